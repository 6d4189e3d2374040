"""What must follow when a rated drive changes: more power, stronger steel, other units."""

import math
import random
from dataclasses import replace
from itertools import product

import pytest
from campaigns import few
from rated_drives import agma, some_iso, some_rated_drive

import gearopt
from gearopt.formulations.drive import teeth
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


@pytest.mark.parametrize(
    ("seed", "standard"), few(product([1, 0, *range(2, 12)], [agma, some_iso]), [(1, agma)])
)
def test_more_power_never_takes_less(seed, standard):
    """By ISO 6336 this is no law: K_v may leave a resonance. Of these drives none does."""
    train = some_rated_drive(3000 + seed, standard=standard)
    value = best(train)[0]
    for _ in range(3):
        train = replace(train, torque=2.0 * train.torque)
        more = best(train)[0]
        assert more >= value * (1.0 - 1e-11)
        value = more


@pytest.mark.slow
@pytest.mark.parametrize("seed", few([1, 0, *range(2, 12)], 1))
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


def on_a_tie(seed, unit, mm):
    """Return a rated stage whose limits of width and wheel lie on its steps and teeth exactly."""
    draw = random.Random(seed)
    step, module = draw.choice([1, 3, 5, 7]), draw.choice([3, 4, 5])
    least, wheel = step * draw.randint(1, 20 * module // step), module * draw.randint(80, 90)
    return {
        "gearopt": 1,
        "kind": "drive",
        "duty": {"power": "7.5 kW", "input_speed": "1450 rpm", "ratio": 4, "ratio_tolerance": 0.02},
        "limits": {"pinion_teeth": [20, 30], "wheel_diameter": f"{wheel / mm!r} {unit}"},
        "teeth": {"modules": [f"{m} mm" for m in (1.5, 2, 2.5, 3, 4, 5)]},
        "rating": {"quality": 7, "life": "20000 h"},
        "gears": {
            "treatment": "carburised",
            "face_width_over_diameter": [0.2, 1],
            "face_width_step": f"{step / mm!r} {unit}",
            "minimum_face_width": f"{least / mm!r} {unit}",
        },
        "stage": [{}],
    }


@pytest.mark.parametrize("seed", few([5, 6, 8, 9], 2))
def test_lengths_in_inches_tie_as_those_in_mm_do(seed):
    """Inches of 16 digits are not quite these lengths; of these drives the answer hangs on it."""
    there, here = (gearopt.solve(on_a_tie(seed, *own)) for own in (("mm", 1), ("in", 25.4)))
    assert here.status == there.status == "optimal"
    assert here.value == pytest.approx(there.value, rel=1e-9)
    one, other = (r.design["stages"][0] for r in (there, here))
    for key in ("pinion_teeth", "wheel_teeth", "normal_module_mm"):
        assert one[key] == other[key]
