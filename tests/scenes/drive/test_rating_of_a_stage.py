"""Overload and safety factors that a stage has of its own, in place of those of [rating]."""

import re
import tomllib
from functools import cache
from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.report.kinds.drive.rating_words import tiles
from gearopt.report.measures import METRIC

PROBLEMS = Path(__file__).parents[3] / "problems"
ELEVATOR = (PROBLEMS / "elevator_by_both.toml").read_text().partition("[x-expected]")[0]
ELEVATOR = ELEVATOR.replace("pinion_teeth = [20, 40]", "pinion_teeth = [20, 24]")
GIVEN = (PROBLEMS / "catalogue_pair.toml").read_text().partition("[x-expected]")[0]


def of_stages(text, *lines):
    """A file with a line of its own in every table [[stage]]."""
    first, *stages = text.split("[[stage]]\n")
    each = [f"[[stage]]\n{line}\n{rest}" for line, rest in zip(lines, stages, strict=True)]
    return first + "".join(each)


def of_rating(text, line):
    """A file with a line of [rating] in the place of the one it may have."""
    key = line.split(" = ")[0]
    return re.sub(rf"^{key} = .*\n", "", text, flags=re.M).replace(
        "[rating]\n", f"[rating]\n{line}\n"
    )


@cache
def solved(text):
    return gearopt.solve(tomllib.loads(text))


@pytest.mark.slow
def test_factors_of_every_stage_are_those_of_the_rating():
    lines = "overload_factor = 1.5", "minimum_contact_safety = 1.3", "minimum_bending_safety = 5"
    whole = ELEVATOR
    for line in lines:
        whole = of_rating(whole, line)
    by_stage, whole = solved(of_stages(ELEVATOR, *["\n".join(lines)] * 2)), solved(whole)
    assert by_stage.status == whole.status == "optimal"
    assert by_stage.value == pytest.approx(whole.value, rel=1e-13)
    assert by_stage.limits.keys() == whole.limits.keys()
    for name, used in whole.limits.items():
        assert by_stage.limits[name] == pytest.approx(used, rel=1e-12)


STRICTER = of_stages(ELEVATOR, "minimum_contact_safety = 1.3", "# as [rating]")


@pytest.mark.slow
def test_one_stage_of_its_own_lies_between():
    """Stricter on one stage than on none, less strict than on both; the limits say which."""
    first, none = solved(STRICTER), solved(ELEVATOR)
    both = solved(of_rating(ELEVATOR, "minimum_contact_safety = 1.3"))
    assert none.value < first.value < both.value
    gears = first.design["rating"]["beside"]["gears"]
    for gear in gears:
        asked = 1.3 if gear["stage"] == 1 else 1.0
        name = f"{gear['member']}_contact_iso[{gear['stage']}]"
        assert first.limits[name] == pytest.approx(asked / gear["contact_safety"], rel=1e-12)
        assert first.limits[name] <= 1.0 + 1e-9


@pytest.mark.slow
def test_key_figures_name_what_is_nearest_where_requirements_differ():
    differing, same = (
        [tile.name for tile in tiles(solved(t), METRIC)] for t in (STRICTER, ELEVATOR)
    )
    assert "S_H nearest to that required, contact by ISO 6336" in differing
    assert "minimum S_H, contact by ISO 6336" in same


def test_given_gears_are_rated_with_them(tmp_path):
    path = tmp_path / "file.toml"
    path.write_text(of_stages(GIVEN, "overload_factor = 2\nminimum_bending_safety = 3"))
    own = gearopt.rate(path)
    path.write_text(of_rating(GIVEN, "overload_factor = 2"))
    whole = gearopt.rate(path)
    (a, _), (b, _) = (r.design["rating"]["gears"] for r in (own, whole))
    assert a["bending_safety"] == b["bending_safety"]
    assert own.limits["pinion_bending[1]"] == pytest.approx(3.0 / a["bending_safety"], rel=1e-12)


@pytest.mark.slow
def test_real_valued_sizes_take_them():
    line = "minimum_contact_safety = 1.3"
    text = (PROBLEMS / "sized_and_rated.toml").read_text().partition("[x-expected]")[0]
    text = re.sub(r"\[teeth\]\n(?:[^\[\n].*\n)*", "", text)
    count = text.count("[[stage]]\n")
    by_stage = solved(of_stages(text, *[line] * count))
    whole = solved(of_rating(text, line))
    assert by_stage.value == pytest.approx(whole.value, rel=1e-6)
    assert by_stage.bound <= whole.value * (1.0 + 1e-9)


def test_without_a_rating_they_are_refused(tmp_path):
    path = tmp_path / "file.toml"
    text = (PROBLEMS / "elevator.toml").read_text().partition("[x-expected]")[0]
    path.write_text(text.replace("[[stage]]\n", "[[stage]]\noverload_factor = 1.5\n", 1))
    with pytest.raises(SceneError, match=r"stage\[1\].overload_factor.*needs a table \[rating\]"):
        gearopt.load(path)
