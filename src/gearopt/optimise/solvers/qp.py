"""Small dense quadratic programs by CasADi's active-set solvers, DAQP and then qrqp.

The text is proven quadratic and convex first (`quadratic`). Built once a problem, re-solved at new
parameter values. What DAQP leaves open is given to qrqp, then to DAQP without equalities that
repeat others (both fail on those). Where no point meets every row, the least-squares violation is
found, whose residuals are the multipliers of a conflict.
"""

from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.form import Form
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.quadratic import Curvature, curvature, hessian_of, misfit, natural
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.scale import sizes
from gearopt.optimise.terms import Array

VIOLATED = 1e-9  # a row, whose unit is 1, is not met beyond it
DEPENDENT = 1e-10  # of a row of length 1: what others leave of it
TINY = 1e-300  # a row of zeros has no direction
PROXIMAL = {"eps_prox": 1e-3, "eta_prox": 1e-14}  # DAQP's way with a singular Hessian
TOLERANCES = {"primal_tol": 1e-11, "dual_tol": 1e-12}  # DAQP's own are 1e-6 and 1e-12
SOLVERS: dict[str, dict[str, Any]] = {
    "daqp": {"daqp": TOLERANCES},
    "qrqp": {"print_iter": False, "print_header": False, "print_info": False},
}
EARLY = "stopped before the end"

RANDOM = False
COUNTS = "quadratic program solved"
SETTINGS = {"solvers": ", ".join(SOLVERS), **TOLERANCES}


