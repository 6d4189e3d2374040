"""Factors that a file gives in the place of computed ones, by any standard."""

from typing import Any

from gearopt.scenes.reading.fields import Table
from gearopt.units import Quantity


class Given(Table):
    """Factors instead of computed ones; [pinion, wheel], or one value for both."""

    def factors(self) -> dict[str, Any]:
        """Return the given factors by symbol, as plain numbers in mm and MPa."""
        held = ((name, getattr(self, name)) for name in type(self).model_fields)
        return {name: _plain(value) for name, value in held if value is not None}


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(map(_plain, value))
    return value.value if isinstance(value, Quantity) else float(value)
