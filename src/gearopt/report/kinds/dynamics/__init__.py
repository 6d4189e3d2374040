"""A pair on moving axes: how it rests, moves, where it is unstable, and what vibrates least."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.dynamics.design import (
    OUT_OF_MESH,
    TRANSMISSION,
    DynamicErrors,
    DynamicsDesign,
    Response,
    Speeds,
    StandardFactors,
)
from gearopt.formulations.dynamics.motion.stability import UNSTABLE
from gearopt.formulations.dynamics.motions_over_speed import ranges, spans
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.report.answer import asked, assumptions, limits, progress, proven, summary
from gearopt.report.explained import remedies, sensitivities
from gearopt.report.exports import listed
from gearopt.report.headline import of_limits
from gearopt.report.kinds import Pages
from gearopt.report.kinds.dynamics import plots
from gearopt.report.kinds.generic import OPENING
from gearopt.report.measures import METRIC, Measures
from gearopt.report.section import Section, Table, Tile, cell, names_and_values, percent
from gearopt.report.words import amount, number

SAME = 1e-3  # of an RMS by which motions of rising and falling speed are one
TWO_MOTIONS = (
    0.02  # of an RMS by which rising and falling speeds differ where there are two motions
)
MEASURES = {
    "rms": "RMS of the deformation about its mean",
    "peak_to_peak": "peak to peak of the deformation",
}
NOT_USED = (
    "Masses, inertias and bearing stiffnesses of [pinion] and [wheel] and the wave of [mesh] are "
    "not used: those of the answer follow from its sizes."
)
HIGHEST = "highest δ, negative in compression"
EXTENT = ("RMS about the mean", "peak to peak", "maximum")
BY_ISO, BY_AGMA = "by ISO 6336-1 (method B)", "by AGMA 2001-D04"
ISO, AGMA = f"K_v {BY_ISO}", f"K_v {BY_AGMA}"


def design_of(result: Result) -> DynamicsDesign | None:
    """The design of a result; None without one."""
    design: DynamicsDesign | None = None
    if result.design.get("equilibrium"):
        design = typed(DynamicsDesign, result.design, "design")
    return design


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Load, response and stability as key figures."""
    if (design := design_of(result)) is None:
        return []
    rest = design.equilibrium
    figures = [
        Tile("normal load", amount(rest.normal_load_N, "N", measures), "along the line of action")
    ]
    if (chosen := design.chosen) is not None:
        worst = amount(chosen.dense_maximum_mm, "um", measures)
        largest = f"largest {_measure(result)}"
        figures.append(Tile(largest, worst, "over all speeds, on the dense grid"))
    if (moved := design.response) is not None:
        figures.append(
            Tile(
                f"{_varying(moved)}, peak to peak",
                amount((moved.transmission_error or moved).peak_to_peak_mm, "um", measures),
                f"by {moved.method}, error {moved.error:.1e}",
            )
        )
    if design.stability is not None and design.stability.here is not None:
        verdict = "unstable" if design.stability.here > 1.0 + UNSTABLE else "stable"
        figures.append(Tile("largest Floquet multiplier", number(design.stability.here), verdict))
    fastest = f"{rest.frequencies_Hz[-1]:,.0f} Hz"
    return [*figures, Tile("highest natural frequency", fastest, "at the mean stiffness")]


def _varying(moved: Response | Speeds) -> str:
    """What measures the vibration: of teeth without errors their deformation says the same."""
    return TRANSMISSION if moved.transmission_error else "deformation"


def _measure(result: Result) -> str:
    """What is minimised of the deformation, in words."""
    return MEASURES.get(result.objective.get("name", ""), "vibration")


def binding_limit(result: Result, measures: Measures = METRIC) -> str:
    """Deformation of the mesh; of a pair that was chosen its speeds and limits, in words."""
    if (design := design_of(result)) is None:
        return ""
    if design.chosen is not None:
        count = len(design.chosen.speed_rpm)
        judged = "1 speed" if count == 1 else f"{count} speeds"
        return f"the objective is the largest value at {judged}; {of_limits(result)}"
    if design.warnings and design.warnings[0].startswith(OUT_OF_MESH):
        return "teeth leave mesh under the load, as the axes move apart"
    rest = abs(design.equilibrium.deformation_mm)
    moved = design.response
    at_rest = f"the mean load deforms the mesh by {amount(rest, 'um', measures)}"
    if moved is None and design.speeds and (largest := _largest_factor(design.speeds)):
        return f"{at_rest}; the dynamic factor is up to {largest[0]:.4g}, at {largest[1]:,.0f} rpm"
    if moved is None:
        return at_rest
    varies = amount((moved.transmission_error or moved).peak_to_peak_mm, "um", measures)
    return f"{at_rest}; in motion the {_varying(moved)} varies by {varies}"


