"""Ipopt through CasADi, on the form of a problem (logarithms of variables and proven rows).

Maxima of log-convex texts become epigraphs (`epigraphs`).
Wide logarithms are split up first (`nonlinear`); y is then followed by the u of their epigraphs.
Ipopt's tolerances are absolute, so it is given natural variables and objectives in units of their
own scale. Where that of the objective is far smaller in the end than at first, it continues from
there in the units found there.

Claims infeasibility only with the multipliers of the least-violation problem, which `certify`
turns into a proof where the form is convex.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise import scale, tape
from gearopt.optimise.clock import Clock
from gearopt.optimise.epigraphs import epigraph, raised
from gearopt.optimise.form import Form, form, values, violation
from gearopt.optimise.nonlinear import OPTIONS, Split, Unit, program, scaled, split, unit_at
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Outcome, Watch
from gearopt.optimise.terms import Array

ACCEPTED = 1e-9  # an iterate that violates no row by more is kept as the best so far
ROUNDING = 1e-12  # of two values of the objective
SMALLER = 1e-2  # of the objective's scale at first: less, and Ipopt continues from where it ended
AGAIN = 6  # times at most
STUCK = 1e-6  # violation at which Ipopt's end point counts as not solved
UNTOLD = ("Solve_Succeeded", "User_Requested_Stop")  # ends that the status says in words

FROM_GUESS = True  # it begins at the guess, or where a caller starts it
RANDOM = False
COUNTS = "iteration"
SETTINGS = {k: v for k, v in OPTIONS.items() if k not in ("print_level", "sb")}


@dataclass(frozen=True)
class _Point:
    """Where Ipopt stopped: y, row multipliers, and its reason."""

    y: Array
    lam_g: Array
    lam_h: Array
    status: str


class _Run:
    """One run as its monitor sees it; it has state because casadi reports it step by step.

    rows: number of inequality and of equality rows. values(y) -> F, and G and H together. best: the
    best feasible iterate so far. raised: what the watcher raised, which casadi would print and
    swallow.
    """

    def __init__(
        self,
        rows: tuple[int, int],
        values: Callable[[Array], tuple[float, Array]],
        clock: Clock,
        unit: Callable[[float], float],
    ):
        self.rows, self.values, self.clock, self.unit = rows, values, clock, unit
        self.best: Array | None = None
        self.least = np.inf
        self.scale: Unit | None = None
        self.raised: BaseException | None = None

    def note(self, y: Array) -> bool:
        """Take an iterate, in Ipopt's units; return whether the run continues."""
        self.clock.evaluations += 1
        self.keep(y if self.scale is None else y * self.scale.variables)
        return self.continues()

    def keep(self, y: Array) -> None:
        """Remember a point that is feasible and lower than those before."""
        count, (value, rows) = self.rows[0], self.values(y)
        worst = max(rows[:count].max(initial=0), np.abs(rows[count:]).max(initial=0))
        if worst <= ACCEPTED and value < self.least:
            self.least, self.best = value, y
            self.clock.best = self.unit(value)

    def continues(self) -> bool:
        """Return whether budget and watcher let the run continue."""
        try:
            return self.clock.tell()
        except BaseException as raised:
            self.raised, self.clock.stopped = raised, True
            return False


def run(
    problem: Problem, budget: Budget, seed: int, watch: Watch | None, start: Array | None = None
) -> Outcome:
    """Solve a continuous problem from its guess (or from the natural point `start`).

    A feasible start and the feasible iterates are kept: what Ipopt ends with is returned only where
    none of them is lower. SolveError for discrete variables. Ipopt is deterministic: the seed
    changes nothing.
    """
    clock = Clock(budget, watch)
    for variable, name in problem.columns:
        if variable.discrete:
            raise SolveError(f"ipopt takes continuous variables only; {name} is discrete")
    if (smooth := epigraph(problem)) is not None:
        lowered = _by_epigraph(problem, smooth, budget, watch, start)
        if not lowered.infeasible:
            return lowered
        clock.evaluations = lowered.evaluations
    shape = form(problem)
    lower, upper, guess = problem.bounds()
    y0 = shape.to_y(np.clip(guess if start is None else start, lower, upper))
    low, high = shape.to_y(lower), shape.to_y(upper)
    rows = (shape.derivatives.numel_out(1), shape.derivatives.numel_out(2))
    following = _Run(rows, partial(values, problem, shape), clock, shape.objective)
    following.keep(y0)
    point = _ipopt(problem, shape, y0, low, high, following)
    if not clock.stopped and violation(problem, shape, point.y) > STUCK:
        point, least = _least_violation(problem, shape, point, low, high, following)
        if least > STUCK and not clock.stopped and following.best is None:
            x = shape.to_x(point.y)
            reached, _ = scale.violation(problem, x, problem.batch(x[None]))
            return Outcome(
                x,
                lam_g=point.lam_g,
                lam_h=point.lam_h,
                infeasible=True,
                evaluations=clock.evaluations,
                message=f"Ipopt: {point.status}; the smallest relative violation of the limits "
                f"reached is {100.0 * reached:.3g} %",
            )
        point = _ipopt(problem, shape, point.y, low, high, following)
    for _ in range(AGAIN):
        if clock.stopped or following.scale is None:
            break
        if unit_at(problem, shape, point.y).objective >= SMALLER * following.scale.objective:
            break
        point = _ipopt(problem, shape, point.y, low, high, following)
    if following.raised is not None:
        raise following.raised
    lost = _lost(problem, shape, point, following)
    best = following.best if clock.stopped or lost else point.y
    message = "" if point.status in UNTOLD else f"Ipopt: {point.status}"
    return Outcome(
        None if best is None else np.clip(shape.to_x(best), lower, upper),
        finished=not clock.stopped,
        lam_g=point.lam_g,
        lam_h=point.lam_h,
        evaluations=clock.evaluations,
        message="Ipopt ended higher than a point it passed, which is kept" if lost else message,
    )


