"""Kernels of the layout against plain numpy, and their bounds against every sampled layout."""

import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import few
from gearboxes import gearbox, law, places, some_box
from uncompiled import uncompiled

from gearopt.formulations.drive.gearbox import Clearances, KeepOut, Place
from gearopt.formulations.drive.layout import problem
from gearopt.formulations.drive.layout.chain import chain
from gearopt.formulations.drive.layout.slabs import arrangements
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve

K = uncompiled("gearopt.formulations.drive.layout.chain_kernel")
BOUND = uncompiled("gearopt.formulations.drive.layout.bound_kernel")
ANNEAL = uncompiled("gearopt.formulations.drive.layout.anneal_kernel")
KEEPS = (
    KeepOut("wall", (60.0, math.inf), (-math.inf, 40.0)),
    KeepOut("post", (-300.0, -150.0), (20.0, 90.0), (0.0, 90.0)),
)
GIVEN = {
    "plain": {},
    "face": {"objective": "face_area"},
    "plan": {"objective": "plan_area"},
    "height": {"objective": "height", "largest": (700.0, math.inf, math.inf)},
    "longest": {"objective": "longest_side"},
    "narrow": {"width": 800.0},
    "kept": {"keep_outs": KEEPS},
    "placed": {"places": (Place(2, (-200.0, 50.0)), Place(1, z=(0.0, math.inf)))},
    "level": {"level": (0, 2)},
}


def boxes(seeds):
    for seed in seeds:
        for name, given in GIVEN.items():
            box = some_box(seed, **given)
            yield seed, name, box, chain(box, arrangements(box))


def test_measure_and_value_are_the_plain_law():
    rng = np.random.default_rng(1)
    for _, name, _, shape in boxes(range(3)):
        theta = rng.uniform(-4.0, 4.0, (50, shape.link.size))
        y, z = places(shape, theta)
        objective, short = law(shape, 0, y, z)
        at = np.zeros((2, shape.reach.size))
        for p in range(50):
            width, height, lack = K.measured_at_angles(shape, 0, theta[p], at[0], at[1])
            assert at == pytest.approx(np.stack([y[p], z[p]]), abs=1e-9), name
            assert lack == pytest.approx(short[p], rel=1e-9, abs=1e-9), name
            assert K.value(shape, 0, width, height) == pytest.approx(objective[p], rel=1e-12), name
            assert K.measured_at_positions(shape, 0, y[p], z[p])[2] == pytest.approx(
                short[p], abs=1e-9
            )


def test_cosines_hold_every_sample():
    rng = np.random.default_rng(2)
    for size in (1e-13, 1e-6, 0.1, 3.0, 7.0):
        for low in np.concatenate([rng.uniform(-20.0, 20.0, 200), np.arange(-9, 9) * math.pi / 2]):
            t = np.cos(np.linspace(low, low + size, 101))
            least, most = K.cosines(low, low + size)
            assert least <= t.min() and t.max() <= most
            slack = 1e-11 + 0.5 * (size / 100.0) ** 2  # of sampling
            assert t.min() - slack <= least and most <= t.max() + slack


def test_lowest_is_the_least_of_samples():
    rng = np.random.default_rng(3)
    for _ in range(2000):
        a, b = rng.normal(size=2) * 10.0 ** rng.uniform(-3, 3)
        low, size = rng.uniform(-10.0, 10.0), 10.0 ** rng.uniform(-8, 1)
        t = np.linspace(low, low + size, 201)
        samples = a * np.cos(t) + b * np.sin(t)
        where, least = K.lowest(a, b, low, low + size)
        scale = math.hypot(a, b)
        assert low <= where <= low + size
        assert least == pytest.approx(a * math.cos(where) + b * math.sin(where), abs=1e-12 * scale)
        assert least <= samples.min() + 1e-12 * scale
        assert samples.min() <= least + scale * (1e-12 + 0.5 * (size / 200.0) ** 2)


def bounds_of(shape, low, high, aim=math.inf):
    """Whether a cell is excluded, its sides, and its sharp bound."""
    links = low.size
    spans = tuple(np.zeros((links + 1, links + 1)) for _ in range(4))
    if K.excluded(shape, 0, low, high, *spans):
        return True, None, math.inf
    sides = K.sides(shape, *spans)
    room, pull, theta = BOUND.scratch(links), np.zeros((2, links)), np.zeros(links)
    return False, sides, BOUND.sharp(shape, 0, low, high, spans, sides, aim, room, pull, theta)


def some_cell(rng, links):
    """A cell of any size, down to a point and up to more than a turn, anywhere."""
    size = np.minimum(10.0 ** rng.uniform(-9, 1, links), 7.0) * rng.choice([0.0, 1.0], p=[0.1, 0.9])
    if rng.random() < 0.5:
        size[:] = size[0]
    low = rng.uniform(-4.0, 4.0, links)
    return low, low + size


MANY = [(range(k, k + 3), 150) for k in (5, 14, 23)]


