"""Wide tooth ranges: what is left out by its definition, and that what is told of it is true."""

import math
from dataclasses import replace
from fractions import Fraction
from importlib import import_module

import numpy as np
import pytest
from brute_force import cost
from small_drives import FACES, OBJECTIVES, drive

from gearopt.formulations.drive.teeth import columns as staging
from gearopt.formulations.drive.teeth import problem
from gearopt.formulations.drive.teeth.progress import MARGIN
from gearopt.formulations.drive.teeth.reach import first_cut
from gearopt.formulations.drive.teeth.search import search
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import method_of

F = Fraction
FEW = 3000
wide = import_module("gearopt.formulations.drive.teeth.reach")


def wide_drive():
    """One module too small for the pinions that a search of few of them takes."""
    given = {"pinion_teeth": (15, 60), "modules": (F(3, 2),), "tolerance": F(1, 500)}
    return drive(3, total=16, **given)


def outcome(train, count=1, floor=-math.inf, watch=None, **budget):
    posed = problem(train, count, floor)
    return method_of(posed, "exact")(posed, Budget(**budget), 0, watch)


@pytest.fixture(scope="module")
def whole():
    return outcome(wide_drive())


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(wide, "PAIRS_AT_ONCE", FEW)


@pytest.mark.parametrize(
    ("stages", "limits"),
    [(2, {}), (2, {"wheel_teeth": (40, 70)}), (3, {"ratio": (F(3), F(5))}), (1, {})],
)
def test_so_few_pinions_that_their_pairs_are_few(stages, limits, monkeypatch):
    """As many as there may be: pairs are counted up to the ratio of a search's first look."""
    train = drive(stages, total=16, pinion_teeth=(15, 30), **limits)
    cut = min(F(3.0 * 16.0 ** (1.0 / stages)), train.highest_ratio)
    own = train.stages[0]
    low = train.lowest_ratio if stages == 1 else own.ratio[0]
    high, (least, most) = min(cut, own.ratio[1] or cut), own.wheel_teeth
    each = [
        sum(low * a <= b <= high * a for b in range(least, 1 + (most or 1000)))
        for a in range(15, 31)
    ]
    pairs = np.cumsum(each)
    for limit in (pairs[0] - 1, pairs[0], pairs[4] - 1, pairs[4], pairs[-1] - 1):
        monkeypatch.setattr(wide, "PAIRS_AT_ONCE", limit)
        last = max(15, 14 + int((pairs <= limit).sum()))
        assert {s.pinion_teeth for s in wide.narrowed(train).stages} == {(15, last)}
    monkeypatch.setattr(wide, "PAIRS_AT_ONCE", pairs[-1])
    assert wide.narrowed(train) == train


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_pinions_that_alone_cost_more_than_a_train_are_left_out(face, objective):
    """By its stage at the least ratio, module and width; one that costs as much is kept."""
    train = drive(3, face, F(30), objective=objective, helix_angle=0.2, pinion_teeth=(15, 40))
    own = train.stages[1]
    train = replace(train, stages=(train.stages[0], replace(own, ratio=(F(2), None)), own))
    teeth = np.arange(15, 41)
    d = teeth / math.cos(0.2)
    own = FACES[face]
    width = float(own.low) * d if own.fixed is None else np.full(26, float(own.fixed))
    costs = [cost(train, k, d, width, u) for k, u in enumerate((1.0, 2.0, 1.0))]
    for value in (0.5 * costs[0][0], costs[0][0], costs[0][9], costs[1][9], 2.0 * costs[1][-1]):
        for most in (value, value * (1.0 - 0.5 * MARGIN), value * (1.0 - 3.0 * MARGIN)):
            found = [s.pinion_teeth for s in wide.trimmed(train, float(most)).stages]
            kept = [c <= most * (1.0 + MARGIN) for c in costs]
            assert found == [(15, teeth[k].max(initial=15)) for k in kept]
    assert wide.trimmed(train, math.inf) == train


