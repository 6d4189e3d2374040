"""Ranges of functions over boxes of numbers: interval arithmetic with derivatives.

The text of a law is run on `Range`s in the place of numbers. A range is what interval arithmetic
gives, cut down to f(middle) + sum of [df/dx_k] [-r_k, r_k], the mean value theorem: it exceeds the
true one by the square of the box's size. Rounding is not directed: allow for it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.optimise.terms import Array

Pair = tuple[Any, Any]


def _times(a: Pair, b: Pair) -> Pair:
    made = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return np.minimum.reduce(made), np.maximum.reduce(made)


@dataclass(frozen=True, eq=False)
class Range:
    """The range of a number in boxes (n,): low and high; at their middles; slopes by variable.

    slopes: least and greatest derivative, (2, n) each, by variable; half: half the width of boxes
    (variables, n).
    """

    low: Array
    high: Array
    middle: Array
    slopes: tuple[Pair, ...]
    half: Array

    @classmethod
    def variables(cls, ends: list[Array]) -> list["Range"]:
        """Return variables between ends (2, n) each."""
        half = np.array([0.5 * (high - low) for low, high in ends])
        zero, one = np.zeros(half.shape[1]), np.ones(half.shape[1])
        found = []
        for k, (low, high) in enumerate(ends):
            slopes = tuple((one, one) if k == j else (zero, zero) for j in range(len(ends)))
            found.append(cls(low, high, 0.5 * (low + high), slopes, half))
        return found

    def made(self, ends: Pair, middle: Any, slopes: tuple[Pair, ...]) -> "Range":
        """Return a range of the same variables, cut down by the mean value theorem."""
        sizes = [np.maximum(np.abs(low), np.abs(high)) for low, high in slopes]
        way = sum(size * half for size, half in zip(sizes, self.half, strict=True))
        low, high = np.fmax(ends[0], middle - way), np.fmin(ends[1], middle + way)
        return Range(low, high, middle, slopes, self.half)

    def by(self, law: Callable[[Any], Any], ends: Pair, slope: Pair) -> "Range":
        """Return a law of this number; ends and slope: of the law over the range."""
        slopes = tuple(_times(slope, own) for own in self.slopes)
        return self.made(ends, law(self.middle), slopes)

    def rising(self, law: Callable[[Any], Any], slope: Callable[[Any], Any]) -> "Range":
        """Return a rising law whose derivative is monotone."""
        ends = slope(self.low), slope(self.high)
        return self.by(law, (law(self.low), law(self.high)), (np.minimum(*ends), np.maximum(*ends)))

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        """Apply a function of numpy; TypeError for others than those of LAWS, by numpy."""
        if method != "__call__" or ufunc.__name__ not in LAWS:
            return NotImplemented
        return LAWS[ufunc.__name__](*inputs)

    def __add__(self, other: Any) -> "Range":
        return _add(self, other)

    __radd__ = __add__

    def __sub__(self, other: Any) -> "Range":
        return _add(self, -other)

    def __rsub__(self, other: Any) -> "Range":
        return _add(-self, other)

    def __neg__(self) -> "Range":
        slopes = tuple((-high, -low) for low, high in self.slopes)
        return Range(-self.high, -self.low, -self.middle, slopes, self.half)

    def __mul__(self, other: Any) -> "Range":
        return _multiply(self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> "Range":
        return _multiply(self, _inverse(other))

    def __rtruediv__(self, other: Any) -> "Range":
        return _multiply(_inverse(self), other)

    def __pow__(self, other: Any) -> "Range":
        return _power(self, other)


def _add(one: Any, other: Any) -> Range:
    if not isinstance(one, Range):
        one, other = other, one
    if not isinstance(other, Range):
        ends = one.low + other, one.high + other
        return Range(*ends, one.middle + other, one.slopes, one.half)
    slopes = tuple((a + c, b + d) for (a, b), (c, d) in zip(one.slopes, other.slopes, strict=True))
    ends = one.low + other.low, one.high + other.high
    return one.made(ends, one.middle + other.middle, slopes)


def _multiply(one: Any, other: Any) -> Range:
    if not isinstance(one, Range):
        one, other = other, one
    if not isinstance(other, Range):
        ends = np.minimum(one.low * other, one.high * other)
        top = np.maximum(one.low * other, one.high * other)
        slopes = tuple(_times((other, other), own) for own in one.slopes)
        return Range(ends, top, one.middle * other, slopes, one.half)
    first, second = (one.low, one.high), (other.low, other.high)
    slopes = []
    for own, its in zip(one.slopes, other.slopes, strict=True):
        a, b = _times(second, own), _times(first, its)
        slopes.append((a[0] + b[0], a[1] + b[1]))
    return one.made(_times(first, second), one.middle * other.middle, tuple(slopes))


def _inverse(value: Any) -> Any:
    if not isinstance(value, Range):
        return 1.0 / value
    sound = value.low * value.high > 0.0
    ends = [np.where(sound, 1.0 / x, np.nan) for x in (value.high, value.low)]
    slopes = [-(1.0 / x**2) for x in (value.low, value.high)]
    between = np.minimum(*slopes), np.maximum(*slopes)
    return value.by(lambda x: 1.0 / x, (ends[0], ends[1]), between)


def _power(value: Any, exponent: Any) -> Range:
    if isinstance(exponent, Range):
        return _exp(exponent * _log(value))
    if exponent == 2:
        return _square(value)
    found: Range = _exp(exponent * _log(value))
    return found


def _square(value: Range) -> Range:
    a, b = value.low**2, value.high**2
    least = np.where(value.low * value.high < 0.0, 0.0, np.minimum(a, b))
    return value.by(np.square, (least, np.maximum(a, b)), (2.0 * value.low, 2.0 * value.high))


def _exp(value: Any) -> Any:
    return value.rising(np.exp, np.exp) if isinstance(value, Range) else np.exp(value)


def _log(value: Any) -> Any:
    return value.rising(np.log, lambda x: 1.0 / x) if isinstance(value, Range) else np.log(value)


def _sine(value: Range) -> Range:
    """Return the sine of an angle from -pi/2 to pi/2; NaN beyond."""
    inside = (value.low >= -0.5 * np.pi) & (value.high <= 0.5 * np.pi)
    ends = [np.where(inside, np.sin(x), np.nan) for x in (value.low, value.high)]
    return value.by(np.sin, (ends[0], ends[1]), _cosines(value))


def _cosines(value: Range) -> Pair:
    """Return the range of the cosine of an angle from -pi to pi."""
    a, b = np.cos(value.low), np.cos(value.high)
    most = np.where(value.low * value.high <= 0.0, 1.0, np.maximum(a, b))
    return np.minimum(a, b), most


def _cosine(value: Range) -> Range:
    slopes = -np.sin(value.high), -np.sin(value.low)
    return value.by(np.cos, _cosines(value), (np.minimum(*slopes), np.maximum(*slopes)))


def _tangent(value: Range) -> Range:
    inside = (value.low > -0.5 * np.pi) & (value.high < 0.5 * np.pi)
    ends = [np.where(inside, np.tan(x), np.nan) for x in (value.low, value.high)]
    low, high = _cosines(value)
    return value.by(np.tan, (ends[0], ends[1]), (high**-2, low**-2))


def _arctan(value: Any) -> Any:
    a, b = 1.0 / (1.0 + value.low**2), 1.0 / (1.0 + value.high**2)
    most = np.where(value.low * value.high <= 0.0, 1.0, np.maximum(a, b))
    ends = np.arctan(value.low), np.arctan(value.high)
    return value.by(np.arctan, ends, (np.minimum(a, b), most))


def _root(value: Range) -> Range:
    return value.rising(np.sqrt, lambda x: 0.5 / np.sqrt(x))


LAWS: dict[str, Callable[..., Any]] = {
    "add": _add,
    "subtract": lambda a, b: _add(a, -b),
    "multiply": _multiply,
    "divide": lambda a, b: _multiply(a, _inverse(b)),
    "negative": lambda a: -a,
    "power": _power,
    "square": _square,
    "sqrt": _root,
    "exp": _exp,
    "log": _log,
    "sin": _sine,
    "cos": _cosine,
    "tan": _tangent,
    "arctan": _arctan,
    "arctan2": lambda y, x: _arctan(y / x),  # x > 0
    "hypot": lambda a, b: _root(_power(a, 2) + _power(b, 2)),
}
