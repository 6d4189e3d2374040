"""One solve of canonical data: scaling that keeps cones, Clarabel, then Newton's method.

Scales are powers of two, one a column, one a row, one a plain cone block. A rotated block
p q >= |w|^2 has two: p and q are scaled apart and w by the root of both. The first scale makes the
entries of A, b and c as equal as they get (least squares of their logarithms, after Curtis and
Reid); later ones make the solution found so far 1.

An interior-point method stops where its matrix becomes too ill-conditioned. Which rows hold is
known by then, and the equations they state are solved by a few steps of Newton to the last digits:
linear rows at their limit, cones on their surface (one smooth equation each) or at their tip.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.conic.canonical import Canonical
from gearopt.optimise.terms import Array

STEP = 10.0  # largest change of a column's exponent of two from one solution to the next
LOOSE = 1e7  # a bound this far beyond a column's scale is left to the certificate


@dataclass(frozen=True)
class Equilibration:
    """x = column * scaled x; scaled rows = row * rows; scaled cost = cost * the cost."""

    column: Array
    row: Array
    cost: float


@dataclass(frozen=True)
class Scaled:
    """Data of Clarabel: P, q, A, b and sizes of the cones; bound rows stand after `nonneg`.

    back (m, rows): multipliers of its rows to those of the scaled canonical rows. ends: column,
    sign and factor of every bound row.
    """

    P: Any
    q: Array
    A: Any
    b: Array
    zero: int
    nonneg: int
    soc: tuple[int, ...]
    back: Any
    ends: tuple[Any, Array, Array]
    scale: Equilibration

    def within(self, lower: Array, upper: Array) -> "Scaled":
        """Return the same data with other bounds of the columns."""
        column, sign, factor = self.ends
        b = self.b.copy()
        rows = slice(self.zero + self.nonneg - len(column), self.zero + self.nonneg)
        bound = np.where(sign > 0, upper[column], -lower[column])
        b[rows] = factor * bound / self.scale.column[column]
        return replace(self, b=b)


def equal(data: Canonical) -> Equilibration:
    """Return the first scale: least squares of log|entry| + its column's + its row's exponent."""
    import scipy.sparse as sp
    from scipy.sparse.linalg import lsqr

    groups = _groups(data)
    row, column, value = data.entries
    n, count = len(data.c), groups.shape[1]
    stated, priced, bent = (np.flatnonzero(v) for v in (data.b, data.c, data.P.diagonal()))
    left = sp.block_array(
        [
            [_picks(column, n), groups[row], None],
            [sp.csr_array((len(stated), n)), groups[stated], None],
            [_picks(priced, n), None, np.ones((len(priced), 1))],
            [2.0 * _picks(bent, n), None, np.ones((len(bent), 1))],
        ],
        format="csr",
    )
    entries = [value, data.b[stated], data.c[priced], data.P.diagonal()[bent]]
    right = -np.log2(np.abs(np.concatenate(entries)))
    exponents = lsqr(left, right, damp=1e-4, atol=1e-6, btol=1e-6, iter_lim=2000)[0]
    rows = groups @ _whole(data, exponents[n : n + count])
    return Equilibration(
        np.exp2(np.rint(exponents[:n])), np.exp2(rows), float(np.exp2(np.rint(exponents[-1])))
    )


def after(data: Canonical, scale: Equilibration, x: Array) -> Equilibration:
    """Return the scale in which x, the largest entry of a row and the cost are about 1."""
    size = np.abs(x) / scale.column
    step = np.clip(np.log2(np.maximum(size, 1e-300)), -STEP, STEP)
    column = scale.column * np.exp2(np.rint(step))
    row, where, value = data.entries
    largest = np.abs(data.b)
    np.maximum.at(largest, row, np.abs(value) * column[where])
    member = _leaders(data)
    kept = member >= 0
    groups = _groups(data)
    most = np.zeros(groups.shape[1])
    np.maximum.at(most, member[kept], largest[kept])
    rows = groups @ _whole(data, -np.log2(np.where(most > 0, most, 1.0)))
    price = np.abs(data.c * column).max(initial=0.0)
    price = max(price, float(np.abs(data.P.diagonal() * column**2).max(initial=0.0)))
    cost = float(np.exp2(-np.rint(np.log2(price)))) if price > 0 else 1.0
    return Equilibration(column, np.exp2(rows), cost)


def scaled(data: Canonical, scale: Equilibration) -> Scaled:
    """Return the data in a scale, with rows for the bounds of the columns that have some."""
    import scipy.sparse as sp

    n, m = len(data.c), len(data.b)
    D, E = sp.diags_array(scale.column), sp.diags_array(scale.row)
    discrete = np.isin(np.arange(n), list(data.allowed))
    above = np.flatnonzero((np.abs(data.upper / scale.column) < LOOSE) | discrete)
    below = np.flatnonzero((np.abs(data.lower / scale.column) < LOOSE) | discrete)
    column = np.concatenate([above, below])
    sign = np.repeat([1.0, -1.0], [len(above), len(below)])
    bound = np.where(sign > 0, data.upper[column], data.lower[column]) / scale.column[column]
    factor = 1.0 / np.maximum(1.0, np.abs(bound))
    front = data.zero + data.nonneg
    plain = _plain(data)
    A, b = plain @ (E @ data.A @ D), plain @ (scale.row * data.b)
    count = len(column)
    back = sp.vstack([plain[:front], sp.csr_array((count, m)), plain[front:]]).T
    unbounded = Scaled(
        sp.csc_array(scale.cost * (D @ data.P @ D)),
        scale.cost * scale.column * data.c,
        sp.vstack([A[:front], _picks(column, n, sign * factor), A[front:]], format="csc"),
        np.concatenate([b[:front], np.zeros(count), b[front:]]),
        data.zero,
        data.nonneg + count,
        tuple(block.size for block in data.blocks),
        sp.csr_array(back),
        (column, sign, factor),
        scale,
    )
    return unbounded.within(data.lower, data.upper)


def _picks(columns: Any, width: int, values: Array | None = None) -> Any:
    """Return A sparse matrix with one entry a row."""
    import scipy.sparse as sp

    count = len(columns)
    values = np.ones(count) if values is None else values
    return sp.csr_array((values, (np.arange(count), columns)), shape=(count, width))


def _plain(data: Canonical) -> Any:
    """Return the map of our slacks to Clarabel's: s_0 = (p + q)/2, s_1 = (p - q)/2 if rotated."""
    import scipy.sparse as sp

    plain = sp.eye_array(len(data.b), format="lil")
    for block in data.blocks:
        if block.rotated:
            k = block.start
            plain[k, k] = plain[k, k + 1] = plain[k + 1, k] = 0.5
            plain[k + 1, k + 1] = -0.5
    return plain.tocsr()


