"""Values and keys as TOML writes them, for messages and for remedies a machine can apply."""

import re
from collections.abc import Callable, Mapping
from decimal import Context, Decimal
from fractions import Fraction
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_LONGEST_INTEGER = 10_000  # bits; Python refuses to print integers of more than 4300 digits


def toml_text(value: Any) -> str:
    """Return a value as TOML writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        quoted = value.replace("\\", "\\\\").replace('"', '\\"')
        return '"' + "".join(c if c.isprintable() else _escape(c) for c in quoted) + '"'
    if isinstance(value, list | tuple):
        return "[" + ", ".join(toml_text(v) for v in value) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {toml_text(v)}" for k, v in value.items()) + "}"
    if isinstance(value, Decimal) and not value.is_finite():
        return "nan" if value.is_nan() else str(float(value))
    if isinstance(value, int) and value.bit_length() > _LONGEST_INTEGER:
        return hex(value)
    return str(value)


def short(value: Any, longest: int = 60) -> str:
    """Return a value as TOML writes it, cut to `longest` characters."""
    try:
        return cut(toml_text(value), longest)
    except RecursionError:
        return "{...}" if isinstance(value, dict) else "[...]"


def cut(text: str, longest: int) -> str:
    """Return a text of at most `longest` characters."""
    return text if len(text) <= longest else text[: longest - 3] + "..."


def dotted(place: tuple[Any, ...]) -> str:
    """Return the path of a place in a file: ("stage", 1, "module") is `stage[2].module`."""
    parts = [f"[{p + 1}]" if isinstance(p, int) else f".{_key(str(p))}" for p in place]
    return "".join(parts).removeprefix(".")


def exact(value: Fraction) -> Decimal | int:
    """Return a fraction of a file as the decimal number it was."""
    if value.denominator == 1:
        return value.numerator
    return Context(prec=40).divide(Decimal(value.numerator), Decimal(value.denominator))


def _escape(character: str) -> str:
    if character in "\n\t":
        return {"\n": "\\n", "\t": "\\t"}[character]
    code = ord(character)
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else toml_text(name)


def toml_tables(
    tables: Mapping[str, Any], said: Callable[[Any], tuple[Any, str]], head: str = ""
) -> str:
    """The text of a file, or of its tables below a head: keys first, then tables in their order.

    said: a value, and a comment with which its line stands as one, "" for none.
    """
    lines, below = [], []
    for key, value in tables.items():
        name = f"{head}.{_key(key)}" if head else _key(key)
        rows = value if isinstance(value, list) else [value]
        if rows and all(isinstance(row, dict) for row in rows):
            double = isinstance(value, list)
            for row in rows:
                text = toml_tables(row, said, name)
                title = f"[[{name}]]" if double else f"[{name}]"
                plain = not text.startswith("\n[") if text else double
                below.append(f"\n{title}\n{text}" if plain else text)
        else:
            content, comment = said(value)
            line = f"{_key(key)} = {toml_text(content)}"
            lines.append(f"# {line} {comment}\n" if comment else f"{line}\n")
    return "".join((*lines, *below))
