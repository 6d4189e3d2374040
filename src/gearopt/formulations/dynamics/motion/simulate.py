"""A motion to an error that is asked: the cheapest method that meets it is found and used."""

import math
from dataclasses import replace

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations.dynamics.motion.integrate import STEPPERS, Marched, conservative, march
from gearopt.formulations.dynamics.motion.timeline import Timeline, timeline
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.motion.accelerations import LEVELS
from gearopt.physics.motion.linear import linear, modes
from gearopt.physics.motion.moving_pair import MovingPair

LONGEST_STEPS_PER_PERIOD = 4.0  # steps in a period of the fastest mode, of the longest steps tried
EXACT = 1e-11  # error of exact pieces, of the largest |delta|: rounding over a long run
ROUNDING = 3e-13  # error below which halving a step shows rounding, not the method
MOVED = 5e-14  # of its scale by which a start is moved: half of what impacts are located to
IMPACTS = 4  # order that a falling change of a motion with impacts is taken to tell, at most
ROUGH = 0.1  # change from which on a method follows a motion
NOISE = 3.0  # times what that changes: changes up to there are of roundings, not of the method
SAFETY = 4.0  # times the error that changes by halving tell of the finer run
SHORTEST = 11  # outputs of a motion that was cut short, at least
MAX_RATE_EVALUATIONS = 400_000_000  # rates evaluated, at most: some minute
FASTEST_STEPS = 2e6  # steps in a second of the clock, at most
CANDIDATES = ("rk8", "rk4", "symplectic", "newmark")
LOCATING = ("rk8", "rk4")  # those that locate where teeth part and meet


@dataclass(frozen=True)
class Simulated:
    """A motion: its method, the error of delta reached, relative to its largest |delta|.

    error: the last change c by halving the steps, times 4/(q - 1) where the changes fell by a
    factor of q > 5 (at most 2^p of an order p, of 4 where teeth part): four times what is left of a
    geometric series. Where teeth part at least four times what a start moved by MOVED changes, 1e-3
    after many impacts. steady [s]: until when that stays below the error asked. rates: evaluated in
    all, those of the search for a method included. met: whether the error asked
    was reached, to the last of the times. longest [s]: the step of the run kept; 0 of exact pieces.
    """

    times: Array
    motion: Marched
    method: str
    error: float
    met: bool
    rates: int
    longest: float
    steady: float = math.inf


@dataclass(frozen=True)
class _Try:
    method: str
    longest: float
    motion: Marched
    change: float  # of delta by the last halving, relative; inf before there was one
    error: float  # estimated from it
    spent: int

    def ahead(self, asked: float) -> float:
        """Rates that are likely to be evaluated until the error asked is met."""
        order = STEPPERS[self.method].order
        wanted = min(max(self.error, asked), 1e6) / asked
        return float(self.motion.rates * max(2.0, wanted ** (1.0 / order)))


