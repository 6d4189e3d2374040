"""What certificates say of bounds, gaps and emptiness, and what is kept of several results."""

from dataclasses import replace

import numpy as np
import pytest

from gearopt.errors import CertificateError
from gearopt.optimise.certificate import FARKAS, Verdict, bounded, certify, reconcile, reported_gap
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Result
from gearopt.optimise.solve import run, solve
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Terms, Var


def test_true_infeasibility_is_proven_with_its_conflict():
    def evaluate(x, p):
        rows = {"large": 3.0 / x.x, "small": x.x / 2.0, "idle": x.y / 5.0}
        return Terms({"f": x.x * x.y}, rows)

    pair = (Var("x", "", 0.1, 10, 1.0, log=True), Var("y", "", 0.1, 10, 1.0, log=True))
    clash = Problem("clash", pair, (), evaluate)
    result, _ = run(clash)
    assert result.status == "infeasible" and result.value is None
    assert sorted(result.proof["conflict"]) == ["large", "small"]
    # x = sqrt(6) violates both by sqrt(1.5) - 1, and nothing violates less
    assert result.proof["least_violation"] == pytest.approx(1.5**0.5 - 1.0, rel=1e-9)
    told = ipopt.run(clash, Budget(), 0, None).message
    assert told.endswith("the smallest relative violation of the limits reached is 22.5 %")


def test_reconcile_keeps_the_better_bound_and_sees_contradictions():
    found = Result("a", "limit", "exact", {"name": "f", "value": 10.0}, bound=8.0, gap=0.2)
    ideal = Result(
        "b",
        "optimal",
        "ipopt",
        {"name": "f", "value": 9.9},
        bound=9.9,
        gap=0.0,
        proof={"method": "dual"},
    )
    better = reconcile(found, ideal, 0.05)
    assert (better.bound, better.status) == (9.9, "optimal")
    assert better.gap == pytest.approx(0.01)
    assert reconcile(found, ideal, 1e-6).status == "limit"
    with pytest.raises(CertificateError, match="below the relaxation"):
        reconcile(found, Result("b", "optimal", "ipopt", {"value": 11.0}, bound=11.0), 1e-6)
    never = Result("b", "infeasible", "ipopt", {}, proof={"method": "dual"})
    with pytest.raises(CertificateError, match="impossible"):
        reconcile(found, never, 1e-6)
    nothing = Result("a", "limit", "exact", {"name": "f", "value": None})
    assert reconcile(nothing, never, 1e-6).status == "infeasible"
    assert reconcile(nothing, never, 1e-6).proof == {"method": "dual"}


def test_huge_multipliers_do_not_falsify_the_bound():
    """min b d with b/d <= 1 and d/b <= 1 in a box from 1e-3: the optimum is 1e-6 at its corner."""
    problem = Problem(
        "corner",
        (Var("b", "", 1e-3, 1e3, 1.0, log=True), Var("d", "", 1e-3, 1e3, 1.0, log=True)),
        (),
        lambda x, p: Terms({"f": x.b * x.d}, {"up": x.b / x.d, "down": x.d / x.b}),
    )
    for size in (1.0, 1e6, 1e12, 1e16):
        claim = Outcome(np.array([5.0, 5.0]), lam_g=np.full(2, size), lam_h=np.empty(0))
        verdict = certify(problem, claim, 1e-6)
        assert verdict.status != "optimal"
        assert verdict.bound is None or verdict.bound <= 1e-6 * (1 + 1e-9)


def test_a_point_below_its_bound_is_not_optimal():
    """x >= 1 missed by 9.9e-9 gains 1e-6 where the objective is x^99."""
    problem = Problem(
        "steep",
        (Var("x", "", 0.1, 10, 2.0, log=True),),
        (),
        lambda x, p: Terms({"f": x.x**99.0}, {"least": 1.0 / x.x}),
    )
    claim = Outcome(np.array([1.0 - 9.9e-9]), lam_g=np.array([99.0]), lam_h=np.empty(0))
    assert certify(problem, claim, 1e-12).status != "optimal"


def level(at=1e8):
    """A problem whose objective is the variable, and a point of it: ties of gaps are exact."""
    variable = Var("x", "", 0.0, 1e9, 1.0)
    return Problem("level", (variable,), (), lambda x, p: Terms({"f": x.x})), np.array([at])


def test_a_claimed_bound_may_lie_above_by_the_tolerance_of_rows():
    problem, x = level()
    for above, fine in ((1.0, True), (2.0, False)):
        claim = Outcome(x, bound=1e8 + above, proof={"method": "own"})
        if fine:  # by 1e-8 exactly
            verdict = certify(problem, claim, 1e-6, exact=True)
            assert (verdict.status, verdict.gap) == ("optimal", 0.0)
        else:
            with pytest.raises(CertificateError, match="claimed bound"):
                certify(problem, claim, 1e-6, exact=True)


