"""What must follow when a rated drive changes: more power, stronger steel."""

import math
from dataclasses import replace

import pytest
from rated_drives import agma, some_iso, some_rated_drive

from gearopt.formulations import teeth
from gearopt.optimise.solve import run


def best(train):
    """Return the least objective, inf where there is none, and the pairs."""
    result, outcome = run(teeth.problem(train))
    if result.status == "infeasible":
        return math.inf, ()
    assert result.status == "optimal"
    return result.value, teeth.pairs(train, outcome.x)


def made_of(train, change):
    """Return the drive with every standard changed."""
    stages = []
    for stage in train.stages:
        options = [
            replace(o, standards=tuple(change(s) for s in o.standards)) for o in stage.options
        ]
        stages.append(replace(stage, options=tuple(options)))
    return replace(train, stages=tuple(stages))


def seeds(count):
    """Return so many seeds, of which all but one are slow."""
    return [1, *(pytest.param(s, marks=pytest.mark.slow) for s in range(count) if s != 1)]


@pytest.mark.parametrize("standard", [agma, some_iso])
@pytest.mark.parametrize("seed", seeds(12))
def test_more_power_never_takes_less(seed, standard):
    """By ISO 6336 this is no law: K_v may leave a resonance. Of these drives none does."""
    train = some_rated_drive(3000 + seed, standard=standard)
    value = best(train)[0]
    for _ in range(3):
        train = replace(train, torque=2.0 * train.torque)
        more = best(train)[0]
        assert more >= value * (1.0 - 1e-11)
        value = more


@pytest.mark.parametrize("seed", seeds(12))
def test_stronger_steel_never_takes_more(seed):
    train = some_rated_drive(4000 + seed)
    value = best(train)[0]
    for factor in (1.05, 1.3):
        given = {"s_at": (factor * 250.0,) * 2, "s_ac": (factor * 900.0,) * 2}
        first = given if factor > 1.05 else {"s_at": (250.0,) * 2, "s_ac": (900.0,) * 2}
        other = best(made_of(train, lambda s, g=first: replace(s, given=g)))[0]
        strong = best(made_of(train, lambda s, g=given: replace(s, given=g)))[0]
        assert strong <= other * (1.0 + 1e-11)
    easier = best(replace(train, safety=tuple(0.9 * s for s in train.safety)))[0]
    assert easier <= value * (1.0 + 1e-11)
