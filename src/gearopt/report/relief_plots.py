"""The relief of a spur pair drawn: profiles to grind, harmonics before and after."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.formulations.pair_contact import ContactLoad, PairContact
from gearopt.formulations.pair_relief import FlankRelief, PairRelief
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.report.measures import Measures
from gearopt.report.pages.sheet import series
from gearopt.report.pair_words import of_duty
from gearopt.report.section import Cell, Figure, Section, Table, axis, layout

STEPS = 10  # of the table from where a relief starts to the tip
FINE = 60  # of its plot
TICKS = 6  # diameters above a plot
PANELS = 4  # loads whose harmonics stand side by side, at most
GAP = 0.04  # between them, of the width
HEARD = (
    "Amplitudes of the transmission error at the mesh frequency and its multiples: grey without "
    "relief, coloured with it."
)


def profiles(relief: PairRelief, pair: GearPair, measures: Measures) -> list[Figure]:
    """Plot what is ground off the flanks of each gear, if anything, against its roll angle."""
    return [
        _profile(member, flank, base, k, measures)
        for k, (member, flank, base) in enumerate(_flanks(relief, pair))
        if flank.amount_mm
    ]


def steps(relief: PairRelief, pair: GearPair, measures: Measures) -> list[Table]:
    """List what is ground off the flanks of each gear, if anything, from start to tip."""
    return [
        _table(member, flank, base, measures)
        for member, flank, base in _flanks(relief, pair)
        if flank.amount_mm
    ]


def _flanks(relief: PairRelief, pair: GearPair) -> list[tuple[str, FlankRelief, float]]:
    """Return members, their reliefs, and their base diameters [mm]."""
    bases = (float(gear.base_diameter) for gear in pair.gears)
    return list(zip(MEMBERS, (relief.pinion, relief.wheel), bases, strict=True))


def removed(flank: FlankRelief, roll: Any) -> Any:
    """Return what is removed [mm] at roll angles [deg] of a flank, 0 where it is not relieved.

    amount (1 - x/length)^exponent at x from the tip on the line of action, along which roll angles
    grow evenly.
    """
    share = (np.asarray(roll) - flank.start_roll_angle_deg) / (
        flank.tip_roll_angle_deg - flank.start_roll_angle_deg
    )
    return flank.amount_mm * np.maximum(share, 0.0) ** flank.exponent


def diameter_at(base: float, roll: Any) -> Any:
    """Return diameters d_b sqrt(1 + xi^2) [mm] at roll angles xi [deg]; base diameter d_b [mm]."""
    return base * np.hypot(1.0, np.radians(roll))


def _rolls(flank: FlankRelief, count: int) -> Any:
    return np.linspace(flank.start_roll_angle_deg, flank.tip_roll_angle_deg, count + 1)


def _table(member: str, flank: FlankRelief, base: float, measures: Measures) -> Table:
    """List a relief from its start to the tip, in equal steps of the roll angle."""
    heads = (
        *(f"diameter [{measures.unit('mm')}]", "roll angle [°]"),
        f"removed [{measures.unit('um')}]",
    )
    rows, fine = [], 2 + 2 * measures.digits  # decimals of a micrometre, or of a mil
    for roll in _rolls(flank, STEPS):
        off = float(removed(flank, roll))
        rows.append(
            [
                Cell(*_length(float(diameter_at(base, roll)), measures)),
                Cell(float(roll), f"{roll:.3f}"),
                Cell(measures.of(off, "um"), f"{measures.of(off, 'um'):.{fine}f}"),
            ]
        )
    return Table(f"{member} profile", heads, rows, f"Flanks of the {member}.", left=0)


def _length(value: float, measures: Measures) -> tuple[float, str]:
    """Return a diameter as a measuring machine wants it: to a micrometre."""
    return measures.of(value, "mm"), measures.length(value, 3)


def _profile(member: str, flank: FlankRelief, base: float, k: int, measures: Measures) -> Figure:
    """Plot what is removed from a flank against the roll angle, with diameters above."""
    start, tip = flank.start_roll_angle_deg, flank.tip_roll_angle_deg
    low = start - 0.35 * (tip - start)
    rolls = np.concatenate(([low], _rolls(flank, FINE)))
    off = measures.of(1.0, "um") * removed(flank, rolls)
    trace = {
        "type": "scatter",
        "mode": "lines",
        "name": member,
        "x": [round(float(v), 5) for v in rolls],
        "y": [round(float(v), 4) for v in off],
        "line": {"color": series((1, 4)[k]), "width": 2},
        "fill": "tozeroy",
        "hovertemplate": "%{x:.3f}°: %{y:.2f}<extra></extra>",
        "showlegend": False,
    }
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
            ticktext=[measures.length(float(diameter_at(base, t))) for t in ticks],
            showgrid=False,
        ),
    )
    shape = "linearly" if flank.exponent == 1.0 else f"with the exponent {flank.exponent:g}"
    caption = f"What is removed from the flanks of the {member}, normal to them, growing {shape}."
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
            traces.append(
                {
                    "type": "bar",
                    "name": f"{said} relief",
                    "x": order,
                    "y": [round(micro * v, 5) for v in one.harmonics_mm],
                    "xaxis": name,
                    "marker": {"color": paint},
                    "hovertemplate": "%{y:.3f}",
                    "showlegend": False,
                }
            )
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
