"""Layers with a name, and packings at random against independent code: no false bound, no crash."""

import math

import numpy as np
import pytest
from campaigns import few
from packing_brute_force import drawn_fault, least_at_random, least_of_two, random_plan
from uncompiled import uncompiled

from gearopt.formulations import packing
from gearopt.formulations.packing import packing_text
from gearopt.formulations.packing.container_bound import bound
from gearopt.formulations.packing.design import describe
from gearopt.formulations.packing.plan import Cylinder, Plan, row
from gearopt.formulations.packing.sa import KERNEL, lateness, numbers, ready
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.optimise.typed import untyped


def alike(*layers, **kind):
    """Cylinders of 20 mm by 10 mm, each in a layer or (None) free."""
    return Plan(tuple(Cylinder(f"c{k}", 10.0, 10.0, None, v) for k, v in enumerate(layers)), **kind)


@pytest.mark.parametrize("method", ["hop", "sa"])
def test_below_a_named_layer_none_is_empty(method):
    """One in layer 2 of 2, two free: one of them lies below, 40 x 20 x 20; side by side is less."""
    plan = alike(2, None, None, max_layers=2)
    problem = packing.problem(plan)
    result, outcome = run(problem, method, Budget(evaluations=200_000))
    assert result.value == pytest.approx(16_000.0, rel=1e-5) and result.bound <= result.value
    assert result.bound == pytest.approx(16_000.0, rel=1e-8)
    design = untyped(describe(plan, packing_text.places(plan, problem, outcome.x)))
    assert design["cylinders"][0]["layer"] == 2 and design["cylinders"][0]["from_mm"] == 10.0
    assert sorted(v["layer"] for v in design["layers"]) == [1, 2]


def test_text_kernel_and_bound_ask_for_the_same_layers():
    plan = alike(3, 1, None, None, max_layers=4)
    problem = packing.problem(plan)
    _, _, _, _, _, least, most, _ = numbers(plan, plan.max_layers)
    names = [r.name for r in problem.rows.inequalities]
    columns = [k for k, name in enumerate(names) if name.startswith("occupied")]
    first = row(plan)
    for free in ((1, 1), (2, 1), (2, 4), (4, 4), (3, 2)):
        layer = np.array([3, 1, *free])
        held = problem.batch(packing_text.point(plan, first._replace(layer=layer))[None]).G[
            0, columns
        ]
        _, missing = uncompiled(KERNEL).stack(layer, plan.height, int(least), int(most))
        assert (missing == 0) == bool((held <= 1.0).all()) == (2 in free)
    assert plan.filled == 3 and sorted(set(first.layer.tolist())) == [1, 2, 3]
    assert bound(plan).value == pytest.approx(400.0 * 40.0, rel=1e-8)
    three = alike(3, 1, None, None, max_layers=3)  # one of them holds two side by side
    assert bound(three).value == pytest.approx(800.0 * 30.0, rel=1e-8)


def test_layers_above_the_named_ones_are_counted_without_gaps():
    plan = alike(1, None, None, max_layers=4)
    places = row(plan)._replace(layer=np.array([1, 4, 3]))
    assert [c.layer for c in describe(plan, places).cylinders] == [1, 3, 2]


def test_layers_that_must_stay_empty_are_refused():
    with pytest.raises(ValueError, match="3 layers cannot each hold"):
        alike(3, None, max_layers=3)
    with pytest.raises(ValueError, match="3 layers cannot each hold"):
        alike(3, None, None, max_layers=2)


def check(seed):
    """A packing at random: whether it was proven; None where there is none."""
    rng = np.random.default_rng([77, seed])
    plan = random_plan(rng)
    if plan is None:
        return None
    problem = packing.problem(plan)
    known = least_at_random(plan, rng, 100)
    two = least_of_two(plan) if not plan.fixed else math.inf
    proven = False
    for method in ("hop", "sa"):
        result, outcome = run(problem, method, Budget(evaluations=20_000), seed=seed)
        design = untyped(describe(plan, packing_text.places(plan, problem, outcome.x)))
        assert drawn_fault(plan, design, result.value) is None
        assert result.bound <= min(known, two) * (1.0 + 1e-9)
        if len(plan.cylinders) == 2 and not plan.fixed:
            assert result.value >= two * (1.0 - 2e-6)
        if result.status == "optimal":
            assert result.value <= min(known, two) * (1.0 + 2e-6)
            proven = True
    return proven


