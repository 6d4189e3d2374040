"""Stacks and grades as linear and second-order cones: a second way, with bounds of other data."""

from typing import Any

import numpy as np

from gearopt.formulations.servo.tolerance.grades import Choice
from gearopt.formulations.servo.tolerance.stack import Stack
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.terms import Terms, Var


def continuous(stack: Stack) -> Conic:
    """Minimise sum a t^-k under the same limits, for k > 0; cones for small rational k alone.

    ValueError for an exponent of zero, whose logarithm is no such cone.
    """
    if not stack.exponent.all():
        raise ValueError("conic takes exponents above zero only")
    size = len(stack.components)

    def evaluate(x: Any, p: Any) -> Terms:
        import cvxpy as cp

        t = cp.reshape(x.t, (size,), order="C")
        cost = 0.0
        for k in sorted(set(stack.exponent)):
            own = np.flatnonzero(stack.exponent == k)
            cost = cost + cp.sum(cp.multiply(stack.cost[own], cp.power(t[own], -k)))
        limits = {}
        for budget, linear, square in zip(stack.budgets, stack.linear, stack.square, strict=True):
            limits[budget.label] = linear @ t
            if square.any():
                limits[budget.label] += cp.norm(cp.multiply(square, t))
        return Terms({"cost": cost}, limits)

    low, high = (tuple(map(float, ends)) for ends in (stack.least, stack.most))
    guess = tuple(np.maximum(low, high)) if stack.used(stack.most).max() <= 1.0 else high
    return Conic("tolerance", (Var("t", "mm", low, high, guess, size),), (), evaluate)


def milp(choice: Choice) -> Conic:
    """Pose the cheapest grades with one 0-1 variable per grade."""
    weights, costs = (np.concatenate(rows).astype(float) for rows in (choice.weights, choice.costs))
    counts = [len(row) for row in choice.costs]
    own = np.repeat(np.eye(len(counts)), counts, axis=1)

    def evaluate(x: Any, p: Any) -> Terms:
        import cvxpy as cp

        chosen = cp.reshape(x.chosen, (len(costs),), order="C")
        return Terms(
            {"cost": costs @ chosen}, {choice.rule: weights @ chosen}, equal={"one": own @ chosen}
        )

    chosen = Var("chosen", "", 0.0, 1.0, 0.0, len(costs), integer=True)
    return Conic("grades", (chosen,), (), evaluate)
