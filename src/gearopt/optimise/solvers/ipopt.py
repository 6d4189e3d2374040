"""Ipopt through CasADi, on the form of a problem (logarithms of variables and proven rows).

Claims infeasibility only with the multipliers of the least-violation problem, which `certify`
turns into a proof where the form is convex.
"""

import time
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.form import Form, form
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome, Watch
from gearopt.optimise.terms import Array

ACCEPTED = 1e-9  # an iterate that violates no row by more is kept as the best so far
FEASIBLE = 1e-8  # that of a certificate
ROUNDING = 1e-12  # of two values of the objective
STUCK = 1e-6  # violation at which Ipopt's end point counts as not solved

OPTIONS = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-12,  # the dual bound is as tight as the multipliers
    "constr_viol_tol": 1e-12,
    "compl_inf_tol": 1e-12,
    "dual_inf_tol": 1e-9,
    "acceptable_tol": 1e-10,
    "acceptable_iter": 8,
    "bound_relax_factor": 0.0,  # the default buys 1e-8 of every bound
    "max_iter": 3000,
}

RANDOM = False
COUNTS = "iteration"
SETTINGS = {k: v for k, v in OPTIONS.items() if k not in ("print_level", "sb")}


@dataclass(frozen=True)
class _Point:
    """Where Ipopt stopped: y, row multipliers, and its word for why."""

    y: Array
    lam_g: Array
    lam_h: Array
    status: str


class _Run:
    """One run as its monitor sees it; it has state because casadi reports it step by step.

    rows: number of inequality and of equality rows. best: the best feasible iterate so far. raised:
    what the watcher raised, which casadi would print and swallow.
    """

    def __init__(self, rows: tuple[int, int], budget: Budget, watch: Watch | None, unit: Any):
        self.rows, self.budget, self.watch, self.unit = rows, budget, watch, unit
        self.clock, self.evaluations, self.stopped = time.perf_counter(), 0, False
        self.best: Array | None = None
        self.least = np.inf
        self.raised: BaseException | None = None

    def note(self, y: Array, value: float, rows: Array) -> bool:
        """Take an iterate; whether the run goes on."""
        self.evaluations += 1
        self.keep(y, value, rows)
        self.stopped = not self.goes_on()
        return not self.stopped

    def keep(self, y: Array, value: float, rows: Array) -> None:
        """Remember a point that is feasible and lower than those before."""
        count = self.rows[0]
        worst = max(rows[:count].max(initial=0), np.abs(rows[count:]).max(initial=0))
        if worst <= ACCEPTED and value < self.least:
            self.least, self.best = value, y

    def goes_on(self) -> bool:
        """Whether budget and watcher let the run go on."""
        seconds = time.perf_counter() - self.clock
        most_s, most_n = self.budget.seconds, self.budget.evaluations
        if most_s is not None and seconds > most_s:
            return False
        if most_n is not None and self.evaluations >= most_n:
            return False
        if self.watch is None:
            return True
        best = None if self.best is None else self.unit(self.least)
        try:
            return self.watch(Event(seconds, self.evaluations, best)) is not False
        except BaseException as raised:
            self.raised = raised
            return False


def run(
    problem: Problem,
    budget: Budget,
    seed: int,
    watch: Watch | None,
    start: Array | None = None,
) -> Outcome:
    """Solve a continuous problem from its guess (or from the natural point `start`).

    A feasible start and the feasible iterates are kept: what Ipopt ends with is returned only where
    none of them is lower. SolveError for discrete variables. Ipopt is deterministic: the seed
    changes nothing.
    """
    for variable, name in problem.columns:
        if variable.discrete:
            raise SolveError(f"ipopt takes continuous variables only; {name} is discrete")
    shape = form(problem)
    lower, upper, guess = problem.bounds()
    y0 = shape.to_y(np.clip(guess if start is None else start, lower, upper))
    low, high = shape.to_y(lower), shape.to_y(upper)
    solver, monitor = _built(problem, shape)
    following = monitor.begin(budget, watch, shape.objective)
    following.keep(y0, *_values(problem, shape, y0))
    point = _ipopt(problem, solver, y0, low, high, monitor.rows)
    if not following.stopped and _violation(problem, shape, point.y) > STUCK:
        point, least = _least_violation(problem, shape, point, low, high, following)
        if least > STUCK and not following.stopped and following.best is None:
            return Outcome(
                shape.to_x(point.y),
                lam_g=point.lam_g,
                lam_h=point.lam_h,
                infeasible=True,
                evaluations=following.evaluations,
                message=f"Ipopt: {point.status}; the least violation found is {least:.3g}",
            )
        point = _ipopt(problem, solver, point.y, low, high, monitor.rows)
    if following.raised is not None:
        raise following.raised
    lost = _lost(problem, shape, point, following)
    best = following.best if following.stopped or lost else point.y
    message = "" if point.status == "Solve_Succeeded" else f"Ipopt: {point.status}"
    return Outcome(
        None if best is None else np.clip(shape.to_x(best), lower, upper),
        finished=not following.stopped,
        lam_g=point.lam_g,
        lam_h=point.lam_h,
        evaluations=following.evaluations,
        message="Ipopt ended higher than a point it passed, which is kept" if lost else message,
    )


def _built(problem: Problem, shape: Form) -> tuple[Any, Any]:
    """The solver of a form and its monitor, built once."""
    import casadi as ca

    key = ("ipopt", id(shape))
    if key not in problem.memo:
        y, p, f, g, h = shape.expressions
        monitor = _monitor_class()(y.numel(), g.numel(), h.numel())
        options = {f"ipopt.{k}": v for k, v in OPTIONS.items()}
        options |= {
            "print_time": False,
            "iteration_callback": monitor,
            "error_on_fail": False,
            "show_eval_warnings": False,
        }
        nlp = {"x": y, "p": p, "f": f, "g": ca.vertcat(g, h)}
        problem.memo[key] = ca.nlpsol("ipopt", "ipopt", nlp, options), monitor
    found: tuple[Any, Any] = problem.memo[key]
    return found


