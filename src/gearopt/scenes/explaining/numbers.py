"""The numbers of a scene by their place in the file: list them, move them, write them."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import PydanticCustomError

from gearopt.frozen import dataclass
from gearopt.optimise.explaining.proposed import DIGITS, FEASIBILITY_MARGIN
from gearopt.scenes.reading.choices import Between, Preferred, Steps
from gearopt.scenes.reading.fields import Reads
from gearopt.scenes.reading.toml_writing import dotted, exact, toml_text
from gearopt.units import Quantity

SHORT = 4  # digits of a number that is kept as it is
MET = 5e-9  # relative, by which it may miss: half of what a row may exceed its limit
STEP_FROM_ZERO = Fraction(1, 10)  # step from zero, in the unit of a number
SLIGHT = 1e-4  # mm; by at most this a length in a remedy is rounded
Path = tuple[str | int, ...]
COUNTS: set[Path] = {("stages",), ("stages", 0), ("stages", 1), ("gears", "stage")}


@dataclass(frozen=True)
class Number:
    """A number of the file. path: its place; value: a quantity, an exact fraction or an integer.

    A range of equal ends (one number in the file means both) is one number.
    """

    path: Path
    value: Any

    @property
    def key(self) -> str:
        """Return its place as messages write it: `stage[2].face_width_over_diameter`."""
        return dotted(self._written)

    @property
    def _written(self) -> Path:
        """Return its place in the file: of a range of diametral pitches the larger is last."""
        flipped = in_reverse(self.value, self.path[:-1])
        end = self.path[-1]
        return (*self.path[:-1], 1 - end) if flipped and isinstance(end, int) else self.path

    @property
    def text(self) -> str:
        """Return the number as the file writes it."""
        return toml_text(written(self.value, self.path)).strip('"')


def in_reverse(value: Any, path: Path) -> bool:
    """Return whether a range has its ends in the file the other way: diametral pitches."""
    end = value[0] if isinstance(value, tuple) and value else value
    return path[-1:] == ("module",) and isinstance(end, Quantity) and end.reciprocal


def numbers(scene: BaseModel, defaults: bool = False) -> tuple[Number, ...]:
    """Return every number that the file gives, in the order of its tables.

    defaults: those too that the file leaves out. Counts and tables that decide no answer are none.
    """
    return tuple(n for n in _walk(scene, (), defaults) if n.path not in COUNTS)


def _walk(value: Any, path: Path, defaults: bool) -> Iterator[Number]:
    if isinstance(value, BaseModel):
        for name in type(value).model_fields if getattr(value, "ANSWERS", True) else ():
            if defaults or name in value.model_fields_set:
                held = getattr(value, name)
                entry = held[0] if _is_one(type(value), name, held, (*path, name)) else held
                yield from _walk(entry, (*path, name), defaults)
    elif isinstance(value, tuple):
        items = list(enumerate(value))
        for k, item in items[::-1] if in_reverse(value, path) else items:
            yield from _walk(item, (*path, k), defaults)
    elif isinstance(value, Quantity | Fraction | int) and not isinstance(value, bool):
        yield Number(path, value)


def _is_one(model: type[BaseModel], field: str, value: Any, path: Path) -> bool:
    """Return whether a value is a range of equal ends, which its file may write as one number."""
    if not isinstance(value, tuple) or len(value) != 2 or value[0] != value[1]:
        return False
    try:
        return bool(read(model, field, written(value[0], path)) == value)
    except (PydanticCustomError, ValueError):  # a place, or a list of tables
        return False


def at(scene: Any, path: Path) -> Any:
    """Value at a place."""
    for step in path:
        scene = scene[step] if isinstance(step, int) else getattr(scene, step)
    return scene


def one_at(scene: Any, path: Path) -> Any:
    """Value at the place of a `Number`: of a range of equal ends one of them."""
    value = at(scene, path)
    return value[0] if isinstance(value, tuple) else value


def put(scene: Any, path: Path, value: Any) -> Any:
    """Return the scene with another value at a place; not checked against the file's rules."""
    if not path:
        return value
    step, rest = path[0], path[1:]
    if isinstance(step, int):
        return scene[:step] + (put(scene[step], rest, value),) + scene[step + 1 :]
    here = getattr(scene, step)
    single = value is not None and not isinstance(value, tuple)
    pair = not rest and isinstance(here, tuple) and single
    return scene.model_copy(update={step: put(here, rest, (value, value) if pair else value)})


