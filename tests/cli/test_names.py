"""Names that help lists and the Tab key completes: kinds, methods, benches, files."""

import subprocess
import sys
from pathlib import Path

import pytest

from gearopt import bench
from gearopt.cli import names
from gearopt.scenes.reading.kinds import kinds

PROBLEMS = Path(__file__).parents[2] / "problems"
KINDS = kinds()
FILES = Path(bench.__file__).parent.glob("*.py")
BENCHES = tuple(sorted(p.stem for p in FILES if p.stem != "__init__"))


@pytest.fixture
def wide(monkeypatch):
    monkeypatch.setenv("COLUMNS", "2000")  # no word is parted


def test_help_says_what_it_is_and_how_to_begin(here, wide):
    said = here("--help").stdout
    words = [
        "Design gear drives, and prove",
        "Begin with three commands",
        "new",
        "solve",
        "explain",
    ]
    places = [
        said.index(w) for w in [*words, "Examples:", "gearopt new drive > my.toml", "--version"]
    ]
    assert places == sorted(places)
    assert "--install-completion" in said


def test_help_lists_kinds_methods_and_benches(here, wide):
    for command in ("new", "schema"):
        said = here(command, "--help").stdout
        assert "drive (a multi-stage drive of cylindrical gears" in said
        assert all(f"{kind} (" in said for kind in KINDS)
    for command in ("solve", "compare"):
        said = here(command, "--help").stdout
        for some in ("packing: hop, sa", "pair: exact, mpec", "servo: exact, enumeration"):
            assert some in said
        assert "annealing, cobyqa, conic, gp, ipopt, multistart, nsga2, qp, scip" in said
    assert all(f"{name} (" in here("bench", "--help").stdout for name in BENCHES)


def test_no_place_for_names_is_left_open(here, wide):
    for command in ("new", "solve", "explain", "check", "compare", "report", "schema", "bench"):
        assert "{kinds}" not in (said := here(command, "--help").stdout)
        assert "{methods}" not in said and "{benches}" not in said


def test_words_begin_as_typed():
    assert tuple(word for word, _ in names.kind_words("")) == KINDS
    assert [word for word, _ in names.kind_words("d")] == ["drive", "dynamics"]
    assert tuple(word for word, _ in names.bench_words("")) == BENCHES
    assert [w for w, _ in names.method_words("s")] == [
        "sa",
        "sa-polish",
        "sa-paper",
        "smooth",
        "screened",
        "scip",
        "spatial",
    ]
    exact = dict(names.method_words("exact"))["exact"].split(", ")
    assert {"compound", "drive", "pair", "servo"} <= {*exact} and "packing" not in exact
    assert names.method_lists("exact,an") == ["exact,annealing"]
    assert names.system_words("i") == ["inch"]


def test_files_are_completed_by_their_ending(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine" / "deep").mkdir(parents=True)
    for name in ("a.toml", "a.json", "a.txt", ".hidden.toml", "mine/b.toml", "mine/deep/c.json"):
        (tmp_path / name).write_text("")
    assert names.problem_files("") == ["a.toml", "mine/"]
    assert names.result_files("a") == ["a.json"]
    assert names.problem_files("mi") == ["mine/", "mine/b.toml", "mine/deep/"]
    assert names.problem_files("mine/b") == ["mine/b.toml"]
    assert names.result_files(f"{tmp_path}/mine/deep/") == [f"{tmp_path}/mine/deep/c.json"]
    assert names.problem_files("none/") == names.problem_files(".h/") == []
    assert names.problem_files(".h") == [".hidden.toml"]


BASH = """
gearopt() { "$PYTHON" -m gearopt "$@"; }
mkdir bin; printf '#!/bin/sh\\nexec "%s" -m gearopt "$@"\\n' "$PYTHON" > bin/gearopt
chmod +x bin/gearopt; PATH=$PWD/bin:$PATH
eval "$(_GEAROPT_COMPLETE=source_bash gearopt)"
way=$(complete -p gearopt | sed 's/.*-F \\([^ ]*\\).*/\\1/')
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); $way gearopt; printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "shown"),
    [
        (("gearopt", "so"), "solve"),
        (("gearopt", "new", "d"), "drive dynamics"),
        (("gearopt", "new", "ra"), "rating"),
        (("gearopt", "rate", f"{PROBLEMS}/elevator_b"), f"{PROBLEMS}/elevator_b*.toml"),
        (("gearopt", "solve", f"{PROBLEMS}/elevator_b"), f"{PROBLEMS}/elevator_b*.toml"),
        (("gearopt", "solve", "x.toml", "--method", "hop"), "hop"),
        (("gearopt", "report", ""), "bin/ kept.json"),
    ],
)
def test_bash_completes(words, shown, tmp_path):
    (tmp_path / "kept.json").write_text("{}")
    done = subprocess.run(
        ["bash", "-c", BASH, "bash", *words],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={"PYTHON": sys.executable, "PATH": "/usr/bin:/bin", **_source()},
    )
    expected = (
        sorted(map(str, PROBLEMS.glob("elevator_b*.toml"))) if "*" in shown else shown.split()
    )
    assert sorted(done.stdout.split()) == expected, done.stderr


def _source():
    """The environment in which another Python finds the same gearopt."""
    return {"PYTHONPATH": str(Path(names.__file__).parents[2])}