def _by_epigraph(
    problem: Problem, smooth: Problem, budget: Budget, watch: Watch | None, start: Array | None
) -> Outcome:
    """Outcome of the epigraph form of a text with maxima, in the variables of the text."""
    begin = None if start is None else raised(problem, start)
    lifted = run(smooth, budget, 0, watch, begin)
    x = None if lifted.x is None else lifted.x[: len(problem.columns)]
    return replace(lifted, x=x, lam_g=None, lam_h=None)


def _split(problem: Problem, shape: Form) -> Split:
    key = ("split", id(shape))
    if key not in problem.memo:
        problem.memo[key] = split(shape, tape.kinds(problem))
    parts: Split = problem.memo[key]
    return parts


def _built(problem: Problem, shape: Form) -> tuple[Any, Any]:
    """Return the solver of a form in units of its own scale, and its monitor, built once."""
    import casadi as ca

    key = ("ipopt", id(shape))
    if key not in problem.memo:
        parts, size = _split(problem, shape), shape.derivatives.numel_in(0)
        units, unit = type(parts.z).sym("units", size), type(parts.z).sym("unit")
        z, f, g, h, levels = scaled(shape, parts, units)
        f = f if shape.log_objective else f / unit
        p = ca.vertcat(parts.p, units, unit)
        problem.memo[key] = program(z, p, f, ca.vertcat(g, h, levels), size)
    built: tuple[Any, Any] = problem.memo[key]
    return built


def _ipopt(
    problem: Problem, shape: Form, y0: Array, low: Array, high: Array, following: _Run
) -> _Point:
    """Run Ipopt from a point, in the units that fit there; nothing is built when time is over."""
    m_g, m_h = following.rows
    if following.clock.over:
        following.continues()
        return _Point(y0, np.zeros(m_g), np.zeros(m_h), "User_Requested_Stop")
    solver, monitor = _built(problem, shape)
    monitor.follow = following.note
    unit = following.scale = unit_at(problem, shape, y0)
    levels = np.array(_split(problem, shape).start(y0, problem.parameter_values())).ravel()
    free = np.full(len(levels), np.inf)
    solution = solver(
        x0=np.concatenate([y0 / unit.variables, levels]),
        p=np.concatenate([problem.parameter_values(), unit.variables, [unit.objective]]),
        lbx=np.concatenate([low / unit.variables, -free]),
        ubx=np.concatenate([high / unit.variables, free]),
        lbg=np.concatenate([np.full(m_g, -np.inf), np.zeros(m_h), -free]),
        ubg=0.0,
    )
    lam = np.array(solution["lam_g"]).ravel() * unit.objective
    status = str(solver.stats()["return_status"])
    point = np.array(solution["x"]).ravel()[: len(y0)] * unit.variables
    return _Point(point, lam[:m_g], lam[m_g : m_g + m_h], status)


def _lost(problem: Problem, shape: Form, point: _Point, following: _Run) -> bool:
    """Return whether the end point is worse than the best passed, by more than tolerance.

    A violation of ACCEPTED lowers the objective of a solved problem by at most its multipliers
    times it. An end point that is not feasible is worse than any that is.
    """
    if following.best is None or following.clock.stopped:
        return False
    value = values(problem, shape, point.y)[0]
    prices = np.abs(np.concatenate([point.lam_g, point.lam_h]))
    bought = ACCEPTED * float(np.nan_to_num(prices).sum()) + ROUNDING * abs(value)
    ended = violation(problem, shape, point.y) <= FEASIBLE
    return not (ended and value <= following.least + bought)


def _least_violation(
    problem: Problem, shape: Form, point: _Point, low: Array, high: Array, outer: _Run
) -> tuple[_Point, float]:
    """Minimise the largest violation t of any row; its multipliers are the conflict.

    outer: the run, whose budget and watcher go on counting.
    """
    import casadi as ca

    key, size = ("ipopt least violation", id(shape)), len(point.y)
    parts = _split(problem, shape)
    m_g, m_h = outer.rows
    if key not in problem.memo:
        t, units = type(parts.z).sym("t"), type(parts.z).sym("units", size)
        y, _, g, h, levels = scaled(shape, parts, units)
        rows = ca.vertcat(g - t, h - t, -h - t, levels)
        problem.memo[key] = program(ca.vertcat(y, t), ca.vertcat(parts.p, units), t, rows, size)
    solver, monitor = problem.memo[key]

    def follow(_: Array) -> bool:
        outer.clock.evaluations += 1
        return outer.continues()

    monitor.follow = follow
    start = np.where(np.isfinite(point.y), point.y, 0.0)
    unit = unit_at(problem, shape, start).variables
    start_levels = np.array(parts.start(start, problem.parameter_values())).ravel()
    free = np.full(len(start_levels), np.inf)
    solution = solver(
        x0=np.concatenate([start / unit, start_levels, [1.0]]),
        p=np.concatenate([problem.parameter_values(), unit]),
        lbx=np.concatenate([low / unit, -free, [-1.0]]),
        ubx=np.concatenate([high / unit, free, [np.inf]]),
        lbg=-np.inf,
        ubg=0.0,
    )
    z = np.array(solution["x"]).ravel()
    lam = np.array(solution["lam_g"]).ravel()
    lam_h = lam[m_g : m_g + m_h] - lam[m_g + m_h : m_g + 2 * m_h]
    return _Point(z[:size] * unit, lam[:m_g], lam_h, point.status), float(z[-1])
