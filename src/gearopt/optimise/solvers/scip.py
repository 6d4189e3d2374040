"""SCIP on the logarithms of a problem's variables, built from its tape.

Integers with few values and finite sets become binaries, so that their logarithms are affine; the
posynomial rows are then convex sums of exponentials, and only exp(log z) = z of a wide integer is
not. (The polynomial form of the same drive leaves a gap of 97 % after 90 s.) SCIP's bound and its
"infeasible" are its word, not ours: they are reported as claims, and the point is judged like any
other. The objective is scaled by its value at the guess; an answer that scaled lies below SCIP's
tolerance is refused, because SCIP then calls anything optimal.
"""

import math
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise import discrete, posynomial
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array

FEW = 300  # values of an integer that are worth a binary each
FEASIBILITY = 1e-9
GAP = 1e-7  # relative
SMALL = 1e3 * FEASIBILITY  # scaled objectives below it are within SCIP's tolerance of anything

RANDOM = True  # the seed shifts SCIP's own
COUNTS = "branch-and-bound node"
SETTINGS = {"limits/gap": GAP, "numerics/feastol": FEASIBILITY, "binaries up to": FEW}


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve by SCIP; SolveError where the text is no posynomial or pyscipopt is not installed."""
    clock = Clock(budget, watch)
    model = posynomial.read(problem)
    scip, logs = _model(problem, model, budget, seed)
    if (left := clock.left.seconds) is not None:
        scip.setParam("limits/time", left)
    _follow(scip, clock, _scale(problem))
    scip.optimize()
    status, nodes = str(scip.getStatus()), int(scip.getNTotalNodes())
    if status == "infeasible":
        return Outcome(None, evaluations=nodes, message="SCIP claims infeasible; not proven by us")
    finished = status in ("optimal", "gaplimit") and not clock.refused
    if not scip.getNSols():
        return Outcome(None, finished, evaluations=nodes, message=f"SCIP: {status}")
    if scip.getPrimalbound() < SMALL:
        raise SolveError(
            f"scip on {problem.name}: the objective is {scip.getPrimalbound():.1e} of its value at "
            "the guess, within SCIP's tolerance; scale it or give a better guess"
        )
    point = _point(problem, np.array([scip.getVal(v) for v in logs]))
    claim = scip.getDualbound() * _scale(problem)
    return Outcome(
        point,
        finished,
        evaluations=nodes,
        message=f"SCIP claims {status} with bound {claim:.10g}, which is its word",
    )


def _scale(problem: Problem) -> float:
    """The objective at the guess, the unit of SCIP's objective."""
    scale = float(problem.batch(problem.bounds()[2][None]).F[0, 0])
    if not 0.0 < scale < math.inf:
        raise SolveError(f"scip on {problem.name}: the objective is {scale:g} at the guess")
    return scale


def _model(
    problem: Problem, model: posynomial.Model, budget: Budget, seed: int
) -> tuple[Any, list[Any]]:
    """The SCIP model and the logarithm of every variable in it."""
    try:
        from pyscipopt import Model, exp, quicksum
    except ImportError as missing:
        raise SolveError("scip needs pyscipopt: pip install 'gearopt[scip]'") from missing
    scip = Model()
    scip.hideOutput()
    scip.setParams(
        {
            "limits/gap": GAP,
            "numerics/feastol": FEASIBILITY,
            "randomization/randomseedshift": seed,
            "misc/catchctrlc": False,  # who watches decides
        }
    )
    if budget.evaluations is not None:
        scip.setParam("limits/totalnodes", budget.evaluations)
    logs = [_logarithm(scip, problem, k) for k in range(len(problem.columns))]

    def monomials(term: posynomial.Posynomial, scale: float = 1.0) -> Any:
        return quicksum(
            exp(math.log(c / scale) + quicksum(e * v for e, v in zip(row, logs, strict=True) if e))
            for c, row in zip(term.coefficients, term.exponents, strict=True)
        )

    for row in model.inequalities:
        if len(row.coefficients) == 1:  # affine in logarithms
            scip.addCons(_affine(row, logs) <= 0)
        else:
            scip.addCons(monomials(row) <= 1)
    for row in model.equalities:
        scip.addCons(_affine(row, logs) == 0)
    # One variable a monomial: SCIP then outer-approximates each convex exponential by itself.
    parts = []
    scale = _scale(problem)
    for c, exponents in zip(model.objective.coefficients, model.objective.exponents, strict=True):
        part = scip.addVar(lb=0.0)
        one = posynomial.Posynomial(np.array([c]), exponents[None])
        scip.addCons(monomials(one, scale) <= part)
        parts.append(part)
    scip.setObjective(quicksum(parts))
    return scip, logs


def _affine(row: posynomial.Posynomial, logs: list[Any]) -> Any:
    from pyscipopt import quicksum

    terms = (float(e) * v for e, v in zip(row.exponents[0], logs, strict=True) if e)
    return math.log(row.coefficients[0]) + quicksum(terms)


def _logarithm(scip: Any, problem: Problem, index: int) -> Any:
    """A SCIP variable that is the logarithm of one variable of the problem."""
    from pyscipopt import exp, quicksum

    variable, name = problem.columns[index]
    low, high = (float(b[index]) for b in problem.bounds()[:2])
    if not low > 0.0:
        raise SolveError(f"scip takes positive variables only; {name} may be {low:g}")
    log = scip.addVar(name, lb=math.log(low), ub=math.log(high) if math.isfinite(high) else None)
    if not variable.discrete:
        return log
    if variable.integer:
        low, high = discrete.ends(problem, index)
        if not high - low < FEW:
            most = high if math.isfinite(high) else None
            scip.addCons(exp(log) == scip.addVar(vtype="I", lb=low, ub=most))
            return log
    values = discrete.values(problem, index)
    picks = [scip.addVar(vtype="B") for _ in values]
    scip.addCons(quicksum(picks) == 1)
    scip.addCons(quicksum(math.log(v) * w for v, w in zip(values, picks, strict=True)) == log)
    return log


def _point(problem: Problem, logs: Array) -> Array:
    """The natural point, discrete variables set to the value they mean."""
    lower, upper, _ = problem.bounds()
    point = np.clip(np.exp(logs), lower, upper)
    for k, (variable, _) in enumerate(problem.columns):
        if variable.values is not None:
            values = np.array(variable.values)
            point[k] = values[np.abs(values - point[k]).argmin()]
        elif variable.integer:
            point[k] = round(point[k])
    return point


def _follow(scip: Any, clock: Clock, scale: float) -> None:
    """Have SCIP tell a clock of its progress, and stop where its watcher wants no more."""
    from pyscipopt import SCIP_EVENTTYPE, Eventhdlr

    kinds = (SCIP_EVENTTYPE.NODESOLVED, SCIP_EVENTTYPE.BESTSOLFOUND)

    class Follower(Eventhdlr):  # type: ignore[misc]
        """What SCIP calls."""

        def eventinit(self) -> None:
            for kind in kinds:
                self.model.catchEvent(kind, self)

        def eventexit(self) -> None:
            for kind in kinds:
                self.model.dropEvent(kind, self)

        def eventexec(self, happened: Any) -> None:
            value = self.model.getPrimalbound()
            clock.best = scale * value if value < self.model.infinity() else math.inf
            clock.evaluations = int(self.model.getNTotalNodes())
            clock.tell()
            if clock.refused:
                self.model.interruptSolve()

    scip.includeEventhdlr(Follower(), "follower", "progress and interruption")
