"""From a moving pair to a result's parts: equilibrium, response, stability, speeds."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.dynamics.design import (
    Columns,
    DynamicError,
    Equilibrium,
    Gaps,
    Response,
    Stability,
    Tongue,
    ToothLoad,
)
from gearopt.formulations.dynamics.motion.simulate import simulate
from gearopt.formulations.dynamics.motion.stability import (
    UNSTABLE,
    bands,
    largest,
    ready,
    stability_map,
)
from gearopt.formulations.dynamics.tooth_load import dynamic_factor, extent, load_over, tooth_load
from gearopt.formulations.pair.design import ContactLoad, PairContact, PairRelief
from gearopt.formulations.pair.flank_design import FlankContact, FlankLoad
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.motion.kinematics import growth
from gearopt.physics.motion.linear import (
    Linear,
    Static,
    linear,
    mesh_shares,
    modes,
    static,
    tongues,
)
from gearopt.physics.motion.moving_pair import MovingPair
from gearopt.physics.motion.stiffness_wave import Wave

Contact = PairContact | FlankContact  # of spur gears, or by slices of the face
MILLI = 1e3  # ms of a s
Grid = tuple[float, float, int]  # ends and how many, equally far apart
LINES = 400  # of a spectrum that are kept
HARMONICS = 4  # of the wave, whose tongues are listed
WIDEST = 12  # tongues that are listed


def columns(values: Any, digits: int = 9) -> Columns:
    """Return numbers as a result holds them."""
    return tuple(float(f"{v:.{digits}g}") for v in np.ravel(values))


def gaps(values: Any, digits: int) -> Gaps:
    """Return numbers as a result holds them, None for those that are none."""
    return tuple(v if math.isfinite(v) else None for v in columns(values, digits))


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
) -> Response | None:
    """Return the motion from rest, unloaded or in the equilibrium, to an error that is asked.

    span: how long [s], and how many outputs. Where the clock stops, a motion of less error or of
    less time; None where there is none as yet.
    """
    start, times = resting(pair, level), np.linspace(0.0, *span)
    simulated = simulate(pair, level, times, error, start if from_load else 0.0 * start, clock)
    if simulated is None:
        return None
    times, delta = simulated.times, simulated.motion.delta
    later = len(times) // 2
    steady = delta[later:] - delta[later:].mean()
    states = simulated.motion.states
    load = load_over(pair, level, times[later:], states[later:])
    stiffness = pair.wave.value(pair.mesh_frequency * times)
    lag = pair.error_at(pair.mesh_frequency * times) - delta
    lines, amplitude = _spectrum(steady, times[1] - times[0])
    digits = max(7, 2 - math.floor(math.log10(error)))  # more than the error that is asked
    return Response(
        method=simulated.method,
        error=simulated.error,
        error_asked=error,
        met=simulated.met,
        steps=simulated.motion.steps,
        separations=(simulated.motion.events + 1) // 2,
        rms_mm=float(steady.std()),
        peak_to_peak_mm=float(np.ptp(delta[later:])),
        highest_mm=float(delta.max()),
        time_ms=columns(MILLI * times, 15),
        deformation_mm=columns(delta, digits),
        axes_mm=tuple(columns(c, digits) for c in _axes(pair, level, states)),
        frequency_Hz=columns(lines),
        amplitude_mm=columns(amplitude, 5),
        jammed_ms=None if simulated.motion.jammed is None else MILLI * simulated.motion.jammed,
        steady_ms=MILLI * simulated.steady if simulated.steady < math.inf else None,
        tooth_load=ToothLoad(
            maximum_N=load.most,
            minimum_N=load.least,
            rms_N=load.rms,
            dynamic_factor=dynamic_factor(load, pair.load),
        ),
        load_N=columns(tooth_load(pair, level, states, stiffness), 6),
        transmission_error=_error(lag, later, digits) if pair.error else None,
    )


def _error(lag: Array, later: int, digits: int) -> DynamicError:
    """Return the transmission error of a motion, its extent from an index on."""
    rms, height, most = extent(lag[later:])
    return DynamicError(
        rms_mm=rms, peak_to_peak_mm=height, highest_mm=most, values_mm=columns(lag, digits)
    )


def _spectrum(values: Array, step: float) -> tuple[Array, Array]:
    """Return frequencies [Hz] and amplitudes of values about zero at equal steps of time [s]."""
    window = np.hanning(values.size)
    amplitude = 2.0 * np.abs(np.fft.rfft(values * window)) / window.sum()
    return np.asarray(np.fft.rfftfreq(values.size, step)[:LINES]), amplitude[:LINES]


def jammed(pair: MovingPair, level: str, states: Array) -> NDArray[np.bool_]:
    """Return whether both flanks are pressed at once at states (T, 2 n), as the axes came together.

    room < delta < 0; on fixed axes or a line the backlash stays as it is.
    """
    if pair.backlash is None or level != "plane":
        return np.zeros(len(states), bool)
    x1, y1, delta, x2, y2 = states.T[:5]
    room = pair.backlash + growth(pair.kinematics, pair.rest, x2 - x1, y2 - y1).length
    return np.asarray((room < delta) & (delta < 0.0))


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
    mine = np.array([pair.mesh_frequency] if pair.mesh_frequency > 0.0 else [])
    ready(system, wave, clock)
    multipliers = largest(system, wave, np.append(mine, frequencies), clock)
    clock.evaluations += len(multipliers)
    waves = [scaled(wave, float(d)) for d in depths]
    growth, error = stability_map(system, waves, frequencies, clock)
    if len(growth) < 2:
        return None
    here, multipliers = (float(multipliers[0]) if mine.size else None), multipliers[mine.size :]
    unstable = bands(frequencies, multipliers > 1.0 + UNSTABLE)
    widest = [
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
        unstable_percent=100.0 * float(np.mean(growth > 1.0 + UNSTABLE)),
        own_depth=own_depth(wave),
        own_frequency_Hz=pair.mesh_frequency,
        here=here,
        bands_Hz=tuple(columns(ends) for ends in unstable),
        tongues=tuple(widest[:WIDEST]),
        error=error if math.isfinite(error) else None,
    )


def nearest_load(loads: Sequence[Any], force: float) -> Any:
    """Return the load whose normal force is nearest to `force` [N], the first of equally near."""
    return min(loads, key=lambda load: abs(load.normal_force_N - force))


def unloaded_error(contact: PairContact, relief: PairRelief | None) -> Columns:
    """Return by how much unloaded teeth are apart at every travel of a contact [mm].

    The least depth removed from the flanks of a pair of teeth in contact.
    """
    travel = np.array(contact.travel_mm)
    if relief is None:
        return (0.0,) * travel.size
    removed = np.array(relief.pinion_removed_mm) + np.array(relief.wheel_removed_mm)
    place = np.array(contact.position_mm) - contact.position_mm[0]
    pairs = np.arange(math.ceil(contact.contact_ratio))[:, None]
    each = np.interp(travel + pairs * contact.base_pitch_mm, place, removed, right=math.inf)
    return tuple(map(float, each.min(axis=0)))


def error_harmonics(contact: Contact, error: Columns, count: int) -> tuple[complex, ...]:
    """Return e_1 to e_count of an error at every travel of a contact, as `MovingPair` has them."""
    phase = np.array(contact.travel_mm) / contact.base_pitch_mm
    edges, first = np.unique(phase, return_index=True)
    after = np.searchsorted(phase, edges, "right") - 1
    inside = edges < 1.0 - 1e-12
    values = np.array(error)
    curve = Wave(edges[inside], values[first][inside], values[after][inside])
    return tuple(complex(2.0 * c) for c in curve.harmonics(count)[1:])


def of_contact(contact: Contact, load: ContactLoad | FlankLoad, unloaded: Any = 0.0) -> Wave:
    """Return normal force over transmission error of a pair's own teeth at one of its loads.

    With this stiffness the normal force deforms the mesh by the transmission error, relief and all,
    less the part of it that counts as an error of unloaded teeth [mm], at every travel. Both sides
    of the points where pairs come and go are a step of the wave. load: of the contact, or of its
    relief.
    """
    phase = np.array(contact.travel_mm) / contact.base_pitch_mm
    stiffness = load.normal_force_N / (np.array(load.transmission_error_mm) - np.array(unloaded))
    inside = (phase > 1e-12) & (phase < 1.0 - 1e-12)
    edges = np.unique(phase[inside])
    left = np.array([stiffness[phase == e][0] for e in edges])
    right = np.array([stiffness[phase == e][-1] for e in edges])
    return Wave(
        np.concatenate([[0.0], edges]),
        np.concatenate([[stiffness[-1]], left]),
        np.concatenate([[stiffness[0]], right]),
    )
