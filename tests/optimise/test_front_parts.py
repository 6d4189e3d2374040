"""The parts of fronts by numbers worked out by hand: picks, gaps, limits, errors, what is said."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import gearopt
from gearopt import Budget, Problem, Terms, Var
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto import epsilon, evolution, scalarised
from gearopt.optimise.pareto.corners import corners, useful
from gearopt.optimise.pareto.found import Found, Point, sifted
from gearopt.optimise.pareto.front import Front, FrontPoint
from gearopt.optimise.pareto.gaps import (
    Gap,
    Strip,
    Tried,
    curve_error,
    gaps,
    met,
    ranked,
    spread,
    strips,
)
from gearopt.optimise.pareto.judged import status, united
from gearopt.optimise.pareto.measures import (
    hypervolume,
    igd,
    knee,
    least_sizes,
    nadir,
    neighbours,
    picks,
    reference,
    scaled,
    unbeaten,
)
from gearopt.optimise.pareto.objectives import Objective, impossible
from gearopt.optimise.pareto.posed import Limit, caps, kept, moved, posed, violation_scale
from gearopt.optimise.pareto.tradeoff import Tradeoff, found, solved
from gearopt.optimise.result import Event, Outcome, Result
from gearopt.optimise.solve import PROVER
from gearopt.optimise.tape import kinds


def point(f, g, slope=None, proven=True, bound=None):
    slopes = None if slope is None else np.array([slope])
    return Point(np.array([f, g]), np.array([float(f), float(g)]), proven, bound, slopes)


def segment():
    """Squares of the distances from 0 and 1, x in [0, 1]: sqrt(a) + sqrt(b) = 1."""
    text = lambda x, p: Terms({"a": x.x**2, "b": (1.0 - x.x) ** 2})  # noqa: E731
    return Problem("segment", (Var("x", "", 0.0, 1.0, 0.5),), (), text)


def steps_of(problem, **budget):
    """The run of a front of a and b, with nothing found so far."""
    return epsilon.Run(problem, ("a", "b"), {}, Clock(Budget(**budget)), None)


def test_picks_are_scaled_by_ideal_and_nadir():
    values = np.array([[10.0, 9.0], [11.0, 5.0], [14.0, 4.0], [20.0, 1.0]])
    assert scaled(values) == pytest.approx(
        np.array([[0.0, 1.0], [0.1, 0.5], [0.4, 0.375], [1.0, 0.0]])
    )
    assert knee(scaled(values)) == 1 and knee(scaled(values)[:2]) is None
    assert knee(np.array([[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]])) is None  # on the line
    found = picks(values, ["mass", "cost"], {"mass": 3.0})
    assert [(p.place, p.rule) for p in found] == [(0, "weights"), (1, "knee"), (3, "compromise")]
    assert [p.weights for p in found] == [(3.0, 0.0), (), ()] and not found[0].decades
    assert picks(np.empty((0, 2)), ["mass", "cost"], None) == []
    assert [p.rule for p in picks(values[:1], ["mass", "cost"], None)] == ["compromise"]
    flat = scaled(np.array([[1.0, 7.0], [3.0, 7.0]]))
    assert flat == pytest.approx(np.array([[0.0, 0.0], [1.0, 0.0]]))
    assert [neighbours(values, k) for k in range(4)] == [[1], [0, 2], [1, 3], [2]]
    cloud = np.random.default_rng(1).random((12, 3))
    places = cloud.argsort(axis=0).argsort(axis=0)
    beside = (np.abs(places[:, None] - places) == 1).any(axis=2)
    assert [neighbours(cloud, k) for k in range(12)] == [np.flatnonzero(b).tolist() for b in beside]


def test_picks_weigh_per_cent_against_per_cent():
    """In powers of two (0, 3), (1, 1), (3, 0): the middle one is nearest to both axes."""
    values = np.array([[1.0, 8.0], [2.0, 2.0], [8.0, 1.0]])
    for unit in ([1.0, 1.0], [1e3, 1e-6]):
        taken = picks(values * unit, ["a", "b"], None)
        assert [(p.place, p.rule) for p in taken] == [(1, "knee"), (1, "compromise")]


def test_no_pick_is_five_times_as_heavy_for_a_tenth_of_the_cost():
    """ln: (0, 0.108), (1.700, 0.029), (2.031, 0): the middle is above the line, the first nearest.

    In the ranges of the objectives the middle one lies at (0.68, 0.26), below the line of (0, 1).
    """
    front = np.array([[63.0, 1140.0], [345.0, 1053.0], [480.0, 1023.0]])
    assert knee(scaled(front)) == 1
    assert [(p.place, p.rule) for p in picks(front, ["mass", "cost"], None)] == [(0, "compromise")]


def test_an_objective_of_many_decades_is_measured_in_them():
    """An error from 1e-9 to 1: in numbers all but the first are alike, and 0 is as good as 1e-9."""
    front = np.array([[12.0, 1.0], [20.0, 1e-3], [24.0, 1e-8], [49.0, 1e-9], [60.0, 0.0]])
    assert scaled(front)[:, 1] == pytest.approx([1.0, 2 / 3, 1 / 9, 0.0, 0.0])
    found = picks(front, ["gear", "error"], None)
    assert [(p.place, p.decades) for p in found] == [(2, ("error",))] * 2
    noise = np.array([[0.0, 1e-17], [1.0, 0.5], [2.0, 1.0]])  # a zero but for rounding
    assert scaled(noise)[:, 1] == pytest.approx([0.0, 0.5, 1.0])
    assert least_sizes(noise).tolist() == [1.0, 0.5]


def test_measures_of_ties_and_flat_fronts():
    tied = np.array([[1.0, 2.0], [1.0 + 1e-10, 2.0], [1.0, 2.0 + 1e-8], [2.0, 1.0]])
    assert unbeaten(tied).tolist() == [0, 3]
    assert unbeaten(tied, equal=True).tolist() == [0, 1, 3]
    assert unbeaten(np.array([[-1.0, 5.0], [-1.0 - 1e-8, 6.0]])).tolist() == [1, 0]
    assert unbeaten(np.array([[-1e9, 3.0], [-1.0, 2.0], [-0.5, 1.0]])).tolist() == [0, 1, 2]
    assert len(unbeaten(np.empty((0, 2)))) == 0 and hypervolume(np.empty((0, 2)), np.ones(2)) == 0
    assert reference(np.array([[4.0, 0.0], [4.0, 0.0]])) == pytest.approx([8.0, 1.0])
    assert reference(np.array([[-3.0, 2.0], [-3.0, 4.0]])) == pytest.approx([0.0, 4.1])
    assert nadir(np.array([[1.0, 5.0], [3.0, 2.0]])) == pytest.approx([3.0, 5.0])
    assert hypervolume(np.array([[1.0, 1.0], [3.0, 0.0]]), np.array([2.0, 2.0])) == 1.0
    assert igd(np.empty((0, 2)), tied) == math.inf
    front = np.array([[10.0, 40.0], [20.0, 20.0]])  # ranges 10 and 20
    assert igd(np.array([[15.0, 40.0], [20.0, 30.0]]), front) == pytest.approx(0.5)
    narrow = np.array([[0.0, 0.5], [0.5, 0.0]])
    assert igd(narrow + [[0.25, 0.0]], narrow) == pytest.approx(0.5)
    assert scaled(narrow) == pytest.approx(2.0 * narrow)
    flat = np.array([[1.0, 5.0], [1.0, 5.0]])
    assert igd(np.array([[3.0, 5.0]]), flat) == pytest.approx(2.0)


def test_a_gap_is_narrowed_by_what_steps_found():
    """Neighbours (0, 10), (1, 3), (9, 0) as (f, g); steps under limits of g."""
    line = [point(9, 0), point(0, 10), point(1, 3), point(1, 4)]
    assert [tuple(p.values) for p in ranked(line)] == [(9, 0), (1, 3), (0, 10)]
    ranges = np.array([9.0, 10.0])
    low, high = gaps(line, [], ranges)
    assert (low.floor, low.top, high.floor, high.top) == (0.0, 3.0, 3.0, 10.0)
    assert low.whole and not low.shut and low.area == 24.0 and high.area == 7.0
    tried = [Tried(2.0, 9.0, 9.0), Tried(1.0, 9.0, 9.0), Tried(6.5, None)]
    low, high = gaps(line, tried, ranges)
    assert (low.floor, low.area, low.whole, low.refused) == (2.0, 8.0, False, ())
    assert (high.floor, high.refused) == (3.0, (6.5,))
    assert low.limit(0.25) == 2.25 and high.limit(0.1) in (4.75, 8.25)
    assert Gap(line[0], line[1], 3.0, (5.0,)).limit(0.1) == 7.5  # the middle of the larger part
    (shut, _) = gaps(line, [Tried(3.0 - 9e-6, 9.0, 9.0 - 8e-6)], ranges)
    assert shut.shut and shut.floor == shut.top
    (still, _) = gaps(line, [Tried(3.0 - 2e-5, 9.0, 9.0)], ranges)
    assert not still.shut
    (other, _) = gaps(line, [Tried(2.0, 9.0)], ranges)  # a step that leads back, but proves nothing
    assert other.whole and other.refused == (2.0,)
    (less, _) = gaps(line, [Tried(2.0, 9.0, 9.0 - 3e-5)], ranges)  # a bound that leaves room
    assert less.whole and less.refused == (2.0,)
    (passed, _) = gaps(line, [Tried(1.0, None), Tried(2.0, 9.0, 9.0)], ranges)
    assert passed.refused == ()  # below what is known to be empty
    assert ranked([]) == []


def test_strips_are_what_the_bounds_of_steps_leave_open():
    """Of points (9, 0), (1, 3), (0, 10) as (f, g), in ranges 9 and 10."""
    values, ranges = np.array([[9.0, 0.0], [1.0, 3.0], [0.0, 10.0]]), np.array([9.0, 10.0])
    tried = [Tried(math.inf, 0.0, 0.0), Tried(0.1, 9.0, 9.0), Tried(3.0, 1.0, 1.0)]
    left = strips(tried, 0.0, math.inf, values, ranges)
    assert [(s.low, s.high, s.bound) for s in left] == [(0, 0.1, 9), (0.1, 3, 1), (3, math.inf, 0)]
    # (9, 0) for the corner (9, 0); (1, 3) for (1, 0.1), and for (0, 3): f is worse by 1
    assert [s.worse for s in left] == pytest.approx([0.0, 0.29, 1 / 9])
    assert [s.missing for s in left] == [0.0, 0.0, 0.0]
    looser = strips([*tried, Tried(2.0, 9.0, 5.0)], 0.0, math.inf, values, ranges)
    assert [s.worse for s in looser] == pytest.approx([0.0, 0.29, 0.1, 1 / 9])
    assert looser[1].missing == pytest.approx(4 / 9)
    near = np.array([[9.0, 2.0 + 5e-6], [1.0, 2.0 + 2e-5]])  # up to 1e-5 counts as at most 2
    assert strips([Tried(2.0, 9.0, 0.0)], 0.0, 2.0, near, ranges)[0].missing == 1.0
    assert strips(tried[1:], 0.0, 20.0, values, ranges)[-1].worse == math.inf  # no step above 3
    assert strips(tried, -math.inf, 9.0, values, ranges)[0].worse == math.inf  # least g not known
    empty = strips([Tried(5.0, None, math.inf), *tried], 0.0, math.inf, values, ranges)
    assert [s.worse for s in empty] == pytest.approx([0.0, 0.0, 0.0, 1 / 9])
    assert [s.missing for s in empty] == [0.0, 0.0, 0.0, 0.0]


def test_errors_are_those_of_tangents():
    # f = 1/g between (1, 1) and (4, 1/4): tangents -1 and -16 meet at g = 0.4, f = 1.6
    hyperbola = [point(1.0, 1.0, -1.0), point(4.0, 0.25, -16.0)]
    u, v = (1.6 - 1.0) / 3.0, (0.4 - 0.25) / 0.75
    assert curve_error(hyperbola, False) == pytest.approx((1.0 - u - v) / math.sqrt(2.0))
    assert curve_error(hyperbola, True) == pytest.approx(0.0, abs=1e-12)
    assert met(hyperbola[1], hyperbola[0]) == pytest.approx([0.8, 0.2])
    ends = [point(1.0, 1.0, 0.0), point(4.0, 0.25, -math.inf)]
    assert curve_error(ends, False) == pytest.approx(1.0 / math.sqrt(2.0))
    assert met(ends[1], ends[0]) == pytest.approx([1.0, 0.0])
    assert met(point(4, 0), point(1, 1)) == pytest.approx([0.5, 0.5])
    assert met(point(4, 0, -6.0), point(1, 1, -9.0)) == pytest.approx([0.5, 0.5])  # outside
    for left in (point(1, 0, -6.0), point(4, 1, -6.0)):  # the same f, the same g
        assert met(left, point(1, 1, -9.0)) == pytest.approx([0.5, 0.5])
    assert curve_error([point(1, 1, -1.0), point(1, 1, -1.0)], False) == 0.0


def test_limits_are_spread_where_the_curve_is_long():
    straight = [point(4, 0), point(1, 2), point(0, 3)]
    limits = spread(gaps(straight, [], np.array([4.0, 3.0])), 2)
    assert sorted(limits) == pytest.approx([2 / 3, 4 / 3])  # a box of 6 against one of 1
    assert len(spread(gaps(straight, [], np.array([4.0, 3.0])), 7)) == 7
    assert spread([], 3) == []
    narrowed = gaps(straight[:2], [Tried(1.0, 4.0, 4.0)], np.array([4.0, 3.0]))
    assert spread(narrowed, 1) == pytest.approx([1.5])


def test_limits_of_objectives_are_quotients_or_differences():
    assert Limit.of(3.0, 9.0) == Limit(3.0, 3.0)
    assert Limit.of(-3.0, 9.0) == Limit(-3.0, 9.0) and Limit.of(-3.0, 1.0) == Limit(-3.0, 3.0)
    assert Limit.of(0.0, 0.0) == Limit(0.0, 1.0) and Limit.of(0.0, 2.0) == Limit(0.0, 2.0)
    text = lambda x, p: Terms({"a": x.x, "b": 5.0 - x.x})  # noqa: E731
    own = Problem("two", (Var("x", "", 0.0, 9.0, 1.0),), (), text)
    limited = posed(own, ["a"], {"b": Limit.of(2.0, 1.0)})
    batch = limited.batch(np.array([[3.0], [4.0]]))
    assert batch.G.ravel() == pytest.approx([1.0, 0.5]) and batch.F.ravel() == pytest.approx([3, 4])
    assert violation_scale(limited, "b") == 2.0 and caps(
        posed(own, ["a", "b"], {"b": Limit(2, 2)})
    ) == {"b": 2}
    signed = moved(posed(own, ["a"], {"b": Limit.of(-2.0, 4.0)}), {"b": Limit(-1.0, 8.0)})
    assert signed.batch(np.array([[2.0]])).G.ravel() == pytest.approx([1.0 + (3.0 + 1.0) / 8.0])
    assert violation_scale(signed, "b") == 8.0 and batch.report["value_b"] == pytest.approx(
        [2.0, 1.0]
    )


def test_limits_of_one_kind_are_one_text_and_quotients_are_log_convex_at_every_limit():
    text = lambda x, p: Terms({"a": x.x, "b": 1.0 / x.x})  # noqa: E731
    methods = {"exact": lambda problem, budget, seed, watch: Outcome(None)}
    own = Problem("two", (Var("x", "", 1.0, 4.0, 2.0, log=True),), (), text, methods=methods)
    built = {}
    steps = [kept(built, own, ["a"], {"b": Limit(*m)}) for m in ((1, 1), (-1, 2), (0, 2))]
    assert len(built) == 2 and [kinds(one).log_convex for one in steps] == [True, False, False]
    again = kept(built, own, ["a"], {"b": Limit(3, 3)})
    assert kinds(again) is kinds(steps[0])  # not read again
    assert not steps[0].methods and posed(own, ["a", "b"], {}).methods == methods


def test_a_front_that_is_known_to_be_empty_has_no_point_by_any_method():
    none = Outcome(None, infeasible=True, message="why")
    problem = impossible("layout", ("a", "b"), none)
    front = found(problem, ("a", "b"), {})
    assert front.infeasible and front.message == "why"
    assert (problem.batch(np.array([[0.0], [0.5], [1.0]])).G > 1.0).all()


def test_corners_below_which_a_point_may_lie():
    left = corners(np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([[4.0, 4.0]]))
    assert sorted(map(tuple, left)) == [(1.0, 4.0), (2.0, 2.0), (4.0, 1.0)]
    bounds = np.array([[2.0, 2.0], [2.1, 1.5], [3.0, 1.0], [math.inf, 0.0], [0.0, 4.1], [4.0, 0.5]])
    assert useful(bounds, left).tolist() == [True, False, True, False, False, True]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"infeasible": True, "complete": True}, "infeasible"),
        ({"complete": True, "finished": False}, "complete"),
        ({"finished": False}, "limit"),
        ({}, "proven"),
        ({"points": (point(1, 2), point(2, 1, proven=False))}, "not proven"),
        ({"points": ()}, "not proven"),
    ],
)
def test_the_status_says_the_least_of_what_is_certain(given, said):
    assert status(Found(**{"points": (point(1, 2),)} | given)) == said


def test_beaten_points_are_set_apart():
    kept, beaten = sifted([point(2, 2), point(1, 1), point(0, 3)])
    assert [tuple(p.values) for p in kept] == [(0, 3), (1, 1)] and beaten.tolist() == [[2, 2]]
    assert sifted([])[0] == ()


@pytest.mark.slow
def test_steps_without_a_result_leave_their_gap_open_and_named(monkeypatch):
    """Of a + b = 1 no step between b = 0.4 and 0.8 has a result."""
    own = epsilon._attempt

    def attempt(run, name, most, near, method):
        if 0.4 < most.get("b", 0.0) < 0.8:
            return SimpleNamespace(status="failed", value=None, bound=None, message=""), None
        return own(run, name, most, near, method)

    monkeypatch.setattr(epsilon, "_attempt", attempt)
    front = gearopt.pareto(segment(), points=5)
    assert front.message == ""
    assert front.status == "proven" and front.epsilon > 0.15 and not front.error
    ((low, high),) = front.unknown
    assert 0.0 <= low <= 0.4 and 0.7 <= high <= 1.0
    second = np.array([p.values[1] for p in front.points])
    assert not ((second > 0.4001) & (second < 0.8)).any() and len(second) == 5


@pytest.mark.parametrize(
    ("left", "unknown"),
    [
        ([(0.0, 1.0, epsilon.OPEN)], ()),  # no more than that is missing
        ([(0.0, 1.0, 0.1), (1.0, 2.0, 0.1)], ((0.0, 2.0),)),
        ([(-math.inf, 1.0, 0.0), (2.0, 3.0, 0.1)], ((-math.inf, 1.0), (2.0, 3.0))),
    ],
)
def test_pieces_that_are_not_known_are_kept_by_their_places(left, unknown):
    run = steps_of(segment())
    strips = [Strip(low, high, 0.0, missing, 0.5) for low, high, missing in left]
    assert epsilon._left_open(run, strips) == unknown


BEST_FOUND = "Not proven: every point is the best one found under its limits"


@pytest.mark.parametrize(
    ("proven", "sample", "said"),
    [
        ((False, False), None, BEST_FOUND + "."),
        ((False,), (point(1, 1),) * 2, BEST_FOUND + ", also from 2 points of evolution."),
        ((True, True), None, "Every point is"),
        ((True, False), None, "1 of 2 points is"),
        ((True, True, False), None, "2 of 3 points are"),
    ],
)
def test_the_proof_of_points_is_one_sentence(proven, sample, said):
    run = steps_of(segment())
    run.sample = sample
    points = tuple(point(k, -k, proven=one) for k, one in enumerate(proven))
    dominates = " proven: no design dominates it by more than 1e-06 of its first objective."
    more = dominates if any(proven) else ""
    assert epsilon._sentence(run, points, False, []) == said + more


@pytest.mark.parametrize(
    ("found", "count"), [((0.25, 0.25), 3), ((0.0, 1.0 - 3e-8), 2), ((1.0 - 1e-7, 0.5), 2)]
)
def test_a_step_adds_no_point_that_is_a_neighbour_of_its_gap(found, count, monkeypatch):
    monkeypatch.setattr(epsilon, "_solved", lambda *_: point(*found))
    line = epsilon.Line(steps_of(segment()), {}, [point(0, 1), point(1, 0)], np.ones(2))
    line.step(0.5)
    assert len(line.points) == count


@pytest.mark.parametrize(
    ("budget", "wanted", "method", "spent"),
    [
        ({}, 0, "ipopt", (None, 300)),
        ({"evaluations": 100}, 0, "ipopt", (None, 100)),
        ({"evaluations": 1000}, 0, "ipopt", (None, 300)),
        ({"seconds": 1e4}, 0, PROVER, (3e3, None)),
        ({"seconds": 1e4}, 60, "ipopt", (500.0, 300)),
    ],
)
def test_a_step_has_three_even_shares_of_the_seconds(budget, wanted, method, spent, monkeypatch):
    """Of ten steps at least, or of the points sought; boxes count where no seconds are named."""
    given = []

    def solve(problem, method, budget, watch):
        given.append(budget)
        return SimpleNamespace(evaluations=7), None

    monkeypatch.setattr(epsilon, "solve_raw", solve)
    run = steps_of(segment(), **budget)
    run.wanted, run.widths = wanted, {"a": 1.0, "b": 1.0}
    epsilon._answered(run, segment(), method, 300)
    seconds, most = spent
    assert given[0].seconds == (seconds and pytest.approx(seconds, rel=1e-3))
    assert given[0].evaluations == most and run.clock.evaluations == 7


@pytest.mark.parametrize(
    ("value", "x", "start"), [(1.0, 0.25, 0.25), (None, 0.25, 0.5), (None, None, 0.5)]
)
def test_a_proof_begins_at_a_point_that_meets_the_limits(value, x, start, monkeypatch):
    """Of its point and that of Ipopt the better one counts, with the bound of the proof."""
    asked = []

    def answer(run, at, method, most):
        asked.append((method, float(at.bounds()[2][0])))
        if method == PROVER:
            return Result("segment", "limit", PROVER, {"value": 2.0}, bound=0.5), Outcome(None)
        place = None if x is None else np.array([x])
        return Result("segment", "feasible", method, {"value": value}), Outcome(place)

    monkeypatch.setattr(epsilon, "_answered", answer)
    result, outcome = epsilon._proven(steps_of(segment()), segment())
    assert asked == [("ipopt", 0.5), (PROVER, start)]
    assert result.value == (value or 2.0) and result.bound == 0.5
    assert outcome.x == (x if value else None)


def test_steps_start_from_neighbours_and_from_evolution_and_the_better_answer_counts(monkeypatch):
    run = steps_of(segment())
    assert epsilon._posed(run, "a", {}, np.array([0.25])).bounds()[2].tolist() == [0.25]
    run.sample = (point(1, 2), point(0, 3))
    assert run.within({"b": 2.0}) == [run.sample[0]] and run.within({"b": 1.9}) == []
    starts = run.started("a", {}), run.started("b", {}), run.started("a", {"b": 1.9})
    assert starts[0] is run.sample[1].x and starts[1] is run.sample[0].x and starts[2] is None
    answers = [point(1, 1), point(2, 1), point(1, 1), None, point(2, 1), point(1, 1)]
    replies = iter(answers)
    reply = lambda *_: (Result("segment", "feasible", "ipopt", {}), next(replies))  # noqa: E731
    monkeypatch.setattr(epsilon, "_attempt", reply)
    for best in (answers[0], answers[2], answers[5]):
        assert epsilon._solved(run, "a", {"b": 2.0}) is best
    assert not run.skipped


@pytest.mark.parametrize(
    ("statuses", "bound"),
    [(("feasible", "feasible"), 0.25), (("feasible", "optimal"), 1.0), (("optimal",), 0.25)],
)
def test_a_step_keeps_the_bound_of_the_answer_that_proves_it(statuses, bound, monkeypatch):
    """Started at the neighbour it is 2, with a bound of 0.25, at the point of evolution 1."""
    asked = []

    def attempt(run, name, most, near, method):
        status, value = statuses[len(asked)], 2.0 - len(asked)
        asked.append((float(near[0]), method))
        found = Result("one", status, "ipopt", {"value": value}, bound=0.25 if value > 1.0 else 1.0)
        return found, point(value, 0.5)

    monkeypatch.setattr(epsilon, "_attempt", attempt)
    run = steps_of(segment())
    run.sample = (point(3, 0), point(4, 0))
    best = epsilon._solved(run, "a", {"b": 0.5}, np.array([0.7]))
    assert asked == [(0.7, None), (3.0, "ipopt")][: len(statuses)]
    assert best.values[0] == 3.0 - len(statuses)
    assert run.steps_of("a", {}) == [Tried(0.5, best.values[0], bound)]
    assert not run.steps_of("b", {}) and not run.skipped


@pytest.mark.parametrize(("limiting", "few"), [(None, 10), (object(), 40)])
def test_a_quarter_of_the_points_come_before_others_are_spread(limiting, few, monkeypatch):
    counts, limits = [], []
    monkeypatch.setattr(epsilon.Line, "fill", lambda line, count: counts.append(count))
    monkeypatch.setattr(epsilon.Line, "step", lambda line, most: limits.append(most))
    monkeypatch.setattr(epsilon.Line, "repeat", lambda line: repeated.append(line))
    for seconds in (None, 10.0):
        run, counts[:], limits[:], repeated = steps_of(segment(), seconds=seconds), [], [], []
        run.limiting, run.widths = limiting, {"a": 1.0, "b": 1.0}
        epsilon._between(run, [point(0, 1), point(1, 0)], 40, {})
        assert counts == [few, 40][: 1 + (few < 40)] and len(limits) == 38 * (few < 40)
        assert len(run.lines) == 1
        assert len(repeated) == (seconds is not None and limiting is None)


def test_a_point_that_breaks_its_limits_is_no_point_of_the_front(monkeypatch):
    failed = SimpleNamespace(status="failed", value=None, evaluations=3)
    solve = lambda *_, **__: (failed, SimpleNamespace(x=np.array([0.5])))  # noqa: E731
    monkeypatch.setattr(epsilon, "solve_raw", solve)
    run = steps_of(segment())
    assert (
        epsilon._attempt(run, "a", {}, None, "ipopt") == (failed, None)
        and run.clock.evaluations == 3
    )


@pytest.mark.parametrize(("most", "spent"), [(1000, 300), (100_000, 2000)])
def test_evolution_has_a_part_of_the_budget_and_its_values_are_not_the_run_s(
    most, spent, monkeypatch
):
    """Three tenths of it, 2000 at most, before steps; half of it before Ipopt improves points."""
    budgets, events = [], []

    def evolve(problem, points, budget, seed, watch):
        budgets.append((points, budget.evaluations))
        watch(Event(0.0, 7, 0.1, None))
        return Found((), evaluations=7)

    monkeypatch.setattr(evolution, "front", evolve)
    assert epsilon._sampled(steps_of(segment(), evaluations=most), segment()) == ()
    front = scalarised.polished(segment(), 8, Budget(evaluations=most), 0, events.append)
    assert budgets == [(0, spent), (8, most // 2)] and front.evaluations == 7
    assert [(e.evaluations, e.best) for e in events] == [(7, None)]


@pytest.mark.parametrize(
    ("points", "weights"), [(2, [[0, 1], [1, 0]]), (3, [[0, 2], [2, 0], [1, 1]])]
)
def test_weighted_sums_are_of_the_ends_first(points, weights, monkeypatch):
    taken = []
    none = SimpleNamespace(value=None, evaluations=1), None
    monkeypatch.setattr(scalarised, "weighed", lambda problem, w: taken.append(w.tolist()))
    monkeypatch.setattr(scalarised, "run", lambda *_: none)
    front = scalarised.annealed(segment(), points, Budget())
    assert taken == weights and front.evaluations == len(weights) and not front.points


@pytest.mark.parametrize(
    ("statuses", "status"),
    [
        (("complete", "complete"), "complete"),
        (("complete", "infeasible"), "complete"),
        (("complete", "proven"), "not proven"),
        (("limit", "proven"), "limit"),
    ],
)
def test_fronts_of_several_problems_are_one(statuses, status):
    """Of (1, 5), (3, 3) and (2, 4), (3, 4) the last is beaten."""
    goals = Objective("a"), Objective("b")
    first, second = ((1.0, 5.0), (3.0, 3.0)), ((2.0, 4.0), (3.0, 4.0))
    fronts = [
        Front(n, s, "epsilon", goals, tuple(FrontPoint(v, True) for v in values), evaluations=4)
        for n, s, values in zip(("two", "three"), statuses, (first, second), strict=True)
    ]
    front = united(fronts, None)
    assert front.name == "two" and [pick.place for pick in front.picks] == [0]
    assert [p.values for p in front.points] == [(1.0, 5.0), (2.0, 4.0), (3.0, 3.0)]
    assert front.beaten == ((3.0, 4.0),) and front.status == status and front.evaluations == 8
    assert {p.proven for p in front.points} == {status == "complete"}


def test_the_proof_of_several_problems_names_each():
    goals = Objective("a"), Objective("b")
    first = Tradeoff(segment(), goals, part="1 stage")
    both = replace(first, others=(replace(first, part="2 stages"),))
    front = solved(both, {}, "nsga2", 4, None, Budget(evaluations=16), 0, None)
    sentence = front.proof["sentence"]
    assert sentence.startswith("1 stage: ") and " 2 stages: " in sentence


def test_a_front_without_designs_claims_none():
    assert epsilon._sentence(steps_of(segment()), (), False, []) == (
        "Not proven: no design was found."
    )


def test_events_of_a_front_are_of_its_first_objective():
    events, goals = [], (Objective("a", "mm"), Objective("b", "kg"))
    given = Tradeoff(segment(), goals), {}, "nsga2", 4, None, Budget(evaluations=8), 0
    front = solved(*given, events.append)
    assert {(e.part, e.unit) for e in events} == {("front", "mm")} and front.evaluations == 8


def test_the_knee_of_three_points_is_the_middle_one():
    assert knee(np.array([[0.0, 1.0], [0.2, 0.2], [1.0, 0.0]])) == 1
    assert knee(np.array([[0.0, 1.0], [1.0, 0.0]])) is None
