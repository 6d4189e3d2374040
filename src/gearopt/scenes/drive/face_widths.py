"""Face widths in the tables of a drive: how they fit together, and how one is chosen."""

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from gearopt.formulations.drive.train import FaceWidth
from gearopt.physics.gears import MEMBERS
from gearopt.physics.geometry.profile_shift import ROOT_SAFETY
from gearopt.scenes.drive.tables.drive import Gears, StageTable
from gearopt.scenes.reading.fields import refuse
from gearopt.units import Quantity

if TYPE_CHECKING:
    from gearopt.scenes.drive.scene import Scene


def fixed_width(own: StageTable) -> Quantity | None:
    """Face width of a mesh that is given: that of the narrower gear."""
    first, second = (gear.face_width or own.face_width for gear in (own.pinion, own.wheel))
    return first and second and min(first, second, key=lambda width: width.value)


def excesses(own: StageTable, gears: Gears) -> tuple[float, float]:
    """By how much [mm] pinion and wheel are wider than their mesh."""
    width = fixed_width(own)
    if width is not None and _own_widths(own):
        each = (gear.face_width or own.face_width or width for gear in (own.pinion, own.wheel))
        first, second = (one.value - width.value for one in each)
        return first, second
    excess = own.pinion_face_width_excess or gears.pinion_face_width_excess
    return excess.value if excess else 0.0, 0.0


def check_excess(scene: "Scene", lacks: str) -> None:
    """Refuse gears wider than their mesh where that is not known; lacks: what they need, or ""."""
    layout, shift, free = scene.layout, scene.shift, scene.given and not scene.to_size
    together, balanced = layout and layout.together, shift and shift.rule == ROOT_SAFETY
    rules = {
        "needs a table [rating]": scene.rating is None,
        f"needs {lacks}": bool(lacks) and not free,
        "does not go together with the layout, whose bounds take one width of a stage": together,
        f"changes S_F1/S_F2 with the width; the rule {ROOT_SAFETY} takes one of all": balanced,
    }
    for k, own in enumerate(scene.stage_tables):
        key, alone = "pinion_face_width_excess", _own_widths(own)
        at = ("stage", k) if alone or getattr(own, key) is not None else ("gears",)
        place: tuple[Any, ...] = (*at, alone[0], "face_width") if alone else (*at, key)
        if alone and not free:
            rule = "is for gears that are all given and rated alone"
            raise refuse(rule, f"Write {key}: the pinion is wider by it", place, "tell")
        for rule, wrong in rules.items() if any(excesses(own, scene.gears)) else ():
            if wrong:
                raise refuse(rule, at=place, action="remove")


def _own_widths(own: StageTable) -> list[str]:
    """Gears of a stage whose face width is given alone."""
    return [member for member in MEMBERS if getattr(own, member).face_width is not None]


def _check_own(own: StageTable, place: tuple[Any, ...]) -> None:
    """Check face widths of single gears: of both, or beside that of the stage."""
    alone = _own_widths(own)
    if alone and fixed_width(own) is None:
        other = MEMBERS[1 - MEMBERS.index(alone[0])]
        rule = "is missing (or give the stage a face_width)"
        raise refuse(rule, "40 mm", (*place, other, "face_width"), "sample")
    for key in ("pinion_face_width_excess", "face_width")[: len(alone)]:
        if getattr(own, key) is not None:
            rule = "conflicts with the face widths of its gears"
            raise refuse(rule, at=(*place, key), action="remove")


def check_width(own: StageTable, gears: Gears, place: tuple[Any, ...]) -> None:
    """Check that one rule sets the face width, and that it is a range where one is needed."""
    key = (*place, "face_width_over_diameter")
    _check_own(own, place)
    if fixed_width(own) is not None:
        if own.face_width_step is not None:
            raise refuse(
                "conflicts with face_width, which fixes the width",
                at=(*place, "face_width_step"),
                action="remove",
            )
        span = own.face_width_over_diameter
        if span is not None and span[0] == span[1]:
            raise refuse(
                "conflicts with face_width: only a range can limit a fixed width",
                [float(span[1] / 2), float(span[1])],
                key,
            )
        return
    step = own.face_width_step or gears.face_width_step
    span = own.face_width_over_diameter or gears.face_width_over_diameter
    if span is None:
        ways = " (or give face_width, or set it in [gears])" if place[0] == "stage" else ""
        raise refuse(f"is missing{ways}", 0.6 if step is None else None, key)
    if step is not None and span[0] == span[1]:
        raise refuse(
            "ties the width, so that it cannot keep to face_width_step: give a range",
            [float(span[0] / 2), float(span[1])],
            key,
        )


def face_width(own: StageTable, gears: Gears) -> FaceWidth:
    """Return how the face width of a stage is chosen, by its own table and that of all."""
    proportion = own.face_width_over_diameter
    least = own.minimum_face_width or gears.minimum_face_width
    limits: dict[str, Any] = {
        "over_module": own.face_width_over_module or gears.face_width_over_module or (None, None),
        "least": least.exact[0] if least else Fraction(0),
    }
    if (fixed := fixed_width(own)) is not None:
        low, high = proportion or (Fraction(0), None)
        return FaceWidth(low, high, fixed=fixed.exact[0], **limits)
    span = proportion or gears.face_width_over_diameter
    assert span is not None  # checked by `check_width`
    step = own.face_width_step or gears.face_width_step
    return FaceWidth(span[0], span[1], step=step.exact[0] if step else None, **limits)
