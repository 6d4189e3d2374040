"""The space a gradient method works in: y = log x for log variables, logarithms of proven rows.

    minimise F(y)  subject to  G(y) <= 0,  H(y) = 0,  lower <= y <= upper

F = log f, G = log g and H = log h for every term that `tape` proves log-convex (H: monomial);
f, g - 1 and h - 1 for the others. When all are proven and all variables are log, F and G are convex
and H is affine: the dual bound of `certificate` then holds.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise import tape
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.terms import Array


@dataclass(frozen=True)
class Form:
    """A problem in y; `expressions` are casadi (y, p, F, G, H), the rest numbers.

    logarithmic: which variables are log (n,). log_objective: F is log f. convex: proven convex.
    terms(y, p) -> F, G and H in one column.
    derivatives(y, p, lam_g, lam_h) -> F, G, H, grad F, grad L with L = F + lam_g.G + lam_h.H.
    jacobians(y, p) -> of G and of H, sparse. hessian(p) -> of F where it is proven constant (see
    `quadratic`; G and H are then affine), else None.
    """

    expressions: tuple[Any, Any, Any, Any, Any]
    terms: Any
    derivatives: Any
    jacobians: Any
    logarithmic: Any
    log_objective: bool
    convex: bool
    hessian: Any = None

    def to_y(self, x: Array) -> Array:
        """Return the y of a natural point."""
        with np.errstate(divide="ignore"):
            return np.where(self.logarithmic, np.log(np.where(self.logarithmic, x, 1.0)), x)

    def to_x(self, y: Array) -> Array:
        """Return the natural point of a y."""
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, y, 0.0)), y)

    def objective(self, value: float) -> float:
        """Return the objective of a value of F."""
        return float(np.exp(value)) if self.log_objective else value


def form(problem: Problem) -> Form:
    """Return the form of a problem at its present parameters, built once per set of kinds.

    SolveError where the problem has no single objective.
    """
    one_objective(problem.name, problem.rows.objectives)
    term_kinds = tape.kinds(problem)
    key = ("form", term_kinds)
    if key not in problem.memo:
        problem.memo[key] = _build(problem, term_kinds)
    result: Form = problem.memo[key]
    return result


def _build(problem: Problem, found: tape.Kinds) -> Form:
    import casadi as ca

    traced = problem.traced()
    logarithmic = np.array([v.log for v, _ in problem.columns])
    kind = ca.MX if problem.repeats else ca.SX
    y = kind.sym("y", len(logarithmic))
    p = kind.sym("p", len(problem.parameter_values()))
    if logarithmic.all():
        x = ca.exp(y)
    else:
        x = ca.vertcat(
            *[ca.exp(e) if log else e for e, log in zip(ca.vertsplit(y), logarithmic, strict=True)]
        )
    f, g, h = traced.terms(x, p)
    log_objective = found.objective <= tape.POSYNOMIAL
    objective = ca.log(f) if log_objective else f
    inequalities = _rows(g, [k <= tape.POSYNOMIAL for k in found.inequalities])
    equalities = _rows(h, [k <= tape.MONOMIAL for k in found.equalities])
    convex = bool(found.log_convex and logarithmic.all())
    return assembled(
        (y, p, objective, inequalities, equalities), logarithmic, log_objective, convex
    )


def assembled(
    expressions: tuple[Any, Any, Any, Any, Any],
    logarithmic: Any,
    log_objective: bool,
    convex: bool,
    hessian: Any = None,
) -> Form:
    """Return A form of casadi expressions (y, p, F, G, H), with their derivatives."""
    import casadi as ca

    y, p, objective, inequalities, equalities = expressions
    lam_g, lam_h = (type(y).sym(n, r.numel()) for n, r in zip("gh", expressions[3:], strict=True))
    lagrangian = objective + ca.dot(lam_g, inequalities) + ca.dot(lam_h, equalities)
    gradients = [ca.gradient(objective, y), ca.gradient(lagrangian, y)]
    terms = [ca.densify(e) for e in (objective, inequalities, equalities)]
    outputs = [*terms, *(ca.densify(e) for e in gradients)]
    return Form(
        expressions,
        ca.Function("terms", [y, p], [ca.vertcat(*terms)]),
        ca.Function("derivatives", [y, p, lam_g, lam_h], outputs),
        ca.Function("jacobians", [y, p], [ca.jacobian(r, y) for r in (inequalities, equalities)]),
        logarithmic,
        log_objective,
        convex,
        hessian,
    )


def _rows(values: Any, logarithmic: list[bool]) -> Any:
    import casadi as ca

    if not logarithmic or all(logarithmic):
        return ca.log(values)
    if not any(logarithmic):
        return values - 1
    return ca.vertcat(
        *[
            ca.log(v) if log else v - 1
            for v, log in zip(ca.vertsplit(values), logarithmic, strict=True)
        ]
    )


def values(problem: Problem, shape: Form, y: Array) -> tuple[float, Array]:
    """Return F, and G and H together, at a point."""
    terms = np.array(shape.terms(y, problem.parameter_values())).ravel()
    return float(terms[0]), terms[1:]


def violation(problem: Problem, shape: Form, y: Array) -> float:
    """Return largest violation of a row at a point; inf where one is not a number."""
    count = shape.derivatives.numel_out(1)
    rows = values(problem, shape, y)[1]
    worst = np.concatenate([rows[:count], np.abs(rows[count:]), [0.0]])
    return float(np.inf if np.isnan(worst).any() else worst.max())
