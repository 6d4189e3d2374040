"""Contact over the flank: pictures of load and pressure, contact lines, errors, words, tables."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.pair.flank_design import FlankContact, FlankLoad
from gearopt.optimise.result import Result
from gearopt.optimise.typed import held
from gearopt.physics.gears import MEMBERS
from gearopt.report.drawing.sheet import series
from gearopt.report.kinds.pair.contact import (
    DASHES,
    STIFFNESS,
    Columns,
    columns,
    load_table,
    travel,
)
from gearopt.report.kinds.pair.words import of_duty
from gearopt.report.measures import METRIC, Measures, rounded
from gearopt.report.plots import Figure, axis, heat, layout
from gearopt.report.plots import lines as curve
from gearopt.report.section import Section, Table, Tile
from gearopt.report.words import amount, micrometres, number, series_of, share

IDLE = 0.005  # part of the contact lines that carries nothing, from which on it is told
EVEN = 5e-4  # of a face load factor: nearer to 1 it is even
HEIGHT = 380  # px
# errors on three pairs against finite elements in space: docs/helical_pairs.md
MEASURED = (
    "Accuracy: on three helical pairs of steel gears, with helix angles from 12 to 25 degrees, and "
    'with coupling = "finite elements", the mean stiffness was from 4 % below to 2 % above that by '
    "finite elements of whole gears in space, the peak-to-peak transmission error from 3 % below "
    "to 11 % above, and the load along the contact lines off by 8 to 10 % rms."
)
SOFTER = (
    "Accuracy: on three helical pairs of steel gears, with helix angles from 12 to 25 degrees, and "
    'with coupling = "ring torsion", as here, the mean stiffness was 3 to 11 % above that by '
    "finite elements of whole gears in space, the peak-to-peak transmission error 25 to 38 % "
    "above, and the load along the contact lines off by 7 to 9 % rms: write "
    'coupling = "finite elements" in [sharing].'
)
CAPTION = (
    "Line load, contact stress, transmission error and stiffness at each load; s from the pitch "
    "point, y from the middle of the face towards the end where contact begins. Without tip relief "
    "the largest stress is that at ends of lines: the limit of a rating is one of mean line loads."
)
UNMEASURED = (
    "How far this coupling is off was not measured on helical pairs: with "
    'coupling = "finite elements" the stiffness was within 4 % of finite elements in space.'
)


def flank_of(result: Result) -> FlankContact | None:
    """The contact over the flank that a design holds; None without one."""
    return held(FlankContact, result.design, "flank")


def tiles(flank: FlankContact, measures: Measures) -> list[Tile]:
    """Line load, transmission error, stiffness and contact ratios as key figures."""
    load = of_duty(flank.loads)
    torque = f"at {share(load.load)} % of the duty's torque"
    iso = amount(flank.iso_mesh_stiffness_MPa, STIFFNESS, measures)
    worst, height, title = load, load.peak_to_peak_mm, "transmission error, peak to peak"
    if load.plain_peak_to_peak_mm is not None:
        worst = max(flank.loads, key=lambda each: each.plain_peak_to_peak_mm or 0.0)
        height, title = worst.plain_peak_to_peak_mm or 0.0, "peak to peak without relief"
    return [
        Tile(
            "largest line load",
            amount(load.largest_line_load_N_per_mm, "N_per_mm", measures),
            f"face load factor {number(load.face_load_factor)}, {torque}",
        ),
        Tile(
            title,
            amount(height, "um", measures),
            f"at {share(worst.load)} % of the duty's torque",
        ),
        Tile(
            "mean mesh stiffness",
            amount(load.mean_mesh_stiffness_MPa, STIFFNESS, measures),
            f"c_γα of ISO 6336-1: {iso}",
        ),
        Tile(
            "total contact ratio",
            number(flank.contact_ratio + flank.overlap_ratio),
            f"ε_α {number(flank.contact_ratio)} and ε_β {number(flank.overlap_ratio)}",
        ),
    ]


def binding_words(flank: FlankContact, measures: Measures) -> str:
    """Largest line load and evenness of the pair, in words."""
    load = of_duty(flank.loads)
    line = amount(load.largest_line_load_N_per_mm, "N_per_mm", measures)
    each = [
        f"{amount(it.peak_to_peak_mm, 'um', measures)} at {100.0 * it.load:g} % of the torque"
        for it in flank.loads
    ]
    carried = f"the flanks carry up to {line} of face width"
    return f"{carried}; the transmission error varies by {series_of(each)}"


def section(result: Result, measures: Measures = METRIC) -> Section | None:
    """Say how the load lies on the flanks, with pictures and tables; None without it."""
    if (flank := flank_of(result)) is None:
        return None
    words = list(map(measures.words, answers(flank, measures)))
    loads = replace(load_table(flank, measures, [], CAPTION), appendix=True)
    tables = [loads, *_tables(flank, measures)]
    return Section(
        "Contact over the flank",
        words=words,
        figures=_figures(flank, measures),
        tables=tables,
        terminal=("\n".join(words), tables[0]),
    )


def answers(flank: FlankContact, measures: Measures = METRIC) -> list[str]:
    """Where the load lies, how even the motion is, stiffness, and how sure that is."""
    load = of_duty(flank.loads)
    if not load.normal_force_N:
        return ["Without load nothing is carried.", _lines(flank, measures)]
    each = [
        f"{micrometres(it.peak_to_peak_mm, measures)} at {100.0 * it.load:g} % of the torque"
        for it in flank.loads
        if it.load
    ]
    return [
        _lines(flank, measures),
        _where(load, measures),
        *_idle(flank),
        f"The transmission error varies by {', '.join(each)}, peak to peak.",
        _stiff(flank, load),
        *_relief(flank, measures),
        *_sure(flank),
    ]


def _lines(flank: FlankContact, measures: Measures) -> str:
    """Say how long the contact lines are."""
    least, mean, most = (amount(v, "mm", measures) for v in flank.contact_lines_mm)
    return f"All contact lines together are {least} to {most} long, {mean} on average."


def _where(load: FlankLoad, measures: Measures) -> str:
    """Say where the line load is largest, and how uneven it is across the face."""
    line = amount(load.largest_line_load_N_per_mm, "N_per_mm", measures)
    s, y = (
        amount(v, "mm", measures) for v in (load.line_load_position_mm, load.line_load_place_mm)
    )
    even = load.face_load_factor < 1.0 + EVEN
    factor = (
        "on average over a base pitch it is even across the face"
        if even
        else "averaged over a base pitch the most loaded slice carries "
        f"{rounded(load.face_load_factor, 3)} times the mean"
    )
    return (
        f"At {100.0 * load.load:g} % of the torque the line load is largest, {line}, at s = {s} on "
        f"the path of contact and y = {y} across the face; {factor}."
    )


def _idle(flank: FlankContact) -> list[str]:
    """Say at which loads part of the contact lines carries nothing."""
    some = [
        f"{100.0 * it.open_share:.2g} % at {100.0 * it.load:g} % of the torque"
        for it in flank.loads
        if it.load and it.open_share > IDLE
    ]
    if not some:
        return []
    return [f"Of the length of the contact lines {', '.join(some)} carries nothing."]


def _stiff(flank: FlankContact, load: FlankLoad) -> str:
    """Say how the mean mesh stiffness compares with ISO 6336-1."""
    off = 100.0 * (load.mean_mesh_stiffness_MPa / flank.iso_mesh_stiffness_MPa - 1.0)
    gaps = (flank.crowning_mm, flank.helix_correction_mm, flank.misalignment_mm, *flank.relief_mm)
    with_gaps = ", the gaps of the flanks counted as approach" if any(gaps) else ""
    return (
        f"The mean mesh stiffness is {rounded(abs(off), 2)} % {'above' if off > 0 else 'below'} "
        f"c_γα of ISO 6336-1{with_gaps}."
    )


def _relief(flank: FlankContact, measures: Measures) -> list[str]:
    """Say what tip relief the flanks have."""
    if not any(flank.relief_mm):
        return []
    rows = zip(
        MEMBERS,
        flank.relief_mm,
        flank.relief_length_mm,
        flank.relief_diameters_mm,
        strict=True,
    )
    each = [
        f"the {name} {micrometres(deep, measures)} at its tip, from d {measures.length(start)} "
        f"{measures.unit('mm')} on ({amount(long, 'mm', measures)} of the path)"
        for name, deep, long, start in rows
    ]
    return [f"Tip relief takes off {' and '.join(each)}."]


def _sure(flank: FlankContact) -> list[str]:
    """Say how far the model was off on helical pairs."""
    if flank.overlap_ratio == 0.0:
        return []
    if flank.coupling == "finite elements":
        return [MEASURED]
    return [SOFTER] if flank.coupling == "ring torsion" else [UNMEASURED]


def _figures(flank: FlankContact, measures: Measures) -> list[Figure]:
    """Pictures of line load and pressure at the duty's torque, and curves over a base pitch."""
    load = of_duty(flank.loads)
    pressure = _picture(flank, load.contact_stress_MPa, "MPa", "contact stress", measures)
    pictured = _picture(flank, load.line_load_N_per_mm, "N_per_mm", "line load", measures)
    at = f"at {100.0 * load.load:g} % of the duty's torque"
    whole = (
        "Each point of the picture is loaded as a contact line passes it; lines: contact at one "
        "moment, which moves to the right."
    )
    return [
        Figure(*pictured, f"Force per face width over the flank, {at}. {whole}"),
        Figure(*pressure, f"Hertz's contact stress over the flank, {at}.", appendix=True),
        _errors(flank, measures),
    ]


