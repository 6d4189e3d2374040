"""Geometric programs by cvxpy and Clarabel, on the same text: the independent oracle of sizing.

The text is run once on cvxpy variables and canonicalised once (DPP); new parameter values are
re-solved without building anything again. cvxpy's own rules (DGP) check the form, its own reduction
takes logarithms, its own solver finds the point: nothing is shared with `form` and `ipopt`.
"""

from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.evaluation import blaming, called, quiet
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, checked, flatten

# Clarabel's defaults give 1e-7 on our drives. Where it cannot reach the first it is asked for the
# next; what it then reached is for the certificate to say.
TOLERANCES = (1e-12, 1e-10)

RANDOM = False
COUNTS = "Clarabel iteration"
SETTINGS = {"solver": "Clarabel", "tolerances": TOLERANCES}


@dataclass(frozen=True)
class _Model:
    """A problem as cvxpy holds it: parameters to set, values to read."""

    problem: Any
    variables: tuple[Any, ...]
    parameters: tuple[Any, ...]
    inequalities: tuple[Any, ...]
    equalities: tuple[Any, ...]


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve a geometric program to its global optimum; SolveError where the text is none."""
    import cvxpy as cp

    clock = Clock(budget, watch)
    if not clock.tell():
        return Outcome(None, finished=False, message="stopped before it began")
    model = _model(problem)
    _set(problem, model)
    limit: dict[str, float] = {}
    for tolerance in TOLERANCES:
        left = clock.left
        if left.seconds is not None:
            limit["time_limit"] = max(left.seconds, 1e-3)
        if left.evaluations is not None:
            limit["max_iter"] = left.evaluations
        accuracy = {f"tol_{name}": tolerance for name in ("gap_abs", "gap_rel", "feas")}
        try:
            with quiet():  # "may be inaccurate": the certificate says how much
                model.problem.solve(gp=True, solver=cp.CLARABEL, **accuracy, **limit)
        except cp.error.SolverError as broken:
            raise SolveError(f"gp on {problem.name}: {broken}") from broken
        clock.evaluations += int(model.problem.solver_stats.num_iters or 0)
        if clock.over or model.problem.status != cp.OPTIMAL_INACCURATE:
            break
    status, late, steps = model.problem.status, clock.over, clock.evaluations
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
    model: _Model = problem.memo[key]
    return model


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
    one_objective(problem.name, problem.rows.objectives)
    with blaming(problem.evaluate, problem.name, "run on cvxpy variables"), quiet():
        terms = called(problem, None, variables, (), {}, parameters)
    terms = checked(terms, problem.name)
    (objective,) = map(cp.Constant.cast_to_const, terms.minimise.values())
    inequal, equal = ([cp.Constant.cast_to_const(v) for v in rows] for rows in flatten(terms))
    names = (*(row.name for row in problem.rows.inequalities), *problem.rows.equalities)
    labelled = zip((*problem.rows.objectives, *names), (objective, *inequal, *equal), strict=True)
    for name, term in labelled:
        if not (term.is_scalar() and term.is_dgp()):
            raise SolveError(f"{problem.name} is not a geometric program by cvxpy's rules: {name}")
    inequalities = tuple(row <= 1 for row in inequal)
    equalities = tuple(row == 1 for row in equal)
    model = cp.Problem(cp.Minimize(objective), [*inequalities, *equalities, *ends])
    if not model.is_dgp(dpp=True):
        raise SolveError(f"{problem.name} is not a geometric program by cvxpy's rules")
    return _Model(model, tuple(variables), tuple(parameters), inequalities, equalities)


def _set(problem: Problem, model: _Model) -> None:
    used = {id(p) for p in model.problem.parameters()}
    names = [q.name for q in problem.parameters for _ in range(q.size)]
    values = problem.parameter_values()
    for name, parameter, value in zip(names, model.parameters, values, strict=True):
        if id(parameter) not in used:
            continue
        if not 0.0 < value < np.inf:
            raise SolveError(f"gp takes positive parameters only; {name} is {value:g}")
        parameter.value = value


def _point(problem: Problem, model: _Model) -> Array | None:
    values = [v if isinstance(v, float) else v.value for v in model.variables]
    if any(v is None for v in values):
        return None
    return np.array(values, float)


def _duals(rows: tuple[Any, ...]) -> Array:
    """Return multipliers of the logarithms of the rows, as `form` states them."""
    values = (0.0 if row.dual_value is None else float(row.dual_value) for row in rows)
    return np.array([np.nan_to_num(value) for value in values], float)
