"""The trains of `gearopt bench servo` are those of the tests, with their counts."""

import math
from dataclasses import replace

import pytest
from servo_trains import PAPER

from gearopt.bench import names
from gearopt.bench.servo import METHODS, _row, run, train_of
from gearopt.formulations.servo.servo_design import OBJECTIVES


def test_the_train_is_that_of_the_tests():
    ours, theirs = train_of(0.1082), PAPER
    assert ours.lost_motion == pytest.approx(theirs.lost_motion, rel=1e-12)
    assert ours.error == pytest.approx(math.radians(0.1082), rel=1e-15)
    assert replace(ours, lost_motion=theirs.lost_motion, error=theirs.error) == theirs
    assert "servo" in names()


def test_the_train_found_is_the_known_one():
    """Least inertia 5.142e-7 kg m2, the bound 4.884e-7: the optimum is 5.29 % above it."""
    row = _row("", train_of(0.1082), "inertia", "exact", 4.8838353e-4, 1)
    assert row["objective"] == pytest.approx(5.142e-4, abs=6e-8) and row["status"] == "optimal"
    assert row["above_bound_percent"] == pytest.approx(100 * (5.142 / 4.884 - 1), abs=0.02)
    assert row["feasible_trains"] != 62054 and row["trains_looked_at"] < 6_326_052


@pytest.mark.slow
def test_every_goal_has_both_methods():
    rows = run(1)
    assert len(rows) == 2 * len(OBJECTIVES) * len(METHODS)
    for every, useful in zip(rows[::2], rows[1::2], strict=True):
        assert every["objective"] == useful["objective"]
        assert useful["trains_looked_at"] < every["trains_looked_at"] == 6_326_052
        assert 0.0 < every["above_bound_percent"] == useful["above_bound_percent"]
        assert every["feasible_trains"] in (62054, 247948)
