"""Maxima in a log-convex text as epigraphs: a variable t for each, with a/t <= 1 and b/t <= 1.

At the kink of a maximum no dual bound of the text is tight. The epigraph form is smooth there, and
its bounds are bounds of the text.
"""

from typing import Any

import numpy as np

from gearopt.optimise.problem import Problem
from gearopt.optimise.tape import fold, kinds, walk
from gearopt.optimise.terms import Array, Terms, Var

HEIGHTS = "heights_of_maxima"
OUTWARD = np.array([1.0 - 1e-9, 1.0 + 1e-9])  # of the ends of a height: more than rounding


def epigraph(problem: Problem) -> Problem | None:
    """Return the epigraph form of a log-convex text, its variables before the heights.

    None where the text takes no maxima, has repeats, is not log-convex in log variables, or where
    a maximum has no finite ends above 0.
    """
    if problem.repeats or not all(v.log and not v.discrete for v in problem.variables):
        return None
    if "maxima" not in problem.memo:
        problem.memo["maxima"] = _takes_maxima(problem)
    if not problem.memo["maxima"] or not kinds(problem).log_convex:
        return None
    key = "epigraph", *(a.tobytes() for a in (*problem.bounds(), problem.parameter_values()))
    if key not in problem.memo:
        problem.memo[key] = _lifted(problem)
    lifted: Problem | None = problem.memo[key]
    return lifted


def raised(problem: Problem, x: Array) -> Array:
    """Return the point of the epigraph form: x, then the value of every max() of the text at x."""
    heights, _ = _run(problem, list(x), problem.parameter_values(), None)
    return np.concatenate([x, heights])


def _takes_maxima(problem: Problem) -> bool:
    """Return whether the tape of a text takes the larger of two numbers."""
    import casadi as ca

    f = problem.traced().blocks[0].function
    return any(f.instruction_id(k) == ca.OP_FMAX for k in range(f.n_instructions()))


def _lifted(problem: Problem) -> Problem | None:
    """Return the epigraph form of a log-convex text with maxima, whose names are the text's."""
    lower, upper, guess = problem.bounds()
    ends, _ = _run(problem, list(np.column_stack([lower, upper])), problem.parameter_values(), None)
    low, high = (np.array(ends) * OUTWARD).T
    if not (np.isfinite(high) & (low > 0.0)).all():
        return None
    rows, count = problem.rows, len(low)

    def evaluate(x: Any, p: Any) -> Terms:
        columns = [c for v in problem.variables for c in _scalars(getattr(x, v.name), v.size)]
        given = [c for q in problem.parameters for c in _scalars(getattr(p, q.name), q.size)]
        over = list(_scalars(getattr(x, HEIGHTS), count))
        below, (f, g, h) = _run(problem, columns, given, over)
        limits = {row.name: v for row, v in zip(rows.inequalities, g, strict=True)}
        equal = dict(zip(rows.equalities, h, strict=True))
        terms = {rows.objectives[0]: f[0]}
        return Terms(terms, limits, {"over": tuple(below)}, equal)

    start = raised(problem, guess)
    lowest, highest, first = (tuple(a.tolist()) for a in (low, high, start[len(guess) :]))
    over = Var(HEIGHTS, "", lowest, highest, first, size=count, log=True)
    lifted = Problem(problem.name, (*problem.variables, over), problem.parameters, evaluate)
    return lifted.starting(start)


def _scalars(block: Any, size: int) -> Any:
    """Return the components of a variable or parameter."""
    return (block,) if size == 1 else block


def _run(
    problem: Problem, columns: list[Any], parameters: Any, heights: list[Any] | None
) -> tuple[list[Any], list[list[Any]]]:
    """Return all maxima of a text and its terms f, g, h; with heights what is at most 1 instead.

    columns: scalars, or the two ends of each variable (2,), between which the terms then lie.
    """
    import casadi as ca

    maxima: list[Any] = []

    def apply(operation: int, terms: list[Any]) -> Any:
        if operation == ca.OP_FMAX and heights is not None:
            height = heights[len(maxima) // 2]
            maxima.extend(term / height for term in terms)
            return height
        falls = operation in (ca.OP_DIV, ca.OP_INV)
        if operation in (ca.OP_POW, ca.OP_CONSTPOW):
            falls = not isinstance(terms[0], float) and bool(np.all(np.asarray(terms[1]) < 0.0))
            terms = [terms[0][::-1], terms[1]] if falls and np.ndim(terms[0]) == 1 else terms
        elif falls and np.ndim(terms[-1]) == 1:
            terms = [*terms[:-1], terms[-1][::-1]]
        value = fold(operation, terms)
        if operation == ca.OP_FMAX:
            maxima.append(value)
        return value

    function = problem.traced().blocks[0].function
    return maxima, walk(function, [columns, [], list(parameters), []], float, apply)
