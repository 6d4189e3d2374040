"""The bound on later stages against its definition in plain loops, and against every train."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from brute_force import best_choice, every_train, some_drive
from campaigns import few
from small_drives import FACES, drive, tables_of

from gearopt.errors import SolveError
from gearopt.formulations.drive.teeth import later_stages as bounds
from gearopt.formulations.drive.teeth import stage as staging
from gearopt.formulations.drive.teeth.later_stages import (
    EDGE,
    bound,
    first_costs,
    ragged,
    slices,
    useful_cells,
)
from gearopt.formulations.drive.teeth.tables import stage_tables

F = Fraction


def naive(train, tables, delta):
    """The bound's definition in plain loops: (to_go, least) by stage and cell."""
    low, high = math.log(train.lowest_ratio), math.log(train.highest_ratio)
    cells = int((high + bounds.EDGE) / delta) + 1
    widest = max(float(t.log_ratio[-1]) for t in tables)
    columns = int(widest / delta) + 1
    least, to_go = {}, {}
    last = tables[-1]
    ends = np.full(cells + columns + 2, np.inf)
    for x in range(cells):
        for j, r in enumerate(last.log_ratio):
            if low - (x + 1) * delta - bounds.EDGE <= r <= high - x * delta + bounds.EDGE:
                torque = train.torque * math.exp(max(x * delta, low - r) - bounds.EDGE)
                ends[x] = min(ends[x], last.cost(np.array([torque]), np.array([j]))[0])
    to_go[len(tables) - 1] = ends
    for k in range(len(tables) - 2, 0, -1):
        t = tables[k]
        own = np.full((cells, columns), np.inf)
        grow = np.full(columns, np.inf)
        floors = [t.floor(m) for m in range(len(t.modules))]
        most = [t.capacity(m) for m in range(len(t.modules))]
        for j, r in enumerate(t.log_ratio):
            column = min(int(r / delta), columns - 1)
            grow[column] = min(grow[column], t.slope[j])
            for m in range(len(t.modules)):
                if most[m][j] > 0.0:
                    reach = math.log(most[m][j] / train.torque) + bounds.EDGE
                    if reach >= 0.0:
                        for x in range(min(int(reach / delta), cells - 1) + 1):
                            own[x, column] = min(own[x, column], floors[m][j])
        for x in range(cells):
            loaded = train.torque * math.exp(x * delta - bounds.EDGE) * grow
            own[x] = np.maximum(own[x], np.where(np.isfinite(grow), loaded, 0.0))
        least[k] = own
        now = np.full(cells + columns + 2, np.inf)
        for x in range(cells):
            now[x] = min(
                own[x, r] + min(to_go[k + 1][x + r], to_go[k + 1][x + r + 1])
                for r in range(columns)
            )
        to_go[k] = now
    return to_go, least


@pytest.mark.parametrize("face", few(FACES, 1))
@pytest.mark.parametrize(
    ("stages", "objective", "total", "edge", "torque"),
    [
        (2, "gear_volume", F(9), EDGE, 2e4),
        (3, "gear_volume", F(16), 4e-3, 2e4),
        (3, "gear_volume", F(5), EDGE, 200.0),
        (4, "total_length", F(8), EDGE, 2e4),
    ],
)
def test_the_bound_is_its_definition(stages, objective, total, face, edge, torque, monkeypatch):
    """Also where cells overlap by so much that one sees it, and where any pair carries the load."""
    monkeypatch.setattr(bounds, "EDGE", edge)
    monkeypatch.setattr(staging, "EDGE", edge)
    train = drive(stages, face, total, objective=objective, pinion_teeth=(15, 17))
    train = replace(train, torque=torque)
    tables, delta = tables_of(train), 0.07
    found = bound(train, tables, delta, lambda: None)
    to_go, least = naive(train, tables, delta)
    assert found.delta == delta and len(found.to_go) == len(found.minimum) == stages
    for k, expected in to_go.items():
        assert found.to_go[k] == pytest.approx(expected, rel=1e-12)
    for k, expected in least.items():
        assert found.minimum[k] == pytest.approx(expected, rel=1e-12)
        cell = np.arange(len(expected))
        beyond = np.minimum(to_go[k + 1][:-1], to_go[k + 1][1:])
        ahead = np.array([beyond[x : x + expected.shape[1]] for x in cell])
        assert found.onward(k, cell) == pytest.approx(expected + ahead, rel=1e-12)
    for k, t in enumerate(tables):
        widest = max(float(t.log_ratio[-1]) for t in tables)
        column = [int(v / delta) for v in t.log_ratio]
        edges = [sum(c < r for c in column) for r in range(int(widest / delta) + 1)]
        assert found.starts[k].tolist() == [*edges, len(t.z1)]
    assert found.cell(np.array([0.0, 0.0699, 0.0701, 0.15])).tolist() == [0, 0, 1, 2]


