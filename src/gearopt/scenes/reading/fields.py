"""Field types of problem files: quantities with units, exact numbers, words.

A `Reads` stands in an `Annotated` type; pydantic calls its `read`. Every rejection carries a rule
and a value to write instead, which `remedy` turns into a SceneError. Numbers reach the readers
exactly as written (int or Decimal).
"""

import math
import re
from collections.abc import Callable
from datetime import date as Date
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError, core_schema

from gearopt import units
from gearopt.frozen import dataclass
from gearopt.scenes.reading.near import near
from gearopt.units import Quantity

LARGEST = Fraction(10) ** 30  # of any number in a file: beyond it lies a slip, not a gear
SMALLEST = 1 / LARGEST
GROUPED = ("time", "speed", "power")  # dimensions whose numbers are often of thousands
FAR_OFF = 100.0  # factor from the example: there another unit is likelier
OUT_OF_RANGE = "is out of any sensible range (1e-30 to 1e30)"
# A comma before three digits may separate thousands, so it is not taken for a decimal one.
_NUMBER = r"(\+?[0-9]*(?:\.|,(?![0-9]{3}(?![0-9])))?[0-9]+(?:[eE][+-]?[0-9]{1,3})?)"
_THOUSANDS = re.compile(r"\s*([0-9]{1,3})([,.])([0-9]{3})\s*(|[A-Za-z][\w ^/*]*)\s*", re.ASCII)
_FRACTION = re.compile(r"\s*([0-9]{1,30})\s*/\s*([0-9]{1,30})\s*", re.ASCII)
_DIGITS = r"([0-9]{1,9}(?:\.[0-9]{1,9})?)"
_QUOTIENT = re.compile(rf"\s*{_DIGITS}\s*(?:([:/])\s*{_DIGITS})?\s*", re.ASCII)
_GROUPS = re.compile(  # 1 450, 1'450, 1.450,5 and 1,450.5: what separates thousands is certain
    r"\s*([0-9]{1,3}(?:(?:[ '\u2019\u202f\u00a0][0-9]{3})+(?![0-9])"
    r"|(?:\.[0-9]{3})+(?=,)|(?:,[0-9]{3})+(?=\.)))([.,][0-9]+)?\s*([^\s\d.,].*)"
)
_GERMAN = {"U/min": "rpm", "U/s": "1/s"}  # units of those who separate thousands by a point
_SLIP = re.compile(rf"\s*{_NUMBER}\s*((?![eE][+-]?[0-9])[^\s\d.,].*?|1/\S+)?\s*")


class Table(BaseModel):
    """A table of a problem file: frozen, unknown keys refused.

    ANSWERS: whether its numbers decide an answer, so that remedies and sensitivities move them.
    """

    ANSWERS: ClassVar[bool] = True
    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)
    _followed: frozenset[str] = frozenset()  # keys that the file whose gears it takes has of it

    @property
    def stated(self) -> set[str]:
        """Return the keys that the file has, or the file whose gears it takes."""
        return self.model_fields_set | self._followed


@dataclass(frozen=True)
class Opened:
    """The files that are being read: each names the next one as its input; the last is this one.

    ask: the `Ask` by which a file is solved whose gears this one takes; None: by default.
    """

    files: tuple[Path, ...]
    ask: Any = None


FOLLOWS = "follows from the gears of another file, where they are taken"  # of keys that are needed


