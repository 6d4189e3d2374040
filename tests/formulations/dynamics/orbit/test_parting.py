"""Designs whose teeth part: collocated motions against simulated ones, and what is made of them."""

from dataclasses import replace

import numpy as np
import pytest
from least_vibration_task import BEST, HEAVY, TASK

from gearopt.formulations.dynamics.orbit import parting_text
from gearopt.formulations.dynamics.orbit.climbing import climb, measure, posed
from gearopt.formulations.dynamics.orbit.least_vibration import methods
from gearopt.formulations.dynamics.orbit.parting_text import (
    elements,
    rounded,
    size,
    start,
    worst_motions,
)
from gearopt.formulations.dynamics.orbit.task import worst
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve

PARTING = replace(
    TASK,
    backlash=0.1,
    elements=12,
    speeds_rpm=(4200.0, 4500.0),
    ranges=TASK.ranges | {"contact_ratio": (1.3, 1.7), "face_width": (12.0, 16.0)},
    most_mass=5e-3,
)
AT = np.array(PARTING.speeds_rpm)


@pytest.mark.slow
def test_motions_in_contact_are_the_linear_ones_and_others_larger():
    task = replace(PARTING, ranges=TASK.ranges)
    speeds = np.array([1500.0, 3000.0, 4500.0, 6000.0])
    known = [2.7250939, 2.0704926, 3.2923260, 1.2282179]  # of an independent program, 40 harmonics
    assert measure(task, BEST, speeds, Clock()) == pytest.approx(known, rel=2e-4)
    found = [size(task, m) for m in worst_motions(task, HEAVY, AT, Clock())]
    assert found == pytest.approx([17.271, 14.035], abs=2e-3)  # by RK8 of 800 periods
    assert worst(TASK, HEAVY, AT, 40) == pytest.approx([6.887, 10.993], abs=2e-3)


def test_elements_are_shared_by_length():
    counts = elements(PARTING)
    assert len(counts) == 4 and sum(counts) == pytest.approx(12, abs=2) and min(counts) >= 2


@pytest.mark.slow
def test_a_simulated_motion_is_nearly_a_point_of_the_problem():
    """What is left falls as elements are added."""
    motions, left = worst_motions(PARTING, HEAVY, AT, Clock()), []
    for count in (12, 48):
        task = replace(PARTING, elements=count)
        one = posed(task)
        found = one.batch(start(task, one, HEAVY, motions)[None])
        left.append(np.abs(found.H - 1.0).mean())
        assert found.F[0, 0] == pytest.approx(17.271, abs=2e-3)
    assert left[0] < 1e-2 and left[1] < 0.3 * left[0]


@pytest.mark.slow
@pytest.mark.parametrize(("elements", "error"), [(12, 1e-2), (24, 2e-3)])
def test_the_collocated_motion_of_a_design_is_the_simulated_one(elements, error):
    """A box of one design: the problem's objective is what simulation gives, to 0.2 % with 24."""
    box = {name: (value, value) for name, value in zip(TASK.ranges, HEAVY, strict=True)}
    task = replace(PARTING, elements=elements, ranges=box, speeds_rpm=(4500.0,))
    motions = worst_motions(task, HEAVY, AT[1:], Clock())
    one = posed(task)
    made = solve(one.starting(start(task, one, HEAVY, motions)), "ipopt")
    assert made.value == pytest.approx(size(task, motions[0]), rel=error)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rms", "peak_to_peak"])
def test_a_design_that_parts_is_led_to_one_that_vibrates_less(name):
    task = replace(PARTING, measure=name)
    found = climb(task, posed(task), HEAVY, Clock())
    assert found.judged < 0.4 * measure(task, HEAVY, AT, Clock()).max()
    assert found.objective == pytest.approx(found.judged, rel=0.01)
    made = solve(rounded(task, found.problem, parting_text.WIDTHS[-1]).starting(found.outcome.x))
    assert made.status in ("stationary", "feasible") and made.value <= found.objective * (1 + 1e-6)


@pytest.mark.slow
def test_two_periods_of_a_motion_are_twice_one():
    box = {name: (value, value) for name, value in zip(TASK.ranges, HEAVY, strict=True)}
    task = replace(PARTING, ranges=box, speeds_rpm=(4500.0,), periods=2)
    motions = worst_motions(task, HEAVY, AT[1:], Clock())
    two = posed(task)
    made = solve(two.starting(start(task, two, HEAVY, motions)), "ipopt")
    assert made.value == pytest.approx(size(task, motions[0]), rel=1e-2)


@pytest.mark.slow
def test_screened_designs_are_judged_by_simulation():
    task = replace(PARTING, speeds_rpm=(4500.0,))
    made = solve(posed(task, methods(task)), "screened")
    assert made.status in ("stationary", "feasible")
    point = np.array(list(made.design.values())[:5])
    assert measure(task, point, AT[1:], Clock()).max() == pytest.approx(made.value, rel=0.01)


def test_what_a_budget_leaves():
    """A clock that has stopped leaves no motion, and designs without one are no starts."""
    clock = Clock(Budget(seconds=0.0))
    assert worst_motions(PARTING, HEAVY, AT, clock) == []
    assert np.isinf(measure(PARTING, HEAVY, AT, clock)).all()
    assert climb(PARTING, posed(PARTING), HEAVY, clock) is None
