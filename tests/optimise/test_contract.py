"""The contract on small problems of every shape it claims to carry."""

import math

import cvxpy as cp
import numpy as np
import pytest

from gearopt.errors import SolveError
from gearopt.optimise import tape
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.form import form
from gearopt.optimise.methods import back_ends
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import method_of, run, solve
from gearopt.optimise.terms import Param, Repeat, Terms, Var


def box(weight=1.0):
    """Largest box from a surface: min 1/(xyz), 2(xy + yz + zx)/area <= 1; a cube is best."""

    def evaluate(x, p):
        a, b, c = x.side
        surface = 2.0 * (a * b + b * c + c * a)
        return Terms({"inverse_volume": weight / (a * b * c)}, {"surface": surface / p.area})

    sides = Var("side", "m", 1e-3, 1e3, 2.0, size=3, log=True)
    return Problem("box", (sides,), (Param("area", "m2", 6.0),), evaluate)


def test_geometric_program_is_proven_optimal_by_its_dual_bound():
    result = solve(box())
    assert result.status == "optimal"
    assert result.value == pytest.approx(1.0, rel=1e-9)
    assert result.bound <= result.value and result.gap < 1e-9
    assert result.design["side_m"] == pytest.approx([1.0, 1.0, 1.0], rel=1e-6)
    assert result.limits == {"surface": pytest.approx(1.0, abs=1e-9)}


def test_new_parameters_do_not_retrace():
    problem = box()
    calls = []

    def counted(x, p, inner=problem.evaluate):
        calls.append(type(x.side[0]).__name__)
        return inner(x, p)

    problem = Problem("box", problem.variables, problem.parameters, counted)
    for area in (6.0, 24.0, 1.5):
        result = solve(problem.at(area=area))
        assert result.value == pytest.approx((6.0 / area) ** 1.5, rel=1e-8)
        assert result.status == "optimal"
    assert calls.count("SX") == 1
    with pytest.raises(ValueError, match="no parameter 'volume'"):
        problem.at(volume=1.0)


def test_equality_of_a_monomial():
    """min x + y, x y = 4."""
    problem = Problem(
        "sum",
        (Var("x", "", 1e-3, 1e3, 1.0, log=True), Var("y", "", 1e-3, 1e3, 5.0, log=True)),
        (),
        lambda x, p: Terms({"sum": x.x + x.y}, equal={"product": x.x * x.y / 4.0}),
    )
    result = solve(problem)
    assert result.status == "optimal"
    assert result.value == pytest.approx(4.0, rel=1e-10)


def test_linear_variables_with_defines_and_several_report_terms():
    """min t, t an epigraph of max(|x - 1|, |x + 2|): t = 1.5 at x = -0.5."""

    def evaluate(x, p):
        return Terms(
            {"t": x.t},
            defines={
                "over": (1.0 + x.x - 1.0 - x.t + 1.0 - 1.0, 1.0 + 1.0 - x.x - x.t - 0.0),
                "under": (1.0 + x.x + 2.0 - x.t, 1.0 - x.x - 2.0 - x.t),
            },
            report={"x_squared": x.x**2, "pair": (x.x, x.t)},
        )

    problem = Problem(
        "minimax", (Var("x", "", -5, 5, 3.0), Var("t", "", -10, 10, 5.0)), (), evaluate
    )
    result = solve(problem)
    assert result.status == "optimal" and 1.5 - 1e-9 < result.bound <= 1.5
    assert result.value == pytest.approx(1.5, abs=1e-8)
    assert result.limits == {}  # defines are never shown
    assert result.report["x_squared"] == pytest.approx(0.25, abs=1e-6)
    assert set(result.report) == {"x_squared", "pair[1]", "pair[2]"}


def grid(rows=100, width=20):
    """Rows of `width` variables pulled to a_k j, all under one shared ceiling that costs."""
    pull = np.linspace(0.5, 2.0, rows)

    def evaluate(x, p):
        return Terms({"cost": 40.0 * x.ceiling})

    def one_row(x, p, row):
        cost = 0.0
        for j in range(width):
            cost = cost + (x.v[j] - row.pull * (j + 1)) ** 2
        return Terms(
            {"cost": cost},
            {"high": tuple(1.0 + (v - x.ceiling) / 10.0 for v in x.v)},
            report={"first": x.v[0]},
        )

    own = Var("v", "", -100.0, 100.0, 1.0, size=width)
    return pull, Problem(
        "grid",
        (Var("ceiling", "", 0.0, 100.0, 50.0),),
        (),
        evaluate,
        (Repeat("row", (own,), {"pull": pull}, one_row),),
    )


