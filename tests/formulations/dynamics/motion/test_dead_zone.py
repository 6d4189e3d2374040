"""The dead-zone oscillator of Kahraman and Singh, simulated: jumps, periods, a published set.

To compare with: an independent program with fixed steps (400 a period, 360 periods to settle, 40
recorded), which locates no separation: good to some 1e-5. Sweeps: `test_motions_over_speed`.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from moving_pairs import oscillator, steady

from gearopt.formulations.dynamics.motion.balance import orbit
from gearopt.formulations.dynamics.motion.integrate import march
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.physics.motion.stiffness_wave import fourier

TURN = 2.0 * math.pi
CASES = {  # zeta, F_a, share of the stiffness that changes
    "shaken": (0.05, 0.05, 0.0),
    "touching": (0.05, 0.01, 0.0),
    "lightly damped": (0.01, 0.0, 0.2),
}


def posed(name, speed):
    ratio, shake, depth = CASES[name]
    return oscillator(ratio, 0.1, shake, fourier(1.0, (depth,)) if depth else None, speed / TURN)


def test_a_jump_up_and_a_jump_down():
    """F_m 0.1, F_a 0.05: up from 0.82 to 0.83, down from 0.71 to 0.70."""
    speeds, found = (0.69, 0.70, 0.71, 0.72, 0.80, 0.82, 0.83), []
    for way in (1, -1):
        state, rows = np.array([-0.1, 0.0]), []
        for speed in speeds[::way]:
            rms, _, _, state = steady(posed("shaken", speed), 150, state, kept=5)
            rows.append(rms)
        found.append(rows[::way])
    apart = [abs(down / up - 1.0) > 0.02 for up, down in zip(*found, strict=True)]
    assert apart == [False, False, True, True, True, True, False]
    linear = 0.05 * 0.82**2 / abs(1.0 - 0.82**2 + 0.082j) / math.sqrt(2.0)  # in contact
    assert found[0][5:] == pytest.approx([linear, 0.18940], rel=3e-5)
    assert found[1][3:5] == pytest.approx([0.23576, 0.20226], rel=3e-5)


def test_separated_motions_of_both_branches():
    """Down at W = 0.75; up at 0.7, in contact: 0.0336533382."""
    state = np.array([-0.1, 0.0])
    for speed in (1.0, 0.9, 0.83, 0.79, 0.75):
        rms, least, most, state = steady(posed("shaken", speed), 150, state, 500, 2)
    assert rms == pytest.approx(0.2247238, rel=2e-6)
    assert (1.0 - least, 1.0 - most) == pytest.approx((1.353042, 0.716349), abs=2e-5)
    low = steady(posed("shaken", 0.7), 250, np.array([-0.1, 0.0]))
    assert low[0] == pytest.approx(0.0336533382, rel=1e-8) and low[2] < 0.0


def test_contact_that_is_lost_by_touching():
    """RMS F_a W^2/(2 zeta W)/sqrt(2) at W = 1: the amplitude is F_m, the largest delta 0."""
    rms, _, most, _ = steady(posed("touching", 1.0), 300, np.array([-0.1, 0.0]))
    assert rms == pytest.approx(0.1 / math.sqrt(2.0), rel=1e-9)
    assert most == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("speed", "periods"), [(1.9, 2), (0.8, 2), (0.7, 1), (0.5, 1)])
def test_a_lightly_damped_motion_with_separation_takes_one_period_or_two(speed, periods):
    """From above twice the natural frequency down: period 2 from 2.09 to 0.8, then period 1."""
    start = {1.9: (0.07, -0.01), 0.8: (1.83, -0.14), 0.7: (-0.29, 0.2), 0.5: (0.24, 0.41)}[speed]
    known = {1.9: 0.11554, 0.8: 0.87245, 0.7: 0.25482, 0.5: 0.54012}[speed]
    pair = posed("lightly damped", speed)
    rms, _, most, state = steady(pair, 400, np.array(start))
    assert rms == pytest.approx(known, rel=1e-4) and most > 0.05
    times = timeline(pair, np.arange(3) / pair.mesh_frequency, False)
    after = march(pair, "fixed", times, "rk8", 0.02 / pair.mesh_frequency, state).states[1:]
    back = np.max(np.abs(after - state), axis=1) < 1e-5
    assert list(back) == [periods == 1, True]


def test_public_parameters_of_a_wind_gearbox():
    """Three harmonics of stiffness and of error, W = 0.5: contact is lost in every period."""
    wave = fourier(1.0, (-0.2, -0.1, -0.05))
    pair = replace(oscillator(0.05, 0.1, 0.0, wave, 0.5 / TURN), error=(0.01, 0.004, 0.002))
    rms, least, most, state = steady(pair, 60, np.array([1.0, 0.0]), 500, 1)
    assert rms == pytest.approx(0.090335, rel=2e-5)
    assert (1.0 - least, 1.0 - most) == pytest.approx((1.242393, 0.951038), abs=2e-5)
    times = np.linspace(0.0, 1.0, 501) / pair.mesh_frequency
    again = march(pair, "fixed", timeline(pair, times, False), "rk8", 0.4, state)
    assert 1.0 - again.delta[:-1].mean() == pytest.approx(1.092864, abs=2e-6)
    assert again.states[-1] == pytest.approx(state, abs=5e-10)  # of period 1
    natural = math.sqrt(3.8e5 / 2.3e-4)  # rad/s
    assert (natural, natural / TURN) == pytest.approx((40646.94223, 6469.16), rel=1e-6)
    found = orbit(pair, "fixed", 0.5 / TURN, 40)
    assert found.found and found.rms == pytest.approx(rms, rel=3e-5)
