"""The text of a problem as columns: variables, and one further column an operation.

The tape is walked once (Smith and Pantelides, Comput. Chem. Eng. 23, 1999). A reading is an affine
form of columns; an operation on readings makes a relation w = op(u, v) of columns, and an affine
argument of several terms a column with a sum. The same operation of the same columns is one column.
What is simplified may drop a domain, never add one, so that the columns' set holds the text's.
Factors that are multiplied or added up here carry by how much they may be off.
"""

import math
from dataclasses import field
from fractions import Fraction
from typing import Any, NoReturn

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.kernels import kernel
from gearopt.optimise.terms import Array

ROOM = "gearopt.optimise.spatial"
SURE = 1e-6  # of a factor: what it is off by for its powers and its inverse to be taken
SMALLEST, LEAST = 1e-290, 1e-320  # factor that is rounded relative to itself; what others lose
ROUNDED = 2.3e-16  # of a factor, twice what one rounding moves it by
ROOT_SWEEPS, SHARE = 20, 0.05
EXACT = 2.0**53
LINEAR, PRODUCT, QUOTIENT, POWER, ROOT, EXP, LOG, SINE, COSINE, TANH, ATAN, ASIN = range(12)
ABS, MAXIMUM, MINIMUM, FLOOR = range(12, 16)
CONTINUOUS, WHOLE, LISTED = 0, 1, 2


@dataclass(frozen=True)
class Affine:
    """constant + sum of factor times column: {column: (factor, error)}; doubt: of constant."""

    terms: dict[int, tuple[float, float]]
    constant: float = 0.0
    doubt: float = 0.0

    @property
    def fixed(self) -> bool:
        """Whether it is a number."""
        return not self.terms


@dataclass(frozen=True)
class Columns:
    """Relations as the kernels take them, and the box of all columns before any propagation.

    variables: number of the first columns, which are the problem's. relations (R, 4): kind, w, u,
    v; exponent (R,). sums: start (R+1,), column, factor, error (E,), constant, doubt (R,). sets:
    sort, first, last (C,), listed values. lower, upper (C,). objective: its column. below (C, n):
    variables that a column depends on. empty: propagation alone proved that there is no point.
    """

    variables: int
    relations: Any
    exponent: Array
    sums: tuple[Any, ...]
    sets: tuple[Any, ...]
    lower: Array
    upper: Array
    objective: int
    below: Any
    empty: bool

    def propagated(self, lower: Array, upper: Array, sweeps: int) -> bool:
        """Narrow a box (C,) in place; False where it holds no point."""
        propagate = kernel(f"{ROOM}.interval_kernel").propagate
        relations, exponent, sums, sets = self.relations, self.exponent, self.sums, self.sets
        return bool(propagate(relations, exponent, sums, sets, lower, upper, sweeps, SHARE))


@dataclass
class Builder:
    """Columns as they are made; it has state because the tape is walked operation by operation."""

    name: str
    width: int = 0
    whole: list[bool] = field(default_factory=list)
    known: dict[Any, int] = field(default_factory=dict)
    relations: list[tuple[int, int, int, int]] = field(default_factory=list)
    exponents: list[float] = field(default_factory=list)
    sums: dict[int, Affine] = field(default_factory=dict)
    of: dict[int, int] = field(default_factory=dict)  # the relation that makes a column
    bases: dict[int, set[int]] = field(default_factory=dict)  # of variable exponent: their powers
    raised: set[int] = field(default_factory=set)  # these, and exponents that are no constants
    rooted: set[int] = field(default_factory=set)  # of roots of quotients, read as one power

    def new(self, whole: bool) -> int:
        """A further column."""
        self.whole.append(whole)
        self.width += 1
        return self.width - 1

    def relation(self, kind: int, w: int, u: int, v: int = -1, p: float = 0.0) -> int:
        """Add a relation."""
        self.relations.append((kind, w, u, v))
        self.exponents.append(p)
        return len(self.relations) - 1

    def sum_of(self, reading: Affine, w: int | None) -> int:
        """Add the relation that a reading is column w, or 0 where w is None."""
        terms = dict(reading.terms)
        if w is not None:
            terms[w] = (-1.0, 0.0)
        r = self.relation(LINEAR, -1 if w is None else w, -1)
        self.sums[r] = Affine(terms, -reading.constant, reading.doubt)
        return r

    def column(self, reading: Affine) -> int:
        """The column of a reading."""
        if reading.constant == 0.0 and reading.doubt == 0.0 and len(reading.terms) == 1:
            ((j, factor),) = reading.terms.items()
            if factor == (1.0, 0.0):
                return j
        key = tuple(sorted(reading.terms.items())), reading.constant, reading.doubt
        if key not in self.known:
            parts = [*reading.terms.values(), (reading.constant, reading.doubt)]
            exact = all(e == 0.0 and f == int(f) and abs(f) < EXACT for f, e in parts)
            self.known[key] = w = self.new(exact and all(self.whole[j] for j in reading.terms))
            self.of[w] = self.sum_of(reading, w)
        return self.known[key]

    def operation(self, kind: int, u: int, v: int = -1, p: float = 0.0) -> Affine:
        """Reading of op(u, v)."""
        if kind in (PRODUCT, MAXIMUM, MINIMUM) and v < u:
            u, v = v, u
        key = kind, u, v, p
        if key not in self.known:
            kept = kind in (PRODUCT, ABS, MAXIMUM, MINIMUM) or kind == POWER and p > 0.0
            whole = kept and self.whole[u] and (v < 0 or self.whole[v]) or kind == FLOOR
            self.known[key] = w = self.new(whole)
            self.of[w] = self.relation(kind, w, u, v, p)
        return Affine({self.known[key]: (1.0, 0.0)})

    def keep(self, needed: list[int]) -> None:
        """Drop relations that no needed column depends on, as of what was read as another."""
        used, kept = set(needed), list[int]()
        for r in range(len(self.relations) - 1, -1, -1):
            kind, w, u, v = self.relations[r]
            if w in used:
                kept.append(r)
                used.update(self.sums[r].terms if kind == LINEAR else (u, v))
        kept.reverse()
        self.sums = {k: self.sums[r] for k, r in enumerate(kept) if r in self.sums}
        self.relations = [self.relations[r] for r in kept]
        self.exponents = [self.exponents[r] for r in kept]
        self.of = {relation[1]: r for r, relation in enumerate(self.relations)}
        self.known = {key: w for key, w in self.known.items() if w in self.of}

    def maker(self, j: int) -> tuple[int, int, float]:
        """Kind, argument and exponent of the relation that makes a column; -1: a variable."""
        r = self.of.get(j)
        return (-1, -1, 0.0) if r is None else (*self.relations[r][::2], self.exponents[r])


