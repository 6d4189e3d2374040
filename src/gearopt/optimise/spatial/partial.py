"""Operations that have no finite number everywhere in a box, and what a text makes of that.

A point counts where every row of the text is finite, even if an operation inside is not: exp(-1/x)
is 0 at x = 0. Its columns are infinite then, of a sign that rounding and order decide, so that both
are kept (Lemma 74).
"""

from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.optimise.evaluation import functions_of
from gearopt.optimise.problem import Problem
from gearopt.optimise.spatial.columns import (
    ABS,
    ASIN,
    ATAN,
    EXP,
    LINEAR,
    LOG,
    MAXIMUM,
    MINIMUM,
    POWER,
    QUOTIENT,
    ROOT,
    ROOT_SWEEPS,
    TANH,
    Builder,
    Columns,
    refuse,
)

OPEN, UNSIGNED = 1, 2  # quotients at 0: see `interval_kernel.may_be_infinite`
_ABSORBING = (QUOTIENT, POWER, ROOT, EXP, TANH, ATAN, MAXIMUM, MINIMUM)  # infinite to finite


def partial_relations(form: Columns) -> Any:
    """Relations (R,) whose value may be infinite or no number within the box and the limits."""
    kinds, p = form.relations[:, 0], form.exponent
    partial = np.isin(kinds, (QUOTIENT, LOG, ROOT, ASIN)) | (kinds == POWER) & (p < 0.0)
    while partial.any():
        relations = form.relations.copy()
        relations[partial, 0] = LINEAR  # without what they say
        low, high = form.lower.copy(), form.upper.copy()
        if not replace(form, relations=relations).propagated(low, high, ROOT_SWEEPS):
            return np.zeros(len(kinds), bool)
        j = np.where(kinds == QUOTIENT, form.relations[:, 3], form.relations[:, 2])
        total = (low[j] > 0.0) | (high[j] < 0.0) & ~np.isin(kinds, (LOG, ROOT))
        total |= (kinds == ROOT) & (p > 0.0) & (low[j] >= 0.0)
        total = np.where(kinds == ASIN, (low[j] >= -1.0) & (high[j] <= 1.0), total)
        if not (partial & total).any():
            break
        partial &= ~total
    return partial


def _reached(builder: Builder, begin: Any) -> set[int]:
    """Columns that depend on the values of some relations (R,)."""
    reached = set[int]()
    for r, (kind, w, u, v) in enumerate(builder.relations):
        arguments = builder.sums[r].terms if kind == LINEAR else (u, v)
        if w >= 0 and (begin[r] or not reached.isdisjoint(arguments)):
            reached.add(w)
    return reached


def open_at_zero(problem: Problem, builder: Builder, partial: Any) -> None:
    """Keep both infinities of quotients by 0 where the text has a number of what follows.

    SolveError where it may have one though an operation has none: a power of variable exponent is 1
    at 0, and np.fmax the other number.
    """
    spoilt = _reached(builder, partial)
    extremes, odd = False, list[int]()
    for r, (kind, _, u, v) in enumerate(builder.relations):
        extremes |= kind in (MAXIMUM, MINIMUM) and not spoilt.isdisjoint((u, v))
        p = builder.exponents[r]
        if kind == QUOTIENT or kind == POWER and p < 0.0 and p % 2.0 == 1.0:
            odd.append(r)
    known = functions_of(problem) if extremes else set[str]()
    if known is None or known & {"fmax", "fmin"}:
        refuse(problem.name, "np.fmax or np.fmin of what may be no number; write np.maximum")
    if not spoilt.isdisjoint(builder.raised):
        refuse(problem.name, "a variable power of what may be no number")
    if not spoilt.isdisjoint(builder.rooted):
        refuse(problem.name, "a root of a quotient by what may be infinite")
    for r in odd:
        kind, w, u, v = builder.relations[r]
        below = v if kind == QUOTIENT else u
        absorbs = below in spoilt
        begin = np.arange(len(partial)) == r
        if not absorbs and not (partial[r] and _absorbed(builder, _reached(builder, begin))):
            continue
        maker, _, p = builder.maker(below)
        unsigned = maker in (-1, ABS) or maker == POWER and p > 0.0 and p % 2.0 == 0.0
        flag = UNSIGNED if unsigned and not absorbs else OPEN
        if kind == QUOTIENT:
            builder.exponents[r] = flag
        else:
            builder.relations[r] = kind, w, u, -1 - flag


def _absorbed(builder: Builder, reached: set[int]) -> bool:
    """Whether an operation may make a number of columns that are infinite."""
    for r, (kind, _, u, v) in enumerate(builder.relations):
        if kind in (POWER, ROOT) and builder.exponents[r] > 0.0:
            continue
        taken = {v} if kind == QUOTIENT else {u, v}
        if kind in _ABSORBING and not reached.isdisjoint(taken):
            return True
    return False
