"""Geometric programs by cvxpy and Clarabel, on the same text: the independent oracle of sizing.

The text is run once on cvxpy variables and canonicalised once (DPP); new parameter values are
re-solved without building anything again. cvxpy's own rules (DGP) check the form, its own reduction
takes logarithms, its own solver finds the point: nothing is shared with `form` and `ipopt`.
"""

import time
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome, Watch
from gearopt.optimise.terms import Array, flatten, namespace

# Clarabel's defaults give 1e-7 on our drives. Where it cannot reach the first it is asked for the
# next; what it then reached is for the certificate to say.
TOLERANCES = (1e-12, 1e-10)

RANDOM = False
COUNTS = "Clarabel iteration"
SETTINGS = {"solver": "Clarabel", "tolerances": TOLERANCES}


@dataclass(frozen=True)
class _Model:
    """A problem as cvxpy holds it: what to set, what to read."""

    problem: Any
    variables: tuple[Any, ...]
    parameters: tuple[Any, ...]
    inequalities: tuple[Any, ...]
    equalities: tuple[Any, ...]


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve a geometric program to its global optimum; SolveError where the text is none."""
    import cvxpy as cp

    clock = time.perf_counter()
    if watch is not None and watch(Event(0.0, 0)) is False:
        return Outcome(None, finished=False, message="stopped before it began")
    model = _model(problem)
    _set(problem, model)
    limit = {} if budget.seconds is None else {"time_limit": max(budget.seconds, 1e-3)}
    steps, most = 0, budget.evaluations
    for tolerance in TOLERANCES:
        if most is not None:
            limit["max_iter"] = max(most - steps, 1)
        accuracy = {f"tol_{name}": tolerance for name in ("gap_abs", "gap_rel", "feas")}
        try:
            with warnings.catch_warnings():  # "may be inaccurate": the certificate says how much
                warnings.simplefilter("ignore", UserWarning)
                model.problem.solve(gp=True, solver=cp.CLARABEL, **accuracy, **limit)
        except cp.error.SolverError as broken:
            raise SolveError(f"gp on {problem.name}: {broken}") from broken
        steps += int(model.problem.solver_stats.num_iters or 0)
        full = most is not None and steps >= most
        if full or model.problem.status != cp.OPTIMAL_INACCURATE:
            break
    status = model.problem.status
    late = budget.seconds is not None and time.perf_counter() - clock > budget.seconds
    late = late or full
    x = _point(problem, model)
    if x is None:
        return Outcome(None, finished=not late, evaluations=steps, message=f"Clarabel: {status}")
    lower, upper, _ = problem.bounds()
    return Outcome(
        np.clip(x, lower, upper),
        finished=not late,
        lam_g=_duals(model.inequalities),
        lam_h=_duals(model.equalities),
        evaluations=steps,
        message="" if status == cp.OPTIMAL else f"Clarabel: {status}",
    )


def _model(problem: Problem) -> _Model:
    """Run the text on cvxpy scalars, once a problem."""
    key = ("gp", *(end.tobytes() for end in problem.bounds()[:2]))
    if key not in problem.memo:
        problem.memo[key] = _build(problem)
    found: _Model = problem.memo[key]
    return found


def _build(problem: Problem) -> _Model:
    import cvxpy as cp

    if problem.repeats:
        raise SolveError(f"gp takes no repeats; {problem.name} has some")
    lower, upper, _ = problem.bounds()
    variables: list[Any] = []
    ends: list[Any] = []
    for (variable, name), low, high in zip(problem.columns, lower, upper, strict=True):
        if variable.discrete or not variable.log:
            kind = "discrete" if variable.discrete else "not declared log"
            raise SolveError(f"gp takes continuous log variables only; {name} is {kind}")
        fixed = low == high
        variables.append(float(low) if fixed else cp.Variable(pos=True, name=name))
        if not fixed:
            ends += [variables[-1] >= low] if low > 0 else []
            ends += [variables[-1] <= high] if np.isfinite(high) else []
    parameters = [cp.Parameter(pos=True) for q in problem.parameters for _ in range(q.size)]
    try:
        terms = problem.evaluate(
            namespace(problem.variables, variables), namespace(problem.parameters, parameters)
        )
    except RuntimeError as numpy_function:  # cvxpy refuses np.log and its like
        raise SolveError(
            f"{problem.name} is no geometric program: its text calls a numpy function"
        ) from numpy_function
    if len(terms.minimise) != 1:
        raise SolveError(f"gp takes one objective; {problem.name} has {len(terms.minimise)}")
    (objective,) = terms.minimise.values()
    inequal, equal = flatten(terms)
    inequalities = tuple(row <= 1 for row in inequal)
    equalities = tuple(row == 1 for row in equal)
    model = cp.Problem(cp.Minimize(objective), [*inequalities, *equalities, *ends])
    if not model.is_dgp(dpp=True):
        raise SolveError(f"{problem.name} is no geometric program by cvxpy's rules")
    return _Model(model, tuple(variables), tuple(parameters), inequalities, equalities)


def _set(problem: Problem, model: _Model) -> None:
    used = {id(p) for p in model.problem.parameters()}
    values = problem.parameter_values()
    for parameter, value in zip(model.parameters, values, strict=True):
        if id(parameter) in used:
            parameter.value = value


def _point(problem: Problem, model: _Model) -> Array | None:
    values = [v if isinstance(v, float) else v.value for v in model.variables]
    if any(v is None for v in values):
        return None
    return np.array(values, float)


def _duals(rows: tuple[Any, ...]) -> Array:
    """Multipliers of the logarithms of the rows, as `form` states them."""
    return np.array([np.nan_to_num(float(row.dual_value)) for row in rows], float)
