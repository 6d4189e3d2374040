"""Packings: kernel against text, known values, statuses, budgets, shapes, clearances, layers."""

import math
from types import SimpleNamespace

import numba
import numpy as np
import pytest
from campaigns import few
from uncompiled import uncompiled

from gearopt.formulations import packing
from gearopt.formulations.packing import hop, packing_text, sa
from gearopt.formulations.packing.design import describe
from gearopt.formulations.packing.plan import Cylinder, Places, Plan, colours, overlap, row
from gearopt.formulations.packing.sa import KERNEL, held, numbers, scattered
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.optimise.typed import untyped


def cylinders(*sizes, height=10.0):
    return tuple(Cylinder(f"c{k}", d / 2.0, height) for k, d in enumerate(sizes))


SIX = cylinders(20, 20, 20, 10, 10, 10)
LARGE = tuple(Cylinder(f"large {k}", 10.0, 10.0, at=(10.0 + 20.0 * k, 10.0)) for k in range(3))
ANCHORED = LARGE + SIX[3:]
TALL = (Cylinder("a", 10.0, 30.0), Cylinder("b", 7.0, 5.0), Cylinder("c", 4.0, 12.0, layer=1))
PLANS = {
    "one layer": Plan(SIX),
    "layers": Plan(SIX, min_layers=2, max_layers=3),
    "square": Plan(SIX, shape="square", objective="area", gap=1.0, wall=2.0),
    "circle": Plan(SIX, shape="circle", wall=0.5),
    "circle around fixed": Plan((LARGE[0], LARGE[2], *SIX[2:]), shape="circle", gap=0.5),
    "width": Plan(SIX, width=45.0, wall=1.0),
    "fixed": Plan(ANCHORED, max_layers=2),
    "unlike heights": Plan(TALL, max_layers=2),
    "unlike sizes": Plan(cylinders(*np.random.default_rng(1).uniform(4, 16, 12)), wall=0.3),
}


def shaken(plan, rng):
    """A packing at random, around its row."""
    x, y, layer, centre = scattered(plan, plan.max_layers, rng)
    free = list(plan.free)
    x[free] += rng.normal(size=len(free))
    if plan.shape == "circle" and plan.fixed:
        centre = centre + rng.normal(size=2)
    return Places(x, y, layer, centre)


def test_a_bound_that_proves_its_packing_is_not_called_weak():
    floor = packing.Bound(1.0, 3, complete=False)
    assert "weaker" in packing.proof(floor)["sentence"]
    assert "weaker" not in packing.proof(floor, near=True)["sentence"]


@pytest.mark.parametrize("plan", PLANS.values(), ids=PLANS)
def test_kernel_computes_what_the_text_does(plan):
    """Objective, crowding of all pairs that may move, empty layers, excess of a given width."""
    law, rng = uncompiled(KERNEL), np.random.default_rng(7)
    problem = packing.problem(plan)
    gap, wall, width, shape, volume, least, most, _ = numbers(plan, plan.max_layers)
    for _ in range(15):
        found = shaken(plan, rng)
        batch = problem.batch(packing_text.point(plan, found)[None])
        area, excess = law.plan_area(*found[:2], found.centre, plan.radius, int(shape), wall, width)
        tall, missing = law.stack(found.layer, plan.height, int(least), int(most))
        assert area * (tall if volume else 1.0) == pytest.approx(batch.F[0, 0], rel=1e-12)
        rows = dict(zip([r.name for r in problem.rows.inequalities], batch.G[0] - 1.0, strict=True))
        apart = sum(max(0.0, v) for name, v in rows.items() if name.startswith("apart"))
        fixed = [plan.cylinders[k] for k in plan.fixed]
        held_apart = [
            max(0.0, 1.0 - math.dist(a.at, b.at) ** 2 / (a.radius + b.radius + gap) ** 2)
            for k, a in enumerate(fixed)
            for b in fixed[:k]
        ]
        crowding = law.crowding_of_all(*found[:3], plan.radius, gap)
        if plan.max_layers == 1:
            apart += sum(held_apart)
        assert crowding == pytest.approx(apart, abs=1e-9)
        assert excess == pytest.approx(max(0.0, rows.get("width", 0.0)), abs=1e-12)
        empty = sum(max(0.0, v) for name, v in rows.items() if name.startswith("occupied"))
        assert missing == empty


