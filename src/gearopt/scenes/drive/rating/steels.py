"""Gears whose steel a file names: what follows from the name, and where it does not fit."""

from fractions import Fraction
from typing import Any

from gearopt.physics import steels
from gearopt.physics.agma.allowables import CURVES, HARDNESS, NITRIDED_CORE
from gearopt.physics.iso6336.materials import LINES
from gearopt.physics.steels import Steel
from gearopt.scenes.drive.rating.iso_material import SOFT_ROOTS
from gearopt.scenes.drive.tables.rating import GearTable
from gearopt.scenes.reading.fields import refuse
from gearopt.units import Quantity

Place = tuple[Any, ...]


def chosen(table: Any) -> Steel | None:
    """The steel that a gear names, in the treatment or class that is beside it.

    Without these the usual one. None: it names none, or the steel has no such treatment.
    """
    rows = steels.named(table.steel) if table.steel else ()
    kind = (table.treatment or "").partition(",")[0]
    fitting = [
        one
        for one in rows
        if one.treatment.startswith(kind)
        and (not table.iso_material or one.iso_material == table.iso_material)
    ]
    return fitting[0] if fitting else None


def of_steel(table: GearTable) -> GearTable:
    """A gear with the keys that follow from its steel, of which it has none of its own."""
    steel = chosen(table)
    if steel is None:
        return table
    named = {
        "treatment": steel.treatment or None,
        "grade": steel.grade,
        "iso_material": steel.iso_material or None,
        "iso_quality": steel.iso_quality,
        **_hardness(steel),
    }
    if table.treatment == SOFT_ROOTS:  # whose roots have no strength in ISO 6336-5
        del named["iso_material"]
    absent = {key: value for key, value in named.items() if getattr(table, key) is None}
    return table.model_copy(update=absent)


def _hardness(steel: Steel) -> dict[str, Quantity]:
    """The least hardness of a steel for which both standards have a strength."""
    name = steel.iso_material.removesuffix(" ferritic")
    lines = [line for line in LINES if line[0] == name and steel.iso_quality in line[2].split("/")]
    lows = [[line[6] for line in lines if line[1] == stress] for stress in ("H", "F")]
    least = max(min(low, default=0.0) for low in lows)
    if not steel.hardened:
        least = max(least, HARDNESS[0] if steel.treatment else 0.0)
        return {"hardness": _within(steel.hardness, least, "HB", "hardness")}
    flank = {"flank_hardness": _within(steel.hardness, least, "HV", "Vickers hardness")}
    if steel.core is None or CURVES.get(steel.treatment) != "nitrided":
        return flank
    least = NITRIDED_CORE.get(steel.treatment, (0.0,))[0]
    return flank | {"hardness": _within(steel.core, least, "HB", "hardness")}


def _within(span: tuple[float, float], least: float, unit: str, dimension: str) -> Quantity:
    """The least hardness of a range that is no less than another one, if it has one."""
    return Quantity(Fraction(min(max(span[0], least), span[1])), unit, dimension)


def check_steel(table: Any, place: Place) -> None:
    """Refuse a steel beside a treatment or class that it does not have."""
    if table.steel is None or chosen(table) is not None:
        return
    rows = steels.named(table.steel)
    key = "iso_material" if table.iso_material else "treatment"
    have = [row.iso_material if table.iso_material else row.treatment for row in rows]
    known = ", ".join(f'"{word}"' for word in dict.fromkeys(filter(None, have)))
    heats = ", ".join(dict.fromkeys(row.heat for row in rows))
    rule = f"does not go with {table.steel}, which is {heats}"
    raise refuse(rule, f"Write {known}, or no steel", (*place, key), "tell")
