"""Judges the records of a search anew, from the problem's own text, without a linear solver.

Every step is taken again: columns are read anew, boxes are cut at the recorded splits, narrowed,
and bounded by the recorded duals. A record that proves less than it claims lowers the bound; a
split that leaves out a value leaves no bound at all (Lemma 78).
"""

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE
from gearopt.optimise.scale import violation
from gearopt.optimise.spatial import enumeration
from gearopt.optimise.spatial.columns import LISTED, WHOLE, Columns
from gearopt.optimise.spatial.columns_of_text import columns
from gearopt.optimise.spatial.enumeration import Enumerated
from gearopt.optimise.spatial.step import (
    ROOT_SWEEPS,
    SWEEPS,
    Record,
    Stepper,
    squeezed,
)
from gearopt.optimise.terms import Array


def proven(problem: Problem, records: Sequence[Record | Enumerated]) -> float:
    """Bound of the objective at all feasible points, inf where there are none.

    -inf where the records prove nothing.
    """
    of_tree = [r for r in records if isinstance(r, Record)]
    claims = [r for r in records if isinstance(r, Enumerated)]
    bounds = [enumeration.proven(problem, claim) for claim in claims]
    return max([*bounds, _replayed(problem, of_tree)])


def boxes(records: Sequence[Record | Enumerated]) -> int:
    """Number of boxes that records are of."""
    return sum(r.boxes if isinstance(r, Enumerated) else 1 for r in records)


def _replayed(problem: Problem, records: Sequence[Record]) -> float:
    """Bound by the records of the tree."""
    if not records or records[0].parent != -1:
        return -math.inf
    form = columns(problem)
    stepper = Stepper(form)
    cutoff = least = math.inf
    open_parts = dict[tuple[int, int], tuple[Array, Array, float]]()
    for place, record in enumerate(records):
        cutoff = min(cutoff, record.cutoff, *(s.cutoff for s in record.squeezes))
        if place == 0:
            box = _root(stepper, record)
        elif (record.parent, record.side) in open_parts:
            lower, upper, _ = open_parts.pop((record.parent, record.side))
            box = (lower, upper) if stepper.narrowed(lower, upper, record.cutoff, SWEEPS) else None
        else:
            return -math.inf
        bound = _bound(problem, stepper, record, box)
        if record.split is None or bound == math.inf or box is None:
            least = min(least, bound)
            continue
        j, below, above = record.split
        if not _whole_cut(form, j, below, above):
            return -math.inf
        for side in (0, 1):
            lower, upper = box[0].copy(), box[1].copy()
            if side == 0:
                upper[j] = min(upper[j], below)
            else:
                lower[j] = max(lower[j], above)
            open_parts[place, side] = lower, upper, bound
    return min(cutoff, least, *(bound for _, _, bound in open_parts.values()))


def _root(stepper: Stepper, record: Record) -> tuple[Array, Array] | None:
    form = stepper.columns
    lower, upper = form.lower.copy(), form.upper.copy()
    if form.empty or not stepper.narrowed(lower, upper, record.cutoff, ROOT_SWEEPS):
        return None
    for squeeze in record.squeezes:
        given = [(j, sign, y.spread(stepper.count)) for j, sign, y in squeeze.duals]
        if not squeezed(stepper, lower, upper, squeeze.at, squeeze.cutoff, partial(list, given)):
            return None
    return lower, upper


def _bound(
    problem: Problem, stepper: Stepper, record: Record, box: tuple[Array, Array] | None
) -> float:
    """Bound on a box below its cutoff, which is narrowed in place; inf where it holds no point."""
    if box is None:
        return math.inf
    lower, upper = box
    if (value := _single(problem, stepper, lower, upper)) is not None:
        return value
    if record.duals is None or record.at is None:
        return float(lower[stepper.columns.objective])
    stepper.fill(lower, upper, record.at)
    y = record.duals.spread(stepper.count)
    after = stepper.closed(lower, upper, record.cutoff, y, record.ray)
    value = None if after.empty else _single(problem, stepper, lower, upper)
    return after.bound if value is None else value


def _single(problem: Problem, stepper: Stepper, lower: Array, upper: Array) -> float | None:
    """Value of a box of one point, inf where that is not feasible; None of a wider box."""
    x, end = (bound[: stepper.columns.variables] for bound in (lower, upper))
    if not np.array_equal(x, end):
        return None
    with np.errstate(all="ignore"):
        batch = problem.batch(x[None])
        excess, _ = violation(problem, x, batch)
    value = float(batch.F[0, 0])
    return value if excess <= FEASIBLE and math.isfinite(value) else math.inf


def _whole_cut(form: Columns, j: int, below: float, above: float) -> bool:
    """Whether no allowed value of a variable lies between the parts of a split."""
    if not 0 <= j < form.variables or math.isnan(below) or math.isnan(above):
        return False
    sort, first, last, values = form.sets
    if sort[j] == WHOLE:
        return above <= math.floor(below) + 1.0
    if sort[j] == LISTED:
        of_j = values[first[j] : last[j]]
        return not ((of_j > below) & (of_j < above)).any()
    return above <= below
