"""From a moving pair to what a result says of it: equilibrium, response, stability, speeds."""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from gearopt.formulations.dynamics.dynamics_design import (
    Columns,
    Equilibrium,
    Response,
    Speeds,
    Stability,
    Tongue,
)
from gearopt.formulations.motion.balance import Orbit, linear_orbit, orbit
from gearopt.formulations.motion.integrate import march
from gearopt.formulations.motion.simulate import fastest, simulate
from gearopt.formulations.motion.stability import bands, largest, stability_map
from gearopt.formulations.motion.timeline import timeline
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.motion.kinematics import growth
from gearopt.physics.motion.linear import Linear, Static, linear, mesh_shares, modes, static
from gearopt.physics.motion.moving_pair import MovingPair
from gearopt.physics.motion.stiffness_wave import Wave
from gearopt.physics.motion.tongues import tongues

MILLI = 1e3  # ms of a s
Grid = tuple[float, float, int]  # ends and how many, equally far apart
LINES = 400  # of a spectrum that are kept
HARMONICS = 4  # of the wave, whose tongues are listed
WIDEST = 12  # tongues that are listed
ORDERS = 12  # of the mesh frequency, shown over speed
LEAP = 3.0  # times as large as the motion before, or as the linear one: Newton's method has left
SETTLED, KEPT = 200, 8  # periods of a simulation that is to settle, and that are judged then
LOOKS, STEPS = 64, 12.0  # outputs of a period of the mesh; steps in one of the fastest mode


def columns(values: Any, digits: int = 9) -> Columns:
    """Return numbers as a result holds them."""
    return tuple(float(f"{v:.{digits}g}") for v in np.ravel(values))


def equilibrium(pair: MovingPair, level: str) -> Equilibrium:
    """Return the state in which the pair rests under its load, and its modes there."""
    state = static(pair)
    system = around(pair, level, state)
    u, v = state.apart if level != "fixed" else (0.0, 0.0)
    distance = math.hypot(pair.rest.centre_distance + u, v)
    x, y = state.axes[:2]
    held = math.hypot(*(k * s for k, s in zip(pair.pinion.stiffness, (x, y), strict=True)))
    return Equilibrium(
        normal_load_N=state.load,
        mean_stiffness_N_per_mm=pair.wave.mean,
        mesh_mass_kg=1e3 * pair.mesh_mass,
        deformation_mm=state.delta,
        centre_distance_mm=distance,
        centre_distance_growth_mm=distance - pair.rest.centre_distance,
        pressure_angle_deg=math.degrees(math.acos(pair.rest.base_radii / distance)),
        bearing_force_N=held if level != "fixed" else state.load,
        frequencies_Hz=columns(modes(system, pair.wave.mean).hertz),
        mesh_shares=columns(mesh_shares(system, pair.wave.mean)),
    )


def around(pair: MovingPair, level: str, state: Static | None = None) -> Linear:
    """Return the linear system of a level, in the plane around its state under load."""
    return linear(pair, level, (state or static(pair)) if level == "plane" else None)


def resting(pair: MovingPair, level: str) -> Array:
    """Return coordinates and velocities of the equilibrium."""
    state = static(pair)
    x1, y1, x2, y2 = state.axes
    sine, cosine = math.sin(pair.pressure_angle), math.cos(pair.pressure_angle)
    places = {
        "fixed": [state.delta],
        "line": [sine * x1 + cosine * y1, state.delta, sine * x2 + cosine * y2],
        "plane": [x1, y1, state.delta, x2, y2],
    }[level]
    return np.concatenate([places, np.zeros(len(places))])


