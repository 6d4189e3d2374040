"""Fronts of the box of a drive's file, and what is told where it has none."""

from pathlib import Path

import pytest

import gearopt
from gearopt import SolveError
from gearopt.report.front import decided, verdict
from gearopt.scenes.drive import trades

FILE = Path(__file__).parents[3] / "problems" / "elevator_box.toml"


@pytest.mark.slow
def test_the_end_of_a_front_is_the_box_that_the_file_asks_for(solved):
    front = gearopt.pareto(FILE, objectives="box_volume,height", points=2)
    best = solved("elevator_box")
    assert front.points[0].values[0] == pytest.approx(best.value, rel=1e-6)
    assert front.points[0].proven and front.method == "epsilon"
    box = front.points[0].design["layout"]["box"]
    assert box["height_mm"] == pytest.approx(front.points[0].values[1], rel=1e-12)
    assert front.points[0].design["stages"] == best.design["stages"]


@pytest.mark.parametrize(
    ("changes", "names", "words"),
    [
        ({}, "gear_volume,height", "cannot share a front"),
        pytest.param(
            *({}, "height,box_volume", "box_volume cannot be limited, only width, height, length"),
            marks=pytest.mark.slow,
        ),
        ({"layout.together": True}, "width,height", "write together = false"),
    ],
)
def test_what_has_no_front_is_said(changes, names, words):
    with pytest.raises(SolveError, match=words):
        gearopt.pareto(FILE, changes, objectives=names)


def test_gears_that_cannot_be_laid_out_have_no_front():
    front = gearopt.pareto(FILE, {"layout.largest_height": "200 mm"}, objectives="width,height")
    assert front.status == "infeasible" and not front.points and front.message
    words = "impossible for these gears (sized first for least gear volume), proven"
    assert verdict(front)[0] == words
    assert all(one.endswith(".") and not one.endswith("..") for one in decided(front))


def test_gears_of_a_front_of_their_box_are_sized_within_its_seconds(monkeypatch):
    asked, own = [], trades.sized
    monkeypatch.setattr(trades, "sized", lambda scene, ask: asked.append(ask) or own(scene, ask))
    front = gearopt.pareto(FILE, objectives="width,height", budget=gearopt.Budget(seconds=1e-3))
    assert asked[0].budget.seconds == pytest.approx(5e-4) and front.status == "limit"
    assert not front.points or "stopped early" in front.proof["scope"]
