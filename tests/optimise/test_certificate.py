"""Certificates refuse what is not so, whoever claims it."""

from dataclasses import replace

import numpy as np
import pytest

from gearopt.errors import CertificateError
from gearopt.optimise import certificate
from gearopt.optimise.certificate import certify
from gearopt.optimise.deadline import until
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome
from gearopt.optimise.solve import run
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.stationarity import residuals
from gearopt.optimise.terms import Terms, Var


def hill():
    """min x + 1/y with x y >= 4, each from 0.1 to 10: x = 0.4, y = 10."""

    def evaluate(x, p):
        return Terms({"f": x.x + 1.0 / x.y}, {"product": 4.0 / (x.x * x.y)})

    pair = (Var("x", "", 0.1, 10, 1.0, log=True), Var("y", "", 0.1, 10, 1.0, log=True))
    return Problem("hill", pair, (), evaluate)


def test_right_outcome_is_optimal():
    result, outcome = run(hill())
    assert result.status == "optimal"
    assert result.value == pytest.approx(0.5, rel=1e-9)  # y = 10, x = 0.4
    assert certify(hill(), outcome, 1e-6).status == "optimal"


def test_wrong_point_with_right_multipliers_is_not_optimal():
    _, outcome = run(hill())
    worse = Outcome(np.array([0.5, 9.0]), lam_g=outcome.lam_g, lam_h=outcome.lam_h)
    verdict = certify(hill(), worse, 1e-6)
    assert verdict.status == "feasible"
    assert verdict.bound <= 0.5 <= verdict.objective
    assert verdict.gap > 0.1


@pytest.mark.slow
def test_wrong_multipliers_weaken_the_bound_but_never_falsify_it():
    _, outcome = run(hill())
    rng = np.random.default_rng(3)
    for _ in range(200):
        lam = outcome.lam_g * np.exp(rng.normal(0, 1)) + rng.normal(0, 0.1)
        claimed = Outcome(outcome.x, lam_g=lam, lam_h=outcome.lam_h)
        verdict = certify(hill(), claimed, 1e-12)
        assert verdict.bound <= 0.5 * (1 + 1e-12)


def test_infeasible_point_is_refused():
    verdict = certify(hill(), Outcome(np.array([0.1, 10.0])), 1e-6)
    assert verdict.status == "failed" and verdict.objective is None
    assert "product is violated" in verdict.message
    outside = certify(hill(), Outcome(np.array([20.0, 5.0])), 1e-6)
    assert (outside.status, outside.message) == ("failed", "x = 20 is above its bound 10.")
    below = certify(hill(), Outcome(np.array([0.01, 400.0])), 1e-6)
    assert below.message == "x = 0.01 is below its bound 0.1."


def test_nan_is_refused_by_name():
    problem = Problem(
        "root",
        (Var("x", "", -1, 1, 0.5),),
        (),
        lambda x, p: Terms({"f": x.x}, {"root": np.sqrt(x.x)}),
    )
    with np.errstate(invalid="ignore"):
        verdict = certify(problem, Outcome(np.array([-0.5])), 1e-6)
    assert verdict.status == "failed" and "root" in verdict.message


def test_discrete_values_are_checked():
    problem = Problem(
        "series",
        (Var("m", "mm", 1, 2, 1, values=(1.0, 1.25, 2.0)), Var("z", "", 10, 20, 12, integer=True)),
        (),
        lambda x, p: Terms({"d": x.m * x.z}),
    )
    assert certify(problem, Outcome(np.array([1.25, 12.0])), 1e-6).status == "feasible"
    wrong = certify(problem, Outcome(np.array([1.3, 12.0])), 1e-6)
    assert wrong.message == "m = 1.3 is not one of its values."
    wrong = certify(problem, Outcome(np.array([1.25, 12.4])), 1e-6)
    assert wrong.message == "z = 12.4 is not a whole number."


def test_nothing_is_proven_where_a_variable_is_discrete():
    problem = Problem(
        "mixed",
        (Var("n", "", 0, 9, 3, integer=True), Var("x", "", 0, 9, 1.0)),
        (),
        lambda x, p: Terms({"f": (x.n - 2.5) ** 2 + (x.x - 1.0) ** 2}),
    )
    for finished, status in ((True, "feasible"), (False, "limit")):
        verdict = certify(problem, Outcome(np.array([3.0, 1.0]), finished), 1e-6)
        assert (verdict.status, verdict.bound) == (status, None)
        assert list(verdict.certificate) == ["feasibility"]


def test_a_claimed_bound_above_a_feasible_value_is_an_error():
    with pytest.raises(CertificateError, match="below the claimed bound"):
        certify(hill(), Outcome(np.array([0.4, 10.0]), bound=0.6), 1e-6, exact=True)


