"""Half-locus and double-arc teeth."""

import numpy as np
import pytest

from gearopt.physics.strain_wave.circular_arc import (
    DoubleArc,
    half_locus_flanks,
    half_locus_gaps,
    rack_locus,
    teeth_on_path,
)
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import neutral_curve
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


def test_a_double_arc_is_smooth_and_lies_on_its_circles():
    tooth = DoubleArc((0.685, 0.785), np.radians(12.0), Vector(0.8, 0.38), 0.05)
    made = tooth.profile(0.4, 1.2, 4001)
    points, low, high = made.points, 0.8 - 0.05 * np.cos(0.2094), 0.8 + 0.05 * np.cos(0.2094)
    assert (np.diff(points.x) > 0.0).all() and (np.diff(points.y) < 0.0).all()
    for inside, centre, radius in zip(
        (points.x > high, points.x < low), tooth.centres, tooth.radii, strict=True
    ):
        assert inside.sum() > 1000
        assert (points[inside] - centre).length == pytest.approx(radius, rel=1e-12)
    slope = np.diff(points.y) / np.diff(points.x)
    assert np.abs(np.diff(slope)).max() < 1e-3
    middle = slice(1, -1)
    steps = (points.y[2:] - points.y[:-2]) / (points.x[2:] - points.x[:-2])
    assert made.directions.y[middle] / made.directions.x[middle] == pytest.approx(steps, abs=1e-4)
    bent = -np.diff(np.arctan(slope)) / np.hypot(np.diff(points.x), np.diff(points.y))[1:]
    off = np.abs(np.abs(bent) - np.abs(made.curvatures[middle]))
    assert np.median(off) < 5e-4


def test_an_arc_that_reaches_the_tip_has_a_least_radius():
    """At the least radius the slope of the tip is 85 degrees; below it the arc ends before."""
    tooth = DoubleArc((1.0, 1.0), np.radians(12.0), Vector(0.8, 0.38), 0.05)
    least = tooth.least_radius(0.4)
    assert least == pytest.approx(
        (0.4 - 0.05 * np.cos(0.2094395)) / (np.sin(1.4835299) - 0.2079117)
    )
    made = DoubleArc((least, 1.0), np.radians(12.0), Vector(0.8, 0.38), 0.05).profile(0.4, 1.2)
    assert np.degrees(np.arctan2(-made.directions.y[-1], made.directions.x[-1])) == pytest.approx(
        85
    )
