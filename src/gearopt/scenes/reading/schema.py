"""The JSON schema of a kind of problem file, for editors."""

from typing import Any

from gearopt.scenes.reading.load import FORMAT, scene_module


def json_schema(kind: str) -> dict[str, Any]:
    """JSON schema (2020-12) of a whole file of a kind."""
    found: dict[str, Any] = scene_module(kind).Scene.model_json_schema()
    head = {
        "gearopt": {"const": FORMAT, "description": "Format version of the file"},
        "kind": {"const": kind, "description": "Kind of problem"},
    }
    found["properties"] = head | found["properties"]
    found["required"] = ["gearopt", "kind", *found.get("required", [])]
    found["patternProperties"] = {"^x-": {}}
    found["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    found["title"] = f"gearopt {kind}"
    return found
