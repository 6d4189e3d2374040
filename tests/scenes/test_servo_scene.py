"""A servo axis's file: what it refuses, and other known numbers by changing one key."""

import math
import tomllib
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from scene_files import dump, mended, parse, walk

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations import servo_box
from gearopt.optimise.result import Budget
from gearopt.scenes.axis.choice import box_of, front, posed
from gearopt.scenes.axis.gears import of_point
from gearopt.scenes.reading.load import read
from gearopt.scenes.servo import EXAMPLE

PROBLEMS = Path(__file__).parents[2] / "problems"


def text(name):
    return (PROBLEMS / f"servo_{name}.toml").read_text(encoding="utf-8")


def changed(base, *edits, drop=()):
    """The scene of a file with (place, value) set and places dropped."""
    content = parse(base)
    for place, value in edits:
        *way, last = place
        walk(content, way)[last] = value
    for place in drop:
        *way, last = place
        del walk(content, way)[last]
    return read(dump(content).encode(), "my.toml")[1]


def solved(base, *edits, drop=()):
    return gearopt.solve(changed(base, *edits, drop=drop))


RATIO = text("gimbal_ratio")


@pytest.mark.parametrize(
    ("edits", "ratio", "acceleration", "at_48"),
    [
        ([], 57.786211, 47.287374, 46.304224),
        ([(("load", "friction"), "0 N m")], 47.982555, 56.948992, 56.948988),
        ([(("load", "efficiency"), Decimal("0.9"))], 61.520067, 44.417347, 42.747476),
        (
            [(("duty", "load_speed"), "5 rad/s"), (("motor", "no_load_speed"), "800 rad/s")],
            42.063097,
            28.626103,
            28.129015,
        ),
    ],
)
def test_accelerations_known_independently(edits, ratio, acceleration, at_48):
    result = solved(RATIO, *edits)
    assert result.status == "optimal" and result.name == "ratio"
    design = result.design["ratio"]
    assert design["total_ratio"] == pytest.approx(ratio, abs=6e-7)
    assert design["value"] == pytest.approx(acceleration, abs=6e-7)
    assert design["given"]["value"] == pytest.approx(at_48, abs=6e-7)
    loss = 100.0 * (1.0 - at_48 / acceleration)
    assert design["given"]["loss_percent"] == pytest.approx(loss, abs=2e-6)
    curve = design["curve"]
    assert max(curve["value"]) == pytest.approx(design["value"], rel=1e-15)
    assert np.all(np.diff(curve["total_ratio"]) > 0) and len(curve["value"]) > 150


@pytest.mark.parametrize(
    ("angle", "ratio", "time"),
    [("90 deg", 47.982555, 0.322041), ("10800 deg", 13.9060, 5.052376)],
)
def test_moves_known_independently(angle, ratio, time):
    result = solved(text("gimbal_move"), (("duty", "angle"), angle))
    assert result.report["best_total_ratio"] == pytest.approx(ratio, abs=6e-5)
    assert result.value == pytest.approx(time, abs=6e-7)


TOLERANCES = text("gimbal_tolerances")


@pytest.mark.parametrize(
    ("rule", "exponent", "cost"),
    [
        ("worst_case", Decimal("0.5"), 11.044978491),
        ("worst_case", 2, 8.923521611),
        ("rss", Decimal("0.5"), 8.884275302),
        ("rss", 1, 6.872001013),
        ("rss", 2, 5.292125686),
    ],
)
def test_costs_known_independently(rule, exponent, cost):
    """Within what the given tolerances use, by the same rule."""
    edits = ((("budget", 0, "rule"), rule), (("tolerances", "exponent"), exponent))
    result = solved(TOLERANCES, *edits)
    assert result.status == "optimal" and result.value == pytest.approx(cost, abs=6e-10)
    rows = result.design["tolerances"]
    assert sum(r["new_cost"] for r in rows) == pytest.approx(result.value, rel=1e-12)
    (budget,) = result.design["allocation"]["budgets"]
    assert budget["used_deg"] == pytest.approx(budget["limit_deg"], rel=1e-9)


