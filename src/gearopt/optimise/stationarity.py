"""Whether a point is stationary: the first-order conditions, in the form's variables.

No variable promises a decrease, by its slope over its own scale, that is more than STATIONARY of
what acts on it: the slopes of the objective and of the limits, which cancel in a solution, and the
curvature. Neither a unit nor a factor of the objective changes that. (For the second-order
conditions see `second_order`.)
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.optimise.form import Form
from gearopt.optimise.problem import Problem
from gearopt.optimise.scale import sizes
from gearopt.optimise.terms import Array

STATIONARY = 1e-6  # of what acts on a variable; of the objective itself where the form is convex
WEAK = 1e-8  # of the variable that is acted on most: less is rounding of the multipliers
ALONE = 1e-14  # the same without multipliers


@dataclass(frozen=True)
class Point:
    """A point of a form with multipliers, and the derivatives there.

    low, high: bounds of y. f, g, h: values of the form. gradient: of the Lagrangian. pull (n,): the
    sizes of the slopes that are added up in it.
    """

    problem: Problem
    shape: Form
    y: Array
    low: Array
    high: Array
    lam_g: Array
    lam_h: Array
    f: float
    g: Array
    h: Array
    gradient_f: Array
    gradient: Array
    pull: Array


def evaluated(
    problem: Problem, shape: Form, y: Array, low: Array, high: Array, lam_g: Array, lam_h: Array
) -> Point:
    """Evaluate a form and its derivatives at a point with multipliers."""
    import casadi as ca

    p = problem.parameter_values()
    parts = shape.derivatives(y, p, lam_g, lam_h)
    f, g, h, gradient_f, gradient = (np.array(part).ravel() for part in parts)
    pull = np.abs(gradient_f)
    for jacobian, lam in zip(shape.jacobians(y, p), (lam_g, lam_h), strict=True):
        pull = pull + np.array(ca.mtimes(ca.fabs(jacobian).T, np.abs(lam))).ravel()
    given = (problem, shape, y, low, high, lam_g, lam_h)
    return Point(*given, float(f[0]), g, h, gradient_f, gradient, pull)


def residuals(point: Point) -> dict[str, float]:
    """Stationarity and complementarity of a point, both relative, hence without units."""
    own, unit = own_scales(point), acting(point)
    slope = point.gradient
    room = np.clip(np.where(slope > 0.0, point.y - point.low, point.high - point.y), 0.0, own)
    slack = np.abs(point.lam_g * point.g).max(initial=0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        promised = np.where(slope == 0.0, 0.0, np.abs(slope) * room / unit)
        held = 0.0 if slack == 0.0 else slack / unit.max()
    return {"stationarity": float(promised.max()), "complementarity": float(held)}


def own_scales(point: Point) -> Array:
    """Own scale of every y: 1 of a logarithm."""
    natural = sizes(point.problem, point.shape.to_x(point.y))
    return np.where(point.shape.logarithmic, 1.0, natural)


def acting(point: Point) -> Array:
    """What acts on each variable over its own scale: slopes, and the curvature, (n,).

    A logarithm that is proven convex has the unit 1: there a promise bounds the gap.
    """
    if point.shape.convex and point.shape.log_objective:
        return np.ones(len(point.y))
    own, bend = own_scales(point), np.zeros(len(point.y))
    curved = hessian(point)
    rows, columns = (np.array(k, int) for k in curved.sparsity().get_triplet())
    there = rows == columns
    bend[rows[there]] = np.abs(np.array(curved.nonzeros())[there])
    size = point.pull * own + 0.5 * bend * own**2
    held = point.lam_g.any() or point.lam_h.any()
    unit: Array = size + (WEAK if held else ALONE) * size.max()
    return unit


def hessian(point: Point) -> Any:
    """Second derivatives of the Lagrangian, a sparse casadi matrix (n, n)."""
    import casadi as ca

    problem, shape = point.problem, point.shape
    if shape.hessian is not None:  # of rows that are affine
        return shape.hessian(problem.parameter_values())
    key = ("hessian", id(shape))
    if key not in problem.memo:
        y, p, f, g, h = shape.expressions
        lam_g, lam_h = (type(y).sym("lam", rows.numel()) for rows in (g, h))
        lagrangian = f + ca.dot(lam_g, g) + ca.dot(lam_h, h)
        outputs = [ca.hessian(lagrangian, y)[0]]
        problem.memo[key] = ca.Function("hessian", [y, p, lam_g, lam_h], outputs)
    return problem.memo[key](point.y, problem.parameter_values(), point.lam_g, point.lam_h)
