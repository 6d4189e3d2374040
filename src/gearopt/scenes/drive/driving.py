"""Which gear drives each stage: the pinion, or the wheel where the speed is increased."""

from fractions import Fraction
from typing import TYPE_CHECKING

from gearopt.scenes.drive.rating.checks import check_pinion
from gearopt.scenes.parts import Duty
from gearopt.scenes.reading.fields import refuse

if TYPE_CHECKING:
    from gearopt.formulations.drive.design import DriveDesign
    from gearopt.formulations.drive.train import Train
    from gearopt.scenes.drive.scene import Scene

REDUCING = "is for drives that reduce the speed"
MIRRORED = (
    ", as the mirrored one does: ratio = {:.6g}, the output's speed at its input, stages reversed"
)
ABOUT_1 = (
    ", and ratio_tolerance lets this one increase it: ask for a larger ratio, or less tolerance"
)


def drivers(scene: "Scene") -> tuple[str, ...]:
    """The gear that drives each stage of gears that are given."""
    usual = "wheel" if scene.duty.asks_ratio and scene.duty.total_ratio < 1 else "pinion"
    return tuple(own.driver or usual for own in scene.stage_tables)


def driven(scene: "Scene", design: "DriveDesign") -> "Scene":
    """A drive whose stages are driven as those of a design."""
    rows = zip(scene.stage_tables, design.stages, strict=True)
    stages = tuple(own.model_copy(update={"driver": stage.driver}) for own, stage in rows)
    return scene.model_copy(update={"stage": stages})


def may_drive(scene: "Scene") -> tuple[str, ...]:
    """What may drive all stages of a drive: both where its ratio may be above 1 and below."""
    low, high = ends(scene.duty) if scene.duty.asks_ratio else (1, 1)
    return ("pinion",) * (low >= 1 or high > 1) + ("wheel",) * (low < 1)


def driving_words(scene: "Scene") -> list[str]:
    """A sentence on what drives, where that may be the wheel."""
    members = may_drive(scene)
    if members == ("wheel",) and any(stage.epicyclic for stage in scene.stage):
        places = dict[str, list[int]]()
        for k, stage in enumerate(scene.stage, 1):
            outer = "ring" if stage.held == "carrier" or not stage.counts[0] else "carrier"
            places.setdefault(outer if stage.epicyclic else "wheel", []).append(k)
        stages = (
            f"in stage{'s' * (len(ks) > 1)} {' and '.join(map(str, ks))} by the {member}"
            for member, ks in places.items()
        )
        return [f"Every stage increases the speed, driven {', '.join(stages)}."]
    if members == ("wheel",):
        return ["Every stage increases the speed: its wheel, the larger gear, drives."]
    if len(members) > 1:
        return ["Every stage reduces the speed, or every one increases it; both were searched."]
    return []


def ends(duty: Duty) -> tuple[Fraction, Fraction]:
    """Ends of the total ratio, input over output speed."""
    within = duty.ratio_tolerance
    return duty.total_ratio * (1 - within), duty.total_ratio * (1 + within)


def largest_ratio(duty: Duty) -> Fraction:
    """The largest ratio of wheel to pinion teeth that a stage may have."""
    low, high = ends(duty)
    return max(1 / low, high)


def trains(scene: "Scene") -> tuple["Train", ...]:
    """The drives of which one with one number of stages is the best."""
    return tuple(map(scene.train, may_drive(scene)))


def ratio_of(duty: Duty, driver: str) -> Fraction:
    """The ratio of a train of the same tolerance; of wheels output over input speed."""
    of_wheels = 1 / (duty.total_ratio * (1 - duty.ratio_tolerance**2))
    return duty.total_ratio if driver == "pinion" else of_wheels


def check_driving(scene: "Scene") -> None:
    """Refuse drivers of gears that are chosen, wheels of fewer teeth, what cannot speed up."""
    duty, alone = scene.duty, scene.given and scene.rating is not None and not scene.UNRATED
    if scene.UNRATED and duty.asks_ratio and duty.total_ratio < 1:
        rule = "is below 1, and the pinion of a pair drives"
        at = ("duty", "ratio" if duty.output_speed is None else "output_speed")
        raise refuse(rule, at=at, action="remove")
    members = may_drive(scene) if scene.to_size else ()
    for name in ("layout", "process_one", "process_two") if "wheel" in members else ():
        if getattr(scene, name) is not None:
            why = ABOUT_1 if len(members) > 1 else MIRRORED.format(float(1 / duty.total_ratio))
            raise refuse(REDUCING + why, at=(name,), action="remove")
    for k, own in enumerate(scene.stage):
        if own.driver is not None and (scene.to_size or not alone):
            rule = "is for given gears that are only rated: chosen ones follow the ratio of [duty]"
            rule = "changes nothing: the pinion of a pair drives" if scene.UNRATED else rule
            raise refuse(rule, at=("stage", k, "driver"), action="remove")
        if scene.rating is not None:
            check_pinion(own, k, alone, any(near.idler for near in scene.stage[k : k + 2]))
