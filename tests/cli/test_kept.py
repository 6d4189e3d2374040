"""`report` of kept files that were edited: shown, or refused in one line; never a traceback."""

import csv
import json
import math
import random
from pathlib import Path

import pytest
import typer

import gearopt
from gearopt import Front
from gearopt.cli import reporting
from gearopt.cli.app import told
from gearopt.cli.reporting import report
from gearopt.errors import GearoptError
from gearopt.optimise.pareto.front import FrontPoint, Growth, Impossible
from gearopt.optimise.pareto.measures import Pick
from gearopt.optimise.pareto.objectives import Objective

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "docs" / "pictures"  # kept results of drives, layouts and packings
ODD = (
    *(None, True, -1, 0, 1, 3.7, 1e300, -1e300, 1e-300, 10**9, 10**30, 10**400),
    *("", "x", "\ud800", "<b>", [], [1], {}, {"a": 1}, [[1]], [{"a": 1}]),
)
KINDS = (
    *("drive", "layout", "packing", "servo", "compound", "impossible", "comparison", "front"),
    pytest.param("pair", marks=pytest.mark.slow),
)


@pytest.fixture(scope="module")
def kept(solved):
    """One file of every kind as plain data."""
    small = {"seeds": 2, "seconds": 0.01, "evaluations": 64}
    compared = gearopt.compare(
        ROOT / "problems" / "elevator.toml", methods="ipopt,annealing", **small
    )
    pictures = {"drive": "elevator", "layout": "elevator_box", "packing": "six_cylinders"}
    others = {
        "servo": "servo_gimbal_swing",
        "compound": "sandgren_train",
        "pair": "relief_two_loads",
    }
    found = {k: json.loads((PICTURES / f"{n}.json").read_text()) for k, n in pictures.items()}
    for kind, name in others.items():
        found[kind] = solved(name).to_dict()
    impossible = gearopt.solve(
        ROOT / "problems" / "elevator_small_wheels.toml", budget=gearopt.Budget(0.5)
    )
    found["front"] = front_of(found["drive"])
    return found | {"impossible": impossible.to_dict(), "comparison": compared.to_dict()}


def front_of(drive):
    """The Pareto front of a kept drive and of one that is longer, as plain data."""
    values = drive["objective"]["value"], 300.0
    points = [
        FrontPoint((values[0] * (1.0 + k), values[1] - k), True, None, (-1.0,), drive["design"])
        for k in range(2)
    ]
    objectives = Objective("gear_volume", "mm3"), Objective("total_length", "mm")
    told = {"picks": (Pick(1, "knee", "a reason"),), "beaten": ((2.0 * values[0], 400.0),)}
    told |= {"impossible": (Impossible({"total_length": 9.0}, True),), "scene": "drive"}
    told |= {"growth": (Growth(0.1, 5, 1.0), Growth(0.2, 9, 2.0)), "hypervolume": 2.0}
    return Front("drive", "complete", "exact", objectives, tuple(points), **told).to_dict()


def places(data, way=()):
    """Every place of plain data; of a list the first four."""
    if way:
        yield way
    pairs = data.items() if isinstance(data, dict) else ()
    for key, value in enumerate(data[:4]) if isinstance(data, list) else pairs:
        yield from places(value, (*way, key))


def edited(data, rng):
    """The data with one value set to something odd, taken away, or doubled."""
    data = json.loads(json.dumps(data))
    *way, last = rng.choice(list(places(data)))
    at = data
    for key in way:
        at = at[key]
    act = rng.choice(("set", "set", "set", "del", "double"))
    if act == "set":
        at[last] = rng.choice(ODD)
    elif act == "del":
        del at[last]
    elif isinstance(at, list):
        at.append(at[last])
    else:
        at[f"{last}x"] = at[last]
    return data


