"""Tables of a spur pair's contact: points of the path, loads, and the curves as CSV files."""

from collections.abc import Callable
from functools import partial
from typing import Any

from gearopt.formulations.pair.contact import ContactLoad, PairContact
from gearopt.report.measures import Measures
from gearopt.report.section import Cell, Table, cell
from gearopt.report.words import share

STIFFNESS = "N_per_mm_um"  # of MPa
MakeTable = Callable[[PairContact, Measures], Table]


def points(found: PairContact, measures: Measures) -> Table:
    """Return where pairs of teeth come and go, and how stiff one pair is there."""
    length, stiff = measures.unit("mm"), measures.unit(STIFFNESS)
    heads = (
        *("point", f"s [{length}]", f"pinion diameter [{length}]", f"wheel diameter [{length}]"),
        *("pinion roll angle [°]", f"stiffness of a pair [{stiff}]"),
    )
    rows = [
        [
            row.point,
            cell(row.position_mm, "mm", measures),
            cell(row.pinion_diameter_mm, "mm", measures),
            cell(row.wheel_diameter_mm, "mm", measures),
            Cell(row.pinion_roll_angle_deg, f"{row.pinion_roll_angle_deg:.3f}"),
            cell(row.pair_stiffness_MPa, STIFFNESS, measures),
        ]
        for row in found.points
    ]
    caption = (
        "Points of the path of contact; s on the line of action from the pitch point, positive "
        "towards the pinion's tip."
    )
    if found.contact_ratio < 2.0:
        caption += " Between LPSTC and HPSTC one pair of teeth carries the load."
    brief = f"d_1 [{length}]", f"d_2 [{length}]", "pinion roll [°]", f"pair [{stiff}]"
    short = dict(zip(heads[2:], brief, strict=True))
    return Table("points of contact", heads, rows, caption, short=short, wrap=0)


def loads(found: PairContact, measures: Measures) -> Table:
    """Return what happens at every load, beside the stiffness by ISO 6336-1."""

    def row(head: str, unit: str, value: Callable[[ContactLoad], float | None]) -> list[Any]:
        values = [value(one) for one in found.loads]
        cells = [Cell("", "–") if v is None else cell(v, unit, measures) for v in values]
        return [f"{head} [{measures.unit(unit)}]", *cells]

    waves = range(len(found.loads[0].harmonics_mm))
    rows = [
        row("normal force", "N", lambda o: o.normal_force_N),
        row("largest load on a tooth", "N", lambda o: o.largest_tooth_force_N),
        [
            "the same, % of the normal force",
            *(Cell(100.0 * o.largest_share, share(o.largest_share)) for o in found.loads),
        ],
        row("largest contact stress", "MPa", lambda o: o.largest_contact_stress_MPa),
        row("transmission error, mean", "um", lambda o: o.mean_transmission_error_mm),
        row("peak to peak", "um", lambda o: o.peak_to_peak_mm),
        *(row(f"harmonic {k + 1}", "um", partial(_harmonic, k)) for k in waves),
        row("mesh stiffness, mean", STIFFNESS, lambda o: _loaded(o, o.mean_mesh_stiffness_MPa)),
        row("mesh stiffness, least", STIFFNESS, lambda o: _loaded(o, o.least_mesh_stiffness_MPa)),
        row("mesh stiffness, most", STIFFNESS, lambda o: _loaded(o, o.most_mesh_stiffness_MPa)),
        row("c_γα of ISO 6336-1", STIFFNESS, lambda o: found.iso_mesh_stiffness_MPa),
        row("c' of ISO 6336-1, of one pair", STIFFNESS, lambda o: found.iso_single_stiffness_MPa),
    ]
    names = [f"{100.0 * one.load:g} %" for one in found.loads]
    return Table(
        "loads",
        ["", *names],
        rows,
        "Force, contact stress, transmission error and stiffness at each load.",
        across=True,
    )


def _harmonic(number: int, one: ContactLoad) -> float:
    """Return the amplitude of a harmonic of the transmission error, counted from 0."""
    return one.harmonics_mm[number]


def _loaded(one: ContactLoad, value: float) -> float | None:
    """Return a mesh stiffness; None without load, of which there is none."""
    return value if one.normal_force_N else None


def path(found: PairContact, measures: Measures) -> Table:
    """Return the path of contact, position by position, with the share at every load."""
    length, stiff = measures.unit("mm"), measures.unit(STIFFNESS)
    stress = measures.unit("MPa")
    listed = [
        (f"s [{length}]", found.position_mm, "mm"),
        (f"pinion diameter [{length}]", found.pinion_diameter_mm, "mm"),
        (f"wheel diameter [{length}]", found.wheel_diameter_mm, "mm"),
        ("pinion roll angle [°]", found.pinion_roll_angle_deg, "deg"),
        (f"stiffness of a pair [{stiff}]", found.pair_stiffness_MPa, STIFFNESS),
    ]
    for one in found.loads:
        at = f"at {100.0 * one.load:g} %"
        listed.append((f"share of the load {at}", one.share, ""))
        listed.append((f"contact stress {at} [{stress}]", one.contact_stress_MPa, "MPa"))
    return columns("path of contact", listed, measures)


def travel(found: PairContact, measures: Measures) -> Table:
    """Return the transmission error over one base pitch at every load."""
    length, micro = measures.unit("mm"), measures.unit("um")
    listed = [(f"travel [{length}]", found.travel_mm, "mm")]
    for one in found.loads:
        head = f"transmission error at {100.0 * one.load:g} % [{micro}]"
        listed.append((head, one.transmission_error_mm, "um"))
    return columns("transmission error", listed, measures)


def columns(
    name: str, listed: list[tuple[str, tuple[float, ...], str]], measures: Measures
) -> Table:
    """Return a table of columns (head, values, unit), of which the page holds the CSV alone."""
    cells = [[cell(v, unit, measures) for v in values] for _, values, unit in listed]
    rows = list(zip(*cells, strict=True))
    return Table(name, [head for head, *_ in listed], rows, folded=True)


TABLES: tuple[MakeTable, ...] = (points, loads, path, travel)
