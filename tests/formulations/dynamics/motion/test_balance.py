"""Harmonic balance against time simulation, closed forms and the dead-zone oscillator."""

import math
from dataclasses import replace

import numpy as np
import pytest
from moving_pairs import oscillator, paper_pair

from gearopt.formulations.dynamics.motion.balance import linear_orbit, orbit
from gearopt.formulations.dynamics.motion.integrate import march
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.physics.motion.moving_pair import damping_of
from gearopt.physics.motion.stiffness_wave import trapezoid

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


@pytest.mark.parametrize("level", ["fixed", "plane"])
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
