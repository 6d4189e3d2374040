"""Harmonic balance against time simulation, closed forms and tables of the dead-zone oscillator."""

import math
from dataclasses import replace

import numpy as np
import pytest
from moving_pairs import paper_pair

from gearopt.formulations.motion.balance import branch, linear_orbit, orbit
from gearopt.formulations.motion.integrate import march
from gearopt.formulations.motion.timeline import timeline
from gearopt.physics.motion.moving_pair import MovingPair, Rotor, damping_of
from gearopt.physics.motion.stiffness_wave import constant, fourier, trapezoid

TURN = 2.0 * math.pi


def oscillator(ratio, load, shake=0.0, wave=None, frequency=0.1):
    """x'' + 2 zeta x' + k(t) f(x) = F_m + F_a W^2 cos W t with a gap of 2, as a pair of unit mass.

    x = 1 - delta: contact at x > 1, apart between -1 and 1.
    """
    rotor = Rotor(1.0, 1.0, 2.0, (1.0, 1.0), torque=load)
    mesh = constant(1.0) if wave is None else wave
    return MovingPair(
        rotor, rotor, 0.3, mesh, frequency, drag=2.0 * ratio, backlash=2.0, error=(shake,)
    )


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


@pytest.mark.slow
def test_the_branch_folds_where_sweeps_jump():
    """F_m 0.1, F_a 0.05: up to 0.82 in contact, above it and down to 0.71 with separation."""
    pair = oscillator(0.05, 0.1, 0.05)
    made = list(branch(pair, "fixed", (0.3 / TURN, 1.5 / TURN), 16, 0.08))
    speed = np.array([o.frequency for o in made]) * TURN
    rms = np.array([o.rms for o in made])
    turn = int(np.argmax(np.diff(speed) < 0.0))
    back = turn + int(np.argmax(np.diff(speed[turn:]) > 0.0))
    assert 0.82 < speed[turn] < 0.83 and 0.70 < speed[back] < 0.71
    upper = np.interp([0.72, 0.8, 0.83, 0.9, 1.0, 1.2], speed[back:], rms[back:])
    known = [0.23576, 0.20226, 0.18940, 0.16286, 0.13308, 0.09421]  # down-sweep, and up from 0.83
    assert upper == pytest.approx(known, rel=3e-3)  # a line between two points of the branch
    lower = np.interp([0.5, 0.7, 0.8], speed[: turn + 1], rms[: turn + 1])
    assert lower == pytest.approx([0.011759, 0.033653, 0.061357], rel=5e-3)
    separated = orbit(pair, "fixed", 0.75 / TURN, 60, made[back + 8])
    assert separated.rms == pytest.approx(0.2247238, rel=2e-6)
    assert 1.0 - separated.extremes[0] == pytest.approx(1.353042, abs=2e-5)
    assert 1.0 - separated.extremes[1] == pytest.approx(0.716349, abs=2e-5)


SWEEPS = {  # zeta, F_a, stiffness: W and RMS of the peak up and down, range of two solutions
    "shaken": (0.05, 0.05, None, (0.83, 0.18940), (0.72, 0.23576), (0.71, 0.82)),
    "touching": (0.05, 0.01, None, (1.00, 0.070711), (1.00, 0.070711), None),
    "stiffness": (0.05, 0.0, 0.2, (0.91, 0.12247), (0.84, 0.14721), (0.84, 0.90)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SWEEPS))
def test_sweeps_up_and_down(name):
    ratio, shake, wave, up, down, two = SWEEPS[name]
    mesh = None if wave is None else fourier(1.0, (wave,))
    grid = np.round(np.arange(0.65, 1.1001, 0.01), 2)
    found = {}
    for way in (1, -1):
        state = np.array([-0.1, 0.0])
        rows = []
        for w in grid[::way]:
            pair = oscillator(ratio, 0.1, shake, mesh, w / TURN)
            rms, _, _, state = steady(pair, 200, state)
            rows.append(rms)
        found[way] = np.array(rows)[::way]
    for way, (w, rms) in ((1, up), (-1, down)):
        assert grid[np.argmax(found[way])] == w
        assert found[way].max() == pytest.approx(rms, rel=2e-4)
    apart = grid[np.abs(found[1] - found[-1]) > 0.02 * found[1]]
    assert (apart.min(), apart.max()) == two if two else apart.size == 0


@pytest.mark.slow
def test_light_damping_has_two_solutions_over_a_wide_range():
    """zeta 0.01, k = 1 + 0.2 cos: at W = 0.8 RMS 0.04086 in contact, 0.87245 with separation."""
    wave = fourier(1.0, (0.2,))
    state = np.array([-0.1, 0.0])
    assert steady(oscillator(0.01, 0.1, 0.0, wave, 0.8 / TURN), 600, state)[0] == pytest.approx(
        0.040864, rel=1e-4
    )
    state = np.array([-1.5, 0.0])
    for w, known in (
        (1.0, 0.54422),
        (0.95, None),
        (0.9, 0.68131),
        (0.86, None),
        (0.83, None),
        (0.81, None),
        (0.8, 0.87245),
    ):
        pair = oscillator(0.01, 0.1, 0.0, wave, w / TURN)
        rms, _, _, state = steady(pair, 250, state)
        assert known is None or rms == pytest.approx(known, rel=2e-4)


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
    phase = np.linspace(0.0, 1.0, 33)
    assert made.delta(phase) == pytest.approx(-pair.load / wave.value(phase), rel=1e-8)
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
    phase = np.arange(64) / 64.0
    assert made.delta(phase) == pytest.approx(run.delta[-65:-1], rel=1e-4)
    again = orbit(replace(pair, backlash=1.0), level, 1500.0, 40)
    assert again.rms == pytest.approx(made.rms, rel=1e-4) and again.found


def test_newton_that_does_not_end_is_said():
    made = orbit(oscillator(0.05, 0.1, 5.0), "fixed", 0.3 / TURN, 3)
    assert not made.found
