"""Bonmin's NLP branch and bound (B-BB) through CasADi: a heuristic on nonconvex problems.

Only B-BB: outer approximation (B-OA, B-Hyb) was 3 to 95 % high on our drives while it said optimal.
The tree is exact for convex relaxations only, so nothing it returns is called proven. Finite sets
become binaries; rows of a posynomial problem are taken in logarithms.
"""

from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise import posynomial
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome, Watch

SECONDS = 60.0  # where the budget names no end
QUIET = (
    "bb_log_level",
    "nlp_log_level",
    "fp_log_level",
    "oa_log_level",
    "lp_log_level",
    "milp_log_level",
)


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve by B-BB from the guess; Bonmin cannot be interrupted, only limited in time."""
    if problem.repeats:
        raise SolveError(f"bonmin takes no repeats; {problem.name} has some")
    if watch is not None and not watch(Event(0.0, 0)):
        return Outcome(None, finished=False, message="stopped before it began")
    seconds = SECONDS if budget.seconds is None else max(budget.seconds, 0.01)
    import casadi as ca

    variables = _Variables(problem)
    logarithmic = _posynomial(problem)
    f, g, h = problem.traced().terms(ca.vertcat(*variables.x), problem.parameter_values())
    rows = ca.vertcat(*variables.sums, *(ca.log(r) if logarithmic else r - 1 for r in (g, h)))
    size_g, size_h, sums = g.numel(), h.numel(), len(variables.sums)
    options = {
        "discrete": variables.discrete,
        "print_time": False,
        "error_on_fail": False,
        "show_eval_warnings": False,
        "bonmin": {"algorithm": "B-BB", "time_limit": seconds} | dict.fromkeys(QUIET, 0),
    }
    nlp = {"x": ca.vertcat(*variables.symbols), "f": ca.log(f) if logarithmic else f, "g": rows}
    solver = ca.nlpsol("bonmin", "bonmin", nlp, options)
    found = solver(
        x0=variables.start,
        lbx=variables.lower,
        ubx=variables.upper,
        lbg=[1.0] * sums + [-np.inf] * size_g + [0.0] * size_h,
        ubg=[1.0] * sums + [0.0] * (size_g + size_h),
    )
    status = str(solver.stats().get("return_status", ""))
    value = np.array(found["x"]).ravel()
    if np.isnan(value).any() or status == "INFEASIBLE":
        return Outcome(None, message=f"Bonmin: {status}; not proven by us")
    to_x = ca.Function("x", [nlp["x"]], [ca.vertcat(*variables.x)])
    rounded = np.where(variables.discrete, np.rint(value), value)
    point = np.clip(np.array(to_x(rounded)).ravel(), *problem.bounds()[:2])
    message = "" if status == "SUCCESS" else f"Bonmin: {status}"
    return Outcome(point, finished=status in ("SUCCESS", "INFEASIBLE"), message=message)


def _posynomial(problem: Problem) -> bool:
    try:
        posynomial.read(problem)
    except SolveError:
        return False
    return True


class _Variables:
    """The variables Bonmin sees and the problem's as expressions of them (built in one pass)."""

    def __init__(self, problem: Problem) -> None:
        self.symbols: list[Any] = []
        self.lower: list[float] = []
        self.upper: list[float] = []
        self.start: list[float] = []
        self.discrete: list[bool] = []
        self.x: list[Any] = []
        self.sums: list[Any] = []
        columns = zip(problem.columns, *problem.bounds(), strict=True)
        for (variable, _), low, high, guess in columns:
            self._column(variable, low, high, guess)

    def _column(self, variable: Any, low: float, high: float, guess: float) -> None:
        import casadi as ca

        if variable.values is not None:
            allowed = [v for v in variable.values if low <= v <= high]
            picks = [self._add(0.0, 1.0, 1.0 / len(allowed), True) for _ in allowed]
            self.sums.append(sum(picks))
            self.x.append(sum(v * w for v, w in zip(allowed, picks, strict=True)))
        elif variable.log:
            self.x.append(ca.exp(self._add(np.log(low), np.log(high), np.log(guess), False)))
        else:
            self.x.append(self._add(low, high, guess, variable.integer))

    def _add(self, low: float, high: float, start: float, discrete: bool) -> Any:
        import casadi as ca

        symbol = ca.SX.sym("v")
        self.symbols.append(symbol)
        self.lower.append(float(low))
        self.upper.append(float(high))
        self.start.append(float(start))
        self.discrete.append(discrete)
        return symbol
