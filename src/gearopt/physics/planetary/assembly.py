"""Whether planets fit between sun and rings, where, and in which phase, in whole numbers.

All planets are alike, so that the teeth of their steps have one position to each other. A planet
fits at an angle phi from another where it can be turned about its axis by chi relative to its arm
with z_p chi = z_s phi at the sun and z_p chi = -z_r phi at a ring, but for whole turns of 2 pi/z_p.
Teeth may be arrays of whole numbers; those of rings are positive here.
"""

from typing import Any

import numpy as np

from gearopt.physics.choosing import choose

SAME = 1e-9  # of a module: a gap that is too small by less counts as wide enough


def places(sun: Any, planet: Any, ring: Any, ring_planet: Any = None) -> Any:
    """Number of equal parts of a turn at each of which a planet fits, counted from another.

    (z_s z_p2 + z_r z_p1)/gcd(z_p1, z_p2); with one step z_s + z_r. N planets can be spaced equally
    where it is a multiple of N. ring_planet: teeth of the step in mesh with the ring. Eliminating
    chi from both conditions leaves phi/(2 pi) (z_s z_p2 + z_r z_p1) = a z_p2 + b z_p1 for whole a
    and b, whose right side takes the multiples of the greatest common divisor. Tests place planets
    by trying all positions of their teeth.
    """
    if ring_planet is None:
        return sun + ring
    return (sun * ring_planet + ring * planet) // np.gcd(planet, ring_planet)


def places_of_two_rings(sun: Any, planet: Any, ring: Any, planet_2: Any, ring_2: Any) -> Any:
    """Number of `places` of a Wolfrom train: those at which all three meshes fit.

    gcd of z_s + z_r1 and |z_r2 z_p1 - z_r1 z_p2|/gcd(z_p1, z_p2), which is that of both rings.
    """
    rings = abs(ring_2 * planet - ring * planet_2) // np.gcd(planet, planet_2)
    return np.gcd(sun + ring, rings)


def spread(count: Any, planets: int) -> Any:
    """Places (..., N), counted from 0, of N planets as nearly equal as they can be.

    The k-th is the nearest to k/N of a turn, the later one of two that are as near.
    """
    k = np.arange(planets)
    return (2 * k * np.asarray(count)[..., None] + planets) // (2 * planets)


def least_spacing(count: Any, planets: int) -> Any:
    """Smallest angle between neighbours of `spread` as a part of a turn."""
    where = spread(count, planets)
    after = np.concatenate((where[..., 1:], np.asarray(count)[..., None]), axis=-1)
    return (after - where).min(axis=-1) / np.maximum(count, 1)


def neighbour_gap(centre_distance: Any, tip_diameter: Any, spacing: Any) -> Any:
    """2 a sin(pi s) - d_a: gap between tip circles of planets a part s of a turn apart."""
    return 2.0 * centre_distance * np.sin(np.pi * spacing) - tip_diameter


def wide_enough(gap: Any, clearance: Any) -> Any:
    """Whether a gap [modules] reaches a clearance, but for SAME."""
    return gap >= clearance - SAME


def phase(teeth: int, place: int, count: int) -> tuple[int, int]:
    """Phase of the mesh of a central gear with the planet at a place, as a fraction of a pitch.

    Numerator and denominator of the fractional part of teeth place/count; against place 0.
    """
    return teeth * place % count, count


def in_step(teeth: Any, planets: int) -> Any:
    """How equally spaced planets mesh with a central gear: 0 in step, 1 in counter-phase, 2 else.

    In step where z/N is whole; in counter-phase where every second one is half a pitch behind.
    """
    rest = teeth % planets
    return choose(rest == 0, 0, choose(2 * rest == planets, 1, 2))