@pytest.mark.parametrize("plan", PLANS.values(), ids=PLANS)
def test_both_texts_say_the_same_of_the_row(plan):
    """The row is feasible; epigraphs and extents agree there, in numpy and in casadi."""
    found = row(plan)
    direct, smooth = packing.problem(plan), packing_text.smooth(plan, found.layer)
    one = direct.batch(packing_text.point(plan, found)[None])
    at = packing_text.point_of_packing(plan, found)
    other = smooth.batch(at[None])
    assert one.F[0, 0] == pytest.approx(other.F[0, 0], rel=1e-12)
    assert one.G.max(initial=0.0) <= 1.0 + 1e-12 and other.G.max() <= 1.0 + 1e-12
    f, g, _ = (np.array(v).ravel() for v in smooth.traced().terms(at, smooth.parameter_values()))
    assert f[0] == pytest.approx(other.F[0, 0], rel=1e-12)
    assert g == pytest.approx(other.G[0], abs=1e-12)
    back = packing_text.places(plan, smooth, at, found.layer)
    assert np.ptp(back.x - found.x) < 1e-12 and np.ptp(back.y - found.y) < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("plan", PLANS.values(), ids=PLANS)
def test_a_short_run_is_feasible_never_below_its_bound_and_repeatable(plan):
    problem = packing.problem(plan)
    budget = Budget(evaluations=10_000)
    first, outcome = run(problem, "hop", budget, seed=3)
    again, _ = run(packing.problem(plan), "hop", budget, seed=3)
    assert first.status in ("limit", "optimal") and first.certificate["feasibility"] < 1e-9
    assert first.value == again.value >= first.bound
    assert first.value <= problem.batch(packing_text.point(plan, row(plan))[None]).F[0, 0]
    assert first.evaluations < 11_000
    design = untyped(describe(plan, packing_text.places(plan, problem, outcome.x)))
    volume, area = (design["container"][k] for k in ("volume_mm3", "area_mm2"))
    assert first.value == pytest.approx(volume if plan.objective == "volume" else area, rel=1e-12)
    check_drawing(plan, design)


def check_drawing(plan, design):
    """The design alone, as a draughtsman reads it, holds together."""
    box, drawn = design["container"], design["cylinders"]
    for k, a in enumerate(drawn):
        r = a["diameter_mm"] / 2.0 + plan.wall
        if plan.shape == "circle":
            size = box["diameter_mm"] / 2.0
            away = math.hypot(a["x_mm"] - box["left_mm"] - size, a["y_mm"] - box["front_mm"] - size)
            assert away + r <= size + 1e-6
        else:
            assert a["x_mm"] - r >= box["left_mm"] - 1e-6
            assert a["x_mm"] + r <= box["left_mm"] + box["width_mm"] + 1e-6
            assert a["y_mm"] - r >= box["front_mm"] - 1e-6
            assert a["y_mm"] + r <= box["front_mm"] + box["depth_mm"] + 1e-6
        assert 0.0 <= a["from_mm"] and a["to_mm"] <= box["height_mm"]
        assert a["fixed"] == (plan.cylinders[k].at is not None)
        if a["fixed"]:
            assert (a["x_mm"], a["y_mm"]) == plan.cylinders[k].at
        for b in drawn[:k]:
            apart = math.hypot(a["x_mm"] - b["x_mm"], a["y_mm"] - b["y_mm"])
            beside = apart >= (a["diameter_mm"] + b["diameter_mm"]) / 2.0 + plan.gap - 1e-6
            assert beside or a["from_mm"] >= b["to_mm"] or b["from_mm"] >= a["to_mm"]


def best(plan, **kind):
    return solve(packing.problem(plan), "hop", **kind)


@pytest.mark.slow
def test_layers_of_six_cylinders_are_proven():
    """Two layers 40 x 20 x 20, three 20 x (15 + sqrt 200) x 30."""
    two, three = (
        best(Plan(SIX, min_layers=2, max_layers=2)),
        best(Plan(SIX, min_layers=3, max_layers=3)),
    )
    assert (two.status, three.status) == ("optimal", "optimal")
    assert two.value == pytest.approx(16_000, rel=1e-9)
    assert three.value == pytest.approx(600 * (15 + math.sqrt(200)), rel=1e-9)
    assert max(two.gap, three.gap) < 1e-8


