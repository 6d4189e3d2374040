"""Tolerances of a servo axis's file: known costs, budgets and grades."""

import math
from decimal import Decimal

import numpy as np
import pytest
from campaigns import few
from servo_files import (
    PROBLEMS,
    TOLERANCES,
    changed,
    solved,
    text,
)

import gearopt


@pytest.mark.parametrize(
    ("rule", "exponent", "cost"),
    few(
        [
            ("worst_case", 2, 8.923521611),
            ("rss", Decimal("0.5"), 8.884275302),
            ("worst_case", Decimal("0.5"), 11.044978491),
            ("rss", 1, 6.872001013),
            ("rss", 2, 5.292125686),
        ],
        1,
    ),
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


@pytest.mark.slow
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


def test_grades_by_rss_known_independently():
    result = solved(text("gimbal_grades"), (("budget",), [{"rule": "rss"}]))
    assert result.value == pytest.approx(7.328427125, abs=6e-10)


@pytest.mark.parametrize(
    ("grade", "worst", "rss"),
    few([(7, 0.0897, 0.0526), (5, 0.0448, 0.0263), (6, 0.0634, 0.0372), (8, 0.1268, 0.0744)], 1),
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
