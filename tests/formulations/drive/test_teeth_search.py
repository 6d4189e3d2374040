"""What a search prunes and proves, and that it may be stopped at any look at the clock."""

import math
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from itertools import product

import numpy as np
import pytest
from brute_force import cost, every_train, some_drive
from campaigns import few
from small_drives import FACES, OBJECTIVES, drive

from gearopt.formulations.drive.teeth import _in_order
from gearopt.formulations.drive.teeth import later_stages as bounds
from gearopt.formulations.drive.teeth import stage as staging
from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.later_stages import bound
from gearopt.formulations.drive.teeth.progress import TIE
from gearopt.formulations.drive.teeth.reach import first_cut, reach
from gearopt.formulations.drive.teeth.search import any_train, possible, reaches, search, within
from gearopt.formulations.drive.teeth.tables import table
from gearopt.optimise.result import Budget

F = Fraction
searching = import_module("gearopt.formulations.drive.teeth.search")  # not its function


def in_reach(train):
    """Whether numbers of teeth keep the ratio, by looking at all of them."""
    stages = [
        [
            (z1, z2)
            for z1, start, stop in spans(train, k, train.highest_ratio)
            for z2 in range(start, stop + 1)
            if not train.coprime or math.gcd(z1, z2) == 1
        ]
        for k in range(len(train.stages))
    ]
    return any(within(train, teeth) for teeth in product(*stages))


