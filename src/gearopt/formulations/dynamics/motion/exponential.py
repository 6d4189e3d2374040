"""Exact motion of piecewise linear scenes: one matrix exponential for every piece of stiffness."""

import numpy as np

from gearopt.formulations.dynamics.motion.integrate import Marched
from gearopt.formulations.dynamics.motion.timeline import Timeline
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.motion.accelerations import LEVELS
from gearopt.physics.motion.linear import linear, modes
from gearopt.physics.motion.moving_pair import MovingPair

PIECES = 5000  # of constant stiffness between two looks at a clock
LINEAR = ("tangent", "paper_linear")


def piecewise_linear(pair: MovingPair, level: str) -> bool:
    """Return whether the motion in contact is a linear one between the steps of the stiffness."""
    straight = level in ("fixed", "line") or (level == "plane" and pair.kinematics in LINEAR)
    return straight and pair.wave.stepped and not pair.error


def exact_motion(
    pair: MovingPair, level: str, times: Timeline, state: Array, clock: Clock | None = None
) -> Marched:
    """Return the motion of teeth that never part, exact to rounding: y(t + h) = exp(A h) y(t).

    y: coordinates, velocities over the highest angular frequency, and 1, which carries the load.
    ValueError where the motion is not `piecewise_linear`, or teeth may part. clock: it counts the
    pieces, and is asked every PIECES; where it stops, the motion ends there.
    """
    from scipy.linalg import expm

    if pair.backlash is not None or not piecewise_linear(pair, level):
        raise ValueError(f"the motion at the level {level!r} is not piecewise linear")
    n = LEVELS[level][0]
    top = float(modes(linear(pair, level), float(np.max(pair.wave.after))).frequencies[-1])
    scale = np.append(np.ones(n), np.full(n, top))
    rates = {float(k): _rates(pair, level, float(k), scale) for k in np.unique(times.k0)}
    now, made = np.append(np.asarray(state, float) / scale, 1.0), dict[tuple[float, str], Array]()
    out, clock = np.empty((len(times.starts), 2 * n)), clock or Clock()
    done = len(out)
    for i, (length, k) in enumerate(zip(times.lengths, times.k0, strict=True)):
        if i % PIECES == PIECES - 1 and not clock.tell():
            done = i
            break
        key = float(k), f"{length:.12e}"
        if key not in made:
            made[key] = expm(rates[key[0]] * length)
        now = made[key] @ now
        out[i] = now[:-1] * scale
        clock.evaluations += 1
    whole = np.concatenate([[state], out])[times.asked[times.asked < done] + 1]
    return Marched(pair, level, whole, done, done)


def _rates(pair: MovingPair, level: str, k: float, scale: Array) -> Array:
    """Return A (2 n + 1, 2 n + 1) of y' = A y at a stiffness k [N/mm], column by column."""
    n, law = LEVELS[level]
    found = np.zeros((2 * n + 1, 2 * n + 1))
    for j in range(2 * n + 1):
        unit = np.eye(2 * n + 1)[j, :-1] * scale
        found[:n, j], found[n:-1, j] = unit[n:], law(pair, k, unit[:n], unit[n:])
    found[:-1] /= scale[:, None]
    found[:-1, :-1] -= found[:-1, -1:]
    return found
