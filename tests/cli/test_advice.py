"""What `solve` says first and last of drives that ratings size."""

import pytest
import typer

from gearopt.api import solve
from gearopt.cli.answering import solve as solve_command
from gearopt.optimise.result import Result
from gearopt.report.answer import decided, meaning
from gearopt.report.words import certainty

PAIR = """gearopt = 1
kind = "drive"
[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
ratio = 4
[gears]
treatment = "carburised"
face_width_over_diameter = 0.6
[[stage]]
[limits]
pinion_teeth = [20, 24]{more}
[teeth]
[rating]
life = "20000 h"
quality = 8
"""


@pytest.fixture
def pair(tmp_path):
    """Write the file of a pair with more limits."""

    def write(more=""):
        path = tmp_path / "pair.toml"
        path.write_text(PAIR.replace("{more}", more), encoding="utf-8")
        return path

    return write


def test_an_impossible_file_without_remedies_names_the_command_that_finds_them(pair, capsys):
    path = pair('\nwheel_diameter = "60 mm"')
    with pytest.raises(typer.Exit) as ended:
        solve_command(path)
    assert ended.value.exit_code == 3
    told = " ".join(capsys.readouterr().out.split())
    assert told.endswith(f"What to write instead: gearopt explain {path}")


def test_a_possible_file_has_no_advice(pair, capsys):
    with pytest.raises(typer.Exit) as ended:
        solve_command(pair())
    assert ended.value.exit_code == 0
    assert "gearopt explain" not in capsys.readouterr().out


def test_teeth_at_an_end_of_their_range_are_reached_and_not_said_to_decide(pair):
    result = solve(pair())
    first = decided(result)
    assert result.limits["pinion_teeth_low[1]"] == 1.0
    assert "active" in first and "determine" not in first and "no limit" not in first


@pytest.mark.parametrize(
    ("bound", "told"), [(None, "locally optimal (no bound)"), (0.9, "locally optimal")]
)
def test_a_local_optimum_with_a_bound_is_not_said_to_have_none(bound, told):
    objective = {"name": "volume", "value": 1.0, "unit": "mm3"}
    result = Result("drive", "stationary", "smooth", objective, bound)
    assert certainty(result)[0] == told and "first and second order" in meaning(result)
