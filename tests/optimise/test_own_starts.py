"""A problem of one's own: starts, the method that is taken, and what its message says of proofs."""

import re
from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt import Budget, Conic, Param, Problem, Repeat, SolveError, Terms, Var, solve

PAGE = Path(__file__).parents[2] / "docs" / "own_problem.md"


def wells():
    """x^4 - x^2 + x/10: a minimum on either side of 0, the left one lower."""
    x = Var("x", "mm", -2.0, 2.0, 1.0)
    text = lambda x, p: Terms({"f": x.x**4 - x.x**2 + 0.1 * x.x})  # noqa: E731
    return Problem("wells", (x,), (), text)


def roots():
    """Where the derivative 4 x^3 - 2 x + 0.1 is zero."""
    return sorted(np.roots([4.0, 0.0, -2.0, 0.1]).real)


@pytest.mark.parametrize("start", [{"x": -1.5}, {"x_mm": -1.5}])
def test_a_start_leads_to_its_own_minimum(start):
    left, _, right = roots()
    assert solve(wells(), method="ipopt").design["x_mm"] == pytest.approx(right, abs=1e-6)
    there = solve(wells(), start=start, method="ipopt")
    assert there.design["x_mm"] == pytest.approx(left, abs=1e-6)
    again = solve(wells(), start=there.design, method="ipopt")
    assert again.status == "stationary" and again.value == pytest.approx(there.value, rel=1e-12)
    assert again.evaluations <= there.evaluations
    few = Budget(evaluations=40)
    assert solve(wells(), start=start, method="annealing", budget=few).value < -0.3


def test_without_a_method_the_lower_of_two_minima_is_proven():
    found = solve(wells())
    assert found.status == "optimal" and found.method == "spatial"
    assert found.design["x_mm"] == pytest.approx(roots()[0], abs=1e-6)
    assert found.bound <= found.value <= found.bound + 1e-6


def test_a_bound_stays_where_the_gap_does():
    """Of an answer that is better than the prover's, or as good, the bound is kept."""
    found = solve(wells(), budget=Budget(evaluations=12))
    assert found.status in ("limit", "stationary") and found.value < 0.0
    assert found.bound is None or found.bound <= -0.32


def test_a_start_names_some_variables_components_or_rows():
    """Ipopt with no steps left returns its start, which is feasible."""
    a, b = Var("a", "mm", 0.0, 9.0, 1.0, size=2), Var("b", "", 0.0, 9.0, 2.0)
    w = Var("w", "mm", 0.0, 9.0, 3.0)
    row = Repeat("row", (w,), {"k": np.array([1.0, 2.0])}, lambda x, p, r: Terms({"f": r.k * x.w}))
    text = lambda x, p: Terms({"f": x.a[0] + x.a[1] + x.b})  # noqa: E731
    problem, none = Problem("rows", (a, b), (), text, (row,)), Budget(evaluations=0)
    start = {"a": [4.0, 5.0], "row[2].w": 6.0}
    found = solve(problem, start=start, budget=none)
    assert found.design["a_mm"] == [4.0, 5.0] and found.design["b"] == 2.0
    assert found.design["row[2].w_mm"] == 6.0 and found.design["row[1].w_mm"] == 3.0
    one = solve(problem, start={"a[2]": 7.0}, budget=none)
    assert one.design["a_mm"] == [1.0, 7.0]


@pytest.mark.parametrize(
    ("start", "words"),
    [
        ({"y": 1.0}, "start: no variable 'y'; variables: x"),
        ({"x": 9.0}, "start: x=9 lies outside its bounds -2 to 2"),
        ({"x": "one"}, "start: x='one': write a number"),
        ({"x": [1.0, 2.0]}, "write a number"),
        ({"x": float("nan")}, "write a number"),
        ([1.0], r"start is values by name, such as start=\{\"x\": 1.0\}"),
    ],
)
def test_a_wrong_start_is_refused_by_name(start, words):
    with pytest.raises(ValueError, match=words):
        solve(wells(), start=start)


def test_who_takes_no_start_says_who_does():
    for method in ("qp", "nsga2", "gp"):
        with pytest.raises(
            SolveError, match=f"{method} takes no start; these do: annealing, cobyqa, ipopt"
        ):
            solve(wells(), method=method, start={"x": 1.0})
    with pytest.raises(SolveError, match="start changes nothing here"):
        solve(PAGE.parents[1] / "problems" / "elevator.toml", start={"x": 1.0})


def pair(text=None, **more):
    """Tooth numbers of a ratio of 3.14."""
    z = tuple(Var(n, "", 17, 60, 30, integer=True) for n in ("z1", "z2"))
    text = text or (lambda x: abs(x.z2 / x.z1 / 3.14 - 1.0))
    return Problem("pair", z, (), lambda x, p: Terms({"error": text(x)}), **more)


def test_discrete_variables_are_proven_or_take_a_sampler_and_it_says_so():
    few = Budget(evaluations=4000)
    proven = solve(pair(), budget=few)
    found = solve(pair(lambda x: np.sign(x.z1) * abs(x.z2 / x.z1 / 3.14 - 1.0)), budget=few)
    assert proven.status == "optimal" and proven.value == found.value
    assert "no relaxation of its text is known: the operation sign" in found.message
    least = min(abs(b / a / 3.14 - 1.0) for a in range(17, 61) for b in range(17, 61))
    assert found.method == "annealing" and found.status == "feasible"
    assert found.value == pytest.approx(least, abs=1e-15)
    assert "annealing was taken, because z1 is discrete, and proves nothing" in found.message
    assert found.message in repr(found)
    named = solve(pair(), method="annealing", budget=few)
    assert "was taken" not in named.message
    with pytest.raises(SolveError, match="ipopt takes continuous variables only; z1"):
        solve(pair(), method="ipopt")
    for start, words in (
        ({"z1": 18.5}, "z1=18.5 is not whole"),
        ({"z1": 99}, "outside its bounds"),
    ):
        with pytest.raises(ValueError, match=words):
            solve(pair(), start=start)
    module = Var("m", "mm", 1.0, 3.0, 2.0, values=(1.0, 2.0, 3.0))
    wheel = Problem("wheel", (module,), (), lambda x, p: Terms({"m": x.m}))
    with pytest.raises(ValueError, match=r"m=1.5 is none of its values \(1.0, 2.0, 3.0\)"):
        solve(wheel, start={"m": 1.5})


