"""Motions to an error that is asked, of teeth that part for less than a step."""

import math
from dataclasses import replace

import numpy as np
import pytest
from moving_pairs import paper_pair

from gearopt.formulations.dynamics.motion.simulate import simulate
from gearopt.physics.motion.moving_pair import MovingPair, Rotor, damping_of
from gearopt.physics.motion.stiffness_wave import trapezoid


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


def test_more_accuracy_never_gives_less_where_impacts_enlarge_rounding():
    """150 impacts in 15 ms: matrix exponentials of 40 digits, impacts located to 1e-38 s.

    A start moved by 1e-16 mm ends 1e-5 mm away: no steps in doubles reach 1e-6.
    """
    known = {  # mm, by number of the output
        **{100: -0.00032296327653940016, 300: -0.005102929948334773, 400: 0.0064267502048121145},
        **{540: -0.005668619406572759, 559: 0.005058665604788158, 600: -0.0024021722939660158},
    }
    gears = (50.0, 5e-4, 1.2, 8e4, 15e3), (75.0, 1.1e-3, 5.0, 1.2e5, 22.5e3)
    pinion, wheel = (
        Rotor(r, m, i, (k, k), (damping_of(0.005, k, m),) * 2, t) for r, m, i, k, t in gears
    )
    wave, frequency = trapezoid(3e5, 0.7, 0.5), 28 * 8200 / 60
    pair = MovingPair(pinion, wheel, math.radians(20.0), wave, frequency, backlash=6e-3)
    damping = damping_of(0.01, wave.mean, pair.mesh_mass)
    pair, times = replace(pair, damping=damping), np.linspace(0.0, 15e-3, 601)
    at, right = np.array(list(known)), np.array(list(known.values()))
    offs = []
    for asked in (2e-2, 1e-4, 1e-6):
        made = simulate(pair, "line", times, asked)
        assert made.motion.events == 150 and made.met == (asked == 2e-2)
        offs.append(
            np.max(np.abs(made.motion.delta[at] - right)) / np.max(np.abs(made.motion.delta))
        )
        assert offs[-1] <= made.error < 2e-2 and made.rates < 1e6
    assert offs[2] <= offs[1] and made.steady < 10e-3