def test_a_stage_is_told_its_own_first_modules(monkeypatch):
    """Of cells twice as wide; a stage like the one after it shares its grid."""
    train, told, grid = drive(4), {}, staging.Table.grid
    train = replace(train, stages=train.stages[:1] * 4)
    tables = tables_of(train)
    rest = bound(train, tables, 0.5, lambda: None)
    rest = replace(rest, first=[np.full((1, 1), k) for k in range(4)])

    def recorded(own, cells, tick):
        told[own.position] = int(cells.first[0, 0])
        return grid(own, cells, tick)[0], np.full((1, 1), 10 + own.position)

    monkeypatch.setattr(staging.Table, "grid", recorded)
    found = bound(train, tables, 0.25, lambda: None, coarse=rest)
    assert told == {2: 2} and [int(found.first[k][0, 0]) for k in (1, 2)] == [12, 12]


def test_a_pair_is_in_the_cell_that_its_cost_is_in():
    """Also where the quotient by delta is whole, and the product with it above the logarithm."""
    train = drive(3)
    tables = tables_of(train)
    log = tables[1].log_ratio
    ends = [(v, v / r) for v in log[log > 0.1] for r in range(20, 100)]
    value, delta = next((v, d) for v, d in ends if int(v / d) * d > v)
    rest = bound(train, tables, delta, lambda: None)
    pair, cell = int(np.searchsorted(log, value)), int(rest.cell(np.array([value]))[0])
    assert rest.starts[1][cell] <= pair < rest.starts[1][cell + 1]


def test_the_largest_ratio_has_a_cell_whatever_its_rounding():
    train = replace(drive(3), torque=200.0)
    delta = math.log(train.highest_ratio) / 40 * (1.0 + 1e-15)
    rest = bound(train, tables_of(train), delta, lambda: None)
    beyond = np.array([math.log(train.highest_ratio) * (1.0 + 1e-14)])
    assert np.isfinite(rest.to_go[-1][rest.cell(beyond)]).all()


@pytest.mark.parametrize("number", few([0, 2, 4, 8, 12], 2))
def test_the_bound_is_below_every_train_and_close(number):
    train = some_drive(number, 3)
    trains, tables = every_train(train), tables_of(train)
    if any(len(t.z1) == 0 for t in tables):
        return
    rest = bound(train, tables, 0.005, lambda: None)
    ratio, torque = np.ones(len(trains.values)), train.torque
    behind = []
    for k in range(3):
        z1, z2 = trains.teeth[:, k, 0], trains.teeth[:, k, 1]
        behind.append(best_choice(train, k, torque * ratio, z1, z2)[0])
        ratio = ratio * z2 / z1
    reached = np.log(trains.teeth[:, 0, 1] / trains.teeth[:, 0, 0])
    ahead = rest.to_go[1][rest.cell(reached)]
    assert (ahead <= (behind[1] + behind[2]) * (1.0 + 1e-12)).all()
    if len(trains.values):
        assert ((behind[0] + ahead).min() / trains.values.min()) > 0.9
        most = 1.0001 * trains.values.min()
        cheap = trains.teeth[trains.values <= most]
        first = first_costs(train, tables[0], rest, 0.005, np.inf)
        useful = useful_cells(tables, rest, first, most)
        before, second = np.log(cheap[:, :2, 1] / cheap[:, :2, 0]).T
        before, both, second = (bounds._cell(r, 0.0025) for r in (before, before + second, second))
        assert useful[1][before, second].all() and useful[2][both].all()


