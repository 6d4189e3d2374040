"""A lower bound for a law that is convex in log-log, from its values beside a point.

Whatever formula gave the point: where the law is not lower one step to the left and one to the
right, convexity keeps the rest above, and secants through the steps bound what lies between.
"""

import math
from collections.abc import Callable

STEP = 1e-5  # of the logarithm: the bound is below the value by half the curvature times 1e-10
DOUBT = 1e-14  # relative rounding of a law


def convex_bound(
    law: Callable[[float], float],
    at: float,
    low: float,
    high: float,
    room: float = 1.0,
    share: float = 1.0,
) -> float | None:
    """Return a lower bound of law > 0 on [low, high]; None where the point is no minimum.

    law: convex in log-log on its domain, infinite or NaN outside; at: the point. room: its relative
    distance from the end of the domain, at most 1, which makes steps as much shorter; what vanishes
    there, and is rounded as much more, has a share in the law.
    """

    def rise(steps: float) -> float:
        """Return log(law/value) some steps beside the point; infinite outside the domain."""
        there = law(at * math.exp(steps * STEP * room))
        return math.log(there / value) if 0.0 < there < math.inf else math.inf

    def side(sign: float, width: float) -> float:
        """Return the minimum rise on one side within a factor `width`; -inf: not known."""
        if width <= 1.0:
            return math.inf
        back, one, two = (rise(sign * k) for k in (-1.0, 1.0, 2.0))
        if one < 0.0 and math.log(width) > STEP * room:
            return -math.inf
        lines = (-back, min(2.0 * one - two, one))  # the least of each secant on one step
        return max((s for s in lines if math.isfinite(s)), default=-math.inf)

    value = law(at)
    if not 0.0 < value < math.inf or at * math.exp(STEP * room) <= at:
        return None  # also where rounding swallows a step: it would show nothing
    least = min(side(-1.0, at / low), side(1.0, high / at))
    if least == -math.inf:
        return None
    return value * math.exp(min(least, 0.0) - 4.0 * DOUBT * (1.0 + share / room))
