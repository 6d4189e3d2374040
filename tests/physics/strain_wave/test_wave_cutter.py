"""Cutters of the conjugate flank: envelopes, their regularity, and the paper's construction."""

from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

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


@pytest.mark.parametrize("teeth", [40, 100, None])
def test_a_cutter_generates_the_flank_that_it_is_made_for(teeth):
    """Exactly by its own points; by splines through 51 of them to less than 1e-6 um."""
    radius = 0.25 * teeth if teeth else np.inf
    cutter = envelope(blank(), PITCH, radius)
    assert cutter.regular
    assert (generated(cutter.profile, PITCH, radius) - blank().points).length.max() < 1e-12
    at = np.r_[0.0, np.cumsum((blank().points[1:] - blank().points[:-1]).length)]
    pick = np.linspace(0, 400, 51).astype(int)
    edge = CubicSpline(at[pick], np.c_[cutter.profile.points.x, cutter.profile.points.y][pick])
    fine = np.linspace(at[0], at[-1], 997)
    along = edge(fine, 1)
    along /= np.hypot(*along.T)[:, None]
    tool = Profile(Vector(*edge(fine).T), Vector(*along.T), np.zeros(997))
    back = generated(tool, PITCH, radius)
    true = CubicSpline(blank().points.x, blank().points.y)
    off = (back.y - true(back.x)) / np.hypot(1.0, true(back.x, 1))
    inside = (back.x >= blank().points.x[0]) & (back.x <= blank().points.x[-1])
    assert 1e3 * np.abs(off[inside]).max() < 1e-6


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
    for steps, most in ((21, 0.04), (81, 0.003), (321, 0.001)):
        rolls = np.linspace(-0.18, 0.03, steps)
        angle = superposition(blank(), (PITCH, 10.0), rolls, edge.length)
        errors.append(1e3 * np.abs((angle - edge.angle) * edge.length).max())
        assert errors[-1] < most
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
    assert errors[1] > 1.0 and errors[1] == pytest.approx(errors[0], rel=0.05)
