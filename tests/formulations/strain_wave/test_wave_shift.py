"""Profile shift against pressure, and the two side conditions that end the search."""

from dataclasses import replace

import numpy as np
import pytest

from gearopt.formulations.strain_wave.duty import Duty
from gearopt.formulations.strain_wave.shift import (
    largest_addendum,
    last_shift_of_one_pair,
    shift_curve,
)
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.rim import Cup

BASE = StrainWave(0.5, 160, profile_shift=0.9)
DUTY = Duty(1e5, 10.0, (206e3, 206e3), (0.3, 0.3), 1e5, Cup(), elastic=False)


def test_the_curve_agrees_with_a_table_made_elsewhere():
    """x: pairs, R, pressures by equal sharing, by whole pairs, by shared loads."""
    table = {
        0.0: (1.183, 279, 119.8, 130.4, 61.3),
        0.9: (1.096, 313, 117.4, 122.9, 58.7),
        1.8: (1.028, 346, 115.3, 116.9, 56.6),
    }
    found = shift_curve(BASE, DUTY, table)
    for point, row in zip(found, table.values(), strict=True):
        printed = point.pairs, point.radius, point.equal, point.whole, point.shared
        assert printed == pytest.approx(row, abs=0.6) and point.pairs == pytest.approx(
            row[0], abs=6e-4
        )
        assert printed[2:] == pytest.approx(row[2:], abs=0.06)
        assert point.least_gap > -1e-9
    stresses = np.array([(p.equal, p.whole, p.shared) for p in found])
    assert (np.diff(stresses, axis=0) < 0.0).all()


def test_shifts_without_a_complete_flank_are_left_out():
    assert shift_curve(replace(BASE, deflection=0.75), DUTY, (0.9,)) == []


@pytest.mark.parametrize(
    ("addendum", "shift"),
    [
        (0.55, 0.965),
        *(pytest.param(*v, marks=pytest.mark.slow) for v in ((0.52, 0.284), (0.6, 2.229))),
    ],
)
def test_where_one_pair_always_touches(addendum, shift):
    found = last_shift_of_one_pair(replace(BASE, addendum=addendum))
    assert found == pytest.approx(shift, abs=1e-3)


def test_where_pairs_stay_above_one():
    assert last_shift_of_one_pair(replace(BASE, addendum=0.7)) is None


@pytest.mark.slow
@pytest.mark.parametrize(("shift", "addendum"), [(0.0, 0.6214), (0.9, 0.6792), (1.5, 0.7125)])
def test_the_largest_addendum_without_interference(shift, addendum):
    """Another program found these on poses of 0.1 degrees."""
    found = largest_addendum(replace(BASE, profile_shift=shift))
    assert found == pytest.approx(addendum, abs=5e-4)
