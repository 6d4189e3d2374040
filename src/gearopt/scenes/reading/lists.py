"""Field types of problem files that hold several values: ranges, lists, named sets."""

import re
from fractions import Fraction
from typing import Any

from pydantic_core import PydanticCustomError

from gearopt.scenes.reading.fields import Reads, refuse
from gearopt.scenes.reading.near import near
from gearopt.units import Quantity

_END = r"([0-9]{1,9}(?:\.[0-9]{1,9})?)"
_RANGE = re.compile(rf"\s*{_END}\s*(?:-|\u2013|\.\.\.?|to)\s*{_END}\s*([A-Za-z%][\w/^ ]*)?")


def mended(item: Reads, values: list[Any]) -> tuple[list[Any], str]:
    """Return the values, wrong ones replaced (or None), and the first rule broken."""
    right, first = [], ""
    for value in values:
        try:
            item.reader(value, item.example)
        except PydanticCustomError as wrong:
            context = wrong.context or {}
            without_value = context["action"] == "tell"  # a sentence, no value
            first, value = first or context["rule"], None if without_value else context["write"]
        right.append(value)
    return right, first


def _accepted(item: Reads, values: list[Any], in_order: bool) -> tuple[list[Any], str]:
    """Return the entries of a list that are accepted, and the first rule broken.

    A wrong entry is put right where that is certain. Else, in_order, it is replaced by the example,
    for entry k belongs to item k; without an order it is left out, as is one that is there already.
    """
    right, rule = mended(item, values)
    if in_order:
        return [item.example if entry is None else entry for entry in right], rule
    distinct: list[Any] = []
    for before, entry in zip(values, right, strict=True):
        if entry is not None and (entry is before or entry not in (*values, *distinct)):
            distinct.append(entry)
    return distinct or [item.example], rule


def _reciprocal(value: Any) -> bool:
    return isinstance(value, Quantity) and value.reciprocal


def _number(value: Any, as_written: bool) -> Any:
    """Size of an end of a range, or the number as it is written: by it ends are compared."""
    if not isinstance(value, Quantity):
        return value
    return value.number if as_written else value.value


def span(item: Reads, example: Any, single: bool = False) -> Reads:
    """Read a range [least, most] of items; single: one item is read too and means both ends.

    Of diametral pitches the ends are in the order of the file's numbers; the smaller module is the
    first one that is returned.
    """

    def ordered(values: list[Any]) -> list[Any]:
        """Return two right values as a file has them: by number, also of diametral pitches."""
        quantities = [item.reader(value, item.example) for value in values]
        numbers = [_number(one, all(map(_reciprocal, quantities))) for one in quantities]
        return values if numbers[0] <= numbers[1] else values[::-1]

    def between(values: list[Any]) -> list[Any] | None:
        """Return the range from the least to the greatest of right values; None of others."""
        if not values or mended(item, values)[1]:
            return None
        sizes = [_number(item.reader(value, item.example), False) for value in values]
        least, greatest = (values[sizes.index(pick(sizes))] for pick in (min, max))
        return ordered([least, greatest])

    def read(value: Any, example: Any) -> tuple[Any, Any]:
        if isinstance(value, tuple):
            return value[0], value[1]
        if isinstance(value, str) and (two := _RANGE.fullmatch(value[:80])):
            texts = [f"{end} {two[3] or ''}".strip() for end in two.group(1, 2)]
            right, _ = mended(item, [int(text) if text.isdigit() else text for text in texts])
            write = None if None in right else right
            raise refuse("is a text, not a range [minimum, maximum]", write)
        if single and not isinstance(value, list):
            only = item.reader(value, item.example)
            return only, only
        ends = value if isinstance(value, list) else [value]
        right, rule = mended(item, ends[:2])
        if len(ends) != 2:
            raise refuse("is not a range [minimum, maximum]", between(ends))
        if rule:
            known = None not in right
            raise refuse(f"has an end that {rule}", ordered(right) if known else None)
        low, high = (item.reader(end, item.example) for end in value)
        if _reciprocal(low) != _reciprocal(high):
            text = [str(low), str(low.of(high.exact[0]))]
            raise refuse("has a module and a diametral pitch as its ends", ordered(text))
        if ordered(value) != value:
            raise refuse("has its ends in the wrong order", value[::-1])
        return (high, low) if _reciprocal(low) else (low, high)

    schema: dict[str, Any] = {"type": "array", "items": item.schema, "minItems": 2, "maxItems": 2}
    return Reads(read, example, {"anyOf": [item.schema, schema]} if single else schema)


def _for_example(item: Reads, value: Any) -> Any:
    """Return one item; what is written for a wrong one is one item, too."""
    try:
        return item.reader(value, item.example)
    except PydanticCustomError as wrong:
        context = wrong.context or {}
        if context["write"] is not None:
            raise
        raise refuse(context["rule"], item.example, action="sample") from None