@dataclass(frozen=True)
class _Program:
    """1/2 x'Qx + c'x, minimum <= A x <= maximum, low <= x <= high; `count` first rows are limits.

    own: scale of each variable.
    """

    hessian: Array
    linear: Array
    rows: Array
    minimum: Array
    maximum: Array
    low: Array
    high: Array
    count: int
    own: Array

    def violation(self, x: Array) -> float:
        """Return largest violation of a row."""
        value = self.rows @ x
        return float(np.maximum(self.minimum - value, value - self.maximum).max(initial=0.0))


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve a convex quadratic program; SolveError names the term that makes the problem none.

    The solvers are deterministic, and cannot be interrupted: `watch` and the budget are asked
    before each, and `watch` with the answer.
    """
    clock = Clock(budget, watch)
    shape, curved = _checked(problem)
    program = _program(problem, shape)
    words: list[str] = []
    for name in (*SOLVERS, "daqp"):
        if not clock.tell():
            return Outcome(None, False, evaluations=len(words), message=EARLY)
        given = np.arange(len(program.maximum))
        if len(words) == len(SOLVERS) and len(given := _independent(program)) == len(
            program.maximum
        ):
            break
        x, lam, status = _solved(problem, name, program, curved, given)
        words.append(f"{name}: {status or 'a row is not met'}")
        clock.evaluations = len(words)
        if status == "" and program.violation(x) <= VIOLATED:
            clock.best = float(problem.batch(x[None]).F[0, 0])
            clock.tell()
            lam_g, lam_h = lam[: program.count], lam[program.count :]
            return Outcome(x, not clock.refused, lam_g, lam_h, evaluations=len(words))
    if not clock.tell():
        return Outcome(None, False, evaluations=len(words), message=EARLY)
    return _nearest(problem, program, len(words), "; ".join(words))


def _checked(problem: Problem) -> tuple[Form, Curvature]:
    """Return the natural form and its curvature, or raise SolveError."""
    for variable, name in problem.columns:
        if variable.discrete:
            raise SolveError(f"qp takes continuous variables only; {name} is discrete")
    one_objective(problem.name, problem.rows.objectives)
    shape = natural(problem)
    if shape is None:
        raise SolveError(f"{problem.name} is not a quadratic program: " + misfit(problem))
    hessian = hessian_of(problem, shape)
    curved = curvature(hessian)
    if not shape.convex:
        minimum = np.linalg.eigvalsh(hessian)[0] if np.isfinite(hessian).all() else np.nan
        raise SolveError(
            f"{problem.name} is not a convex quadratic program: {problem.rows.objectives[0]} has "
            f"curvature {minimum:.3g}"
        )
    return shape, curved


def _program(problem: Problem, shape: Form) -> _Program:
    """Return the quadratic program at the present parameters, from its values at x = 0."""
    p, origin = problem.parameter_values(), np.zeros(len(problem.columns))
    no_g, no_h = (np.zeros(shape.derivatives.numel_out(k)) for k in (1, 2))
    _, g, h, linear, _ = (np.array(v).ravel() for v in shape.derivatives(origin, p, no_g, no_h))
    rows = np.vstack([np.array(j).reshape(-1, len(origin)) for j in shape.jacobians(origin, p)])
    hessian = hessian_of(problem, shape)
    names = [*(r.name for r in problem.rows.inequalities), *problem.rows.equalities]
    known = np.isfinite(rows).all(axis=1) & np.isfinite(np.concatenate([g, h]))
    if not (np.isfinite(hessian).all() and np.isfinite(linear).all()):
        names, known = [problem.rows.objectives[0]], np.zeros(1, bool)
    if not known.all():
        raise SolveError(
            f"{problem.name} is not a quadratic program: {names[int(known.argmin())]} has an "
            "infinite coefficient, or one that is not a number"
        )
    low, high, _ = problem.bounds()
    return _Program(
        hessian,
        linear,
        rows,
        np.concatenate([np.full(len(g), -np.inf), -h]),
        np.concatenate([-g, -h]),
        low,
        high,
        len(g),
        sizes(problem, problem.bounds()[2]),
    )


def _solved(
    problem: Problem, name: str, program: _Program, curved: Curvature, given: Any
) -> tuple[Array, Array, str]:
    """Return point, multipliers of the rows, and the complaint of the solver ("" for none).

    given: which rows the solver is given. The solvers' tolerances are absolute: the objective is
    divided by its largest term over the variables' own scale, variables are scaled to a Hessian of
    unit diagonal, or where they have none in it by their own scale.
    """
    import casadi as ca

    definite = curved.floor > 0.0 and bool((curved.diagonal > 0.0).all())
    size, rows = len(program.linear), len(given)
    key = ("qp", name, definite, size, rows)
    if key not in problem.memo:
        options = SOLVERS[name] | {"error_on_fail": False}
        if name == "daqp" and not definite:
            options = options | {"daqp": TOLERANCES | PROXIMAL}
        shapes = {"h": ca.Sparsity.dense(size, size), "a": ca.Sparsity.dense(rows, size)}
        problem.memo[key] = ca.conic("qp", name, shapes, options)
    solver = problem.memo[key]
    unit_of_columns, bent = program.own, curved.diagonal > 0.0
    cost = (
        max(
            np.abs(program.linear * unit_of_columns).max(),
            (curved.diagonal * unit_of_columns**2).max(),
        )
        or 1.0
    )
    unit = np.where(bent, np.sqrt(cost / np.where(bent, curved.diagonal, 1.0)), unit_of_columns)
    solution = solver(
        h=program.hessian / cost * np.outer(unit, unit),
        g=program.linear / cost * unit,
        a=program.rows[given] * unit,
        lba=program.minimum[given],
        uba=program.maximum[given],
        lbx=program.low / unit,
        ubx=program.high / unit,
    )
    stats = solver.stats()
    status = "" if stats["success"] else str(stats["return_status"])
    lam = np.zeros(len(program.maximum))
    with np.errstate(all="ignore"):  # a solver that gave up leaves any numbers
        x = np.clip(np.array(solution["x"]).ravel() * unit, program.low, program.high)
        lam[given] = np.array(solution["lam_a"]).ravel() * cost
    return x, lam, status


def _independent(program: _Program) -> Any:
    """Return all limits, and the equalities that are no combination of those before them."""
    basis = np.empty((0, len(program.linear)))
    kept = list(range(program.count))
    for k in range(program.count, len(program.maximum)):
        row = program.rows[k] / max(float(np.linalg.norm(program.rows[k])), TINY)
        rest = row - basis.T @ (basis @ row)
        if (length := float(np.linalg.norm(rest))) > DEPENDENT:
            basis, kept = np.vstack([basis, rest / length]), [*kept, k]
    return np.array(kept, int)


def _nearest(problem: Problem, program: _Program, runs: int, words: str) -> Outcome:
    """Return the point of least squared violation, whose residuals s prove a conflict.

    minimise 1/2 s's  subject to  minimum <= A x - s <= maximum,  low <= x <= high
    """
    size, rows = len(program.linear), len(program.maximum)
    free = np.full(rows, np.inf)
    wide = _Program(
        np.diag(np.repeat([0.0, 1.0], [size, rows])),
        np.zeros(size + rows),
        np.hstack([program.rows, -np.eye(rows)]),
        program.minimum,
        program.maximum,
        np.concatenate([program.low, -free]),
        np.concatenate([program.high, free]),
        program.count,
        np.concatenate([program.own, np.ones(rows)]),
    )
    z, _, status = _solved(problem, "daqp", wide, curvature(wide.hessian), np.arange(rows))
    x, s = z[:size], z[size:]
    worst = program.violation(x)
    if status or worst <= VIOLATED:
        return Outcome(None, evaluations=runs, message=f"not solved; {words}")
    return Outcome(
        x,
        lam_g=s[: program.count],
        lam_h=s[program.count :],
        infeasible=True,
        evaluations=runs + 1,
        message=f"the smallest relative violation of the limits reached is {100.0 * worst:.3g} %",
    )