def response(
    pair: MovingPair,
    level: str,
    span: tuple[float, int],
    error: float,
    from_load: bool,
    clock: Clock,
) -> Response:
    """Return the motion from rest, unloaded or in the equilibrium, to an error that is asked.

    span: how long [s], and how many outputs.
    """
    start, times = resting(pair, level), np.linspace(0.0, *span)
    made = simulate(pair, level, times, error, start if from_load else 0.0 * start, clock)
    delta, later = made.motion.delta, len(times) // 2
    steady = delta[later:] - delta[later:].mean()
    window = np.hanning(steady.size)
    amplitude = 2.0 * np.abs(np.fft.rfft(steady * window)) / window.sum()
    lines = np.fft.rfftfreq(steady.size, times[1] - times[0])
    shown = slice(0, LINES)
    return Response(
        method=made.method,
        error=made.error,
        error_asked=error,
        met=made.met,
        steps=made.motion.steps,
        separations=(made.motion.events + 1) // 2,
        rms_mm=float(steady.std()),
        peak_to_peak_mm=float(np.ptp(delta[later:])),
        highest_mm=float(delta.max()),
        time_ms=columns(MILLI * times),
        deformation_mm=columns(delta, 7),
        axes_mm=tuple(columns(c, 7) for c in _axes(pair, level, made.motion.states)),
        frequency_Hz=columns(lines[shown]),
        amplitude_mm=columns(amplitude[shown], 5),
        jammed_ms=jammed(pair, level, MILLI * times, made.motion.states),
    )


def jammed(pair: MovingPair, level: str, times: Array, states: Array) -> float | None:
    """Return the first of times (T,) at which the coast flank is pressed without any backlash left.

    states (T, 2 n). None: at none of them; on fixed axes or a line the backlash stays as it is.
    """
    if pair.backlash is None or level != "plane":
        return None
    x1, y1, delta, x2, y2 = states.T[:5]
    room = pair.backlash + growth(pair.kinematics, pair.rest, x2 - x1, y2 - y1).length
    found = np.flatnonzero((room < 0.0) & (delta > room))
    return float(times[found[0]]) if found.size else None


def _axes(pair: MovingPair, level: str, states: Array) -> list[Array]:
    """Return x_1, y_1, x_2, y_2 [mm] of states of a level."""
    if level == "fixed":
        return []
    if level == "plane":
        return [states[:, k] for k in (0, 1, 3, 4)]
    sine, cosine = math.sin(pair.pressure_angle), math.cos(pair.pressure_angle)
    return [part * states[:, k] for k in (0, 2) for part in (sine, cosine)]


def scaled(wave: Wave, depth: float) -> Wave:
    """Return a wave of the same mean and shape with another depth (k_max - k_min)/mean."""
    share = depth / own_depth(wave)
    mean = wave.mean
    return Wave(
        wave.edges,
        mean + share * (wave.before - mean),
        mean + share * (wave.after - mean),
        share * wave.cosines,
        share * wave.sines,
    )


def own_depth(wave: Wave) -> float:
    """Return (k_max - k_min)/mean of a wave."""
    phases = np.concatenate([np.linspace(0.0, 1.0, 721), wave.edges])
    ends = np.concatenate([wave.value(phases), wave.straight(phases, True)])
    if len(wave.cosines):
        ends = wave.value(phases)
    return float(np.ptp(ends) / wave.mean)


def stability(
    pair: MovingPair, level: str, across: Grid, up: Grid, clock: Clock
) -> Stability | None:
    """Return multipliers over mesh frequencies [Hz] and depths of the pair's own shape of wave.

    Of the least depths alone where the clock stops; None where it leaves no two of them.
    """
    frequencies, depths = np.linspace(*across), np.linspace(*up)
    system, wave = around(pair, level), pair.wave
    growth = stability_map(system, [scaled(wave, float(d)) for d in depths], frequencies, clock)
    if len(growth) < 2:
        return None
    own = largest(system, wave, frequencies)
    here = None
    if pair.mesh_frequency > 0.0:
        here = float(largest(system, wave, np.array([pair.mesh_frequency]))[0])
    found = [
        Tongue(
            modes=t.modes,
            harmonic=t.harmonic,
            frequency_Hz=t.frequency,
            half_width_percent=100.0 * t.half_width,
            damping_percent=100.0 * t.damping,
        )
        for t in tongues(system, wave, HARMONICS)
        if frequencies[0] <= t.frequency <= frequencies[-1]
    ]
    return Stability(
        frequency_Hz=columns(frequencies),
        depth=columns(depths[: len(growth)]),
        growth=tuple(columns(row, 6) for row in growth),
        unstable_percent=100.0 * float(np.mean(growth > 1.0 + 1e-6)),
        own_depth=own_depth(wave),
        own_frequency_Hz=pair.mesh_frequency,
        here=here,
        bands_Hz=tuple(columns(ends) for ends in bands(frequencies, own)),
        tongues=tuple(found[:WIDEST]),
    )


