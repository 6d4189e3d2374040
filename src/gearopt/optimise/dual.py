"""Proofs by multipliers: a lower bound, or that nothing is feasible; and those of a point.

With l >= 0 and any v the Lagrangian of a convex form is convex, so on the box it is at least its
value at a point plus the minimum of its linear part; that of a strictly convex quadratic program is
bounded without a box. Rounding of every term, of the gradient too, is taken off.

Multipliers are computed from a point's gradients alone, no method's word is needed: of the rows
near their limit, those that leave the least gradient in the variables that are off their bounds; a
least squares with multipliers of inequalities >= 0.
"""

import math
from typing import Any

import numpy as np

from gearopt.optimise.form import Form
from gearopt.optimise.problem import Problem
from gearopt.optimise.quadratic import box, curvature, hessian_of, least
from gearopt.optimise.result import Outcome
from gearopt.optimise.stationarity import ACTIVE_WITHIN, Point, evaluated, hessian
from gearopt.optimise.terms import Array

# entries of the dense system; larger problems keep their method's multipliers
MAX_ENTRIES = 2_000_000
DENSE_ENTRIES = 100_000  # entries of the dense system, which takes milliseconds
SPARSE = 0.05  # share of entries up to which a larger system is solved as a sparse one
DAMPING, STEPS = 1e-11, 4  # of a sparse system; each step divides the damping's error by more


def multipliers(
    shape: Form, y: Array, p: Array, low: Array, high: Array
) -> tuple[Array, Array] | None:
    """Return (lam_g, lam_h) of a feasible point, or None.

    None where the system is too large, or a slope is no number.
    """
    no_g, no_h = (np.zeros(shape.derivatives.numel_out(k)) for k in (1, 2))
    if (len(no_g) + len(no_h)) * len(y) > MAX_ENTRIES:
        return None
    _, g, _, gradient, _ = (np.array(v).ravel() for v in shape.derivatives(y, p, no_g, no_h))
    active = np.flatnonzero(g >= -ACTIVE_WITHIN)
    rows = _rows(shape, y, p, active)
    free = (y > low + ACTIVE_WITHIN) & (y < high - ACTIVE_WITHIN)
    columns = rows.T[free]
    slopes = columns if isinstance(columns, np.ndarray) else columns.data
    if not (np.isfinite(slopes).all() and np.isfinite(gradient[free]).all()):
        return None
    lam = _signed(columns, -gradient[free], len(active))
    no_g[active] = lam[: len(active)]
    return no_g, lam[len(active) :]


def _signed(columns: Any, target: Array, count: int) -> Array:
    """Return the x of minimum |columns x - target| whose first `count` entries are >= 0.

    Entries below 0 are left out together. That is too many where columns depend on each other, as
    at a corner where more limits meet than there are variables: of a dense system those stay that
    are needed. A large sparse one is solved as often as it was, and its x may be beside the least.
    """
    keep = np.ones(columns.shape[1], bool)
    exact = isinstance(columns, np.ndarray)
    while True:
        x = np.zeros(len(keep))
        x[keep] = _least_squares(columns[:, keep], target)
        wrong = x[:count] < 0.0
        if not wrong.any():
            return x
        keep[:count] &= _needed(columns, target, count) if exact else ~wrong
        exact = False  # what is below 0 from here on is so by rounding


def _needed(columns: Array, target: Array, count: int) -> Any:
    """Return which of the first `count` entries are above 0 in the signed least squares."""
    from scipy.optimize import nnls

    other = columns[:, count:]
    signed = np.column_stack([columns[:, :count], target / np.abs(target).max()])
    signed -= other @ np.linalg.lstsq(other, signed, rcond=None)[0]
    try:
        x, _ = nnls(signed[:, :-1], signed[:, -1])
    except RuntimeError:  # no end of its iterations
        return np.ones(count, bool)
    return x > 0.0


def _rows(shape: Form, y: Array, p: Array, active: Any) -> Any:
    """Return gradients of the active inequalities and of all equalities, one per row."""
    of_g, of_h = shape.jacobians(y, p)
    size = (len(active) + of_h.shape[0]) * len(y)
    if size <= DENSE_ENTRIES or of_g.nnz() + of_h.nnz() > SPARSE * size:
        of_g, of_h = (np.array(j).reshape(-1, len(y)) for j in (of_g, of_h))
        return np.vstack([of_g[active], of_h])
    import scipy.sparse as sp

    of_g, of_h = (j.sparse().reshape(-1, len(y)).tocsr() for j in (of_g, of_h))
    return sp.vstack([of_g[active], of_h], format="csr")


