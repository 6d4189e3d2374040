"""Names of a servo axis's report: the counts of its enumeration, and that the page explains all."""

import json
import re
from pathlib import Path

import pytest
from campaigns import few
from scene_files import dump, parse

import gearopt
from gearopt.formulations.servo.servo_design import ServoDesign, ServoReport
from gearopt.optimise.result import Budget
from gearopt.optimise.typed import typed, untyped
from gearopt.report.answer import proof
from gearopt.scenes.reading.load import read
from gearopt.scenes.servo import posed

ROOT = Path(__file__).parents[3]
PROBLEMS = ROOT / "problems"
OWN = {"assumptions", "notes", "ways_out"}  # of every kind of file


def scene(name, **train):
    content = parse((PROBLEMS / f"servo_{name}.toml").read_text(encoding="utf-8"))
    content["train"] |= train
    return read(dump(content).encode(), "my.toml")[1]


def told(result):
    return json.loads(result.to_json())["report"]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "feasible"), [("gimbal", 62054), ("gimbal_light", 247948)])
def test_enumeration_counts_every_train(name, feasible):
    """6,326,052 trains of the right ratio; with 0.1082 and 0.12 degrees so many are feasible."""
    result = gearopt.solve(scene(name), method="enumeration")
    assert result.status == "optimal" and result.method == "enumeration"
    report = told(result)
    assert (report["combinations"], report["feasible_trains"]) == (6_326_052, feasible)
    words = f"6,326,052 choices of teeth and modules examined, {feasible:,} meet all limits;"
    assert words in " ".join(proof(result))
    assert result.value == pytest.approx(gearopt.solve(scene(name)).value, rel=1e-12)


def test_pruned_search_counts_no_feasible_trains(solved):
    assert "combinations" not in told(solved("servo_gimbal_stiff"))


@pytest.mark.slow
def test_what_an_enumeration_does_not_look_at_is_said():
    result = gearopt.solve(scene("gimbal_stiff"), method="enumeration")
    assert result.value == pytest.approx(gearopt.solve(scene("gimbal_stiff")).value, rel=1e-12)
    assert result.proof["not_counted"] == ["stiffness"]
    assert "meet all limits but stiffness;" in " ".join(proof(result))
    assert told(result)["feasible_trains"] >= 1


def test_enumeration_may_be_compared():
    assert {"exact", "enumeration"} <= posed(scene("gimbal_stiff"), "exact").problem.methods.keys()
    found = gearopt.compare(
        scene("gimbal_stiff"),
        methods=("exact", "enumeration"),
        seeds=1,
        evaluations=10**7,
        seconds=1.0,
    )
    assert found is not None


@pytest.mark.slow
def test_the_least_error_that_fits_the_box():
    """0.11707 degrees with 18/94 and 23/210 teeth; docs/servo_train.md."""
    report = told(gearopt.solve(scene("gimbal_fine", minimise="error"), budget=Budget(seconds=60)))
    assert report["chosen_error_deg"] == pytest.approx(0.11707, abs=6e-6)
    assert report["needed_width_mm"] <= 80.0 and report["needed_height_mm"] <= 130.0


NAMES = ("gimbal", "gimbal_stiff", "gimbal_move", "gimbal_swing", "gimbal_grades", "gimbal_fine")


@pytest.mark.parametrize("name", few(NAMES, 5))
def test_the_page_explains_every_name(name, solved):
    page = (ROOT / "docs" / "servo.md").read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    explained = set(re.findall(r"`(\w+)`", " ".join(rows)))
    result = solved(f"servo_{name}")
    names = {k.removesuffix("_with_train") for k in told(result)}
    assert len(names) > 4 and names - OWN <= explained | {"best_total_ratio"}
    plain = result.to_dict()
    assert untyped(typed(ServoDesign, plain["design"])) == plain["design"]
    report = ServoReport.from_dict(plain["report"])
    assert report.to_dict().items() <= plain["report"].items() and len(report.figures) > 3
