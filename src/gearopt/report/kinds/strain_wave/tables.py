"""Tables of a strain wave gearing: sizes, teeth, flank, clearances, shifts, cutter."""

from collections.abc import Sequence
from typing import Any

from gearopt.formulations.strain_wave.cutter_report import CutterDesign
from gearopt.formulations.strain_wave.report import INVOLUTE, WaveDesign
from gearopt.report.measures import Measures
from gearopt.report.section import Cell, Table, cell
from gearopt.report.words import amount

LAWS = {"involute": "involute of the circular spline"}
SHAPES = {"cosine": "cos 2φ", "ellipse": "ellipse", "discs": "two discs"}


def sizes(found: WaveDesign, measures: Measures) -> Table:
    """Return what the gearing is built from, as names and values."""
    length = measures.unit("mm")
    shape = SHAPES[found.wave_generator]
    if found.wave_generator == "discs":
        shape += f", {found.wrap_angle_deg:g}° each side"
    rows: list[list[Any]] = [
        ["law of the teeth", LAWS.get(found.law, found.law)],
        ["ratio, circular spline at rest", found.ratio],
        ["teeth of the flexspline", found.flexspline_teeth],
        ["teeth of the circular spline", found.circular_spline_teeth],
        [f"module [{length}]", _mm(found.module_mm, measures)],
        ["pressure angle [°]", found.pressure_angle_deg],
        ["profile shift, modules", found.profile_shift],
        ["addendum, modules", found.addendum],
        ["deflection, modules", found.deflection],
        [f"rim [{length}]", _mm(found.rim_mm, measures)],
        [f"thickness at half the height [{length}]", _mm(found.thickness_mm, measures)],
        *_arcs(found, measures),
        ["wave generator", shape],
        [f"face width [{length}]", _mm(found.face_width_mm, measures)],
        [f"outer diameter [{length}]", _mm(found.outer_diameter_mm, measures)],
        [f"circular spline: tip diameter [{length}]", _mm(found.tip_diameter_mm, measures)],
        [f"last active diameter [{length}]", _mm(found.active_diameter_mm, measures)],
        [f"root diameter [{length}]", _mm(found.root_diameter_mm, measures)],
        [f"base diameter [{length}]", _mm(found.base_diameter_mm, measures)],
        *_flexspline(found, measures),
    ]
    return Table("sizes", ["", ""], [row for row in rows if row[1] is not None])


def loads(found: WaveDesign, measures: Measures) -> Table:
    """Return what the gearing carries and how hard it is loaded, as names and values."""
    stress = measures.unit("MPa")
    winds = "teeth, rim and cup" if found.elastic_rim else "the teeth alone, rim rigid"
    rows: list[list[Any]] = [
        ["conjugate pairs per lobe and flank", found.pairs_in_contact],
        ["teeth that carry, per lobe", found.carrying_teeth],
        ["equivalent number, equally loaded", found.effective_teeth],
        [f"windup of {winds} [mrad]", found.windup_mrad],
        [f"pressure, shared loads [{stress}]", cell(found.shared_pressure_MPa, "MPa", measures)],
        [f"pressure, equal loads [{stress}]", cell(found.equal_pressure_MPa, "MPa", measures)],
        [
            f"pressure, whole pairs [{stress}]",
            cell(found.whole_pairs_pressure_MPa, "MPa", measures),
        ],
        [f"bending of the rim [{stress}]", cell(found.rim_bending_MPa, "MPa", measures)],
        [f"shear of the rim [{stress}]", cell(found.rim_shear_MPa, "MPa", measures)],
        [
            f"torque at which teeth ratchet [{measures.unit('Nm')}]",
            cell(found.ratcheting_torque_Nm, "Nm", measures),
        ],
        ["least deflection with contact, modules", found.least_deflection],
    ]
    return Table("loads and stresses", ["", ""], [row for row in rows if row[1] is not None])


def teeth(found: WaveDesign, measures: Measures) -> Table:
    """Return what every tooth near the contact carries."""
    heads = [
        *("tooth", "on the wave [°]", f"clearance [{measures.unit('um')}]"),
        *(f"load [{measures.unit('N')}]", f"pressure [{measures.unit('MPa')}]"),
    ]
    rows = [
        [
            t.tooth,
            Cell(t.wave_angle_deg, f"{t.wave_angle_deg:.3f}"),
            cell(t.clearance_mm, "um", measures),
            cell(t.force_N, "N", measures),
            cell(t.contact_pressure_MPa, "MPa", measures),
        ]
        for t in found.teeth
    ]
    where = "middle of the arc of contact" if found.law == INVOLUTE else "major axis"
    caption = f"Teeth of one lobe, numbered from the {where}; both are alike."
    return Table("teeth", heads, rows, caption)


