"""Field types of problem files: quantities with units, exact numbers, ranges.

A `Reads` stands in an `Annotated` type; pydantic calls its `read`. Every rejection carries a rule
and a value to write instead, which `load` turns into a SceneError. Numbers reach the readers
exactly as written (int or Decimal).
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

from pydantic import BaseModel, ConfigDict
from pydantic_core import PydanticCustomError, core_schema

from gearopt import units
from gearopt.units import Quantity

LARGEST = Fraction(10) ** 30  # of any number in a file: beyond it lies a slip, not a gear
SMALLEST = 1 / LARGEST


class Table(BaseModel):
    """A table of a problem file: frozen, unknown keys refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)


@dataclass(frozen=True)
class Reads:
    """How a value of a file is read: read(value, example) -> value, or raises `refuse(...)`.

    example: a right value, shown where a wrong one stands. schema: the JSON schema of the value.
    """

    reader: Callable[[Any, Any], Any]
    example: Any
    schema: dict[str, Any]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        """Let pydantic call the reader and nothing else."""
        return core_schema.no_info_plain_validator_function(
            lambda value: self.reader(value, self.example)
        )

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """The JSON schema as it stands."""
        return dict(self.schema)


def refuse(
    rule: str, write: Any = None, at: tuple[Any, ...] = (), action: str = "set"
) -> PydanticCustomError:
    """The error for a value: what is wrong, and what to do.

    write: the value to set (None: the field's example), or for `swap` the key to exchange with.
    at: the place below the checked table, for checks of several keys. action: as in errors.Fix.
    """
    context = {"rule": rule, "write": write, "at": at, "action": action}
    return PydanticCustomError("gearopt", "{rule}", context)


def quantity(dimension: str, example: str, most: str | None = None, zero: bool = False) -> Reads:
    """A positive quantity such as "7.5 kW"; most: the largest allowed, zero: whether 0 is."""
    limit = units.parse(most, dimension) if most else None
    names = ", ".join(units.UNITS[dimension])
    usual = units.parse(example, dimension).unit

    def read(value: Any, example: str) -> Quantity:
        if isinstance(value, Quantity):
            return value
        if isinstance(value, int | Decimal) and not isinstance(value, bool):
            right = _with_unit(value, usual, example)
            raise refuse(f"is a bare number: {dimension} needs a unit ({names})", right)
        if not isinstance(value, str):
            raise refuse(f"is not a text with a number and a unit of {dimension} ({names})")
        try:
            found = units.parse(value, dimension)
        except ValueError as reason:
            raise refuse(str(reason)) from None
        _check_range(found.number, zero)
        if limit is not None and found.value > limit.value * (1 + 1e-12):
            raise refuse(f"must be at most {most}")
        return found

    alternatives = "|".join(re.escape(unit) for unit in units.UNITS[dimension])
    number = r"\+?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?"
    schema = {"type": "string", "pattern": rf"^\s*{number}\s*({alternatives})\s*$"}
    return Reads(read, example, schema)


def _with_unit(value: int | Decimal, unit: str, example: str) -> str:
    """The bare number with a unit, where that is a valid quantity; else the example."""
    usable = Decimal(value).is_finite() and SMALLEST < Fraction(value) < LARGEST
    return f"{value} {unit}" if usable else example


def _check_range(number: Fraction, zero: bool) -> None:
    if number < 0 or (number == 0 and not zero):
        raise refuse("must be zero or more" if zero else "must be greater than zero")
    if number and not SMALLEST < number < LARGEST:
        raise refuse("is out of any sensible range (1e-30 to 1e30)")