@pytest.mark.parametrize(
    ("gap", "status"), [(1e-6, "optimal"), (0.9e-6, "feasible"), (0.0, "feasible")]
)
def test_a_claimed_gap_of_the_tolerance_is_optimal(gap, status):
    problem, x = level()
    proof = {"method": "own"}
    claim = Outcome(x, bound=1e8 - 100.0, proof=proof, message="Told.")
    verdict = certify(problem, claim, gap, exact=True)
    assert (verdict.status, verdict.gap, verdict.bound) == (status, 1e-6, 1e8 - 100.0)
    assert (verdict.proof, verdict.message, verdict.objective) == (proof, "Told.", 1e8)
    stopped = certify(problem, replace(claim, finished=False, proof=None), gap, exact=True)
    assert stopped.status == ("optimal" if status == "optimal" else "limit") and stopped.proof == {}


def ours(value_above, tolerance, excess=0.0, at=1e8):
    problem, x = level(at)
    before = Verdict("feasible", at, certificate={"feasibility": excess}, message="Ended.")
    return bounded(problem, x, before, at - value_above, tolerance, "row")


def test_our_own_bound_decides_within_the_tolerance():
    assert (ours(1.0, 0.0).status, ours(1.0, 0.0).gap) == ("optimal", 1e-8)  # never below 1e-8
    assert ours(2.0, 0.0).status == "feasible" and ours(100.0, 1e-6).status == "optimal"
    assert ours(-1.0, 0.0).status == "optimal" and ours(-1.0, 0.0).gap == 0.0
    verdict = ours(101.0, 1e-6)
    assert (verdict.status, verdict.message, verdict.bound) == ("feasible", "Ended.", 1e8 - 101.0)
    assert "scale" not in verdict.certificate
    assert ours(0.01, 1e-6, at=0.1).status == "feasible"


def test_a_value_below_our_bound_is_an_error_or_explained():
    """An error where no limit is exceeded by more than rounding; else the excess is named."""
    with pytest.raises(CertificateError, match="below the dual bound"):
        ours(-101.0, 0.0)
    with pytest.raises(CertificateError, match="below the dual bound"):
        ours(-101.0, 0.0, excess=1e-14)
    assert ours(-100.0, 0.0).status == "feasible"  # by 1e-6 exactly
    for excess in (1.01e-14, 5e-9):
        verdict = ours(-101.0, 0.0, excess=excess)
        assert verdict.status == "feasible" and verdict.gap is None
        words = f"row is violated by {excess:.3g}, from which the objective benefits. Ended."
        assert verdict.message == words


@pytest.mark.parametrize(("slope", "kind"), [(1e5, Problem), (-1e5, Problem), (1e5, Conic)])
def test_limits_that_contradict_each_other_by_a_little_are_no_error(slope, kind):
    """x >= 1 + 1e-10 and x <= 1: a point between them is accepted, and may lie below the bound."""
    x = Var("x", "", -10.0, 10.0, 1.0)

    def text(x, p):
        rows = {"least": 2.0 + 1e-10 - x.x, "most": x.x}
        return Terms({"f": slope * (x.x - 1.0) + 1.0}, rows)

    problem = kind("rows", (x,), (), text)
    if kind is Problem:
        verdict = certify(problem, Outcome(np.array([1.0 + 5e-11])), 1e-6)
    else:
        verdict = solve(problem)
    assert verdict.status in ("feasible", "stationary")
    assert verdict.message.startswith(("least is violated by 5e-11", "most is violated by 5e-11"))
    assert verdict.message.endswith("from which the objective benefits.")

    assert (reported_gap(0.5), reported_gap(-0.5), reported_gap(np.inf), reported_gap(-np.inf)) == (
        0.5,
        None,
        None,
        None,
    )
    assert reported_gap(-1e-6) == 0.0 and reported_gap(-1.1e-6) is None


@pytest.mark.parametrize(("least", "status"), [(3.0, "infeasible"), (0.3, "failed")])
def test_a_proof_of_emptiness_shows_a_violation_of_1e_9(least, status):
    assert FARKAS == 1e-9
    far = np.exp(2e-9 * least)
    problem = Problem(
        "near",
        (Var("x", "", 0.1, 10, 1.0, log=True),),
        (),
        lambda x, p: Terms({"f": x.x}, {"large": far / x.x, "small": x.x, "idle": x.x / 9.0}),
    )
    lam = np.array([1.0, 1.0, 0.0])
    claim = Outcome(np.ones(1), lam_g=lam, lam_h=np.empty(0), infeasible=True)
    verdict = certify(problem, claim, 1e-6)
    assert verdict.status == status
    if status == "infeasible":
        assert verdict.proof["conflict"] == ["large", "small"]
        assert verdict.proof["least_violation"] == pytest.approx(3e-9, rel=1e-3)
        assert verdict.message == "no design meets these together: large, small"
        assert verdict.proof["method"] == "dual"