def within(found: WaveDesign, measures: Measures) -> Table:
    """Return the mean teeth within some clearances."""
    heads = [f"within [{measures.unit('um')}]", "teeth per lobe and flank"]
    factor = measures.of(1.0, "um") * 1e-3
    rows = [
        [Cell(factor * v, f"{factor * v:g}"), n]
        for v, n in zip(found.within_um, found.teeth_within, strict=True)
    ]
    return Table("teeth within a clearance", heads, rows)


def shifts(found: WaveDesign, measures: Measures) -> Table:
    """Return pressures by the profile shift."""
    length, stress = measures.unit("mm"), measures.unit("MPa")
    heads = [
        *("profile shift", "pairs", f"least R [{length}]", f"equal loads [{stress}]"),
        *(f"whole pairs [{stress}]", f"shared loads [{stress}]"),
        f"least clearance [{measures.unit('um')}]",
    ]
    rows = [
        [
            Cell(r.profile_shift, f"{r.profile_shift:g}"),
            r.pairs,
            cell(r.radius_mm, "mm", measures),
            cell(r.equal_MPa, "MPa", measures),
            cell(r.whole_MPa, "MPa", measures),
            cell(r.shared_MPa, "MPa", measures),
            cell(min(0.0, r.least_clearance_mm), "um", measures),
        ]
        for r in found.shifts
    ]
    return Table("profile shifts", heads, rows, folded=True)


def deflections(found: WaveDesign, measures: Measures) -> Table:
    """Return what a wave generator of another size does to the same teeth."""
    heads = ["deflection, modules", f"least clearance [{measures.unit('um')}]"]
    rows = [
        [Cell(d.deflection, f"{d.deflection:g}"), cell(d.least_clearance_mm, "um", measures)]
        for d in found.deflections
    ]
    caption = (
        "The same teeth on a wave generator of another size: backlash above 0, interference below."
    )
    return Table("other deflections", heads, rows, caption)


def flank(found: WaveDesign, measures: Measures) -> Table:
    """Return the contacts of conjugate flanks, point by point."""
    length = measures.unit("mm")
    columns: list[tuple[str, Sequence[float], str]] = [
        ("on the wave [°]", found.arc_deg, ""),
        (f"radius [{length}]", found.radius_mm, "mm"),
        (f"height [{length}]", found.height_mm, "mm"),
        (f"half thickness [{length}]", found.half_thickness_mm, "mm"),
        (f"R_f [{length}]", found.flexspline_curvature_mm, "mm"),
        (f"R_c [{length}]", found.circular_curvature_mm, "mm"),
        (f"R [{length}]", found.relative_curvature_mm, "mm"),
    ]
    caption = (
        "Where flanks are conjugate: radius on the circular spline, height over the neutral curve, "
        "radii of curvature of flexspline (convex: above 0) and circular spline (concave: above "
        "0), and R of the contact, 1/R = 1/R_f - 1/R_c."
    )
    return _columns("conjugate contact", columns, measures, caption)


def tooth_points(found: WaveDesign, measures: Measures) -> Table:
    """Return points of the flexspline's flank, to make it by."""
    length = measures.unit("mm")
    columns = [
        (f"height over the neutral curve [{length}]", found.tooth_height_mm, "mm"),
        (f"half thickness [{length}]", found.tooth_half_mm, "mm"),
    ]
    return _columns("points of the flexspline's flank", columns, measures, folded=True)


def space_points(found: WaveDesign, measures: Measures) -> Table:
    """Return points of the circular spline's flank, to make it by."""
    length = measures.unit("mm")
    columns = [
        (f"across, from the middle of the space [{length}]", found.space_across_mm, "mm"),
        (f"out, from the axis [{length}]", found.space_out_mm, "mm"),
    ]
    return _columns("points of the circular spline's flank", columns, measures, folded=True)


def _flexspline(found: WaveDesign, measures: Measures) -> list[list[Any]]:
    """Return diameters of the flexspline before it is bent, and of the wave generator in it."""
    length, neutral = measures.unit("mm"), found.neutral_diameter_mm
    values = {
        "flexspline, undeformed: tip diameter": neutral + 2.0 * found.tooth_height_mm[-1],
        "root diameter of the flexspline": neutral + found.rim_mm,
        "neutral diameter of the flexspline": neutral,
        "bore of the flexspline": neutral - found.rim_mm,
        "wave generator: major diameter": found.wave_major_mm,
        "minor diameter": found.wave_minor_mm,
    }
    return [[f"{name} [{length}]", _mm(value, measures)] for name, value in values.items()]


