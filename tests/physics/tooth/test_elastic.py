"""Elastic teeth: where the force acts, integrals of the profile, torsion, what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from reference_pairs import elastic, force

from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.fillet import form_diameter, profile
from gearopt.physics.geometry.tooth import tip_thickness
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.foundation import torsion_compliance
from gearopt.physics.tooth.ladder import COUPLINGS, LEVELS, tabulated


def test_geometry_of_the_reference_pair_as_another_program_has_it():
    pair = elastic("reference")
    pinion, wheel = pair.members
    assert force("reference") == pytest.approx(5675.614786538198, rel=1e-12)
    assert pair.path.transverse_ratio == pytest.approx(1.6831622619773194, rel=1e-12)
    assert pinion.root_half_angle == pytest.approx(0.1205151856599913, rel=1e-12)
    assert wheel.root_half_angle == pytest.approx(0.06025759282999565, rel=1e-12)
    radii = [35.23847327947156, 70.47694655894313], [33.75, 71.25], [40.5, 78.0]
    joints, thick = [35.47097391076563, 72.47031991045625], [0.7198193893, 0.7754300523]
    gears = pair.pair.gears
    assert [each.base_radius for each in pair.members] == pytest.approx(radii[0], rel=1e-14)
    assert [each.root_radius for each in pair.members] == pytest.approx(radii[1], rel=1e-14)
    assert [0.5 * gear.tip_diameter for gear in gears] == pytest.approx(radii[2], rel=1e-14)
    assert [0.5 * form_diameter(gear) for gear in gears] == pytest.approx(joints, rel=1e-12)
    assert [tip_thickness(gear) / 3.0 for gear in gears] == pytest.approx(thick, rel=1e-9)
    path = pair.path
    assert path.base_pitch == pytest.approx(8.856394302280648, rel=1e-14)
    points = [path.start, path.lowest_single, 0.0, path.highest_single, path.end]
    assert points == pytest.approx([-7.7700, -1.7197, 0.0, 1.0864, 7.1367], abs=5e-5)
    first, second = pair.load_lines(points)
    assert first.radius == pytest.approx([35.5993, 36.9472, 37.5, 37.8853, 40.5], abs=5e-5)
    assert second.radius == pytest.approx([78.0, 75.6054, 75.0, 74.6354, 72.8684], abs=5e-5)
    angles = [3.766, 13.604, 16.400, 18.166, 28.004], [24.517, 19.598, 18.200, 17.317, 12.398]
    assert np.degrees(first.angle) == pytest.approx(angles[0], abs=5e-4)
    assert np.degrees(second.angle) == pytest.approx(angles[1], abs=5e-4)


def test_geometry_of_the_second_pair():
    pair = elastic("second")
    assert np.degrees(pair.pair.working_angle) == pytest.approx(21.0270, abs=5e-5)
    assert pair.pair.centre_distance == pytest.approx(116.7806, abs=5e-5)
    assert force("second") == pytest.approx(17736.296, abs=5e-4)
    joints = [0.5 * form_diameter(gear) for gear in pair.pair.gears]
    assert joints == pytest.approx([34.07967719987271, 76.56051519517268], rel=1e-12)
    path = pair.path
    assert path.transverse_ratio == pytest.approx(1.540281, abs=5e-7)
    assert path.base_pitch == pytest.approx(11.808526, abs=5e-7)
    points = [path.start, path.lowest_single, path.highest_single, path.end]
    assert points == pytest.approx([-7.6756, -1.2957, 4.1329, 10.5128], abs=5e-5)


def test_integrals_of_the_profile_against_a_hundred_times_as_many_points():
    member = elastic("reference").members[0]
    table = tabulated(member)
    top = member.load_line(12.0).height
    across, y = profile(member.gear, 40000, 40000)
    rows = (2.0 * across) ** -3, y * y * (2.0 * across) ** -3, 0.5 / across
    inside = y <= top
    for row, made in zip(rows, (*table.bending[::2], table.slender), strict=True):
        known = np.trapezoid(row[inside], y[inside])
        assert np.interp(top, table.heights, made) == pytest.approx(known, rel=2e-4)


@pytest.mark.parametrize(
    ("name", "known"),
    [("reference", (0.8415267, 1.3241732)), ("second", (1.0814617, 1.1207633))],
)
def test_torsion_of_the_rings(name, known):
    """Micrometres at the load of the pair."""
    pair = elastic(name)
    made = [1e3 * force(name) * torsion_compliance(each) for each in pair.members]
    assert made == pytest.approx(known, rel=1e-6)
    assert COUPLINGS["ring torsion"](pair) == pytest.approx(sum(known) / 1e3 / force(name))
    assert COUPLINGS["none"](pair) == 0.0


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"plane": "shell"}, "no plane 'shell'; known: stress, strain"),
        ({"bores": (0.0, 50.0)}, "bore of the pinion, 0 mm"),
        ({"bores": (30.0, 142.5)}, "bore of the wheel, 142.5 mm"),
    ],
)
def test_what_does_not_deform_is_refused(changed, said):
    with pytest.raises(ValueError, match=said):
        replace(elastic("reference"), **changed)


def test_helical_gears_and_pointed_teeth_are_refused():
    helical = GearPair.of_teeth(3.0, 25, 50, 30.0, 0.2)
    with pytest.raises(ValueError, match="pinion is helical"):
        ElasticPair(helical, (30.0, 50.0))
    pointed = GearPair.of_teeth(3.0, 10, 50, 30.0, profile_shifts=(0.8, 0.0))
    with pytest.raises(ValueError, match="teeth of the pinion are pointed"):
        ElasticPair(pointed, (10.0, 50.0))


@pytest.mark.parametrize("load", [0.0, -5.0, np.array([100.0, np.nan])])
def test_a_contact_without_force_is_refused(load):
    with pytest.raises(ValueError, match="under a force above 0 N"):
        LEVELS["profile + Sainsot"].compliance(elastic("reference"), 0.0, load)


def test_a_place_where_no_teeth_touch_is_refused():
    pair = elastic("reference")
    with pytest.raises(ValueError, match="outside the path of contact"):
        LEVELS["profile + Sainsot"].compliance(pair, pair.path.end + 0.01, 1000.0)