@pytest.mark.slow
def test_mapped_repeat_of_100_rows_by_20_variables():
    """Against the closed form: d/dc [40 c + sum (target - c)+^2] = 0."""
    pull, problem = grid()
    result, outcome = run(problem)
    assert result.status == "optimal"  # a convex quadratic program
    targets = np.outer(pull, np.arange(1, 21)).ravel()
    low, high = 0.0, 50.0
    for _ in range(200):
        c = 0.5 * (low + high)
        low, high = (c, high) if 2.0 * np.maximum(targets - c, 0).sum() > 40.0 else (low, c)
    best = 40.0 * c + (np.maximum(targets - c, 0.0) ** 2).sum()
    assert result.value == pytest.approx(best, rel=1e-9)
    assert result.design["ceiling"] == pytest.approx(c, rel=1e-7)
    values = outcome.x[1:].reshape(100, 20)
    assert np.allclose(values.ravel(), np.minimum(targets, c), atol=1e-6)
    assert len(result.limits) == 2000 and "row.high[3][100]" in result.limits
    assert len(result.report["row.first"]) == 100


def test_batch_traced_and_compiled_agree():
    rng = np.random.default_rng(1)
    for problem in (box(), grid(7, 3)[1]):
        lower, upper, _ = problem.bounds()
        points = rng.uniform(np.maximum(lower, 0.1), np.minimum(upper, 9.0), (5, len(lower)))
        batch = problem.batch(points)
        compiled = problem.compiled()
        terms = problem.traced().terms
        for k, point in enumerate(points):
            f, g, h = (np.array(v).ravel() for v in terms(point, problem.parameter_values()))
            assert np.allclose(batch.F[k], f, rtol=4e-15, atol=0)
            assert np.allclose(batch.G[k], g, rtol=4e-15, atol=1e-15)
            assert batch.H[k].shape == h.shape
            for ours, theirs in zip(compiled(point), (f, g, h), strict=True):
                assert np.array_equal(ours, theirs)
        assert len(problem.rows.inequalities) == batch.G.shape[1]


def test_rows_of_a_repeat_are_named_in_the_order_of_the_arrays():
    _, problem = grid(3, 2)
    names = [r.name for r in problem.rows.inequalities]
    assert names[:3] == ["row.high[1][1]", "row.high[2][1]", "row.high[1][2]"]
    point = np.array([[4.0, 1.0, 2.0, 3.0, 5.0, 6.0, 7.0]])
    values = dict(zip(names, problem.batch(point).G[0], strict=True))
    assert values["row.high[2][2]"] == pytest.approx(1.0 + (5.0 - 4.0) / 10.0)
    assert values["row.high[1][3]"] == pytest.approx(1.0 + (6.0 - 4.0) / 10.0)


def test_log_form_of_a_repeat_is_proven_convex():
    """min sum 1/x_k with shared budget: sum_k w_k x_k <= 1 through rows w_k x_k/s_k."""
    weights = np.array([1.0, 4.0, 9.0])

    def own(x, p, row):
        return Terms({"cost": 1.0 / x.part}, {"share": row.w * x.part / x.total})

    problem = Problem(
        "shares",
        (Var("total", "", 1e-3, 1e3, 1.0, log=True),),
        (),
        lambda x, p: Terms({"cost": 0.1 * x.total}),
        (Repeat("part", (Var("part", "", 1e-6, 1e6, 1.0, log=True),), {"w": weights}, own),),
    )
    assert tape.kinds(problem) == tape.Kinds(tape.POSYNOMIAL, 3 * (tape.MONOMIAL,), ())
    assert form(problem).convex
    result = solve(problem)
    # sum w/s + 0.1 s is least at s = sqrt(10 sum w)
    assert result.status == "optimal"
    assert result.value == pytest.approx(2.0 * math.sqrt(0.1 * weights.sum()), rel=1e-9)


def test_discrete_variables_are_refused_by_ipopt():
    problem = Problem(
        "n", (Var("n", "", 1, 9, 2, integer=True),), (), lambda x, p: Terms({"n": x.n})
    )
    with pytest.raises(SolveError, match="n is discrete"):
        solve(problem, "ipopt")


def test_unknown_method_names_the_known_ones():
    with pytest.raises(SolveError, match="methods: .*ipopt"):
        solve(box(), "simplex")


def test_a_text_that_cannot_be_traced_is_named():
    def evaluate(x, p):
        return Terms({"f": x.a if x.a > 1.0 else 2.0 * x.a})

    problem = Problem("kink", (Var("a", "", 0.5, 2, 1.0, log=True),), (), evaluate)
    with pytest.raises(SolveError, match="the text of kink cannot be traced"):
        solve(problem)


def test_declarations_are_checked():
    with pytest.raises(ValueError, match="lower <= guess <= upper"):
        Var("a", "", 1.0, 2.0, 3.0)
    with pytest.raises(ValueError, match="lower > 0"):
        Var("a", "", 0.0, 2.0, 1.0, log=True)
    with pytest.raises(ValueError, match="identifier"):
        Var("a b", "", 0.0, 2.0, 1.0)
    twice = Var("a", "", 0.0, 2.0, 1.0)
    with pytest.raises(ValueError, match="declared twice"):
        Problem("p", (twice, twice), (), lambda x, p: Terms({"f": x.a}))


