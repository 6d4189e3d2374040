"""Random problems of one's own, each with a reference answer found without gearopt.

A text is plain numpy on scalars. The reference enumerates the discrete variables and searches the
continuous ones from many starts by SLSQP (scipy), on the same text called with plain floats.
"""

import warnings
from dataclasses import dataclass
from itertools import product
from types import SimpleNamespace

import numpy as np
from scipy.optimize import minimize

from gearopt import Problem, Terms, Var

FEASIBLE = 1e-8


@dataclass(frozen=True)
class Case:
    """A problem, its family and its text; smooth: no kinks."""

    name: str
    problem: Problem
    text: object
    smooth: bool = True

    def terms(self, point):
        """Objective, limits and equal rows at a flat point, by the text alone."""
        x, k = {}, 0
        for v in self.problem.variables:
            values = tuple(float(a) for a in point[k : k + v.size])
            x[v.name], k = (values if v.size > 1 else values[0]), k + v.size
        found = self.text(SimpleNamespace(**x), None)
        limits, equal = (
            np.array(
                [float(r) for v in rows.values() for r in (v if isinstance(v, tuple) else (v,))]
            )
            for rows in (found.limits, found.equal)
        )
        return float(next(iter(found.minimise.values()))), limits, equal

    def violation(self, point):
        """Largest violation of rows at a point."""
        with np.errstate(all="ignore"):
            _, g, h = self.terms(point)
        worst = max((g - 1).max(initial=0.0), np.abs(h - 1).max(initial=0.0))
        return np.inf if np.isnan(worst) else worst


def reference(case, starts=12, seed=0):
    """The least value known over all discrete values, and its point; inf where none is feasible."""
    rng = np.random.default_rng(seed)
    low, high, _ = case.problem.bounds()
    sets = []
    for (v, _), a, b in zip(case.problem.columns, low, high, strict=True):
        if v.values is not None:
            sets.append([w for w in v.values if a <= w <= b])
        elif v.integer:
            sets.append(list(range(int(np.ceil(a)), int(np.floor(b)) + 1)))
        else:
            sets.append([None])
    best, where = np.inf, None
    free = [k for k, s in enumerate(sets) if s == [None]]
    for combination in product(*sets):
        point = np.array([0.0 if c is None else c for c in combination])
        for start in range(starts if free else 1):
            value, x = _local(case, point, free, low, high, rng, start)
            if value < best:
                best, where = value, x
    return best, where


def _local(case, point, free, low, high, rng, start):
    point = point.copy()
    if free:
        a, b = low[free], high[free]
        u = rng.random(len(free)) if start else np.full(len(free), 0.5)
        logs = (a > 0) & (b > 10 * a)
        positive = np.maximum((a, b), 1e-300)
        begin = np.where(logs, positive[0] ** (1 - u) * positive[1] ** u, a + u * (b - a))
        point[free] = refined(case, point, free, begin, low, high)
    if case.violation(point) > FEASIBLE:
        return np.inf, None
    return case.terms(point)[0], point


def refined(case, point, free, begin, low, high):
    """A local optimum of the continuous variables from a start, in the unit box."""
    a, b = low[free], high[free]
    width = np.where(b > a, b - a, 1.0)

    def full(t):
        x = point.copy()
        x[free] = np.clip(a + t * width, a, b)
        return x

    scale = max(abs(case.terms(full((begin - a) / width))[0]), 1e-300)
    rows = [
        {"type": "ineq", "fun": lambda t: 1.0 - case.terms(full(t))[1]},
        {"type": "eq", "fun": lambda t: case.terms(full(t))[2] - 1.0},
    ]
    _, g, h = case.terms(full((begin - a) / width))
    rows = [r for r, n in zip(rows, (g, h), strict=True) if n.size]
    t = (begin - a) / width
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        for _ in range(2):
            found = minimize(
                lambda t: case.terms(full(t))[0] / scale,
                t,
                method="SLSQP",
                bounds=[(0.0, 1.0)] * len(free),
                constraints=rows,
                options={"maxiter": 200, "ftol": 1e-15},
            )
            if np.isfinite(found.x).all():
                t = found.x
    return full(t)[free]


def case(seed):
    """The problem of a seed: one of ten families."""
    rng = np.random.default_rng(seed)
    return FAMILIES[seed % len(FAMILIES)](rng)


def _problem(name, variables, text, smooth=True):
    return Case(name, Problem(name, tuple(variables), (), text), text, smooth)


