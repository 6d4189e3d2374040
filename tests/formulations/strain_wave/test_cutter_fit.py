"""Straight and circular cutting edges of least largest deviation."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import linprog

from gearopt.formulations.strain_wave.cutter_fit import arc_edge, arc_of_cones, straight_edge
from gearopt.formulations.strain_wave.cutter_report import Cutter, cutter_of
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import blank_profile, envelope
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.vectors import Vector

BASE = StrainWave(0.5, 160, profile_shift=0.9)
# angle deg, deviation um, by least squares um, arc R mm, deviation um, fixed 20 deg um
TABLE = {
    "base": (BASE, 20.097, 0.0623, 0.0838, 357.0, 4.5e-4, 0.51),
    "15 deg": (
        replace(BASE, pressure_angle=np.radians(15.0), addendum=0.5),
        *(15.128, 0.0507, 0.0685, 260.0, 4.7e-4, 19.5),
    ),
    "28 deg": (
        replace(BASE, pressure_angle=np.radians(28.0)),
        *(28.061, 0.0539, 0.0721, 501.0, 2.3e-4, 46.1),
    ),
    "320:1": (
        replace(BASE, teeth=640, module=0.2, rim=1.6),
        *(20.021, 0.0017, 0.0022, 2328.0, 4e-6, 0.05),
    ),
}


@cache
def edge(name, count=301, radius=np.inf):
    gearing = TABLE[name][0]
    points = envelope(blank_profile(flank(gearing, 301)), gearing.blank_radius, radius)
    return points.profile.points[np.linspace(0, 300, count).astype(int)]


@pytest.mark.slow
@pytest.mark.parametrize("name", TABLE)
def test_fits_agree_with_a_table_made_elsewhere(name):
    _, angle, deviation, squares, radius, arc, fixed = TABLE[name]
    line = straight_edge(edge(name))
    assert line.result.status == "optimal"
    assert np.degrees(line.angle) == pytest.approx(angle, abs=6e-4)
    assert 1e3 * line.deviation == pytest.approx(deviation, abs=6e-5)
    assert 1e3 * line.least_squares == pytest.approx(squares, abs=6e-5)
    assert 1.0 - line.deviation / line.least_squares == pytest.approx(0.26, abs=0.02)
    found = straight_edge(edge(name), np.radians(20.0))
    assert 1e3 * found.deviation == pytest.approx(fixed, rel=0.08)
    assert found.angle == pytest.approx(np.radians(20.0), rel=1e-12)
    round_ = arc_edge(edge(name))
    assert round_.result.status == "optimal" and round_.rounds < 5
    assert round_.radius == pytest.approx(radius, abs=0.6)
    assert 1e3 * round_.deviation == pytest.approx(arc, rel=0.09)


def test_the_straight_edge_is_that_of_another_linear_program():
    points = edge("base", 61)
    u = points.x - points.x.mean()
    rows = np.c_[np.ones_like(u), u]
    ones = -np.ones((len(u), 1))
    found = linprog(
        [0, 0, 1],
        A_ub=np.r_[np.c_[rows, ones], np.c_[-rows, ones]],
        b_ub=np.r_[points.y, -points.y],
        bounds=[(None, None)] * 2 + [(0, None)],
        method="highs",
    )
    line = straight_edge(points)
    normal = np.cos(line.angle)
    assert line.deviation == pytest.approx(found.fun * normal, abs=1e-9)
    off = (points.y - line.offset + np.tan(line.angle) * points.x) * normal
    assert np.abs(off).max() == pytest.approx(line.deviation, rel=1e-6)
    assert (off.max(), off.min()) == pytest.approx((line.deviation, -line.deviation), rel=1e-6)


def test_an_arc_is_found_exactly_in_any_place():
    angle = np.linspace(0.3, 0.9, 31)
    points = Vector(5.0 + 2.5 * np.cos(angle), -1.0 + 2.5 * np.sin(angle))
    found = arc_edge(points)
    assert found.radius == pytest.approx(2.5, rel=1e-8) and found.deviation < 1e-9
    assert (found.centre.x, found.centre.y) == pytest.approx((5.0, -1.0), abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("radius", [10.0, np.inf])
def test_cones_agree_with_linear_programs(radius):
    """Begun beside the answer they come back to it; no arc near it deviates less."""
    points = edge("base", 31, radius)
    found = arc_edge(points)
    away = points[15] + (found.centre - points[15]) * 1.2
    again = arc_of_cones(points, replace(found, centre=away))
    assert again.result.status == "optimal" and again.rounds > 1
    assert again.deviation == pytest.approx(found.deviation, rel=1e-6)
    assert again.radius == pytest.approx(found.radius, rel=1e-6)
    rng = np.random.default_rng(0)
    for _ in range(50):
        centre = found.centre + Vector(*rng.normal(0.0, 1e-4 * found.radius, 2))
        far = (points - centre).length
        assert 0.5 * np.ptp(far) >= found.deviation * (1.0 - 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("least", [500.0, 1000.0])
def test_a_tool_of_a_least_radius(least):
    """A flat parabola less an arc: of the straight edge's deviation 1 - R/R_min is left."""
    points = edge("base", 31)
    found, line = arc_edge(points), straight_edge(points)
    round_ = arc_of_cones(points, found, least)
    assert round_.result.status == "optimal" and round_.radius == pytest.approx(least, rel=1e-9)
    left = line.deviation * (1.0 - found.radius / least)
    assert round_.deviation == pytest.approx(left, rel=0.01)
    far = (points - round_.centre).length - round_.radius
    assert (far.max(), far.min()) == pytest.approx((round_.deviation, -round_.deviation), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("least", [50.0, 5e4])
def test_a_tool_flatter_than_the_edge_of_a_pinion_type_cutter(least):
    """R 1.4 to 3 mm: Gauss's steps with scipy's linear programs for an arc of this radius."""
    points = edge("base", 51, 15.0)
    found = arc_of_cones(points, arc_edge(points), least)
    z = np.array(points.x) + 1j * np.array(points.y)
    turn = (z[-1] - z[0]) / abs(z[-1] - z[0])
    z = (z - z[0]) / turn * 1j  # the chord along the imaginary axis
    side = np.sign(((found.centre.x + 1j * found.centre.y - points.x[0] - 1j * points.y[0])
                    / turn * 1j).real)  # fmt: skip
    centre = side * least + z.imag.mean() * 1j
    for _ in range(20):
        away = z - centre
        lean = away / abs(away)
        rows = np.stack([lean.real, lean.imag * least], axis=1)
        left, ones = abs(away) - least, np.ones((len(z), 1))
        limits = np.block([[-rows, -ones], [rows, -ones]])
        step = linprog([0, 0, 1], limits, np.concatenate([-left, left]), bounds=[(None, None)] * 3)
        centre += step.x[0] + 1j * least * step.x[1]
    assert found.radius == pytest.approx(least, rel=1e-9)
    assert found.deviation == pytest.approx(abs(abs(z - centre) - least).max(), rel=1e-6)
    assert found.deviation < straight_edge(points).deviation


def test_no_arc_of_any_radius_deviates_less():
    """With a radius given the best arc is a straight line through heights less that arc's."""
    points = edge("base", 31)
    found = arc_edge(points)
    lean = (points[30] - points[0]).angle
    flat = (points - points[15]).turned(-lean)
    line = np.c_[np.ones(31), flat.x, -np.ones(31)]
    deviations = []
    for radius in found.radius * np.array([-4.0, 0.25, 0.5, 0.98, 1.0, 1.02, 2.0, 4.0]):
        sag = 1e6 * (flat.y - np.copysign(np.sqrt(radius**2 - flat.x**2), radius) + radius)
        rows = np.r_[line, line * [-1.0, -1.0, 1.0]]
        one = linprog([0, 0, 1], A_ub=rows, b_ub=np.r_[sag, -sag], bounds=[(None, None)] * 3)
        deviations.append(1e-6 * one.fun)
    assert min(deviations) == deviations[4] == pytest.approx(found.deviation, rel=1e-4)


@pytest.mark.slow
def test_the_report_tells_the_arc_of_a_tool():
    """357 mm is the best; a tool of at least 500 mm gets that, one of at least 100 mm the best."""
    blank = blank_profile(flank(BASE))
    for least, radius in ((100.0, 356.66), (500.0, 500.0)):
        found = cutter_of(BASE, blank, Cutter(least_radius=least))
        assert found.arc_radius_mm == pytest.approx(radius, abs=5e-3)
        assert found.least_radius_mm == least


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "low", "high"),
    [
        ([{"profile_shift": x} for x in (0.0, 0.5, 2.0)], 20.04, 20.12),
        ([{"deflection": w} for w in (0.97, 1.1, 1.2)], 20.04, 20.12),
        ([{"neutral": 38.5}], 20.255, 20.265),
        ([{"teeth": 60, "module": 1.2}], 20.415, 20.425),
    ],
    ids=["profile shift", "deflection", "neutral radius", "30:1"],
)
def test_the_hob_of_a_20_degree_gearing_is_near_20_degrees(changes, low, high):
    for change in changes:
        gearing = replace(BASE, **change)
        blank = blank_profile(flank(gearing, 61))
        line = straight_edge(envelope(blank, gearing.blank_radius).profile.points)
        assert low < np.degrees(line.angle) < high and line.deviation < 1e-3
