"""Plots of a pair on moving axes: response, spectrum, orbit, stability, speeds."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.formulations.dynamics.design import (
    TRANSMISSION,
    Chosen,
    DynamicErrors,
    Response,
    Speeds,
    Stability,
    StandardFactors,
)
from gearopt.formulations.dynamics.motion.stability import UNSTABLE, bands
from gearopt.report.drawing.player import Animation, Body, Reading, View
from gearopt.report.drawing.sheet import Sheet, Window, around, series
from gearopt.report.measures import Measures
from gearopt.report.plots import Figure, axis, band, heat, layout, lines, upright

ORBIT = "motion of the axes"  # the animation that the response follows
MOMENTS = 240  # of the animation
SECONDS = 12.0  # in which it passes at normal speed
LATER_PART = 0.5  # of the response that it shows: the later half
SIZE = 300.0  # px of a view of an orbit
AXIS_MARGIN = 1.15  # of the largest displacement that a view shows
DOT, CORNERS = 5.0, 20  # px and corners of the point that moves
HEIGHT = 320  # px of a plot
ORDERS = 200  # of the mesh frequency that a spectrum marks; more would cover it
QUIET, LOUD = "--card", "--series-1"  # ends of a map's colours
Values = Sequence[Any]


def line(
    x: Values, y: Values, name: str = "", colour: int = 1, dash: str = "solid"
) -> dict[str, Any]:
    """A curve of the series' colour of this number."""
    hover, named = "%{x:.5g}: %{y:.4g}", bool(name)
    return lines(x, y, series(colour), 1.8, dash, hover=hover, name=name, showlegend=named)


def response(motion: Response, measures: Measures) -> Figure:
    """Plot the deformation over time; the line at zero is where teeth part."""
    micro = _micro(motion.deformation_mm, measures)
    plot = layout(
        axis("time [ms]"), axis(f"deformation δ [{measures.unit('um')}]"), HEIGHT, hovermode="x"
    )
    plot["shapes"] = [_across(0.0)]
    caption = "Deformation of the mesh, negative under compression; above the line teeth part."
    follows = ORBIT if motion.axes_mm else ""
    traces = [line(motion.time_ms, micro)]
    if errors := motion.transmission_error:
        lag = _micro(errors.values_mm, measures)
        traces.append(line(motion.time_ms, lag, "", 2, "dash"))
        caption += f" Dashed: the {TRANSMISSION}, by which the driven gear lags behind."
    return Figure(traces, plot, caption, follows=follows)


def load(motion: Response, measures: Measures) -> Figure:
    """Plot the load on the teeth over time."""
    force = measures.unit("N")
    values = [float(f"{measures.of(v, 'N'):.6g}") for v in motion.load_N]
    plot = layout(axis("time [ms]"), axis(f"tooth load [{force}]"), HEIGHT, hovermode="x")
    plot["shapes"] = [_across(0.0)]
    caption = "Load on the teeth: zero while they are apart, negative on the coast flank."
    return Figure([line(motion.time_ms, values)], plot, caption)


def dynamic_factors(speeds: Speeds, standard: StandardFactors) -> Figure:
    """Plot the dynamic factor over speed, with K_v of the standards."""
    falling = speeds.falling_dynamic_factor or speeds.dynamic_factor
    two = falling != speeds.dynamic_factor
    name = "motion, speed rising" if two else "motion"
    curves = [(name, speeds.dynamic_factor, "solid")]
    curves += [("motion, speed falling", falling, "dash")] if two else []
    curves += [("K_v, ISO 6336-1", standard.iso, "dot")] if standard.iso else []
    curves += [("K_v, AGMA 2001-D04", standard.agma, "dashdot")] if standard.agma else []
    traces = [
        line(speeds.speed_rpm, values, called, k, dash)
        for k, (called, values, dash) in enumerate(curves, 1)
    ]
    ends = axis("dynamic factor")
    plot = layout(axis("speed of the pinion [rpm]", tickformat=","), ends, HEIGHT, hovermode="x")
    plot["margin"] |= {"t": 44}
    caption = "Dynamic factor over speed: the largest tooth load over the normal load"
    return Figure(traces, plot, caption + (", beside K_v." if len(curves) > 1 + two else "."))


