"""Kernels as the Python they are written in, for tests of functions that only kernels call."""

from types import SimpleNamespace

from gearopt.optimise.kernels import kernel, plain


def uncompiled(module):
    """A kernel module, its functions uncompiled."""
    own = vars(kernel(module)).items()
    return SimpleNamespace(**{n: plain(v) if hasattr(v, "py_func") else v for n, v in own})
