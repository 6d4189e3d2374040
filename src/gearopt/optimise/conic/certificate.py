"""Judges an outcome of a conic problem: the user's own rows, and bounds from canonical data.

A claim is a list of leaves that together cover the box: each with multipliers that bound the cost
there, or prove that nothing is there. A problem without discrete variables has one leaf.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.optimise.certificate import FARKAS, Verdict, bounded
from gearopt.optimise.certificate import prices as by_name
from gearopt.optimise.conic.canonical import Canonical, canonical
from gearopt.optimise.conic.cone_bound import (
    Leaf,
    cutoff,
    emptiness,
    lagrangian,
    narrowed,
    propagate,
)
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.result import FEASIBLE, Outcome
from gearopt.optimise.scale import broken, runaway, violation
from gearopt.optimise.stationarity import ACTIVE_WITHIN
from gearopt.optimise.terms import Array

EXCLUDED = "the bounds of the variables exclude every point"
MAX_PROOFS = 2000  # proofs tried to name the fewest rows of a conflict
CONVEX_CONIC = "Proof: a convex conic problem; the bound is a dual one, computed from its data"
ARITHMETIC = "double, with a rounding allowance"


@np.errstate(all="ignore")
def certify(problem: Conic, outcome: Outcome, gap: float) -> Verdict:
    """Return status, bound and residuals of an outcome; `gap`: the largest called optimal.

    CertificateError where a bound contradicts a feasible point.
    """
    if outcome.infeasible:
        return _infeasible(problem, outcome)
    unsolved = "failed" if outcome.finished else "limit"
    if outcome.x is None:
        return Verdict(unsolved, message=outcome.message or "no point found")
    lower, upper, guess = problem.bounds()
    batch = problem.batch(outcome.x[None])
    excess, worst = violation(problem, outcome.x, batch)
    certificate: dict[str, float | None] = {"feasibility": excess}
    value = float(batch.F[0, 0])
    if not (excess <= FEASIBLE and math.isfinite(value)):
        message = f"{broken(problem, outcome.x, excess, worst)}. {outcome.message}".strip()
        return Verdict(unsolved, certificate=certificate, message=message)
    if loose := runaway(problem, outcome.x, lower, upper, guess):
        return Verdict("failed", value, certificate=certificate, message=loose)
    status = "feasible" if outcome.finished else "limit"
    bound, charge, slack, loose = _bound(problem, outcome, value)
    if not math.isfinite(bound):
        message = f"{loose} {outcome.message}".strip()
        return Verdict(status, value, certificate=certificate, message=message)
    nodes = len(outcome.leaves)
    parts = (
        f", the minimum of those of {nodes:,} parts of the ranges of variables" if nodes > 1 else ""
    )
    sentence = f"{CONVEX_CONIC}{parts}."
    proof = {"method": "dual", "arithmetic": ARITHMETIC, "nodes": nodes, "sentence": sentence}
    before = Verdict(status, value, certificate=certificate, proof=proof, message=outcome.message)
    verdict = bounded(problem, outcome.x, before, bound, gap, worst)
    unit = verdict.certificate.get("scale") or abs(value) or 1.0
    residuals = {"stationarity": charge / unit, "complementarity": slack / unit}
    prices = _shadow_prices(problem, outcome.leaves, batch.G[0] >= 1.0 - ACTIVE_WITHIN)
    stated = dict(verdict.certificate) | residuals
    return replace(verdict, certificate=stated, multipliers=prices)


def _shadow_prices(problem: Conic, leaves: tuple[Leaf, ...], binding: Any) -> dict[str, float]:
    """Return d objective / d right-hand side of every limit and equality; of several leaves none.

    With A x + s = b the cost changes by -y per b, and the right-hand side of a row is in its b.
    binding (ng,): which inequalities bind.
    """
    (leaf, *others), data, rows = leaves, canonical(problem), problem.rows
    if others or leaf.y is None:
        return {}
    stated = data.label >= 0
    count = len(rows.inequalities)
    prices = np.zeros(count + len(rows.equalities))
    prices[data.label[stated]] = -leaf.y[stated]
    return by_name(rows, np.where(binding, prices[:count], 0.0), prices[count:])


def _bound(problem: Conic, outcome: Outcome, value: float) -> tuple[float, float, float, str]:
    """Minimum cost of all leaves, its rounding loss (see `Proof`), and the unbounded variable."""
    data = canonical(problem)
    if not covers(data, outcome.leaves):
        return -math.inf, 0.0, 0.0, ""
    least, charge, slack, most = math.inf, 0.0, 0.0, cutoff(value)
    for leaf in outcome.leaves:
        box = propagate(data, leaf.lower, leaf.upper, most)
        if box is None:
            continue
        if leaf.ray and leaf.y is not None and emptiness(data, *box, leaf.x, leaf.y) > 0.0:
            continue
        unheld = [
            n
            for (_, n), k in zip(problem.columns, data.user, strict=True)
            if not np.isfinite(box[0][k]) or not np.isfinite(box[1][k])
        ]
        if unheld:
            loose = f"{unheld[0]} is unbounded: give it a bound or a limit, for a proof."
            return -math.inf, 0.0, 0.0, loose
        if leaf.y is None or leaf.ray:
            return -math.inf, 0.0, 0.0, ""
        proof = lagrangian(data, *box, leaf.x, leaf.y)
        if proof.least < least:
            least, charge, slack = proof.least, proof.charge, proof.slack
    return min(least, most), charge, slack, ""


def _infeasible(problem: Conic, outcome: Outcome) -> Verdict:
    """Accept the claim only if every leaf is empty by its intervals or by its multipliers."""
    data = canonical(problem)
    empty = covers(data, outcome.leaves) and all(_empty(data, leaf) for leaf in outcome.leaves)
    if not empty:
        return Verdict("failed", message="no feasible point found; impossibility is not proven")
    names = [r.name for r in problem.rows.inequalities] + list(problem.rows.equalities)
    numbers = {number for leaf in outcome.leaves for number in _weights(data, leaf)}
    if len(names) * len(outcome.leaves) <= MAX_PROOFS:
        numbers = set(range(len(names)))
        weights = _weights(data, outcome.leaves[0])
        for number in sorted(numbers, key=lambda k: weights.get(k, 0.0)):
            fewer = numbers - {number}
            if all(_empty(*_only(data, leaf, fewer)) for leaf in outcome.leaves):
                numbers = fewer
    conflict = [names[k] for k in sorted(numbers)]
    words = f"no design meets these together: {', '.join(conflict)}" if conflict else EXCLUDED
    proof = {"method": "dual", "conflict": conflict, "nodes": len(outcome.leaves)}
    proof |= {"sentence": f"Proof: {words}."} if conflict else {}
    return Verdict("infeasible", proof=proof, message=words)


def _empty(data: Canonical, leaf: Leaf) -> bool:
    """Return whether intervals or a leaf's multipliers prove that no point of it is feasible."""
    low, high, crossed = narrowed(data, leaf.lower, leaf.upper)
    if crossed or leaf.y is None:
        return crossed
    return any(
        emptiness(data, low, high, leaf.x, y) > FARKAS
        for y in (leaf.y, np.where(data.label >= 0, leaf.y, 0.0))  # the rest may be noise
    )


