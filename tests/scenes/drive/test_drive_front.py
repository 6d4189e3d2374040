"""What `gearopt pareto` says of drives: why one has no such front, how losses are computed."""

from pathlib import Path

import pytest

import gearopt
from gearopt.report.front import decided

PROBLEMS = Path(__file__).parents[3] / "problems"


@pytest.mark.parametrize(
    ("name", "objectives", "words"),
    [
        ("elevator", "gear_volume,mass", r'needs a density, as in \[objective\] density = "7.85'),
        ("elevator", "gear_volume,cost", "needs the price of every stage's materials"),
        ("elevator", "gear_volume,mesh_los", r"did you mean mesh_loss\?"),
        ("shigley_14_4", "gear_volume,mesh_loss", "gearopt rate FILE"),
        ("six_cylinders", "volume,area", "no objectives to weigh"),
    ],
)
def test_what_is_missing_is_said_in_one_line(name, objectives, words):
    with pytest.raises(gearopt.SolveError, match=words) as told:
        gearopt.pareto(PROBLEMS / f"{name}.toml", objectives=objectives)
    assert "\n" not in str(told.value)


def test_an_impossible_drive_has_an_impossible_front_and_the_command_that_explains(here):
    path = PROBLEMS / "elevator_small_wheels.toml"
    found = here("pareto", path, "--objectives", "gear_volume,mesh_loss")
    assert found.returncode == 3 and f"gearopt explain {path}" in found.stdout.replace("\n", "")


FORMULA = "0.06 π (1/z1 + 1/z2) of the input power a stage"


@pytest.mark.parametrize("minimised", ["mesh_loss", "gear_volume"])
def test_the_formula_of_a_mesh_loss_is_told_beside_its_optimum(minimised):
    known = gearopt.solve(PROBLEMS / "elevator.toml", {"objective.minimise": minimised})
    told = [note for note in known.report["notes"] if FORMULA in note]
    assert len(told) == (minimised == "mesh_loss") == (FORMULA in known.to_html())
    assert all("not checked against any source" in note for note in told)


@pytest.mark.parametrize("second", ["mesh_loss", "total_length"])
def test_the_formula_of_a_mesh_loss_is_told_beside_a_front_of_it(second):
    """The objectives of the front count, not the one that the file minimises."""
    changes = {"objective.minimise": "mesh_loss"}
    front = gearopt.pareto(PROBLEMS / "elevator.toml", changes, objectives=["gear_volume", second])
    told = [line for line in decided(front) if FORMULA in line]
    assert len(told) == (second == "mesh_loss") == (FORMULA in front.to_html())
    assert all("not checked against any source" in line for line in told)