def warns(result: Result, measures: Measures = METRIC) -> Sequence[str]:
    """Warnings: unstable motions, teeth that part, an accuracy not reached."""
    design = design_of(result)
    return design.warnings if design else ()


def motion(result: Result, measures: Measures) -> Section | None:
    """Show the motion in time, its spectrum, and the axes that move."""
    design = design_of(result)
    if design is None or (moved := design.response) is None:
        return None
    micro = measures.unit("um")
    rows: list[list[Any]] = [
        ["method", moved.method],
        ["error reached, of the largest deformation", f"{moved.error:.2e}"],
        ["steps", moved.steps],
        ["times that teeth part", moved.separations],
        *(names_and_values(moved.transmission_error, measures) if moved.transmission_error else ()),
        [f"deformation, RMS about the mean [{micro}]", cell(moved.rms_mm, "um", measures)],
        [f"deformation, peak to peak [{micro}]", cell(moved.peak_to_peak_mm, "um", measures)],
        [f"{HIGHEST}, of the whole motion [{micro}]", cell(moved.highest_mm, "um", measures)],
        *_loads(moved, design.standard, measures),
    ]
    table = Table("response", ("", ""), rows, "RMS, peak to peak and loads of the second half.")
    moving = [plots.orbit(moved, measures)] if moved.axes_mm else []
    figures = [
        plots.response(moved, measures),
        *([plots.load(moved, measures)] if moved.load_N else []),
        plots.spectrum(moved, design.mesh_frequency_Hz, measures),
    ]
    words = [design.standard.missing] if design.standard and design.standard.missing else []
    return Section(
        "Motion",
        words=words,
        animations=moving,
        figures=figures,
        tables=(table,),
        terminal=(table, *words),
    )


def _loads(
    moved: Response, standard: StandardFactors | None, measures: Measures
) -> list[list[Any]]:
    """Rows of the tooth load and its dynamic factor, with K_v of the standards beside."""
    if moved.tooth_load is None:
        return []
    rows = names_and_values(moved.tooth_load, measures)
    known = standard or StandardFactors()
    for name, value in ((ISO, known.own_iso), (AGMA, known.own_agma)):
        rows += [] if value is None else [[name, value]]
    return rows


def stability(result: Result, measures: Measures) -> Section | None:
    """Show the map of stability, its bands and its tongues."""
    design = design_of(result)
    if design is None or (held := design.stability) is None:
        return None
    rows = [
        [
            " + ".join(map(str, t.modes)),
            t.harmonic,
            cell(t.frequency_Hz, "", measures),
            cell(t.half_width_percent, "percent", measures),
            cell(t.damping_percent, "percent", measures),
        ]
        for t in held.tongues
    ]
    heads = ("modes", "harmonic", "mesh frequency [Hz]", "half width [%]", "damping against it [%]")
    table = Table("tongues", heads, rows, "Widest instability tongues by the first-order formulas.")
    ends = f"{spans(held.bands_Hz)} Hz" if held.bands_Hz else "none"
    words = [
        f"{held.unstable_percent:.3g} % of the map, at depths from {held.depth[0]:.3g} to "
        f"{held.depth[-1]:.3g}, is unstable. Unstable mesh frequencies at the pair's own depth of "
        f"{held.own_depth:.3g}: {ends}.",
    ]
    if held.error is not None:
        step = held.frequency_Hz[1] - held.frequency_Hz[0]
        words.append(
            f"Multipliers are known to {held.error:.1e}, ends of ranges to one step of the "
            f"frequencies, {step:,.3g} Hz.",
        )
    return Section(
        "Stability",
        words=words,
        figures=(plots.stability(held),),
        tables=(table,),
        terminal=("\n".join(words),),
    )


def speeds(result: Result, measures: Measures) -> Section | None:
    """Show motions over speed: where they are largest, where there are two, and what they are."""
    design = design_of(result)
    if design is None or (held := design.speeds) is None:
        return None
    standard = design.standard or StandardFactors()
    figures = [plots.over_speed(held, measures), plots.waterfall(held, measures)]
    figures[1:1] = [plots.dynamic_factors(held, standard)] if held.dynamic_factor else []
    words = [_worst(held, measures), *_two(held), *_factors(held, standard), *_known_to(held)]
    table = _speeds(held, standard, measures)
    return Section("Speeds", words=words, figures=figures, tables=(table,), terminal=words)


def _largest_factor(held: Speeds) -> tuple[float, float] | None:
    """The largest dynamic factor and its speed [rpm]; None where every motion grows for ever."""
    ways = held.dynamic_factor, held.falling_dynamic_factor
    both = [pair for way in ways for pair in zip(way, held.speed_rpm, strict=False)]
    return max(((k, n) for k, n in both if k is not None), default=None)