class Refused(Exception):
    """An operation that has no relaxation here; the caller says of which text."""


def added(a: Affine, b: Affine, sign: float = 1.0) -> Affine:
    """A + sign b."""
    terms = dict(a.terms)
    for j, (factor, error) in b.terms.items():
        before, doubt = terms.pop(j, (0.0, 0.0))
        total = finite(before + sign * factor)
        exact = Fraction(before) + Fraction(sign * factor) == Fraction(total)
        error += doubt + (0.0 if exact else ROUNDED * abs(total))
        if total != 0.0 or error > 0.0:
            terms[j] = (total, error)
    constant = finite(a.constant + sign * b.constant)
    if a.fixed and b.fixed:  # as the text itself adds
        return Affine({}, constant)
    exact = Fraction(a.constant) + Fraction(sign * b.constant) == Fraction(constant)
    rounding = 0.0 if exact else ROUNDED * abs(constant)
    return Affine(terms, constant, a.doubt + b.doubt + rounding)


def finite(number: float) -> float:
    """A factor or constant that was made here; Refused where it is beyond the doubles."""
    if not math.isfinite(number):
        raise Refused("factors whose product or sum is beyond the numbers that a computer holds")
    return number


def scaled(a: Affine, factor: float, doubt: float = 0.0) -> Affine:
    """A times a number that is known to within a doubt."""

    def moved(value: float, error: float) -> tuple[float, float]:
        product = finite(value * factor)
        exact = Fraction(value) * Fraction(factor) == Fraction(product)
        rounding = 0.0 if exact else ROUNDED * abs(product) + LEAST
        return product, error * (abs(factor) + doubt) + abs(value) * doubt + rounding

    if a.fixed and doubt == 0.0:
        return Affine({}, a.constant * factor)
    terms = {j: moved(*pair) for j, pair in a.terms.items()} if factor or doubt else {}
    return Affine(terms, *moved(a.constant, a.doubt))


def monomial(builder: Builder, a: Affine) -> tuple[float, float, int]:
    """Factor, its error and the column of a reading as a multiple of one column."""
    if len(a.terms) == 1 and a.constant == 0.0 and a.doubt == 0.0:
        ((j, (factor, error)),) = a.terms.items()
        return factor, error, j
    return 1.0, 0.0, builder.column(a)


def multiplied(builder: Builder, a: Affine, b: Affine) -> Affine:
    """Reading of a product."""
    for first, second in ((a, b), (b, a)):
        if first.fixed:
            return scaled(second, first.constant, first.doubt)
    (f, e, u), (g, d, v) = monomial(builder, a), monomial(builder, b)
    base, p = as_power(builder, u)
    other, q = as_power(builder, v)
    same = base == other and exact_sum(p, q)
    product = powered_column(builder, base, p + q) if same else builder.operation(PRODUCT, u, v)
    return scaled(scaled(product, f, e), g, d)


def exact_sum(p: float, q: float) -> bool:
    """Whether two exponents add up without rounding."""
    return Fraction(p) + Fraction(q) == Fraction(p + q)


def as_power(builder: Builder, j: int) -> tuple[int, float]:
    """The column and exponent that a column is a power of; itself and 1 otherwise."""
    kind, u, p = builder.maker(j)
    return (u, p) if kind in (POWER, ROOT) else (j, 1.0)


