"""The command line: exit codes, one message for bad input, nothing but JSON with --json."""

import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path

import pytest
from campaigns import few

import gearopt
from gearopt.cli.app import print_whole
from gearopt.optimise.methods import back_ends
from gearopt.scenes.reading.ask import RANDOM

ROOT = Path(__file__).parents[1]
ELEVATOR = ROOT / "problems" / "elevator.toml"


def gear(*words, **kind):
    return subprocess.run(
        [sys.executable, "-m", "gearopt", *map(str, words)], capture_output=True, text=True, **kind
    )


@pytest.mark.slow
def test_solve_prints_design_limits_bound_and_proof():
    done = gear("solve", ELEVATOR, "--top", 3)
    assert done.returncode == 0 and done.stderr == ""
    for words in (
        "proven optimal",
        "115       91",
        "5,782.4",
        "trains compared",
        "2.92 %",
        "5,789.2",
        "150.06",
    ):
        assert words in done.stdout, words


def test_json_is_one_object_and_reads_back(here):
    done = here("solve", ELEVATOR, "--json", "--top", 20)
    result = gearopt.Result.from_json(done.stdout)
    assert result.status == "optimal" and result.to_dict() == json.loads(done.stdout)
    assert len(result.report["trains"]) == 20
    assert result.scene == "drive" and result.versions["numpy"]


@pytest.mark.slow
def test_html_writes_a_page_beside_the_report_or_the_json(tmp_path, here):
    path = tmp_path / "a page.html"
    done = here("solve", ELEVATOR, "--html", path, "--top", 3)
    assert done.returncode == 0 and done.stderr == ""
    assert "proven optimal" in done.stdout and done.stdout.endswith(f"\nPage: {path}\n")
    first = path.read_text(encoding="utf-8")
    assert "<h1>Two-stage elevator drive</h1>" in first and "5,789.2" in first
    assert f"{ELEVATOR} --top 3 --html &#39;{path}&#39;" in first
    path.unlink()
    done = here("solve", ELEVATOR, "--html", path, "--json")
    assert json.loads(done.stdout)["status"] == "optimal" and path.exists()


