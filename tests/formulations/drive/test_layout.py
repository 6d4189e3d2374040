"""Layouts of gearboxes: published boxes, a grid of all layouts, local searches, methods."""

import math
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from campaigns import few
from gearboxes import gearbox, law, places, some_box

from gearopt.errors import SolveError
from gearopt.formulations.drive.gearbox import Clearances, Gearbox, KeepOut, Place, Shaft
from gearopt.formulations.drive.layout import exact, problem
from gearopt.formulations.drive.layout.chain import chain, turns
from gearopt.formulations.drive.layout.layout_text import positions, sides, smooth
from gearopt.formulations.drive.layout.slabs import arrange, arrangements, clashes, in_order
from gearopt.optimise.box import violation
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.optimise.solvers import ipopt
from gearopt.physics.gears import GearPair

NONE = Clearances(0.0, 0.0, 0.0, 0.0)
DEGREE = math.radians(1.0)
PUBLISHED = [  # train, clearances, partial span, box [mm3]
    ("table4_p1", Clearances(), False, 75_516_512),
    ("table4_p1", NONE, False, 56_826_192),
    ("table4_p1", Clearances(), True, 55_654_946),
    ("table4_p2", Clearances(), False, 66_689_036),
    ("table4_p2", Clearances(), True, 50_183_602),
    ("discrete", Clearances(), False, 47_483_118),
    ("discrete", Clearances(), True, 40_113_089),
    ("elevator_p1", Clearances(), False, 27_094_106),
    ("elevator", Clearances(), False, 18_406_834),
]


@pytest.mark.parametrize(
    ("name", "clearances", "partial", "volume"), few(PUBLISHED, PUBLISHED[3::3])
)
def test_published_boxes(name, clearances, partial, volume):
    box = gearbox(name, clearances, partial=partial)
    text = problem(box, "exact")
    result = solve(text, "exact", gap=1e-4)
    assert result.status == "optimal"
    assert result.gap <= 1e-4
    assert round(result.value) == volume
    tight = solve(text, budget=Budget(gap=1e-8), gap=1e-8)
    assert tight.status == "optimal"
    assert tight.value == pytest.approx(volume, abs=0.6)


def test_sides_of_the_published_boxes():
    box = gearbox("table4_p1")
    (one,) = arrangements(box)
    angles = solve(problem(box)).design["angle_rad"]
    found = sides(chain(box, (one,)), *positions(chain(box, (one,)), tuple(angles)))
    assert one.length == pytest.approx(209.9)
    assert sorted((found["width"], found["height"])) == pytest.approx([411.98, 873.29], abs=0.01)


def test_stages_in_one_slab_clash():
    for name, short in (("table4_p1", 43.0), ("discrete", 15.0)):
        box = gearbox(name)
        worst = clashes(box, arrange(box, ((0, 2), (1,))))[0]
        assert worst.short == pytest.approx(short, abs=0.5)
        assert worst.need.between == ("wheel 1", "pinion 3")
        assert [a.slabs for a in arrangements(box)] == [((0,), (1,), (2,))]
        shared = solve(problem(replace(box, slabs=((0, 2), (1,)))))
        assert shared.status == "infeasible"


def test_shaft_beside_a_wheel_of_a_neighbour_is_a_data_check():
    """a_2 - r_a1 is 25.8 mm, of which a shaft of 45.6 mm leaves 3.0 mm."""
    box = gearbox("table4_p1")
    between = box.pairs[1].centre_distance - 0.5 * box.pairs[0].wheel.tip_diameter
    assert between == pytest.approx(25.8, abs=0.02)
    shafts = (*box.shafts[:2], Shaft(22.8), box.shafts[3])
    left = between - 22.8
    assert left == pytest.approx(3.0, abs=0.02)
    for clearance, short in ((left - 0.01, False), (left + 0.01, True)):
        other = replace(box, shafts=shafts, clearances=Clearances(5.0, clearance))
        assert bool(clashes(other, arrange(other, in_order(other)))) == short
        result = solve(problem(other))
        assert result.status == ("infeasible" if short else "optimal")
        ends = solve(problem(other, "ipopt"), "ipopt")
        assert (ends.value is None) == short


