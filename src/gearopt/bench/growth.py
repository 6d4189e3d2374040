"""Families of problems of growing size: up to which size the default method proves, and how fast.

Every problem has SECONDS and a gap of 1e-6; its numbers are drawn by the seed 0.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from gearopt.optimise.own_problems import solve_own
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.terms import Terms, Var

SECONDS, GAP = 10.0, 1e-6


def run(repeat: int) -> list[dict[str, Any]]:
    """Rows: family, size, status, gap, CPU seconds, up to the first size that is not proven."""
    rows = list[dict[str, Any]]()
    for family, (sizes, posed) in FAMILIES.items():
        for size in sizes:
            begin = time.process_time()
            budget = Budget(seconds=SECONDS, gap=GAP)
            result = solve_own(posed(size), None, budget, 0, None, GAP, None)
            rows.append(
                {
                    "family": family,
                    "variables": size,
                    "status": result.status,
                    "gap": result.gap,
                    "method": result.method,
                    "cpu_s": round(time.process_time() - begin, 3),
                }
            )
            if result.status != "optimal":
                break
    return rows


def _problem(low: float, high: float, size: int, text: Callable[..., Any], **more: Any) -> Problem:
    """Problem of text(x (n,)) -> objective and limits, all variables with the same ends."""
    middle = float(round(0.5 * (low + high))) if more.get("integer") else 0.6 * low + 0.4 * high
    x = Var("x", "", low, high, middle, size=size, **more)

    def evaluate(point: Any, p: Any) -> Terms:
        objective, limits = text(np.array([point.x[k] for k in range(size)]))
        return Terms({"f": objective}, {f"g{k}": row for k, row in enumerate(limits, 1)})

    return Problem(f"{size} variables", (x,), (), evaluate)


def quadratic(size: int) -> Problem:
    """Indefinite quadratic form over a box, half of its products present."""
    rng = np.random.default_rng(0)
    square = rng.normal(size=(size, size)) * (rng.random((size, size)) < 0.5)
    linear = rng.normal(size=size)
    return _problem(0.0, 1.0, size, lambda x: (x @ (square + square.T) @ x + linear @ x, []))


def signomial(size: int) -> Problem:
    """Sums of products of three powers with either sign, under a limit of the same sort."""
    rng = np.random.default_rng(0)

    def terms() -> Any:
        places = [rng.choice(size, 3, replace=False) for _ in range(size)]
        return list(zip(places, rng.uniform(-1.0, 2.0, (size, 3)), strict=True))

    of_cost, of_limit, signs = terms(), terms(), rng.choice((-1.0, 1.0), size)

    def product(x: Any, place: Any, power: Any) -> Any:
        return x[place[0]] ** power[0] * x[place[1]] ** power[1] * x[place[2]] ** power[2]

    def text(x: Any) -> tuple[Any, list[Any]]:
        cost = sum(s * product(x, *term) for s, term in zip(signs, of_cost, strict=True))
        return cost + sum(x), [sum(product(x, *term) for term in of_limit) <= 2.0 * size]

    return _problem(0.2, 3.0, size, text)


def geometric(size: int) -> Problem:
    """The same with positive terms alone, a geometric program."""
    rng = np.random.default_rng(0)
    places = [rng.choice(size, 3, replace=False) for _ in range(2 * size)]
    powers = rng.uniform(-2.0, 2.0, (2 * size, 3))

    def text(x: Any) -> tuple[Any, list[Any]]:
        parts = [
            x[i] ** p * x[j] ** q * x[k] ** r
            for (i, j, k), (p, q, r) in zip(places, powers, strict=True)
        ]
        return sum(parts[:size]), [sum(parts[size:]) <= 2.0 * size]

    return _problem(0.2, 3.0, size, text)


def wells(size: int) -> Problem:
    """A chain of double wells of degree 4, neighbours coupled."""

    def text(x: Any) -> tuple[Any, list[Any]]:
        alone = sum((x[k] ** 2 - 1) ** 2 + 0.1 * x[k] for k in range(size))
        return alone + sum(0.3 * (x[k] - x[k + 1]) ** 2 for k in range(size - 1)), []

    return _problem(-2.0, 2.0, size, text)


def links(size: int) -> Problem:
    """A planar chain of links that reaches for a point, by its angles."""
    target = 0.6 * size, 0.3 * size

    def text(x: Any) -> tuple[Any, list[Any]]:
        turned = [sum(x[: k + 1]) for k in range(size)]
        across = sum(np.cos(angle) for angle in turned) - target[0]
        up = sum(np.sin(angle) for angle in turned) - target[1]
        return across**2 + up**2 + 0.05 * sum(v**2 for v in x), []

    return _problem(-np.pi, np.pi, size, text)


def whole(size: int) -> Problem:
    """A separable quadratic with products of neighbours and two limits, of whole numbers."""
    rng = np.random.default_rng(0)
    at, weight = rng.uniform(5.0, 40.0, size), rng.uniform(1.0, 3.0, size)

    def text(x: Any) -> tuple[Any, list[Any]]:
        cost = sum(w * (v - a) ** 2 for w, v, a in zip(weight, x, at, strict=True))
        cost = cost + sum(0.5 * x[k] * x[k + 1] for k in range(size - 1))
        return cost, [sum(x) <= 18.0 * size, sum(v**2 for v in x) >= 300.0 * size]

    return _problem(0, 50, size, text, integer=True)


FAMILIES: dict[str, tuple[tuple[int, ...], Callable[[int], Problem]]] = {
    "geometric program": ((10, 30, 100, 300), geometric),
    "indefinite quadratic": ((10, 20, 30, 40), quadratic),
    "signomials with a limit": ((10, 20, 30, 40), signomial),
    "double wells of degree 4": ((4, 6, 8, 10), wells),
    "planar chain by its angles": ((2, 3, 4), links),
    "whole quadratic, 0 to 50": ((4, 6, 8, 10), whole),
}
