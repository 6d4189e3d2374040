"""Steps of a front by epsilon constraints: which are taken, and what their answers add."""

import math

import numpy as np
import pytest
from test_front_parts import point, segment, steps_of

from gearopt import Budget, Problem, Repeat, Terms, Var
from gearopt.optimise.pareto import enumerated, epsilon, evolution, scalarised
from gearopt.optimise.pareto.epsilon import Limiting, Line
from gearopt.optimise.pareto.front import Front, FrontPoint
from gearopt.optimise.pareto.gaps import Strip, Tried
from gearopt.optimise.pareto.objectives import Objective
from gearopt.optimise.pareto.tradeoff import found
from gearopt.optimise.result import Outcome, Result


def whole():
    """x and its distance to 9, of whole x."""
    n = Var("x", "", 0, 9, 0, integer=True)
    return Problem("whole", (n,), (), lambda x, p: Terms({"a": x.x, "b": 9.0 - x.x}))


def line_of(problem, *tried, ranges=(1.0, 1.0)):
    """A line between (0, 1) and (1, 0), in parts of its ranges, after steps."""
    run = steps_of(problem)
    run.steps_of("a", {}).extend(tried)
    ends = [point(0.0, ranges[1]), point(ranges[0], 0.0)]
    return Line(run, {}, ends, np.array(ranges))


BACK = Tried(0.2, 1.0, 1.0)  # b = 0.2 is proven to lead back to (1, 0)
LOST = tuple(Tried(0.2 + 0.2 * k, None) for k in range(3))


@pytest.mark.parametrize(
    ("problem", "tried", "limit"),
    [
        (segment, (), 0.5),
        (segment, (BACK,), 0.6),
        (whole, (), 0.5),
        (whole, (BACK,), 1.0 - 5e-7),  # is there any other design?
        (whole, (BACK, Tried(0.9, None)), 0.55),  # the larger part of what is left
        (segment, LOST[:2], 0.7),
        (segment, LOST, None),  # three steps without a result are enough
        (segment, (Tried(1.0 - 1e-9, 1.0, 1.0),), None),
    ],
)
def test_steps_go_into_the_largest_gap(problem, tried, limit, monkeypatch):
    """Two for each point that is sought, where they find none."""
    taken = []
    monkeypatch.setattr(Line, "step", lambda line, most: taken.append(most))
    line = line_of(problem(), *tried)
    line.fill(2)
    assert not taken  # so many points are there
    line.fill(3)
    assert taken == pytest.approx([] if limit is None else [limit] * 6)


@pytest.mark.parametrize(("gain", "count"), [(0.5, 2), (2.0, 3)])
def test_steps_that_miss_much_are_taken_again_the_worst_first(gain, count, monkeypatch):
    """A point is new that is better than its neighbour by a millionth of the range."""
    limits = []

    def solve(run, name, most, near):
        limits.append(most.get("b", math.inf))
        return point(1e3, 200.0) if "b" in most else point(0.5 - gain * 1e-6 * 1e3, 500.0)

    left = [(0.0, 250.0, 0.1), (250.0, 500.0, 0.01), (500.0, math.inf, 0.5)]
    strips = [Strip(low, high, 0.0, missing, 1.0) for low, high, missing in left]
    monkeypatch.setattr(epsilon, "_strips", lambda *_: strips)
    monkeypatch.setattr(epsilon, "_solved", solve)
    line = line_of(segment(), ranges=(1e3, 1e3))
    line.points[0] = point(0.5, 1e3)
    line.repeat()
    assert limits == [math.inf, 250.0] and len(line.points) == count


@pytest.mark.parametrize(
    ("refused", "status", "spent", "asked"),
    [
        ("", "feasible", 0, 2),
        ("No bounds.", "feasible", 0, 1),
        ("", "optimal", 0, 1),
        ("", "feasible", 1000, 1),
    ],
)
def test_an_answer_that_is_proven_or_cannot_be_stands(refused, status, spent, asked, monkeypatch):
    methods = []

    def answer(run, at, method, most):
        methods.append((method, most))
        run.clock.evaluations = spent
        return Result("segment", status, method, {"value": 1.0}), Outcome(np.array([0.5]))

    monkeypatch.setattr(epsilon, "_answered", answer)
    run = steps_of(segment(), evaluations=1000)
    run.refused = refused
    epsilon._proven(run, segment())
    most = None if refused else epsilon.ITERATIONS
    assert methods == [("ipopt", most), ("spatial", epsilon.BOXES)][:asked]


