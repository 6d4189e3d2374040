"""What a polish starts from, in which order, what it may spend, and what it tells: a solver's word
is a list of answers here.
"""

import math
import time
from types import SimpleNamespace

import numpy as np
import pytest

from gearopt.optimise import polish
from gearopt.optimise.clock import Clock
from gearopt.optimise.polish import Polish, polished, prepared, sampling
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome
from gearopt.optimise.terms import Terms, Var


def mixed(ends=(0.0, 9.0), text=lambda x: {"f": 100.0 + abs(x.n - 4.0) + x.x}, **limits):
    """A set of values, a whole number and a continuous variable; least at n = 4."""
    n = Var("n", "", 0.5, 9.0, 2.0, values=(1.0, 2.0, 4.0, 8.0))
    whole = Var("k", "", 0.5, 3.2, 2, integer=True)
    return Problem(
        "mixed",
        (n, whole, Var("x", "", *ends, (ends[0] + ends[1]) / 2)),
        (),
        lambda x, p: Terms(text(x), {k: v(x) for k, v in limits.items()}),
    )


def at(n, k=2.0, x=5.0):
    return np.array([n, k, x])


@pytest.fixture
def ipopt(monkeypatch):
    """Stands for Ipopt: keeps what it is asked, and gives what `answer` makes of a start."""
    stand = SimpleNamespace(asked=[], events=(), heard=[])
    stand.answer = lambda start: Outcome(start, evaluations=5)

    def run(problem, budget, seed, told, start):
        low, high, _ = problem.bounds()
        assert low[:2].tolist() == high[:2].tolist() == start[:2].tolist()
        stand.asked.append((*start, budget.evaluations))
        stand.heard += [told(event) for event in stand.events]
        return stand.answer(start)

    monkeypatch.setattr(polish.ipopt, "run", run)
    return stand


def last(problem, budget=None, watch=None, skipped=None, ago=0.0):
    clock = Clock(budget or Budget(), watch, time.perf_counter() - ago)
    return Polish(problem, clock, skipped)


def test_a_tenth_of_a_budget_is_kept_and_500_evaluations_at_the_most():
    for given, left in ((1000, 900), (19, 18), (4_999, 4_500), (5_000, 4_500), (80_000, 79_500)):
        own, most = sampling(Clock(Budget(10.0, given)), True)
        assert (own.budget, most) == (Budget(9.0), left)  # the evaluations are its plan
    clock = Clock(Budget(10.0, 1000), lambda event: True, 3.0)
    own, most = sampling(clock, False)
    assert (own.budget, most, own.start, own.watch) == (Budget(10.0), 1000, 3.0, clock.watch)
    assert sampling(Clock(Budget(gap=0.5)), True)[0].budget == Budget()


def test_what_is_not_polished():
    free = mixed()
    assert prepared(free, Clock()).skipped is None
    for problem in (
        mixed(ends=(5.0, 5.0)),
        mixed(text=lambda x: {"f": x.x, "g": -x.x}),
        Problem("whole", (free.variables[1],), (), lambda x, p: Terms({"f": x.k})),
    ):
        assert prepared(problem, Clock()).skipped == ""
    table = mixed(text=lambda x: {"f": np.frexp(x.x)[0]})
    assert prepared(table, Clock()).skipped.startswith("not polished: the text of mixed")
    found = Outcome(at(1.0), message="Ended.")
    assert polished(last(free, skipped="Not."), found, np.empty((0, 3))) == found
    assert polished(last(free, skipped="Not."), Outcome(None), np.empty((0, 3))).message == "Not."


def test_the_starts_and_their_neighbours(ipopt):
    """The first of each choice, the sampler's own, then one value up or down of the best's."""
    starts = np.array([at(1.0), at(1.0, x=6.0), at(2.0), at(1.0, 1.0)])
    sampled = Outcome(at(2.0, x=5.5), evaluations=100, message="Ended.")
    found = polished(last(mixed()), sampled, starts)
    runs = [(1, 2, 5), (2, 2, 5), (1, 1, 5), (2, 2, 5.5)]
    runs += [(4, 2, 5), (2, 1, 5), (2, 3, 5)]  # beside (2, 2, 5); (1, 2) is tried
    runs += [(8, 2, 5), (4, 1, 5), (4, 3, 5)]  # beside (4, 2, 5)
    assert [(n, k, x) for n, k, x, _ in ipopt.asked] == runs
    assert [left for *_, left in ipopt.asked] == [2000 - 5 * k for k in range(10)]
    assert found.x.tolist() == [4.0, 2.0, 5.0] and found.evaluations == 150
    assert found.finished and found.message == ""


def test_five_choices_are_started_from(ipopt):
    starts = np.array([at(n, k) for n in (1.0, 2.0, 4.0) for k in (1.0, 2.0, 3.0)])
    polished(last(mixed()), Outcome(None), starts)
    assert [tuple(a[:2]) for a in ipopt.asked[:5]] == [(1, 1), (1, 2), (1, 3), (2, 1), (2, 2)]
    assert tuple(ipopt.asked[5][:2]) != (2, 3) and polish.STARTS == 5


