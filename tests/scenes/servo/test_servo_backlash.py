"""Two-sided allowances and minimum backlash: by hand, by drawn deviations, by one-sided files."""

import math
from dataclasses import asdict, replace

import numpy as np
import pytest
from servo_files import TOLERANCES, changed, text

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations.servo.choice import train_problem
from gearopt.optimise.clock import Clock
from gearopt.report.explained import remedy_words
from gearopt.report.headline import lead
from gearopt.scenes.servo.backlash import binds

TAN = math.tan(math.radians(20.0))
FILE = text("gimbal_backlash")
ONE_SIDED = [
    ((("mesh", 0, "pinion_thickness"), "0.03 mm"), (("mesh", 1, "pinion_thickness"), "0.035 mm")),
    ((("mesh", 0, "wheel_thickness"), "0.04 mm"), (("mesh", 1, "wheel_thickness"), "0.045 mm")),
    ((("mesh", 0, "centre_distance"), "0.005 mm"), (("mesh", 1, "centre_distance"), "0.006 mm")),
]


def posed(scene):
    return gearopt.solve(train_problem(scene.choice()))


def test_backlash_by_hand():
    scene = changed(FILE)
    by_hand = (20 + 15 - 2 * TAN * 7.5, 70 + 2 * TAN * 10), (45 - 2 * TAN * 12, 80 + 2 * TAN * 18.5)
    for stage, ends in enumerate(by_hand, 1):
        assert [1e3 * end for end in scene.backlash(stage)] == pytest.approx(ends, rel=1e-12)


def test_drawn_deviations_stay_within_and_come_near_both_ends():
    """By the formula of ISO 21771 in the test's own words, not by sources of the scene."""
    rng = np.random.default_rng(1)
    n = 400_000
    apart = rng.uniform(-5, 6, n) + rng.uniform(0, 2.5, n) + rng.uniform(0, 3, n)
    apart += 3 * np.cos(rng.uniform(0, 7, n)) + 4 * np.cos(rng.uniform(0, 7, n))
    thinner = rng.uniform(20, 35, n) + rng.uniform(25, 45, n)
    drawn = thinner + 2 * TAN * apart
    low, high = (1e3 * end for end in changed(FILE).backlash(2))
    assert low <= drawn.min() < low + 0.25 * (high - low)
    assert high - 0.25 * (high - low) < drawn.max() <= high


@pytest.mark.parametrize(
    ("stage", "write", "there"),
    [(1, "0.0295 mm", True), (1, "0.0296 mm", False), (2, "36.2 um", True), (2, "36.3 um", False)],
)
def test_a_minimum_backlash_is_kept_or_refused_by_name(stage, write, there):
    found = posed(changed(FILE, (("mesh", stage - 1, "minimum_backlash"), write)))
    assert (found.status == "optimal") == there
    if not there:
        assert found.status == "infeasible" and f"backlash of stage {stage}" in found.message
        assert found.proof["conflict"] == [f"minimum_backlash[{stage}]"]


def test_the_answer_is_that_of_one_sided_deviations_of_the_same_worst_case():
    edits = [edit for pair in ONE_SIDED for edit in pair]
    drop = [("mesh", k, "minimum_backlash") for k in (0, 1)]
    assert posed(changed(FILE, *edits, drop=drop)).value == posed(changed(FILE)).value


def test_what_is_proposed_keeps_the_gears_from_binding():
    scene = changed(FILE, (("mesh", 0, "minimum_backlash"), "0.034 mm"))
    found = binds(scene, Clock())
    assert found.conflict == ("minimum_backlash[1]",)
    assert {way.what.rpartition(".")[2] for way in found.remedies} == {
        "minimum_backlash", "centre_distance", "pinion_thickness", "wheel_thickness",
    }  # fmt: skip
    for way in found.remedies:
        assert way.verified["with"] == "feasible" and way.verified["with_less"] == "infeasible"


