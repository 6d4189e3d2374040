"""A field type of problem files: places in a plane."""

from typing import Any

from gearopt.scenes.reading.fields import Reads, mended, refuse


def pair(item: Reads) -> Reads:
    """A place [x, y] of two items."""

    def read(value: Any, example: Any) -> tuple[Any, Any]:
        if isinstance(value, tuple):
            return value[0], value[1]
        if not isinstance(value, list) or len(value) != 2:
            raise refuse("is not a place [x, y]")
        right, rule = mended(item, value)
        if rule:
            raise refuse(f"has a part that {rule}", None if None in right else right)
        return item.reader(value[0], item.example), item.reader(value[1], item.example)

    schema = {"type": "array", "items": item.schema, "minItems": 2, "maxItems": 2}
    return Reads(read, [item.example] * 2, schema)