def _ipopt(
    problem: Problem, solver: Any, y0: Array, low: Array, high: Array, rows: tuple[int, int]
) -> _Point:
    m_g, m_h = rows
    zero = np.zeros(m_h)
    found = solver(
        x0=y0,
        p=problem.parameter_values(),
        lbx=low,
        ubx=high,
        lbg=np.concatenate([np.full(m_g, -np.inf), zero]),
        ubg=np.zeros(m_g + m_h),
    )
    lam = np.array(found["lam_g"]).ravel()
    status = str(solver.stats()["return_status"])
    return _Point(np.array(found["x"]).ravel(), lam[:m_g], lam[m_g:], status)


def _values(problem: Problem, shape: Form, y: Array) -> tuple[float, Array]:
    """F, and G and H together, at a point."""
    no_g, no_h = (np.zeros(shape.derivatives.numel_out(k)) for k in (1, 2))
    parts = shape.derivatives(y, problem.parameter_values(), no_g, no_h)
    f, g, h = (np.array(part).ravel() for part in parts[:3])
    return float(f[0]), np.concatenate([g, h])


def _violation(problem: Problem, shape: Form, y: Array) -> float:
    count = shape.derivatives.numel_out(1)
    rows = _values(problem, shape, y)[1]
    worst = np.concatenate([rows[:count], np.abs(rows[count:]), [0.0]])
    return float(np.inf if np.isnan(worst).any() else worst.max())


def _lost(problem: Problem, shape: Form, point: _Point, following: _Run) -> bool:
    """Whether the end point is worse than the best one passed, by more than tolerance buys.

    A violation of ACCEPTED lowers the objective of a solved problem by at most its multipliers
    times it. An end point that is not feasible is worse than any that is.
    """
    if following.best is None or following.stopped:
        return False
    value = _values(problem, shape, point.y)[0]
    prices = np.abs(np.concatenate([point.lam_g, point.lam_h]))
    bought = ACCEPTED * float(np.nan_to_num(prices).sum()) + ROUNDING * abs(value)
    ended = _violation(problem, shape, point.y) <= FEASIBLE
    return not (ended and value <= following.least + bought)


def _least_violation(
    problem: Problem, shape: Form, point: _Point, low: Array, high: Array, outer: _Run
) -> tuple[_Point, float]:
    """Minimise the largest violation t of any row; its multipliers are the conflict.

    outer: the run, whose budget and watcher go on counting.
    """
    import casadi as ca

    key = ("ipopt least violation", id(shape))
    y, p, _, g, h = shape.expressions
    m_g, m_h = g.numel(), h.numel()
    if key not in problem.memo:
        t = type(y).sym("t")
        rows = ca.vertcat(g - t, h - t, -h - t)
        options = {f"ipopt.{k}": v for k, v in OPTIONS.items()}
        monitor = _monitor_class()(y.numel() + 1, rows.numel(), 0)
        options |= {
            "print_time": False,
            "iteration_callback": monitor,
            "error_on_fail": False,
            "show_eval_warnings": False,
        }
        nlp = {"x": ca.vertcat(y, t), "p": p, "f": t, "g": rows}
        problem.memo[key] = ca.nlpsol("least_violation", "ipopt", nlp, options), monitor
    solver, monitor = problem.memo[key]
    inner = monitor.begin(Budget(), lambda event: outer.goes_on(), float)
    start = np.where(np.isfinite(point.y), point.y, 0.0)
    found = solver(
        x0=np.append(start, 1.0),
        p=problem.parameter_values(),
        lbx=np.append(low, -1.0),
        ubx=np.append(high, np.inf),
        lbg=-np.inf,
        ubg=0.0,
    )
    z = np.array(found["x"]).ravel()
    lam = np.array(found["lam_g"]).ravel()
    outer.stopped = outer.stopped or inner.stopped
    lam_h = lam[m_g : m_g + m_h] - lam[m_g + m_h :]
    return _Point(z[:-1], lam[:m_g], lam_h, point.status), float(z[-1])


@cache
def _monitor_class() -> Any:
    """The class of casadi's iteration callback, around a `_Run` (casadi is imported late)."""
    import casadi as ca

    class Monitor(ca.Callback):  # type: ignore[misc]
        def __init__(self, n: int, m_g: int, m_h: int) -> None:
            super().__init__()
            self.sizes = {"f": 1, "x": n, "lam_x": n, "g": m_g + m_h, "lam_g": m_g + m_h}
            self.rows = (m_g, m_h)
            self.run = _Run(self.rows, Budget(), None, float)
            self.construct("monitor", {})

        def begin(self, budget: Budget, watch: Watch | None, unit: Any) -> _Run:
            self.run = _Run(self.rows, budget, watch, unit)
            return self.run

        def get_n_in(self) -> int:
            return int(ca.nlpsol_n_out())

        def get_n_out(self) -> int:
            return 1

        def get_name_in(self, i: int) -> Any:
            return ca.nlpsol_out(i)

        def get_sparsity_in(self, i: int) -> Any:
            return ca.Sparsity.dense(self.sizes.get(ca.nlpsol_out(i), 0), 1)

        def eval(self, arguments: Any) -> list[int]:
            named = {ca.nlpsol_out(i): np.array(v).ravel() for i, v in enumerate(arguments)}
            return [int(not self.run.note(named["x"], float(named["f"][0]), named["g"]))]

    return Monitor
