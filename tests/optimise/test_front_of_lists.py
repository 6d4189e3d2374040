"""Fronts of listed designs, by steps that look through the list, against brute force."""

import math
from itertools import product

import numpy as np
import pytest
from test_front_parts import segment
from test_front_steps import whole

from gearopt import Budget, SolveError
from gearopt.optimise.pareto import epsilon
from gearopt.optimise.pareto.epsilon import Limiting
from gearopt.optimise.pareto.found import Point
from gearopt.optimise.pareto.measures import unbeaten
from gearopt.optimise.result import Result


@pytest.fixture
def listed(monkeypatch):
    """Let steps choose among designs (n, k), their values, of ties the worst; returns the calls."""
    calls = []

    def of(designs, lost=(0.0, 0.0)):
        def attempt(run, name, most, near, method):
            calls.append((name, dict(most), near))
            run.convex = False
            run.clock.evaluations += 1
            run.clock.tell()
            k = run.names.index(name)
            caps = [most.get(n, math.inf) for n in run.names]
            inside = designs[(designs <= caps).all(axis=1)]
            if lost[0] < most.get("b", 0.0) < lost[1]:
                return Result("list", "failed", "list", {}), None
            if not len(inside):
                return Result("list", "infeasible", "list", {}, message="nothing"), None
            order = (-inside.sum(axis=1), inside[:, k])
            best = inside[np.lexsort(order)[0]]
            result = Result("list", "optimal", "list", {"value": best[k]}, bound=float(best[k]))
            return result, Point(best, best, True, float(best[k]) if k == 0 else None)

        monkeypatch.setattr(epsilon, "_attempt", attempt)
        monkeypatch.setattr(epsilon, "_sampled", lambda *_: ())
        return calls

    return of


def front(designs, points=0, problem=segment, limiting=None, caps=None, **budget):
    names = tuple("abc"[: designs.shape[1]])
    return epsilon.front(problem(), names, caps or {}, points, Budget(**budget), limiting=limiting)


def some(seed, objectives, scale=1.0):
    """40 designs near a plane, of whole numbers from -5 to 14, so that there are ties."""
    rng = np.random.default_rng(seed)
    every = rng.integers(-5, 15, (600, objectives)).astype(float)
    return scale * every[np.abs(every.sum(axis=1) - 8.0) < 3.0][:40]


@pytest.mark.parametrize(("seed", "scale"), [*product(range(3), (1.0, 1e-3, 1e4))])
def test_all_unbeaten_designs_are_found(seed, scale, listed):
    designs = some(seed, 2, scale)
    calls = listed(designs)
    made = front(designs, problem=whole)
    wanted = designs[unbeaten(designs)]
    assert made.values == pytest.approx(wanted, rel=1e-12) and len(wanted) > 5
    assert made.complete and made.finished and not made.skipped and made.error is None
    assert made.evaluations == len(calls) <= 4 * len(wanted)
    assert made.steps[-1].values == pytest.approx(wanted) and len(made.steps) >= len(wanted)


@pytest.mark.parametrize("points", [2, 4, 12])
def test_so_many_points_are_sought_along_a_line(points, listed):
    """Of a + b = 1, in ranges of 1000 and 1: the proven epsilon is half of the largest gap."""
    part = np.linspace(0.0, 1.0, 10_001)
    calls = listed(np.column_stack([1e3 * part, 1.0 - part]))
    made = front(np.zeros((0, 2)), points)
    assert len(made.points) == points and 4 <= len(calls) <= 4 + 2 * points
    width = np.diff([p.values[0] for p in made.points]).max() / 1e3
    assert made.epsilon == pytest.approx(width, abs=1e-3) or points == 2
    assert [near is None for _, _, near in calls][:2] == [True, False]


@pytest.mark.parametrize("seed", range(3))
def test_designs_within_largest_values_are_found(seed, listed):
    designs = some(seed, 2)
    listed(designs)
    inside = designs[(designs <= [9.0, 7.0]).all(axis=1)]
    made = front(designs, problem=whole, caps={"a": 9.0, "b": 7.0})
    assert made.values == pytest.approx(inside[unbeaten(inside)]) and made.complete
    nothing = front(designs, problem=whole, caps={"a": -9.0})
    assert nothing.infeasible and not nothing.points and nothing.message == "nothing"
    assert [dict(one.limits) for one in nothing.skipped] == [{"a": -9.0}]