def moved(scene: BaseModel, path: Path, value: Any) -> Any:
    """Return the scene with another value at a place; None where the rules of the file refuse it.

    A fraction where a whole number stands (real-valued teeth) is judged by the next whole number
    beyond it.
    """
    now, judged = at(scene, path), value
    if isinstance(now, tuple) and not isinstance(value, tuple):
        now = now[0]
    if isinstance(now, int) and isinstance(value, Fraction):
        judged = math.floor(value) if value < now else math.ceil(value)
    return put(scene, path, value) if allowed(put(scene, path, judged)) else None


def allowed(scene: BaseModel) -> bool:
    """Return whether a scene is one that its file's own rules take."""
    try:
        type(scene).model_validate(content(scene))
    except ValidationError:
        return False
    return True


def content(scene: BaseModel, given: bool = True) -> dict[str, Any]:
    """Content of the file of a scene, or of a table, to be read again by its own rules.

    given: what the file itself has; else whatever is not the usual value.
    """
    tables: dict[str, Any] = _content(scene, (), given)
    return tables


def _content(value: Any, path: Path, given: bool) -> Any:
    if isinstance(value, BaseModel):
        return {
            name: _content(held, (*path, name), given)
            for name, info in type(value).model_fields.items()
            if (held := getattr(value, name)) is not None
            and (
                name in value.model_fields_set
                if given
                else held != info.get_default(call_default_factory=True)
            )
        }
    if isinstance(value, tuple):
        values = [_content(v, path, given) for v in value]
        return values[::-1] if in_reverse(value, path) else values
    return written(value, path)


def times(value: Any, factor: float | Fraction) -> Any:
    """Return a number of a file times a factor, unrounded."""
    if isinstance(value, Quantity):
        return replace(value, number=value.number * Fraction(factor))
    return value * Fraction(factor)


def read(model: type[BaseModel], field: str, raw: Any) -> Any:
    """Return a raw value through the reader of a field; PydanticCustomError: it is refused."""
    (reads,) = (m for m in model.model_fields[field].metadata if isinstance(m, Reads))
    return reads.reader(raw, reads.example)


def written(value: Any, path: Path) -> Any:
    """Return a value as a file holds it at a place: quantities as texts, decimals, lists."""
    if path[-1:] == ("ratio_tolerance",):
        return f"{exact(100 * value)} %"
    if isinstance(value, Quantity):
        return f"{exact(value.number)} {value.unit}".rstrip()
    if isinstance(value, Fraction):
        return exact(value) if _is_decimal(value) or not _is_ratio(path) else str(value)
    if isinstance(value, Steps | Between | Preferred):
        return value.written
    if isinstance(value, tuple):
        ends: list[Any] = [written(v, path) for v in value]
        if len(ends) == 2 and value[0] == value[1]:
            return ends[0]
        return ends[::-1] if in_reverse(value, path) else ends
    return value


def _is_ratio(path: Path) -> bool:
    """Return whether `speed_ratio` reads what stands at a place: fractions too."""
    return any(name in ("ratio", "stage_ratio", "stage_ratios") for name in path[-2:])


def _is_decimal(value: Fraction) -> bool:
    """Return whether a fraction has finitely many decimals."""
    return bool(10 ** value.denominator.bit_length() % value.denominator == 0)


def eased(value: Any, factor: float, direction: int) -> Any:
    """Return a number moved by a factor >= 1 up (+1) or down (-1), rounded to relax the limit.

    Integers stay integers (one that is meant but for rounding is taken); others keep DIGITS digits
    and get FEASIBILITY_MARGIN, to be feasible in doubles. Zero is shifted by (factor - 1)
    STEP_FROM_ZERO in its own unit, a whole one by ones.
    """
    if not getattr(value, "number", value):
        return _shifted(value, factor, direction)
    if isinstance(value, Quantity):
        way = -direction if value.reciprocal else direction
        return replace(value, number=_rounded(value.number * Fraction(factor) ** way, way))
    moved = Fraction(factor) ** direction
    if isinstance(value, int):
        number, near = float(value * moved), round(value * moved)
        if abs(number - near) <= FEASIBILITY_MARGIN * number:
            return near
        return math.ceil(number) if direction > 0 else math.floor(number)
    return _rounded(value * moved, direction)