def test_a_wide_drive_is_that_of_all_its_pinions_and_tells_no_bound_of_a_part(few, whole):
    """What both searches spent is counted."""
    train, seen = wide_drive(), []
    found = outcome(train, watch=seen.append)
    first = search(wide.narrowed(train), 1, Budget())
    assert first.bound > 1.1 * whole.bound
    assert found.bound == whole.bound and (found.x == whole.x).all() and found.finished
    assert all(e.bound is None or e.bound <= whole.bound * (1.0 + 1e-12) for e in seen)
    assert any(e.bound is not None for e in seen)
    second = search(wide.trimmed(train, first.threshold), 1, Budget())
    assert found.evaluations == first.clock.evaluations + second.clock.evaluations
    assert found.proof["nodes"] == first.nodes + second.nodes


def test_nor_where_the_first_look_is_at_all_ratios(few):
    train = drive(3, total=4, pinion_teeth=(15, 60), modules=(F(1),), tolerance=F(1, 500))
    assert first_cut(train) == train.highest_ratio
    seen, best = [], outcome(train).bound
    found = outcome(train, watch=seen.append)
    assert found.bound == best and all(e.bound is None or e.bound <= best for e in seen)
    assert search(wide.narrowed(train), 1, Budget()).found[0][0] > 1.01 * best


def test_a_watcher_that_says_stop_once_stops_both_searches_of_a_wide_drive(few, whole):
    train, all_seen = wide_drive(), []
    outcome(train, watch=all_seen.append)
    known = [event.best is not None for event in all_seen]
    second = next(k for k in range(1, len(known)) if known[k - 1] and not known[k])
    for stop, count in ((1, 1), (second, 5), (second + 1, 1), (second + 4, 1), (len(known) - 1, 1)):
        seen = []
        watch = lambda e, t=seen, n=stop: t.append(e) or len(t) != n  # noqa: E731
        found = outcome(train, count, floor=1.0, watch=watch)
        assert len(seen) == stop and not found.finished and not found.infeasible
        assert 1.0 <= found.bound <= whole.bound
        best = [e.best for e in seen if e.best is not None]
        assert (found.x is None) == (not best)
        if best:
            value = problem(train).batch(found.x[None]).F[0, 0]
            assert value == pytest.approx(min(best), rel=1e-12)


def test_both_searches_share_a_budget_and_a_gap(few, whole):
    train = wide_drive()
    first = search(wide.narrowed(train), 1, Budget())
    short = outcome(train, evaluations=first.clock.evaluations + 1)
    enough = outcome(train, seconds=1e3, evaluations=2 * whole.evaluations)
    assert not short.finished and short.evaluations < enough.evaluations and enough.finished
    value = problem(train).batch(short.x[None]).F[0, 0]  # a train of few pinions is one of all
    assert whole.bound <= value <= first.found[0][0]
    near = outcome(train, floor=0.5 * whole.bound, gap=0.9)
    assert (
        near.finished
        and near.evaluations <= first.clock.evaluations
        and near.bound == 0.5 * whole.bound
    )
    close = outcome(train, floor=0.5 * whole.bound, gap=0.1)
    value = problem(train).batch(close.x[None]).F[0, 0]
    assert close.finished and value - close.bound <= 0.1 * value and close.bound <= whole.bound


def test_pairs_beyond_memory_leave_the_best_of_few_pinions_and_no_claim(few, monkeypatch):
    """Also where a gap is asked for: few pinions prove nothing of the others."""
    monkeypatch.setattr(staging, "PAIRS", 2 * FEW)
    train = wide_drive()
    narrow = replace(train.stages[0], pinion_teeth=(15, 30))
    train = replace(train, stages=(narrow, *train.stages[1:]))
    few_teeth = [s.pinion_teeth[1] for s in wide.narrowed(train).stages]
    assert few_teeth == [30, 33, 33]
    first = search(wide.narrowed(train), 1, Budget())
    for gap in (0.0, 0.5):
        found = outcome(train, floor=1.0, gap=gap)
        assert not found.finished and not found.infeasible and found.bound == 1.0
        assert found.message.endswith("Only pinions of up to 33 teeth were searched")
        value = problem(train).batch(found.x[None]).F[0, 0]
        assert value == pytest.approx(first.found[0][0], rel=1e-12)
