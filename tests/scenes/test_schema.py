"""The JSON schema takes every right file and refuses what it can know to be wrong."""

import tomllib
from pathlib import Path

import jsonschema
import pytest

from gearopt.scenes.drive import KIND
from gearopt.scenes.reading.json_schema import json_schema
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.load import examples, kind_named
from gearopt.scenes.reading.mistakes import table_of

EXAMPLE = KIND.example.text

PROBLEMS = sorted((Path(__file__).parents[2] / "problems").glob("*.toml"))
VALIDATORS = {kind: jsonschema.Draft202012Validator(json_schema(kind)) for kind in kinds()}
VALIDATOR = VALIDATORS["drive"]


@pytest.mark.parametrize("kind", kinds())
def test_the_schema_is_one(kind):
    jsonschema.Draft202012Validator.check_schema(json_schema(kind))


@pytest.mark.parametrize("path", PROBLEMS, ids=lambda p: p.stem)
def test_every_shipped_file_fits(path):
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    assert list(VALIDATORS[content["kind"]].iter_errors(content)) == []


MORE = {"drive": [examples()["rating"], examples()["sizing"]], "pair": [examples()["sized-pair"]]}


@pytest.mark.parametrize("kind", kinds())
def test_the_example_fits_and_shows_every_table(kind):
    example, content = kind_named(kind).example.text, {}
    for text in (example, *MORE.get(kind, ())):
        VALIDATORS[kind].validate(tomllib.loads(text))
        content |= tomllib.loads(text)
    fields = kind_named(kind).scene.model_fields
    tables = {name for name, info in fields.items() if table_of(info.annotation)}
    apart = {
        "layout",
        "place",
        "keep_out",
        "process_one",
        "process_two",
        "load",
        "material",
    } & tables
    assert all(
        f"# [{name}]" in example for name in apart - {"place", "keep_out", "load", "material"}
    )  # as a comment
    told = "".join((example, *MORE.get(kind, ())))
    assert tables and all(content.get(n) or f"# [{n}]" in told for n in tables - apart)


@pytest.mark.parametrize("kind", kinds())
def test_every_key_is_described(kind):
    for name, table in json_schema(kind)["$defs"].items():
        for key, entry in table["properties"].items():
            assert len(entry.get("description", "")) > 7, f"{name}.{key}"


BROKEN = {
    "unknown key": lambda c: c["gears"].update(helix_angel="25 deg"),
    "unknown table": lambda c: c.update(bearings={}),
    "bare number": lambda c: c["duty"].update(power=7.5),
    "unknown unit": lambda c: c["duty"].update(power="7.5 KW"),
    "unit of another dimension": lambda c: c["duty"].update(power="7.5 mm"),
    "negative quantity": lambda c: c["duty"].update(power="-7.5 kW"),
    "range of one": lambda c: c["limits"].update(pinion_teeth=[20]),
    "range of three": lambda c: c["limits"].update(pinion_teeth=[20, 30, 40]),
    "tooth count with a fraction": lambda c: c["limits"].update(pinion_teeth=[20, 30.5]),
    "too few teeth": lambda c: c["limits"].update(pinion_teeth=[2, 30]),
    "missing key": lambda c: c["duty"].pop("power"),
    "missing table": lambda c: c.pop("limits"),
    "no version": lambda c: c.pop("gearopt"),
    "another version": lambda c: c.update(gearopt=2),
    "another kind": lambda c: c.update(kind="bearing"),
    "unknown word": lambda c: c["objective"].update(minimise="noise"),
    "text for a truth": lambda c: c["teeth"].update(coprime="yes"),
    "table for a list": lambda c: c.update(stage={}),
    "empty list": lambda c: c["teeth"].update(modules=[]),
    "too many stages": lambda c: c.update(stages=7),
}


@pytest.mark.parametrize("change", BROKEN.values(), ids=BROKEN)
def test_wrong_files_are_refused(change):
    content = tomllib.loads(EXAMPLE)
    change(content)
    with pytest.raises(jsonschema.ValidationError):
        VALIDATOR.validate(content)


def test_tables_of_ones_own_are_free():
    content = tomllib.loads(EXAMPLE) | {"x-notes": {"anything": [1, "a"]}}
    assert list(VALIDATOR.iter_errors(content)) == []
