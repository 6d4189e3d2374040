"""Numbers of a design that lie at the ends of their ranges, and what wider ranges would give."""

from collections.abc import Mapping
from dataclasses import dataclass

from gearopt.formulations.strain_wave.demand import FREE
from gearopt.optimise.dual import multipliers
from gearopt.optimise.form import form
from gearopt.optimise.problem import Problem
from gearopt.optimise.stationarity import evaluated
from gearopt.optimise.terms import Array

WIDER = 0.1  # of a range, by which it is thought to be wider
AT_END = 1e-6  # of a range, within which its end counts as reached


@dataclass(frozen=True, kw_only=True)
class RangeEnd:
    """A number at an end of its range, in its own unit; least: whether that is the lower end.

    gain: how much less the objective would be if the range reached WIDER of its width further, to
    first order; None where no multipliers are known.
    """

    name: str
    value: float
    least: bool
    gain: float | None = None


def ends_of(
    ranges: Mapping[str, tuple[float, float]], numbers: Array, slopes: Mapping[str, float]
) -> tuple[RangeEnd, ...]:
    """Return the numbers (6,) in the order of FREE that are at ends of ranges, greatest gain first.

    slopes: d objective/d number with the limits held, as `slopes_of` has them; may be empty.
    """
    found = []
    for name, value in zip(FREE, map(float, numbers), strict=True):
        low, high = ranges[name]
        width = high - low
        if not width:
            continue
        for end, sign in ((low, 1.0), (high, -1.0)):
            if abs(value - end) <= AT_END * width:
                gain = sign * slopes[name] * WIDER * width if name in slopes else None
                found.append(RangeEnd(name=name, value=end, least=sign > 0.0, gain=gain))
    return tuple(sorted(found, key=lambda e: -(e.gain or 0.0)))


def slopes_of(problem: Problem, x: Array) -> dict[str, float]:
    """Return d objective/d number of a stationary point, limits held: the prices of its ranges.

    Slopes of the Lagrangian, whose multipliers are computed from the point's gradients. Empty where
    there are none.
    """
    shape = form(problem)
    low, high, y = (shape.to_y(v) for v in (*problem.bounds()[:2], x))
    found = multipliers(shape, y, problem.parameter_values(), low, high)
    if found is None:
        return {}
    point = evaluated(problem, shape, y, low, high, *found)
    unit = shape.objective(point.f) if shape.log_objective else 1.0
    names = [variable.name for variable, _ in problem.columns]
    each = zip(names, shape.logarithmic, x, point.gradient, strict=True)
    return {n: float(unit * g / (v if log else 1.0)) for n, log, v, g in each if n in FREE}