def test_a_gap_whose_steps_fail_is_left_after_three(listed):
    """Of (k, 40 - 2 k) limits between 24 and 32 fail: of (4, 32) to (9, 22) 26, 23 and 29 do."""
    designs = np.array([[k, 40.0 - 2.0 * k] for k in range(12)])
    calls = listed(designs, (24.0, 32.0))
    made = front(designs, problem=whole)
    assert made.values[:, 0].tolist() == [0, 1, 2, 3, 4, 9, 10, 11] and len(calls) < 20
    assert len(made.skipped) == 3 and not any(one.proven for one in made.skipped)
    assert not made.complete and made.finished and len(made.unknown) == 1


@pytest.mark.parametrize("points", [0, 2, 3])
def test_finitely_many_designs_are_stepped_down(points, listed):
    designs = np.array([[k, 40.0 - 2.0 * k + k % 4] for k in range(12)])
    calls = listed(designs)
    limiting = Limiting(lambda name, most: segment(), ("b",), whole=True)
    made = front(designs, points, limiting=limiting)
    wanted = designs[unbeaten(designs)]
    assert made.values == pytest.approx(wanted[: points or None]) and len(wanted) > 3
    assert made.complete == (not points) and not made.skipped
    assert len(calls) == (points or len(wanted) + 1)
    assert [most.get("b", math.inf) for _, most, _ in calls[1:]] == pytest.approx(
        [*wanted[: len(calls) - 1, 1]], rel=2e-8
    )


def test_slices_are_fronts_under_even_limits_of_the_third(listed):
    designs = some(5, 3)
    calls = listed(designs)
    made = front(designs, 400, problem=whole)
    levels = [most["c"] for name, most, _ in calls if name == "a" and set(most) == {"c"}][1:]
    steps = np.linspace(max(levels), designs[:, 2].min(), 20)
    assert levels == pytest.approx(steps, abs=1e-5) and levels[0] <= designs[:, 2].max()
    rows = [designs[designs[:, 2] <= level + 1e-5] for level in levels]
    slices = np.vstack([row[unbeaten(row[:, :2])] for row in rows])
    found = {tuple(p.values) for p in made.points}
    assert found >= {tuple(one) for one in slices[unbeaten(slices)]}
    assert found <= {tuple(one) for one in designs[unbeaten(designs)]}
    assert made.epsilon is None and not made.complete


def test_small_differences_of_a_large_objective_lose_no_design(listed):
    """An excess of 1e-7 of a million is a tenth of all differences: ends are held closer."""
    designs = np.array([[1e6, 10.0], [1e6 + 0.05, 1.0], [1e6 + 1.0, 0.0]])
    calls = listed(designs)
    assert front(designs, problem=whole).values == pytest.approx(designs, abs=1e-9)
    ends = [most["a"] - 1e6 for _, most, _ in calls if "a" in most]
    assert ends == pytest.approx([0.1, 0.01], rel=1e-6)  # feasible to 1e-8 of a million
    listed(designs * [1e-6, 1.0])
    made = front(designs, problem=whole)
    assert len(made.points) == 3 and made.points[0].values[1] == 10.0


@pytest.mark.parametrize("best", [[3.0, 1.0], [0.0, 1.0], [0.0, 0.0], [-2.0, -1.0]])
def test_one_design_that_is_better_than_all_is_a_complete_front(best, listed):
    designs = np.array([best, np.add(best, [0.0, 2.0]), np.add(best, [1.0, 3.0])])
    listed(designs)
    made = front(designs, problem=whole)
    assert (
        made.complete
        and made.values.tolist() == [best]
        and made.steps[-1].values.tolist() == [best]
    )


def test_objectives_that_cannot_be_limited_are_not(listed):
    designs = some(6, 2)
    calls = listed(designs)
    made = front(designs, problem=whole, limiting=Limiting(lambda name, most: whole(), ("b",)))
    assert made.values == pytest.approx(designs[unbeaten(designs)])
    assert not any("a" in most for _, most, _ in calls)
    with pytest.raises(SolveError, match="a cannot be limited, only b: name it first, without"):
        front(designs, caps={"a": 1.0}, limiting=Limiting(lambda name, most: whole(), ("b",)))


@pytest.mark.parametrize("most", [1, 2, 4, 6])
def test_a_run_that_is_stopped_keeps_what_it_has(most, listed):
    designs = some(7, 2)
    calls = listed(designs)
    made = front(designs, problem=whole, evaluations=most)
    assert len(calls) == made.evaluations == most
    assert not made.finished and not made.complete and not made.infeasible
    assert 1 <= len(made.points) <= max(1, most - 2)
