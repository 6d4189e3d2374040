"""Fronts against the utilisation of the load limits, beside a look at every design."""

import math
from dataclasses import replace
from fractions import Fraction as F
from itertools import product

import numpy as np
import pytest
from brute_force import k_factor_width, pairs
from campaigns import few
from rated_brute_force import cheapest
from rated_drives import some_rated_drive
from small_drives import drive

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.teeth import load_front
from gearopt.optimise import methods
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto.objectives import Limiting
from gearopt.optimise.pareto.tradeoff import found
from gearopt.optimise.result import Budget

SMALL = {"total": 6, "pinion_teeth": (15, 16), "modules": (F(3, 2), F(2), F(3))}


def front(train, points=None, most=None, name="gear_volume", budget=None):
    train, names = replace(train, objective=name), (name, load_front.UTILISATION)
    limiting = Limiting(
        lambda aim, most: load_front.limited(train, aim, most), names, load_front.discrete(train)
    )
    problem = load_front.problem(train, names)
    return found(problem, names, most or {}, None, points, budget, limiting=limiting)


def widths(face, d):
    """All face widths of a pinion [mm] where they are no range."""
    if face.tied:
        return [float(face.high) * d]
    if face.fixed is not None:
        return [float(face.fixed)] if face.low * F(d) <= face.fixed <= face.high * F(d) else []
    step = float(face.step)
    ends = math.ceil(float(face.low) * d / step), math.floor(float(face.high) * d / step)
    return [k * step for k in range(ends[0], ends[1] + 1)]


def choices(train, k, torque, z1, z2):
    """Gear volume, sum of centre distances and utilisation of every module and width of a pair."""
    stage = train.stages[k]
    for module in map(float, stage.modules):
        d, u = module * z1, z2 / z1
        for b in widths(stage.face_width, d):
            used = k_factor_width(stage, torque, d, module, u) / b
            if used <= 1.0 + 1e-12:
                yield 0.25 * math.pi * b * d * d * (1.0 + u * u), 0.5 * d * (1.0 + u), used


def every_design(train, which):
    """Objective and utilisation of all designs of a two-stage drive."""
    one = np.array([1])
    _, z1, z2 = pairs(train, 0, one, one)
    owner, z3, z4 = pairs(train, 1, z1, z2)
    rows = []
    for k, a, b in zip(owner.tolist(), z3.tolist(), z4.tolist(), strict=True):
        first = list(choices(train, 0, train.torque, int(z1[k]), int(z2[k])))
        torque = train.torque * z2[k] / z1[k]
        second = list(choices(train, 1, torque, a, b)) if first else []
        rows += [(p[which] + q[which], max(p[2], q[2])) for p, q in product(first, second)]
    return np.array(rows).reshape(-1, 2)


def unbeaten(rows):
    """Rows by the first column whose second is below that of all before, ties of 1e-9 once."""
    best, kept = math.inf, []
    for f, g in rows[np.lexsort(rows.T[::-1])]:
        if g < best * (1.0 - 1e-9):
            if kept and f <= kept[-1][0] * (1.0 + 1e-9):
                kept.pop()
            kept.append((f, g))
            best = g
    return np.array(kept)


@pytest.mark.parametrize("face", few(["tied", "fixed", "stepped"], ["tied"]))
def test_the_front_is_complete_beside_every_design(face):
    for which, name in enumerate(("gear_volume", "sum_of_centre_distances")):
        train = drive(2, face, **SMALL)
        wanted, made = unbeaten(every_design(train, which)), front(train, name=name)
        assert made.complete and len(made.points) == len(wanted) > 5
        assert made.values == pytest.approx(wanted, rel=1e-9)


def test_largest_values_of_interest_end_the_steps():
    train = drive(2, "tied", **SMALL)
    wanted = unbeaten(every_design(train, 0))
    limits = {"gear_volume": float(np.median(wanted[:, 0])), "utilisation": float(wanted[3, 1])}
    made = front(train, most=limits)
    inside = (wanted <= [limits["gear_volume"], limits["utilisation"]]).all(axis=1)
    assert made.complete and made.values == pytest.approx(wanted[inside], rel=1e-9)
    none = front(train, most={"gear_volume": float(wanted[0, 0]) * 0.999})
    assert none.infeasible and not none.points and none.message


@pytest.mark.slow
def test_free_widths_give_ends_and_steps_of_which_each_is_the_best_of_its_loads():
    train = drive(2, "free", **SMALL)
    most = {"gear_volume": 4.0 * found_best(train)}
    made = front(train, 6, most)
    assert not made.complete and made.epsilon > 0.0 and all(p.proven for p in made.points)
    for volume, used in made.values:
        assert found_best(load_front.carrying(train, used)) == pytest.approx(volume, rel=1e-5)
    assert found_best(load_front.carrying(train, made.values[-1, 1] * 0.999)) > made.values[-1, 0]


def found_best(train):
    problem = teeth.problem(train)
    outcome = problem.methods["exact"](problem, Budget(), 0, None)
    return math.inf if outcome.x is None else float(problem.batch(outcome.x[None]).F[0, 0])


@pytest.mark.slow
def test_every_step_of_a_rated_drive_is_what_a_look_at_all_trains_finds():
    train = some_rated_drive(4, 2, ("tied", "stepped", "fixed"))
    made = front(train, 4, name=train.objective)
    assert len(made.points) == 4 and all(p.proven for p in made.points)
    for best, used in made.values:
        assert cheapest(load_front.carrying(train, used)) == pytest.approx(best, rel=1e-6)
    own = teeth.problem(train)
    for point in made.points:
        used = zip(own.rows.inequalities, own.batch(point.x[None]).G[0], strict=True)
        loads = [v for row, v in used if "_bending[" in row.name or "_contact[" in row.name]
        assert max(loads) == pytest.approx(point.values[1], rel=1e-12)


def test_a_front_that_is_stopped_is_not_complete():
    made = front(drive(2, "tied", **SMALL), budget=Budget(evaluations=2000))
    assert not made.complete and not made.finished


@pytest.mark.slow
def test_a_search_for_the_least_utilisation_that_is_stopped_proves_its_bound():
    train, names = drive(**SMALL), ("gear_volume", load_front.UTILISATION)
    problem, bounds = load_front.problem(train, names), []
    whole = load_front._least(train, problem, 1.0, math.inf, Clock())
    for most in np.linspace(1, whole.evaluations - 1, 9):
        clock = Clock(Budget(evaluations=int(most)))
        outcome = load_front._least(train, problem, 1.0, math.inf, clock)
        methods._check_claims("", outcome)
        if outcome.bound:
            bounds.append(outcome.bound)
            assert f"up to {100.0 * outcome.bound:.4g} %" in outcome.proof["sentence"]
    assert bounds and max(bounds) <= whole.bound