def weak_orders(stages):
    """Every order of slabs in which no stages that follow each other share one."""
    for rank in product(range(stages), repeat=stages):
        used = sorted(set(rank))
        if used == list(range(len(used))) and all(a != b for a, b in zip(rank, rank[1:])):  # noqa: B905
            yield tuple(tuple(s for s in range(stages) if rank[s] == r) for r in used)


@pytest.mark.parametrize(
    ("stages", "seed"), few(product([2, 3, 4], range(6)), [*product([2, 3], range(6)), (4, 5)])
)
def test_arrangements_against_all_weak_orders(stages, seed):
    keep = KeepOut("post", (-100.0, 100.0), (150.0, 200.0), (0.0, 60.0))
    box = some_box(seed, stages, partial=seed > 1, slabs=None, keep_outs=(keep,) * (seed % 2))
    if seed > 2:  # bearings that reach into the slab beside theirs
        wide = box.clearances.axial + 8.0
        box = replace(box, shafts=tuple(Shaft(s.radius, s.radius + 6, wide) for s in box.shafts))
    free = np.triu_indices(stages + 1, 2)
    every = [arrange(box, slabs) for slabs in weak_orders(stages)]
    assert len(every) == {2: 2, 3: 8, 4: 44}[stages]
    possible = [a for a in every if not clashes(box, a)]
    kept = arrangements(box)

    def better(a, b):
        return (
            a.length <= b.length + 1e-8
            and (a.apart[free] <= b.apart[free] + 1e-8).all()
            and (a.keep_apart <= b.keep_apart + 1e-8).all()
        )

    assert all(any(better(k, a) for k in kept) for a in possible)
    assert {k.slabs for k in kept} <= {a.slabs for a in possible}
    assert not any(better(a, b) for a in kept for b in kept if a is not b)


@pytest.mark.slow
def test_the_best_arrangement_is_that_of_every_one_tried():
    box = some_box(3, 4, partial=False, slabs=None)
    orders = arrangements(box)
    assert len(orders) > 1
    best = solve(problem(box))
    alone = [solve(problem(replace(box, slabs=a.slabs))).value for a in orders]
    assert best.status == "optimal"
    assert best.value == pytest.approx(min(alone), rel=2e-6)
    assert alone[best.design["arrangement"]] == pytest.approx(min(alone), rel=2e-6)
    with pytest.raises(SolveError, match="one order of slabs"):
        problem(box, "ipopt")


FOLDED = Gearbox(  # coaxial: both centre distances are the same
    (GearPair.of_teeth(3.0, 26, 242 / 3, 30.0), GearPair.of_teeth(4.0, 24, 56, 50.0)),
    (Shaft(10.0), Shaft(17.5), Shaft(30.0)),
    partial=True,
)
ELEVATOR = gearbox("elevator")
GRID = {
    "volume": ELEVATOR,
    "height": replace(ELEVATOR, objective="height", largest=(500.0, math.inf, math.inf)),
    "plan_area": replace(ELEVATOR, objective="plan_area", largest=(math.inf, 400.0, math.inf)),
    "longest_side": replace(ELEVATOR, objective="longest_side"),
    "width": replace(ELEVATOR, width=420.0),
    "keep_out": replace(ELEVATOR, keep_outs=(KeepOut("pump", (60.0, 300.0), (-200.0, 120.0)),)),
    "two_posts": replace(
        ELEVATOR,
        keep_outs=(
            KeepOut("post", (-250.0, -200.0), (-50.0, 300.0)),
            KeepOut("ceiling", (-math.inf, math.inf), (250.0, math.inf)),
        ),
    ),
    "output_height": replace(ELEVATOR, places=(Place(2, z=(99.0, 101.0)),)),
    "output_side": replace(ELEVATOR, places=(Place(2, y=(199.0, math.inf)),)),
    "output_place": replace(ELEVATOR, places=(Place(2, (147.0, 153.0), (197.0, 203.0)),)),
    "split_line": replace(ELEVATOR, places=(Place(1, z=(-1.0, 1.0)), Place(2, z=(-2.0, 2.0)))),
    "coaxial": replace(FOLDED, places=(Place(2, (-2.0, 2.0), (-2.0, 2.0)),)),
    "motor": replace(ELEVATOR, motor=150.0),
}
IMPOSSIBLE = {
    "too_far": replace(ELEVATOR, places=(Place(2, (390.0, math.inf)),)),
    "coaxial": replace(ELEVATOR, places=(Place(2, (-2.0, 2.0), (-2.0, 2.0)),)),
    "too_low": replace(ELEVATOR, largest=(400.0, 400.0, math.inf)),
    "input_in_the_way": replace(ELEVATOR, keep_outs=(KeepOut("pump", (0.0, 9.0), (0.0, 9.0)),)),
    "walled_in": replace(
        ELEVATOR,
        keep_outs=(
            KeepOut("pump", (-300.0, 300.0), (100.0, 150.0)),
            KeepOut("floor", (-math.inf, math.inf), (-math.inf, -100.0)),
        ),
    ),
}


