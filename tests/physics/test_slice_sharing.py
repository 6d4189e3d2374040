"""Load sharing by slices that hold each other: optimality conditions and closed forms."""

import numpy as np
import pytest
from dense_slices import matrix

from gearopt.physics.load_sharing import share
from gearopt.physics.slice_sharing import Springs, share_slices


def random_springs(rng):
    """Springs over many decades, slices that lack contact, links or none."""
    shape = int(rng.integers(1, 4)), int(rng.integers(1, 25))
    contacts = 10.0 ** rng.uniform(-7.0, -4.5, shape)
    bed = 10.0 ** rng.uniform(3.0, 6.0, shape)
    links = 10.0 ** rng.uniform(3.0, 7.0, (shape[0], shape[1] - 1)) * rng.integers(0, 2)
    apart = rng.uniform(0.0, 0.02, shape)
    apart[rng.random(shape) < 0.2] = np.inf
    apart[0, 0] = 0.01
    return Springs(contacts, bed, links, rng.uniform(0.0, 1e-6)), apart


def test_two_hundred_random_meshes_meet_the_conditions_of_the_quadratic_program():
    """Equilibrium, no pull, no gap below 0, and force times gap 0, by the dense matrix C."""
    rng = np.random.default_rng(0)
    for _ in range(200):
        springs, apart = random_springs(rng)
        load = 10.0 ** rng.uniform(0.0, 5.0)
        found = share_slices(springs, apart, load)
        forces, there = found.forces.ravel(), np.isfinite(apart.ravel())
        moved = matrix(springs) @ forces + np.where(there, apart.ravel(), 0.0) - found.approach
        assert abs(forces.sum() / load - 1.0) < 1e-12
        assert forces.min() >= 0.0 and moved[there].min() > -1e-12 * found.approach * 1e2
        assert np.abs(forces * moved).max() < 1e-12 * load * found.approach
        assert np.all(found.gaps.ravel()[forces > 0.0] == 0.0)
        gaps = found.gaps.ravel()[there]
        assert gaps == pytest.approx(moved[there], abs=1e-11 * found.approach)


def test_one_slice_a_pair_is_the_closed_form_of_spur_pairs():
    rng = np.random.default_rng(3)
    shape = 50, 3
    soft, body = rng.uniform(1e-6, 2e-6, shape), rng.uniform(1e-6, 3e-6, shape)
    apart, load, coupling = rng.uniform(0.0, 0.02, shape), 10.0 ** rng.uniform(0, 5, 50), 5e-7
    springs = Springs(soft[..., None], 1.0 / body[..., None], np.zeros((*shape, 0)), coupling)
    found = share_slices(springs, apart[..., None], load)
    closed = share(soft + body + coupling, apart, load, coupling)
    assert found.forces[..., 0] == pytest.approx(closed.forces, rel=1e-12, abs=1e-9)
    assert found.approach == pytest.approx(closed.approach, rel=1e-12)
    assert found.gaps[..., 0] == pytest.approx(closed.gaps, abs=1e-15)


def test_even_load_does_not_depend_on_what_holds_slices_together():
    """A row of equal slices, even gaps: links carry nothing."""
    contacts, bed = np.full((1, 9), 2e-5), np.full((1, 9), 4e4)
    for links in (0.0, 1e5):
        found = share_slices(
            Springs(contacts, bed, np.full((1, 8), links), 1e-6), np.zeros((1, 9)), 900.0
        )
        assert found.forces == pytest.approx(np.full((1, 9), 100.0), rel=1e-12)
        assert found.approach == pytest.approx(100.0 * (2e-5 + 1 / 4e4) + 1e-6 * 900.0, rel=1e-12)


def test_what_cannot_be_shared_is_refused():
    springs = Springs(np.full((1, 2), 1e-5), np.full((1, 2), 1e5), np.full((1, 1), 1e5), 0.0)
    with pytest.raises(ValueError, match="at least 0"):
        share_slices(springs, np.zeros((1, 2)), -1.0)
    with pytest.raises(ValueError, match="no slice"):
        share_slices(springs, np.full((1, 2), np.inf), 1.0)
