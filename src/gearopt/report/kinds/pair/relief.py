"""The relief of a spur pair: what a grinder needs, what it does at every load, its plots."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.formulations.pair.design import (
    ContactLoad,
    FlankRelief,
    MadeRelief,
    PairContact,
    PairRelief,
)
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.optimise.typed import held
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.tooth.measured import PAIRS
from gearopt.physics.tooth.validity import EXACT
from gearopt.report.drawing.sheet import SERIES_OF_MEMBERS, series
from gearopt.report.kinds.pair.contact import Columns, columns
from gearopt.report.kinds.pair.words import between, of_duty
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure, axis, layout, lines
from gearopt.report.section import Cell, Section, Table, Tile, cell, percent, side_by_side
from gearopt.report.words import amount, micrometres, share

# peak-to-peak on more positions over that on the computed ones: no difference
SAME_PEAK_TO_PEAK = 1.001
CRITERIA = {  # of a relief: what their names mean
    "peak_to_peak": "peak-to-peak transmission error",
    "harmonics": "first three harmonics of the transmission error",
    "load_jump": "share of the load with which a pair of teeth enters or leaves contact",
    "peak_load": "largest share of the load on a pair of teeth",
}
TABLE_STEPS = 10  # of the table from where a relief starts to the tip
PLOT_STEPS = 60  # of its plot
TICKS = 6  # diameters above a plot
PANELS = 4  # loads whose harmonics stand side by side, at most
PANEL_GAP = 0.04  # between them, of the width
BARS = {"type": "bar", "hovertemplate": "%{y:.3f}", "showlegend": False}
HARMONICS_WORDS = (
    "Amplitudes of the transmission error at the mesh frequency and its multiples: grey without "
    "relief, coloured with it."
)


def relief_of(result: Result) -> PairRelief | None:
    """The relief that a design holds; None without one."""
    return held(PairRelief, result.design, "relief")


def tiles(relief: PairRelief, measures: Measures) -> list[Tile]:
    """Both amounts as key figures, and what they leave by the finest level."""
    rows = (("pinion", relief.pinion), ("wheel", relief.wheel))
    judged = [
        Tile(
            f"the same flanks by {there.level}",
            _value(relief, there.value, measures),
            f"{at_loads(relief)}; {_value(relief, there.without_relief, measures)} without relief",
        )
        for there in ([relief.judged] if relief.judged else [])
    ]
    return judged + [
        Tile(
            f"relief of the {name}",
            amount(flank.amount_mm, "um", measures),
            f"from d {measures.length(flank.start_diameter_mm)} {measures.unit('mm')} to the tip",
        )
        for name, flank in rows
    ]


def relief_words(relief: PairRelief, measures: Measures) -> str:
    """Return a clause: tip relief of both gears [um], and how far it changes the criterion."""
    first, second = (amount(f.amount_mm, "um", measures) for f in (relief.pinion, relief.wheel))
    none, best = relief.rows[0], relief.rows[-1]
    values = (
        f"{_value(relief, none.value, measures)} to {_value(relief, best.value, measures)}"
        f"{_strays(relief, measures)}"
    )
    also = "; not judged by finite elements" if relief.unjudged else ""
    if judged := relief.judged:
        also = f"; the same flanks by {judged.level}: {_value(relief, judged.value, measures)}"
    return (
        f"tip relief of {first} on the pinion and {second} on the wheel changes the "
        f"{CRITERIA[relief.minimise]} from {values} {at_loads(relief)}{also}"
    )


def at_loads(relief: PairRelief) -> str:
    """The load that a value of the relief holds at."""
    if len(relief.loads) > 1:
        return f"at the worst of {len(relief.loads)} loads"
    return f"at {100.0 * relief.loads[0]:g} % of the torque"


def _sure(relief: PairRelief, measures: Measures) -> list[str]:
    """Say under which model the relief was chosen, and what that is worth."""
    if not relief.level:
        return []
    if relief.level == relief.coupling == EXACT:
        return ["Values with relief hold under finite elements, the finest level of the teeth."]
    said = [
        f"Values with relief, and what is proven of them, hold under {relief.level}, coupling "
        f"{relief.coupling}."
    ]
    if judged := relief.judged:
        here, there, plain = (
            _value(relief, value, measures)
            for value in (relief.rows[-1].value, judged.value, judged.without_relief)
        )
        worse = ", more than without any" if judged.value > judged.without_relief else ""
        said.append(
            f"The same flanks judged by {judged.level}: {there}{worse}, where {relief.level} says "
            f"{here}; without relief {plain}. For a relief that is the best by finite elements, "
            "write no level and no coupling in [sharing]."
        )
    if relief.minimise == "peak_to_peak" and (known := relief.in_mesh):
        deep, worth, cost = (
            between(100.0 * least, 100.0 * most)
            for least, _, most in (known.amount, known.judged, known.penalty)
        )
        said.append(
            f"Measured on {PAIRS} random pairs: the amounts of the best linear relief by this "
            f"model were {deep} those by finite elements; the peak to peak that it is said to "
            f"leave was {worth} what these say of its flanks, which was {cost} their least."
        )
    return [*said, relief.unjudged] if relief.unjudged else said


def _strays(relief: PairRelief, measures: Measures) -> str:
    """The largest peak-to-peak on more positions of the gears, where it is larger."""
    if relief.minimise != "peak_to_peak" or not _finer(relief, measures):
        return ""
    return f" ({amount(max(relief.finer_mm), 'um', measures)} at ten times as many positions)"


def _value(relief: PairRelief, value: float, measures: Measures) -> str:
    if relief.minimise in ("load_jump", "peak_load"):
        return f"{share(value)} %"
    return amount(value, "um", measures)


def answers(relief: PairRelief, measures: Measures) -> list[str]:
    """Relief to grind, and its effect at other loads than those it is made for."""
    words = [
        _flank("pinion", relief.pinion, measures),
        _flank("wheel", relief.wheel, measures),
        "Only the sum of what is taken off both flanks where they touch counts: instead of the "
        "tips of one gear the roots of the other may be relieved, at the same points of contact. "
        "Crowning and end relief vary along the face width, which a plane model cannot show.",
    ]
    if relief.break_even is not None:
        words.append(
            f"Below {100.0 * relief.break_even:.3g} % of the torque the gears run more evenly "
            "without relief: a light load does not close the gaps that relief opens."
        )
    words += _finer(relief, measures) + _sure(relief, measures)
    return [*words, _as_made(relief.made, measures)] if relief.made else words


def _finer(relief: PairRelief, measures: Measures) -> list[str]:
    """Say how far the transmission error strays between the positions that were computed."""
    known, finer = max(relief.rows[-1].peak_to_peak_mm), max(relief.finer_mm, default=0.0)
    if finer <= SAME_PEAK_TO_PEAK * known:
        return []
    return [
        "Peak-to-peak values, and what is proven of them, hold at the computed positions of the "
        "gears. At ten times as many the transmission error varies by up to "
        f"{micrometres(finer, measures, 4)} at the loads this relief is made for, not "
        f"{micrometres(known, measures, 4)}."
    ]


def _as_made(made: MadeRelief, measures: Measures) -> str:
    """Say how the relief does as it is ground."""
    off = f"amounts off by up to {micrometres(made.amount_tolerance_mm, measures)}"
    if made.length_tolerance_mm:
        off += f" and lengths by up to {made.length_tolerance_mm:.3g} mm"
    pinion, wheel = (amount(each, "um", measures) for each in made.worst_amounts_mm)
    worst, bound, median, most = (
        micrometres(each, measures, 4)
        for each in (made.worst_mm, made.bound_mm, made.median_mm, made.most_mm)
    )
    return (
        f"As manufactured, with {off}, the transmission error varies by up to {worst}, peak to "
        f"peak, and by no more than {bound} (proven of the computed positions); the worst has "
        f"{pinion} off the pinion and {wheel} off the wheel. Of {made.drawn:,} gear pairs drawn "
        f"at random half stay below {median} and 95 % below {most}."
    )


def _flank(name: str, flank: FlankRelief, measures: Measures) -> str:
    known = {None: "by the profile in the table", 1.0: "linearly", 2.0: "as a parabola"}
    shape = known.get(flank.exponent) or f"with the exponent {flank.exponent:g}"
    if not flank.amount_mm:
        return f"The {name} keeps its involute."
    return (
        f"Grind {amount(flank.amount_mm, 'um', measures)} off the tips of the {name}, normal to "
        f"the flank, growing {shape} from {flank.start_diameter_mm:.3f} mm diameter (roll angle "
        f"{flank.start_roll_angle_deg:.2f}°) to {flank.tip_diameter_mm:.3f} mm "
        f"({flank.tip_roll_angle_deg:.2f}°)."
    )


def grinding(relief: PairRelief, measures: Measures) -> Table:
    """Amounts, diameters and roll angles of both gears."""
    both = relief.pinion, relief.wheel
    rows = [*side_by_side(both, measures), ["exponent", *(_power(f.exponent) for f in both)]]
    return Table("relief", ["", "pinion", "wheel"], rows, "Tip relief to be ground.", across=True)


def _power(exponent: float | None) -> Cell:
    return Cell(exponent, "free" if exponent is None else f"{exponent:g}")


def rules(relief: PairRelief, measures: Measures) -> Table:
    """The relief beside none and beside rules, each in a column."""
    micro, rows = measures.unit("um"), relief.rows
    at = [f"at {100.0 * load:g} %" for load in relief.loads]
    lines: list[list[Any]] = [
        *side_by_side(rows, measures),
        ["exponent", *(_power(r.exponent) for r in rows)],
    ]
    for k, name in enumerate(at):
        values = (cell(r.peak_to_peak_mm[k], "um", measures) for r in rows)
        lines.append([f"peak to peak {name} [{micro}]", *values])
    for k, name in enumerate(at):
        lines.append([f"load jump {name} [%]", *(percent(r.load_jump[k]) for r in rows)])
    caption = (
        "Gears without relief, with relief by two rules, and with this relief. At the torque of "
        "the duty the paper's rule (Hwang and others) takes the full deflection of the pair that "
        "enters or leaves contact as relief of the tips, the corrected rule the deflection of the "
        "pairs that stay in contact. A load jump is the share of the load with which a pair enters "
        "or leaves contact."
    )
    return Table("relief and rules", ["", *(r.name for r in rows)], lines, caption, across=True)


def after(contact: PairContact, relief: PairRelief, measures: Measures) -> Table:
    """Peak to peak, first harmonic and largest load at every load, before and after."""
    micro, force = measures.unit("um"), measures.unit("N")
    rows = []
    for when, loads in (("without", contact.loads), ("with", relief.at)):
        figures = {
            f"peak to peak [{micro}]": [(load.peak_to_peak_mm, "um") for load in loads],
            f"first harmonic [{micro}]": [(load.harmonics_mm[0], "um") for load in loads],
            f"largest load on a tooth [{force}]": [(o.largest_tooth_force_N, "N") for o in loads],
        }
        for words, values in figures.items():
            rows.append([f"{words}, {when}", *(cell(*value, measures) for value in values)])
    names = [f"{100.0 * load.load:g} %" for load in relief.at]
    caption = "Transmission error and load of a tooth at every load, without and with relief."
    return Table("without and with relief", ["", *names], rows, caption, across=True)


def profile(contact: PairContact, relief: PairRelief, measures: Measures) -> Table:
    """Modified profiles by position, diameter and roll angle."""
    listed: Columns = [
        ("s", contact.position_mm, "mm"),
        ("pinion diameter", contact.pinion_diameter_mm, "mm"),
        ("pinion roll angle", contact.pinion_roll_angle_deg, "deg"),
        ("off the pinion", relief.pinion_removed_mm, "um"),
        ("wheel diameter", contact.wheel_diameter_mm, "mm"),
        ("wheel roll angle", contact.wheel_roll_angle_deg, "deg"),
        ("off the wheel", relief.wheel_removed_mm, "um"),
    ]
    for load in relief.at:
        listed.append((f"share of the load at {100.0 * load.load:g} %", load.share, ""))
    return columns("modified profile", listed, measures)


@dataclass(frozen=True)
class Flank:
    """The flanks of one gear: their relief, base diameter [mm], and columns along the path.

    rolls [deg] and listed [mm]: roll angles and what is removed there.
    """

    member: str
    relief: FlankRelief
    base: float
    rolls: Sequence[float]
    listed: Sequence[float]

    def removed(self, roll: Any) -> Any:
        """Amounts removed [mm] at roll angles [deg], 0 where there is no relief.

        amount (1 - x/length)^exponent at x from the tip on the line of action, along which roll
        angles grow evenly; of a shape of its own between the points that are listed.
        """
        relief = self.relief
        if relief.exponent is None:
            order = np.argsort(self.rolls)
            return np.interp(roll, np.asarray(self.rolls)[order], np.asarray(self.listed)[order])
        share = (np.asarray(roll) - relief.start_roll_angle_deg) / (
            relief.tip_roll_angle_deg - relief.start_roll_angle_deg
        )
        return relief.amount_mm * np.maximum(share, 0.0) ** relief.exponent

    def at(self, count: int) -> Any:
        """Roll angles [deg] from where the relief starts to the tip, in equal steps."""
        return np.linspace(
            self.relief.start_roll_angle_deg, self.relief.tip_roll_angle_deg, count + 1
        )


def flanks(contact: PairContact, relief: PairRelief, pair: GearPair) -> list[Flank]:
    """The flanks of both gears that are ground."""
    bases = (float(gear.base_diameter) for gear in pair.gears)
    reliefs = (relief.pinion, relief.wheel)
    rolls = (contact.pinion_roll_angle_deg, contact.wheel_roll_angle_deg)
    listed = (relief.pinion_removed_mm, relief.wheel_removed_mm)
    rows = zip(MEMBERS, reliefs, bases, rolls, listed, strict=True)
    return [Flank(*row) for row in rows if row[1].amount_mm]


def diameter_at(base: float, roll: Any) -> Any:
    """Diameters d_b sqrt(1 + xi^2) [mm] at roll angles xi [deg]; base diameter d_b [mm]."""
    return base * np.hypot(1.0, np.radians(roll))


def steps(flank: Flank, measures: Measures) -> Table:
    """List what is ground off, from where the relief starts to the tip."""
    heads = (
        *(f"diameter [{measures.unit('mm')}]", "roll angle [°]"),
        f"removed [{measures.unit('um')}]",
    )
    rows, fine = [], 2 + 2 * measures.digits  # decimals of a micrometre, or of a mil
    for roll in flank.at(TABLE_STEPS):
        off = measures.of(float(flank.removed(roll)), "um")
        rows.append(
            [
                Cell(*_length(float(diameter_at(flank.base, roll)), measures)),
                Cell(float(roll), f"{roll:.3f}"),
                Cell(off, f"{off:.{fine}f}"),
            ]
        )
    name = flank.member
    return Table(f"{name} profile", heads, rows, f"Relief along the flanks of the {name}.", left=0)


def _length(value: float, measures: Measures) -> tuple[float, str]:
    """A diameter as a measuring machine wants it: to a micrometre."""
    return measures.of(value, "mm"), measures.length(value, 3)


def profile_plot(flank: Flank, measures: Measures) -> Figure:
    """Plot what is removed from a flank against its roll angle, with diameters above."""
    start, tip = flank.relief.start_roll_angle_deg, flank.relief.tip_roll_angle_deg
    member, low = flank.member, start - 0.35 * (tip - start)
    rolls = np.concatenate(([low], flank.at(PLOT_STEPS)))
    off = measures.of(1.0, "um") * flank.removed(rolls)
    x, y = [round(float(v), 5) for v in rolls], [round(float(v), 4) for v in off]
    colour = series(SERIES_OF_MEMBERS[MEMBERS.index(member)])
    trace = lines(x, y, colour, hover="%{x:.3f}°: %{y:.2f}<extra></extra>")
    trace |= {"name": member, "fill": "tozeroy", "showlegend": False}
    ticks = np.linspace(start, tip, TICKS)
    above = trace | {"xaxis": "x2", "opacity": 0.0, "hoverinfo": "skip", "fill": "none"}
    del above["hovertemplate"]
    unit, micro = measures.unit("mm"), measures.unit("um")
    ends = [float(low), float(tip + 0.02 * (tip - low))]
    plot = layout(
        axis(f"roll angle of the {member} [°]", range=ends),
        axis(f"removed [{micro}]", rangemode="tozero"),
        280,
        xaxis2=axis(
            f"diameter of the {member} [{unit}]",
            overlaying="x",
            side="top",
            matches="x",
            tickvals=[float(t) for t in ticks],
            ticktext=[measures.length(float(diameter_at(flank.base, t))) for t in ticks],
            showgrid=False,
        ),
    )
    power = flank.relief.exponent
    shape = {1.0: "growing linearly", None: "a free, convex shape"}.get(power, f"exponent {power}")
    caption = f"Relief of the flanks of the {member}, normal to them: {shape}."
    return Figure([trace, above], plot, caption)


def harmonics(contact: PairContact, relief: PairRelief, measures: Measures) -> Section:
    """Plot harmonics of the transmission error before and after at up to PANELS loads."""
    rows = list(zip(contact.loads, relief.at, strict=True))
    if len(rows) > PANELS:
        duty = contact.loads.index(of_duty(contact.loads))
        rows = [rows[k] for k in sorted({0, duty, len(rows) - 1})]
    figure = _bars(rows, contact, relief, measures)
    return Section(
        "Harmonics of the transmission error",
        words=(HARMONICS_WORDS,),
        figures=(figure,),
        appendix=True,
    )


def _bars(
    rows: Sequence[tuple[ContactLoad, ContactLoad]],
    contact: PairContact,
    relief: PairRelief,
    measures: Measures,
) -> Figure:
    """Plot one panel of bars a load, all with one scale."""
    wide = (1.0 - PANEL_GAP * (len(rows) - 1)) / len(rows)
    micro, traces, axes, notes = measures.of(1.0, "um"), [], {}, []
    for k, (before, after) in enumerate(rows):
        name = "x" if k == 0 else f"x{k + 1}"
        start = k * (wide + PANEL_GAP)
        order = list(range(1, len(before.harmonics_mm) + 1))
        colour = series(contact.loads.index(before) + 1)
        for said, load, paint in (("without", before, "--axis"), ("with", after, colour)):
            heights = [round(micro * v, 5) for v in load.harmonics_mm]
            look = {"name": f"{said} relief", "xaxis": name, "marker": {"color": paint}}
            traces.append(BARS | look | {"x": order, "y": heights})
        axes[f"xaxis{name[1:]}"] = axis(
            "multiple of the mesh frequency",
            domain=[start, min(1.0, start + wide)],
            dtick=1,
            range=[0.4, len(order) + 0.6],
        )
        suits = ", made for it" if any(math.isclose(before.load, w) for w in relief.loads) else ""
        place = {"x": start + 0.5 * wide, "xref": "paper", "xanchor": "center"}
        place |= {"y": 1.0, "yref": "paper", "yanchor": "bottom", "showarrow": False}
        notes.append(place | {"text": f"at {100.0 * before.load:g} %{suits}"})
    first = axes.pop("xaxis")
    up = axis(f"amplitude [{measures.unit('um')}]", rangemode="tozero")
    plot = layout(first, up, 320, annotations=notes, barmode="group", bargap=0.25, **axes)
    plot["margin"] |= {"t": 30}
    return Figure(traces, plot, "Harmonics at each load, relative to the duty's torque.")
