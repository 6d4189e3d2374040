"""Gears and gear pairs against a printed report, a paper's table, closed forms and themselves."""

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.gears import (
    Gear,
    GearPair,
    Rack,
)
from gearopt.physics.loads import pitch_line_velocity

# KISSsoft report of 03/2017, high-speed pair of the NREL 5 MW gearbox (gfsReboucas/Drivetrain,
# @NREL_5MW/stage_03.rtf): z 24/95, m_n 14, beta 10, x 0.48/0.6691, k m_n -0.938, a 861, b 360.
# Printed: d, d_b, d_a, d_f, alpha_t, alpha_wt, g_alpha, eps_alpha, eps_beta, v at 1165.9 rpm.
MODULE, HELIX, SHIFTS, SHORTER = 14.0, math.radians(10.0), (0.48, 0.6691), -0.938
REFERENCE, BASE = (341.183, 1350.517), (320.026, 1266.77)
TIP, ROOT = (380.747, 1395.376), (319.623, 1334.252)
REPORT = GearPair.of_teeth(MODULE, 24, 95, 360.0, HELIX)

# Chong and Lee, Table 2: m, z1, z2, d1, a, b; helix angle 25 degrees
PROCESS_ONE = [(2, 25, 124, 55.17, 164.4, 33.1), (3, 25, 109, 82.75, 221.76, 62.1)]

MEMBERS = (
    "reference_diameter",
    "tip_diameter",
    "root_diameter",
    "base_diameter",
    "volume",
)
OF_PAIR = (
    "ratio",
    "centre_distance",
    "volume",
    "base_pitch",
    "transverse_contact_ratio",
    "overlap_ratio",
)


def test_diameters_of_a_printed_report():
    """Its gears are shifted and shortened, which is taken away first."""
    rows = zip(REPORT.gears, SHIFTS, REFERENCE, BASE, TIP, ROOT, strict=True)
    for gear, x, d, d_b, d_a, d_f in rows:
        shift = 2 * x * MODULE
        assert gear.reference_diameter == pytest.approx(d, abs=6e-4)
        assert gear.base_diameter == pytest.approx(d_b, abs=6e-4)
        assert gear.tip_diameter == pytest.approx(d_a - shift - 2 * SHORTER, abs=2e-3)
        assert gear.root_diameter == pytest.approx(d_f - shift, abs=2e-3)
        assert math.degrees(gear.transverse_pressure_angle) == pytest.approx(20.284, abs=6e-4)
    assert REPORT.overlap_ratio == pytest.approx(1.421, abs=6e-4)


def test_a_table_of_a_paper():
    total = 0.0
    for m, z1, z2, d1, a, b in PROCESS_ONE:
        pair = GearPair.of_teeth(m, z1, z2, b, math.radians(25.0))
        assert pair.pinion.reference_diameter == pytest.approx(d1, abs=0.006)
        assert pair.centre_distance == pytest.approx(a, abs=0.03)
        total += pair.volume
    assert total == pytest.approx(8708993, abs=0.6)


def test_contact_ratio_of_a_printed_report():
    """Of its shifted gears at their working centre distance."""
    gears = [
        replace(gear, profile_shift=x, tip_alteration=SHORTER / MODULE)
        for gear, x in zip(REPORT.gears, SHIFTS, strict=True)
    ]
    pair, pitch = GearPair(*gears, 861.0), REPORT.base_pitch
    assert math.degrees(pair.working_angle) == pytest.approx(22.856, abs=6e-4)
    assert pair.transverse_contact_ratio == pytest.approx(1.463, abs=6e-4)
    assert pair.transverse_contact_ratio * pitch == pytest.approx(
        61.276, abs=0.01
    )  # alpha_wt is printed to 1e-3 degrees
    speed = 1165.9 * math.pi / 30.0
    assert 1e-3 * pitch_line_velocity(speed, REFERENCE[0]) == pytest.approx(20.83, abs=6e-3)


def test_a_textbook_pair():
    """Shigley, example 14-5: 17/52 teeth, P_n 10, phi_n 20, psi 30: Z 0.4507 in, m_N 0.6895."""
    pair = GearPair.of_teeth(0.1, 17, 52, 1.0, math.radians(30.0))  # in inches
    line = pair.transverse_contact_ratio * pair.base_pitch
    assert line == pytest.approx(0.4507, rel=2e-3)  # the book rounds radii and angles
    normal = math.pi * 0.1 * math.cos(pair.pinion.rack.pressure_angle)
    assert normal / (0.95 * line) == pytest.approx(0.6895, rel=2e-3)


