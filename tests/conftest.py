"""What tests share: the command within this process, results solved once, kernels compiled once."""

import fcntl
import gc
import subprocess
import sys
import tomllib
from contextlib import contextmanager
from pathlib import Path

import pytest

import gearopt

PROBLEMS = Path(__file__).parents[1] / "problems"
MANY = 6  # slow cases of one test, of which all are run, but of one marked `campaign`

gc.set_threshold(50_000)  # modules and tests are kept: looking at them takes a tenth of a run


def pytest_addoption(parser):
    """An option for campaigns: slow tests of many random cases."""
    words = f"of every slow test of more than {MANY} cases, or marked campaign, run one in so many"
    parser.addoption("--sample", type=int, default=1, help=words)


def pytest_collection_modifyitems(config, items):
    """Leave out cases of campaigns where a sample is asked for."""
    every = config.getoption("--sample")
    if every == 1:
        return
    campaigns = {}
    for item in items:
        if item.get_closest_marker("slow"):
            campaigns.setdefault((item.path, item.originalname), []).append(item)
    sampled = [
        cases
        for cases in campaigns.values()
        if len(cases) > MANY or cases[0].get_closest_marker("campaign")
    ]
    dropped = {id(k) for cases in sampled for n, k in enumerate(cases) if n % every}
    config.hook.pytest_deselected(items=[k for k in items if id(k) in dropped])
    items[:] = [k for k in items if id(k) not in dropped]


def pytest_pycollect_makeitem(collector, obj):
    """No cases of a slow test where slow ones are left out and none is named."""
    config = collector.config
    if config.option.markexpr != "not slow" or any("::" in word for word in config.args):
        return None
    marks = getattr(obj, "pytestmark", ())
    return [] if callable(obj) and any(m.name == "slow" for m in marks) else None


def pytest_collection_finish():
    """What is loaded now is kept to the end."""
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    """A file of tests is compiled, with what pytest adds to its assertions, by one worker only.

    That takes 10 s for all files, so what is compiled is kept even where Python is asked not to.
    """
    if not isinstance(collector, pytest.Module):
        return (yield)
    asked, sys.dont_write_bytecode = sys.dont_write_bytecode, False
    try:
        with locked(collector.path.open()):
            return (yield)
    finally:
        sys.dont_write_bytecode = asked


def answered(path, **options):
    """The result of a file: of one that only rates given gears its rating."""
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    drive = content["kind"] == "drive"
    only_rated = drive and "rating" in content and "limits" not in content
    return gearopt.rate(path) if only_rated else gearopt.solve(path, **options)


@contextmanager
def locked(file):
    """One worker at a time; the others wait."""
    with file:
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
        with locked((shared / f"{name}.lock").open("w")):
            if not kept.exists():
                found = answered(PROBLEMS / f"{name}.toml")
                kept.write_text(found.to_json(), encoding="utf-8")
        return gearopt.Result.from_json(kept.read_text(encoding="utf-8"))

    return result


@pytest.fixture(scope="session", autouse=True)
def compiled_once(shared, worker_id):
    """A kernel that several workers need is compiled by the first; the others wait and load it.

    None is run uncompiled meanwhile: some test needs its machine code.
    """
    from gearopt.optimise import kernels

    kernels.PATIENCE = 0.0
    if worker_id == "master":
        return
    from numba.core.dispatcher import Dispatcher

    compile_now, within = Dispatcher.compile, []

    def compiled(self, signature):
        if within:  # called by the kernel that is being compiled
            return compile_now(self, signature)
        within.append(self)
        try:
            with locked((shared / f"{self.py_func.__module__}.lock").open("w")):
                return kernels.compiling(lambda: compile_now(self, signature))
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
