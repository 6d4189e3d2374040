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
from gearopt.physics.strain_wave.vectors import Vector
from gearopt.report.drawing.sheet import SHEET, Drawing, Sheet, Window, series
from gearopt.report.kinds.strain_wave.motion import SERIES_OF_BODIES, drawn
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure, axis, layout, lines
from gearopt.report.section import Table, columns, side_by_side
from gearopt.report.words import amount, number

TEETH = 2  # of the hob on either side of the major axis
NEAR_DEG = 25.0  # of the wave on either side, of the plot of clearances
HEADS = ["", "conjugate", "as cut"]
NO_FLANK = (
    "No such hob: a straight edge of {}° cuts no flank from root to tip on this blank. Another "
    "[cutter] tool_angle may do."
)


def words(tool: CutterDesign, measures: Measures) -> tuple[str, ...]:
    """What the hob is, how it is set, and how near its teeth come to conjugate ones."""
    if not tool.regular:
        return (NO_FLANK.format(number(tool.given_deg)),)
    blank = "the blank as the wave generator deforms it"
    if tool.generation != DEFORMED:
        relief = f", relieved by {amount(tool.tip_relief_mm, 'um', measures)} at the tip"
        blank = f"the round blank: an involute{relief if tool.tip_relief_mm else ''}"
    setting = amount(tool.reference_radius_mm, "mm", measures)
    off = amount(max(tool.cut_within_mm), "um", measures)
    at_ends = (
        "The tooth of the largest load mostly touches at an end of its flank, as cut: that is no "
        "line contact, and no contact pressure is computed.",
    )
    return (
        f"A straight-sided hob of {number(tool.given_deg)}° and the module of the gearing cuts "
        f"{blank}. It is fed in until its teeth touch the circular spline at one position of the "
        f"wave: its reference line is then {setting} from the axis of the blank.",
        f"The teeth as cut lie within the conjugate flank by up to {off}. The loads and clearances "
        "above are those of conjugate teeth; the table compares them with the teeth as cut.",
        *(at_ends if tool.forms[-1].shared_pressure_MPa is None else ()),
    )


def forms(tool: CutterDesign, measures: Measures) -> Table:
    """Conjugate teeth beside those that are cut."""
    caption = (
        "Play: of one side, without load, normal to the flanks, at the position of the wave "
        "generator where it is largest. Contact pressure: of Hertz's line contact, with 1/R of the "
        "nearest pose of contact within the flanks; none where the tooth of the largest load "
        "mostly touches at an end of a flank."
    )
    return Table("teeth as cut", HEADS, side_by_side(tool.forms, measures), caption)


def points(tool: CutterDesign, measures: Measures) -> list[Table]:
    """Points of the flank that is cut, and clearances of its teeth over the wave."""
    return [columns(tool, measures, name, folded=True) for name in (CUT, CUT_CLEARANCE)]


def figures(design: WaveDesign, tool: CutterDesign, measures: Measures) -> list[Figure]:
    """Plot clearances of both forms near the major axis, and how far the flank is cut away."""
    factor, unit = measures.of(1.0, "um"), measures.unit("um")
    each = (
        ("conjugate", design.wave_angle_deg, design.wave_clearance_mm, 1),
        ("as cut", tool.cut_wave_deg, tool.cut_clearance_mm, 4),
    )
    curves = []
    for name, angles, gaps, colour in each:
        x, y = np.array(angles), factor * np.array(gaps)
        near = np.abs(x) <= NEAR_DEG
        curves.append(lines(x[near], y[near], series(colour), name=name, hover="%{y:.4g}"))
    plot = layout(
        axis("angle of the tooth on the wave [°]"), axis(f"clearance [{unit}]"), hovermode="x"
    )
    plot["margin"] |= {"t": 34}
    caption = "Least clearance of a tooth by its place on the wave, of conjugate teeth and as cut."
    height = measures.of(1.0, "mm") * np.array(tool.cut_height_mm)
    within = lines(height, factor * np.array(tool.cut_within_mm), series(4), hover="%{y:.4g}")
    across = axis(f"height over the neutral curve [{measures.unit('mm')}]")
    flank = layout(across, axis(f"within the conjugate flank [{unit}]"), hovermode="x")
    told = "How far the flank as cut lies within the conjugate one, normal to it."
    return [Figure(curves, plot, caption), Figure([within], flank, told)]


def mesh(design: WaveDesign, tool: CutterDesign, measures: Measures) -> Drawing:
    """Draw the hob's teeth in the spaces of its blank, the major axis upright, to scale."""
    shape, pitch = drawn(design), math.pi * design.module_mm
    curve = shape.curve if tool.generation == DEFORMED else round_blank(shape.gearing)
    out, half = np.array(tool.x_mm) + tool.reference_radius_mm, np.array(tool.y_mm)
    rim = 0.5 * design.rim_mm
    ring = 2.0 * math.pi * np.linspace(-TEETH - 0.5, TEETH + 0.5, 41) / design.flexspline_teeth
    inner, outer = (_along(*whole_curve(curve, ring), level) for level in (-rim, rim))
    top, wide = float(out.max()) + 0.5 * design.module_mm, (TEETH + 0.5) * pitch
    window = Window(-wide, wide, float(inner[:, 1].min()), top)
    sheet = Sheet(window, (SHEET - 48.0) / (2.0 * wide))
    _shape(sheet, np.vstack([inner, outer[::-1]]), SERIES_OF_BODIES[0], "rim of the blank")
    height, across = np.array(tool.cut_height_mm), np.array(tool.cut_half_mm)
    side = np.c_[np.r_[rim, height], np.r_[across[0], across]]
    outline = np.vstack([side, side[::-1] * (1.0, -1.0)])
    for k in range(-TEETH, TEETH + 1):
        place, normal = whole_curve(curve, np.array([2.0 * math.pi * k / design.flexspline_teeth]))
        tooth = _along(place, normal, outline[:, 0], outline[:, 1])
        _shape(sheet, tooth, SERIES_OF_BODIES[0], "tooth of the blank, as cut")
    beyond = half[-1] - math.tan(math.radians(tool.given_deg)) * (top - out[-1])
    side = np.c_[np.r_[half, max(beyond, 0.0)], np.r_[out, top]]
    for k in range(-TEETH, TEETH):
        other = side[::-1] * (-1.0, 1.0) + ((k + 1) * pitch, 0.0)
        _shape(sheet, np.vstack([side + (k * pitch, 0.0), other]), 6, "tooth of the hob")
    caption = (
        "The hob in its blank, the active part of its edge; it moves along the tangent of the "
        f"{'major axis' if tool.generation == DEFORMED else 'round blank'} by one pitch of "
        f"{amount(pitch, 'mm', measures)} for each tooth that passes."
    )
    return sheet.drawing("hob in its blank", caption)


def _along(place: Vector, normal: Any, out: Any, across: Any = 0.0) -> Any:
    """Points (n, 2) out and across from places on the neutral curve, upright."""
    point = place + Vector(np.cos(normal), np.sin(normal)) * out
    point = point + Vector(-np.sin(normal), np.cos(normal)) * across
    return np.c_[-point.y, point.x]


def _shape(sheet: Sheet, points: Any, colour: int, title: str) -> None:
    path = " L ".join(f"{u:.2f} {v:.2f}" for u, v in (sheet.at(*p) for p in points.tolist()))
    sheet.shape(f"M {path} Z", "tip", series(colour), title)
