"""The quick bound of rated drives lies below every train, and below every row in its cells."""

import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import few
from rated_drives import MODULES, TREATMENTS, F, agma, rated_drive, some_face, some_iso

from gearopt.formulations.drive.rated_continuous import quick_bound as quick
from gearopt.formulations.drive.rated_continuous import ways
from gearopt.formulations.drive.teeth.search import search
from gearopt.formulations.drive.teeth.tables import stage_tables
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.strength.standard import Load, Option
from gearopt.optimise.result import Budget
from gearopt.physics.blanks import Blank
from gearopt.physics.geometry.profile_shift import Shifting

AIMS = "gear_volume", "mass", "cost", "sum_of_centre_distances", "total_length"
LEVELS = Load(500.0, 1.3), Load(9000.0, 0.8, 0.9), Load(9000.0, 0.4, 1.1)


def some_options(rng):
    """Ways of making gears of one to three treatments, by AGMA, ISO 6336 or both."""
    quality, hours = float(rng.integers(5, 12)), float(10.0 ** rng.uniform(1.0, 5.0))
    laws = ((agma,), (some_iso,), (agma, some_iso))[rng.integers(3)]
    levels = LEVELS if rng.random() < 0.3 else None
    chosen = rng.permutation(len(TREATMENTS))[: rng.integers(1, 4)]
    options = []
    for steels in (TREATMENTS[k] for k in chosen):
        made = [law(steels, quality, hours) for law in laws]
        made = [replace(one, loads=levels) if levels else one for one in made]
        prices = tuple(float(p) for p in rng.integers(1, 4, size=2))
        cutting = 0.5 * prices[1], 3.0 * prices[0]
        options.append(Option(tuple(made), prices=prices, cutting_prices=cutting))
    return tuple(options)


def some_drive(seed, stages=None):
    """A random drive of up to three stages whose loads about fit its modules."""
    rng = np.random.default_rng(seed)
    count = stages or int(rng.integers(1, 4))
    begin, low = int(rng.integers(0, 7)), int(rng.integers(18, 30))
    modules, middle = MODULES[begin : begin + 5], float(MODULES[begin + 2])
    rpm = float(10.0 ** rng.uniform(1.7, 3.6))
    torque = 12.0 * float(10.0 ** rng.uniform(-0.8, 0.2)) * middle**3 * low**2 * 0.1
    train = rated_drive(
        F(int(rng.integers(20, (60, 160, 400)[count - 1])), 10),
        [some_face(rng, middle, low) for _ in range(count)],
        power=torque * rpm * math.pi / 30.0,
        rpm=rpm,
        helix=float(rng.choice([0.0, rng.uniform(0.1, 0.5)])),
        options=some_options(rng),
        modules=modules,
        pinion_teeth=(low, low + int(rng.integers(1, 4))),
    )
    if rng.random() < 0.3:
        web = Blank(rim_over_module=2.5, web_over_width=0.4)
        train = replace(
            train, stages=tuple(replace(s, blanks=(Blank(), web)) for s in train.stages)
        )
    safety = float(rng.uniform(0.9, 1.6)), float(rng.uniform(0.9, 1.3))
    return replace(train, safety=safety, objective=str(rng.choice(AIMS)), density=7.8e-9)


