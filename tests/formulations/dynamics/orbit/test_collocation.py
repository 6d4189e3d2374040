"""Collocated motions against closed forms, an independent program's table, and their orders."""

import math
from itertools import pairwise

import numpy as np
import pytest
from collocated_oscillator import at_phase_zero, oscillator, partings, posed, started

from gearopt.formulations.dynamics.orbit.collocation import gauss
from gearopt.optimise.solve import solve

DOWN = (0.9, 0.85, 0.8, 0.77, 0.75)  # falling speeds, which keep the motion that parts
PARTING = 0.22472379317  # RMS at W = 0.75 by simulation; 0.2247238 of an independent program


def reached(pair, elements, points, width, state=None, periods=1):
    """Return the RMS of a collocated motion, and delta at element starts.

    elements: equal ones of a period, or the shares of it at which they end.
    """
    state = at_phase_zero([pair]) if state is None else state
    ends = np.linspace(0.0, 1.0, elements + 1) if isinstance(elements, int) else elements
    problem = posed(pair, ends, points, width, periods)
    made = solve(started(problem, pair, ends, points, state, periods))
    assert made.status in ("stationary", "feasible")
    places = next(np.array(v) for k, v in made.design.items() if "places" in k)
    return 1e-3 * made.value, 1e-3 * places


def test_the_method_of_gauss():
    """Two points: 1/2 -+ sqrt(3)/6, and the table of Hammer and Hollingsworth."""
    made, r = gauss(2), math.sqrt(3.0) / 6.0
    assert made.points == pytest.approx([0.5 - r, 0.5 + r]) and made.weights == pytest.approx(0.5)
    assert made.inner == pytest.approx(np.array([[0.25, 0.25 - r], [0.25 + r, 0.25]]))
    three = gauss(3)
    assert three.weights == pytest.approx(np.array([5.0, 8.0, 5.0]) / 18.0)


@pytest.mark.slow
@pytest.mark.parametrize("points", [2, 3])
def test_orders_in_contact(points):
    """RMS F_a W^2/|1 - W^2 + 2 i zeta W|/sqrt(2) at W = 0.7, to the order 2 S."""
    pair, w = oscillator(0.05, 0.7, (0.05,)), 0.7
    exact = 0.05 * w**2 / abs(1.0 - w**2 + 0.1j * w) / math.sqrt(2.0)
    assert exact == pytest.approx(0.0336533382, rel=1e-8)
    errors = [abs(reached(pair, n, points, 1e-3)[0] / exact - 1.0) for n in (5, 10, 20)]
    slopes = -np.diff(np.log2(errors))
    assert slopes == pytest.approx(2.0 * points, abs=0.3)
    assert errors[-1] < (3e-5 if points == 2 else 2e-8)


@pytest.mark.slow
def test_a_motion_that_parts():
    """F_a 0.05, W = 0.75, falling: RMS 0.2247238, largest 1.353042, least 0.716349."""
    pair = oscillator(0.05, 0.75, (0.05,))
    state = at_phase_zero([oscillator(0.05, w, (0.05,)) for w in DOWN])
    rms, places = reached(pair, 80, 3, 0.1, state)
    assert rms == pytest.approx(0.2247238, rel=3e-5)
    assert 1.0 - places.min() == pytest.approx(1.353042, abs=5e-4)
    assert 1.0 - places.max() == pytest.approx(0.716349, abs=5e-4)
    wide, narrow = (reached(pair, 80, 3, w, state)[0] / PARTING - 1.0 for w in (10.0, 5.0))
    assert math.log2(wide / narrow) == pytest.approx(2.0, abs=0.2)  # by the width, squared


@pytest.mark.slow
def test_order_of_a_rounded_corner():
    """Where elements resolve the corner the order is 6; where they do not, 2 at least."""
    pair = oscillator(0.05, 0.75, (0.05,))
    state = at_phase_zero([oscillator(0.05, w, (0.05,)) for w in DOWN])
    found = np.array([reached(pair, n, 3, 200.0, state)[0] for n in (12, 24, 72)])
    errors = np.abs(found[:2] / found[2] - 1.0)
    assert math.log2(errors[0] / errors[1]) > 5.0
    sharp = [abs(reached(pair, n, 3, 0.1, state)[0] / PARTING - 1.0) for n in (8, 64)]
    assert sharp[0] / sharp[1] > 8.0**2 / 4.0  # the place of a corner in its element counts


@pytest.mark.slow
def test_published_parameters_and_two_periods():
    """W = 0.5, three harmonics of stiffness and error: RMS 0.09033; the same over two periods."""
    pair = oscillator(0.05, 0.5, (0.01, 0.004, 0.002), (-0.2, -0.1, -0.05))
    state = at_phase_zero([pair])
    once = reached(pair, 60, 3, 0.3, state)[0]
    assert once == pytest.approx(0.09033, abs=1e-5)
    assert reached(pair, 30, 3, 0.3, state, 2)[0] == pytest.approx(once, rel=2e-3)


@pytest.mark.slow
def test_ends_of_elements_where_teeth_part():
    """Elements that end where teeth part and meet have the order 6 again, at any corner."""
    pair = oscillator(0.05, 0.75, (0.05,))
    state = at_phase_zero([oscillator(0.05, w, (0.05,)) for w in DOWN])
    moments, errors = partings(pair, state), []
    assert len(moments) == 2
    for count in (3, 6):
        marks = [0.0, *moments, 1.0]
        parts = [np.linspace(a, b, count + 1)[:-1] for a, b in pairwise(marks)]
        ends = np.append(np.concatenate(parts), 1.0)
        errors.append(abs(reached(pair, ends, 3, 0.01, state)[0] / PARTING - 1.0))
    assert errors[0] / errors[1] > 2.0**5 and errors[1] < 1e-6
