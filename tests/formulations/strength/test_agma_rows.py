"""Rows of AGMA ratings: lower bounds on boxes of widths, monotone in the torque."""

from dataclasses import replace

import numpy as np
import pytest
from campaigns import few
from rated_drives import RACK, TREATMENTS, agma

from gearopt.formulations.strength.standard import Load, Option
from gearopt.physics.agma.rating_factors import Practice
from gearopt.physics.gears import GearPair

N = 300
GIVEN = ({}, {"J": (0.4, 0.45), "C_H": (1.0, 1.1)}, {}, {"I": 0.1, "K_s": (1.1, 1.2), "K_m": 1.4})
LEVELS = ((Load(2e4),), (Load(2e3, 0.9, 1.2),), (Load(2e2), Load(2e4, 0.5, 0.8)))
# of box over width, by seed, medians as measured
TIGHT = (0.9826, 0.9597, 0.9841, 1.0, 0.9884, 0.9696, 0.9752, 1.0, 0.9809, 0.9750, 0.9856, 1.0)


def drawn(seed):
    """Return a standard and random pairs of one helix angle, with torques and widths."""
    rng = np.random.default_rng(seed)
    standard = agma(
        TREATMENTS[seed % len(TREATMENTS)],
        float(rng.integers(5, 12)),
        float(10.0 ** rng.uniform(0.0, 5.0)),
        practice=Practice(
            quality=float(rng.integers(5, 12)),
            curve=str(rng.choice(["open", "commercial", "precision", "extra precision"])),
            crowned=bool(rng.random() < 0.5),
            size=bool(rng.random() < 0.5),
        ),
        given=GIVEN[seed % len(GIVEN)],
    )
    standard = replace(standard, loads=LEVELS[seed % len(LEVELS)])
    helix = 0.0 if seed % 3 == 0 else float(rng.uniform(0.1, 0.5))
    z1 = rng.integers(17, 60, N)
    z2 = np.ceil(z1 * rng.uniform(1.0, 8.0, N))
    module = 10.0 ** rng.uniform(-0.5, 1.5, N)
    pair = GearPair.of_teeth(module, z1, z2, 1.0, helix, RACK)
    torque = module**3 * 10.0 ** rng.uniform(2.0, 5.0, N)
    speed = 10.0 ** rng.uniform(0.0, 3.0, N)
    width = pair.pinion.reference_diameter * 10.0 ** rng.uniform(-1.5, 0.4, N)
    return rng, standard, pair, torque, speed, width


def used(standard, pair, torque, speed, safety=(1.2, 1.1)):
    """What is used by the exact safety factors; NaN where a pair is refused."""
    names = Option((standard,)).utilisations(pair, torque, speed, safety)
    bent = [v for n, v in names.items() if "bending" in n]
    pressed = [v for n, v in names.items() if "contact" in n]
    found = np.maximum(np.maximum(*bent), np.maximum(*pressed) ** 2)
    return np.where(found < 1e8, found, np.nan)


@pytest.mark.parametrize("seed", few(range(12), 4))
def test_no_width_of_a_box_uses_less(seed):
    rng, standard, pair, torque, speed, low = drawn(seed)
    ends = (torque, 1.3 * torque), (speed, speed / 1.3)  # the first of which counts
    rows = standard.rows(standard.prepared(pair), pair, *ends, (1.2, 1.1))
    exact = used(standard, pair.of_width(low), torque, speed)
    known = ~np.isnan(exact)
    assert known.sum() > 100
    assert rows.used(low, low)[known] == pytest.approx(exact[known], rel=1e-11)
    border = rows.border(low)
    high = np.minimum(low * 10.0 ** rng.uniform(0.0, 0.5, N), border)
    bound = rows.used(low, high)
    least = np.full(N, np.inf)
    for share in (0.0, 1.0, *rng.random(6)):
        width = low + share * (high - low)
        at = used(standard, pair.of_width(width), torque, speed)
        sure = ~np.isnan(at)
        assert (bound[sure] <= at[sure] * (1.0 + 1e-12)).all()
        least[sure] = np.minimum(least, at)[sure]
    sound = np.isfinite(least)
    assert np.median(bound[sound] / least[sound]) == pytest.approx(TIGHT[seed], abs=1e-4)


@pytest.mark.parametrize("seed", few(range(12), 4))
def test_a_stronger_torque_never_uses_less(seed):
    rng, standard, pair, torque, speed, width = drawn(seed)
    own = pair.of_width(width)
    before = used(standard, own, torque, speed)
    for _ in range(6):
        more = 10.0 ** rng.uniform(0.0, 1.0, N)
        torque, speed = torque * more, speed / more
        now = used(standard, own, torque, speed)
        assert (now[~np.isnan(now)] >= before[~np.isnan(now)] * (1.0 - 1e-12)).all()
        before = now