def test_a_fixed_row_and_a_second_layer_are_proven():
    found = best(Plan(ANCHORED, min_layers=2, max_layers=2))
    assert found.status == "optimal" and found.value == pytest.approx(24_000, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("most", [1, 4])
@pytest.mark.parametrize("seed", range(10))
def test_the_best_known_of_six_cylinders_is_found_by_every_seed(most, seed):
    """20 x (20 + 4 sqrt 200) x 10; the search is stopped when it is there."""
    known = 200 * (20 + 4 * math.sqrt(200))
    until = {
        "budget": Budget(evaluations=2_000_000),
        "watch": lambda e: e.best > known * (1 + 1e-9),
    }
    found = best(Plan(SIX, max_layers=most), seed=seed, **until)
    assert found.bound > 15_109 and found.value == pytest.approx(known, rel=1e-6)
    assert found.value >= known * (1 - 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "distance"),
    [
        (5, math.sqrt(0.5)),
        (7, 4 - 2 * math.sqrt(3)),
        (9, 0.5),
    ],
)
def test_points_in_a_square(count, distance):
    """Circles of radius r in a square of side s: their centres are 2 r/(s - 2 r) apart.

    Of more than 5 no bound proves it: they are stopped when it is there.
    """
    known = (1.0 + 1.0 / distance) ** 2
    plan = Plan(cylinders(*[1.0] * count), shape="square", objective="area")
    found = best(plan, watch=lambda e: e.best > known * (1.0 + 1e-12))
    assert 1.0 / (math.sqrt(found.value) - 1.0) == pytest.approx(distance, abs=1e-9)
    assert found.status == ("optimal" if count == 5 else "limit") and found.bound <= known


@pytest.mark.parametrize(
    ("count", "ratio"),
    [
        (2, 2.0),
        pytest.param(3, 1 + 2 / math.sqrt(3), marks=pytest.mark.slow),
        (4, 1 + math.sqrt(2)),
    ],
)
def test_few_circles_in_a_circle(count, ratio):
    plan = Plan(cylinders(*[2.0] * count), shape="circle", objective="area")
    found = solve(packing.problem(plan), "hop", Budget(evaluations=20_000))
    assert math.sqrt(found.value / math.pi) == pytest.approx(ratio, rel=1e-9)


def test_clearances_are_larger_cylinders_in_a_smaller_box():
    """With gap g and wall w every side is that of cylinders larger by g, plus 2 w - g."""
    plain = best(Plan(cylinders(12, 12, 7), width=20.0))
    spaced = best(Plan(cylinders(10, 10, 5), width=21.0, gap=2.0, wall=1.5))
    assert spaced.value / 21.0 / 10.0 == pytest.approx(plain.value / 20.0 / 10.0 + 1.0, rel=1e-8)


def test_tall_ones_share_a_layer():
    """Two tall and two flat of one diameter: 400 x 2 plan, heights 30 + 5; mixed would be 60."""
    tall = (
        Cylinder("t", 10, 30),
        Cylinder("f", 10, 5),
        Cylinder("t", 10, 30),
        Cylinder("f", 10, 5),
    )
    problem = packing.problem(Plan(tall, min_layers=2, max_layers=2))
    result, outcome = run(problem, "hop")
    assert result.status == "optimal" and result.value == pytest.approx(800 * 35, rel=1e-9)
    layer = outcome.x[-4:]
    assert layer[0] == layer[2] != layer[1] == layer[3]


def test_layers_are_renamed_from_the_floor_unless_one_is_fixed():
    plan = Plan(TALL[:2], max_layers=3)
    found = Places(np.zeros(2), np.zeros(2), np.array([3, 2]), np.zeros(2))
    design = untyped(describe(plan, found))
    assert [c["layer"] for c in design["cylinders"]] == [2, 1]
    assert [(v["from_mm"], v["to_mm"]) for v in design["layers"]] == [(0.0, 5.0), (5.0, 35.0)]


