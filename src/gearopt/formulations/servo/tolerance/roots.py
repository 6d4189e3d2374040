"""Minimum cost of a stack by the roots of its optimality conditions: water filling.

At the optimum w_i t_i^-(k_i + 1) = A_i + B_i t_i within the ends of t_i, where

    A = sum_b lam_b l_b,    B = sum_b (lam_b/r_b) q_b^2,    r_b = |q_b t|

Each t_i follows from A_i, B_i by Newton's method. The multiplier lam_b of a budget is the one at
which it is used up (utilisation falls as lam_b rises, all others following), or zero; r_b is where
|q_b t|/r_b = 1, which falls as r_b rises. So all unknowns are roots of monotone functions, one
inside the other. All is scaled, and done in logarithms: no spread of a, s or E matters.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gearopt.formulations.servo.tolerance.stack import Stack
from gearopt.optimise.clock import Clock
from gearopt.optimise.dual import ROUNDING
from gearopt.optimise.terms import Array

NEWTON_STEPS = 5  # of Newton: the error is below 0.7, then e^2/8: 6e-2, 5e-4, 3e-8, 1e-16, done
REACH = 300.0  # of the logarithm of a multiplier or a radius, scaled
INSIDE = 1.0 - 1e-15  # a direction normalised in doubles is made no longer than 1

Solution = tuple[Array, Array]  # tolerances t (components,) and multipliers lam (budgets,)


def closed_form(stack: Stack) -> Solution | None:
    """Return T = E w/|s w|_p, w = (a/s^p)^(1/(k + p)), p = 1 worst case, 2 RSS; lam = sum w t^-k.

    None unless there is one such budget, one exponent, and t within its ends.
    """
    if len(stack.budgets) > 1 or len(set(stack.exponent)) > 1:
        return None
    (linear,), (square,) = stack.linear, stack.square
    if linear.any() and square.any():
        return None
    p, weight = (2, square) if square.any() else (1, linear)
    if not weight.all():
        return None
    k = float(stack.exponent[0])
    shape = np.exp((np.log(stack.cost) - p * np.log(weight)) / (k + p))
    t = shape / np.linalg.norm(weight * shape, p)
    given = np.array([c.most for c in stack.components])
    if not ((stack.least <= t) & (t <= given)).all():
        return None
    return t, np.array([(stack.slope * t**-k).sum()])


def roots(stack: Stack, clock: Clock) -> Solution:
    """Return tolerances and multipliers of a stack whose minimum tolerances keep its budgets.

    TimeoutError when the clock, asked before each step of the outermost root, is over.
    ArithmeticError for costs or multipliers beyond doubles.
    """
    unit_stack, unit, cost = scaled(stack)
    lam, u = _settled(unit_stack, (), (), dict.fromkeys(range(len(stack.budgets)), 0.0), clock)
    over = float((unit_stack.used(u) / np.maximum(1.0, unit_stack.used(unit_stack.least))).max())
    t = np.maximum(stack.least, unit * u / max(1.0, over))
    return t, cost * np.array(lam)


def scaled(stack: Stack) -> tuple[Stack, Array, float]:
    """Return the stack in u = t/unit, 1 being a budget used up or the upper end; scaled costs."""
    unit, k = stack.most, stack.exponent
    with np.errstate(over="raise"):
        costs = stack.cost * unit**-k
        scale = float((costs * len(unit) ** k).sum())  # with k, lam of n equal components
    parts = tuple(
        replace(c, sensitivity=c.sensitivity * t, cost=a / scale, least=c.least / t, most=1.0)
        for c, t, a in zip(stack.components, unit.tolist(), costs.tolist(), strict=True)
    )
    return Stack(parts, stack.budgets), unit, scale


def levels(stack: Stack) -> int:
    """Return how many roots lie inside each other: the time grows tenfold with each."""
    return len(stack.budgets) + len(_mixed_budgets(stack))


def _mixed_budgets(stack: Stack) -> list[int]:
    """Return budgets whose radius is unknown: |q t| alone is 1 where it is used up."""
    return [int(b) for b in np.flatnonzero(stack.linear.any(1) & stack.square.any(1))]


def _settled(
    stack: Stack,
    lam: tuple[float, ...],
    radii: tuple[float, ...],
    last: dict[int, float],
    clock: Clock | None = None,
) -> tuple[tuple[float, ...], Array]:
    """Return multipliers and tolerances where the first multipliers and radii are given.

    last: the root last found at each depth, near which the next one is. clock: see `roots`.
    """
    budget, mixed, depth = len(lam), _mixed_budgets(stack), len(lam) + len(radii)
    if budget < len(stack.budgets):
        unused = _settled(stack, (*lam, 0.0), radii, last)
        target = max(1.0, float(stack.used(stack.least)[budget]))
        if stack.used(unused[1])[budget] <= target:
            return unused

        def used(x: float) -> float:
            if clock is not None and not clock.tell():
                raise TimeoutError("stopped by the budget")
            t = _settled(stack, (*lam, math.exp(x)), radii, last)[1]
            return math.log(stack.used(t)[budget] / target)

        last[depth] = _root(used, last[depth])
        return _settled(stack, (*lam, math.exp(last[depth])), radii, last)
    if len(radii) < len(mixed):
        budget = mixed[len(radii)]
        if lam[budget] == 0.0:
            return _settled(stack, lam, (*radii, 1.0), last)

        def beyond(x: float) -> float:
            t = _settled(stack, lam, (*radii, math.exp(x)), last)[1]
            return math.log(np.linalg.norm(stack.square[budget] * t)) - x

        last[depth] = _root(beyond, last.get(depth, 0.0))
        return _settled(stack, lam, (*radii, math.exp(last[depth])), last)
    radius = np.ones(len(lam))
    radius[mixed] = radii
    return lam, cheapest(stack, lam @ stack.linear, (lam / radius) @ stack.square**2)


@np.errstate(divide="ignore", invalid="ignore")  # what nothing holds goes to its upper end
def cheapest(stack: Stack, linear: Array, square: Array) -> Array:
    """Return the t that minimises cost + A t + B t^2/2 within the ends; A, B (components,) >= 0."""
    k = stack.exponent
    log_a, log_b = np.log(linear / stack.slope), np.log(square / stack.slope)
    y = np.minimum(-log_a / (k + 1.0), -log_b / (k + 2.0))  # each alone would go beyond the root
    held = np.isfinite(y)
    y = np.where(held, y, 0.0)
    # on the logarithm of w t^-(k + 1) = A + B t, convex and rising in y
    for _ in range(NEWTON_STEPS):
        first, second = log_a + (k + 1.0) * y, log_b + (k + 2.0) * y
        total = np.logaddexp(first, second)
        y = y - np.where(held, total / (k + 1.0 + np.exp(second - total)), 0.0)
    return np.clip(np.where(held, np.exp(y), np.inf), stack.least, stack.most)


def _root(falling: Callable[[float], float], near: float) -> float:
    """Return the zero of a falling function; ArithmeticError where it is beyond `REACH`."""
    from scipy.optimize import brentq

    start, step = near, 0.01 if falling(near) > 0.0 else -0.01
    far = start + step
    while (falling(far) > 0.0) == (step > 0.0):
        start, step = far, 4.0 * step
        far = start + step
        if abs(far) > REACH:
            raise ArithmeticError("a multiplier is beyond the range of doubles")
    return float(brentq(falling, start, far, xtol=1e-15, rtol=1e-15))


def lower_bound(stack: Stack, lam: Array, t: Array) -> float:
    """Return a bound of the cost from multipliers lam (budgets,) and directions v = q t/|q t|.

    t: a point [mm]. For lam >= 0 and |v| <= 1, |q t| >= v.(q t), so that every allowed t costs at
    least sum_i min over t_i of (cost_i(t_i) + c_i t_i) - sum lam, c = sum_b lam_b (l_b + q_b v_b);
    that minimum is at t_i = (w_i/c_i)^(1/(k_i + 1)), or at the end of the range before it.
    ValueError for a negative multiplier.
    """
    if not (np.asarray(lam) >= 0.0).all():
        raise ValueError("multipliers are >= 0")
    along = stack.square * t
    length = np.linalg.norm(along, axis=1, keepdims=True)
    direction = INSIDE * along / np.where(length > 0.0, length, 1.0)
    slope = lam @ (stack.linear + stack.square * direction)
    with np.errstate(divide="ignore"):
        free = (stack.slope / slope) ** (1.0 / (stack.exponent + 1.0))
    best = np.clip(free, stack.least, stack.most)
    terms = [stack.costs(best), slope * best, -np.asarray(lam)]
    rounding = ROUNDING * sum(float(np.abs(part).sum()) for part in terms)
    return math.fsum(value for part in terms for value in part) - rounding
