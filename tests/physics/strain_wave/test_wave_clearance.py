"""Clearance over the wave, interference, and how many teeth come near: 80:1 of m 0.5 mm."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearopt.physics.strain_wave.clearance import (
    clearances,
    corner,
    interference,
    involute_gap,
    least_gaps,
    poses,
    teeth_within,
    thickness_at,
    tooth_arcs,
    tooth_clearances,
)
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import arc_angle, neutral_curve, radii
from gearopt.physics.strain_wave.vectors import Vector, polar

BASE = StrainWave(0.5, 160, profile_shift=0.9)


@cache
def base():
    return flank(BASE)


def test_distance_to_an_involute_is_that_to_its_nearest_point():
    t = np.linspace(0.3, 0.5, 200001)
    along = polar(1.0, BASE.half_angle - t)
    curve = along * BASE.base_radius + along.left * (BASE.base_radius * t)
    for place in (Vector(40.9, 0.3), Vector(41.1, 0.45)):
        nearest = (curve - place).length.min()
        found, radius = involute_gap(BASE, place)
        assert abs(found) == pytest.approx(nearest, abs=2e-9)
        assert radius == pytest.approx(np.hypot(place.x, place.y))
    assert involute_gap(BASE, Vector(40.9, 0.3))[0] > 0.0


def test_the_corner_is_on_the_tip_circle_and_on_the_flank():
    place = corner(BASE)
    assert place.length == pytest.approx(BASE.tip_radius, rel=1e-14)
    assert abs(involute_gap(BASE, place)[0]) < 1e-13


def test_clearances_of_the_neighbours():
    """um of teeth -5 to 5 from the middle of the arc of contact, from another program."""
    printed = [11.425, 6.649, 3.242, 1.097, 0.103, 0.0, 0.101, 0.999, 2.733, 5.181, 8.215]
    found = 1e3 * tooth_clearances(base(), tooth_arcs(base(), np.arange(-5, 6)))
    assert found == pytest.approx(printed, abs=1.5e-3)
    far = 1e3 * tooth_clearances(base(), tooth_arcs(base(), [-10, 10]))
    assert far == pytest.approx([58.876, 27.387], abs=1.5e-3)
    within = teeth_within(base(), np.array([0.5, 1, 2, 5, 10, 20]) * 1e-3)
    assert within == pytest.approx([3.10, 3.94, 5.12, 7.49, 10.26, 14.45], abs=0.011)


def test_the_base_case_is_free_of_interference_over_the_whole_wave():
    found = interference(base(), step_deg=0.05)
    assert found.free and found.gap < 1e-9  # the conjugate flank touches


@pytest.mark.parametrize(("angle", "pairs", "worst"), [(15, 1.33, -31), (10, 1.67, -79)])
def test_lower_pressure_angles_interfere_on_disengagement(angle, pairs, worst):
    made = flank(replace(BASE, pressure_angle=np.radians(angle)))
    assert made.pairs_in_contact == pytest.approx(pairs, abs=6e-3)
    found = interference(made, step_deg=0.1)
    assert 1e3 * found.gap == pytest.approx(worst, abs=0.7) and not found.free


def test_flanks_of_another_deflection():
    """Cut for w = 1 and run at another w, with the same blank: backlash below, interference above.

    um, from another program on coarser poses.
    """
    for w, gap in ((0.98, 3.16), (1.02, -3.33), (1.05, -8.55), (1.1, -17.81)):
        run = replace(BASE, deflection=w, neutral=BASE.neutral_radius)
        made = replace(base(), gearing=run, curve=neutral_curve(run))
        assert 1e3 * interference(made, 0.1).gap == pytest.approx(gap, abs=6e-3)


def by_complex_numbers(made, angles):
    """Return gaps of tip and corner at poses, infinite where they do not count: own kinematics."""
    gear, curve = made.gearing, made.curve
    rho, slope = radii(curve, angles)[:2]
    turn = gear.teeth / gear.circular_teeth * arc_angle(curve, angles)
    place = rho * np.exp(1j * (angles - turn))
    axis = np.exp(1j * (angles - np.arctan2(slope, rho) - turn))
    flex = made.contacts.point
    base, top = gear.base_radius, gear.tip_radius
    tip = place + axis * complex(flex.x[-1], flex.y[-1])
    pressure = np.arccos(np.minimum(base / np.abs(tip), 1.0))
    room = base * (gear.half_angle - np.tan(pressure) + pressure - np.angle(tip))
    end = np.arccos(base / top)
    corner = (top * np.exp(1j * (gear.half_angle - np.tan(end) + end)) - place) / axis
    beside = (corner.real < flex.x[0]) | (corner.real > flex.x[-1])
    lean = np.interp(corner.real, flex.x, np.gradient(flex.y, flex.x))
    off = (corner.imag - np.interp(corner.real, flex.x, flex.y)) / np.sqrt(1.0 + lean**2)
    return np.minimum(np.where(np.abs(tip) < top, np.inf, room), np.where(beside, np.inf, off))


@pytest.mark.parametrize(
    "wave", ["cosine", *(pytest.param(w, marks=pytest.mark.slow) for w in ("ellipse", "discs"))]
)
def test_least_gaps_are_true_minima(wave):
    """The tip cuts most as it passes the corner: poses of 1e-3 degrees come near, 1e-7 meet it."""
    made = flank(StrainWave(0.5, 160, np.radians(18.0), 0.3, 0.8, 1.1, 1.0, wave=wave))
    found = least_gaps(made)[0]
    assert found.passing and found.point == 1.0 and found.gap < -0.002
    whole = np.radians(np.arange(-90.0, 90.0, 1e-3))
    gaps = by_complex_numbers(made, whole)
    near = whole[gaps.argmin()]
    fine = by_complex_numbers(made, near + np.radians(np.arange(-2e-3, 2e-3, 1e-7)))
    assert found.gap <= gaps.min() < found.gap + 1e-5
    assert found.gap == pytest.approx(fine.min(), abs=2e-9)
    assert found.angle == pytest.approx(near, abs=2e-5)


@pytest.mark.slow
def test_least_gaps_of_random_gearings():
    """No pose of a dense check lies lower by a nm; where it is higher, it missed the passage."""
    draw = np.random.default_rng(22)
    cutting = 0
    for k in range(12):
        x, h_a, angle = draw.uniform(0, 2), draw.uniform(0.4, 0.9), draw.uniform(15, 30)
        numbers = (x, h_a, draw.uniform(0.97, 1.25), draw.uniform(0.4, 1.4))
        wave = ("cosine", "ellipse", "discs")[k % 3]
        made = flank(StrainWave(0.5, 160, np.radians(angle), *numbers, wave=wave))
        found = least_gaps(made)[0]
        whole = np.radians(np.arange(-90.0, 90.0, 2e-3))
        gaps = by_complex_numbers(made, whole)
        fine = by_complex_numbers(
            made, whole[gaps.argmin()] + np.radians(np.arange(-3e-3, 3e-3, 1e-6))
        )
        assert found.gap == pytest.approx(min(fine.min(), 0.0), abs=2e-7)
        cutting += not found.free
    assert cutting


def test_a_polynomial_replaces_the_flank():
    """The corner's distance to the flank: seven points are enough; a circle is met to 1e-9."""
    angle = np.radians(np.linspace(100.0, 103.0, 7))
    points = tuple(Vector(-14.0 * np.cos(a), 14.0 * np.sin(a)) for a in angle)
    height = -14.0 * np.cos(np.radians(101.23))
    assert thickness_at(points, height) == pytest.approx(14 * np.sin(np.radians(101.23)), abs=1e-9)
    many, few = (clearances(base(), poses(1.0, 20.0), n) for n in (201, 51))
    assert np.nanmax(np.abs(many - few)[np.isfinite(many) & np.isfinite(few)]) < 1e-4
    assert np.isinf(clearances(base(), np.radians([89.0]))).all()