def test_a_polish_has_an_end(ipopt, monkeypatch):
    """By runs, by iterations, by the budget: all of them are its own; else it was stopped."""
    starts = np.array([at(n) for n in (1.0, 2.0, 4.0, 8.0)])
    sampled = Outcome(None, evaluations=100, infeasible=True)
    monkeypatch.setattr(polish, "RUNS", 2)
    found = polished(last(mixed()), sampled, starts)
    assert len(ipopt.asked) == 2 and found.finished and not found.infeasible
    monkeypatch.setattr(polish, "RUNS", 60)
    ipopt.asked.clear()
    monkeypatch.setattr(polish, "ITERATIONS", 10)
    found = polished(last(mixed()), sampled, starts)
    assert [a[-1] for a in ipopt.asked] == [10, 5] and found.evaluations == 110
    ipopt.asked.clear()
    ipopt.answer = lambda start: Outcome(start, finished=len(ipopt.asked) < 3, evaluations=5)
    found = polished(last(mixed(), Budget(evaluations=115)), sampled, starts)
    assert [a[-1] for a in ipopt.asked] == [15, 10, 5] and found.finished
    ipopt.asked.clear()
    found = polished(last(mixed(), Budget(evaluations=150)), sampled, starts)
    assert len(ipopt.asked) == 3 and not found.finished
    ipopt.answer = lambda start: Outcome(start, evaluations=5)
    stopped = Outcome(at(1.0), finished=False)
    assert not polished(last(mixed()), stopped, starts).finished
    assert polished(last(mixed(), Budget(evaluations=100)), sampled, starts).evaluations == 100


def test_the_best_feasible_point_is_the_answer(ipopt):
    """By 1e-8 in the limits; a tie stays with the sampler."""
    problem = mixed(limit=lambda x: 1.0 + (5.0 - x.x))
    sampled = Outcome(at(4.0, x=6.0), message="Ended.")
    for x, better in ((6.0, False), (5.5, True), (5.0 - 0.9e-8, True), (5.0 - 1.1e-8, False)):
        ipopt.answer = lambda start, x=x: Outcome(np.array([*start[:2], x]), message="Ipopt.")
        found = polished(last(problem), sampled, np.empty((0, 3)))
        assert (found.x[2], found.message) == ((x, "") if better else (6.0, "Ended."))
    nothing = mixed(text=lambda x: {"f": np.log(x.x - 9.0)})
    ipopt.answer = lambda start: Outcome(start)
    assert polished(last(nothing), Outcome(at(1.0)), np.empty((0, 3))).x.tolist() == [1, 2, 5]
    half = mixed(text=lambda x: {"f": np.sqrt(x.x - 5.0)})  # no number is worse than any
    ipopt.answer = lambda start: Outcome(at(1.0, x=6.0))
    assert polished(last(half), Outcome(at(1.0, x=4.0)), np.empty((0, 3))).x[2] == 6.0
    ipopt.answer = lambda start: Outcome(None, infeasible=True)
    nothing = polished(last(problem), Outcome(None, infeasible=True), np.array([at(1.0)]))
    assert nothing.x is None and not nothing.infeasible


def test_the_ends_of_a_set_have_one_neighbour(ipopt):
    low = mixed(text=lambda x: {"f": x.n + x.x})
    polished(last(low), Outcome(at(1.0, 1.0)), np.empty((0, 3)))
    assert {tuple(a[:2]) for a in ipopt.asked} == {(1, 1), (2, 1), (1, 2)}
    ipopt.asked.clear()
    high = mixed(text=lambda x: {"f": 90.0 - x.n - x.k + x.x})
    polished(last(high), Outcome(at(8.0, 3.0)), np.empty((0, 3)))
    assert {tuple(a[:2]) for a in ipopt.asked} == {(8, 3), (4, 3), (8, 2)}


def test_a_watcher_is_told_of_the_whole_run(ipopt):
    heard = []
    ipopt.events = (Event(0.0, 3, 104.0), Event(1.0, 4, None), Event(1.0, 4, 103.0))
    watch = lambda event: heard.append(event)  # noqa: E731
    sampled = Outcome(at(4.0, x=5.0), evaluations=100)
    few = Budget(evaluations=110)
    polished(last(mixed(), few, watch, ago=50.0), sampled, np.array([at(2.0, x=6.0)]))
    assert [e.evaluations for e in heard] == [103, 104, 104, 108, 109, 109]
    assert [e.best for e in heard[:3]] == [104.0, 104.0, 103.0]
    assert 50.0 <= heard[0].seconds <= heard[1].seconds < 60.0
    assert ipopt.heard == [True] * 6
    ipopt.heard.clear()
    heard.clear()
    polished(last(mixed(), few, watch), Outcome(None), np.array([at(2.0)]))
    assert [e.best for e in heard[:3]] == [104.0, 104.0, 103.0]
    for answer in (None, True, False):
        ipopt.heard.clear()
        polished(last(mixed(), few, lambda e, a=answer: a), sampled, np.empty((0, 3)))
        assert ipopt.heard[0] is (answer is not False)
    ipopt.heard.clear()
    polished(last(mixed(), few), sampled, np.empty((0, 3)))
    assert ipopt.heard[0] is True


def test_without_time_nothing_is_run(ipopt):
    late = last(mixed(), Budget(seconds=1.0), ago=1.5)
    found = polished(late, Outcome(at(1.0), evaluations=7), np.array([at(2.0)]))
    assert ipopt.asked == [] and not found.finished and found.x.tolist() == [1.0, 2.0, 5.0]
    assert found.evaluations == 7 and math.isclose(polish.SHARE, 0.1)
    polished(last(mixed(), Budget(seconds=60.0)), Outcome(at(1.0)), np.empty((0, 3)))
    assert len(ipopt.asked) > 1
