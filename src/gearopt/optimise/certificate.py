"""Judges an outcome from the problem's own terms, never from what a method says.

Tolerances: a row may exceed its limit by FEASIBLE (the unit of a row is 1); a KKT point has
stationarity and complementarity below STATIONARY; the bounds carry a rounding allowance.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from gearopt.errors import CertificateError
from gearopt.optimise.form import Form, form
from gearopt.optimise.multipliers import multipliers
from gearopt.optimise.problem import Batch, Problem
from gearopt.optimise.result import Outcome, Result
from gearopt.optimise.terms import Array

FEASIBLE = 1e-8  # rows are dimensionless; a stress 1e-8 over its limit is below any data error
STATIONARY = 1e-6  # of the objective's logarithm (or its largest derivative) per unit step
ROUNDING = 1e-14  # 50 units in the last place of every term that is added up in a bound
FARKAS = 1e-9  # an infeasibility proof must show at least this violation
TINY = 1e-300  # a gap relative to an objective of zero is infinite, not an error
RUNAWAY = 1e9  # a variable without a bound that moves this factor from its guess is held by nothing


@dataclass(frozen=True)
class Verdict:
    """What is certain: status, objective, bound and gap (or None), residuals, proof, words."""

    status: str
    objective: float | None = None
    bound: float | None = None
    gap: float | None = None
    certificate: Mapping[str, float | None] = field(default_factory=dict)
    proof: Mapping[str, Any] = field(default_factory=dict)
    message: str = ""


def certify(problem: Problem, outcome: Outcome, gap: float, exact: bool = False) -> Verdict:
    """Status, bound and residuals of an outcome; `gap` is the largest one called optimal.

    exact: the outcome is that of the formulation's own exact algorithm, whose bound and exhaustion
    count; of any other method they do not. CertificateError where a bound contradicts a feasible
    point, or where a further point of the list is not feasible.
    """
    if not exact:
        outcome = replace(outcome, bound=None, proof=None)
    for other in outcome.others:
        violation, worst = _violation(problem, other, problem.batch(other[None]))
        if not violation <= FEASIBLE:
            raise CertificateError(f"a listed point violates {worst} by {violation:.3g}")
    if outcome.infeasible:
        return _infeasible(problem, outcome)
    unsolved = "failed" if outcome.finished else "limit"
    if outcome.x is None:
        return Verdict(unsolved, message=outcome.message or "no point found")
    batch = problem.batch(outcome.x[None])
    violation, worst = _violation(problem, outcome.x, batch)
    certificate: dict[str, float | None] = {"feasibility": violation}
    if not violation <= FEASIBLE:
        message = f"{worst} is violated by {violation:.3g}. {outcome.message}".strip()
        return Verdict(unsolved, certificate=certificate, message=message)
    value = float(batch.F[0, 0])
    if not math.isfinite(value):
        where = ", ".join(
            f"{n} = {v:.6g}" for (_, n), v in zip(problem.columns, outcome.x, strict=True)
        )
        message = f"{problem.rows.objectives[0]} is not a number at {where}"[:300]
        return Verdict(unsolved, certificate=certificate, message=message)
    if outcome.bound is not None and math.isfinite(outcome.bound):
        return _claimed(outcome, value, certificate, gap)
    if any(v.discrete for v, _ in problem.columns):
        status = "feasible" if outcome.finished else "limit"
        return Verdict(status, value, certificate=certificate, message=outcome.message)
    return _local(problem, outcome, value, certificate, gap)


def _claimed(
    outcome: Outcome, value: float, certificate: dict[str, float | None], tolerance: float
) -> Verdict:
    """Judge a point with the bound of an exact algorithm."""
    bound = outcome.bound
    assert bound is not None
    gap = (value - bound) / max(abs(value), TINY)
    if gap < -FEASIBLE:
        raise CertificateError(f"a feasible value {value!r} lies below the claimed bound {bound!r}")
    status = "optimal" if gap <= tolerance else ("feasible" if outcome.finished else "limit")
    return Verdict(
        status, value, bound, max(gap, 0.0), certificate, outcome.proof or {}, outcome.message
    )


def _local(
    problem: Problem,
    outcome: Outcome,
    value: float,
    certificate: dict[str, float | None],
    tolerance: float,
) -> Verdict:
    """Judge a point with multipliers: KKT residuals, and a dual bound where the form is convex."""
    assert outcome.x is not None
    shape = form(problem)
    lower, upper, guess = problem.bounds()
    low, high, y = (shape.to_y(a) for a in (lower, upper, outcome.x))
    candidates = [multipliers(shape, y, problem.parameter_values(), low, high)]
    if outcome.lam_g is not None and outcome.lam_h is not None:
        candidates.append((np.maximum(outcome.lam_g, 0.0), outcome.lam_h))
    judged = [_kkt(problem, shape, y, low, high, *lam) for lam in candidates if lam is not None]
    if not judged:
        return Verdict("feasible" if outcome.finished else "limit", value, certificate=certificate)
    residuals, _ = min(judged, key=lambda j: max(j[0].values()))
    certificate |= residuals
    good = max(residuals.values()) <= STATIONARY
    status = "stationary" if good else ("feasible" if outcome.finished else "limit")
    runaway = _runaway(problem, outcome.x, lower, upper, guess)
    if runaway:
        return Verdict("failed", value, certificate=certificate, message=runaway)
    least = max(least for _, least in judged)
    if not shape.convex or not math.isfinite(least):
        return Verdict(status, value, certificate=certificate, message=outcome.message)
    bound = shape.objective(least)
    gap = (value - bound) / max(abs(value), TINY)
    if gap < -100 * FEASIBLE:
        raise CertificateError(f"a feasible value {value!r} lies below the dual bound {bound!r}")
    if abs(gap) <= max(tolerance, FEASIBLE):
        status = "optimal"
    proof = {"method": "dual", "arithmetic": "double, with a rounding allowance"}
    return Verdict(status, value, bound, max(gap, 0.0), certificate, proof, outcome.message)


def _kkt(
    problem: Problem, shape: Form, y: Array, low: Array, high: Array, lam_g: Array, lam_h: Array
) -> tuple[dict[str, float], float]:
    """Residuals of the optimality conditions, and the least value of the Lagrangian on the box."""
    parts = shape.derivatives(y, problem.parameter_values(), lam_g, lam_h)
    f, g, h, gradient_f, gradient = (np.array(part).ravel() for part in parts)
    scale = 1.0 if shape.log_objective else _steepness(problem, shape, gradient_f)
    step = np.clip(gradient / scale, y - high, y - low)  # a bound in the way stops a step
    residuals = {
        "stationarity": float(np.abs(step).max(initial=0.0)),
        "complementarity": float(np.abs(lam_g * g).max(initial=0.0)) / scale,
    }
    lagrangian = f[0] + lam_g @ g + lam_h @ h
    slack = _allowance(f, lam_g * (1.0 + np.abs(g)), lam_h * (1.0 + np.abs(h)))
    slack += _gradient_allowance(problem, shape, y, low, high, gradient_f, lam_g, lam_h)
    return residuals, float(lagrangian + _box(gradient, y, low, high) - slack)


def _steepness(problem: Problem, shape: Form, gradient: Array) -> float:
    """The unit of a gradient: the steepest slope of the objective here or at the guess."""
    no_g, no_h = (np.zeros(shape.derivatives.numel_out(k)) for k in (1, 2))
    guess = shape.to_y(problem.bounds()[2])
    there = np.array(shape.derivatives(guess, problem.parameter_values(), no_g, no_h)[3]).ravel()
    steepest = np.abs(np.concatenate([gradient, there]))
    return max(float(steepest[np.isfinite(steepest)].max(initial=0.0)), TINY)


def _gradient_allowance(
    problem: Problem,
    shape: Form,
    y: Array,
    low: Array,
    high: Array,
    gradient_f: Array,
    lam_g: Array,
    lam_h: Array,
) -> float:
    """Rounding of the Lagrangian's gradient, carried to the far side of the box."""
    import casadi as ca

    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return 0.0
    total = np.abs(gradient_f)
    for jacobian, lam in zip(
        shape.jacobians(y, problem.parameter_values()), (lam_g, lam_h), strict=True
    ):
        if len(lam):
            total = total + np.array(ca.mtimes(ca.fabs(jacobian).T, np.abs(lam))).ravel()
    return float(ROUNDING * (total * np.maximum(high - y, y - low)).sum())


