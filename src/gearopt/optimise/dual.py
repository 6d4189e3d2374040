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
from gearopt.optimise.stationarity import Point, evaluated
from gearopt.optimise.terms import Array

ROUNDING = 1e-14  # 50 units in the last place of every term that is added up in a bound


def bound(point: Point) -> tuple[float, float]:
    """The least value of the Lagrangian on the box, and the rounding that was taken off it."""
    lam_g, lam_h, shape, y = point.lam_g, point.lam_h, point.shape, point.y
    lagrangian = point.f + lam_g @ point.g + lam_h @ point.h
    rows = lam_g * (1.0 + np.abs(point.g)), lam_h * (1.0 + np.abs(point.h))
    doubt = ROUNDING * point.pull
    if shape.hessian is None:  # the objective is a logarithm
        slack = _allowance(1.0, point.f, *rows)
        drop = float(box(point.gradient, doubt, y, point.low, point.high).sum())
    else:
        hessian = hessian_of(point.problem, shape)
        linear, along = point.gradient_f - hessian @ y, np.abs(hessian) @ np.abs(y)
        slack = _allowance(point.f, *rows, y * along, linear * y)
        doubt = doubt + ROUNDING * (along + np.abs(linear))
        drop = least(point.gradient, doubt, y, point.low, point.high, curvature(hessian))
    return float(lagrangian + drop - slack), slack


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
    point = evaluated(problem, shape, shape.to_y(outcome.x), low, high, lam_g, lam_h)
    slack = _allowance(1.0, lam_g * (1.0 + np.abs(point.g)), lam_h * (1.0 + np.abs(point.h)))
    slopes = point.gradient - point.gradient_f
    drop = box(slopes, ROUNDING * point.pull, point.y, low, high).sum()
    return float(lam_g @ point.g + lam_h @ point.h + drop - slack), lam_g, lam_h


def _allowance(*terms: Array | float) -> float:
    """Rounding of a sum of terms, by their sizes."""
    return ROUNDING * sum(float(np.abs(t).sum()) for t in terms)