@pytest.mark.parametrize(("finite", "names"), [(True, "ab"), (True, "abc"), (False, "ab")])
def test_designs_that_are_finitely_many_are_stepped_down_one_by_one(finite, names, monkeypatch):
    """Of two objectives; each limit is just below the design before."""
    rest = [point(k, 9 - k) for k in range(3)]
    limits = []

    def solve(run, name, most, near=None):
        limits.append(dict(most))
        if not rest:
            run.skipped.append(epsilon.Impossible(most, True))
        return rest.pop(0) if rest else None

    monkeypatch.setattr(epsilon, "_solved", solve)
    monkeypatch.setattr(epsilon, "_ends", lambda *_: None)
    limiting = Limiting(lambda name, most: segment(), ("b", "c"), whole=finite)
    front = epsilon.front(segment(), names, {}, 0, Budget(), limiting=limiting)
    if not finite or len(names) > 2:
        assert not front.points and not limits
        return
    assert front.complete and len(front.points) == 3
    assert [one.get("b", math.inf) for one in limits] == pytest.approx([math.inf, 9, 8, 7])
    assert all(one["b"] < k for one, k in zip(limits[1:], (9, 8, 7), strict=True))


def test_evolution_takes_no_texts_that_are_repeated(monkeypatch):
    row = Repeat(
        "row", (), {"f": np.array([1.0, 4.0])}, lambda x, p, r: Terms({}, {"g": x.x / r.f})
    )
    text = segment().evaluate
    own = Problem("rows", (Var("x", "", 0.0, 1.0, 0.5),), (), text, (row,))
    monkeypatch.setattr(evolution, "front", lambda *_: pytest.fail("it was asked"))
    assert epsilon._sampled(steps_of(own), own) == ()


def test_weights_are_of_the_ranges_of_the_ends(monkeypatch):
    """Ends (0, 0.25) and (0.5, 0.25): the second objective has no range."""
    taken, reports = [], [(0.0, 0.25), (0.5, 0.25), (0.25, 0.25)]

    def run(*_):
        a, b = reports[len(taken) - 1]
        return Result(
            "segment", "feasible", "annealing", {"value": 1.0}, report={"value_a": a, "value_b": b}
        ), Outcome(np.zeros(1))

    monkeypatch.setattr(scalarised, "weighed", lambda problem, w: taken.append(w.tolist()))
    monkeypatch.setattr(scalarised, "run", run)
    front = scalarised.annealed(segment(), 3, Budget())
    assert taken == [[0, 2], [2, 0], [2.0, 1.0]] and len(front.steps) == 3
    assert [tuple(p.values) for p in front.points] == [(0.0, 0.25)] and len(front.beaten) == 2


@pytest.mark.parametrize(
    ("problem", "most", "status", "proof", "slope", "convex"),
    [
        (segment, {"b": 0.25}, "optimal", "dual", -8.0, True),
        (segment, {"b": 0.25}, "optimal", "spatial", -8.0, False),
        (segment, {"b": 0.25}, "feasible", "dual", -8.0, False),
        (segment, {"a": 0.25}, "optimal", "dual", None, True),
        (segment, {}, "optimal", "dual", None, True),
        (whole, {"b": 0.25}, "optimal", "dual", None, True),
    ],
)
def test_prices_of_limits_are_slopes_of_the_front(
    problem, most, status, proof, slope, convex, monkeypatch
):
    """d a/d b = -2/0.25, as the limit is a quotient; of the first objective alone."""
    result = Result(
        "one",
        status,
        "ipopt",
        {"value": 0.25},
        bound=0.2,
        report={"value_a": 0.25, "value_b": 0.75},
        multipliers={f"most_{name}": -2.0 for name in most},
        proof={"method": proof},
    )
    monkeypatch.setattr(epsilon, "_answered", lambda *_: (result, Outcome(np.array([0.5]))))
    run, name = steps_of(problem()), "b" if "a" in most else "a"
    _, made = epsilon._attempt(run, name, most, None, "ipopt")
    assert made.values.tolist() == [0.25, 0.75] and made.proven == (status == "optimal")
    assert made.bound == (0.2 if name == "a" else None)
    assert made.slopes == (slope and pytest.approx(slope))
    assert run.convex == convex and not run.logarithmic


@pytest.mark.parametrize(
    ("problem", "names", "points", "count"),
    [
        (segment, "ab", None, 60),
        (whole, "ab", None, 0),
        (whole, "aba", None, 400),
        (whole, "ab", 7, 7),
    ],
)
def test_all_designs_are_sought_where_they_are_finitely_many(
    problem, names, points, count, monkeypatch
):
    """Of three objectives 400, in slices; else so many as are asked for, by default 60."""
    asked = []
    monkeypatch.setattr(enumerated, "front", lambda *_: None)
    monkeypatch.setattr(epsilon, "front", lambda *given, **_: asked.append(given[3]))
    found(problem(), names, {}, points=points)
    assert asked == [count]


@pytest.mark.parametrize(
    ("given", "proven", "whole_front"),
    [
        ({"status": "complete"}, False, True),
        ({"status": "proven", "epsilon": 0.1}, True, True),
        ({"status": "proven", "error": 0.1}, True, True),
        ({"status": "proven"}, True, False),
        ({"status": "not proven", "epsilon": 0.1}, False, False),
    ],
)
def test_a_front_is_whole_that_is_complete_or_known_between_its_points(given, proven, whole_front):
    points = FrontPoint((1.0, 2.0), True), FrontPoint((2.0, 1.0), proven)
    goals = Objective("a"), Objective("b")
    assert (
        Front("f", method="epsilon", objectives=goals, points=points, **given).whole == whole_front
    )
