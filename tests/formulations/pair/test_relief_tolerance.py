"""Relief as it is made: proven worst cases against samples; nominal values that allow for it."""

import numpy as np
import pytest
from relief_pairs import mesh

from gearopt.formulations.pair.relief.meshing import Relief
from gearopt.formulations.pair.relief.parametric import Ranges, at_point
from gearopt.formulations.pair.relief.relief_tolerance import (
    Tolerance,
    drawn,
    robust_problem,
    worst,
)
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve

MADE = mesh((0.6, 1.0))
NOMINAL = Relief(11.7e-3, 4.16), Relief(13.5e-3, 4.75)


def value(point, exponent=1.0):
    """Worst peak-to-peak [mm] of a point, by numpy's closed form."""
    ranges = Ranges((0.0, 1.0), (0.1, 10.0), (exponent, exponent))
    made = MADE.separations(*at_point(np.asarray(point), ranges))
    return float(MADE.criteria(made).peak_to_peak.max())


@pytest.mark.parametrize("exponent", [1.0, 2.0])
@pytest.mark.parametrize("tolerance", [Tolerance(1e-3), Tolerance(2e-3, 0.3), Tolerance(6e-3, 1.0)])
def test_the_worst_case_is_reached_and_never_exceeded(tolerance, exponent):
    """Its point is within the tolerances and has the value; no corner and no sample is worse."""
    nominal = tuple(Relief(r.amount, r.length, exponent) for r in NOMINAL)
    found = worst(MADE, nominal, tolerance)
    x = np.array([11.7e-3, 13.5e-3, 4.16, 4.75])
    low = np.maximum(x - tolerance.widths, [0.0, 0.0, 0.0, 0.0])
    assert (found.point >= low - 1e-9).all() and (found.point <= x + tolerance.widths + 1e-9).all()
    assert value(found.point, exponent) == pytest.approx(found.value, rel=1e-9)
    assert found.value <= found.bound <= found.value * 1.0011
    sample = drawn(MADE, nominal, tolerance, 500, 0)
    corners = np.array(np.meshgrid(*[(-1.0, 1.0)] * 4)).reshape(4, -1).T
    corners = [value(np.maximum(x + k * tolerance.widths, 0.0), exponent) for k in corners]
    assert max(sample.max(), *corners) <= found.bound
    assert found.value > value(x, exponent) and sample.min() > 0.0


def test_lengths_stay_at_a_thousandth_of_their_own_nominal():
    found = Tolerance(20e-3, 5.0).moved([11.7e-3, 13.5e-3, 4.16, 4.75], -1.0)
    assert found == pytest.approx([0.0, 0.0, 4.16e-3, 4.75e-3], rel=1e-12)


def test_no_tolerance_is_the_nominal_value():
    found = worst(MADE, NOMINAL, Tolerance(0.0))
    x = [11.7e-3, 13.5e-3, 4.16, 4.75]
    assert found.value == pytest.approx(value(x), rel=1e-9) and found.bound < found.value * 1.0011
    early = worst(MADE, NOMINAL, Tolerance(5e-3, 1.0), Budget(evaluations=4))
    assert early.boxes == 4 and early.bound > early.value
    gaps = (worst(MADE, NOMINAL, Tolerance(6e-3, 1.0), Budget(gap=g)) for g in (0.2, 1e-3))
    rough, fine = gaps
    assert rough.boxes < fine.boxes and fine.bound <= rough.bound <= 1.2 * rough.value + 1e-12
    told = []
    stopped = worst(MADE, NOMINAL, Tolerance(5e-3, 1.0), watch=lambda e: bool(told.append(e)))
    assert stopped is None or (stopped.boxes == 0 and stopped.bound > stopped.value)
    assert len(told) == 1


def test_a_nominal_relief_that_allows_for_tolerances():
    """Better in the worst case than the best one without any; worse where it is met exactly."""
    tolerance, ranges = Tolerance(2e-3), Ranges.of(MADE)
    posed = robust_problem(MADE, ranges, tolerance)
    found = solve(posed, "annealing", Budget(evaluations=1500), seed=1)
    x = np.array([*found.design["amount_mm"], *found.design["length_mm"]])
    assert found.value >= value(x) == pytest.approx(found.report["nominal"], rel=1e-9)
    whole = worst(MADE, at_point(x, ranges), tolerance)
    assert found.value <= whole.bound and whole.value < worst(MADE, NOMINAL, tolerance).value
