"""Wrong declarations and texts of users: one clear error each, nothing on the standard error."""

import math
import multiprocessing
import os
import re

import numpy as np
import pytest

import gearopt
from gearopt.errors import GearoptError, SolveError
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.optimise.solvers import nsga2
from gearopt.optimise.terms import Param, Repeat, Terms, Var

METHODS = ("ipopt", "annealing", "nsga2", "multistart", "qp", "gp", "scip")
SHORT = {
    "multistart": Budget(evaluations=200),
    "annealing": Budget(evaluations=96),
    "nsga2": Budget(evaluations=20),
}


def var(**more):
    return Var(**{"name": "a", "unit": "", "lower": 0.5, "upper": 3.0, "guess": 1.0, **more})


def own(text, *variables, parameters=(), repeats=(), log=True):
    block = var(name="w", size=3, log=log)
    return Problem("own", variables or (var(log=log), block), parameters, text, repeats)


def tried(problem, method):
    """The result or the error of a method within a short budget."""
    try:
        return solve(problem, method, SHORT.get(method, Budget(seconds=1.0)))
    except GearoptError as refused:
        return refused


TERMS = {
    "math": (lambda x: math.sqrt(x.a), ""),
    "abs": (lambda x: abs(x.a), ""),
    "array": (lambda x: np.array(x.w) / 9.0, "block"),
    "block": (lambda x: (x.a, x.a / 2.0), "block"),
    "one in a list": (lambda x: [x.a], "block"),
    "no term in a block": (lambda x: (), "block"),
    "matrix": (lambda x: np.outer(x.w, x.w), "of several dimensions"),
    "tuple in a tuple": (lambda x: ((x.a,),), "in a block"),
    "none": (lambda x: None, "None, no real number"),
    "text": (lambda x: "1.0", "'1.0', no real number"),
    "complex": (lambda x: 1j, "no real number"),
    "complex of a": (lambda x: x.a * 1j, "no real number"),
    "comparison": (lambda x: x.a > 1.0, "comparison"),
    "function": (lambda x: len, "builtin_function_or_method"),
    "generator": (lambda x: (v for v in x.w), "generator"),
    "dict": (lambda x: {}, "dict"),
    "not a number": (lambda x: math.nan, ""),
    "infinite": (lambda x: x.a * math.inf, ""),
    "never a number": (lambda x: np.log(-x.a), ""),
    "zero": (lambda x: 0, ""),
    "huge": (lambda x: np.exp(1000.0 * x.a), ""),
    "division by zero": (lambda x: 1 / 0, "ZeroDivisionError: division by zero"),
    "missing": (lambda x: x.b, "nothing is named 'b' here; declared: a, w"),
    "beyond the block": (lambda x: x.w[5], "IndexError"),
    "its own error": (lambda x: {}["key"], "KeyError: 'key'"),
    "max": (lambda x: np.max(x.w), ""),
    "if": (lambda x: x.a if x.a > 1.0 else 1.0, ""),
    "int": (lambda x: int(x.a), ""),
    "polyval": (lambda x: np.polyval([1.0, 2.0], x.a), ""),
}


PLACES = {
    "objective": lambda term: lambda x, p: Terms({"f": term(x)}),
    "limit": lambda term: lambda x, p: Terms({"f": x.a + sum(x.w)}, {"g": term(x)}),
    "equal": lambda term: lambda x, p: Terms({"f": (x.a - 1.0) ** 2}, equal={"g": term(x)}),
    "report": lambda term: lambda x, p: Terms({"f": x.a}, report={"g": term(x)}),
}


@pytest.mark.parametrize("name", TERMS)
def test_a_strange_objective_is_an_answer_or_one_clear_error(name, capfd):
    term, words = TERMS[name]
    for method in ("ipopt", "gp", "qp"):
        found = tried(own(PLACES["objective"](term)), method)
        if words:
            assert isinstance(found, SolveError) and words in str(found), (method, found)
        assert not isinstance(found, gearopt.CertificateError)
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("place", PLACES)
def test_strange_terms_are_answers_or_clear_errors_for_every_method(place, method, capfd):
    for term, _ in TERMS.values():
        for log in (True, False):
            found = tried(own(PLACES[place](term), log=log), method)
            assert not isinstance(found, gearopt.CertificateError)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("method", METHODS)
def test_an_array_is_a_block_of_limits(method):
    def text(x, p):
        return Terms({"f": 1.0 / x.a + sum(1.0 / v for v in x.w)}, {"g": np.array(x.w) / 2.0})

    found = tried(own(text), method)
    if isinstance(found, SolveError):
        assert method in ("qp",)
        return
    if method in ("ipopt", "gp", "multistart", "scip"):
        assert found.value == pytest.approx(1.0 / 3.0 + 1.5, rel=1e-6)
    assert not found.limits or list(found.limits) == ["g[1]", "g[2]", "g[3]"]