def test_mean_and_three_deviations_known_independently():
    edits = (
        (("budget", 0), {"rule": "mean_plus_sd", "limit": "0.10819163246984825 deg"}),
        (("tolerances", "least_factor"), Decimal("0.25")),
        (("tolerances", "largest_factor"), 4),
    )
    result = solved(TOLERANCES, *edits)
    assert result.value == pytest.approx(
        7.504136982, abs=6e-10
    )  # the print is a solver's, 1e-6 off
    drawn = result.design["drawn"]
    low, high = drawn["quantile_low_deg"], drawn["quantile_high_deg"]
    assert low < 0.1062 + 5e-5 and high > 0.1062 - 5e-5
    assert drawn["worst_case_deg"] == pytest.approx(0.1443, abs=6e-5)
    assert sum(drawn["histogram"]["counts"]) == drawn["count"]
    assert len(drawn["histogram"]["edges_deg"]) == 61


def test_two_budgets_known_independently():
    rss = f"{0.7 * 0.04703039201954477!r} deg"
    edits = ((("budget",), [{"rule": "worst_case"}, {"rule": "rss", "limit": rss}]),)
    assert solved(TOLERANCES, *edits).value == pytest.approx(9.969507852, abs=6e-10)


def test_the_worst_case_gives_the_printed_tolerances():
    result = gearopt.solve(PROBLEMS / "servo_gimbal_tolerances.toml")
    new = {r["name"]: 1e3 * r["new_mm"] for r in result.design["tolerances"]}
    printed = {
        "test radius of pinion 1": 30.1,
        "test radius of wheel 1": 34.8,
        "pitch of stage 1": 32.6,
        "test radius of pinion 2": 16.5,
        "test radius of wheel 2": 19.2,
        "pitch of stage 2": 18.1,
    }
    assert {k: new[k] for k in printed} == pytest.approx(printed, abs=0.06)
    assert result.report["old_mean_deg"] == pytest.approx(0.0510, abs=6e-5)
    assert result.report["old_sd_deg"] == pytest.approx(0.0138, abs=6e-5)
    assert result.report["backlash_deg"] == pytest.approx(0.06318, abs=6e-6)
    assert result.report["pitch_deg"] == pytest.approx(0.04501, abs=6e-6)
    total = sum(row["error_deg"] for row in result.design["errors"])
    assert total == pytest.approx(result.design["train"]["error_deg"], rel=1e-14)


def test_dear_pitch_deviations_become_wider():
    """The closed form with a_i = 4 for pitch: t ~ sqrt(a t_0/s), C = (sum)^2/E."""
    result = solved(TOLERANCES, (("tolerances", "pitch_cost"), 4))
    rows = result.design["tolerances"]
    cost = [4.0 if r["kind"] == "pitch" else 1.0 for r in rows]
    parts = [a * r["old_mm"] * r["sensitivity_deg_per_mm"] for a, r in zip(cost, rows, strict=True)]
    limit = result.design["allocation"]["budgets"][0]["limit_deg"]
    assert result.value == pytest.approx(sum(np.sqrt(parts)) ** 2 / limit, rel=1e-12)
    assert result.design["allocation"]["old_cost"] == 20.0
    same = gearopt.solve(PROBLEMS / "servo_gimbal_tolerances.toml").design["tolerances"]
    for new, old in zip(rows, same, strict=True):
        assert (new["new_mm"] > old["new_mm"]) == (new["kind"] == "pitch")
    choice = solved(text("gimbal_grades"), (("tolerances", "pitch_cost"), 4))
    assert choice.status == "optimal" and result.value < choice.value < 20.0


