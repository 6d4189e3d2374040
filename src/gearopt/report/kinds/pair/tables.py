"""Tables of a spur pair's contact: points of the path, loads, and the curves as CSV files."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from gearopt.formulations.pair.contact import ContactLoad, PairContact
from gearopt.report.measures import Measures
from gearopt.report.section import Cell, Table, cell, records
from gearopt.report.words import share

STIFFNESS = "N_per_mm_um"  # of MPa
Columns = list[tuple[str, Sequence[float], str]]
MakeTable = Callable[[PairContact, Measures], Table]


def points(found: PairContact, measures: Measures) -> Table:
    """Points where pairs of teeth come and go, and how stiff one pair is there."""
    heads, rows = records(found.points, measures)
    caption = (
        "Points of the path of contact; s on the line of action from the pitch point, positive "
        "towards the pinion's tip."
    )
    if found.contact_ratio < 2.0:
        caption += " Between LPSTC and HPSTC one pair of teeth carries the load."
    length, stiff = measures.unit("mm"), measures.unit(STIFFNESS)
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
    """Positions on the path of contact, with the share and the contact stress at every load."""
    listed: Columns = [
        ("s", found.position_mm, "mm"),
        ("pinion diameter", found.pinion_diameter_mm, "mm"),
        ("wheel diameter", found.wheel_diameter_mm, "mm"),
        ("pinion roll angle", found.pinion_roll_angle_deg, "deg"),
        ("stiffness of a pair", found.pair_stiffness_MPa, STIFFNESS),
    ]
    for load in found.loads:
        at = f"at {100.0 * load.load:g} %"
        listed.append((f"share of the load {at}", load.share, ""))
        listed.append((f"contact stress {at}", load.contact_stress_MPa, "MPa"))
    return columns("path of contact", listed, measures)


def travel(
    found: PairContact,
    measures: Measures,
    loads: Sequence[ContactLoad] = (),
    name: str = "transmission error",
) -> Table:
    """Transmission error over one base pitch at every load; loads: those with relief."""
    listed: Columns = [("travel", found.travel_mm, "mm")]
    for load in loads or found.loads:
        head = f"transmission error at {100.0 * load.load:g} %"
        listed.append((head, load.transmission_error_mm, "um"))
    return columns(name, listed, measures)


def columns(name: str, listed: Columns, measures: Measures) -> Table:
    """Columns (label, values, unit) as a table of which the page holds the CSV alone."""
    cells = [[cell(v, unit, measures) for v in values] for _, values, unit in listed]
    heads = [f"{label} [{measures.unit(unit)}]" if unit else label for label, _, unit in listed]
    return Table(name, heads, list(zip(*cells, strict=True)), folded=True)


TABLES: tuple[MakeTable, ...] = (points, loads, path, travel)
