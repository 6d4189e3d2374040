"""Every back end on problems with known optima: right where it claims, never believed blindly."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from campaigns import few

from gearopt.errors import SolveError
from gearopt.formulations.drive import continuous_sizing, teeth
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.methods import back_ends
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.optimise.solvers import ipopt, scip
from gearopt.optimise.terms import Param, Terms, Var
from gearopt.physics.gears import SERIES_I

F = Fraction
ELEVATOR, ONE_PERCENT = F("1450") / F("66.5"), F(1, 100)
SAMPLERS = ("annealing", "nsga2")


def box():
    """The largest box from a surface of 6: a cube of volume 1."""

    def evaluate(x, p):
        a, b, c = x.side
        surface = 2.0 * (a * b + b * c + c * a)
        return Terms({"inverse_volume": 1.0 / (a * b * c)}, {"surface": surface / p.area})

    sides = Var("side", "m", 0.01, 100.0, 2.0, size=3, log=True)
    return Problem("box", (sides,), (Param("area", "m2", 6.0),), evaluate)


def catalogue():
    """Least wire and number of turns: min d^2 n, d from a list, n whole, d^3 n >= 100."""

    def evaluate(x, p):
        return Terms({"volume": x.d**2 * x.n}, {"strength": 100.0 / (x.d**3 * x.n)})

    wire = Var("d", "mm", 1.0, 4.0, 2.0, values=(1.0, 1.5, 2.0, 2.5, 4.0))
    return Problem("catalogue", (wire, Var("n", "", 1, 200, 100, integer=True)), (), evaluate)


CATALOGUE_BEST = min(d * d * math.ceil(100.0 / d**3) for d in (1.0, 1.5, 2.0, 2.5, 4.0))

HELICAL = Toothing(math.radians(25.0))


def drive(total=ELEVATOR, widths=("0.6", "0.75"), tolerance=ONE_PERCENT, **stage):
    limits = {"modules": SERIES_I, "pinion_teeth": (20, 40), "toothings": (HELICAL,)} | stage
    stages = tuple(Stage((2.07, 48.0), FaceWidth(F(w), F(w)), **limits) for w in widths)
    return Train(49392.913, F(total), tolerance, stages, law=K_FACTOR)


def test_the_folder_is_the_list_of_methods():
    assert set(back_ends()) >= {"ipopt", "gp", "multistart", "scip", *SAMPLERS}


@pytest.mark.parametrize(("method", "gap"), [("ipopt", 1e-9), ("multistart", 1e-9), ("gp", 1e-4)])
def test_convex_problem_is_proven(method, gap):
    """Clarabel's point is 1e-6 off where the objective is flat, and so is the bound at it."""
    result = solve(box(), method, gap=gap)
    assert result.status == "optimal" and result.gap < gap
    assert result.bound <= 1.0
    assert result.value == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("method", few(SAMPLERS, 1))
def test_samplers_are_polished_and_the_bound_is_ours(method):
    result = solve(box(), method, Budget(evaluations=4_000), seed=1)
    assert result.status == "optimal" and result.evaluations <= 4_000
    assert result.bound <= 1.0 and result.value == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize(
    "method", ["annealing", pytest.param("nsga2", marks=pytest.mark.slow), "scip"]
)
def test_integers_and_finite_sets(method):
    result = solve(catalogue(), method, Budget(evaluations=20_000), seed=1)
    assert result.status == "feasible"
    assert result.value == pytest.approx(CATALOGUE_BEST, rel=1e-12)
    assert result.design["d_mm"] in (1.0, 1.5, 2.0, 2.5, 4.0)
    assert isinstance(result.design["n"], int)


@pytest.mark.slow
@pytest.mark.parametrize("method", [*SAMPLERS, "multistart"])
def test_the_same_seed_gives_the_same_answer(method):
    budget = Budget(evaluations=2000)
    first, again, other = (solve(box(), method, budget, seed=s) for s in (4, 4, 5))
    assert first.design == again.design and first.value == again.value
    if method != "multistart":
        assert other.design != first.design


@pytest.mark.parametrize("method", [*SAMPLERS, "multistart"])
def test_a_watcher_stops_the_run_and_keeps_the_best(method):
    seen = []
    result = solve(box(), method, watch=lambda event: seen.append(event) or len(seen) < 20)
    assert len(seen) >= 20
    assert result.status in ("limit", "optimal")  # multistart may have proven its first start
    assert result.value is None or result.value >= 1.0 - 1e-9


