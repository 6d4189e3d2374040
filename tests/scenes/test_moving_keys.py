"""Every key of every kind, changed alone by 10 % or to another word, moves the answer.

`moving_keys.toml` says in which file (of problems/, or an example, with some keys set otherwise) a
key moves what is told: value, design, bounds, limits, report; not the echo of the key itself, nor
sentences. `to` names other values where 10 % move nothing there, `set` and `unset` what stands
otherwise in the file. `still`: keys that move no number, or are not changed, each with the reason.
"""

import json
import random
import re
import tomllib
from decimal import Decimal
from functools import cache
from pathlib import Path

import pytest

import gearopt
from gearopt import Budget
from gearopt.errors import GearoptError, SolveError
from gearopt.scenes.reading.json_schema import json_schema
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.load import examples, kind_named
from gearopt.scenes.reading.mistakes import example_of, table_of, tables

PROBLEMS = Path(__file__).parents[2] / "problems"
TABLE = tomllib.loads(Path(__file__).with_name("moving_keys.toml").read_text("utf-8"))
BASES = [(kind, name) for kind, own in TABLE.items() for name in own if name != "still"]
QUICK = [(kind, name) for kind, name in BASES if TABLE[kind][name].get("quick")]
SAMPLE = 2  # keys that the default tests change
SECONDS = 100.0  # of a search
NUMBER = re.compile(r"\s*([+-]?[0-9.]+(?:[eE][+-]?\d+)?)(.*)", re.DOTALL)
UNIT = re.compile(r"_(mm|um|m|MPa|GPa|deg|rpm|kW|N|Nm|rad|s|ms|Hz|kg|percent|kg_m2|N_per_mm)$")
APART = {"asked", "options", "versions", "seconds", "evaluations", "file", "file_sha256"}
NO_FACTS = {"certificate", "gap", "multipliers", "assumptions", "notes", "message", "inputs"}
NO_FACTS |= {"progress", "proof", "seconds", "evaluations"}
CLOSE = 1e-9  # relative: less is the rounding of an answer


def keys(kind):
    """Return every key of a kind as `table.key` with its example and its words."""
    schema = json_schema(kind)
    for title, table in (("", kind_named(kind).scene), *tables(kind_named(kind).scene)):
        for name, info in table.model_fields.items():
            if not table_of(info.annotation):
                own = schema["$defs"][table.__name__] if title else schema
                path = ".".join(filter(None, (title.strip("[]"), name)))
                yield path, (example_of(table, (name,)), words_of(own["properties"][name]))


def words_of(node):
    """Return the words of a schema's node."""
    if isinstance(node, dict):
        inner = [w for key in ("anyOf", "items", "prefixItems") for w in words_of(node.get(key))]
        return [*node.get("enum", ()), *inner]
    return [w for part in node or () for w in words_of(part)] if isinstance(node, list) else []


KNOWN = {kind: dict(keys(kind)) for kind in kinds()}