def powered(builder: Builder, a: Affine, p: float) -> Affine:
    """Reading of a power with a constant exponent."""
    if a.fixed and a.doubt == 0.0:
        return Affine({}, float(np.float64(a.constant) ** p))
    f, e, u = monomial(builder, a)
    factor = float(np.float64(f) ** p)  # no number of f < 0 where p is not whole
    if SMALLEST < abs(factor) < math.inf and abs(p) * e < SURE * abs(f):
        rounding = 0.0 if abs(f) == 1.0 else 8.0 * ROUNDED
        doubt = (rounding + abs(p) * 1.1 * e / abs(f)) * abs(factor)
    else:
        u, factor, doubt = builder.column(a), 1.0, 0.0
    base, q = as_power(builder, u)
    exact = Fraction(p) * Fraction(q) == Fraction(p * q)
    of_size = q % 2.0 == 0.0 and p % 1.0 != 0.0  # (u^2)^p is a power of |u|
    if exact and not of_size:
        if q < 0.0 and p % 1.0 != 0.0:
            builder.rooted.add(base)
        return scaled(powered_column(builder, base, p * q), factor, doubt)
    if exact and p * q == 1.0:
        return scaled(builder.operation(ABS, base), factor, doubt)
    return scaled(powered_column(builder, u, p), factor, doubt)


def powered_column(builder: Builder, u: int, p: float) -> Affine:
    """Reading of a power of a column."""
    if p == 0.0:
        return Affine({}, 1.0)
    if p == 1.0:
        return Affine({u: (1.0, 0.0)})
    kind, inner, _ = builder.maker(u)
    if kind == ABS and p % 2.0 == 0.0:
        u = inner
    return builder.operation(POWER if p % 1.0 == 0.0 else ROOT, u, p=p)


def divided(builder: Builder, a: Affine, b: Affine) -> Affine:
    """Reading of a quotient."""
    if b.fixed and b.doubt == 0.0:
        if b.constant == 0.0:
            raise Refused("division by a constant 0")
        if a.fixed and a.doubt == 0.0:
            return Affine({}, a.constant / b.constant)
        inverse = 1.0 / b.constant
        if math.isinf(inverse):
            raise Refused("division by a constant whose inverse is infinite")
        exact = Fraction(inverse) * Fraction(b.constant) == 1
        return scaled(a, inverse, 0.0 if exact else ROUNDED * abs(inverse))
    if a.fixed:
        return scaled(powered(builder, b, -1.0), a.constant, a.doubt)
    (f, e, u), (g, d, v) = monomial(builder, a), monomial(builder, b)
    if not d < SURE * abs(g):
        g, d, v = 1.0, 0.0, builder.column(b)
    base, p = as_power(builder, u)
    other, q = as_power(builder, v)
    same = base == other and exact_sum(p, -q)
    ratio = powered_column(builder, base, p - q) if same else builder.operation(QUOTIENT, u, v)
    return (
        divided(builder, scaled(ratio, f, e), Affine({}, g))
        if d == 0.0
        else scaled(scaled(ratio, f, e), 1.0 / g, (2.0 * ROUNDED + 1.1 * d / abs(g)) / abs(g))
    )


def of_column(builder: Builder, kind: int, a: Affine) -> Affine:
    """Reading of a function of one reading."""
    u = builder.column(a)
    before, inner, p = builder.maker(u)
    if (kind, before) in ((EXP, LOG), (LOG, EXP)):
        return Affine({inner: (1.0, 0.0)})
    if kind == ABS and (before == ABS or before == POWER and p % 2.0 == 0.0):
        return Affine({u: (1.0, 0.0)})
    return builder.operation(kind, u)


def of_two(builder: Builder, kind: int, a: Affine, b: Affine) -> Affine:
    """Reading of a maximum or a minimum."""
    u, v = builder.column(a), builder.column(b)
    return Affine({u: (1.0, 0.0)}) if u == v else builder.operation(kind, u, v)


def raised(builder: Builder, a: Affine, b: Affine) -> Affine:
    """Reading of a**b; with a variable b of exp(b log a), for which a may not be negative."""
    if b.fixed and b.doubt == 0.0:
        return powered(builder, a, b.constant)
    positive = a.fixed and a.doubt == 0.0 and a.constant > 0.0
    if positive:
        log = math.log(a.constant)
        logarithm = Affine({}, log, 8.0 * ROUNDED * abs(log))
    else:
        builder.raised.add(builder.column(a))
        logarithm = of_column(builder, LOG, a)
    builder.raised.add(builder.column(b))
    power = of_column(builder, EXP, multiplied(builder, b, logarithm))
    if not positive:
        builder.bases.setdefault(builder.column(a), set()).update(power.terms)
    return power


def refuse(name: str, words: str) -> NoReturn:
    """Raise SolveError: a text has no relaxation here."""
    raise SolveError(f"{name}: no relaxation of its text is known: {words}")
