"""Shifts of equal root safety, against the ratings of single pairs and against looking at all."""

import numpy as np
import pytest
from campaigns import few
from rated_drives import agma, iso

from gearopt.formulations.drive.root_balance import RootBalance
from gearopt.formulations.drive.toothing import Toothing
from gearopt.physics.agma.rating import rate as rate_by_agma
from gearopt.physics.agma.rating_factors import Practice, Steel
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import ISO_53_A
from gearopt.physics.geometry.profile_shift import Meshing, Shifting, equal_sliding
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.rating import rate as rate_by_iso

HARD, SOFT = Material("Eh", "MQ"), Material("V alloy", "MQ", 300.0)
RIMS = Blank(4.0), Blank(2.0)
STANDARDS = {
    "tempered, ISO": (iso(), rate_by_iso),
    "hard, ISO": (iso((HARD, HARD)), rate_by_iso),
    "hard on soft, ISO": (iso((HARD, SOFT), hours=50.0), rate_by_iso),
    "rims, ISO": (iso((HARD, HARD), blanks=RIMS), rate_by_iso),
    "tempered, AGMA": (agma(), rate_by_agma),
    "two steels, AGMA": (agma((Steel("carburised", 2), Steel(hardness=330.0))), rate_by_agma),
    "sizes, AGMA": (agma(practice=Practice(quality=7.0, size=True)), rate_by_agma),
}
SPEED, ALLOWANCES = 150.0, (-0.05, -0.08)


def pairs(count, seed):
    """Meshings (n,) of spur and helical gears, of modules from 1 to 8 mm."""
    rng = np.random.default_rng(seed)
    z1 = rng.integers(14, 40, count).astype(float)
    z2, m = np.round(z1 * rng.uniform(1.0, 6.0, count)), rng.choice([1.0, 2.0, 4.0, 8.0], count)
    helix = np.radians(rng.uniform(16.0, 30.0, count) * (rng.random(count) < 0.5))
    distance = m * (0.5 * (z1 + z2) / np.cos(helix) + rng.uniform(-0.2, 1.0, count))
    return Meshing(m, (z1, z2), helix, (ISO_53_A,) * 2, distance)


CASES = [(name, seed) for seed in range(20) for name in STANDARDS]
QUICK = [("hard on soft, ISO", 0), ("tempered, AGMA", 0)]


@pytest.mark.parametrize(("name", "seed"), few(CASES, QUICK))
def test_both_roots_are_equally_safe_by_the_rating_of_the_pair(name, seed):
    """At any torque and of any width; by AGMA of helical gears from an overlap of 1 on."""
    standard, rate = STANDARDS[name]
    by_agma = rate is rate_by_agma
    made = pairs(4, seed)
    rule = Shifting("equal root safety", balance=RootBalance(standard, SPEED, ALLOWANCES))
    shifts = rule.shifts(made)
    places = np.flatnonzero(np.isfinite(shifts[0]))[:2]
    for i in places:
        m, z1, z2, helix, a, x1, x2, k = (
            float(v[i])
            for v in (made.module, *made.teeth, made.helix_angle, made.distance, *shifts)
        )
        cut = Toothing(helix, made.racks, (x1, x2), (k, k), ALLOWANCES, a)
        pair = cut.pair(m, z1, z2, m * z1 / np.cos(helix))
        case = standard.case(pair, 1e4 * m**3, SPEED, *([{}] if by_agma else []))
        materials = case.steels if by_agma else case.materials
        first, second = rate(
            pair, case.operation, materials, case.practice, case.given
        ).bending_safety
        assert first == pytest.approx(second, rel=1e-9)
    assert len(places)


WHOLE = [(name, 300) for name in STANDARDS]


@pytest.mark.parametrize(("name", "count"), few([("hard, ISO", 12), *WHOLE], 1))
def test_no_root_is_missed_and_none_is_nearer_to_equal_sliding(name, count):
    """By 40 shifts between those of undercut gears; near an end a standard may refuse a pair."""
    made, balance = pairs(count, 1), RootBalance(STANDARDS[name][0], SPEED, (0.0, 0.0))
    x1 = Shifting("equal root safety", balance=balance).shifts(made)[0]
    sine = np.sin(made.pressure_angles[1]) ** 2 / np.cos(made.helix_angle) / 2.0
    deep = 1.25 - 0.38 * (1.0 - np.sin(np.radians(20.0)))
    low, high = deep - made.teeth[0] * sine, made.shift_sum - deep + made.teeth[1] * sine
    low, high = np.maximum(low, made.clear()[0]), np.minimum(high, made.clear()[1])
    grid = np.linspace(0.0, 1.0, 40)[:, None] * (high - low) + low
    sides = np.array([np.log(balance(made, x)) for x in grid])
    crossed = sides[:-1] * sides[1:] <= 0.0
    middle = np.where(crossed, 0.5 * (grid[:-1] + grid[1:]), np.inf)
    start, wide = np.clip(equal_sliding(made), low, high), (high - low) / 39.0
    off = np.abs(middle - start).min(axis=0)
    there, seen = np.isfinite(x1), np.isfinite(off) & (low < high)
    assert (
        0.5 < there.mean()
        and not (seen & ~there).any()
        and (there & seen).sum() > 0.9 * there.sum()
    )
    assert np.log(balance(made, x1))[there] == pytest.approx(0.0, abs=1e-9)
    assert (np.abs(np.abs(x1 - start) - off)[there & seen] <= wide[there & seen]).all()
