"""The ways of making the gears of a stage, each with the rating that limits it."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from typing import Any

from gearopt.formulations.strength.standard import Load, Option
from gearopt.physics.gears import MEMBERS
from gearopt.physics.iso6336.static import static_given, static_operation
from gearopt.scenes.drive.rating.gears import loads, required_hours, unit_operation
from gearopt.scenes.drive.rating.materials import Named, choices
from gearopt.scenes.drive.tables.blanks import blank
from gearopt.scenes.drive.tables.drive import Gears, StageTable
from gearopt.scenes.drive.tables.rating import OF_STAGE, GearTable, LoadTable, RatingTable
from gearopt.scenes.parts import Duty

STANDARDS = {  # of the key standard
    "agma": ("agma",),
    "iso6336": ("iso6336",),
    "both": ("agma", "iso6336"),
}
SECOND = "_iso"  # after the names of limits by the second of two standards
STATIC = "_static"  # after the names of limits on static strength


def by(standard: str) -> Any:
    """The module of a standard, `by_agma` or `by_iso6336`, imported where it is asked for."""
    return import_module(f"{__package__}.by_{standard}")


def of_stages(
    rating: RatingTable,
    stages: Sequence[StageTable],
    gears: Gears,
    materials: Sequence[Named],
    duty: Duty,
    levels: Sequence[LoadTable],
) -> tuple[tuple[Option, ...], ...]:
    """Ways of making the gears of every stage.

    Where all stages have the same materials these alone, in the order of the first stage.
    """
    hours, loaded = required_hours(rating, duty), loads(rating, duty, levels)
    options = []
    for table in stages:
        pinion, wheel = (choices(getattr(table, member), gears, materials) for member in MEMBERS)
        options.append(
            tuple(
                option(of_stage(rating, table), table, (a, b), hours, loaded)
                for a in pinion
                for b in wheel
            )
        )
    if not gears.same_materials:
        return tuple(options)
    named = [{option.materials: option for option in stage} for stage in options]
    shared = [names for names in named[0] if all(names in stage for stage in named)]
    return tuple(tuple(stage[names] for names in shared) for stage in named)


def option(
    rating: RatingTable,
    own: StageTable,
    made: tuple[tuple[GearTable, Named | None], tuple[GearTable, Named | None]],
    hours: float,
    loaded: tuple[Load, ...],
) -> Option:
    """One way of making the gears of a stage; made: the table and the material of each."""
    tables, materials = (made[0][0], made[1][0]), (made[0][1], made[1][1])
    operation = unit_operation(rating, hours, tables)
    width = own.face_width.value if own.face_width else None
    standards = [
        standard.LIMIT(
            loaded,
            operation,
            (standard.steel(tables[0]), standard.steel(tables[1])),
            standard.bare_practice(rating, tables),
            (blank(tables[0], width), blank(tables[1], width)),
            standard.given(rating, own),
        )
        for standard in map(by, STANDARDS[rating.standard])
    ]
    if len(standards) > 1:
        standards[1] = replace(standards[1], suffix=SECOND)
    if rating.static_torque_factor is not None:
        standards.insert(-1, _static(standards[-1], rating, rating.static_torque_factor))
    named = tuple(m.name if m else "" for m in materials)
    densities = tuple(m.density.value if m and m.density else None for m in materials)
    treatments = tuple(float(m.treatment_price) if m else 0.0 for m in materials)
    prices = tuple(
        (1.0 if m is None or m.price is None else float(m.price)) + treatment
        for m, treatment in zip(materials, treatments, strict=True)
    )
    cuttings = tuple(float(m.cutting_price) if m else 0.0 for m in materials)
    words = " and ".join(filter(None, named))
    paid = _two(prices), _two(treatments), _two(cuttings)
    return Option(tuple(standards), words, _two(densities), *paid, _two(named))


def _static(standard: Any, rating: RatingTable, factor: Fraction) -> Any:
    """The rating against static strength beside that by ISO 6336; factor: of the duty's torque."""
    (bending, contact), asked = required(rating), required_static(rating)
    return replace(
        standard,
        loads=(Load(0.0, float(factor)),),
        operation=static_operation(standard.operation, 1.0),
        given=static_given(standard.given),
        suffix=STATIC,
        safety=(asked[0] / bending, asked[1] / contact),
    )


def _two(values: tuple[Any, ...]) -> tuple[Any, Any]:
    return values[0], values[1]


def of_stage(rating: RatingTable, own: StageTable) -> RatingTable:
    """The table [rating] with what a stage has of its own."""
    held = {name: getattr(own, name) for name in OF_STAGE}
    made = rating.model_copy(update={name: v for name, v in held.items() if v is not None})
    share = {} if made.shaft is None else {"pinion_offset": made.shaft.share}
    return made.model_copy(update=share)


def own_safety(own: StageTable) -> tuple[float | None, float | None]:
    """S_F and S_H that a stage asks for itself."""
    bending, contact = own.minimum_bending_safety, own.minimum_contact_safety
    return None if bending is None else float(bending), None if contact is None else float(contact)


def required(rating: RatingTable) -> tuple[float, float]:
    """Safety factors asked for against bending and against pitting."""
    return float(rating.minimum_bending_safety), float(rating.minimum_contact_safety)


def required_static(rating: RatingTable) -> tuple[float, float]:
    """Safety factors asked for of static strength, against bending and of contact."""
    bending, contact = rating.minimum_static_bending_safety, rating.minimum_static_contact_safety
    return float(bending or 1), float(contact or 1)
