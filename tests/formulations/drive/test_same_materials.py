"""One material for all pinions and one for all wheels: every choice, and brute force."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import product

import numpy as np
import pytest
from rated_brute_force import cheapest
from rated_drives import MODULES, TIED, TREATMENTS, agma, rated_drive, some_rated_drive

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.teeth import choices
from gearopt.formulations.drive.teeth.choices import valued
from gearopt.formulations.drive.teeth.search import search
from gearopt.formulations.drive.train import FaceWidth
from gearopt.formulations.strength.standard import Option
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run
from gearopt.physics.agma.rating_factors import Steel

F = Fraction
STEPPED = FaceWidth(F(2, 5), F(3, 5), step=F(4))
HARD, SOFT = Steel("carburised", 2), Steel(hardness=300.0)


def made_of(quality, *steels):
    """Return options of one accuracy by the steels of pinion and wheel, named after them."""
    dear = {"carburised": 6.0, "nitrided": 3.0}
    return tuple(
        Option(
            (agma(pair, quality=quality),),
            prices=tuple(dear.get(s.kind, 1.0) for s in pair),
            materials=tuple(f"{s.kind} {s.grade} {s.hardness}" for s in pair),
        )
        for pair in steels
    )


def with_options(train, *options):
    """Return the drive with options for each of its stages."""
    stages = (replace(s, options=o) for s, o in zip(train.stages, options, strict=True))
    return replace(train, stages=tuple(stages))


def small(objective="cost"):
    """Return a drive whose dear steel pays in the second stage alone."""
    narrow = {"pinion_teeth": (20, 21), "modules": MODULES[1:5]}
    train = rated_drive(F(9), [TIED, STEPPED], **narrow)
    steels = (SOFT, SOFT), (HARD, HARD), (HARD, SOFT)
    train = with_options(train, made_of(7.0, *steels), made_of(8.0, *steels))
    return replace(train, objective=objective, density=7.8e-9)


def of_each(train):
    """Return the drives that may take one option alone, the same in all stages."""
    count = len(train.stages[0].options)
    return [with_options(train, *([s.options[k]] for s in train.stages)) for k in range(count)]


@cache
def best_of_the_same():
    """Return the best drive of `small` in the same materials."""
    return search(replace(small(), same_option=True), 1, Budget()).found[0]


@pytest.mark.slow
def test_the_best_of_the_same_materials_are_the_best_of_each():
    """Trains of equal teeth count once, with the materials that are best for them."""
    train = small()
    alike = replace(train, same_option=True)
    each = [search(one, 3, Budget()).found for one in of_each(train)]
    value, made = best_of_the_same()
    alone = [found[0][0] for found in each]
    assert value == pytest.approx(min(alone), rel=1e-12)
    assert value > search(train, 1, Budget()).found[0][0] * 1.001
    pairs, options = choices.best_choices(alike, made)
    assert options == (alone.index(min(alone)),) * 2
    point = teeth.point(alike, pairs, options)
    assert teeth.gears(alike, point)[1] == options
    batch = teeth.problem(alike).batch(np.stack([point, point]))
    assert batch.F[:, 0] == pytest.approx(value, rel=1e-12)
    assert batch.G.max() <= 1.0 + 1e-11
    by_teeth = {}
    for value, made in (row for found in each for row in found):
        by_teeth[made] = min(value, by_teeth.get(made, np.inf))
    three = search(alike, 3, Budget()).found
    assert [value for value, _ in three] == pytest.approx(sorted(by_teeth.values())[:3], rel=1e-12)


@pytest.mark.slow
def test_a_stop_leaves_a_bound_of_all_materials():
    """Whenever it ends, its bound is below the best drive of every material."""
    train, (best, _) = replace(small(), same_option=True), best_of_the_same()
    for most in (3, 12):
        asked = []
        stopped = search(train, 1, Budget(), lambda e, n=most, a=asked: a.append(e) or len(a) < n)
        assert stopped.bound <= best * (1.0 + 1e-12)
    result = run(teeth.problem(train), "exact", Budget(gap=0.2), gap=0.2)[0]
    assert result.status == "optimal" and result.bound <= best <= result.value


@pytest.mark.parametrize("method", ["annealing", pytest.param("nsga2", marks=pytest.mark.slow)])
def test_samplers_take_the_same_materials(method):
    train = replace(small(), same_option=True)
    result, outcome = run(teeth.problem(train), method, Budget(evaluations=150), 0)
    best, _ = best_of_the_same()
    assert result.value is None or result.value >= best * (1.0 - 1e-9)
    assert outcome.x is None or len(set(teeth.gears(train, outcome.x)[1])) == 1


def test_options_of_other_materials_are_refused():
    train = small()
    swapped = with_options(train, train.stages[0].options, train.stages[1].options[::-1])
    with pytest.raises(ValueError, match="same materials"):
        replace(swapped, same_option=True)


def random_drive(seed):
    """Return a random drive of two stages with two or three pairs of steels, and an objective."""
    rng = np.random.default_rng([17, seed])
    train = some_rated_drive(seed, stages=2)
    several = rng.permutation(len(TREATMENTS))[: int(rng.integers(2, 4))]
    steels = [TREATMENTS[k] for k in several]
    made = [made_of(float(rng.integers(6, 11)), *steels) for _ in train.stages]
    worth = {"carburised": 2.5, "nitrided": 2.0, "through-hardened": 1.0}  # about their strength
    spread = 10.0 ** rng.uniform(-0.1, 0.1, (len(steels), 2))
    prices = [
        tuple(worth[s.kind] * float(f) for s, f in zip(pair, own, strict=True))
        for pair, own in zip(steels, spread, strict=True)
    ]
    options = [
        tuple(replace(option, prices=own) for option, own in zip(stage, prices, strict=True))
        for stage in made
    ]
    aims = ["cost", "cost", "gear_volume", "cost", "mass"]
    return replace(with_options(train, *options), objective=aims[seed % 5])


@pytest.mark.slow
@pytest.mark.parametrize("seed", [23, 2])  # one costs more than free
def test_random_drives_of_the_same_materials_as_by_brute_force(seed):
    train = random_drive(seed)
    free, alike = (search(t, 1, Budget()) for t in (train, replace(train, same_option=True)))
    least = min(cheapest(one) for one in of_each(train))
    if not alike.found:
        assert least == np.inf
        return
    value = alike.found[0][0]
    continuous = any(
        not (s.face_width.tied or s.face_width.step or s.face_width.fixed) for s in train.stages
    )
    assert value <= least * (1.0 + 1e-9)
    assert least <= value * (1.05 if continuous else 1.0 + 1e-9)  # brute force has a grid of widths
    assert free.found[0][0] <= value * (1.0 + 1e-12)
    chosen = choices.best_choices(train, free.found[0][1])[1]
    if len(set(chosen)) == 1:
        assert value == pytest.approx(free.found[0][0], rel=1e-12)


def test_a_search_of_lists_cut_short_has_a_design_and_a_bound():
    """Brute force has the optimum elsewhere; the watcher ends the search with its first bound."""
    train, seen = small(), []
    narrow = [replace(s, options=s.options[:2]) for s in train.stages]
    assert [t.stages for t in train.of_one_material] == [
        tuple(replace(s, options=s.options[k : k + 1]) for s in narrow) for k in range(2)
    ]
    best = search(train, 1, Budget(), lambda e: seen.append(e) is None).found[0][0]
    early = search(train, 1, Budget(), lambda event: event.bound is None)
    assert early.clock.stopped and early.found[0][0] >= best
    assert 0.5 * best < early.bound <= best
    assert all(e.bound <= best * (1.0 + 1e-12) for e in seen if e.bound is not None)


@pytest.mark.slow
def test_more_effort_never_finds_a_worse_train():
    steels = (Steel(hardness=250.0), HARD)
    options = made_of(7.0, *product(steels, repeat=2))
    train = rated_drive(F(15), [TIED] * 2, options=options)
    efforts = Budget(seconds=0.0), Budget(evaluations=1), Budget(evaluations=800)
    found = [search(train, 1, budget).found[0] for budget in efforts]
    values = [valued(train, chosen)[0] for _, chosen in found]
    assert [value for value, _ in found] == pytest.approx(values, rel=1e-12)
    assert values[0] >= values[1] >= values[2]
