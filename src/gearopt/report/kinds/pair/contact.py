"""The contact of a spur pair: moving teeth, plots over its path, sections, in space, tables."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.drive.design import StageDesign, drive_design
from gearopt.formulations.pair.design import ContactLoad, LoadedMesh, PairContact, PairRelief
from gearopt.formulations.pair.flank_design import FlankContact
from gearopt.optimise.result import Result
from gearopt.physics.blanks import Body
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import usable_path
from gearopt.report.drawing.mesh_view import carries_alone
from gearopt.report.drawing.solid import undrawn
from gearopt.report.kinds.pair import solid as pair_solid
from gearopt.report.kinds.pair import tooth_section
from gearopt.report.kinds.pair.mesh_motion import CAPTION, Carried, in_mesh
from gearopt.report.kinds.pair.path_plots import Line, over_path, zone_words
from gearopt.report.kinds.pair.words import of_duty
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure
from gearopt.report.section import Cell, Section, Table, cell, records, side_by_side
from gearopt.report.words import share

MESH = "teeth in mesh"  # the animation that plots follow
DASHES = ("solid", "dash", "dashdot", "longdash")  # of one load after the other
SECTIONS = (
    "A tooth of each gear in its transverse section, both at one scale; dimensions in {unit}: "
    "diameters of tip d_a, reference d, root form d_Ff, base d_b and root circle d_f; thickness s "
    "on the reference circle and s_a on the tip circle; least radius of the fillet ρ_F. F_n acts "
    "where {where}, at the angle α_L to the normal of the tooth's centre line."
)
STIFFNESS = "N_per_mm_um"  # of MPa
Columns = list[tuple[str, Sequence[float], str]]
MakeTable = Callable[[PairContact, Measures], Table]


def pair_of(result: Result) -> GearPair | None:
    """The gears of a design; None without them or where their teeth are not whole."""
    stages = drive_design(result.design).stages if result.design.get("stages") else ()
    if not stages:
        return None
    pair = stages[0].pair
    return pair if all(float(gear.teeth).is_integer() for gear in pair.gears) else None


def carried(contact: PairContact, load: ContactLoad) -> Carried:
    """Shares of the pairs of teeth at a load, as drawings and plots have them."""
    travels = np.asarray(contact.travel_mm) / contact.base_pitch_mm
    return Carried.of_columns(travels, contact.position_mm, load.share, load.transmission_error_mm)


def moving(
    contact: PairContact, relief: PairRelief | None, pair: GearPair, measures: Measures
) -> Section:
    """Show the pair in mesh at the torque of the duty, and every load over the path of contact.

    With a relief before and after it, side by side and in every plot.
    """
    duty, path = of_duty(contact.loads), usable_path(pair)
    shown = {"": carried(contact, duty)}
    if relief:
        after = relief.at[contact.loads.index(duty)]
        shown = {"without relief": shown[""], "with relief": carried(contact, after)}
    at = f"At {100.0 * duty.load:g} % of the duty's torque. {CAPTION}"
    figures = [*_of_loads(contact, relief, pair, measures), _stiffness(contact, pair, measures)]
    return Section(
        "Teeth in mesh",
        words=(f"Line of action and plots: {zone_words(path, relief is not None)}",),
        animations=[in_mesh(pair, MESH, shown, measures, at)],
        figures=figures,
        appendix=True,
    )


def _of_loads(
    contact: PairContact, relief: PairRelief | None, pair: GearPair, measures: Measures
) -> list[Figure]:
    """Plot shares and transmission error at every load, before and after a relief."""
    shown, path = carried(contact, of_duty(contact.loads)), usable_path(pair)
    shares, errors = _lines(contact.loads, measures)
    said = "by the load"
    if relief:
        before, after = (shares, errors), _lines(relief.at, measures)
        shares, errors = ([*_pale(b), *a] for b, a in zip(before, after, strict=True))
        said = "by the load; dotted: without relief"
    return [
        over_path(
            *(shown, path, shares, "share of the normal force [%]"),
            f"Share of the load that one pair of teeth carries along its path, {said}.",
            *(measures, MESH),
        ),
        over_path(
            *(shown, path, errors, f"transmission error [{measures.unit('um')}]"),
            f"Transmission error: approach of the gears along the line of action, {said}.",
            *(measures, MESH),
        ),
    ]


def _lines(loads: Sequence[ContactLoad], measures: Measures) -> tuple[list[Line], list[Line]]:
    """Curves of shares and of transmission errors, one for each load."""
    micro = measures.of(1.0, "um")
    shares, errors = [], []
    for k, load in enumerate(loads):
        look = f"at {100.0 * load.load:g} %", k + 1, DASHES[k % len(DASHES)]
        shares.append(Line(100.0 * np.asarray(load.share), *look))
        errors.append(Line(micro * np.asarray(load.transmission_error_mm), *look))
    return shares, errors


def _pale(lines: Sequence[Line]) -> list[Line]:
    """Curves as they are shown behind those that matter."""
    return [replace(line, name="", dash="dot", width=1.2) for line in lines]


def _stiffness(contact: PairContact, pair: GearPair, measures: Measures) -> Figure:
    """Plot the stiffness of one pair of teeth and of the mesh beside those of ISO 6336-1."""
    duty, factor = of_duty(contact.loads), measures.of(1.0, STIFFNESS)
    lines = [Line(factor * np.asarray(contact.pair_stiffness_MPa), "one pair of teeth", 1)]
    if duty.normal_force_N:
        error = float(pair.face_width) * np.asarray(duty.transmission_error_mm)
        lines.append(Line(factor * duty.normal_force_N / error, "mesh", 2))
    beside = [
        ("c_γα of ISO 6336-1", factor * contact.iso_mesh_stiffness_MPa),
        ("c' of ISO 6336-1", factor * contact.iso_single_stiffness_MPa),
    ]
    return over_path(
        *(carried(contact, duty), usable_path(pair), lines),
        f"stiffness [{measures.unit(STIFFNESS)}]",
        f"Stiffness, normal force over face width and approach: of one pair of teeth, and of the "
        f"mesh at {100.0 * duty.load:g} % of the torque.",
        *(measures, MESH, beside),
    )


def teeth(result: Result, measures: Measures) -> Section | None:
    """Draw a tooth of each gear with its dimensions; None without gears of whole teeth."""
    if (pair := pair_of(result)) is None:
        return None
    single = carries_alone(pair, usable_path(pair))
    without = " without relief" if result.design.get("relief") else ""
    where = f"one pair of teeth carries alone{without}, farthest out"
    where = where if single else "contact reaches the tip"
    words = SECTIONS.format(unit=measures.lengths, where=where)
    return Section(
        "Tooth sections",
        words=(words,),
        drawings=tooth_section.sections(pair, measures),
        appendix=True,
    )


def in_space(result: Result, measures: Measures) -> Section | None:
    """Draw the gears in three dimensions; None without gears of whole teeth."""
    if (pair := pair_of(result)) is None:
        return None
    if why := undrawn(gear.teeth for gear in pair.gears):
        return Section("In three dimensions", words=(why,))
    stage = drive_design(result.design).stages[0]
    figure = pair_solid.figure(pair, bodies(stage), measures)
    return Section("In three dimensions", figures=(figure,), appendix=True)


def bodies(stage: StageDesign) -> tuple[Body, Body]:
    """The bodies of both gears below their teeth."""
    return (
        Body(
            stage.pinion_rim_thickness_mm,
            stage.pinion_web_thickness_mm,
            stage.pinion_hub_diameter_mm,
            stage.pinion_bore_mm,
        ),
        Body(
            stage.wheel_rim_thickness_mm,
            stage.wheel_web_thickness_mm,
            stage.wheel_hub_diameter_mm,
            stage.wheel_bore_mm,
        ),
    )


def points(contact: PairContact, measures: Measures, relieved: bool) -> Table:
    """Points where pairs of teeth come and go without relief, and how stiff one pair is there."""
    heads, rows = records(contact.points, measures)
    caption = (
        "Points of the path of contact; s on the line of action from the pitch point, positive "
        "towards the pinion's tip."
    )
    if contact.contact_ratio < 2.0:
        caption += " Between LPSTC and HPSTC one pair of teeth carries the load"
        caption += f"{', without relief' * relieved}."
    length, stiff = measures.unit("mm"), measures.unit(STIFFNESS)
    brief = f"d_1 [{length}]", f"d_2 [{length}]", "pinion roll [°]", f"pair [{stiff}]"
    short = dict(zip(heads[2:], brief, strict=True))
    return Table("points of contact", heads, rows, caption, short=short, wrap=0)


def loads(contact: PairContact, measures: Measures) -> Table:
    """Forces, stresses and errors at every load, beside the stiffness by ISO 6336-1."""
    each = contact.loads
    shares = [Cell(100.0 * load.largest_share, share(load.largest_share)) for load in each]
    forces = [["the same, % of the normal force", *shares]]
    caption = "Force, contact stress, transmission error and stiffness at each load."
    return load_table(contact, measures, forces, caption)


def load_table(
    contact: PairContact | FlankContact, measures: Measures, forces: list[list[Any]], caption: str
) -> Table:
    """Everything at every load, beside the stiffness by ISO 6336-1; forces: rows after them."""
    each: Sequence[LoadedMesh] = contact.loads
    micro, stiff = measures.unit("um"), measures.unit(STIFFNESS)
    waves = zip(*(load.harmonics_mm for load in each), strict=True)
    unloaded = Cell("", "–")  # there is no mesh stiffness
    by_iso = {
        "c_γα of ISO 6336-1": contact.iso_mesh_stiffness_MPa,
        "c' of ISO 6336-1, of one pair": contact.iso_single_stiffness_MPa,
    }
    rows = [
        *side_by_side(each, measures, "forces"),
        *forces,
        *side_by_side(each, measures, "stress"),
        *side_by_side(each, measures, "motion"),
        *(
            [f"harmonic {k} [{micro}]", *(cell(v, "um", measures) for v in wave)]
            for k, wave in enumerate(waves, 1)
        ),
        *(
            [head, *(c if o.normal_force_N else unloaded for c, o in zip(cells, each, strict=True))]
            for head, *cells in side_by_side(each, measures, "stiffness")
        ),
        *(
            [f"{name} [{stiff}]", *[cell(value, STIFFNESS, measures)] * len(each)]
            for name, value in by_iso.items()
        ),
    ]
    names = [f"{100.0 * load.load:g} %" for load in each]
    return Table("loads", ["", *names], rows, caption, across=True)


def path(contact: PairContact, measures: Measures) -> Table:
    """Positions on the path of contact, with the share and the contact stress at every load."""
    listed: Columns = [
        ("s", contact.position_mm, "mm"),
        ("pinion diameter", contact.pinion_diameter_mm, "mm"),
        ("wheel diameter", contact.wheel_diameter_mm, "mm"),
        ("pinion roll angle", contact.pinion_roll_angle_deg, "deg"),
        ("stiffness of a pair", contact.pair_stiffness_MPa, STIFFNESS),
    ]
    for load in contact.loads:
        at = f"at {100.0 * load.load:g} %"
        listed.append((f"share of the load {at}", load.share, ""))
        listed.append((f"contact stress {at}", load.contact_stress_MPa, "MPa"))
    return columns("path of contact", listed, measures)


def travel(
    contact: PairContact | FlankContact,
    measures: Measures,
    loads: Sequence[LoadedMesh] = (),
    name: str = "transmission error",
) -> Table:
    """Transmission error over one base pitch at every load; loads: those with relief."""
    listed: Columns = [("travel", contact.travel_mm, "mm")]
    each: Sequence[LoadedMesh] = loads or contact.loads
    for load in each:
        head = f"transmission error at {100.0 * load.load:g} %"
        listed.append((head, load.transmission_error_mm, "um"))
    return columns(name, listed, measures)


def columns(name: str, listed: Columns, measures: Measures) -> Table:
    """Columns (label, values, unit) as a table of which the page holds the CSV alone."""
    cells = [[cell(v, unit, measures) for v in values] for _, values, unit in listed]
    heads = [f"{label} [{measures.unit(unit)}]" if unit else label for label, _, unit in listed]
    return Table(name, heads, list(zip(*cells, strict=True)), folded=True)


TABLES: tuple[MakeTable, ...] = (loads, path, travel)