def _leaders(data: Canonical) -> Any:
    """Return number of the exponent that a row asks for; -1 for the w rows of rotated blocks."""
    front = data.zero + data.nonneg
    member = np.full(len(data.b), -1)
    member[:front] = np.arange(front)
    number = front
    for block in data.blocks:
        if block.rotated:
            member[block.start], member[block.start + 1] = number, number + 1
        else:
            member[block.rows] = number
        number += 1 + block.rotated
    return member


def _groups(data: Canonical) -> Any:
    """Return rows' exponents from the free ones (rows, exponents); w: the mean of p and q."""
    import scipy.sparse as sp

    member = _leaders(data)
    free = sp.lil_array((len(member), int(member.max(initial=-1)) + 1))
    kept = np.flatnonzero(member >= 0)
    free[kept, member[kept]] = 1.0
    for block in data.blocks:
        if block.rotated:
            first = member[block.start]
            for k in range(block.start + 2, block.start + block.size):
                free[k, first] = free[k, first + 1] = 0.5
    return free.tocsr()


def _whole(data: Canonical, exponents: Array) -> Array:
    """Round exponents so that the mean of a rotated block's two is whole too."""
    whole = np.rint(exponents)
    number = data.zero + data.nonneg
    for block in data.blocks:
        if block.rotated:
            whole[number + 1] += (whole[number] + whole[number + 1]) % 2.0
        number += 1 + block.rotated
    return whole


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
    """Solve scaled data by Clarabel."""
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
        solution = clarabel.DefaultSolver(P, scaled.q, A, scaled.b, cones, settings).solve()
        words, steps = str(solution.status), steps + solution.iterations
        if "Solved" in words or "Infeasible" in words or "Time" in words:
            break
    x, s, y = (np.array(v, float) for v in (solution.x, solution.s, solution.z))
    return Point(x, s, y, words, steps, "PrimalInf" in words, "Solved" in words)


@np.errstate(all="ignore")
def polished(scaled: Scaled, point: Point) -> Point | None:
    """Return the point where the rows that seem to hold do so exactly; None: Newton fails."""
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
    """Return linear rows at their limit, cones on their surface, rows of cones at their tip."""
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
    """Return second derivative of sum factor (|s_1| - s_0) in x, its gradients and values."""
    import scipy.sparse as sp

    if not surface:
        return None, None, np.empty(0)
    count, start = len(surface), np.array([block.start for block in surface])
    rest = [np.arange(block.start + 1, block.stop) for block in surface]
    norms = np.array([np.linalg.norm(s[rows]) for rows in rest])
    units = [s[rows] / norm for rows, norm in zip(rest, norms, strict=True)]
    shapes = [
        (np.eye(len(unit)) - np.outer(unit, unit)) * (max(factor, 0.0) / norm)
        for unit, factor, norm in zip(units, factors, norms, strict=True)
    ]
    owner = np.repeat(np.arange(count), [len(rows) for rows in rest])
    places = np.concatenate([np.arange(count), owner]), np.concatenate([start, *rest])
    values = np.concatenate([np.ones(count), *(-unit for unit in units)])
    normals = sp.csr_array((values, places), shape=(count, len(s))) @ A
    tips = A[np.concatenate(rest)]
    return tips.T @ sp.block_diag(shapes, "csr") @ tips, normals, norms - s[start]