@pytest.mark.parametrize(("seeds", "cells"), few([(range(4, 5), 25), *MANY], 1))
def test_no_layout_of_a_cell_is_below_its_bounds(seeds, cells):
    rng = np.random.default_rng(seeds[0])
    met = {"excluded": 0, "feasible": 0, "aimed": 0}
    for seed, name, _, shape in boxes(seeds):
        for _ in range(cells):
            low, high = some_cell(rng, shape.link.size)
            theta = low + rng.random((60, low.size)) * (high - low)
            theta[:20] = np.where(rng.random((20, low.size)) < 0.5, low, high)  # corners
            y, z = places(shape, theta)
            value, short = law(shape, 0, y, z)
            here = short <= 0.0
            aim = float(value.min()) * 1.05 if rng.random() < 0.5 else math.inf
            out, sides, least = bounds_of(shape, low, high, aim)
            met["excluded"] += out
            if not here.any():
                continue
            met["feasible"] += 1
            assert not out, (seed, name)
            width = (y + shape.reach).max(1) - (y - shape.reach).min(1)
            height = (z + shape.reach).max(1) - (z - shape.reach).min(1)
            tiny = 1e-12 * (width + height)
            assert (sides[0] - tiny <= width).all() and (width <= sides[1] + tiny).all()
            assert (sides[2] - tiny <= height).all() and (height <= sides[3] + tiny).all()
            met["aimed"] += least == aim
            assert least <= max(value[here].min() * (1.0 + 1e-12), 0.0) or (
                least <= aim <= value[here].min() * (1.0 + 1e-12)
            ), (seed, name)
    assert min(met["excluded"], met["feasible"]) > cells


def test_the_cut_of_a_distance_holds_for_every_layout_that_keeps_it():
    rng = np.random.default_rng(5)
    cuts = 0
    for seed in range(20):
        shape = (box := some_box(seed)) and chain(box, arrangements(box))
        links = shape.link.size
        for _ in range(50):
            low, high = some_cell(rng, links)
            y, z = places(shape, low + rng.random((200, links)) * (high - low))
            dy, dz = y[:, links] - y[:, 0], z[:, links] - z[:, 0]
            there = np.hypot(dy, dz)
            need = float(rng.uniform(0.9, 1.1) * there.mean())
            p, q, b = BOUND.cut(shape, need, low, high, 0, links, float(dy[0]), float(dz[0]))
            cuts += b > 0.0
            far = there >= need
            assert b == 0.0 or (p * dy[far] + q * dz[far] >= b).all()
    assert cuts > 50


@pytest.mark.parametrize(
    "given",
    [
        pytest.param({}, marks=pytest.mark.slow),
        {"objective": "height", "largest": (450.0, math.inf, math.inf)},
        pytest.param({"objective": "longest_side"}, marks=pytest.mark.slow),
        pytest.param({"width": 450.0}, marks=pytest.mark.slow),
        {"level": (0, 2)},
    ],
)
def test_bounds_converge_with_the_square_of_the_cell(given):
    """Of cells around the best layout; a tenth of the side has a hundredth of the error."""
    box = gearbox("discrete", Clearances(0.0, 0.0, 10.0, 0.0), **given)
    shape = chain(box, arrangements(box)[:1])
    best = solve(problem(box), budget=Budget(gap=1e-8), gap=1e-8)
    assert best.status == "optimal"
    theta = np.array(best.design["angle_rad"])
    y, z = places(shape, theta[None])
    value = float(law(shape, 0, y, z)[0][0])
    errors = []
    for size in (0.03, 0.003):
        _, _, least = bounds_of(shape, theta - 0.4 * size, theta + 0.6 * size)
        errors.append(value - least)
    slope = math.log10(errors[0] / errors[1])
    assert errors[1] > 0.0
    assert slope > 1.8


def test_closings_reach_what_they_close_on():
    rng = np.random.default_rng(6)
    box = gearbox("table4_p1", places=(Place(3, (100.0, 100.0), (350.0, 350.0)),))
    shape = chain(box, arrangements(box))
    assert list(shape.close) == [0, 2, 3]
    level = chain(
        replace(box, places=(Place(3, z=(-50.0, -50.0)),), level=(0, 1)), arrangements(box)
    )
    assert list(level.close) == [1, 0, 1]
    for _ in range(200):
        theta, back = rng.uniform(-4.0, 4.0, 3), np.zeros(3)
        y, z = np.zeros(4), np.zeros(4)
        ANNEAL.placed(shape, theta, y, z)
        ANNEAL.directions(y, z, back)
        there = places(shape, back[None])
        reachable = abs(math.hypot(100.0 - y[1], 350.0 - z[1])) < shape.link[1:].sum()
        assert np.hypot(np.diff(y), np.diff(z)) == pytest.approx(shape.link)
        assert not reachable or (y[3], z[3]) == pytest.approx((100.0, 350.0))
        assert not reachable or [there[0][0, 3], there[1][0, 3]] == pytest.approx([100.0, 350.0])
        ANNEAL.placed(level, theta, y, z)
        assert z[1] == 0.0 and np.hypot(np.diff(y), np.diff(z)) == pytest.approx(shape.link)
        assert z[3] == pytest.approx(-50.0) or abs(-50.0 - z[2]) > shape.link[2]


def test_a_search_without_room_or_that_cannot_halve_keeps_an_honest_floor():
    branch = kernel("gearopt.formulations.drive.layout.branch_kernel").branch
    box = gearbox("table4_p1")
    shape = chain(box, arrangements(box))
    cells, bounds, theta = np.zeros((3, 2, 3)), np.zeros(3), np.zeros(3)
    cells[0, 0], cells[0, 1] = -math.pi, math.pi
    count, best, floor = 1, 8e7, math.inf
    while count:
        state = (count, best, 0.0, floor, 1e-6, 10**6)
        count, best, _, floor, _ = branch(shape, 0, cells, bounds, *state, theta)
    assert count == 0 and 0.0 < floor <= 75_516_511.6 < best