@pytest.mark.parametrize(("start", "known"), [((0.9, 0.8, 0.7), True), ((2.0, 2.0, 2.0), False)])
def test_ipopt_builds_no_program_when_time_is_over(monkeypatch, start, known):
    """A start that is feasible is kept, another is none."""

    def built(*given):
        raise AssertionError("a program is built")

    monkeypatch.setattr(ipopt, "program", built)
    stopped = ipopt.run(box(), Budget(seconds=0.0), 0, None, start=np.array(start))
    assert not stopped.finished and not stopped.infeasible
    assert (stopped.x is not None) == known
    if known:
        assert stopped.x == pytest.approx(start, rel=1e-12)
    with pytest.raises(AssertionError, match="a program is built"):
        ipopt.run(box(), Budget(seconds=100.0), 0, None, start=np.array(start))


@pytest.mark.slow
def test_gp_and_ipopt_share_nothing_and_agree_to_1e_9():
    """Three stages of an exact ratio, and two within 1 %."""
    three = replace(drive(110, ("0.6", "0.6", "0.75"), F(0), modules=()), torque=21702.9)
    for train in (drive(), three):
        a, b = (solve(continuous_sizing.problem(train), m) for m in ("ipopt", "gp"))
        assert a.status == b.status == "optimal"
        assert a.value == pytest.approx(b.value, rel=1e-9)


def test_gp_is_canonicalised_once():
    problem = continuous_sizing.problem(drive(tolerance=F(0), modules=()))
    one = solve(problem, "gp")
    (key,) = (k for k in problem.memo if k[0] == "gp")
    model = problem.memo[key]
    harder = solve(problem.at(k_factor=(1.8, 1.8)), "gp")
    assert [k for k in problem.memo if k[0] == "gp"] == [key] and problem.memo[key] is model
    assert harder.value == pytest.approx(one.value * 2.07 / 1.8, rel=1e-8)


def test_gp_refuses_what_is_no_geometric_program():
    with pytest.raises(SolveError, match="continuous log variables only; d is discrete"):
        solve(catalogue(), "gp")
    signomial = Problem(
        "s", (Var("a", "", 0.1, 1, 0.5, log=True),), (), lambda x, p: Terms({"f": 1.0 - x.a})
    )
    with pytest.raises(SolveError, match="not a geometric program"):
        solve(signomial, "gp")
    logarithm = Problem("l", signomial.variables, (), lambda x, p: Terms({"f": 1.0 - np.log(x.a)}))
    with pytest.raises(SolveError, match="the text of l cannot be run on cvxpy variables"):
        solve(logarithm, "gp")


@pytest.mark.slow
def test_scip_finds_what_exhaustion_proves_but_is_not_believed():
    problem = teeth.problem(drive())
    ours, theirs = solve(problem, "exact"), solve(problem, "scip", Budget(seconds=60))
    assert theirs.value == pytest.approx(ours.value, rel=1e-9)
    assert ours.status == "optimal" and theirs.status == "feasible" and theirs.bound is None
    assert theirs.message.startswith("SCIP claims optimal")


def test_scip_infeasible_is_its_word():
    result = solve(teeth.problem(drive(wheel_diameter=F(250))), "scip", Budget(seconds=60))
    assert result.status == "failed" and "not proven" in result.message


def test_scip_under_its_tolerance_is_refused():
    """min (x/1000)^8 from a guess of 1000, least x = 1: scaled 1e-24, where SCIP says anything."""
    problem = Problem(
        "tiny",
        (Var("x", "", 1.0, 1000.0, 1000.0, log=True),),
        (),
        lambda x, p: Terms({"f": x.x**8}),
    )
    with pytest.raises(SolveError, match="within SCIP's tolerance"):
        solve(problem, "scip")


def test_posynomials_of_the_tape_are_the_text():
    rng = np.random.default_rng(2)
    problem = continuous_sizing.problem(drive(ratio=(F(2), F(9)), wheel_diameter=F(400)))
    model = scip.read(problem)
    points = np.exp(rng.uniform(0.0, 2.0, (20, len(problem.columns))))
    batch = problem.batch(points)
    rows = [(model.objective, batch.F[:, 0])]
    rows += list(zip(model.inequalities, batch.G.T, strict=True))
    for term, values in rows:
        expanded = np.exp(np.log(points) @ term.exponents.T) @ term.coefficients
        assert np.allclose(expanded, values, rtol=1e-12)