def held(data, folder, capsys):
    """What `report` says of data: its standard output, or the one message."""
    path, page = folder / "kept.json", folder / "page.html"
    path.write_text(json.dumps(data), encoding="utf-8")
    page.unlink(missing_ok=True)
    try:
        report(path, html=page, csv=folder / "tables", units="metric")
    except typer.Exit:
        said = capsys.readouterr()
        assert page.exists() and said.out and said.err == ""
        return said.out
    except GearoptError as wrong:
        said = capsys.readouterr()
        assert said.out == "" and said.err == "" and not page.exists()
        assert str(wrong).startswith(f"{path}: ") and "\n" not in str(wrong)
        return str(wrong)
    raise AssertionError("neither shown nor refused")


@pytest.mark.parametrize("kind", KINDS)
def test_a_kept_file_is_shown_or_refused_in_one_line(kind, kept, tmp_path, capsys):
    assert "Page: " in held(kept[kind], tmp_path, capsys)
    assert held(edited(kept[kind], random.Random(1)), tmp_path, capsys)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("kind", KINDS)
def test_many_edits_of_kept_files(kind, seed, kept, tmp_path, capsys):
    rng = random.Random(100 + seed)
    for _ in range(25):
        assert held(edited(kept[kind], rng), tmp_path, capsys)


CODES = "\x1b]0;x\x07\x9b31m\u202e\u2066\x00\r"  # of terminals: title, colour, direction, bell


@pytest.mark.parametrize("kind", ("drive", "servo", "packing", "comparison", "front", "impossible"))
def test_codes_for_terminals_do_not_reach_them(kind, kept, tmp_path, capsys):
    """In texts and keys at whatever place; a message of refusal goes the way of all messages."""
    rng, path, shown = random.Random(kind), tmp_path / "kept.json", 0
    for _ in range(6):
        data = json.loads(json.dumps(kept[kind]))
        *way, last = rng.choice(list(places(data)))
        at = data
        for key in way:
            at = at[key]
        value = at.pop(last)
        if isinstance(at, list):
            at.insert(last, f"{CODES}{value}")
        elif isinstance(value, str):
            at[last] = f"{value}{CODES}"
        else:
            at[f"{last}{CODES}"] = value
        path.write_text(json.dumps(data), encoding="utf-8")
        try:
            report(path)
        except (GearoptError, typer.Exit) as ended:
            said = capsys.readouterr().out + (
                told(ended) if isinstance(ended, GearoptError) else ""
            )
        else:
            said = capsys.readouterr().out
        assert said and not set(CODES) - set("]0;x31m") & set(said)
        shown += "gearopt: " not in said
    assert shown or kind == "comparison"


SET = [
    ("layout", ("design", "layout", "gears", 0, "reference_diameter_mm"), 10**9, "far from"),
    ("layout", ("design", "layout", "gears", 0, "teeth"), 10**9, "teeth"),
    ("layout", ("design", "layout", "gears", 0, "to_mm"), 10**12, "far from"),
    ("layout", ("design", "layout", "gears", 0, "helix_angle_deg"), 89.9999999, "drawn in"),
    ("layout", ("design", "layout", "gears", 0, "teeth"), {"a": 1}, "design.layout.gears[1].teeth"),
    ("drive", ("asked", "title"), "\ud800", "text with half a character"),
    ("drive", ("objective", "name"), {"a": 1}, "an objective without a name"),
    ("drive", ("objective", "unit"), ["mm3"], "whose unit is not a text"),
    ("drive", ("file",), {"a": 1}, "value of the wrong type in file"),
    ("drive", ("status",), {"a": 1}, "which no result has"),
    ("comparison", ("groups", 0, "rows", 0, "method"), {"a": 1}, "groups[1].rows[1].method"),
    ("comparison", ("groups", 0, "rows", 0, "method"), "other", "no settings of the method"),
    ("comparison", ("groups", 0, "unit"), {"a": 1}, "a value in groups[1].unit that is not a"),
    ("comparison", ("budget",), {}, "lacks in budget: evaluations"),
    ("comparison", ("comparison",), 7, "comparison format 7"),
    ("comparison", ("seeds",), 7, "that is not a list"),
    ("comparison", ("extra",), 7, "unknown keys in it: extra"),
]


