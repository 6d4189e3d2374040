"""The page of a layout with real-valued teeth: the nearest whole ones are drawn, and it is said."""

import json
import math
from pathlib import Path

import pytest

import gearopt
from gearopt.physics.gears import Gear
from gearopt.physics.geometry.fillet import profile
from gearopt.report.drawing.solid import BACKLASH, Toothed, drawn_teeth, gear_mesh, outline
from gearopt.report.kinds.drive import layout_solid
from gearopt.report.measures import METRIC
from gearopt.report.pages.result import page, tables

ROOT = Path(__file__).parents[3]
BOX = ROOT / "docs" / "pictures" / "elevator_box.json"


def real_valued():
    """A kept layout with other tooth numbers by parts of a tooth."""
    kept = json.loads(BOX.read_text(encoding="utf-8"))
    for gear in kept["design"]["layout"]["gears"]:
        gear["teeth"] += 0.37
    return gearopt.Result.from_dict(kept)


@pytest.mark.parametrize("teeth", [20.0, 20.4, 19.6, 20])
def test_a_gear_closes_whatever_its_teeth(teeth):
    gear = Toothed(Gear(2.0, teeth, 40.0, 10.0), 0.0, 10.0, (0.0, 0.0))
    points, _ = gear_mesh(gear, 3, 0.3)
    around = [math.atan2(z, y) for x, y, z in points if x == 0.0 and (y, z) != (0.0, 0.0)]
    tips = [p for p in points if p[0] == 0.0 and math.hypot(*p[1:]) > 21.9]
    assert drawn_teeth(teeth) == 20 and len(tips) == 2 * 20
    turned = sorted(round((a + 2.0 * math.pi / 20) % (2.0 * math.pi), 6) for a in around)
    same = sorted(round(a % (2.0 * math.pi), 6) for a in around)
    assert len(turned) == len(same)
    gaps = [b - a for a, b in zip(same, same[1:], strict=False)]
    assert max(gaps) < 2.0 * math.pi / 20  # no gap wider than a pitch


@pytest.mark.parametrize("teeth", [0.3, -4.0, 1e9])
def test_what_is_no_number_of_teeth_is_refused(teeth):
    with pytest.raises(ValueError, match="teeth"):
        drawn_teeth(teeth)


def test_the_page_draws_whole_teeth_and_says_so():
    result = real_valued()
    assert layout_solid.ROUNDED in page(result, "")
    assert all(text.strip() for text in tables(result).values())
    kept = gearopt.Result.from_json(BOX.read_text(encoding="utf-8"))
    assert layout_solid.ROUNDED not in layout_solid.section(kept, METRIC).figures[0].caption


@pytest.mark.slow
@pytest.mark.parametrize("method", ["ipopt", "multistart"])
def test_gears_and_box_at_once_with_real_valued_teeth_make_a_page(method):
    path = ROOT / "problems" / "three_stage_together.toml"
    result = gearopt.solve(path, method=method, budget=gearopt.Budget(seconds=5.0))
    assert any(gear["teeth"] % 1 for gear in result.design["layout"]["gears"])
    assert layout_solid.ROUNDED in page(result, "")


def test_teeth_in_space_are_those_of_the_rack():
    """Points of the outline lie on the profile that a rolled rack leaves, but for the backlash."""
    gear = Gear(2.0, 20, 40.0, 10.0)
    tooth = outline(gear, 9)[:18]
    x, y = profile(gear, 4, 6)
    for (angle, radius), a, b in zip(tooth[9:], x[::-1], y[::-1], strict=True):
        assert radius == pytest.approx(math.hypot(a, b))
        assert angle == pytest.approx(math.atan2(a, b) - BACKLASH * math.pi / 20)
