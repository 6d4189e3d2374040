"""Reading a deviation that may be two-sided: one quantity, or a lower and an upper allowance."""

import re
from typing import Any

from gearopt import units
from gearopt.scenes.reading.fields import Reads, quantity, refuse
from gearopt.units import Quantity

# Possessive throughout: what has thousands of digits is not tried again from each of them.
NUMBER = r"(?>[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?:[eE][+-]?[0-9]++)?+"
SIGNED = rf"[+-]?\s*+{NUMBER}"
EITHER = re.compile(rf"\s*+({SIGNED})\s*+([^\s/]*+)\s*+/\s*+({SIGNED})\s*+(\S++)\s*+")
ALIKE = re.compile(rf"\s*(?:±|\+/-|\+-)\s*({NUMBER})\s*(\S+)\s*")


def allowances(example: str) -> Reads:
    """Read a length >= 0, or two allowances in any order, as (lower, upper).

    Two allowances: "+0.02/-0.01 mm", "±0.01 mm" or a list of both.
    """
    unsigned, signed = (quantity("length", example, zero=not s, signed=s) for s in (False, True))

    def read(value: Any, example: Any) -> Quantity | tuple[Quantity, Quantity]:
        if isinstance(value, Quantity | tuple):
            return value  # read before
        ends = texts_of(value)
        if ends is None:
            length: Quantity = unsigned.reader(value, example)
            return length
        if len(ends) != 2:
            raise refuse("is neither a length nor two allowances", ["-0.01 mm", "0.02 mm"])
        low, high = sorted((signed.reader(e, example) for e in ends), key=lambda q: q.value)
        if low.value == high.value:
            raise refuse("has two equal allowances: the lower one must be below the upper one")
        return low, high

    pair = {"type": "array", "items": signed.schema, "minItems": 2, "maxItems": 2}
    texts = {"type": "string", "pattern": "/|±"}
    return Reads(read, example, {"anyOf": [unsigned.schema, texts, pair]})


def texts_of(value: Any) -> list[Any] | None:
    """Return two allowances as texts, in the order they have; None for a value that is no pair."""
    if isinstance(value, list):
        return value
    if not isinstance(value, str):
        return None
    if alike := ALIKE.fullmatch(value):
        number, unit = alike.groups()
        return [f"-{number} {unit}", f"{number} {unit}"]
    if either := EITHER.fullmatch(value):
        first, unit, second, other = either.groups()
        if units.named(other, "length"):
            return [
                f"{first.replace(' ', '')} {unit or other}",
                f"{second.replace(' ', '')} {other}",
            ]
    return None