def simulate(
    pair: MovingPair,
    level: str,
    times: Array,
    error: float,
    state: Array | None = None,
    clock: Clock | None = None,
) -> Simulated | None:
    """Return the motion whose error of delta is at most `error`, by the method that costs least.

    times (outputs,) [s], from the start; state (2 n,): coordinates and velocities there, at rest
    and unloaded where None. Piecewise linear scenes whose teeth never part are solved exactly; else
    steps of several methods are halved (with backlash of those that locate separations), always of
    that whose order promises to need the fewest evaluations, until the change says that the error
    is met, the clock stops, or the change is of roundings. Then the run of least error is told, or
    of the first two what both have reached; None where that is less than SHORTEST outputs.
    """
    state, clock = np.zeros(2 * LEVELS[level][0]) if state is None else state, clock or Clock()
    intervals = timeline(pair, times[: _within_reach(pair, times, clock)])
    if pair.backlash is None and piecewise_linear(pair, level):
        exact = exact_motion(pair, level, intervals, state, clock)
        return _simulated(times, exact, "exponential", EXACT, error, exact.rates, 0.0)
    _check_steps(pair, level, float(times[-1] - times[0]))
    tried = _begun(pair, level, intervals, state, clock)
    spent, ended = sum(t.spent for t in tried), list[_Try]()
    while tried:
        best = min(tried, key=lambda t: (t.error > error, t.ahead(error)))
        if (
            best.error <= error
            or spent + 2 * best.motion.rates > MAX_RATE_EVALUATIONS
            or not clock.tell()
        ):
            break
        finer = _halved(best, intervals, state, clock)
        if clock.stopped or finer is None:
            break
        spent += finer.motion.rates
        if best.change < ROUGH and finer.change > 0.5 * best.change:  # is rounding alone left?
            moved = _moved(best, intervals, state, clock)
            if best.change < 1e-6 or finer.change <= NOISE * moved.max():
                break
        tried[tried.index(best)] = finer
        ended.append(replace(best, error=max(best.error, finer.change)))
    if not tried:
        return None
    if best.error > error:
        best = min((*ended, *tried), key=lambda t: t.error)
    changed = _moved(best, intervals, state, clock)
    reached = max(best.error, float(changed.max(initial=0.0)))
    simulated = _simulated(times, best.motion, best.method, reached, error, spent, best.longest)
    if simulated is None or len(changed) < len(best.motion.states):
        return simulated and replace(simulated, met=False)
    beyond = np.flatnonzero(changed > error)
    return (
        replace(simulated, steady=float(times[max(0, beyond[0] - 1)])) if beyond.size else simulated
    )


def _within_reach(pair: MovingPair, times: Array, clock: Clock) -> int:
    """Number of the first outputs that a motion can reach in what is left of the clock."""
    seconds = clock.left.seconds
    if seconds is None:
        return len(times)
    kinks = len(pair.wave.edges) * pair.mesh_frequency * float(times[-1] - times[0])
    steps_per_output = max(1.0, kinks / len(times))  # no step goes over a kink
    return min(len(times), SHORTEST + int(FASTEST_STEPS * seconds / steps_per_output))


def _moved(tried: _Try, times: Timeline, state: Array, clock: Clock) -> Array:
    """Return SAFETY times the change of the deformation by a start moved by MOVED, relative.

    0 of a motion whose teeth neither part nor meet; of the first outputs where the clock stops.
    """
    motion = tried.motion
    if not motion.events:
        return np.zeros(len(motion.states))
    length = abs(motion.pair.load) / motion.pair.wave.mean
    start = state - MOVED * np.maximum(length, np.abs(state))
    other = march(motion.pair, motion.level, times, tried.method, tried.longest, start, clock).delta
    both = min(len(other), len(motion.states))
    scale = float(np.max(np.abs(motion.delta))) or 1.0
    change = np.abs(other[:both] - motion.delta[:both]) / scale
    return np.where(np.isfinite(change), SAFETY * change, math.inf)


def _begun(pair: MovingPair, level: str, times: Timeline, state: Array, clock: Clock) -> list[_Try]:
    """Return the first two runs of every method that fits, or of those for which there was time."""
    tried: list[_Try] = []
    for method in CANDIDATES if pair.backlash is None else LOCATING:
        if clock.stopped or (tried and not clock.tell()):
            break
        if not STEPPERS[method].undamped or conservative(pair, level):
            first = _first(pair, level, times, method, state, clock)
            second = None if clock.stopped else _halved(first, times, state, clock)
            if second is not None and (not tried or not clock.stopped):
                tried.append(second)
    return tried


def _simulated(
    times: Array, motion: Marched, method: str, error: float, asked: float, spent: int, step: float
) -> Simulated | None:
    """Return a motion as far as it has come; None where that is less than SHORTEST outputs."""
    count = len(motion.states)
    if count < min(SHORTEST, len(times)):
        return None
    met = error <= asked and count == len(times)
    return Simulated(times[:count], motion, method, error, met, spent, step)


def fastest(pair: MovingPair, level: str) -> float:
    """Return the period of the fastest mode at the highest stiffness [s]."""
    phases = np.linspace(0.0, 1.0, 257)
    stiffest = max(float(np.max(pair.wave.value(phases))), float(np.max(pair.wave.after)))
    plane = level if level in ("fixed", "line") else "plane"
    top = modes(linear(pair, plane), stiffest).frequencies[-1]
    harmonic = 2.0 * math.pi * pair.mesh_frequency * max(len(pair.wave.cosines), len(pair.error))
    return 2.0 * math.pi / max(float(top), harmonic)


