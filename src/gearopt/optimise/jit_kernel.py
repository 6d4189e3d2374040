"""How kernels are compiled: those that Python calls, and those that only kernels call.

Their machine code is kept (`kernels.kernel`). What numba would add to call a function from C, and
an inner one from Python, is left out: it takes a fifth of the time of compiling.
"""

from numba import njit

entry = njit(cache=True, no_cfunc_wrapper=True)
inner = njit(cache=True, no_cfunc_wrapper=True, no_cpython_wrapper=True)
