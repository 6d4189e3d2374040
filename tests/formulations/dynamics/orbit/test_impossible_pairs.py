"""Limits that no design of the ranges meets, and designs moved into limits."""

from dataclasses import replace

import numpy as np
import pytest
from least_vibration_task import TASK

from gearopt.formulations.dynamics.orbit.impossible import impossible, least_limits
from gearopt.formulations.dynamics.orbit.least_vibration import methods
from gearopt.formulations.dynamics.orbit.orbit_text import problem, reduced
from gearopt.formulations.dynamics.orbit.screening import within
from gearopt.optimise.box import box
from gearopt.optimise.solve import solve


def test_what_the_lightest_pair_weighs():
    """7850 kg/m3 pi (63.85^2 + 85.13^2) mm2, 8 mm wide, rims of 0.6."""
    kilogrammes = 7.85e-6 * np.pi * sum(r**2 for r in TASK.radii) * 8.0 * 0.6
    assert 1e3 * least_limits(TASK)["mass"] * TASK.most_mass == pytest.approx(kilogrammes)
    assert kilogrammes == pytest.approx(1.3406, abs=1e-4)


def within_ranges(**ranges):
    return {"ranges": TASK.ranges | ranges}


CASES = {  # changes of the task, and the names of what cannot be met
    "mass": ({"most_mass": 0.5e-3}, ["mass"]),
    "displacement": ({"most_displacement": 0.006}, ["displacement"]),
    "both": ({"most_mass": 1.3e-3, "most_displacement": 0.006}, ["mass", "displacement"]),
    "high": (within_ranges(contact_ratio=(1.9, 1.95), ramp=(0.12, 0.2)), ["ramp"]),
    "low": (within_ranges(contact_ratio=(1.05, 1.1), ramp=(0.15, 0.2)), ["ramp"]),
}


@pytest.mark.parametrize("name", list(CASES))
def test_impossible_limits_are_proven_at_once(name):
    changes, conflict = CASES[name]
    task = replace(TASK, **changes)
    made = solve(problem(task, methods(task)), "screened")
    assert made.status == "infeasible" and made.proof["conflict"] == conflict
    points = box(reduced(task)).points(np.random.default_rng(1).random((100, 5)))
    rows = [row.name for row in reduced(task).rows.inequalities]
    for limit in conflict:
        columns = [k for k, row in enumerate(rows) if row.startswith(limit)]
        worst = reduced(task).batch(points).G[:, columns].max(axis=1)
        assert worst.min() >= least_limits(task)[limit] - 1e-12 > 1.0 - 1e-12


def test_limits_that_can_just_be_met():
    for mass, never in ((1.3405e-3, True), (1.3407e-3, False)):
        assert (impossible(replace(TASK, most_mass=mass)) is not None) is never
    ranges = TASK.ranges | {"contact_ratio": (1.9, 1.95), "ramp": (0.1, 0.2)}
    assert impossible(replace(TASK, ranges=ranges)) is None


def test_designs_are_moved_into_the_limits():
    points = box(reduced(TASK)).points(np.random.default_rng(2).random((100, 5)))
    before, after = (reduced(TASK).batch(p).G.max(axis=1) for p in (points, within(TASK, points)))
    assert (before > 1.0).mean() > 0.5 and after.max() < 1.0 + 1e-9
    kept = points[before <= 1.0]
    assert within(TASK, kept) == pytest.approx(kept)