def test_false_infeasibility_is_not_believed():
    lam = np.array([1.0])
    claim = Outcome(np.array([1.0, 1.0]), lam_g=lam, lam_h=np.empty(0), infeasible=True)
    verdict = certify(hill(), claim, 1e-6)
    assert verdict.status == "failed" and "not proven" in verdict.message


def test_nonconvex_failure_is_never_called_infeasible():
    problem = Problem(
        "waves",
        (Var("x", "", 0.0, 6.0, 1.0),),
        (),
        lambda x, p: Terms({"f": x.x}, {"never": 2.0 + np.sin(x.x)}),
    )
    result, _ = run(problem)
    assert result.status == "failed" and "not proven" in result.message


def test_budget_keeps_the_best_feasible_iterate():
    problem = hill()
    stopped = ipopt.run(problem, Budget(evaluations=4), 0, None, start=np.array([9.0, 9.0]))
    assert not stopped.finished
    verdict = certify(problem, stopped, 1e-9)
    assert verdict.status == "limit" and verdict.objective >= 0.5
    seen = []
    watched = ipopt.run(problem, Budget(), 0, lambda event: seen.append(event) or len(seen) < 3)
    assert len(seen) == 3 and not watched.finished


def valley():
    """min (x^2 - 1)^2 for x in [-2, 2], which is convex in no form."""

    def evaluate(x, p):
        return Terms({"f": (x.x * x.x - 1.0) ** 2})

    return Problem("valley", (Var("x", "", -2.0, 2.0, 0.5),), (), evaluate)


def test_residuals_are_not_sought_of_a_search_that_ended_with_its_seconds(monkeypatch):
    """But of an end, of a form that has a bound, and while there are seconds."""
    sought = []

    def noted(point):
        sought.append(point)
        return residuals(point)

    monkeypatch.setattr(certificate, "residuals", noted)
    ended, stopped = Outcome(np.array([1.0])), Outcome(np.array([0.9]), finished=False)
    with until(0.0):
        verdict = certify(valley(), stopped, 1e-6)
        assert verdict.status == "limit" and verdict.objective == pytest.approx(0.0361)
        assert not sought and verdict.certificate == {"feasibility": 0.0}
        assert verdict.bound is None and not verdict.multipliers
        assert certify(valley(), ended, 1e-6).status == "stationary" and sought
        of_convex = certify(hill(), Outcome(np.array([0.5, 9.0]), finished=False), 1e-6)
        assert of_convex.status == "limit" and of_convex.bound <= 0.5
    with until(100.0):
        assert {"stationarity"} <= certify(valley(), stopped, 1e-6).certificate.keys()


def test_an_objective_that_is_no_number_is_refused_by_name():
    problem = Problem(
        "log", (Var("x", "", 1, 300, 55.0),), (), lambda x, p: Terms({"loss": np.log(x.x - 200.0)})
    )
    with np.errstate(invalid="ignore"):
        verdict = certify(problem, Outcome(np.array([55.0])), 1e-6)
    assert verdict.status == "failed" and "loss is not a number at x = 55" in verdict.message


def test_a_certificate_of_nan_proves_nothing():
    """0 * log(0) in a row with multiplier 0 makes the sum NaN."""
    problem = Problem(
        "under",
        (Var("x", "", 0.1, 100, 1.0, log=True),),
        (),
        lambda x, p: Terms({"f": x.x}, {"a": x.x / 2.0, "u": x.x**-2000.0}),
    )
    claim = Outcome(
        np.array([10.0]), lam_g=np.array([1.0, 0.0]), lam_h=np.empty(0), infeasible=True
    )
    assert certify(problem, claim, 1e-6).status == "failed"


def test_only_an_exact_algorithm_of_the_formulation_may_bring_a_bound():
    claim = Outcome(np.array([0.5, 10.0]), bound=0.5, proof={"method": "solver says"})
    assert certify(hill(), claim, 1e-6).proof.get("method") != "solver says"
    no = Outcome(None, infeasible=True, proof={"method": "solver says"})
    assert certify(hill(), no, 1e-6).status == "failed"
    assert certify(hill(), no, 1e-6, exact=True).status == "infeasible"


def test_a_listed_point_that_is_not_feasible_is_an_error():
    claim = Outcome(np.array([0.5, 10.0]), others=(np.array([0.1, 10.0]),))
    with pytest.raises(CertificateError, match="a listed point violates product"):
        certify(hill(), claim, 1e-6)


