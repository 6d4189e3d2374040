"""The relief of a spur pair drawn: profiles to grind, harmonics before and after."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.formulations.pair.contact import ContactLoad, PairContact
from gearopt.formulations.pair.relief_map import FlankRelief, PairRelief
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.report.drawing.sheet import series
from gearopt.report.kinds.pair.words import of_duty
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure, axis, layout, lines
from gearopt.report.section import Cell, Section, Table

TABLE_STEPS = 10  # of the table from where a relief starts to the tip
PLOT_STEPS = 60  # of its plot
TICKS = 6  # diameters above a plot
PANELS = 4  # loads whose harmonics stand side by side, at most
GAP = 0.04  # between them, of the width
BARS = {"type": "bar", "hovertemplate": "%{y:.3f}", "showlegend": False}
HEARD = (
    "Amplitudes of the transmission error at the mesh frequency and its multiples: grey without "
    "relief, coloured with it."
)


@dataclass(frozen=True)
class Flank:
    """The flanks of one gear: their relief, base diameter [mm], and columns along the path.

    rolls [deg] and listed [mm]: roll angles and what is removed there.
    """

    member: str
    told: FlankRelief
    base: float
    rolls: Sequence[float]
    listed: Sequence[float]

    def removed(self, roll: Any) -> Any:
        """Return what is removed [mm] at roll angles [deg], 0 where there is no relief.

        amount (1 - x/length)^exponent at x from the tip on the line of action, along which roll
        angles grow evenly; of a shape of its own between the points that are listed.
        """
        told = self.told
        if told.exponent is None:
            order = np.argsort(self.rolls)
            return np.interp(roll, np.asarray(self.rolls)[order], np.asarray(self.listed)[order])
        share = (np.asarray(roll) - told.start_roll_angle_deg) / (
            told.tip_roll_angle_deg - told.start_roll_angle_deg
        )
        return told.amount_mm * np.maximum(share, 0.0) ** told.exponent

    def at(self, count: int) -> Any:
        """Return roll angles [deg] from where the relief starts to the tip, in equal steps."""
        return np.linspace(self.told.start_roll_angle_deg, self.told.tip_roll_angle_deg, count + 1)


def flanks(found: PairContact, relief: PairRelief, pair: GearPair) -> list[Flank]:
    """Return the flanks of both gears that are ground."""
    bases = (float(gear.base_diameter) for gear in pair.gears)
    told = (relief.pinion, relief.wheel)
    rolls = (found.pinion_roll_angle_deg, found.wheel_roll_angle_deg)
    listed = (relief.pinion_removed_mm, relief.wheel_removed_mm)
    rows = zip(MEMBERS, told, bases, rolls, listed, strict=True)
    return [Flank(*row) for row in rows if row[1].amount_mm]


def diameter_at(base: float, roll: Any) -> Any:
    """Return diameters d_b sqrt(1 + xi^2) [mm] at roll angles xi [deg]; base diameter d_b [mm]."""
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
    return Table(f"{name} profile", heads, rows, f"Flanks of the {name}.", left=0)


def _length(value: float, measures: Measures) -> tuple[float, str]:
    """Return a diameter as a measuring machine wants it: to a micrometre."""
    return measures.of(value, "mm"), measures.length(value, 3)


def profile(flank: Flank, measures: Measures) -> Figure:
    """Plot what is removed from a flank against its roll angle, with diameters above."""
    start, tip = flank.told.start_roll_angle_deg, flank.told.tip_roll_angle_deg
    member, low = flank.member, start - 0.35 * (tip - start)
    rolls = np.concatenate(([low], flank.at(PLOT_STEPS)))
    off = measures.of(1.0, "um") * flank.removed(rolls)
    x, y = [round(float(v), 5) for v in rolls], [round(float(v), 4) for v in off]
    colour = series((1, 4)[MEMBERS.index(member)])
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
    power = flank.told.exponent
    shape = {1.0: "growing linearly", None: "a free, convex shape"}.get(power, f"exponent {power}")
    caption = f"What is removed from the flanks of the {member}, normal to them: {shape}."
    return Figure([trace, above], plot, caption)


def harmonics(found: PairContact, relief: PairRelief, measures: Measures) -> Section:
    """Plot harmonics of the transmission error before and after at up to PANELS loads."""
    rows = list(zip(found.loads, relief.at, strict=True))
    if len(rows) > PANELS:
        duty = found.loads.index(of_duty(found))
        rows = [rows[k] for k in sorted({0, duty, len(rows) - 1})]
    figure = _bars(rows, found, relief, measures)
    return Section("Harmonics of the transmission error", words=(HEARD,), figures=(figure,))


def _bars(
    rows: Sequence[tuple[ContactLoad, ContactLoad]],
    found: PairContact,
    relief: PairRelief,
    measures: Measures,
) -> Figure:
    """Plot one panel of bars a load, all with one scale."""
    wide = (1.0 - GAP * (len(rows) - 1)) / len(rows)
    micro, traces, axes, notes = measures.of(1.0, "um"), [], {}, []
    for k, (before, after) in enumerate(rows):
        name = "x" if k == 0 else f"x{k + 1}"
        start = k * (wide + GAP)
        order = list(range(1, len(before.harmonics_mm) + 1))
        colour = series(found.loads.index(before) + 1)
        for said, one, paint in (("without", before, "--axis"), ("with", after, colour)):
            heights = [round(micro * v, 5) for v in one.harmonics_mm]
            own = {"name": f"{said} relief", "xaxis": name, "marker": {"color": paint}}
            traces.append(BARS | own | {"x": order, "y": heights})
        axes[f"xaxis{name[1:]}"] = axis(
            "multiple of the mesh frequency",
            domain=[start, min(1.0, start + wide)],
            dtick=1,
            range=[0.4, len(order) + 0.6],
        )
        made = ", made for it" if any(math.isclose(before.load, w) for w in relief.loads) else ""
        place = {"x": start + 0.5 * wide, "xref": "paper", "xanchor": "center"}
        place |= {"y": 1.0, "yref": "paper", "yanchor": "bottom", "showarrow": False}
        notes.append(place | {"text": f"at {100.0 * before.load:g} %{made}"})
    first = axes.pop("xaxis")
    up = axis(f"amplitude [{measures.unit('um')}]", rangemode="tozero")
    plot = layout(first, up, 320, annotations=notes, barmode="group", bargap=0.25, **axes)
    plot["margin"] |= {"t": 30}
    return Figure(traces, plot, "Harmonics at each load, relative to the duty's torque.")
