"""Teeth that are hard on a model of stiffness: undercut, pointed, and gears of any shape."""

import numpy as np
import pytest
from campaigns import few
from reference_pairs import elastic, five

from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.contact import contact_path, usable_path
from gearopt.physics.geometry.fillet import form_diameter, profile
from gearopt.physics.geometry.flaws import flaws
from gearopt.physics.geometry.tooth import tip_thickness
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.finite_elements import fineness_of, pair_compliance
from gearopt.physics.tooth.ladder import LEVELS, USUAL, tabulated
from gearopt.physics.tooth.mesh import gear_mesh
from gearopt.physics.tooth.validity import cheapest, doubts, unsupported


def pinion_of(teeth, shift=0.0):
    return GearPair.of_teeth(3.0, teeth, 50, 30.0, profile_shifts=(shift, 0.0))


@pytest.mark.parametrize(
    ("teeth", "joint", "waist", "nominal", "usable"),
    [
        (8, 1.0128, 0.811, 1.531, 0.913),
        (9, 1.0086, 0.855, 1.547, 1.003),
        (10, 1.0058, 0.889, 1.562, 1.093),
        (12, 1.0023, 0.937, 1.588, 1.275),
        (14, 1.0007, 0.966, 1.609, 1.459),
        (17, 1.0000, 0.990, 1.635, 1.635),
    ],
)
def test_undercut(teeth, joint, waist, nominal, usable):
    """R_j/r_b, waist over the chord where the fillet ends, contact ratios; another program's."""
    pair = pinion_of(teeth)
    pinion = pair.pinion
    x, _ = profile(pinion, 2000, 2)
    assert form_diameter(pinion) / pinion.base_diameter == pytest.approx(joint, abs=6e-5)
    assert x[:2000].min() / x[1999] == pytest.approx(waist, abs=6e-4)
    assert contact_path(pair).transverse_ratio == pytest.approx(nominal, abs=6e-4)
    assert usable_path(pair).transverse_ratio == pytest.approx(usable, abs=6e-4)


def test_an_undercut_tooth_deforms_by_its_profile_but_not_as_a_trapezoid():
    pair = ElasticPair(pinion_of(12), (12.0, 50.0))
    at = five(pair)
    made = LEVELS[USUAL].compliance(pair, at, 3000.0)
    assert np.isfinite(made).all() and (made > 0.0).all()
    with pytest.raises(ValueError, match="undercut tooth has a waist"):
        LEVELS["trapezoid + Sainsot"].compliance(pair, at, 3000.0)
    assert "a trapezoid has no waist" in unsupported(pair, "trapezoid + Sainsot")[0]
    assert any("from the form circle outwards" in each for each in doubts(pair, USUAL))
    assert cheapest(pair, 0.08) != "trapezoid + Sainsot" == cheapest(elastic("reference"), 0.08)


def test_the_waist_bends_more_than_the_same_tooth_without_it():
    table = tabulated(ElasticPair(pinion_of(8), (9.0, 50.0)).members[0])
    across, up = profile(pinion_of(8).pinion, 400, 400)
    filled = np.interp(np.maximum(up, up[399]), up, across)
    full = np.trapezoid((2.0 * np.maximum(across, filled)) ** -3, up)
    assert table.bending[0][-1] > full


def test_contact_that_breaks_off_is_said():
    pair = ElasticPair(pinion_of(8), (9.0, 50.0))
    assert any("contact ratio of 0.913: contact breaks off" in each for each in doubts(pair, USUAL))


@pytest.mark.parametrize(
    ("teeth", "shift", "known"),
    [(12, 0.5, 0.2851), (12, 0.7, 0.1133), (10, 0.8, -0.1092), (25, 1.2, 0.1556)],
)
def test_pointed_teeth(teeth, shift, known):
    """Tip thickness in modules, of another program; below 0.2 said, below 0 refused."""
    pair = pinion_of(teeth, shift)
    assert tip_thickness(pair.pinion) / 3.0 == pytest.approx(known, abs=6e-5)
    if known < 0.0:
        with pytest.raises(ValueError, match="pointed"):
            ElasticPair(pair, (10.0, 50.0))
        return
    said = doubts(ElasticPair(pair, (10.0, 50.0)), USUAL)
    thin = [each for each in said if "tips of the pinion" in each]
    assert len(thin) == (known < 0.2)
    assert not thin or f"{known:.2f} m_n thick" in thin[0]


@pytest.mark.parametrize("seed", few(range(40), 2))
def test_every_gear_is_meshed_by_convex_quadrilaterals(seed):
    """Undercut, shifted, of a tool without room for its tip, on a ring as thick as a tooth."""
    rng = np.random.default_rng(seed)
    made = 0
    while made < 5:
        angle, radius = np.radians(rng.choice([14.5, 20.0, 25.0])), rng.uniform(0.05, 0.39)
        rack = Rack(angle, 1.0, rng.uniform(1.15, 1.4), radius)
        teeth = int(rng.integers(8, 60)), int(rng.integers(12, 150))
        shifts = rng.uniform(-0.3, 0.8), rng.uniform(-0.3, 0.5)
        pair = GearPair.of_teeth(3.0, *teeth, 30.0, rack=rack, profile_shifts=shifts)
        if any(flaw.fatal for flaw in flaws(pair)):
            continue
        ratios = rng.uniform(1.2, 6.0, 2)
        bores = [float(gear.root_diameter) for gear in pair.gears] / ratios
        made_of = ElasticPair(pair, (bores[0], bores[1]))
        made += 1
        for member, fine in zip(made_of.members, fineness_of(made_of, 3000.0, 0), strict=True):
            mesh = gear_mesh(member.gear, member.bore, fine)
            sides = np.roll(mesh.points[:, mesh.quads], -1, axis=1) - mesh.points[:, mesh.quads]
            after = np.roll(sides, -1, axis=1)
            turn = sides[0] * after[1] - sides[1] * after[0]
            assert (turn > 0.1 * np.hypot(*sides) * np.hypot(*after)).all()


@pytest.mark.slow
def test_finite_elements_of_an_undercut_pinion_are_near_its_profile():
    pair = ElasticPair(pinion_of(10), (12.0, 50.0))
    at = five(pair)[1:4]
    error = pair_compliance(pair, at, 3000.0) / LEVELS[USUAL].compliance(pair, at, 3000.0) - 1.0
    assert np.abs(error).max() < 0.15
