"""A lower bound for a law that is convex in log-log, from its values beside a point.

Whatever formula gave the point: where the law is not lower one step to the left and one to the
right, convexity keeps the rest above, and secants through the steps bound what lies between.
"""

import math
from collections.abc import Callable

STEP = 1e-5  # of the logarithm: the bound is below the value by half the curvature times 1e-10
DOUBT = 1e-14  # relative rounding of a law


def convex_bound(
    law: Callable[[float], float], at: float, low: float, high: float, doubt: float = DOUBT
) -> float | None:
    """Lower bound of law > 0 on [low, high], or None where the point is no minimum.

    law: convex in log-log on its domain, infinite or NaN outside; at: the point; doubt: relative
    rounding of the law there.
    """
    left = _side(law, at, -1.0, at / low)
    right = _side(law, at, 1.0, high / at)
    least = min(left, right)
    if not math.isfinite(least) and least != math.inf:
        return None
    value = law(at)
    return value * math.exp(min(least, 0.0) - 4.0 * doubt) if math.isfinite(value) else None


def _side(law: Callable[[float], float], at: float, sign: float, width: float) -> float:
    """Least of log(law/law(at)) on one side that reaches to a factor `width`; -inf: not known."""
    if width <= 1.0:
        return math.inf
    value = law(at)
    back, one, two = (_log(law, at, sign * k, value) for k in (-1.0, 1.0, 2.0))
    if one < 0.0 and math.log(width) > STEP:
        return -math.inf
    inside = [-back, 2.0 * one - two]
    return max((s for s in inside if math.isfinite(s)), default=-math.inf)


def _log(law: Callable[[float], float], at: float, steps: float, value: float) -> float:
    """log(law/value) some steps beside a point; infinite outside the domain."""
    there = law(at * math.exp(steps * STEP))
    return math.log(there / value) if 0.0 < there < math.inf else math.inf
