"""The problem of the least vibration: one block of harmonic balance for every speed.

With `reduced` the balance is solved inside the text instead, so that samplers see five variables.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.formulations.dynamics.orbit.task import (
    MICRO,
    UNITS,
    VARIABLES,
    Task,
    cosine,
    fourier_coefficients,
    measured,
    parts,
    samples,
    wave_samples,
)
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Param, Repeat, Terms, Var

LARGEST = 1000.0  # um, of any coefficient of delta: the end of a search
LOGARITHMIC = ("bearing_stiffness", "face_width")
PEAKS = 8  # speeds whose multipliers are approximated by linear limits
CUTS = PEAKS + 10  # linear limits in the place of one of the multiplier, with those of a region
Cut = tuple[Array, float]  # slopes (5,) and offset


def shared(task: Task) -> tuple[Var, ...]:
    """Return the five variables, with the middle of their ranges as the guess."""
    low, high = task.box()
    variables = []
    for k, name in enumerate(VARIABLES):
        log = name in LOGARITHMIC
        guess = math.sqrt(low[k] * high[k]) if log else 0.5 * (low[k] + high[k])
        key = f"optimise.{name}"
        variables.append(Var(name, UNITS[k], low[k], high[k], guess, log=log, key=key))
    return tuple(variables)


def parameters(task: Task) -> tuple[Param, ...]:
    """Return the limits as parameters."""
    return (
        Param("most_mass", "t", task.most_mass, key="optimise.mass", role="limit"),
        Param(
            "most_displacement",
            "mm",
            task.most_displacement,
            key="optimise.displacement",
            role="limit",
        ),
    )


def limits(task: Task, x: Any, p: Any) -> dict[str, Any]:
    """Return the limits of a design: mass, displacement, and ramps that fit their contacts."""
    built = parts(task, x.bearing_stiffness, x.contact_ratio, x.face_width, x.rim)
    return {
        "mass": (built.masses[0] + built.masses[1]) / p.most_mass,
        "displacement": task.load / x.bearing_stiffness / p.most_displacement,
        "ramp_of_two_pairs": 1.0 + (x.ramp - (x.contact_ratio - 1.0)),
        "ramp_of_one_pair": 1.0 + (x.ramp - (2.0 - x.contact_ratio)),
    }


def problem(task: Task, methods: dict[str, Any] | None = None) -> Problem:
    """Return the problem with 2 H + 1 coefficients of delta a speed, in um.

    minimise the largest measure over the speeds; rows of a speed: the balance of every harmonic
    (equal), the measure under the objective, no separation.
    """
    count = task.harmonics
    top = Var(task.measure, "um", 1e-3, LARGEST, 20.0, log=True, search=True)

    def evaluate(x: Any, p: Any) -> Terms:
        cuts = {"multiplier": _cut(x, p)} if task.most_growth is not None else {}
        return Terms({task.measure: getattr(x, task.measure)}, limits(task, x, p), cuts)

    def balance(x: Any, p: Any, row: Any) -> Terms:
        built = parts(task, x.bearing_stiffness, x.contact_ratio, x.face_width, x.rim)
        mean, cosines, sines = forces(task, x, built, row.omega)
        equal = {"load": -mean / MICRO / task.load}
        for h in range(1, count + 1):
            real, imaginary = receptance(x, built, h * row.omega)
            a, b = real * MICRO, imaginary * MICRO
            nc, ns = cosines[h - 1] / MICRO, sines[h - 1] / MICRO
            equal[f"cosine_{h}"] = 1.0 + (x.cosines[h - 1] - a * nc - b * ns)
            equal[f"sine_{h}"] = 1.0 + (x.sines[h - 1] - a * ns + b * nc)
        defines, kept = judged(task, x)
        return Terms({}, kept, defines, equal)

    rows = 2.0 * math.pi * task.teeth / 60.0 * np.array(task.speeds_rpm)
    repeat = Repeat("speed", _of_a_speed(task), {"omega": rows}, balance)
    variables, given = (*shared(task), top), parameters(task)
    if task.most_growth is not None:
        given = (*given, Param("slopes", "", (0.0,) * (5 * CUTS), 5 * CUTS))
        given = (*given, Param("offsets", "", (1.0,) * CUTS, CUTS))
    return Problem("orbit", variables, given, evaluate, (repeat,), methods or {})


def _of_a_speed(task: Task) -> tuple[Var, ...]:
    """Return the variables of a speed: coefficients of delta, and its ends where they count."""
    largest = -LARGEST, LARGEST
    variables = [
        Var("mean", "um", *largest, -15.0, search=True),
        Var("cosines", "um", *largest, 0.0, task.harmonics, search=True),
        Var("sines", "um", *largest, 0.0, task.harmonics, search=True),
    ]
    if task.measure == "peak_to_peak":
        variables += [Var("lowest", "um", *largest, -20.0, search=True)]
        variables += [Var("highest", "um", *largest, -10.0, search=True)]
    return tuple(variables)


def _cut(x: Any, p: Any) -> tuple[Any, ...]:
    """Return the rows slopes . x <= offset."""
    point = [getattr(x, name) for name in VARIABLES]
    return tuple(
        1.0 + sum(p.slopes[5 * k + i] * v for i, v in enumerate(point)) - p.offsets[k]
        for k in range(CUTS)
    )


def with_cuts(problem: Problem, cuts: Sequence[Cut]) -> Problem:
    """Return the problem with rows slopes . x <= offset, (5,) and a float each, CUTS at most."""
    slopes, offsets = np.zeros((CUTS, 5)), np.ones(CUTS)
    for k, (slope, offset) in enumerate(cuts):
        slopes[k], offsets[k] = slope, offset
    return problem.at(slopes=tuple(map(float, slopes.ravel())), offsets=tuple(map(float, offsets)))


def forces(task: Task, x: Any, made: Any, omega: Any) -> tuple[Any, list[Any], list[Any]]:
    """Return mean, cosines and sines of N = k delta + c delta' [N um/mm], from those of delta."""
    count = task.harmonics
    k = [cosine(made.single, x.contact_ratio, x.ramp, n) for n in range(1, 2 * count + 1)]
    mean = made.mean * x.mean + sum(k[n] * x.cosines[n] for n in range(count)) / 2.0
    cosines, sines = [], []
    for h in range(1, count + 1):
        speed = h * omega * made.mesh_damping
        c = made.mean * x.cosines[h - 1] + k[h - 1] * x.mean + speed * x.sines[h - 1]
        s = made.mean * x.sines[h - 1] - speed * x.cosines[h - 1]
        for n in range(1, 2 * count + 1):
            for m, sign in ((h - n, 1.0), (h + n, 1.0), (n - h, -1.0)):
                if 1 <= m <= count:
                    c = c + k[n - 1] * x.cosines[m - 1] / 2.0
                    s = s + sign * k[n - 1] * x.sines[m - 1] / 2.0
        cosines.append(c)
        sines.append(s)
    return mean, cosines, sines


