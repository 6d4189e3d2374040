"""The motion that a pair comes to at a speed: in contact, near a motion before it, or simulated.

Teeth in contact move as the linear pair does, while that is stable. Where they part, harmonic
balance gives a motion that repeats every period of the mesh; Newton's method on a simulated period
corrects its state, and the multipliers of that period tell whether it is stable. Where there is
none near by, a simulation goes on from the motion before until it repeats itself.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gearopt.formulations.dynamics.motion.balance import SAMPLES, Orbit, linear_orbit, orbit, states
from gearopt.formulations.dynamics.motion.integrate import Marched, march
from gearopt.formulations.dynamics.motion.simulate import fastest
from gearopt.formulations.dynamics.motion.stability import UNSTABLE, largest, ready
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.formulations.dynamics.parts import around, jammed, resting
from gearopt.formulations.dynamics.tooth_load import Lag, Load, extent, load_over
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.motion.linear import linear
from gearopt.physics.motion.moving_pair import MovingPair

ORDERS = 12  # of the mesh frequency, shown over speed
FASTEST_MODES, FOURIER_TIMES, MOST_HARMONICS = 3.0, 4, 512  # harmonics of a motion in contact
GUESSED = 40  # of one that parts, at most: its state is made exact afterwards
STEPS_PER_PERIOD = 12.0  # of RK8 in a period of the fastest mode: 1e-6 of a motion
FINER = 4  # times as many samples of a motion in contact for the load on its teeth
FINEST_LAG = 16  # times as many for its transmission error
ROUNDING, SAFETY = 1e-9, 2.0  # error at least; times the change by half the steps
LOOKS, FINEST = 64, 16.0  # samples of a period of the mesh at least, and of the fastest mode
RMS_JUMP = 0.3  # of its RMS by which a motion may differ from the one at the speed before
SHOTS, CLOSED = 6, 1e-9  # Newton's steps to a state that repeats; what is left, of its size
MOVED = 1e-6  # of its scale by which a state is moved for a derivative
CHUNK = 32  # periods between two looks at whether a simulation repeats itself
MOST_PERIODS = 8  # of the mesh, after which a motion may repeat
SETTLED, REPEATED = 1e-6, 1e-3  # change of states that ends a simulation; that counts as repeated
PATIENCE = 15.0  # time constants of the least damped mode that a simulation may take
GROWN = 8.0  # logarithm of the factor by which an unstable one may grow in it
LONGER, NEARLY = 4, 0.02  # times as many where states change by less than this: it settles slowly
MIN_PERIODS, MOST_STEPS = 128, 100_000  # periods at least, and steps at most
KEPT = 64  # periods of a motion that does not repeat from which its numbers are taken
ENDLESS = 1e4  # times as large as it began, and as the backlash: a motion that grows for ever
KICK = 0.1  # of its state by which a motion in contact is moved where it is unstable


@dataclass(frozen=True)
class Motion:
    """A motion at a speed: RMS of delta about its mean, least and largest delta [mm].

    amplitudes (ORDERS,) of the orders of the mesh frequency [mm]. repeats: after how many periods
    of the mesh, 0: not within MOST_PERIODS. load: on the teeth; lag: its transmission error. error:
    estimated, of delta relative to its largest value; of a motion that does not repeat the range of
    the RMS of its quarters. A motion that grows for ever has NaN for numbers.
    jams: both flanks are pressed at once, as the axes came together. For the next speed: the state
    at phase 0, delta at LOOKS phases of each period, and its series.
    """

    rms: float
    least: float
    highest: float
    amplitudes: Array
    repeats: int
    jams: bool
    load: Load
    lag: Lag
    error: float
    state: Array
    delta: Array
    series: Orbit

    @property
    def grows(self) -> bool:
        """Whether it grows for ever, so that it has no size."""
        return math.isnan(self.rms)


class Contact(NamedTuple):
    """The motion of teeth that stay in contact, its largest multiplier, and its error.

    error: of delta, relative to its largest value: what half of the harmonics change.
    """

    series: Orbit
    growth: float
    error: float

    @property
    def holds(self) -> bool:
        """Whether teeth stay in contact, and would after a small disturbance."""
        return self.series.extremes[1] <= 0.0 and self.growth <= 1.0 + UNSTABLE


def in_contact(
    pair: MovingPair, level: str, frequencies: Array, harmonics: int, clock: Clock
) -> list[Contact]:
    """Return the motions of teeth in contact at mesh frequencies [Hz], by harmonic balance.

    harmonics: at least so many, see `enough`. Of the first alone where the clock stops.
    """
    contacts, system = [], around(pair, level)
    ready(system, pair.wave, clock)
    for frequency in frequencies:
        if not clock.tell():
            break
        wanted = enough(pair, level, float(frequency), harmonics)
        series = linear_orbit(pair, level, float(frequency), wanted)
        grown = largest(system, pair.wave, np.array([frequency]), clock)
        if not len(grown):
            break
        half = linear_orbit(pair, level, float(frequency), max(1, wanted // 2))
        count = LOOKS * (2 * wanted // LOOKS + 1)
        error = _apart(half.delta(count), series.delta(count))
        contacts.append(Contact(series, float(grown[0]), max(error, ROUNDING)))
        clock.evaluations += 3
    return contacts


def enough(pair: MovingPair, level: str, frequency: float, harmonics: int) -> int:
    """Return how many harmonics of a mesh frequency [Hz] a motion of teeth in contact asks for.

    A stiffness with kinks or jumps excites the fastest mode at any speed: harmonics to
    FASTEST_MODES times that mode, at most MOST_HARMONICS. A Fourier series: FOURIER_TIMES times
    its own, and those of the transmission error.
    """
    smooth = FOURIER_TIMES * max(len(pair.wave.cosines), len(pair.error))
    if len(pair.wave.edges) == 1:
        return max(harmonics, smooth)
    top = 1.0 / fastest(replace(pair, mesh_frequency=0.0), level)
    most = min(MOST_HARMONICS, math.ceil(FASTEST_MODES * top / frequency))
    return max(harmonics, most, smooth)


def linear_motion(pair: MovingPair, level: str, contact: Contact) -> Motion:
    """Return the motion of teeth in contact, which grows for ever where that is unstable."""
    series = contact.series
    count = LOOKS * (2 * len(series.harmonics) // LOOKS + 1)
    passed = states(pair, level, series, FINER * count)
    times = np.arange(FINER * count + 1) / (FINER * count * series.frequency)
    phases = np.arange(FINEST_LAG * count) / (FINEST_LAG * count)
    motion = Motion(
        series.rms,
        *series.extremes,
        _amplitudes(series),
        1,
        bool(np.any(jammed(pair, level, passed))),
        load_over(pair, level, times, np.vstack([passed, passed[:1]])),
        extent(pair.error_at(phases) - series.delta(phases.size)),
        contact.error,
        passed[0],
        series.delta(count)[:: count // LOOKS],
        series,
    )
    return motion if contact.growth <= 1.0 + UNSTABLE else _growing(motion, jams=False)


def _growing(motion: Motion, jams: bool) -> Motion:
    """Record of a motion that grows for ever."""
    none, nothing = math.nan, np.full(ORDERS, math.nan)
    bare = replace(motion, load=Load(none, none, none), lag=Lag(none, none, none), jams=jams)
    return replace(bare, rms=none, least=none, highest=none, amplitudes=nothing, error=none)


def _apart(other: Array, delta: Array) -> float:
    """Return by how much two courses of delta differ, relative to the largest of the second."""
    return float(np.max(np.abs(other - delta)) / np.max(np.abs(delta)))


def _amplitudes(series: Orbit) -> Array:
    amplitudes = np.zeros(ORDERS)
    orders = 2.0 * np.abs(series.harmonics[1 : ORDERS + 1])
    amplitudes[: orders.size] = orders
    return amplitudes


def continued(
    pair: MovingPair, level: str, contact: Contact, last: Motion, clock: Clock
) -> Motion | None:
    """Return the stable motion near the last one that repeats as that does; None: there is none.

    Near one that did not repeat, one of a single period is looked for.
    """
    state, periods = last.state, last.repeats or 1
    harmonics = min(GUESSED, len(contact.series.harmonics) - 1)
    if periods == 1:
        guess = contact.series if last.highest <= 0.0 else last.series
        balanced = orbit(pair, level, pair.mesh_frequency, harmonics, guess)
        clock.evaluations += 1
        if not balanced.found:
            return None
        state = states(pair, level, balanced, SAMPLES * harmonics)[0]
    repeating = _repeating(pair, level, state, periods, clock)
    if repeating is None:
        return None
    motion = _periodic_response(pair, level, repeating, periods, clock)
    if motion is None:
        return None
    size = max(motion.delta.size, last.delta.size)
    off = float(np.std(np.resize(motion.delta, size) - np.resize(last.delta, size)))
    return motion if off <= RMS_JUMP * max(motion.rms, last.rms) else None


def _repeating(
    pair: MovingPair, level: str, state: Array, periods: int, clock: Clock
) -> Array | None:
    """Return the state that periods of the mesh repeat, by Newton's method from one near by.

    None where it does not end, or where a small disturbance would grow. Derivatives are those of
    periods simulated from states moved by MOVED, the moments at which teeth part included.
    """
    scale, size = _scale(pair, level), state.size
    for _ in range(SHOTS):
        end, slope = _slope(pair, level, state, periods, clock)
        if not np.all(np.isfinite(slope)):
            return None
        wrong = end - state / scale
        if np.max(np.abs(wrong)) <= CLOSED * np.max(np.abs(state / scale)):
            stable = np.max(np.abs(np.linalg.eigvals(slope))) <= 1.0 + UNSTABLE
            return state if stable else None
        state = state + scale * np.linalg.lstsq(np.eye(size) - slope, wrong, rcond=None)[0]
    return None


def _slope(
    pair: MovingPair, level: str, state: Array, periods: int, clock: Clock
) -> tuple[Array, Array]:
    """Return the state after periods, and its derivatives by the state, both over `_scale`."""
    scale = _scale(pair, level)
    starts = np.vstack([state, state + MOVED * np.diag(scale)])
    ends = np.array([_passed(pair, level, start, periods, clock) for start in starts]) / scale
    return ends[0], (ends[1:] - ends[0]).T / MOVED


def _passed(
    pair: MovingPair, level: str, state: Array, periods: int, clock: Clock, finer: float = 1.0
) -> Array:
    """Return the state after periods of the mesh; NaN where the clock stopped."""
    ends = np.array([0.0, periods]) / pair.mesh_frequency
    motion = _marched(pair, level, ends, state, clock, finer)
    return np.asarray(motion.states[1] if len(motion.states) > 1 else np.full(state.size, math.nan))


def _marched(
    pair: MovingPair, level: str, times: Array, state: Array, clock: Clock, finer: float = 1.0
) -> Marched:
    longest = fastest(pair, level) / STEPS_PER_PERIOD / finer
    return march(pair, level, timeline(pair, times), "rk8", longest, state, clock)


def _scale(pair: MovingPair, level: str) -> Array:
    """Return lengths and rates (2 n,) in which a state is measured."""
    size = resting(pair, level).size // 2
    length = abs(pair.load) / pair.wave.mean
    rate = 2.0 * math.pi * length / fastest(pair, level)
    return np.append(np.full(size, length), np.full(size, rate))


def settled(
    pair: MovingPair, level: str, contact: Contact, last: Motion | None, clock: Clock
) -> Motion | None:
    """Return the motion to which a simulation comes from the one before; None: the clock stopped.

    Where that was in contact, and contact is unstable, it is moved by KICK: a disturbance that a
    machine always has.
    """
    state = resting(pair, level) if last is None else last.state
    if contact.growth > 1.0 + UNSTABLE and (last is None or last.highest <= 0.0):
        state = (1.0 - KICK) * state
    scale, passed = _scale(pair, level), state[None]
    room = float(np.max(np.abs(state / scale)) + (pair.backlash or 0.0) / scale[0])
    most, spent, changes = _patience(pair, level, contact.growth), 0, [math.inf]
    while min(changes) > SETTLED and spent < (LONGER if min(changes) < NEARLY else 1) * most:
        times = np.arange(CHUNK + 1) / pair.mesh_frequency
        motion = _marched(pair, level, times, passed[-1], clock)
        if len(motion.states) <= CHUNK or not clock.tell():
            return None
        if not np.max(np.abs(motion.states / scale)) < ENDLESS * room:
            return _growing(linear_motion(pair, level, contact), motion.jammed is not None)
        passed = np.concatenate([passed[-CHUNK:], motion.states[1:]])
        spent += CHUNK
        changes = [_change(passed / scale, p) for p in range(1, MOST_PERIODS + 1)]
    repeats = next((p for p, c in enumerate(changes, 1) if c <= REPEATED), 0)
    response = _periodic_response(pair, level, passed[-1], repeats, clock)
    if response is not None and repeats == 1 and response.highest <= 0.0 and contact.holds:
        return linear_motion(pair, level, contact)
    return response


def _patience(pair: MovingPair, level: str, growth: float) -> int:
    """Return how many periods of the mesh a simulation may take to settle.

    growth: the largest multiplier of teeth in contact; beyond 1 a motion takes time to grow.
    """
    system = linear(pair, level)
    inverse = 1.0 / system.mass[:, None]
    n = system.mass.size
    held = np.block(
        [
            [np.zeros((n, n)), np.eye(n)],
            [-inverse * system.with_mesh(pair.wave.mean), -inverse * system.damping],
        ]
    )
    slowest = float(np.min(-np.linalg.eigvals(held).real))
    wanted = 0.0
    if slowest > 1e-9 * pair.mesh_frequency:
        wanted = PATIENCE * pair.mesh_frequency / slowest
    if growth > 1.0 + UNSTABLE:
        wanted = max(wanted, GROWN / math.log(growth))
    a_period = max(1.0, STEPS_PER_PERIOD / (fastest(pair, level) * pair.mesh_frequency))
    return max(MIN_PERIODS, int(min(wanted, MOST_STEPS / a_period)))


def _change(passed: Array, periods: int) -> float:
    """Return how far the last states are from those so many periods before, over that of delta."""
    later, before = passed[-MOST_PERIODS:], passed[-MOST_PERIODS - periods : -periods]
    half = passed.shape[1] // 2
    size = np.max(np.abs(later[:, [half // 2, half + half // 2]]))
    return float(np.max(np.abs(later - before)) / size)


def _periodic_response(
    pair: MovingPair, level: str, state: Array, repeats: int, clock: Clock
) -> Motion | None:
    """Amplitudes, load and error of the motion from a state on, over its periods.

    None: the clock stopped.
    """
    periods, frequency = repeats or KEPT, pair.mesh_frequency
    finer = math.ceil(FINEST / (LOOKS * frequency * fastest(pair, level)))
    looks = LOOKS * finer
    times = np.arange(periods * looks + 1) / (looks * frequency)
    motion = _marched(pair, level, times, state, clock)
    if len(motion.states) < len(times):
        return None
    delta = motion.delta[:-1]
    for shorter in range(1, periods if repeats else 1):
        apart = delta[shorter * looks :] - delta[: -shorter * looks]
        if np.max(np.abs(apart)) <= REPEATED * np.max(np.abs(delta)):
            repeats = shorter
            break
    series = Orbit(frequency, np.fft.rfft(delta)[::periods][: looks // 2] / delta.size)
    error = _error(pair, level, motion, times, repeats, clock)
    if error is None:
        return None
    return Motion(
        rms=float(delta.std()),
        least=float(delta.min()),
        highest=float(delta.max()),
        amplitudes=_amplitudes(series),
        repeats=repeats,
        jams=motion.jammed is not None,
        load=load_over(pair, level, times, motion.states),
        lag=extent(pair.error_at(frequency * times[:-1]) - delta),
        error=error,
        state=motion.states[-1],
        delta=delta[: (repeats or KEPT) * looks : finer],
        series=series,
    )


def _error(
    pair: MovingPair, level: str, motion: Marched, times: Array, repeats: int, clock: Clock
) -> float | None:
    """Return the error of delta of a motion over its periods, relative to its largest value.

    One that repeats: what half the steps change, with the state that they repeat, by a step of
    Newton's method from its own. Else the range of the RMS of four quarters. None: the clock
    stopped.
    """
    delta, state = motion.delta, motion.states[0]
    if not repeats:
        parts = [quarter.std() for quarter in np.array_split(delta, 4)]
        return float(np.ptp(parts) / np.max(np.abs(delta)))
    scale = _scale(pair, level)
    _, slope = _slope(pair, level, state, repeats, clock)
    wrong = _passed(pair, level, state, repeats, clock, 2.0) / scale - state / scale
    if not np.all(np.isfinite(slope)) or not np.all(np.isfinite(wrong)):
        return None
    moved = np.linalg.lstsq(np.eye(state.size) - slope, wrong, rcond=None)[0]
    finer = _marched(pair, level, times, state + scale * moved, clock, 2.0)
    if len(finer.states) < len(times):
        return None
    return max(SAFETY * _apart(finer.delta, delta), ROUNDING)
