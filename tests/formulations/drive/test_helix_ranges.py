"""Helix angles as real numbers: what cells of them need, and the bound of drives."""

import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import few
from random_cells import designs_within, needed_by, random_cells
from rated_drives import FREE, RACK, by, rated_drive
from test_rated_cells import SAFETY, STANDARDS, TOOTHINGS

from gearopt.formulations.drive import continuous_sizing
from gearopt.formulations.drive.rated_continuous.boxes import T, bounded, first_boxes, shafts_about
from gearopt.formulations.drive.toothing import Toothing
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve

KINDS = {name: TOOTHINGS[name] for name in ("helical", "thinned", "shifted")}
ENDS = math.radians(1.0), math.radians(45.0)
WIDTHS = 0.005, 0.05, 0.3
CASES = [(s, k, w, n) for n in range(2) for w in WIDTHS for k in KINDS for s in STANDARDS]
QUICK = [("iso 2019", "shifted", 0.05, 0), ("agma", "helical", 0.3, 0)]


def inclining(train, low, high):
    """The drive with a range of helix angles [degrees] of every stage."""
    ends = math.radians(low), math.radians(high)
    return replace(train, stages=tuple(replace(s, helix=ends) for s in train.stages))


@pytest.mark.parametrize(("name", "kind", "width", "seed"), few(CASES, QUICK))
def test_no_design_needs_less_than_its_cell(name, kind, width, seed):
    rng, standard = np.random.default_rng(seed), STANDARDS[name]
    few_cells = (name, kind, width, seed) in QUICK
    cells = random_cells(rng, 60 if few_cells else 600, KINDS[kind], width, ENDS)
    with np.errstate(all="ignore"):
        least = standard.needed(cells, SAFETY)
        for _ in range(3):
            pair, torque, speed = designs_within(rng, cells)
            exact = needed_by(standard, pair, torque, speed, SAFETY)
            for below, true in zip(least, exact, strict=True):
                rated = np.isfinite(true)
                assert rated.mean() > 0.7 and (below / true)[rated].max() <= 1.0 + 1e-10


def test_a_range_of_one_angle_is_that_angle():
    """What cells need and the sizes of boxes are those of a stage that has the angle."""
    rng, angle = np.random.default_rng(3), 0.3
    cells = random_cells(rng, 50, Toothing(angle, (RACK, RACK)), 0.02)
    same = replace(cells, ranges={"helix_angle": np.full((2, 50), angle)})
    for standard in (STANDARDS["iso"], STANDARDS["agma"]):
        for one, other in zip(
            standard.needed(cells, SAFETY), standard.needed(same, SAFETY), strict=True
        ):
            assert one == pytest.approx(other, rel=1e-12)
    train = rated_drive(4, [FREE], helix=angle, options=by("agma"))
    shafts = shafts_about(train, 1)
    ranged = shafts_about(inclining(train, math.degrees(angle), math.degrees(angle)), 1)
    (boxes, share), (others, also) = (bounded(s, 0, first_boxes(s, 0)) for s in (shafts, ranged))
    rows = np.arange(len(boxes.sizes)) != T
    assert boxes.sizes[rows] == pytest.approx(others.sizes[rows], abs=1e-11)
    assert share == pytest.approx(also, rel=1e-11)


def smallest(train, exact, rng, count):
    """Values of the smallest designs of random teeth, widths and helix angles of one stage.

    Of every second the gears are as slim as may be, of every second the ratio is the lowest.
    """
    (stage,), n = train.stages, 120
    low, high = stage.pinion_teeth
    z, slim = rng.uniform(low, high, count), rng.uniform(0.3, 0.75, count)
    beta = np.arctan(np.exp(rng.uniform(*np.log(np.tan(stage.helix)), count)))
    ratio = rng.uniform(float(train.lowest_ratio), float(train.highest_ratio), count)
    slim[::2], ratio[::4], ratio[1::4] = 0.3, float(train.lowest_ratio), float(train.lowest_ratio)
    d = np.tile(np.geomspace(30.0, 400.0, n), count)
    teeth, over, angle, u = (np.repeat(row, n) for row in (z, slim, beta, ratio))
    batch = exact.batch(np.stack([d * np.cos(angle) / teeth, teeth, u, over * d, angle], axis=1))
    good = (batch.G <= 1.0).all(axis=1)
    values = np.where(good, batch.F[:, 0], np.inf).reshape(count, n).min(axis=1)
    return values[np.isfinite(values)]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["agma", "iso"])
def test_no_random_design_is_below_the_bound(name):
    """Of which some are near the best one; and no designs of one angle are."""
    train = inclining(rated_drive(4, [FREE], options=by(name)), 8.0, 30.0)
    exact = continuous_sizing.problem(train)
    result = solve(exact, budget=Budget(120.0, gap=0.03))
    values = smallest(train, exact, np.random.default_rng(7), 400)
    assert len(values) > 360 and result.bound > 0.0
    assert values.min() >= result.bound and values.min() < 1.1 * result.value
    assert result.value >= result.bound
    alone = rated_drive(4, [FREE], options=by(name), helix=math.radians(20.0))
    assert solve(continuous_sizing.problem(alone), budget=Budget(2.0)).value >= result.bound


@pytest.mark.slow
@pytest.mark.parametrize("name", ["agma", "iso"])
def test_the_bound_of_two_stages_is_below_whole_teeth_of_any_angles(name):
    from gearopt.formulations.drive import teeth

    usual = rated_drive(12, [FREE, FREE], options=by(name), pinion_teeth=(20, 22))
    train = inclining(usual, 10.0, 25.0)
    result = solve(continuous_sizing.problem(train), budget=Budget(40.0, gap=0.1))
    angles = [Toothing(math.radians(b), (RACK, RACK)) for b in (10.0, 16.0, 25.0)]
    several = replace(
        usual, stages=tuple(replace(s, toothings=tuple(angles)) for s in usual.stages)
    )
    whole = solve(teeth.problem(several))
    assert 0.0 < result.bound <= result.value * (1.0 + 1e-9) and whole.status == "optimal"
    assert result.bound <= whole.value
