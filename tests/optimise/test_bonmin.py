"""Bonmin's B-BB against enumeration and exhaustion; what it says is never a proof."""

import math
import time
from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt import load
from gearopt.errors import SolveError
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.optimise.solvers import bonmin
from gearopt.optimise.terms import Terms, Var
from gearopt.scenes.drive import model

SERIES = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0)


def mixed(seed):
    """d of a list, n whole, t continuous and tight: the problem, and its optimum by enumeration."""
    rng = np.random.default_rng(seed)
    c1, c2 = rng.uniform(0.5, 2.0, 2)
    a, b, e = rng.uniform(20, 300), rng.uniform(0.5, 4.0), rng.uniform(0.2, 3.0)
    values = tuple(sorted(rng.choice(SERIES, int(rng.integers(1, 6)), replace=False)))

    def evaluate(x, p):
        cost = c1 * x.d**2 * x.n + c2 * x.t * x.n**0.5
        return Terms(
            {"cost": cost}, {"strength": a / (x.d**3 * x.n), "length": b / (x.t * x.d) + e / x.n}
        )

    best = min(
        c1 * d * d * n + c2 * b / (d * (1.0 - e / n)) * math.sqrt(n)
        for d in values
        for n in range(math.floor(e) + 1, 201)
        if a <= d**3 * n
    )
    variables = (
        Var("d", "mm", values[0], values[-1], values[0], values=values),
        Var("n", "", 1, 200, 100, integer=True),
        Var("t", "mm", 0.01, 100.0, 1.0, log=True),
    )
    return Problem("mixed", variables, (), evaluate), best


def pair(first, second):
    """Least a b >= 6."""
    variables = (Var("a", "", **first), Var("b", "", **second))
    return Problem(
        "pair", variables, (), lambda x, p: Terms({"f": x.a * x.b}, {"g": 6.0 / (x.a * x.b)})
    )


def ends(low, high, **more):
    return {"lower": low, "upper": high, "guess": low, **more}


@pytest.mark.parametrize("seed", [0, 6, 9])  # sets of 4, 1 and 5 members
def test_mixed_problems_against_enumeration(seed):
    problem, best = mixed(seed)
    result = solve(problem, "bonmin", Budget(seconds=20))
    assert result.status == "feasible" and result.bound is None
    assert result.value == pytest.approx(best, rel=1e-12)
    assert isinstance(result.design["n"], int)


@pytest.mark.slow
def test_twenty_mixed_problems():
    for seed in range(20):
        problem, best = mixed(seed)
        assert solve(problem, "bonmin").value == pytest.approx(best, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "volume"),
    [
        ("elevator", 5782370.7),
        ("three_stage", 12677057.9),
        ("elevator_fine_ratio", 5974577.8),
        ("three_stage_fine_ratio", 12846064.4),
    ],
)
def test_drives(name, volume, capfd):
    """Its loops over one node, which no time limit ended, came of Ipopt's relaxed bounds."""
    result = gearopt.solve(f"problems/{name}.toml", "bonmin", budget=Budget(seconds=60))
    assert result.value == pytest.approx(volume, abs=0.06)
    assert result.status == "feasible" and result.message == "Bonmin: SUCCESS, which is its word"
    assert capfd.readouterr() == ("", "")


def test_nothing_is_printed(capfd):
    solve(mixed(3)[0], "bonmin")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (ends(1, 8, values=(1.0, 2.0, 4.0, 8.0)), ends(1, 3, values=(1.0, 1.5, 3.0)), (4.0, 1.5)),
        (ends(1, 8, values=(1.0, 2.0, 4.0, 8.0)), ends(3, 3, integer=True), (2.0, 3)),
        (ends(2, 2, values=(2.0,)), ends(3, 3, integer=True), (2.0, 3)),  # nothing is unknown
        (ends(2, 2), ends(1.5, math.inf, integer=True), (2.0, 3)),
    ],
)
def test_sets_and_fixed_variables(first, second, expected):
    result = solve(pair(first, second), "bonmin", Budget(seconds=20))
    assert result.value == pytest.approx(6.0, rel=1e-12)
    assert (result.design["a"], result.design["b"]) == pytest.approx(expected)


def test_infeasible_is_its_word():
    impossible = pair(ends(1, 2, values=(1.0, 2.0)), ends(1, 2, integer=True))
    result = solve(impossible, "bonmin", Budget(seconds=20))
    assert result.status == "failed" and "not proven" in result.message


def test_what_does_not_fit_is_refused():
    with pytest.raises(SolveError, match="positive variables only; a may be 0"):
        solve(pair(ends(0, 2, integer=True), ends(1, 2)), "bonmin")
    with pytest.raises(SolveError, match="no whole number lies between 2.2 and 2.7 for b"):
        solve(pair(ends(1, 2), ends(2.2, 2.7, integer=True)), "bonmin")


def test_a_break_of_bonmin_is_an_error(monkeypatch):
    monkeypatch.setitem(bonmin.OPTIONS, "algorithm", "B-NONE")
    with pytest.raises(SolveError, match="bonmin on pair: "):
        solve(pair(ends(1, 9, integer=True), ends(1, 9)), "bonmin")


def endless(monkeypatch):
    """A child that answers nothing."""
    monkeypatch.setattr(bonmin, "CHILD", "import time; time.sleep(60)")
    return pair(ends(1, 9, integer=True), ends(1, 9))


def test_budget_and_watcher_kill_it(monkeypatch):
    problem, seen = endless(monkeypatch), []
    start = time.perf_counter()
    assert solve(problem, "bonmin", Budget(seconds=0.1)).status == "limit"
    result = solve(
        problem, "bonmin", watch=lambda event: seen.append(event.seconds) or len(seen) < 3
    )
    assert result.status == "limit" and len(seen) == 3
    assert time.perf_counter() - start < 20.0  # not the child's minute

    def interrupted(event):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        solve(problem, "bonmin", watch=interrupted)


@pytest.mark.slow
def test_stopped_after_its_first_point_it_gives_that_point():
    """Three stages: the first point comes within a second, the best after two or more."""
    path = Path(__file__).parents[2] / "problems" / "three_stage.toml"
    problem = model(load(path), "bonmin").problem
    for seconds in (1.0, 2.0, 4.0, 8.0):  # until the first point is there, before the best one is
        result = solve(problem, "bonmin", watch=lambda event, s=seconds: event.seconds < s)
        if result.value is not None:
            break
    assert result.value is not None and result.value >= 12677057.9
    assert result.status == "limit" or result.value == pytest.approx(12677057.9, rel=1e-6)
