"""The command `rate`: its exit code, files and JSON; the file that `gearopt new rating` prints."""

import json
from pathlib import Path

import pytest

import gearopt
from gearopt.scenes.reading.load import examples

PROBLEMS = Path(__file__).parents[2] / "problems"
PAIR = PROBLEMS / "catalogue_pair.toml"


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    path = tmp_path_factory.mktemp("kept") / "pair.json"
    path.write_text(gearopt.rate(PAIR).to_json(), encoding="utf-8")
    return path


def test_the_new_file_is_safe_as_it_is_printed(tmp_path, here):
    printed = here("new", "rating").stdout
    assert printed == examples()["rating"]
    path = tmp_path / "p.toml"
    path.write_text(printed, encoding="utf-8")
    assert here("check", path).stdout == f"{path}: a valid drive file\n"
    said = here("rate", path, "--json")
    result = gearopt.Result.from_json(said.stdout)
    assert said.returncode == 0 and said.stderr == "" and result.feasible
    assert result.design["rating"]["safe"] and "flaws" not in result.design["rating"]
    assert max(result.limits.values()) > 0.7  # not idle


@pytest.mark.parametrize("other", ["helix_angle", "centre_distance"])
def test_every_line_of_the_new_file_works_uncommented(other, tmp_path, here):
    """Keys and tables that stand behind a # are right ones; the distance is that of spur gears."""
    lines = examples()["rating"].splitlines()
    bare = [line if line.startswith(f"# {other}") else line.removeprefix("# ") for line in lines]
    path = tmp_path / "p.toml"
    path.write_text("\n".join(bare).replace('"30 %"', '"100 %"'), encoding="utf-8")
    said = here("rate", path, "--json")
    assert said.returncode == 0, said.stderr
    rating = json.loads(said.stdout)["design"]["rating"]
    factors = {f["symbol"]: f for f in rating["factors"]}
    assert factors["K_m"]["source"] == factors["J"]["source"] == "given"
    assert rating["levels"]
    assert all("overlap ratio" in flaw for flaw in rating.get("flaws", ()))  # 0.8: as it is told
    assert rating["efficiency_percent"] > 98.0


def test_not_safe_is_an_answer_too(tmp_path, here):
    path = tmp_path / "p.toml"
    text = PAIR.read_text(encoding="utf-8").replace('"30 kW"', '"90 kW"')
    path.write_text(text, encoding="utf-8")
    said = here("rate", path)
    assert said.returncode == 0 and said.stderr == ""
    assert not gearopt.rate(path).feasible
    said = here("rate", path, "--json")
    assert said.returncode == 0 and json.loads(said.stdout)["design"]["rating"]["safe"] is False
    path.write_text(PAIR.read_text(encoding="utf-8").replace('"120.5 mm"', '"119 mm"'), "utf-8")
    assert here("rate", path, "--json").returncode == 3  # no answer of use: they do not fit


def test_json_comes_back_as_it_went(kept, here, tmp_path):
    result, again = gearopt.rate(PAIR), gearopt.Result.from_json(kept.read_text(encoding="utf-8"))
    assert again.design == result.design and again.limits == result.limits
    assert again.status == "evaluated" and again.value is None and again.scene == "drive"
    shown, live = here("report", kept), here("rate", PAIR)
    assert shown.returncode == live.returncode == 0

    def numbers(text):
        return text.splitlines()[:-1]  # the last line has the time it took

    assert numbers(shown.stdout) == numbers(live.stdout)
    page = tmp_path / "pair.html"
    assert here("report", kept, "--html", page).returncode == 0 and page.stat().st_size > 10_000


def test_inches_are_for_people_and_json_names_its_units(here):
    said = here("rate", PAIR, "--units", "inch", "--json")
    assert said.returncode == 2 and "changes nothing of --json" in said.stderr
    assert here("rate", PAIR, "--units", "inch").returncode == 0


def test_a_table_of_files(tmp_path, here):
    room = tmp_path / "csv"
    assert here("rate", PAIR, "--csv", room).returncode == 0
    names = {path.stem for path in room.glob("*.csv")}
    assert names and all((room / f"{name}.csv").stat().st_size for name in names)


def test_the_schema_of_a_drive_has_the_tables_of_a_rating(here):
    schema = json.loads(here("schema", "drive").stdout)
    assert {"rating", "load"} <= schema["properties"].keys()
    rating = schema["$defs"]["RatingTable"]["properties"]
    assert {"standard", "life", "quality", "given"} <= rating.keys()
    assert {"treatment", "profile_shift"} <= schema["$defs"]["GearTable"]["properties"].keys()
    assert "[[load]]" in here("schema", "drive", "--table").stdout


def test_changes_from_python():
    plain, wider = (gearopt.rate(PAIR, changes) for changes in ({}, {"rating.life": "1000 h"}))
    assert max(wider.limits.values()) < max(plain.limits.values())