@pytest.mark.parametrize(
    ("odd", "said"),
    [
        (KeyError("ratio"), "lacks the key 'ratio'"),
        (ZeroDivisionError("float division by zero"), "a number that is zero or too large"),
        (IndexError("list index out of range"), "a list that is too short"),
        (TypeError("'int' object is not iterable"), "a value of the wrong type"),
        (ValueError("has unknown keys in it: a"), "has unknown keys in it: a"),
    ],
)
def test_faults_are_told_in_the_words_of_the_file(odd, said):
    assert said in reporting._fault(odd) and "rror" not in reporting._fault(odd)


@pytest.mark.parametrize(("kind", "place", "value", "said"), SET)
def test_what_is_odd_is_named(kind, place, value, said, kept, tmp_path, capsys):
    data = json.loads(json.dumps(kept[kind]))
    *way, last = place
    at = data
    for key in way:
        at = at[key]
    at[last] = value
    assert said in held(data, tmp_path, capsys)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"result": NaN}', "holds NaN"),
        ('{"comparison": 1, "groups": -Infinity}', "holds -Infinity"),
        ("[" * 100_000, "nested too deeply"),
        ('{"comparison": 1}', "lacks keys in it: budget, groups"),
    ],
)
def test_text_that_is_no_plain_data_is_refused(text, said, tmp_path):
    path = tmp_path / "kept.json"
    path.write_text(text)
    with pytest.raises(GearoptError, match="kept.json") as wrong:
        report(path)
    assert said in str(wrong.value) and "\n" not in str(wrong.value)


def test_a_comparison_has_a_table_of_its_runs_and_one_system(kept, tmp_path, capsys):
    path, table = tmp_path / "kept.json", tmp_path / "tables" / "runs.csv"
    path.write_text(json.dumps(kept["comparison"]))
    with pytest.raises(GearoptError, match="this file holds a comparison"):
        report(path, units="inch")
    with pytest.raises(typer.Exit):
        report(path, csv=table.parent)
    assert str(table) in capsys.readouterr().out
    rows = list(csv.DictReader(table.read_text(encoding="utf-8-sig").splitlines()))
    runs = [
        (row["method"], kind, run)
        for group in kept["comparison"]["groups"]
        for row in group["rows"]
        for kind in ("evaluations", "time")
        if row[f"equal_{kind}"]
        for run in row[f"equal_{kind}"]["runs"]
    ]
    assert [(r["method"], r["held equal"], int(r["seed"])) for r in rows] == [
        (method, kind, run["seed"]) for method, kind, run in runs
    ]
    values = [float(r["objective"] or "nan") for r in rows if r["unit"] == "cm³"]
    known = [math.nan if run["objective"] is None else run["objective"] / 1e3 for *_, run in runs]
    assert values == pytest.approx(known, rel=1e-12, nan_ok=True)


def test_stages_that_cannot_be_drawn_are_refused_at_once(kept, tmp_path, capsys):
    """Thousands of them, or lengths near the smallest number, kept a page from being made."""
    data = json.loads(json.dumps(kept["drive"]))
    stages = data["design"]["stages"]
    small = [{k: 5e-324 if k.endswith("_mm") else v for k, v in s.items()} for s in stages]
    for odd, said in ((stages * 51, "102 stages cannot be drawn"), (small, "cannot be drawn")):
        data["design"]["stages"] = odd
        assert said in held(data, tmp_path, capsys)


def test_an_old_page_stays_where_the_new_one_cannot_be_made(kept, tmp_path):
    path, page = tmp_path / "kept.json", tmp_path / "page.html"
    page.write_text("old")
    path.write_text(json.dumps(kept["drive"] | {"asked": {"title": "\ud800"}}))
    with pytest.raises(GearoptError):
        report(path, html=page)
    assert page.read_text() == "old"
