"""What multipliers prove: optimality residuals, a lower bound, or that nothing is feasible.

With l >= 0 and any v the Lagrangian of a convex form is convex, so on the box it is at least its
value at a point plus the least of its linear part. Rounding of every term, of the gradient too, is
taken off.
"""

import math

import numpy as np

from gearopt.optimise.form import Form
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Outcome
from gearopt.optimise.terms import Array

ROUNDING = 1e-14  # 50 units in the last place of every term that is added up in a bound
TINY = 1e-300  # a gap relative to an objective of zero is infinite, not an error


def kkt(
    problem: Problem, shape: Form, y: Array, low: Array, high: Array, lam_g: Array, lam_h: Array
) -> tuple[dict[str, float], float]:
    """Residuals of the optimality conditions, and the least value of the Lagrangian on the box."""
    parts = shape.derivatives(y, problem.parameter_values(), lam_g, lam_h)
    f, g, h, gradient_f, gradient = (np.array(part).ravel() for part in parts)
    scale = 1.0 if shape.log_objective else _steepness(problem, shape, gradient_f)
    step = np.clip(gradient / scale, y - high, y - low)  # a bound in the way stops a step
    residuals = {
        "stationarity": float(np.abs(step).max(initial=0.0)),
        "complementarity": float(np.abs(lam_g * g).max(initial=0.0)) / scale,
    }
    lagrangian = f[0] + lam_g @ g + lam_h @ h
    slack = _allowance(f, lam_g * (1.0 + np.abs(g)), lam_h * (1.0 + np.abs(h)))
    slack += _gradient_allowance(problem, shape, y, low, high, gradient_f, lam_g, lam_h)
    return residuals, float(lagrangian + _box(gradient, y, low, high) - slack)


def _steepness(problem: Problem, shape: Form, gradient: Array) -> float:
    """The unit of a gradient: the steepest slope of the objective here or at the guess."""
    no_g, no_h = (np.zeros(shape.derivatives.numel_out(k)) for k in (1, 2))
    guess = shape.to_y(problem.bounds()[2])
    there = np.array(shape.derivatives(guess, problem.parameter_values(), no_g, no_h)[3]).ravel()
    steepest = np.abs(np.concatenate([gradient, there]))
    return max(float(steepest[np.isfinite(steepest)].max(initial=0.0)), TINY)


def _gradient_allowance(
    problem: Problem,
    shape: Form,
    y: Array,
    low: Array,
    high: Array,
    gradient_f: Array,
    lam_g: Array,
    lam_h: Array,
) -> float:
    """Rounding of the Lagrangian's gradient, carried to the far side of the box."""
    import casadi as ca

    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return 0.0
    total = np.abs(gradient_f)
    for jacobian, lam in zip(
        shape.jacobians(y, problem.parameter_values()), (lam_g, lam_h), strict=True
    ):
        if len(lam):
            total = total + np.array(ca.mtimes(ca.fabs(jacobian).T, np.abs(lam))).ravel()
    return float(ROUNDING * (total * np.maximum(high - y, y - low)).sum())


def farkas(
    problem: Problem, shape: Form, outcome: Outcome, low: Array, high: Array
) -> tuple[float, Array, Array]:
    """The largest violation that every point of the box has at least, and normalised multipliers.

    With l >= 0, sum l + sum |v| = 1 and a convex form, max(G, |H|) >= l.G + v.H >= its linear
    lower bound on the box.
    """
    assert outcome.x is not None and outcome.lam_g is not None and outcome.lam_h is not None
    lam_g = np.maximum(outcome.lam_g, 0.0)
    lam_h = outcome.lam_h
    total = lam_g.sum() + np.abs(lam_h).sum()
    if not total > 0:
        return -math.inf, lam_g, lam_h
    lam_g, lam_h = lam_g / total, lam_h / total
    y = shape.to_y(outcome.x)
    parts = shape.derivatives(y, problem.parameter_values(), lam_g, lam_h)
    _, g, h, gradient_f, gradient = (np.array(part).ravel() for part in parts)
    slack = _allowance(lam_g * (1.0 + np.abs(g)), lam_h * (1.0 + np.abs(h)))
    slack += _gradient_allowance(problem, shape, y, low, high, gradient_f, lam_g, lam_h)
    least = lam_g @ g + lam_h @ h + _box(gradient - gradient_f, y, low, high) - slack
    return float(least), lam_g, lam_h


def _box(gradient: Array, y: Array, low: Array, high: Array) -> float:
    """Least value of gradient.(z - y) over low <= z <= high; -inf where a bound is infinite."""
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return -math.inf
    return float(np.minimum(gradient * (low - y), gradient * (high - y)).sum())


def _allowance(*terms: Array) -> float:
    return ROUNDING * (1.0 + sum(float(np.abs(t).sum()) for t in terms))
