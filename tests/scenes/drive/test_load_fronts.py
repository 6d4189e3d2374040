"""Fronts of a drive's file against the utilisation of its load limits."""

from pathlib import Path

import pytest

import gearopt
from gearopt import SolveError

PROBLEMS = Path(__file__).parents[3] / "problems"


def test_the_first_design_is_the_answer_and_the_others_have_more_safety(solved):
    front = gearopt.pareto(
        PROBLEMS / "elevator.toml",
        objectives="gear_volume,utilisation",
        most={"gear_volume": 6.2e6},
    )
    best = solved("elevator")
    assert front.status == "complete" and front.method == "epsilon" and len(front.points) >= 5
    assert front.points[0].values[0] == pytest.approx(best.value, rel=1e-12)
    used = max(v for name, v in best.limits.items() if name.startswith(("k_factor", "unit_load")))
    assert front.points[0].values[1] == pytest.approx(used, rel=1e-12)
    for point in front.points:
        loads = [v for n, v in point.limits.items() if n.startswith(("k_factor", "unit_load"))]
        assert max(loads) == pytest.approx(point.values[1], rel=1e-12)


@pytest.mark.parametrize(
    ("stem", "names", "words"),
    [
        ("elevator", "utilisation,gear_volume", "it is the second of two objectives"),
        ("elevator", "gear_volume,mesh_loss,utilisation", "it is the second of two"),
        ("five_stages_continuous", "gear_volume,utilisation", "has no objective 'utilisation'"),
    ],
)
def test_what_has_no_front_is_said(stem, names, words):
    with pytest.raises(SolveError, match=words):
        gearopt.pareto(PROBLEMS / f"{stem}.toml", objectives=names)
