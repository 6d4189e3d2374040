"""The relief of a spur pair: what a grinder needs, what it does at every load, rules beside it."""

from typing import Any

from gearopt.formulations.pair.contact import PairContact
from gearopt.formulations.pair.relief_map import FlankRelief, MadeRelief, PairRelief
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.report.kinds.pair.tables import Columns, columns
from gearopt.report.measures import METRIC, Measures
from gearopt.report.section import Cell, Table, Tile, cell, percent, side_by_side
from gearopt.report.words import amount, share

# peak-to-peak on more positions over that on the computed ones: no difference
SAME_PEAK_TO_PEAK = 1.001
CRITERIA = {  # of a relief: what their names mean
    "peak_to_peak": "peak-to-peak transmission error",
    "harmonics": "first three harmonics of the transmission error",
    "load_jump": "share with which a pair of teeth comes or goes",
    "peak_load": "largest share of a pair of teeth",
}


def relief_of(result: Result) -> PairRelief | None:
    """Return the relief that a design holds; None without one."""
    held = result.design.get("relief")
    found: PairRelief | None = typed(PairRelief, held, "relief") if held else None
    return found


def tiles(found: PairRelief, measures: Measures) -> list[Tile]:
    """Return both amounts as key figures."""
    rows = (("pinion", found.pinion), ("wheel", found.wheel))
    return [
        Tile(
            f"relief of the {name}",
            amount(flank.amount_mm, "um", measures),
            f"from d {measures.length(flank.start_diameter_mm)} {measures.unit('mm')} to the tip",
        )
        for name, flank in rows
    ]


def binding_limit(found: PairRelief) -> str:
    """Return what the relief is and what it gains."""
    first, second = (amount(f.amount_mm, "um", METRIC) for f in (found.pinion, found.wheel))
    none, best = found.rows[0], found.rows[-1]
    said = f"{_value(found, best.value)}{_strays(found)} instead of {_value(found, none.value)}"
    at = f"{100.0 * found.loads[0]:g} % of the torque"
    if len(found.loads) > 1:
        at = f"the worst of {len(found.loads)} loads"
    return (
        f"{first} off the pinion's tips and {second} off the wheel's: {CRITERIA[found.minimise]} "
        f"{said} at {at}"
    )


def _strays(found: PairRelief) -> str:
    """Return the largest peak-to-peak on more positions of the gears, where it is larger."""
    if found.minimise != "peak_to_peak" or not _finer(found):
        return ""
    return f" ({amount(max(found.finer_mm), 'um', METRIC)} on ten times as many positions)"


def _value(found: PairRelief, value: float) -> str:
    if found.minimise in ("load_jump", "peak_load"):
        return f"{share(value)} %"
    return amount(value, "um", METRIC)


def answers(found: PairRelief) -> list[str]:
    """Return what to grind, and what happens at other loads than those it is made for."""
    words = [
        _flank("pinion", found.pinion),
        _flank("wheel", found.wheel),
        "Only the sum of what is taken off both flanks where they touch counts: instead of the "
        "tips of one gear the roots of the other may be relieved, at the same points of contact. "
        "Crowning and end relief vary along the face width, which plane models do not see.",
    ]
    if found.break_even is not None:
        words.append(
            f"Below {100.0 * found.break_even:.3g} % of the torque the gears run more evenly "
            "without relief: a light load does not close the gaps that relief opens."
        )
    words += _finer(found)
    return [*words, _as_made(found.made)] if found.made else words


def _finer(found: PairRelief) -> list[str]:
    """Say how far the transmission error strays between the positions that were computed."""
    known, finer = max(found.rows[-1].peak_to_peak_mm), max(found.finer_mm, default=0.0)
    if finer <= SAME_PEAK_TO_PEAK * known:
        return []
    return [
        "Peak-to-peak values and what is proven of them are of the computed positions of the "
        "gears. On ten times as many the transmission error varies by up to "
        f"{1e3 * finer:.4g} µm at the loads this relief is made for, not {1e3 * known:.4g} µm."
    ]


def _as_made(made: MadeRelief) -> str:
    """Say how the relief does as it is ground."""
    off = f"amounts off by up to {1e3 * made.amount_tolerance_mm:.3g} µm"
    if made.length_tolerance_mm:
        off += f" and lengths by up to {made.length_tolerance_mm:.3g} mm"
    pinion, wheel = (1e3 * amount for amount in made.worst_amounts_mm)
    return (
        f"As manufactured, with {off}, the transmission error varies by up to "
        f"{1e3 * made.worst_mm:.4g} µm, peak to peak, and by no more than "
        f"{1e3 * made.bound_mm:.4g} µm (proven of the computed positions); the worst has "
        f"{pinion:.2f} µm off the pinion and {wheel:.2f} µm off the wheel. Of "
        f"{made.drawn:,} gear pairs drawn at random half stay below "
        f"{1e3 * made.median_mm:.4g} µm and 95 % below {1e3 * made.most_mm:.4g} µm."
    )


