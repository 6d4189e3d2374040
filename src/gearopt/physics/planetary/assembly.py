"""Whether planets fit between sun and rings, where, and in which phase, in whole numbers.

All planets are alike, so that the teeth of their steps have one position to each other. A planet
fits at an angle phi from another where it can be turned about its axis by chi relative to its arm
with z_p chi = z_s phi at the sun and z_p chi = -z_r phi at a ring, but for whole turns of 2 pi/z_p.
Teeth may be arrays of whole numbers; those of rings are positive here.
"""

from fractions import Fraction
from typing import Any

import numpy as np

SAME = 1e-9  # of a module: a gap that is too small by less counts as wide enough


def places(sun: Any, planet: Any, ring_planet: Any, ring: Any) -> Any:
    """Number of equal parts of a turn at each of which a planet fits, counted from another.

    (z_s z_p2 + z_r z_p1)/gcd(z_p1, z_p2), of planets with one step z_s + z_r; ring_planet: the step
    in mesh with the ring. Eliminating chi leaves phi/(2 pi) (z_s z_p2 + z_r z_p1) = a z_p2 + b z_p1
    for whole a and b. Of two rings the greatest common divisor of both numbers counts.
    """
    return (sun * ring_planet + ring * planet) // np.gcd(planet, ring_planet)


def spread(count: Any, planets: int) -> Any:
    """Places (..., N), counted from 0, of N planets as nearly equal as they can be.

    The k-th is the nearest to k/N of a turn, the later one of two that are as near.
    """
    k = np.arange(planets)
    return (2 * k * np.asarray(count)[..., None] + planets) // (2 * planets)


def turns(count: int, planets: int) -> list[Fraction]:
    """The places of `spread` as parts of a turn."""
    return [Fraction(place, count) for place in spread(count, planets).tolist()]


def least_spacing(count: Any, planets: int) -> Any:
    """Smallest angle between neighbours of `spread` as a part of a turn."""
    where = spread(count, planets)
    after = np.concatenate((where[..., 1:], np.asarray(count)[..., None]), axis=-1)
    return (after - where).min(axis=-1) / np.maximum(count, 1)


def neighbour_distance(centre_distance: Any, spacing: Any) -> Any:
    """2 a sin(pi s): distance of the axes of planets a part s of a turn apart."""
    return 2.0 * centre_distance * np.sin(np.pi * spacing)