@pytest.mark.parametrize(
    ("text", "ends"),
    [
        ("+0.02/-0.01 mm", (-0.01, 0.02)),
        ("-0.01 mm / +0.02 mm", (-0.01, 0.02)),
        ("±0.01 mm", (-0.01, 0.01)),
        ("+/- 10 um", (-0.01, 0.01)),
        ("-10/+20 um", (-0.01, 0.02)),
        (["0.02 mm", "-0.01 mm"], (-0.01, 0.02)),
    ],
)
def test_two_allowances_are_read(text, ends):
    mesh = changed(FILE, (("mesh", 0, "centre_distance"), text)).mesh[0]
    assert mesh.opening("centre_distance") == pytest.approx(ends, rel=1e-15)


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("mesh", 0, "centre_distance"), ["0.01 mm", "0.01 mm"]),
        (("mesh", 0, "centre_distance"), ["0.01 mm"]),
        (("mesh", 0, "centre_distance"), "-0.01 mm"),
        (("mesh", 0, "pinion_thickness"), "+0.9/+0.8 mm"),
        pytest.param(("mesh", 0, "centre_distance"), "1" * 9999 + " mm", id="many digits"),
    ],
)
def test_what_are_no_allowances_is_refused(place, value):
    with pytest.raises(SceneError) as wrong:
        changed(FILE, (place, value))
    assert wrong.value.key.startswith("mesh[1].")


@pytest.mark.slow
def test_tolerances_keep_the_lower_ends_and_the_minimum_backlash():
    """Run-outs of both stages end where the minimum backlash does; errors are drawn by hand."""
    edits = [(("mesh", 0, "centre_distance"), ["0.004 mm", "0.010 mm"])]
    base = gearopt.solve(changed(TOLERANCES, *edits, (("accuracy", "error"), "0.2 deg")))
    held = (("mesh", 0, "minimum_backlash"), "0.0025 mm")
    result = gearopt.solve(changed(TOLERANCES, *edits, held, (("accuracy", "error"), "0.2 deg")))
    assert base.status == result.status == "optimal" and result.value > base.value
    assert result.limits["minimum_backlash[1]"] == pytest.approx(1.0, abs=1e-7)
    rows = {row["name"]: row for row in result.design["tolerances"]}
    turning = rows["bearing run-out of wheel 1"]["new_mm"]
    assert 2 * TAN * (0.004 - turning) == pytest.approx(0.0025, rel=1e-6)
    start = (
        2 * TAN * 0.004 * rows["bearing run-out of wheel 1"]["sensitivity_deg_per_mm"] / (2 * TAN)
    )
    worst = start + sum(r["sensitivity_deg_per_mm"] * r["new_mm"] for r in rows.values())
    assert result.report["new_worst_case_deg"] == pytest.approx(worst, rel=1e-9)
    assert worst == pytest.approx(0.2, rel=1e-6)
    drawn = result.design["drawn"]
    assert drawn["worst_case_deg"] == pytest.approx(worst, rel=1e-9)
    assert start < drawn["mean_deg"] < worst and drawn["largest_deg"] <= worst
    none = changed(TOLERANCES, *edits, (("mesh", 0, "minimum_backlash"), "0.003 mm"))
    assert gearopt.solve(none).status == "infeasible"


def test_the_utilisation_is_required_over_actual():
    """16 of 29.54 µm in stage 1, by hand."""
    found = posed(changed(FILE, (("mesh", 0, "minimum_backlash"), "0.016 mm")))
    assert found.limits["minimum_backlash[1]"] == pytest.approx(16 / (35 - 15 * TAN), rel=1e-12)


@pytest.mark.slow
def test_both_stages_are_moved_together():
    both = [(("mesh", k, "minimum_backlash"), "0.08 mm") for k in (0, 1)]
    found = binds(changed(FILE, *both), Clock())
    assert found.remedies and {len(way.changes) for way in found.remedies} == {2}
    for way in found.remedies:
        assert way.verified["with"] == "feasible" and way.verified["with_less"] == "infeasible"
    told = lead(replace(posed(changed(FILE, *both)), scene="servo"))
    assert told == (
        "the limits on minimum backlash of stages 1 and 2 cannot be met with what else the file "
        "gives, even if all other limits are dropped"
    )


def test_a_page_proposes_them():
    scene = changed(FILE, (("mesh", 0, "minimum_backlash"), "0.034 mm"))
    rows, _ = remedy_words(asdict(binds(scene, Clock())))
    assert [row[1] for row in rows][:1] == ['mesh[1].minimum_backlash = "0.0295 mm"']
