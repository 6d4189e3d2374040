"""How far a point is from feasible, and what has the worst of it."""

from typing import Any

import numpy as np

from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Batch, Problem
from gearopt.optimise.scale import sizes
from gearopt.optimise.terms import Array

RUNAWAY = 1e9  # a variable without a bound that moves this factor from its guess is held by nothing


def violation(problem: Problem | Conic, x: Array, batch: Batch) -> tuple[float, str]:
    """Largest violation of rows, bounds and discreteness, and the name of what has it.

    That of a bound is relative to the variable's own scale, of a value to that or to 1.
    """
    lower, upper, _ = problem.bounds()
    size = sizes(problem, x)
    names = [r.name for r in problem.rows.inequalities] + list(problem.rows.equalities)
    names += [f"bound of {name}" for _, name in problem.columns]
    names += [f"set of values of {name}" for _, name in problem.columns]
    columns = zip(problem.columns, x, np.minimum(size, 1.0), strict=True)
    discrete = [_distance(v, value, unit) for (v, _), value, unit in columns]
    amounts = np.concatenate(
        [
            batch.G[0] - 1.0,
            np.abs(batch.H[0] - 1.0),
            np.maximum(lower - x, x - upper) / np.minimum(size, np.maximum(1.0, np.abs(x))),
            np.array(discrete),
        ]
    )
    worst = int(amounts.argmax())  # the first NaN; at least 0, that of a value that is met
    return float(amounts[worst]), names[worst]


def _distance(variable: Any, value: float, unit: float) -> float:
    """Distance of a discrete variable from its nearest allowed value, in a unit of listed ones."""
    if variable.values is not None:
        return float(min(abs(value - v) for v in variable.values)) / unit
    return abs(value - round(value)) if variable.integer else 0.0


def runaway(problem: Problem | Conic, x: Array, lower: Array, upper: Array, guess: Array) -> str:
    """Name a variable that nothing holds: unbounded, and far beyond any scale of its guess."""
    scale = RUNAWAY * np.maximum(1.0, np.abs(guess))
    loose = ~(np.isfinite(lower) & np.isfinite(upper)) & (np.abs(x) > scale)
    if not loose.any():
        return ""
    k = int(np.argmax(loose))
    return f"nothing holds {problem.columns[k][1]} ({x[k]:.3g}): give it a bound or a limit"
