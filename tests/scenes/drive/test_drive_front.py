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


@pytest.mark.slow
@pytest.mark.parametrize("second", ["mesh_loss", "total_length"])
def test_the_formula_of_a_mesh_loss_is_told_beside_a_front_of_it(second):
    """The objectives of the front count, not the one that the file minimises."""
    changes = {"objective.minimise": "mesh_loss"}
    front = gearopt.pareto(PROBLEMS / "elevator.toml", changes, objectives=["gear_volume", second])
    told = [line for line in decided(front) if FORMULA in line]
    assert len(told) == (second == "mesh_loss") == (FORMULA in front.to_html())
    assert all("not checked against any source" in line for line in told)


PAIR = PROBLEMS / "minimum_volume_pair.toml"
CHOSEN = ("limits", "teeth", "shift", "stages", "x-expected")


@pytest.fixture(scope="module")
def rated_front():
    return gearopt.pareto(PAIR, objectives="gear_volume,mesh_loss")


def given_again(front, number):
    """The file of a front with the gears of a design as given ones."""
    rows = front.points[number - 1].design["stages"]
    tables = {key: value for key, value in front.asked.items() if key not in CHOSEN}
    own = front.asked.get("stage", [{}] * len(rows))
    stages = [
        {key: value for key, value in table.items() if "face_width" not in key}
        | {
            "module": f"{row['normal_module_mm']!r} mm",
            "face_width": f"{row['face_width_mm']!r} mm",
        }
        | {key: row[key] for key in ("pinion_teeth", "wheel_teeth")}
        for table, row in zip(own, rows, strict=True)
    ]
    return tables | {"stage": stages}


def test_a_design_of_a_front_is_rated_as_gears_that_are_given(rated_front):
    for number in (1, len(rated_front.points)):
        rated = gearopt.rate(rated_front, design=number)
        given = gearopt.rate(given_again(rated_front, number))
        assert rated.design["rating"] == given.design["rating"] and rated.feasible
        assert rated.limits == given.limits and rated.status == "evaluated"
    assert f"gearopt rate front.json --design {rated_front.picks[-1].place + 1}" in (
        rated_front.to_html()
    )


def test_a_design_that_a_front_has_not_is_one_clear_error(rated_front, tmp_path, here):
    count = len(rated_front.points)
    path = tmp_path / "front.json"
    path.write_text(rated_front.to_json(), encoding="utf-8")
    assert here("rate", path, "--design", count).returncode == 0
    result = here("rate", path, "--design", 1, "--json").stdout
    (tmp_path / "rating.json").write_text(result, encoding="utf-8")
    wrong = [
        (path, count + 1, f"no design {count + 1} of the front, from 1 to {count}"),
        (path, 0, "no design 0"),
        (PAIR, 1, "is not JSON"),
        (tmp_path / "rating.json", 1, "is no Pareto front"),
    ]
    for file, number, words in wrong:
        said = here("rate", file, "--design", number)
        assert said.returncode == 2 and words in said.stderr and said.stderr.count("\n") == 1


@pytest.mark.slow
def test_fronts_without_a_rating_are_refused():
    train = gearopt.pareto(
        PROBLEMS / "sandgren_train.toml", objectives="squared_error,largest_gear"
    )
    with pytest.raises(gearopt.SolveError, match='rated of kind = "drive"'):
        gearopt.rate(train, design=1)
    loads = gearopt.pareto(PROBLEMS / "elevator.toml", objectives="gear_volume,mesh_loss")
    with pytest.raises(gearopt.SolveError, match=r"no table \[rating\]"):
        gearopt.rate(loads, design=1)
    assert "--design" not in loads.to_html()
    with pytest.raises(gearopt.SolveError, match="name a design"):
        gearopt.rate(loads)