def trigonometric(rng):
    """Sines of two variables, one limit."""
    a, b, c, d = rng.uniform(0.5, 3.0, 4)
    m = rng.uniform(0.3, 1.5)

    def text(x, p):
        f = np.sin(a * x.u) + np.cos(b * x.v) + 0.1 * c * (x.u - d) ** 2 + 0.05 * x.v**2
        return Terms({"f": f}, {"near": (x.u**2 + x.v**2) / (9.0 * m)})

    return _problem("trig", [Var("u", "", -3.0, 4.0, 0.3), Var("v", "", -3.0, 3.0, -0.2)], text)


def mixed(rng):
    """An integer with fractional bounds, a continuous variable, a trigonometric coupling."""
    low, high = rng.uniform(-3.9, -0.1), rng.uniform(0.1, 4.9)
    a, b, c = rng.uniform(0.3, 2.0, 3)

    def text(x, p):
        f = (x.n - 1.3 * a) ** 2 + b * np.sin(x.n + 2.0 * x.r) + c * x.r**2
        return Terms({"f": f}, {"sum": 1.0 + (x.n + x.r - 2.5) / 10.0})

    guess = 0.5 * (low + high)
    return _problem(
        "mixed", [Var("n", "", low, high, guess, integer=True), Var("r", "", -2.0, 2.0, 0.1)], text
    )


def sums(rng):
    """np.sum, np.prod and np.max over the components of a variable."""
    target = rng.uniform(0.5, 2.0, 3)
    weight = rng.uniform(0.5, 3.0, 3)
    kind = int(rng.integers(3))
    most = rng.uniform(2.0, 6.0)

    def text(x, p):
        w = np.array(x.w) - target
        f = np.sum(weight * w * w) + 0.1 * np.prod(x.w)
        limit = {0: np.sum(x.w), 1: np.sum(np.square(x.w)), 2: np.mean(x.w)}[kind]
        return Terms({"f": f}, {"total": limit / most})

    return _problem("sums", [Var("w", "", 0.1, 3.0, 1.0, 3)], text)


def zero(rng):
    """An optimum of exactly zero, inside, at a bound, or at a limit."""
    a, b = rng.uniform(-1.0, 1.0, 2)
    kind = int(rng.integers(4))
    big = 10.0 ** rng.integers(-6, 7)

    def text(x, p):
        if kind == 0:
            return Terms({"f": big * ((x.u - a) ** 2 + 2.0 * (x.v - b) ** 2)})
        if kind == 1:
            return Terms({"f": big * (x.u + 2.0 + (x.v - b) ** 2)})
        if kind == 2:
            return Terms({"f": big * (x.u - x.v)}, {"above": 1.0 + (x.v - x.u) / 4.0})
        return Terms({"f": big * (x.u - a) ** 2 * (1.0 + x.v**2)})

    return _problem("zero", [Var("u", "", -2.0, 2.0, 0.7), Var("v", "", -2.0, 2.0, -0.4)], text)


def equality(rng):
    """A continuous equality, with or without an integer."""
    a, b, r = rng.uniform(0.5, 2.0, 3)
    whole = bool(rng.integers(2))

    def text(x, p):
        f = a * x.u**2 + b * np.cos(x.v) + (0.3 * (x.n - 2.4) ** 2 if whole else 0.0)
        there = x.u**2 + x.v**2 + (0.2 * x.n if whole else 0.0)
        return Terms({"f": f}, {}, {}, {"circle": there / (1.0 + r)})

    variables = [Var("u", "", -2.0, 2.0, 0.7), Var("v", "", -2.0, 2.0, 0.6)]
    if whole:
        variables.append(Var("n", "", 0.5, 5.5, 2.0, integer=True))
    return _problem("equality", variables, text)


def scaled(rng):
    """Rosenbrock's valley in other units of the objective and of the variables."""
    big, size = 10.0 ** rng.integers(-12, 13), 10.0 ** rng.integers(-6, 7)
    steep = 10.0 ** rng.uniform(0.0, 2.0)

    def text(x, p):
        u, v = x.u / size, x.v / size
        return Terms({"f": big * (steep * (v - u * u) ** 2 + (1.0 - u) ** 2 + 0.5)})

    ends = (-2.0 * size, 2.0 * size)
    return _problem(
        "scaled", [Var("u", "m", *ends, -1.2 * size), Var("v", "m", *ends, 1.0 * size)], text
    )


