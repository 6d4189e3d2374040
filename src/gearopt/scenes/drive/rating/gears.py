"""The gears that physics rates, from tables: materials, blanks, operations, levels of load."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive.design import drive_design
from gearopt.formulations.strength.standard import Load
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.rating import Operation
from gearopt.physics.shaft_forces import rpm
from gearopt.scenes.drive.face_widths import fixed_width
from gearopt.scenes.drive.rating.materials import Named, choices
from gearopt.scenes.drive.tables.blanks import blank
from gearopt.scenes.drive.tables.drive import Gears, StageTable
from gearopt.scenes.drive.tables.rating import GearTable, LoadTable, RatingTable
from gearopt.scenes.drive.toothings import toothing
from gearopt.scenes.parts import Duty
from gearopt.scenes.reading.ask import Ask

HOUR = 3600.0  # s
Tables = tuple[GearTable, GearTable]  # of pinion and wheel
Blanks = tuple[Blank, Blank]


def gear_tables(
    own: StageTable,
    shared: Gears,
    materials: Sequence[Named],
    stage: int,
    names: tuple[str, str] = ("", ""),
) -> Tables:
    """Tables of pinion and wheel of a stage (from 0), each with its material.

    names: of the materials that were chosen, where there was a choice; SolveError where it is open.
    """
    tables = []
    for member, name in zip(MEMBERS, names, strict=True):
        known = choices(getattr(own, member), shared, materials)
        fitting = [t for t, m in known if len(known) == 1 or (m and m.name == name)]
        if not fitting:
            words = ", ".join(m.name for _, m in known if m)
            raise SolveError(
                f"the {member} of stage {stage + 1} has no material yet, one of {words}"
            )
        tables.append(fitting[0])
    return tables[0], tables[1]


def given_pairs(stages: Sequence[StageTable], gears: Gears) -> tuple[GearPair, ...]:
    """Gear pairs of stages whose gears are all given."""
    pairs: list[GearPair] = []
    for stage in stages:
        assert stage.size and stage.pinion_teeth and stage.wheel_teeth
        teeth = float(stage.pinion_teeth[0]), float(stage.wheel_teeth[0])
        module, teeth_of = float(stage.size[0].exact[0]), toothing(stage, gears)
        if (fixed := fixed_width(stage)) is not None:
            width = fixed.value
        elif stage.idler:
            width = float(pairs[-1].face_width)
        else:
            span = stage.face_width_over_diameter or gears.face_width_over_diameter
            assert span
            unit = teeth_of.pair(module, *teeth, 1.0)
            width = float(span[0]) * float(unit.pinion.reference_diameter)
        pairs.append(teeth_of.pair(module, *teeth, width))
    return _as_taken(pairs, gears)


def _as_taken(pairs: Sequence[GearPair], gears: Gears) -> tuple[GearPair, ...]:
    """Pairs whose bodies are those of the file that they are taken from, if they are."""
    source, number = map(vars(gears).get, ("from", "stage"))
    if source is None:
        return tuple(pairs)
    stages = drive_design(source.result(Ask()).design).stages
    chosen = stages if number is None else stages[number - 1 :]
    bodied = []
    for pair, stage in zip(pairs, chosen, strict=False):
        rows = zip(pair.gears, stage.bodies, strict=True)
        first, second = (
            g if d == g.reference_diameter else replace(g, body_diameter=d) for g, d in rows
        )
        bodied.append(GearPair(first, second, pair.working_distance))
    return tuple(bodied)


def blanks(tables: Tables, pair: GearPair) -> Blanks:
    """Blanks of the gears of a pair."""
    pinion, wheel = pair.gears
    return blank(tables[0], float(pinion.width)), blank(tables[1], float(wheel.width))


def required_hours(rating: RatingTable, duty: Duty) -> float:
    """Life that is asked for [h], at the duty's speed where it is in revolutions."""
    if rating.life is not None:
        return rating.life.value / HOUR
    assert rating.input_revolutions is not None
    return float(rating.input_revolutions) / (60.0 * rpm(duty.input_speed.value))


def operations(
    rating: RatingTable,
    duty: Duty,
    levels: Sequence[LoadTable],
    slower: float,
    tables: Tables,
    share: float = 1.0,
) -> tuple[Operation, ...]:
    """Operation of a pair at every level of load; slower: input over pinion speed.

    share: part of the power that the mesh transmits.
    """
    hours = required_hours(rating, duty)
    at_duty = share * duty.input_power, duty.input_speed.value / slower
    at_power = _operation(rating, *at_duty, hours, tables)
    each: list[Any] = [
        replace(
            at_power,
            power=share * level.power.value,
            pinion_speed=(level.input_speed or duty.input_speed).value / slower,
            hours=hours * float(level.share),
        )
        for level in levels
    ]
    return tuple(each) or (at_power,)


def unit_operation(rating: RatingTable, hours: float, tables: Tables) -> Operation:
    """Operation of a pair at unit power and speed; hours: the life that is asked for."""
    return _operation(rating, 1.0, 1.0, hours, tables)


def _operation(
    rating: RatingTable, power: float, speed: float, hours: float, tables: Tables
) -> Operation:
    operation = Operation(
        power,
        speed,
        hours,
        float(rating.overload_factor),
        reliability=float(rating.reliability),
        contacts=(float(tables[0].contacts or 1), float(tables[1].contacts or 1)),
    )
    if rating.temperature is None:
        return operation
    return replace(operation, temperature_C=rating.temperature.value)


def loads(rating: RatingTable, duty: Duty, levels: Sequence[LoadTable]) -> tuple[Load, ...]:
    """Levels of load relative to the duty, with their hours."""
    hours = required_hours(rating, duty)
    each = [
        Load(
            hours * float(level.share),
            level.power.value / duty.input_power,
            (level.input_speed or duty.input_speed).value / duty.input_speed.value,
        )
        for level in levels
    ]
    return tuple(each) or (Load(hours),)
