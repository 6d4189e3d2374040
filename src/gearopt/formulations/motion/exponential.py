"""Exact motion of piecewise linear scenes: one matrix exponential for every piece of stiffness."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gearopt.formulations.motion.integrate import MARCH, Marched
from gearopt.formulations.motion.numbers import Numbers, numbers
from gearopt.formulations.motion.timeline import Timeline
from gearopt.optimise.kernels import kernel
from gearopt.optimise.terms import Array
from gearopt.physics.motion.linear import linear, modes
from gearopt.physics.motion.moving_pair import MovingPair

LOOKS = 40  # looks for a separation, in a period of the fastest mode
NARROW = 1e-15  # share of a look to which it is located
GRAZING = 1e-3  # margin of a crest between looks; the cubic through them is good to 7e-5
HALVES = 30  # of a look, until a short separation is ahead of it or begins in it
LINEAR = ("tangent", "paper_linear")


def piecewise_linear(pair: MovingPair, level: str) -> bool:
    """Return whether the motion is a linear one between the steps of the stiffness."""
    straight = level in ("fixed", "line") or (level == "plane" and pair.kinematics in LINEAR)
    return straight and pair.wave.stepped and not pair.error


@dataclass
class Propagator:
    """Maps y -> exp(A t) y + ... of a pair by stiffness, flank and time; it keeps those made.

    It has state because a map is used for many periods.
    """

    model: Numbers
    top: float  # the highest angular frequency [rad/s], which scales velocities
    made: dict[Any, Array] = field(default_factory=dict)

    def map(self, k: float, flank: int, time: float) -> Array:
        """Return the map (2 n + 1, 2 n + 1) of (y, 1), velocities divided by `top`."""
        from scipy.linalg import expm

        key = (k, flank, f"{time:.12e}")
        if key not in self.made:
            self.made[key] = expm(self._rates(k, flank) * time)
        return self.made[key]

    def passing(self, k: float, flank: int, time: float) -> Array:
        """Return the same, not kept."""
        from scipy.linalg import expm

        return np.asarray(expm(self._rates(k, flank) * time))

    def _rates(self, k: float, flank: int) -> Array:
        key = (k, flank)
        if key not in self.made:
            n = self.model.level
            found, out = np.zeros((2 * n + 1, 2 * n + 1)), np.empty(2 * n)
            scale = np.append(np.ones(n), np.full(n, self.top))
            law = kernel(MARCH).rates
            law(self.model, 0.0, k, flank, np.zeros(2 * n), out)
            found[:-1, -1] = out / scale
            for j in range(2 * n):
                unit = np.zeros(2 * n)
                unit[j] = scale[j]
                law(self.model, 0.0, k, flank, unit, out)
                found[:-1, j] = out / scale - found[:-1, -1]
            self.made[key] = found
        return self.made[key]


def propagator(pair: MovingPair, level: str) -> Propagator:
    """Return the maps of a pair that is `piecewise_linear`; ValueError where it is not."""
    if not piecewise_linear(pair, level):
        raise ValueError(f"the motion at the level {level!r} is not piecewise linear")
    stiffest = float(np.max(pair.wave.after))
    top = modes(linear(pair, level), stiffest).frequencies[-1]
    return Propagator(numbers(pair, level), float(top))


def exact_motion(pair: MovingPair, level: str, times: Timeline, state: Array) -> Marched:
    """Return the motion, exact to rounding between separations, which are located to rounding."""
    maps = propagator(pair, level)
    n = maps.model.level
    scale = np.append(np.ones(n), np.full(n, maps.top))
    now = np.append(np.asarray(state, float) / scale, 1.0)
    flank = int(kernel(MARCH).flank_now(maps.model, now[:-1] * scale))
    out, steps, events = np.empty((len(times.starts), 2 * n)), 0, 0
    for i, (length, k) in enumerate(zip(times.lengths, times.k0, strict=True)):
        if maps.model.backlash == math.inf:
            now, steps = maps.map(float(k), 0, float(length)) @ now, steps + 1
        else:
            now, flank, more = _through(maps, scale, float(k), float(length), now, flank)
            steps, events = steps + more[0], events + more[1]
        out[i] = now[:-1] * scale
    whole = np.concatenate([[state], out])[times.asked + 1]
    return Marched(pair, level, whole, steps, steps, events)


def _through(
    maps: Propagator, scale: Array, k: float, length: float, now: Array, flank: int
) -> tuple[Array, int, tuple[int, int]]:
    """Return the state and flank after a piece in which teeth may part; looks and events."""
    kernels, looks, events = kernel(MARCH), 0, 0
    look = 2.0 * math.pi / maps.top / LOOKS
    while length > 0.0:
        part = min(look, length)
        new = (maps.map if part == look else maps.passing)(k, flank, part) @ now
        looks += 1
        past = kernels.past(maps.model, flank, new[:-1] * scale)
        for _ in range(HALVES):
            ends = now[:-1] * scale, new[:-1] * scale
            if past > 0.0 or not kernels.swung(maps.model, flank, part, *ends, GRAZING):
                break
            part *= 0.5
            new, looks = maps.passing(k, flank, part) @ now, looks + 1
            past = kernels.past(maps.model, flank, new[:-1] * scale)
        if past > 0.0:
            low, high = 0.0, part
            while high - low > NARROW * look:
                middle = 0.5 * (low + high)
                tried = maps.passing(k, flank, middle) @ now
                if middle in (low, high):
                    break
                inside = kernels.past(maps.model, flank, tried[:-1] * scale) <= 0.0
                low, high = (middle, high) if inside else (low, middle)
            part, new = high, maps.passing(k, flank, high) @ now
            flank, events = _other(maps, flank, new[:-1] * scale), events + 1
        now, length = new, length - part
    return now, flank, (looks, events)


def _other(maps: Propagator, flank: int, state: Array) -> int:
    """Return the flank on which a motion goes on that has come to the end of one."""
    if flank != 1:
        return 1
    n = maps.model.level
    return 0 if state[n // 2] <= 0.5 * maps.model.backlash else 2
