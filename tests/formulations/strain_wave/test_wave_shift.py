"""Profile shift against pressure, and the two side conditions that end the search."""

from dataclasses import replace

import numpy as np
import pytest

from gearopt.formulations.strain_wave.demand import Duty, equal_pressure
from gearopt.formulations.strain_wave.shift import (
    largest_addendum,
    last_shift_of_one_pair,
    shift_curve,
)
from gearopt.physics.strain_wave.clearance import interference, interferes
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.rim import Cup

BASE = StrainWave(0.5, 160, profile_shift=0.9)
DUTY = Duty(1e5, 10.0, (206e3, 206e3), (0.3, 0.3), 1e5, Cup(), elastic=False)


# x: pairs, R, pressures by equal sharing, by whole pairs, by shared loads, from another program
CURVE = {
    0.0: (1.183, 279, 119.8, 130.4, 61.3),
    0.3: (1.152, 290, 119.0, 127.7, 60.3),
    0.6: (1.123, 302, 118.1, 125.2, 59.5),
    0.9: (1.096, 313, 117.4, 122.9, 58.7),
    1.2: (1.072, 325, 116.7, 120.8, 57.9),
    1.5: (1.049, 336, 116.0, 118.8, 57.2),
    1.8: (1.028, 346, 115.3, 116.9, 56.6),
}


def test_the_curve_agrees_with_a_table_made_elsewhere():
    found = shift_curve(BASE, DUTY, CURVE)
    for point, row in zip(found, CURVE.values(), strict=True):
        assert (point.pairs, point.radius) == pytest.approx(row[:2], rel=2e-3)
        assert (point.equal, point.whole, point.shared) == pytest.approx(row[2:], abs=0.06)
        assert point.least_gap > -1e-9
    stresses = np.array([(p.equal, p.whole, p.shared) for p in found])
    assert (np.diff(stresses, axis=0) < 0.0).all()
    fall = 1.0 - (found[-1].equal / found[0].equal) ** (1.0 / 1.8)
    assert fall == pytest.approx(0.02, abs=3e-3)  # of a shift of one module


def test_with_a_neutral_radius_that_is_held_the_stress_falls_by_6_percent():
    """MPa, from another program: R_m is the reference radius of the blank, 40 mm."""
    found = []
    for x in (0.0, 0.6, 0.9, 1.2, 1.8):
        made = flank(replace(BASE, profile_shift=x, neutral=40.0))
        found.append(equal_pressure(DUTY, made))
        assert int(made.contacts.gap_curvature.argmax()) == 0  # at the flexspline's root
    assert found == pytest.approx([128.1, 123.0, 120.7, 118.6, 114.7], abs=0.06)
    assert 1.0 - (found[-1] / found[0]) ** (1.0 / 1.8) == pytest.approx(0.06, abs=3e-3)


def test_shifts_without_a_complete_flank_are_left_out():
    assert shift_curve(replace(BASE, deflection=0.75), DUTY, (0.9,)) == []


@pytest.mark.parametrize(
    ("addendum", "shift"),
    [
        (0.55, 0.965),
        (0.58, 1.703),
        *(pytest.param(*v, marks=pytest.mark.slow) for v in ((0.52, 0.284), (0.6, 2.229))),
    ],
)
def test_where_one_pair_always_touches(addendum, shift):
    found = last_shift_of_one_pair(replace(BASE, addendum=addendum))
    assert found == pytest.approx(shift, abs=1e-3)


def test_where_pairs_stay_above_one():
    assert last_shift_of_one_pair(replace(BASE, addendum=0.7)) is None


@pytest.mark.parametrize(
    ("shift", "addendum", "pairs"),
    [
        (0.9, 0.6792, 1.240),
        *(
            pytest.param(*v, marks=pytest.mark.slow)
            for v in ((0.0, 0.6214, 1.226), (0.5, 0.6548, 1.235), (1.5, 0.7125, 1.245))
        ),
    ],
)
def test_the_largest_addendum_without_interference(shift, addendum, pairs):
    """Another program found a little more, on poses of 0.1 degrees, with 1.23 to 1.25 pairs."""
    shifted = replace(BASE, profile_shift=shift)
    found = largest_addendum(shifted)
    assert addendum - 9e-4 < found < addendum
    made = flank(replace(shifted, addendum=found))
    assert float(made.pairs_in_contact) == pytest.approx(pairs, abs=2e-3)


def test_long_teeth_interfere_at_20_degrees():
    for addendum, free in ((0.55, True), (0.8, False), (1.0, False)):
        made = flank(replace(BASE, addendum=addendum))
        assert made.complete and interference(made, 0.25).free == free
        assert interferes(made, 0.25, 11) is not free
