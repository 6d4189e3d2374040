"""Profile shifts as real numbers: what their cells need, their bodies, the bound of drives."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from campaigns import few
from random_cells import designs_within, needed_by, random_cells
from rated_drives import FREE, RACK, by, rated_drive
from test_helix_ranges import ENDS
from test_rated_cells import SAFETY, STANDARDS

from gearopt.formulations.drive import continuous_sizing, teeth
from gearopt.formulations.drive.rated_continuous import boxes as rated_boxes
from gearopt.formulations.drive.rated_continuous.boxes import bounded, first_boxes, shafts_about
from gearopt.formulations.drive.rated_continuous.cells import _halves
from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.strength.cells import LOWER, UPPER, Cells
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.physics.gears import Rack
from gearopt.physics.geometry.profile_shift import Shifting

X1, SUM = (-0.5, 1.0), (-0.5, 1.5)
SOLID = [name for name in STANDARDS if "webs" not in name and "rims" not in name]
CASES = [
    (s, h, w, n) for n in range(2) for w in (0.005, 0.05, 0.3) for h in (None, ENDS) for s in SOLID
]
QUICK = [("iso 2019", ENDS, 0.05, 0), ("agma", None, 0.3, 0)]


def shifting(helix=0.2, rack=RACK, **limits):
    """A toothing whose profile shifts are chosen."""
    return Toothing(
        helix, (rack, rack), shifting=Shifting(**limits), pinion_shift=0.0, shift_sum=0.0
    )


def ranging(train, x1=(0.0, 0.6), total=(0.0, 1.0), helix=None):
    """The drive with ranges of profile shifts, and of helix angles [rad], of every stage."""
    angle = train.stages[0].toothing.helix_angle
    return replace(
        train,
        stages=tuple(
            replace(s, toothings=(shifting(angle),), shifts=(x1, total), helix=helix)
            for s in train.stages
        ),
    )


def kept(pair):
    """Which pairs keep to the usual limits of chosen profile shifts."""
    return np.logical_and.reduce([used <= 1.0 for used in Shifting().used(pair).values()])


@pytest.mark.parametrize(("name", "helices", "width", "seed"), few(CASES, QUICK))
def test_no_design_needs_less_than_its_cell(name, helices, width, seed):
    rng, standard = np.random.default_rng(seed), STANDARDS[name]
    count = 60 if (name, helices, width, seed) in QUICK else 600
    cut = shifting(rack=(RACK, Rack())[seed])
    cells = random_cells(rng, count, cut, width, helices, (X1, SUM))
    possible = rated_boxes._may_be_made(rated_drive_stage(cut), cells)
    with np.errstate(all="ignore"):
        least = [np.nan_to_num(v, nan=0.0) for v in standard.needed(cells, SAFETY)]
        for _ in range(3):
            pair, torque, speed = designs_within(rng, cells)
            good = kept(pair)
            assert possible[good].all() and good.mean() > 0.15
            exact = needed_by(standard, pair, torque, speed, SAFETY)
            for below, true in zip(least, exact, strict=True):
                rated = np.isfinite(true) & good
                assert (below / true)[rated].max() <= 1.0 + 1e-10


INSIDE = [  # z1, u, x1 and x1 + x2 of cells whose least is inside, and where in z1 and u it is
    ((21.42 * math.exp(-0.3), 21.42 * math.exp(0.3)), (5.27, 5.27), 0.752, 0.036, 0.43, 0.5),
    ((29.41 * math.exp(-0.15), 29.41 * math.exp(0.15)), (6.8, 6.8), 0.565, -0.022, 0.6, 0.5),
]


@pytest.mark.parametrize(("teeth", "ratio", "x1", "total", "part", "other"), INSIDE)
def test_shifted_teeth_need_least_within_a_range_of_teeth(teeth, ratio, x1, total, part, other):
    """I of AGMA 908 rises and falls with z1 at a large x1: its corners are no bound."""
    z, u = np.array(teeth)[:, None], np.array(ratio)[:, None]
    same, both = np.ones((2, 1)), np.zeros((2, 1))
    d, cut = 60.0 * same, shifting(0.0)
    ranges = {"pinion_shift": both + x1, "shift_sum": both + total}
    sizes = d, d * u, d / z[::-1], 0.6 * d, 0.6 * same
    cells = Cells(cut, z, u, *sizes, 5e5 * same, 100.0 * same, ranges)
    own = replace(cut, pinion_shift=np.full(1, x1), shift_sum=np.full(1, total))
    teeth_at = z[0] ** (1.0 - part) * z[1] ** part
    pair = own.of_diameter(d[0] / teeth_at, teeth_at, d[0], u[0], 0.6 * d[0])
    assert kept(pair).all()
    standard = STANDARDS["agma"]
    exact = needed_by(standard, pair, np.full(1, 5e5), np.full(1, 100.0), SAFETY)
    assert standard.needed(cells, SAFETY)[0] <= exact[0]


@pytest.mark.parametrize(("ratio", "x1"), [(1.68688, 0.405059), (2.101256, 0.409616)])
def test_cells_of_wide_ratios_keep_their_teeth(ratio, x1):
    """What is left of a limit of sliding has a peak within the range of u."""
    cut = shifting(0.0, Rack())
    z, u = np.full((2, 1), 12.0), np.array([[1.5445], [4.6336]])
    d, total = np.full((2, 1), 60.0), np.full((2, 1), 0.49882)
    ranges = {"pinion_shift": np.array([[-0.18378], [0.41622]]), "shift_sum": total}
    sizes = d, d * u, d / z[::-1], 0.6 * d, np.full((2, 1), 0.6)
    cells = Cells(cut, z, u, *sizes, 1e4 * d, d, ranges)
    own = replace(cut, pinion_shift=np.full(1, x1), shift_sum=total[0])
    pair = own.of_diameter(np.full(1, 5.0), z[0], d[0], np.full(1, ratio), 36.0)
    assert kept(pair).all() and rated_boxes._may_be_made(rated_drive_stage(cut), cells).all()


@pytest.mark.parametrize("name", ["agma", "iso"])
def test_a_drive_whose_teeth_all_exceed_their_limits_is_impossible(name):
    train = ranging(
        rated_drive(4, [FREE], options=by(name), pinion_teeth=(8, 9), helix=0.0),
        (-0.3, -0.2),
        (0.0, 0.1),
    )
    result = solve(continuous_sizing.problem(train), budget=Budget(5.0))
    assert result.status == "infeasible"


def rated_drive_stage(cut):
    """A stage of this toothing."""
    return replace(rated_drive(4, [FREE]).stages[0], toothings=(cut,), shifts=(X1, SUM))


def test_a_range_of_one_value_is_that_value():
    """What cells need is that of a stage whose teeth have the shifts of the file."""
    rng = np.random.default_rng(3)
    cut = replace(shifting(), pinion_shift=0.3, shift_sum=0.5)
    cells = random_cells(rng, 50, cut, 0.02)
    both = {"pinion_shift": np.full((2, 50), 0.3), "shift_sum": np.full((2, 50), 0.5)}
    for standard in (STANDARDS["iso"], STANDARDS["agma"]):
        rows = standard.needed(cells, SAFETY), standard.needed(replace(cells, ranges=both), SAFETY)
        for one, other in zip(*rows, strict=True):
            assert one == pytest.approx(other, rel=1e-12)


@pytest.mark.parametrize("helix", [None, (0.15, 0.5)])
def test_no_body_of_a_box_is_smaller(helix):
    """Shares of random designs are no less than those of their sizes with the least bodies."""
    train = ranging(rated_drive(4, [FREE], pinion_teeth=(17, 40)), X1, SUM, helix)
    (stage,), rng = train.stages, np.random.default_rng(6)
    shafts = shafts_about(train, 1)
    boxes = first_boxes(shafts, 0)
    for _ in range(6):
        boxes = _halves(shafts, 0, boxes)
    sizes = boxes.sizes
    first, second = rated_boxes.body_squares(stage, sizes)
    rows = {n: getattr(rated_boxes, n) for n in ("Z", "U", "T", "X1", "SUM")}
    for _ in range(20):
        part = rng.uniform(size=(5, sizes.shape[2])) * rng.integers(0, 2, (5, 1)) ** 0.1
        z, u, tangent, x1, total = (
            sizes[row, LOWER] + p * (sizes[row, UPPER] - sizes[row, LOWER])
            for row, p in zip(rows.values(), part, strict=True)
        )
        own = {} if helix is None else {"helix_angle": np.arctan(np.exp(tangent))}
        cut = stage.cut(pinion_shift=x1, shift_sum=total, **own)
        pair = cut.pair(1.0, np.exp(z), np.exp(z + u), 1.0)
        for square, gear in zip((first, second), pair.gears, strict=True):
            body = (gear.body / gear.reference_diameter) ** 2
            assert (square <= body * (1.0 + 1e-12))[body > 0.0].all()


@pytest.mark.parametrize("helix", [None, (0.15, 0.5)])
def test_boxes_hold_all_designs_that_are_accepted(helix):
    """Random designs of one stage lie in a box that is left, with at least its share."""
    train = ranging(rated_drive(4, [FREE], options=by("agma", "iso"), pinion_teeth=(20, 40)))
    stage = replace(train.stages[0], helix=helix)
    train = replace(train, stages=(stage,))
    shafts, rng = shafts_about(train, 1), np.random.default_rng(5)
    boxes, least = bounded(shafts, 0, first_boxes(shafts, 0))
    for _ in range(5):
        boxes, least = bounded(shafts, 0, _halves(shafts, 0, boxes))
    low, high = (
        [np.log(20), math.log(0.3), math.log(30), math.log(3.96), 0.0, 0.0],
        [
            np.log(40),
            math.log(0.75),
            math.log(400),
            math.log(4.04),
            0.6,
            1.0,
        ],
    )
    drawn = rng.uniform(low, high, (6000, 6)).T
    z, slim, d, u = np.exp(drawn[:4])
    angle = (
        np.full(len(z), stage.toothing.helix_angle)
        if helix is None
        else rng.uniform(*helix, len(z))
    )
    own = {} if helix is None else {"helix_angle": angle}
    cut = stage.cut(pinion_shift=drawn[4], shift_sum=drawn[5], **own)
    pair = cut.of_diameter(d * np.cos(angle) / z, z, d, u, slim * d)
    load = np.full(len(z), train.torque), np.full(len(z), train.speed)
    used = stage.options[0].utilisations(pair, *load, train.safety)
    module = pair.normal_module
    good = (np.max([*used.values()], axis=0) <= 1.0) & (module >= 1.0) & (module <= 12.0)
    good &= kept(pair)
    point = np.empty((len(boxes.sizes), 1, int(good.sum())))
    rows = {"Z": z, "B_OVER_D": slim, "D": d, "END": u, "M": module, "B": slim * d}
    rows |= {"D2": u * d, "U": u, "T": np.tan(angle) if helix else np.ones_like(z)}
    for name, value in rows.items():
        point[getattr(rated_boxes, name), 0] = np.log(value[good])
    point[rated_boxes.X1, 0], point[rated_boxes.SUM, 0] = drawn[4:, good]
    low, high = (boxes.sizes[:, end, :, None] for end in (LOWER, UPPER))
    inside = ((low <= point + 1e-12) & (point <= high + 1e-12)).all(axis=0)
    assert good.sum() > 100 and inside.any(axis=0).all()
    share = np.where(inside, least[:, None], np.inf).min(axis=0)
    assert (share <= objective_share(train, 0, pair)[good] * (1.0 + 1e-9)).all()


def best_of_grid(train, steps):
    """Least value of designs on a grid of shifts, each the best of the search with them given."""
    ends = train.stages[0].shifts
    values = []
    for x1, total in product(*(np.linspace(*end, steps) for end in ends)):
        alone = ranging(train, (x1, x1), (total, total))
        result = solve(continuous_sizing.problem(alone), budget=Budget(0.7))
        values.append(math.inf if result.value is None else result.value)
    return min(values)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["agma", "iso"])
def test_no_given_shifts_are_below_the_bound(name):
    """And the search among all shifts is as good as the best of a grid of them."""
    train = ranging(rated_drive(4, [FREE], options=by(name)))
    result = solve(continuous_sizing.problem(train), budget=Budget(60.0, gap=0.03))
    given = best_of_grid(train, 4)
    assert 0.0 < result.bound <= result.value * (1.0 + 1e-9)
    assert result.bound <= given and result.value <= 1.001 * given


@pytest.mark.slow
@pytest.mark.parametrize("name", ["agma", "iso"])
def test_the_bound_of_two_stages_is_below_whole_teeth_of_any_shifts(name):
    usual = rated_drive(12, [FREE, FREE], options=by(name), pinion_teeth=(20, 22))
    train = ranging(usual)
    result = solve(continuous_sizing.problem(train), budget=Budget(30.0, gap=0.1))
    stage = train.stages[0]
    ways = tuple(
        stage.cut(pinion_shift=x1, shift_sum=total)
        for x1, total in product((0.0, 0.3, 0.6), (0.0, 0.5, 1.0))
    )
    several = [replace(s, toothings=ways, shifts=None) for s in train.stages]
    whole = solve(teeth.problem(replace(train, stages=tuple(several))))
    assert 0.0 < result.bound <= result.value * (1.0 + 1e-9) and whole.status == "optimal"
    assert result.bound <= whole.value
