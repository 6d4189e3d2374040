"""Harmonic balance against time simulation, closed forms and the dead-zone oscillator."""

import math
from dataclasses import replace

import numpy as np
import pytest
from moving_pairs import oscillator, paper_pair, steady

from gearopt.formulations.motion.balance import linear_orbit, orbit
from gearopt.formulations.motion.integrate import march
from gearopt.formulations.motion.timeline import timeline
from gearopt.physics.motion.moving_pair import damping_of
from gearopt.physics.motion.stiffness_wave import fourier, trapezoid

TURN = 2.0 * math.pi


def test_linear_oscillator():
    """RMS F_a W^2/|1 - W^2 + 2 i zeta W|/sqrt(2), in contact throughout."""
    made = orbit(oscillator(0.05, 0.1, 0.01), "fixed", 0.5 / TURN, 6)
    assert made.rms == pytest.approx(0.00235180217, rel=1e-8)
    assert made.harmonics[0].real == pytest.approx(-0.1) and made.extremes[1] < 0.0
    touching = orbit(oscillator(0.05, 0.1, 0.01), "fixed", 1.0 / TURN, 6)
    assert touching.rms == pytest.approx(0.1 / math.sqrt(2.0), rel=1e-9)
    assert touching.extremes[1] == pytest.approx(0.0, abs=1e-9)  # contact is lost by touching
    low = orbit(oscillator(0.05, 0.1, 0.05), "fixed", 0.7 / TURN, 10)
    assert low.rms == pytest.approx(0.0336533382, rel=1e-8)


WEAK = {  # zeta, eps: amplitude by an independent program, which reads it off 400 points a period
    (0.05, 1e-3): 0.00999999935,
    (0.01, 1e-3): 0.0499999967,
    (0.002, 1e-3): 0.2499999835,
    (0.05, 1e-2): 0.0999993472,
    (0.01, 1e-2): 0.499997136,
    (0.002, 1e-2): 2.50003775,
}


@pytest.mark.parametrize(("ratio", "depth"), list(WEAK))
def test_weak_modulation_near_resonance(ratio, depth):
    """x'' + 2 zeta x' + (1 + eps cos t) x = 1: amplitude eps/(2 zeta), to second order in eps."""
    pair = replace(oscillator(ratio, 1.0, 0.0, fourier(1.0, (depth,))), backlash=None)
    made = linear_orbit(pair, "fixed", 1.0 / TURN, 12)
    amplitude = np.ptp(made.delta(4000)) / 2.0
    first = depth / (2.0 * ratio)
    assert amplitude == pytest.approx(first, rel=1e-7 if depth < 1e-2 else 3e-5)
    assert amplitude == pytest.approx(WEAK[ratio, depth], rel=1e-5)
    if (ratio, depth) == (0.002, 1e-2):
        pair = replace(pair, mesh_frequency=1.0 / TURN)
        _, least, most, _ = steady(pair, 1500, np.array([-1.0, 0.0]), 4000, 1)
        assert 0.5 * (most - least) == pytest.approx(amplitude, rel=1e-6)


def test_at_rest_the_balance_is_static():
    """A mesh frequency that tends to zero: delta = -F/k, of the RMS of F/k."""
    wave = fourier(2e5, (4e4, 1e4), (2e4,))
    pair = paper_pair("tangent", kx=1e5, wave=wave, torques=(2e5, 8e5 / 3.0))
    made = linear_orbit(pair, "line", 0.01, 30)
    phase = np.arange(64) / 64
    assert made.delta(64) == pytest.approx(-pair.load / wave.value(phase), rel=1e-8)
    known = pair.load / wave.value(np.arange(256) / 256)
    assert made.rms == pytest.approx(known.std(), rel=1e-8)


@pytest.mark.parametrize("level", ["fixed", "line", "plane"])
def test_linear_orbits_are_where_simulations_end(level):
    wave = trapezoid(2e5, 0.5, 0.6, 0.1)
    pair = paper_pair(
        "tangent", kx=1e5, wave=wave, frequency=1500.0, torques=(2e5, 8e5 / 3.0), bearing=0.5
    )
    pair = replace(pair, damping=damping_of(0.03, 2e5, pair.mesh_mass))
    made = linear_orbit(pair, level, 1500.0, 40)
    size = {"fixed": 1, "line": 3, "plane": 5}[level]
    times = np.arange(64 * 200 + 1) / (64 * 1500.0)
    run = march(pair, level, timeline(pair, times), "rk8", 1.2e-5, np.zeros(2 * size))
    assert made.delta(64) == pytest.approx(run.delta[-65:-1], rel=1e-4)
    again = orbit(replace(pair, backlash=1.0), level, 1500.0, 40)
    assert again.rms == pytest.approx(made.rms, rel=1e-4) and again.found


def test_newton_that_does_not_end_is_said():
    made = orbit(oscillator(0.05, 0.1, 5.0), "fixed", 0.3 / TURN, 3)
    assert not made.found
