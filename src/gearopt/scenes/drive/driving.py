"""Which gear drives each stage: the pinion, or the wheel where the speed is increased."""

from typing import TYPE_CHECKING

from gearopt.scenes.drive.rating.checks import check_pinion
from gearopt.scenes.reading.fields import refuse

if TYPE_CHECKING:
    from gearopt.scenes.drive.scene import Scene


def drivers(scene: "Scene") -> tuple[str, ...]:
    """The gear that drives each stage of gears that are given."""
    usual = "wheel" if scene.duty.asks_ratio and scene.duty.total_ratio < 1 else "pinion"
    return tuple(own.driver or usual for own in scene.stage_tables)


def check_driving(scene: "Scene") -> None:
    """Refuse drivers of gears that are chosen, wheels of fewer teeth, what cannot speed up."""
    duty, alone = scene.duty, scene.given and scene.rating is not None and not scene.UNRATED
    if duty.asks_ratio and duty.total_ratio < 1 and (scene.to_size or scene.UNRATED):
        rule = "is below 1: write that of the drive with input and output exchanged"
        raise refuse(rule, float(1 / duty.total_ratio), ("duty", "ratio"))
    for k, own in enumerate(scene.stage):
        if own.driver is not None and (scene.to_size or not alone):
            rule = "is for given gears that are only rated: chosen ones follow the ratio of [duty]"
            rule = "changes nothing: the pinion of a pair drives" if scene.UNRATED else rule
            raise refuse(rule, at=("stage", k, "driver"), action="remove")
        if scene.rating is not None:
            check_pinion(own, k, alone)