def test_names_are_unique():
    one = Var("a", "", 0.0, 2.0, 1.0)
    with pytest.raises(ValueError, match="parameter 'k' is declared twice"):
        Problem(
            "p", (one,), (Param("k", "", 1.0), Param("k", "", 2.0)), lambda x, p: Terms({"f": x.a})
        )
    with pytest.raises(ValueError, match="no variables"):
        Problem("p", (), (), lambda x, p: Terms({"f": 1.0}))
    clash = Problem("p", (one,), (), lambda x, p: Terms({"f": x.a}, {"a": (x.a,), "a[1]": x.a}))
    with pytest.raises(SolveError, match=r"two rows are named 'a\[1\]'"):
        solve(clash)


def test_two_objectives_are_refused_by_a_single_objective_solve():
    problem = Problem(
        "p", (Var("a", "", 0.0, 2.0, 1.0),), (), lambda x, p: Terms({"f": x.a, "g": 1.0 - x.a})
    )
    with pytest.raises(SolveError, match="2 objectives"):
        solve(problem)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (lambda x, p: Terms({"f": x.a}, {"limit": 1.0 < x.a}), "limits limit is no comparison"),
        (lambda x, p: {"f": x.a}, "returns dict, not Terms"),
        (lambda x, p: Terms({"f": x.a}, [x.a]), "limits is not a dict"),
    ],
)
def test_a_text_that_returns_the_wrong_thing_is_named(text, message):
    problem = Problem("wrong", (Var("a", "", 0.5, 2, 1.0),), (), text)
    with pytest.raises(SolveError, match=message):
        solve(problem)


def test_an_undeclared_name_is_answered_with_the_declared_ones():
    problem = Problem(
        "typo", (Var("radius", "", 0.5, 2, 1.0),), (), lambda x, p: Terms({"f": x.radios})
    )
    with pytest.raises(SolveError, match="'radios' here; declared: radius"):
        solve(problem)


def load_sharing():
    """Two springs under a load: a quadratic program."""
    force = Var("force", "N", 0.0, 1e4, 10.0, size=2)
    return Problem(
        "load sharing",
        (force,),
        (),
        lambda x, p: Terms(
            {"energy": x.force[0] ** 2 + 2.0 * x.force[1] ** 2 + x.force[0]},
            equal={"load": (x.force[0] + x.force[1]) / 3000.0},
        ),
    )


def tolerances(integer=False):
    """Cheapest whole or real-valued widths within a sum."""
    t = Var("t", "mm", 1.0, 50.0, 2.0, size=4, integer=integer)
    cost = np.array([1.0, 2.0, 3.0, 4.7])
    return Conic(
        "tolerances",
        (t,),
        (),
        lambda x, p: Terms(
            {"cost": cp.sum(cp.multiply(cost, cp.inv_pos(x.t)))}, {"sum": cp.sum(x.t) / 33.3}
        ),
    )


POSED = {  # problems of each back end, by what a single one of them may go beyond its evaluations
    "annealing": (box, 0),
    "cobyqa": (box, 0),
    "conic": (tolerances, 100),  # whole rounds of Clarabel
    "conic with whole numbers": (lambda: tolerances(integer=True), 4),  # a node's relaxations
    "gp": (box, 0),
    "ipopt": (box, 0),
    "multistart": (box, 0),
    "nsga2": (box, 0),
    "qp": (load_sharing, 0),
    "scip": (box, 0),
    "spatial": (box, 1),  # both parts of a box
}


def test_every_back_end_is_held_to_its_budget():
    assert {name.split(" with ")[0] for name in POSED} == set(back_ends())


@pytest.mark.parametrize("stop", [1, 3])
@pytest.mark.parametrize("name", POSED)
def test_a_back_end_stops_when_its_watcher_says_no(name, stop):
    method, problem, seen = name.split(" with ")[0], POSED[name][0](), []

    def watch(event):
        seen.append(event)
        return len(seen) < stop

    outcome = method_of(problem, method)(problem, Budget(), 0, watch)
    assert 1 <= len(seen) <= stop  # never asked again
    assert outcome.finished == (len(seen) < stop)
    known = seen[-1].best is not None and not outcome.finished
    assert not known or outcome.x is not None  # the best point is kept


@pytest.mark.parametrize(
    ("name", "evaluations"),
    [
        pytest.param(
            n, most, marks=[pytest.mark.slow] * ((n, most) == ("conic with whole numbers", 40))
        )
        for n in POSED
        for most in (1, 40)
    ],
)
def test_a_back_end_keeps_to_its_evaluations(name, evaluations):
    method, (pose, beyond) = name.split(" with ")[0], POSED[name]
    problem, seen = pose(), []
    budget = Budget(evaluations=evaluations)
    outcome = method_of(problem, method)(problem, budget, 0, lambda e: seen.append(e) or True)
    assert outcome.evaluations <= evaluations + beyond
    assert all(a.evaluations <= b.evaluations for a, b in zip(seen, seen[1:], strict=False))


@pytest.mark.parametrize("name", POSED)
def test_without_time_a_back_end_ends_at_once(name):
    method, problem = name.split(" with ")[0], POSED[name][0]()
    outcome = method_of(problem, method)(problem, Budget(seconds=0.0), 0, None)
    assert not outcome.finished