@pytest.mark.parametrize(
    ("variable", "objective"),
    [
        (Var("x", "", 0.0, np.inf, 1e12), lambda x, p: Terms({"f": -x.x})),
        (Var("x", "", 0.0, 1.0, 0.5), lambda x, p: Terms({"f": 1e-7 * x.x})),
    ],
)
def test_a_point_on_a_slope_is_not_stationary(variable, objective):
    """Far out on an unbounded slope, and on a slope that is small in its own unit."""
    problem = Problem("slope", (variable,), (), objective)
    for at in (0.3, 1e18) if np.isinf(variable.upper) else (0.3, 0.7):
        claim = Outcome(np.array([at]), lam_g=np.empty(0), lam_h=np.empty(0))
        assert certify(problem, claim, 1e-6).status in ("feasible", "failed")


def test_an_exception_of_the_watcher_reaches_the_caller():
    def broken(event):
        raise RuntimeError("my own")

    with pytest.raises(RuntimeError, match="my own"):
        ipopt.run(hill(), Budget(), 0, broken)
    told = []
    assert ipopt.run(hill(), Budget(), 0, told.append).finished  # None is not False
    assert told


def test_of_two_objectives_the_first_counts_and_nothing_is_proven():
    variable = Var("x", "", 1.0, 2.0, 1.0, log=True)
    problem = Problem("two", (variable,), (), lambda x, p: Terms({"f": x.x, "g": 1.0 / x.x}))
    verdict = certify(problem, Outcome(np.array([1.0])), 1e-6)
    assert (verdict.status, verdict.objective, verdict.bound) == ("feasible", 1.0, None)
    assert verdict.message == ""
    stopped = certify(problem, Outcome(np.array([1.0]), finished=False), 1e-6)
    assert stopped.status == "limit"


def test_multipliers_of_one_kind_alone_are_not_used():
    for lam in ({"lam_g": np.array([0.5])}, {"lam_h": np.empty(0)}):
        assert certify(hill(), Outcome(np.array([0.4, 10.0]), **lam), 1e-6).status == "optimal"


def test_a_claim_of_emptiness_needs_a_point_and_multipliers():
    lam = {"lam_g": np.ones(1), "lam_h": np.empty(0)}
    for claim in (
        Outcome(None, infeasible=True, message="No way", **lam),
        Outcome(np.ones(2), infeasible=True, message="No way"),
    ):
        verdict = certify(hill(), claim, 1e-6)
        assert (verdict.status, verdict.message) == (
            "failed",
            "No way; impossibility is not proven",
        )


def test_an_excess_of_1e_8_is_feasible_and_a_little_more_is_not():
    """Rows, of the point and of listed points; exactly 1e-8 is met."""
    problem = Problem(
        "tie", (Var("n", "", 0, 9, 1.0),), (), lambda x, p: Terms({"f": x.n}, {"row": x.n})
    )
    at = [1.0 + 1e-8, 1.0 + 1.1e-8]
    bounds = [certify(problem, Outcome(np.array([x])), 1e-6) for x in (-1e-8, -1.01e-8)]
    assert [v.objective for v in bounds] == [-1e-8, None]  # of a variable whose scale is 1
    rows = [certify(problem, Outcome(np.array([x]), message="Ended."), 1e-6) for x in at]
    assert rows[0].objective == at[0] and 0.9e-8 < rows[0].certificate["feasibility"] < 1e-8
    assert rows[1].objective is None and rows[1].status == "failed"
    assert rows[1].message == "row is violated by 1.1e-08. Ended."
    early = certify(problem, Outcome(np.array([2.0]), finished=False), 1e-6)
    assert early.status == "limit"
    for x, fine in zip([-1e-8, *at], (True, True, False), strict=True):
        claim = Outcome(np.array([0.5]), others=(np.array([x]),))
        if fine:
            assert certify(problem, claim, 1e-6).objective == 0.5
        else:
            with pytest.raises(CertificateError, match="listed point"):
                certify(problem, claim, 1e-6)


def test_no_point_is_failed_or_limit():
    for finished, status in ((True, "failed"), (False, "limit")):
        verdict = certify(hill(), Outcome(None, finished), 1e-6)
        assert (verdict.status, verdict.message) == (status, "no point found")
    assert certify(hill(), Outcome(None, message="Gone."), 1e-6).message == "Gone."


