"""`gearopt compare`: table, JSON, page, one message for wrong words, Ctrl-C."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import gearopt

ROOT = Path(__file__).parents[1]
ELEVATOR = ROOT / "problems" / "elevator.toml"
SHORT = ("--seeds", 2, "--seconds", 0.02, "--evaluations", 640)


def gear(*words, **kind):
    command = [sys.executable, "-m", "gearopt", "compare", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, **kind)


@pytest.mark.slow
def test_table_and_page(tmp_path):
    path = tmp_path / "page.html"
    done = gear(ELEVATOR, "--methods", "exact, ipopt,annealing", "--html", path, *SHORT)
    assert done.returncode == 0 and "runs, about" in done.stderr
    for words in ("Whole teeth", "Real-valued teeth", "- annealing: ", f"Page: {path}"):
        assert words in done.stdout
    html = path.read_text(encoding="utf-8")
    assert "Two-stage elevator drive: methods compared" in html
    assert all(f"</span>{name}</th>" in html for name in ("exact", "ipopt", "annealing"))


@pytest.mark.slow
def test_json_is_one_object_and_reads_back():
    done = gear(ELEVATOR, "--methods", "exact,annealing", "--json", *SHORT)
    assert done.returncode == 0 and done.stderr == ""
    found = gearopt.Comparison.from_json(done.stdout)
    assert found.to_dict() == json.loads(done.stdout)
    assert found.complete and found.seeds == (0, 1)
    assert found.budget == {"evaluations": 640, "seconds": 0.02, "patience_seconds": 0.2}
    assert found.file == str(ELEVATOR) and len(found.file_sha256) == 64


@pytest.mark.parametrize(
    "words",
    [
        (ELEVATOR, "--methods", "exact,simplex"),
        (ELEVATOR, "--methods", ","),
        (ELEVATOR, "--seeds", "0"),
        (ELEVATOR, "--html", "/no/such/folder/page.html"),
        ("nothing.toml",),
    ],
)
def test_wrong_words_are_exit_2_without_traceback(words, here):
    done = here("compare", *words, *SHORT[2:])
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr and "Traceback" not in done.stderr


@pytest.mark.slow
def test_ctrl_c_reports_what_is_finished(tmp_path):
    """Runs of half a second; after four seconds of processor time one of several is under way."""
    path = tmp_path / "page.html"
    words = ("--methods", "exact,annealing", "--seconds", "0.5", "--json", "--html", str(path))
    running = subprocess.Popen(
        [sys.executable, "-m", "gearopt", "compare", str(ELEVATOR), *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    spent = Path(f"/proc/{running.pid}/stat")
    while sum(map(int, spent.read_text().split()[13:15])) < 4 * os.sysconf("SC_CLK_TCK"):
        time.sleep(0.05)
    os.kill(running.pid, signal.SIGINT)
    out, err = running.communicate(timeout=30)
    assert running.returncode == 0 and err == ""
    found = gearopt.Comparison.from_json(out)
    assert not found.complete and found.message.startswith("stopped after")
    exact, annealing = found.groups[0].rows
    assert exact.equal_time.summary.tight == 1.0
    assert 0 < len(annealing.equal_evaluations.runs) < 25
    assert "Not complete: stopped after" in path.read_text(encoding="utf-8")
