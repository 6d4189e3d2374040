"""Drives of least cost: material, heat treatment and cutting, against every candidate by hand."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from campaigns import few
from front_brute_force import loss
from rated_brute_force import cheapest, costs, masses, safe, widths
from rated_drives import TREATMENTS, agma, some_iso, some_rated_drive

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.front import fronts
from gearopt.formulations.drive.teeth.search import within
from gearopt.formulations.strength.standard import Option
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.physics.blanks import Blank

PLAIN = ("tied", "stepped", "fixed")  # widths that can be listed
TWO_STAGES = (40, 43, 44, 46, 47, 49, 50, 51, 52, 63)  # seeds of few candidates
WEB = Blank(rim_over_module=3.0, web_over_width=0.4)


def priced_drive(seed, stages):
    """A random small drive whose gears choose of materials with prices of metres and kilograms."""
    rng = np.random.default_rng([5, seed])
    train = some_rated_drive(seed, stages, PLAIN)
    standard, quality = (agma, some_iso)[seed % 2], float(rng.integers(6, 11))
    options, bodies = [], (Blank(), WEB) if rng.random() < 0.3 else (Blank(), Blank())
    for k in rng.permutation(len(TREATMENTS))[: int(rng.integers(1, 4))]:
        price, cutting = rng.uniform(1.0, 4.0, 2), rng.uniform(0.0, 8.0, 2)
        densities = (None, 7.2e-9) if rng.random() < 0.3 and standard is agma else (None, None)
        made = replace(standard(TREATMENTS[k], quality), blanks=bodies)
        words = f"{k}", densities, tuple(price)
        options.append(Option((made,), *words, cutting_prices=tuple(cutting)))
    made = [replace(s, options=tuple(options), blanks=bodies) for s in train.stages]
    return replace(train, stages=tuple(made), objective="cost")


def of_one_option(train):
    """The drives of one way of making each stage."""
    for chosen in product(*(stage.options for stage in train.stages)):
        stages = [replace(s, options=(o,)) for s, o in zip(train.stages, chosen, strict=True)]
        yield replace(train, stages=tuple(stages))


SMALL = [(1, seed) for seed in range(20)] + [(2, seed) for seed in TWO_STAGES]


@pytest.mark.parametrize(("stages", "seed"), few(SMALL, [(1, 4)]))
def test_the_least_cost_is_that_of_every_candidate(stages, seed):
    train = priced_drive(seed, stages)
    best, result = min(map(cheapest, of_one_option(train))), solve(teeth.problem(train))
    assert result.status == ("optimal" if np.isfinite(best) else "infeasible")
    if np.isfinite(best):
        assert result.value == pytest.approx(best, rel=1e-10)


def every_row(train):
    """Values of every pair and module of one stage, made in one way, at its least safe width."""
    names = (train.objective, *train.others)
    for z1, start, stop in spans(train, 0, train.highest_ratio):
        for z2, module in product(range(start, stop + 1), train.stages[0].modules):
            made = [train.pair(0, float(module), z1, z2, b) for b in widths(train, 0, module, z1)]
            fit = (p for p in made if safe(train, 0, p, train.torque))
            if not within(train, ((z1, z2),)) or (pair := next(fit, None)) is None:
                continue
            length = 2.0 * pair.centre_distance
            values = {"cost": sum(costs(train, 0, pair)), "mass": sum(masses(train, 0, pair))}
            values |= {"mesh_loss": loss(z1, z2), "total_length": length}
            yield [values[name] for name in names]


@pytest.mark.parametrize("seed", few(range(12), [4]))
def test_fronts_of_cost_equal_all_candidates(seed):
    train = priced_drive(seed, 1)
    others = (("mesh_loss",), ("mass",), ("total_length", "mass"))[seed % 3]
    train = replace(train, others=others)
    made = fronts(train, np.full(1 + len(others), np.inf), Clock(Budget()))
    rows = np.array([row for one in of_one_option(train) for row in every_row(one)])
    assert not made.clock.stopped and len(made.values) == len({*map(tuple, made.values)})
    for row in made.values:
        assert np.isclose(rows, row, rtol=1e-9).all(axis=1).any()
    for row in rows:
        assert (made.values <= row * (1.0 + 1e-9)).all(axis=1).any()
    for row in made.values:
        lower = (rows <= row * (1.0 + 1e-9)).all(axis=1)
        assert not (lower & (rows < row * (1.0 - 1e-9)).any(axis=1)).any()
