"""Whole teeth under ratings: against every candidate rated exactly."""

from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from itertools import product

import numpy as np
import pytest
from campaigns import few
from rated_brute_force import cheapest, least_share, safe
from rated_drives import EIGHT, FREE, MODULES, RACK, TIED, F, agma, by, iso, rated_drive

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.teeth import choices
from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.later_stages import bound, first_costs, useful_cells
from gearopt.formulations.drive.teeth.progress import SearchEnded
from gearopt.formulations.drive.teeth.search import search, within
from gearopt.formulations.drive.teeth.stage import Cells
from gearopt.formulations.drive.teeth.tables import stage_tables
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.formulations.strength.standard import Option
from gearopt.optimise.result import Budget
from gearopt.physics.agma.rating_factors import Steel
from gearopt.physics.iso6336.materials import Material

searching = import_module("gearopt.formulations.drive.teeth.search")
rating = import_module("gearopt.formulations.drive.teeth.rated")
stage_tables_of = import_module("gearopt.formulations.drive.teeth.tables")

SLOW = pytest.mark.slow
HARD, FAIR = Material("Eh", "MQ"), Material("Eh", "ML")
STEPPED = FaceWidth(F(3, 10), F(3, 4), step=F(5))


@pytest.mark.parametrize("face", [TIED, STEPPED], ids=["tied", "stepped"])
@pytest.mark.parametrize("helix", few([0.0, 0.4], [0.4]))
@pytest.mark.parametrize(
    "options",
    [
        by("agma"),
        by("static", "iso"),
        *(pytest.param(by(*n), marks=SLOW) for n in (("iso",), ("agma", "static", "iso"))),
    ],
)
def test_the_best_of_one_stage_is_that_of_all_candidates(face, helix, options):
    choice = {"pinion_teeth": (20, 23), "modules": MODULES[4:9], "helix": helix}
    train = rated_drive(F(3), [face], options=options, **choice)
    found = search(train, 1, Budget())
    pairs = [
        (z1, z2)
        for z1, start, stop in spans(train, 0, train.highest_ratio)
        for z2 in range(start, stop + 1)
        if within(train, ((z1, z2),))
    ]
    best = min(least_share(train, 0, train.torque, *pair) for pair in pairs)
    assert found.found[0][0] == pytest.approx(best, rel=1e-11)
    made = choices.best_pairs(train, found.found[0][1])
    assert safe(train, 0, made[0], train.torque)


@pytest.mark.parametrize("options, modules", few([(by("agma"), (4, 6)), (by("iso"), (7, 9))], 1))
def test_no_narrower_width_carries(options, modules):
    """Of every pair of a stage, each width on a fine grid below the one found is rated unsafe."""
    choice = {"pinion_teeth": (20, 21), "modules": MODULES[slice(*modules)], "helix": 0.3}
    train = rated_drive(F(3), [FREE], options=options, **choice)
    for z1, start, _ in spans(train, 0, train.highest_ratio):
        only = train.fixed_teeth(0, z1, start)
        pair = choices.best_pairs(only, ((z1, start),))[0]
        assert safe(train, 0, pair, train.torque)
        low = 0.3 * pair.pinion.reference_diameter
        for width in np.linspace(low, pair.face_width * (1.0 - 1e-9), 40):
            narrower = pair.of_width(float(width))
            assert (
                width == pytest.approx(pair.face_width, rel=1e-8)
                or not safe(train, 0, narrower, train.torque)
                or pair.face_width == pytest.approx(low)
            )