def _least_squares(columns: Any, target: Array) -> Array:
    """Return the x of minimum |columns x - target|.

    Sparse: of [[1, A], [A', -d]] (r, x) = (b, 0), which is regular whatever A is, with the damping
    d taken out again step by step.
    """
    if isinstance(columns, np.ndarray):
        return np.asarray(np.linalg.lstsq(columns, target, rcond=None)[0], float)
    import scipy.sparse as sp
    from scipy.sparse.linalg import splu

    size, count = columns.shape
    damping = DAMPING * float(columns.multiply(columns).sum(axis=0).max() if count else 1.0)
    corner = -max(damping, np.finfo(float).tiny) * sp.eye(count)
    factors = splu(sp.bmat([[sp.eye(size), columns], [columns.T, corner]], format="csc"))
    x = np.zeros(count)
    for _ in range(STEPS):
        x += factors.solve(np.concatenate([target - columns @ x, np.zeros(count)]))[size:]
    return x


RISE = 1e-12  # slope towards an infinite end: above the rounding of slopes, and cheap
RANK = 1e-9  # of the largest singular value: a direction that is flat
MAX_RISEN = 200  # variables: its system is dense
ROUNDING = 1e-14  # 50 units in the last place of every term that is added up in a bound


def bound(point: Point) -> tuple[float, float]:
    """Return the minimum of the Lagrangian on the box, and the rounding taken off it."""
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


def risen(point: Point) -> Point:
    """Return the point of a log form, moved so that slopes towards infinite ends are above 0.

    By the least change of the variables and of the multipliers above 0; then those ends cost
    nothing (Lemma 3 holds at any point). The point itself where there is no such end.
    """
    problem, shape, count = point.problem, point.shape, len(point.y)
    endless = np.isinf(point.high)
    if not endless.any() or count > MAX_RISEN or shape.hessian is not None:
        return point
    firm, p = np.flatnonzero(point.lam_g > 0.0), problem.parameter_values()
    of_g, of_h = (np.array(j).reshape(-1, count) for j in shape.jacobians(point.y, p))
    off = point.y > point.low + ACTIVE_WITHIN  # at its lower end a slope above 0 costs nothing
    system = np.hstack([np.array(hessian(point))[:, off], of_g[firm].T, of_h.T])[off]
    if not np.isfinite(system).all():
        return point
    aim = RISE * max(1.0, float(point.pull.max())) * _reachable(system, endless[off])
    step = np.linalg.lstsq(system, aim - point.gradient[off], rcond=RANK)[0]
    of_y, more_g, more_h = np.split(step, np.cumsum([off.sum(), len(firm)]))
    y, lam_g, lam_h = point.y.copy(), point.lam_g.copy(), point.lam_h + more_h
    y[off] += of_y
    lam_g[firm] = np.maximum(lam_g[firm] + more_g, 0.0)
    return evaluated(problem, shape, y, point.low, point.high, lam_g, lam_h)


def _reachable(system: Array, endless: Any) -> Array:
    """Return slopes, at least 1 towards infinite ends, that the columns of a system add up to.

    Across its flat directions they are 0, as far as that goes.
    """
    from scipy.optimize import nnls

    left, sizes, _ = np.linalg.svd(system)
    flat = left[:, int((sizes > RANK * sizes.max(initial=0.0)).sum()) :].T
    either = np.hstack([flat, -flat[:, ~endless]])
    more, _ = nnls(either, -flat @ endless)
    slopes = endless + more[: len(endless)]
    slopes[~endless] -= more[len(endless) :]
    return np.asarray(slopes, float)


def farkas(
    problem: Problem, shape: Form, outcome: Outcome, low: Array, high: Array
) -> tuple[float, Array, Array]:
    """Return a lower bound of the largest violation on the box, and its multipliers (ng,), (nh,).

    In rows of the form. Above 0 it proves that no point of the box is feasible (Lemma 4): with
    l >= 0, sum l + sum |v| = 1 and a convex form, max(G, |H|) >= l.G + v.H, which is bounded by its
    linear part, less rounding. -inf where all multipliers are 0.
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
    """Return rounding of a sum of terms, by their sizes."""
    return ROUNDING * sum(float(np.abs(t).sum()) for t in terms)
