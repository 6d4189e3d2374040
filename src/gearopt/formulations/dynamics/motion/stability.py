"""Stability of a pair under a periodic mesh stiffness: Floquet multipliers and maps of them."""

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.dynamics.motion.integrate import eighth
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import compiling_aside, kernel
from gearopt.optimise.terms import Array
from gearopt.physics.motion.linear import Linear, modes
from gearopt.physics.motion.stiffness_wave import Wave

KERNEL = "gearopt.formulations.dynamics.motion.floquet_kernel"
STEPS_PER_PERIOD = 30.0  # of RK8 in a period of the fastest mode: 1e-12 of an entry
UNSTABLE = 1e-6  # by which the largest multiplier of an unstable pair exceeds 1
SLICE = 2000  # steps between two looks at a clock: some hundredth of a second
CONDITION = 1e7  # of eigenvectors, above which a matrix exponential takes their place


def monodromy(system: Linear, wave: Wave, frequency: float, clock: Clock | None = None) -> Array:
    """Return the map (2 n, 2 n) of displacements and velocities over a period of the mesh.

    Velocities are divided by the highest angular frequency. A stepped stiffness is solved exactly,
    by matrix exponentials; any other by RK8 from kink to kink. frequency of the mesh [Hz] > 0. NaN
    where the clock stops, which is asked after every SLICE steps.
    """
    return _over_period(system, wave, frequency, _top(system, wave), clock)


def _over_period(
    system: Linear, wave: Wave, frequency: float, top: float, clock: Clock | None
) -> Array:
    """Return `monodromy`; top: the highest angular frequency [rad/s], whatever the mesh's."""
    if wave.stepped:
        from scipy.linalg import expm

        over_period = np.eye(2 * system.mass.size)
        for length, k in zip(wave.lengths, wave.after, strict=True):
            over_period = expm(_rates(system, float(k), top) * (length / frequency)) @ over_period
        return over_period
    over_period, part = np.eye(2 * system.mass.size), np.empty((2 * system.mass.size,) * 2)
    given = 1.0 / system.mass, system.stiffness, system.damping, system.direction
    longest = 2.0 * math.pi / top / STEPS_PER_PERIOD
    for begin, pieces in _slices(wave, 1.0 / frequency / longest):
        if begin and clock is not None and not clock.tell():
            return np.full(over_period.shape, math.nan)
        pieces = *pieces, wave.cosines, wave.sines
        kernel(KERNEL).monodromy(eighth(), given, pieces, 1.0 / frequency, longest, begin, part)
        over_period = part @ over_period
    scale = np.append(np.ones(system.mass.size), np.full(system.mass.size, top))
    return np.asarray(over_period * scale / scale[:, None])


def _slices(wave: Wave, steps: float) -> Iterator[tuple[float, Any]]:
    """Yield the pieces of a wave, lengths and stiffness at both ends, with the phase they begin at.

    All at once, or parts of at most SLICE of the steps of a period.
    """
    ends = np.roll(wave.before, -1)
    if steps <= SLICE:
        yield 0.0, (wave.lengths, wave.after, ends)
        return
    for begin, length, low, high in zip(wave.edges, wave.lengths, wave.after, ends, strict=True):
        count = math.ceil(length * steps / SLICE)
        for k in range(count):  # one by one: a mesh of 1e-9 Hz has more than memory holds
            first, last = (np.array([low + (high - low) * (j / count)]) for j in (k, k + 1))
            yield float(begin + k / count * length), (np.array([length / count]), first, last)


def ready(system: Linear, wave: Wave, clock: Clock) -> None:
    """Compile the kernel that `monodromy` takes for a wave, aside from the clock's time."""
    if not wave.stepped:
        work = partial(monodromy, system, wave, _top(system, wave))
        compiling_aside(clock, kernel(KERNEL).monodromy, work)


def multipliers(system: Linear, wave: Wave, frequency: float) -> NDArray[np.complex128]:
    """Return the Floquet multipliers, (2 n,), the largest first; any beyond 1 is unstable."""
    eigenvalues = np.linalg.eigvals(monodromy(system, wave, frequency)).astype(complex)
    return np.asarray(eigenvalues[np.argsort(-np.abs(eigenvalues))])


def _one_by_one(system: Linear, wave: Wave, frequencies: Array, clock: Clock | None) -> Array:
    """Return the largest |multiplier| at the first mesh frequencies, until the clock stops."""
    largest_each, top = list[float](), _top(system, wave)
    for frequency in frequencies:
        if clock is not None and not clock.tell():
            break
        over = _over_period(system, wave, float(frequency), top, clock)
        if np.isnan(over).any() and clock is not None and clock.stopped:
            break
        largest_each.append(float(np.max(np.abs(np.linalg.eigvals(over)))))
    return np.array(largest_each)


def largest(system: Linear, wave: Wave, frequencies: Array, clock: Clock | None = None) -> Array:
    """Return the largest |multiplier| at mesh frequencies (F,) [Hz].

    At the first of them where the clock stops.
    """
    if not wave.stepped:
        return _one_by_one(system, wave, frequencies, clock)
    top, over_period = _top(system, wave), np.eye(2 * system.mass.size, dtype=complex)
    for length, k in zip(wave.lengths, wave.after, strict=True):
        rates = _rates(system, float(k), top)
        values, vectors = np.linalg.eig(rates)
        if np.linalg.cond(vectors) > CONDITION:
            return _one_by_one(system, wave, frequencies, clock)
        grown = np.exp(values * length / np.asarray(frequencies)[:, None])
        over_period = (vectors * grown[:, None, :]) @ np.linalg.inv(vectors) @ over_period
    return np.asarray(np.max(np.abs(np.linalg.eigvals(over_period)), axis=-1))


def stability_map(
    system: Linear, waves: list[Wave], frequencies: Array, clock: Clock | None = None
) -> Array:
    """Return the largest |multiplier| of every wave at every mesh frequency [Hz], (W, F).

    Of the first waves alone where the clock stops; it counts multipliers as evaluations.
    """
    rows, clock = [], clock or Clock()
    ready(system, waves[0], clock)
    for wave in waves:
        if not clock.tell():
            break
        row = largest(system, wave, frequencies, clock)
        clock.evaluations += len(row)
        if len(row) < len(frequencies):
            break
        rows.append(row)
    return np.reshape(rows, (len(rows), len(frequencies)))


def bands(places: Any, inside: Any) -> list[tuple[float, float]]:
    """Return the first and last of neighbouring places (N,) that are inside (N,)."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
    ends = zip(change[::2], change[1::2], strict=True)
    return [(float(places[a]), float(places[b - 1])) for a, b in ends]


def _top(system: Linear, wave: Wave) -> float:
    stiffest = float(np.max(wave.value(np.linspace(0.0, 1.0, 257))))
    return float(modes(system, max(stiffest, float(np.max(wave.after)))).frequencies[-1])


def _rates(system: Linear, k: float, top: float) -> Any:
    """Return A of y' = A y, velocities divided by `top`."""
    n, inverse = system.mass.size, 1.0 / system.mass[:, None]
    matrix = np.zeros((2 * n, 2 * n))
    matrix[:n, n:] = top * np.eye(n)
    matrix[n:, :n] = -inverse * system.with_mesh(k) / top
    matrix[n:, n:] = -inverse * system.damping
    return matrix
