"""Harmonic balance against time simulation, closed forms and tables of the dead-zone oscillator."""

import math
from dataclasses import replace

import numpy as np
import pytest
from moving_pairs import oscillator, paper_pair

from gearopt.formulations.motion.balance import linear_orbit, orbit
from gearopt.formulations.motion.integrate import march
from gearopt.formulations.motion.timeline import timeline
from gearopt.physics.motion.moving_pair import damping_of
from gearopt.physics.motion.stiffness_wave import fourier, trapezoid

TURN = 2.0 * math.pi


def steady(pair, periods, state, points=200, kept=10):
    """RMS of delta about its mean, its extremes and the last state, by RK8 with located events."""
    period = 1.0 / pair.mesh_frequency
    times = np.linspace(0.0, (periods + kept) * period, (periods + kept) * points + 1)
    made = march(pair, "fixed", timeline(pair, times, False), "rk8", period / 40.0, state)
    delta = made.delta[-kept * points :]
    return delta.std(), delta.min(), delta.max(), made.states[-1]


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


def test_public_parameters_of_a_wind_gearbox():
    """Three harmonics of stiffness and of error, W = 0.5: contact is lost in every period."""
    wave = fourier(1.0, (-0.2, -0.1, -0.05))
    pair = replace(oscillator(0.05, 0.1, 0.0, wave, 0.5 / TURN), error=(0.01, 0.004, 0.002))
    rms, least, most, _ = steady(pair, 50, np.array([1.0, 0.0]), 500, 2)
    assert rms == pytest.approx(0.090335, rel=2e-5)
    assert 1.0 - least == pytest.approx(1.242393, abs=2e-5)
    assert 1.0 - most == pytest.approx(0.951038, abs=2e-5)
    assert math.sqrt(3.8e5 / 2.3e-4) == pytest.approx(40646.94, rel=1e-6)
    found = orbit(pair, "fixed", 0.5 / TURN, 40)
    assert found.found and found.rms == pytest.approx(rms, rel=3e-5)


@pytest.mark.parametrize(("ratio", "depth"), [(0.05, 1e-3), (0.01, 1e-3), (0.002, 1e-3)])
def test_weak_modulation_near_resonance(ratio, depth):
    """x'' + 2 zeta x' + (1 + eps cos t) x = 1: amplitude eps/(2 zeta)."""
    pair = oscillator(ratio, 1.0, 0.0, fourier(1.0, (depth,)))
    made = linear_orbit(replace(pair, backlash=None), "fixed", 1.0 / TURN, 5)
    assert np.ptp(made.extremes) / 2.0 == pytest.approx(depth / (2.0 * ratio), rel=1e-4)


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
