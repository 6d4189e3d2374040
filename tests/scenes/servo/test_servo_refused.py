"""Files of servo axes that are refused, and what to write instead."""

import tomllib

import pytest
from scene_files import dump, mended, parse, walk
from servo_files import (
    GIVEN_GEARS,
    TOLERANCES,
    changed,
    solved,
)

from gearopt.errors import SceneError
from gearopt.scenes.reading.load import read
from gearopt.scenes.servo import KIND

EXAMPLE = KIND.example.text


@pytest.mark.parametrize(
    ("sheet", "plain"),
    [
        ("8.6e-6 kgm2", "8.6e-6 kg m^2"),
        ("86 gcm\u00b2", "86 g cm^2"),
        ("86 g\u00b7cm\u00b2", "86 g cm^2"),
    ],
)
def test_inertias_are_read_as_data_sheets_write_them(sheet, plain):
    there, same = (changed(EXAMPLE, (("motor", "inertia"), text)) for text in (sheet, plain))
    assert there.motor.inertia == same.motor.inertia


def test_an_inertia_with_a_decimal_comma_is_mended():
    with pytest.raises(SceneError) as caught:
        changed(EXAMPLE, (("motor", "inertia"), "0,09 kg cm^2"))
    assert caught.value.fix.value == '"0.09 kg cm^2"'


NO_GRADE = {k: v for k, v in GIVEN_GEARS.items() if k != "grade"}

GIVEN_TEETH = {"module": "0.5 mm", "pinion_teeth": 17, "wheel_teeth": 85}

