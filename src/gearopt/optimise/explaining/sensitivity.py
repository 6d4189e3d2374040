"""Sensitivities of an optimum: d ln objective / d ln input, from multipliers.

By the envelope theorem the derivative of the optimal value with respect to a parameter is the
partial derivative of the Lagrangian, and with respect to a bound that holds a variable it is the
Lagrangian's slope along that variable. No re-solve is needed; `explain` makes one to check.
"""

from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.dual import multipliers
from gearopt.optimise.form import Form, form
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array

BINDS = 1e-6  # a row this close to its limit binds
HOLDS = 1e-4  # relative: a bound this near to a variable holds it, or did with another number
KINK = 0.02  # relative difference of sensitivities from both sides that do not belong to one
STATIONARY = 1e-4  # largest gradient left in a variable off its bounds, of the multipliers


@dataclass(frozen=True)
class Sensitivities:
    """Logarithmic sensitivities of the objective: relative change per relative change.

    parameters (np,): to each. columns (n,): to the bound that holds the variable (0 where none
    does). multipliers (ng,), equalities (nh,): to the limit of each row.
    """

    parameters: Array
    columns: Array
    multipliers: Array
    equalities: Array

    def along(
        self, problem: Problem, x: Array, ends: tuple[Problem, Problem], step: float
    ) -> float | None:
        """Return d ln objective / d ln number, of a number on which the problem depends in any way.

        ends: the problem with the number times exp(-step) and exp(step). The Lagrangian of both is
        taken at the same x; of variables that their bounds hold, the bounds' moves are added. None
        where one of them has no value, or other rows, or both sides differ.
        """
        below, above = (
            self._change(x, *pair)
            for pair in zip((ends[0], problem), (problem, ends[1]), strict=True)
        )
        if below is None or above is None or not np.isfinite(below + above):
            return None
        if abs(above - below) > KINK * (step + max(abs(above), abs(below))):
            return None
        return (below + above) / (2.0 * step) + 0.0

    def _change(self, x: Array, before: Problem, after: Problem) -> float | None:
        """Return the change of the Lagrangian at x between two problems; None: other rows."""
        first, second = before.batch(x[None]), after.batch(x[None])
        if first.G.shape != second.G.shape or first.H.shape != second.H.shape:
            return None
        value, new = float(first.F[0, 0]), float(second.F[0, 0])
        if min(value, new) > 0.0:
            change = float(np.log(new / value))
        else:
            change = (new - value) / abs(value) if value else np.nan
        priced = self.multipliers > 0.0
        change += float(self.multipliers[priced] @ (second.G - first.G)[0, priced])
        change += float(self.equalities @ (second.H - first.H)[0])
        return change + float(self.columns @ _moved(before, after, x))

    def stationary(self, problem: Problem, x: Array) -> bool:
        """Return whether no gradient is left in a variable off its bounds: x may be a kink."""
        free = ~(_held(problem, x, 0) | _held(problem, x, 1))
        left = np.abs(self.columns[free]).max(initial=0.0)
        return bool(left <= STATIONARY * (1.0 + self.multipliers.max(initial=0.0)))


def _held(problem: Problem, x: Array, side: int) -> Any:
    """Return which variables (n,) their lower (0) or upper (1) bound holds; if equal the lower."""
    lower, upper, _ = problem.bounds()
    near = np.abs(x - (lower, upper)[side]) <= HOLDS * np.maximum(np.abs(x), HOLDS)
    return near if side == 0 else near & (lower < upper)


def _moved(before: Problem, after: Problem, x: Array) -> Array:
    """Return relative moves (n,) of the bounds that hold x, from one problem to another near it."""
    moves = np.zeros(len(x))
    for side in (0, 1):
        held = (_held(before, x, side) | _held(after, x, side)) & (x != 0.0)
        moves[held] = (after.bounds()[side] - before.bounds()[side])[held] / x[held]
    return moves


def of_fixed(problem: Problem) -> Sensitivities:
    """Return those of a point whose variables are all fixed: no multipliers."""
    rows = problem.rows
    no_g, no_h = np.zeros(len(rows.inequalities)), np.zeros(len(rows.equalities))
    none = np.zeros(len(problem.parameter_values())), np.zeros(len(problem.columns))
    return Sensitivities(*none, no_g, no_h)


def sensitivities(problem: Problem, x: Array) -> Sensitivities:
    """Return sensitivities of a continuous problem at its optimum x (n,).

    Where an input is infinite, or is a parameter without effect, the sensitivity is 0; at the end
    of what a text takes (a square root of 0) it may be infinite. SolveError
    where no multipliers exist (a system too large, or no optimality).
    """
    shape = form(problem)
    p = problem.parameter_values()
    low, high = (shape.to_y(a) for a in problem.bounds()[:2])
    y = shape.to_y(x)
    lam = multipliers(shape, y, p, low, high)
    if lam is None:
        raise SolveError(
            f"{problem.name} has no sensitivities: too large, or gradients are not numbers"
        )
    f, _, _, _, slope = (np.array(v).ravel() for v in shape.derivatives(y, p, *lam))
    unit = 1.0 if shape.log_objective else max(abs(float(f[0])), 1e-300)
    finite = np.where(np.isfinite(p), p, 0.0)
    along = np.where(shape.logarithmic, 1.0, x)
    by_parameter = _by_parameter(problem, shape, y, p, *lam) * finite
    return Sensitivities(
        np.nan_to_num(by_parameter, posinf=np.inf, neginf=-np.inf) / unit + 0.0,  # no -0
        slope * along / unit,
        lam[0] / unit,
        lam[1] / unit,
    )


def _by_parameter(
    problem: Problem, shape: Form, y: Array, p: Array, lam_g: Array, lam_h: Array
) -> Array:
    """Return dL/dp (np,) of L = f + lam_g.g + lam_h.h at y."""
    import casadi as ca

    key = ("sensitivity", id(shape))
    if key not in problem.memo:
        ys, ps, f, g, h = shape.expressions
        kind = type(ys)
        of_g, of_h = kind.sym("lam_g", g.numel()), kind.sym("lam_h", h.numel())
        lagrangian = f + ca.dot(of_g, g) + ca.dot(of_h, h)
        outputs = [ca.densify(ca.gradient(lagrangian, ps))]
        problem.memo[key] = ca.Function("by_parameter", [ys, ps, of_g, of_h], outputs)
    return np.array(problem.memo[key](y, p, lam_g, lam_h)).ravel()
