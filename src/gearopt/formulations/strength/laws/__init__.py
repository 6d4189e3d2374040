"""The strength laws that need nothing but a loaded pair: one file per law, known by being here."""

import pkgutil
from functools import cache
from importlib import import_module

from gearopt.formulations.strength import Law


@cache
def laws() -> tuple[Law, ...]:
    """Return the laws that the files of this folder hold."""
    names = [f"{__name__}.{module.name}" for module in pkgutil.iter_modules(__path__)]
    held = [value for name in names for value in vars(import_module(name)).values()]
    return tuple(value for value in held if isinstance(value, Law) and value.limits)
