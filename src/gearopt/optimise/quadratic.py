"""Convex quadratic programs in the natural variables: proven on the tape, bounded without a box.

    minimise 1/2 x'Qx + c'x + f0   subject to   A x + a <= 1,   B x + b = 1,   lower <= x <= upper

That f is quadratic and the rows affine is read from the tape: the degree of every term as a
polynomial, 0 constant, 1 affine, 2 quadratic, `OTHER` everything else. It is proven from the
operations alone, not sampled: cancellations (x^3 - x^3) are not seen, and kinks (abs, sign, max),
whose derivatives would pass for constants, are `OTHER`. Parameters and data are constants at their
present values. That Q is positive semidefinite is our own eigenvalue, with a rounding allowance.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearopt.optimise.form import Form, assembled
from gearopt.optimise.problem import Problem
from gearopt.optimise.tape import Block, fold, walk
from gearopt.optimise.terms import Array

CONSTANT, AFFINE, QUADRATIC, OTHER = range(4)


@dataclass(frozen=True)
class Degrees:
    """Degree of the objective and of every inequality and equality row, in the problem's order."""

    objective: int
    inequalities: tuple[int, ...]
    equalities: tuple[int, ...]


@dataclass(frozen=True)
class _Term:
    degree: int
    value: Any = None  # of a constant, where it is known


def degrees(problem: Problem) -> Degrees:
    """Read the tapes of a problem at its present parameter values, once for each."""
    key = ("degrees", problem.parameter_values().tobytes())
    if key not in problem.memo:
        problem.memo[key] = _degrees(problem)
    found: Degrees = problem.memo[key]
    return found


def _degrees(problem: Problem) -> Degrees:
    objective: list[int] = []
    rows: tuple[list[int], list[int]] = ([], [])
    for block in problem.traced().blocks:
        read = walk(
            block.function, _inputs(problem, block), lambda value: _Term(CONSTANT, value), _apply
        )
        f, g, h = ([term.degree for term in out] for out in read)
        times = block.repeat.count if block.repeat else 1
        objective += f
        rows[0].extend(g * times)
        rows[1].extend(h * times)
    return Degrees(max(objective), tuple(rows[0]), tuple(rows[1]))


def _inputs(problem: Problem, block: Block) -> list[list[_Term]]:
    repeat = block.repeat
    data: list[Array] = [np.asarray(v, float) for v in repeat.data.values()] if repeat else []
    return [
        [_Term(AFFINE)] * sum(v.size for v in problem.variables),
        [_Term(AFFINE)] * (repeat.width if repeat else 0),
        [_Term(CONSTANT, float(v)) for v in problem.parameter_values()],
        [_Term(CONSTANT, v) for v in data],
    ]


def _apply(operation: int, terms: list[_Term]) -> _Term:
    """The degree of `operation(terms)`."""
    import casadi as ca

    first, last = terms[0], terms[-1]
    if all(t.degree == CONSTANT for t in terms):
        known = all(t.value is not None for t in terms)
        return _Term(CONSTANT, fold(operation, [t.value for t in terms]) if known else None)
    if operation in (ca.OP_ADD, ca.OP_SUB):
        return _Term(max(first.degree, last.degree))
    if operation in (ca.OP_NEG, ca.OP_TWICE, ca.OP_ASSIGN):
        return first
    if operation == ca.OP_MUL:
        return _Term(min(first.degree + last.degree, OTHER))
    if operation == ca.OP_DIV:
        return _Term(first.degree if last.degree == CONSTANT else OTHER)
    if operation == ca.OP_SQ:
        return _Term(min(2 * first.degree, OTHER))
    if operation in (ca.OP_POW, ca.OP_CONSTPOW) and last.degree == CONSTANT:
        for power in (0, 1, 2):
            if last.value is not None and np.all(last.value == power):
                return _Term(min(power * first.degree, OTHER))
    return _Term(OTHER)


ROUNDING = 1e-14  # 50 units in the last place, of a matrix scaled to unit diagonal, times its size

MOST = 3000  # variables; the Hessian is dense


@dataclass(frozen=True)
class Curvature:
    """Q >= floor * diag(diagonal), proven; diagonal (n,) is that of Q, with 0 for empty rows."""

    diagonal: Array
    floor: float
    rounding: float

    @property
    def convex(self) -> bool:
        """Whether Q is positive semidefinite, within the rounding of its eigenvalues."""
        return self.floor >= -2.0 * self.rounding


