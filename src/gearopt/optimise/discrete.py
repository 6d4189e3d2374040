"""The values that a discrete variable may take within its bounds."""

import math
from collections.abc import Sequence
from typing import NoReturn

from gearopt.errors import SolveError
from gearopt.optimise.problem import Problem

ROUNDING = 1e-12  # relative; a bound that is computed (3 x 0.1) still holds the value it stands for


def values(problem: Problem, column: int) -> Sequence[float]:
    """Values of one component of a point in order: those of its set, or its whole numbers.

    SolveError where its bounds hold none, or where an integer has no finite bounds.
    """
    variable, name = problem.columns[column]
    if variable.values is None:
        least, most = ends(problem, column)
        if not (math.isfinite(least) and math.isfinite(most)):
            raise SolveError(f"{problem.name}: the integer {name} needs finite bounds")
        return range(int(least), int(most) + 1)
    low, high = _widened(problem, column)
    found = tuple(sorted({float(v) for v in variable.values if low <= v <= high}))
    return found or _nothing(problem, column, "value of its set")


def checked(problem: Problem) -> None:
    """Raise SolveError where the bounds of a discrete variable hold none of its values."""
    for column, (variable, _) in enumerate(problem.columns):
        if variable.values is not None:
            values(problem, column)
        elif variable.integer:
            ends(problem, column)


def ends(problem: Problem, column: int) -> tuple[float, float]:
    """Least and most whole number between the bounds of an integer, infinite where they are."""
    low, high = _widened(problem, column)
    least = float(math.ceil(low)) if math.isfinite(low) else low
    most = float(math.floor(high)) if math.isfinite(high) else high
    return (least, most) if least <= most else _nothing(problem, column, "whole number")


def _widened(problem: Problem, column: int) -> tuple[float, float]:
    low, high = (float(b[column]) for b in problem.bounds()[:2])
    return low - ROUNDING * abs(low), high + ROUNDING * abs(high)


def _nothing(problem: Problem, column: int, what: str) -> NoReturn:
    low, high = (float(b[column]) for b in problem.bounds()[:2])
    name = problem.columns[column][1]
    raise SolveError(f"{problem.name}: no {what} lies between {low:g} and {high:g} for {name}")