def _factors(held: Speeds, standard: StandardFactors) -> list[str]:
    """Say where the dynamic factor is largest, with K_v of the standards there."""
    if (largest := _largest_factor(held)) is None:
        return []
    most, speed = largest
    at = held.speed_rpm.index(speed)
    beside = [
        f"{values[at]:.4g} {name}"
        for name, values in ((BY_ISO, standard.iso), (BY_AGMA, standard.agma))
        if values and values[at] is not None
    ]
    tail = f"; K_v there is {' and '.join(beside)}" if beside else ""
    words = "The dynamic factor, the largest tooth load over the normal load, is up to "
    words += f"{most:.4g}, at {speed:,.0f} rpm{tail}."
    return [words, *([standard.missing] if standard.missing else [])]


def _known_to(held: Speeds) -> list[str]:
    """Say the largest estimated errors of the motions that repeat, and of those that do not."""
    ways = [(held.errors, held.repeats), (held.falling_errors, held.falling_repeats)]
    every = [(e, r) for way in ways for e, r in zip(*way, strict=False) if e is not None]
    steady, rest = [e for e, r in every if r], [e for e, r in every if not r]
    said = []
    if steady:
        said.append(
            f"Estimated error of the deformation, relative to its largest value: up to "
            f"{max(steady):.1e}."
        )
    if rest:
        said.append(f"RMS of motions that do not repeat vary by up to {max(rest):.1e} of it.")
    return said


def _worst(held: Speeds, measures: Measures) -> str:
    """Say where the RMS of a stable motion is largest, and the tooth load there."""
    ways = ("", held.loads_N), (" as speed falls", held.falling_loads_N)
    ends = []
    rising = plots.vibrations(held)[0].rms_mm
    for each, (way, loads) in zip(plots.vibrations(held), ways, strict=False):
        for k, (rms, height) in enumerate(zip(each.rms_mm, each.peak_to_peak_mm, strict=True)):
            if rms is not None and height is not None:
                up = rising[k]
                apart = up is None or not math.isclose(rms, up, rel_tol=SAME)
                load = loads[0][k] if loads else None
                ends.append((rms, not apart, -k, way * apart, height, each.highest_mm[k], load))
    if not ends:
        return "The motion is unstable at all speeds."
    rms, _, k, way, height, most, load = max(ends, key=lambda end: end[:3])
    largest = f"peak to peak {amount(height, 'um', measures)}"
    if held.transmission_error and most is not None:
        largest += f", maximum {amount(most, 'um', measures)}"
    pressed = "" if load is None else f"; the tooth load is up to {amount(load, 'N', measures)}"
    edge = ", an end of the range" if -k in (0, len(rising) - 1) and len(ends) > 1 else ""
    return (
        f"The RMS of the {_varying(held)} about its mean is largest at "
        f"{held.speed_rpm[-k]:,.0f} rpm{edge}{way}: {amount(rms, 'um', measures)}, {largest}"
        f"{pressed}."
    )


def _two(held: Speeds) -> list[str]:
    """Say where speed that rises and speed that falls lead to two motions."""
    falling = held.falling_rms_mm or held.rms_mm
    pairs = [(a or 0.0, b or 0.0) for a, b in zip(held.rms_mm, falling, strict=True)]
    where = [min(pair) > 0.0 and np.ptp(pair) > TWO_MOTIONS * max(pair) for pair in pairs]
    if not any(where):
        return []
    most = max(max(pair) / min(pair) for pair, two in zip(pairs, where, strict=True) if two)
    return [
        f"There are two motions at {ranges(held.speed_rpm, where)}, one up to {most:.3g} times "
        "as large as the other: which one occurs depends on whether speed rises or falls."
    ]


