"""Repairs, conflicts and sensitivities of problems of one's own, against closed forms."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from gearopt import Param, Problem, Repeat, SolveError, Terms, Var, explain
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.halving import DOUBTS, Bracket, middles, take
from gearopt.optimise.explaining.handles import handles
from gearopt.optimise.explaining.repair import elastic, least
from gearopt.optimise.result import Budget, Outcome

# A bar of diameter d under a force F: least d^2 with 4 F S/(pi d^2 s) <= 1 and d <= D.
F, STRESS, SAFETY = 1.0e4, 100.0, 1.5
NEEDED = math.sqrt(4 * F * SAFETY / (math.pi * STRESS))  # 13.82 mm

STEEL = Param("stress", "MPa", STRESS, role="data")


def bar(most=10.0, power=1.0, role="limit"):
    """The safety factor enters the row to a power; d <= most is written as a bound."""

    def evaluate(x, p):
        stress = 4 * F * p.safety**power / (math.pi * x.d**2 * p.stress)
        return Terms({"area": x.d**2}, {"stress": stress})

    parameters = (
        Param("safety", "", SAFETY ** (1 / power), role=role, key="limits.safety"),
        STEEL,
    )
    variables = (Var("d", "mm", 1.0, most, min(5.0, most), log=True),)
    return Problem("bar", variables, parameters, evaluate)


@pytest.mark.slow
def test_of_two_conflicts_no_limit_resolves_both():
    """x <= 1 against x >= 2, and the same of y: dropping one limit leaves the other pair."""

    def evaluate(x, p):
        limits = {"x stress": p.needed / x.x, "y stress": p.needed / x.y}
        return Terms({"area": x.x * x.y}, limits)

    pair = tuple(Var(n, "mm", 0.1, 1.0, 0.5, log=True) for n in "xy")
    found = explain(Problem("two", pair, (Param("needed", "mm", 2.0),), evaluate))
    assert len(found.conflict) == 2 and len({n[0] for n in found.conflict}) == 1
    assert found.any_resolves is False


@pytest.mark.slow
def test_a_bound_and_a_safety_factor_that_enters_squared():
    """Either d <= 13.82, or the safety factor whose square is 1.5/1.91."""
    found = explain(bar(power=2.0))
    assert found.result.status == "infeasible"
    assert set(found.conflict) == {"stress", "d upper"} and found.any_resolves
    even = {r.what: r for r in found.remedies}
    ratio = NEEDED / 10.0
    assert even["d upper"].bound == pytest.approx(ratio, rel=1e-9)
    assert float(even["d upper"].changes[0].write) == pytest.approx(NEEDED, rel=1e-5)
    (change,) = even["stress"].changes
    assert change.key == "limits.safety"  # S^2 falls by ratio^2, so S by ratio
    assert float(change.write) == pytest.approx(math.sqrt(SAFETY) / ratio, rel=1e-5)
    assert even["stress"].bound == pytest.approx(ratio, rel=1e-9)
    for remedy in found.remedies:
        assert remedy.verified == {"with": "optimal", "with_less": "infeasible"}
    data = json.loads(found.to_json())
    assert data["explanation"] == 1 and data["result"]["status"] == "infeasible"
    assert data["remedies"][0]["changes"][0]["write"]
    keyless = replace(bar(power=2.0), parameters=(Param("safety", "", 1.2, role="limit"), STEEL))
    found = {r.what: r.changes[0].key for r in explain(keyless).remedies}
    assert found["stress"] == "safety"  # the number to write, not its row


def test_a_row_without_a_parameter_is_relaxed_itself():
    """Its factor is the utilisation up to which it must be allowed: (13.82/10)^2."""
    found = explain(bar(role="data"))
    (row,) = (r for r in found.remedies if r.what == "stress")
    assert row.bound == pytest.approx((NEEDED / 10.0) ** 2, rel=1e-9)


def test_what_is_given_moves_only_when_limits_do_not_help():
    fixed = bar(most=10.0, role="data")
    (d,) = fixed.variables
    given = Problem("bar", (Var("d", "mm", 10.0, 10.0, 10.0, log=True),), *_rest(fixed))
    kinds = {h.name: h.given for h in handles(given)}
    assert kinds == {"stress": False, "d": True} and d.upper == 10.0
    assert explain(given).remedies[0].what == "stress"


def _rest(problem):
    return problem.parameters, problem.evaluate


def test_least_repair_is_sparse_and_its_product_is_proven():
    """x1 x2 x3 >= 1000 with x <= 5 each: the product must grow by 8, in one bound alone."""

    def evaluate(x, p):
        return Terms({"sum": sum(x.x)}, {"product": p.product / (x.x[0] * x.x[1] * x.x[2])})

    product = Param("product", "", 1000.0)
    box = (Var("x", "", 1.0, 5.0, 2.0, 3, log=True),)
    problem = Problem("boxes", box, (product,), evaluate)
    movable = [h for h in handles(problem) if h.name.startswith("x")]
    repair = least(problem, movable, Clock(Budget()))
    assert len(repair.moves) == 1
    assert repair.factor == pytest.approx(8.0, rel=1e-9)
    assert repair.bound == pytest.approx(8.0, rel=1e-9)


def test_signed_rows_and_bounds_below_zero():
    """x >= 2 is asked of x <= -1: no logarithms, so branch and bound proves what suffices."""

    def evaluate(x, p):
        return Terms({"square": x.x**2}, {"reach": 1 + (2.0 - x.x) / 4.0})

    explained = explain(Problem("signed", (Var("x", "", -5.0, -1.0, -2.0),), (), evaluate))
    assert explained.result.value is None and explained.conflict == ("reach", "x upper")
    written = {r.what: float(r.changes[0].write) for r in explained.remedies}
    assert written == {"reach": pytest.approx(1.75, 1e-5), "x upper": pytest.approx(2.0, 1e-5)}
    assert {r.verified["with_less"] for r in explained.remedies} == {"infeasible"}


@pytest.mark.slow
def test_repeats_share_one_factor():
    def evaluate(x, p):
        return Terms({"d": x.d})

    def row(x, p, r):
        return Terms({}, {"load": r.load / (x.d * p.allowed)})

    loads = {"load": np.array([2.0, 8.0, 4.0])}
    problem = Problem(
        "loads",
        (Var("d", "mm", 0.1, 2.0, 1.0, log=True),),
        (Param("allowed", "", 2.0, role="limit"),),
        evaluate,
        (Repeat("speed", (), loads, row),),
    )
    found = explain(problem)
    assert set(found.conflict) == {"allowed", "d upper"}
    even = {r.what: r.bound for r in found.remedies}
    assert even["allowed"] == pytest.approx(2.0, rel=1e-9)
    assert even["d upper"] == pytest.approx(2.0, rel=1e-9)


@pytest.mark.slow
def test_rows_of_a_repeat_are_one_limit():
    """Load 8 needs d = 8: neither the other rows nor the lower bound of d have a part in that."""

    def row(x, p, r):
        return Terms({}, {"load": r.load / x.d})

    loads = {"load": np.array([1.0, 3.0, 8.0])}
    d = Var("d", "mm", 1.0, 5.0, 2.0, log=True)
    repeat = Repeat("speed", (), loads, row)
    found = explain(Problem("loads", (d,), (), lambda x, p: Terms({"d": x.d}), (repeat,)))
    assert set(found.conflict) == {"speed.load", "d upper"}
    assert {r.what: round(r.bound, 9) for r in found.remedies} == {
        "speed.load": 1.6,
        "d upper": 1.6,
    }


@pytest.mark.slow
def test_a_parameter_without_effect_at_the_guess_is_still_the_limit():
    """(x/S)^2 <= 1 at x = 0: no slope there, but S is what must be written."""

    def evaluate(x, p):
        return Terms({"x": x.x}, {"reach": (x.x / p.S) ** 2, "need": 1 + (3.0 - x.x) / 4.0})

    least_s = Param("S", "", 2.0, role="limit", key="limits.S")
    problem = Problem("guess", (Var("x", "", -5.0, 5.0, 0.0),), (least_s,), evaluate)
    keys = {c.key: float(c.write) for r in explain(problem).remedies for c in r.changes}
    assert keys["limits.S"] == pytest.approx(3.0, rel=1e-5)


def test_an_objective_of_zero_or_below():
    """min x - 1 over x >= a: 0 at a = 1 (no relative price), -0.5 at a = 0.5."""
    problem = Problem(
        "shifted",
        (Var("x", "", 0.0, 5.0, 2.0),),
        (Param("a", "", 1.0, role="limit"),),
        lambda x, p: Terms({"x": x.x - 1.0}, {"least": 1 + (p.a - x.x)}),
    )
    assert all(i.price is None for i in explain(problem.at(a=1.0)).influences)
    (below,) = explain(problem.at(a=0.5)).influences
    assert below.price == pytest.approx(-0.01, rel=1e-6)  # easing is better, so negative
    assert below.sensitivity == pytest.approx(1.0, rel=1e-9)
    assert below.resolved == pytest.approx((1.0, 1.0), rel=1e-2)


def test_a_misspelt_role_is_refused():
    with pytest.raises(ValueError, match="no role 'limt'"):
        Param("S", "", 1.0, role="limt")


def test_sensitivities_against_the_closed_form():
    """Area = 4 F S/(pi s): +1 in S, -1 in s; the bound d <= 50 costs nothing."""
    found = explain(bar(most=50.0))
    slope = {i.key: i for i in found.influences}
    assert slope["limits.safety"].sensitivity == pytest.approx(1.0, abs=1e-9)
    assert slope["stress"].sensitivity == pytest.approx(-1.0, abs=1e-9)
    assert slope["stress"].resolved == pytest.approx((-1.0, -1.0), abs=1e-6)
    assert slope["limits.safety"].step == "-1%"
    assert slope["limits.safety"].price == pytest.approx(-0.01, abs=1e-9)
    assert found.binding == ("stress",)


def test_discrete_problems_are_refused_by_name():
    problem = Problem("whole", (Var("z", "", 1, 9, 5, integer=True),), (), lambda x, p: None)
    with pytest.raises(SolveError, match="z is discrete"):
        elastic(problem, [])


def test_a_parameter_at_the_end_of_what_the_text_takes_is_probed_on_one_side():
    """An efficiency of 1 in sqrt(1 - eta^2): nothing above it, an infinite slope."""
    eta = Param("eta", "", 1.0)

    def evaluate(x, p):
        return Terms({"c": x.x + 0.1 * np.sqrt(1.0 - p.eta**2)}, {"m": 1.0 / x.x})

    (found,) = explain(Problem("end", (Var("x", "", 0.1, 10.0, 2.0),), (eta,), evaluate)).influences
    assert found.sensitivity is None
    assert found.resolved[0] is not None and found.resolved[1] is None


def bars(most, largest):
    """Least section n d^2 of n whole bars, n d^2 >= 150, n and d up to a most."""

    proof = {"method": "closed form", "sentence": "Proof: a closed form."}

    def exact(problem, budget, seed, watch):
        (need,), upper = problem.parameter_values(), problem.bounds()[1]
        n = math.ceil(need / upper[1] ** 2 - 1e-9)
        if n > upper[0]:
            return Outcome(None, infeasible=True, proof=proof)
        x = np.array([n, math.sqrt(need / n)])
        return Outcome(x, bound=need * (1.0 - 1e-12), proof=proof)

    def evaluate(x, p):
        section = x.n * x.d**2
        return Terms({"section": section}, {"load": p.load / section})

    n = Var("n", "", 1, most, 1, integer=True, key=("", "bars.most"))
    d = Var("d", "mm", 0.01, largest, 1.0, log=True, key=("", "bars.diameter"))
    load = Param("load", "", 150.0, role="limit", key="bars.load")
    return Problem("bars", (n, d), (load,), evaluate, methods={"exact": exact})


def test_a_discrete_problem_with_an_exact_method_is_explained():
    """Four bars of 5 mm hold 100: six bars, 6.124 mm, or 100; each tried by the method itself."""
    found = explain(bars(4, 5.0))
    assert found.result.status == "infeasible"
    writes = {r.changes[0].key: float(r.changes[0].write) for r in found.remedies}
    assert writes["bars.most"] == 6.0
    assert writes["bars.diameter"] == pytest.approx(math.sqrt(150.0 / 4.0), rel=1e-3)
    assert writes["bars.load"] == pytest.approx(100.0, rel=1e-3)
    for remedy in found.remedies:
        assert remedy.verified == {"with": "optimal", "with_less": "infeasible"}


def test_slopes_of_a_discrete_problem_hold_its_whole_numbers():
    slopes = {i.key: i for i in explain(bars(8, 5.1)).influences}
    assert slopes["bars.load"].sensitivity == pytest.approx(1.0, abs=1e-9)
    assert slopes["bars.load"].resolved == pytest.approx((1.0, 1.0), abs=1e-6)
    assert slopes["bars.diameter"].sensitivity == 0.0 and slopes["bars.diameter"].price == 0.0


def test_a_bound_with_a_key_is_priced():
    """Area d^2 to be the least with d >= 20: slope 2, and 1 % less is eased."""

    def evaluate(x, p):
        return Terms({"area": x.d**2}, {"need": 1.0 / x.d})

    d = Var("d", "mm", 20.0, 50.0, 30.0, log=True, key="bar.diameter")
    found = {i.key: i for i in explain(Problem("bar", (d,), (), evaluate)).influences}
    lower, upper = found["bar.diameter[1]"], found["bar.diameter[2]"]
    assert lower.sensitivity == pytest.approx(2.0, abs=1e-9)
    assert lower.resolved == pytest.approx((2.0, 2.0), abs=1e-6)
    assert lower.step == "-1%" and lower.price == pytest.approx(0.99**2 - 1.0, abs=1e-9)
    assert upper.sensitivity == 0.0 and upper.price == 0.0


@pytest.mark.parametrize("least", [1.0, 1.003, 1.05, 1.4, 2.5])
@pytest.mark.parametrize("band", [1.0, 1.0001, 1.01, 1.3, 3.0])
def test_undecided_factors_are_not_known_to_do_and_few_are_tried(least, band):
    """A factor that suffices from `least` on, undecided a factor `band` below that."""
    known, undecided = Bracket(1.0, 4.0), 0
    for factor in middles(known, 1.0005):
        answer = True if factor >= least else (None if factor * band > least else False)
        undecided += answer is None
        take(known, factor, answer)
    close = 1.0006 if band <= 1.0001 else (1.05 if band < 1.1 else 1.7)
    assert least <= known.high <= least * close
    assert undecided <= DOUBTS
