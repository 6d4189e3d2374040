"""Applies a remedy to a problem file as its user would: set a key, read the file again."""

import re
import tomllib
from decimal import Decimal
from fractions import Fraction

from gearopt.scenes.drive import Scene

NUMBER = re.compile(r"[+-]?[0-9][0-9.]*(?:[eE][+-]?[0-9]+)?")


def scene_of(text, model=Scene):
    """The scene of a file's text, and its content."""
    content = tomllib.loads(text, parse_float=Decimal)
    content = {k: v for k, v in content.items() if k not in ("gearopt", "kind") and k[:2] != "x-"}
    return model.model_validate(content), content


def edited(content, remedy, back=(), model=Scene):
    """The scene of a content with the changes of a remedy; those in `back` 0.1 % (or 1) smaller."""
    content = _copy(content)
    for change in remedy.changes:
        place, name = _place(content, change.key)
        less = change in back
        if change.write:
            place[name] = _value(_less(change.was, change.write) if less else change.write)
        else:
            del place[name]
    return model.model_validate(content)


def _copy(value):
    if isinstance(value, dict):
        return {k: _copy(v) for k, v in value.items()}
    return [_copy(v) for v in value] if isinstance(value, list) else value


def _place(content, key):
    *tables, name = key.split(".")
    here = content
    if name.endswith("]"):  # an item of a list
        name, _, index = name.rstrip("]").partition("[")
        return _place(content, ".".join([*tables, name, index]))[0], int(index) - 1
    for table in tables:
        stem, _, index = table.rstrip("]").partition("[")
        if stem == "stage" and "stage" not in content:
            content["stage"] = [{} for _ in range(content["stages"])]
        here = here.setdefault(stem, {})
        here = here[int(index) - 1] if index else here
    return here, name


def _value(text):
    return tomllib.loads(f"x = {text}", parse_float=Decimal)["x"]


def _less(was, write, back=1e-3):
    """The text of an edit with every changed number nearer to what stood there."""
    old, new = NUMBER.findall(was), NUMBER.findall(write)
    old = old * len(new) if len(old) == 1 else old
    numbers = iter(zip(old, new, strict=True))

    def nearer(match):
        before, after = next(numbers)
        a, b = Fraction(before), Fraction(after)
        if a == b:
            return after
        if after.isdigit() and before.isdigit():
            return str(int(after) + (1 if a > b else -1))
        return f"{float(b) + (-1 if b > a else 1) * back * abs(float(b)):.12g}"

    return NUMBER.sub(nearer, write)