def _infeasible(problem: Problem, outcome: Outcome) -> Verdict:
    """Accept an infeasibility claim only with an exhausted search or a Farkas certificate."""
    if outcome.proof:
        return Verdict("infeasible", proof=outcome.proof, message=outcome.message)
    shape = form(problem)
    low, high = (shape.to_y(a) for a in problem.bounds()[:2])
    finite = np.isfinite(low).all() and np.isfinite(high).all()
    if outcome.x is None or outcome.lam_g is None or not (shape.convex and finite):
        return Verdict("failed", message=f"{outcome.message}; impossibility is not proven".lstrip())
    least, lam_g, lam_h = farkas(problem, shape, outcome, low, high)
    if not least > FARKAS:  # NaN proves nothing
        return Verdict("failed", message="no feasible point found; impossibility is not proven")
    names = [r.name for r in problem.rows.inequalities] + list(problem.rows.equalities)
    weights = np.concatenate([lam_g, np.abs(lam_h)])
    conflict = [names[k] for k in np.argsort(-weights, kind="stable") if weights[k] > 1e-6]
    proof = {"method": "dual", "conflict": conflict, "least_violation": math.expm1(least)}
    return Verdict(
        "infeasible",
        proof=proof,
        message=f"no design meets these together: {', '.join(conflict)}",
    )


