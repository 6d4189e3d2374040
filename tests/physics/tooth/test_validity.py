"""Undercut, pointed, thin: what is said, refused, and which level is the cheapest that suits."""

from dataclasses import replace

import numpy as np
import pytest
from reference_pairs import elastic, five

from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import contact_path, usable_path
from gearopt.physics.geometry.fillet import form_diameter, profile
from gearopt.physics.geometry.tooth import tip_thickness
from gearopt.physics.tooth.beam import tabulated
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.ladder import LEVELS, USUAL
from gearopt.physics.tooth.validity import cheapest, doubts, unsupported, usual_plane


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
    assert cheapest(pair, 0.05) != "trapezoid + Sainsot" == cheapest(elastic("reference"), 0.05)


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


def test_thin_rings_and_large_ones():
    pair = elastic("reference")
    thin = replace(pair, bores=(67.5 / 1.15, 50.0))
    assert "at 1.15 it is 23 % too soft" in unsupported(thin, USUAL)[0]
    assert unsupported(thin, "finite elements") == ()
    assert any("a real rim is softer" in each for each in doubts(thin, "finite elements"))
    assert cheapest(thin, 0.06) == "profile + Cornell + torsion"
    large = replace(pair, bores=(8.0, 50.0))
    assert any("fitted up to 7" in each for each in doubts(large, USUAL))
    assert unsupported(large, USUAL) == () == unsupported(pair, USUAL)


def test_wide_roots_and_planes():
    assert any("0.167 rad" in each for each in doubts(elastic("second"), USUAL))
    assert not any("pinion" in each for each in doubts(elastic("reference"), "profile + Cornell"))
    narrow = elastic("reference").pair.of_width(12.0)
    assert usual_plane(narrow) == "stress" and usual_plane(elastic("reference").pair) == "strain"
    said = doubts(ElasticPair(narrow, (30.0, 50.0), plane="strain"), "finite elements")
    assert any("plane stress is nearer to the truth" in each for each in said)


@pytest.mark.parametrize(
    ("error", "known"),
    [
        (0.6, "ISO 6336"),
        (0.1, "profile + Cornell + torsion"),
        (0.05, "trapezoid + Sainsot"),
        (0.02, "finite elements"),
        (0.0, "finite elements"),
    ],
)
def test_the_cheapest_level_within_an_error(error, known):
    pair = elastic("reference")
    assert cheapest(pair, error) == known
    made = LEVELS[cheapest(pair, error)]
    assert made.worst <= max(error, 1e-3)
