"""The text of a problem as columns: variables, and one further column an operation.

The tape is walked once (Smith and Pantelides, Comput. Chem. Eng. 23, 1999). A reading is an affine
form of columns; an operation on readings makes a relation w = op(u, v) of columns, and an affine
argument of several terms a column with a sum. The same operation of the same columns is one column.
What is simplified may drop a domain, never add one, so that the columns' set holds the text's.
Factors that are multiplied or added up here carry by how much they may be off.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, NoReturn

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.box import allowed_values, whole_ends
from gearopt.optimise.kernels import kernel
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.tape import walk
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


def _reader(builder: Builder) -> Callable[[int, list[Affine]], Affine]:
    import casadi as ca

    from gearopt.optimise.tape import fold

    plain = {
        ca.OP_EXP: EXP, ca.OP_LOG: LOG, ca.OP_SIN: SINE, ca.OP_COS: COSINE, ca.OP_TANH: TANH,
        ca.OP_ATAN: ATAN, ca.OP_ASIN: ASIN, ca.OP_FABS: ABS, ca.OP_FLOOR: FLOOR,
    }  # fmt: skip
    unity, quarter = Affine({}, 1.0), Affine({}, math.pi / 2.0, ROUNDED)
    names = {getattr(ca, n): n[3:].lower() for n in dir(ca) if n.startswith("OP_")}

    def exponential(a: Affine, sign: float) -> Affine:
        return of_column(builder, EXP, scaled(a, sign))

    known: dict[int, Callable[..., Affine]] = {
        ca.OP_ASSIGN: lambda a: a,
        ca.OP_ADD: added,
        ca.OP_SUB: lambda a, b: added(a, b, -1.0),
        ca.OP_NEG: lambda a: scaled(a, -1.0),
        ca.OP_TWICE: lambda a: scaled(a, 2.0),
        ca.OP_MUL: lambda a, b: multiplied(builder, a, b),
        ca.OP_DIV: lambda a, b: divided(builder, a, b),
        ca.OP_INV: lambda a: divided(builder, unity, a),
        ca.OP_SQ: lambda a: powered(builder, a, 2.0),
        ca.OP_SQRT: lambda a: powered(builder, a, 0.5),
        ca.OP_POW: lambda a, b: raised(builder, a, b),
        ca.OP_CONSTPOW: lambda a, b: raised(builder, a, b),
        ca.OP_TAN: lambda a: divided(
            builder, of_column(builder, SINE, a), of_column(builder, COSINE, a)
        ),
        ca.OP_ACOS: lambda a: added(quarter, of_column(builder, ASIN, a), -1.0),
        ca.OP_SINH: lambda a: scaled(added(exponential(a, 1.0), exponential(a, -1.0), -1.0), 0.5),
        ca.OP_COSH: lambda a: scaled(added(exponential(a, 1.0), exponential(a, -1.0)), 0.5),
        ca.OP_LOG1P: lambda a: of_column(builder, LOG, added(unity, a)),
        ca.OP_EXPM1: lambda a: added(exponential(a, 1.0), unity, -1.0),
        ca.OP_HYPOT: lambda a, b: powered(
            builder, added(powered(builder, a, 2.0), powered(builder, b, 2.0)), 0.5
        ),
        ca.OP_FMAX: lambda a, b: of_two(builder, MAXIMUM, a, b),
        ca.OP_FMIN: lambda a, b: of_two(builder, MINIMUM, a, b),
        ca.OP_CEIL: lambda a: scaled(of_column(builder, FLOOR, scaled(a, -1.0)), -1.0),
    }

    def apply(operation: int, readings: list[Affine]) -> Affine:
        if all(a.fixed and a.doubt == 0.0 for a in readings):
            number = fold(operation, [a.constant for a in readings])
            if number is not None:
                if not np.isfinite(number):
                    raise Refused(f"{names[operation]} of constants, which is no number")
                return Affine({}, float(number))
        if operation in plain:
            return of_column(builder, plain[operation], readings[0])
        if operation not in known:
            raise Refused(f"the operation {names.get(operation, operation)}")
        return known[operation](*readings[: 2 if len(readings) > 1 else 1])

    return apply


def _outputs(problem: Problem, builder: Builder) -> tuple[Affine, list[Affine], list[Affine]]:
    """Readings of the objective, the inequalities and the equalities."""

    def constant(number: float) -> Affine:
        if not math.isfinite(number):
            raise Refused("a constant that is no number")
        return Affine({}, float(number))

    shared = sum(v.size for v in problem.variables)
    objective, start = Affine({}), shared
    inequalities, equalities = list[Affine](), list[Affine]()
    for block in problem.traced().blocks:
        repeat = block.repeat
        for row in range(repeat.count if repeat else 1):
            width = repeat.width if repeat else 0
            inputs = [
                [Affine({j: (1.0, 0.0)}) for j in range(shared)],
                [Affine({start + j: (1.0, 0.0)}) for j in range(width)],
                [constant(v) for v in problem.parameter_values()],
                [constant(v[row]) for v in repeat.data.values()] if repeat else [],
            ]
            f, g, h = walk(block.function, inputs, constant, _reader(builder))
            for value in f:
                objective = added(objective, value)
            inequalities += g
            equalities += h
            start += width
    return objective, inequalities, equalities


def columns(problem: Problem, slack: float = 0.0, logarithms: bool = True) -> Columns:
    """Columns of a problem at its present parameters.

    slack: by which rows may exceed 1. logarithms: with those of positive products and powers.
    SolveError names the operation that has no relaxation, or a text that cannot be traced.
    """
    from gearopt.optimise.spatial.partial import open_at_zero, partial_relations  # needs these

    one_objective(problem.name, problem.rows.objectives)
    builder = Builder(problem.name)
    for variable, _ in problem.columns:
        builder.new(variable.integer and variable.values is None)
    count = builder.width
    try:
        f, g, h = _outputs(problem, builder)
    except Refused as refused:
        raise SolveError(f"{problem.name}: no relaxation of its text is known: {refused}") from None
    aim = builder.column(f)
    limits, equal = [builder.column(a) for a in g], [builder.column(a) for a in h]
    builder.keep([aim, *limits, *equal])
    lower, upper = np.full(builder.width, -np.inf), np.full(builder.width, np.inf)
    lower[:count], upper[:count] = _allowed_ends(problem)
    for j in (*limits, *equal):
        upper[j] = min(upper[j], 1.0 + slack)
    for j in equal:
        lower[j] = max(lower[j], 1.0 - slack)
    first = _assembled(problem, builder, count, lower, upper, aim)
    _check_bases(problem.name, builder, first)
    if (partial := partial_relations(first)).any():
        open_at_zero(problem, builder, partial)
        first = _assembled(problem, builder, count, lower, upper, aim)
    low, high = first.lower.copy(), first.upper.copy()
    if not (logarithms and first.propagated(low, high, ROOT_SWEEPS)):
        return first
    _logarithms(builder, low)
    more = builder.width - len(lower)
    lower = np.concatenate([lower, np.full(more, -np.inf)])
    upper = np.concatenate([upper, np.full(more, np.inf)])
    return _assembled(problem, builder, count, lower, upper, aim)


def _check_bases(name: str, builder: Builder, form: Columns) -> None:
    """Raise SolveError for u^v with u that may be negative: at whole v exp(v log u) is another."""
    doubtful = dict(builder.bases)
    kinds, results, of = form.relations[:, :3].T
    while doubtful:  # without their powers, which may be negative, and logarithms, cut off at 0
        powers = [w for some in doubtful.values() for w in some]
        left_out = (kinds == LOG) & np.isin(of, list(doubtful))
        left_out |= (kinds == EXP) & np.isin(results, powers)
        relations, low, high = form.relations.copy(), form.lower.copy(), form.upper.copy()
        relations[left_out, 0] = LINEAR
        if not replace(form, relations=relations).propagated(low, high, ROOT_SWEEPS):
            return
        if not (positive := [j for j in doubtful if low[j] >= 0.0]):
            refuse(
                name,
                "a variable power of what may be negative; write np.exp(v * np.log(u)) for u**v "
                "where u is positive",
            )
        for j in positive:
            del doubtful[j]


def refuse(name: str, words: str) -> NoReturn:
    """Raise SolveError: a text has no relaxation here."""
    raise SolveError(f"{name}: no relaxation of its text is known: {words}")


def _logarithms(builder: Builder, low: Array) -> None:
    """Add log w = log u + log v and its like, where all three are positive (Lemma 75)."""

    def logarithm(j: int) -> Affine:
        kind, inner, _ = builder.maker(j)
        return Affine({inner: (1.0, 0.0)}) if kind == EXP else builder.operation(LOG, j)

    for r in range(len(builder.relations)):
        kind, w, u, v = builder.relations[r]
        if kind not in (PRODUCT, QUOTIENT, POWER, ROOT):
            continue
        if not all(low[j] > 0.0 for j in (w, u, v) if j >= 0):
            continue
        of_u = logarithm(u)
        if kind in (POWER, ROOT):
            right = scaled(of_u, builder.exponents[r])
        else:
            right = added(of_u, logarithm(v), 1.0 if kind == PRODUCT else -1.0)
        builder.sum_of(added(right, logarithm(w), -1.0), None)


def _assembled(
    problem: Problem, builder: Builder, count: int, lower: Array, upper: Array, aim: int
) -> Columns:
    """Columns as arrays; whole and listed variables within their allowed ends."""
    lower, upper, listed = lower.copy(), upper.copy(), list[float]()
    sort = np.where(builder.whole, WHOLE, CONTINUOUS).astype(np.int64)
    first, last = np.zeros(builder.width, np.int64), np.zeros(builder.width, np.int64)
    for j, (variable, _) in enumerate(problem.columns):  # a row may limit a variable itself
        if variable.values is not None:
            values = allowed_values(problem, j)
            sort[j], first[j], last[j] = LISTED, len(listed), len(listed) + len(values)
            listed += values
            inside = [v for v in values if lower[j] <= v <= upper[j]] or [np.inf, -np.inf]
            lower[j], upper[j] = inside[0], inside[-1]
        elif variable.integer:
            lower[j], upper[j] = np.ceil(lower[j]), np.floor(upper[j])
    start, terms = [0], list[tuple[int, tuple[float, float]]]()
    for r in range(len(builder.relations)):
        terms += builder.sums[r].terms.items() if r in builder.sums else []
        start.append(len(terms))
    none = Affine({})
    kept = [builder.sums.get(r, none) for r in range(len(builder.relations))]
    sums = (
        np.array(start, np.int64),
        np.array([j for j, _ in terms], np.int64),
        np.array([f for _, (f, _) in terms], float),
        np.array([e for _, (_, e) in terms], float),
        np.array([a.constant for a in kept], float),
        np.array([a.doubt for a in kept], float),
    )
    columns = Columns(
        count,
        np.array(builder.relations, np.int64).reshape(-1, 4),
        np.array(builder.exponents, float),
        sums,
        (sort, first, last, np.array(listed, float)),
        lower,
        upper,
        aim,
        _below(builder, count),
        bool((lower > upper).any()),
    )
    return columns


def _allowed_ends(problem: Problem) -> tuple[Array, Array]:
    """Least and greatest values (n,) of the variables; a discrete one may be a rounding outside."""
    lower, upper = (bound.copy() for bound in problem.bounds()[:2])
    for j, (variable, _) in enumerate(problem.columns):
        if variable.values is not None:
            values = allowed_values(problem, j)
            lower[j], upper[j] = values[0], values[-1]
        elif variable.integer:
            least, greatest = whole_ends(problem, j)
            lower[j] = max(least, np.ceil(lower[j] - 0.25))  # not by a part of a large number
            upper[j] = min(greatest, np.floor(upper[j] + 0.25))
    return lower, upper


def _below(builder: Builder, count: int) -> Any:
    below = np.zeros((builder.width, count), bool)
    below[np.arange(count), np.arange(count)] = True
    for r, (kind, w, u, v) in enumerate(builder.relations):
        if w < 0:
            continue
        arguments = [u, v] if kind != LINEAR else [j for j in builder.sums[r].terms if j != w]
        for j in arguments:
            if j >= 0:
                below[w] |= below[j]
    return below