REFUSED = [  # edits, dropped, key, words
    ([], [("motor",)], "motor", "belong together"),
    ([], [("duty",)], "duty", "belong together"),
    ([], [("motor", "torque")], "motor.torque", "needs it"),
    ([(("duty", "motion"), "move")], [], "duty.angle", "needs it"),
    ([(("duty", "motion"), "swing")], [], "duty.amplitude", "needs it"),
    ([(("duty", "angle"), "90 deg")], [], "duty.angle", 'for motion = "move"'),
    ([(("motor", "no_load_speed"), "800 rad/s")], [], "motor.no_load_speed", "without load_speed"),
    ([(("budget", 0, "kappa"), 2)], [], "budget[1].kappa", 'for rule = "mean_plus_sd"'),
    ([], [("mesh", 1)], "mesh", "each of the two stages"),
    ([], [("mesh",)], "mesh", "needs one per stage"),
    ([], [("shaft",)], "shaft", "twists"),
    (
        [(("train", "minimise"), "move_time")],
        [],
        "duty.motion",
        'does not suit minimise = "move_time" of [train]',
    ),
    ([(("train", "maximise"), "acceleration")], [], "train.minimise", "conflicts with maximise"),
    (
        [(("train", "minimise"), "rms_torque")],
        [("motor",), ("load",), ("duty",), ("stiffness", "frequency"), ("lightest",)],
        "duty",
        'minimise = "rms_torque" needs it',
    ),
    (
        [(("mesh", 0), NO_GRADE), (("mesh", 1), NO_GRADE | {"pitch": "9 um"})],
        [],
        "mesh[1].pitch",
        "the other [[mesh]] has one",
    ),
    (
        [(("mesh", k), NO_GRADE) for k in (0, 1)],
        [],
        "mesh[1].pitch",
        "[tolerances] are made of them",
    ),
    (
        [(("mesh", k), NO_GRADE) for k in (0, 1)],
        [("tolerances",), ("cost",), ("budget",)],
        "mesh[1].pitch",
        "[accuracy] holds their error",
    ),
    (
        [(("mesh", k), NO_GRADE) for k in (0, 1)] + [(("train", "minimise"), "error")],
        [("tolerances",), ("cost",), ("budget",), ("accuracy",)],
        "mesh[1].pitch",
        'minimise = "error" needs one',
    ),
    (
        [(("train", "minimise"), "error")],
        [("mesh",), ("tolerances",), ("cost",), ("budget",), ("accuracy",)],
        "mesh",
        'minimise = "error" needs one per stage',
    ),
    ([], [("stiffness",)], "lightest", "needs a table"),
    ([], [("tolerances",)], "budget", "needs a table"),
    ([(("mesh", 0, "module"), "0.5 mm")], [], "mesh[1].pinion_teeth", "given by module"),
    ([(("mesh", 0, "grade"), 7)], [("mesh", 0, "pitch")], "mesh[1].grade", "given gears"),
    ([(("mesh", 0, "wheel_pitch"), "9 um")], [], "mesh[1].wheel_pitch", "conflicts with pitch"),
    ([(("train", "wheel_tip_diameters"), ["80 mm"])], [], "train.wheel_tip_diameters", "both"),
    (
        [(("train", "ratio"), [47, 49]), (("train", "ratio_tolerance"), "1 %")],
        [],
        "train.ratio_tolerance",
        "conflicts with a range",
    ),
    (
        [(("stiffness", "youngs_modulus"), "206 GPa")],
        [],
        "stiffness.youngs_modulus",
        "conflicts with line_stiffness",
    ),
    ([(("stiffness", "windup"), "1 mrad")], [("stiffness", "load_torque")], "stiffness.load_torque",
     "beside windup"),
    ([(("budget",), [{"rule": "rss"}, {"rule": "rss"}])], [], "budget[2]", "one budget for each"),
    (
        [(("tolerances", "grades"), 4), (("budget",), [{"rule": "mean_plus_sd"}])],
        [],
        "budget[1].rule",
        "not for grades",
    ),
    (
        [(("train", "second_pinion_diameter"), "8.5 mm")],
        [],
        "train.second_pinion_diameter",
        "too small around a shaft of 8 mm",
    ),
    ([(("shaft", "diameter"), "0.5 in")], [], "train.second_pinion_diameter", "0.5 in"),
    (
        [(("train", "output_shaft_diameter"), "17 mm")],
        [],
        "space.hub_diameter",
        "below the 17 mm of output_shaft_diameter",
    ),
    ([(("space", "swept_angle"), "60 deg")], [], "space.swept_angle", "below the 90 deg"),
    ([(("space", "swept_angle"), "181 deg")], [], "train.sector", "travel of 91 deg"),
    ([(("train", "sector"), "20 %")], [], "train.sector", "travel of 108 deg"),
    (
        [(("duty",), {"motion": "move", "angle": "100 deg"})],
        [],
        "train.sector",
        "smaller than the 100 deg that the load turns",
    ),
    (
        [(("duty",), {"motion": "swing", "amplitude": "50 deg", "frequency": "1 Hz"})],
        [("motor", "friction")],
        "train.sector",
        "smaller than the 100 deg that the load turns",
    ),
    (
        [(("duty",), {"motion": "move", "angle": "80 deg"}), (("space", "swept_angle"), "160 deg")],
        [],
        "space.swept_angle",
        "the 90 deg of the wheel's sector and the 80 deg",
    ),
    (
        [(("mesh", k, n), v) for k in (0, 1) for n, v in GIVEN_TEETH.items()],
        [],
        "mesh[2].pinion_teeth",
        "root circle of 7.25 mm, thinner than the shaft of 8 mm",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("edits", "drop", "key", "words"), REFUSED)
def test_a_file_that_does_not_fit_together_is_refused_and_mended(edits, drop, key, words):
    content = parse(EXAMPLE)
    for place, value in edits:
        *way, last = place
        walk(content, way)[last] = value
    for place in drop:
        *way, last = place
        del walk(content, way)[last]
    data = dump(content)
    with pytest.raises(SceneError) as wrong:
        read(data.encode(), "my.toml")
    assert wrong.value.key == key and words in wrong.value.rule
    for _ in range(6):
        data = mended(data, wrong.value.fix)
        try:
            read(data.encode(), "my.toml")
            return
        except SceneError as next_one:
            wrong.value.fix = next_one.fix
    raise AssertionError(data)


TRUED = [(("budget",), [{"rule": "mean_plus_sd", "kappa": 0}])]


def test_a_mean_alone_needs_an_upper_end_for_run_outs():
    with pytest.raises(SceneError, match="no budget counts the run-outs") as wrong:
        changed(TOLERANCES, *TRUED)
    assert wrong.value.key == "tolerances.largest_factor"
    held = solved(TOLERANCES, *TRUED, (("tolerances", "largest_factor"), 4))
    assert held.status == "optimal"
    rows = held.design["tolerances"]
    outs = [r["new_mm"] / r["old_mm"] for r in rows if "run-out" in r["name"]]
    assert outs == pytest.approx([4.0] * 3)
    both = [{"rule": "worst_case"}, {"rule": "mean_plus_sd", "kappa": 0}]
    assert solved(TOLERANCES, (("budget",), both)).status == "optimal"


def test_the_mean_of_run_outs_alone_is_no_budget():
    meshes = [
        {
            "module": "0.5 mm",
            "pinion_teeth": 16,
            "wheel_teeth": 96,
            "pinion_bearing_run_out": "3 um",
        }
    ] * 2
    with pytest.raises(SceneError, match="the mean of run-outs is 0") as wrong:
        changed(TOLERANCES, *TRUED, (("mesh",), meshes), (("tolerances", "largest_factor"), 4))
    assert wrong.value.key == "budget[1].kappa"


def test_grades_beside_a_train_are_refused():
    given = [(("mesh", k, n), v) for k in (0, 1) for n, v in GIVEN_GEARS.items()]
    with pytest.raises(SceneError, match="chooses the diameters") as wrong:
        changed(EXAMPLE, *given, drop=[("mesh", k, "pitch") for k in (0, 1)])
    assert wrong.value.key == "mesh[1].grade" and wrong.value.fix.action == "remove"


def test_tolerances_alone_need_given_gears():
    lone = dump({k: v for k, v in tomllib.loads(EXAMPLE).items()
                 if k in ("gearopt", "kind", "mesh", "tolerances")})  # fmt: skip
    with pytest.raises(SceneError, match="without .train. tolerances are for given gears"):
        read(lone.encode())
