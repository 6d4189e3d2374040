"""Methods that a problem brings itself: their names, how they are called, what they may return."""

from dataclasses import replace

import numpy as np
import pytest

import gearopt
from gearopt import Event, Outcome, Problem, SolveError, Terms, Var, solve


def square(**methods):
    """x^2 on [1, 3]: 1 at x = 1."""
    x, text = Var("x", "", 1.0, 3.0, 2.0), lambda x, p: Terms({"y": x.x**2})
    return Problem("square", (x,), (), text, methods=methods)


def returning(outcome):
    return square(mine=lambda problem, budget, seed, watch: outcome)


def test_an_own_method_may_always_call_its_watch():
    told = []

    def mine(problem, budget, seed, watch):
        told.append(watch(Event(0.0, 1, 4.0)))
        return Outcome(np.array([1.0]))

    assert solve(square(mine=mine)).value == 1.0
    made = gearopt.compare(square(mine=mine), methods=["mine"], seeds=1, seconds=0.01)
    assert made.groups[0].best == 1.0
    gearopt.compare(square(mine=mine), methods=["mine"], seeds=1, seconds=0.01, bound_from="mine")
    assert all(told) and len(told) == 1 + 4 + 5
    assert solve(square(mine=mine), watch=lambda event: False).value == 1.0 and not told[-1]


@pytest.mark.parametrize(
    ("methods", "words"),
    [
        ({"ipopt": print}, "'ipopt' is a method of gearopt itself; give your own another name"),
        ([print], "methods are a dict of functions.*not list"),
        (None, "methods are a dict of functions.*not NoneType"),
        ({"mine": 3}, "methods has 'mine': int; write a name and a function run"),
        ({3: print}, "methods has 3: "),
    ],
)
def test_methods_are_functions_by_names_of_their_own(methods, words):
    with pytest.raises(ValueError, match=f"problem square: {words}"):
        replace(square(), methods=methods)


@pytest.mark.parametrize(
    ("outcome", "words"),
    [
        (None, r"NoneType; return Outcome\(x\), or Outcome\(None\)"),
        (np.ones(1), "ndarray; return Outcome"),
        (Outcome(np.ones(2)), r"a point of the shape \(2,\); .* in order, \(1,\)"),
        (Outcome(1.0), r"a point of the shape \(\)"),
        (Outcome([[1.0]]), r"a point of the shape \(1, 1\)"),
        (Outcome("a"), "a point of str"),
        (Outcome({"x": 1.0}), "a point of dict"),
        (Outcome([np.nan]), "a point with NaN in it"),
        (Outcome([1.0], others=([1.0, 2.0],)), r"a point of the shape \(2,\)"),
        (Outcome([1.0], bound=1.0), "a bound without its proof; a bound counts only with its"),
        (Outcome([1.0], bound=1.0, proof={"method": "all"}), "a bound without its proof"),
        (Outcome([1.0], bound=1.0, proof="looked at all"), "the proof 'looked at all'; a bound"),
        (Outcome([1.0], bound=1.0, proof={"sentence": 3}), "a proof whose sentence is 3"),
        (Outcome([1.0], bound="low", proof={"sentence": "All."}), "the bound 'low'"),
        (Outcome([1.0], bound=np.nan, proof={"sentence": "All."}), "the bound nan"),
        (
            Outcome(None, infeasible=True, proof={"method": "all"}),
            "infeasible with a proof without a sentence",
        ),
    ],
)
def test_what_an_own_method_returns_is_held_to_its_sort(outcome, words):
    with pytest.raises(SolveError, match=f"the method 'mine' of square returns {words}"):
        solve(returning(outcome))


def test_a_list_is_a_point_and_a_bound_with_a_sentence_is_proven():
    proof = {"method": "corner", "sentence": "Proof: the square rises from 1 on."}
    found = solve(returning(Outcome([1], bound=1.0, proof=proof)))
    assert found.status == "optimal" and found.design == {"x": 1.0}
    assert solve(returning(Outcome(None))).status == "failed"
