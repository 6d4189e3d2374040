"""Stability of a pair under a periodic mesh stiffness: Floquet multipliers and maps of them."""

import math
from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

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
ROUNDING, SAFETY = 1e-14, 4.0  # relative error of a map, at least; times what it changes
MOVES = (1, 2, 3)  # seeds of the signs by which maps are moved
NEAR, SOME = 8, 0.05  # mesh frequencies of a map at which its error is looked for, and share
CONDITION = 1e7  # of eigenvectors, above which a matrix exponential takes their place


def monodromy(system: Linear, wave: Wave, frequency: float, clock: Clock | None = None) -> Array:
    """Return the map (2 n, 2 n) of displacements and velocities over a period of the mesh.

    Velocities are divided by the highest angular frequency. A stepped stiffness is solved exactly,
    by matrix exponentials; any other by RK8 from kink to kink. frequency of the mesh [Hz] > 0. NaN
    where the clock stops, which is asked after every SLICE steps.
    """
    return _over_period(system, wave, frequency, _top(system, wave), clock)


def _over_period(
    system: Linear,
    wave: Wave,
    frequency: float,
    top: float,
    clock: Clock | None,
    finer: float = 1.0,
) -> Array:
    """Return `monodromy`; top: the highest angular frequency [rad/s], whatever the mesh's.

    finer: by how much the steps are shorter.
    """
    if wave.stepped:
        from scipy.linalg import expm

        over_period = np.eye(2 * system.mass.size)
        for length, k in zip(wave.lengths, wave.after, strict=True):
            over_period = expm(_rates(system, float(k), top) * (length / frequency)) @ over_period
        return over_period
    over_period, part = np.eye(2 * system.mass.size), np.empty((2 * system.mass.size,) * 2)
    given = 1.0 / system.mass, system.stiffness, system.damping, system.direction
    longest = 2.0 * math.pi / top / STEPS_PER_PERIOD / finer
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


def _one_by_one(
    system: Linear, wave: Wave, frequencies: Array, clock: Clock | None, finer: float = 1.0
) -> Array:
    """Return the maps at the first mesh frequencies, until the clock stops."""
    maps, top = list[Array](), _top(system, wave)
    for frequency in frequencies:
        if clock is not None and not clock.tell():
            break
        over = _over_period(system, wave, float(frequency), top, clock, finer)
        if np.isnan(over).any() and clock is not None and clock.stopped:
            break
        maps.append(over)
    return np.reshape(maps, (len(maps), 2 * system.mass.size, 2 * system.mass.size))


def _maps(system: Linear, wave: Wave, frequencies: Array, clock: Clock | None = None) -> Array:
    """Return the maps over a period at mesh frequencies (F, 2 n, 2 n), as `monodromy` has them.

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
    return np.asarray(over_period)


def _radius(maps: Array) -> Array:
    return np.asarray(np.max(np.abs(np.linalg.eigvals(maps)), axis=-1, initial=0.0))


def largest(system: Linear, wave: Wave, frequencies: Array, clock: Clock | None = None) -> Array:
    """Return the largest |multiplier| at mesh frequencies (F,) [Hz].

    At the first of them where the clock stops.
    """
    return _radius(_maps(system, wave, frequencies, clock))


class Mapped(NamedTuple):
    """The largest |multipliers| (W, F), and the largest error of one, estimated; NaN: not known."""

    growth: Array
    error: float


def stability_map(
    system: Linear, waves: list[Wave], frequencies: Array, clock: Clock | None = None
) -> Mapped:
    """Return the largest |multiplier| of every wave at every mesh frequency [Hz], (W, F).

    Of the first waves alone where the clock stops; it counts multipliers as evaluations. error:
    SAFETY times what maps that are moved by their own error change, the largest of MOVES, at the
    frequencies of `_closest`.
    """
    rows, clock, off = [], clock or Clock(), 0.0
    ready(system, waves[0], clock)
    size = _map_error(system, waves[-1], frequencies, clock)
    for wave in waves:
        if not clock.tell():
            break
        maps = _maps(system, wave, frequencies, clock)
        clock.evaluations += len(maps)
        if len(maps) < len(frequencies):
            break
        values = np.linalg.eigvals(maps)
        rows.append(np.max(np.abs(values), axis=-1))
        some = _closest(values)
        norms = size * np.max(np.abs(maps[some]), axis=(1, 2), keepdims=True)
        for move in MOVES:
            signs = np.random.default_rng(move).choice([-1.0, 1.0], maps.shape[1:])
            changed = _radius(maps[some] + norms * signs) - rows[-1][some]
            off = max(off, float(np.max(np.abs(changed))))
    growth = np.reshape(rows, (len(rows), len(frequencies)))
    return Mapped(growth, max(SAFETY * off, SAFETY * size))


def _closest(values: Any) -> NDArray[np.int64]:
    """Return where the largest of multipliers (F, 2 n) has another one nearest to it.

    Errors of a map count most there. SOME of them, or NEAR.
    """
    lead = np.take_along_axis(values, np.argmax(np.abs(values), axis=-1)[:, None], -1)
    apart = np.partition(np.abs(values - lead), 1, axis=-1)[:, 1]
    return np.asarray(np.argsort(apart)[: max(NEAR, int(SOME * len(values)))])


def _map_error(system: Linear, wave: Wave, frequencies: Array, clock: Clock) -> float:
    """Return the relative error of entries of maps, from others at three frequencies.

    Others: by steps half as long; of a stepped stiffness by matrix exponentials. NaN: the clock
    stopped.
    """
    some = np.asarray(frequencies)[[0, len(frequencies) // 2, -1]]
    maps = _maps(system, wave, some, clock)
    others = _one_by_one(system, wave, some, clock, 2.0)
    if len(maps) < len(some) or len(others) < len(some):
        return math.nan
    apart = np.max(np.abs(maps - others), axis=(1, 2)) / np.max(np.abs(others), axis=(1, 2))
    return float(max(apart.max(), ROUNDING))


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
