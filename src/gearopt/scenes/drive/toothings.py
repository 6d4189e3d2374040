"""From the tables of a stage to its teeth: helix, tools, shifts; and where shifts do not fit."""

import itertools
import math
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import LENGTHS, Stage
from gearopt.physics.gears import ISO_53_A, MEMBERS, Rack
from gearopt.scenes.drive.face_widths import excesses
from gearopt.scenes.drive.tables.drive import Gears, ShiftTable, StageTable
from gearopt.scenes.drive.tables.rating import GearTable, with_shared
from gearopt.scenes.reading.choices import Between, Choice, values_of
from gearopt.scenes.reading.fields import refuse

USUAL: dict[str, float] = dict.fromkeys(("profile_shift", "tip_alteration", "tip_chamfer"), 0)
USUAL |= {"addendum": 1, "tool_addendum": 1.25}
SAME = 1e-9  # m_n
ROOT: tuple[str, ...] = ("profile_shift", "tool_addendum")  # what sets a root circle
TIP: tuple[str, ...] = ("profile_shift", "tip_alteration", "addendum")


@lru_cache(64)  # of some thousand ways the same are asked for again and again
def toothings(
    own: StageTable,
    gears: Gears,
    reach: tuple[float, float] = (0.0, 0.0),
    shift: ShiftTable | None = None,
) -> tuple[Toothing, ...]:
    """Return the ways in which the teeth of a stage may be cut: by helix angle, distance and x1.

    reach: ends of the centre distances [mm] that serve, of a series without its own. shift: how
    profile shifts follow from the distances, None: they are given.
    """
    helices = values_of(gears.helix_angle if own.helix_angle is None else own.helix_angle)
    pressure = (own.pressure_angle or gears.pressure_angle).value
    pinion, wheel = with_shared(own.pinion, gears), with_shared(own.wheel, gears)
    first = Toothing(
        helices[0].value,
        (rack(pinion, pressure), rack(wheel, pressure)),
        (_or(pinion.profile_shift, 0.0), _or(wheel.profile_shift, 0.0)),
        (_or(pinion.tip_alteration, 0.0), _or(wheel.tip_alteration, 0.0)),
        (_allowance(pinion), _allowance(wheel)),
        width_excesses=excesses(own, gears),
    )
    distances: list[float | None] = [None]
    shifts: list[float | None] = [None]
    sums: list[float | None] = [None]
    if own.centre_distance is not None:
        distances = [a.value for a in values_of(own.centre_distance, reach)]
    if shift is not None:
        first = replace(first, shifting=shift.shifting)
        if shift.pinion_shift is not None:
            shifts = [float(x1) for x1 in _listed(shift.pinion_shift)]
        if own.centre_distance is None and shift.sum is not None:
            sums = [float(total) for total in _listed(shift.sum)]
    ways = helices[:1] if inclination(own, gears) else helices
    rows = itertools.product([helix.value for helix in ways], distances, shifts, sums)
    return tuple(
        replace(first, helix_angle=helix, working_distance=a, pinion_shift=x1, shift_sum=total)
        for helix, a, x1, total in rows
    )


def _listed(value: Choice) -> tuple[Any, ...]:
    """Values of a choice, of all values of a range the first."""
    return values_of(value)[: 1 if isinstance(value, Between) else None]


def inclination(own: StageTable, gears: Gears) -> tuple[float, float] | None:
    """The least and the greatest helix angle [rad] of a range without a step, if there is one."""
    helix = gears.helix_angle if own.helix_angle is None else own.helix_angle
    return (helix.low.value, helix.high.value) if isinstance(helix, Between) else None


def toothing(own: StageTable, gears: Gears) -> Toothing:
    """Return the teeth of a stage that has no choice; of others the first."""
    return toothings(own, gears)[0]


def rack(gear: GearTable, pressure_angle: float) -> Rack:
    """Return the basic rack of a gear; pressure_angle [rad]."""
    usual = ISO_53_A
    return Rack(
        pressure_angle,
        _or(gear.addendum, usual.addendum),
        _or(gear.tool_addendum, usual.dedendum),
        _or(gear.tool_tip_radius, usual.tip_radius),
        float((gear.tool_protuberance or 0) - (gear.grinding_allowance or 0)),
        _or(gear.tip_chamfer, usual.tip_chamfer),
    )


def _or(value: Fraction | None, usual: float) -> float:
    return usual if value is None else float(value)


def _allowance(gear: GearTable) -> float:
    return gear.thickness_allowance.value if gear.thickness_allowance else 0.0


def check_centre_distances(
    stages: tuple[StageTable, ...],
    gears: Gears,
    lacks: str,
    objective: str,
    asked: str,
    follows: bool = False,
) -> None:
    """Refuse stages off their reference centre distance where the file asks for what assumes it.

    An objective in LENGTHS assumes it where no distance is given, and so does `asked` ("together",
    "process_two" or ""), except at given distances where `follows`: profile shifts follow from
    these. lacks: what the file lacks to choose gears at a given distance, "" for nothing; such a
    distance is refused first. SceneError by `refuse`.
    """
    for k, table in enumerate(stages):
        if table.centre_distance is not None and lacks:
            rule = f"needs gears that are all given, or {lacks}"
            raise refuse(rule, at=("stage", k, "centre_distance"), action="remove")
        given = table.centre_distance is not None
        of_length = objective in LENGTHS and not given
        if not (of_length or asked and not (given and follows)):
            continue
        if not given and toothing(table, gears).on_reference:
            continue
        what = f"minimise = {objective}" if objective in LENGTHS else asked
        rule = f"moves the centre distance, which {what} takes from the reference circles"
        if given:
            raise refuse(rule, at=("stage", k, "centre_distance"), action="remove")
        member = "wheel" if table.pinion.profile_shift is None else "pinion"
        place = ("stage", k, member, "profile_shift")
        raise refuse(rule, "Give shifts whose sum is 0, or none", place, "tell")


