"""What models of elastic teeth do not cover is said; the cheapest level within an error."""

from dataclasses import replace

import pytest
from reference_pairs import elastic

from gearopt.physics.gears import GearPair
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.foundation import ring_torsion
from gearopt.physics.tooth.ladder import LEVELS, RINGED, USUAL
from gearopt.physics.tooth.measured import IN_MESH
from gearopt.physics.tooth.validity import (
    cheapest,
    cheapest_in_mesh,
    doubts,
    errors_in_mesh,
    finest,
    refused,
    unsupported,
    usual_level,
    usual_plane,
)


def test_thin_rings_and_large_ones():
    pair = elastic("reference")
    thin = replace(pair, bores=(67.5 / 1.15, 50.0))
    assert "at 1.15 it is 23 % too soft" in unsupported(thin, USUAL)[0]
    assert unsupported(thin, "finite elements") == ()
    assert any("a real rim is softer" in each for each in doubts(thin, "finite elements"))
    assert cheapest(thin, 0.2) == "finite elements"
    large = replace(pair, bores=(8.0, 50.0))  # Sainsot: 6 to 11 % too stiff by finite elements
    assert cheapest(large, 0.1) == "finite elements"
    assert cheapest(large, 0.11) == "profile + Cornell + torsion"
    assert any("fitted up to 7" in each for each in doubts(large, USUAL))
    assert unsupported(large, USUAL) == () == unsupported(pair, USUAL)


def test_bores_for_which_the_fit_means_nothing():
    """Beyond 15 the ring's torsion is nearly all that gives way, and exact: half of Sainsot's."""
    rows = {10.0: (0.85, 0.95), 50.0: (1.8, 2.6)}
    for ratio, (least, most) in rows.items():
        pair = ElasticPair(elastic("reference").pair, (67.5 / ratio, 142.5 / ratio))
        softer = [LEVELS[name].compliance(pair, 0.0, 5e3) for name in (USUAL, RINGED)]
        assert least < softer[0] / softer[1] < most and usual_level(pair) == RINGED
        assert bool(refused(pair, USUAL)) == (ratio > 15.0) and not refused(pair, RINGED)
    assert ring_torsion(pair) > 0.9 * softer[1] and usual_level(elastic("reference")) == USUAL


def test_no_model_is_known_beyond_fifty_bores():
    """A bore of a hundredth of a millimetre turns so far that metres came out."""
    pair = elastic("reference").pair
    for ratio in (51.0, 6750.0):
        for level in LEVELS:
            (said,) = refused(ElasticPair(pair, (67.5 / ratio, 50.0)), level)
            assert f"{ratio:.4g} times its bore" in said and "Write a bore of 1.35 mm" in said
    assert not refused(ElasticPair(pair, (67.5 / 49.9, 50.0)), RINGED)


def test_the_cheapest_models_in_mesh_and_the_finest(monkeypatch):
    """Without finite elements the finest is the analytic one that was least off."""
    pair, thin = elastic("reference"), replace(elastic("reference"), bores=(60.0, 50.0))
    exact = "finite elements", "finite elements"
    assert cheapest_in_mesh(pair, 0.01) == exact == cheapest_in_mesh(thin, 0.5) == finest(pair)
    for error in (0.15, 0.3, 1.0):
        level, coupling = names = cheapest_in_mesh(pair, error)
        assert LEVELS[level].worst <= error
        assert max(map(abs, IN_MESH[names].peak_to_peak)) <= error
        assert (coupling == "finite elements") == (error == 0.15)
    assert errors_in_mesh(pair, USUAL, "given") is None is errors_in_mesh(thin, USUAL, "none")
    monkeypatch.setattr("gearopt.physics.tooth.validity.find_spec", lambda name: None)
    worst = {
        max(map(abs, known.peak_to_peak)): names
        for names, known in IN_MESH.items()
        if "finite elements" not in names
    }
    assert finest(pair) == worst[min(worst)] and finest(thin) == (USUAL, "ring torsion")


def test_wide_roots_and_planes():
    assert doubts(elastic("reference"), USUAL) == () == doubts(elastic("second"), USUAL)
    few = ElasticPair(GearPair.of_teeth(3.0, 12, 40, 30.0, profile_shifts=(0.5, 0.0)), (9.0, 40.0))
    assert any("known up to 0.17 rad" in each for each in doubts(few, USUAL))
    assert not any("pinion" in each for each in doubts(elastic("reference"), "profile + Cornell"))
    narrow = elastic("reference").pair.of_width(12.0)
    assert usual_plane(narrow) == "stress" and usual_plane(elastic("reference").pair) == "strain"
    said = doubts(ElasticPair(narrow, (30.0, 50.0), plane="strain"), "finite elements")
    assert any("plane stress describes it better than plane strain" in each for each in said)
    (told,) = (each for each in said if "describes" in each)
    by_strain, by_stress = (
        1.0 / LEVELS[USUAL].compliance(ElasticPair(narrow, (30.0, 50.0), plane=plane), 0.0, 2e3)
        for plane in ("strain", "stress")
    )
    assert by_strain / by_stress == pytest.approx(1.07, abs=0.01) and "about 7 % too high" in told


@pytest.mark.parametrize(
    ("error", "known"),
    [
        (1.3, "ISO 6336"),
        (0.2, "profile + Sainsot"),
        (0.08, "trapezoid + Sainsot"),
        (0.05, "finite elements"),
        (0.0, "finite elements"),
    ],
)
def test_the_cheapest_level_within_an_error(error, known):
    pair = elastic("reference")
    assert cheapest(pair, error) == known
    made = LEVELS[cheapest(pair, error)]
    assert made.worst <= max(error, 1e-3)
