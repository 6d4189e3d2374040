"""The public names are those of `__all__`, each documented."""

import ast
import copy
import inspect
import os
import pickle
import subprocess
import sys
from pathlib import Path

import pytest

import gearopt
from gearopt import Param, Problem, SceneError, Terms, Var, api
from gearopt.optimise.result import Budget


def test_all_is_what_the_package_offers():
    assert gearopt.__all__ == sorted(gearopt.__all__) == dir(gearopt)
    assert gearopt.solve is api.solve and gearopt.Budget is Budget
    with pytest.raises(AttributeError, match="'gearopt' has no attribute 'nothing'"):
        gearopt.nothing  # noqa: B018


HEAVY = ("numpy", "casadi", "cvxpy", "scipy", "typer", "rich")


def test_a_name_is_imported_when_it_is_asked_for():
    """Before that Ctrl-C has nothing to interrupt, and no library is read."""
    code = (
        "import sys, gearopt, gearopt.__main__\n"
        f"print(any(m in sys.modules for m in {HEAVY!r}))\n"
        "from gearopt import *; print(solve.__name__, Budget(1.0).seconds)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.split() == ["False", "solve", "1.0"] and done.stderr == ""


def test_public_names_are_documented():
    for name in gearopt.__all__:
        assert inspect.getdoc(getattr(gearopt, name)), name


def other_than(what):
    """It as another process gets it, and its deep copy."""
    return pickle.loads(pickle.dumps(what)), copy.deepcopy(what)


def test_errors_reach_other_processes_whole():
    """A pool of processes hangs on an error that cannot be unpickled."""
    with pytest.raises(SceneError) as wrong:
        gearopt.load({"gearopt": 1, "kind": "drive", "duty": {"power": "7 kg"}, "gaers": {}})
    assert len(wrong.value.errors) > 2
    for other in other_than(wrong.value):
        assert str(other) == str(wrong.value) and other.fix == wrong.value.fix
        assert [vars(e).keys() for e in other.errors] == [
            vars(e).keys() for e in wrong.value.errors
        ]
        assert [e.key for e in other.errors] == [e.key for e in wrong.value.errors]


def text(x, p):
    return Terms({"cost": x.a + p.k / x.a})


def test_problems_that_were_solved_are_copied_and_reach_other_processes():
    """What was traced is left behind: casadi's expressions cannot be copied."""
    problem = Problem("own", (Var("a", "", 0.1, 9.0, 1.0),), (Param("k", "", 1.0),), text)
    found = gearopt.solve(problem.at(k=4.0))
    assert found.value == pytest.approx(4.0, rel=1e-12)
    for other in other_than(problem):
        assert other == problem and not other.memo
        assert gearopt.solve(other.at(k=4.0)).value == found.value
    assert all(other == found for other in other_than(found))


USER = """
from typing import Any
import gearopt
from gearopt import Budget, Event, Front, Param, Problem, Result, SceneError, Terms, Var

def text(x: Any, p: Any) -> Terms:
    return Terms({"cost": x.a + p.k / x.a})

def watch(event: Event) -> bool:
    return event.seconds < 1.0

problem = Problem("own", (Var("a", "mm", 0.1, 9.0, 1.0),), (Param("k", "", 1.0),), text)
found: Result = gearopt.solve(problem.at(k=4.0), budget=Budget(seconds=1.0), watch=watch)
front: Front = gearopt.pareto("my.toml", objectives=["gear_volume", "mesh_loss"])
values: list[float] = [point.values[0] for point in front.points]
rated: Result = gearopt.rate("my.toml", {"duty.power": "7 kW"})
told: str = gearopt.compare("my.toml", methods=["ipopt"]).to_json()
try:
    print(gearopt.explain("my.toml").remedies, gearopt.load("my.toml"), values, rated, told)
except SceneError as wrong:
    print(wrong.key, wrong.fix.value if wrong.fix else "")
"""


@pytest.mark.slow
def test_a_program_of_a_user_is_checked_for_its_types(tmp_path):
    """By mypy, which knows the package by its `py.typed`; wrong ones are found."""
    site = tmp_path / "site"
    site.mkdir()
    (site / "gearopt").symlink_to(Path(gearopt.__file__).parent)

    def checked(text):
        (tmp_path / "user.py").write_text(text)
        words = ["--strict", "--config-file", "", "--cache-dir", tmp_path / "cache", "user.py"]
        return subprocess.run(
            [sys.executable, "-m", "mypy", *map(str, words)],
            cwd=tmp_path,
            env=os.environ | {"MYPYPATH": "", "PYTHONPATH": str(site)},
            capture_output=True,
            text=True,
        )

    assert (done := checked(USER)).returncode == 0, done.stdout
    wrong = checked(USER.replace("values: list[float]", "values: list[str]"))
    assert wrong.returncode == 1 and "expected List[str]" in wrong.stdout


def test_type_checkers_see_every_public_name():
    source = Path(gearopt.__file__)
    imported = {
        name.name
        for node in ast.walk(ast.parse(source.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and node.module != "importlib"
        for name in node.names
    }
    assert imported - {"version", "import_module"} == set(gearopt.__all__)
    assert (source.parent / "py.typed").exists()