def spectrum(motion: Response, mesh_frequency: float, measures: Measures) -> Figure:
    """Plot the amplitudes of the second half over frequency, with the mesh frequency's orders."""
    micro = _micro(motion.amplitude_mm, measures)
    high = motion.frequency_Hz[-1]
    plot = layout(
        axis("frequency [Hz]"),
        axis(f"amplitude [{measures.unit('um')}]", type="log", dtick=2, exponentformat="power"),
        HEIGHT,
        hovermode="x",
    )
    drawn = mesh_frequency > 0.0 and high <= ORDERS * mesh_frequency
    orders = range(1, int(high / mesh_frequency) + 1) if drawn else range(0)
    plot["shapes"] = [upright(k * mesh_frequency) for k in orders]
    caption = "Spectrum of the second half of the motion, of the deformation"
    caption += "; dotted: the mesh frequency and its multiples." if drawn else "."
    kept = [max(v, 1e-9) for v in micro]
    return Figure([line(motion.frequency_Hz, kept)], plot, caption)


def orbit(motion: Response, measures: Measures) -> Animation:
    """Show the axes of both gears moving about their places at rest, much enlarged."""
    x1, y1, x2, y2 = (np.asarray(c) for c in motion.axes_mm)
    time = np.asarray(motion.time_ms)
    first = int((1.0 - LATER_PART) * (len(time) - 1))
    shown = np.unique(np.linspace(first, len(time) - 1, MOMENTS).astype(int))
    later = slice(first, len(time))
    views = []
    for k, (name, x, y) in enumerate((("pinion", x1, y1), ("wheel", x2, y2))):
        views.append(_view(name, x[later], y[later], x[shown], y[shown], 1 + 3 * k, measures))
    delta = np.asarray(motion.deformation_mm)[shown]
    unit = measures.unit("um")
    readings = [
        Reading("time", time[shown], "ms", 3),
        Reading("deformation", np.array(_micro(delta, measures)), unit, 2),
    ]
    times = (time[shown] - time[shown[0]]) * SECONDS / (time[-1] - time[first])
    caption = (
        "Each axis moves on its bearings, here over the second half of the time. The views are "
        "enlarged, each to its own scale; the crossing of the thin lines is the unloaded place."
    )
    return Animation(ORBIT, views, times, caption, readings, marks=time[shown])


