"""Judges an outcome from the problem's own terms, not from the word of a solver.

A bound and an exhausted search are taken from a problem's own exact method alone, with its proof;
a feasible point that contradicts them refuses both.

Tolerances: a row may exceed its limit by FEASIBLE (the unit of a row is 1); a stationary point has
stationarity and complementarity below STATIONARY and no direction along which the objective falls;
the bounds carry a rounding allowance. Gaps are relative to |value|, of a value that is zero to the
objective's own scale (see `scale`).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np

from gearopt.errors import CertificateError, SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.deadline import passed
from gearopt.optimise.dual import ROUNDING, farkas, multipliers, risen
from gearopt.optimise.dual import bound as dual_bound
from gearopt.optimise.epigraphs import epigraph, raised
from gearopt.optimise.form import Form, form
from gearopt.optimise.problem import Problem, Rows
from gearopt.optimise.quadratic import natural
from gearopt.optimise.result import FEASIBLE, Outcome, Result
from gearopt.optimise.scale import broken, is_known, measured, runaway, violation, way
from gearopt.optimise.scale import gap as gap_of
from gearopt.optimise.stationarity import (
    ACTIVE_WITHIN,
    STATIONARY,
    Point,
    evaluated,
    no_minimum,
    residuals,
)
from gearopt.optimise.terms import Array

LOOSE = 1e-2  # a gap above which no point of a convex problem is said to be a minimum
FARKAS = 1e-9  # an infeasibility proof must show at least this violation
CONVEX_IN_LOGARITHMS, CONVEX_QUADRATIC = (
    f"Proof: {shape}; the bound is a dual one, computed from our own derivatives."
    for shape in ("the problem is convex in logarithms", "a convex quadratic program")
)
SEARCHED, EMPTY = (
    f"Proof: the ranges of the variables in parts, each {shown}."
    for shown in (
        "bounded by linear programming or by intervals",
        "shown by linear programming or by intervals to hold no point",
    )
)


@dataclass(frozen=True)
class Verdict:
    """The certified facts: status, objective, bound and gap (or None), residuals, proof, words.

    multipliers: {name of a limit or an equality: d objective / d right-hand side}. lower: a point
    beside one that is no minimum, from which the objective falls further.
    """

    status: str
    objective: float | None = None
    bound: float | None = None
    gap: float | None = None
    certificate: Mapping[str, float | None] = field(default_factory=dict)
    proof: Mapping[str, Any] = field(default_factory=dict)
    message: str = ""
    multipliers: Mapping[str, float] = field(default_factory=dict)
    lower: Array | None = None


@np.errstate(all="ignore")  # numbers beyond doubles become NaN, and NaN proves nothing
def certify(problem: Problem, outcome: Outcome, gap: float, exact: bool = False) -> Verdict:
    """Return status, bound and residuals of an outcome; `gap`: the largest called optimal.

    exact: the outcome is that of the formulation's own exact algorithm, whose bound and exhaustion
    count; of any other method they do not. CertificateError where a bound contradicts a feasible
    point, or where a further point of the list is not feasible.
    """
    if not exact:
        outcome = replace(outcome, bound=None, proof=None, stationary=None)
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
        message = f"{broken(problem, outcome.x, excess, worst)}. {outcome.message}".strip()
        return Verdict(unsolved, certificate=certificate, message=message)
    value = float(batch.F[0, 0])
    if not math.isfinite(value):
        where = ", ".join(
            f"{n} = {v:.6g}" for (_, n), v in zip(problem.columns, outcome.x, strict=True)
        )
        message = f"{problem.rows.objectives[0]} is not a number at {where}"[:300]
        return Verdict(unsolved, certificate=certificate, message=message)
    reached = "stationary" if outcome.stationary else "feasible"
    status = reached if outcome.finished else "limit"
    before = Verdict(status, value, certificate=certificate, message=outcome.message)
    if outcome.records:
        return _searched(problem, outcome, before, gap, worst)
    if outcome.bound is not None and math.isfinite(outcome.bound):
        return _claimed(problem, outcome, before, gap)
    if outcome.stationary is not None:
        return before
    several = len(problem.rows.objectives) > 1  # then the first counts, and no multipliers do
    if several or any(v.discrete for v, _ in problem.columns):
        return before
    return _local(problem, outcome, before, gap, worst)


def _shape(problem: Problem) -> Form:
    """Return the form of a problem; where only that is proven convex, in natural variables."""
    shape = form(problem)
    plain = None if shape.convex else natural(problem)
    return plain if plain is not None and plain.convex else shape


def _claimed(problem: Problem, outcome: Outcome, before: Verdict, tolerance: float) -> Verdict:
    """Judge a point with the bound of an exact algorithm; before: the verdict without one."""
    value, bound = before.objective, outcome.bound
    assert outcome.x is not None and value is not None and bound is not None
    gap, scale = measured(problem, outcome.x, value, bound, tolerance)
    if gap < -FEASIBLE:
        raise CertificateError(f"a feasible value {value!r} lies below the claimed bound {bound!r}")
    return replace(
        before,
        status="optimal" if gap <= tolerance else before.status,
        bound=bound,
        gap=reported_gap(gap),
        certificate=dict(before.certificate) | scale,
        proof=outcome.proof or {},
    )


def bounded(
    problem: Problem | Conic,
    x: Array,
    before: Verdict,
    bound: float,
    tolerance: float,
    worst: str,
) -> Verdict:
    """Judge a point by a bound that we computed ourselves; before: the verdict without one.

    worst: the name of what has the largest violation. CertificateError where the value lies below
    the bound though no limit is exceeded: an excess gains by its shadow price, which may be any (of
    limits that contradict each other by a little), but within ROUNDING that is less than the
    rounding taken off the bound.
    """
    value, excess = before.objective, before.certificate["feasibility"]
    assert value is not None and excess is not None
    tolerance = max(tolerance, FEASIBLE)
    gap, scale = measured(problem, x, value, bound, tolerance)
    if gap < -100 * FEASIBLE and excess <= ROUNDING:
        raise CertificateError(f"a feasible value {value!r} lies below the dual bound {bound!r}")
    status, message = before.status, before.message
    if abs(gap) <= tolerance:
        status = "optimal"
    elif gap < 0.0:
        message = (
            f"{worst} is violated by {excess:.3g}, from which the objective benefits. {message}"
        )
    return replace(
        before,
        status=status,
        bound=bound,
        gap=reported_gap(gap),
        certificate=dict(before.certificate) | scale,
        message=message.strip(),
    )


def reported_gap(gap: float) -> float | None:
    """Return a gap as results hold it, at least 0; None where infinite or below a bound."""
    return max(gap, 0.0) if -100 * FEASIBLE <= gap < math.inf else None


def _searched(
    problem: Problem, outcome: Outcome, before: Verdict, tolerance: float, worst: str
) -> Verdict:
    """Judge a point of spatial branch and bound: its records are gone through anew."""
    from gearopt.optimise.spatial import certificate as records  # of this method alone

    assert outcome.x is not None
    bound = records.proven(problem, outcome.records)
    if not any(v.discrete for v, _ in problem.columns):
        before = _local(problem, outcome, before, tolerance, worst)
    if not math.isfinite(bound) or (before.bound is not None and before.bound >= bound):
        return before
    proof = {"method": "spatial", "boxes": records.boxes(outcome.records), "sentence": SEARCHED}
    return bounded(problem, outcome.x, replace(before, proof=proof), bound, tolerance, worst)


def _local(
    problem: Problem, outcome: Outcome, before: Verdict, tolerance: float, worst: str
) -> Verdict:
    """Judge a point with multipliers: KKT residuals, and a dual bound where the form is convex.

    before: the verdict without them, which stays where a search of a form that has no bound ended
    with its seconds: its end is no optimum, and residuals of large texts take as long as a search.
    """
    assert outcome.x is not None
    try:
        if (smooth := epigraph(problem)) is not None:
            lifted = replace(outcome, x=raised(problem, outcome.x), lam_g=None, lam_h=None)
            return _local(smooth, lifted, before, tolerance, worst)
        shape = _shape(problem)
    except SolveError as untraced:  # without derivatives no more than a feasible point is certain
        said = str(untraced) in before.message
        why = "No bound, no optimality conditions" + ("" if said else f": {untraced}")
        message = ". ".join(filter(None, [before.message.rstrip("."), why]))
        return replace(before, message=message)
    late = not outcome.finished and not shape.convex and passed()
    points = [] if late else _points(problem, shape, outcome)
    each = [(residuals(point), point) for point in points]
    if each:
        of_kkt, best = min(each, key=lambda j: np.nan_to_num(np.max([*j[0].values()]), nan=np.inf))
        residual = dict(before.certificate) | of_kkt
        before = replace(before, certificate=residual, multipliers=_shadow_prices(best))
    lower, upper, guess = problem.bounds()
    if loose := runaway(problem, outcome.x, lower, upper, guess):
        return replace(before, status="failed", message=loose)
    if not each:
        return before
    if outcome.finished and all(v <= STATIONARY for v in of_kkt.values()):
        doubt = no_minimum(best)
        message = f"{doubt.words}. {before.message}".strip() if doubt.words else before.message
        status = "feasible" if doubt.words else "stationary"
        before = replace(before, status=status, message=message, lower=doubt.lower)
    both = [*points, *map(risen, points)] if np.isinf(points[0].high).any() else points
    bounds = [dual_bound(point) for point in both] if shape.convex else []
    known = [pair for pair in bounds if math.isfinite(pair[0])]
    if not known:
        return before
    least = max(known)[0]
    arithmetic = "double, with a rounding allowance"
    sentence = CONVEX_IN_LOGARITHMS if shape.hessian is None else CONVEX_QUADRATIC
    proof = {"method": "dual", "arithmetic": arithmetic, "sentence": sentence}
    value = shape.objective(least)
    judged = bounded(problem, outcome.x, replace(before, proof=proof), value, tolerance, worst)
    return _doubted(problem, outcome.x, judged)


def _shadow_prices(point: Point) -> dict[str, float]:
    """Return d objective / d right-hand side of every limit and equality, by its name.

    The rows of a form are those of the problem, or their logarithms, which at the right-hand side 1
    change alike.
    """
    shape, rows = point.shape, point.problem.rows
    unit = shape.objective(point.f) if shape.log_objective else 1.0
    binding = np.where(point.g >= -ACTIVE_WITHIN, point.lam_g, 0.0)
    return prices(rows, -unit * binding, -unit * point.lam_h)


def prices(rows: Rows, of_g: Array, of_h: Array) -> dict[str, float]:
    """Return numbers of inequalities (ng,) and equalities (nh,) by name, but for `defines`."""
    limits = zip(rows.inequalities, of_g, strict=True)
    named = [(row.name, v) for row, v in limits if row.kind == "limits"]
    return {n: float(v) + 0.0 for n, v in (*named, *zip(rows.equalities, of_h, strict=True))}


def _doubted(problem: Problem, x: Array, before: Verdict) -> Verdict:
    """Call no point of a convex form a minimum if its bound is far below it.

    The way is that of the objective from the guess: what is less of it may be rounding alone.
    """
    value, bound = before.objective, before.bound
    if before.status != "stationary" or value is None or bound is None:
        return before
    if value - bound <= max(LOOSE * abs(value), STATIONARY * way(problem, x)):
        return before
    words = f"not proven to be a minimum: the bound is lower by {value - bound:.3g}"
    return replace(before, status="feasible", message=f"{words}. {before.message}".strip())


def _points(problem: Problem, shape: Form, outcome: Outcome) -> list[Point]:
    """Return the point with our multipliers, and with those of its method if it has any."""
    assert outcome.x is not None
    low, high, y = (shape.to_y(a) for a in (*problem.bounds()[:2], outcome.x))
    candidates = [multipliers(shape, y, problem.parameter_values(), low, high)]
    if outcome.lam_g is not None and outcome.lam_h is not None:
        candidates.append((np.maximum(outcome.lam_g, 0.0), outcome.lam_h))
    return [evaluated(problem, shape, y, low, high, *lam) for lam in candidates if lam is not None]


def _infeasible(problem: Problem, outcome: Outcome) -> Verdict:
    """Accept an infeasibility claim only with an exhausted search or a Farkas certificate."""
    if outcome.proof:
        return Verdict("infeasible", proof=outcome.proof, message=outcome.message)
    if outcome.records:
        from gearopt.optimise.spatial import certificate as records

        if records.proven(problem, outcome.records) < math.inf:
            return Verdict("failed", message="no feasible point found; impossibility is not proven")
        words = "no point of the box meets all limits"
        proof = {"method": "spatial", "boxes": records.boxes(outcome.records), "sentence": EMPTY}
        return Verdict("infeasible", proof=proof, message=words)
    shape = _shape(problem)
    low, high = (shape.to_y(a) for a in problem.bounds()[:2])
    if outcome.x is None or outcome.lam_g is None or not shape.convex:
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
    scale = max(r.certificate.get("scale") or 0.0 for r in (result, relaxation))
    gap = gap_of(value, bound, scale)
    if gap < -FEASIBLE:
        raise CertificateError(f"the value {value!r} lies below the relaxation's bound {bound!r}")
    if result.bound is not None and bound <= result.bound:
        return result
    status = "optimal" if gap <= tolerance else result.status
    certificate = (
        result.certificate
        if is_known(value, scale) or 0.0 < bound <= value
        else result.certificate | {"scale": scale}
    )
    return replace(
        result,
        bound=bound,
        gap=reported_gap(gap),
        status=status,
        certificate=certificate,
        proof=dict(relaxation.proof),
    )


def least(results: Sequence[Result], tolerance: float) -> Result:
    """Return the best of the answers to the parts of a problem, held against the bounds of all.

    results: of parts whose designs together are all designs. The bound is the least of theirs; a
    part that is proven impossible has none to be below, one without a bound leaves the whole
    without. tolerance: the largest relative gap called optimal.
    """
    possible = [r for r in results if r.status != "infeasible"]
    if not possible:
        return results[0]
    known = [r for r in possible if r.value is not None]
    early = [r for r in possible if r.status == "limit"]
    best = min(known, key=lambda r: r.value or 0.0, default=(early or possible)[0])
    lowest = min(possible, key=lambda r: -math.inf if r.bound is None else r.bound)
    if best.value is None or lowest.bound is None:
        status = best.status if best.status != "optimal" else "feasible"
        return replace(best, status=status, bound=lowest.bound, gap=None, proof=dict(lowest.proof))
    scale = max(r.certificate.get("scale") or 0.0 for r in results)
    gap = gap_of(best.value, lowest.bound, scale)
    unsure = "limit" if early else "feasible"
    status = unsure if best.status == "optimal" else best.status
    return replace(
        best,
        status="optimal" if gap <= tolerance else status,
        bound=lowest.bound,
        gap=reported_gap(gap),
        proof=dict(lowest.proof),
    )
