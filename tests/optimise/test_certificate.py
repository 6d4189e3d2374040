"""Certificates refuse what is not so, whoever claims it."""

from dataclasses import replace

import numpy as np
import pytest

from gearopt.errors import CertificateError
from gearopt.optimise.certificate import FARKAS, Verdict, bounded, certify, reconcile, told
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Result
from gearopt.optimise.solve import run, solve
from gearopt.optimise.solvers import ipopt
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
    assert outside.status == "failed" and "bound of x" in outside.message


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
    assert "values of m" in certify(problem, Outcome(np.array([1.3, 12.0])), 1e-6).message
    assert "values of z" in certify(problem, Outcome(np.array([1.25, 12.4])), 1e-6).message


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


def test_true_infeasibility_is_proven_with_its_conflict():
    def evaluate(x, p):
        rows = {"large": 3.0 / x.x, "small": x.x / 2.0, "idle": x.y / 5.0}
        return Terms({"f": x.x * x.y}, rows)

    pair = (Var("x", "", 0.1, 10, 1.0, log=True), Var("y", "", 0.1, 10, 1.0, log=True))
    result, _ = run(Problem("clash", pair, (), evaluate))
    assert result.status == "infeasible" and result.value is None
    assert sorted(result.proof["conflict"]) == ["large", "small"]
    # x = sqrt(6) violates both by sqrt(1.5) - 1, and nothing violates less
    assert result.proof["least_violation"] == pytest.approx(1.5**0.5 - 1.0, rel=1e-9)


def test_nonconvex_failure_is_never_called_infeasible():
    problem = Problem(
        "waves",
        (Var("x", "", 0.0, 6.0, 1.0),),
        (),
        lambda x, p: Terms({"f": x.x}, {"never": 2.0 + np.sin(x.x)}),
    )
    result, _ = run(problem)
    assert result.status == "failed" and "not proven" in result.message


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


def test_budget_keeps_the_best_feasible_iterate():
    problem = hill()
    stopped = ipopt.run(problem, Budget(evaluations=4), 0, None, start=np.array([9.0, 9.0]))
    assert not stopped.finished
    verdict = certify(problem, stopped, 1e-9)
    assert verdict.status == "limit" and verdict.objective >= 0.5
    seen = []
    watched = ipopt.run(problem, Budget(), 0, lambda event: seen.append(event) or len(seen) < 3)
    assert len(seen) == 3 and not watched.finished


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


def test_an_exception_of_the_watcher_reaches_the_caller():
    def broken(event):
        raise RuntimeError("my own")

    with pytest.raises(RuntimeError, match="my own"):
        ipopt.run(hill(), Budget(), 0, broken)
    told = []
    assert ipopt.run(hill(), Budget(), 0, told.append).finished  # None is not False
    assert told


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
        words = f"row is violated by {excess:.3g}, which the objective gains from. Ended."
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
    assert verdict.message.endswith("which the objective gains from.")

    assert (told(0.5), told(-0.5), told(np.inf), told(-np.inf)) == (0.5, None, None, None)
    assert told(-1e-6) == 0.0 and told(-1.1e-6) is None


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
            "arithmetic": "double, with a rounding allowance",
        }
    inside = replace(outcome, x=outcome.x * [1.0 + 2e-6, 1.0])  # where we see no limit that holds
    verdict = certify(hill(), inside, 1e-6)
    assert verdict.certificate["stationarity"] <= 1e-5 and verdict.gap < 3e-6
    assert verdict.certificate["complementarity"] == pytest.approx(1.6e-6, rel=1e-3)


def test_multipliers_of_a_method_are_taken_as_at_least_zero(monkeypatch):
    """Its own alone: the right ones prove the optimum, those below zero count as none."""
    _, outcome = run(hill())
    monkeypatch.setattr("gearopt.optimise.multipliers.MOST", 0)
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


def test_without_finite_bounds_there_is_no_bound():
    pair = tuple(Var(n, "", 0.1, np.inf, 1.0, log=True) for n in "xy")
    problem = Problem("open", pair, (), lambda x, p: Terms({"f": x.x * x.y + 1.0 / (x.x * x.y)}))
    verdict = certify(problem, Outcome(np.array([2.0 - 1e-7, 0.5]), message="Ended."), 1e-6)
    assert (verdict.status, verdict.bound, verdict.proof) == ("stationary", None, {})
    away = certify(problem, Outcome(np.array([2.0, 0.6])), 1e-6)
    assert away.status == "feasible"
    early = Outcome(np.array([2.0 - 1e-7, 0.5]), False)
    assert certify(problem, early, 1e-6).status == "limit"


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
    assert verdict.status == "failed" and verdict.message.startswith("nothing holds x (2e+09)")
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


def test_the_better_bound_brings_its_proof():
    found = Result("a", "feasible", "exact", {"name": "f", "value": 1.0}, proof={"method": "own"})
    ideal = replace(found, bound=1.0, proof={"method": "dual"})
    known = reconcile(found, ideal, 1e-6)
    assert (known.status, known.bound, known.proof) == ("optimal", 1.0, {"method": "dual"})
    kept = reconcile(replace(found, bound=1.0), replace(ideal, bound=0.5), 1e-6)
    assert (kept.bound, kept.proof) == (1.0, {"method": "own"})