def receptance(x: Any, made: Any, omega: Any) -> tuple[Any, Any]:
    """Return real and imaginary part of 1/(W^2 m_e) - sum of 1/(k_b - W^2 m + i W c) [mm/N]."""
    real, imaginary = 1.0 / (omega**2 * made.mesh_mass), 0.0
    for m, c in zip(made.masses, made.bearing_damping, strict=True):
        re, im = x.bearing_stiffness - omega**2 * m, omega * c
        real = real - re / (re**2 + im**2)
        imaginary = imaginary + im / (re**2 + im**2)
    return real, imaginary


def judged(task: Task, x: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the rows that hold a speed's measure under the objective, and the limit of parting."""
    count = task.harmonics
    kept: dict[str, Any] = {}
    delta = []
    if task.margin is not None or task.measure != "rms":
        turn = 2.0 * math.pi * np.arange(samples(count)) / samples(count)
        for angle in turn:
            value = x.mean
            for h in range(count):
                value = value + x.cosines[h] * math.cos((h + 1) * angle)
                value = value + x.sines[h] * math.sin((h + 1) * angle)
            delta.append(value)
    if task.margin is not None:
        kept["separation"] = tuple(1.0 + (d + task.margin * MICRO) / 10.0 for d in delta)
    if task.measure == "rms":
        square = sum(x.cosines[h] ** 2 + x.sines[h] ** 2 for h in range(count)) / 2.0
        return {"worst": square / x.rms**2}, kept
    return {
        "worst": 1.0 + (x.highest - x.lowest - x.peak_to_peak) / 10.0,
        "above": tuple(1.0 + (d - x.highest) / 10.0 for d in delta),
        "below": tuple(1.0 + (x.lowest - d) / 10.0 for d in delta),
    }, kept


def reduced(task: Task) -> Problem:
    """Return the problem of the five variables alone: the balance is solved inside its text.

    For samplers: the text cannot be traced, and takes arrays of points at once.
    """
    speeds = np.array(task.speeds_rpm)

    def evaluate(x: Any, p: Any) -> Terms:
        points = np.stack([np.atleast_1d(getattr(x, name)) for name in VARIABLES], axis=-1)
        value, highest = measured(task, fourier_coefficients(task, points, speeds, task.harmonics))
        rows = limits(task, x, p)
        if task.margin is not None:
            top = highest.max(axis=1)
            rows["separation"] = 1.0 + (_as(x, top) + task.margin * MICRO) / 10.0
        return Terms({task.measure: _as(x, value.max(axis=1))}, rows)

    return Problem("orbit", shared(task), parameters(task), evaluate, vectorised=True)


def _as(x: Any, values: Array) -> Any:
    """Return one value a point in the shape of the variables."""
    return values if np.ndim(x.ramp) else float(values[0])


def start(task: Task, whole: Problem, point: Array) -> Array:
    """Return the point of the whole problem that a design (5,) and its own motions make."""
    count, speeds = task.harmonics, np.array(task.speeds_rpm)
    coefficients = fourier_coefficients(task, np.asarray(point)[None], speeds, count)
    value, _ = measured(task, coefficients)
    rows = []
    for row in coefficients[0] * MICRO:
        of_speed = [[row[count].real], 2.0 * row[count + 1 :].real, -2.0 * row[count + 1 :].imag]
        if task.measure == "peak_to_peak":
            delta = (wave_samples(count) @ row).real
            of_speed.append([delta.min(), delta.max()])
        rows.append(np.concatenate(of_speed))
    low, high, _ = whole.bounds()
    point_of_all = np.concatenate([point, [value.max()], *rows])
    return np.asarray(np.clip(point_of_all, low, high))
