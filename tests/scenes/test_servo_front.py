"""Fronts of servo files: which objectives they have, and what is told of those that have none."""

from pathlib import Path

import pytest

import gearopt
from gearopt import SolveError

PROBLEMS = Path(__file__).parents[2] / "problems"


@pytest.mark.parametrize(
    ("stem", "options", "words"),
    [
        ("servo_gimbal_light", {}, 'of kind "servo": inertia, mass, error$'),
        ("servo_gimbal_fast", {}, "inertia, mass, inverse_acceleration$"),
        ("servo_gimbal_move", {"objectives": "mass,error"}, "objectives: none$"),
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
