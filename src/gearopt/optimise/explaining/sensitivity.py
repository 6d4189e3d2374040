"""What an optimum owes to each input: d ln objective / d ln input, from multipliers.

By the envelope theorem the derivative of the optimal value with respect to a parameter is the
partial derivative of the Lagrangian, and with respect to a bound that holds a variable it is the
Lagrangian's slope along that variable. No re-solve is needed; `explain` makes one to check.
"""

from dataclasses import dataclass

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.form import Form, form
from gearopt.optimise.multipliers import multipliers
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array

BINDS = 1e-6  # a row this close to its limit binds


@dataclass(frozen=True)
class Sensitivities:
    """parameters (np,) and columns (n,): relative change of the objective per relative change.

    columns: of a bound that holds the variable (0 where none does). multipliers (ng,): of the
    inequality rows, relative change of the objective per relative change of the row's limit.
    """

    parameters: Array
    columns: Array
    multipliers: Array


def sensitivities(problem: Problem, x: Array) -> Sensitivities:
    """Sensitivities of a continuous problem at its optimum x (n,).

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
            f"{problem.name} has no sensitivities: too large, or slopes are no numbers"
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
    )


def _by_parameter(
    problem: Problem, shape: Form, y: Array, p: Array, lam_g: Array, lam_h: Array
) -> Array:
    """dL/dp (np,)."""
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