def number(
    example: Any, least: int, most: int | Fraction, percent: bool = False, zero: bool = False
) -> Reads:
    """A pure number, kept exactly as a fraction; percent: "1 %" is read too."""

    def read(value: Any, example: Any) -> Fraction:
        if isinstance(value, Fraction):
            return value
        if isinstance(value, str) and percent:
            try:
                found = units.parse(value, "fraction").exact[0]
            except ValueError:
                raise refuse('is not a number or a percentage such as "1 %"') from None
        elif isinstance(value, bool) or not isinstance(value, int | Decimal):
            raise refuse("is not a number")
        elif not Decimal(value).is_finite():
            raise refuse("is not a finite number")
        else:
            found = Fraction(value)
        _check_range(found, zero)
        if not least <= found <= most:
            raise refuse(f"must be between {least} and {float(most):g}")
        return found

    schema: dict[str, Any] = {"type": "number", "minimum": least, "maximum": float(most)}
    if percent:
        text = {"type": "string", "pattern": r"^\s*[0-9.]+([eE][+-]?[0-9]+)?\s*%?\s*$"}
        schema = {"anyOf": [schema, text]}
    return Reads(read, example, schema)


def whole(example: int, least: int, most: int) -> Reads:
    """A whole number."""

    def read(value: Any, example: Any) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise refuse("is not a whole number")
        if not least <= value <= most:
            raise refuse(f"must be a whole number from {least} to {most}")
        return value

    return Reads(read, example, {"type": "integer", "minimum": least, "maximum": most})


def span(item: Reads, example: Any, single: bool = False) -> Reads:
    """A range [least, most] of items; single: one item is read too and means both ends."""

    def read(value: Any, example: Any) -> tuple[Any, Any]:
        if isinstance(value, tuple):
            return value[0], value[1]
        if single and not isinstance(value, list):
            only = item.reader(value, item.example)
            return only, only
        if not isinstance(value, list) or len(value) != 2:
            raise refuse("is not a range [least, most]")
        try:
            low, high = (item.reader(end, item.example) for end in value)
        except PydanticCustomError as wrong:
            rule = (wrong.context or {})["rule"]
            raise refuse(f"has an end that {rule}") from None
        if _order(low) > _order(high):
            raise refuse("has its ends in the wrong order", value[::-1])
        return low, high

    schema: dict[str, Any] = {"type": "array", "items": item.schema, "minItems": 2, "maxItems": 2}
    return Reads(read, example, {"anyOf": [item.schema, schema]} if single else schema)


def _order(value: Any) -> Any:
    """What a range is ordered by."""
    return value.value if isinstance(value, Quantity) else value


def choice(*names: str) -> Reads:
    """One of some words."""

    def read(value: Any, example: Any) -> str:
        if value not in names or not isinstance(value, str):
            known = ", ".join(f'"{n}"' for n in names)
            raise refuse(f"is not one of {known}")
        return value

    return Reads(read, names[0], {"enum": list(names)})


def truth() -> Reads:
    """True or false."""

    def read(value: Any, example: Any) -> bool:
        if not isinstance(value, bool):
            raise refuse("is neither true nor false")
        return value

    return Reads(read, True, {"type": "boolean"})


def words() -> Reads:
    """Free text of a line or two."""

    def read(value: Any, example: Any) -> str:
        if not isinstance(value, str):
            raise refuse("is not a text")
        if len(value) > 1000 or not value.isprintable():
            raise refuse("is longer than 1000 characters or has control characters")
        return value

    return Reads(read, "a text", {"type": "string", "maxLength": 1000})


def either(names: dict[str, Any], item: Reads) -> Reads:
    """A named set, or a list of items, as a sorted tuple of exact inside-unit numbers."""

    def read(value: Any, example: Any) -> tuple[Fraction, ...]:
        if isinstance(value, tuple):
            return value
        if isinstance(value, str) and value in names:
            return tuple(names[value])
        known = ", ".join(f'"{n}"' for n in names)
        if not isinstance(value, list) or not value:
            raise refuse(f"is neither one of {known} nor a list")
        try:
            found = {item.reader(entry, item.example).exact[0] for entry in value}
        except PydanticCustomError as wrong:
            rule = (wrong.context or {})["rule"]
            raise refuse(f"has an entry that {rule}") from None
        return tuple(sorted(found))

    items = {"type": "array", "items": item.schema, "minItems": 1}
    return Reads(read, next(iter(names)), {"anyOf": [{"enum": list(names)}, items]})
