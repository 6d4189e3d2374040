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
from gearopt.report.drawing.sheet import SHEET, Drawing, Sheet, Window, series
from gearopt.report.kinds.strain_wave.motion import SERIES_OF_BODIES, drawn
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure, axis, layout, lines
from gearopt.report.section import Table, columns, side_by_side
from gearopt.report.words import amount, number

TEETH = 3  # of the hob on either side of the major axis
DEEP = 2.0  # modules below the teeth that a drawing shows
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
    x, y = np.array(tool.x_mm) + tool.reference_radius_mm, np.array(tool.y_mm)
    low, top = float(x.min()), float(x.max()) + design.module_mm
    wide = (TEETH + 0.5) * pitch
    base = low - DEEP * design.module_mm
    sheet = Sheet(Window(-wide, wide, base, top), (SHEET - 48.0) / (2.0 * wide))
    numbers = np.arange(-TEETH - 1, TEETH + 2)
    place, normal = whole_curve(curve, 2.0 * math.pi * numbers / design.flexspline_teeth)
    rim = 0.5 * design.rim_mm
    half, height = np.array(tool.cut_half_mm), np.array(tool.cut_height_mm)
    side = np.c_[np.r_[rim, height], np.r_[half[0], half]]
    outline = np.vstack([side, side[::-1] * (1.0, -1.0)])
    for k in range(len(numbers)):
        cosine, sine = math.cos(normal[k]), math.sin(normal[k])
        out = place.x[k] + outline[:, 0] * cosine - outline[:, 1] * sine
        across = place.y[k] + outline[:, 0] * sine + outline[:, 1] * cosine
        _shape(sheet, np.c_[-across, out], SERIES_OF_BODIES[0], "tooth of the blank, as cut")
    for k in range(-TEETH - 1, TEETH + 2):
        left = np.c_[y + k * pitch, x]
        right = np.c_[(k + 1.0) * pitch - y, x]
        body = [((k + 1.0) * pitch - y[-1], top), (y[-1] + k * pitch, top)]
        _shape(sheet, np.vstack([left, body[::-1], right[::-1]]), 6, "tooth of the hob")
    caption = (
        "The hob in its blank, the active part of its edge; it moves along the tangent of the "
        f"{'major axis' if tool.generation == DEFORMED else 'round blank'} by one pitch of "
        f"{amount(pitch, 'mm', measures)} for each tooth that passes."
    )
    return sheet.drawing("hob in its blank", caption)


def _shape(sheet: Sheet, points: Any, colour: int, title: str) -> None:
    path = " L ".join(f"{u:.2f} {v:.2f}" for u, v in (sheet.at(*p) for p in points.tolist()))
    sheet.shape(f"M {path} Z", "tip", series(colour), title)