def _weights(data: Canonical, leaf: Leaf) -> dict[int, float]:
    """Return multipliers of the user's rows by number."""
    weights = dict.fromkeys((int(k) for k in data.label if k >= 0), 0.0)
    for k in np.flatnonzero(data.label >= 0):
        weights[int(data.label[k])] += 0.0 if leaf.y is None else abs(float(leaf.y[k]))
    return weights


def _only(data: Canonical, leaf: Leaf, numbers: set[int]) -> tuple[Canonical, Leaf]:
    """Return data and leaf with these of the user's rows alone, which are linear rows."""
    keep = np.isin(data.label, [-1, *numbers])
    gone = ~keep
    front = data.zero + data.nonneg
    fewer = replace(
        data,
        A=data.A[keep],
        b=data.b[keep],
        label=data.label[keep],
        zero=data.zero - int(gone[: data.zero].sum()),
        nonneg=data.nonneg - int(gone[data.zero : front].sum()),
        blocks=tuple(replace(b, start=b.start - int(gone.sum())) for b in data.blocks),
    )
    return fewer, replace(leaf, y=None if leaf.y is None else leaf.y[keep])


def covers(data: Canonical, leaves: tuple[Leaf, ...]) -> bool:
    """Return whether the leaves are a partition of the box by cuts between allowed values.

    The box is cut where no leaf straddles, again and again, until each part is one leaf's.
    """
    columns = sorted(data.allowed)
    free = np.setdiff1d(np.arange(len(data.c)), columns)
    if not leaves:
        return False
    low, high = (np.array([getattr(leaf, end) for leaf in leaves]) for end in ("lower", "upper"))
    if (low[:, free] > data.lower[free]).any() or (high[:, free] < data.upper[free]).any():
        return False
    first = _positions(data, columns, low, "left")
    last = _positions(data, columns, high, "right") - 1
    counts = np.array([len(data.allowed[k]) for k in columns], int)
    parts = [(np.arange(len(leaves)), 0 * counts, counts - 1)]
    while parts:
        here, start, end = parts.pop()
        own_first, own_last = first[here], last[here]
        if len(here) == 1:
            if (own_first > start).any() or (own_last < end).any():
                return False
            continue
        order = np.argsort(own_first, axis=0, kind="stable")
        reach = np.maximum.accumulate(np.take_along_axis(own_last, order, 0), axis=0)
        gaps = np.argwhere(reach[:-1] < np.take_along_axis(own_first, order, 0)[1:])
        if not len(gaps):
            return False
        k, column = gaps[0]
        cut = reach[k, column]
        below, above = end.copy(), start.copy()
        below[column], above[column] = cut, cut + 1
        parts.append((here[own_last[:, column] <= cut], start, below))
        parts.append((here[own_first[:, column] > cut], above, end))
    return True


def _positions(data: Canonical, columns: list[int], ends: Array, side: Any) -> Any:
    """Return positions of ends (leaves, n) among the allowed values of discrete columns."""
    places = [np.searchsorted(data.allowed[k], ends[:, k], side) for k in columns]
    return np.stack(places, axis=1) if places else np.zeros((len(ends), 0), int)
