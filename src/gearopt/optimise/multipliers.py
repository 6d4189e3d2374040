"""Multipliers of a point, computed from its gradients alone: no method's word is needed.

Of the rows near their limit, those multipliers that leave the least gradient in the variables that
are off their bounds; a least squares with multipliers of inequalities >= 0.
"""

from typing import Any

import numpy as np

from gearopt.optimise.form import Form
from gearopt.optimise.terms import Array

NEAR = 1e-6  # a row this close to its limit, a variable this close to its bound, is active
MOST = 2_000_000  # entries of the dense system; larger problems keep their method's multipliers
SMALL = 100_000  # entries of the dense system, which takes milliseconds
SPARSE = 0.05  # share of entries up to which a larger system is solved as a sparse one
DAMPING, STEPS = 1e-11, 4  # of a sparse system; each step divides the damping's error by more


def multipliers(
    shape: Form, y: Array, p: Array, low: Array, high: Array
) -> tuple[Array, Array] | None:
    """(lam_g, lam_h) of a feasible point, or None.

    None where the system is too large, or a slope is no number.
    """
    no_g, no_h = (np.zeros(shape.derivatives.numel_out(k)) for k in (1, 2))
    if (len(no_g) + len(no_h)) * len(y) > MOST:
        return None
    _, g, _, gradient, _ = (np.array(v).ravel() for v in shape.derivatives(y, p, no_g, no_h))
    active = np.flatnonzero(g >= -NEAR)
    rows = _rows(shape, y, p, active)
    free = (y > low + NEAR) & (y < high - NEAR)
    columns = rows.T[free]
    slopes = columns if isinstance(columns, np.ndarray) else columns.data
    if not (np.isfinite(slopes).all() and np.isfinite(gradient[free]).all()):
        return None
    lam = _signed(columns, -gradient[free], len(active))
    no_g[active] = lam[: len(active)]
    return no_g, lam[len(active) :]


def _signed(columns: Any, target: Array, count: int) -> Array:
    """The x of least |columns x - target| whose first `count` entries are not below 0.

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
    """Which of the first `count` entries are above 0 in the least squares where they are >= 0."""
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
    """Gradients of the active inequalities and of all equalities, a row each."""
    of_g, of_h = shape.jacobians(y, p)
    size = (len(active) + of_h.shape[0]) * len(y)
    if size <= SMALL or of_g.nnz() + of_h.nnz() > SPARSE * size:
        of_g, of_h = (np.array(j).reshape(-1, len(y)) for j in (of_g, of_h))
        return np.vstack([of_g[active], of_h])
    import scipy.sparse as sp

    of_g, of_h = (j.sparse().reshape(-1, len(y)).tocsr() for j in (of_g, of_h))
    return sp.vstack([of_g[active], of_h], format="csr")


def _least_squares(columns: Any, target: Array) -> Array:
    """The x of least |columns x - target|.

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