@pytest.mark.slow
@pytest.mark.parametrize("standards", [("iso",), ("agma", "iso")])
def test_the_best_of_two_stages_by_iso_is_that_of_all_candidates(standards):
    choice = {"pinion_teeth": (20, 20), "modules": MODULES[8:11], "options": by(*standards)}
    train = rated_drive(F(4), [TIED, TIED], **choice)
    found = search(train, 1, Budget())
    assert found.found[0][0] == pytest.approx(cheapest(train), rel=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("options", [by("agma", "iso"), by("agma"), by("iso")])
def test_a_train_is_feasible_by_its_own_text(options):
    train = rated_drive(Fraction(9), [TIED, TIED], pinion_teeth=(20, 21), options=options)
    found = search(train, 1, Budget())
    point = teeth.point(train, choices.best_pairs(train, found.found[0][1]))
    batch = teeth.problem(train).batch(point[None])
    assert batch.G.max() <= 1.0 + 1e-11
    assert batch.F[0, 0] == pytest.approx(found.found[0][0], rel=1e-12)


CARBURISED = (Steel("carburised", 2),) * 2


@pytest.mark.slow
@pytest.mark.parametrize("objective", ["cost", "gear_volume", "mass", "total_length"])
def test_the_best_material_is_that_of_all_of_them(objective):
    """Options alone, one after the other; a dear steel that is stronger, a light one."""
    made = (
        Option((agma(),), "soft", (7.85e-9, 7.85e-9), (1.0, 1.2)),
        Option((agma(CARBURISED),), "hard", (7.85e-9, 7.85e-9), (6.0, 6.0)),
        Option((agma((CARBURISED[0], Steel(hardness=300.0))),), "mixed", (None, 7e-9), (2.5, 1.0)),
    )
    narrow = {"pinion_teeth": (20, 20), "modules": MODULES[1:5]}
    train = rated_drive(F(9), [TIED, STEPPED], options=made, **narrow)
    train = replace(train, objective=objective, density=7.8e-9)
    found = search(train, 1, Budget())
    alone = []
    for first in made:
        for second in made:
            stages = [
                replace(s, options=(o,)) for s, o in zip(train.stages, (first, second), strict=True)
            ]
            alone.append(search(replace(train, stages=tuple(stages)), 1, Budget()).found[0][0])
    assert found.found[0][0] == pytest.approx(min(alone), rel=1e-12)
    assert len({round(v, 9) for v in alone}) > 2
    point = teeth.point(train, *choices.best_choices(train, found.found[0][1]))
    batch = teeth.problem(train).batch(np.stack([point, point]))
    assert batch.F[:, 0] == pytest.approx(found.found[0][0], rel=1e-12)
    assert batch.G.max() <= 1.0 + 1e-11
    names = [(o + 1) for o in teeth.gears(train, point)[1]]
    assert names == [alone.index(min(alone)) // 3 + 1, alone.index(min(alone)) % 3 + 1]


@pytest.mark.slow
def test_index_limits_beside_ratings():
    """Each alone is a relaxation; where one of them does not bind, it changes nothing."""
    rated = rated_drive(F(9), [FREE, FREE], pinion_teeth=(20, 20), modules=MODULES[2:5])
    loose, tight = (1e3, 1e3), (2.0, 48.0)
    values = {}
    for name, limits, options in (
        ("rated", None, rated.stages[0].options),
        ("loose", loose, rated.stages[0].options),
        ("both", tight, rated.stages[0].options),
        ("index", tight, ()),
    ):
        stages = tuple(replace(s, allowable=limits or (), options=options) for s in rated.stages)
        train = replace(rated, stages=stages, law=K_FACTOR if limits else rated.law)
        found = search(train, 1, Budget()).found[0]
        point = teeth.point(train, *choices.best_choices(train, found[1]))
        batch = teeth.problem(train).batch(point[None])
        assert batch.G.max() <= 1.0 + 1e-11
        assert batch.F[0, 0] == pytest.approx(found[0], rel=1e-12)
        values[name] = found[0]
    assert values["loose"] == pytest.approx(values["rated"], rel=1e-12)
    assert values["both"] >= max(values["rated"], values["index"]) * (1.0 - 1e-12)


@pytest.mark.parametrize("shift", ["nominal", "generating"])
def test_the_cost_of_a_pair_is_that_of_its_best_module_and_option(shift, monkeypatch):
    """Each rated alone, on steps of widths; tried at once and one by one, and in a cell of torque.

    Allowances, which count in Y_F of one option, make the teeth of every module other ones.
    """
    hard = iso((HARD, HARD), practice=replace(EIGHT, shift=shift))
    made = Option((iso((FAIR, FAIR)),)), Option((hard,), prices=(1.2, 1.4))
    choice = {"pinion_teeth": (20, 23), "modules": MODULES[2:9:2], "options": made}
    choice["toothings"] = (Toothing(0.2, (RACK, RACK), thickness_allowances=(-0.3, -0.35)),)
    aim = {"tolerance": F(0), "objective": "cost", "density": 7.8e-9, "safety": (2.2, 0.8)}
    train = replace(rated_drive(4, [STEPPED], **choice), **aim)
    (own,) = stage_tables(train, F(4))
    parts, pair = (x.ravel() for x in np.meshgrid([0.3, 1.0, 3.0, 10.0], range(4), indexing="ij"))
    torque, least, best = parts * train.torque, np.full(16, np.inf), set()
    width = np.broadcast_to(np.arange(5.0, 300.0, 5.0)[:, None], (59, 16))
    load = np.broadcast_to(torque, width.shape), train.speed_at(torque) + 0.0 * width, train.safety
    for module, option in product(range(4), range(2)):
        one = own.made(own.modules[module], pair + np.zeros(width.shape, int)).of_width(width)
        rated = np.max([*made[option].utilisations(one, *load).values()], axis=0)
        part = width / one.pinion.reference_diameter
        good = (part >= 0.3) & (part <= 0.75) & (rated <= 1.0)
        share = objective_share(train, 0, one, option=option)
        cost = np.where(good, share, np.inf).min(axis=0)
        best |= {(module, option)} if (cost < least).any() else set()
        least = np.minimum(least, cost)
    assert len(best) > 4
    assert own.cost(torque, pair) == pytest.approx(least, rel=1e-12)
    grid, first = own.grid(Cells(1, 1, 2.0), lambda: None)
    assert first is None and 0.8 * least[4:8].min() < grid <= least[4:8].min()
    monkeypatch.setattr(rating, "AT_ONCE", 1)
    assert own.cost(torque, pair) == pytest.approx(least, rel=1e-12)


def assert_no_smaller_module_is_of_use(table, rest, most):
    """Of random torques and pairs: none that carries costs less than so much."""
    rng, (cell, pair) = np.random.default_rng(1), np.nonzero(rest.first[1])
    cell, pair = (x[rng.integers(0, len(cell), 200)] for x in (cell, pair))
    torque = table.train.torque * np.exp((cell + rng.random(200)) * rest.delta)
    first = rest.first[1][cell, pair]
    for module in range(len(table.modules)):
        width = table.width(torque, pair, module)
        some = np.flatnonzero(np.isfinite(width) & (module < first))
        own = table.made(table.modules[module], pair[some]).of_width(width[some])
        assert (objective_share(table.train, 1, own) > most).all()


def test_cells_of_use_hold_the_best_train():
    """The best train's value lies above what every grid says of the cells it passes through."""
    train = rated_drive(F(30), [TIED] * 3, pinion_teeth=(20, 20), modules=MODULES[1:7])
    found = search(train, 1, Budget())
    value, chosen = found.found[0]
    tables = stage_tables(train, train.highest_ratio)
    useful, delta, rest = None, 0.32, None
    widest = bound(train, tables, delta, lambda: None)
    first = first_costs(train, tables[0], widest, 0.01, value * 1.001)
    for _ in range(4):
        rest = bound(train, tables, delta, lambda: None, useful, value * 1.001, rest)
        ratios = np.log([z2 / z1 for z1, z2 in chosen])
        cells = rest.cell(np.concatenate([[0.0], np.cumsum(ratios)]))
        pairs = choices.best_pairs(train, chosen)
        costs = [float(objective_share(train, k, p)) for k, p in enumerate(pairs)]
        assert rest.minimum[1][cells[1], rest.cell(ratios[1:2])[0]] <= costs[1]
        assert rest.to_go[1][cells[1]] <= sum(costs[1:])
        assert rest.to_go[2][cells[2]] <= costs[2]
        assert_no_smaller_module_is_of_use(tables[1], rest, value)
        useful = useful_cells(tables, rest, first, value * 1.001)
        delta /= 2.0
    assert useful[1].mean() < 0.2


@pytest.mark.parametrize("standards", [("agma",), ("iso",)])
def test_what_like_drives_have_in_common_is_computed_once(standards, monkeypatch):
    """Other safety factors, fewer teeth: the costs are those of a table alone."""
    wide = rated_drive(4, [TIED], options=by(*standards), pinion_teeth=(20, 24))
    shelf = []
    (first,) = stage_tables(wide, F(4), shelf=shelf)
    pair = np.arange(len(first.ratio))
    first.cost(np.full(len(pair), wide.torque), pair)
    stage = replace(wide.stages[0], pinion_teeth=(21, 22), wheel_diameter=F(900))
    other = replace(wide, stages=(stage,), safety=(1.3, 1.1))
    alone, shared = stage_tables(other, F(4))[0], stage_tables(other, F(4), shelf=shelf)[0]
    pair = np.arange(len(alone.ratio))
    torque = np.full(len(pair), other.torque)
    expected = alone.cost(torque, pair)
    standard = type(other.stages[0].options[0].standards[0])
    monkeypatch.setattr(standard, "prepared", lambda *a: pytest.fail("computed again"))
    assert np.array_equal(shared.cost(torque, pair), expected) and np.isfinite(expected).any()
    assert shelf == [first]


def test_a_search_that_another_clock_ended_is_not_exhausted(monkeypatch):
    def ended(*given):
        raise SearchEnded

    monkeypatch.setattr(searching, "reach", ended)
    progress = search(rated_drive(F(9), [TIED] * 2), 1, Budget())
    assert progress.clock.stopped and not progress.enough


def test_a_first_train_is_not_looked_for_forever(monkeypatch):
    monkeypatch.setattr(searching, "GRACE", 0.0)
    progress = search(rated_drive(F(9), [TIED] * 2), 1, Budget(seconds=0.0))
    assert progress.clock.stopped and not progress.found


def test_without_time_a_first_train_is_looked_for_among_few_pairs(monkeypatch):
    """Two stages of 5 pinions, 400 or so pairs each: of 20 of them one is found, and it carries."""
    train, tables = rated_drive(F(9), [TIED] * 2, pinion_teeth=(20, 24)), []
    monkeypatch.setattr(stage_tables_of, "THINNED", 20)
    bounded = searching.bound
    monkeypatch.setattr(
        searching, "bound", lambda t, few, *a: tables.append(few) or bounded(t, few, *a)
    )
    progress = search(train, 1, Budget(seconds=0.0))
    assert [[len(t.ratio) for t in few] for few in tables] == [[20, 20]]
    value, chosen = progress.found[0]
    point = teeth.point(train, *choices.best_choices(train, chosen))
    assert progress.clock.stopped and within(train, chosen)
    made = teeth.problem(train).batch(point[None])
    assert made.G.max() <= 1.0 + 1e-9 and made.F[0, 0] == pytest.approx(value, rel=1e-12)
