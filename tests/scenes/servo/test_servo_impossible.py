"""Servo axes that no train can do: what is named, what is proposed, and what a stop leaves."""

import re
from dataclasses import replace
from decimal import Decimal

import pytest
from scene_files import dump, parse
from servo_files import BARE, NARROW, PROBLEMS, RATIO, STIFF, changed, solved, text
from typer.testing import CliRunner

import gearopt
from gearopt.cli import app
from gearopt.formulations.servo import choice
from gearopt.formulations.servo.servo_design import ServoDesign, ServoReport
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.report.answer import proof, summary
from gearopt.report.measures import METRIC
from gearopt.scenes.servo import KIND
from gearopt.scenes.servo.explain import remedies
from gearopt.scenes.servo.notes import notes
from gearopt.scenes.servo.reach import reached

EXAMPLE = KIND.example.text


@pytest.mark.slow
def test_a_stiff_train_with_wheel_tips_below_a_tooth_is_impossible():
    tips = (("train", "wheel_tip_diameters"), ["1 mm", "1 mm"])
    result = solved(STIFF, tips)
    stiff = next(part for part in result.parts if part.name == "stiff")
    assert result.status == stiff.status == "infeasible"


def test_a_look_for_a_box_stops_in_time():
    tight = (*NARROW, (("space", "height"), "95 mm"))
    scene = changed(EXAMPLE, *tight, drop=BARE)
    result = gearopt.solve(choice.train_problem(scene.choice()), budget=Budget(seconds=0.0))
    assert result.status == "limit" and result.value is None


@pytest.mark.slow
def test_tolerances_beyond_the_error_of_the_file_are_named():
    """Three standard deviations within the limit, the worst case above it."""
    edits = ((("budget", 0), {"rule": "mean_plus_sd"}),)
    result = solved(EXAMPLE, *edits, drop=[("space",), ("lightest",)])
    assert result.design["drawn"]["worst_case_deg"] > 0.12
    assert any(
        "tolerances at their limits the error is 0.16109" in note for note in result.report["notes"]
    )


@pytest.mark.slow
def test_the_wider_error_that_is_proposed_is_the_least():
    explained = gearopt.explain(PROBLEMS / "servo_gimbal_impossible.toml")
    assert {"error", "wheel_tip_diameter[2]"} <= set(explained.conflict)
    least, even, *_ = explained.remedies
    assert least.changes[0].write == '"0.0979798 deg"' and least.bound < least.factor
    assert len(even.changes) == 14 and "pitch of stage 2" in explained.message


@pytest.mark.slow
@pytest.mark.parametrize(
    ("edits", "blamed", "words", "ways"),
    [
        (
            [(("train", "bending_stress"), "1 MPa")],
            {"bending_stress", "wheel_tip_diameter[2]"},
            "real-valued",
            {"train.bending_stress", "train.face_width", "train.output_torque"},
        ),
        (
            [(("train", "ratio"), 5000)],
            {"ratio_low", "wheel_tip_diameter[2]", "second_pinion_diameter_low"},
            "real-valued",
            set(),
        ),
        (
            [(("train", "ratio"), Decimal("47.98255")), (("train", "ratio_tolerance"), 0)],
            set(),
            "no whole teeth make the ratio within 0 %; within 0.0001 % some do",
            {"train.ratio_tolerance"},
        ),
    ],
)
def test_what_is_impossible_for_another_reason_is_said(edits, blamed, words, ways):
    explained = gearopt.explain(changed(text("gimbal_light"), *edits))
    assert explained.result.status == "infeasible"
    assert ways <= {way.what for way in explained.remedies}
    assert all(way.verified["with"] == "feasible" for way in explained.remedies)
    assert "the cause is not the accuracy alone" in explained.message and words in explained.message
    assert blamed <= set(explained.conflict) and "error" not in explained.conflict
    assert bool(blamed) == bool(explained.conflict)


FEW = (
    (("train", "modules"), ["0.5 mm"]),
    (("train", "pinion_teeth"), [20, 26]),
    (("accuracy", "error"), "0.3 deg"),
)
PLAIN = [("lightest",), ("tolerances",), ("budget",), ("cost",)]


def possible(scene):
    return gearopt.solve(choice.train_problem(scene.choice())).status == "optimal"


@pytest.mark.slow
def test_a_box_that_no_train_fits_is_told_with_the_smallest_one():
    edits = (*FEW, (("space", "width"), "40 mm"))
    scene = changed(EXAMPLE, *edits, drop=[*PLAIN, ("stiffness",)])
    result = gearopt.solve(scene)
    assert result.status == "infeasible" and "fits the box" in result.message
    found = result.report["ways_out"]
    there, too_small = re.findall(r"([\d.]+) mm x ([\d.]+) mm", found["message"])
    assert float(too_small[0]) == pytest.approx(float(there[0]), rel=1e-3)
    for sides, fits in ((there, True), (too_small, False)):
        width, height = (f"{side} mm" for side in sides)
        edits = (*FEW, (("space", "width"), width), (("space", "height"), height))
        assert possible(changed(EXAMPLE, *edits, drop=[*PLAIN, ("stiffness",)])) == fits
    (way,) = (w for w in found["remedies"] if w["what"] == "space.width")
    write = way["changes"][0]["write"].strip('"')
    assert way["bound"] < way["factor"] < 1.0006 * way["bound"]
    edits = (*FEW, (("space", "width"), write))
    assert possible(changed(EXAMPLE, *edits, drop=[*PLAIN, ("stiffness",)]))


