"""Face widths in the tables of a drive: how they fit together, and how one is chosen."""

from fractions import Fraction
from typing import Any

from gearopt.formulations.drive.train import FaceWidth
from gearopt.scenes.drive.tables.drive import Gears, StageTable
from gearopt.scenes.reading.fields import refuse


def check_width(own: StageTable, gears: Gears, place: tuple[Any, ...]) -> None:
    """Check that one rule sets the face width, and that it is a range where one is needed."""
    key = (*place, "face_width_over_diameter")
    if own.face_width is not None:
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
    if own.face_width is not None:
        low, high = proportion or (Fraction(0), None)
        return FaceWidth(low, high, fixed=own.face_width.exact[0], **limits)
    span = proportion or gears.face_width_over_diameter
    assert span is not None  # checked by `check_width`
    step = own.face_width_step or gears.face_width_step
    return FaceWidth(span[0], span[1], step=step.exact[0] if step else None, **limits)