TEXTS = [
    (lambda x, p: None, "returns NoneType, not Terms"),
    (lambda x, p: {"f": x.a}, "returns dict, not Terms"),
    (lambda x, p: Terms({}), "minimises nothing"),
    (lambda x, p: Terms([x.a]), "minimise is not a dict"),
    (lambda x, p: Terms({"f": x.a}, None), "limits is not a dict"),
    (lambda x, p: Terms({1: x.a}), "has the key 1; write a name"),
    (lambda x, p: Terms({"f": x.a}, {3: x.a}), "has the key '?3"),
    (lambda: Terms({"f": 1.0}), "cannot be evaluated: TypeError: .* takes 0 positional"),
    (lambda x, p: Terms({"f": x.a}, limit={}), "unexpected keyword argument 'limit'"),
    (lambda x, p: Terms({"f": x.a}, {"a": x.a}, {"a": x.a}), "two rows are named 'a'"),
    (lambda x, p: Terms({"f": p.torque}), "nothing is named 'torque' here"),
    (lambda x, p: Terms({"f": sum(x.a)}), r"in line \d+ .*sum\(x.a\)"),
]


@pytest.mark.parametrize("k", range(len(TEXTS)))
def test_a_wrong_text_is_one_error_for_every_method(k):
    text, words = TEXTS[k]
    for method in METHODS:
        with pytest.raises(SolveError, match=words):
            solve(own(text), method)


DECLARED = [
    (lambda: var(values=()), "values are finite numbers"),
    (lambda: var(values=(math.nan,)), "values are finite numbers"),
    (lambda: var(values=("a",)), "values are finite numbers"),
    (lambda: var(integer=True, values=(0.0, 2.5, 3.0)), "2.5 among its values is not whole; write"),
    (lambda: var(lower=math.nan), "lower is nan"),
    (lambda: var(upper=None), "upper is None"),
    (lambda: var(guess="1"), "guess is '1'"),
    (lambda: var(lower=1j), "lower is 1j"),
    (lambda: var(lower=4.0), "lower <= guess <= upper"),
    (lambda: var(guess=math.inf, upper=math.inf), "the guess is infinite"),
    (lambda: var(size=0), "size is a whole number"),
    (lambda: var(size=2.0), "size is a whole number"),
    (lambda: var(size=2, lower=(0.1, 0.2, 0.3)), r"lower has the shape \(3,\)"),
    (lambda: var(name=3), "variable name 3 is not an identifier"),
    (lambda: Param("q", "", math.nan), "parameter q: value is nan"),
    (lambda: Param("q", "", (1.0, 2.0), 3), r"value has the shape \(2,\)"),
    (lambda: Param("q r", "", 1.0), "parameter name 'q r'"),
    (lambda: own(ok, parameters=(Param("q", "", 1.0),)).at(q=(1.0, 2.0)), "has the shape"),
    (lambda: Repeat("r", (), {}, ok), "data are columns"),
    (lambda: Repeat("r", (), {"d": np.array([])}, ok), "data d are not a row of numbers"),
    (lambda: Repeat("r", (), {"d": 1.0}, ok), "data d are not a row of numbers"),
    (lambda: Repeat("r", (), {"d": [math.nan]}, ok), "data d are not a row of numbers"),
    (lambda: Repeat("r", (), {"d": [1.0], "e": [1.0, 2.0]}, ok), r"differ in length: \[1, 2\]"),
    (lambda: own(ok, repeats=(Repeat("r", (), {"d": [1.0]}, ok),) * 2), "'r' is declared twice"),
    (lambda: Problem("own", [var()], (), ok), "variables are a tuple"),
    (lambda: Problem("own", (var(),), None, ok), "parameters are a tuple"),
    (lambda: Problem("own", (var(),), (), None), "evaluate is NoneType"),
    (lambda: own(ok).batch(np.ones(4)), r"points are \(N, 4\), not \(4,\)"),
]


def ok(x, p, *row):
    return Terms({"f": x.a})


@pytest.mark.parametrize("k", range(len(DECLARED)))
def test_a_wrong_declaration_is_a_value_error(k):
    declare, words = DECLARED[k]
    with pytest.raises(ValueError, match=words):
        declare()


@pytest.mark.parametrize("method", [m for m in METHODS if m not in ("ipopt", "qp", "gp")])
def test_discrete_variables_without_a_value_between_their_bounds(method):
    for nothing in (var(values=(7.0,)), var(lower=1.2, upper=1.8, guess=1.5, integer=True)):
        with pytest.raises(
            SolveError, match="no (whole number|value of its set) lies between .* for a"
        ):
            solve(own(ok, nothing), method)


