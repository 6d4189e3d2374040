"""Least widths by nominal stresses: none narrower carries, at any torque and width of a range."""

import numpy as np
import pytest
import test_agma_rows
import test_iso_rows
from campaigns import few
from test_iso_rows import ASKED

KINDS = test_iso_rows.KINDS | test_iso_rows.SPECTRA
SPREAD = 30.0  # of torques
WIDE = 1.5  # of widths
POINTS = 6


def looseness(standard, pair, low, torque, power, rng):
    """What is used over its bound by nominal stresses (points, n), at least 1."""
    ends = torque, torque * SPREAD
    speed = power / ends[0], power / ends[1]
    needed = standard.nominal(standard.prepared(pair), pair, ends, speed, ASKED, (low, low * WIDE))
    ratios = []
    for share in ((0, 0), (1, 0), (0, 1), (1, 1), *rng.uniform(0.0, 1.0, (POINTS, 2))):
        width, load = low * WIDE ** share[0], torque * SPREAD ** share[1]
        made = standard.safeties(pair.of_width(width), load, power / load)
        parts = [ASKED[k // 2] / s for k, s in enumerate(made)]
        used = np.max([parts[0], parts[1], parts[2] ** 2, parts[3] ** 2], axis=0)
        ratios.append(used * width / (needed * load))
    return np.array(ratios)


@pytest.mark.parametrize("kind", few(KINDS, ["others given", "short life"]))
def test_no_width_by_iso_6336_uses_less(kind):
    standard, helix = KINDS[kind]
    pair, width, torque, power, rng = test_iso_rows.pairs(helix, 21, (0.2, -0.1))
    ratios = looseness(standard, pair, width, 0.2 * torque, power, rng)
    rated = np.isfinite(ratios)
    assert rated.mean() > 0.9
    assert (ratios[rated] >= 1.0 - 1e-12).all()
    assert np.median(ratios[rated]) < (6.0 if kind == "rough" else 3.7)


@pytest.mark.parametrize("seed", few(range(12), 1))
def test_no_width_by_agma_2001_uses_less(seed):
    rng, standard, pair, torque, speed, low = test_agma_rows.drawn(seed)
    ratios = looseness(standard, pair, low, torque, torque * speed, rng)
    rated = np.isfinite(ratios)
    assert rated.mean() > 0.3
    assert (ratios[rated] >= 1.0 - 1e-12).all()
    assert np.median(ratios[rated]) < 1.6
