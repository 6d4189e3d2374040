"""Compiled kernels are kept between runs, and never stale."""

import gc
import subprocess
import sys
import textwrap

import numba
import pytest

from gearopt.optimise.kernels import COMPILING, compiled

PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from gearopt.optimise import kernels
print(kernels.kernel("caller_kernel").twice(1.5))
"""


@pytest.mark.slow
def test_a_changed_callee_is_compiled_again(tmp_path, monkeypatch):
    """numba's own index looks at the caller's file alone and would give the old number."""
    package = tmp_path / "gearopt_copy"
    package.mkdir()
    callee, caller = package / "callee_kernel.py", package / "caller_kernel.py"
    njit = "import numba\n\n@numba.njit(cache=True)\n"
    callee.write_text(njit + "def factor():\n    return 2.0\n")
    caller.write_text(
        "from callee_kernel import factor\n" + njit + "def twice(x):\n    return factor() * x\n"
    )
    program = textwrap.dedent(PROGRAM).replace(
        "print(", f"kernels._SOURCES = __import__('pathlib').Path({str(package)!r})\nprint("
    )
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))

    def run():
        done = subprocess.run(
            [sys.executable, "-c", program, str(package)],
            capture_output=True,
            text=True,
            check=True,
        )
        return float(done.stdout)

    assert run() == 3.0
    assert run() == 3.0
    callee.write_text(njit + "def factor():\n    return 4.0\n")
    assert run() == 6.0
    assert len(list((tmp_path / "cache").iterdir())) == 2


@numba.njit
def half(x):
    return 0.5 * x


@numba.njit
def quarter(x):
    return half(half(x))


def test_a_watcher_hears_of_every_function_and_may_end_the_compiling():
    events, values = [], []

    def work():
        values.append(quarter(8.0))

    def ends(event):
        events.append(event)
        return len(events) < 2

    assert not compiled(work, (quarter,), ends) and values == []
    assert [e.part for e in events] == [f"{COMPILING}: {k} of 2" for k in (1, 2)]
    assert all(e.best is None and e.bound is None for e in events)
    assert compiled(work, (quarter,), lambda event: True) and values == [2.0]
    assert compiled(work, (quarter,), lambda event: pytest.fail("nothing is left to compile"))
    assert gc.isenabled() and len(quarter.signatures) == len(half.signatures) == 1
