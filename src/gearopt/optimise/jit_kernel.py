"""How kernels are compiled: those that Python calls, and those that only kernels call.

Their machine code is kept (`kernels.kernel`), each file with a checksum at its end: numba would run
what a crash or a full disk left of one. A damaged file counts as none, so that it is written anew.
Where nothing can be kept, kernels are compiled in every run. What numba would add to call a
function from C, and an inner one from Python, is left out: it takes a fifth of the time of
compiling.

`inlined` is for small functions that a kernel calls millions of times and that make no array (numba
refuses one that does): they become part of their callers, references to arrays are not counted, and
a division by zero gives infinity. Steps of motions are three to four times as fast by it. `light`
is the same for larger ones, which stay functions of their own.
"""

import hashlib
import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

from numba import config, njit
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile

from gearopt.optimise.kernels import say, sound

UNKEPT = "machine code of kernels cannot be kept in {} ({}): every run compiles them again"

Locator = CompileResultCacheImpl._locator_classes[0]  # of config.CACHE_DIR; its name has changed


class _Files(IndexDataCacheFile):  # type: ignore[misc, unused-ignore]
    """The index of a kernel and its machine code, with checksums; an interface of numba."""

    def _load_index(self) -> Any:
        try:
            return super()._load_index() if sound(self._index_path) else {}
        except (ImportError, AttributeError):  # it names classes that have moved since
            return {}

    def _load_data(self, name: str) -> Any:
        if not sound(self._data_path(name)):
            raise OSError(f"{name} is damaged")  # to numba: there is none
        return super()._load_data(name)

    @contextmanager
    def _open_for_write(self, path: str) -> Iterator[io.BytesIO]:
        content = io.BytesIO()
        yield content
        data = content.getvalue()
        with super()._open_for_write(path) as file:
            file.write(data + hashlib.sha256(data).digest())


class _Folder(Locator):  # type: ignore[misc, valid-type, unused-ignore]
    """The folder that `kernels.kernel` names, read even where none may write; numba's interface.

    Its name changes with every kernel, so that neither the place nor the age of a source counts:
    all environments of a user share the machine code of one version.
    """

    def __init__(self, function: Any, file: str) -> None:
        super().__init__(function, file)
        self._cache_path = str(Path(config.CACHE_DIR, function.__module__))

    def get_source_stamp(self) -> str:
        return ""

    @classmethod
    def from_function(cls, function: Any, file: str) -> "_Folder | None":
        return cls(function, file) if config.CACHE_DIR else None


class _Place(CompileResultCacheImpl):  # type: ignore[misc, unused-ignore]
    """That folder and no other; an interface of numba."""

    _locator_classes = [_Folder]


class _Kept(FunctionCache):  # type: ignore[misc, unused-ignore]
    """The kept machine code of a kernel; an interface of numba."""

    _impl_class = _Place

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = _Files(self._cache_path, self._impl.filename_base, stamp)

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep machine code; say so where the system refuses."""
        try:
            super().save_overload(signature, compiled)
        except OSError as refused:
            say(UNKEPT.format(config.CACHE_DIR, refused.strerror))


def _kernel(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator that compiles by numba's options and keeps what is compiled."""

    def decorate(function: Callable[..., Any]) -> Any:
        dispatcher = njit(no_cfunc_wrapper=True, **options)(function)
        dispatcher._cache = _Kept(function)
        return dispatcher

    return decorate


entry = _kernel()
inner = _kernel(no_cpython_wrapper=True)
light = _kernel(no_cpython_wrapper=True, error_model="numpy", _nrt=False)
inlined = _kernel(no_cpython_wrapper=True, forceinline=True, error_model="numpy", _nrt=False)


@cache
def _law(function: FunctionType, instead: tuple[tuple[str, Any], ...]) -> Any:
    names = dict(function.__globals__)
    for name in function.__code__.co_names:
        if isinstance(names.get(name), FunctionType):
            names[name] = dict(instead).get(name) or _law(names[name], instead)
    return light(FunctionType(function.__code__, names))


def law(function: Any, instead: dict[str, Any]) -> Any:
    """Return a function of arrays or numbers as a kernel of numbers, with those that it calls.

    They are called by names of their modules. instead: kernels in place of some, by name.
    """
    return _law(function, tuple(instead.items()))
