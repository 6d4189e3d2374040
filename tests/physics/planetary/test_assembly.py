"""Places of planets, against brute force over all positions of their teeth."""

from fractions import Fraction
from itertools import product
from math import gcd, pi, sin

import numpy as np
import pytest

from gearopt.physics.planetary import assembly

TEETH = np.arange(12, 121)


def fits(angle, steps):
    """Whether some turn of a planet fits all its meshes; steps: (central teeth signed, planet)."""
    (first, teeth), *others = steps
    for k in range(teeth):
        turn = (first * angle + k) / teeth  # of the planet relative to its arm, in turns
        if all((z * angle - p * turn).denominator == 1 for z, p in others):
            return True
    return False


def equally(planets, steps):
    return all(fits(Fraction(k, planets), steps) for k in range(planets))


@pytest.mark.parametrize("planets", [3, 4, 5, 6])
def test_simple_sets_in_a_sample(planets):
    """Every tooth of every planet is tried in turn, in whole numbers of a common fraction."""
    check_simple(planets, TEETH[::9], TEETH[::6], TEETH[::7])


@pytest.mark.slow
@pytest.mark.parametrize("planets", [3, 4, 5, 6])
def test_all_simple_sets(planets):
    check_simple(planets, TEETH, TEETH, TEETH)


def check_simple(planets, suns, planet_teeth, rings):
    """Angles in parts of a turn 1/(N z_p): z_p chi = z_s phi + k, and z_p chi + z_r phi is whole.

    chi runs over z_p positions for each planet; the teeth of a ring fit at one of them or none.
    """
    sun, ring = (a.ravel() for a in np.meshgrid(suns, rings, indexing="ij"))
    for z_p in planet_teeth:
        whole = np.ones(sun.size, bool)
        for k in range(1, planets):
            turns = np.arange(z_p)[:, None]
            chi = sun * k + planets * turns  # in parts of a turn 1/(N z_p)
            at_ring = chi + ring * k  # z_p chi + z_r phi in parts 1/N of a pitch
            whole &= (at_ring % planets == 0).any(axis=0)
        assert np.array_equal(whole, assembly.places(sun, z_p, z_p, ring) % planets == 0)


def test_stepped_planets():
    """Random stepped sets, also with a common divisor of both steps."""
    rng, seen = np.random.default_rng(5), set()
    for _ in range(300):
        s, p, q, r = (int(z) for z in rng.integers(12, 60, 4))
        if rng.integers(2):
            d = int(rng.integers(2, 7))
            p, q = max(d, p // d * d), max(d, q // d * d)
        n = int(rng.integers(2, 7))
        known = assembly.places(s, p, q, r)
        able = equally(n, [(s, p), (-r, q)])
        assert able == (known % n == 0)
        seen.add((bool(able), gcd(p, q) > 1))
        assert fits(Fraction(1, int(known)), [(s, p), (-r, q)])
    assert len(seen) == 4


def of_two_rings(s, p, r, q, t):
    return gcd(int(assembly.places(s, p, p, r)), int(assembly.places(s, p, q, t)))


def test_wolfrom_sets():
    rng, seen = np.random.default_rng(6), set()
    for k in range(300):
        s, p, q = (int(z) for z in rng.integers(12, 40, 3))
        r, t = s + 2 * p, s + p + q
        n = int(rng.integers(2, 5))
        known = of_two_rings(s, p, r, q, t)
        able = equally(n, [(s, p), (-r, p), (-t, q)])
        assert able == (known % n == 0), k
        seen.add(bool(able))
    assert seen == {True, False}


def test_published_sets():
    """Stepped 24/48/20/92: 408 a planet of three. A 3K set that six planets do not fit alike.

    5/4/13 with 6/21 is that of the public repository CKraft11/pygeartrain.
    """
    assert assembly.places(24, 48, 20, 92) == 3 * 408
    assert of_two_rings(5, 4, 13, 6, 21) % 6 != 0
    assert of_two_rings(18, 36, 90, 33, 87) % 3 == 0
    for s, r, n, whole in ((18, 93, 3, 37), (21, 99, 3, 40), (26, 89, 5, 23), (17, 61, 3, 26)):
        assert assembly.places(s, 7, 7, r) == n * whole


def test_nearest_places_are_the_nearest_of_all():
    """Against every choice of places: the largest deviation from k/N is as small as it can be."""
    for count, planets in product((7, 10, 13, 111), (3, 4, 5)):
        where = assembly.spread(count, planets)
        parts = [Fraction(int(w), count) - Fraction(k, planets) for k, w in enumerate(where)]
        nearest = [
            min(abs(Fraction(w, count) - Fraction(k, planets)) for w in range(count + 1))
            for k in range(planets)
        ]
        assert [abs(p) for p in parts] == nearest
        around = [*where, count]
        gaps = [b - a for a, b in zip(around, around[1:], strict=False)]
        assert assembly.least_spacing(count, planets) == pytest.approx(min(gaps) / count)


def test_distance_of_neighbours():
    """17/22 of module 4, three planets: axes 135.09996 mm apart (REXS sample stage)."""
    apart = assembly.neighbour_distance(78.0, 1 / 3)
    assert apart == pytest.approx(135.099962990372, rel=1e-12)
    assert apart == pytest.approx(2 * 78.0 * sin(pi / 3), rel=1e-14)
