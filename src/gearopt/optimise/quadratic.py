"""Convex quadratic programs in the natural variables: proven on the tape, bounded without a box.

    minimise 1/2 x'Qx + c'x + f0   subject to   A x + a <= 1,   B x + b = 1,   lower <= x <= upper

That f is quadratic and the rows affine is read from the tape: the degree of every term as a
polynomial, 0 constant, 1 affine, 2 quadratic, `OTHER` everything else. It is proven from the
operations alone, not sampled: cancellations (x^3 - x^3) are not seen, and kinks (abs, sign, max),
whose derivatives would pass for constants, are `OTHER`. Parameters and data are constants at their
present values. That Q is positive semidefinite is our own eigenvalue, with a rounding allowance.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.form import Form, assembled
from gearopt.optimise.problem import Problem
from gearopt.optimise.tape import Kinds, Term, fold, read
from gearopt.optimise.terms import Array

CONSTANT, AFFINE, QUADRATIC, OTHER = range(4)


def degrees(problem: Problem) -> Kinds:
    """Return the degrees of all terms, read at the present parameter values, once for each."""
    key = ("degrees", problem.parameter_values().tobytes())
    if key not in problem.memo:
        objective, *rows = (
            tuple(term.kind for term in terms)
            for terms in read(problem, lambda v: Term(AFFINE), _apply)
        )
        problem.memo[key] = Kinds(max(objective), *rows)
    kinds: Kinds = problem.memo[key]
    return kinds


def _apply(operation: int, terms: list[Term]) -> Term:
    """Return the degree of `operation(terms)`."""
    import casadi as ca

    first, last = terms[0], terms[-1]
    if all(t.kind == CONSTANT for t in terms):
        known = all(t.value is not None for t in terms)
        return Term(CONSTANT, fold(operation, [t.value for t in terms]) if known else None)
    if operation in (ca.OP_ADD, ca.OP_SUB):
        return Term(max(first.kind, last.kind))
    if operation in (ca.OP_NEG, ca.OP_TWICE, ca.OP_ASSIGN):
        return first
    if operation == ca.OP_MUL:
        return Term(min(first.kind + last.kind, OTHER))
    if operation == ca.OP_DIV:
        return Term(first.kind if last.kind == CONSTANT else OTHER)
    if operation == ca.OP_SQ:
        return Term(min(2 * first.kind, OTHER))
    if operation in (ca.OP_POW, ca.OP_CONSTPOW) and last.kind == CONSTANT:
        for power in (0, 1, 2):
            if last.value is not None and np.all(last.value == power):
                return Term(min(power * first.kind, OTHER))
    return Term(OTHER)


ROUNDING = 1e-14  # 50 units in the last place, of a matrix scaled to unit diagonal, times its size

MAX_VARIABLES = 3000  # variables; the Hessian is dense


@dataclass(frozen=True)
class Curvature:
    """Q >= floor * diag(diagonal), proven; diagonal (n,) is that of Q, with 0 for empty rows."""

    diagonal: Array
    floor: float
    rounding: float

    @property
    def convex(self) -> bool:
        """Return whether Q is positive semidefinite, within the rounding of its eigenvalues."""
        return self.floor >= -2.0 * self.rounding


def curvature(hessian: Array) -> Curvature:
    """Return the curvature of a symmetric Q (n, n), from the eigenvalues of D^-1/2 Q D^-1/2."""
    diagonal = np.diag(hessian).copy()
    used = np.abs(hessian).max(axis=1, initial=0.0) > 0.0
    rounding = ROUNDING * max(1, int(used.sum()))
    if not np.isfinite(hessian).all() or (diagonal[used] <= 0.0).any():
        return Curvature(diagonal, -np.inf, rounding)
    root = np.sqrt(diagonal[used])
    scaled = hessian[np.ix_(used, used)] / np.outer(root, root)
    least = 2.0 - float(np.abs(scaled).sum(axis=1).max(initial=1.0))  # Gershgorin's circles
    if least < 0.5:  # else good enough, at low cost
        least = float(np.linalg.eigvalsh(scaled)[0])
    return Curvature(diagonal, least - rounding, rounding)


def natural(problem: Problem) -> Form | None:
    """Return the form in the natural variables, where a problem is proven quadratic; else None.

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
    """Return Q (n, n) at the present parameters."""
    return dense(shape.hessian(problem.parameter_values()))


def dense(matrix: Any) -> Array:
    """Return A casadi matrix as a dense array; casadi's own way is slow."""
    full = np.zeros(matrix.shape)
    full[matrix.sparsity().get_triplet()] = matrix.nonzeros()
    return full


def misfit(problem: Problem) -> str:
    """Name the term that a quadratic program cannot have, in words; "" if there is none."""
    of_terms, rows = degrees(problem), problem.rows
    if len(problem.columns) > MAX_VARIABLES:
        return f"it has {len(problem.columns)} variables, more than {MAX_VARIABLES}"
    if of_terms.objective > QUADRATIC:
        return f"the objective {rows.objectives[0]} is not quadratic"
    names = [r.name for r in rows.inequalities] + list(rows.equalities)
    for name, degree in zip(names, of_terms.inequalities + of_terms.equalities, strict=True):
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
    """Return the minimum of t (z - y), low <= z <= high, |t - gradient| <= doubt, by variable."""
    slopes = np.array([gradient - doubt, gradient + doubt])[:, None, :]
    with np.errstate(invalid="ignore"):
        ends = slopes * np.array([low - y, high - y])[None, :, :]
    lowest: Array = np.where(np.isnan(ends), 0.0, ends).min(axis=(0, 1))
    return lowest  # NaN, taken as 0: a slope of 0 to infinity


def least(
    gradient: Array, doubt: Array, y: Array, low: Array, high: Array, curved: Curvature
) -> float:
    """Return a lower bound of gradient.(z - y) + 1/2 (z - y)'Q(z - y) over the box.

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
