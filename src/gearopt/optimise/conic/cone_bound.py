"""What multipliers of the canonical rows prove: a lower bound, or that nothing is feasible.

With y in the dual cone, y.(b - A x) >= 0 for every feasible x. Hence cost(x) is at least
cost(x) + y.(A x - b), a convex function, which on a box is at least its value at any point plus the
least of its linear part there. Rounding of every term is taken off; the cone is entered strictly.
"""

import math
from dataclasses import dataclass

import numpy as np

from gearopt.optimise.conic.canonical import Canonical
from gearopt.optimise.terms import Array

ROUNDING = 1e-14  # 50 units in the last place of every term that is added up in a bound
STRICT = 4e-15  # share by which a multiplier is moved into its cone, for the rounding of norms


@dataclass(frozen=True)
class Leaf:
    """One part of the box and the claim about it: `solve` certifies a list of them.

    lower, upper (n,): canonical columns, discrete ones at allowed values. x (n,): where the cost
    is expanded. y (m,): multipliers. ray: they are to prove that the part is empty.
    """

    lower: Array
    upper: Array
    x: Array
    y: Array | None
    ray: bool = False


@dataclass(frozen=True)
class Proof:
    """What multipliers prove on a box.

    least: no feasible point of the box is cheaper. charge, slack: what it lost to the gradient that
    is left and to rows off their limit, in units of the cost. weights (m,): the multipliers used.
    """

    least: float
    charge: float
    slack: float
    weights: Array


def inside(data: Canonical, y: Array) -> Array:
    """Multipliers moved into the dual cone, strictly; NaN becomes 0.

    Of p q >= |w|^2 the dual is 4 y_p y_q >= |y_w|^2.
    """
    y = np.where(np.isfinite(y), y, 0.0)
    end = data.zero + data.nonneg
    y[data.zero : end] = np.maximum(y[data.zero : end], 0.0)
    for block in data.blocks:
        k, rest = block.start, slice(block.start + 1 + block.rotated, block.start + block.size)
        y[k] = max(y[k], 0.0)
        norm = math.sqrt(float(y[rest] @ y[rest])) * (1.0 + STRICT * 0.25)
        if block.rotated:
            y[k + 1] = max(y[k + 1], 0.0)
            reach = 2.0 * math.sqrt(y[k]) * math.sqrt(y[k + 1])
        else:
            reach = y[k]
        if norm > reach * (1.0 - STRICT):
            y[rest] *= reach / norm * (1.0 - STRICT)
    return y


@np.errstate(all="ignore")
def lagrangian(
    data: Canonical, low: Array, high: Array, x: Array, y: Array, priced: bool = True
) -> Proof:
    """The least value of cost(x) + y.(A x - b) on the box; priced=False leaves the cost out.

    low, high (n,): finite where the gradient is not zero, else the bound is -inf.
    """
    x = np.clip(np.where(np.isfinite(x), x, 0.0), low, high)
    y = inside(data, y)
    row, column, value = data.entries
    c, P = (data.c, data.P) if priced else (0.0 * data.c, 0.0 * data.P)
    product = value * y[row]
    gradient = c + P @ x + np.bincount(column, product, len(x))
    sizes = np.abs(c) + abs(P) @ np.abs(x) + np.bincount(column, np.abs(product), len(x))
    weighted = y * data.b
    at = c @ x + 0.5 * x @ (P @ x) + np.bincount(column, product, len(x)) @ x - weighted.sum()
    reach = np.maximum(np.abs(high - x), np.abs(low - x))
    loss = np.where(gradient == 0.0, 0.0, np.minimum(gradient * (low - x), gradient * (high - x)))
    error = np.where(sizes == 0.0, 0.0, sizes * np.maximum(reach, np.abs(x)))
    allowance = (
        ROUNDING * (1.0 + max(len(x), len(y)) / 100.0) * (error.sum() + np.abs(weighted).sum())
    )
    shortfall, unit = data.convexity
    if priced and shortfall:
        allowance += 0.5 * shortfall * float(((reach / unit)[P.diagonal() != 0] ** 2).sum())
    offset = data.d if priced else 0.0
    least = at + offset + loss.sum() - allowance - ROUNDING * abs(offset)
    cost = c @ x + 0.5 * x @ (P @ x)
    proven = -math.inf if math.isnan(least) else float(least)
    return Proof(proven, float(-loss.sum()), abs(float(cost - at)), y)


@np.errstate(all="ignore")
def emptiness(data: Canonical, low: Array, high: Array, x: Array, y: Array) -> float:
    """How far the user's rows would have to be widened together, at least, for a point to exist.

    Proven where it is positive; -inf where nothing is known.
    """
    proof = lagrangian(data, low, high, x, y, priced=False)
    weights = np.abs(proof.weights)
    total = weights[data.label >= 0].sum()
    scale = total if total > 0 else float(weights @ (1.0 + np.abs(data.b)))
    return proof.least / scale if scale > 0 and math.isfinite(proof.least) else -math.inf