def check_follows(k: int, own: StageTable) -> None:
    """Refuse shifts and tips of a stage (from 0) whose centre distance they follow from."""
    for member in MEMBERS:
        for key in ("profile_shift", "tip_alteration"):
            if getattr(getattr(own, member), key) is not None:
                of = (
                    ""
                    if own.centre_distance is None
                    else f"the centre distance of stage {k + 1} and "
                )
                rule = f"follows from {of}[shift]"
                raise refuse(rule, at=("stage", k, member, key), action="remove")


def check_tools(stages: tuple[StageTable, ...], gears: Gears) -> None:
    """Refuse grinding that takes more than the protuberance: it leaves a notch."""
    for k, own in enumerate(stages):
        for member in MEMBERS:
            table, alone = with_shared(getattr(own, member), gears), getattr(own, member)
            depth, juts = table.grinding_allowance or 0, table.tool_protuberance or 0
            if depth > juts:
                rule = f"is above tool_protuberance, {float(juts):g}: grinding would cut a notch"
                tell = f"Write tool_protuberance = {float(depth):g} or more, or remove it"
                place = ("gears",) if alone.grinding_allowance is None else ("stage", k, member)
                raise refuse(rule, tell, (*place, "grinding_allowance"), "tell")


def check_mesh(stage: Stage, k: int, own: StageTable, gears: Gears) -> None:
    """Refuse a stage (from 0) whose fewest teeth have no root, no involute or no centre distance.

    And one whose tips reach into the roots of their mates, whatever the teeth. own, gears: its
    tables.
    """
    _check_tips(stage, k, own, gears)
    for cut in stage.toothings:
        _check_fewest(stage, cut, k, own, gears)


def _check_fewest(stage: Stage, made: Toothing, k: int, own: StageTable, gears: Gears) -> None:
    """Refuse a toothing of a stage (from 0) whose fewest teeth are none, or do not mesh."""
    fewest = stage.pinion_teeth[0]
    teeth = fewest, max(stage.wheel_teeth[0], math.ceil(stage.ratio[0] * fewest))
    pair = made.pair(float(min(stage.modules, default=1)), *teeth, 1.0)
    for member, gear in zip(MEMBERS, pair.gears, strict=True):
        if gear.root_diameter <= 0.0:
            rule, keys = "leaves the root circle of {} teeth no diameter", ROOT
        elif gear.active_tip_diameter <= gear.base_diameter:
            rule, keys = "leaves {} teeth no involute below their tips", (*TIP, "tip_chamfer")
        else:
            continue
        place, write = cause(k, member, own, gears, keys)
        raise refuse(rule.format(gear.teeth), write, place, "sample")
    if math.isfinite(pair.working_angle):
        return
    if made.working_distance is not None:
        rule = f"lets the base circles of {teeth[0]} and {teeth[1]} teeth overlap"
        raise refuse(rule, f"{pair.reference_distance:.3f} mm", ("stage", k, "centre_distance"))
    rule = f"and that of its mate leave no centre distance to {teeth[0]} and {teeth[1]} teeth"
    low = min((0, 1), key=lambda i: made.profile_shifts[i])
    raise refuse(rule, 0, ("stage", k, MEMBERS[low], "profile_shift"))


def _check_tips(stage: Stage, k: int, own: StageTable, gears: Gears) -> None:
    """Refuse tips that reach deeper than the mate's tool cuts: no numbers of teeth mend it.

    c = (y - x1 - x2 + h_fP2 - h_aP1 - k_1) m_n, in which y never exceeds x1 + x2 (ISO 21771).
    """
    racks, shorter = stage.toothing.racks, stage.toothing.tip_alterations
    if stage.toothing.working_distance is not None:
        return
    for i, member in enumerate(MEMBERS):
        deep = racks[i].addendum + shorter[i] - racks[1 - i].dedendum
        if deep <= SAME:
            continue
        long = racks[i].addendum + shorter[i] > USUAL["addendum"]
        which, keys = (member, TIP[1:]) if long else (MEMBERS[1 - i], ROOT[1:])
        place, write = cause(k, which, own, gears, keys)
        rule = f"makes the tips of the {member} reach {deep:.4g} m_n into the roots of its mate"
        raise refuse(f"{rule}, whatever the teeth", write, place, "sample")


def cause(
    k: int, member: str, own: StageTable, gears: Gears, keys: tuple[str, ...]
) -> tuple[tuple[str | int, ...], float]:
    """Return the place of the key that is farthest from its usual value, and that value."""
    table = with_shared(getattr(own, member), gears)

    def away(key: str) -> float:
        value = getattr(table, key, None)
        return 0.0 if value is None else abs(float(value) - USUAL[key])

    key = max(keys, key=away)
    alone = getattr(getattr(own, member), key) is not None
    return ("stage", k, member, key) if alone else ("gears", key), USUAL[key]
