"""What multipliers prove: optimality residuals, a lower bound, or that nothing is feasible.

With l >= 0 and any v the Lagrangian of a convex form is convex, so on the box it is at least its
value at a point plus the least of its linear part; that of a strictly convex quadratic program is
bounded without a box. Rounding of every term, of the gradient too, is taken off.
"""

import math

import numpy as np

from gearopt.optimise.form import Form
from gearopt.optimise.problem import Problem
from gearopt.optimise.quadratic import box, curvature, hessian_of, least
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
    doubt = _doubt(problem, shape, y, gradient_f, lam_g, lam_h)
    if shape.hessian is None:
        return residuals, float(lagrangian + box(gradient, doubt, y, low, high).sum() - slack)
    hessian = hessian_of(problem, shape)
    linear = gradient_f - hessian @ y
    sizes = np.abs(y) * (np.abs(hessian) @ np.abs(y)), np.abs(linear) * np.abs(y)
    doubt = doubt + ROUNDING * (np.abs(hessian) @ np.abs(y) + np.abs(linear))
    drop = least(gradient, doubt, y, low, high, curvature(hessian))
    return residuals, float(lagrangian + drop - slack - _allowance(*sizes))


def _steepness(problem: Problem, shape: Form, gradient: Array) -> float:
    """The unit of a gradient: the steepest slope of the objective here or at the guess."""
    no_g, no_h = (np.zeros(shape.derivatives.numel_out(k)) for k in (1, 2))
    guess = shape.to_y(problem.bounds()[2])
    there = np.array(shape.derivatives(guess, problem.parameter_values(), no_g, no_h)[3]).ravel()
    steepest = np.abs(np.concatenate([gradient, there]))
    return max(float(steepest[np.isfinite(steepest)].max(initial=0.0)), TINY)


def _doubt(
    problem: Problem, shape: Form, y: Array, gradient_f: Array, lam_g: Array, lam_h: Array
) -> Array:
    """Rounding of the Lagrangian's gradient, (n,)."""
    import casadi as ca

    total = np.abs(gradient_f)
    for jacobian, lam in zip(
        shape.jacobians(y, problem.parameter_values()), (lam_g, lam_h), strict=True
    ):
        if len(lam):
            total = total + np.array(ca.mtimes(ca.fabs(jacobian).T, np.abs(lam))).ravel()
    return ROUNDING * total


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
    doubt = _doubt(problem, shape, y, gradient_f, lam_g, lam_h)
    least = lam_g @ g + lam_h @ h + box(gradient - gradient_f, doubt, y, low, high).sum() - slack
    return float(least), lam_g, lam_h


def _allowance(*terms: Array) -> float:
    return ROUNDING * (1.0 + sum(float(np.abs(t).sum()) for t in terms))
