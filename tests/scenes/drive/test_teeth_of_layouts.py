"""Teeth of the file in layouts and in sizes that are chosen; pairs that cannot mesh."""

import math

import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations.drive.layout.chain import chain
from gearopt.formulations.drive.layout.slabs import arrangements

TEXT = """
gearopt = 1
kind = "drive"
[duty]
power = "{power}"
input_speed = "360 rpm"
ratio = {ratio}
ratio_tolerance = "2 %"
[gears]
tool_addendum = 1.4
tool_tip_radius = 0.39
[[stage]]
{stage}
[limits]
k_factor = "4 MPa"
unit_load = "60 MPa"
pinion_teeth = [17, 25]
[teeth]
"""
ANNEX_A = """module = "8 mm"
pinion_teeth = 17
wheel_teeth = 103
face_width = "100 mm"
helix_angle = "15.8 deg"
[stage.pinion]
profile_shift = 0.14522
[stage.wheel]
tool_tip_radius = 0.3
"""


def written(tmp_path, stage=ANNEX_A, more="", power="10 kW", ratio="6.0588"):
    path = tmp_path / "drive.toml"
    path.write_text(TEXT.format(stage=stage, power=power, ratio=ratio) + more)
    return path


LAYOUT = '[layout]\nshaft_diameters = ["60 mm", "90 mm"]\nwall_clearance = "10 mm"\n'


def test_a_published_pair_has_its_distance_and_tips_in_a_gearbox(tmp_path):
    """ISO/TR 6336-30, example 1: a = 500 mm, d_a = 159.66 and 872.35 mm, x1 = 0.14522."""
    scene = gearopt.load(written(tmp_path, more=LAYOUT))
    box = scene.gearbox((scene.train().pair(0, 8.0, 17, 103, 100.0),))
    (order,) = arrangements(box)
    made = chain(box, (order,))
    assert made.link == pytest.approx([500.0], abs=6e-3)
    assert made.reach == pytest.approx([0.5 * 159.66 + 10.0, 0.5 * 872.35 + 10.0], abs=3e-3)


@pytest.mark.slow
def test_a_published_pair_is_laid_out_at_its_working_centre_distance(tmp_path):
    result = gearopt.solve(written(tmp_path, more=LAYOUT))
    assert result.status == "optimal"
    one, two = result.design["layout"]["shafts"]
    there = math.hypot(two["y_mm"] - one["y_mm"], two["z_mm"] - one["z_mm"])
    (stage,) = result.design["stages"]
    assert there == pytest.approx(500.0, abs=6e-3) == stage["centre_distance_mm"]
    pinion, wheel = result.design["layout"]["gears"]
    assert pinion["tip_diameter_mm"] == pytest.approx(159.66, abs=6e-3)
    assert wheel["tip_diameter_mm"] == pytest.approx(872.35, abs=6e-3)
    box = result.design["layout"]["box"]
    assert min(box["width_mm"], box["height_mm"]) == pytest.approx(892.35, abs=0.01)
    assert pinion["profile_shift"] == 0.14522 and "profile_shift" not in wheel
    assert (pinion["tool_addendum"], pinion["tool_tip_radius"]) == (1.4, 0.39)
    assert (wheel["tool_addendum"], wheel["tool_tip_radius"]) == (1.4, 0.3)


def test_a_drive_is_sized_with_the_helix_of_every_stage(tmp_path):
    stages = [f'face_width_over_diameter = 0.6\nhelix_angle = "{b} deg"' for b in (25, 10)]
    result = gearopt.solve(written(tmp_path, "\n[[stage]]\n".join(stages), ratio="20"))
    assert result.status == "optimal"
    for stage, beta in zip(result.design["stages"], (25.0, 10.0), strict=True):
        d = stage["normal_module_mm"] * stage["pinion_teeth"] / math.cos(math.radians(beta))
        assert stage["pinion_diameter_mm"] == pytest.approx(d, rel=1e-12)
        assert stage["face_width_mm"] == pytest.approx(0.6 * d, rel=1e-12)
        assert stage["helix_angle_deg"] == beta
    (sizing,) = [part for part in result.parts if part.name == "sizing"]
    assert sizing.bound <= result.value


FREE = "face_width_over_diameter = 0.6\n[stage.pinion]\nprofile_shift = 0.3\n"
WRONG = {
    "process two": (
        FREE,
        '[process_two]\nfirst_centre_distance = "500 mm"\n'
        "pinion_teeth = [17]\nstage_ratios = [6]\n",
        "which process_two takes from the reference circles",
    ),
    "overlap": (ANNEX_A.replace("[stage.pin", 'centre_distance = "460 mm"\n[stage.pin'), "", "498"),
    "no involute": (
        ANNEX_A.replace("0.14522", "-2.6"),
        "",
        "pinion.profile_shift = -2.6: leaves 17 teeth no involute below their tips",
    ),
    "no root": (
        ANNEX_A.replace("17", "5").replace("profile_shift = 0.14522", "tool_addendum = 2.9"),
        "",
        "pinion.tool_addendum = 2.9: leaves the root circle of 5 teeth no diameter",
    ),
    "no root by the tool of all gears": (
        ANNEX_A.replace("17", "5").replace("0.14522", "-1.3"),
        "",
        "pinion.profile_shift = -1.3: leaves the root circle of 5 teeth no diameter",
    ),
    "no distance": (
        ANNEX_A + "profile_shift = -2.9\n",
        "",
        "wheel.profile_shift = -2.9: and that of its mate leave no centre distance to 17 and 103",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_teeth_that_cannot_be_had_are_refused_by_name(tmp_path, name):
    stage, more, said = WRONG[name]
    with pytest.raises(SceneError) as caught:
        gearopt.load(written(tmp_path, stage, more))
    assert said in str(caught.value)


@pytest.mark.slow
def test_a_layout_has_the_hands_of_the_file(tmp_path):
    """The wheel of stage 1 is right; so is pinion 2 beside it on its shaft, and wheel 2 left."""
    stage = ANNEX_A.replace("[stage.pinion]", 'pinion_hand = "left"\n[stage.pinion]', 1)
    rating = '[rating]\nlife = "20000 h"\nquality = 8\n'
    second = "\n[[stage]]\n" + ANNEX_A
    text = TEXT.format(stage=stage + second, power="10 kW", ratio="36.709")
    text = text.replace("[gears]", '[gears]\ntreatment = "carburised"')
    more = LAYOUT.replace('"90 mm"', '"90 mm", "100 mm"')
    path = tmp_path / "drive.toml"
    path.write_text(text.replace('k_factor = "4 MPa"', 'k_factor = "40 MPa"') + rating + more)
    found = gearopt.solve(path).design["layout"]["gears"]
    hands = {gear["name"]: gear["hand"] for gear in found}
    assert hands == {"pinion 1": "left", "wheel 1": "right", "pinion 2": "right", "wheel 2": "left"}
