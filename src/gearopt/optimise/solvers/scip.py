"""SCIP on the logarithms of a problem's variables, built from the posynomials of its tape.

Every variable that is positive by its bounds counts as a factor, whether declared log or not.
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
from gearopt.frozen import dataclass
from gearopt.optimise.box import allowed_values, whole_ends
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.tape import walk
from gearopt.optimise.terms import Array

MOST_TERMS = 200  # of one expanded row; beyond it the text should name an intermediate variable


@dataclass(frozen=True)
class Posynomial:
    """sum_k coefficients[k] * prod_j x_j**exponents[k, j]; coefficients (t,) > 0 unless empty."""

    coefficients: Array
    exponents: Array


@dataclass(frozen=True)
class Posynomials:
    """Objective, inequalities (<= 1) and equalities (monomials, = 1) of a problem."""

    objective: Posynomial
    inequalities: tuple[Posynomial, ...]
    equalities: tuple[Posynomial, ...]


def read(problem: Problem) -> Posynomials:
    """Expand every row of a problem's tape; SolveError names the row that is not a posynomial."""
    if problem.repeats:
        raise SolveError(f"{problem.name} has repeats, which this reader does not expand")
    rows = problem.rows
    (block,) = problem.traced().blocks
    f, g, h = _outputs(problem, block.function)
    names = [*rows.objectives, *(r.name for r in rows.inequalities), *rows.equalities]
    for name, term in zip(names, [*f, *g, *h], strict=True):
        if term is None or not (term.coefficients > 0).all() or not len(term.coefficients):
            raise SolveError(f"{problem.name}: {name} is not a posynomial")
        if not (np.isfinite(term.coefficients).all() and np.isfinite(term.exponents).all()):
            raise SolveError(f"{problem.name}: {name} has an infinite coefficient or exponent")
    for name, term in zip(rows.equalities, h, strict=True):
        if len(term.coefficients) != 1:
            raise SolveError(f"{problem.name}: the equality {name} is not a monomial")
    return Posynomials(f[0], tuple(g), tuple(h))


def _outputs(problem: Problem, function: Any) -> list[list[Any]]:
    lower, _, _ = problem.bounds()
    count = len(lower)
    inputs: list[list[Any]] = [
        [_variable(k, lower) for k in range(count)],
        [],
        [_constant(value, count) for value in problem.parameter_values()],
        [],
    ]
    return walk(function, inputs, lambda value: _constant(value, count), _apply)


def _constant(value: float, count: int) -> Posynomial:
    return Posynomial(np.array([float(value)]), np.zeros((1, count)))


def _variable(index: int, lower: Array) -> Posynomial | None:
    if not lower[index] > 0:
        return None
    exponents = np.zeros((1, len(lower)))
    exponents[0, index] = 1.0
    return Posynomial(np.ones(1), exponents)


def _apply(operation: int, terms: list[Posynomial | None]) -> Posynomial | None:
    import casadi as ca

    if any(t is None for t in terms):
        return None
    a, b = terms[0], terms[-1]
    assert a is not None and b is not None
    if operation == ca.OP_ADD:
        return _sum(a, b)
    if operation == ca.OP_SUB:
        return _sum(a, Posynomial(-b.coefficients, b.exponents))
    if operation == ca.OP_NEG:
        return Posynomial(-a.coefficients, a.exponents)
    if operation == ca.OP_TWICE:
        return Posynomial(2.0 * a.coefficients, a.exponents)
    if operation == ca.OP_MUL:
        return _product(a, b)
    if operation == ca.OP_SQ:
        return _product(a, a)
    if operation == ca.OP_DIV:
        inverse = _power(b, -1.0)
        return None if inverse is None else _product(a, inverse)
    if operation == ca.OP_INV:
        return _power(a, -1.0)
    if operation == ca.OP_SQRT:
        return _power(a, 0.5)
    if operation in (ca.OP_POW, ca.OP_CONSTPOW):
        constant = len(b.coefficients) == 1 and not b.exponents.any()
        return _power(a, float(b.coefficients[0])) if constant else None
    return a if operation == ca.OP_ASSIGN else None


def _sum(a: Posynomial, b: Posynomial) -> Posynomial | None:
    return _collected(
        np.concatenate([a.coefficients, b.coefficients]), np.concatenate([a.exponents, b.exponents])
    )


