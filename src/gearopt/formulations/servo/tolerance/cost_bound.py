"""A lower bound on the cost of a stack, from any multipliers, in closed form.

For lam >= 0 and |v| <= 1, |q t| >= v.(q t), so that every allowed t costs at least

    sum_i min over t_i of (cost_i(t_i) + c_i t_i) - sum lam,    c = sum_b lam_b (l_b + q_b v_b)

and that least is at t_i = (w_i/c_i)^(1/(k_i + 1)), or at the end of the range before it.
"""

import math

import numpy as np

from gearopt.formulations.servo.tolerance.stack import Stack
from gearopt.optimise.dual import ROUNDING
from gearopt.optimise.terms import Array

INSIDE = 1.0 - 1e-15  # a direction normalised in doubles is made no longer than 1


def lower_bound(stack: Stack, lam: Array, t: Array) -> float:
    """The bound of multipliers lam (budgets,) and of the directions q t/|q t| of a point t [mm].

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
