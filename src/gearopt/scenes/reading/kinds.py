"""Which kinds of problem file there are: the folders of `gearopt.scenes` that describe one."""

from functools import cache
from pkgutil import iter_modules

import gearopt.scenes

SHARED = {"reading", "explaining", "kind", "parts", "plan"}  # of `gearopt.scenes`, what is no kind


def kinds() -> tuple[str, ...]:
    """Return the kinds of problem file: all modules of `gearopt.scenes` but shared ones."""
    return _kinds_in(tuple(gearopt.scenes.__path__))


@cache
def _kinds_in(folders: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(sorted({m.name for m in iter_modules(folders)} - SHARED))