def curvature(hessian: Array) -> Curvature:
    """The curvature of a symmetric Q (n, n), from the eigenvalues of D^-1/2 Q D^-1/2."""
    diagonal = np.diag(hessian).copy()
    used = np.abs(hessian).max(axis=1, initial=0.0) > 0.0
    rounding = ROUNDING * max(1, int(used.sum()))
    if not np.isfinite(hessian).all() or (diagonal[used] <= 0.0).any():
        return Curvature(diagonal, -np.inf, rounding)
    root = np.sqrt(diagonal[used])
    scaled = hessian[np.ix_(used, used)] / np.outer(root, root)
    least = 2.0 - float(np.abs(scaled).sum(axis=1).max(initial=1.0))  # Gershgorin's circles
    if least < 0.5:  # else good enough, and cheap
        least = float(np.linalg.eigvalsh(scaled)[0])
    return Curvature(diagonal, least - rounding, rounding)


def natural(problem: Problem) -> Form | None:
    """The form in the natural variables, where a problem is proven quadratic; else None.

    `convex` says whether it is a convex quadratic program at the present parameters.
    """
    if misfit(problem) or len(problem.rows.objectives) != 1:
        return None
    key = ("natural", degrees(problem))
    if key not in problem.memo:
        problem.memo[key] = _build(problem)
    shape: Form = problem.memo[key]
    return replace(shape, convex=curvature(hessian_of(problem, shape)).convex)


def hessian_of(problem: Problem, shape: Form) -> Array:
    """Q (n, n) at the present parameters."""
    return dense(shape.hessian(problem.parameter_values()))


def dense(matrix: Any) -> Array:
    """A casadi matrix as a dense array; casadi's own way is slow."""
    found = np.zeros(matrix.shape)
    found[matrix.sparsity().get_triplet()] = matrix.nonzeros()
    return found


def misfit(problem: Problem) -> str:
    """The term that is of too high a degree for a quadratic program, in words; "" if none is."""
    found, rows = degrees(problem), problem.rows
    if len(problem.columns) > MOST:
        return f"it has {len(problem.columns)} variables, more than {MOST}"
    if found.objective > QUADRATIC:
        return f"the objective {rows.objectives[0]} is not quadratic"
    names = [r.name for r in rows.inequalities] + list(rows.equalities)
    for name, degree in zip(names, found.inequalities + found.equalities, strict=True):
        if degree > AFFINE:
            return f"{name} is not affine"
    return ""


def _build(problem: Problem) -> Form:
    import casadi as ca

    kind = ca.MX if problem.repeats else ca.SX
    x = kind.sym("x", len(problem.columns))
    p = kind.sym("p", len(problem.parameter_values()))
    f, g, h = problem.traced().terms(x, p)
    full = ca.jacobian(ca.gradient(f, x), x)  # ca.hessian takes n^3 steps for a dense one
    hessian = ca.Function("hessian", [x, p], [(full + full.T) / 2])(0, p)
    return assembled(
        (x, p, f, g - 1, h - 1),
        np.zeros(x.numel(), bool),
        log_objective=False,
        convex=False,
        hessian=ca.Function("hessian", [p], [hessian]),
    )


def box(gradient: Array, doubt: Array, y: Array, low: Array, high: Array) -> Array:
    """Least of t (z - y) over low <= z <= high and |t - gradient| <= doubt, of each variable."""
    slopes = np.array([gradient - doubt, gradient + doubt])[:, None, :]
    with np.errstate(invalid="ignore"):
        ends = slopes * np.array([low - y, high - y])[None, :, :]
    lowest: Array = np.where(np.isnan(ends), 0.0, ends).min(axis=(0, 1))
    return lowest  # NaN, taken as 0: a slope of 0 to infinity


def least(
    gradient: Array, doubt: Array, y: Array, low: Array, high: Array, curved: Curvature
) -> float:
    """Lower bound of gradient.(z - y) + 1/2 (z - y)'Q(z - y) over the box.

    Every variable is charged the less of its linear part over its bounds and, where Q is definite,
    of slope^2/(2 floor Q_jj), which needs no bounds. Q below 0 by rounding is charged over the box.
    """
    linear = box(gradient, doubt, y, low, high)
    steep = np.abs(gradient) + doubt
    diagonal = curved.diagonal
    if curved.floor <= 0.0:
        width = np.where(diagonal > 0.0, np.maximum(high - y, y - low), 0.0)
        return float(linear.sum() + 0.5 * curved.floor * (diagonal * width**2).sum())
    with np.errstate(divide="ignore", invalid="ignore"):
        bowl = np.where(diagonal > 0.0, -0.5 * steep**2 / (curved.floor * diagonal), -np.inf)
    return float(np.maximum(linear, bowl).sum())