def _view(
    name: str, track_x: Any, track_y: Any, x: Any, y: Any, colour: int, measures: Measures
) -> View:
    """Draw the track of an axis, and the point that moves on it."""
    ends = np.array([min(track_x.min(), 0.0), max(track_x.max(), 0.0)])
    tops = np.array([min(track_y.min(), 0.0), max(track_y.max(), 0.0)])
    half = 0.5 * AXIS_MARGIN * max(np.ptp(ends), np.ptp(tops), 1e-9)
    cx, cy = ends.mean(), tops.mean()
    free = (16.0, 16.0, 30.0, 16.0)
    window = Window(cx - half, cx + half, cy - half, cy + half, free)
    sheet = Sheet(window, window.scale(SIZE, SIZE))
    sheet.line((window.left, 0.0), (window.right, 0.0), "axis")
    sheet.line((0.0, window.bottom), (0.0, window.top), "axis")
    thin = max(1, len(track_x) // 600)
    track = np.stack([track_x, track_y], axis=1)[::thin]
    dot = [
        (DOT / sheet.scale * math.cos(a), DOT / sheet.scale * math.sin(a))
        for a in np.linspace(0.0, 2.0 * math.pi, CORNERS, endpoint=False)
    ]
    places = np.stack([x, y, np.zeros_like(x)], axis=1)
    bodies = [Body(track, style="tip", colour=series(colour), title="track", line=True)]
    mover = [Body(dot, places, "picked", "--ink", f"axis of the {name}")]
    scale = _round(half)
    length = measures.of(scale, "um")
    left = window.left + 0.04 * half
    low = window.bottom - 14.0 / sheet.scale
    sheet.line((left, low), (left + scale, low), "size")
    text = f"{length:,.4g} {measures.unit('um')}"
    sheet.label(text, around(sheet.at(left + 0.5 * scale, low), (12.0, 16.0)), "size")
    return View(sheet, f"axis of the {name}", bodies, mover, f"Axis of the {name}")


def _round(length: float) -> float:
    """A round number of at most a length: 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(k * power for k in (1.0, 2.0, 5.0) if k * power <= length)


def stability(chart: Stability) -> Figure:
    """Draw the map of unstable depths and mesh frequencies with the pair's own point."""
    growth = np.asarray(chart.growth)
    size = [[max(0.0, min(float(v) - 1.0, 1.0)) or None for v in row] for row in growth]
    share = [[None if v is None else 100.0 * v for v in row] for row in size]
    hover = "%{x:.4g} kHz, depth %{y:.3g}: +%{z:.3g} % a period"
    colours = [[0.0, "--series-2/0.35"], [1.0, "--series-2"]]
    frequencies = [f / 1e3 for f in chart.frequency_Hz]
    traces = [heat(frequencies, chart.depth, share, "growth [%]", hover, colorscale=colours)]
    for tongue in chart.tongues:
        x = tongue.frequency_Hz / 1e3
        half = x * tongue.half_width_percent / 100.0 * chart.depth[-1] / chart.own_depth
        look = line([x - half, x, x + half], [chart.depth[-1], 0.0, chart.depth[-1]], "", 1, "dot")
        traces.append(look | {"hoverinfo": "skip", "opacity": 0.7})
    if chart.own_frequency_Hz > 0.0:
        point = line([chart.own_frequency_Hz / 1e3], [chart.own_depth], "this pair")
        point |= {"mode": "markers", "marker": {"color": "--ink", "size": 10, "symbol": "x"}}
        traces.append(point)
    low, high = (chart.frequency_Hz[k] / 1e3 for k in (0, -1))
    plot = layout(
        axis("mesh frequency [kHz]", range=[low, high]),
        axis("depth of the stiffness wave", range=[0.0, chart.depth[-1]]),
        HEIGHT + 40,
    )
    caption = (
        "Coloured: the motion of teeth in contact grows without limit; colour: growth per mesh "
        "period. Dotted: instability tongues by the first-order formulas, without damping."
    )
    return Figure(traces, plot, caption)


def vibrations(speeds: Speeds) -> list[DynamicErrors]:
    """Transmission errors over speed, rising and, where it was followed, falling.

    Of teeth without errors the deformation, which is the same but for its sign.
    """
    lags = speeds.transmission_error, speeds.falling_transmission_error
    if any(lags):
        return [lag for lag in lags if lag]
    rows = (
        (speeds.rms_mm, speeds.peak_to_peak_mm, speeds.highest_mm),
        (speeds.falling_rms_mm, speeds.falling_peak_to_peak_mm, speeds.falling_highest_mm),
    )
    return [
        DynamicErrors(rms_mm=rms, peak_to_peak_mm=height, highest_mm=most)
        for rms, height, most in rows
        if rms
    ]


def over_speed(speeds: Speeds, measures: Measures) -> Figure:
    """Plot the RMS of the vibration over speed, rising and falling where they differ."""
    both = vibrations(speeds)
    of = TRANSMISSION if speeds.transmission_error else "deformation"
    rising, falling = ([_shown(v, measures) for v in both[k].rms_mm] for k in (0, -1))
    two = falling != rising
    traces = [line(speeds.speed_rpm, rising, "speed rising" if two else "")]
    if two:
        traces.append(line(speeds.speed_rpm, falling, "speed falling", 2, "dash"))
    curves = [(rising, speeds.repeats), (falling, speeds.falling_repeats)]
    longer = {
        (n, v)
        for values, repeats in curves[: 1 + two]
        for n, v, r in zip(speeds.speed_rpm, values, repeats, strict=True)
        if r != 1 and v is not None
    }
    if longer:
        places = [[point[k] for point in sorted(longer)] for k in range(2)]
        marks = line(places[0], places[1], "several periods, or no repetition")
        look = {"color": "--ink", "size": 5, "symbol": "circle-open"}
        traces.append(marks | {"mode": "markers", "marker": look})
    plot = layout(
        axis("speed of the pinion [rpm]", tickformat=","),
        _measured(f"RMS of the {of} about its mean", measures),
        HEIGHT,
        hovermode="x",
    )
    unstable = [g > 1.0 + UNSTABLE for g in speeds.growth]
    half = 0.5 * (speeds.speed_rpm[1] - speeds.speed_rpm[0])
    ends = bands(speeds.speed_rpm, unstable)
    plot["shapes"] = [band(low - half, high + half, series(2), opacity=0.12) for low, high in ends]
    if len(traces) > 1:
        plot["margin"] |= {"t": 44}
    caption = f"Motions over speed: RMS of the {of} about its mean."
    if any(unstable):
        caption += " Shaded: teeth in contact are unstable."
    return Figure(traces, plot, caption)


def waterfall(speeds: Speeds, measures: Measures) -> Figure:
    """Draw the orders of the mesh frequency over speed."""
    values = [[_shown(v, measures) for v in row] for row in speeds.harmonics_mm]
    unit, orders = measures.unit("um"), range(1, len(values) + 1)
    logs = [[v and math.log10(max(v, 1e-4)) for v in row] for row in values]
    colours = [[0.0, QUIET], [1.0, LOUD]]
    hover, title = "%{x:.5g} rpm, order %{y}: %{customdata:.3g} " + unit, f"lg amplitude [{unit}]"
    trace = heat(
        speeds.speed_rpm, orders, logs, title, hover, customdata=values, colorscale=colours
    )
    plot = layout(
        axis("speed of the pinion [rpm]", tickformat=","),
        axis("order of the mesh frequency", dtick=1),
        HEIGHT,
    )
    caption = (
        "Waterfall of the deformation: amplitudes of the orders of the mesh frequency over speed"
    )
    caption += ", speed rising." if speeds.falling_rms_mm not in ((), speeds.rms_mm) else "."
    return Figure([trace], plot, caption)


def before_and_after(best: Chosen, measure: str, measures: Measures) -> Figure:
    """Plot the measure that is minimised over all speeds, of the file's pair and of the best."""
    after = _micro(best.dense_mm, measures)
    traces = [
        line(
            best.dense_rpm,
            [_shown(v, measures) for v in best.before_mm],
            "the pair of the file",
            4,
            "dash",
        ),
        line(best.dense_rpm, after, "least vibration", 1),
    ]
    alone = set(best.before_mm) == {None}  # where the run was stopped
    traces = traces[alone:]
    judged = [float(np.interp(n, best.dense_rpm, after)) for n in best.speed_rpm]
    marks = line(best.speed_rpm, judged, "speeds of the problem")
    traces.append(marks | {"mode": "markers", "marker": {"color": series(1), "size": 6}})
    plot = layout(
        axis("speed of the pinion [rpm]", tickformat=","),
        _measured(measure, measures),
        HEIGHT,
        hovermode="x",
    )
    plot["margin"] |= {"t": 44}
    pairs = (
        "pair of least vibration" if alone else "pair of the file and of that of least vibration"
    )
    caption = f"{measure[0].upper()}{measure[1:]} over speed, of the {pairs}; "
    caption += "only the marked speeds enter the objective."
    return Figure(traces, plot, caption)


def _measured(measure: str, measures: Measures) -> dict[str, Any]:
    """An axis from zero; a long title stands in two lines, since a plot is no higher."""
    title = f"{measure} [{measures.unit('um')}]".replace(" about ", "<br>about ")
    return axis(title, rangemode="tozero")


def _micro(values: Values | Any, measures: Measures) -> list[float]:
    return [float(f"{measures.of(float(v), 'um'):.6g}") for v in values]


def _shown(value: float | None, measures: Measures) -> float | None:
    return None if value is None else _micro([value], measures)[0]


def _across(level: float) -> dict[str, Any]:
    look = {"color": "--axis", "width": 1}
    ends = {"x0": 0.0, "x1": 1.0, "y0": level, "y1": level}
    return {"type": "line", "xref": "paper", "line": look} | ends
