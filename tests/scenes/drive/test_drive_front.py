"""What `gearopt pareto` says of drives that have no such front."""

from pathlib import Path

import pytest

import gearopt

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
