"""Planetary stages by AGMA and by both standards: the search against every candidate."""

import numpy as np
import planetary_by_agma as made
import planetary_drives as own
import pytest
from campaigns import few
from test_planetary_stages import _of_both_kinds, agree, some_pairs, used  # noqa: F401

from gearopt.formulations.drive.planetary import HELD, PLANET, Cutting
from gearopt.physics.gears import Cutter


def agree_by(train, both, monkeypatch):
    monkeypatch.setattr(own, "safe", made.safe_by_both if both else made.safe)
    agree(train, made.by_agma(train, both))


@pytest.mark.parametrize("both", few([False, True], (1,)))
@pytest.mark.parametrize("seed", few(range(60), (9,)))
def test_stages_are_those_of_every_candidate(seed, both, monkeypatch):
    agree_by(own.some_planetary_drive(seed), both, monkeypatch)


@pytest.mark.parametrize("seed", few(range(30), 0))
def test_pinions_in_rings_are_those_of_every_candidate(seed, monkeypatch):
    agree_by(own.some_internal_drive(seed), bool(seed % 2), monkeypatch)


@pytest.mark.parametrize("seed", few(range(16), 0))
def test_drives_with_a_planetary_stage_are_those_of_every_candidate(seed, monkeypatch):
    agree_by(own.some_planetary_drive(seed, 2), bool(seed % 2), monkeypatch)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("held", "helix"), few([(held, helix) for held in HELD for helix in (0.0, 0.2, 0.45)], 1)
)
@pytest.mark.parametrize("size", few([False, True], 1))
def test_no_width_and_torque_of_a_box_use_less(held, helix, size):
    """Rows of both meshes are bounds up to m_F = 1, or above, and exact where two ends meet."""
    rng = np.random.default_rng(len(held))
    count, looked, turned = 300, 0, 0
    pair = some_pairs(held, count, rng, helix)
    cut = Cutting(helix, cutter=None if helix else Cutter(25, 0.0, 1.25, 0.2))
    torque, speed = 10.0 ** rng.uniform(4.0, 7.0, count), 10.0 ** rng.uniform(0.0, 2.3, count)
    low = pair.face_width * rng.uniform(0.5, 1.0, count)
    strong = torque * rng.uniform(1.0, 3.0, count)
    for option in own.ways(cut, (3,), (0, 1, 2), held):
        for way in made._ways(option, False, size):
            for standard in way.standards:
                ready = standard.prepared(pair)
                point = standard.rows(ready, pair, (torque,) * 2, (speed,) * 2, (1.4, 1.1))
                at = point.used(pair.face_width, pair.face_width)
                exact = used(standard.safeties(pair, torque, speed))
                rated = np.isfinite(exact)
                assert (rated == np.isfinite(at)).all()
                np.testing.assert_allclose(at[rated], exact[rated], rtol=1e-9)
                ends = (torque, strong), (speed, torque * speed / strong)
                rows = standard.rows(ready, pair, *ends, (1.4, 1.1))
                high = np.minimum(pair.face_width * 1.7, rows.border(low))
                bound = rows.used(low, high)
                for share in (0.0, 1.0, *rng.random(4)):
                    width = low + share * (high - low)
                    there = torque * (strong / torque) ** rng.random(count)
                    inside = used(
                        standard.safeties(pair.of_width(width), there, torque * speed / there)
                    )
                    assert (bound <= inside * (1.0 + 1e-9))[np.isfinite(inside)].all()
                looked += int(rated.sum())
                turned += int(rated.sum()) * (standard.turned)
                assert not standard.turned or way.planets.fewest == PLANET
    assert looked > 100
    assert turned > 10
