"""Drawing data of answers: printed measures, defaults that are told, keys that are wrong."""

from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations.drive.design import drive_design
from gearopt.scenes.drive.drawing import drawing_data

PROBLEMS = Path(__file__).parents[3] / "problems"
WIND = PROBLEMS / "wind_planetary_stage.toml"
BALLS = [f"{d} mm" for d in (18, 20, 22, 25, 28, 30, 35, 40, 45, 50)]  # DIN 3977 near these


def data(file, **drawing):
    """The drawing data of rated gears, by the name of a gear or mesh."""
    found = drive_design(gearopt.rate(file, {"drawing": drawing}).design).drawing
    return {row.gear: row for row in found.gears} | {row.mesh: row for row in found.meshes}, found


@pytest.fixture(scope="module")
def wind():
    rows, found = data(WIND, balls=BALLS)
    assert not found.unverified
    return rows


@pytest.mark.parametrize(
    ("gear", "ball", "k", "balls", "root"),
    [
        ("sun", 45.0, 3, (466.306, 466.079, 465.974), 341.481),
        ("planet", 40.0, 5, (836.492, 836.128, 835.961), 724.182),
        ("ring", 35.0, 11, (1900.511, 1901.454, 1901.836), None),
    ],
)
def test_a_planetary_stage_has_the_measures_of_its_report(wind, gear, ball, k, balls, root):
    """KISSsoft 03/2017, NREL 5 MW, stage 2: its balls, too, are those that are chosen.

    The report has x 0.5039 of the planet and a rack in place of the ring's cutter.
    """
    row = wind[gear]
    assert (row.ball_diameter_mm, row.span_teeth) == (ball, k)
    found = row.over_balls_mm, row.upper_over_balls_mm, row.lower_over_balls_mm
    assert found == pytest.approx(balls, abs=4e-3)
    assert row.upper_root_diameter_mm == pytest.approx(root or row.upper_root_diameter_mm, abs=5e-3)
    assert row.root_diameter_mm * (1 if gear != "ring" else -1) > row.upper_root_diameter_mm * (
        1 if gear != "ring" else -1
    )


def test_the_protuberance_is_that_of_the_tool():
    """Not what remains of it after grinding, 0.01."""
    keys = {"tool_protuberance": 0.02, "grinding_allowance": 0.01}
    changes = {f"stage[1].wheel.{key}": value for key, value in keys.items()}
    result = gearopt.rate(PROBLEMS / "two_stages_rated.toml", {"drawing": {}} | changes)
    rows = drive_design(result.design).drawing.gears
    assert next(row.tool for row in rows if row.gear == "wheel 1").endswith(", pr 0.02, q 0.01")


def test_backlash_of_a_planetary_stage_is_that_of_its_report(wind):
    for mesh, printed in (("sun and planet", (0.283, 0.490)), ("planet and ring", (0.463, 0.708))):
        row = wind[f"stage 1, {mesh}"]
        found = row.least_backlash_mm, row.largest_backlash_mm
        assert found == pytest.approx(printed, abs=2.5e-3)  # of x 0.5038 for 0.5039
    assert wind["planet"].mate == "z 18 and z 93" and wind["sun"].mate == "z 36"


def test_an_own_allowance_is_the_upper_one_with_the_tolerance_of_the_fit():
    key = "stage[1].sun.thickness_allowance"
    found = gearopt.rate(WIND, {"drawing": {}, key: "-0.2 mm"}).design["drawing"]["gears"]
    sun, planet = found[:2]
    assert (sun["upper_allowance_mm"], sun["lower_allowance_mm"]) == pytest.approx((-0.2, -0.26))
    assert sun["allowances"] == "own A_sne, tolerance DIN 3967 cd25"
    assert planet["upper_allowance_mm"] == pytest.approx(-0.175)


def test_given_allowances_take_the_place_of_tables():
    rows, found = data(WIND, allowance="-0.1/-0.16 mm", centre_distance="±0.02 mm")
    assert {row.upper_allowance_mm for row in found.gears} == {-0.1}
    assert {row.lower_allowance_mm for row in found.gears} == {-0.16}
    mesh = rows["stage 1, sun and planet"]
    assert (mesh.lower_distance_allowance_mm, mesh.upper_distance_allowance_mm) == (-0.02, 0.02)


@pytest.mark.parametrize("text", ["27cd", "cd27", "DIN 3967 27cd"])
def test_a_fit_may_be_written_either_way(text):
    assert gearopt.load(WIND, {"drawing": {"allowance": text}}).drawing.fit == "DIN 3967 cd27"


def test_what_the_file_does_not_say_is_told():
    result = gearopt.rate(WIND, {"drawing": {"centre_distance": "js6"}})
    told = result.report["assumptions"][-1]
    assert "DIN 3967 cd25 (default), centre distance js6, grade 6 unless" in told


def test_tolerances_of_2013_are_marked_unverified():
    assert "2013" in data(WIND, tolerances="2013")[1].unverified[0]


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("allowance", "xy25", "neither a fit of DIN 3967"),
        ("allowance", "cd31", "neither a fit of DIN 3967"),
        ("allowance", "0.1/-0.1 mm", "teeth are thinned"),
        ("allowance", 25, "neither a fit of DIN 3967"),
        ("centre_distance", "h7", "neither one of js5"),
        ("centre_distance", 7, "neither one of js5"),
        ("accuracy_grade", 13, "12"),
        ("balls", [], "is empty"),
    ],
)
def test_wrong_values_are_one_clear_error(key, value, said):
    with pytest.raises(SceneError, match=said) as wrong:
        gearopt.load(WIND, {"drawing": {key: value}})
    assert wrong.value.key == f"drawing.{key}"


@pytest.mark.slow
def test_an_idler_is_one_gear_with_two_mates(solved):
    design = drive_design(solved("idler").design)
    found = drawing_data(gearopt.load(PROBLEMS / "idler.toml", {"drawing": {}}), design).gears
    assert [row.gear for row in found] == ["pinion 1", "wheel 1", "wheel 2"]
    teeth = design.stages[0].pinion_teeth, design.stages[1].wheel_teeth
    assert found[1].mate == f"z {teeth[0]} and z {teeth[1]}"


def test_a_ring_has_the_hand_of_its_pinion():
    changes = {"gears.helix_angle": "8 deg", "stage[1].centre_distance": None, "drawing": {}}
    changes["stage[1].ring_teeth"] = 90
    for gear in ("sun", "planet", "ring"):
        changes[f"stage[1].{gear}.profile_shift"] = 0
        changes[f"stage[1].{gear}.tip_alteration"] = 0
    found = gearopt.rate(WIND, changes).design
    hands = [row["hand"] for row in found["drawing"]["gears"]]
    assert hands == ["right", "left", "left"]
    assert [row["hand"] for row in found["rating"]["teeth"]] == ["right", "left", "left", "left"]
