"""Compiled kernels are kept between runs, and never stale."""

import gc
import hashlib
import importlib.util
import os
import pickle
import resource
import subprocess
import sys
import textwrap

import numba
import pytest

from gearopt.optimise.kernels import COMPILING, compiled, say

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


DOUBLE = """
from gearopt.optimise.jit_kernel import entry

@entry
def double(x):
    return 2.0 * x
"""


@pytest.fixture
def doubled(tmp_path, monkeypatch, caplog):
    """doubled(): what a kernel, read anew, makes of 1.5, whether it was loaded, what was said."""
    source = tmp_path / "double_kernel.py"
    source.write_text(DOUBLE)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))

    def value():
        spec = importlib.util.spec_from_file_location("double_kernel", source)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        say.cache_clear()
        caplog.clear()
        found = module.double(1.5)
        return found, sum(module.double.stats.cache_hits.values()) == 1, caplog.messages

    return value


def test_damaged_machine_code_is_compiled_again(doubled, tmp_path):
    """Truncated, emptied, of random bytes, one bit turned: numba alone fails or runs it."""
    assert doubled() == (3.0, False, [])
    files = sorted((tmp_path / "cache").rglob("*.nb?"))
    assert [file.suffix for file in files] == [".nbc", ".nbi"]
    for file, damage in (
        (files[0], lambda data: data[: len(data) // 2]),
        (files[0], lambda data: data[:900] + bytes([data[900] ^ 16]) + data[901:]),
        (files[0], lambda data: b""),
        (files[1], lambda data: os.urandom(len(data))),
        (files[1], lambda data: data[:40]),
    ):
        assert doubled() == (3.0, True, [])
        file.write_bytes(damage(file.read_bytes()))
        value, loaded, (words,) = doubled()
        assert value == 3.0 and not loaded
        assert words == f"kept machine code is damaged ({file}) and is compiled again"


def test_a_kernel_that_cannot_be_kept_is_compiled_in_every_run(doubled, tmp_path):
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, usual[1]))  # as on a full disk
    try:
        value, loaded, words = doubled()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    assert value == 3.0 and not loaded and len(words) == 1
    assert f"cannot be kept in {tmp_path / 'cache'} (File too large)" in words[0]
    (tmp_path / "cache").mkdir(exist_ok=True)
    assert doubled() == (3.0, False, []) and doubled() == (3.0, True, [])


def test_machine_code_that_names_a_class_which_has_moved_is_compiled_again(doubled, tmp_path):
    """The index names the classes of tuples that a kernel takes; another version may lack them."""
    assert doubled() == (3.0, False, [])
    index = next((tmp_path / "cache").rglob("*.nbi"))
    with index.open("rb") as file:
        pickle.load(file)
        version = file.tell()
    data = index.read_bytes()[:version] + b"cgearopt.formulations\nMoved\n."
    index.write_bytes(data + hashlib.sha256(data).digest())
    assert doubled() == (3.0, False, [])
    assert doubled() == (3.0, True, [])