def _picture(
    flank: FlankContact,
    values: Sequence[Sequence[float]],
    unit: str,
    name: str,
    measures: Measures,
) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Traces and layout of values over the flank, with contact lines at one moment."""
    length, factor = measures.of(1.0, "mm"), measures.of(1.0, unit)
    x, y = (length * np.asarray(v) for v in (flank.path_mm, flank.place_mm))
    z = [[float(f"{factor * v:.4g}") for v in row] for row in values]
    said = f"s %{{x:.4g}}, y %{{y:.4g}} {measures.unit('mm')}: %{{z:.4g}} {measures.unit(unit)}"
    title = f"{name}<br>[{measures.unit(unit)}]"
    trace = heat(
        [round(float(v), 5) for v in x],
        [round(float(v), 5) for v in y],
        z,
        title,
        f"{said}<extra></extra>",
        colorscale="Viridis",
        zmin=0.0,
    )
    traces = [trace, *_moment(flank, length)]
    half = 0.5 * length * flank.face_width_mm
    plot = layout(
        axis(f"position s on the path of contact [{measures.unit('mm')}]"),
        axis(f"place y across the face [{measures.unit('mm')}]", range=[-half, half]),
        HEIGHT,
        showlegend=False,
    )
    return traces, plot


def _moment(flank: FlankContact, length: float) -> list[dict[str, Any]]:
    """Contact lines at one moment; length: of a millimetre in the shown unit."""
    slope = np.tan(np.radians(flank.base_helix_angle_deg))
    half = 0.5 * flank.face_width_mm
    low, high = flank.path_mm[0], flank.path_mm[-1]
    traces = []
    first = low - slope * half + 0.5 * flank.base_pitch_mm
    for middle in np.arange(first, high + slope * half, flank.base_pitch_mm):
        ends = np.array([-half, half])
        if slope > 0.0:
            ends = np.clip((np.array([low, high]) - middle) / slope, -half, half)
        s = np.clip(middle + slope * ends, low, high)
        x, y = ([round(float(v * length), 5) for v in each] for each in (s, ends))
        traces.append(curve(x, y, "#ffffff", 2.0, hoverinfo="skip"))
    return traces


def _errors(flank: FlankContact, measures: Measures) -> Figure:
    """Plot the transmission error over one base pitch of travel, at every load."""
    x = [round(measures.of(v, "mm"), 5) for v in flank.travel_mm]
    traces, several = [], len(flank.loads) > 1
    for k, load in enumerate(flank.loads):
        about = load.mean_transmission_error_mm
        y = [float(f"{measures.of(v - about, 'um'):.6g}") for v in load.transmission_error_mm]
        named = amount(about, "um", measures)
        trace = curve(x, y, series(k + 1), 2.0, DASHES[k % len(DASHES)], hover="%{y:.4g}")
        traces.append(
            trace | {"name": f"at {100.0 * load.load:g} %, about {named}", "showlegend": several}
        )
    plot = layout(
        axis(f"travel [{measures.unit('mm')}]"),
        axis(f"transmission error<br>about its mean [{measures.unit('um')}]"),
        300,
        hovermode="x",
    )
    plot["margin"] |= {"t": 44 if several else 24}
    said = "Transmission error over one base pitch: approach along the line of action, by the load."
    return Figure(traces, plot, said, appendix=True)


def _tables(flank: FlankContact, measures: Measures) -> list[Table]:
    """CSV files: errors over a base pitch, and the flank at every load."""
    y, s = (v.ravel() for v in np.meshgrid(flank.place_mm, flank.path_mm, indexing="ij"))
    over: Columns = [("s", s.tolist(), "mm"), ("y", y.tolist(), "mm")]
    for load in flank.loads:
        at = f"at {100.0 * load.load:g} %"
        line, stress = (
            [v for row in rows for v in row]
            for rows in (load.line_load_N_per_mm, load.contact_stress_MPa)
        )
        over += [(f"line load {at}", line, "N_per_mm"), (f"contact stress {at}", stress, "MPa")]
    return [travel(flank, measures), columns("flank", over, measures)]
