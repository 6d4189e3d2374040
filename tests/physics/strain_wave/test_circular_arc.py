"""Half-locus and double-arc teeth."""

import numpy as np
import pytest

from gearopt.physics.strain_wave.circular_arc import (
    DoubleArc,
    conjugate_spline,
    half_locus_flanks,
    half_locus_gaps,
    rack_locus,
    teeth_on_path,
)
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import angle_of_arc, neutral_curve
from gearopt.physics.strain_wave.tooth_motion import motion
from gearopt.physics.strain_wave.vectors import Vector


def test_half_locus_teeth_of_a_rack_touch_everywhere():
    """At every pose one point of the moved tooth is on the rigid flank, and both are tangent."""
    angle = np.linspace(0.02, 1.5, 60)
    path = rack_locus(0.5, angle)
    rigid, flexible = half_locus_flanks(path)
    assert (flexible + path - rigid).length.max() == 0.0
    step = 1e-6
    rates = [half_locus_flanks(rack_locus(0.5, angle + s)) for s in (-step, step)]
    ahead, back = (rates[1][k] - rates[0][k] for k in (0, 1))
    assert np.abs(ahead.cross(back)).max() < 1e-15
    gearing = StrainWave(0.5, 160)
    assert teeth_on_path(gearing, np.radians(0.5), np.radians(60.0)) == pytest.approx(26.4, abs=0.1)


def test_the_turn_of_the_tooth_makes_half_locus_teeth_interfere():
    """um at constant diameter, from another program: it falls as the square of the module."""
    found = []
    for teeth in (160, 320, 640):
        gearing = StrainWave(
            80.0 / teeth, teeth, profile_shift=0.0, addendum=0.01, rim=0.01, neutral=40.0
        )
        arcs = np.radians(0.5), np.radians(60.0)
        poses = np.radians(np.arange(0.5, 60.0, 0.5))
        least, _ = half_locus_gaps(gearing, neutral_curve(gearing), arcs, poses)
        found.append(-1e3 * np.nanmin(least))
    assert found == pytest.approx([14.7, 3.7, 0.9], abs=0.06)
    assert np.log2(np.array(found[:-1]) / found[1:]) == pytest.approx([2.0, 2.0], abs=0.02)


def test_the_conjugate_of_an_arc_moves_along_it():
    """The tooth's material at the point of contact slides along the flank, never into it."""
    gearing = StrainWave(0.5, 160, profile_shift=0.9)
    curve = neutral_curve(gearing)
    tooth = DoubleArc((0.685, 0.785), np.radians(12.0), Vector(0.8, 0.38), 0.05)
    arcs, step = np.array([0.05, 0.3, 0.6]), 1e-6
    angle = angle_of_arc(curve, arcs)
    at, before, after = (motion(gearing, curve, angle + s) for s in (0.0, -step, step))
    rows = zip(
        conjugate_spline(gearing, curve, tooth, arcs), tooth.centres, tooth.radii, strict=True
    )
    for place, centre, radius in rows:
        point = at.of_tooth(place)
        arm = point - centre
        assert arm.length == pytest.approx(radius, rel=1e-12)
        speed = (after.placed(point) - before.placed(point)) * (0.5 / step)
        normal = arm.turned(at.turn) * (1.0 / radius)
        assert np.abs(speed.dot(normal) / speed.length).max() < 1e-7


def test_a_double_arc_is_smooth_where_its_parts_meet():
    tooth = DoubleArc((0.685, 0.785), np.radians(12.0), Vector(0.8, 0.38), 0.05)
    points = tooth.points((0.5, 0.5), 4000)
    assert (np.diff(points.x) > 0.0).all() and (np.diff(points.y) < 0.0).all()
    ends = tooth.middle - tooth.direction * 0.05, tooth.middle + tooth.direction * 0.05
    assert (points[3999] - ends[0]).length < 1e-12 and (points[4000] - ends[1]).length < 1e-12
    slope = np.diff(points.y) / np.diff(points.x)
    assert slope[3998] == pytest.approx(slope[3999], abs=2e-4)
    assert slope[3999] == pytest.approx(slope[4000], abs=2e-4)
