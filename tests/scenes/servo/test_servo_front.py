"""Fronts of servo files: which objectives they have, and what is told of those that have none."""

from fractions import Fraction as F
from html import escape
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt import SolveError
from gearopt.formulations.servo.tolerance.grades import Choice, Graded, problem
from gearopt.optimise.pareto.tradeoff import found
from gearopt.scenes.servo.notes import assumptions

PROBLEMS = Path(__file__).parents[3] / "problems"


@pytest.mark.parametrize(
    ("stem", "options", "words"),
    [
        ("servo_gimbal_light", {}, 'of kind "servo": inertia, mass, error$'),
        ("servo_gimbal_fast", {}, "inertia, mass, inverse_acceleration$"),
        ("servo_gimbal_move", {"objectives": "mass,error"}, "no objectives to weigh"),
        (
            "servo_gimbal_light",
            {"objectives": "mass,error", "method": "epsilon"},
            "teeth are whole",
        ),
        (
            "servo_gimbal_fine",
            {"objectives": "mass,error", "method": "nsga2"},
            "kept by exact alone",
        ),
    ],
)
def test_what_a_file_has_no_front_for_is_said(stem, options, words):
    with pytest.raises(SolveError, match=words):
        gearopt.pareto(PROBLEMS / f"{stem}.toml", **options)


def test_an_accuracy_that_no_train_reaches_has_no_front():
    front = gearopt.pareto(PROBLEMS / "servo_gimbal_impossible.toml", objectives="inertia,error")
    assert front.status == "infeasible" and not front.points
    assert "no teeth and modules meet all limits" in front.message


@pytest.mark.slow
def test_the_front_of_a_file_is_the_list_that_its_answer_shows(solved):
    names = ("inertia", "mass", "error")
    front = gearopt.pareto(PROBLEMS / "servo_gimbal_light.toml", objectives=names)
    listed = solved("servo_gimbal_light").report["trains"]
    keys = ("inertia_kg_m2", "mass_kg", "error_deg")
    every = sorted({tuple(row[key] for key in keys) for row in listed})
    assert front.status == "complete" and len(front.points) == len(every) == 298
    found = sorted(point.values for point in front.points)
    for one, other in zip(found, every, strict=True):
        assert one == pytest.approx(other, rel=1e-12)
    design = front.points[0].design["train"]
    assert design["inertia_kg_m2"] == pytest.approx(front.points[0].values[0], rel=1e-12)


def values(front):
    return np.array([point.values for point in front.points])


@pytest.mark.slow
def test_cost_against_error_of_tolerances_is_the_hyperbola_of_the_closed_form():
    """Cost times error is constant where no tolerance is at its minimum; the error bound holds."""
    front = gearopt.pareto(
        PROBLEMS / "servo_gimbal_trade_off.toml",
        objectives="cost,error",
        points=9,
        most={"cost": 60.0},
    )
    cost, error = values(front).T
    told = assumptions(gearopt.load(PROBLEMS / "servo_gimbal_trade_off.toml"))
    assert told and front.report["assumptions"] == told  # as of a result, on the page, too
    assert all(escape(words, quote=False) in front.to_html() for words in told)
    inside = error > 0.03
    assert front.status == "proven" and inside.sum() >= 5
    assert cost[inside] * error[inside] == pytest.approx(9.889999362 * 0.10819163, rel=1e-6)
    assert cost[-1] == pytest.approx(60.0, rel=1e-6)
    width = np.ptp(values(front), axis=0)
    for k in np.flatnonzero(inside)[:-1]:
        between = np.linspace(error[k + 1], error[k], 30)
        slope = (cost[k + 1] - cost[k]) / (error[k + 1] - error[k])
        chord = cost[k] + slope * (between - error[k])
        gap = (chord - cost[k] * error[k] / between) / width[0]
        off = gap / np.hypot(1.0, slope * width[1] / width[0])
        assert off.max() <= front.error * (1.0 + 1e-3)
    rows = front.points[0].design["tolerances"]
    assert sum(row["new_cost"] for row in rows) == pytest.approx(cost[0], rel=1e-9)


@pytest.mark.slow
def test_an_error_that_the_least_tolerances_exceed_has_no_front():
    changes = {"accuracy.error": "0.01 deg"}
    file = PROBLEMS / "servo_gimbal_trade_off.toml"
    front = gearopt.pareto(file, changes, objectives="cost,error")
    assert front.status == "infeasible" and not front.points and front.message


@pytest.mark.parametrize("rule", ["worst_case", "rss"])
def test_the_front_of_grades_is_that_of_all_picks(rule):
    rng = np.random.default_rng(7)
    parts = tuple(
        Graded(
            f"part {k}",
            F(int(rng.integers(1, 9))),
            tuple((F(t), F(int(40 / t) + int(rng.integers(3)))) for t in (1, 2, 3, 5)),
        )
        for k in range(5)
    )
    choice, names = Choice(parts, F(60), rule), ("cost", "error")
    rows = []
    for picks in product(range(4), repeat=5):
        own = [one.grades[k] for one, k in zip(parts, picks, strict=True)]
        used = [one.sensitivity * t for one, (t, _) in zip(parts, own, strict=True)]
        total = sum(used) if rule == "worst_case" else sum(u * u for u in used)
        if total <= (60 if rule == "worst_case" else 3600):
            rows.append((sum(c for _, c in own), total))
    best = sorted(
        {r for r in rows if not any(o != r and o[0] <= r[0] and o[1] <= r[1] for o in rows)}
    )
    made = found(problem(choice, names), names, {})
    power = 1 if rule == "worst_case" else 2
    assert made.complete and len(made.points) == len(best) > 10
    assert made.values[:, 0] == pytest.approx([float(c) for c, _ in best])
    assert made.values[:, 1] ** power == pytest.approx([float(e) for _, e in best])
    some = found(problem(choice, names), names, {"cost": float(best[4][0])})
    assert len(some.points) == 5
