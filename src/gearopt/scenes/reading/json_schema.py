"""Tables and keys of a kind of problem file: as JSON schema for editors, as Markdown for people."""

from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema

from gearopt.scenes.reading.fields import FOLLOWS
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.load import FORMAT, kind_named
from gearopt.scenes.reading.mistakes import example_of, table_of, tables
from gearopt.scenes.reading.toml_writing import toml_text
from gearopt.units import SYSTEMS


class _Schema(GenerateJsonSchema):
    """Leaves out defaults that JSON cannot hold, as fractions; an interface of pydantic."""

    ignored_warning_kinds = {"skipped-choice", "non-serializable-default"}


def json_schema(kind: str) -> dict[str, Any]:
    """Return the JSON schema (2020-12) of a whole file of a kind."""
    schema: dict[str, Any] = kind_named(kind).scene.model_json_schema(schema_generator=_Schema)
    head = {
        "gearopt": {"const": FORMAT, "description": "Format version of the file"},
        "kind": {"const": kind, "description": "Kind of problem"},
        "units": {
            "enum": list(SYSTEMS),
            "description": "Units in which answers are shown, unless --units says otherwise",
        },
    }
    schema["properties"] = head | schema["properties"]
    if any("from" in table.get("properties", ()) for table in schema["$defs"].values()):
        _needed_alone(schema)
    schema["required"] = ["gearopt", "kind", *schema.get("required", [])]
    schema["patternProperties"] = {"^x-": {}}
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    schema["title"] = f"gearopt {kind}"
    return schema


def _needed_alone(schema: dict[str, Any]) -> None:
    """Ask for tables, and for their keys, of files alone whose gears are not another one's."""
    words, names = ("required", "oneOf"), schema.pop("required")
    refs = {name: schema["properties"][name]["$ref"].rpartition("/")[2] for name in names}
    held = {
        ref: {w: v for w in words if (v := schema["$defs"][ref].pop(w, None))}
        for ref in {*refs.values()}
    }
    schema["if"] = {"required": ["gears"], "properties": {"gears": {"required": ["from"]}}}
    inside = {name: held[ref] for name, ref in refs.items()}
    schema["else"] = {"required": names, "properties": inside}
    if "anyOf" in schema:
        schema["else"]["anyOf"] = schema.pop("anyOf")


def reference(kind: str) -> str:
    """Return every table and key of a kind in Markdown: meaning, whether needed, an example.

    Tables that it has from another kind are named; their keys stand on the page of that kind.
    """
    model: type[BaseModel] = kind_named(kind).scene
    taken = any("from" in table.model_fields for _, table in tables(model))
    parts = [f"### top of the file\n\n{_doc(model)}\n\n{_rows(model, taken)}"]
    lent: dict[str, list[str]] = {}
    for title, table in tables(model):
        home = table.__module__.split(".")[2]  # gearopt.scenes.KIND
        if home in kinds() and home != kind:
            lent.setdefault(home, []).append(f"`{title}`")
        else:
            parts.append(f"### {title}\n\n{_doc(table)}\n\n{_rows(table, taken)}")
    for home, titles in lent.items():
        words = f"{', '.join(titles)}: their keys stand on [that page]({home}.md)."
        parts.append(f'### tables of kind = "{home}"\n\n{words}')
    return "\n\n".join(parts) + "\n"


def _doc(model: type[BaseModel]) -> str:
    return " ".join((model.__doc__ or "").split())


def _rows(model: type[BaseModel], taken: bool) -> str:
    """The keys of a table; taken: files may take their gears, and what follows, from another."""
    lines = ["| key | needed | meaning | example |", "|---|---|---|---|"]
    for name, info in model.model_fields.items():
        if table_of(info.annotation):
            continue
        extra = info.json_schema_extra
        default = extra.get("default") if isinstance(extra, dict) else None
        if default is None and info.default not in (None, "") and not info.is_required():
            default = info.default
        shown = f"default {toml_text(default)}" if default is not None else "no"
        asked = "yes, or by `from`" if taken and FOLLOWS in info.metadata else "yes"
        needed = asked if info.is_required() else shown
        example = toml_text(example_of(model, (name,)))
        lines.append(f"| `{name}` | {needed} | {info.description} | `{name} = {example}` |")
    return "\n".join(lines)