def test_the_conflict_is_in_the_order_of_its_weights():
    """x >= 3 against x <= 2 with little of y <= 1e-5 and nothing of y <= 1e-7."""

    def evaluate(x, p):
        rows = {"hardly": x.y / 9.0, "large": 3.0 / x.x, "idle": x.y / 8.0}
        return Terms({"f": x.x * x.y}, rows, equal={"two": x.x / 2.0})

    pair = tuple(Var(n, "", 0.1, 10, 1.0, log=True) for n in "xy")
    lam_g = np.array([3e-6, 1.0, 1e-6])
    claim = Outcome(np.ones(2), lam_g=lam_g, lam_h=np.array([1.001]), infeasible=True)
    verdict = certify(Problem("order", pair, (), evaluate), claim, 1e-6)
    assert verdict.proof["conflict"] == ["two", "large", "hardly"]


def test_a_quadratic_program_without_a_point_is_judged_in_its_rows():
    """x >= 3 and x <= 2 in natural variables: l (3 - x + 1 - 1) + l (x - 2) = 1/2 everywhere."""
    problem = Problem(
        "rows",
        (Var("x", "", -10, 10, 1.0),),
        (),
        lambda x, p: Terms({"f": x.x**2}, {"large": 1.0 + 3.0 - x.x, "small": x.x - 1.0}),
    )
    claim = Outcome(np.ones(1), lam_g=np.ones(2), lam_h=np.empty(0), infeasible=True)
    verdict = certify(problem, claim, 1e-6)
    assert verdict.status == "infeasible"
    assert verdict.proof["least_violation"] == pytest.approx(0.5, abs=1e-12)


def test_without_finite_bounds_a_bound_needs_slopes_of_zero():
    pair = tuple(Var(n, "", 0.1, np.inf, 1.0, log=True) for n in "xy")
    problem = Problem("open", pair, (), lambda x, p: Terms({"f": x.x * x.y + 1.0 / (x.x * x.y)}))
    verdict = certify(problem, Outcome(np.array([2.0 - 1e-7, 0.5]), message="Ended."), 1e-6)
    assert verdict.status == "optimal" and 2.0 - 1e-9 < verdict.bound <= 2.0
    away = certify(problem, Outcome(np.array([2.0, 0.6])), 1e-6)
    assert away.status == "feasible" and (away.bound is None or away.bound <= 2.0)
    falling = Problem("falls", pair[:1], (), lambda x, p: Terms({"f": 1.0 + 1.0 / x.x}))
    early = certify(falling, Outcome(np.array([1e3]), False), 1e-6)
    assert (early.status, early.bound, early.proof) == ("limit", None, {})


def test_reconciled_results_keep_what_nobody_contradicts():
    found = Result("a", "feasible", "exact", {"name": "f", "value": 10.0}, bound=8.0, gap=0.2)
    for bound in (None, 7.0, 8.0):
        other = Result("b", "optimal", "ipopt", {"name": "f", "value": 9.9}, bound=bound)
        assert reconcile(found, other, 1e-6) is found
    nothing = Result("a", "limit", "exact", {"name": "f", "value": None}, bound=1.0)
    ideal = Result("b", "optimal", "ipopt", {"name": "f", "value": 9.9}, bound=9.9)
    assert reconcile(nothing, ideal, 1e-6) is nothing
    proven = Result("a", "infeasible", "exact", {"name": "f", "value": None}, message="own")
    never = Result("b", "infeasible", "ipopt", {}, proof={"method": "dual"}, message="theirs")
    assert reconcile(proven, never, 1e-6) is proven
    assert reconcile(nothing, never, 1e-6).message == "theirs"
    tie = replace(found, objective={"name": "f", "value": 1e8}, bound=None)
    above = replace(ideal, bound=1e8 + 1.0)  # by 1e-8 exactly
    assert reconcile(tie, above, 1e-6).status == "optimal"
    assert reconcile(tie, replace(ideal, bound=1e8 - 100.0), 1e-6).status == "optimal"
    with pytest.raises(CertificateError):
        reconcile(tie, replace(ideal, bound=1e8 + 2.0), 1e-6)


def test_the_better_bound_brings_its_proof():
    found = Result("a", "feasible", "exact", {"name": "f", "value": 1.0}, proof={"method": "own"})
    ideal = replace(found, bound=1.0, proof={"method": "dual"})
    known = reconcile(found, ideal, 1e-6)
    assert (known.status, known.bound, known.proof) == ("optimal", 1.0, {"method": "dual"})
    kept = reconcile(replace(found, bound=1.0), replace(ideal, bound=0.5), 1e-6)
    assert (kept.bound, kept.proof) == (1.0, {"method": "own"})