@pytest.mark.parametrize(("z1", "z2", "helix"), [(18, 18, 0), (21, 115, 25), (22.4, 95.5, 12)])
def test_the_path_of_contact_lies_between_the_tip_circles(z1, z2, helix):
    """Points of the line of action through the pitch point that lie inside both tip circles."""
    m = 2.0
    pair = GearPair.of_teeth(m, z1, z2, 10.0, math.radians(helix))
    angle = pair.pinion.transverse_pressure_angle
    steps = np.linspace(-6 * m, 6 * m, 2_000_001)
    x, y = steps * math.sin(angle), steps * math.cos(angle)
    r1, r2 = (gear.reference_diameter / 2 for gear in pair.gears)
    inside = (np.hypot(x + r1, y) < pair.pinion.tip_diameter / 2) & (
        np.hypot(x - r2, y) < pair.wheel.tip_diameter / 2
    )
    pitch = math.pi * pair.pinion.base_diameter / z1
    assert pair.base_pitch == pytest.approx(pitch, rel=1e-14)
    expected = inside.sum() * (steps[1] - steps[0]) / pitch
    assert pair.transverse_contact_ratio == pytest.approx(expected, abs=2e-5)


def test_contact_ratio_of_two_racks_is_the_limit():
    """eps_alpha -> 4 h_aP/(m_n pi sin(2 alpha)) for many teeth: 1.981 at 20 degrees."""
    pair = GearPair.of_teeth(1.0, 1e7, 1e7, 1.0)
    expected = 4.0 / (math.pi * math.sin(2.0 * pair.pinion.rack.pressure_angle))
    assert pair.transverse_contact_ratio == pytest.approx(expected, rel=1e-4)


def test_hands_of_the_helix_do_not_count():
    left, right = (GearPair.of_teeth(2.0, 20, 50, 40.0, beta) for beta in (-0.3, 0.3))
    assert left.overlap_ratio == right.overlap_ratio > 0.0
    assert GearPair.of_teeth(2.0, 20, 50, 40.0).overlap_ratio == 0.0
    for name in OF_PAIR:
        assert getattr(left, name) == getattr(right, name)


def test_a_rack_of_other_teeth():
    gear = Gear(2.0, 30, 60.0, 10.0, rack=Rack(math.radians(25.0), addendum=0.8, dedendum=1.1))
    assert (gear.tip_diameter, gear.root_diameter) == pytest.approx((63.2, 55.6))
    assert gear.base_diameter == pytest.approx(60.0 * math.cos(math.radians(25.0)))


def test_a_pair_by_its_pinion_is_the_pair_by_its_teeth():
    """And another face width changes nothing else."""
    d1 = REPORT.pinion.reference_diameter
    same = GearPair.of_diameter(MODULE, 24, d1, 95 / 24, 100.0, HELIX).of_width(360.0)
    for name in OF_PAIR:
        assert getattr(same, name) == pytest.approx(getattr(REPORT, name), rel=1e-15)
    assert same.wheel.teeth == pytest.approx(95, rel=1e-15)
    assert same.pinion == REPORT.pinion


def test_two_gears_make_a_pair():
    """Identities of volume, mass, inertia, centre distance and pitch."""
    rho = 7.85e-9
    for gear in REPORT.gears:
        assert gear.mass(rho) == pytest.approx(rho * gear.volume, rel=1e-15)
        expected = gear.mass(rho) * gear.reference_diameter**2 / 8
        assert gear.inertia(rho) == pytest.approx(expected, rel=1e-15)
    pinion, wheel = REPORT.gears
    assert pinion.volume + wheel.volume == pytest.approx(REPORT.volume, rel=1e-15)
    both = pinion.reference_diameter + wheel.reference_diameter
    assert REPORT.centre_distance == pytest.approx(both / 2, rel=1e-15)
    assert wheel.reference_diameter == pytest.approx(
        pinion.reference_diameter * REPORT.ratio, rel=1e-15
    )


def _made(x):
    """Every number of a pair with module, teeth, width and helix angle x."""
    pair = GearPair.of_teeth(x[0], x[1], x[2], x[3], x[4])
    found = [getattr(gear, name) for gear in pair.gears for name in MEMBERS]
    found += [gear.inertia(7.85e-9) for gear in pair.gears]
    found += [gear.mass(7.85e-9) for gear in pair.gears]
    found.append(pitch_line_velocity(x[1], pair.pinion.reference_diameter))
    return [*found, *(getattr(pair, name) for name in OF_PAIR)]


def test_traced_equals_batch_and_derivatives_central_differences():
    point = np.array([2.3, 21.0, 54.0, 27.8, 0.37])
    x = ca.SX.sym("x", 5)
    with legacy_numpy():
        values = ca.vertcat(*_made(ca.vertsplit(x)))
    function = ca.Function("pair", [x], [values, ca.jacobian(values, x)])
    traced, slopes = (np.array(v) for v in function(point))
    batch = np.array(_made(np.tile(point, (3, 1)).T))
    assert batch == pytest.approx(np.tile(traced, (1, 3)), rel=1e-13)
    for k in range(5):
        step = 1e-6 * point[k] * np.eye(5)[k]
        ends = [np.array(_made(point + s * step)) for s in (1, -1)]
        slope = (ends[0] - ends[1]) / (2 * step[k])
        assert slopes[:, k] == pytest.approx(slope, rel=1e-6, abs=1e-7 * abs(traced).max())
