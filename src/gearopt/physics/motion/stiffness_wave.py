"""Mesh stiffness over a period of the mesh: constant, rectangle, trapezoid, Fourier, table.

The phase counts periods of the mesh: 0 to 1. Stiffness in N/mm.
"""

import math
from collections.abc import Callable
from dataclasses import field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.frozen import dataclass

Array = NDArray[np.float64]
PAIR_SHARE = 0.75  # of c' that a second pair of teeth adds in c_gamma = c' (0.75 eps + 0.25)
SHORTEST = 1e-12  # of a period: a shorter piece is the rounding of its ends


@dataclass(frozen=True)
class Wave:
    """Stiffness k(phase): straight between `edges`, and a Fourier sum on top.

    edges (n,) from 0, rising, below 1; before, after (n,) [N/mm]: left and right limit at an edge.
    The last piece ends at phase 1 with before[0]. cosines, sines (H,) [N/mm] of the harmonics.
    """

    edges: Array
    before: Array
    after: Array
    cosines: Array = field(default_factory=lambda: np.zeros(0))
    sines: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def mean(self) -> float:
        """Mean stiffness [N/mm]."""
        return float(np.sum(0.5 * (self.after + np.roll(self.before, -1)) * self.lengths))

    @property
    def least(self) -> float:
        """Least stiffness [N/mm] over 2000 phases a period, edges not among them."""
        return float(np.min(self.value(np.arange(2000) / 2000)))

    @property
    def lengths(self) -> Array:
        """Phase from each edge to the next, (n,)."""
        return np.diff(np.append(self.edges, 1.0))

    @property
    def stepped(self) -> bool:
        """Whether the stiffness is constant between edges."""
        return not len(self.cosines) and bool(np.all(self.after == np.roll(self.before, -1)))

    def straight(self, phase: Any, left: bool = False) -> Array:
        """Return the pieces' part at phases; left: the left limits at edges [N/mm]."""
        place = np.asarray(phase, float) % 1.0
        if left:
            place = np.where(place == 0.0, 1.0, place)
        index = np.searchsorted(self.edges, place, "left" if left else "right") - 1
        share = (place - self.edges[index]) / self.lengths[index]
        end = np.roll(self.before, -1)[index]
        return np.asarray(self.after[index] + share * (end - self.after[index]))

    def value(self, phase: Any) -> Array:
        """Return k at phases, the right limit at edges [N/mm]."""
        angle = 2.0 * math.pi * np.multiply.outer(np.asarray(phase, float), self.numbers)
        waves = np.cos(angle) @ self.cosines + np.sin(angle) @ self.sines
        return np.asarray(self.straight(phase) + waves)

    @property
    def numbers(self) -> Array:
        """Harmonic numbers 1 to H of the Fourier sum."""
        return np.arange(1.0, len(self.cosines) + 1.0)

    def harmonics(self, count: int) -> NDArray[np.complex128]:
        """Return c_0 to c_count of k = sum over all h of c_h exp(2 pi i h phase), in closed form.

        c_-h is the conjugate of c_h. Of every straight piece the integral is exact.
        """
        coefficients = np.zeros(count + 1, complex)
        coefficients[0] = self.mean
        start, stop = self.edges, np.append(self.edges[1:], 1.0)
        low, high = self.after, np.roll(self.before, -1)
        for h in range(1, count + 1):
            q = -2j * math.pi * h
            slope = (high - low) / (stop - start)
            ends = (high - slope / q) * np.exp(q * stop) - (low - slope / q) * np.exp(q * start)
            coefficients[h] = np.sum(ends) / q
            if h <= len(self.cosines):
                coefficients[h] += 0.5 * (self.cosines[h - 1] - 1j * self.sines[h - 1])
        return coefficients


def constant(stiffness: float) -> Wave:
    """Return a stiffness that does not change [N/mm]."""
    level = np.array([stiffness])
    return Wave(np.zeros(1), level, level)


def trapezoid(mean: float, depth: float, duty: float, ramp: float = 0.0) -> Wave:
    """Return k = mean (1 + depth (w - duty)), w a trapezoid of 0 to 1 and of mean `duty`.

    depth (k_max - k_min)/mean; w rises over `ramp` of the period from phase 0, falls from phase
    `duty`; ramp 0 is a rectangle. ValueError where the ramps overlap: ramp > min(duty, 1 - duty).
    """
    if not 0.0 < duty < 1.0 or not 0.0 <= ramp <= min(duty, 1.0 - duty) + SHORTEST:
        raise ValueError(f"a ramp of {ramp:g} does not fit a duty of {duty:g}")
    top, bottom = mean * (1.0 + depth * (1.0 - duty)), mean * (1.0 - depth * duty)
    if ramp == 0.0:
        before, after = np.array([bottom, top]), np.array([top, bottom])
        return Wave(np.array([0.0, duty]), before, after)
    corners = ((0.0, bottom), (ramp, top), (duty, top), (duty + ramp, bottom), (1.0, bottom))
    kept = [c for c, after in pairwise(corners) if after[0] - c[0] > SHORTEST]
    edges, level = np.array(kept).T.copy()  # in order, as kernels are compiled for
    return Wave(edges, level, level)


def of_contact_ratio(single: float, contact_ratio: float, ramp: float = 0.0) -> Wave:
    """Return k = k_s (1 + 0.75 w), w of duty eps - 1: of one pair of teeth, and of two.

    single k_s [N/mm]; transverse contact ratio 1 < eps < 2. The mean is k_s (0.75 eps + 0.25), that
    of ISO 6336-1, 9.3; that the wave is a trapezoid between both is an assumption.
    """
    duty = contact_ratio - 1.0
    mean = single * (1.0 + PAIR_SHARE * duty)
    return trapezoid(mean, PAIR_SHARE * single / mean, duty, ramp)


def fourier(mean: float, cosines: Any, sines: Any = ()) -> Wave:
    """Return mean + sum of cosines_h cos(2 pi h phase) + sines_h sin(2 pi h phase) [N/mm]."""
    a, b = (np.atleast_1d(np.asarray(c, float)) for c in (cosines, sines))
    size = max(a.size, b.size)
    a, b = (np.pad(c, (0, size - c.size)) for c in (a, b))
    level = np.array([mean])
    return Wave(np.zeros(1), level, level, a, b)


def sampled(stiffness: Callable[[Array], Any], points: int) -> Wave:
    """Return straight lines between values of a function of the phase, at that many phases."""
    edges = np.arange(points) / points
    values = np.asarray(stiffness(edges), float)
    return Wave(edges, values, values)