def _arcs(found: WaveDesign, measures: Measures) -> list[list[Any]]:
    """Return radii and tangent of double arcs."""
    length = measures.unit("mm")
    names = "radius at the tip, convex", "radius at the root, concave", "length of the tangent"
    values = *found.arc_radii_mm, found.tangent_mm
    return [
        [f"{name} [{length}]", _mm(v, measures)]
        for name, v in zip(names, values, strict=False)
        if v is not None
    ]


def _mm(value: float | None, measures: Measures) -> Cell | None:
    """Return a size with the digits that it is made by."""
    if value is None:
        return None
    return Cell(measures.of(value, "mm"), measures.length(value, 4))


def wave(found: WaveDesign, measures: Measures) -> Table:
    """Return the clearance of a tooth by its angle on the wave."""
    columns = [
        ("on the wave [°]", found.wave_angle_deg, ""),
        (f"clearance [{measures.unit('um')}]", found.wave_clearance_mm, "um"),
    ]
    return _columns("clearance over the wave", columns, measures, folded=True)


def load(found: WaveDesign, measures: Measures) -> Table:
    """Return load and pressure of a tooth by its angle on the wave."""
    columns = [
        ("on the wave [°]", found.load_angle_deg, ""),
        (f"load [{measures.unit('N')}]", found.load_N, "N"),
        (f"pressure [{measures.unit('MPa')}]", found.load_pressure_MPa, "MPa"),
    ]
    return _columns("load over the wave", columns, measures, folded=True)


def rounds(found: WaveDesign, measures: Measures) -> Table:
    """Return how the search went."""
    heads = [
        *("round", "passages held clear", f"pressure [{measures.unit('MPa')}]"),
        *(f"least clearance [{measures.unit('um')}]", "iterations"),
    ]
    rows = [
        [
            k,
            r.cuts,
            cell(r.pressure_MPa, "MPa", measures),
            cell(r.least_clearance_mm, "um", measures),
            r.iterations,
        ]
        for k, r in enumerate(found.rounds, 1)
    ]
    return Table("rounds", heads, rows)


def edges(found: CutterDesign, measures: Measures) -> Table:
    """Return straight and circular edges that may replace the exact one."""
    length, micro = measures.unit("mm"), measures.unit("um")
    least = ""
    if found.least_radius_mm:
        least = f" from {amount(found.least_radius_mm, 'mm', measures)} on"
    rows: list[list[Any]] = [
        [
            "straight, best",
            Cell(found.straight_deg, f"{found.straight_deg:.3f}"),
            None,
            cell(found.straight_deviation_mm, "um", measures),
        ],
        [
            "straight, of the tool",
            Cell(found.given_deg, f"{found.given_deg:.3f}"),
            None,
            cell(found.given_deviation_mm, "um", measures),
        ],
        [
            f"circular arc, best found{least}",
            None,
            cell(found.arc_radius_mm, "mm", measures),
            cell(found.arc_deviation_mm, "um", measures),
        ],
    ]
    heads = ["edge", "angle [°]", f"radius [{length}]", f"largest deviation [{micro}]"]
    caption = "Deviations normal to the edge: the part of the tool's tolerance that is used up."
    return Table("cutting edges", heads, rows, caption)


def edge_points(found: CutterDesign, measures: Measures) -> Table:
    """Return the points of the cutting edge."""
    length = measures.unit("mm")
    columns = [(f"x [{length}]", found.x_mm, "mm"), (f"y [{length}]", found.y_mm, "mm")]
    return _columns("points of the cutting edge", columns, measures, folded=True)


def _columns(
    name: str,
    columns: Sequence[tuple[str, Sequence[float], str]],
    measures: Measures,
    caption: str = "",
    folded: bool = False,
) -> Table:
    rows: list[list[Any]] = [
        [
            cell(v, suffix, measures) if suffix else Cell(v, f"{v:.4f}")
            for v, (_, _, suffix) in zip(row, columns, strict=True)
        ]
        for row in zip(*(values for _, values, _ in columns), strict=True)
    ]
    return Table(name, [head for head, _, _ in columns], rows, caption, folded=folded)
