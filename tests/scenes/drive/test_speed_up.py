"""Drives that increase the speed: the gears of the mirrored reducing drive, to every number."""

import math

import pytest
from rated_files import pair, two_stages

import gearopt
from gearopt.errors import SceneError

FIRST = {"module": "3 mm", "pinion_teeth": 20, "wheel_teeth": 61, "face_width": "31 mm"}
SECOND = {"module": "4 mm", "pinion_teeth": 18, "wheel_teeth": 67, "face_width": "60 mm"}
RATIO = 61 / 20 * 67 / 18
BOTH = {"standard": "both", "iso6336": {"accuracy_grade": 7}, "oil_viscosity": "40 mPa s"}


def two(stages, speed, **more):
    """The tables of two stages at one power and input speed [rpm]."""
    tables = two_stages(rating=BOTH, duty={"input_speed": f"{speed!r} rpm"} | more)
    return tables | {"gears": tables["gears"] | {"helix_angle": "14 deg"}, "stage": stages}


def rising(stages):
    """Stages in reverse order, driven by their wheels."""
    return [stage | {"driver": "wheel"} for stage in reversed(stages)]


def numbers(rating, stages=0):
    """Numbers of a rating by their rows, magnitudes; stages: so many, counted from the output."""
    every = {}
    for name in ("gears", "meshes", "factors", "shafts", "teeth"):
        for row in rating[name]:
            at = row.get("stage", row.get("shaft"))
            last = stages + ("shaft" in row) + 1
            place = name, last - at if stages else at, row.get("member"), row.get("symbol")
            keys = set(row) - {"stage", "shaft"}
            every |= {(*place, k): abs(row[k]) for k in keys if isinstance(row[k], float)}
    return every


def test_the_same_gears_driven_from_the_other_end():
    """At one power torques, speeds, forces, stresses, cycles and factors are the same."""
    forth = gearopt.rate(two([FIRST, SECOND], 1450.0)).design
    back = gearopt.rate(two(rising([FIRST, SECOND]), 1450.0 / RATIO)).design
    for one, other in zip(
        (forth["rating"], forth["rating"]["beside"]),
        (back["rating"], back["rating"]["beside"]),
        strict=True,
    ):
        assert len(numbers(one)) > 150
        assert numbers(other, 2) == pytest.approx(numbers(one), rel=1e-12)
    assert back["ratio"] * forth["ratio"] == pytest.approx(1.0, rel=1e-14)
    power = back["output_torque_Nm"] * 1450.0 * math.pi / 30
    assert power == pytest.approx(7500.0, rel=1e-12)
    assert [stage["driver"] for stage in back["stages"]] == ["wheel", "wheel"]


def test_a_ratio_below_1_says_that_wheels_drive():
    """Asked by either key, without `driver`; a pinion that drives instead is off the ratio."""
    bare = [SECOND, FIRST]
    told = gearopt.rate(two(rising(bare[::-1]), 100.0)).design["rating"]
    for asked in ({"ratio": "360/4087"}, {"output_speed": f"{100.0 * RATIO!r} rpm"}):
        assert gearopt.rate(two(bare, 100.0, **asked)).design["rating"] == told
    off = gearopt.rate(two([s | {"driver": "pinion"} for s in bare], 100.0, ratio="360/4087"))
    assert any("above the one asked for" in flaw for flaw in off.design["rating"]["flaws"])


def test_one_stage_up_and_one_down():
    """A layshaft of 1:1: the last shaft turns as the first one; thrusts of the layshaft cancel."""
    stages = [FIRST | {"helix_angle": "14 deg"}, FIRST | {"helix_angle": "14 deg"}]
    stages[1] |= {"driver": "wheel"}
    design = gearopt.rate(two(stages, 1450.0)).design
    shafts = design["rating"]["shafts"]
    assert design["ratio"] == pytest.approx(1.0, rel=1e-14)
    assert [s["speed_rpm"] for s in shafts] == pytest.approx([1450.0, 1450.0 * 20 / 61, 1450.0])
    assert shafts[1]["axial_force_N"] == pytest.approx(0.0, abs=1e-9)
    first, *_, last = design["rating"]["gears"]
    assert [g["cycles"] for g in (first, last)] == pytest.approx([1.74e9, 1.74e9 * 20 / 61])


def test_what_drives_is_told():
    page = gearopt.rate(two(rising([FIRST]), 500.0)).to_html()
    assert "driving gear" in page and "turns anticlockwise and is driven" in page
    assert "driving gear" not in gearopt.rate(two([FIRST], 500.0)).to_html()


@pytest.mark.parametrize(
    ("stage", "words"),
    [
        ({"pinion_teeth": 61, "wheel_teeth": 20}, 'driver = "wheel" says that the other one'),
        ({"driver": "gear"}, '"wheel"'),
    ],
)
def test_wrong_files(stage, words):
    with pytest.raises(SceneError, match=words):
        gearopt.rate(pair(**stage))


def test_gears_that_are_chosen_have_no_driver():
    limits = {"pinion_teeth": [17, 30]}
    tables = pair(duty={"ratio": 3}, driver="wheel") | {"limits": limits, "teeth": {}}
    with pytest.raises(SceneError, match="chosen ones follow the ratio"):
        gearopt.solve(tables)
