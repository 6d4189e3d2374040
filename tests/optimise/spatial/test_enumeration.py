"""Boxes of whole and listed values, held against all their points."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from global_cases import case, posed

from gearopt.optimise.failures import Points, counting
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import method_of, run, solve
from gearopt.optimise.spatial import certificate, enumeration
from gearopt.optimise.spatial.enumeration import EASY, Enumerated
from gearopt.optimise.terms import Var

FAMILIES = {
    "sum": lambda a, b, c: (a**2 - 3.0 * b + c * a, a + b + c - 9.0),
    "product": lambda a, b, c: (a * b * c - b**3, 2.0 - a * b),
    "quotient": lambda a, b, c: (abs(a / (b + 0.5) - 0.37 * c), c - a * b),
    "power": lambda a, b, c: ((a + 1.0) ** 1.7 - b**3 + c**2, a**2 + b**2 - 20.0),
    "kinks": lambda a, b, c: (np.maximum(a - b, c) - np.minimum(a, b * c), abs(a - c) - 3.0),
    "floor": lambda a, b, c: (a - b + 0.1 * c, 0.01 + a * b / 3.0 - np.floor(a * b / 3.0) - 0.1),
    "waves": lambda a, b, c: (np.sin(a * b) + np.cos(c - a) + np.tan(0.2 * b), np.sin(a + c)),
    "exp": lambda a, b, c: (np.exp(0.2 * a - b) * c + np.log(a + 1.0), np.exp(b - c) - 4.0),
    "roots": lambda a, b, c: (np.sqrt(a) * b - np.hypot(b, c), 1.0 - a - np.sqrt(b + 1.0)),
    "angles": lambda a, b, c: (np.arctan(a / b) + np.tanh(c - a), np.arccos(b / 9.0) - 1.5),
    "met exactly": lambda a, b, c: (-a - b - c, 0.1 * (a + b + c) - 0.3),
}


@pytest.mark.parametrize("name", FAMILIES)
def test_whole_numbers_agree_with_brute_force(name, monkeypatch):
    monkeypatch.setattr(enumeration, "GROWING", 0.0)
    rng = np.random.default_rng(len(name))
    for boxes in (EASY, 0, 20):  # after which all variables are tried
        monkeypatch.setattr(enumeration, "EASY", boxes)
        low = rng.integers(-4, 3, 3)
        high = low + rng.integers(1, 9, 3)

        def text(x):
            f, g = FAMILIES[name](*x)
            return f, [g], []

        ends = [(int(a), int(b), "whole") for a, b in zip(low, high, strict=True)]
        problem = posed(ends, text, [a for a, _, _ in ends])
        points = np.array(list(product(*(range(a, b + 1) for a, b, _ in ends))), float)
        with np.errstate(all="ignore"):
            batch = problem.batch(points)
        met = np.isfinite(batch.F[:, 0]) & (batch.G[:, 0] <= 1.0 + 1e-8)
        best = batch.F[met, 0].min(initial=np.inf)
        result, outcome = run(problem, "spatial")
        if np.isinf(best):
            assert result.status == "infeasible"
            continue
        assert result.status == "optimal" and result.value == pytest.approx(best, rel=1e-6)
        claim = outcome.records[0]
        forged = replace(claim, lower_bound=best + 0.1)
        assert certificate.proven(problem, (forged,)) <= best
        assert certificate.proven(problem, (replace(claim, boxes=-900),)) <= best


def test_listed_values_and_stops():
    best, problem = case("gear, Sandgren")
    assert solve(problem, "spatial").value == pytest.approx(best, rel=1e-6)
    short = solve(problem, "spatial", Budget(evaluations=3))
    assert short.status == "limit" and (short.bound is None or short.bound <= best)
    listed = tuple(Var(f"x{k}", "", 0.5, 4.0, 1.0, values=(0.5, 1.25, 1.6, 4.0)) for k in (1, 2))
    free = posed([(0.5, 4.0)] * 2, lambda x: ((x[0] - 1.3) ** 2 + (x[1] - x[0] ** 2) ** 2, [], []))
    result = solve(replace(free, variables=listed), "spatial")
    assert result.status == "optimal" and result.design == {"x1": 1.25, "x2": 1.6}


def test_bounds_that_are_computed_hold_the_values_they_stand_for():
    whole = Var("x1", "", 0.0, 3.0 - 4e-16, 0.0, integer=True)
    listed = Var("x2", "", 0.1, 0.3, 0.1, values=(0.1, 3.0 * 0.1))
    beside = Var("x2", "", 0.1, 0.2, 0.1)
    problem = posed([(0, 1)] * 2, lambda x: (-x[0] - x[1], [], []))
    assert solve(replace(problem, variables=(whole, listed)), "spatial").value == -3.0 - 3.0 * 0.1
    assert solve(replace(problem, variables=(whole, beside)), "spatial").value == pytest.approx(
        -3.2
    )


def test_whole_numbers_whose_middle_is_rounded_are_left_to_the_tree():
    low = 2.0**53 - 3.0  # the middle of it and the next one is that one
    problem = posed([(low, low + 1.0, "whole")], lambda x: (x[0] - low, [], []), [low])
    assert not enumeration.takes(enumeration.columns(problem))
    assert solve(problem, "spatial").value == 0.0


def test_points_for_which_no_time_was_left_are_not_taken_for_judged(monkeypatch):
    def text(x):
        return np.sum(x), [0.95 - np.sin(3.0 * x[0] + x[1] ** 2)], []

    problem = posed([(-6, 6, "whole")] * 2, text, [0, 0])
    best = solve(problem, "spatial").value
    monkeypatch.setattr(Points, "late", property(lambda points: points.count > 5))
    with counting(1.0):
        outcome = method_of(problem, "spatial")(problem, Budget(), 0, None)
    assert not any(isinstance(r, Enumerated) for r in outcome.records)
    assert np.sum(outcome.x) == best
