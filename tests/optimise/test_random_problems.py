"""Problems of one's own at random: no wrong status, value or bound by any method, only SolveError.

Held against enumeration of the discrete values and SLSQP from many starts (`random_problems`), and
against points near the answer.
"""

import warnings

import numpy as np
import pytest
from campaigns import few
from random_problems import FEASIBLE, case, reference, refined

from gearopt import solve
from gearopt.errors import SolveError
from gearopt.optimise.result import Budget

QUICK = ("ipopt", "gp", "qp", "annealing")
METHODS = (*QUICK, "multistart", "nsga2", "scip")
NEAR = 0.05  # of a variable's range: what lies farther off may be another minimum


FAMILIES = [(seed, QUICK, 1_000, 2) for seed in range(11)]
MORE = [(seed, METHODS, 20_000, 12) for seed in range(11, 22, 2)]


@pytest.mark.parametrize(("seed", "methods", "evaluations", "starts"), few([*FAMILIES, *MORE], 7))
def test_problems_of_every_family(seed, methods, evaluations, starts):
    own = case(seed)
    best, _ = reference(own, starts)
    for method in methods:
        most = evaluations if method in ("annealing", "nsga2") else None
        budget = Budget(seconds=4.0, evaluations=most)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                result = solve(own.problem, method=method, budget=budget, seed=seed)
            except SolveError:
                continue
        if result.status == "infeasible":
            assert np.isinf(best)
        elif result.design:
            held(own, result, best, np.random.default_rng(seed))


def held(own, result, best, rng):
    """A design against the text, its bound and status against the best value known."""
    low, high, _ = own.problem.bounds()
    x = point(own.problem, result.design)
    value, worst = own.terms(x)[0], own.violation(x)
    assert result.value == pytest.approx(value, rel=1e-9)
    assert worst <= FEASIBLE * 1.0001 or result.status == "failed"
    assert np.all(x >= low - 1e-9 * abs(low) - 1e-12)
    assert np.all(x <= high + 1e-9 * abs(high) + 1e-12)
    scale = size(own, low, high, rng)
    if result.bound is not None:
        assert result.bound <= best + 1e-7 * abs(best) + 1e-9 * scale
    if result.status == "optimal" and own.name == "wide":
        assert result.value <= best * (1.0 + 1.1e-6)
    elif result.status == "optimal":
        assert result.value <= best + 1.1e-6 * abs(best) + 1e-7 * scale
    if result.status == "stationary":
        nowhere_better_near(own, x, value, scale, rng)


def nowhere_better_near(own, x, value, scale, rng):
    """Neither a local search from a stationary point nor points around it are better."""
    low, high, _ = own.problem.bounds()
    free = [k for k, (v, _) in enumerate(own.problem.columns) if not v.discrete]
    assert free
    if own.smooth:
        other = x.copy()
        other[free] = refined(own, x, free, x[free], low, high)
        move = np.max(np.abs(other - x) / np.where(high > low, high - low, 1.0))
        if own.violation(other) <= FEASIBLE and move < NEAR:
            drop = value - own.terms(other)[0]
            assert drop <= 1e-6 * max(abs(value), 1e-6 * scale) + 1e-9 * scale
    for radius in (1e-4, 1e-3):
        around = np.tile(x, (200, 1))
        step = radius * rng.uniform(-1.0, 1.0, (200, len(free))) * (high - low)[free]
        around[:, free] += step
        near = [p for p in np.clip(around, low, high) if own.violation(p) <= 0.0]
        drop = value - min((own.terms(p)[0] for p in near), default=np.inf)
        assert drop <= 2e-5 * scale * radius + 1e-6 * abs(value) + 1e-12 * scale


def size(own, low, high, rng):
    """Largest objective, by absolute value, of points at random."""
    points = low + rng.random((64, len(low))) * (high - low)
    for k, (v, _) in enumerate(own.problem.columns):
        if v.integer:
            points[:, k] = np.clip(np.rint(points[:, k]), np.ceil(low[k]), np.floor(high[k]))
    with np.errstate(all="ignore"):
        return np.nanmax(np.abs([own.terms(p)[0] for p in points]))


def point(problem, design):
    """The flat point of a design."""
    keys = (f"{v.name}_{v.unit}" if v.unit else v.name for v in problem.variables)
    return np.hstack([design[key] for key in keys]).astype(float)
