"""What a search keeps of what it finds, what of it is told, and when it must stop."""

import math
import time

import numpy as np
import pytest

from gearopt.formulations.drive.teeth.progress import MARGIN, TIE, Progress, SearchEnded
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget, Event


def fake(value, *numbers):
    return value, tuple((n, 2 * n) for n in numbers)


def filled(wanted, *found):
    progress = Progress(wanted, Clock())
    progress.add(np.array([v for v, _ in found]), iter([t for _, t in found]))
    return progress


def test_the_best_and_its_ties_are_kept():
    near, far = 1.0 + 0.5 * TIE, 1.0 + 3.0 * TIE
    progress = filled(1, fake(2.0, 9), fake(near, 8), fake(1.0, 7), fake(far, 6))
    assert progress.found == [fake(1.0, 7), fake(near, 8)]
    progress.add(np.array([1.0, near]), iter([((7, 14),), ((5, 10),)]))
    assert progress.found == [fake(1.0, 7), fake(near, 5), fake(near, 8)]
    progress.add(np.array([0.5]), iter([((4, 8),)]))
    assert progress.found == [fake(0.5, 4)]
    edge = 0.5 * (1.0 + TIE)
    progress.add(np.array([edge]), iter([((3, 6),)]))
    assert progress.found == [fake(0.5, 4), fake(edge, 3)]


def test_a_list_keeps_as_many_as_are_wanted():
    progress = filled(2, fake(3.0, 9), fake(1.0, 7), fake(1.0, 6))
    assert progress.found == [fake(1.0, 6), fake(1.0, 7)]
    assert filled(3, fake(3.0, 9)).found == [fake(3.0, 9)]


def test_what_is_pruned_is_above_the_best_by_more_than_rounding():
    assert filled(1).threshold == math.inf
    assert filled(2, fake(1.0, 7)).threshold == math.inf
    assert filled(1, fake(2.0, 7)).threshold == 2.0 * (1.0 + MARGIN)
    assert filled(2, fake(2.0, 7), fake(4.0, 8)).threshold == 4.0 * (1.0 - TIE)


def test_a_bound_counts_where_the_search_is_of_all_trains():
    progress = Progress(1, Clock(), floor=2.0)
    progress.raise_lower(5.0)
    assert (progress.clock.evaluations, progress.compared, progress.nodes) == (0, 0, 0)
    assert Progress(1, Clock()).bound == -math.inf
    assert progress.bound == 2.0
    progress.whole = True
    progress.raise_lower(5.0)
    progress.raise_lower(4.0)
    assert progress.bound == 5.0
    progress.floor = 6.0
    assert progress.bound == 6.0


@pytest.mark.parametrize(
    ("budget", "looked", "seconds", "over"),
    [
        (Budget(), 10**9, 1e9, False),
        (Budget(seconds=5.0), 0, 4.0, False),
        (Budget(seconds=5.0), 0, 5.0, True),
        (Budget(seconds=5.0), 0, 5.5, True),
        (Budget(evaluations=10), 9, 0.0, False),
        (Budget(evaluations=10), 10, 0.0, True),
        (Budget(evaluations=10), 11, 0.0, True),
        (Budget(5.0, 10), 9, 6.0, True),
        (Budget(5.0, 10), 10, 1.0, True),
    ],
)
def test_budgets_end_a_search(budget, looked, seconds, over, monkeypatch):
    seen = []
    progress = Progress(1, Clock(budget, seen.append, 100.0, looked))
    monkeypatch.setattr(time, "perf_counter", lambda: 100.0 + seconds)
    assert progress.continues() is not over and progress.clock.stopped is over
    assert seen == [Event(seconds, looked, None, None)]
    assert Progress(1, Clock()).continues()


def test_a_watcher_is_told_and_stops_a_search():
    seen = []
    progress = filled(1, fake(3.0, 7))
    clock, progress.floor = progress.clock, 2.0
    clock.watch, clock.evaluations = lambda e: seen.append(e), 5
    assert progress.continues() and not progress.clock.stopped  # None is not False
    progress.tick()
    assert [(e.evaluations, e.best, e.bound) for e in seen] == [(5, 3.0, 2.0)] * 2
    progress.add(np.array([3.0 * (1.0 + 0.5 * TIE)]), iter([((8, 16),)]))
    progress.tick()
    assert len(progress.found) == 2 and seen[-1].best == 3.0  # of ties the least
    progress.lower = 3.5  # of what is left; the best train is one of all
    progress.tick()
    assert seen[-1].bound == 3.0
    clock.watch = lambda event: False
    with pytest.raises(SearchEnded):
        progress.tick()
    assert progress.clock.stopped and not progress.enough
    clock.watch = None
    assert not progress.continues()


def test_a_gap_that_is_reached_is_enough():
    for gap, enough in ((0.5, True), (0.25, True), (0.24, False), (0.0, False)):
        progress = filled(1, fake(4.0, 7))
        progress.clock.budget, progress.floor = Budget(gap=gap), 3.0
        assert progress.continues() is not enough and progress.enough is enough
        assert not progress.clock.stopped
    listed = filled(2, fake(4.0, 7), fake(4.0, 8))
    listed.clock.budget, listed.floor = Budget(gap=0.5), 3.0
    assert listed.continues()
    assert Progress(1, Clock(Budget(gap=0.5)), floor=3.0).continues()
    none = filled(1, fake(4.0, 7))
    none.clock.budget, none.floor = Budget(gap=0.0), 4.0
    assert none.continues()  # a gap of nothing is not asked for
