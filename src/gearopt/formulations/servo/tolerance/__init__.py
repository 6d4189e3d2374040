"""Tolerances at minimum cost within budgets of the error.

    minimise    sum a_i t_i^-k_i                  (-a_i ln t_i where k_i = 0)
    subject to  sum_i l_bi t_i + (sum_i (q_bi t_i)^2)^(1/2) <= 1        for every budget b
                least_i <= t_i <= most_i

`stack` has what l and q are for the worst case, RSS, and mean + kappa sd. Where all k > 0 cost and
budgets are log-convex, so `ipopt` and `gp` find the optimum and the dual bound proves it.
`exact` is the closed form, or the roots of the optimality conditions, with a bound of its own.
`conic` states the same as cones, `grades` chooses among few tolerances per component,
`sampling` draws errors.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.servo.tolerance.roots import closed_form, levels, lower_bound, roots
from gearopt.formulations.servo.tolerance.stack import Stack
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import CLOSED_FORM, Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Param, Terms, Var, each, spread

RANDOM = False
COUNTS = "solution in closed form or by roots"
LEVELS = 4  # roots inside each other that `exact` takes on: some 0.3 s for 14 components
DUAL = (
    "Proof: costs and budgets are convex; the bound follows from Lagrange multipliers of the "
    "budgets."
)
TIE = 1e-12  # by which minimum tolerances may exceed a budget
ENDS = {"least": "tolerances.least_factor", "most": "tolerances.largest_factor"}  # keys in a file
SMALLEST = 1e-290  # mm, the end of a search


def problem(stack: Stack) -> Problem:
    """Pose the stack: variables t [mm]; limits the budgets by name, minimum and maximum t.

    Parameters: error of every budget, minimum and maximum of the components that have them.
    """
    components = stack.components

    def evaluate(x: Any, p: Any) -> Terms:
        t = each(x.t)
        cost = sum(
            c.cost * width**-c.exponent if c.exponent > 0 else -c.cost * np.log(width)
            for c, width in zip(components, t, strict=True)
        )
        limits = {
            b.label: _budget_utilisation([b.weights(c) for c in components], t) * (b.error / error)
            for b, error in zip(stack.budgets, each(p.error), strict=True)
        }
        return Terms({"cost": cost}, {**limits, **_ends(stack, t, p)})

    low, high, guess = (tuple(map(float, ends)) for ends in search(stack))
    t = Var("t", "mm", low, high, guess, len(components), log=True, search=True)
    methods = {"exact": _exact(stack)} if levels(stack) <= LEVELS else {}
    return Problem("tolerance", (t,), _parameters(stack), evaluate, methods=methods)


def _parameters(stack: Stack) -> tuple[Param, ...]:
    """Return the errors allowed, and minimum and maximum tolerances that were given."""
    errors, keys = (tuple(getattr(b, n) for b in stack.budgets) for n in ("error", "key"))
    parameters = [Param("error", "", errors, len(errors), keys, "limit")]
    for name, given in zip(ENDS, _bounded_components(stack), strict=True):
        if given:
            values = tuple(getattr(stack.components[k], name) for k in given)
            parameters.append(Param(name, "mm", values, len(given), ENDS[name], "limit"))
    return tuple(parameters)


def _bounded_components(stack: Stack) -> tuple[list[int], list[int]]:
    """Return the components with a minimum, and those with a maximum tolerance."""
    parts = list(enumerate(stack.components))
    return [k for k, c in parts if c.least > 0.0], [k for k, c in parts if c.most < np.inf]


def _at(stack: Stack, problem: Problem) -> Stack:
    """Return the stack with the parameters of its problem."""
    values = {q.name: spread(q.value, q.size).tolist() for q in problem.parameters}
    parts = list(stack.components)
    for name, given in zip(ENDS, _bounded_components(stack), strict=True):
        for k, value in zip(given, values.get(name, ()), strict=True):
            parts[k] = replace(parts[k], **{name: value})
    errors = zip(stack.budgets, values["error"], strict=True)
    return Stack(tuple(parts), tuple(replace(b, error=error) for b, error in errors))


def _budget_utilisation(weights: list[tuple[float, float]], t: tuple[Any, ...]) -> Any:
    """Return the utilisation of a budget: sum l t + (sum (q t)^2)^(1/2)."""
    linear = [weight * width for (weight, _), width in zip(weights, t, strict=True) if weight > 0]
    square = [weight * width for (_, weight), width in zip(weights, t, strict=True) if weight > 0]
    return sum(linear) + (sum(part**2 for part in square) ** 0.5 if square else 0.0)


def _ends(stack: Stack, t: tuple[Any, ...], p: Any) -> Mapping[str, Any]:
    """Return the limits of minimum and maximum tolerances that were given."""
    least, most = _bounded_components(stack)
    low = {k: q / t[k] for k, q in zip(least, each(p.least) if least else (), strict=True)}
    high = {k: t[k] / q for k, q in zip(most, each(p.most) if most else (), strict=True)}
    limits: dict[str, Any] = {}
    for k in range(len(t)):
        limits |= {f"least[{k + 1}]": low[k]} if k in low else {}
        limits |= {f"most[{k + 1}]": high[k]} if k in high else {}
    return limits


def search(stack: Stack) -> tuple[Array, Array, Array]:
    """Return ends far from any cheapest t [mm], and a t that keeps the limits where one exists.

    A t is no more than what alone uses up a budget, and costs no more than the guess does less the
    minimum cost of all others; the ends are twice as far.
    """
    low, high = stack.least, stack.most
    used, loose = stack.used(low).max(), stack.used(high).max()
    share = 1.0 if loose <= 1.0 else max(0.0, 1.0 - used) / max(loose - used, TIE)
    guess = np.maximum(low + share * (high - low), np.where(low > 0.0, low, 1e-9 * high))
    k = stack.exponent
    with np.errstate(all="ignore"):  # a cost beyond doubles leaves the end of the search far away
        costs, total = stack.costs(high), float(stack.costs(guess).sum())
        highest = np.fmax(total - (costs.sum() - costs), costs)
        power = np.where(k > 0.0, np.log(stack.cost / highest) / k, -highest / stack.cost)
    narrowest = np.exp(np.clip(power, np.log(SMALLEST), np.log(guess)))
    return 0.5 * np.maximum(np.minimum(narrowest, guess), low), 2.0 * high, guess


def _exact(stack: Stack) -> Any:
    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Return the closed form if there is one, else roots, with the bound of the multipliers.

        Nothing here is random.
        """
        clock, posed = Clock(budget, watch), _at(stack, problem)
        if (conflict := impossible(posed)) is not None:
            return conflict
        try:
            with np.errstate(over="raise"):
                return _cheapest(posed, clock)
        except TimeoutError as early:
            return Outcome(search(posed)[2], finished=False, message=str(early))
        except ArithmeticError as extreme:
            return Outcome(None, message=f"beyond the range of doubles: {extreme}")

    return exact


