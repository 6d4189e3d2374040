"""Tables of a strain wave gearing: sizes, teeth, flank, clearances, shifts, cutter."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from gearopt.formulations.strain_wave import design as of_design
from gearopt.formulations.strain_wave.cutter_report import EDGE, CutterDesign
from gearopt.formulations.strain_wave.design import INVOLUTE, WaveDesign
from gearopt.report.measures import Measures
from gearopt.report.section import Cell, Table, cell, columns, names_and_values, records
from gearopt.report.words import amount

LAWS = {"involute": "involute of the circular spline"}
SHAPES = {"cosine": "cos 2φ", "ellipse": "ellipse", "discs": "two discs"}
CONTACT = (
    "Where flanks are conjugate: radius on the circular spline, height over the neutral curve, "
    "radii of curvature of flexspline (convex: above 0) and circular spline (concave: above 0), "
    "and R of the contact, 1/R = 1/R_f - 1/R_c."
)


def sizes(design: WaveDesign, measures: Measures) -> Table:
    """Names and values of what the gearing is built from."""
    shape = SHAPES[design.wave_generator]
    if design.wave_generator == "discs":
        shape += f", {design.wrap_angle_deg:g}° each side"
    law = {"law": LAWS.get(design.law, design.law)}
    names = "radius at the tip, convex", "radius at the root, concave", "length of the tangent"
    arcs = dict(zip(names, (*design.arc_radii_mm, design.tangent_mm), strict=False))
    neutral = design.neutral_diameter_mm
    flexspline = {  # before it is bent, and the wave generator in it
        "flexspline, undeformed: tip diameter": neutral + 2.0 * design.tooth_height_mm[-1],
        "root diameter of the flexspline": neutral + design.rim_mm,
        "neutral diameter of the flexspline": neutral,
        "bore of the flexspline": neutral - design.rim_mm,
        "wave generator: major diameter": design.wave_major_mm,
        "minor diameter": design.wave_minor_mm,
    }
    rows = [
        *names_and_values(design, measures, "teeth", law),
        *_lengths(arcs, measures),
        *names_and_values(design, measures, "gearing", {"wave_generator": shape}),
        *_lengths(flexspline, measures),
    ]
    return Table("sizes", ["", ""], rows)


def _lengths(values: Mapping[str, float | None], measures: Measures) -> list[list[Any]]:
    """Rows of lengths [mm] with the digits that they are made by."""
    return [
        [f"{name} [{measures.unit('mm')}]", Cell(measures.of(v, "mm"), measures.short_length(v, 4))]
        for name, v in values.items()
        if v is not None
    ]


def loads(design: WaveDesign, measures: Measures) -> Table:
    """Names and values of what the gearing carries and how hard it is loaded."""
    winds = "teeth, rim and cup" if design.elastic_rim else "the teeth alone, rim rigid"
    labels = {"windup_mrad": f"windup of {winds} [mrad]"}
    rows = names_and_values(design, measures, "loads", labels=labels)
    return Table("loads and stresses", ["", ""], rows)


def teeth(design: WaveDesign, measures: Measures) -> Table:
    """Rows of the teeth near the contact, with what each carries."""
    where = "middle of the arc of contact" if design.law == INVOLUTE else "major axis"
    caption = f"Teeth of one lobe, numbered from the {where}; both are alike."
    return Table("teeth", *records(design.teeth, measures), caption)


def within(design: WaveDesign, measures: Measures) -> Table:
    """Mean numbers of teeth within some clearances."""
    heads = [f"clearance up to [{measures.unit('um')}]", "teeth per lobe and flank"]
    factor = measures.of(1.0, "um") * 1e-3
    rows = [
        [Cell(factor * v, f"{factor * v:g}"), n]
        for v, n in zip(design.within_um, design.teeth_within, strict=True)
    ]
    return Table("teeth within a clearance", heads, rows)


def shifts(design: WaveDesign, measures: Measures) -> Table:
    """Pressures by the profile shift."""
    rows = [replace(r, least_clearance_mm=min(0.0, r.least_clearance_mm)) for r in design.shifts]
    return Table("profile shifts", *records(rows, measures), folded=True)


def deflections(design: WaveDesign, measures: Measures) -> Table:
    """Clearances of the same teeth on a wave generator of another size."""
    caption = (
        "The same teeth on a wave generator of another size: backlash above 0, interference below."
    )
    return Table("other deflections", *records(design.deflections, measures), caption)


def points(design: WaveDesign, measures: Measures) -> list[Table]:
    """Points of the conjugate contact, and of both flanks, to make them by."""
    return [
        columns(design, measures, of_design.CONTACT, caption=CONTACT),
        columns(design, measures, of_design.FLANK, folded=True),
        columns(design, measures, of_design.SPACE, folded=True),
    ]


def over_wave(design: WaveDesign, measures: Measures) -> list[Table]:
    """Clearance, load and pressure of a tooth by its angle on the wave."""
    return [
        columns(design, measures, name, folded=True)
        for name in (of_design.CLEARANCE, of_design.LOAD)
    ]


def rounds(design: WaveDesign, measures: Measures) -> Table:
    """Rounds of the search."""
    heads, rows = records(design.rounds, measures)
    return Table("rounds", ["round", *heads], [[k, *row] for k, row in enumerate(rows, 1)])


def edges(tool: CutterDesign, measures: Measures) -> Table:
    """Straight and circular edges that may replace the exact one."""
    least = ""
    if tool.least_radius_mm:
        least = f" from {amount(tool.least_radius_mm, 'mm', measures)} on"
    radius = cell(tool.arc_radius_mm, "mm", measures)
    each = (
        ("straight, best", tool.straight_deg, None, tool.straight_deviation_mm),
        ("straight, of the tool", tool.given_deg, None, tool.given_deviation_mm),
        (f"circular arc, best found{least}", None, radius, tool.arc_deviation_mm),
    )
    rows = [
        [name, None if deg is None else Cell(deg, f"{deg:.3f}"), arc, cell(off, "um", measures)]
        for name, deg, arc, off in each
    ]
    length, micro = measures.unit("mm"), measures.unit("um")
    heads = ["edge", "angle [°]", f"radius [{length}]", f"largest deviation [{micro}]"]
    caption = "Deviations normal to the edge: the part of the tool's tolerance that is used up."
    return Table("cutting edges", heads, rows, caption)


def edge_points(tool: CutterDesign, measures: Measures) -> Table:
    """Points of the cutting edge."""
    return columns(tool, measures, EDGE, folded=True)