def each_gear(item: Reads, members: str = "[pinion, wheel]") -> Reads:
    """Read [pinion, wheel], or one item that means both, as a tuple."""

    def read(value: Any, example: Any) -> tuple[Any, Any]:
        if isinstance(value, tuple):
            return value[0], value[1]
        if not isinstance(value, list):
            only = _for_example(item, value)
            return only, only
        right, rule = mended(item, value[:2])
        if len(value) != 2:
            both = None if None in right else (right * 2)[:2] or None
            raise refuse(f"is not one value nor a list {members}", both)
        if rule:
            raise refuse(f"has a value that {rule}", None if None in right else right)
        return item.reader(value[0], item.example), item.reader(value[1], item.example)

    both = {"type": "array", "items": item.schema, "minItems": 2, "maxItems": 2}
    return Reads(read, [item.example] * 2, {"anyOf": [item.schema, both]})


def either(names: dict[str, Any], item: Reads) -> Reads:
    """Read a named set, or a list of items, as a tuple of quantities, each size once."""

    def read(value: Any, example: Any) -> tuple[Quantity, ...]:
        if isinstance(value, tuple):
            return value
        if isinstance(value, str) and value in names:
            return tuple(names[value])
        if not isinstance(value, list) or not value:
            known = ", ".join(f'"{n}"' for n in names)
            close = near(value, names) if isinstance(value, str) else None
            raise refuse(f"is neither one of {known} nor a list", close)
        write, rule = _accepted(item, value, in_order=False)
        if rule:
            raise refuse(f"has an entry that {rule}", write)
        sizes: dict[Fraction, Quantity] = {}
        for size in (item.reader(entry, item.example) for entry in value):
            sizes.setdefault(size.exact[0], size)
        return tuple(sizes.values())

    items = {"type": "array", "items": item.schema, "minItems": 1}
    return Reads(read, next(iter(names)), {"anyOf": [{"enum": list(names)}, items]})


def each_mesh(item: Reads) -> Reads:
    """Read one item, as it is, or one for each mesh of a planetary stage, as a tuple."""
    both = each_gear(item, "[sun and planet, planet and ring]")

    def read(value: Any, example: Any) -> Any:
        if isinstance(value, list | tuple):
            return both.reader(value, both.example)
        return item.reader(value, example)

    return Reads(read, item.example, both.schema)


def several(item: Reads, example: Any, in_order: bool = False, single: bool = False) -> Reads:
    """Read a list of items, as a tuple in the file's order.

    in_order: entry k belongs to item k, such as stage k. single: one item is read, too.
    """

    def read(value: Any, example: Any) -> tuple[Any, ...]:
        if isinstance(value, tuple):
            return value
        if single and not isinstance(value, list):
            return (_for_example(item, value),)
        if not isinstance(value, list) or not value:
            raise refuse("is empty" if value == [] else "is not a list")
        write, rule = _accepted(item, value, in_order)
        if rule:
            raise refuse(f"has an entry that {rule}", write)
        return tuple(item.reader(entry, item.example) for entry in value)

    schema: dict[str, Any] = {"type": "array", "items": item.schema, "minItems": 1}
    return Reads(read, example, {"anyOf": [item.schema, schema]} if single else schema)


def one_or_several(item: Reads) -> Reads:
    """Read an item, or a list of items to choose from, as a tuple; a list of one is that item."""
    many = several(item, [item.example])

    def read(value: Any, example: Any) -> Any:
        if not isinstance(value, list | tuple):
            return item.reader(value, example)
        each = tuple(dict.fromkeys(many.reader(value, example)))
        return each if len(each) > 1 else each[0]

    return Reads(read, item.example, {"anyOf": [item.schema, many.schema]})


def pair(item: Reads, what: str = "a place [x, y]", example: Any = None) -> Reads:
    """Read two items."""

    def read(value: Any, example: Any) -> tuple[Any, Any]:
        if isinstance(value, tuple):
            return value[0], value[1]
        if not isinstance(value, list) or len(value) < 2:
            raise refuse(f"is not {what}", example)
        right, rule = mended(item, value[:2])
        if len(value) > 2:
            raise refuse(f"is not {what}", None if None in right else right)
        if rule:
            raise refuse(f"has a part that {rule}", None if None in right else right)
        return item.reader(value[0], item.example), item.reader(value[1], item.example)

    schema = {"type": "array", "items": item.schema, "minItems": 2, "maxItems": 2}
    return Reads(read, example or [item.example] * 2, schema)


def word_or(names: tuple[str, ...], item: Reads) -> Reads:
    """Read one of some words, or else an item."""

    def read(value: Any, example: Any) -> Any:
        if value in names:
            return value
        try:
            return item.reader(value, item.example)
        except PydanticCustomError as wrong:
            known = ", ".join(f'"{n}"' for n in names)
            if not isinstance(value, str) or re.match(r"\s*[-+.]?[0-9]", value):
                raise wrong
            raise refuse(f"is neither one of {known} nor a number", near(value, names)) from None

    return Reads(read, names[0], {"anyOf": [{"enum": list(names)}, item.schema]})
