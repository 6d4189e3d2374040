"""Motions over a range of speeds, as a machine has them whose speed slowly rises or falls.

Each motion begins where the one before has come to.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from gearopt.formulations.dynamics.design import Columns, DynamicErrors, Speeds
from gearopt.formulations.dynamics.motion.stability import bands
from gearopt.formulations.dynamics.parts import columns, gaps
from gearopt.formulations.dynamics.steady_motion import (
    Contact,
    Motion,
    continued,
    in_contact,
    linear_motion,
    settled,
)
from gearopt.formulations.dynamics.tooth_load import dynamic_factor
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.motion.moving_pair import MovingPair

Grid = tuple[float, float, int]  # ends and how many, equally far apart
STEP = 0.025  # of itself by which speed rises or falls at once


def over_speeds(
    pair: MovingPair, level: str, teeth: int, grid: Grid, harmonics: int, clock: Clock | None = None
) -> Speeds:
    """Return motions over speeds of the pinion, followed up and down where teeth may part.

    grid: least and largest speed [rpm], and how many; where teeth may part, those between are
    passed in steps of at most STEP. Where the clock stops, the first speeds alone, or the rising
    ones.
    """
    clock, speeds_rpm = clock or Clock(), np.linspace(*grid)
    asked = teeth * np.asarray(speeds_rpm) / 60.0
    frequencies = asked if pair.backlash is None else passed(asked)
    kept = np.searchsorted(frequencies, asked)
    every = in_contact(pair, level, frequencies, harmonics, clock)
    up = followed(pair, level, every, clock)
    down = list[Motion]()
    if pair.backlash is not None and len(up) == len(frequencies):
        down = followed(pair, level, every[::-1], clock)[::-1]
    rising = [up[k] for k in kept if k < len(up)]
    falling = [down[k] for k in kept] if len(down) == len(frequencies) else []
    contacts = [every[k] for k in kept[: len(rising)]]
    jams = [any(o.jams for o in (rising[k], *falling[k : k + 1])) for k in range(len(rising))]
    speeds_rpm = speeds_rpm[: len(rising)]
    return Speeds(
        teeth_part=pair.backlash is not None,
        speed_rpm=columns(speeds_rpm),
        rms_mm=gaps([o.rms for o in rising], 7),
        peak_to_peak_mm=gaps([o.highest - o.least for o in rising], 7),
        highest_mm=gaps([o.highest for o in rising], 7),
        repeats=tuple(o.repeats for o in rising),
        falling_rms_mm=gaps([o.rms for o in falling], 7),
        falling_peak_to_peak_mm=gaps([o.highest - o.least for o in falling], 7),
        falling_highest_mm=gaps([o.highest for o in falling], 7),
        falling_repeats=tuple(o.repeats for o in falling),
        growth=columns([c.growth for c in contacts], 6),
        jammed_rpm=columns(speeds_rpm[np.array(jams, bool)]),
        harmonics_mm=tuple(gaps(row, 5) for row in np.array([o.amplitudes for o in rising]).T),
        loads_N=tuple(gaps(row, 7) for row in zip(*(o.load for o in rising), strict=True)),
        falling_loads_N=tuple(gaps(row, 7) for row in zip(*(o.load for o in falling), strict=True)),
        dynamic_factor=gaps([dynamic_factor(o.load, pair.load) for o in rising], 6),
        falling_dynamic_factor=gaps([dynamic_factor(o.load, pair.load) for o in falling], 6),
        errors=gaps([o.error for o in rising], 3),
        falling_errors=gaps([o.error for o in falling], 3),
        transmission_error=_errors(rising) if pair.error and rising else None,
        falling_transmission_error=_errors(falling) if pair.error and falling else None,
    )


def _errors(motions: Sequence[Motion]) -> DynamicErrors:
    """Return the transmission errors of motions."""
    each = (gaps(values, 7) for values in zip(*(motion.lag for motion in motions), strict=True))
    rms, height, most = each
    return DynamicErrors(rms_mm=rms, peak_to_peak_mm=height, highest_mm=most)


def passed(frequencies: Array) -> Array:
    """Return rising frequencies with others between them: steps of at most STEP of themselves."""
    parts = [frequencies[:1]]
    for low, high in pairwise(frequencies):
        count = math.ceil(math.log(high / low) / STEP)
        parts.append(np.append(np.geomspace(low, high, count + 1)[1:-1], high))
    return np.concatenate(parts)


def rms_limited_by_backlash(
    pair: MovingPair, level: str, harmonics: int, clock: Clock
) -> float | None:
    """Return the RMS of the motion at the pair's own mesh frequency [mm], from contact there.

    None where the pair has no frequency or no backlash, where the motion grows for ever, or where
    the clock stops.
    """
    if pair.backlash is None or pair.mesh_frequency <= 0.0:
        return None
    frequency = np.array([pair.mesh_frequency])
    motions = followed(pair, level, in_contact(pair, level, frequency, harmonics, clock), clock)
    return motions[0].rms if motions and not motions[0].grows else None


def ranges(speeds_rpm: Columns, inside: Sequence[bool]) -> str:
    """Return those speeds that are inside in words: "800 to 900 and 1,200 rpm"."""
    return f"{spans(bands(speeds_rpm, inside))} rpm"


def spans(ends: Iterable[Sequence[float]]) -> str:
    """Return ranges in words: "800 to 900 and 1,200"."""
    texts = [f"{a:,.0f}" if a == b else f"{a:,.0f} to {b:,.0f}" for a, b in ends]
    return (
        f" and {texts[-1]}".join([", ".join(texts[:-1]), ""]) if len(texts) > 1 else "".join(texts)
    )


def followed(pair: MovingPair, level: str, contacts: list[Contact], clock: Clock) -> list[Motion]:
    """Return the motions that a pair takes on as its speed passes slowly from one to the next.

    contacts: those of teeth in contact, in the order in which the speeds are passed; the first
    speed is begun in contact where that is stable, else at rest under the load. A pair without
    backlash stays in contact, stable or not. Of the first speeds alone where the clock stops.
    """
    motions: list[Motion] = []
    for contact in contacts:
        if pair.backlash is not None and not clock.tell():
            break
        moved = replace(pair, mesh_frequency=contact.series.frequency)
        last = motions[-1] if motions and not motions[-1].grows else None
        motion: Motion | None = None
        if pair.backlash is None or (contact.holds and (last is None or last.highest <= 0.0)):
            motion = linear_motion(moved, level, contact)
        elif last is not None:
            motion = continued(moved, level, contact, last, clock)
        if motion is None:
            motion = settled(moved, level, contact, last, clock)
        if motion is None:
            break
        motions.append(motion)
    return motions