def _flank(name: str, flank: FlankRelief) -> str:
    known = {None: "by the profile in the table", 1.0: "linearly", 2.0: "as a parabola"}
    shape = known.get(flank.exponent) or f"with the exponent {flank.exponent:g}"
    if not flank.amount_mm:
        return f"The {name} keeps its involute."
    return (
        f"Grind {1e3 * flank.amount_mm:.2f} µm off the tips of the {name}, normal to the flank, "
        f"growing {shape} from {flank.start_diameter_mm:.3f} mm diameter (roll angle "
        f"{flank.start_roll_angle_deg:.2f}°) to {flank.tip_diameter_mm:.3f} mm "
        f"({flank.tip_roll_angle_deg:.2f}°)."
    )


def grinding(found: PairRelief, measures: Measures) -> Table:
    """Amounts, diameters and roll angles of both gears."""
    both = found.pinion, found.wheel
    rows = [*side_by_side(both, measures), ["exponent", *(_power(f.exponent) for f in both)]]
    return Table("relief", ["", "pinion", "wheel"], rows, "What to grind.", across=True)


def _power(exponent: float | None) -> Cell:
    return Cell(exponent, "free" if exponent is None else f"{exponent:g}")


def rules(found: PairRelief, measures: Measures) -> Table:
    """Return the relief beside none and beside rules, each in a column."""
    micro, rows = measures.unit("um"), found.rows
    at = [f"at {100.0 * load:g} %" for load in found.loads]
    lines: list[list[Any]] = [
        [f"pinion [{micro}]", *(cell(r.pinion_amount_mm, "um", measures) for r in rows)],
        [f"wheel [{micro}]", *(cell(r.wheel_amount_mm, "um", measures) for r in rows)],
        ["exponent", *(_power(r.exponent) for r in rows)],
    ]
    for k, name in enumerate(at):
        values = (cell(r.peak_to_peak_mm[k], "um", measures) for r in rows)
        lines.append([f"peak to peak {name} [{micro}]", *values])
    for k, name in enumerate(at):
        lines.append([f"load jump {name} [%]", *(percent(r.load_jump[k]) for r in rows)])
    caption = (
        "Without relief, by rules, and as found here. Rules remove at the tips a deflection at the "
        "torque of the duty: that of Hwang and others (the paper's) the whole deflection of the "
        "pair that enters or leaves contact, the corrected rule that of the pairs that stay. "
        "Load jump: the share of the load with which a pair enters or leaves contact."
    )
    return Table("relief and rules", ["", *(r.name for r in rows)], lines, caption, across=True)


def after(contact: PairContact, found: PairRelief, measures: Measures) -> Table:
    """Return peak to peak, first harmonic and largest load at every load, before and after."""
    micro, force = measures.unit("um"), measures.unit("N")
    rows = []
    for when, loads in (("without", contact.loads), ("with", found.at)):
        told = {
            f"peak to peak [{micro}]": [(one.peak_to_peak_mm, "um") for one in loads],
            f"first harmonic [{micro}]": [(one.harmonics_mm[0], "um") for one in loads],
            f"largest load on a tooth [{force}]": [(o.largest_tooth_force_N, "N") for o in loads],
        }
        for words, values in told.items():
            rows.append([f"{words}, {when}", *(cell(*value, measures) for value in values)])
    names = [f"{100.0 * one.load:g} %" for one in found.at]
    caption = "Every load without relief, and with it."
    return Table("without and with relief", ["", *names], rows, caption, across=True)


def profile(contact: PairContact, found: PairRelief, measures: Measures) -> Table:
    """Modified profiles by position, diameter and roll angle."""
    listed: Columns = [
        ("s", contact.position_mm, "mm"),
        ("pinion diameter", contact.pinion_diameter_mm, "mm"),
        ("pinion roll angle", contact.pinion_roll_angle_deg, "deg"),
        ("off the pinion", found.pinion_removed_mm, "um"),
        ("wheel diameter", contact.wheel_diameter_mm, "mm"),
        ("wheel roll angle", contact.wheel_roll_angle_deg, "deg"),
        ("off the wheel", found.wheel_removed_mm, "um"),
    ]
    for load in found.at:
        listed.append((f"share of the load at {100.0 * load.load:g} %", load.share, ""))
    return columns("modified profile", listed, measures)
