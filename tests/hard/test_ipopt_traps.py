"""Known ways in which Ipopt's word is wrong: each shows the lie, then what we say."""

import math

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.certificate import certify
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome
from gearopt.optimise.solve import solve
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Param, Terms, Var

QUIET = {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": False}


def test_succeeded_at_an_absurd_diameter():
    """With only b <= m_a d, volume is invariant along b d^2 = const: d1 runs away."""

    def evaluate(x, p):
        ratio, torque, volume, limits = (x.u, p.total / x.u), p.torque, 0.0, {}
        for k in range(2):
            d, b, u = x.d[k], x.b[k], ratio[k]
            limits[f"k_factor[{k + 1}]"] = 2.0 * torque / (d**2 * b) * (1.0 + 1.0 / u) / 2.07
            limits[f"width[{k + 1}]"] = b / (0.75 * d)
            volume = volume + math.pi / 4.0 * b * d**2 * (1.0 + u**2)
            torque = torque * u
        return Terms({"volume": volume}, limits)

    open_ended = (
        Var("d", "mm", 1e-300, math.inf, 50.0, size=2, log=True),
        Var("b", "mm", 1e-300, math.inf, 30.0, size=2, log=True),
        Var("u", "", 1.0, 20.0, 5.0, log=True),
    )
    parameters = (Param("torque", "N mm", 49392.913), Param("total", "", 1450 / 66.5))
    problem = Problem("no least width", open_ended, parameters, evaluate)
    rng = np.random.default_rng(1)
    runaways = 0
    for _ in range(5):
        outcome = ipopt.run(problem, Budget(), 0, None, start=np.exp(rng.normal(0.0, 4.0, 5)))
        assert outcome.message == ""  # the lie: Solve_Succeeded, and the volume is right
        assert problem.batch(outcome.x[None]).F[0, 0] == pytest.approx(5687087.85, rel=1e-6)
        verdict = certify(problem, outcome, 1e-6)
        assert verdict.status != "optimal" and verdict.bound is None
        if outcome.x[0] > 1e15:
            runaways += 1
            assert verdict.status == "failed"
            assert verdict.message.startswith("d[1] is unbounded")
    assert runaways >= 3


def five_stages(as_two_inequalities):
    """1000:1 in five stages, b = 0.8 d; K-factor 2.07 MPa, 5 kW at 1500 rpm."""

    def evaluate(x, p):
        torque, volume, limits, equal, product = p.torque, 0.0, {}, {}, 1.0
        for k in range(5):
            d, b, u = x.d[k], x.b[k], x.u[k]
            limits[f"k_factor[{k + 1}]"] = 2.0 * torque / (d**2 * b) * (1.0 + 1.0 / u) / 2.07
            if as_two_inequalities:
                limits[f"width_high[{k + 1}]"] = b / (0.8 * d)
                limits[f"width_low[{k + 1}]"] = 0.8 * d / b
            else:
                equal[f"width[{k + 1}]"] = b / (0.8 * d)
            volume = volume + math.pi / 4.0 * b * d**2 * (1.0 + u**2)
            torque, product = torque * u, product * u
        return Terms({"volume": volume}, limits, equal={**equal, "ratio": product / 1000.0})

    variables = (
        Var("d", "mm", 1e-3, 1e6, 1.0, size=5, log=True),
        Var("b", "mm", 1e-3, 1e6, 1.0, size=5, log=True),
        Var("u", "", 1.0, 1000.0, 1.0, size=5, log=True),
    )
    torque = Param("torque", "N mm", 30e6 * 5.0 / math.pi / 1500.0)
    return Problem("five stages", variables, (torque,), evaluate)


def test_two_inequalities_that_emulate_an_equality():
    """No interior, so the multipliers are worthless: our gap shows it."""
    emulated = solve(five_stages(True))
    assert emulated.status != "optimal"
    assert emulated.gap > 1e-5
    assert emulated.bound <= 161945020.98 * (1 + 1e-12)
    honest = solve(five_stages(False))
    assert honest.status == "optimal" and honest.gap < 1e-9
    assert honest.value == pytest.approx(161945020.98, abs=0.006)


def test_bound_relaxation_in_metres():
    """Least module 2 mm = 0.002 m: Ipopt's default buys 1e-8 m of it, 5e-6 in length."""
    module = ca.SX.sym("m")
    solver = ca.nlpsol("s", "ipopt", {"x": module, "f": 1e6 * module}, QUIET)
    found = solver(x0=0.01, lbx=0.002, ubx=0.05)
    assert solver.stats()["return_status"] == "Solve_Succeeded"
    lie = float(found["x"])
    assert lie / 0.002 - 1.0 < -4e-6

    problem = Problem(
        "module", (Var("m", "m", 0.002, 0.05, 0.01),), (), lambda x, p: Terms({"m": 1e6 * x.m})
    )
    refused = certify(problem, Outcome(np.array([lie])), 1e-6)
    assert refused.status == "failed" and "is below its bound" in refused.message
    ours = solve(problem)
    assert ours.status == "optimal"
    assert ours.design["m_m"] >= 0.002


def test_return_status_is_not_taken_for_an_answer():
    """Stopped by its iteration limit Ipopt still returns a point; it is judged like any other."""
    problem = five_stages(False)
    before = ipopt.OPTIONS["max_iter"]
    ipopt.OPTIONS["max_iter"] = 3
    try:
        outcome = ipopt.run(problem, Budget(), 0, None)
    finally:
        ipopt.OPTIONS["max_iter"] = before
    assert "Maximum_Iterations_Exceeded" in outcome.message
    verdict = certify(problem, outcome, 1e-6)
    assert verdict.status not in ("optimal", "stationary")
    assert verdict.bound is None or verdict.bound <= 161945020.98
