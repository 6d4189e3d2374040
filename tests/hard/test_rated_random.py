"""Random rated drives against every candidate, and impossible ones by construction."""

import math

import numpy as np
import pytest
from campaigns import few
from rated_brute_force import cheapest, safe
from rated_drives import agma, impossible, some_iso, some_rated_drive

from gearopt.formulations.drive import teeth
from gearopt.optimise.solve import run, solve
from gearopt.optimise.terms import each

PLAIN = ("tied", "stepped", "fixed")  # widths that can be listed


TWO_STAGES = (40, 43, 44, 46, 47, 49, 50, 51, 52, 63)  # seeds of few candidates


@pytest.mark.parametrize("standard", [agma, some_iso])
@pytest.mark.parametrize("seed", few([*range(20), *TWO_STAGES], 2))
def test_small_drives_equal_to_every_candidate_rated_alone(seed, standard):
    train = some_rated_drive(seed, 2 if seed in TWO_STAGES else 1, PLAIN, standard)
    best, result = cheapest(train), solve(teeth.problem(train))
    if math.isinf(best):
        assert result.status == "infeasible"
        return
    assert result.status == "optimal"
    assert result.value == pytest.approx(best, rel=1e-10)


@pytest.mark.parametrize("seed", few(range(30), 2))
def test_impossible_drives_are_told(seed):
    train = impossible(some_rated_drive(1000 + seed), seed)
    assert solve(teeth.problem(train)).status == "infeasible"


@pytest.mark.parametrize("standard", [agma, some_iso])
@pytest.mark.parametrize("seed", few(range(30), 2))
def test_no_random_candidate_is_better(seed, standard):
    """Free widths among them; the best one is rated alone, candidates by the text."""
    train = some_rated_drive(2000 + seed, standard=standard)
    problem = teeth.problem(train)
    result, outcome = run(problem)
    rng, points = np.random.default_rng(seed), []
    if result.status == "infeasible":  # by the other standard
        assert standard is some_iso
    else:
        assert result.status == "optimal"
        torque = train.torque
        for k, pair in enumerate(teeth.pairs(train, outcome.x)):
            assert safe(train, k, pair, torque)
            torque *= pair.ratio
    for v in problem.variables:
        for k in range(v.size):
            low, high = float(each(v.lower)[k]), float(each(v.upper)[k])
            if v.values:
                points.append(rng.choice(v.values, 2000))
                continue
            near = rng.uniform(low, high, 2000)
            if outcome.x is not None:
                near = outcome.x[len(points)] * rng.uniform(0.8, 1.25, 2000)
            near = np.rint(near) if v.integer else near
            points.append(np.clip(near, low, high))
    found = problem.batch(np.array(points).T)
    feasible = (found.G.max(axis=1) <= 1.0) & np.isclose(found.H, 1.0).all(axis=1)
    least = math.inf if outcome.x is None else result.value * (1.0 - 1e-11)
    assert (found.F[feasible, 0] >= least).all()
