"""Whole teeth of drives whose wheels drive: brute force by the formulas, and the mirrored drive."""

import math
import random
from dataclasses import replace
from fractions import Fraction as F

import pytest

from gearopt.formulations.drive import continuous_sizing, teeth
from gearopt.formulations.drive.teeth.search import search
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve

MODULES = tuple(map(F, ("1", "1.25", "1.5", "2", "2.5", "3", "4")))
K_LIMIT, U_LIMIT = 2.07, 48.0  # MPa
FACES = (
    FaceWidth(F("0.6"), F("0.6")),
    FaceWidth(F("0.3"), F("0.9")),
    FaceWidth(F("0.3"), F("0.9"), step=F(1)),
)
TIES = 1e-9


def drawn(seed, count):
    """A random drive of so many stages."""
    draw = random.Random(seed)
    stages, most = [], 60 if count < 3 else 36
    for _ in range(count):
        z = draw.randint(17, 20)
        pinions = z, z + (4 if count < 3 else 1)
        limits = (K_LIMIT, U_LIMIT), draw.choice(FACES), MODULES, pinions, (17, most)
        stages.append(Stage(*limits))
    ratio = F(draw.uniform(1.3, 1.7) ** count).limit_denominator(1000)
    aims = "gear_volume", "gear_volume", "total_length", "sum_of_centre_distances"
    return Train(
        draw.uniform(2e4, 4e5),
        ratio,
        draw.choice([F(1, 500), F(1, 100), F(3, 100)]),
        tuple(stages),
        driver="wheel",
        objective=draw.choice(aims),
        law=K_FACTOR,
        speed=150.0,
    )


def share(train, k, z1, z2, torque):
    """Least share of a pair whose wheel has a torque [N mm]; inf: no module carries it."""
    face, best = train.stages[k].face_width, math.inf
    for m in map(float, MODULES):
        d, u, pinion = m * z1, z2 / z1, torque * z1 / z2
        force = 2.0 * pinion / d
        needed = max(force / d * (1.0 + 1.0 / u) / K_LIMIT, force / m / U_LIMIT)
        low, high = float(face.low) * d, float(face.high) * d
        width = max(needed, low)
        if face.step is not None:
            width = math.ceil(width - TIES)
        if width > high + TIES:
            continue
        worth = math.pi / 4.0 * width * (d**2 + (d * u) ** 2)
        if train.objective != "gear_volume":
            worth = d * (1.0 + u) / 2.0
        if train.objective == "total_length":
            last = len(train.stages) - 1
            worth += (k == 0) * d * u / 2.0 + (k == last) * d / 2.0
        best = min(best, worth)
    return best


def brute(train, k=0, reached=F(1), value=0.0):
    """The least objective of all trains behind a ratio, from the input on."""
    if k == len(train.stages):
        return value if train.lowest_ratio <= reached <= train.highest_ratio else math.inf
    best, stage = math.inf, train.stages[k]
    for z1 in range(stage.pinion_teeth[0], stage.pinion_teeth[1] + 1):
        for z2 in range(z1, stage.wheel_teeth[1] + 1):
            ratio = reached * F(z2, z1)
            if ratio <= train.highest_ratio:
                own = share(train, k, z1, z2, train.torque / float(reached))
                best = min(best, brute(train, k + 1, ratio, value + own))
    return best


CASES = [(n, 2) for n in range(14)] + [(n, 1) for n in range(14, 20)] + [(20, 3), (21, 3)]


@pytest.mark.parametrize(
    ("seed", "count"),
    [c if c in CASES[13:16] else pytest.param(*c, marks=pytest.mark.slow) for c in CASES],
)
def test_the_best_is_that_of_all_trains(seed, count):
    train, best = drawn(seed, count), brute(drawn(seed, count))
    result = solve(teeth.problem(train), method="exact")
    assert (result.status == "infeasible") == (best == math.inf)
    if best < math.inf:
        assert result.value == pytest.approx(best, rel=1e-9)
        assert solve(continuous_sizing.problem(train)).bound <= best * (1.0 + 1e-9)


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("objective", ["gear_volume", "total_length"])
def test_of_a_given_ratio_the_best_is_the_mirrored_one(count, objective):
    """Hand calculation: with T i at its input the reducing drive has the same gears."""
    stage = Stage((K_LIMIT, U_LIMIT), FACES[1], MODULES, (18, 26), (18, 90))
    rising = Train(
        3e5,
        F(6),
        F(0),
        (stage,) * count,
        driver="wheel",
        objective=objective,
        law=K_FACTOR,
        speed=15.0,
    )
    reducing = replace(rising, driver="pinion", torque=3e5 / 6.0, speed=90.0)
    back, forth = (search(train, 1, Budget()).found[0] for train in (rising, reducing))
    assert back[0] == pytest.approx(forth[0], rel=1e-12)
    assert back[1] == forth[1][::-1]