@pytest.mark.slow
def test_report_shows_a_kept_result_again(tmp_path, here):
    kept, pages = tmp_path / "result.json", [tmp_path / name for name in ("a.html", "b.html")]
    done = here("solve", ELEVATOR, "--top", 10, "--prices", "--json", "--html", pages[0])
    kept.write_text(done.stdout, encoding="utf-8")
    again = here("report", kept, "--html", pages[1], "--csv", tmp_path / "tables")
    assert again.returncode == 0 and again.stderr == ""
    assert "5,782.4" in again.stdout and "limits.k_factor" in again.stdout
    first, second = (page.read_text(encoding="utf-8") for page in pages)
    assert first.replace("a.html", "b.html") == second
    stages = (tmp_path / "tables" / "stages.csv").read_text(encoding="utf-8-sig")
    assert stages.startswith(",stage 1,stage 2\n") and "teeth z2,115,91\n" in stages
    inch = here("report", kept, "--units", "inch").stdout
    assert "352.86 in³" in inch and "mm³" not in inch and "diametral pitch" in inch


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("report", "no.json"), "cannot be read"),
        (("report", ROOT / "problems"), "cannot be read"),
        (("report", ELEVATOR), "is not JSON"),
        (("report", "list.json"), "is not a result"),
        (("report", "other.json"), "result format 7"),
        (("report", "part.json"), "lacks the keys method"),
        (("report", "more.json"), "extra"),
        (("report", "status.json"), "status 'great'"),
        (("report", "parts.json"), "value of the wrong type in parts"),
        (("report", "value.json"), "whose value is not a number"),
        (("report", "stages.json"), "has unknown keys in design"),
        (("report", "why.json"), "is an explanation"),
        (("solve", ELEVATOR, "--units", "furlong"), "write metric or inch"),
        (("solve", ELEVATOR, "--csv", ELEVATOR), "is a file"),
        (("solve", ELEVATOR, "--csv", ELEVATOR / "x"), "is a file"),
    ],
)
def test_what_cannot_be_shown_is_one_message(words, said, tmp_path, here, monkeypatch):
    part = {"result": 1, "name": "x", "status": "optimal", "objective": {}}
    files = {"list.json": [1], "other.json": {"result": 7}, "part.json": part}
    files["more.json"] = part | {"method": "exact", "extra": 1}
    whole = part | {"method": "exact", "objective": {"name": "mass", "value": 1.0}}
    files["status.json"] = whole | {"status": "great"}
    files["parts.json"] = whole | {"parts": None}
    files["value.json"] = whole | {"objective": {"name": "mass", "value": "abc"}}
    files["stages.json"] = whole | {"design": {"stages": [{"ratio": None}]}, "scene": "packing"}
    files["why.json"] = {"explanation": 1, "result": whole}
    for name, content in files.items():
        (tmp_path / name).write_text(json.dumps(content), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    done = here(*words)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.count("\n") == 1 and said in done.stderr


@pytest.mark.parametrize("page", ["", "/no/such/folder/page.html"])
def test_a_page_that_cannot_be_written_is_told_before_solving(page, tmp_path, here):
    done = here("solve", ELEVATOR, "--html", page or tmp_path)
    assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1


@pytest.mark.slow
def test_infeasible_is_exit_3(here):
    done = here("solve", ROOT / "problems" / "thousand_in_two_stages.toml", "--seconds", 0.5)
    assert done.returncode == 3
    assert "impossible, proven" in done.stdout and "stage ratio" in done.stdout


def test_nothing_found_in_time_is_exit_4(here):
    done = here("solve", ELEVATOR, "--seconds", 0, "--json")
    assert done.returncode == 4
    assert json.loads(done.stdout)["status"] == "limit"


def test_bad_input_is_one_message_and_exit_2(tmp_path, here):
    path = tmp_path / "typo.toml"
    path.write_text(ELEVATOR.read_text().replace("helix_angle", "helix_angel"))
    for command in ("solve", "check"):
        done = here(command, path)
        assert done.returncode == 2 and done.stdout == ""
        assert done.stderr.count("\n") == 1
        assert "gears.helix_angel: unknown key. Did you mean helix_angle?" in done.stderr
    report = json.loads(here("check", path, ELEVATOR, "--json").stdout)
    assert [r["valid"] for r in report] == [False, True]
    assert report[0]["key"] == "gears.helix_angel"


@pytest.mark.parametrize(
    "words",
    [
        ("solve", ELEVATOR, "--method", "simplex"),
        ("solve", ELEVATOR, "--top", "0"),
        ("schema", "bearing"),
        ("new", "bearing"),
        ("bench", "nothing"),
        ("frobnicate",),
        ("solve",),
        ("solve", ROOT / "problems" / "elevator_exact_ratio.toml", "--method", "exact"),
    ],
)
def test_wrong_words_are_exit_2_without_traceback(words, here):
    done = here(*words)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr and "Traceback" not in done.stderr


def test_new_file_solves_and_schema_is_json(tmp_path, here):
    path = tmp_path / "new.toml"
    path.write_text(here("new", "drive").stdout)
    assert here("check", path).returncode == 0
    schema = json.loads(here("schema", "drive").stdout)
    assert "duty" in schema["else"]["required"]  # of files with gears of their own


def test_doctor(here):
    done = here("doctor", "--json")
    assert done.returncode == 0
    found = json.loads(done.stdout)
    assert found["exact works"].startswith("yes") and found["ipopt works"].startswith("yes")


def to_nobody(*words, **kind):
    """A command whose standard output is a pipe that nobody reads any more."""
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "gearopt", *map(str, words)]
    running = subprocess.Popen(command, stdout=writer, stderr=subprocess.PIPE, text=True, **kind)
    os.close(writer)
    return running


@pytest.mark.slow
def test_a_closed_pipe_is_no_error():
    running = to_nobody("schema", "drive")
    assert running.communicate()[1] == "" and running.returncode == 0


