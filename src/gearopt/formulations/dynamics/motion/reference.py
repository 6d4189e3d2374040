"""Adaptive library methods for the same motions: scipy's, and CVODES of SUNDIALS through casadi."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.dynamics.motion.integrate import MARCH, Marched, Numbers, numbers
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.optimise.kernels import kernel
from gearopt.optimise.tape import legacy_numpy
from gearopt.optimise.terms import Array
from gearopt.physics.motion.accelerations import LEVELS
from gearopt.physics.motion.moving_pair import MovingPair

SCIPY = ("DOP853", "Radau", "LSODA")
MAX_STEPS = 10**7  # of CVODES, at most


def scales(pair: MovingPair, level: str) -> Array:
    """Return lengths and velocities (2 n,) below which digits of a state do not count."""
    n = LEVELS[level][0]
    length = abs(pair.load) / pair.wave.mean
    speed = length * math.sqrt(pair.wave.mean / pair.mesh_mass)
    return np.append(np.full(n, length), np.full(n, speed))


def scipy_motion(
    pair: MovingPair, level: str, times: Array, method: str, rtol: float, state: Array
) -> Marched:
    """Return the motion by scipy's solve_ivp, started again at kinks and where the flank changes.

    method: of SCIPY; rtol relative, with an absolute tolerance of rtol times `scales`. times [s].
    """
    model, asked = numbers(pair, level), np.asarray(times, float)
    pieces = timeline(pair, asked[[0, -1]])
    now = np.array(state, float)
    out, rates, events = [now], 0, 0
    flank = int(kernel(MARCH).flank_now(model.pair, now))
    tolerances = {"method": method, "rtol": rtol, "atol": rtol * scales(pair, level)}
    for start, length, k0, k1 in zip(
        pieces.starts, pieces.lengths, pieces.k0, pieces.k1, strict=True
    ):
        t, end, line = start, start + length, (start, k0, (k1 - k0) / length)
        while t < end:
            due = asked[(asked > t) & (asked <= end)]
            solution = _smooth(model, line, flank, (t, end), now, due, tolerances)
            rates += solution.nfev
            left = solution.status == 1
            t = solution.t_events[0][0] if left else end
            states = np.reshape(solution.y, (len(now), -1)).T  # a list where none was reached
            out += list(states[: int(np.sum(due <= t))])
            now = solution.y_events[0][0] if left else states[-1]
            if left:
                flank, events = _other(model, flank, now), events + 1
    return Marched(pair, level, np.array(out), rates, rates, events)


def _other(model: Numbers, flank: int, state: Array) -> int:
    """Return the flank on which a motion goes on that has come to the end of one."""
    if flank != 1:
        return 1
    return 0 if state[len(state) // 4] <= 0.5 * float(model.pair["backlash"][0]) else 2


def _smooth(
    model: Numbers,
    line: tuple[float, float, float],
    flank: int,
    span: tuple[float, float],
    now: Array,
    asked: Array,
    tolerances: dict[str, Any],
) -> Any:
    """Return scipy's motion on one flank, k on a line (time, k, slope), until the flank changes."""
    from scipy.integrate import solve_ivp

    law = kernel(MARCH)

    def rate(at: float, y: Array) -> Array:
        k, rates = line[1] + line[2] * (at - line[0]), np.empty(y.size)
        law.rates(*model, at, k, flank, np.ascontiguousarray(y), rates)
        return rates

    def leaves(at: float, y: Array) -> float:
        return float(law.past(model.pair, flank, y))

    leaves.terminal, leaves.direction = True, 1.0  # type: ignore[attr-defined]
    events = leaves if model.pair["backlash"][0] < math.inf else None
    given = {"t_eval": np.union1d(asked, span[1]), "events": events}
    begun = np.ascontiguousarray(now)  # for other layouts a kernel is compiled once more
    return solve_ivp(rate, span, begun, **given, **tolerances)


def cvodes(pair: MovingPair, level: str, times: Array, rtol: float) -> Any:
    """Return a run(state) -> Marched by CVODES (BDF), built once; for pairs without backlash.

    The stiffness is a function of time in its right-hand side; steps go across kinks.
    """
    import casadi as ca

    if pair.backlash is not None:
        raise ValueError("CVODES is run here without separation")
    n, law = LEVELS[level]
    y, t = ca.SX.sym("y", 2 * n), ca.SX.sym("t")
    scale = scales(pair, level)
    whole = [y[i] * float(scale[i]) for i in range(2 * n)]
    bare = replace(pair, error=())
    with legacy_numpy():
        accelerations = law(bare, _stiffness(pair, t), whole[:n], whole[n:])
    if pair.error:
        accelerations[n // 2] += _shaken(pair, t)
    rhs = [one / float(s) for one, s in zip([*whole[n:], *accelerations], scale, strict=True)]
    integrator = ca.integrator(
        "motion",
        "cvodes",
        {"x": y, "t": t, "ode": ca.vertcat(*rhs)},
        float(times[0]),
        [float(at) for at in times[1:]],
        {"reltol": rtol, "abstol": rtol, "max_num_steps": MAX_STEPS},
    )

    def run(state: Array) -> Marched:
        x = np.array(integrator(x0=np.asarray(state) / scale)["xf"], float).T
        states = np.concatenate([[state], x * scale])
        return Marched(pair, level, states, 0, 0)

    return run


def _stiffness(pair: MovingPair, t: Any) -> Any:
    import casadi as ca

    wave = pair.wave
    phase = t * pair.mesh_frequency
    phase = phase - ca.floor(phase)
    after = np.roll(wave.before, -1)
    stiffness = 0.0
    for edge, length, low, high in zip(wave.edges, wave.lengths, wave.after, after, strict=True):
        inside = ca.logic_and(phase >= edge, phase < edge + length)
        line = float(low) + float(high - low) * (phase - float(edge)) / float(length)
        stiffness = stiffness + ca.if_else(inside, line, 0.0)
    for h, (a, b) in enumerate(zip(wave.cosines, wave.sines, strict=True), 1):
        angle = 2.0 * math.pi * h * phase
        stiffness = stiffness + float(a) * ca.cos(angle) + float(b) * ca.sin(angle)
    return stiffness


def _shaken(pair: MovingPair, t: Any) -> Any:
    import casadi as ca

    omega = 2.0 * math.pi * pair.mesh_frequency
    return sum(
        -((h * omega) ** 2) * (e.real * ca.cos(h * omega * t) - e.imag * ca.sin(h * omega * t))
        for h, e in enumerate(pair.error, 1)
    )
