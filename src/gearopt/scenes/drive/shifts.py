"""What a file asks of teeth that are chosen: sums of profile shifts, their rule, helix angles."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearopt.formulations.drive.root_balance import RootBalance
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import LENGTHS
from gearopt.physics.geometry.profile_shift import ROOT_SAFETY
from gearopt.scenes.drive.rating.options import of_stages
from gearopt.scenes.drive.tables.drive import ShiftTable, StageTable
from gearopt.scenes.reading.choices import Between
from gearopt.scenes.reading.fields import refuse
from gearopt.scenes.reading.toml_writing import exact

if TYPE_CHECKING:
    from gearopt.scenes.drive.scene import Scene

LEAST_HELIX = 1  # deg, of real-valued helix angles
LEAST_RADIUS = 0.1  # m_n, of tools of which shifts are chosen in real values: fillets without a
# radius have no notch parameter to be bounded
MOST_WAYS = 10_000  # helix angles times distances or sums times shifts of a stage


def by_root_safety(shift: ShiftTable | None) -> bool:
    """Whether chosen shifts make both roots equally safe."""
    return shift is not None and shift.pinion_shift is None and shift.rule == ROOT_SAFETY


def balanced(scene: "Scene", own: StageTable, ways: tuple[Toothing, ...]) -> tuple[Toothing, ...]:
    """Ways in which the teeth of a stage may be cut, with the strength of their roots.

    Where shifts follow from that; the speed is the one of equal stage ratios.
    """
    if scene.rating is None or not by_root_safety(scene.shift) or not scene.shifted(own):
        return ways
    tables = scene.stage_tables
    place = next(k for k, table in enumerate(tables) if table is own)
    slower = float(ratio := scene.duty.total_ratio) ** ((place + (ratio < 1)) / len(tables))
    rating = scene.rating, (own,), scene.gears, scene.material, scene.duty, scene.load
    standard = of_stages(*rating)[0][0].standards[-1]
    speed, cut = scene.duty.input_speed.value / slower, ways[0]
    assert cut.shifting is not None
    balance = RootBalance(standard, speed, cut.thickness_allowances)
    return tuple(replace(way, shifting=replace(cut.shifting, balance=balance)) for way in ways)


def check_shift(scene: "Scene", shifted: list[int], lacks: str, asked: str) -> None:
    """Refuse a table [shift] that changes nothing, or that the search does not take.

    shifted: stages (from 0) whose shifts follow from it; lacks: what a file lacks for them; asked:
    what takes reference circles beside the objective, or nothing.
    """
    shift = scene.shift
    if shift is None:
        return
    summed = shift.sum is not None or shift.pinion_shift is not None
    if not shifted and not (summed and any(stage.type == "planetary" for stage in scene.stage)):
        rule = (
            "changes nothing: no gears are chosen at a given centre_distance of a [[stage]], nor "
            "by a sum of profile shifts"
        )
        tell = (
            "Remove it: gears that are all given have profile_shift in [stage.pinion] and "
            "[stage.wheel]"
            if scene.given
            else "Write sum = 0.5 in [shift], or a centre_distance, or remove the table"
        )
        raise refuse(rule, tell, ("shift",), "tell")
    for name in ("rule", "contact_ratio", "tip_thickness", "specific_sliding"):
        if name in shift.model_fields_set and any(stage.epicyclic for stage in scene.stage):
            rule = "is of stages of external gears alone, and is not kept by planets and rings"
            raise refuse(rule, at=("shift", name), action="remove")
    for name in ("pinion_shift", "sum"):
        if isinstance(value := getattr(shift, name), Between):
            check_range(scene, value, ("shift", name))
    if shift.sum is not None:
        real = scene.teeth is None and shift.ranges is not None
        _check_sum(scene, _lacks_of_real(scene) if real else lacks, asked)
    if shift.pinion_shift is not None and "rule" in shift.model_fields_set:
        rule = "changes nothing beside pinion_shift"
        raise refuse(rule, at=("shift", "rule"), action="remove")
    if shift.pinion_shift is not None or shift.sum is not None:
        _check_ways(scene, shifted)
    if by_root_safety(shift) and (scene.load or scene.material):
        name = "load" if scene.load else "material"
        rule = f"needs one load and one material of each gear, without [[{name}]]"
        raise refuse(rule, "equal sliding", ("shift", "rule"), "sample")


def _check_sum(scene: "Scene", lacks: str, asked: str) -> None:
    """Refuse sums of shifts where no search chooses gears by them."""
    given = next((k for k, t in enumerate(scene.stage) if t.centre_distance is not None), None)
    if given is not None:
        rule = f"follows from the centre distance of stage {given + 1}"
        raise refuse(rule, at=("shift", "sum"), action="remove")
    lacks = lacks or ("one number of stages" if scene.several else "")
    if any(any(scene.toothings(own)[0].thickness_allowances) for own in scene.stage_tables):
        lacks = lacks or "gears without thickness_allowance"
    if lacks:
        raise refuse(f"needs {lacks}", at=("shift", "sum"), action="remove")
    aim = scene.objective.minimise
    if aim in LENGTHS or asked:
        what = f"minimise = {aim}" if aim in LENGTHS else asked
        rule = f"moves the centre distance, which {what} takes from the reference circles"
        raise refuse(rule, at=("shift", "sum"), action="remove")


def _check_ways(scene: "Scene", stages: list[int]) -> None:
    """Refuse more ways to cut the teeth of stages (from 0) than are looked at."""
    assert scene.shift is not None
    ways = max((len(scene.toothings(scene.stage_tables[k])) for k in stages), default=0)
    if ways > MOST_WAYS:
        rule = f"makes {ways:,} ways of cutting a stage with its helix angles and distances"
        tell = f"Give fewer of these, for {MOST_WAYS:,} ways at most"
        key = "sum" if scene.shift.pinion_shift is None else "pinion_shift"
        raise refuse(rule, tell, ("shift", key), "tell")


def _lacks_of_real(scene: "Scene") -> str:
    """What a file lacks for ranges of teeth of real-valued sizes; "" for nothing."""
    if scene.given:
        return "gears that are to be chosen: these are all given"
    if scene.teeth is not None:
        return "real-valued sizes, without a table [teeth] (or give a step)"
    if not scene.rated_real or scene.limits.loaded:
        return "limits by [rating] alone, one load and one material of each gear"
    if scene.several:
        return "one number of stages"
    if any(blank.has_web or blank.bore for both in scene.blanks for blank in both):
        return "solid gears: no bore, hub, rim or web"
    tools = [cut for own in scene.stage_tables for cut in scene.toothings(own)[:1]]
    if scene.shift and any(r.tip_radius < LEAST_RADIUS for cut in tools for r in cut.racks):
        return f"tools with a tip radius of {LEAST_RADIUS:g} m_n or more"
    return ""


def check_range(scene: "Scene", value: Between, place: tuple[str | int, ...]) -> None:
    """Refuse all values of a range where no search of real-valued sizes chooses of them."""
    of_shifts, shift = place[0] == "shift", scene.shift
    if of_shifts and scene.teeth is None and shift is not None and shift.ranges is None:
        other = "sum" if place[1] == "pinion_shift" else "pinion_shift"
        rule = f"is a range without a step, which needs {other} as a number or such a range, too"
        tell = f"Write, for example, {other} = {{ from = 0, to = 0.5 }}"
        raise refuse(rule, tell, place, "tell")
    if lacks := _lacks_of_real(scene):
        rule = f"is a range without a step, which needs {lacks}"
        first = exact(value.low) if of_shifts else str(value.low)
        raise refuse(rule, first, place, "sample")
    if not of_shifts and value.low.value < math.radians(LEAST_HELIX):
        rule = f"begins below {LEAST_HELIX} deg: spur gears are rated by laws of their own"
        way = f'Write, for example, {{ from = "{LEAST_HELIX} deg", to = "30 deg" }}'
        raise refuse(rule, way, place, "tell")
