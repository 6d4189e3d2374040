"""Numbers at ends of their ranges, and what wider ranges give."""

from dataclasses import replace

import numpy as np
import pytest

from gearopt.formulations.strain_wave.demand import FREE
from gearopt.formulations.strain_wave.exchange import WIDER, ends_of, exchange, slopes_of
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Terms, Var
from gearopt.scenes.reading.load import read
from gearopt.scenes.strain_wave import KIND as WAVES

FROM_DUTY = WAVES.examples["strain-wave-from-duty"].text

RANGES = dict.fromkeys(FREE, (0.0, 2.0)) | {"module": (0.5, 0.5)}


def posed(shift=2.0):
    """Least (x - 3)^2 + (a + 1)^2 with x + a >= 1: at x = shift and a = 0, the ends of both."""

    def evaluate(x, p):
        cost = (x.profile_shift - 3.0) ** 2 + (x.addendum + 1.0) ** 2 + 1.0
        return Terms({"cost": cost}, {"sum": 2.0 - x.profile_shift - x.addendum})

    variables = Var("profile_shift", "", 0.0, shift, 1.0), Var("addendum", "", 0.0, 2.0, 1.0)
    return Problem("two ranges", variables, (), evaluate)


def test_slopes_are_what_moved_ends_give():
    """d/dx (x - 3)^2 = -2 at 2, d/da (a + 1)^2 = 2 at 0; the end of x moved and solved again."""
    found = slopes_of(posed(), np.array([2.0, 0.0]))
    assert found == pytest.approx({"profile_shift": -2.0, "addendum": 2.0}, abs=1e-9)
    moved = [solve(posed(2.0 + d), method="ipopt").value for d in (-1e-3, 1e-3)]
    assert (moved[1] - moved[0]) / 2e-3 == pytest.approx(found["profile_shift"], abs=1e-5)


def test_ends_are_in_order_of_what_they_give():
    slopes = {"profile_shift": -2.0, "addendum": 3.0, "rim": 1.0}
    numbers = [2.0, 1.0, 0.7, 0.0, 1.0, 0.5]
    first, second = ends_of(RANGES, np.array(numbers), slopes)
    assert (first.name, first.least, second.name, second.least) == (
        *("addendum", True),
        *("profile_shift", False),
    )
    assert (first.gain, second.gain) == pytest.approx((3.0 * WIDER * 2.0, 2.0 * WIDER * 2.0))
    (alone, _) = ends_of(RANGES, np.array(numbers), {})
    assert alone.gain is None


@pytest.mark.slow
def test_wider_ranges_of_a_gearing_give_what_is_told():
    """Each end moved by a hundredth of its range and all solved again, clear at all poses."""
    own = read(FROM_DUTY.encode())[1]
    demand, start = own.demand(), own.start()
    found = exchange(demand, start, Clock())
    slopes = slopes_of(found.problem, found.outcome.x)
    ends = ends_of(demand.ranges, found.outcome.x[: len(FREE)], slopes)
    assert {end.name for end in ends} == {"deflection", "addendum", "rim", "profile_shift"}
    for end in ends:
        low, high = demand.ranges[end.name]
        by = 0.01 * (high - low)
        moved = (low - by, high) if end.least else (low, high + by)
        wider = replace(demand, ranges={**demand.ranges, end.name: moved})
        other = exchange(wider, found.outcome.x[: len(FREE)], Clock())
        lower = (found.result.value - other.result.value) * WIDER / 0.01
        assert lower == pytest.approx(end.gain, rel=0.02)