@cache
def half_degrees():
    t = np.arange(-math.pi, math.pi, 0.5 * DEGREE)
    return np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)


def best_on_grid(box):
    """The least objective of all layouts at half degrees."""
    shape = chain(box, arrangements(box)[:1])
    value, short = law(shape, 0, *places(shape, half_degrees()))
    return float(value[short <= 0.0].min(initial=math.inf))


@pytest.mark.parametrize("name", few(GRID, ["keep_out"]))
def test_exact_against_a_grid(name):
    box = GRID[name]
    result, grid = solve(problem(box)), best_on_grid(box)
    assert result.status == "optimal"
    assert result.bound <= result.value <= grid
    assert grid <= 1.06 * result.value  # a step moves the last shaft by 3 mm


@pytest.mark.parametrize("name", few(IMPOSSIBLE, ["walled_in"]))
def test_exact_proves_what_no_grid_point_contradicts(name):
    box = IMPOSSIBLE[name]
    result = solve(problem(box))
    assert result.status == "infeasible"
    assert result.proof["method"] == "exhausted"
    assert result.proof["sentence"].endswith("interval arithmetic; none is left to examine.")
    assert best_on_grid(box) == math.inf


def test_too_long_a_box_is_impossible():
    box = gearbox("elevator")
    length = arrangements(box)[0].length
    for most, status in ((length - 0.01, "infeasible"), (length, "optimal")):
        limited = replace(box, largest=(math.inf, math.inf, most))
        assert solve(problem(limited)).status == status
    assert solve(problem(limited)).limits["largest_length"] == 1.0


def test_equal_heights_and_places_are_met():
    box = gearbox("discrete")
    level = solve(problem(replace(box, level=(0, 1, 3))))
    y, z = positions(chain(box, arrangements(box)), tuple(level.design["angle_rad"]))
    assert level.status == "optimal"
    assert z[1] == pytest.approx(0.0, abs=1e-5) and z[3] == pytest.approx(0.0, abs=1e-5)
    for at in ({"y": (150.0, 150.0)}, {"z": (-150.0, -150.0)}):
        result = solve(problem(replace(box, places=(Place(3, **at),))))
        assert result.status == "optimal"
        assert result.value == pytest.approx(47_483_118, abs=1.0)  # a reflection of the best


@pytest.mark.parametrize("given", [{"level": (0, 2)}, {"objective": "height"}])
def test_the_range_of_the_first_angle_leaves_nothing_out(given):
    box = gearbox("elevator", **given)
    low, high = turns(box)
    everywhere = replace(box, keep_outs=(KeepOut("far away", (1e6, 2e6), (1e6, 2e6)),))
    assert high - low <= 0.5 * math.pi and turns(everywhere) != (low, high)
    assert solve(problem(everywhere)).value == pytest.approx(solve(problem(box)).value, rel=2e-6)


def local(box, starts, seed):
    """The best of Ipopt from random layouts."""
    orders = arrangements(box)
    shape, text = chain(box, orders), smooth(box, orders[0])
    rng, best = np.random.default_rng(seed), math.inf
    for _ in range(starts):
        theta = rng.uniform(-math.pi, math.pi, len(box.pairs))
        found = sides(shape, *positions(shape, tuple(theta)))
        start = [*theta, *(found[n] for n in ("left", "bottom", "width", "height"))]
        x = ipopt.run(text, Budget(), 0, None, start=np.array(start)).x
        if x is not None:
            value, excess = violation(text, x[None])
            best = min(best, float(value[0])) if excess[0] <= 1e-9 else best
    return best


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 17, 31])
def test_no_local_optimum_is_below_the_bound(seed):
    box = some_box(seed)
    result, best = solve(problem(box)), local(box, 60, seed)
    assert result.status == "optimal"
    assert result.bound <= best * (1.0 + 1e-8)
    assert result.value <= best * (1.0 + 1e-6)


