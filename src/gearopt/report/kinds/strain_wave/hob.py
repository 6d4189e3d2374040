"""A straight-sided hob of the flexspline in its blank, and the teeth that it cuts."""

import math
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.cutter_report import (
    CUT,
    CUT_CLEARANCE,
    DEFORMED,
    CutterDesign,
)
from gearopt.formulations.strain_wave.design import WaveDesign
from gearopt.physics.strain_wave.neutral_curve import whole_curve
from gearopt.physics.strain_wave.straight_hob import round_blank
from gearopt.physics.strain_wave.vectors import Vector, polar
from gearopt.report.drawing.sheet import SHEET, Drawing, Sheet, Window, series
from gearopt.report.kinds.strain_wave.motion import SERIES_OF_BODIES, drawn
from gearopt.report.measures import Measures
from gearopt.report.section import Table, columns, side_by_side
from gearopt.report.words import amount, number

TEETH = 2  # of the blank on either side of the major axis
CAPTION = (
    "Play: of one side, without load, normal to the flanks, at the position of the wave generator "
    "where it is largest. Contact pressure: of Hertz's line contact, with 1/R at the pose at which "
    "the conjugate flank touches; none where the tooth of the largest load mostly touches at an "
    "end of a flank."
)


def words(tool: CutterDesign, measures: Measures) -> tuple[str, ...]:
    """What the hob is, how it is set, and how near its teeth come to conjugate ones."""
    angle = number(tool.given_deg)
    if not tool.regular:
        return (
            f"No such hob: a straight edge of {angle}° cuts no flank from root to tip on this "
            "blank. Another [cutter] tool_angle may do.",
        )
    blank = "the blank as the wave generator deforms it"
    if tool.generation != DEFORMED:
        relief = f", relieved by {amount(tool.tip_relief_mm, 'um', measures)} at the tip"
        blank = f"the round blank: an involute{relief if tool.tip_relief_mm else ''}"
    return (
        f"A straight-sided hob of {angle}° and the module of the gearing cuts {blank}. It is fed "
        "in until its teeth touch the circular spline at one position of the wave: its reference "
        f"line is then {measures.length(tool.reference_radius_mm, 4)} {measures.lengths} from the "
        "axis of the blank.",
        "The teeth as cut lie within the conjugate flank by up to "
        f"{amount(max(tool.cut_within_mm), 'um', measures)}. The loads and clearances above are "
        "those of conjugate teeth; the table compares them with the teeth as cut.",
    )


def tables(tool: CutterDesign, measures: Measures) -> list[Table]:
    """Conjugate teeth beside those that are cut; points and clearances of the latter."""
    heads, rows = ["", "conjugate", "as cut"], side_by_side(tool.forms, measures)
    forms = Table("teeth as cut", heads, rows, CAPTION)
    return [forms, *(columns(tool, measures, n, folded=True) for n in (CUT, CUT_CLEARANCE))]


def mesh(design: WaveDesign, tool: CutterDesign, measures: Measures) -> Drawing:
    """Draw the hob's teeth in the spaces of its blank, the major axis upright, to scale."""
    shape, pitch = drawn(design), math.pi * design.module_mm
    curve = shape.curve if tool.generation == DEFORMED else round_blank(shape.gearing)
    turn, rim = 2.0 * math.pi / design.flexspline_teeth, 0.5 * design.rim_mm
    ring = whole_curve(curve, turn * np.linspace(-TEETH - 0.5, TEETH + 0.5, 41))
    inner, outer = (_along(*ring, level) for level in (-rim, rim))
    out, half = np.array(tool.x_mm) + tool.reference_radius_mm, np.array(tool.y_mm)
    top, wide = float(out.max()) + 0.5 * design.module_mm, (TEETH + 0.5) * pitch
    window = Window(-wide, wide, float(inner[:, 1].min()), top)
    sheet = Sheet(window, (SHEET - 48.0) / (2.0 * wide))
    _shape(sheet, np.vstack([inner, outer[::-1]]), SERIES_OF_BODIES[0], "rim of the blank")
    height, across = np.r_[rim, tool.cut_height_mm], np.r_[tool.cut_half_mm[0], tool.cut_half_mm]
    for k in range(-TEETH, TEETH + 1):
        foot = whole_curve(curve, np.array([turn * k]))
        sides = _along(*foot, height, across), _along(*foot, height, -across)[::-1]
        _shape(sheet, np.vstack(sides), SERIES_OF_BODIES[0], "tooth of the blank, as cut")
    beyond = half[-1] - math.tan(math.radians(tool.given_deg)) * (top - out[-1])
    side = np.c_[np.r_[half, max(beyond, 0.0)], np.r_[out, top]]
    for k in range(-TEETH, TEETH):
        other = side[::-1] * (-1.0, 1.0) + ((k + 1) * pitch, 0.0)
        _shape(sheet, np.vstack([side + (k * pitch, 0.0), other]), 6, "tooth of the hob")
    caption = (
        "The hob in its blank, with the active part of its edge; it moves along the tangent at the "
        f"top by one pitch of {amount(pitch, 'mm', measures)} for each tooth that passes."
    )
    return sheet.drawing("hob in its blank", caption)


def _along(place: Vector, normal: Any, out: Any, across: Any = 0.0) -> Any:
    """Points (n, 2) out and across from places on the neutral curve, upright."""
    axle = polar(1.0, normal)
    point = place + axle * out + axle.left * across
    return np.c_[-point.y, point.x]


def _shape(sheet: Sheet, points: Any, colour: int, title: str) -> None:
    path = " L ".join(f"{u:.2f} {v:.2f}" for u, v in (sheet.at(*p) for p in points.tolist()))
    sheet.shape(f"M {path} Z", "tip", series(colour), title)
