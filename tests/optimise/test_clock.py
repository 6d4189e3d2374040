"""Events of a run of many parts: named, in the unit that is shown, on one clock."""

import time
from dataclasses import replace
from itertools import pairwise
from random import Random

import gearopt
from gearopt import Budget, Problem, Terms, Var
from gearopt.optimise.clock import Clock, in_part, of_others, of_problem, whole
from gearopt.optimise.result import Event, Outcome


def seen(make):
    """What a watcher is told, and the watcher to tell it to."""
    events = []
    return events, make(lambda event: events.append(event) or True)


def test_no_watcher_stays_none():
    assert in_part(None, "kg") is of_others(None) is whole(None) is None
    assert of_problem(None, square()) is None


def test_random_runs_of_many_parts_are_told_in_order():
    """Searches that begin anew: their clocks, counts, best values and bounds fall back."""
    random = Random(3)
    for _ in range(50):
        events, watch = seen(whole)
        spent = 0
        for part in random.choices(("a", "b", "c"), k=6):
            count, best, bound = 0, 10.0, -10.0
            for _ in range(random.randint(1, 5)):
                count += random.randint(0, 9)
                best, bound = best - random.random(), bound + random.random()
                watch(Event(random.random(), count, best, bound, part))
            spent += count
        assert all(
            a.seconds <= b.seconds and a.evaluations <= b.evaluations for a, b in pairwise(events)
        )
        assert events[-1].evaluations <= spent
        for part in "abc":
            own = [e for e in events if e.part == part]
            assert all(a.best >= b.best and a.bound <= b.bound for a, b in pairwise(own))


def test_counts_of_parts_add_up():
    events, watch = seen(whole)
    for part, counts in (("a", (5, 9)), ("b", (0, 4)), ("c", (3,))):
        for count in counts:
            watch(Event(0.0, count, part=part))
    assert [e.evaluations for e in events] == [5, 9, 9, 13, 16]


def test_values_are_told_in_the_unit_that_is_shown():
    events, watch = seen(lambda told: in_part(told, "Nm", "ratio", 1e-3))
    watch(Event(1.0, 2, 3000.0, None, "x", "torque"))
    watch(Event(1.0, 2, None, 0.0, "x", "torque"))
    assert events[0] == Event(1.0, 2, 3.0, None, "ratio", "torque", "Nm")
    assert events[1] == Event(1.0, 2, None, 0.0, "ratio", "torque", "Nm")


def test_changed_problems_tell_no_values():
    events, watch = seen(of_others)
    watch(Event(1.0, 2, 3.0, 1.0, "sizing", "mass", "kg"))
    assert events == [Event(1.0, 2, part="other numbers")]


def test_a_watcher_ends_a_run_through_every_layer():
    def stop(event):
        return False

    layers = whole(in_part(of_others(of_problem(stop, square())), "kg"))
    assert layers(Event(0.0, 0)) is False


def square():
    return Problem("square", (Var("x", "", 1.0, 3.0, 2.0),), (), lambda x, p: Terms({"y": x.x**2}))


def test_events_of_an_own_problem_name_it():
    def method(problem, budget, seed, watch):
        watch(Event(0.0, 1, 4.0, 0.5))
        return Outcome(None)

    for own, name in ((square(), None), (replace(square(), methods={"mine": method}), "mine")):
        events, watch = seen(lambda told: told)
        gearopt.solve(own, method=name, budget=Budget(evaluations=50), watch=watch)
        assert events and {(e.part, e.objective, e.unit) for e in events} == {("square", "y", "")}


def test_a_clock_tells_what_is_reached_and_stops_once():
    events = []
    clock = Clock(Budget(), lambda event: events.append(event) or len(events) < 3)
    assert clock.tell() and (events[0].best, events[0].bound) == (None, None)
    clock.evaluations, clock.best, clock.bound = 7, 3.0, 4.0
    assert clock.tell(2)
    assert (events[1].evaluations, events[1].best, events[1].bound) == (
        9,
        3.0,
        3.0,
    )  # no bound above
    assert not clock.tell() and clock.stopped and clock.refused and clock.over
    assert not clock.tell() and len(events) == 3  # it is not asked again


def test_a_clock_ends_with_its_budget():
    clock = Clock(Budget(evaluations=5))
    assert clock.tell(4) and not clock.over
    assert not clock.tell(5) and clock.stopped and not clock.refused
    late = Clock(
        Budget(seconds=1.0, evaluations=5), start=time.perf_counter() - 0.75, evaluations=3
    )
    assert 0.2 < late.within(9.0) <= 0.25 and late.within(0.1) == 0.1
    assert late.left.evaluations == 2 and late.tell()
    assert Clock(Budget(seconds=0.0)).over and Clock(Budget(evaluations=0)).over
    assert Clock().within(9.0) == 9.0 and not Clock().over


def test_a_run_within_another_counts_in_it():
    events = []
    outer = Clock(Budget(evaluations=10), events.append, evaluations=4, best=2.0)
    inner = outer.inner()
    assert inner(Event(0.0, 3, 5.0)) and inner(Event(0.0, 5, 1.0))
    assert [(e.evaluations, e.best) for e in events] == [(7, 2.0), (9, 1.0)]
    assert not inner(Event(0.0, 6)) and outer.evaluations == 10
