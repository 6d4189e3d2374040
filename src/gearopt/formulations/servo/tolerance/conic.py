"""Stacks and grades as linear and second-order cones: a second way, with bounds of other data."""

from collections.abc import Mapping, Sequence
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
    return several(stack, {}, ("cost",))


def several(
    stack: Stack, errors: Mapping[str, str], names: Sequence[str], lost: float = 0.0
) -> Conic:
    """Minimise cost and errors of budgets, whose limits hold, too; exponents as of `continuous`.

    errors: label of the budget of every error, by its name. names: "cost" or of errors, those that
    are minimised. lost: what is added to every error.
    """
    if not stack.exponent.all():
        raise ValueError("conic takes exponents above zero only")
    size = len(stack.components)

    def evaluate(x: Any, p: Any) -> Terms:
        import cvxpy as cp

        t = cp.reshape(x.t, (size,), order="C")
        cost = 0.0
        for k in sorted(set(stack.exponent)):
            columns = np.flatnonzero(stack.exponent == k)
            cost = cost + cp.sum(cp.multiply(stack.cost[columns], cp.power(t[columns], -k)))
        limits, goals, called = {}, {"cost": cost}, {label: n for n, label in errors.items()}
        for budget, linear, square in zip(stack.budgets, stack.linear, stack.square, strict=True):
            used = linear @ t
            if square.any():
                used += cp.norm(cp.multiply(square, t))
            limits[budget.label] = used
            if budget.label in called:
                goals[called[budget.label]] = lost + budget.error * used
        return Terms({name: goals[name] for name in names}, limits)

    low, high = (tuple(map(float, ends)) for ends in (stack.least, stack.most))
    guess = tuple(np.maximum(low, high)) if stack.used(stack.most).max() <= 1.0 else high
    return Conic("tolerance", (Var("t", "mm", low, high, guess, size),), (), evaluate)


def milp(choice: Choice) -> Conic:
    """Pose the cheapest grades with one 0-1 variable per grade."""
    weights, costs = (np.concatenate(rows).astype(float) for rows in (choice.weights, choice.costs))
    counts = [len(row) for row in choice.costs]
    membership = np.repeat(np.eye(len(counts)), counts, axis=1)

    def evaluate(x: Any, p: Any) -> Terms:
        import cvxpy as cp

        chosen = cp.reshape(x.chosen, (len(costs),), order="C")
        return Terms(
            {"cost": costs @ chosen},
            {choice.rule: weights @ chosen},
            equal={"one": membership @ chosen},
        )

    chosen = Var("chosen", "", 0.0, 1.0, 0.0, len(costs), integer=True)
    return Conic("grades", (chosen,), (), evaluate)
