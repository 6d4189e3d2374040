"""Multipliers of a point, computed from its gradients alone: no method's word is needed.

Of the rows near their limit, those multipliers that leave the least gradient in the variables that
are off their bounds; an active-set least squares with multipliers of inequalities >= 0.
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
    count = len(active)
    keep = np.ones(count + len(no_h), bool)
    while True:
        lam = np.zeros(len(keep))
        lam[keep] = _least_squares(columns[:, keep], -gradient[free])
        wrong = keep[:count] & (lam[:count] < 0.0)
        if not wrong.any():
            break
        keep[:count] &= ~wrong
    lam_g = no_g.copy()
    lam_g[active] = lam[:count]
    return lam_g, lam[count:]


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