def _speeds(held: Speeds, standard: StandardFactors, measures: Measures) -> Table:
    """Every speed's motion as a table, of falling speeds beside the rising ones."""
    micro, force = measures.unit("um"), measures.unit("N")
    heads = [f"RMS [{micro}]", f"peak to peak [{micro}]", f"{HIGHEST} [{micro}]", "motion"]
    loads = [f"tooth load, {name} [{force}]" for name in ("maximum", "minimum", "RMS")]
    heads += [*loads, "dynamic factor", "error"] if held.loads_N else []
    lags = plots.vibrations(held) if held.transmission_error else []
    heads = [f"{TRANSMISSION}, {name} [{micro}]" for name in EXTENT if lags] + heads
    rising = (
        [*_each(lags[:1]), held.rms_mm, held.peak_to_peak_mm, held.highest_mm],
        held.repeats,
        held.loads_N,
        (held.dynamic_factor, held.errors),
    )
    falling = (
        [
            *_each(lags[1:]),
            held.falling_rms_mm,
            held.falling_peak_to_peak_mm,
            held.falling_highest_mm,
        ],
        held.falling_repeats,
        held.falling_loads_N,
        (held.falling_dynamic_factor, held.falling_errors),
    )
    ways = [rising, falling] if held.falling_rms_mm and rising[:2] != falling[:2] else [rising]
    names = heads if len(ways) == 1 else [f"{h}, {w}" for w in ("rising", "falling") for h in heads]
    beside = [(n, v) for n, v in ((ISO, standard.iso), (AGMA, standard.agma)) if v]
    rows: list[list[Any]] = []
    for k, speed in enumerate(held.speed_rpm):
        row: list[Any] = [speed]
        for sizes, repeats, forces, numbers in ways:
            row += [cell(values[k], "um", measures) for values in sizes]
            row.append(_said(repeats[k], sizes[-1][k]))
            row += [cell(values[k], "N", measures) for values in forces]
            row += [values[k] for values in numbers if values]
        rows.append(row + [values[k] for _, values in beside])
    heads = ["speed [rpm]", *names, *(name for name, _ in beside)]
    return Table("motions over speed", tuple(heads), rows, folded=True)


def _each(errors: Sequence[DynamicErrors]) -> list[Sequence[float | None]]:
    """RMS, peak to peak and maximum of a transmission error over speed; none of none."""
    return [c for e in errors for c in (e.rms_mm, e.peak_to_peak_mm, e.highest_mm)]


def _said(repeats: int, highest: float | None) -> str:
    """Kind of motion in a few words."""
    if highest is None:
        return "unstable"
    if repeats != 1:
        return f"repeats after {repeats} periods" if repeats else "does not repeat"
    return "teeth part" if highest > 0.0 else "in contact"


def chosen(result: Result, measures: Measures) -> Section | None:
    """Show the design of least vibration beside the pair of the file."""
    gearing = design_of(result)
    if gearing is None or (best := gearing.chosen) is None:
        return None
    micro = measures.unit("um")
    measure = _measure(result)
    largest = f"largest {measure}, over all speeds [{micro}]"
    rows = names_and_values(best, measures, labels={"dense_maximum_mm": largest})
    design = Table("design", ("", ""), rows)
    heads = ("speeds", "harmonics", f"objective [{micro}]", f"over all speeds [{micro}]")
    rounds = [
        [int(n), int(h), *(cell(1e-3 * v, "um", measures) for v in values)]
        for n, h, *values in best.rounds
    ]
    exchange = Table("exchange", heads, rounds, "Speeds added until the dense grid agrees.")
    tables = (design, exchange) if rounds else (design,)
    figures = (plots.before_and_after(best, measure, measures),)
    return Section("Least vibration", figures=figures, tables=tables, terminal=tables)


def rest(result: Result, measures: Measures) -> Section | None:
    """Say how the pair rests under its load, and how it could swing."""
    if (design := design_of(result)) is None:
        return None
    at = design.equilibrium
    rows = names_and_values(at, measures)
    state = Table("under load", ("", ""), rows, "At the mean stiffness, under the mean load.")
    modes = [
        [k, f, percent(share)]
        for k, (f, share) in enumerate(zip(at.frequencies_Hz, at.mesh_shares, strict=True), 1)
    ]
    heads = ("mode", "frequency [Hz]", "energy in the mesh [%]")
    swing = Table("modes", heads, modes, "Undamped modes, and their strain energy in the mesh.")
    return Section("At rest", tables=(state, swing), terminal=(state, swing))


def prices(result: Result, measures: Measures) -> Section | None:
    """Show sensitivities, and say which numbers a design of least vibration does not use."""
    section, design = sensitivities(result, measures), design_of(result)
    if section is None or design is None or design.chosen is None:
        return section
    terminal = (*section.terminal, NOT_USED)
    return replace(section, words=[*section.words, NOT_USED], terminal=terminal)


SECTIONS = (chosen, motion, speeds, stability, rest)
PAGES = Pages(
    sections=(*OPENING, *SECTIONS, limits, prices, progress, proven, assumptions),
    terminal=(rest, stability, motion, speeds, chosen, limits, prices, remedies, summary),
    tiles=tiles,
    binding_limit=binding_limit,
    warns=warns,
    drawn=False,
    exports={"csv": listed(motion, speeds, lacking="there is no motion to export")},
    pages_of_given=Pages(
        sections=(summary, asked, *SECTIONS, assumptions),
        terminal=(rest, stability, motion, speeds, summary),
        tiles=tiles,
        binding_limit=binding_limit,
        warns=warns,
        drawn=False,
    ),
)