def test_the_better_multipliers_give_bound_and_residuals():
    """Ours at the optimum, a method's poor ones beside them; and no bound of NaN."""
    _, outcome = run(hill())
    for lam in (outcome.lam_g, np.array([100.0]), np.array([np.nan])):
        claim = replace(outcome, lam_g=lam)
        verdict = certify(hill(), claim, 1e-9)
        assert verdict.status == "optimal" and verdict.gap <= 1e-9
        assert verdict.certificate["stationarity"] <= 1e-9
        assert verdict.proof == {
            "method": "dual",
            "sentence": "Proof: the problem is convex in logarithms; the bound is a dual one, "
            "computed from our own derivatives.",
            "arithmetic": "double, with a rounding allowance",
        }
    inside = replace(outcome, x=outcome.x * [1.0 + 2e-6, 1.0])  # where we see no limit that holds
    verdict = certify(hill(), inside, 1e-6)
    assert verdict.certificate["stationarity"] <= 1e-5 and verdict.gap < 3e-6
    assert verdict.certificate["complementarity"] == pytest.approx(1.6e-6, rel=1e-3)


def test_multipliers_of_a_method_are_taken_as_at_least_zero(monkeypatch):
    """Its own alone: the right ones prove the optimum, those below zero count as none."""
    _, outcome = run(hill())
    monkeypatch.setattr("gearopt.optimise.dual.MAX_ENTRIES", 0)
    assert certify(hill(), outcome, 1e-9).status == "optimal"
    none, below = (
        certify(hill(), replace(outcome, lam_g=np.array([lam])), 1e-9) for lam in (0.0, -5.0)
    )
    assert none.status == below.status == "feasible" and none.bound == below.bound
    assert none.certificate == below.certificate and none.bound < 0.3
    bare = certify(hill(), replace(outcome, lam_g=None), 1e-9)
    assert (bare.status, bare.bound) == ("feasible", None)


def test_a_long_list_of_variables_is_cut():
    many = Var("variable", "", 1.0, 9.0, 2.0, 60)
    problem = Problem(
        "many", (many,), (), lambda x, p: Terms({"loss": np.log(0.0 * x.variable[0] - 1.0)})
    )
    with np.errstate(invalid="ignore"):
        verdict = certify(problem, Outcome(np.full(60, 2.0)), 1e-6)
    assert verdict.status == "failed" and len(verdict.message) == 300


def test_a_bound_counts_only_from_an_exact_algorithm_and_where_it_is_finite():
    """x + 1/y at (1, 10): 1.1, of which a method says that nothing is below; 0.5 is."""
    claim = Outcome(np.array([1.0, 10.0]), bound=1.1, proof={"method": "own"})
    assert certify(hill(), claim, 1e-6, exact=True).status == "optimal"
    verdict = certify(hill(), claim, 1e-6)
    assert verdict.status == "feasible" and verdict.bound <= 0.5
    nothing = certify(hill(), replace(claim, bound=-np.inf), 1e-6, exact=True)
    assert nothing.status == "feasible" and nothing.bound == verdict.bound


def test_what_is_not_solved_says_how_far_it_is_from_feasible():
    off = certify(hill(), Outcome(np.array([1.0, 3.2])), 1e-6)
    assert off.status == "failed" and off.certificate == {"feasibility": pytest.approx(0.25)}
    x = Var("x", "", -1.0, 1.0, 1.0)
    pole = Problem("pole", (x,), (), lambda x, p: Terms({"f": 1.0 / x.x}))
    verdict = certify(pole, Outcome(np.zeros(1)), 1e-6)
    assert verdict.status == "failed" and verdict.certificate == {"feasibility": 0.0}


def test_a_variable_that_nothing_holds_is_named():
    x = Var("x", "", -np.inf, np.inf, 1.0)
    problem = Problem("free", (x,), (), lambda x, p: Terms({"f": np.exp(-x.x * 1e-8)}))
    verdict = certify(problem, Outcome(np.array([2e9]), message="Ended."), 1e-6)
    assert verdict.status == "failed" and verdict.message.startswith("x is unbounded (2e+09)")
    assert certify(problem, Outcome(np.array([0.9e9])), 1e-6).status == "feasible"


def test_an_exhausted_search_is_told_as_it_was():
    claim = Outcome(None, infeasible=True, proof={"method": "exhausted"}, message="None of 9.")
    verdict = certify(hill(), claim, 1e-6, exact=True)
    assert (verdict.status, verdict.proof, verdict.message) == (
        "infeasible",
        {"method": "exhausted"},
        "None of 9.",
    )


def test_a_text_without_derivatives_is_feasible_and_says_why_no_more():
    x = Var("x", "", 1.0, 9.0, 2.0)
    table = Problem("table", (x,), (), lambda x, p: Terms({"f": np.frexp(x.x)[0]}))
    verdict = certify(table, Outcome(np.array([2.0]), message="Ended."), 1e-6)
    assert verdict.status == "feasible"
    assert verdict.message.startswith(
        "Ended. No bound, no optimality conditions: the text of table"
    )
