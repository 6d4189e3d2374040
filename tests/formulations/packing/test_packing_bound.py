"""The bound of a packing: against closed forms, brute force, and packings at random."""

import math
from itertools import permutations

import numpy as np
import pytest
from campaigns import few

from gearopt.formulations.packing.container_bound import (
    _pair,
    _triple,
    bound,
    depth,
    orders,
    orders_of,
)
from gearopt.formulations.packing.plan import Cylinder, Plan


def plan(*diameters, height=10.0, **kind):
    discs = tuple(Cylinder(f"c{k}", d / 2.0, height) for k, d in enumerate(diameters))
    return Plan(discs, objective=kind.pop("objective", "area"), **kind)


@pytest.mark.parametrize(
    ("what", "area"),
    [
        (plan(20), 400.0),
        (plan(20, 20), 800.0),
        (plan(20, 10), 20 * (15 + math.sqrt(200))),
        (plan(20, 1), 400.0),  # it fits into a corner
        (plan(20, 20, width=20.0), 800.0),
        (plan(20, 20, width=30.0), 30 * (20 + math.sqrt(300))),
        (plan(20, 20, width=50.0), 1000.0),
        (plan(20, 20, 20, 10, 10, 10, width=20.0), 20 * (20 + 4 * math.sqrt(200))),
        (plan(20, 20, shape="square"), (20 + 10 * math.sqrt(2)) ** 2),
        (plan(1, 1, 1, shape="square"), (1 + 1 / (math.sqrt(6) - math.sqrt(2))) ** 2),
        (plan(1, 1, 1, 1, 1, shape="square"), (1 + math.sqrt(2)) ** 2),
        (plan(20, 20, shape="circle"), math.pi * 400),
        (plan(20, 10, shape="circle"), math.pi * 225),
        (plan(*[3.0] * 4, width=3.0), 36.0),
        (plan(20, 10, gap=2.0, wall=3.0), 26 * (6 + 15 + math.sqrt(17**2 - 25))),
        (plan(20, 20, gap=2.0), 20 * 42.0),
    ],
)
def test_it_is_exact_where_the_best_packing_is_known(what, area):
    found = bound(what).value
    assert found == pytest.approx(area, rel=2e-9) and found <= area


def test_layers_share_out_every_way():
    """Six cylinders: 17,485.28 in three layers, 16,000 in four."""
    six = (20, 20, 20, 10, 10, 10)
    for most, volume in ((3, 600 * (15 + math.sqrt(200))), (4, 16_000.0)):
        found = bound(plan(*six, min_layers=most, max_layers=most, objective="volume"))
        assert found.value == pytest.approx(volume, rel=2e-9) and found.value <= volume
        assert found.choices > 1


def test_too_many_ways_fall_back_to_the_volume():
    sizes = np.linspace(5, 15, 12)
    found = bound(plan(*sizes, min_layers=1, max_layers=4, objective="volume"))
    assert found.choices == 0
    assert found.value == pytest.approx(10 * math.pi / 4 * (sizes**2).sum(), rel=1e-9)
    flat = bound(plan(*sizes, min_layers=1, max_layers=4))
    assert flat.value == pytest.approx(math.pi / 16 * (sizes**2).sum(), rel=1e-9)


def test_fixed_layers_and_places_are_kept():
    at = tuple(Cylinder(f"f{k}", 10.0, 10.0, at=(20.0 * k, 0.0)) for k in range(3))
    assert bound(Plan((*at, Cylinder("s", 1.0, 10.0)))).value == pytest.approx(12_000, rel=1e-9)
    apart = Plan(
        (Cylinder("a", 10.0, 10.0, layer=1), Cylinder("b", 10.0, 10.0, layer=2)), max_layers=2
    )
    assert bound(apart).value == pytest.approx(8_000, rel=1e-9)


def strip(radii, w, rng):
    """Discs dropped one by one into a strip of width w at random: a packing, and its depth."""
    placed = []
    for r in radii:
        x = rng.uniform(r, w - r)
        y = r
        for a, b, q in sorted(placed, key=lambda c: c[1]):
            if abs(x - a) < r + q and (x - a) ** 2 + (y - b) ** 2 < (r + q) ** 2:
                y = max(y, b + math.sqrt((r + q) ** 2 - (x - a) ** 2))
        while any((x - a) ** 2 + (y - b) ** 2 < (r + q) ** 2 * (1 - 1e-12) for a, b, q in placed):
            y += 0.01 * r
        placed.append((x, y, r))
    return max(y + r for _, y, r in placed)