def test_a_frequency_that_no_train_has_is_told_with_the_highest_one():
    drop, asked = [*PLAIN, ("space",)], (("stiffness", "frequency"), "5 kHz")
    (words,) = reached(changed(EXAMPLE, *FEW, asked, drop=drop), Clock())
    highest = float(re.search(r", ([\d.]+) Hz", words)[1])
    for factor, there in ((1.0 - 1e-4, True), (1.0 + 1e-4, False)):
        asked = (("stiffness", "frequency"), f"{highest * factor:.8g} Hz")
        assert possible(changed(EXAMPLE, *FEW, asked, drop=drop)) == there


@pytest.mark.slow
def test_the_highest_frequency_is_proposed():
    drop, asked = [*PLAIN, ("space",)], (("stiffness", "frequency"), "5 kHz")
    result = gearopt.solve(changed(EXAMPLE, *FEW, asked, drop=drop))
    assert result.status == "infeasible" and "stiffness that is required" in result.message
    found = result.report["ways_out"]
    least, highest = found["remedies"][0], float(re.search(r", ([\d.]+) Hz", found["message"])[1])
    assert least["what"] == "stiffness.frequency" and least["kind"] == "least"
    assert float(least["changes"][0]["write"].strip('"').split()[0]) <= highest


@pytest.mark.slow
def test_every_number_that_helps_alone_is_least_and_a_module_is_added():
    """Tip diameters, bore, teeth and modules: what is proposed is possible, a little less not."""
    tips = (("train", "wheel_tip_diameters"), ["80 mm", "84 mm"])
    explained = gearopt.explain(changed(text("gimbal_light"), tips))
    ways = {way.what: way for way in explained.remedies}
    assert {"accuracy.error", "train.wheel_tip_diameters[2]"} <= ways.keys()
    for way in explained.remedies:
        assert way.verified["with"] == "feasible"
        assert way.verified.get("with_less", "infeasible") == "infeasible"
    few = (("train", "modules"), ["1.25 mm"])
    explained = gearopt.explain(changed(text("gimbal_light"), few))
    assert any(way.what == "train.modules" for way in explained.remedies)


@pytest.mark.slow
def test_the_reason_of_an_impossible_duty_is_told_once(tmp_path):
    """Eta T^2 < 4 b F_L."""
    content = parse(RATIO)
    content["motor"]["no_load_speed"], content["load"]["friction"] = "5 rad/s", "1 N m"
    content["duty"] = {"motion": "acceleration", "load_speed": "1 rad/s"}
    file = tmp_path / "duty.toml"
    file.write_text(dump(content), encoding="utf-8")
    shown = CliRunner().invoke(app, ["explain", str(file)])
    assert " ".join(shown.output.split()).count("never exceeds the load's friction") == 1


def test_a_run_out_of_time_says_so():
    result = gearopt.solve(changed(EXAMPLE), budget=Budget(seconds=0.0))
    assert result.status == "limit" and result.value is None and result.bound is None
    assert result.message == "stopped by the budget" and "ways_out" not in result.report
    assert {p.name: p.status for p in result.parts} == {"ratio": "optimal", "stiff": "limit"}
    assert gearopt.Result.from_json(result.to_json()).status == "limit"


def test_time_that_ran_out_is_no_reason_of_its_own():
    scene = changed(text("gimbal_impossible"))
    for clock in (Clock(Budget(seconds=0.0)), Clock(Budget(), lambda event: False)):
        found = remedies(scene, clock)
        assert (found.conflict, found.remedies) == ((), ())
        assert found.message.startswith("time ran out")


def test_a_stop_ends_the_look_for_ways_out():
    """The least error is found; from then on the user wants no more."""
    seen = []

    def watch(event):
        seen.append(event)
        return len(seen) < 8

    clock = Clock(Budget(), watch)
    found = remedies(changed(text("gimbal_impossible")), clock)
    assert clock.stopped and all(r.verified["with"] == "feasible" for r in found.remedies)
    assert len(found.remedies) < 2


def test_a_message_with_a_stop_gets_no_second_one():
    result = gearopt.solve(changed(RATIO))
    late = replace(result, status="limit", message="Bound of ratio is violated by 1.01.")
    assert "Bound of ratio is violated by 1.01." in summary(late, METRIC).words
    ratio = replace(late, objective={"name": "ratio"})
    note = notes(changed(RATIO), (result, ratio), ServoDesign(), ServoReport())
    assert note == ["There is no answer for the part ratio: Bound of ratio is violated by 1.01."]


def test_limits_and_conflicts_of_tolerances_are_named():
    """One row a deviation; tolerances that use up the budget alone are said."""
    tight = (("tolerances", "least_factor"), Decimal("0.9"))
    result = gearopt.solve(changed(text("gimbal_tolerances"), tight))
    assert result.limits["least of pitch of stage 2"] == pytest.approx(1.0, abs=1e-6)
    assert not any("[" in name for name in result.limits)
    none = gearopt.solve(
        changed(text("gimbal_tolerances"), tight, (("budget", 0, "limit"), "0.05 deg"))
    )
    assert none.status == "infeasible"
    assert "pitch of stage 2" in proof(none)[0] and "alone use up the budget" in proof(none)[0]
