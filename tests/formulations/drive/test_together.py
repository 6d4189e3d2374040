"""Sizes and layout at once: brute force over every train, anchors, early stops, kernels."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from brute_force import own_teeth
from campaigns import few
from gearboxes import face_width, smallest_box
from uncompiled import uncompiled

from gearopt.errors import SolveError
from gearopt.formulations.drive import layout, teeth, together
from gearopt.formulations.drive.gearbox import Clearances, Gearbox, KeepOut, Place, Shaft
from gearopt.formulations.drive.layout.slabs import arrangements, clashes, orders
from gearopt.formulations.drive.together import continuous, search, tables
from gearopt.formulations.drive.together.tables import numbers, rest
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.handles import handles
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run
from gearopt.physics.gears import MODULES

F = Fraction
IN_ORDER = ((0,), (1,), (2,))


def chong(kilowatt, rpm, ratio, widths):
    torque = 30e6 * kilowatt / (math.pi * rpm)
    series = MODULES["ISO 54 I"]
    own = Toothing(math.radians(25))
    stages = tuple(
        Stage((2.07, 48.0), FaceWidth(h, h), series, (20, 40), toothings=(own,)) for h in widths
    )
    return Train(torque, ratio, F(1, 100), stages, law=K_FACTOR)


def three():
    return chong(8.0, 3520.0, F(110), (F(3, 5), F(3, 5), F(3, 4)))


def elevator():
    return chong(7.5, 1450.0, F(2900, 133), (F(3, 5), F(3, 4)))


def frame(train, radii, **choices):
    """A function that makes the gearbox of gear pairs on shafts of given radii."""

    def make(pairs):
        shafts = tuple(Shaft(r) for r in radii)
        clear = choices.get("clearances", Clearances())
        return Gearbox(pairs, shafts, **{**choices, "clearances": clear})

    return make


def certified(train, make, gap, **budget):
    return run(together.problem(train, make), "exact", Budget(gap=gap, **budget), 0, None, gap)[0]


def some_face(rng):
    high = F(int(rng.choice([50, 70, 90])), 100)
    return [
        FaceWidth(high, high),
        FaceWidth(F(3, 10), high),
        FaceWidth(F(3, 10), high, step=F(int(rng.choice([2, 5])))),
        FaceWidth(F(1, 10), F(2), fixed=F(int(rng.choice([20, 30, 40])))),
    ][int(rng.choice(4, p=[0.4, 0.2, 0.2, 0.2]))]


def some_train(rng, stages=2):
    """Few teeth and modules, so that every train can be laid out."""
    found = []
    for k in range(stages):
        z = int(rng.choice([17, 18, 20]))
        small = [F(3, 2), F(2), F(5, 2), F(3)] if k < stages - 1 else [F(3), F(4), F(5), F(6)]
        few = tuple(sorted(rng.choice(np.array(small, object), 2, replace=False)))
        cap = [None, F(8)][int(rng.integers(2))]
        wheel = [None, F(300)][int(rng.integers(2))]
        k_limit, u_limit = float(rng.choice([1.5, 3.0])), float(rng.choice([40.0, 60.0]))
        stage = Stage(
            (k_limit, u_limit), some_face(rng), few, (z, z + 1), (1, 90), (F(1), cap), wheel
        )
        found.append(stage)
    ratio = F(int(rng.choice([40, 60, 85] if stages == 2 else [60, 90])), 10)
    torque, helix = float(rng.choice([2e4, 5e4])), math.radians(float(rng.choice([0, 15, 25])))
    coprime = bool(rng.random() < 0.2)
    made = tuple(replace(stage, toothings=(Toothing(helix),)) for stage in found)
    train = Train(torque, ratio, F(1, 100), made, coprime=coprime, law=K_FACTOR)
    return own_teeth(train) if coprime else train


def some_frame(rng, train):
    """A function that makes gearboxes of one random kind; shafts may follow from the torque."""
    first, torsion = float(rng.uniform(6, 12)), bool(rng.random() < 0.4)
    growth, stages = float(rng.uniform(1.2, 1.7)), len(train.stages)
    gaps = [rng.uniform(*r) for r in ((1, 6), (1, 4), (0, 12), (4, 12))]
    kinds = ["box_volume"] * 4 + ["plan_area", "face_area", "height", "longest_side"]
    choices = {
        "clearances": Clearances(*(float(g) for g in gaps)),
        "partial": bool(rng.random() < 0.4),
        "objective": str(rng.choice(kinds)),
        "motor": float(rng.choice([0.0, 0.0, 60.0])),
        "largest": (float(rng.choice([math.inf, 400.0])), math.inf, math.inf),
        "level": [(), (), (), (0, stages)][int(rng.integers(4))],
    }

    def make(pairs):
        radii, ratio = [first], 1.0
        for k, pair in enumerate(pairs, 1):
            ratio *= pair.ratio
            radii.append(first * (ratio ** (1.0 / 3.0) if torsion else growth**k))
        shafts = tuple(Shaft(r) for r in radii)
        return Gearbox(pairs, shafts, **choices)

    return make


MEASURES = {
    "box_volume": lambda w, h, length: w * h * length,
    "plan_area": lambda w, h, length: w * length,
    "face_area": lambda w, h, length: w * h,
    "height": lambda w, h, length: h,
}
TOGETHER = [(seed, 2, 1e-4) for seed in (3, *range(3), *range(4, 12))]  # 3: sizing first is worse
TOGETHER += [(seed, 3, 1e-3) for seed in (0, 2)]  # half a minute each


@pytest.mark.parametrize(("seed", "stages", "gap"), few(TOGETHER, 1))
def test_gears_and_box_as_by_brute_force(seed, stages, gap):
    rng = np.random.default_rng([stages, seed])
    train = some_train(rng, stages)
    make = some_frame(rng, train)
    best = smallest_box(train, make, 0.2 * gap)
    result = certified(train, make, gap)
    if math.isinf(best):
        assert result.status == "infeasible"
        return
    assert result.status == "optimal"
    assert result.value == pytest.approx(best, rel=1.2 * gap)
    assert result.bound <= best * (1 + 1e-9)


@pytest.mark.slow
def test_anchor_with_a_shared_slab():
    """The first and third stage side by side: a box that no sizing for volume alone finds."""
    train = three()
    make = frame(train, (8.0, 15.0, 22.5, 35.0))
    result = certified(train, make, 1e-2)
    assert result.status == "optimal"
    assert result.value <= 38_165_872.4
    box = make(together.pairs(train, np.array([1.5, 3, 4, 21, 21, 24, 162, 89, 80])))
    assert orders(box)[result.design["arrangement"]] == ((0, 2), (1,))


@pytest.mark.slow
def test_elevator():
    """18,406,823 mm3 when sized first; every choice of both is now within 1e-4 of this one."""
    train = elevator()
    result = certified(train, frame(train, (10.0, 17.5, 30.0)), 1e-4)
    assert result.status == "optimal"
    assert result.value == pytest.approx(17_582_508.8, rel=1e-4)
    assert result.report["gear_volume"] > 5_782_370.7


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_never_worse_than_sizing_first(seed):
    rng = np.random.default_rng([7, seed])
    train = some_train(rng)
    make = some_frame(rng, train)
    sized, outcome = run(teeth.problem(train), "exact")
    result = certified(train, make, 1e-3)
    if sized.status == "infeasible":
        assert result.status == "infeasible"
        return
    box = make(teeth.pairs(train, outcome.x))
    for order in (a for a in arrangements(box) if not clashes(box, a)):
        laid = run(layout.problem(replace(box, slabs=order.slabs)), "exact", Budget(gap=1e-4))[0]
        if laid.value is not None:
            assert result.value <= laid.value * (1 + 1e-9)


@pytest.mark.slow
def test_stopped_early_it_still_has_a_valid_bound():
    train = elevator()
    problem = together.problem(train, frame(train, (10.0, 17.5, 30.0)))
    bounds = []
    for stop in (1, 3, 8, 20, 60, 80):
        count = 0

        def watch(event, stop=stop):
            nonlocal count
            count += 1
            return count < stop

        result = run(problem, "exact", Budget(gap=1e-4), 0, watch)[0]
        assert result.status in ("limit", "optimal", "feasible")
        assert result.bound is None or result.bound <= 17_582_510
        assert result.value is None or result.value >= 17_582_508.8 * (1 - 1e-4)
        bounds.append(result.bound or 0.0)
    assert bounds == sorted(bounds)
    assert 0.0 < bounds[-1]


def test_what_face_widths_decide_is_refused():
    train = elevator()
    free = replace(train.stages[0], face_width=FaceWidth(F(3, 10), F(3, 5)))
    train = replace(train, stages=(free, train.stages[1]))
    keep = KeepOut("tank", (50.0, 80.0), (0.0, 10.0), (0.0, 30.0))
    with pytest.raises(SolveError, match="keep-outs with a range of x"):
        together.problem(train, frame(train, (10.0, 17.5, 30.0), keep_outs=(keep,)))


def test_bearings_longer_than_the_gap_may_reach_past_a_narrow_gear_and_are_refused():
    train = three()
    free = replace(train.stages[0], face_width=FaceWidth(F(3, 10), F(3, 5)))
    train = replace(train, stages=(free, *train.stages[1:]))
    gap = Clearances().axial

    def make(wide):
        shafts = tuple(Shaft(r, r + 5.0, wide) for r in (8.0, 15.0, 22.5, 35.0))
        return lambda pairs: Gearbox(pairs, shafts, slabs=IN_ORDER, partial=True)

    for wide in (0.0, 0.5, gap):
        bearings = numbers(train, make(wide))[0].bearing[:, 0]
        assert bearings.tolist() == ([13.0, 20.0, 27.5, 40.0] if wide else [0.0] * 4)
    with pytest.raises(SolveError, match="bearings beside gears"):
        numbers(train, make(gap + 1.0))
    two = replace(train, stages=train.stages[:2])  # whose bearings face no gear of another stage
    shafts = tuple(Shaft(r, r + 5.0, gap + 1.0) for r in (8.0, 15.0, 35.0))
    numbers(two, lambda pairs: Gearbox(pairs, shafts, slabs=IN_ORDER[:2], partial=True))


def at_its_limit():
    """A drive and frames of its least height in decimals, 2.2 (56 + 2) + 2 8 = 143.6 mm."""
    face, series = FaceWidth(F(3, 10), F(7, 10)), (F(11, 5), F(12, 5), F(13, 5), F(14, 5))
    stage = Stage((2.0, 48.0), face, series, (17, 26))
    train = Train(1.5e4, F(9), F(1, 20), (stage, stage), law=K_FACTOR)
    clear = Clearances(5.0, 2.0, 8.0, 10.0)
    largest = (math.inf, 143.6, math.inf)
    return train, frame(train, (8.0, 10.0, 12.0), clearances=clear, largest=largest)


def test_a_box_as_large_as_it_may_be_is_not_too_large_by_rounding():
    train, make = at_its_limit()
    drive, _ = numbers(train, make)
    nodes = uncompiled("gearopt.formulations.drive.together.node_kernel")
    high = 2.0 * (0.5 * 2.2 * 56 + 2.2 + 8.0)
    assert high > 143.6  # by rounding alone
    assert math.isfinite(nodes.worth(drive.aim, 50.0, high * high, high))
    assert math.isinf(nodes.worth(drive.aim, 50.0, high * high, high * (1.0 + 1e-10)))
    box = make((train.pair(0, 2.2, 17, 56, 14.0), train.pair(1, 2.2, 21, 55, 32.0)))
    (order,) = search.orders_of(replace(box, slabs=((0,), (1,))))
    tight = replace(box, slabs=order.slabs, largest=(math.inf, math.inf, order.length - 1e-12))
    assert search.orders_of(tight)


@pytest.mark.slow
def test_a_train_that_meets_the_largest_box_exactly_is_found():
    train, make = at_its_limit()
    result = certified(train, make, 1e-3)
    assert result.status == "optimal"
    assert result.value == pytest.approx(2_716_776.33, rel=1e-3)


def test_a_train_whose_layouts_are_not_exhausted_leaves_the_search_unproven(monkeypatch):
    train = elevator()
    stage = replace(train.stages[0], modules=(F(2), F(3)), pinion_teeth=(20, 21))
    train = replace(train, stages=(stage, replace(train.stages[1], modules=(F(3), F(4)))))
    work = search.Search(train, frame(train, (10.0, 17.5, 30.0)), Clock(), 0)
    pairs = train.pair(0, 2.0, 21, 128, 25.0), train.pair(1, 3.0, 24, 85, 50.0)
    assert (
        search.lay(work, (pairs, (0, 0)), 0.3)
        and math.isfinite(work.value)
        and not work.clock.stopped
    )
    best, box = work.value, work.make(pairs)
    (order,) = search.orders_of(box)  # of its layouts `best` is the least
    assert work.trains == 1
    for bound, known in ((0.0, None), (5.0, 5.0), (math.inf, None)):
        work.clock.bound = bound
        assert together._outcome(work, together.slabs_of(box), True).bound == known
    for share, below in ((0.9, False), (1.2, False), (1.3, False), (1.5, True)):
        work.clock.best = share * best
        assert search._below(work, box, order, 0.3) == below
    work.clock.best, work.clock.stopped = 0.9 * best, True
    assert search._below(work, box, order, 0.3)  # nothing is known of it
    monkeypatch.setattr("gearopt.formulations.drive.layout.exact.DEEP", 3)
    fresh = search.Search(train, work.make, Clock(), 0)
    assert search._below(fresh, box, order, 0.3)  # any layout is better than none
    assert not search.lay(fresh, (pairs, (0, 0)), 0.003) and not fresh.clock.stopped


def test_tables_of_the_rest_hold_ratios_at_the_edges_of_their_cells():
    """Logarithms a billionth beside multiples of the cells: no ratio falls between two of them."""
    stage = Stage((2.0, 48.0), FaceWidth(F(3, 5), F(3, 5)), (F(2), F(3), F(4), F(6)), (20, 40))
    train = Train(3e4, F(42 * 45, 16 * 15), F(0), (stage, stage, stage), law=K_FACTOR)
    teeth = ((16, 42), (15, 45), (20, 20))
    for k, pair in enumerate(teeth):
        train = train.fixed_teeth(k, *pair)
    drive, _ = numbers(train, frame(train, (8.0, 10.0, 12.0, 14.0)))
    first, second = (math.log(z2 / z1) for z1, z2 in teeth[:2])
    delta = (second + 1e-9) / 7635
    assert 1e-9 < first - 6707 * delta < 2e-9
    held = rest(drive._replace(delta=delta), lambda: True)
    cell = int((first + second - 1e-9) / delta)  # as `bound` of the nodes asks
    assert cell == 6707 + 7635 - 1
    assert np.isfinite(held.least[2, :2, cell]).all()
    assert not held.edge[0].any()
    for edge, z2 in zip(held.edge[1:], (42, 45), strict=True):  # tip radii of modules 2 to 6
        assert edge[[0, -1]] == pytest.approx([z2 + 2.0, 3.0 * z2 + 6.0])
        assert edge[0] < z2 + 2.0


def test_tables_of_the_rest_are_the_same_in_slices_of_any_size(monkeypatch):
    train = three()
    limited = (replace(s, pinion_teeth=(20, 21), modules=(F(2), F(3))) for s in train.stages)
    train = replace(train, stages=tuple(limited))
    drive, _ = numbers(train, frame(train, (8.0, 15.0, 22.5, 35.0)))
    drive = drive._replace(delta=drive.log_high / 6.0)
    whole, sizes = rest(drive, lambda: True), np.diff(drive.start)[:-1] * drive.modules.shape[1]
    filled = int(drive.log_high / drive.delta) + 2
    for entries in (1, 2 * sizes[0], 3 * sizes[1]):
        asked = []
        monkeypatch.setattr(tables, "SLICE", entries)
        sliced = rest(drive, lambda asked=asked: asked.append(0) or True)
        assert all(np.array_equal(a, b) for a, b in zip(whole, sliced, strict=True))
        cells = [max(1, entries // size) for size in sizes]
        assert len(asked) == sum(math.ceil(filled / count) for count in cells)
    assert np.isfinite(whole.least[1]).any()
    none = tables.useful(drive, 0.0)
    assert not none.z1.size and np.isinf(rest(none, lambda: True).least).all()
    assert rest(drive, lambda: False) is None


def test_passes_raise_the_bound_and_never_lower_it(monkeypatch):
    values = iter((10.0, 7.0, 6.5))

    def prove(work, *_):
        work.clock.best, work.best = next(values), "a design"
        return True

    work = SimpleNamespace(drive=None)
    stubs = {"prove": prove, "prepare": lambda *_: work, "numbers": lambda *_: (None, None)}
    for name, stub in stubs.items():
        monkeypatch.setattr(together, name, stub)
    own = search.Search(elevator(), None, Clock(Budget(gap=0.03)), 0)
    own.clock.bound = 0.0
    assert together._proven(own)
    assert own.clock.bound == pytest.approx(0.7 * 10.0)
    assert next(values, None) is None


def test_no_tables_of_box_and_gears_are_made_when_time_is_over(monkeypatch):
    """A layout that is known is the answer, without a bound."""
    train, make = elevator(), frame(elevator(), (12.0, 19.0, 32.0))

    def tables(*given):
        raise AssertionError("tables are made")

    monkeypatch.setattr(together, "numbers", tables)
    own = search.Search(train, make, Clock(Budget(seconds=0.0)), 0)
    assert together._searched(own, None).message == "stopped before a layout was found"
    point = np.array([2, 3, 21, 24, 128, 85, -0.7, 1.5])
    box, angles, order = together.laid_out(train, make, point)
    own = search.Search(train, make, Clock(Budget(seconds=0.0)), 0)
    outcome = together._searched(own, ((box.pairs, (0, 0)), order, np.array(angles)))
    assert outcome.x == pytest.approx(point) and not outcome.finished and outcome.bound is None


@pytest.mark.parametrize(
    ("stopped", "possible", "infeasible"),
    [(False, False, True), (False, True, False), (True, False, False)],
)
def test_only_an_exhausted_search_without_a_design_is_infeasible(stopped, possible, infeasible):
    own = search.Search(elevator(), None, Clock(), 0)
    own.clock.stopped = stopped
    outcome = together._outcome(own, (), possible)
    assert outcome.x is None and outcome.infeasible is infeasible
    assert outcome.finished is not stopped and bool(outcome.message) is stopped


def test_a_pass_without_anything_below_its_cut_is_finished():
    own, work = SimpleNamespace(value=0.0), SimpleNamespace(drive=SimpleNamespace(kind=np.ones(2)))
    assert search.prove(own, work, 0.1) is True


def test_modules_that_no_width_below_the_cut_leaves_are_dropped():
    train = elevator()
    drive, _ = numbers(train, frame(train, (10.0, 17.5, 30.0)))
    count = drive.z1.size
    widths = np.full((count, drive.modules.shape[1]), np.inf)
    widths[0, [2, 4]] = widths[1, 3] = 1.0
    rows = {"row": np.arange(count + 1), "cell": np.zeros(count, np.int64), "step": 9.0}
    kept = search.shortened(drive._replace(bisected=widths, **rows), math.inf)
    assert kept.bisected.shape[1] == kept.modules.shape[1] == 5
    assert (kept.first[0], kept.last[0]) == (2, 4) and (kept.first[1], kept.last[1]) == (3, 3)
    assert not kept.last[2:].any() and kept.most_steps.shape[0] in (1, 5)


@pytest.mark.parametrize("total", [(3, 3), (4, 4), (5, 5), (4, 5), (3, 6)])
def test_the_window_of_a_pair_spans_the_torques_of_all_trains_that_have_it(total):
    """Three stages of log ratio 1 or 2 each, within a total log ratio."""
    ratios = {"start": np.array([0, 2, 4, 6]), "log_ratio": np.tile([1.0, 2.0], 3)}
    drive = SimpleNamespace(kind=np.zeros(3), log_low=total[0], log_high=total[1], **ratios)
    trains = [t for t in product((1, 2), repeat=3) if total[0] <= sum(t) <= total[1]]
    for stage in range(3):
        for own, low, high in zip((1, 2), *search._window(drive, stage), strict=True):
            reached = [sum(t[:stage]) for t in trains if t[stage] == own]
            assert (
                (low, high) == (min(reached), max(reached)) if reached else low > high or not stage
            )


def test_other_pairs_are_refused():
    train = elevator()
    make = frame(train, (10.0, 17.5, 30.0))
    with pytest.raises(SolveError, match="must have the gear pairs"):
        together.problem(train, lambda pairs: make(tuple(p.of_width(50.0) for p in pairs)))


def test_the_text_measures_a_layout_as_layout_does():
    train = elevator()
    tank = KeepOut("tank", (50.0, 160.0), (0.0, 10.0))
    make = frame(train, (10.0, 17.5, 30.0), keep_outs=(tank,))
    problem = together.problem(train, make)
    point = np.array([2.0, 3.0, 21, 24, 128, 85, -0.7, -1.5])
    other = np.array([*point[:6], 0.3, 0.6])
    box = make(together.pairs(train, point))
    laid = layout.problem(box).batch(np.stack([point[-2:], other[-2:]]))
    found = problem.batch(np.stack([point, other]))
    assert found.F[:, 0] == pytest.approx(laid.F[:, 0], rel=1e-14)
    names = [r.name for r in problem.rows.inequalities]
    assert {"k_factor[1]", "ratio_high"} <= set(names)
    assert sum(name.startswith("shafts_apart") for name in names) == 3
    (order,) = search.orders_of(box)
    links = np.array([p.centre_distance for p in box.pairs])
    for row, angles in zip(found.G, (point[-2:], other[-2:]), strict=True):
        y, z = (np.append(0.0, np.cumsum(links * f(angles))) for f in (np.cos, np.sin))
        past = np.maximum(np.maximum(50.0 - y, y - 160.0), 0.0)
        over = np.maximum(np.maximum(-z, z - 10.0), 0.0)
        first, second = np.triu_indices(3, 1)
        need = np.append(order.keep_apart[0], order.apart[first, second]) ** 2
        there = np.append(
            past**2 + over**2, (y[first] - y[second]) ** 2 + (z[first] - z[second]) ** 2
        )
        asked = [f"clear_of_keep_out[1,{k}]" for k in (1, 2, 3)]
        asked += [f"shafts_apart[{i + 1},{j + 1}]" for i, j in zip(first, second, strict=True)]
        kept = [row[names.index(name)] for name in asked]
        wanted = 1.0 + (need - there) / np.maximum(np.maximum(need, there), 1.0)
        assert kept == pytest.approx(wanted, rel=1e-12)


def test_a_point_with_an_arrangement_is_read():
    train = three()
    make = frame(train, (8.0, 15.0, 22.5, 35.0))
    point = np.array([1.5, 3, 4, 21, 21, 24, 162, 89, 80, -0.7, -1.5, 0.4, 3])
    box, angles, order = together.laid_out(train, make, point)
    assert angles == (-0.7, -1.5, 0.4) and order.slabs == orders(box)[3] == ((0, 2), (1,))
    assert [p.pinion_teeth for p in box.pairs] == [21, 21, 24]
    two, alone = elevator(), frame(elevator(), (10.0, 17.5, 30.0), slabs=((0,), (1,)))
    _, angles, order = together.laid_out(two, alone, np.array([2, 3, 21, 24, 128, 85, -0.7, 1.5]))
    assert angles == (-0.7, 1.5) and order.slabs == ((0,), (1,))
    arrangement = together.text(train, make, box, {}).variables[-1]
    assert (arrangement.lower, arrangement.upper, arrangement.guess) == (0, 3, 0)


@pytest.mark.parametrize("width", [None, 50.0])
@pytest.mark.parametrize("objective", MEASURES)
def test_objectives_are_powers_of_sides_with_a_length(objective, width):
    """Constant and factor of the length 300, by the powers of width 70 and height 40."""
    train = elevator()
    box = frame(train, (10.0, 17.5, 30.0), objective=objective, width=width)(
        (train.pair(0, 2.0, 21, 128, 25.0), train.pair(1, 3.0, 24, 85, 50.0))
    )
    powers, (constant, slope) = tables._objective(box)
    length, value = constant + slope * 300.0, 70.0 ** powers[0] * 40.0 ** powers[1]
    assert length * value == pytest.approx(MEASURES[objective](width or 70.0, 40.0, 300.0))
    longest = replace(box, objective="longest_side")  # no less than the width that is given
    assert tables._objective(longest) == ((1.0, 1.0), (width or 0.0, 0.0))


def test_each_first_stage_has_a_chain_of_the_shafts_behind_it():
    train = elevator()
    given = {"places": (Place(2, (50.0, 60.0), (0.0, 10.0)),), "level": (0, 2)}
    rows = tables.chains(*numbers(train, frame(train, (10.0, 17.5, 30.0), **given)))
    assert [len(c.link) for c in rows] == [2, 1]
    assert [c.apart.shape for c in rows] == [(1, 3, 3), (1, 2, 2)]
    assert [len(c.place) for c in rows] == [len(c.reach) for c in rows] == [3, 2]
    assert rows[0].place[2].tolist() == [50.0, 60.0, 0.0, 10.0]
    assert np.isinf(rows[0].place[:2]).all() and np.isinf(rows[1].place).all()
    assert [c.level.tolist() for c in rows] == [[0, 2], []]


def test_radii_of_shafts_are_the_least_of_every_cell_of_torque_to_the_highest():
    train = elevator()

    def make(pairs):
        ratios = np.cumprod([1.0, *(p.ratio for p in pairs)])
        return Gearbox(pairs, tuple(Shaft(10.0 * float(r)) for r in ratios))

    radii = numbers(train, make)[0].shaft
    ends = 10.0 * np.exp(tables.DELTA * np.arange(radii.shape[1]))
    assert radii == pytest.approx(np.stack([np.full(len(ends), 10.0), ends, ends]))
    assert 10.0 * train.highest_ratio < ends[-1]


def test_widths_by_cells_of_torque_are_those_of_their_lower_ends(monkeypatch):
    """Of a law without loads: one cell where there may be few entries."""
    train = elevator()
    table = SimpleNamespace(z1=np.ones(3), load=None, modules=(2.0,), width=lambda t, *_: 1e-3 * t)
    _, widths, rows, first, step = tables._loads(train, [table])
    count = math.ceil((math.log(train.highest_ratio) + 0.02) / 0.01)
    assert rows.tolist() == [0, count, 2 * count, 3 * count] and not first.any()
    wanted = 1e-3 * train.torque * np.exp(step * np.arange(count))
    assert widths[:count, 0] == pytest.approx(wanted) and count * step >= math.log(
        train.highest_ratio
    )
    monkeypatch.setattr(tables, "ENTRIES", 2)
    assert tables._loads(train, [table])[1] == pytest.approx(np.full((3, 1), 1e-3 * train.torque))
    wider = SimpleNamespace(**{**vars(table), "z1": np.ones(1), "modules": (2.0, 3.0)})
    monkeypatch.setattr(tables, "ENTRIES", 16)  # of four pairs and two modules
    _, widths, rows, *_ = tables._loads(train, [table, wider])
    assert widths.shape == (8, 2) and rows.tolist() == [0, 2, 4, 6, 8]
    assert np.isinf(widths[:6, 1]).all() and np.isfinite(widths[6:]).all()
    table.z1 = np.ones(0)  # no pair is possible
    assert tables._loads(train, [table])[1].shape == (0, 1)


def test_widths_of_a_cell_are_the_least_of_it_and_those_behind_it_of_its_pair():
    cells = np.array([1, 4, 2])
    row = np.concatenate([[0], np.cumsum(cells)])
    widths = np.random.default_rng(0).random((row[-1], 3))
    ends = np.repeat(row[1:], cells)
    least = [widths[start:stop].min(axis=0) for start, stop in enumerate(ends)]
    search._hold_stronger(widths, row, cells)
    assert np.array_equal(widths, least)


def test_real_valued_layouts_keep_clearances_and_bounds():
    train = elevator()
    make = frame(train, (10.0, 17.5, 30.0), motor=60.0, width=200.0)
    pairs = train.pair(0, 2.0, 21, 128, 25.0), train.pair(1, 3.0, 24, 85, 50.0)
    box = make(pairs)
    rows = continuous._clearance_rows(box, [], ([0.0, 100.0, 80.0], [10.0, 30.0, 70.0]))
    need = 60.0 + 30.0 + box.clearances.shafts
    assert rows == {"motor_to_output": pytest.approx(2.0 - (80.0**2 + 60.0**2) / need**2)}
    tank = replace(box, keep_outs=(KeepOut("tank", (50.0, 80.0), (0.0, 12.0)),))
    bodies = search.orders_of(box)[0].bodies
    clear = continuous._keep_out_rows(tank, bodies, ([0.0, 100.0, 80.0], [10.0, 30.0, 70.0]))
    for k, there in enumerate((50.0**2, 20.0**2 + 18.0**2, 58.0**2)):
        for b, body in enumerate(bodies[k]):
            wanted = 2.0 - there / (body.radius + box.clearances.shafts) ** 2
            assert clear[f"clear_of_keep_out[1][{k + 1}][{b + 1}]"] == pytest.approx(wanted)
    posed = continuous.problem(train, make, ((0,), (1,)), (pairs, (-0.7, -1.5)))
    slab, wide = (next(v for v in posed.variables if v.name == n) for n in ("slab", "width"))
    assert slab.guess == (25.0, 50.0) and slab.lower == pytest.approx(1e-4 * slab.upper)
    start = posed.batch(posed.bounds()[2][None])
    walls = {r.name: start.G[0, k] for k, r in enumerate(posed.rows.inequalities)}
    assert walls["given_width"] == pytest.approx(wide.guess / 200.0)
    tied = np.array([0.6 * 42.0 / 25.0, 0.75 * 72.0 / 50.0]) / train.stages[0].toothing.cosine
    assert [v for n, v in walls.items() if n.startswith("slab[")] == pytest.approx(tied)
    for side in ("low_y", "high_y", "low_z", "high_z"):  # each touches a body
        there = [v for n, v in walls.items() if n.startswith(side)]
        assert max(there) == pytest.approx(1.0) and min(there) < 0.9
    limits = {h.family.split()[0] for h in handles(posed)}  # not the ends of where it searches
    assert limits.isdisjoint({"angle", "left", "bottom", "width", "height", "slab"})


def test_the_width_of_a_stage_without_options_is_that_of_its_load():
    train = elevator()
    wanted = face_width(train.stages[0], train.torque, train.stages[0].modules[4], (21, 128))
    widths = search.widths_of(train.fixed_teeth(0, 21, 128), 0, train.torque, 4)
    assert widths == [pytest.approx(wanted, rel=1e-12)]


@pytest.mark.slow
def test_kernels_bound_what_they_measure():
    """The closed form of two discs is the least W H of all angles; widths are those of `teeth`."""
    nodes = uncompiled("gearopt.formulations.drive.together.node_kernel")
    rng = np.random.default_rng(5)
    angle = np.linspace(0.0, 0.5 * math.pi, 20_001)
    for r0, r1, share in rng.uniform([10, 10, 0.5], [200, 200, 1.5], (200, 3)):
        a = share * (r0 + r1)
        sides = [
            np.maximum(2 * max(r0, r1), r0 + r1 + a * c) for c in (np.cos(angle), np.sin(angle))
        ]
        least = nodes.least_area(r0, r1, a)
        assert least <= (sides[0] * sides[1]).min() * (1 + 1e-12)
        assert least == pytest.approx((sides[0] * sides[1]).min(), rel=1e-3)
    for seed in range(6):
        train = some_train(np.random.default_rng(seed))
        drive, _ = numbers(train, frame(train, (8.0, 12.0, 20.0)))
        for p in rng.integers(drive.start[1], size=50):
            torque = float(rng.choice([1e3, 1e4, 3e4]))
            for k in range(drive.first[p], drive.last[p] + 1):
                z1, z2, m = int(drive.z1[p]), int(drive.z2[p]), float(drive.modules[0, k])
                wanted = face_width(train.stages[0], torque, m, (z1, z2))
                enough = k >= nodes.module(drive, 0, p, torque)
                b = nodes.width(drive, 0, p, k, torque) if enough else math.inf
                assert b == pytest.approx(math.inf if wanted is None else wanted, rel=1e-12)