def posynomial(rng):
    """A geometric program of two or three log variables."""
    powers = rng.uniform(-2.0, 2.0, (4, 3))
    weights = np.exp(rng.uniform(-1.0, 1.0, 4))
    size = 10.0 ** rng.integers(-3, 4)

    def text(x, p):
        f = sum(
            weights[k] * x.a ** powers[k, 0] * x.b ** powers[k, 1] * x.c ** powers[k, 2]
            for k in range(3)
        )
        return Terms(
            {"f": size * f}, {"product": 0.3 / (x.a * x.b * x.c), "sum": (x.a + x.b) / 6.0}
        )

    return _problem("posynomial", [Var(n, "", 0.1, 10.0, 1.0, log=True) for n in "abc"], text)


def quadratic(rng):
    """A convex quadratic program with an affine equality half of the time."""
    root = rng.normal(size=(3, 3))
    hessian = root @ root.T + 0.1 * np.eye(3)
    linear = rng.normal(size=3)
    equal = bool(rng.integers(2))
    big = 10.0 ** rng.integers(-8, 9)

    def text(x, p):
        w = (x.a, x.b, x.c)
        f = 0.5 * sum(hessian[i, j] * w[i] * w[j] for i in range(3) for j in range(3))
        f = big * (f + sum(linear[i] * w[i] for i in range(3)))
        rows = {"plane": 1.0 + (x.a + 0.5 * x.b - x.c - 0.3)} if equal else {}
        return Terms({"f": f}, {"half": 1.0 + (x.a - x.b - 0.5) / 2.0}, {}, rows)

    return _problem("quadratic", [Var(n, "", -2.0, 3.0, 0.5) for n in "abc"], text)


def norms(rng):
    """np.linalg.norm and np.max over components; kinks."""
    centre = rng.uniform(-1.0, 1.0, 2)
    kind = int(rng.integers(3))

    def text(x, p):
        w = np.array(x.w)
        if kind == 0:
            f = np.linalg.norm(w - centre) + 0.1 * np.sum(w)
        elif kind == 1:
            f = np.max(w - centre) + 0.3 * np.sum(w * w)
        else:
            f = np.sum(np.abs(w - centre)) + 0.2 * np.sum(w * w)
        return Terms({"f": f}, {"low": 1.0 + (0.2 - np.min(w)) / 5.0})

    return _problem("norms", [Var("w", "", -2.0, 2.0, 0.5, 2)], text, smooth=False)


def chosen(rng):
    """Values of a finite set beside an integer and a log variable; sometimes impossible."""
    values = tuple(np.sort(rng.choice([0.5, 0.8, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0], 5, False)))
    load = rng.uniform(5.0, 90.0)

    def text(x, p):
        f = x.m**2 * x.z * x.b
        return Terms(
            {"f": f}, {"load": load / (x.m**2 * x.z * x.b**0.5), "wide": x.b / (3.0 * x.m)}
        )

    return _problem(
        "chosen",
        [
            Var("m", "mm", values[0], values[-1], values[2], values=values),
            Var("z", "", 11.5, 20.5, 14.0, integer=True),
            Var("b", "mm", 0.5, 9.0, 2.0, log=True),
        ],
        text,
    )


def wide(rng):
    """Terms of different size in a wide box; the optimum is small, but not zero."""
    width = 10.0 ** rng.integers(4, 13)
    steep, at = 10.0 ** rng.uniform(-3.0, 1.0), rng.uniform(0.2, 0.8)
    rest = 10.0 ** rng.uniform(-3.0, 0.0)
    guess = float(rng.choice([0.0, 0.9 * width, rng.uniform(0.0, 1.0) * width]))
    kind = int(rng.integers(3))

    def text(x, p):
        if kind == 0:
            return Terms({"f": (steep * (x.u - x.v)) ** 2 + (x.v / width - at) ** 2 + rest})
        if kind == 1:
            return Terms({"f": steep * (x.u - 3.0) ** 2 + (x.v - 4.0) ** 2 + rest})
        return Terms({"f": steep * (x.u / width - at) ** 3 + (x.v / width - at) ** 2 + 7.0})

    return _problem(
        "wide", [Var("u", "", 0.0, width, guess), Var("v", "", 0.0, width, guess)], text
    )


FAMILIES = (
    trigonometric,
    mixed,
    sums,
    zero,
    equality,
    scaled,
    posynomial,
    quadratic,
    norms,
    chosen,
    wide,
)