def test_fixed_cylinders_over_one_another_need_layers():
    at = [Cylinder(f"f{k}", 10.0, 10.0, at=(k, 0.0)) for k in range(3)]
    plan = Plan((*at, *cylinders(4)), max_layers=3)
    assert overlap(plan, 0, 2) == pytest.approx(18.0)
    assert colours(plan, 2) is None and sorted(colours(plan, 3)[:3]) == [1, 2, 3]
    assert plan.fewest == 3
    result = best(plan)
    assert result.status == "optimal" and result.value == pytest.approx(22 * 20 * 30, rel=1e-8)


@pytest.mark.parametrize("method", few(["sa", "hop"], 1))
def test_a_watcher_stops_and_the_best_is_kept(method):
    seen = []

    def watch(event):
        seen.append(event)
        return len(seen) < 4

    many = Plan(cylinders(*[3.0] * 30))
    result = solve(packing.problem(many), method, watch=watch)
    assert result.status == "limit" and result.value <= seen[-1].best
    assert all(a.best >= b.best for a, b in zip(seen, seen[1:], strict=False))
    assert all(e.bound <= e.best for e in seen[1:])  # the first is told before the bound


def test_no_time_gives_the_row():
    plan = Plan(SIX)
    result = solve(packing.problem(plan), "hop", Budget(0.0))
    assert result.status == "limit" and result.value == pytest.approx(20 * 90 * 10)


@pytest.mark.slow
def test_a_loose_bound_is_not_claimed_in_comparisons():
    short = Budget(evaluations=5_000)
    assert solve(packing.problem(Plan(SIX)), "sa", short).bound > 15_000
    assert solve(packing.problem(Plan(SIX), loose=False), "sa", short).bound is None
    two = packing.problem(Plan(SIX, min_layers=2, max_layers=2), loose=False)
    assert solve(two, "hop").status == "optimal"


def test_methods_say_what_a_comparison_must_know():
    assert hop.RANDOM and sa.RANDOM and sa.PACED and not hasattr(hop, "PACED")


def test_all_fixed_is_refused():
    with pytest.raises(ValueError, match="nothing is left"):
        Plan(LARGE)


def test_fixed_ones_that_overlap_are_refused():
    with pytest.raises(ValueError, match="overlap"):
        packing.problem(Plan(ANCHORED, gap=0.1))


def test_held_names_what_is_fixed():
    plan = Plan((*LARGE[:1], Cylinder("l", 1.0, 1.0, layer=2), *SIX[:1]), max_layers=2)
    assert held(plan).tolist() == [1, 2, 0]


@pytest.mark.parametrize("method", [hop, sa], ids=["hop", "sa"])
def test_kernel_is_compiled_before_the_clock_starts(method, monkeypatch):
    """The first use on a machine compiles for seconds, which are not the search's."""
    order = []
    monkeypatch.setattr(method, "ready", lambda watch: order.append("compiled") or True)
    monkeypatch.setattr(method, "Clock", lambda *given: order.append("clock") or Clock(*given))
    run(packing.problem(Plan(SIX[:2])), method.__name__.rsplit(".", 1)[-1], Budget(evaluations=10))
    assert order == ["compiled", "clock"]


APART = ("circle around fixed", "unlike heights")  # others are near these


@pytest.mark.parametrize(
    "plan",
    [pytest.param(p, id=n, marks=[pytest.mark.slow] * (n not in APART)) for n, p in PLANS.items()],
)
def test_what_is_compiled_before_is_what_a_search_calls(plan, monkeypatch):
    """Machine code belongs to types: a search of others would compile within its time."""
    seen, compiled = [], kernel(KERNEL).anneal

    def spy(*given):
        seen.append(tuple(map(numba.typeof, given)))
        return compiled(*given)

    spy.py_func = compiled.py_func
    monkeypatch.setattr(sa, "kernel", lambda name: SimpleNamespace(anneal=spy))
    sa._one_disc.__wrapped__()
    assert len(seen) == 1
    run(packing.problem(plan), "sa", Budget(evaluations=100))
    run(packing.problem(plan), "hop", Budget(evaluations=100))
    assert len(seen) >= 3 and len(set(seen)) == 1
