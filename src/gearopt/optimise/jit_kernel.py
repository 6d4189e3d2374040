"""How kernels are compiled: those that Python calls, and those that only kernels call.

Their machine code is kept (`kernels.kernel`). What numba would add to call a function from C, and
an inner one from Python, is left out: it takes a fifth of the time of compiling.

`inlined` is for small functions that a kernel calls millions of times and that make no array (numba
refuses one that does): they become part of their callers, references to arrays are not counted, and
a division by zero gives infinity. Steps of motions are three to four times as fast by it.
"""

from numba import njit

entry = njit(cache=True, no_cfunc_wrapper=True)
inner = njit(cache=True, no_cfunc_wrapper=True, no_cpython_wrapper=True)
inlined = njit(
    cache=True,
    no_cfunc_wrapper=True,
    no_cpython_wrapper=True,
    forceinline=True,
    error_model="numpy",
    _nrt=False,
)
