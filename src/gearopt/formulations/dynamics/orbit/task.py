"""Limits and ranges of a pair over a range of speeds, and the periodic motions of a design."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.motion.moving_pair import MovingPair, Rotor, damping_of
from gearopt.physics.motion.stiffness_wave import PAIR_SHARE, of_contact_ratio

VARIABLES = ("bearing_stiffness", "contact_ratio", "ramp", "face_width", "rim")
UNITS = ("N/mm", "", "", "mm", "")
MICRO = 1e3  # um of a mm


@dataclass(frozen=True)
class Task:
    """A pair of gears as discs on bearings, driven at a torque over speeds of the pinion.

    torque [N mm] of the pinion; base_radii and radii r_b, r [mm] of both (discs of the radii r
    carry the masses); teeth of the pinion; pressure_angle [rad]; density [t/mm3]; single c' [MPa];
    mesh_damping and bearing_damping: ratios zeta. speeds_rpm: where the motion is judged. ranges:
    (minimum, maximum) of VARIABLES. most_mass [t]; most_displacement F/k_b [mm]; margin [mm]: of
    the teeth from parting, None: not asked. most_growth: of the largest Floquet multiplier over all
    speeds, None: not asked. measure: "rms" or "peak_to_peak" of delta. harmonics of a motion whose
    teeth stay in contact. backlash [mm]: teeth may part; then motions are collocated in so many
    elements of a mesh period, and repeat after so many periods. None: a linear mesh. always: the
    mesh damps teeth that are apart, too.
    """

    torque: float
    base_radii: tuple[float, float]
    radii: tuple[float, float]
    teeth: int
    pressure_angle: float
    density: float
    single: float
    mesh_damping: float
    bearing_damping: float
    speeds_rpm: tuple[float, ...]
    ranges: dict[str, tuple[float, float]]
    most_mass: float
    most_displacement: float
    margin: float | None = None
    most_growth: float | None = None
    measure: str = "rms"
    harmonics: int = 10
    backlash: float | None = None
    elements: int = 24
    periods: int = 1
    always: bool = False

    @property
    def load(self) -> float:
        """F = T/r_b1 [N], the torques in balance."""
        return self.torque / self.base_radii[0]

    def box(self) -> tuple[Array, Array]:
        """Return lower and upper bounds of VARIABLES, (5,) each."""
        ends = np.array([self.ranges[name] for name in VARIABLES], float)
        return ends[:, 0], ends[:, 1]


class Parts(NamedTuple):
    """Parts of a design: masses [t], m_e [t], stiffnesses [N/mm], damping [N s/mm]."""

    masses: tuple[Any, Any]
    mesh_mass: Any
    single: Any
    mean: Any
    mesh_damping: Any
    bearing_damping: tuple[Any, Any]


def solid(task: Task) -> float:
    """Return rho pi (r_1^2 + r_2^2) [t/mm]: the mass of both gears is this times b lambda."""
    return task.density * math.pi * sum(r**2 for r in task.radii)


def parts(task: Task, stiffness: Any, contact_ratio: Any, face_width: Any, rim: Any) -> Parts:
    """Return the parts of a design: m_i = rho pi r_i^2 b lambda, I_i = m_i r_i^2/2, k_s = c' b.

    The mean stiffness is k_s (0.25 + 0.75 eps); c = 2 zeta sqrt(k m) of the mesh, at the mean, and
    of each bearing. Arrays, floats or casadi scalars.
    """
    disc = task.density * math.pi * face_width * rim
    m1, m2 = (disc * r**2 for r in task.radii)
    inverse = sum(
        2.0 * rb**2 / (m * r**2)
        for rb, m, r in zip(task.base_radii, (m1, m2), task.radii, strict=True)
    )
    single = task.single * face_width
    mean = single * (1.0 - PAIR_SHARE + PAIR_SHARE * contact_ratio)
    mesh = 2.0 * task.mesh_damping * np.sqrt(mean / inverse)
    held = tuple(2.0 * task.bearing_damping * np.sqrt(stiffness * m) for m in (m1, m2))
    return Parts((m1, m2), 1.0 / inverse, single, mean, mesh, (held[0], held[1]))


def cosine(single: Any, contact_ratio: Any, ramp: Any, order: int) -> Any:
    """Return k_l of k = mean + sum of k_l cos(2 pi l phase) [N/mm], two pairs in the middle of it.

    0.75 k_s 2/(l pi) sin(l pi (eps - 1)) sin(l pi r)/(l pi r): the trapezoid of
    `stiffness_wave.of_contact_ratio`.
    """
    turn = order * math.pi
    flat = PAIR_SHARE * single * 2.0 / turn * np.sin(turn * (contact_ratio - 1.0))
    return flat * np.sin(turn * ramp) / (turn * ramp)


def fourier_coefficients(task: Task, points: Array, speeds_rpm: Array, harmonics: int) -> Array:
    """Return delta_-H to delta_H [mm] of designs (N, 5) at speeds (K,) [rpm], (N, K, 2 H + 1)."""
    kb, ratio, ramp, width, rim = points.T[:, :, None]
    built = parts(task, kb, ratio, width, rim)
    order = np.arange(-harmonics, harmonics + 1)
    waves = [cosine(built.single, ratio, ramp, n) / 2.0 for n in range(1, 2 * harmonics + 1)]
    half = np.concatenate(waves, axis=1)
    both = np.concatenate([half[:, ::-1], built.mean, half], axis=1)
    mesh = both[:, order[:, None] - order[None, :] + 2 * harmonics][:, None].astype(complex)
    omega = order * (2.0 * math.pi * task.teeth / 60.0 * np.asarray(speeds_rpm))[:, None]
    rows = np.arange(order.size)
    mesh = np.repeat(mesh, len(omega), axis=1)
    mesh[:, :, rows, rows] += 1j * omega * built.mesh_damping[:, :, None]
    with np.errstate(divide="ignore"):
        answer = 1.0 / (omega**2 * built.mesh_mass[:, :, None]) + 0j
    for m, c in zip(built.masses, built.bearing_damping, strict=True):
        k, m, c = kb[:, :, None], m[:, :, None], c[:, :, None]
        answer = answer - 1.0 / (k - omega**2 * m + 1j * omega * c)
    matrix = np.eye(order.size) - np.where(order == 0, 0.0, answer)[..., None] * mesh
    matrix[:, :, harmonics] = mesh[:, :, harmonics] / built.mean[:, :, None]
    right = np.zeros((*matrix.shape[:3], 1), complex)
    right[:, :, harmonics, 0] = -task.load / built.mean
    return np.asarray(np.linalg.solve(matrix, right)[..., 0])


def measured(task: Task, found: Array) -> tuple[Array, Array]:
    """Return the measure [um] and the largest delta [um] of series (..., 2 H + 1)."""
    harmonics = found.shape[-1] // 2
    waves = wave_samples(harmonics)
    delta = (found @ waves.T).real * MICRO
    if task.measure == "rms":
        square = np.sum(np.abs(found) ** 2, axis=-1) - np.abs(found[..., harmonics]) ** 2
        return np.sqrt(square) * MICRO, delta.max(axis=-1)
    return np.ptp(delta, axis=-1), delta.max(axis=-1)


def wave_samples(harmonics: int) -> Array:
    """Return exp(2 pi i h phase) at SAMPLES a harmonic, (samples, 2 H + 1)."""
    phase = np.arange(samples(harmonics)) / samples(harmonics)
    order = np.arange(-harmonics, harmonics + 1)
    return np.asarray(np.exp(2j * math.pi * np.outer(phase, order)))


def samples(harmonics: int) -> int:
    """Return at how many phases extremes are looked for."""
    return 6 * harmonics


def worst(task: Task, point: Array, speeds_rpm: Array, harmonics: int) -> Array:
    """Return the measure [um] of one design at speeds (K,)."""
    measures = measured(
        task, fourier_coefficients(task, np.asarray(point)[None], speeds_rpm, harmonics)
    )[0]
    return np.asarray(measures[0])


def pair_of(task: Task, point: Sequence[float] | Array, speed_rpm: float) -> MovingPair:
    """Return a design as a pair on the line of action, to simulate it and for its multipliers."""
    kb, ratio, ramp, width, rim = (float(v) for v in point)
    built = parts(task, kb, ratio, width, rim)
    rotors = [
        Rotor(rb, float(m), float(0.5 * m * r**2), (kb, kb), (float(c), float(c)), torque)
        for rb, m, r, c, torque in zip(
            task.base_radii,
            built.masses,
            task.radii,
            built.bearing_damping,
            (task.torque, task.torque * task.base_radii[1] / task.base_radii[0]),
            strict=True,
        )
    ]
    fits = min(ramp, ratio - 1.0, 2.0 - ratio)  # limits are met to 1e-8
    wave = of_contact_ratio(float(built.single), ratio, fits)
    damping = damping_of(task.mesh_damping, wave.mean, float(built.mesh_mass))
    return MovingPair(
        rotors[0],
        rotors[1],
        task.pressure_angle,
        wave,
        task.teeth * speed_rpm / 60.0,
        damping=0.0 if task.always else damping,
        drag=damping if task.always else 0.0,
        backlash=task.backlash,
        kinematics="tangent",
    )
