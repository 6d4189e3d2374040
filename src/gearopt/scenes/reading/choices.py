"""Field types of problem files for values to choose from: lists, ranges with a step, series."""

import re
from dataclasses import replace
from fractions import Fraction
from typing import Any, cast

from gearopt.frozen import dataclass
from gearopt.physics.preferred_numbers import PREFERRED, preferred_numbers
from gearopt.scenes.reading.fields import Reads, refuse
from gearopt.scenes.reading.lists import mended, several
from gearopt.scenes.reading.toml_writing import exact, toml_text
from gearopt.units import Quantity

MAX_STEPS = 200  # values of a range with a step, at most
KEYS_OF_RANGE = ("from", "to", "step")
KEYS_OF_SERIES = ("from", "to", "series")


def _number(value: Any) -> Fraction:
    number: Fraction = value.number if isinstance(value, Quantity) else value
    return number


def _text(value: Any) -> Any:
    """Return a quantity or a number as a file has it."""
    return str(value) if isinstance(value, Quantity) else exact(value)


@dataclass(frozen=True)
class Steps:
    """A range with a step, both ends included where a step meets them.

    Of quantities of one unit, or of pure numbers.
    """

    low: Any
    high: Any
    step: Any

    @property
    def count(self) -> int:
        """Number of values."""
        low, high, step = map(_number, (self.low, self.high, self.step))
        return int((high - low) / step) + 1

    @property
    def values(self) -> tuple[Any, ...]:
        """The values, ascending."""
        low, step = _number(self.low), _number(self.step)
        numbers = [low + k * step for k in range(self.count)]
        if not isinstance(self.low, Quantity):
            return tuple(numbers)
        return tuple(replace(self.low, number=number) for number in numbers)

    @property
    def written(self) -> dict[str, Any]:
        """The range as a file has it."""
        return dict(zip(KEYS_OF_RANGE, map(_text, (self.low, self.high, self.step)), strict=True))


@dataclass(frozen=True)
class Between:
    """Every value between two ends, of quantities of one unit or of pure numbers."""

    low: Any
    high: Any

    @property
    def values(self) -> tuple[Any, Any]:
        """Both ends."""
        return self.low, self.high

    @property
    def written(self) -> dict[str, Any]:
        """The range as a file has it."""
        return dict(zip(KEYS_OF_RANGE[:2], map(_text, self.values), strict=True))


@dataclass(frozen=True)
class Preferred:
    """Preferred numbers [mm] of a series of ISO 3 from low to high; None: as far as they serve."""

    series: str
    low: Quantity | None = None
    high: Quantity | None = None

    def within(self, low: float, high: float) -> tuple[Quantity, ...]:
        """The values between its own ends, or else between two lengths [mm]."""
        ends = [
            Fraction(other) if own is None else own.exact[0]
            for own, other in ((self.low, low), (self.high, high))
        ]
        return tuple(
            Quantity(value, "mm", "length") for value in preferred_numbers(self.series, *ends)
        )

    @property
    def written(self) -> str | dict[str, str]:
        """The series as a file has it."""
        if self.low is None:
            return self.series
        ends = str(self.low), str(self.high)
        return dict(zip(KEYS_OF_SERIES, (*ends, self.series), strict=True))


# what `to_choose` reads: of quantities, or of pure numbers
Choice = Quantity | Fraction | tuple[Any, ...] | Steps | Between | Preferred


def values_of(value: Choice, reach: tuple[float, float] = (0.0, 0.0)) -> tuple[Any, ...]:
    """The values that a key of `to_choose` holds, of `Between` the ends.

    reach [mm]: those of a series without ends.
    """
    if isinstance(value, Steps | Between):
        return value.values
    if isinstance(value, Preferred):
        return value.within(*reach)
    return value if isinstance(value, tuple) else (value,)


def in_words(value: Choice) -> str:
    """The values that there are to choose from, in words; nothing where there is one."""
    if isinstance(value, Preferred):
        ends = "" if value.low is None else f", {value.low} to {value.high}"
        return f"the series {value.series} of ISO 3 (unverified){ends}"
    if isinstance(value, Between):
        return "all values from {} to {}".format(*map(_text, value.values))
    values = sorted(values_of(value), key=lambda one: getattr(one, "value", one))
    low, high = map(_text, (values[0], values[-1]))
    return f"{len(values)} values, {low} to {high}" if len(values) > 1 else ""


