"""Judges an outcome from the problem's own terms, never from what a method says.

Tolerances: a row may exceed its limit by FEASIBLE (the unit of a row is 1); a KKT point has
stationarity and complementarity below STATIONARY; the bounds carry a rounding allowance.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from gearopt.errors import CertificateError, SolveError
from gearopt.optimise.dual import TINY, farkas, kkt
from gearopt.optimise.feasibility import runaway, violation
from gearopt.optimise.form import Form, form
from gearopt.optimise.multipliers import multipliers
from gearopt.optimise.problem import Problem
from gearopt.optimise.quadratic import natural
from gearopt.optimise.result import Outcome, Result

FEASIBLE = 1e-8  # rows are dimensionless; a stress 1e-8 over its limit is below any data error
STATIONARY = 1e-6  # of the objective's logarithm (or its largest derivative) per unit step
FARKAS = 1e-9  # an infeasibility proof must show at least this violation


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


@np.errstate(all="ignore")  # numbers beyond doubles become NaN, and NaN proves nothing
def certify(problem: Problem, outcome: Outcome, gap: float, exact: bool = False) -> Verdict:
    """Status, bound and residuals of an outcome; `gap` is the largest one called optimal.

    exact: the outcome is that of the formulation's own exact algorithm, whose bound and exhaustion
    count; of any other method they do not. CertificateError where a bound contradicts a feasible
    point, or where a further point of the list is not feasible.
    """
    if not exact:
        outcome = replace(outcome, bound=None, proof=None)
    for other in outcome.others:
        excess, worst = violation(problem, other, problem.batch(other[None]))
        if not excess <= FEASIBLE:
            raise CertificateError(f"a listed point violates {worst} by {excess:.3g}")
    if outcome.infeasible:
        return _infeasible(problem, outcome)
    unsolved = "failed" if outcome.finished else "limit"
    if outcome.x is None:
        return Verdict(unsolved, message=outcome.message or "no point found")
    batch = problem.batch(outcome.x[None])
    excess, worst = violation(problem, outcome.x, batch)
    certificate: dict[str, float | None] = {"feasibility": excess}
    if not excess <= FEASIBLE:
        message = f"{worst} is violated by {excess:.3g}. {outcome.message}".strip()
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
    several = len(problem.rows.objectives) > 1  # then the first counts, and no multipliers do
    if several or any(v.discrete for v, _ in problem.columns):
        status = "feasible" if outcome.finished else "limit"
        return Verdict(status, value, certificate=certificate, message=outcome.message)
    return _local(problem, outcome, value, certificate, gap)


def _shape(problem: Problem) -> Form:
    """The form of a problem, or where only that is proven convex, the one in natural variables."""
    shape = form(problem)
    plain = None if shape.convex else natural(problem)
    return plain if plain is not None and plain.convex else shape


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
    try:
        shape = _shape(problem)
    except SolveError as untraced:  # without derivatives no more than a feasible point is certain
        message = f"{outcome.message} No bound, no optimality conditions: {untraced}".lstrip()
        status = "feasible" if outcome.finished else "limit"
        return Verdict(status, value, certificate=certificate, message=message)
    lower, upper, guess = problem.bounds()
    low, high, y = (shape.to_y(a) for a in (lower, upper, outcome.x))
    candidates = [multipliers(shape, y, problem.parameter_values(), low, high)]
    if outcome.lam_g is not None and outcome.lam_h is not None:
        candidates.append((np.maximum(outcome.lam_g, 0.0), outcome.lam_h))
    judged = [kkt(problem, shape, y, low, high, *lam) for lam in candidates if lam is not None]
    if not judged:
        return Verdict("feasible" if outcome.finished else "limit", value, certificate=certificate)
    residuals, _ = min(judged, key=lambda j: np.nan_to_num(max(j[0].values()), nan=np.inf))
    certificate |= residuals
    good = max(residuals.values()) <= STATIONARY
    status = "stationary" if good else ("feasible" if outcome.finished else "limit")
    loose = runaway(problem, outcome.x, lower, upper, guess)
    if loose:
        return Verdict("failed", value, certificate=certificate, message=loose)
    least = max((least for _, least in judged if not math.isnan(least)), default=-math.inf)
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


def _infeasible(problem: Problem, outcome: Outcome) -> Verdict:
    """Accept an infeasibility claim only with an exhausted search or a Farkas certificate."""
    if outcome.proof:
        return Verdict("infeasible", proof=outcome.proof, message=outcome.message)
    shape = _shape(problem)
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
    excess = least if shape.hessian is not None else math.expm1(least)  # rows or their logarithms
    proof = {"method": "dual", "conflict": conflict, "least_violation": excess}
    return Verdict(
        "infeasible",
        proof=proof,
        message=f"no design meets these together: {', '.join(conflict)}",
    )


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
