"""Before kernels are compiled: layouts are solved in Python, to the same numbers."""

import math
import subprocess
import sys

import numpy as np
import pytest
from gearboxes import gearbox, some_box

from gearopt.formulations.drive import layout
from gearopt.formulations.drive.layout import annealing
from gearopt.formulations.drive.layout.exact import BRANCH
from gearopt.optimise import kernels
from gearopt.optimise.result import Budget

PROGRAM = """
import sys
from gearopt.formulations.drive import layout, together
from gearopt.formulations.packing import sa

told = []
for room in (sa, layout, together):
    assert room.ready(lambda event: told.append(event.part) or True)
for name, module in sys.modules.items():
    for function in vars(module).values() if name.endswith("_kernel") else ():
        if len(getattr(function, "signatures", ())) > 1:
            sys.exit(f"{function.__name__} is compiled for {function.signatures}")
print(*told, sep="\\n")
"""
BOXES = [
    pytest.param(lambda: gearbox("table4_p1"), id="table 4"),
    pytest.param(lambda: some_box(3, 4), id="random 3", marks=pytest.mark.slow),
    pytest.param(lambda: some_box(8, 5), id="random 8", marks=pytest.mark.slow),
]


def first_use(monkeypatch, patience):
    """As on a machine where nothing is compiled, for so many seconds."""
    monkeypatch.setattr(kernels, "_kept", lambda entry: False)
    monkeypatch.setattr(kernels, "PATIENCE", patience)
    monkeypatch.setattr(kernels.warm(), "seconds", 0.0)


def solved(box, watch=None):
    model = layout.problem(box)
    return model.methods["exact"](model, Budget(gap=1e-2), 0, watch)


@pytest.mark.parametrize("box", BOXES)
def test_python_and_machine_code_give_the_same_answer_bit_by_bit(box, monkeypatch):
    own, drawn = box(), np.random.get_state()[1].copy()  # noqa: NPY002
    machine = solved(own)
    first_use(monkeypatch, math.inf)
    python = solved(own)
    assert kernels.warm().seconds > 0.0
    assert (np.random.get_state()[1] == drawn).all()  # noqa: NPY002 - the user's generator
    assert machine.finished and python.finished
    assert python.bound == machine.bound and python.evaluations == machine.evaluations
    assert python.proof == machine.proof
    assert python.x is machine.x or python.x.tolist() == machine.x.tolist()


def test_after_some_seconds_a_search_goes_on_compiled_from_where_it_is(monkeypatch):
    box = gearbox("table4_p1")
    machine = solved(box)
    first_use(monkeypatch, 1e-9)  # the first slice alone is Python's
    both = solved(box)
    assert both.evaluations == machine.evaluations and both.bound == machine.bound


def test_a_watcher_ends_a_search_that_would_compile(monkeypatch):
    first_use(monkeypatch, 0.0)
    monkeypatch.setattr(kernels, "compiled", lambda work, entries, watch: watch(None))
    outcome = solved(gearbox("table4_p1"), lambda event: event is not None)
    assert not outcome.finished and outcome.x is not None and outcome.bound is None
    monkeypatch.setattr(annealing, "compiled", lambda work, entries, watch: watch(None))
    outcome = solved(gearbox("table4_p1"), lambda event: event is not None)
    assert not outcome.finished and outcome.x is None and outcome.bound is None


def test_a_kernel_in_python_is_what_it_was_written_as():
    law = kernels.kernel(BRANCH)
    python = kernels.plain(law.branch)
    assert python.__code__ is law.branch.py_func.__code__
    assert not hasattr(python.__globals__["sharp"], "py_func")
    assert not hasattr(python.__globals__["sharp"].__globals__["program"], "py_func")
    assert hasattr(law.branch.py_func.__globals__["sharp"], "py_func")


@pytest.mark.slow
def test_every_function_is_compiled_once(tmp_path, monkeypatch):
    """A literal integer among the arguments of one would compile it, and what it calls, again."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("NUMBA_OPT", "0")  # signatures do not depend on it
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    steps = [line.split(": ")[1].split(" of ") for line in done.stdout.splitlines()]
    assert steps[0][0] == "1" and len(steps) > 40
    assert all(0 < int(k) <= int(n) for k, n in steps)
