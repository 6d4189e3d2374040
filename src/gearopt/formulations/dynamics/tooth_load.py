"""Load on the teeth in a motion, with its extremes between known states; transmission error."""

import math
from typing import Any, NamedTuple

import numpy as np

from gearopt.optimise.terms import Array
from gearopt.physics.motion.kinematics import growth
from gearopt.physics.motion.moving_pair import MovingPair

PARTS = 8  # looks in an interval between two states, along a cubic
BESIDE = 1e-10  # of a mesh period: a step of the stiffness counts from both sides


class Load(NamedTuple):
    """Largest and least load on the teeth and its RMS [N]; below zero on the coast flanks."""

    most: float
    least: float
    rms: float


class Lag(NamedTuple):
    """Transmission error e - delta, the lag of the driven gear [mm]: RMS about its mean, extent."""

    rms: float
    height: float
    most: float


def extent(lag: Array) -> Lag:
    """Return the extent of a transmission error at equal steps of time [mm]."""
    return Lag(float(lag.std()), float(np.ptp(lag)), float(lag.max()))


def tooth_load(pair: MovingPair, level: str, states: Array, stiffness: Any) -> Array:
    """Return the force on the teeth [N] in states (..., 2 n), at a mesh stiffness [N/mm] in each.

    That of the spring and of its damper: above zero on the drive flank, below on the coast flank, 0
    apart; a damper that would pull teeth together counts as 0. Without backlash the mesh pulls.
    """
    n = states.shape[-1] // 2
    delta, rate = states[..., n // 2], states[..., n + n // 2]
    damping = pair.damping + pair.drag
    drive = -(stiffness * delta + damping * rate)
    if pair.backlash is None:
        return np.asarray(drive)
    room, widening = pair.backlash, 0.0
    if level == "plane":
        (x1, y1, _, x2, y2), speeds = np.moveaxis(states[..., :n], -1, 0), states[..., n:]
        more = growth(pair.kinematics, pair.rest, x2 - x1, y2 - y1)
        room = room + more.length
        widening = sum(
            g * (speeds[..., 3 + k] - speeds[..., k]) for k, g in enumerate(more.gradient)
        )
    coast = stiffness * (delta - room) + pair.damping * (rate - widening) + pair.drag * rate
    pushed = np.where(delta > room, -np.maximum(coast, 0.0), 0.0)
    return np.where(delta <= 0.0, np.maximum(drive, 0.0), pushed)


def between(times: Array, states: Array, moments: Array) -> Array:
    """Return states at moments on the cubics through neighbouring states (T, 2 n) at times [s]."""
    n = states.shape[1] // 2
    k = np.clip(np.searchsorted(times, moments, "right") - 1, 0, len(times) - 2)
    h = (times[k + 1] - times[k])[:, None]
    s = (moments - times[k])[:, None] / h
    rest, first, last = 1.0 - s, states[k], states[k + 1]
    places = rest**2 * (1.0 + 2.0 * s) * first[:, :n] + s**2 * (3.0 - 2.0 * s) * last[:, :n]
    places = places + h * s * rest * (rest * first[:, n:] - s * last[:, n:])
    rates = 6.0 * s * rest * (last[:, :n] - first[:, :n]) / h
    rates = rates + rest * (1.0 - 3.0 * s) * first[:, n:] + s * (3.0 * s - 2.0) * last[:, n:]
    return np.concatenate([places, rates], axis=-1)


def load_over(pair: MovingPair, level: str, times: Array, states: Array) -> Load:
    """Return the load over a time, from states (T, 2 n) at times [s] that rise.

    PARTS looks between two states, and both sides of every step of the stiffness.
    """
    fine = times[:-1, None] + np.diff(times)[:, None] * np.arange(PARTS) / PARTS
    moments, frequency = np.append(fine, times[-1]), pair.mesh_frequency
    if frequency > 0.0:
        periods = np.arange(math.floor(times[0] * frequency), math.ceil(times[-1] * frequency) + 1)
        steps = (periods[:, None] + pair.wave.edges).ravel()
        steps = np.concatenate([steps - BESIDE, steps + BESIDE]) / frequency
        moments = np.union1d(moments, steps[(steps > times[0]) & (steps < times[-1])])
    loads = tooth_load(
        pair, level, between(times, states, moments), pair.wave.value(frequency * moments)
    )
    squares = 0.5 * (loads[:-1] ** 2 + loads[1:] ** 2) * np.diff(moments)
    rms = math.sqrt(float(squares.sum()) / float(times[-1] - times[0]))
    return Load(float(loads.max()), float(loads.min()), rms)


def dynamic_factor(load: Load, mean: float) -> float:
    """Return the largest load on either flank over the mean one [N]."""
    return max(load.most, -load.least) / mean
