"""Teeth that a straight-sided hob cuts, judged beside conjugate ones: the base case of 80:1."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearopt.formulations.strain_wave.cutter_report import DEFORMED, MODIFIED, Cutter
from gearopt.formulations.strain_wave.demand import Duty
from gearopt.formulations.strain_wave.hob_report import (
    _form,
    cut_flank,
    hob_design,
    touch_at_ends,
)
from gearopt.physics.strain_wave.clearance import interference, poses
from gearopt.physics.strain_wave.conjugate import flank
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


def within(generation):
    """How far the flank as cut lies within the conjugate one, at all its points."""
    cut, at = cut_flank(base(), Cutter(generation=generation))[0], base().contacts
    return (at.point.y - cut.contacts.point.y) * at.direction.x


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
    cut = cut_flank(base(), Cutter(generation=generation))[0]
    assert abs(interference(cut).gap) < 1e-9
    assert gaps_by_hand(base(), cut.contacts.point) == pytest.approx(0.0, abs=2e-6)
    assert within(generation).min() > -1e-9


def test_a_straight_hob_on_the_deformed_blank_is_within_3_nm_of_the_conjugate_flank():
    """On the round blank it misses by 1 um: 400 times as far. The shapes, whatever the infeed."""
    deformed, modified = (within(g) for g in (DEFORMED, MODIFIED))
    assert np.ptp(deformed) < 3e-6 and 300.0 < np.ptp(modified) / np.ptp(deformed) < 500.0


def test_the_involute_misses_by_what_a_fixed_edge_of_20_degrees_does():
    """Two ways to 0.5 um on either side: the best offset of the page's straight edge of a rack."""
    assert 1e3 * 0.5 * np.ptp(within(MODIFIED)) == pytest.approx(0.51, abs=5e-3)


def test_play_is_what_parallel_flanks_lost():
    """Conjugate points 2 um inside: each clearance grows by that, and the windup by it over r_b."""
    at, thin = base().contacts, 2e-3
    points = at.point - at.direction.left * thin
    form = _form(DUTY, replace(base(), contacts=replace(at, point=points)), thin)
    exact = _form(DUTY, base(), 0.0)
    assert exact.play_mm == 0.0 and form.play_mm == pytest.approx(thin, abs=1e-6)
    assert form.least_clearance_mm == pytest.approx(thin, abs=1e-6)
    grown = 1e-3 * (form.windup_mrad - exact.windup_mrad)
    assert grown == pytest.approx(thin / BASE.base_radius, rel=2e-3)
    assert form.effective_teeth == pytest.approx(exact.effective_teeth, rel=1e-3)


def test_conjugate_teeth_touch_within_their_flanks_on_the_arc_of_contact_alone():
    arc = base().contacts.motion.arc
    assert not touch_at_ends(base(), np.linspace(arc[3], arc[-4], 23)).any()
    assert touch_at_ends(base(), [arc[0] - 0.01, arc[-1] + 0.01]).all()


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


@pytest.mark.slow
def test_a_relief_clears_the_interference_of_15_degrees_with_little_play():
    """Conjugate teeth cut by 6.7 um; thinner involutes have 6.4 um of play, relieved ones 0.1."""
    plain = design(MODIFIED, LOW, 15.0).forms
    relieved = design(MODIFIED, LOW, 15.0, 8e-3).forms
    assert 1e3 * plain[0].least_clearance_mm == pytest.approx(-6.7, abs=0.05)
    assert plain[1].least_clearance_mm >= -1e-8 and relieved[1].least_clearance_mm >= -1e-8
    assert 1e3 * plain[1].play_mm == pytest.approx(6.4, abs=0.05)
    assert 1e3 * relieved[1].play_mm < 0.1
    assert relieved[1].shared_pressure_MPa > 4.0 * design(DEFORMED).forms[0].shared_pressure_MPa


def test_a_hob_that_cuts_no_flank_is_none():
    """Below the base circle of 39.85 mm that a hob of 5 degrees has."""
    low, asked = flank(replace(BASE, profile_shift=-1.0)), Cutter(angle=math.radians(5.0))
    root = low.gearing.neutral_radius + low.contacts.point.x[0]
    assert low.complete and root < 40.0 * math.cos(math.radians(5.0))
    found = hob_design(DUTY, low, replace(asked, generation=MODIFIED))
    assert not found.regular and found.forms == ()


def test_a_hob_has_the_pressure_angle_where_none_is_given():
    found = design(MODIFIED, LOW, 0.0, 8e-3)
    assert (
        found.given_deg == pytest.approx(15.0)
        and found.forms == design(MODIFIED, LOW, 15.0, 8e-3).forms
    )


def test_points_of_the_edge_lie_on_the_hobs_straight_side():
    found = design(DEFORMED)
    side = Vector(np.array(found.x_mm), np.array(found.y_mm))
    quarter = 0.25 * math.pi * 0.5
    assert side.y == pytest.approx(quarter - math.tan(math.radians(20.0)) * side.x, abs=1e-12)