@pytest.mark.slow
def test_a_closed_pipe_loses_no_file(tmp_path):
    files = ("--html", "page.html", "--csv", "tables")
    first = to_nobody("solve", ELEVATOR, *files, cwd=tmp_path)
    assert first.communicate()[1] == "" and first.returncode == 0
    assert (tmp_path / "page.html").read_text(encoding="utf-8").rstrip().endswith("</html>")
    assert "teeth z2,115,91\n" in (tmp_path / "tables" / "stages.csv").read_text("utf-8-sig")


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ("--help",),
        ("--version",),
        ("solve", "--help"),
        ("solve", ELEVATOR, "--json", "--html", "page.html"),
        ("report", "kept.json", "--html", "page.html"),
        ("explain", ELEVATOR),
        ("explain", ELEVATOR, "--json"),
        ("compare", ELEVATOR, "--methods", "exact", "--html", "page.html", "--seconds", 0.02),
        ("compare", ELEVATOR, "--methods", "exact", "--json", "--seconds", 0.02),
        ("check", ELEVATOR),
        ("check", ELEVATOR, "--json"),
        ("new", "drive"),
        ("schema", "drive", "--table"),
        ("doctor",),
        ("bench", "servo", "--repeat", 1),
    ],
)
def test_a_closed_pipe_is_no_error_of_any_command(words, tmp_path):
    if words[0] == "report":
        (tmp_path / "kept.json").write_text(gear("solve", ELEVATOR, "--json").stdout)
    running = to_nobody(*words, cwd=tmp_path)
    said = running.communicate()[1]
    assert running.returncode == 0
    assert said == "" or (words[0] == "compare" and said.startswith("2 runs, about"))
    assert ("page.html" in words) == (tmp_path / "page.html").exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.slow
def test_a_full_disk_is_one_message():
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "gearopt", "schema", "drive"]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr == "gearopt: the output cannot be written (No space left on device)\n"


INTERRUPTED = """
import os, runpy, signal, sys

class Interrupts:
    def find_spec(self, name, *where):
        if name == module:
            if "gearopt.cli.watching" in sys.modules:  # however slow the machine is
                sys.modules["gearopt.cli.watching"].GRACE = 30.0
            for _ in range(int(times)):
                os.kill(os.getpid(), 2)

module, times, *sys.argv[1:] = sys.argv[1:]
signal.signal(signal.SIGINT, signal.default_int_handler)
del sys.modules["signal"]
sys.meta_path.insert(0, Interrupts())
runpy.run_module("gearopt", run_name="__main__", alter_sys=True)
"""


@pytest.mark.parametrize(
    ("module", "times", "code", "words"),
    few(
        [
            ("signal", 1, 130, "gearopt: interrupted\n"),
            ("gearopt.report.terminal", 1, 130, "gearopt: interrupted\n"),
            ("numpy", 1, 130, "gearopt: interrupted\n"),
            ("typer", 1, 130, "gearopt: interrupted\n"),
            ("casadi", 1, 4, ""),
            ("casadi", 2, 130, "gearopt: interrupted\n"),
        ],
        1,
    ),
)
def test_ctrl_c_while_a_module_is_read_is_no_traceback(module, times, code, words):
    """While it loads, at the start of a run, twice in a run, and after it."""
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED, module, str(times), "solve", str(ELEVATOR)],
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (code, words)


def test_json_is_printed_whole_before_ctrl_c_counts(monkeypatch):
    class Screen(io.StringIO):
        def write(self, text):
            signal.raise_signal(signal.SIGINT)
            return super().write(text)

    monkeypatch.setattr(sys, "stdout", screen := Screen())
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background
    try:
        with pytest.raises(KeyboardInterrupt):
            print_whole("{}")
    finally:
        signal.signal(signal.SIGINT, before)
    assert screen.getvalue() == "{}\n"