@pytest.mark.parametrize(
    ("wrong", "write"),
    [
        ("8.6e-6 kgm2", "8.6e-6 kg m^2"),
        ("86 gcm\u00b2", "86 g cm^2"),
        ("86 g\u00b7cm\u00b2", "86 g cm^2"),
        ("0,09 kg cm^2", "0.09 kg cm^2"),
    ],
)
def test_inertias_as_data_sheets_write_them_are_mended(wrong, write):
    with pytest.raises(SceneError) as caught:
        changed(EXAMPLE, (("motor", "inertia"), wrong))
    assert caught.value.fix.value == f'"{write}"'


def test_grades_by_rss_known_independently():
    result = solved(text("gimbal_grades"), (("budget",), [{"rule": "rss"}]))
    assert result.value == pytest.approx(7.328427125, abs=6e-10)


@pytest.mark.parametrize(
    ("grade", "worst", "rss"),
    [(5, 0.0448, 0.0263), (6, 0.0634, 0.0372), (7, 0.0897, 0.0526), (8, 0.1268, 0.0744)],
)
def test_pitch_errors_of_both_gears_by_grade(grade, worst, rss):
    """An independent computation, for gears of 8, 48, 13 and 104 mm."""
    edits = [(("mesh", k, "grade"), grade) for k in (0, 1)]
    scene = changed(TOLERANCES, *edits, drop=[("mesh", k, "pitch") for k in (0, 1)])
    result = gearopt.solve(scene)
    pitch = [r["error_deg"] for r in result.design["errors"] if r["kind"] == "pitch"]
    assert len(pitch) == 4
    assert sum(pitch) == pytest.approx(worst, abs=6e-5)
    assert math.hypot(*pitch) == pytest.approx(rss, abs=6e-5)


STIFF = text("gimbal_stiff")


@pytest.mark.parametrize(
    ("frequency", "grams"), [("150 Hz", 70.59627), ("250 Hz", 128.15908), ("300 Hz", 181.12544)]
)
def test_lightest_trains_known_independently(frequency, grams):
    result = solved(STIFF, (("stiffness", "frequency"), frequency))
    stiff = next(part for part in result.parts if part.name == "stiff")
    assert stiff.status == "optimal" and 1e3 * stiff.value == pytest.approx(grams, abs=6e-6)


def test_the_whole_toothed_train_is_as_stiff_as_asked():
    """230 Hz cuts the best trains off; the answer is the best of the unbeaten ones."""
    least = [(("stiffness", "frequency"), "230 Hz"), (("accuracy", "error"), "0.12 deg")]
    example = changed(EXAMPLE, *least, drop=[("space",), ("lightest",)])
    result = gearopt.solve(example)
    assert result.status == "optimal" and "trains_stiff_enough" in result.proof
    assert result.design["stiffness"]["frequency_Hz"] >= 230.0
    assert result.limits["stiffness"] == pytest.approx(
        (230.0 / result.design["stiffness"]["frequency_Hz"]) ** 2, rel=1e-12
    )
    points, worth = front(example)
    assert 1e-3 * worth[:, 0].min() == pytest.approx(result.value, rel=1e-12)
    free = gearopt.solve(changed(EXAMPLE, drop=[("space",), ("lightest",)]))
    assert result.value > free.value
    none = solved(EXAMPLE, (("stiffness", "frequency"), "5 kHz"), drop=[("space",), ("lightest",)])
    assert none.status == "infeasible" and "stiffness" in none.message


NARROW = (
    (("accuracy", "error"), "0.15 deg"),
    (("space", "width"), "74 mm"),
    (("train", "modules"), ["0.5 mm"]),
)
BARE = [("stiffness",), ("lightest",), ("tolerances",), ("cost",), ("budget",)]


