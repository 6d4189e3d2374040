"""Flanks of a straight-sided hob: brute force on the deformed blank, the involute on the round."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson

from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import neutral_curve
from gearopt.physics.strain_wave.straight_hob import (
    hobbed,
    reference_radius,
    relieved,
    round_blank,
)

BASE = StrainWave(0.5, 160, profile_shift=0.9)
ROUND = 14.20261922808788  # mm: offset of a hob of 20 degrees on the round blank
DEFORMED = 14.374616740154853


@cache
def heights():
    return flank(BASE, 41).contacts.point.x


def place_and_turn(gearing, angles):
    """Own kinematics: neutral curve by its polar form, arc by Simpson's rule; phi = 0 at p = 0."""
    curve = neutral_curve(gearing)
    if gearing.wave == "ellipse":
        rho = (np.cos(angles) ** 2 / curve.first**2 + np.sin(angles) ** 2 / curve.second**2) ** -0.5
    else:
        rho = curve.first + curve.second * np.cos(2.0 * angles)
    q = rho * np.exp(1j * angles)
    rate = np.gradient(q, angles, edge_order=2)
    arc = cumulative_simpson(np.abs(rate), x=angles, initial=0.0) / curve.radius
    return q, rate / np.abs(rate) / 1j, arc - arc[len(arc) // 2]


def left_by_polygons(gearing, angle, offset, heights):
    """Half thickness that a hob's tooth leaves at heights: its sides cross them at 40001 places.

    The hob's side is a stretch of a straight line, 0.15 mm deeper than it must be; nothing of an
    envelope is used.
    """
    angles = np.radians(np.linspace(-10.0, 10.0, 40001))
    q, axis, arc = place_and_turn(gearing, angles)
    normal = math.sin(angle) + 1j * math.cos(angle)
    along = normal / 1j  # out of the blank, towards the middle of the hob's space
    deep = (gearing.neutral_radius + gearing.radial_deflection + heights[0] - 0.15) / along.real
    first = offset * (normal - along * normal.real / along.real) + along * deep
    ends = [
        first + 1j * gearing.blank_radius * arc,
        first + along + 1j * gearing.blank_radius * arc,
    ]
    low, high = ((end - q) / axis for end in ends)
    share = (heights[:, None] - low.real) / (high.real - low.real)
    side = low.imag + share * (high.imag - low.imag)
    return np.where((share >= 0.0) & (share <= 1.0), side, np.inf).min(axis=1)


@pytest.mark.parametrize(("wave", "angle"), [("cosine", 20.0), ("ellipse", 23.0)])
def test_polygons_of_a_hob_on_the_deformed_blank_leave_the_flank(wave, angle):
    """Within 0.01 nm, of poses 0.0005 degrees apart and an arc by Simpson's rule."""
    gearing, tool = replace(BASE, wave=wave), math.radians(angle)
    offset = DEFORMED + (angle - 20.0) * 0.7
    cut = hobbed(gearing, neutral_curve(gearing), tool, offset, heights())
    assert cut.regular
    left = left_by_polygons(gearing, tool, offset, heights())
    assert cut.tooth.points.y == pytest.approx(left, abs=1e-8)


def test_a_hob_on_the_round_blank_cuts_an_involute():
    """Base radius m z_f cos(a)/2: polar angle plus tan - angle is constant, R = r_b tan."""
    cut = hobbed(BASE, round_blank(BASE), math.radians(20.0), ROUND, heights())
    z = BASE.neutral_radius + cut.tooth.points.x + 1j * cut.tooth.points.y
    base = 40.0 * math.cos(math.radians(20.0))
    pressure = np.arccos(base / np.abs(z))
    half = np.angle(z) + np.tan(pressure) - pressure
    assert np.ptp(half) < 1e-14
    assert -1.0 / cut.tooth.curvatures == pytest.approx(base * np.tan(pressure), rel=1e-11)
    slope = np.angle(cut.tooth.directions.x + 1j * cut.tooth.directions.y)
    assert slope == pytest.approx(np.angle(z) - pressure, abs=1e-12)


def test_the_reference_line_is_that_of_the_profile_shift():
    """Tooth thickness pi m/2 + 2 x m tan a on the reference circle, x m beyond it the line."""
    tool = math.radians(20.0)
    cut = hobbed(BASE, round_blank(BASE), tool, ROUND, heights())
    z = BASE.neutral_radius + cut.tooth.points.x[0] + 1j * cut.tooth.points.y[0]
    pressure = math.acos(40.0 * math.cos(tool) / abs(z))
    at_base = np.angle(z) + math.tan(pressure) - pressure
    thickness = 2.0 * 40.0 * (at_base - (math.tan(tool) - tool))
    shift = (thickness - 0.25 * math.pi) / (2.0 * 0.5 * math.tan(tool))
    assert reference_radius(BASE, tool, ROUND) == pytest.approx(40.0 + 0.5 * shift, abs=1e-12)


@pytest.mark.parametrize("deformed", [True, False])
def test_the_edge_is_straight_and_tangents_and_curvatures_are_those_of_the_points(deformed):
    blank = neutral_curve(BASE) if deformed else round_blank(BASE)
    fine = np.linspace(0.52, 1.13, 2001)
    cut = hobbed(BASE, blank, math.radians(20.0), ROUND, fine)
    line = np.polyfit(cut.edge.x, cut.edge.y, 1)
    assert line[0] == pytest.approx(-math.tan(math.radians(20.0)), rel=1e-9)
    assert np.abs(np.polyval(line, cut.edge.x) - cut.edge.y).max() < 1e-12
    for tooth in (cut.tooth, relieved(cut.tooth, 0.01)):
        slope = np.gradient(tooth.points.y, fine, edge_order=2)
        assert tooth.directions.y / tooth.directions.x == pytest.approx(slope, abs=1e-6)
        bend = np.gradient(slope, fine)[2:-2] / (1.0 + slope[2:-2] ** 2) ** 1.5
        assert tooth.curvatures[2:-2] == pytest.approx(bend, rel=1e-4)


def test_a_relief_is_what_the_tip_loses_normal_to_the_flank():
    cut = hobbed(BASE, round_blank(BASE), math.radians(20.0), ROUND, heights())
    lost = cut.tooth.points.y - relieved(cut.tooth, 0.008).points.y
    assert lost[0] == 0.0 and (np.diff(lost) > 0.0).all()
    assert lost[-1] * cut.tooth.directions.x[-1] == pytest.approx(0.008, rel=1e-12)
    assert lost[20] == pytest.approx(
        lost[-1] * ((heights()[20] - heights()[0]) / np.ptp(heights())) ** 2
    )


def test_a_flank_below_the_base_circle_is_not_cut():
    """A hob of 5 degrees on a blank whose root is within m z_f cos(a)/2 = 39.85 mm."""
    low = replace(BASE, neutral=38.9)
    cut = hobbed(low, round_blank(low), math.radians(5.0), 3.9, heights())
    base = 40.0 * math.cos(math.radians(5.0))
    inside = low.neutral + heights() < base - 0.01
    assert not cut.regular and inside.any() and not inside.all()
    assert np.isnan(cut.tooth.points.y[inside]).all() and np.isfinite(cut.tooth.points.y[-1])