def scaled(value, factor):
    """Return a number, quantity, truth or list of them times a factor; whole numbers by 1."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, list):
        return [scaled(v, factor) for v in value]
    if isinstance(value, int):
        moved = round(value * factor)
        return moved if moved != value else value + (1 if factor > 1.0 else -1)
    if isinstance(value, float | Decimal):
        return float(f"{float(value) * factor:.6g}")
    found = NUMBER.fullmatch(value) if isinstance(value, str) else None
    return f"{float(found[1]) * factor:.6g}{found[2]}" if found else value


def others(value, example, words):
    """What a key is changed to, in turn: 10 % more and less, other words, the example."""
    start = example if value is None else value
    return [
        other
        for other in (scaled(start, 1.1), scaled(start, 0.9), *words, example)
        if other != value
    ]


@cache
def base(kind, name):
    """Return the file of a base, what is set otherwise in it, and the answer."""
    own = TABLE[kind][name]
    path = PROBLEMS / f"{own['file']}.toml"
    file = path if path.exists() else tomllib.loads(examples()[own["file"]], parse_float=Decimal)
    content = tomllib.loads(path.read_text("utf-8"), parse_float=Decimal) if path.exists() else file
    given = own.get("set", {}) | dict.fromkeys(own.get("unset", ()))
    budget = Budget(evaluations=own["evaluations"]) if "evaluations" in own else Budget(SECONDS)
    return file, content, given, budget, facts(file, given, budget)


def facts(file, changes, budget):
    """Return every number and short word of an answer by its place; of given drives the rating."""
    try:
        found = gearopt.solve(file, changes, budget=budget, remedies=False)
    except SolveError as refused:
        if "nothing to choose" not in str(refused):
            raise
        found = gearopt.rate(file, changes)
    told = json.loads(found.to_json())
    return dict(leaves({k: v for k, v in told.items() if k not in APART}))


def leaves(value, place=()):
    """Yield place and value of everything in tables and lists but what tells no fact."""
    if isinstance(value, dict | list):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, inner in items:
            if key not in NO_FACTS and not str(key).startswith("seconds"):
                yield from leaves(inner, (*place, key))
    elif not (isinstance(value, str) and (len(value) > 40 or re.search(r"\d", value))):
        yield place, value


def moved(before, after, key):
    """Return whether any fact differs by more than rounding, but for the echo of a key."""
    name = key.rpartition(".")[2]
    for place in before.keys() | after.keys():
        one, two = before.get(place), after.get(place)
        numbers = all(isinstance(v, int | float) for v in (one, two))
        same = abs(one - two) <= CLOSE * max(abs(one), abs(two)) if numbers else one == two
        if not same and name not in {UNIT.sub("", step) for step in map(str, place)}:
            return True
    return False


def at(content, key):
    """Return the value at a key of a file's tables, None where there is none."""
    for step in re.findall(r"[^.\[\]]+", key):
        if isinstance(content, list):
            content = content[int(step) - 1] if int(step) <= len(content) else None
        elif content is not None:
            content = content.get(step)
    return content


def idle(kind, name, key):
    """What was tried of a key that moves nothing; None where it moves the answer."""
    file, content, given, budget, before = base(kind, name)
    own, tried = TABLE[kind][name], []
    value = given.get(key, at(content, key))
    plain = re.sub(r"\[\d+\]", "", key)
    to = own.get("to", {})
    for other in [to[key]] if key in to else others(value, *KNOWN[kind][plain]):
        try:
            after = facts(file, given | {key: other}, budget)
        except GearoptError as refused:
            tried.append(str(refused)[:200])
            continue
        if moved(before, after, key):
            return None
        tried.append(f"{other!r} moves nothing")
    return f"{name}: {key}: {tried}"


def listed(kind):
    """Return the keys that bases of a kind move, without their places in lists."""
    own = [TABLE[kind][name] for k, name in BASES if k == kind]
    return [re.sub(r"\[\d+\]", "", key) for one in own for key in moving(one)]


def moving(own):
    """Return the keys that a base moves."""
    return [*own.get("moves", "").split(), *own.get("to", {})]


@pytest.mark.parametrize("kind", kinds())
def test_every_key_is_in_the_table_once(kind):
    assert kind in TABLE, f"moving_keys.toml has no [{kind}]: name a file that its keys move"
    every = [*listed(kind), *TABLE[kind].get("still", {})]
    assert len(every) == len(set(every))
    lent = {key for key in KNOWN[kind] if kind == "pair" and key in KNOWN["drive"]}
    assert set(KNOWN[kind]) - lent <= set(every) <= set(KNOWN[kind])
    assert all(len(why) > 10 for why in TABLE[kind].get("still", {}).values())


def test_some_keys_move_the_answer():
    every = [(kind, name, key) for kind, name in QUICK for key in moving(TABLE[kind][name])]
    found = [idle(*one) for one in random.Random(20).sample(every, SAMPLE)]
    assert not any(found), "\n".join(filter(None, found))


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "name"), BASES)
def test_every_key_moves_the_answer(kind, name):
    found = [idle(kind, name, key) for key in moving(TABLE[kind][name])]
    assert not any(found), "\n".join(filter(None, found))