@pytest.mark.slow
def test_ctrl_c_keeps_the_best_found(tmp_path):
    """Six stages with free widths take minutes; an interrupt after two seconds loses nothing."""
    path = tmp_path / "long.toml"
    text = (ROOT / "problems" / "six_stages.toml").read_text()
    for width in ("0.6", "0.75"):
        text = text.replace(f"diameter = {width}", f"diameter = [0.3, {width}]")
    path.write_text(text)
    running = subprocess.Popen(
        [sys.executable, "-m", "gearopt", "solve", str(path), "--json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    time.sleep(3.0)
    os.kill(running.pid, signal.SIGINT)
    start = time.perf_counter()
    out, err = running.communicate(timeout=30)
    assert time.perf_counter() - start < 5.0
    assert running.returncode == 0 and err == ""
    result = json.loads(out)
    assert result["status"] == "limit"
    assert result["objective"]["value"] > 0 and 0 < result["bound"] < result["objective"]["value"]


def test_every_option_has_help(here):
    for command in ("solve", "check", "schema", "new", "doctor", "bench"):
        done = here(command, "--help")
        assert done.returncode == 0 and "Usage" in done.stdout


@pytest.mark.parametrize(
    ("command", "file"),
    [
        ("explain", "unstable_speed"),
        ("solve", "sandgren_train"),
        ("rate", "shigley_14_4"),
    ],
)
def test_what_a_command_says_names_its_own_options(command, file, here):
    said = here(command, ROOT / "problems" / f"{file}.toml").stdout
    options = set(re.findall(r"(?<!\S)--[a-z-]+", here(command, "--help").stdout))
    named = [set(re.findall(r"(?<!\S)--[a-z-]+", line)) for line in said.splitlines()]
    assert any(named)
    assert set().union(*named) <= options


@pytest.mark.slow
def test_version_and_ascii_terminals():
    assert gear("--version").stdout.strip() == gearopt.Result("", "", "", {}).gearopt
    ascii_only = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = gear("solve", ELEVATOR, env=ascii_only)
    assert done.returncode == 0 and "Traceback" not in done.stderr


@pytest.mark.slow
def test_six_stages_fit_a_terminal_of_80_columns(here, solved, tmp_path, monkeypatch):
    (kept := tmp_path / "kept.json").write_text(solved("six_stages").to_json(), encoding="utf-8")
    for name, value in (("COLUMNS", "80"), ("FORCE_COLOR", "1"), ("TERM", "xterm")):
        monkeypatch.setenv(name, value)
    done = here("report", kept)
    assert "224,034" in done.stdout and "20,942" in done.stdout  # no digit is cut


@pytest.mark.parametrize(
    ("stem", "options", "said"),
    [
        ("sandgren_train", ("--top", 3), "--top 3 changes nothing here: a compound train"),
        ("sandgren_train", ("--seed", 3), "--seed 3 changes nothing here: the method is not ran"),
        ("elevator", ("--seed", 3, "--method", "ipopt"), "nothing here: ipopt is not random"),
        ("elevator", ("--top", 3, "--method", "ipopt"), "exact lists the next best ones"),
        ("elevator", ("--units", "inch", "--json"), "--units inch changes nothing of --json"),
        ("five_stages_continuous", ("--top", 3), "which a table [teeth] asks for"),
        ("servo_gimbal", ("--top", 3), "the trains of the Pareto front are listed"),
        ("servo_gimbal_ratio", ("--top", 3), "without [train] there are no trains"),
        ("six_cylinders", ("--top", 3), "no next best answers are listed"),
    ],
)
def test_an_option_that_changes_nothing_is_refused(stem, options, said, here):
    file = ROOT / "problems" / f"{stem}.toml"
    done = here("solve", file, *options)
    assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1
    assert said in done.stderr
    if options[0] == "--top":
        method = options[3] if len(options) > 2 else None
        with pytest.raises(gearopt.SolveError, match="top=3 changes nothing here: "):
            gearopt.solve(file, method=method, top=3)


def test_options_of_files_are_refused_for_problems_of_ones_own():
    x = gearopt.Var("x", "mm", 1.0, 2.0, 1.5)
    own = gearopt.Problem("own", (x,), (), lambda x, p: gearopt.Terms({"length": x.x}))
    with pytest.raises(gearopt.SolveError, match="top=2 changes nothing here: own has no next"):
        gearopt.solve(own, top=2)
    with pytest.raises(gearopt.SolveError, match=r"prices=True is for files: explain\(own\)"):
        gearopt.solve(own, prices=True)


def test_the_methods_that_take_a_seed_are_those_that_say_so():
    declared = {n: import_module(f"gearopt.optimise.solvers.{n}").RANDOM for n in back_ends()}
    assert {name for name, random in declared.items() if random} == set(RANDOM)


def test_continuous_answer_of_a_teeth_file_says_so(here):
    done = here("solve", ELEVATOR, "--method", "ipopt")
    assert "Teeth and modules are real numbers here" in done.stdout
    assert "centre distances" not in done.stdout.split("total length")[1]


@pytest.mark.skipif(not Path("/proc/self/mem").exists(), reason="needs a file that cannot be read")
def test_a_file_that_cannot_be_read_is_one_message(here):
    """Even root cannot read the first byte of a process's memory."""
    done = here("solve", "/proc/self/mem")
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.count("\n") == 1 and "cannot be read" in done.stderr