@pytest.mark.parametrize("method", ["annealing", "nsga2", "scip"])
def test_whole_values_of_an_integer_are_kept_to(method):
    """Of 0, 3 and 9 between 0.3 and 5 only 3 is left, and it is printed as it is evaluated."""
    whole = var(lower=0.3, upper=5.0, guess=1.5, integer=True, values=(0.0, 3.0, 9.0))
    result = solve(own(ok, whole), method, Budget(evaluations=200))
    assert result.design["a"] == 3 and isinstance(result.design["a"], int)
    assert result.value == 3.0 and result.status in ("optimal", "feasible")


def two(x, p):
    return Terms({"mass": x.a, "loss": 1.0 / x.a})


@pytest.mark.parametrize("method", [None, *METHODS])
def test_two_objectives_are_refused_with_what_to_do(method):
    with pytest.raises(
        SolveError, match=r"2 objectives \(mass, loss\).*weigh them.*make one a limit"
    ):
        solve(own(two), method)


def test_two_objectives_are_refused_everywhere_but_for_a_front():
    with pytest.raises(SolveError, match="2 objectives"):
        gearopt.compare(own(two), methods=("nsga2",), seeds=1, evaluations=20, seconds=0.1)
    with pytest.raises(SolveError, match="2 objectives"):
        gearopt.explain(own(two))
    found, outcome = run(own(two), "nsga2", Budget(evaluations=200))
    assert found.status == "feasible" and len(outcome.others) > 5
    assert nsga2.run(own(two), Budget(evaluations=200), 0, None).others


def test_an_infinite_coefficient_is_named():
    def text(x, p):
        return Terms({"f": 1.0 + (x.a - 1.0) ** 2}, {"g": x.a / p.q})

    problem = own(text, var(), parameters=(Param("q", "", 1.0),))
    assert solve(problem, "qp").status == "optimal"
    with pytest.raises(SolveError, match="g has an infinite coefficient"):
        solve(problem.at(q=0.0), "qp")


def test_other_rows_at_other_parameters_are_an_error():
    def text(x, p):
        return Terms({"f": x.a}, {"g": 1.0 / x.a} if p.on > 0 else {})

    problem = own(text, var(), parameters=(Param("on", "", 1.0),))
    assert solve(problem, "annealing", SHORT["annealing"]).limits
    with pytest.raises(SolveError, match="other rows at other parameters"):
        solve(problem.at(on=-1.0), "annealing")


def test_methods_take_whole_numbers_and_finite_sets_or_name_the_first():
    """As docs/own_problem.md says; nothing proves what the samplers and SCIP answer."""
    count = Var("count", "", 1, 9, 5, integer=True, log=True)
    size = Var("size", "mm", 1.0, 2.0, 1.5, values=(1.0, 1.5, 2.0), log=True)

    def text(x, p):
        return Terms({"sum": x.count + x.size}, {"area": 6.5 / (x.count * x.size)})

    problem = Problem("picked", (count, size), (), text)
    for method in ("annealing", "nsga2", "scip"):
        result = solve(problem, method, Budget(evaluations=1000))
        assert (result.status, result.value, result.bound) == ("feasible", 6.0, None)
    for method in ("ipopt", "multistart", "gp", "qp"):
        with pytest.raises(SolveError, match="count is discrete"):
            solve(problem, method)


@pytest.mark.slow
def test_workers_share_points_and_change_no_answer():
    """A text that raises beyond a = 2.9 and knows no symbols; one or two processes run it."""
    pids = set()

    def simulated(x, p):
        if x.a > 2.9:
            raise RuntimeError(f"too stiff {os.getpid()}")
        return Terms({"f": float((x.a - 1) ** 2 + (x.b - 2) ** 2)}, {"l": float(x.a * x.b / 3)})

    two = (Var("a", "", 0.1, 3.0, 1.5), Var("b", "", 0.5, 3.0, 1.0))
    answers = []
    for workers in (1, 2):
        problem = Problem("simulated", two, (), simulated)
        budget = Budget(evaluations=400)
        result = gearopt.solve(problem, method="nsga2", budget=budget, seed=3, workers=workers)
        words = r"(\d+) of \d+ points failed.*too stiff (\d+)"
        failed, where = re.search(words, result.message).groups()
        answers.append((result.design, result.value, result.evaluations, failed))
        pids.add(int(where) == os.getpid())
    assert answers[0] == answers[1] and pids == {True, False}
    assert not multiprocessing.active_children()
    smooth = Problem("smooth", two, (), lambda x, p: Terms({"f": x.a + x.b}))
    with pytest.raises(SolveError, match="workers=2 changes nothing here"):
        gearopt.solve(smooth, workers=2)
