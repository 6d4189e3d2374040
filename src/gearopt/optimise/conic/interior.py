"""One solve of scaled canonical data: Clarabel, then Newton's method on the rows that hold.

An interior-point method stops where its matrix becomes too ill-conditioned. Which rows hold is
known by then, and the equations they state are solved by a few steps of Newton to the last digits:
linear rows at their limit, cones on their surface (one smooth equation each) or at their tip.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.optimise.conic.scaling import Scaled
from gearopt.optimise.terms import Array

TOLERANCES = (1e-11, 1e-8, 1e-4)  # the next where one fails; the certificate says what was reached
NEWTON = 4
REGULAR = 1e-10  # on the diagonal of Newton's matrix, taken back by refinement


@dataclass(frozen=True)
class Point:
    """x, s, y of scaled data, and the solver's words; `ray`: y claims that nothing is feasible."""

    x: Array
    s: Array
    y: Array
    words: str
    steps: int
    ray: bool = False
    solved: bool = True


def interior(scaled: Scaled, seconds: float | None = None) -> Point:
    """Clarabel on scaled data."""
    import clarabel
    import scipy.sparse as sp

    cones = []
    if scaled.zero:
        cones.append(clarabel.ZeroConeT(scaled.zero))
    if scaled.nonneg:
        cones.append(clarabel.NonnegativeConeT(scaled.nonneg))
    cones += [clarabel.SecondOrderConeT(size) for size in scaled.soc]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.presolve_enable = False
    if seconds is not None:
        settings.time_limit = max(seconds, 1e-3)
    P, A, steps = sp.csc_matrix(sp.triu(scaled.P)), sp.csc_matrix(scaled.A), 0
    for tolerance in TOLERANCES:
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
        found = clarabel.DefaultSolver(P, scaled.q, A, scaled.b, cones, settings).solve()
        words, steps = str(found.status), steps + found.iterations
        if "Solved" in words or "Infeasible" in words or "Time" in words:
            break
    x, s, y = (np.array(v, float) for v in (found.x, found.s, found.z))
    return Point(x, s, y, words, steps, "PrimalInf" in words, "Solved" in words)


@np.errstate(all="ignore")
def polished(scaled: Scaled, point: Point) -> Point | None:
    """The point where the rows that seem to hold do so exactly; None where Newton fails."""
    import scipy.sparse as sp
    from scipy.sparse.linalg import splu

    linear, surface, tip = _holding(scaled, point)
    A = sp.csr_array(scaled.A)
    x, y = point.x.copy(), np.zeros(len(point.y))
    y[linear] = point.y[linear]
    y[tip] = point.y[tip]
    factors = np.array([point.y[block.start] for block in surface])
    n = len(x)
    exact = np.concatenate([linear, tip]).astype(int)
    for _ in range(NEWTON):
        s = scaled.b - A @ x
        bent, normals, over = _surfaces(A, s, surface, factors)
        rows = sp.vstack([A[exact], normals]) if len(surface) else A[exact]
        hessian = scaled.P + bent if len(surface) else scaled.P
        count = rows.shape[0]
        if n + count > 40_000:
            return None
        matrix = sp.block_array([[hessian, rows.T], [rows, None]], format="csc")
        diagonal = sp.diags_array(np.repeat([REGULAR, -REGULAR], [n, count]))
        multipliers = np.concatenate([y[exact], factors])
        right = -np.concatenate([scaled.q + scaled.P @ x + rows.T @ multipliers, -s[exact], over])
        try:
            lu = splu(sp.csc_matrix(matrix + diagonal))
        except RuntimeError:  # exactly singular
            return None
        step = lu.solve(right)
        for _ in range(3):
            step += lu.solve(right - matrix @ step)
        if not np.isfinite(step).all():
            return None
        x = x + step[:n]
        y[exact] += step[n : n + len(exact)]
        factors = factors + step[n + len(exact) :]
    s = scaled.b - A @ x
    for block, factor in zip(surface, factors, strict=True):
        rest = slice(block.start + 1, block.stop)
        y[block.start], y[rest] = factor, -factor * s[rest] / np.linalg.norm(s[rest])
    return Point(x, s, y, point.words, point.steps) if np.isfinite(y).all() else None


def _holding(scaled: Scaled, point: Point) -> tuple[Any, list[slice], Any]:
    """Linear rows at their limit, cones on their surface, rows of cones at their tip."""
    front = scaled.zero + scaled.nonneg
    s, y = point.s, point.y
    linear = np.arange(scaled.zero)
    loose = np.arange(scaled.zero, front)
    linear = np.concatenate([linear, loose[y[loose] > s[loose]]])
    surface, tip, start = [], [np.empty(0, int)], front
    for size in scaled.soc:
        block = slice(start, start + size)
        inner = s[start] - np.linalg.norm(s[start + 1 : start + size])
        outer = y[start] - np.linalg.norm(y[start + 1 : start + size])
        if outer > s[start]:
            tip.append(np.arange(start, start + size))
        elif y[start] > inner:
            surface.append(block)
        start += size
    return linear, surface, np.concatenate(tip)


def _surfaces(A: Any, s: Array, surface: list[slice], factors: Array) -> tuple[Any, Any, Array]:
    """Second derivative of sum factor (|s_1| - s_0) in x, gradients of |s_1| - s_0, values."""
    import scipy.sparse as sp

    if not surface:
        return None, None, np.empty(0)
    bent, normals, over = [], [], []
    for block, factor in zip(surface, factors, strict=True):
        rest = slice(block.start + 1, block.stop)
        norm = np.linalg.norm(s[rest])
        unit = s[rest] / norm
        normals.append(sp.csr_array(A[[block.start]] - sp.csr_array(unit[None]) @ A[rest]))
        over.append(norm - s[block.start])
        shape = (np.eye(len(unit)) - np.outer(unit, unit)) * max(factor, 0.0) / norm
        bent.append(A[rest].T @ sp.csr_array(shape) @ A[rest])
    return sum(bent[1:], bent[0]), sp.vstack(normals), np.array(over)