class Found(NamedTuple):
    """A periodic motion: RMS about its mean, least and largest delta, amplitudes of orders [mm]."""

    rms: float
    least: float
    highest: float
    amplitudes: Array


def over_speeds(
    pair: MovingPair, level: str, teeth: int, grid: Grid, harmonics: int, clock: Clock | None = None
) -> Speeds:
    """Return periodic motions over speeds of the pinion, followed up and down where teeth part.

    grid: least and largest speed [rpm], and how many. Where the clock stops, only the speeds that
    were followed in both directions.
    """
    clock, speeds_rpm = clock or Clock(), np.linspace(*grid)
    frequencies = teeth * np.asarray(speeds_rpm) / 60.0
    rising = followed(pair, level, frequencies, harmonics, clock)
    done = slice(0, len(rising))
    falling = rising
    if pair.backlash is not None:
        falling = followed(pair, level, frequencies[done][::-1], harmonics, clock)[::-1]
        done = slice(len(rising) - len(falling), len(rising))
    speeds_rpm, frequencies, rising = speeds_rpm[done], frequencies[done], rising[done]
    grown = largest(around(pair, level), pair.wave, frequencies)
    return Speeds(
        speed_rpm=columns(speeds_rpm),
        rms_mm=columns([o.rms for o in rising], 7),
        peak_to_peak_mm=columns([o.highest - o.least for o in rising], 7),
        highest_mm=columns([o.highest for o in rising], 7),
        falling_rms_mm=columns([o.rms for o in falling], 7),
        growth=columns(grown, 6),
        harmonics_mm=tuple(columns(row, 5) for row in np.array([o.amplitudes for o in rising]).T),
    )


def followed(
    pair: MovingPair, level: str, frequencies: Array, harmonics: int, clock: Clock
) -> list[Found]:
    """Return the motions at frequencies [Hz], by harmonic balance, each from the one before.

    Linear ones are solved. Where Newton's method does not end, or leaps, the motion is the one that
    a simulation of SETTLED periods from the equilibrium comes to. Of the first alone where the
    clock stops.
    """
    found: list[Found] = []
    last: Orbit | None = None
    for frequency in frequencies:
        if not clock.tell():
            break
        simple = linear_orbit(pair, level, float(frequency), harmonics)
        made = simple
        if pair.backlash is not None and (simple.extremes[1] > 0.0 or last is not None):
            made = orbit(pair, level, float(frequency), harmonics, last or simple)
        leaps = not made.found or (found and made.rms > LEAP * max(found[-1].rms, simple.rms))
        if leaps and simple.extremes[1] <= 0.0:
            made, leaps = simple, False
        if leaps:
            kept, made = _settled(pair, level, float(frequency))
        found.append(kept if leaps else _balanced(made))
        last = made if made.extremes[1] > 0.0 else None
    return found


def _balanced(made: Orbit) -> Found:
    amplitudes = np.zeros(ORDERS)
    orders = 2.0 * np.abs(made.harmonics[1 : ORDERS + 1])
    amplitudes[: orders.size] = orders
    return Found(made.rms, *made.extremes, amplitudes)


def _settled(pair: MovingPair, level: str, frequency: float) -> tuple[Found, Orbit]:
    """Return what a simulation comes to over its last KEPT periods, and as the next one's guess."""
    slow = replace(pair, mesh_frequency=frequency)
    times = np.arange((SETTLED + KEPT) * LOOKS) / (LOOKS * frequency)
    longest = fastest(slow, level) / STEPS
    start = resting(pair, level)
    delta = march(slow, level, timeline(slow, times), "rk8", longest, start).delta[-KEPT * LOOKS :]
    lines = np.fft.rfft(delta)[::KEPT] / delta.size
    orders = 2.0 * np.abs(lines[1 : ORDERS + 1])
    kept = Found(float(delta.std()), float(delta.min()), float(delta.max()), orders)
    return kept, Orbit(frequency, lines)