def _longest_step(pair: MovingPair, level: str, method: str) -> float:
    """Step of the first run by a method [s]."""
    steps = LONGEST_STEPS_PER_PERIOD if method == "rk8" else 4.0 * LONGEST_STEPS_PER_PERIOD
    return fastest(pair, level) / steps


def _check_steps(pair: MovingPair, level: str, end: float) -> None:
    """SolveError where a motion of `end` [s] takes more rates than any run may."""
    period = fastest(pair, level)
    if not end * LONGEST_STEPS_PER_PERIOD <= MAX_RATE_EVALUATIONS * period:
        raise SolveError(
            f"the fastest mode of the pair has a period of {period:.3g} s: a motion of {end:.3g} s "
            f"takes more than {MAX_RATE_EVALUATIONS:,} steps; simulate a shorter time, or check "
            "masses, inertias and stiffnesses"
        )


def _first(
    pair: MovingPair, level: str, times: Timeline, method: str, state: Array, clock: Clock
) -> _Try:
    longest = _longest_step(pair, level, method)
    motion = march(pair, level, times, method, longest, state, clock)
    return _Try(method, longest, motion, math.inf, math.inf, motion.rates)


def _halved(tried: _Try, times: Timeline, state: Array, clock: Clock) -> _Try | None:
    """Return a run of half the steps, with the error that the change between both tells.

    Of the outputs that it has reached where the clock stops; None without any.
    """
    old, half = tried.motion, 0.5 * tried.longest
    while True:
        new = march(old.pair, old.level, times, tried.method, half, state, clock)
        if new.steps > old.steps or clock.stopped:
            break
        half *= 0.5
    if len(new.states) < 2:
        return None
    scale = float(np.max(np.abs(new.delta))) or 1.0
    change = float(np.max(np.abs(new.delta - old.delta[: len(new.states)]))) / scale
    change = change if math.isfinite(change) else math.inf
    falls = tried.change / change if change > 0.0 else math.inf
    order = (
        min(STEPPERS[tried.method].order, IMPACTS) if new.events else STEPPERS[tried.method].order
    )
    falls = min(falls, 2.0**order) if tried.change < math.inf else 1.0
    estimate = SAFETY * change / (falls - 1.0) if falls > SAFETY + 1.0 else change
    error = max(estimate, ROUNDING)
    spent = tried.spent + new.rates
    return replace(tried, longest=half, motion=new, change=change, error=error, spent=spent)


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
    now, maps = np.append(np.asarray(state, float) / scale, 1.0), dict[tuple[float, str], Array]()
    out, clock = np.empty((len(times.starts), 2 * n)), clock or Clock()
    done = len(out)
    for i, (length, k) in enumerate(zip(times.lengths, times.k0, strict=True)):
        if i % PIECES == PIECES - 1 and not clock.tell():
            done = i
            break
        key = float(k), f"{length:.12e}"
        if key not in maps:
            maps[key] = expm(rates[key[0]] * length)
        now = maps[key] @ now
        out[i] = now[:-1] * scale
        clock.evaluations += 1
    whole = np.concatenate([[state], out])[times.asked[times.asked < done] + 1]
    return Marched(pair, level, whole, done, done)


def _rates(pair: MovingPair, level: str, k: float, scale: Array) -> Array:
    """Return A (2 n + 1, 2 n + 1) of y' = A y at a stiffness k [N/mm], column by column."""
    n, law = LEVELS[level]
    matrix = np.zeros((2 * n + 1, 2 * n + 1))
    for j in range(2 * n + 1):
        unit = np.eye(2 * n + 1)[j, :-1] * scale
        matrix[:n, j], matrix[n:-1, j] = unit[n:], law(pair, k, unit[:n], unit[n:])
    matrix[:-1] /= scale[:, None]
    matrix[:-1, :-1] -= matrix[:-1, -1:]
    return matrix
