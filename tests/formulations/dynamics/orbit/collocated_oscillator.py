"""The dead-zone oscillator x'' + 2 zeta x' + k(t) f(x) = F_m + F_a W^2 cos W t, collocated.

A pair of unit mass on fixed axes with a gap of 2, x = 1 - delta: contact at x > 1. In the equations
lengths count thousandths.
"""

import math
from itertools import pairwise

import numpy as np

from gearopt.formulations.dynamics.motion.integrate import march
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.formulations.dynamics.orbit.collocation import Moving, Piece, Timing, collocated, gauss
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Param, Repeat, Terms, Var
from gearopt.physics.motion.moving_pair import MovingPair, Rotor
from gearopt.physics.motion.stiffness_wave import fourier

TURN, LARGE = 2.0 * math.pi, 1e7


def oscillator(ratio, speed, shake=(), cosines=(0.0,)):
    """F_m = 0.1; shake: F_a of every harmonic; cosines of k = 1 + sum."""
    rotor = Rotor(1.0, 1.0, 2.0, (1.0, 1.0), torque=0.1)
    more = {"drag": 2.0 * ratio, "backlash": 2.0, "error": tuple(shake)}
    return MovingPair(rotor, rotor, 0.3, fourier(1.0, cosines), speed / TURN, **more)


def shaken(pair, phase):
    omega = TURN * pair.mesh_frequency
    return sum(
        -1e3 * a * (h * omega) ** 2 * np.cos(TURN * h * phase) for h, a in enumerate(pair.error, 1)
    )


def posed(pair, ends, points, width, periods=1):
    """Return the problem of the RMS of a motion that repeats after so many periods.

    ends: shares of a period between which elements lie.
    """
    count = (len(ends) - 1) * periods

    def block(x, p, row):
        def stiffness(share):
            return float(pair.wave.value(share))

        moving = Moving(
            pair.mesh_mass,
            pair.load,
            pair.damping,
            1e3 * pair.backlash,
            p.width,
            drag=pair.drag,
            shaken=lambda phase: shaken(pair, periods * phase),
        )
        pieces = [Piece(1.0 / periods, ends, stiffness)] * periods
        made = collocated(moving, pieces, points, x, Timing(row.period, 1.0))
        each = list(zip(made.weights, made.delta, strict=True))
        equal = {name: tuple(1.0 + r for r in rows) for name, rows in made.rows.items()}
        equal["mean"] = 1.0 + (sum(w * d for w, d in each) - x.mean) / 100.0
        square = sum(w * (d - x.mean) ** 2 for w, d in each)
        return Terms({}, {}, {"worst": square / x.rms**2}, equal)

    own = [
        Var(name, "um", -LARGE, LARGE, 0.0, size, search=True)
        for name, size in (
            ("mean", 1),
            ("places", count),
            ("speeds", count),
            ("bends", count * points),
        )
    ]
    period = periods / pair.mesh_frequency
    repeat = Repeat("speed", tuple(own), {"period": np.array([period])}, block)
    top = Var("rms", "um", 1e-3, LARGE, 100.0, log=True, search=True)
    given = (Param("width", "um", width),)
    return Problem("oscillator", (top,), given, lambda x, p: Terms({"rms": x.rms}), (repeat,))


def at_phase_zero(pairs, periods=300):
    """Return the state that simulations of pairs one after the other come to."""
    state = np.array([-0.1, 0.0])
    for pair in pairs:
        times = timeline(pair, np.array([0.0, periods / pair.mesh_frequency]), False)
        state = march(pair, "fixed", times, "rk8", 0.02 / pair.mesh_frequency, state).states[-1]
    return state


def started(problem, pair, ends, points, state, periods=1):
    """Return the problem with a simulated motion as its guess."""
    edges = np.append((np.arange(periods)[:, None] + ends[:-1]).ravel(), periods)
    inner = np.concatenate([a + (b - a) * gauss(points).points for a, b in pairwise(edges)])
    marks, back = np.unique(np.concatenate([edges, inner]), return_inverse=True)
    times = timeline(pair, marks / pair.mesh_frequency, False)
    states = march(pair, "fixed", times, "rk8", 0.01 / pair.mesh_frequency, state).states[back]
    first, (delta, rate) = 1e3 * states[: len(edges) - 1], states[len(edges) :].T
    gap = np.where(delta < 0.0, delta, np.maximum(delta - pair.backlash, 0.0))
    force = pair.wave.value(inner) * gap + pair.drag * rate
    bends = shaken(pair, inner) - 1e3 * (pair.load + force) / pair.mesh_mass
    mean = [1e3 * delta.mean()]
    whole = [[1e3 * delta.std()], mean, first[:, 0], first[:, 1], bends]
    return problem.starting(np.concatenate(whole))


def partings(pair, state):
    """Return the phases at which teeth part and meet on the drive flank."""
    phases = np.linspace(0.0, 1.0, 4001)
    times = timeline(pair, phases / pair.mesh_frequency, False)
    made = march(pair, "fixed", times, "rk8", 0.01 / pair.mesh_frequency, state)
    delta, rate = made.states.T
    k = np.flatnonzero((delta[:-1] < 0.0) != (delta[1:] < 0.0))
    return phases[k] - delta[k] / rate[k] * pair.mesh_frequency