def test_packings_at_random():
    assert [check(seed) for seed in range(3)].count(True) > 0


@pytest.mark.slow
@pytest.mark.parametrize("first", range(4, 148, 18))
def test_many_packings_at_random(first):
    found = [check(seed) for seed in range(first, first + 9)]
    assert found.count(None) < 5 and found.count(True) > 1


EIGHT = tuple(
    Cylinder(f"c{k}", r, h)
    for k, (r, h) in enumerate(zip((9, 9, 7, 5, 5, 4, 4, 3), (5, 9) * 4, strict=True))
)


@pytest.mark.parametrize(
    "kind", few([{}, {"shape": "circle"}, {"shape": "square"}, {"width": 25.0}], 2)
)
def test_a_bound_that_is_late_is_weaker_and_valid(kind):
    plan = Plan(EIGHT[:4], max_layers=2, **kind)
    whole = bound(plan)
    assert whole.complete
    asked = []
    for most in (0, 3, 300):
        asked.clear()

        def late(most=most):
            asked.append(None)
            return len(asked) > most

        found = bound(plan, late)
        assert 0.0 < found.value <= whole.value * (1.0 + 1e-12)
        assert found.complete or len(asked) < most + 200  # soon after it was told
    assert bound(plan, lambda: True).value >= 0.3 * whole.value


def test_the_bound_looks_at_clock_and_watcher():
    """Ended while the bound is computed: the row, a valid bound, and nothing is remembered."""
    plan = Plan(EIGHT, max_layers=2, shape="square")
    problem, seen = packing.problem(plan), []
    assert ready()  # compiling has events of its own
    result = solve(problem, "hop", watch=lambda event: bool(seen.append(event)))
    assert result.status == "limit" and len(seen) == 1 and seen[0].bound is None
    assert result.bound < result.value == seen[0].best
    assert result.proof["method"] == "subdivision, stopped early" and "bound" not in problem.memo
    none = solve(problem, "hop", Budget(seconds=0.0))
    assert none.status == "limit" and none.value == result.value


def test_late_asks_the_watcher_now_and_then():
    asked = []
    late = lateness(Clock(Budget(), asked.append), None)
    assert not any(late() for _ in range(1_000)) and 1 <= len(asked) < 100
    assert lateness(Clock(start=-1e9), 1.0)()


def circles(count):
    radii = range(1, count + 1)
    cylinders = tuple(Cylinder(f"c{k}", float(k), 10.0) for k in radii)
    return packing.problem(Plan(cylinders, shape="circle", objective="area"))


@pytest.mark.slow
@pytest.mark.parametrize(("count", "radius"), [(9, 19.2331939), (11, 24.96063428)])
def test_circles_of_all_radii_up_to_n(count, radius):
    """The best known of the circle packing contest: Ye, Huang, Lu, arXiv:1306.0694, table 4."""
    known = math.pi * radius**2
    until = lambda event: event.best > known * (1.0 + 1e-8)  # noqa: E731
    found = solve(circles(count), "hop", Budget(evaluations=4_000_000), seed=1, watch=until)
    assert math.sqrt(found.value / math.pi) == pytest.approx(radius, abs=1e-7)


def test_hop_goes_on_in_rounds_while_the_budget_lasts(monkeypatch):
    """Rounds of few hops end apart: the search goes on to the end of its evaluations."""
    monkeypatch.setattr(packing.hop, "PATIENCE", 2)
    monkeypatch.setattr(packing.hop, "ALIKE", 10**9)
    found = solve(circles(6), "hop", Budget(evaluations=40_000))
    assert found.evaluations >= 40_000 and found.status == "feasible"
    monkeypatch.setattr(packing.hop, "ALIKE", 2)
    early = solve(circles(6), "hop", Budget(evaluations=6_000_000))
    assert early.evaluations < 1_000_000 and early.status == "feasible"
    assert early.value == pytest.approx(found.value, rel=1e-9)


def test_hop_ends_where_the_budget_names_no_end(monkeypatch):
    monkeypatch.setattr(packing.hop, "PATIENCE", 2)
    monkeypatch.setattr(packing.hop, "ALIKE", 10**9)
    monkeypatch.setattr(packing.hop, "ROUNDS", 3)
    assert solve(circles(6), "hop").status == "feasible"