def test_a_box_that_is_required_changes_the_train():
    """The answer fits, and of the better trains none does."""
    scene = changed(EXAMPLE, *NARROW, drop=BARE)
    result = gearopt.solve(scene)
    assert result.status == "optimal" and result.design["box"]["fits"]
    assert result.design["box"]["needed_width_mm"] <= 74.0
    loose = gearopt.solve(changed(EXAMPLE, *NARROW, (("space", "required"), False), drop=BARE))
    assert loose.value < result.value and not loose.design["box"]["fits"]
    assert any("does not fit" in note for note in loose.report["notes"])
    points, worth = front(scene)
    better = [x for x, row in zip(points, worth, strict=True) if 1e-3 * row[0] < result.value]
    assert better and servo_box.first_that_fits([box_of(scene, x) for x in better]) is None
    found = box_of(scene, gears_point(result))
    assert servo_box.first_that_fits([found]) is not None


def test_a_look_for_a_box_stops_in_time():
    tight = (*NARROW, (("space", "height"), "95 mm"))
    scene = changed(EXAMPLE, *tight, drop=BARE)
    result = gearopt.solve(posed(scene), budget=Budget(seconds=0.02))
    assert result.status == "limit" and result.value is None


def gears_point(result):
    first, second = result.design["train"]["stages"]
    keys = ("pinion_teeth", "wheel_teeth", "normal_module_mm")
    return np.array([stage[key] for key in keys for stage in (first, second)], float)


def test_neighbours_are_not_beaten_in_all_three():
    result = gearopt.solve(PROBLEMS / "servo_gimbal_light.toml")
    rows = result.report["trains"]
    worth = np.array([[r["inertia_kg_m2"], r["mass_kg"], r["error_deg"]] for r in rows])
    for k, own in enumerate(worth):
        others = np.delete(worth, k, axis=0)
        assert not ((others <= own).all(1) & (others < own).any(1)).any()
    assert len(rows) == 298 and len({r["best_of"] for r in rows}) == 4
    named = {r["best_of"]: r for r in rows if r["best_of"]}
    assert named["mass"]["mass_kg"] == result.value
    error = named["error"]["error_deg"]
    assert error == pytest.approx(0.09798, abs=6e-6)
    assert named["inertia"]["inertia_kg_m2"] == pytest.approx(1.562e-7, abs=6e-11)


def test_given_gears_stand_beside_the_best():
    report = gearopt.solve(PROBLEMS / "servo_gimbal.toml").report
    assert report["given_inertia_kg_m2"] == pytest.approx(7.578e-7, abs=6e-11)
    assert report["given_mass_kg"] == pytest.approx(0.1914, abs=6e-5)
    assert report["given_error_deg"] == pytest.approx(0.10819, abs=6e-6)
    assert report["given_frequency_Hz"] == pytest.approx(210.1, abs=0.06)
    assert report["real_valued_bound_inertia_kg_m2"] == pytest.approx(4.884e-7, abs=6e-11)
    mass = [row["mass_in_pinions"] for row in report["stage_counts"]]
    assert mass == pytest.approx([2305.0, 98.0, 42.623, 31.713, 28.522, 27.805], abs=6e-4)


def test_stiffness_by_youngs_modulus_is_near_the_known_one():
    """There the teeth's form factors are those of a table; the fit here differs by 3 % or less."""
    content = parse(text("gimbal"))
    del content["stiffness"]["line_stiffness"]
    content["stiffness"]["youngs_modulus"] = "193.2 GPa"
    report = gearopt.solve(read(dump(content).encode())[1]).report
    stiffness = report["given_stiffness"]
    assert stiffness["output_Nm_per_rad"] == pytest.approx(3.466e4, rel=0.005)
    assert stiffness["frequency_Hz"] == pytest.approx(210.6, rel=0.003)
    assert stiffness["windup_deg"] == pytest.approx(0.000697, rel=0.005)
    shares = [s["compliance_share"] for s in stiffness["springs"]]
    assert shares == pytest.approx([0.203, 0.782, 0.015], abs=0.004)


