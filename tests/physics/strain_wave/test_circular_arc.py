"""Half-locus and double-arc teeth."""

import numpy as np
import pytest

from gearopt.physics.strain_wave.circular_arc import DoubleArc, exact_locus, half_locus_tooth
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import neutral_curve
from gearopt.physics.strain_wave.vectors import Vector


def test_half_the_locus_of_very_many_teeth_is_that_of_a_rack():
    """Of a rack: (m/2)(2 phi - sin 2 phi), m cos 2 phi; the tooth is its negative at half scale."""
    gearing = StrainWave(0.01, 20000, addendum=0.75, rim=0.5)
    tooth = half_locus_tooth(gearing, neutral_curve(gearing), 0.0157)
    above = tooth.points.x > tooth.points.x[-1] - 0.0075
    double = np.linspace(2 * np.radians(6.0), 2.2, 4000)
    height = (np.cos(double[0]) - np.cos(double)) * 0.005
    across = (double - np.sin(double) - double[0] + np.sin(double[0])) * 0.0025
    own = tooth.points[above]
    expected = 0.00785 - np.interp(own.x - own.x[0], height, across)
    assert own.y == pytest.approx(expected, abs=2e-5)
    slope = np.gradient(tooth.points.y, tooth.points.x)
    assert (tooth.directions.y / tooth.directions.x)[5:-5] == pytest.approx(slope[5:-5], abs=0.02)


def test_the_turn_of_the_tooth_makes_half_locus_teeth_interfere():
    """um at constant diameter, from another program: it falls as the square of the module."""
    found = []
    for teeth in (160, 320, 640):
        gearing = StrainWave(
            80.0 / teeth, teeth, profile_shift=0.0, addendum=0.01, rim=0.01, neutral=40.0
        )
        curve = neutral_curve(gearing)
        path, _ = exact_locus(gearing, curve, np.radians(np.linspace(0.5, 60.0, 400)))
        rigid, flexible = path * 0.5, path * -0.5
        places, turns = exact_locus(gearing, curve, np.radians(np.arange(0.5, 60.0, 0.5)))
        order, least = np.argsort(rigid.y), []
        for k in range(len(turns)):
            moved = places[k] + flexible.turned(-turns[k])
            inside = (moved.y > rigid.y.min()) & (moved.y < rigid.y.max())
            aside = np.interp(moved.y[inside], rigid.y[order], rigid.x[order]) - moved.x[inside]
            least.append(aside.min() if inside.any() else np.inf)
        found.append(-1e3 * min(least))
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
