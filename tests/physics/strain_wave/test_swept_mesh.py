"""The space that a tooth leaves, against the involute and against conjugates in closed form."""

import math
from functools import cache

import numpy as np
import pytest

from gearopt.physics.strain_wave.circular_arc import DoubleArc, half_locus_tooth, tooth_heights
from gearopt.physics.strain_wave.clearance import tooth_arcs, tooth_clearances
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import Profile
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import angle_of_arc, neutral_curve
from gearopt.physics.strain_wave.swept_mesh import (
    gaps,
    intervals,
    mean_pairs,
    swept_mesh,
    tooth_gaps,
    touching,
)
from gearopt.physics.strain_wave.tooth_motion import motion
from gearopt.physics.strain_wave.vectors import Vector

ARCS = StrainWave(0.5, 160, math.radians(10.0), 0.0, 0.8)
LOCUS = StrainWave(0.5, 160, math.radians(20.0), 0.0, 0.75)


@cache
def involute():
    made = flank(StrainWave(0.5, 160, profile_shift=0.9), 801)
    at = made.contacts
    tooth = Profile(at.point, at.direction, at.curvatures[1])
    return made, swept_mesh(made.gearing, made.curve, tooth)


@cache
def arcs():
    low, middle, high = tooth_heights(ARCS)
    tooth = DoubleArc((0.685, 0.785), math.radians(10.0), Vector(middle, math.pi / 8), 0.025)
    return tooth, swept_mesh(ARCS, neutral_curve(ARCS), tooth.profile(low, high))


def test_the_space_of_a_conjugate_tooth_is_the_involute_again():
    """To 0.01 nm, without the law of gearing; the last radii are reached by the tip alone."""
    made, mesh = involute()
    t = np.sqrt((mesh.radii / made.gearing.base_radius) ** 2 - 1.0)
    involute_half = made.gearing.half_angle - (t - np.arctan(t))
    off = mesh.radii * (mesh.halves - involute_half)
    used = mesh.radii < made.gearing.active_radius - 0.005
    assert used.sum() > 390 and np.abs(off[used]).max() < 1e-8


def test_contact_of_a_conjugate_tooth_is_that_of_the_closed_form():
    """1.096 pairs from another program; the normals' arm is the base radius, 38.0576 mm."""
    made, mesh = involute()
    found = touching(mesh)
    stretches = intervals(found)
    assert np.degrees(stretches) == pytest.approx(np.array([[1.0105, 3.4768]]), abs=2e-3)
    assert mean_pairs(mesh, stretches) == pytest.approx(1.096, abs=1e-3)
    assert found.arms == pytest.approx(38.05755114, abs=1e-7)
    exact = np.interp(found.arcs, made.contacts.motion.arc, made.contacts.gap_curvature)
    assert found.gap_curvature == pytest.approx(exact, rel=1e-6)


def test_clearances_of_a_conjugate_tooth():
    made, mesh = involute()
    places = tooth_arcs(made, np.arange(-5, 6))
    assert tooth_gaps(mesh, places) == pytest.approx(
        tooth_clearances(made, places), rel=5e-3, abs=2e-8
    )


def test_double_arcs_touch_where_the_normal_through_the_instant_centre_passes_the_arc():
    """Every contact on an arc: its normal, the arc's centre and the instant centre are in line."""
    tooth, mesh = arcs()
    found = touching(mesh)
    _, middle, _ = tooth_heights(ARCS)
    on_tip = found.heights > middle + 0.03
    at = motion(ARCS, mesh.curve, angle_of_arc(mesh.curve, found.arcs[on_tip]))
    centre, radius = tooth.centres[0], tooth.radii[0]
    outward = centre - at.of_tooth(at.centre)
    exact = centre + outward * (radius / outward.length)
    other = centre - outward * (radius / outward.length)
    miss = np.minimum(abs(exact.x - found.heights[on_tip]), abs(other.x - found.heights[on_tip]))
    assert on_tip.sum() > 50 and miss.max() < 1e-6


def test_curvature_of_the_space_is_that_of_its_points():
    """A parabola through neighbouring points of the space against the closed form, double arc."""
    _, mesh = arcs()
    found = touching(mesh)
    x, y = mesh.radii * np.cos(mesh.halves), mesh.radii * np.sin(mesh.halves)
    dx, dy = np.gradient(x), np.gradient(y)
    bend = (dx * np.gradient(dy) - dy * np.gradient(dx)) / np.hypot(dx, dy) ** 3
    inside = (found.radii > mesh.radii[120]) & (found.radii < mesh.radii[350])
    seen = np.interp(found.radii[inside], mesh.radii, bend)
    assert inside.sum() > 20
    assert np.median(np.abs(found.curvatures[1][inside] - seen)) < 0.02


def test_nothing_interferes_at_poses_that_were_not_swept():
    for gearing, tooth in ((ARCS, arcs()[1].tooth), (LOCUS, locus())):
        mesh = swept_mesh(gearing, neutral_curve(gearing), tooth)
        found = gaps(mesh, np.radians(np.arange(-89.0, 89.0, 0.5) + 0.0237))
        assert -1e-6 < found.min() < 1e-6


@cache
def locus():
    return half_locus_tooth(LOCUS, neutral_curve(LOCUS), math.pi / 4)


def test_half_locus_teeth_touch_over_a_third_of_the_wave():
    """26 of 160 teeth between 0.5 and 60 degrees, by the rack's identity; here from 6 degrees on.

    The rack's path falls by 1.5 modules from 6 degrees to half of arccos(cos(12) - 1.5) = 60.7.
    """
    mesh = swept_mesh(LOCUS, neutral_curve(LOCUS), locus())
    stretches = intervals(touching(mesh))
    assert mean_pairs(mesh, stretches) == pytest.approx(26.4, rel=0.05)
    assert np.degrees(stretches[-1][1]) == pytest.approx(60.7, abs=3.0)


def test_half_a_locus_is_no_higher_than_its_motion():
    with pytest.raises(ValueError, match=r"half the locus is 1.0\d* modules high"):
        half_locus_tooth(
            StrainWave(0.5, 160, addendum=1.1), neutral_curve(StrainWave(0.5, 160)), 0.78
        )
