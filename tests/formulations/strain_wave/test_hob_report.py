"""Teeth that a straight-sided hob cuts, judged beside conjugate ones: the base case of 80:1."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearopt.formulations.strain_wave.cutter_report import DEFORMED, MODIFIED, Cutter
from gearopt.formulations.strain_wave.demand import Duty
from gearopt.formulations.strain_wave.hob_report import (
    cut_flank,
    hob_design,
    nearest_contacts,
    play,
)
from gearopt.physics.strain_wave.clearance import interference, poses
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import Profile
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import arc_angle, radii
from gearopt.physics.strain_wave.rim import Cup
from gearopt.physics.strain_wave.vectors import Vector

BASE = StrainWave(0.5, 160, profile_shift=0.9)
LOW = replace(BASE, pressure_angle=math.radians(15.0), addendum=0.5)
DUTY = Duty(1e5, 10.0, (206e3, 206e3), (0.3, 0.3), 1e5, Cup(), elastic=False)


@cache
def base():
    return flank(BASE)


@cache
def design(generation, gearing=BASE, tool=20.0, relief=0.0):
    asked = Cutter(angle=math.radians(tool), generation=generation, relief=relief)
    return hob_design(DUTY, flank(gearing), asked)


def gaps_by_hand(made, points):
    """Least clearance of points at poses of 0.02 degrees, with kinematics in complex numbers."""
    gear, curve, p = made.gearing, made.curve, poses(0.02, 60.0)
    rho, slope = radii(curve, p)[:2]
    turn = gear.teeth / gear.circular_teeth * arc_angle(curve, p)
    axis = np.exp(1j * (p - np.arctan2(slope, rho) - turn))
    at = rho * np.exp(1j * (p - turn)) + axis * (points.x + 1j * points.y)[:, None]
    pressure = np.arccos(np.minimum(gear.base_radius / np.abs(at), 1.0))
    room = gear.half_angle - np.tan(pressure) + pressure - np.angle(at)
    return np.where(np.abs(at) < gear.tip_radius, np.inf, gear.base_radius * room).min()


@pytest.mark.parametrize("generation", [DEFORMED, MODIFIED])
def test_a_hob_is_fed_in_until_teeth_just_touch(generation):
    cut = cut_flank(base(), Cutter(generation=generation))
    assert abs(interference(cut.flank).gap) < 1e-9
    assert gaps_by_hand(base(), cut.tooth.points) == pytest.approx(0.0, abs=2e-6)
    assert cut.deviation.min() > -1e-9


def test_a_straight_hob_on_the_deformed_blank_is_within_3_nm_of_the_conjugate_flank():
    """On the round blank it misses by 1 um: 400 times as far. The shapes, whatever the infeed."""
    deformed, modified = (
        cut_flank(base(), Cutter(generation=g)).deviation for g in (DEFORMED, MODIFIED)
    )
    assert np.ptp(deformed) < 3e-6 and 300.0 < np.ptp(modified) / np.ptp(deformed) < 500.0


def test_the_involute_misses_by_what_a_fixed_edge_of_20_degrees_does():
    """Two ways to 0.5 um on either side: the best offset of the page's straight edge of a rack."""
    off = cut_flank(base(), Cutter(generation=MODIFIED)).deviation
    assert 1e3 * 0.5 * np.ptp(off) == pytest.approx(0.51, abs=5e-3)


def test_thinner_teeth_have_the_play_that_they_lost():
    """A parallel flank: every clearance grows by 2 um."""
    at, thin = base().contacts, 2e-3
    points = at.point - at.direction.left * thin
    thinner = replace(base(), contacts=replace(at, point=points))
    assert play(base()) == 0.0
    assert play(thinner) == pytest.approx(thin, abs=1e-6)


def test_contacts_of_the_conjugate_flank_are_those_of_the_closed_form():
    """1/R within 0.1 % on the arc of contact, all within the flanks; beyond it at ends."""
    at = base().contacts
    exact = Profile(at.point, at.direction, at.curvatures[1])
    inside = np.linspace(at.motion.arc[1], at.motion.arc[-2], 23)
    found, at_end = nearest_contacts(base(), exact, inside)
    assert not at_end.any()
    closed = np.interp(inside, at.motion.arc, at.gap_curvature)
    assert found == pytest.approx(closed, rel=1e-3)
    beyond = np.array([at.motion.arc[0] - 0.01, at.motion.arc[-1] + 0.01])
    assert nearest_contacts(base(), exact, beyond)[1].all()


def test_conjugate_teeth_carry_as_the_design_says():
    form = design(DEFORMED).forms[0]
    assert form.shared_pressure_MPa == pytest.approx(58.68, abs=5e-3)
    assert (form.carrying_teeth, form.play_mm) == (6, 0.0)
    assert form.effective_teeth == pytest.approx(4.34, abs=5e-3)
    assert 1e-3 * form.windup_mrad == pytest.approx(0.0796e-3, abs=1e-7)


def test_ends_of_an_involutes_flank_carry_most_and_no_pressure_is_told():
    exact, cut = design(MODIFIED).forms
    assert cut.at_ends > 90.0 > exact.at_ends and cut.shared_pressure_MPa is None
    assert cut.windup_mrad > exact.windup_mrad and cut.near < exact.near


def test_a_relief_clears_the_interference_of_15_degrees_with_little_play():
    """Conjugate teeth cut by 6.7 um; thinner involutes have 6.4 um of play, relieved ones 0.1."""
    plain = design(MODIFIED, LOW, 15.0).forms
    relieved = design(MODIFIED, LOW, 15.0, 8e-3).forms
    assert 1e3 * plain[0].least_clearance_mm == pytest.approx(-6.7, abs=0.05)
    assert plain[1].least_clearance_mm >= -1e-8 and relieved[1].least_clearance_mm >= -1e-8
    assert 1e3 * plain[1].play_mm == pytest.approx(6.4, abs=0.05)
    assert 1e3 * relieved[1].play_mm < 0.1
    assert relieved[1].shared_pressure_MPa > 4.0 * plain[0].shared_pressure_MPa


def test_a_hob_that_cuts_no_flank_is_none():
    """Below the base circle of 39.85 mm that a hob of 5 degrees has."""
    low, asked = flank(replace(BASE, profile_shift=-1.0)), Cutter(angle=math.radians(5.0))
    root = low.gearing.neutral_radius + low.contacts.point.x[0]
    assert low.complete and root < 40.0 * math.cos(math.radians(5.0))
    found = hob_design(DUTY, low, replace(asked, generation=MODIFIED))
    assert not found.regular and found.forms == ()


def test_points_of_the_edge_lie_on_the_hobs_straight_side():
    found = design(DEFORMED)
    side = Vector(np.array(found.x_mm), np.array(found.y_mm))
    quarter = 0.25 * math.pi * 0.5
    assert side.y == pytest.approx(quarter - math.tan(math.radians(20.0)) * side.x, abs=1e-12)
