"""Materials by name, of which the gears of a stage choose: tables, checks, and a file with one."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field, create_model

from gearopt.physics.gears import MEMBERS
from gearopt.scenes.drive.rating.steels import check_steel, of_steel
from gearopt.scenes.drive.tables.rating import STEEL, GearKeys, GearTable, with_shared
from gearopt.scenes.reading.fields import Table, number, quantity, refuse, words
from gearopt.units import Quantity

MADE = ("quality", "accuracy_grade")  # keys that a material may have, else the gear
PRICE = number(1.5, 0, 10**9, zero=True)
Place = tuple[Any, ...]


class Named(Table):
    """A material by its name; gears choose it by materials."""

    name: Annotated[str, words()] = Field(description="Its name, which materials of gears hold")
    density: Annotated[Quantity | None, quantity("density", "7.85 kg/dm^3")] = Field(
        None, description="Density, for mass and cost; by default that of [objective]"
    )
    price: Annotated[Fraction | None, number(2.5, 0, 10**9)] = Field(
        None, description="Price of a kilogram of finished gear, in any currency; cost needs it"
    )
    treatment_price: Annotated[Fraction, PRICE] = Field(
        default_factory=lambda: Fraction(0),
        description="Price of the heat treatment of a kilogram of finished gear",
        json_schema_extra={"default": 0},
    )
    cutting_price: Annotated[Fraction, PRICE] = Field(
        default_factory=lambda: Fraction(0),
        description="Price of a metre of teeth cut: number of teeth times face width",
        json_schema_extra={"default": 0},
    )


_FIELDS: dict[str, Any] = {
    key: (GearKeys.model_fields[key].annotation, GearKeys.model_fields[key])
    for key in (*STEEL, *MADE)
}
MaterialTable = create_model("MaterialTable", __base__=Named, __doc__=Named.__doc__, **_FIELDS)


def names(own: GearTable, shared: GearKeys) -> tuple[str, ...]:
    """Return the materials that a gear may have; none where its steel is its own or of all."""
    if own.materials is not None:
        return own.materials
    if any(getattr(own, key) is not None for key in STEEL):
        return ()
    return shared.materials or ()


def choices(
    own: GearTable, shared: GearKeys, materials: Sequence[Named]
) -> tuple[tuple[GearTable, Named | None], ...]:
    """Tables of a gear with each material that it may have, and that material."""
    table = with_shared(own, shared)
    table = table.model_copy(update={"materials": None})
    known = {material.name: material for material in materials}
    allowed = [known[name] for name in names(own, shared)]
    if not allowed:
        return ((of_steel(table), None),)
    return tuple(
        (of_steel(table.model_copy(update=_of(material))), material) for material in allowed
    )


def _of(material: Named) -> dict[str, Any]:
    """Keys of a gear by its material: its steel, and its accuracy where it has one."""
    steel = {key: getattr(material, key) for key in STEEL}
    accuracy = {key: getattr(material, key) for key in MADE}
    return steel | {key: value for key, value in accuracy.items() if value is not None}


def check_materials(
    stages: Sequence[tuple[Place, Any]], gears: GearKeys, materials: Sequence[Named]
) -> None:
    """Refuse names twice or unknown, and a steel beside materials.

    stages: their places and tables.
    """
    known = [one.name for one in materials]
    for k, name in enumerate(known):
        if name in known[:k]:
            remedy = f"Rename this one or material[{known.index(name) + 1}]: gears choose by name"
            rule = f"is that of material[{known.index(name) + 1}], too"
            raise refuse(rule, remedy, ("material", k, "name"), "tell")
    for k, one in enumerate(materials):
        check_steel(one, ("material", k))
    for place, table in _tables(stages, gears):
        check_steel(table, place)
        for name in table.materials or ():
            if name not in known:
                remedy = f"Known: {', '.join(known)}" if known else "Write a table [[material]]"
                rule = f'has "{name}", which is the name of no [[material]]'
                raise refuse(rule, remedy, (*place, "materials"), "tell")
        for key in STEEL if table.materials else ():
            if getattr(table, key) is not None:
                rule = "conflicts with materials, which set it"
                raise refuse(rule, at=(*place, key), action="remove")


def check_same(gears: Any, stages: Sequence[Any]) -> None:
    """Refuse the same materials for all stages where gears have none, or none in common."""
    if not gears.same_materials:
        return
    at = ("gears", "same_materials")
    if len(stages) == 1:
        raise refuse("changes nothing: there is one stage", at=at, action="remove")
    free = False
    for member in MEMBERS:
        known = [names(getattr(stage, member), gears) for stage in stages]
        free = free or any(len(found) > 1 for found in known or [gears.materials or ()])
        for k, common in enumerate(known or [gears.materials or ()]):
            if not common:
                place = ("stage", k, member, "materials") if stages else ("gears", "materials")
                raise refuse("is missing: same_materials chooses of the materials of all", at=place)
        if known and not set(known[0]).intersection(*known):
            words = "; ".join(f"stage {k}: {', '.join(own)}" for k, own in enumerate(known, 1))
            rule = f"leaves no material that the {member}s of all stages may have ({words})"
            raise refuse(rule, at=at, action="remove")
    if not free:
        raise refuse("changes nothing: no gear has a choice of materials", at=at, action="remove")


def unused(stages: Sequence[Any], gears: GearKeys, materials: Sequence[Named]) -> list[str]:
    """Return the names of materials that no gear may have."""
    tables = [getattr(stage, member) for stage in stages for member in MEMBERS]
    used = {name for table in tables for name in names(table, gears)}
    return [one.name for one in materials if one.name not in used]


def _tables(
    stages: Sequence[tuple[Place, Any]], gears: GearKeys
) -> Iterator[tuple[Place, GearKeys]]:
    yield ("gears",), gears
    for place, stage in stages:
        yield from (((*place, member), getattr(stage, member)) for member in MEMBERS)
