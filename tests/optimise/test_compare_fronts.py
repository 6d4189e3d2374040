"""Methods of fronts compared: on fronts that are known, by hypervolume and IGD+."""

import math

import cvxpy as cp
import numpy as np
import pytest

import gearopt
from gearopt import Comparison, Conic, Problem, SolveError, Terms, Var
from gearopt.optimise.comparing import fronts
from gearopt.optimise.result import Outcome
from gearopt.report import comparison as words

SMALL = {"evaluations": 600, "seconds": 0.05, "seeds": 2}


def steps(*points, finished=True):
    """Minimise a = x and b = 4/x of x in 1, 2, 4: all three are unbeaten; exact says `points`."""

    def evaluate(x, p):
        return Terms({"a": x.x, "b": 4.0 / x.x})

    def exact(problem, budget, seed, watch):
        rows = [np.array([p]) for p in points]
        return Outcome(rows[0], finished, others=tuple(rows[1:]), proof={"sentence": ""})

    x = Var("x", "", 1.0, 4.0, 2.0, values=(1.0, 2.0, 4.0))
    return Problem("steps", (x,), (), evaluate, methods={"exact": exact})


def rows(found):
    return {row.method: row for row in found.groups[0].rows}


def test_gaps_are_the_missing_part_of_the_hypervolume_of_a_complete_front():
    problem = steps(1.0, 2.0, 4.0)
    found = gearopt.compare(problem, objectives="a,b", methods=("exact", "nsga2"), **SMALL)
    (group,) = found.groups
    assert group.proven and group.bound_from == "exact" and group.reference == 0.0
    assert "the complete Pareto front of 3 designs, proven (exact)" in group.front
    for row in group.rows:
        for run in (*row.equal_evaluations.runs, *row.equal_time.runs):
            assert run.gap == run.objective == pytest.approx(0.0, abs=1e-12)
            assert run.distance == pytest.approx(0.0, abs=1e-12) and run.violation <= 1e-8
    assert len(rows(found)["nsga2"].equal_time.runs) == 2


def test_missing_hypervolume_and_distance_of_a_part_of_a_front():
    problem = steps(1.0, 4.0, finished=False)
    found = gearopt.compare(problem, objectives="a,b", methods=("exact", "nsga2"), **SMALL)
    run = rows(found)["exact"].equal_time.runs[0]
    high = 1.0 + 1.05 * 3.0  # from there (1, 4), (2, 2) and (4, 1) beat three rectangles
    whole = (high - 1.0) * (high - 4.0) + (high - 2.0) * (4.0 - 2.0) + (high - 4.0) * (2.0 - 1.0)
    lacking = (4.0 - 2.0) * (4.0 - 2.0)
    assert run.gap == pytest.approx(lacking / whole, rel=1e-12)
    # of (2, 2) the nearest of (1, 4) and (4, 1) is worse by 2 of 3 in one objective
    assert run.distance == pytest.approx((2.0 / 3.0) / 3.0, rel=1e-12)
    assert not found.groups[0].proven and "nothing is proven" in found.groups[0].front


def discs():
    """Squared distances from (0, 0) and (2, 1): on the front sqrt(a) + sqrt(b) = sqrt(5)."""

    def evaluate(x, p):
        return Terms({"a": x.x**2 + x.y**2, "b": (x.x - 2) ** 2 + (x.y - 1) ** 2})

    return Problem("discs", tuple(Var(n, "", -5.0, 5.0, 1.0) for n in "xy"), (), evaluate)


@pytest.mark.slow
def test_samplers_are_held_against_epsilon_constraints(monkeypatch):
    monkeypatch.setattr(
        fronts, "REFERENCE_POINTS", {2: 60}
    )  # points of the reference, which take long
    found = gearopt.compare(discs(), objectives="a,b", evaluations=3000, seconds=1.0, seeds=1)
    assert list(rows(found)) == ["epsilon", "nsga2", "annealing", "hybrid"]
    epsilon, nsga = (rows(found)[m].equal_evaluations for m in ("epsilon", "nsga2"))
    assert epsilon.summary.worst_gap < 0.01 and nsga.summary.worst_gap < 0.01
    assert all(s.curve.median for s in (epsilon, nsga))
    curve = [gap for gap in nsga.curve.median if gap is not None]
    assert curve[-1] < curve[0] and (np.diff(curve) <= 1e-15).all()


def test_a_comparison_of_fronts_comes_back_from_json_and_says_its_command():
    found = gearopt.compare(
        steps(1.0, 2.0, 4.0), objectives="a,b", most={"a": 4.5}, methods=("exact",), **SMALL
    )
    assert Comparison.from_json(found.to_json()).to_dict() == found.to_dict()
    assert "objectives=['a', 'b'], most={'a': 4.5}" in words.command(found)
    assert "has the whole front" in repr(found) and "IGD+" in found.to_html()
    with pytest.raises(SolveError, match="most changes nothing"):
        gearopt.compare(discs(), most={"a": 1.0})
    assert math.isclose(found.groups[0].best, 0.0, abs_tol=1e-12)


@pytest.mark.slow
def test_a_conic_problem_is_compared_by_epsilon_constraints(monkeypatch):
    def evaluate(x, p):
        return Terms({"cost": cp.sum(cp.inv_pos(x.t)), "error": cp.sum(x.t)})

    monkeypatch.setattr(fronts, "REFERENCE_POINTS", {2: 9})
    problem = Conic("tolerances", (Var("t", "", 0.1, 1.0, 0.5, 2),), (), evaluate)
    found = gearopt.compare(problem, objectives="cost,error", evaluations=9999, seconds=3.0)
    (group,) = found.groups
    assert [row.method for row in group.rows] == ["epsilon"] and group.proven
    assert group.rows[0].equal_evaluations.summary.worst_gap < 0.05


def test_methods_that_there_are_not_and_single_objectives_are_told():
    with pytest.raises(SolveError, match="no method 'foo' for a front; methods: exact, epsilon"):
        gearopt.compare(steps(1.0), objectives="a,b", methods="exact,foo", **SMALL)
    with pytest.raises(SolveError, match="two or three objectives, each once, not a;"):
        gearopt.compare(steps(1.0), objectives="a", **SMALL)
