"""Files that minimise what is largest over the stages, beside the rating of the answer."""

from pathlib import Path

import pytest

import gearopt
from gearopt import SceneError, SolveError
from gearopt.report.words import goal

PROBLEMS = Path(__file__).parents[3] / "problems"
SMALL = {"limits.pinion_teeth": [20, 21], "limits.stage_ratio": [4.3, 5.1]}
SMALL |= {"teeth.modules": ["1.5 mm", "2 mm", "3 mm", "4 mm"]}


def least(name, **changes):
    return gearopt.solve(
        PROBLEMS / "elevator_by_agma.toml", SMALL | {"objective.minimise": name} | changes
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "rows", "key", "shown"),
    [
        ("axial_force", "meshes", "axial_force_N", ("axial force", "N")),
        ("specific_sliding", "teeth", "largest_specific_sliding", ("specific sliding", "")),
        ("inverse_contact_ratio", "meshes", "total_contact_ratio", ("contact ratio", "")),
    ],
)
def test_the_least_is_what_the_rating_of_the_answer_says(name, rows, key, shown):
    """Of the stage that has most; the title line names what is meant."""
    found = least(name)
    values = [row[key] for row in found.design["rating"][rows]]
    worst = max(values) if name == "axial_force" else abs(min(values))
    told, unit, value, bound, _ = goal(found)
    assert found.status == "optimal" and found.design["rating"]["safe"]
    assert value == pytest.approx(worst, rel=1e-12) and bound == pytest.approx(value, rel=1e-6)
    assert (told, unit) == shown
    assert any("Of designs up to this value" in note for note in found.report["notes"])


def test_spur_gears_have_no_axial_force_and_nothing_changes_that():
    changes = SMALL | {"objective.minimise": "axial_force", "gears.helix_angle": "0 deg"}
    found = gearopt.solve(PROBLEMS / "elevator_by_agma.toml", changes, prices=True)
    assert found.value == found.bound == 0.0 and found.status == "optimal"
    assert any("spur gears have none" in note for note in found.report["notes"])
    assert all(one["price"] is None for one in found.report["prices"]["influences"])
    names = ["gear_volume", "axial_force"]
    front = gearopt.pareto(PROBLEMS / "elevator_by_agma.toml", changes, objectives=names)
    assert front.status == "complete" and len(front.points) == 1


@pytest.mark.parametrize(
    ("stem", "changes", "words"),
    [
        ("elevator", {}, r"needs limits by \[rating\] alone"),
        ("elevator_by_agma", {"teeth": None}, r"needs a table \[teeth\]"),
        ("how_many_stages", {}, "needs one number of stages"),
        ("elevator_box_rated", {}, "sized before their layout"),
    ],
)
def test_where_an_extreme_is_not_minimised(stem, changes, words):
    changes = changes | {"objective.minimise": "axial_force"}
    with pytest.raises(SceneError, match=words):
        gearopt.solve(PROBLEMS / f"{stem}.toml", changes)


def test_words_that_are_near():
    with pytest.raises(SceneError, match='Write "inverse_contact_ratio"'):
        least("contact_ratio")
    with pytest.raises(SolveError, match="it is the second of two objectives"):
        names = ["axial_force", "specific_sliding"]
        gearopt.pareto(PROBLEMS / "elevator_by_agma.toml", objectives=names)
    with pytest.raises(SolveError, match="smooth takes real-valued teeth"):
        gearopt.solve(
            PROBLEMS / "elevator_by_agma.toml",
            {"objective.minimise": "axial_force"},
            method="smooth",
        )