def _product(a: Posynomial, b: Posynomial) -> Posynomial | None:
    coefficients = np.outer(a.coefficients, b.coefficients).ravel()
    exponents = (a.exponents[:, None, :] + b.exponents[None, :, :]).reshape(
        len(coefficients), a.exponents.shape[1]
    )
    return _collected(coefficients, exponents)


def _power(a: Posynomial, exponent: float) -> Posynomial | None:
    if len(a.coefficients) == 1 and a.coefficients[0] > 0:
        return Posynomial(a.coefficients**exponent, exponent * a.exponents)
    if exponent == int(exponent) and 1 <= exponent <= 8:
        result: Posynomial | None = a
        for _ in range(int(exponent) - 1):
            result = None if result is None else _product(result, a)
        return result
    return None


def _collected(coefficients: Array, exponents: Array) -> Posynomial | None:
    """Add up equal monomials and drop zeros."""
    unique, place = np.unique(np.round(exponents, 12), axis=0, return_inverse=True)
    total = np.bincount(place.ravel(), weights=coefficients, minlength=len(unique))
    keep = total != 0
    if keep.sum() > MOST_TERMS:
        return None
    return Posynomial(total[keep], unique[keep])


MAX_BINARIES = 300  # values of an integer that are worth a binary each
FEASIBILITY = 1e-9
GAP = 1e-7  # relative
# scaled objectives below it are within SCIP's tolerance of anything
SMALLEST_OBJECTIVE = 1e3 * FEASIBILITY

RANDOM = True  # the seed shifts SCIP's own
COUNTS = "branch-and-bound node"
SETTINGS = {"limits/gap": GAP, "numerics/feastol": FEASIBILITY, "binaries up to": MAX_BINARIES}


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve by SCIP; SolveError where the text is no posynomial or pyscipopt is not installed."""
    clock = Clock(budget, watch)
    model = read(problem)
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
    if scip.getPrimalbound() < SMALLEST_OBJECTIVE:
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
    """Return the objective at the guess, the unit of SCIP's objective."""
    scale = float(problem.batch(problem.bounds()[2][None]).F[0, 0])
    if not 0.0 < scale < math.inf:
        raise SolveError(f"scip on {problem.name}: the objective is {scale:g} at the guess")
    return scale


def _model(
    problem: Problem, model: Posynomials, budget: Budget, seed: int
) -> tuple[Any, list[Any]]:
    """Return the SCIP model and the logarithm of every variable in it."""
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

    def monomials(term: Posynomial, scale: float = 1.0) -> Any:
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
        monomial = Posynomial(np.array([c]), exponents[None])
        scip.addCons(monomials(monomial, scale) <= part)
        parts.append(part)
    scip.setObjective(quicksum(parts))
    return scip, logs


def _affine(row: Posynomial, logs: list[Any]) -> Any:
    from pyscipopt import quicksum

    terms = (float(e) * v for e, v in zip(row.exponents[0], logs, strict=True) if e)
    return math.log(row.coefficients[0]) + quicksum(terms)


def _logarithm(scip: Any, problem: Problem, index: int) -> Any:
    """Return A SCIP variable that is the logarithm of one variable of the problem."""
    from pyscipopt import exp, quicksum

    variable, name = problem.columns[index]
    low, high = (float(b[index]) for b in problem.bounds()[:2])
    if not low > 0.0:
        raise SolveError(f"scip takes positive variables only; {name} may be {low:g}")
    log = scip.addVar(name, lb=math.log(low), ub=math.log(high) if math.isfinite(high) else None)
    if not variable.discrete:
        return log
    if variable.integer:
        low, high = whole_ends(problem, index)
        if not high - low < MAX_BINARIES:
            most = high if math.isfinite(high) else None
            scip.addCons(exp(log) == scip.addVar(vtype="I", lb=low, ub=most))
            return log
    values = allowed_values(problem, index)
    picks = [scip.addVar(vtype="B") for _ in values]
    scip.addCons(quicksum(picks) == 1)
    scip.addCons(quicksum(math.log(v) * w for v, w in zip(values, picks, strict=True)) == log)
    return log


def _point(problem: Problem, logs: Array) -> Array:
    """Return the natural point, discrete variables set to the value they mean."""
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
    """Have SCIP report its progress to a clock, and stop where its watcher refuses."""
    from pyscipopt import SCIP_EVENTTYPE, Eventhdlr

    kinds = (SCIP_EVENTTYPE.NODESOLVED, SCIP_EVENTTYPE.BESTSOLFOUND)

    class Follower(Eventhdlr):  # type: ignore[misc]
        """The event handler that SCIP calls."""

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