def test_tolerances_beyond_the_error_of_the_file_are_named():
    """Three standard deviations within the limit, the worst case above it."""
    edits = ((("budget", 0), {"rule": "mean_plus_sd"}),)
    result = solved(EXAMPLE, *edits, drop=[("space",), ("lightest",)])
    assert result.design["drawn"]["worst_case_deg"] > 0.12
    assert any("at their worst" in note for note in result.report["notes"])


def test_the_wider_error_that_is_proposed_is_the_least():
    explained = gearopt.explain(PROBLEMS / "servo_gimbal_impossible.toml")
    assert {"error", "wheel_tip[2]"} <= set(explained.conflict)
    least, even = explained.remedies
    assert least.changes[0].write == '"0.09798 deg"' and least.bound < least.factor
    assert len(even.changes) == 14 and "pitch of stage 2" in explained.message


def test_what_is_impossible_for_another_reason_is_said():
    scene = changed(text("gimbal_light"), (("train", "bending_stress"), "1 MPa"))
    explained = gearopt.explain(scene)
    assert explained.result.status == "infeasible" and explained.remedies == ()
    assert "not for the accuracy" in explained.message


def test_comparing_takes_the_train_without_its_box():
    scene = changed(EXAMPLE)
    found = gearopt.compare(scene, ("exact", "annealing"), seeds=1, evaluations=500, seconds=0.2)
    assert found is not None
    assert posed(scene, boxed=False).methods.keys() == {"exact", "enumeration"}
    x = gearopt.solve(posed(scene, boxed=False)).design
    assert of_point([*x["pinion_teeth"], *x["wheel_teeth"], *x["module_mm"]]).pinions == (17, 23)


def test_a_run_out_of_time_says_so():
    result = gearopt.solve(changed(EXAMPLE), budget=Budget(seconds=0.0))
    assert result.status in ("limit", "stationary", "optimal", "feasible")
    result.to_json()


REFUSED = [  # edits, dropped, key, words
    ([], [("motor",)], "motor", "belong together"),
    ([], [("duty",)], "duty", "belong together"),
    ([], [("motor", "torque")], "motor.torque", "needs it"),
    ([(("duty", "motion"), "move")], [], "duty.angle", "needs it"),
    ([(("duty", "motion"), "swing")], [], "duty.amplitude", "needs it"),
    ([(("duty", "angle"), "90 deg")], [], "duty.angle", 'for motion = "move"'),
    ([], [("mesh", 1)], "mesh", "each of the two stages"),
    ([], [("mesh",)], "mesh", "needs one a stage"),
    ([], [("shaft",)], "shaft", "needs it"),
    ([], [("accuracy", "error")], "accuracy.error", "needs it"),
    ([], [("stiffness",)], "lightest", "needs a table"),
    ([], [("tolerances",)], "budget", "needs a table"),
    ([(("mesh", 0, "module"), "0.5 mm")], [], "mesh[1].pinion_teeth", "given by module"),
    ([(("mesh", 0, "grade"), 7)], [("mesh", 0, "pitch")], "mesh[1].grade", "given gears"),
    ([(("mesh", 0, "wheel_pitch"), "9 um")], [], "mesh[1].wheel_pitch", "beside pitch"),
    ([(("train", "wheel_tip_diameters"), ["80 mm"])], [], "train.wheel_tip_diameters", "both"),
    (
        [(("train", "ratio"), [47, 49]), (("train", "ratio_tolerance"), "1 %")],
        [],
        "train.ratio_tolerance",
        "beside a range",
    ),
    (
        [(("stiffness", "youngs_modulus"), "206 GPa")],
        [],
        "stiffness.youngs_modulus",
        "beside line_stiffness",
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


def test_tolerances_alone_need_given_gears():
    lone = dump({k: v for k, v in tomllib.loads(EXAMPLE).items()
                 if k in ("gearopt", "kind", "mesh", "tolerances")})  # fmt: skip
    with pytest.raises(SceneError, match="without .train. tolerances are for given gears"):
        read(lone.encode())
