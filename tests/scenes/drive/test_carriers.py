"""Carriers of planetary stages: what they weigh, and where they are seen."""

import math
from pathlib import Path

import pytest

import gearopt
from gearopt.report.drawing.bodies import layout_of
from gearopt.report.drawing.train_views import _picked, in_one_line
from gearopt.scenes.drive.notes import assumptions

PROBLEMS = Path(__file__).parents[3] / "problems"
STAGE, WIND = PROBLEMS / "planetary_stage.toml", PROBLEMS / "wind_planetary_stage.toml"
KEY = "stage[1].carrier_over_face_width"


def test_a_given_stage_weighs_more_by_its_cheeks(solved):
    """Discs of 2 x 584 + 0.7 x 36 x 21 mm, together 0.4 x 550 mm wide; gears stay as printed."""
    plain, carried = solved("wind_planetary_stage").design, gearopt.rate(WIND, {KEY: 0.4}).design
    (stage,) = carried["stages"]
    volume = math.pi / 4 * (2 * 584.0 + 0.7 * 36 * 21) ** 2 * 0.4 * 550.0
    assert stage["carrier_mass_kg"] == pytest.approx(7.83e-6 * volume, rel=1e-9)
    masses = [stage[f"{gear}_mass_kg"] for gear in ("pinion", "wheel", "ring")]
    assert masses == pytest.approx([379.7, 880.3, 2712.3], rel=1e-3)
    assert carried["mass_kg"] - plain["mass_kg"] == pytest.approx(stage["carrier_mass_kg"])
    more = carried["gear_volume_mm3"] - plain["gear_volume_mm3"]
    assert more == pytest.approx(volume, rel=1e-9)
    assert carried["rating"]["gears"] == plain["rating"]["gears"]


@pytest.mark.slow
def test_the_stage_of_least_volume_is_that_with_its_carrier():
    found = gearopt.solve(STAGE, {KEY: 0.6})
    (stage,) = found.design["stages"]
    assert found.status == "optimal" and found.value == pytest.approx(548.95e3, rel=1e-5)
    assert [stage[f"{g}_teeth"] for g in ("sun", "planet", "ring")] == [32, 51, 136]
    gears = math.pi / 4 * stage["carrier_diameter_mm"] ** 2 * stage["carrier_width_mm"]
    assert found.value - gears == pytest.approx(314199.08, rel=1e-7)
    told = " ".join(found.report["assumptions"])
    assert "two discs" in told and "without carrier_over_face_width" not in told
    assert "without carrier_over_face_width" in " ".join(assumptions(gearopt.load(STAGE)))
    plates = in_one_line(_picked(found.design["stages"]))[0].plates
    assert all(plate.sized for plate in plates) and len(plates) == 2
    ends = [(plate.end - plate.start, 2.0 * plate.reach) for plate in plates]
    drawn = 0.5 * stage["carrier_width_mm"], stage["carrier_diameter_mm"]
    assert ends == [pytest.approx(drawn)] * 2


@pytest.mark.slow
def test_a_layout_is_longer_by_the_cheeks():
    result = gearopt.solve(PROBLEMS / "planetary_box.toml", {KEY: 0.5})
    layout = layout_of(result)
    (ring,) = (gear for gear in layout.gears if gear.member == "ring")
    near, far = sorted(layout.shafts[:2], key=lambda shaft: shaft.from_mm)
    width = result.design["stages"][0]["face_width_mm"]
    assert ring.to_mm - ring.from_mm == pytest.approx(width, rel=1e-9)
    assert far.from_mm - near.to_mm == pytest.approx(1.5 * width, rel=1e-9)
