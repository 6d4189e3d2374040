"""Modules in problem files: in mm, or as diametral pitches in 1/in; and their standard series."""

from typing import Any

from gearopt.physics.gears import DIAMETRAL_PITCHES, MODULES
from gearopt.scenes.reading.fields import Reads, quantity, refuse
from gearopt.scenes.reading.lists import either
from gearopt.units import Quantity

LARGEST_IN_INCHES = 25.4  # mm; beyond it the number is a diametral pitch


def module() -> Reads:
    """Read a normal module, or a diametral pitch; one of many inches is asked back."""
    length = quantity("module", "2 mm", "1 m")

    def read(value: Any, example: Any) -> Quantity:
        size: Quantity = length.reader(value, example)
        if size.unit in ("in", "ft") and size.value > LARGEST_IN_INCHES:
            number = f"{float(size.number):.12g}"
            rule = f"is a module of {size.value:.4g} mm"
            way = f'Write "{number} 1/in" for a diametral pitch of {number}'
            raise refuse(rule, way, action="tell")
        return size

    return Reads(read, length.example, length.schema)


MODULE = module()
FAMILIES = (("ISO 54 I", "ISO 54 I+II"), ("DP coarse", "DP coarse+fine"))  # the larger one last
SERIES: dict[str, tuple[Quantity, ...]] = {
    **{name: tuple(Quantity(m, "mm", "module") for m in s) for name, s in MODULES.items()},
    **{
        name: tuple(Quantity(p, "1/in", "module") for p in s)
        for name, s in DIAMETRAL_PITCHES.items()
    },
}


def series(item: Reads = MODULE) -> Reads:
    """Read a standard series by its name, or a list of modules, as quantities in its order."""
    return either(SERIES, item)


def series_of(found: tuple[Quantity, ...]) -> str:
    """Return the name of the series that a list is; "" for a list of the file's own."""
    return next((name for name, series in SERIES.items() if series == found), "")


def unverified(found: tuple[Quantity, ...]) -> list[str]:
    """Sentences on a series: which source it has."""
    name = series_of(found)
    words = f"The diametral pitches of {name} are those of textbooks (unverified by a standard)."
    return [words] if name in DIAMETRAL_PITCHES else []


def family(found: tuple[Quantity, ...]) -> tuple[str, str]:
    """Return the names of the standard series of the kind of unit of most modules of a list."""
    pitches = sum(m.reciprocal for m in found)
    return FAMILIES[2 * pitches > len(found)]