def cut(value: Any, way: int, digits: int = DIGITS) -> Any:
    """Return a quantity or fraction of so many digits, rounded up (+1) or down (-1)."""
    number = value.number if isinstance(value, Quantity) else value
    context = Context(prec=digits, rounding=ROUND_CEILING if way > 0 else ROUND_FLOOR)
    short = Fraction(context.divide(Decimal(number.numerator), Decimal(number.denominator)))
    return replace(value, number=short) if isinstance(value, Quantity) else short


def rounded(size: float, like: Quantity, direction: float) -> str:
    """Return a length in mm in the unit of another, rounded up (> 0) or down by at most SLIGHT."""
    per_mm = float(like.of(Fraction(1)).number)
    digits = 10.0 ** math.ceil(-math.log10(per_mm * SLIGHT) - 1e-9)
    whole = (math.ceil if direction > 0 else math.floor)(round(size * per_mm * digits, 6))
    return f"{whole / digits:.12g} {like.unit}"


def _shifted(zero: Any, factor: float, direction: int) -> Any:
    if isinstance(zero, int):
        return direction * math.ceil(factor - 1.0)
    number = direction * _rounded((Fraction(factor) - 1) * STEP_FROM_ZERO, 1)
    return replace(zero, number=number) if isinstance(zero, Quantity) else number


def _rounded(value: Fraction, direction: int) -> Fraction:
    """Return a number of DIGITS digits with room to relax the limit; a short one is kept."""

    def decimal(number: Fraction, digits: int, rounding: str) -> Fraction:
        context = Context(prec=digits, rounding=rounding)
        return Fraction(context.divide(Decimal(number.numerator), Decimal(number.denominator)))

    short = decimal(value, SHORT, ROUND_HALF_EVEN)
    if abs(short - value) <= MET * value:
        return short
    roomy = value * Fraction(1.0 + FEASIBILITY_MARGIN) ** direction
    return decimal(roomy, DIGITS, ROUND_CEILING if direction > 0 else ROUND_FLOOR)


def taken_back(now: Any, before: Any, part: float) -> Any:
    """Return a value moved back by a part of its size; integers by one."""
    if isinstance(now, tuple):
        old = before if isinstance(before, tuple) else (before, before)
        return tuple(taken_back(a, b, part) for a, b in zip(now, old, strict=True))
    number, target = (v.number if isinstance(v, Quantity) else v for v in (now, before))
    if number == target:
        return now
    if isinstance(now, int):
        return now + (1 if target > number else -1)
    return times(now, 1.0 - part if number > target else 1.0 + part)


def apart(before: Any, after: Any) -> float:
    """Return how far two values are apart, as a factor >= 1; of ranges, the product of both ends'.

    Ends that were equal and are equal are one number.
    """
    if isinstance(before, tuple):
        if before[0] == before[1] and after[0] == after[1]:
            return apart(before[0], after[0])
        return math.prod(apart(a, b) for a, b in zip(before, after, strict=True))
    a, b = (float(v.number if isinstance(v, Quantity) else v) for v in (before, after))
    return max(a, b) / min(a, b) if min(a, b) > 0.0 else math.inf


def around(ends: Any, series: Sequence[Fraction]) -> list[str]:
    """The narrowest range of a series of modules [mm] around one, by its ends, that holds none."""
    below = max((m for m in series if m < ends[0].exact[0]), default=series[0])
    above = min((m for m in series if m > ends[1].exact[0]), default=series[-1])
    wider = eased(ends[0].of(below), 1.0, -1), eased(ends[1].of(above), 1.0, 1)
    module_range = written(wider, ("limits", "module"))
    return module_range if isinstance(module_range, list) else [module_range, module_range]