@dataclass(frozen=True)
class Reads:
    """How a value of a file is read: read(value, example) -> value, or raises `refuse(...)`.

    example: a right value, shown where a wrong one stands. schema: the JSON schema of the value.
    opens: the value names a file, and `Opened` (None of no file) is a third argument.
    """

    reader: Callable[..., Any]
    example: Any
    schema: dict[str, Any]
    opens: bool = False

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        """Let pydantic call the reader and nothing else."""
        if self.opens:
            return core_schema.with_info_plain_validator_function(
                lambda value, info: self.reader(value, self.example, info.context)
            )
        return core_schema.no_info_plain_validator_function(
            lambda value: self.reader(value, self.example)
        )

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Return the JSON schema as it stands."""
        return dict(self.schema)


def refuse(
    rule: str,
    write: Any = None,
    at: tuple[Any, ...] = (),
    action: str = "set",
    instead: str = "",
) -> PydanticCustomError:
    """Return the error for a value: what is wrong, and what to do.

    write: the value to set (None: the field's example), or for `swap` the key to exchange with.
    at: the place below the checked table, for checks of several keys. action: as in
    errors.Fix, or sample: to set, but one right value of many; or tell: `write` is the sentence
    that says what to do, where that takes edits of several keys. instead: a key beside it that
    would do in its place; where that one is only misspelt, this is not told.
    """
    context = {"rule": rule, "write": write, "at": at, "action": action, "instead": instead}
    return PydanticCustomError("gearopt", "{rule}", context)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | Decimal) and not isinstance(value, bool)


def _is_far(value: int | Decimal) -> bool:
    """Return whether a number has so many digits that its fraction should not even be formed."""
    return value.bit_length() > 200 if isinstance(value, int) else abs(value.adjusted()) > 60


def _beginning(value: Any) -> str:
    """Return the beginning of a text, or of a number that is not far off; else ""."""
    plain = isinstance(value, str) or (_is_number(value) and not _is_far(value))
    return str(value)[:80] if plain else ""


def quantity(
    dimension: str,
    example: str,
    limit: str | None = None,
    zero: bool = False,
    signed: bool = False,
) -> Reads:
    """Read a positive quantity such as "7.5 kW"; limit: the largest allowed, zero: whether 0 is.

    signed: it may be below zero as well (a place).
    """
    bound = units.parse(limit, dimension) if limit else None
    names, usual = ", ".join(units.UNITS[dimension]), units.parse(example, dimension)

    def fault(found: Quantity) -> str:
        if not signed and (found.number < 0 or (found.number == 0 and not zero)):
            return "is below zero" if zero else "is not greater than zero"
        if found.number and not SMALLEST < abs(found.number) < LARGEST:
            return OUT_OF_RANGE
        above = bound is not None and found.value > bound.value * (1 + 1e-12)
        return f"is above {limit}" if above else ""

    def likely(digits: str) -> str:
        return _likely_unit(digits, usual)

    def usable(text: str) -> str | None:
        try:
            return None if fault(units.parse(text, dimension)) else text
        except ValueError:
            return None

    def read(value: Any, example: str) -> Quantity:
        if isinstance(value, Quantity):
            return value
        if _is_number(value):
            right = None if _is_far(value) else usable(f"{value} {likely(str(value))}")
            raise refuse(f"is a bare number: {dimension} needs a unit ({names})", right)
        if not isinstance(value, str):
            raise refuse(f"is not a text with a number and a unit of {dimension} ({names})")
        if two := thousands(value, lambda text: _likely_thousands(text, usual)):
            sign = "comma" if "," in value else "point"
            rule = f"has a {sign}, which may separate thousands or decimals"
            raise refuse(rule, f'Write "{two[0]}" or "{two[1]}"', action="tell")
        try:
            parsed = units.parse(value, dimension)
        except ValueError as reason:
            raise refuse(str(reason), usable(meant(value, dimension, likely))) from None
        if rule := fault(parsed):
            raise refuse(rule, usable(value.strip().removeprefix("-")))
        return parsed

    alternatives = "|".join(map(units.pattern, units.UNITS[dimension]))
    sign = "[+-]?" if signed else r"\+?"
    number = sign + r"([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?"
    schema = {"type": "string", "pattern": rf"^\s*{number}\s*({alternatives})\s*$"}
    return Reads(read, example, schema)


def _likely_unit(digits: str, usual: Quantity) -> str:
    """Unit that a number without one may have: that of the usual quantity, if not far from it."""
    apart = {}
    for unit in (usual.unit, *units.UNITS[usual.dimension]):
        try:
            value = abs(units.parse(f"{digits} {unit}", usual.dimension).value)
            apart[unit] = abs(math.log(value / usual.value))
        except (ValueError, ArithmeticError):  # no number, or zero
            return usual.unit
    near = apart[usual.unit] < math.log(FAR_OFF)
    return usual.unit if near else min(apart, key=lambda unit: apart[unit])


def _likely_thousands(text: str, usual: Quantity) -> bool:
    """Whether a decimal point leaves far less than is usual, as in a life of 20.000 h."""
    if usual.dimension not in GROUPED:
        return False
    try:
        amount = units.parse(text, usual.dimension).value
    except ValueError:
        return False
    return 0.0 < amount <= usual.value / FAR_OFF


def number(
    example: Any,
    minimum: int | Fraction,
    maximum: int | Fraction,
    percent: bool = False,
    zero: bool = False,
    fraction: bool = False,
    scale: bool = False,
) -> Reads:
    """Read a pure number, kept exactly as a fraction.

    percent: "1 %" is read too; fraction: "127/120" too. scale: as of `whole`.
    """
    above = f"between {float(minimum):.7g} and" if minimum or zero else "greater than 0 and at most"
    sort = 'a number or a percentage such as "1 %"' if percent else "a number"
    sort += ' or a fraction such as "127/120"' if fraction else ""

    def inside(found: Fraction) -> bool:
        return minimum <= found <= maximum and (found > 0 or zero)

    def read(value: Any, example: Any) -> Fraction:
        if isinstance(value, Fraction):
            return value
        if fraction and isinstance(value, str) and (parts := _FRACTION.fullmatch(value)):
            if not int(parts[2]):
                raise refuse("is divided by zero")
            parsed = Fraction(int(parts[1]), int(parts[2]))
        elif isinstance(value, str):
            try:
                parsed = units.parse(value, "fraction").exact[0]
            except ValueError:
                raise refuse(f"is not {sort}") from None
            if not percent:
                raise refuse("is a text, not a number", float(parsed) if inside(parsed) else None)
        elif not _is_number(value):
            raise refuse(f"is not {sort}")
        elif not Decimal(value).is_finite():
            raise refuse("is not a finite number")
        else:
            parsed = LARGEST if _is_far(value) else Fraction(value)
        if parsed and not SMALLEST < abs(parsed) < LARGEST:
            raise refuse(OUT_OF_RANGE)
        if not inside(parsed):
            raise refuse(f"is not {above} {float(maximum):.7g}", slip(value, parsed))
        return parsed

    def slip(value: Any, found: Fraction) -> Any:
        if percent and _is_number(value) and inside(found / 100):
            return f"{value} %"
        if scale and found >= 0:
            return float(max(minimum, min(found, maximum)))
        return -value if _is_number(value) and inside(-found) else None

    return Reads(read, example, _number_schema(minimum, maximum, percent, fraction))


def _number_schema(
    minimum: int | Fraction, maximum: int | Fraction, percent: bool, fraction: bool
) -> dict[str, Any]:
    """Return the JSON schema of what `number` reads."""
    schema: dict[str, Any] = {"type": "number", "maximum": float(maximum)}
    schema["minimum"] = minimum if isinstance(minimum, int) else float(minimum)
    if percent:
        text = {"type": "string", "pattern": r"^\s*[0-9.]+([eE][+-]?[0-9]+)?\s*%?\s*$"}
        schema = {"anyOf": [schema, text]}
    if fraction:
        text = {"type": "string", "pattern": r"^\s*[0-9]+\s*/\s*[0-9]+\s*$"}
        schema = {"anyOf": [schema, text]}
    return schema


def speed_ratio(example: Any, minimum: int | Fraction) -> Reads:
    """Read a ratio of speeds up to a million, exactly: a number, or a fraction as "127/120"."""
    item = number(example, minimum, 10**6, fraction=True)

    def read(value: Any, example: Any) -> Fraction:
        try:
            ratio: Fraction = item.reader(value, example)
        except PydanticCustomError:
            parts = _QUOTIENT.fullmatch(_beginning(value))
            above, below = (Fraction(p or 1) for p in (parts.group(1, 3) if parts else "00"))
            if parts is None or not above or not below:
                raise
            if parts[2] != ":":
                raise
            ratio = above / below
            write = ratio.numerator if ratio.denominator == 1 else str(ratio)
            item.reader(write, example)
            if ratio < 1:  # that of a reducer, most likely
                rule = f"is written with a colon: {write} is that of a drive that increases speed"
                raise refuse(rule, Decimal(f"{float(1 / ratio):.5g}")) from None
            raise refuse("is written with a colon", write) from None
        return ratio

    return Reads(read, item.example, item.schema)


def whole(example: int, minimum: int, maximum: int, scale: bool = False) -> Reads:
    """Read a whole number.

    scale: it is a grade, of which the nearest is written instead of one beyond the ends.
    """

    def read(value: Any, example: Any) -> int:
        if isinstance(value, str) and re.fullmatch(r"\s*[0-9]{1,9}\s*", value):
            meant = int(value) if minimum <= int(value) <= maximum else None
            raise refuse("is a text, not a whole number", meant)
        if isinstance(value, Decimal) and value.is_finite() and minimum <= value <= maximum:
            raise refuse("is not a whole number", int(value))
        if isinstance(value, bool) or not isinstance(value, int):
            raise refuse("is not a whole number")
        if not minimum <= value <= maximum:
            meant = minimum if 0 <= value < minimum else None  # the largest is no sensible one
            meant = -value if minimum <= -value <= maximum else meant
            meant = maximum if scale and value > maximum else meant
            raise refuse(f"is not a whole number from {minimum} to {maximum}", meant)
        return value

    return Reads(read, example, {"type": "integer", "minimum": minimum, "maximum": maximum})


def choice(
    *names: str, means: dict[str, str] | None = None, other: dict[str, str] | None = None
) -> Reads:
    """Read one of some words.

    means: other words for some of them, which are read as they are. other: words that may mean
    several things, each with a sentence that says what to write.
    """
    means, other = means or {}, other or {}

    def read(value: Any, example: Any) -> str:
        if isinstance(value, str) and value in means:
            return means[value]
        if isinstance(value, str) and (ways := other.get(value)):
            known = ", ".join(f'"{n}"' for n in names)
            raise refuse(f"is not one of {known}", ways, action="tell")
        if value not in names or not isinstance(value, str):
            known = ", ".join(f'"{n}"' for n in names)
            year = isinstance(value, int) and abs(value) < 10_000  # a word that is written as one
            close = near(str(value), names) if isinstance(value, str) or year else None
            raise refuse(f"is not {'one of ' * (len(names) > 1)}{known}", close)
        return value

    return Reads(read, names[0], {"enum": [*names, *means]})


def advised(item: Reads, ways: dict[str, str]) -> Reads:
    """Read an item; what is refused and matches a pattern is told what its sentence says.

    ways: regular expressions of whole values as text, in any case; the first that fits counts, and
    its groups stand in the sentence as in `re.Match.expand`.
    """

    def read(value: Any, example: Any) -> Any:
        try:
            return item.reader(value, example)
        except PydanticCustomError as wrong:
            several = value[:4] if isinstance(value, list) else [value]
            text = " ".join(map(_beginning, several)).strip()
            tried = ((re.fullmatch(known, text, re.IGNORECASE), way) for known, way in ways.items())
            if (way := next((fits.expand(way) for fits, way in tried if fits), None)) is None:
                raise
            raise refuse((wrong.context or {})["rule"], way, action="tell") from None

    return Reads(read, item.example, item.schema)


def truth() -> Reads:
    """Read true or false."""

    def read(value: Any, example: Any) -> bool:
        if not isinstance(value, bool):
            word = value.lower() if isinstance(value, str) else value
            raise refuse("is neither true nor false", word not in ("false", "no", "off", 0))
        return value

    return Reads(read, True, {"type": "boolean"})


def words() -> Reads:
    """Read free text of a line or two."""

    def read(value: Any, example: Any) -> str:
        if isinstance(value, Date):
            return str(value)
        if not isinstance(value, str):
            plain = _is_number(value) and not _is_far(value)
            raise refuse("is not a text", str(value) if plain else None)
        if len(value) > 1000 or not value.isprintable():
            cleaned = "".join(c for c in " ".join(value.split()) if c.isprintable())[:1000]
            raise refuse("has line breaks or more than 1000 characters", cleaned)
        return value

    return Reads(read, "a text", {"type": "string", "maxLength": 1000})


def thousands(text: str, likely: Callable[[str], bool]) -> tuple[str, str] | None:
    """Return both readings of "1,450 rpm", whose comma may separate thousands; None without one.

    A point may do so beside a German unit, as in "1.450 U/min", or before a last 0 where that is
    likely: the second reading, which has none, is not asked back again.
    """
    match = _THOUSANDS.fullmatch(text[:80])
    if match is None:
        return None
    whole, sign, decimals, word = match.groups()
    grouped = whole[0] != "0" and decimals[-1] == "0" and likely(text)
    if sign == "." and word.strip() not in _GERMAN and not grouped:
        return None
    unit = f" {_GERMAN.get(word.strip(), word)}".rstrip()
    return f"{whole}{decimals}{unit}", f"{whole}.{decimals}".rstrip("0").rstrip(".") + unit


def meant(text: str, dimension: str, likely: Callable[[str], str]) -> str:
    """Return a text with its separators and its unit put right; "" where that cannot be done.

    likely: the unit of a number, as text, that has none.
    """
    if groups := _GROUPS.fullmatch(text[:80]):
        digits, rest, word = groups.groups("")
        text = f"{re.sub('[^0-9]', '', digits)}{rest} {word}"
    match = _SLIP.fullmatch(text[:80])
    if match is None:
        return ""
    word = match[2] or likely(match[1].replace(",", "."))
    unit = units.named(word, dimension, re.IGNORECASE)
    if unit is None or (unit[0] != word[0] and unit[1:] == word[1:]):
        return ""  # not MW for mW: that is another unit, and the number would be wrong
    return f"{match[1].replace(',', '.')} {unit}"


class ReportHead(Table):
    """What stands in the title block of the page and of the PDF, as it is written here.

    The title is that at the top of the file. It changes no number of the answer.
    """

    company: Annotated[str, words()] = Field("", description="Who designed the gears")
    customer: Annotated[str, words()] = Field("", description="For whom")
    number: Annotated[str, words()] = Field("", description="Number of the report or the project")
    revision: Annotated[str, words()] = Field("", description="Its revision")
    date: Annotated[str, words()] = Field("", description="Its date; none is added by itself")
    engineer: Annotated[str, words()] = Field("", description="Who prepared it")
    approved: Annotated[str, words()] = Field("", description="Who approved it")
    note: Annotated[str, words()] = Field("", description="A remark of a line or two")
    paper: Annotated[str | None, choice("A4", "Letter")] = Field(
        None, description="Paper of the PDF; by default A4, in inches Letter"
    )
    appendix: Annotated[bool, truth()] = Field(
        False, description="Whether paper has what only a specialist checks, as rating factors"
    )


class ProblemFile(Table):
    """What files of all kinds have."""

    title: Annotated[str, words()] = Field("", description="Title of the report")
    source: Annotated[str, words()] = Field(
        "", description="Where the data and the expected value come from"
    )
    report: ReportHead | None = None