def box(log=False, lower=1.0, upper=50.0, text=None):
    """The sum of two sides of a rectangle of 12: a geometric program, if it is declared one."""
    a, b = (Var(n, "mm", lower, upper, 9.0, log=log) for n in "ab")
    text = text or (lambda x, p: Terms({"sum": x.a + x.b}, {"area": p.least / (x.a * x.b)}))
    return Problem("box", (a, b), (Param("least", "mm2", 12.0),), text)


def test_what_only_lacks_logarithms_is_told():
    """Declared so, it is proven: what the message promises."""
    found = solve(box(), method="ipopt")
    words = "declare log=True for a, b: then this is a geometric program, whose optimum is proven"
    assert found.status == "stationary" and words in found.message
    declared = solve(box(log=True))
    assert declared.status == "optimal" and "declare" not in declared.message
    assert declared.value == pytest.approx(2.0 * 12.0**0.5, rel=1e-6)


def test_what_only_lacks_logarithms_is_proven_by_them():
    """The answer is that of the text as it stands: its rows and their prices are."""

    def text(x, p):
        return Terms({"sum": x.a + x.b}, {"area": x.a * x.b >= p.least, "a": x.a**2 <= 90 / x.b})

    plain, declared = (solve(box(log, text=text)) for log in (False, True))
    assert plain.status == declared.status == "optimal" and plain.method == "ipopt"
    assert plain.proof == declared.proof and plain.value == pytest.approx(2.0 * 12.0**0.5)
    assert plain.multipliers["area"] == pytest.approx(-81.0 / 12.0**0.5)
    assert plain.limits["area"] == pytest.approx(1.0)


def test_a_maximum_is_promised_a_proof_by_logarithms_alone():
    """max(x, 4/x) is least at 2, at its kink."""
    for log in (False, True):
        x = Var("x", "", 0.1, 9.0, 1.0, log=log)
        bent = Problem("bent", (x,), (), lambda x, p: Terms({"f": np.maximum(x.x, 4.0 / x.x)}))
        found = solve(bent, method="ipopt", budget=Budget(evaluations=300))
        assert (found.status == "optimal") == log
        assert ("declare log=True for x: then" in found.message) != log
    open_ = solve(box(lower=0.0, upper=np.inf), method="ipopt").message
    assert "a lower bound above 0 for a, b, a finite upper bound for a, b: then" in open_


@pytest.mark.parametrize(
    "problem",
    [
        box(text=lambda x, p: Terms({"sum": x.a - 0.5 * x.b}, {"area": 12.0 / (x.a * x.b)})),
        box(text=lambda x, p: Terms({"sum": x.a + np.sin(x.b)})),
        wells(),
    ],
    ids=["difference", "sine", "wells"],
)
def test_what_lacks_more_is_not(problem):
    assert "log=True" not in solve(problem, method="ipopt").message


def test_the_method_of_ones_own_on_the_page_runs(capsys):
    """docs/own_problem.md: an Outcome with a bound and a proof is certified as any other."""
    section = PAGE.read_text(encoding="utf-8").split("## A method of your own")[1]
    code, shown = re.findall(r"```(?:python)?\n(.*?)```", section, re.S)[:2]
    scope = {}
    exec(compile(code, str(PAGE), "exec"), scope)
    assert capsys.readouterr().out == shown
    assert scope["solve"] is gearopt.solve


def test_a_method_of_ones_own_may_not_lie():
    def lies(problem, budget, seed, watch):
        proof = {"method": "none", "sentence": "Proof: none."}
        return gearopt.Outcome(np.array([20.0, 60.0]), bound=1.0, proof=proof)

    with pytest.raises(gearopt.CertificateError, match="below the claimed bound"):
        solve(pair(methods={"lies": lies}))


def knapsack(x, p):
    weights, gains = np.array([5.0, 7.0, 4.0, 3.0, 6.5]), np.array([8.0, 11.0, 6.0, 4.0, 10.1])
    limits = {"weight": x.n @ weights + x.y <= 14.3, "spare": x.y >= 0.1}
    return Terms(maximise={"gain": x.n @ gains - 0.01 * x.y}, limits=limits)


def test_a_conic_start_is_the_first_design_of_branch_and_bound():
    """One out of reach is no design; its whole numbers may still lead to none."""
    items = (Var("n", "", 0, 2, 0, size=5, integer=True), Var("y", "", 0.0, 9.0, 1.0))
    problem = Conic("knapsack", items, (), knapsack)
    best = solve(problem)
    assert best.status == "optimal"
    known = {"n": best.design["n"], "y": 0.5}
    early = solve(problem, start=known, budget=Budget(evaluations=1))
    assert early.value == pytest.approx(best.value, rel=1e-9) and early.feasible
    wrong = solve(problem, start={"n": [2, 2, 2, 2, 2]})
    assert wrong.value == pytest.approx(best.value, rel=1e-9) and wrong.status == "optimal"
    with pytest.raises(SolveError, match="a start changes nothing"):
        solve(Conic("one", items[1:], (), lambda x, p: Terms({"y": x.y**2})), start={"y": 2.0})