def test_ratios_out_of_reach_are_those_of_no_numbers_of_teeth():
    """Of random narrow ranges, with ties at the ends of the tolerance, and hunting teeth."""
    rng = np.random.default_rng(5)
    answers = []
    for seed in range(300):
        count = 1 + seed % 3
        teeth = [tuple(sorted(rng.integers(12, 16, 2).tolist())) for _ in range(count)]
        wheels = [tuple(sorted(rng.integers(24, 30, 2).tolist())) for _ in range(count)]
        ends = [(rng.choice(z), rng.choice(w)) for z, w in zip(teeth, wheels, strict=True)]
        total = math.prod(F(int(w), int(z)) for z, w in ends)
        tolerance = F(int(rng.integers(0, 3)), 500)
        total *= (1, 1 / (1 + tolerance), F(10**15 + 1, 10**15))[seed // 3 % 3]
        train = drive(count, total=total, tolerance=tolerance, coprime=bool(seed % 2))
        rows = zip(train.stages, teeth, wheels, strict=True)
        stages = [replace(s, pinion_teeth=z, wheel_teeth=w, ratio=(F(1), None)) for s, z, w in rows]
        train = replace(train, stages=tuple(stages))
        answers.append(reaches(train))
        assert answers[-1] is in_reach(train)
    assert 60 < answers.count(False) < 240


def test_within_is_decided_in_whole_numbers():
    train = drive(2, total=F(10**20 + 1, 10**19), tolerance=F(0))
    assert not within(train, ((10, 100), (10, 10)))
    pairs = ((10**10, 10**20 + 1), (10**10, 10))
    assert within(train, pairs)
    wide = replace(train, ratio=F(10), tolerance=F(1, 10))
    for teeth_of, good in (((10, 90), True), ((10, 110), True), ((100, 899), False)):
        assert within(wide, (teeth_of,)) is good
    assert not within(wide, ((100, 1101),)) and within(wide, ((10, 100),))
    halves = replace(wide, ratio=F(9, 4), tolerance=F(1, 9))  # from 2 to 5/2
    for teeth_of, good in (((10, 20), 1), ((10, 25), 1), ((100, 199), 0), ((100, 251), 0)):
        assert within(halves, (teeth_of,)) is bool(good)


@pytest.mark.parametrize("number", range(8))
def test_the_cheapest_of_equal_ratios_and_of_those_the_first(number):
    rng = np.random.default_rng(number)
    node = np.sort(rng.integers(0, 4, 60))
    ratio = np.concatenate([np.sort(rng.integers(1, 5, (node == n).sum())) for n in range(4)])
    price = rng.choice([1.0, 1.0 + 0.5 * TIE, 1.0 + 5.0 * TIE, 2.0, np.inf], 60)
    keep = searching._best_of_ratio(node, ratio.astype(float), price)
    expected = np.zeros(60, bool)
    for n, r in product(range(4), range(1, 5)):
        group = np.flatnonzero((node == n) & (ratio == r))
        if len(group) and np.isfinite(price[group]).any():
            good = [g for g in group if price[g] <= price[group].min() * (1.0 + TIE)]
            expected[good[0]] = True
    assert (keep == expected).all()
    none = searching._best_of_ratio(np.empty(0, int), np.empty(0), np.empty(0))
    assert none.tolist() == [] and none.dtype == bool
    one = searching._best_of_ratio(np.zeros(1, int), np.ones(1), np.array([np.inf]))
    assert one.tolist() == [False]


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("objective", few(OBJECTIVES, 2))
def test_the_reach_of_a_stage_is_where_its_load_alone_costs_too_much(face, objective):
    train = drive(3, face, F(200), objective=objective)
    cut, most = F(18), train.highest_ratio

    def least(k, u):
        """Of stage k at the input torque, with real-valued sizes and K-factor alone; u: any."""
        own = train.stages[k]
        load = 2.0 * train.torque * (1.0 + 1.0 / u) / own.allowable[0]
        if objective in ("gear_volume", "mass"):
            return cost(train, k, 1.0, load, u)
        width = own.face_width
        d = np.sqrt(load / 24.0) if width.fixed else (load / float(width.high)) ** (1.0 / 3.0)
        return cost(train, k, d, 1.0, u)

    def of_all(u):
        return np.min([least(k, u) for k in range(3)], axis=0)

    ratios = np.geomspace(float(cut), float(most), 2000)
    costs, step = of_all(ratios), ratios[1] / ratios[0]
    for value in of_all(np.array([20.0, 60.0, 150.0])):
        found = float(reach(train, cut, most, value))
        assert found == pytest.approx(ratios[costs <= value][-1] * step, rel=1e-9)
    tie = costs[700]
    found = [float(reach(train, cut, most, tie * part)) for part in (1 - 1e-14, 1 + 1e-14)]
    assert ratios[700] == pytest.approx(found[0], rel=1e-12)
    assert ratios[701] == pytest.approx(found[1], rel=1e-12)
    assert reach(train, cut, most, 1e-9) == cut
    assert reach(train, cut, most, math.inf) == most
    assert reach(train, cut, most, 1e30) == most
    assert reach(train, most, most, 1e-9) == most


WORK = {  # stages, seed, trains wanted: pairs looked at, nodes, trains compared
    (2, 0, 1): (15523, 4, 3055),
    (2, 3, 1): (5596, 16, 13),
    (2, 6, 1): (2753, 13, 18),
    (2, 8, 1): (640, 2, 11),
    (2, 10, 1): (8621, 4, 412),
    (2, 13, 1): (3349, 2, 1189),
    (2, 15, 1): (18397, 4, 2575),
    (2, 13, 10): (3257, 2, 1143),
    (3, 2, 1): (879, 4, 6),
    (3, 2, 10): (4150, 47, 26),
    (3, 5, 1): (2721, 37, 3),
    (3, 5, 10): (14531, 84, 20),
    (3, 8, 1): (746, 19, 29),
    (3, 8, 10): (1145, 37, 46),
    (3, 9, 1): (2298, 8, 150),
    (3, 9, 10): (2542, 8, 223),
    (3, 12, 1): (673, 25, 4),
    (3, 12, 10): (2681, 45, 19),
    (4, 0, 1): (7150, 35, 5),
    (4, 3, 1): (153016, 1052, 0),
}
IMPATIENT = {  # the same with finer grids sooner
    (3, 5, 1): (3699, 68, 6),
    (3, 7, 1): (4355, 13, 2689),
    (3, 9, 1): (2561, 11, 152),
}


def work(stages, number, wanted):
    progress = search(some_drive(number, stages), wanted, Budget())
    return progress.found, (progress.clock.evaluations, progress.nodes, progress.compared)


QUICK = [case for case, counts in WORK.items() if sum(counts) < 5000]


@pytest.mark.parametrize(("stages", "number", "wanted"), few(WORK, QUICK))
def test_pruning_is_worth_what_it_was(stages, number, wanted):
    """Within what rounding may change; a bound that is less tight looks at more."""
    counts = work(stages, number, wanted)[1]
    assert counts == pytest.approx(WORK[stages, number, wanted], rel=0.02, abs=1)


@pytest.mark.parametrize(("stages", "number", "wanted"), few(IMPATIENT, [(3, 9, 1)]))
def test_finer_grids_find_the_same_with_less(stages, number, wanted, monkeypatch):
    case = stages, number, wanted
    found = work(*case)[0]
    monkeypatch.setattr(searching, "FIRST_LOOK", 300)
    monkeypatch.setattr(searching, "PATIENCE", 1000)
    again, counts = work(*case)
    assert again == found and counts == pytest.approx(IMPATIENT[case], rel=0.02, abs=1)


@pytest.mark.parametrize("patience", [1, 1000])
@pytest.mark.parametrize(
    ("face", "total", "tolerance"),
    [("tied", 5, 0), ("stepped", 5, F(1, 50)), ("fixed", 4, F(1, 1000))],
)
def test_a_look_that_is_cut_short_proves_nothing(face, total, tolerance, patience, monkeypatch):
    """Where patience ends before the trains do, the search goes on, up to the same ratio too."""
    train = drive(3, face, total, tolerance=F(tolerance), pinion_teeth=(15, 18))
    assert first_cut(train) == train.highest_ratio
    monkeypatch.setattr(searching, "FIRST_LOOK", patience)
    monkeypatch.setattr(searching, "PATIENCE", 1000)
    found = search(train, 1, Budget())
    assert found.found[0][0] == pytest.approx(every_train(train).values.min(), rel=1e-12)


@pytest.mark.parametrize("ratio", [F(101, 10), F(107, 10)])
def test_one_stage_may_have_all_of_a_ratio_that_no_double_is(ratio):
    """A heavy second stage is best idle; the first look ends below the ratio of the first."""
    assert F(float(ratio)) < ratio
    given = {"allowable": (1e9, 1e9), "pinion_teeth": (20, 20)}
    train = drive(2, total=ratio, tolerance=F(0))
    stages = tuple(
        replace(s, modules=(m,), **given) for s, m in zip(train.stages, (F(2), F(20)), strict=True)
    )
    found = search(replace(train, stages=stages), 1, Budget()).found
    assert [pairs for _, pairs in found] == [((20, int(20 * ratio)), (20, 20))]


@pytest.mark.parametrize("tolerance", [F(0), F(1, 100)])
def test_what_a_first_look_proves_is_not_told_as_a_bound_of_all(tolerance):
    """The best train has 38:1 in its light first stage, beyond the first look."""
    given = {"allowable": (1e9, 1e9), "pinion_teeth": (20, 20)}
    train = drive(3, total=60, tolerance=tolerance)
    stages = tuple(
        replace(s, modules=(m,), **given) for s, m in zip(train.stages, (2, 20, 20), strict=True)
    )
    train, seen = replace(train, stages=stages), []
    best, (first, *_) = search(train, 1, Budget(), seen.append).found[0]
    assert F(first[1], first[0]) > first_cut(train)
    told = [event.bound for event in seen if event.bound is not None]
    assert told and max(told) <= best
    near = search(train, 1, Budget(gap=0.1))
    assert near.found[0][0] * (1.0 - 0.1) <= best and near.bound <= best


def test_of_many_trains_no_more_than_the_wanted_are_spelled_out(monkeypatch):
    """And their ties; the others are known to be worse by their cost alone."""
    train, spelled = drive(2, total=6), []
    monkeypatch.setattr(
        searching, "within", lambda t, teeth_of: spelled.append(teeth_of) or within(t, teeth_of)
    )
    for wanted, most in ((1, 3), (4, 12)):
        spelled.clear()
        progress = search(train, wanted, Budget())
        assert len(progress.found) == wanted and progress.compared > 100
        assert len(spelled) <= most


@pytest.mark.parametrize(
    ("stages", "number", "first"), few([(2, 3, 0.01), (3, 5, 0.01), (4, 0, 0.005)], 2)
)
def test_grids_are_halved_while_they_fit(stages, number, first, monkeypatch):
    """One grid for a first look, however short; then finer ones, up to the largest.

    Of two stages, whose bound is that of the last one alone, none is finer.
    """
    train, made, looked = some_drive(number, stages), [], []

    def noted(train, tables, delta, tick, *others):
        made.append(delta)
        looked.append(tick.__self__.clock.evaluations)
        return bound(train, tables, delta, tick, *others)

    monkeypatch.setattr(searching, "bound", noted)
    monkeypatch.setattr(searching, "FIRST_LOOK", 0)
    monkeypatch.setattr(searching, "PATIENCE", 0)
    own = table(train, stages - 1, train.highest_ratio)
    finer = math.log(train.highest_ratio) * own.log_ratio[-1] / (first / 2) ** 2
    halved = [first, first, first / 2] if stages > 2 else [first] * 2
    for cells, deltas in ((finer, halved), (finer * (1 - 1e-9), [first] * 2)):
        made.clear()
        looked.clear()
        monkeypatch.setattr(searching, "CELLS", cells)
        search(train, 1, Budget(evaluations=20_000))
        assert made == deltas
        assert looked[0] == 0 and (np.diff(looked) > 0).all()


@pytest.mark.parametrize(("stages", "number"), few([(2, 3), (3, 2), (2, 6), (3, 8)], 2))
@pytest.mark.parametrize("tolerance", [F(0), None])
def test_what_is_near_an_end_of_the_ratio_is_decided_in_whole_numbers(
    stages, number, tolerance, monkeypatch
):
    """Whatever is called near: here far more than rounding asks for."""
    train = some_drive(number, stages)
    train = train if tolerance is None else replace(train, tolerance=tolerance)
    found = search(train, 5, Budget())
    monkeypatch.setattr(searching, "EDGE", 0.003)
    again = search(train, 5, Budget())
    assert again.found == found.found and again.clock.evaluations >= found.clock.evaluations
    assert all(within(train, teeth_of) for _, teeth_of in again.found)


@pytest.mark.parametrize(
    ("stages", "number"), few([(2, n) for n in range(0, 24, 2)] + [(3, 2), (3, 8)], 3)
)
def test_some_random_drives_by_brute_force(stages, number):
    train = some_drive(number, stages)
    found, trains = _in_order(search(train, 1, Budget())), every_train(train)
    assert bool(found) == bool(len(trains.values))
    assert not found or np.array_equal(found[0], trains.teeth[trains.best()])


def train_of_six():
    return drive(3, total=F(60), pinion_teeth=(15, 18))


def test_a_search_may_stop_at_every_look_at_the_clock(monkeypatch):
    """Bound and value stay true, and nothing goes on after it."""
    monkeypatch.setattr(bounds, "SLICE", 50)
    monkeypatch.setattr(searching, "SLICE", 50)
    train = train_of_six()
    seen = []
    best = search(train, 1, Budget(), seen.append)
    assert not best.clock.stopped
    value = best.found[0][0]
    assert all(e.best is None or e.best >= value for e in seen)
    assert all(e.bound is None or e.bound <= value for e in seen)
    for stop in (1, 2, *np.linspace(3, len(seen), 3).astype(int).tolist()):
        told = []
        progress = search(train, 1, Budget(), lambda e, t=told, n=stop: t.append(e) or len(t) < n)
        assert progress.clock.stopped and len(told) == stop
        assert progress.bound <= value
        assert not progress.found or progress.found[0][0] >= value


def test_no_more_than_a_slice_is_sized_between_two_looks_at_the_clock(monkeypatch):
    monkeypatch.setattr(bounds, "SLICE", 40)
    monkeypatch.setattr(searching, "SLICE", 40)
    whole = search(train_of_six(), 1, Budget())
    sized, most = [0], []
    real = staging.Table.cost
    monkeypatch.setattr(
        staging.Table,
        "cost",
        lambda t, q, p, most=math.inf: sized.append(sized.pop() + len(p)) or real(t, q, p),
    )

    def watch(event):
        most.append(sized[0])
        sized[0] = 0
        return True

    parts = search(train_of_six(), 1, Budget(), watch)
    assert parts.found == whole.found and parts.clock.evaluations == whole.clock.evaluations
    assert max(most) <= 250 and len(most) > 100  # a dive through three stages, or one cell


@pytest.mark.parametrize(
    "pairs", [((17, 17), (20, 60)), ((20, 60), (17, 17)), ((20, 30), (20, 40))]
)
def test_the_only_train_has_the_whole_ratio_in_one_stage(pairs):
    """At the very end of the last stage's window, where rounding must not lose it."""
    given = {"allowable": (1e9, 1e9), "modules": (F(2),)}
    stages = tuple(
        replace(drive(1).stages[0], pinion_teeth=(a, a), wheel_teeth=(b, b), **given)
        for a, b in pairs
    )
    train = replace(drive(2, total=3), tolerance=F(0), stages=stages)
    assert [teeth_of for _, teeth_of in search(train, 1, Budget()).found] == [pairs]
    assert search(replace(train, ratio=F(3) + F(1, 10**12)), 1, Budget()).found == []


def test_possible_needs_one_train_only():
    seen = []
    train = some_drive(8, 3)
    assert possible(train, 60.0, lambda e: seen.append(e) is None) is True
    assert len([e for e in seen if e.best is not None]) == 1
    assert possible(train, 0.0, None) is None and possible(train, 60.0, None) is True
    assert possible(train, 60.0, lambda event: False) is None
    assert possible(train, 60.0, lambda event: None) is True
    assert possible(replace(train, stages=train.stages[:1]), 60.0, None) is False


@pytest.mark.parametrize("position", [0, 1, 2])
def test_a_stage_without_a_pair_leaves_no_train(position):
    train = drive(3)
    none = replace(train.stages[position], wheel_teeth=(1, 10))
    stages = (*train.stages[:position], none, *train.stages[position + 1 :])
    progress = search(replace(train, stages=stages), 1, Budget())
    assert progress.found == [] and not progress.clock.stopped


def test_any_train_is_one_that_keeps_every_limit():
    train = drive(2, total=6)
    teeth_of, trains = any_train(train, 60.0, None), every_train(train)
    assert list(map(list, teeth_of)) in trains.teeth.tolist()
    assert any_train(drive(2, total=6, modules=(F(1, 10),)), 60.0, None) == ()
    assert any_train(train, 0.0, None) is None
