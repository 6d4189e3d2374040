"""Motions to an error that is asked, of teeth that part for less than a step."""

import math

import numpy as np
import pytest
from moving_pairs import paper_pair

from gearopt.formulations.motion.simulate import simulate


@pytest.mark.parametrize("over", [5e-4, 2e-2])
def test_the_error_told_is_kept_and_separations_are_counted(over):
    """Swings to `over` times the static compression beyond contact: flights of closed form.

    x'' = -x - 1 in contact (units of 1/omega and F/k): from -2 - over at rest it leaves at the time
    pi - acos(1/(1 + over)) with the rate r = (2 over + over^2)^(1/2), and flies for 2 r.
    """
    pair = paper_pair(backlash=1.0)
    still, omega = pair.load / 2e5, math.sqrt(2e5 * 3400.0)
    rate = math.sqrt(2.0 * over + over**2)
    period = 2.0 * (math.pi - math.acos(1.0 / (1.0 + over)) + rate) / omega
    low, high = -(2.0 + over) * still, 0.5 * rate**2 * still
    times, known = period * np.array([0.0, 5.0, 10.0, 20.5, 40.0]), [low, low, low, high, low]
    for asked in (1e-3, 1e-7):
        made = simulate(pair, "fixed", times, asked, np.array([low, 0.0]))
        off = np.max(np.abs(made.motion.delta - known)) / -low
        assert made.met and off <= max(made.error, 1e-10)
    assert made.motion.events == 80
