"""What tests share: the command within this process, results solved once, kernels compiled once."""

import fcntl
import subprocess
import sys
import tomllib
from contextlib import contextmanager
from pathlib import Path

import pytest

import gearopt

PROBLEMS = Path(__file__).parents[1] / "problems"


def answered(path, **options):
    """The result of a file: of one that only rates given gears its rating."""
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    only_rated = "rating" in content and "limits" not in content
    return gearopt.rate(path) if only_rated else gearopt.solve(path, **options)


@contextmanager
def locked(path):
    """One worker at a time; the others wait."""
    with path.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


@pytest.fixture(scope="session")
def shared(tmp_path_factory, worker_id):
    """A folder that all workers of this run have in common."""
    own = tmp_path_factory.getbasetemp()
    return own if worker_id == "master" else own.parent


@pytest.fixture(scope="session")
def solved(shared):
    """solved(name): the result of problems/NAME.toml, found once in a run of all workers.

    A file without limits is rated.
    """

    def result(name):
        kept = shared / f"{name}.json"
        with locked(shared / f"{name}.lock"):
            if not kept.exists():
                found = answered(PROBLEMS / f"{name}.toml")
                kept.write_text(found.to_json(), encoding="utf-8")
        return gearopt.Result.from_json(kept.read_text(encoding="utf-8"))

    return result


@pytest.fixture(scope="session", autouse=True)
def compiled_once(shared, worker_id):
    """A kernel that several workers need is compiled by the first; the others wait and load it."""
    if worker_id == "master":
        return
    from numba.core.dispatcher import Dispatcher

    compile_now, within = Dispatcher.compile, []

    def compiled(self, signature):
        if within:  # called by the kernel that is being compiled
            return compile_now(self, signature)
        within.append(self)
        try:
            with locked(shared / f"{self.py_func.__module__}.lock"):
                return compile_now(self, signature)
        finally:
            within.pop()

    Dispatcher.compile = compiled


@pytest.fixture
def here(capsys, monkeypatch):
    """here(*words): the command within this process, which saves the start of another one."""
    from gearopt.cli import run

    def call(*words):
        monkeypatch.setattr(sys, "argv", ["gearopt", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            run()
        said = capsys.readouterr()
        return subprocess.CompletedProcess(words, ended.value.code, said.out, said.err)

    return call