def to_choose(item: Reads, sample: Steps | Preferred, between: bool = False) -> Reads:
    """Read one value, or several to choose from: a list, or a range {from, to, step}.

    between: a range {from, to} without a step, too. sample: a right range. A list or range of one
    value is that value. With a series as the sample also one by its name, or between two ends
    {from, to, series}.
    """
    way = f"Write, for example, {toml_text(sample.written)}"
    in_series = isinstance(sample, Preferred)
    listed = several(item, [item.example])

    def read(value: Any, example: Any) -> Choice:
        if isinstance(value, Steps | Between | Preferred):
            return value
        if between and isinstance(value, dict) and set(value) == set(KEYS_OF_RANGE[:2]):
            return _between(item, value, way)
        if in_series and isinstance(value, str) and value in PREFERRED:
            return Preferred(value)
        if isinstance(value, dict):
            if in_series and set(value) == set(KEYS_OF_SERIES):
                return _of_series(item, value, way)
            return _stepped(item, value, way, " or series" if in_series else "")
        if in_series and isinstance(value, str) and re.match(r"\W*r\W*\d", value, re.I):
            meant = "R" + "".join(re.findall(r"\d", value))
            rule = f"is none of the series {', '.join(PREFERRED)} of ISO 3"
            if meant in PREFERRED:
                raise refuse(rule, meant)
            raise refuse(rule, cast(Preferred, sample).series, action="sample")
        if not isinstance(value, list | tuple):
            return cast(Choice, item.reader(value, item.example))
        entries = listed.reader(list(value), listed.example)
        distinct = tuple({getattr(entry, "exact", entry): entry for entry in entries}.values())
        return cast(Choice, distinct[0]) if len(distinct) == 1 else distinct

    return Reads(read, item.example, {"anyOf": _ways(item, listed, in_series, between)})


def _between(item: Reads, value: dict[str, Any], way: str) -> Choice:
    """Read a range without a step; way: what to write instead of a wrong one."""
    low, high = _entries(item, [value[name] for name in KEYS_OF_RANGE[:2]], way)
    ends = [getattr(end, "value", end) for end in (low, high)]
    if ends[0] > ends[1]:
        raise refuse("has its ends in the wrong order", way, action="tell")
    return Between(low, high) if ends[0] < ends[1] else cast(Choice, low)


def _stepped(item: Reads, value: dict[str, Any], way: str, or_series: str) -> Choice:
    """Read a range with a step; way: what to write instead of a wrong one."""
    if set(value) != set(KEYS_OF_RANGE):
        raise refuse(f"is not a range with from, to and step{or_series}", way, action="tell")
    steps = Steps(*_entries(item, [value[name] for name in KEYS_OF_RANGE], way))
    if len({getattr(end, "unit", "") for end in (steps.low, steps.high, steps.step)}) > 1:
        raise refuse("has entries of different units", way, action="tell")
    if _number(steps.low) > _number(steps.high):
        raise refuse("has its ends in the wrong order", way, action="tell")
    if _number(steps.step) <= 0:
        raise refuse("has no step above zero", way, action="tell")
    if steps.count > MAX_STEPS:
        raise refuse(f"has {steps.count:,} values, above {MAX_STEPS}", way, action="tell")
    return steps if steps.count > 1 else cast(Choice, steps.low)


def _of_series(item: Reads, value: dict[str, Any], way: str) -> Choice:
    """Read preferred numbers between two ends; way: what to write instead of wrong ones."""
    low, high = _entries(item, [value[name] for name in KEYS_OF_SERIES[:2]], way)
    if value["series"] not in PREFERRED:
        raise refuse(f"has no series of {', '.join(PREFERRED)}", way, action="tell")
    if low.value > high.value:
        raise refuse("has its ends in the wrong order", way, action="tell")
    numbers = Preferred(value["series"], low, high)
    if not (inside := numbers.within(0.0, 0.0)):
        raise refuse(f"holds no value of {numbers.series}", way, action="tell")
    return numbers if len(inside) > 1 else inside[0]


def _entries(item: Reads, values: list[Any], way: str) -> list[Any]:
    """The entries of a range as an item reads them."""
    right, rule = mended(item, values)
    if rule:
        raise refuse(f"has an entry that {rule}", way, action="tell")
    return [item.reader(entry, item.example) for entry in right]


def _ways(item: Reads, listed: Reads, in_series: bool, between: bool) -> list[dict[str, Any]]:
    """The schemas of what may be written."""
    ends = {name: item.schema for name in KEYS_OF_RANGE}
    needed = [*KEYS_OF_RANGE[: 2 if between else 3]]
    table = {"type": "object", "properties": ends, "required": needed}
    ways: list[dict[str, Any]] = [item.schema, listed.schema, table]
    if in_series:
        ends = {"from": item.schema, "to": item.schema, "series": {"enum": [*PREFERRED]}}
        table = {"type": "object", "properties": ends, "required": [*KEYS_OF_SERIES]}
        ways += [{"enum": [*PREFERRED]}, table]
    return ways