def test_equal_inner_stages_share_what_was_made(monkeypatch):
    made = []
    real = staging.Table.grid
    monkeypatch.setattr(staging.Table, "grid", lambda *a: made.append(1) or real(*a))
    same = tuple(replace(s, allowable=(2.0, 40.0)) for s in drive(5).stages)
    train = replace(drive(5, total=F(40)), stages=same)
    tables = stage_tables(train, train.highest_ratio)
    assert tables[1] is tables[2] is tables[3]
    assert tables[0] is not tables[1] and tables[3] is not tables[4]
    assert [t.position for t in tables] == [0, 1, 1, 1, 4]
    bound(train, tables, 0.1, lambda: None)
    assert len(made) == 1
    ends = [replace(s, allowable=(k, 40.0)) for s, k in zip(same[:2], (3.0, 4.0), strict=True)]
    unlike = replace(train, stages=(ends[0], *same[1:4], ends[1]))
    bound(unlike, tables_of(unlike), 0.1, lambda: None)  # of the inner stages alone
    assert len(made) == 2
    made.clear()
    pair = replace(train, stages=(same[0], ends[0], same[2], same[3], same[4]))
    tables = stage_tables(pair, pair.highest_ratio)
    assert tables[2] is tables[3] and tables[1] is not tables[2]
    assert [t.position for t in tables] == [0, 1, 2, 2, 4]
    other = replace(train, stages=(*same[:2], replace(same[2], allowable=(1.0, 40.0)), *same[3:]))
    tables = stage_tables(other, other.highest_ratio)
    assert len({id(t) for t in tables}) == 5
    bound(other, tables, 0.1, lambda: None)
    assert len(made) == 3


def test_a_grid_looks_at_the_clock_at_every_module_and_stage():
    """Each of them is a pass over a grid of up to ten million cells."""
    train, looks = drive(3), []
    bound(train, tables_of(train), 0.1, lambda: looks.append(1))
    inner = len(train.stages[1].modules) + 1  # its modules, and the load alone
    assert len(looks) == inner + 1 + 1  # the recursion over it, and one slice of the last stage


def test_too_many_entries_are_refused_and_as_many_are_not(monkeypatch):
    train = drive(2)
    tables = tables_of(train)
    edge = np.arange(int(math.log(train.highest_ratio) / 0.1) + 1) * 0.1
    low, high = math.log(train.lowest_ratio), math.log(train.highest_ratio)
    logs = tables[-1].log_ratio
    ends = [(low - x - 0.1 - EDGE, high - x + EDGE) for x in edge]
    count = sum(int(((logs >= a) & (logs < b)).sum()) for a, b in ends)
    monkeypatch.setattr(bounds, "ENTRIES", count)
    bound(train, tables, 0.1, lambda: None)
    monkeypatch.setattr(bounds, "ENTRIES", count - 1)
    with pytest.raises(SolveError, match="too many pairs to the last stage"):
        bound(train, tables, 0.1, lambda: None)


@pytest.mark.parametrize("most", [1, 3, 7, 100])
def test_slices_and_ragged_are_lists(most):
    rng = np.random.default_rng(most)
    count, start = rng.integers(0, 5, 40), rng.integers(0, 50, 40)
    parts = [range(40)[part] for part in slices(count, most)]
    assert [k for part in parts for k in part] == list(range(40)) and all(parts)
    for part, after in zip(parts, [*parts[1:], None], strict=True):
        assert len(part) == 1 or count[list(part)].sum() <= most
        if after is not None:  # none could be longer
            assert count[list(part)].sum() + count[after[0]] > most
    owner, index = ragged(start, count)
    assert owner.tolist() == [k for k in range(40) for _ in range(count[k])]
    assert index.tolist() == [start[k] + j for k in range(40) for j in range(count[k])]
    assert list(slices(np.empty(0, int), most)) == []
    assert [len(a) for a in ragged(np.empty(0, int), np.empty(0, int))] == [0, 0]
