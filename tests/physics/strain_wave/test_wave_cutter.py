"""Cutters of the conjugate flank: envelopes, their regularity, and the paper's construction."""

from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, make_interp_spline

from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import (
    Profile,
    blank_profile,
    envelope,
    generated,
    least_teeth,
    superposition,
)
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.vectors import Vector

PITCH = 40.0  # radius of the blank's pitch circle


@cache
def blank():
    return blank_profile(flank(StrainWave(0.5, 160, profile_shift=0.9), 401))


# largest error [um] of the flank that a spline through 21, 51, 101 points of a cutter generates,
# by another program; and the least and largest radius of its edge [mm]
ROUND_TRIPS = {
    None: ((1.8e-8, 4.5e-10, 3e-11), (343.0, 374.0)),
    100: ((3.3e-6, 8.6e-8, 5.3e-9), (6.8, 8.3)),
    40: ((1.5e-5, 3.9e-7, 2.4e-8), (1.4, 3.0)),
}


@pytest.mark.parametrize("teeth", ROUND_TRIPS)
def test_a_cutter_generates_the_flank_that_it_is_made_for(teeth):
    """Exactly by its own points; by a spline with its fourth order, from 51 on below 1e-6 um."""
    radius = 0.25 * teeth if teeth else np.inf
    cutter = envelope(blank(), PITCH, radius)
    printed, ends = ROUND_TRIPS[teeth]
    assert cutter.regular
    assert (generated(cutter.profile, PITCH, radius) - blank().points).length.max() < 1e-12
    found = [round_trip(cutter.profile, radius, count) for count in (21, 51, 101)]
    assert found == pytest.approx(printed, rel=0.06) and max(found[1:]) < 1e-6
    assert np.log(found[0] / found[2]) / np.log(5.0) == pytest.approx(4.0, abs=0.1)
    edge = 1.0 / np.abs(cutter.profile.curvatures)
    assert (edge.min(), edge.max()) == pytest.approx(ends, rel=0.02)


def round_trip(edge, radius, count):
    at = np.r_[0.0, np.cumsum((blank().points[1:] - blank().points[:-1]).length)]
    pick = np.linspace(0, 400, count).astype(int)
    spline = CubicSpline(at[pick], np.c_[edge.points.x, edge.points.y][pick])
    fine = np.linspace(at[0], at[-1], 997)
    along = spline(fine, 1)
    along /= np.hypot(*along.T)[:, None]
    tool = Profile(Vector(*spline(fine).T), Vector(*along.T), np.zeros(997))
    back = generated(tool, PITCH, radius)
    true = make_interp_spline(blank().points.x, blank().points.y, k=5)
    off = (back.y - true(back.x)) / np.hypot(1.0, true(back.x, nu=1))
    inside = (back.x >= blank().points.x[0]) & (back.x <= blank().points.x[-1])
    return 1e3 * np.abs(off[inside]).max()


def test_the_blank_rolls_from_one_end_of_its_flank_to_the_other():
    """Degrees of its turn, whatever the cutter, from another program."""
    for radius in (np.inf, 10.0):
        roll = np.degrees(envelope(blank(), PITCH, radius).roll)
        assert (roll[0], roll[-1]) == pytest.approx((0.136, -2.341), abs=6e-4)
        assert (np.diff(roll) < 0.0).all()


@pytest.mark.parametrize("teeth", [8, 20])
def test_cutters_of_few_teeth_have_a_cusp(teeth):
    assert not envelope(blank(), PITCH, 0.25 * teeth).regular


def test_speed_and_curvature_of_an_envelope_are_derivatives_of_it():
    cutter = envelope(blank(), PITCH, 10.0)
    at = np.r_[0.0, np.cumsum((blank().points[1:] - blank().points[:-1]).length)]
    edge = CubicSpline(at, np.c_[cutter.profile.points.x, cutter.profile.points.y])
    d1, d2 = Vector(*edge(at, 1).T), Vector(*edge(at, 2).T)
    assert d1.length == pytest.approx(cutter.speeds, rel=1e-5)
    found = (d1.cross(d2) / d1.length**3)[20:-20]
    assert found == pytest.approx(cutter.profile.curvatures[20:-20], rel=1e-3)


def test_the_least_teeth_of_a_cutter_depend_on_the_pitch_circle():
    """The paper says that any circle between root and tip does.

    Another program, which asks for a speed of 0.02 instead of above 0, has one tooth more at two.
    """
    other = {40.0: 25, 40.148: 19, 40.25: 16, 40.5: 8, 40.754: 6}
    found = {pitch: least_teeth(blank(), pitch, 160) for pitch in other}
    assert found == {40.0: 24, 40.148: 19, 40.25: 15, 40.5: 8, 40.754: 6}
    for pitch, teeth in other.items():
        assert envelope(blank(), pitch, pitch * teeth / 160).speeds.min() > 0.02
        fewer = envelope(blank(), pitch, pitch * (teeth - 1) / 160)
        assert teeth == 6 or not fewer.speeds.min() > 0.02


def test_superposed_rolls_approach_the_envelope():
    """The paper's construction: its error falls with the square of the roll step."""
    edge = -envelope(blank(), PITCH, 10.0).profile.points[50:350:10]
    errors = []
    for steps in (21, 81, 321):
        rolls = np.linspace(-0.18, 0.03, steps)
        angle = superposition(blank(), (PITCH, 10.0), rolls, edge.length)
        errors.append(1e3 * np.abs((angle - edge.angle) * edge.length).max())
    assert errors[:2] == pytest.approx([0.039, 0.002], rel=0.15) and errors[2] < 1e-3
    assert np.log2(errors[0] / errors[1]) / 2.0 == pytest.approx(2.0, abs=0.3)


def test_equation_13_as_printed_misses_by_20_um():
    edge = -envelope(blank(), PITCH, 10.0).profile.points[50:350:10]
    rolls = np.linspace(-0.18, 0.03, 321)
    angle = superposition(blank(), (PITCH, 10.0), rolls, edge.length, printed=True)
    assert 1e3 * np.abs((angle - edge.angle) * edge.length).max() == pytest.approx(20.5, abs=0.1)


def test_rolls_that_end_too_early_leave_an_error_that_no_step_removes():
    edge = -envelope(blank(), PITCH, 10.0).profile.points[50:350:10]
    errors = []
    for steps in (81, 1281):
        angle = superposition(blank(), (PITCH, 10.0), np.linspace(-0.1, 0.03, steps), edge.length)
        errors.append(1e3 * np.nanmax(np.abs((angle - edge.angle) * edge.length)))
    assert errors == pytest.approx([1.4, 1.4], abs=0.06)  # um, another program
