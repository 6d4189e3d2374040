"""Paths of contact, contact ratios and sliding against printed values and the gears' kinematics."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import (
    active_root_diameters,
    contact_path,
    diameters_at,
    specific_sliding,
    usable_path,
)
from gearopt.physics.geometry.fillet import half_angle, profile_angle
from gearopt.physics.geometry.tooth import tip_thickness, virtual_teeth


def report():
    """KISSsoft report of 03/2017, NREL 5 MW gearbox, high-speed pair (k m_n = -0.938 mm)."""
    pair = GearPair.of_teeth(14.0, 24, 95, 360.0, math.radians(10.0), profile_shifts=(0.48, 0.6691))
    gears = [replace(gear, tip_alteration=-0.938 / 14.0) for gear in pair.gears]
    return GearPair(*gears, 861.0)


def test_a_printed_report_to_its_last_digit():
    """gfsReboucas/Drivetrain, @NREL_5MW/stage_03.rtf."""
    pair = report()
    tips = [gear.tip_diameter for gear in pair.gears]
    assert tips == pytest.approx([380.747, 1395.376], abs=6e-4)
    assert pair.working_diameters == pytest.approx((347.294, 1374.706), abs=6e-4)
    assert math.degrees(pair.working_angle) == pytest.approx(22.856, abs=6e-4)
    assert active_root_diameters(pair) == pytest.approx((330.798, 1348.584), abs=6e-4)
    assert contact_path(pair).length == pytest.approx(61.276, abs=6e-4)
    assert usable_path(pair).transverse_ratio == pytest.approx(1.463, abs=6e-4)
    assert pair.overlap_ratio == pytest.approx(1.421, abs=6e-4)
    assert [tip_thickness(gear) for gear in pair.gears] == pytest.approx([8.8, 11.034], abs=6e-4)
    normal = (25.037, 99.104)  # the report's z_n by z/(cos(beta_b)^2 cos(beta))
    assert [virtual_teeth(gear) for gear in pair.gears] == pytest.approx(normal, abs=6e-4)


def test_iso_tr_6336_30_example_1():
    """z 17/103, m_n 8, beta 15.8, x 0.14522/0: tip diameters 159.66, 872.35; a 500; z_n."""
    pair = GearPair.of_teeth(8.0, 17, 103, 100.0, math.radians(15.8), profile_shifts=(0.14522, 0))
    tips = [gear.tip_diameter for gear in pair.gears]
    assert tips == pytest.approx([159.66, 872.35], abs=6e-3)
    assert pair.centre_distance == pytest.approx(500.0, abs=6e-3)
    virtual = [virtual_teeth(gear) for gear in pair.gears]
    assert virtual == pytest.approx([18.905, 114.543], abs=6e-4)
    # the tangential force at the reference circle that it prints for 9000 N m
    assert 2 * 9e6 / pair.pinion.reference_diameter == pytest.approx(127352, abs=0.6)


# Digest of the profile modification paper, section 3: m, z, x; s of SAP, LPSTC, HPSTC, EAP; eps
DIGEST = [
    ((3.0, 25, 50), (0.0, 0.0), (-7.7700, -1.7197, 1.0864, 7.1367), 1.6831622619773194),
    ((4.0, 18, 40), (0.3, -0.1), (-7.6756, -1.2957, 4.1329, 10.5128), 1.540281),
]


@pytest.mark.parametrize(("teeth", "shifts", "points", "ratio"), DIGEST)
def test_points_of_the_digest(teeth, shifts, points, ratio):
    path = contact_path(GearPair.of_teeth(*teeth, 30.0, profile_shifts=shifts))
    found = path.start, path.lowest_single, path.highest_single, path.end
    assert found == pytest.approx(points, abs=6e-5)
    assert path.transverse_ratio == pytest.approx(ratio, rel=4e-7)
    pair = GearPair.of_teeth(*teeth, 30.0, profile_shifts=shifts)
    assert pair.transverse_contact_ratio == pytest.approx(path.transverse_ratio, rel=1e-13)


def test_radii_of_the_digest():
    pair = GearPair.of_teeth(3.0, 25, 50, 30.0)
    path = contact_path(pair)
    at = np.array([path.start, path.lowest_single, 0.0, path.highest_single, path.end])
    first, second = diameters_at(pair, path, at)
    assert first / 2 == pytest.approx([35.5993, 36.9472, 37.5, 37.8853, 40.5], abs=6e-5)
    assert second / 2 == pytest.approx([78.0, 75.6054, 75.0, 74.6354, 72.8684], abs=6e-5)


def test_load_angles_of_the_digest():
    """Angle of the load to the normal of the centre line, at SAP, LPSTC, pitch, HPSTC, EAP."""
    pair = GearPair.of_teeth(3.0, 25, 50, 30.0)
    path = contact_path(pair)
    at = np.array([path.start, path.lowest_single, 0.0, path.highest_single, path.end])
    expected = (
        [3.766, 13.604, 16.400, 18.166, 28.004],
        [24.517, 19.598, 18.200, 17.317, 12.398],
    )
    for gear, diameter, angles in zip(
        pair.gears, diameters_at(pair, path, at), expected, strict=True
    ):
        radius = diameter / 2
        found = np.degrees(profile_angle(gear, radius) - half_angle(gear, radius))
        assert found == pytest.approx(angles, abs=6e-4)


def test_diameters_and_distances_of_the_digest():
    """Section 3: r_b, r_a, r_f, p_b, F_n of the reference pair; alpha_w and a of the second."""
    pair = GearPair.of_teeth(3.0, 25, 50, 30.0)
    radii = [d / 2 for g in pair.gears for d in (g.base_diameter, g.tip_diameter, g.root_diameter)]
    expected = [35.23847, 40.5, 33.75, 70.47695, 78.0, 71.25]
    assert radii == pytest.approx(expected, abs=6e-6)
    assert pair.base_pitch == pytest.approx(8.856394, abs=6e-7)
    assert 2e5 / radii[0] == pytest.approx(5675.615, abs=6e-4)  # of 200 N m
    second = GearPair.of_teeth(4.0, 18, 40, 40.0, profile_shifts=(0.3, -0.1))
    assert math.degrees(second.working_angle) == pytest.approx(21.0270, abs=6e-5)
    assert second.centre_distance == pytest.approx(116.7806, abs=6e-5)


# Digest, section 10: pinion teeth against 50, nominal and usable contact ratio
@pytest.mark.parametrize(
    ("z", "nominal", "usable"),
    [
        (8, 1.531, 0.913),
        (9, 1.547, 1.003),
        (10, 1.562, 1.093),
        (12, 1.588, 1.275),
        (14, 1.609, 1.459),
    ],
)
def test_undercut_shortens_the_path(z, nominal, usable):
    pair = GearPair.of_teeth(3.0, z, 50, 30.0)
    assert contact_path(pair).transverse_ratio == pytest.approx(nominal, abs=6e-4)
    assert usable_path(pair).transverse_ratio == pytest.approx(usable, abs=6e-4)


def test_sliding_is_that_of_two_turning_flanks():
    """Velocities of the two contact points, along the flanks, from omega x r."""
    pair = report()
    path, speed = contact_path(pair), 122.0
    angle = float(pair.working_angle)
    along = np.array([math.sin(angle), math.cos(angle)])  # line of action; x through the axes
    across = np.array([-along[1], along[0]])
    for s in (float(path.start), 5.0, float(path.end)):
        point = s * along
        axes = -pair.working_diameters[0] / 2, pair.working_diameters[1] / 2
        omegas = -speed, speed / pair.ratio
        velocities = []
        for x, omega in zip(axes, omegas, strict=True):
            r = point - np.array([x, 0.0])
            velocities.append(omega * np.array([-r[1], r[0]]))
        tangential = [float(v @ across) for v in velocities]
        normal = [float(v @ along) for v in velocities]
        assert normal[0] == pytest.approx(normal[1], rel=1e-12)
        slide = abs(tangential[0] - tangential[1])
        assert slide == pytest.approx(abs(speed * (1 + 1 / pair.ratio) * s), rel=1e-9)
        first, second = specific_sliding(path, pair.ratio, s)
        assert first == pytest.approx(1 - tangential[1] / tangential[0], rel=1e-9)
        assert second == pytest.approx(1 - tangential[0] / tangential[1], rel=1e-9)
    assert specific_sliding(path, pair.ratio, 0.0) == pytest.approx((0.0, 0.0), abs=1e-14)


def test_the_mates_tip_beyond_the_tangent_point_has_no_active_diameter():
    first, second = active_root_diameters(GearPair.of_teeth(1.0, 8, 100, 10.0))
    assert math.isnan(first) and second > 0.0