@pytest.mark.parametrize("seed", few(range(12), 2))
def test_random_trains_are_proven(seed):
    result = solve(problem(some_box(seed)))
    assert result.status == "optimal"
    assert result.gap <= 1e-6


@pytest.mark.slow
def test_annealing_on_angles_is_near_the_optimum():
    text = problem(gearbox("table4_p1"), "sa")
    values = [solve(text, "sa", Budget(evaluations=128_701), seed).value for seed in range(25)]
    gaps = np.array(values) / 75_516_511.57 - 1.0
    assert gaps.min() >= -1e-9
    assert np.median(gaps) <= 2e-4
    assert gaps.max() <= 1e-2


@pytest.mark.parametrize(
    "method", few(["sa", "sa-polish", "sa-paper", "exact", "multistart", "nsga2"], 3)
)
def test_a_seed_decides_the_answer(method):
    box = gearbox("elevator")
    budget = Budget(evaluations={"multistart": 100, "nsga2": 1000}.get(method, 5000))
    runs = [run(problem(box, method), method, budget, seed)[1] for seed in (3, 3, 4)]
    assert (runs[0].x == runs[1].x).all()
    assert runs[0].evaluations == runs[1].evaluations
    same = method in ("exact", "multistart")  # the optimum; a first start that is given
    assert same or (runs[0].x != runs[2].x).any()


@pytest.mark.parametrize("seed", few(range(5), 1))
def test_polishing_never_loses(seed):
    box = gearbox("table4_p1")
    rough, fine = (solve(problem(box, m), m, seed=seed) for m in ("sa", "sa-polish"))
    assert 75_516_511 < fine.value <= rough.value


@pytest.mark.parametrize("method", ["sa", "sa-polish", "sa-paper", "exact"])
def test_budgets_are_honoured(method):
    box = gearbox("table4_p1", partial=True)
    for most in (500, 30_000):
        outcome = run(problem(box, method), method, Budget(evaluations=most))[1]
        assert 0 < outcome.evaluations <= most
    late = run(problem(box, method), method, Budget(seconds=0.0))[1]
    assert not late.finished
    assert 0 < late.evaluations <= 20_000


@pytest.mark.parametrize("method", ["sa", "exact"])
def test_a_watcher_stops_a_run_and_keeps_the_best(method):
    events = []

    def watch(event):
        events.append(event)
        return len(events) < 3

    result = solve(problem(gearbox("table4_p1"), method), method, watch=watch)
    assert len(events) == 3
    assert result.evaluations <= 60_000
    assert result.status == "limit"
    assert result.value <= events[-1].best * (1.0 + 1e-12)  # what came after is kept too


@pytest.mark.slow
def test_exact_stopped_early_keeps_a_valid_bound():
    box = some_box(10, 5, partial=False)
    whole = solve(problem(box))
    assert whole.status == "optimal"
    bounds = []
    for spare in (50, 1000):
        spent = exact.STARTS * exact.STEPS + spare
        result = solve(problem(box), "exact", Budget(evaluations=spent))
        assert result.status == "limit" and result.evaluations <= spent
        assert result.value >= whole.bound
        bounds.append(0.0 if result.bound is None else result.bound)
    assert bounds == sorted(bounds) and 0.0 < bounds[-1] <= whole.value


def test_wrong_gearboxes_are_refused():
    box = gearbox("table4_p1")
    for given, word in (
        ({"shafts": box.shafts[:2]}, "N \\+ 1 shafts"),
        ({"objective": "mass"}, "no objective"),
        ({"slabs": ((0,), (1,))}, "every stage once"),
        ({"slabs": ((0, 1), (2,))}, "cannot share"),
        ({"places": (Place(0, z=(0.0, 1.0)),)}, "after the input shaft"),
        ({"places": (Place(1, z=(1.0, 0.0)),)}, "ends before"),
        ({"level": (0, 7)}, "split line"),
    ):
        with pytest.raises(ValueError, match=word):
            replace(box, **given)
