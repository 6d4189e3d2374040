"""The value to write instead of a wrong one is accepted: the file is then read without an error."""

import tomllib
from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.scenes.reading.changes import changed

PROBLEMS = Path(__file__).parents[2] / "problems"
ELEVATOR, GIMBAL = "elevator", "servo_gimbal"

WRONG = {  # file, wrong keys, which one is named, what to write (None: remove it)
    "one load limit beside a preset": (
        ELEVATOR,
        {"limits.preset": "chong-lee-elevator", "limits.k_factor": None},
        "limits.unit_load",
        None,
    ),
    "both load limits beside a preset": (
        ELEVATOR,
        {"limits.preset": "chong-lee-elevator"},
        "limits.preset",
        None,
    ),
    "a series of distances beside load limits": (
        ELEVATOR,
        {"stage[2].centre_distance": "R10"},
        "stage[2].centre_distance",
        None,
    ),
    "a list of distances beside load limits": (
        ELEVATOR,
        {"stage[2].centre_distance": ["200 mm", "224 mm"]},
        "stage[2].centre_distance",
        None,
    ),
    "several helix angles beside load limits": (
        ELEVATOR,
        {"gears.helix_angle": ["20 deg", "25 deg"]},
        "gears.helix_angle",
        "20 deg",
    ),
    "a series of distances of given gears": (
        "shigley_14_5",
        {"stage[1].centre_distance": "R10"},
        "stage[1].centre_distance",
        None,
    ),
    "a load too large": ("reference_pair", {"sharing.loads": [0.5, 1000]}, "sharing.loads", [0.5]),
    "every load too large": ("reference_pair", {"sharing.loads": [1000]}, "sharing.loads", [0.5]),
    "a load as a text, twice": (
        "reference_pair",
        {"sharing.loads": [0.5, "0.5", "1"]},
        "sharing.loads",
        [0.5, 1],
    ),
    "a module of zero": (
        GIMBAL,
        {"train.modules": ["0 mm", "0.3 mm", "0.5 mm"]},
        "train.modules",
        ["0.3 mm", "0.5 mm"],
    ),
    "a module without its unit, twice": (
        GIMBAL,
        {"train.modules": ["0.3 mm", 0.3, 0.5]},
        "train.modules",
        ["0.3 mm", "0.5 mm"],
    ),
    "a diameter of one wheel, in order": (
        GIMBAL,
        {"train.wheel_tip_diameters": ["0 mm", "106 mm"]},
        "train.wheel_tip_diameters",
        ["80 mm", "106 mm"],
    ),
    "a place of three coordinates": (
        "six_cylinders_triangle",
        {"cylinder[2].at": ["30 mm", "10 mm", "10 mm"]},
        "cylinder[2].at",
        ["30 mm", "10 mm"],
    ),
    "a range of three ends": (
        ELEVATOR,
        {"limits.pinion_teeth": [25, 19, 38]},
        "limits.pinion_teeth",
        [19, 38],
    ),
    "an accuracy grade beyond the scale": (
        "iso_tr_6336_30",
        {"rating.iso6336.accuracy_grade": 16},
        "rating.iso6336.accuracy_grade",
        12,
    ),
    "one accuracy grade beyond the scale": (
        "iso_tr_6336_30",
        {"rating.iso6336.accuracy_grade": [16, 7]},
        "rating.iso6336.accuracy_grade",
        [12, 7],
    ),
    "an accuracy grade of a gear": (
        "iso_tr_6336_30",
        {"stage[1].wheel.accuracy_grade": 13},
        "stage[1].wheel.accuracy_grade",
        12,
    ),
    "two grades that are none": (
        "iso_tr_6336_30",
        {"rating.iso6336.accuracy_grade": [True, True, True]},
        "rating.iso6336.accuracy_grade",
        [6, 6],
    ),
    "a factor of both gears": (
        "iso_tr_6336_30",
        {"rating.iso6336.given.Z_L": -1000000000},
        "rating.iso6336.given.Z_L",
        1.1,
    ),
    "Q_v below its scale": ("shigley_14_5", {"rating.quality": 4}, "rating.quality", 5.0),
}


@pytest.mark.parametrize("name", WRONG)
def test_the_value_to_write_is_accepted(name):
    file, wrong, key, write = WRONG[name]
    tables = tomllib.loads((PROBLEMS / f"{file}.toml").read_text(encoding="utf-8"))
    tables = changed(tables, wrong, file)
    with pytest.raises(SceneError) as refused:
        gearopt.load(tables)
    (error,) = refused.value.errors
    assert error.key == key and error.fix.action == ("remove" if write is None else "set")
    right = None if write is None else tomllib.loads(f"v = {error.fix.value}")["v"]
    assert right == write
    gearopt.load(tables, {key: right})