def with_ways(seed, stages=None):
    """A random drive that chooses helix angles and, mostly, distances or sums, x1 or its rule."""
    rng, train = np.random.default_rng(seed), some_drive(seed, stages)
    angles = rng.choice(np.radians([0.0, 2.0, 8.0, 15.0, 24.0, 30.0]), rng.integers(1, 4), False)
    solid = tuple(replace(stage, blanks=(Blank(), Blank())) for stage in train.stages)
    if rng.random() < 0.15:  # no shifts are chosen
        angles = np.radians(np.sort(rng.choice(35, 8, False)))
        cuts = tuple(Toothing(float(angle)) for angle in angles)
        return replace(train, stages=tuple(replace(stage, toothings=cuts) for stage in solid))
    rule = Shifting(
        str(rng.choice(["equal sliding", "after Roloff", "after Henriot"])),
        contact_ratio=float(rng.choice([0.9, 1.1])),
        sliding=float(rng.choice([2.0, 9.0])),
    )
    low, by_rule = rng.uniform(-0.6, 0.8), rng.random() < 0.3
    shifts = [None] if by_rule else low + rng.uniform(0.0, 0.5) * np.arange(rng.integers(1, 4))
    given, stages = rng.random() < 0.6, []
    for stage in solid:
        teeth = stage.pinion_teeth[1] * (1.0 + rng.uniform(1.0, 4.0))
        middle = 0.5 * float(stage.modules[2]) * teeth
        places = rng.uniform(0.9, 1.1, 2) * middle if given else rng.uniform(-0.8, 1.6, 2)
        name = "working_distance" if given else "shift_sum"
        values = [(a, x, place) for a in angles for x in shifts for place in places]
        names, plain = ("helix_angle", "pinion_shift", name), Toothing(shifting=rule)
        columns = [[None if v is None else float(v) for v in row] for row in values]
        cuts = tuple(plain.at(dict(zip(names, row, strict=True))) for row in columns)
        stages.append(replace(stage, toothings=cuts, wheel_teeth=(1, 160)))
    aim = str(rng.choice(["gear_volume", "mass", "cost"]))
    return replace(train, stages=tuple(stages), objective=aim)


def divided(rng, kinds, k):
    """Kinds of a stage, each up to three times replaced by its halves."""
    for _ in range(rng.integers(0, 4)):
        rows = []
        for kind in kinds:
            halves = ways.halves(kind.stages[k]) or [kind.stages[k]]
            before, after = kind.stages[:k], kind.stages[k + 1 :]
            rows += [replace(kind, stages=(*before, half, *after)) for half in halves]
        kinds = rows
    return kinds


def least_beside_rows(seed, count, drive=some_drive):
    """Least costs of random rows of a drive over those of their cells, where both are known."""
    rng, train = np.random.default_rng(seed), drive(seed)
    total, found = math.log(float(train.highest_ratio)), [np.ones(1)]
    for k, table in enumerate(stage_tables(train, train.highest_ratio)):
        kinds = quick._kinds(train, k)
        if not len(table.ratio) or not kinds:
            continue
        pair = rng.integers(len(table.ratio), size=count)
        u = table.log_ratio[pair]
        reached = rng.uniform(0.0, np.maximum(total - u, 0.0)) * (k > 0)
        if k == len(train.stages) - 1:
            low = math.log(float(train.lowest_ratio))
            reached = rng.uniform(np.maximum(low - u, 0.0), np.maximum(total - u, 0.0)) * (k > 0)
            inside = (reached + u >= low) & (reached + u <= total)
            pair, u, reached = pair[inside], u[inside], reached[inside]
        cost = table.cost(train.torque * np.exp(reached), pair)
        some = np.isfinite(cost)
        most = np.quantile(cost[some], rng.uniform()) if some.any() else 1.0
        kinds = divided(rng, kinds, k)
        share = np.minimum.reduce([quick._shares(kind, k, most) for kind in kinds])
        step = total / (quick.WIDE * quick.PARTS)
        last = quick.WIDE * quick.PARTS - 1
        cell = [np.minimum((x / step).astype(int), last) for x in (reached, u)]
        known = some & (cost <= most)
        found.append(cost[known] / share[cell[0] * (k > 0), cell[1]][known])
    return np.concatenate(found)


@pytest.mark.parametrize("seed", few([*range(400), 5002, 5079], 3))
def test_no_row_costs_less_than_its_cell(seed):
    """100,000 rows and more in all; the last seeds have modules at a step of the tolerances."""
    assert np.all(least_beside_rows(seed, 60 if seed < 3 else 700) >= 1.0 - 1e-11)


@pytest.mark.parametrize("seed", few(range(20_000, 20_300), 1))
def test_no_row_of_chosen_ways_costs_less_than_its_cell(seed):
    assert np.all(least_beside_rows(seed, 60 if seed < 3 else 700, with_ways) >= 1.0 - 1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("drive", [some_drive, with_ways])
@pytest.mark.parametrize("seed", range(30))
def test_no_train_is_better_than_the_bound(seed, drive):
    train = drive(1000 + seed, stages=1 + seed % 2)
    found = search(train, 1, Budget()).found
    for value, _ in found[:1]:
        assert quick.quick_bound(train, value) <= value * (1.0 + 1e-11)
        assert quick.quick_bound(train, 1.5 * value) <= value * (1.0 + 1e-11)
