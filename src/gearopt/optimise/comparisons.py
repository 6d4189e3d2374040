"""Limits that a text writes as comparisons, `x.a <= x.b`: how they become rows of a problem.

A text that does so is run on `Quantity`s, which compute as what they stand for and keep what is
compared. A row is the quotient of both sides where the greater one is a positive number, or made of
positive numbers and variables with `log=True` alone: posynomials and linear rows stay what they
are. Else it is 1 + (lesser - greater)/scale, the scale being the larger of both at the guess.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Block, Named, Terms, flat

POSITIVE = {np.add, np.multiply, np.divide, np.sqrt, np.power, np.maximum, np.minimum, np.hypot}
KEPT = {np.less_equal: "<=", np.greater_equal: ">=", np.equal: "=="}
ROWS = ("limits", "defines", "equal")
CHAINED = (
    "A comparison has no truth value here: write low <= x and x <= high as two limits, and a "
    "choice by np.where"
)


class Quantity(NDArrayOperatorsMixin):
    """A number, array or symbol of a text; positive: it is above 0 wherever the problem is."""

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, value: Any, positive: bool = False) -> None:
        self.value, self.positive = value, positive

    def __array_ufunc__(self, function: Any, method: str, *inputs: Any, **more: Any) -> Any:
        if method != "__call__":
            return NotImplemented
        if function in KEPT:
            return Comparison(inputs[0], inputs[1], KEPT[function])
        values = function(*map(plain, inputs), **more)
        above = function is np.exp or function in POSITIVE and all(map(positive, inputs))
        if isinstance(values, tuple):
            return tuple(map(Quantity, values))
        return Quantity(values, above)

    def __array_function__(self, function: Any, types: Any, inputs: Any, more: Any) -> Any:
        return Quantity(function(*_plain(inputs), **more))

    def __getattr__(self, name: str) -> Callable[..., Any]:
        function = getattr(np, name, None)
        if not isinstance(function, np.ufunc):
            raise AttributeError(f"a scalar of the text has no {name}")
        return lambda *others: function(self, *others)  # as numpy asks the objects of an array

    def __float__(self) -> float:
        return float(self.value)

    def __bool__(self) -> bool:
        return bool(self.value)


@dataclass(frozen=True)
class ComparedNumber:
    """The number that a limit is compared with, a literal of the text or a parameter by its name.

    sign: +1 where a larger one is easier, -1 where a smaller one is. scale: of the row where it is
    a difference, 0 where it is a quotient.
    """

    value: float
    sign: int
    scale: float
    parameter: str = ""


class Comparison:
    """Two sides of a limit; what np.where takes it for is whether it holds."""

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, left: Any, right: Any, sign: str) -> None:
        self.lesser, self.greater = (right, left) if sign == ">=" else (left, right)
        self.equal = sign == "=="

    def __array_function__(self, function: Any, types: Any, inputs: Any, more: Any) -> Any:
        return Quantity(function(*_plain(inputs), **more))

    def __bool__(self) -> bool:
        raise TypeError(CHAINED)

    @property
    def value(self) -> Any:
        """Whether it holds: a bool, an array, or a symbol."""
        lesser, greater = plain(self.lesser), plain(self.greater)
        return lesser == greater if self.equal else lesser <= greater

    def row(self, scale: float) -> Any:
        """A term that must not exceed 1, or must be 1; scale: of a difference, 0 for a quotient."""
        lesser, greater = plain(self.lesser), plain(self.greater)
        return lesser / greater if scale == 0.0 else 1.0 + (lesser - greater) / scale

    def scale(self) -> float:
        """The scale of the row, of a comparison of floats; 0 where it is a quotient."""
        if positive(self.greater):
            return 0.0
        larger = max(abs(float(plain(side))) for side in (self.lesser, self.greater))
        return larger if 0.0 < larger < np.inf else 1.0

    def number(self, scale: float, parameters: Mapping[str, Any]) -> ComparedNumber | None:
        """The number on one of its sides, None where there is none, or it is a balance."""
        if self.equal:
            return None
        for side, sign in ((self.greater, 1), (self.lesser, -1)):
            names = [name for name, value in parameters.items() if value is side]
            if names or not isinstance(side, Quantity):
                return ComparedNumber(float(plain(side)), sign, scale, "".join(names))
        return None


def quantities(scalars: Named, above: Mapping[str, bool]) -> Named:
    """Scalars by name, to be compared; above: those known to be above 0."""
    compared: dict[str, Any] = {}
    for name, value in vars(scalars).items():
        known = above.get(name, False)
        block = [Quantity(v, known) for v in value] if isinstance(value, Block) else None
        compared[name] = Quantity(value, known) if block is None else Block(block)
    return Named(**compared)


def plain(value: Any) -> Any:
    """Return the value of a quantity or comparison; anything else as it is."""
    return value.value if isinstance(value, Quantity | Comparison) else value


def _plain(values: Any) -> Any:
    if isinstance(values, tuple | list):
        return type(values)(map(_plain, values))
    return plain(values)


def positive(value: Any) -> bool:
    """Whether a quantity or a number is known to be above 0."""
    if isinstance(value, Quantity):
        return value.positive
    return isinstance(value, float | int | np.number) and bool(value > 0.0)


def compares(terms: Any) -> bool:
    """Whether terms of a text on floats hold a comparison, True or False, among their limits."""
    blocks = [getattr(terms, part) for part in ROWS] if isinstance(terms, Terms) else []
    rows = [v for block in blocks if isinstance(block, Mapping) for _, v in flat(block)]
    return any(isinstance(v, bool | np.bool_) for v in rows)


def rows(
    terms: Terms, scales: dict[str, float], numbers: dict[str, ComparedNumber], parameters: Named
) -> Terms:
    """Terms with comparisons made rows; those with == stand among the equal rows.

    scales, numbers: by name, as the first run on floats, at the guess, finds them; they are kept
    there. parameters: as the text was given them.
    """
    known = scales, numbers, vars(parameters)
    parts: dict[str, dict[str, Any]] = {part: {} for part in ROWS}
    for part in ROWS:
        for name, value in getattr(terms, part).items():
            block = value if isinstance(value, tuple | list) else (value,)
            balance = any(isinstance(v, Comparison) and v.equal for v in block)
            names = [f"{name}[{k}]" if block is value else name for k in range(1, len(block) + 1)]
            rows = tuple(_row(v, n, *known) for v, n in zip(block, names, strict=True))
            parts["equal" if balance else part][name] = rows if block is value else rows[0]
    shown = [{k: _plain(v) for k, v in getattr(terms, p).items()} for p in ("minimise", "report")]
    return replace(terms, minimise=shown[0], report=shown[1], **parts)


def _row(
    value: Any,
    name: str,
    scales: dict[str, float],
    numbers: dict[str, ComparedNumber],
    parameters: Mapping[str, Any],
) -> Any:
    if not isinstance(value, Comparison):
        return plain(value)
    if name not in scales:
        scales[name] = value.scale()
        if (number := value.number(scales[name], parameters)) is not None:
            numbers[name] = number
    return value.row(scales[name])