def _cheapest(stack: Stack, clock: Clock) -> Outcome:
    """Return the cheapest tolerances with the bound of their multipliers."""
    optimum = closed_form(stack)
    t, lam = optimum or roots(stack, clock)
    proof = {
        "method": "closed form" if optimum else "dual",
        "arithmetic": "double, with a rounding allowance",
        "multipliers": dict(zip([b.label for b in stack.budgets], lam.tolist(), strict=True)),
        "sentence": CLOSED_FORM if optimum else DUAL,
    }
    return Outcome(t, bound=lower_bound(stack, lam, t), proof=proof, evaluations=1)


def impossible(stack: Stack) -> Outcome | None:
    """Return the claim that minimum tolerances break a budget; None where they do not."""
    free = stack.least == 0.0
    for row, (budget, used) in enumerate(zip(stack.budgets, stack.used(stack.least), strict=True)):
        weight = stack.linear[row] + stack.square[row]
        starved = free & (weight > 0.0)  # their cost would be infinite
        if used <= 1.0 + TIE and not (used >= 1.0 and starved.any()):
            continue
        chosen = _largest(stack, row, weight * stack.least)
        names = ", ".join(stack.components[k].name for k in chosen)
        proof = {
            "method": "closed form",
            "conflict": [budget.label, *(f"least[{k + 1}]" for k in chosen)],
            "components": [stack.components[k].name for k in chosen],
            "least_utilisation": float(used),
        }
        message = f"the minimum tolerances of {names} alone use up the budget {budget.label}"
        proof["sentence"] = f"Proof: {message}."
        return Outcome(None, infeasible=True, proof=proof, message=message)
    return None


def _largest(stack: Stack, row: int, shares: Array) -> list[int]:
    """Return components, the largest first, until their minimum tolerances use up a budget."""
    order = np.argsort(-shares, kind="stable")
    for count in range(1, len(order)):
        some = np.isin(np.arange(len(order)), order[:count])
        if stack.used(np.where(some, stack.least, 0.0))[row] > 1.0 + TIE:
            return [int(k) for k in order[:count]]
    return [int(k) for k in order if shares[k] > 0.0]