def farkas(
    problem: Problem, shape: Form, outcome: Outcome, low: Array, high: Array
) -> tuple[float, Array, Array]:
    """The largest violation that every point of the box has at least, and normalised multipliers.

    With l >= 0, sum l + sum |v| = 1 and a convex form, max(G, |H|) >= l.G + v.H >= its linear
    lower bound on the box.
    """
    assert outcome.x is not None and outcome.lam_g is not None and outcome.lam_h is not None
    lam_g = np.maximum(outcome.lam_g, 0.0)
    lam_h = outcome.lam_h
    total = lam_g.sum() + np.abs(lam_h).sum()
    if not total > 0:
        return -math.inf, lam_g, lam_h
    lam_g, lam_h = lam_g / total, lam_h / total
    y = shape.to_y(outcome.x)
    parts = shape.derivatives(y, problem.parameter_values(), lam_g, lam_h)
    _, g, h, gradient_f, gradient = (np.array(part).ravel() for part in parts)
    slack = _allowance(lam_g * (1.0 + np.abs(g)), lam_h * (1.0 + np.abs(h)))
    slack += _gradient_allowance(problem, shape, y, low, high, gradient_f, lam_g, lam_h)
    least = lam_g @ g + lam_h @ h + _box(gradient - gradient_f, y, low, high) - slack
    return float(least), lam_g, lam_h


def _box(gradient: Array, y: Array, low: Array, high: Array) -> float:
    """Least value of gradient.(z - y) over low <= z <= high; -inf where a bound is infinite."""
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return -math.inf
    return float(np.minimum(gradient * (low - y), gradient * (high - y)).sum())


def _allowance(*terms: Array) -> float:
    return ROUNDING * (1.0 + sum(float(np.abs(t).sum()) for t in terms))


def _violation(problem: Problem, x: Array, batch: Batch) -> tuple[float, str]:
    """Largest violation of rows, bounds and discreteness, and the name of what has it."""
    lower, upper, _ = problem.bounds()
    logarithmic = np.array([v.log for v, _ in problem.columns])
    span = np.where(upper > lower, upper - lower, np.inf)
    width = np.where(logarithmic, np.abs(x), np.minimum(span, np.maximum(1.0, np.abs(x))))
    names = [r.name for r in problem.rows.inequalities] + list(problem.rows.equalities)
    names += [f"bound of {name}" for _, name in problem.columns]
    names += [f"set of values of {name}" for _, name in problem.columns]
    discrete = [_distance(v, value) for (v, _), value in zip(problem.columns, x, strict=True)]
    amounts = np.concatenate(
        [
            batch.G[0] - 1.0,
            np.abs(batch.H[0] - 1.0),
            np.maximum(lower - x, x - upper) / width,
            np.array(discrete),
        ]
    )
    if np.isnan(amounts).any():
        return math.nan, names[int(np.isnan(amounts).argmax())]
    worst = int(amounts.argmax())
    return max(0.0, float(amounts[worst])), names[worst]


def _distance(variable: Any, value: float) -> float:
    """Distance of a discrete variable from its nearest allowed value."""
    if variable.values is not None:
        return float(min(abs(value - v) for v in variable.values))
    return abs(value - round(value)) if variable.integer else 0.0


def _runaway(problem: Problem, x: Array, lower: Array, upper: Array, guess: Array) -> str:
    """Name a variable that nothing holds: unbounded, and far beyond any scale of its guess."""
    scale = RUNAWAY * np.maximum(1.0, np.abs(guess))
    loose = ~(np.isfinite(lower) & np.isfinite(upper)) & (np.abs(x) > scale)
    if not loose.any():
        return ""
    k = int(np.argmax(loose))
    return f"nothing holds {problem.columns[k][1]} ({x[k]:.3g}): give it a bound or a limit"


def reconcile(result: Result, relaxation: Result, tolerance: float) -> Result:
    """Hold a result against a relaxation of the same problem, solved independently.

    The better bound is kept. CertificateError where the two contradict each other.
    """
    value, bound = result.value, relaxation.bound
    if relaxation.status == "infeasible" and value is not None:
        raise CertificateError("a design was found for what the relaxation proves impossible")
    if relaxation.status == "infeasible" and result.status != "infeasible":
        return replace(
            result, status="infeasible", proof=dict(relaxation.proof), message=relaxation.message
        )
    if value is None or bound is None:
        return result
    if value < bound * (1.0 - FEASIBLE) if bound > 0 else value < bound - FEASIBLE:
        raise CertificateError(f"the value {value!r} lies below the relaxation's bound {bound!r}")
    if result.bound is not None and bound <= result.bound:
        return result
    gap = max(0.0, (value - bound) / max(abs(value), TINY))
    status = "optimal" if gap <= tolerance else result.status
    return replace(result, bound=bound, gap=gap, status=status, proof=dict(relaxation.proof))
