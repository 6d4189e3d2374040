"""Gears that ratings limit and their box at once: brute force over every train and layout."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from gearboxes import smallest_box
from rated_brute_force import safe, widths
from rated_drives import TREATMENTS, agma, some_iso, some_rated_drive

from gearopt.formulations.drive import layout, teeth, together
from gearopt.formulations.drive.gearbox import Clearances, Gearbox, Shaft
from gearopt.formulations.drive.layout.slabs import arrangements, clashes
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.together import search as together_search
from gearopt.formulations.drive.together.search import CELL_WIDTHS, Search, narrower
from gearopt.formulations.drive.together.tables import numbers
from gearopt.formulations.strength.standard import Option
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run

KINDS = "tied", "stepped", "fixed"  # widths that can be counted
AIMS = "box_volume", "plan_area", "longest_side", "height"


def some_train(seed, standard=agma, options=1, stages=2):
    """A random drive of few teeth and modules, with one or more ways of making its gears."""
    rng = np.random.default_rng([31, seed])
    train = some_rated_drive(seed, stages, KINDS, standard)
    own = []
    for stage in train.stages:
        low = stage.pinion_teeth[0]
        few = stage.modules[:: max(1, len(stage.modules) // 2)][-3:]
        made = stage.options
        if options > 1:
            every = (standard(t, float(rng.integers(6, 11))) for t in TREATMENTS[:options])
            made = tuple(Option((s,), materials=(f"{k}",) * 2) for k, s in enumerate(every))
        own.append(replace(stage, pinion_teeth=(low, low + 1), modules=few, options=made))
    train = replace(train, stages=tuple(own), tolerance=train.tolerance / 2)
    return replace(train, stages=tuple(replace(s, wheel_teeth=(1, 120)) for s in train.stages))


def some_frame(seed, train):
    """A function that makes gearboxes whose shafts about fit the modules of a drive."""
    rng = np.random.default_rng([32, seed])
    middle = float(train.stages[0].modules[-1])
    radii = middle * rng.uniform(3.0, 5.0) * 1.3 ** np.arange(len(train.stages) + 1)
    kinds = {
        "clearances": Clearances(*(float(g) for g in rng.uniform(1.0, 10.0, 4))),
        "objective": AIMS[seed % 4],
    }
    return lambda pairs: Gearbox(pairs, tuple(Shaft(float(r)) for r in radii), **kinds)


def narrowest_of(train):
    """Minimum face widths by rating every candidate alone, of all options the best."""

    @cache
    def narrowest(k, torque, module, teeth):
        best = None
        for option in train.stages[k].options:
            stages = [replace(s, options=(option,)) for s in train.stages]
            one = replace(train, stages=tuple(stages), same_option=False)
            for width in widths(one, k, module, teeth[0]):
                if best is not None and width >= best:
                    break
                if safe(one, k, train.pair(k, float(module), *map(float, teeth), width), torque):
                    best = float(width)
        return best

    return narrowest


def brute_force(train, make, rel):
    if not train.same_option:
        return smallest_box(train, make, rel, narrowest=narrowest_of(train))
    count = len(train.stages[0].options)
    every = [
        replace(train, stages=tuple(replace(s, options=(s.options[k],)) for s in train.stages))
        for k in range(count)
    ]
    return min(smallest_box(one, make, rel, narrowest=narrowest_of(one)) for one in every)


def same_as_brute_force(train, make, gap):
    """What the search finds, after holding it to the least of all boxes, infinite: none."""
    best = brute_force(train, make, 0.2 * gap)
    result, outcome = run(together.problem(train, make), "exact", Budget(gap=gap), 0, None, gap)
    if not math.isinf(best):
        assert result.value == pytest.approx(best, rel=1.2 * gap)
        assert result.bound <= best * (1.0 + 1e-9)
    assert result.status == ("infeasible" if math.isinf(best) else "optimal")
    return result, outcome


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_two_stages_by_agma_as_by_brute_force(seed):
    train = some_train(seed)
    result, _ = same_as_brute_force(train, some_frame(seed, train), 1e-3)
    assert result.status == "infeasible" or result.bound <= result.value * (1.0 + 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 4])
def test_two_stages_by_iso_as_by_brute_force(seed):
    train = some_train(seed, some_iso)
    result, _ = same_as_brute_force(train, some_frame(seed, train), 1e-3)
    assert result.status == "infeasible" or result.bound <= result.value * (1.0 + 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("same", [False, True])
@pytest.mark.parametrize("seed", [0])
def test_materials_as_by_brute_force(seed, same):
    train = replace(some_train(seed, options=3), same_option=same)
    result, outcome = same_as_brute_force(train, some_frame(seed, train), 1e-3)
    if result.value is not None and same:
        assert len(set(teeth.gears(train, outcome.x)[1])) == 1


@pytest.mark.slow
def test_three_stages_as_by_brute_force():
    seed = 1
    train = some_train(seed, stages=3)
    few = [
        replace(s, modules=s.modules[-count:], wheel_teeth=(1, 60))
        for s, count in zip(train.stages, (1, 1, 2), strict=True)
    ]
    train = replace(train, stages=tuple(few), tolerance=train.tolerance / 4)
    result, _ = same_as_brute_force(train, some_frame(seed, train), 1e-2)
    assert result.status == "infeasible" or result.bound <= result.value * (1.0 + 1e-9)


@pytest.mark.parametrize("standard", [agma, pytest.param(some_iso, marks=pytest.mark.slow)])
def test_widths_of_cells_are_below_those_of_every_torque(standard, monkeypatch):
    """At a torque and at all stronger ones that a stage may carry, in cells of any width."""
    train = some_train(3, standard, stages=3)
    train = replace(train, torque=12.0 * train.torque)  # so that widths depend on it
    make = some_frame(3, train)
    search, (drive, _) = Search(train, make, Clock(), 0), numbers(train, make)
    rng = np.random.default_rng(8)
    for step in CELL_WIDTHS[:2]:
        drive = narrower(search.tables, drive, step, lambda: True)
        for stage, table in enumerate(search.tables):
            assert_least_at_cells(table, drive, stage)
        for table, pair, torque, row in some_torques(train, search.tables, drive, rng):
            for module in range(len(table.modules)):
                width = table.width(np.array([torque]), np.array([pair]), module).item()
                assert drive.bisected[row, module] <= width * (1.0 + 1e-9)
    assert np.isfinite(drive.bisected).any()
    highest = np.concatenate([together_search._window(drive, k)[1] for k in range(3)])
    last = (drive.cell + np.diff(drive.row) - 1) * drive.step
    assert (last <= np.maximum(highest, drive.cell * drive.step) + 1e-9).all()
    for end in range(2):  # of a cell, which holds the torques that are looked up in it
        monkeypatch.setattr(RatedTable, "least_width", lambda *args, end=end: args[1][end])
        ends = narrower(search.tables, drive, drive.step, lambda: True).bisected
        for _, _, torque, row in some_torques(train, search.tables, drive, rng):
            over = ends[row][np.isfinite(ends[row])] / torque
            assert (over >= 1.0 - 1e-12).all() if end else (over <= 1.0 + 1e-12).all()
    monkeypatch.setattr(together_search, "ENTRIES", drive.bisected.size - 1)
    assert narrower(search.tables, drive, drive.step, lambda: True) is drive  # too many


def some_torques(train, tables, drive, rng):
    """Tables, pairs, torques [N mm] of trains with them, and rows where kernels look for these."""
    for _ in range(20):
        stage = int(rng.integers(len(tables)))
        table, others = tables[stage], [t.log_ratio for t in tables]
        pair = int(rng.integers(len(table.z1)))
        reached = sum(float(rng.choice(o)) for o in others[:stage])
        there, later = reached + table.log_ratio[pair], others[stage + 1 :]
        low = math.log(train.lowest_ratio) - sum(o.max() for o in later)
        if low <= there <= math.log(train.highest_ratio) - sum(o.min() for o in later):
            own = drive.start[stage] + pair
            cell = max(int(max(reached - 1e-9, 0.0) / drive.step) - drive.cell[own], 0)
            row = min(drive.row[own] + cell, drive.row[own + 1] - 1)
            yield table, pair, train.torque * math.exp(reached), row


def assert_least_at_cells(table, drive, stage):
    """At the start of the cells of every pair but its first one, of stage 0 at its one torque."""
    start, stop = drive.start[stage : stage + 2]
    pair = np.repeat(np.arange(start, stop), np.diff(drive.row[start : stop + 1]))
    row = drive.row[start] + np.arange(len(pair))
    pair, row = (a[(row > drive.row[pair]) | (stage == 0)] for a in (pair, row))
    reached = (drive.cell[pair] + row - drive.row[pair]) * drive.step
    torque = drive.torque * np.exp(reached + (1e-9 if stage else 0.0))
    every = range(len(table.modules))
    widths = np.column_stack([table.width(torque, pair - start, k) for k in every])
    bounds = drive.bisected[row, : len(every)]
    assert (bounds <= widths * (1.0 + 1e-9)).all()
    assert (bounds >= widths * (1.0 - 1e-9)).mean() > 0.9  # they are no idle ones


@pytest.mark.slow
def test_the_answer_is_no_worse_than_gears_first():
    train = some_train(1)
    make = some_frame(1, train)
    sized, outcome = run(teeth.problem(train), "exact")
    result, _ = run(together.problem(train, make), "exact", Budget(gap=0.01), 0, None, 0.01)
    if sized.value is not None:
        first = teeth.pairs(train, outcome.x)
        assert result.value <= smallest_of(make, first) * (1.0 + 1e-9)


def smallest_of(make, pairs):
    """The smallest box of gears that are given."""
    box = make(pairs)
    found = [
        run(layout.problem(replace(box, slabs=a.slabs)), "exact", Budget(gap=1e-3))[0].value
        for a in arrangements(box)
        if not clashes(box, a)
    ]
    return min((v for v in found if v is not None), default=math.inf)
