"""From the tables of a file to what physics rates: gear pairs, steels, operations, practice."""

from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.strength.rated import Load
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import GearPair
from gearopt.physics.rating import Operation
from gearopt.physics.shaft_forces import rpm
from gearopt.scenes.drive.rating.materials import Named, choices
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.blanks import blank
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.drive.tables.rating import GearTable, RatingTable
from gearopt.scenes.drive.tables.teeth import toothing

HOUR = 3600.0  # s
Tables = tuple[GearTable, GearTable]  # of pinion and wheel
Blanks = tuple[Blank, Blank]


def own(scene: Scene, stage: int, member: str, material: str = "") -> GearTable:
    """Return what one gear has, of its own or of all gears; stage from 0.

    material: the name of the one that was chosen, where it could choose; SolveError where that is
    open.
    """
    known = gear_choices(scene, stage, member)
    found = [table for table, one in known if len(known) == 1 or (one and one.name == material)]
    if not found:
        names = ", ".join(one.name for _, one in known if one)
        raise SolveError(f"the {member} of stage {stage + 1} has no material yet, one of {names}")
    return found[0]


def gear_choices(
    scene: Scene, stage: int, member: str
) -> tuple[tuple[GearTable, Named | None], ...]:
    """Return what one gear has with each material that it may have, and that material."""
    table = getattr(scene.stage[stage], member) if scene.stage else GearTable()
    return choices(table, scene.gears, scene.material)


def pair_of(
    scene: Scene, stage: int, module: float, teeth: tuple[float, float], face_width: float
) -> GearPair:
    """Return the pair of a stage (from 0) with its shifts, tools and centre distance.

    module, face_width [mm]; teeth of pinion and wheel.
    """
    own = scene.stage[stage] if scene.stage else StageTable()
    return toothing(own, scene.gears).pair(module, *teeth, face_width)


def given_pairs(scene: Scene) -> tuple[GearPair, ...]:
    """Return the pairs of a drive whose gears are all given."""
    found = []
    for k, stage in enumerate(scene.stage):
        assert stage.size and stage.pinion_teeth and stage.wheel_teeth
        teeth = float(stage.pinion_teeth[0]), float(stage.wheel_teeth[0])
        module = float(stage.size[0].exact[0])
        if stage.face_width is not None:
            width = stage.face_width.value
        else:
            span = stage.face_width_over_diameter or scene.gears.face_width_over_diameter
            assert span
            unit = toothing(stage, scene.gears).pair(module, *teeth, 1.0)
            width = float(span[0]) * float(unit.pinion.reference_diameter)
        found.append(pair_of(scene, k, module, teeth, width))
    return tuple(found)


def blanks(scene: Scene, stage: int, gears: Tables, pair: GearPair | None = None) -> Blanks:
    """Return the blanks of the gears of a stage (from 0), whose face width is given, or a pair's.

    gears: what they have.
    """
    given = scene.stage[stage].face_width if scene.stage else None
    width = float(pair.face_width) if pair is not None else given.value if given else None
    return blank(gears[0], width), blank(gears[1], width)


def required_hours(scene: Scene) -> float:
    """Return the life that is asked for [h], at the duty's speed where it is in revolutions."""
    asked = scene.rating
    assert asked
    if asked.life is not None:
        return asked.life.value / HOUR
    assert asked.input_revolutions is not None
    return float(asked.input_revolutions) / (60.0 * rpm(scene.duty.input_speed.value))


def operations(scene: Scene, slower: float, gears: Tables) -> tuple[Operation, ...]:
    """Return what a pair does at every level of load; slower: input over pinion speed."""
    asked, hours = scene.rating, required_hours(scene)
    assert asked
    duty = scene.duty.power.value, scene.duty.input_speed.value / slower
    one = _operation(asked, *duty, hours, gears)
    levels: list[Any] = [
        replace(
            one,
            power=level.power.value,
            pinion_speed=(level.input_speed or scene.duty.input_speed).value / slower,
            hours=hours * float(level.share),
        )
        for level in scene.load
    ]
    return tuple(levels) or (one,)


def unit_operation(scene: Scene, gears: Tables) -> Operation:
    """Return what a pair does at unit power and speed, as what limits its stage takes it."""
    assert scene.rating
    return _operation(scene.rating, 1.0, 1.0, required_hours(scene), gears)


def _operation(
    asked: RatingTable, power: float, speed: float, hours: float, gears: Tables
) -> Operation:
    one = Operation(
        power,
        speed,
        hours,
        float(asked.overload_factor),
        reliability=float(asked.reliability),
        contacts=(float(gears[0].contacts or 1), float(gears[1].contacts or 1)),
    )
    if asked.temperature is None:
        return one
    return replace(one, temperature_C=asked.temperature.value)


def loads(scene: Scene) -> tuple[Load, ...]:
    """Return the levels of load relative to the duty, with their hours."""
    hours, duty = required_hours(scene), scene.duty
    levels = [
        Load(
            hours * float(level.share),
            level.power.value / duty.power.value,
            (level.input_speed or duty.input_speed).value / duty.input_speed.value,
        )
        for level in scene.load
    ]
    return tuple(levels) or (Load(hours),)
