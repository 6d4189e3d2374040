"""Complete fronts of whole teeth, against unpruned brute force and against each other."""

from dataclasses import replace
from fractions import Fraction as F
from itertools import product

import numpy as np
import pytest
from campaigns import few
from front_brute_force import every_choice, every_rated_choice, unbeaten
from rated_drives import agma, some_iso, some_rated_drive
from small_drives import drive

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.teeth.front import fronts
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto.tradeoff import found
from gearopt.optimise.result import Budget

TWO = ("gear_volume", "sum_of_centre_distances"), ("gear_volume", "mesh_loss")
THREE = ("total_length", "mass", "mesh_loss")
SMALL = {"pinion_teeth": (15, 16), "modules": (F(2), F(5, 2), F(4))}


def train_of(stages, face, names, **changes):
    given = {} if stages == 2 else {"total": 30, **SMALL}
    made = drive(stages, face, objective=names[0], **given | changes)
    return replace(made, others=names[1:])


def front_of(train, most=None, budget=None):
    limits = np.full(len(train.objectives), np.inf) if most is None else np.array(most)
    return fronts(train, limits, Clock(budget or Budget()))


def same(train, search, most=None, choices=every_choice):
    """Hold a front to brute force: values, and the teeth of which a tie keeps the fewest."""
    every, values = choices(train)
    if most is not None:
        inside = (values <= np.array(most) * (1 + 1e-9)).all(axis=1)
        every, values = every[inside], values[inside]
    kept = unbeaten(every, values) if len(values) else []
    wanted = sorted(every[kept].tolist())
    made = [tuple((p.pinion_teeth, p.wheel_teeth) for p in pairs) for pairs, _ in search.trains]
    assert wanted == sorted([list(map(list, one)) for one in made])
    assert np.sort(search.values, axis=0) == pytest.approx(np.sort(values[kept], axis=0), rel=1e-12)
    assert not search.clock.stopped
    return len(kept)


@pytest.mark.parametrize(
    ("face", "names"),
    few(
        product(("tied", "free", "stepped", "fixed"), (*TWO, THREE)),
        [("tied", TWO[0]), ("free", TWO[1]), ("stepped", THREE), ("fixed", TWO[0])],
    ),
)
def test_the_front_of_two_stages_equals_brute_force(face, names):
    train = train_of(2, face, names)
    assert same(train, front_of(train)) >= 2


@pytest.mark.slow
@pytest.mark.parametrize(("face", "names"), [("free", TWO[1]), ("stepped", THREE)])
def test_the_front_of_three_stages_equals_brute_force(face, names):
    train = train_of(3, face, names)
    assert same(train, front_of(train)) >= 6


def test_largest_values_of_interest_cut_the_front_and_leave_it_complete():
    train = train_of(2, "free", TWO[1])
    whole = front_of(train)
    most = [float(np.median(whole.values[:, 0])), np.inf]
    assert 2 <= same(train, front_of(train, most), most) < len(whole.values)
    nothing = front_of(train, [whole.values[0, 0] * 0.999, np.inf])
    assert len(nothing.values) == 0 and not nothing.clock.stopped


def test_the_ends_of_a_front_are_the_best_trains_of_each_objective():
    train = train_of(2, "stepped", THREE)
    search = front_of(train)
    for k, name in enumerate(THREE):
        best = found_best(replace(train, objective=name, others=()))
        assert search.values[:, k].min() == pytest.approx(best, rel=1e-12)


def found_best(train):
    problem = teeth.problem(train)
    outcome = problem.methods["exact"](problem, Budget(), 0, None)
    return problem.batch(outcome.x[None]).F[0, 0]


def test_exact_gives_points_of_the_problem_in_order_with_their_proof():
    train = train_of(2, "tied", TWO[1])
    made = found(teeth.problem(train), train.objectives, {}, "exact")
    assert made.complete and len(made.points) == len(front_of(train).values)
    assert (np.diff(made.values[:, 0]) > 0).all() and (np.diff(made.values[:, 1]) < 0).all()
    assert made.proof["method"] == "exhausted" and all(p.proven for p in made.points)
    turned = found(teeth.problem(train), train.objectives[::-1], {}, "exact")
    assert turned.values[::-1, ::-1] == pytest.approx(made.values, rel=1e-12)


def test_a_search_that_is_stopped_claims_nothing():
    train = train_of(3, "tied", TWO[0])
    made = found(teeth.problem(train), train.objectives, {}, "exact", budget=Budget(evaluations=10))
    assert not made.complete and not made.finished and "allow more time" in made.message


@pytest.mark.parametrize("evaluations", [30, 300, 1000])
def test_a_search_that_is_stopped_keeps_to_the_largest_values(evaluations):
    train = train_of(2, "free", TWO[1])
    most = {TWO[1][0]: float(np.median(front_of(train).values[:, 0]))}
    budget = Budget(evaluations=evaluations)
    made = found(teeth.problem(train), train.objectives, most, "exact", budget=budget)
    assert all(p.values[0] <= most[TWO[1][0]] * (1 + 1e-9) for p in made.points)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(15))
def test_fronts_of_random_drives_equal_brute_force(seed):
    rng = np.random.default_rng(seed)
    face = str(rng.choice(["tied", "free", "open", "stepped", "fixed"]))
    names = (*TWO, THREE)[int(rng.integers(3))]
    low = int(rng.integers(14, 22))
    modules = tuple(sorted(F(int(m), 4) for m in rng.choice(np.arange(4, 16), 3, replace=False)))
    changes = {
        "pinion_teeth": (low, low + int(rng.integers(1, 4))),
        "modules": modules,
        "total": int(rng.integers(6, 16)),
        "tolerance": F(int(rng.integers(1, 5)), 100),
        "coprime": bool(rng.integers(2)),
        "helix_angle": float(rng.choice([0.0, 0.2])),
    }
    train = train_of(2, face, names, **changes)
    found = front_of(train)
    assert same(train, found) == len(found.values)


RATED_SEEDS = [(2, 43), (2, 44)]  # stages and seed; of two stages those of few candidates
RATED_SEEDS += [(1, seed) for seed in range(12)]


@pytest.mark.parametrize(("stages", "seed"), few(RATED_SEEDS, [(1, 4), (1, 1)]))
def test_fronts_of_random_rated_drives_equal_all_candidates_rated_alone(stages, seed):
    standard = (agma, some_iso)[seed % 2]
    train = some_rated_drive(seed, stages, ("tied", "stepped", "fixed"), standard)
    names = (*TWO, THREE)[seed % 3]
    train = replace(train, objective=names[0], others=names[1:])
    found = front_of(train)
    assert same(train, found, choices=every_rated_choice) == len(found.values)