@pytest.mark.parametrize("seed", few(range(8), 4))
def test_no_packing_at_random_is_less_deep(seed):
    rng = np.random.default_rng(seed)
    radii = rng.choice([1.0, 1.5, 2.5, 4.0], size=int(rng.integers(2, 7)))
    w = 2.0 * radii.max() * rng.uniform(1.0, 2.0)
    needed = float(depth(radii, np.array([w]))[0])
    shallowest = min(strip(rng.permutation(radii), w, rng) for _ in range(300))
    assert needed <= shallowest
    assert needed >= 0.45 * shallowest  # a bound that is no joke


@pytest.mark.parametrize("seed", range(6))
def test_a_triple_needs_what_brute_force_finds(seed):
    """The least over a grid of places across, of the last axis along; the order is kept."""
    rng = np.random.default_rng(seed)
    a, b, c = rng.uniform(1.0, 3.0, 3)
    w = 2.0 * max(a, b, c) * rng.uniform(1.0, 1.9)
    xa, xb, xc = np.meshgrid(
        *(np.linspace(r, w - r, 61) for r in (a, b, c)), indexing="ij", sparse=True
    )

    def along(apart, across):
        return np.sqrt(np.maximum(apart**2 - across**2, 0.0))

    last = np.maximum(along(a + b, xb - xa) + along(b + c, xc - xb), along(a + c, xc - xa))
    found = float(_triple(a, b, c, np.array([w]))[0])
    assert found <= last.min() + 1e-9
    assert found >= last.min() - 0.1 * (a + b + c)  # the grid is coarse where a root is steep
    assert found >= float(_pair(a, c, np.array([w]))[0])


def test_a_root_of_nothing_is_nothing():
    """Discs of 0.1 and 0.2 side by side: across they are 0.3 less a rounding apart, along 0."""
    for a, b in ((0.1, 0.2), (0.7, 0.1), (1.1, 2.2), (10.0, 1 / 3)):
        assert float(_pair(a, b, np.array([2 * (a + b)]))[0]) == 0.0
        assert float(_pair(a, b, np.array([a + a + b + b]))[0]) == 0.0


def test_depth_falls_with_width():
    w = np.linspace(8.0, 60.0, 4001)
    found = depth([4.0, 4.0, 2.0, 2.0, 1.0], w)
    assert np.all(np.diff(found) <= 1e-9 * found[0])


def test_many_discs_are_bounded_by_area_and_olers_inequality():
    """A row of equal discs is exact; beyond 300 orders the order is left out."""
    assert orders_of(np.repeat([1.0, 2.0], 10)) > 300
    assert depth([1.0] * 40, np.array([2.0]))[0] == pytest.approx(80.0)
    mixed = depth([1.0] * 10 + [2.0] * 10, np.array([12.0]))[0]
    assert mixed >= math.pi * 50 / 12


def test_orders_are_all_different_ones():
    assert sorted(orders([1, 1, 2])) == sorted(set(permutations([1, 1, 2])))


@pytest.mark.parametrize(
    ("radii", "wall", "gap"),
    few([((4, 4, 4, 5), 0.5, 1.0), ((2, 2, 2, 3), 0.0, 0.0), ((3, 3, 3, 5), 2.0, 0.0)], 1),
)
def test_no_bound_is_above_the_least_of_its_own_function(radii, wall, gap):
    """Where the best rectangle is nearly square, width and depth rise together."""
    discs = plan(*(2.0 * r for r in radii), wall=wall, gap=gap)
    rho, spare = np.array(radii) + 0.5 * gap, 2.0 * wall - gap
    w = np.linspace(2.0 * rho.max(), 4.0 * rho.max(), 20_001)
    least = ((w + spare) * (np.maximum(depth(tuple(rho), w), w) + spare)).min()
    value = bound(discs).value
    assert value <= least * (1.0 + 1e-9)
    assert value >= least * (1.0 - 1e-3)
