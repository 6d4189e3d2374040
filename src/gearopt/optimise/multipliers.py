"""Multipliers of a point, computed from its gradients alone: no method's word is needed.

Of the rows near their limit, those multipliers that leave the least gradient in the variables that
are off their bounds; an active-set least squares with multipliers of inequalities >= 0.
"""

import numpy as np

from gearopt.optimise.form import Form
from gearopt.optimise.terms import Array

NEAR = 1e-6  # a row this close to its limit, a variable this close to its bound, is active
MOST = 2_000_000  # entries of the dense system; larger problems keep their method's multipliers


def multipliers(
    shape: Form, y: Array, p: Array, low: Array, high: Array
) -> tuple[Array, Array] | None:
    """(lam_g, lam_h) of a feasible point, or None where the system is too large."""
    no_g, no_h = (np.zeros(shape.derivatives.numel_out(k)) for k in (1, 2))
    if (len(no_g) + len(no_h)) * len(y) > MOST:
        return None
    _, g, _, gradient, _ = (np.array(v).ravel() for v in shape.derivatives(y, p, no_g, no_h))
    active = np.flatnonzero(g >= -NEAR)
    of_g, of_h = (np.array(j).reshape(-1, len(y)) for j in shape.jacobians(y, p))
    rows = np.vstack([of_g[active], of_h])
    free = (y > low + NEAR) & (y < high - NEAR)
    count = len(active)
    keep = np.ones(count + len(no_h), bool)
    lam = np.zeros(len(keep))
    for _ in range(count + 1):
        lam[:] = 0.0
        lam[keep] = np.linalg.lstsq(rows[keep][:, free].T, -gradient[free], rcond=None)[0]
        wrong = keep[:count] & (lam[:count] < 0.0)
        if not wrong.any():
            break
        keep[:count] &= ~wrong
    lam_g = no_g.copy()
    lam_g[active] = np.maximum(lam[:count], 0.0)
    return lam_g, lam[count:]
