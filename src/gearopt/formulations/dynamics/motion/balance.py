"""Periodic motions by harmonic balance: delta as a Fourier series over a period of the mesh.

The axes and the turning are linear and are eliminated: of every harmonic delta_h = R(h W) N_h, with
N the mesh force; 2 H + 1 unknowns are left at every level.
"""

import math
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.motion.linear import Linear, linear
from gearopt.physics.motion.moving_pair import MovingPair

Complex = NDArray[np.complex128]
NEWTON = 12  # steps; near a motion four to six of them end it
NEWTON_TOLERANCE = 1e-12  # change relative to the largest coefficient that ends Newton's method
SAMPLES = 64  # of a period, a harmonic: where the flank changes series converge slowly
LOOKS = 2048  # samples of a period for the extremes


@dataclass(frozen=True)
class Orbit:
    """A periodic motion at a mesh frequency [Hz].

    harmonics (H + 1,): delta_h [mm], delta = delta_0 + 2 Re sum of delta_h exp(2 pi i h f t).
    found: whether Newton's method ended.
    """

    frequency: float
    harmonics: Complex
    found: bool = True

    @property
    def rms(self) -> float:
        """RMS of delta about its mean [mm]."""
        return float(np.sqrt(2.0 * np.sum(np.abs(self.harmonics[1:]) ** 2)))

    def delta(self, count: int) -> Array:
        """Return delta at the phases 0, 1/count, 2/count, ... of a period [mm]; count > 2 H."""
        return _sampled(self.harmonics, count)

    @cached_property
    def extremes(self) -> tuple[float, float]:
        """Least and largest delta [mm]."""
        samples = self.delta(LOOKS)
        return float(samples.min()), float(samples.max())


def _sampled(half: Complex, count: int) -> Array:
    """Return a real series of coefficients (H + 1, ...) at equal phases, (count, ...)."""
    return np.asarray(np.fft.irfft(half, count, axis=0) * count)


def _bare(pair: MovingPair, level: str) -> Linear:
    return linear(replace(pair, damping=0.0, drag=0.0), level)


def _moved(pair: MovingPair, level: str, omegas: Any) -> tuple[Complex, Complex]:
    """Return -q_h/N_h (H, n) and R = delta_h/N_h (H,) of the pair without its mesh [mm/N]."""
    bare, w = _bare(pair, level), np.asarray(omegas, float)[:, None, None]
    dynamic = bare.stiffness - w**2 * np.diag(bare.mass) + 1j * w * bare.damping
    moved = np.linalg.solve(dynamic, bare.direction[:, None])[..., 0]
    return moved, np.asarray(-(moved @ bare.direction))


def receptance(pair: MovingPair, level: str, omegas: Any) -> Complex:
    """Return R = delta_h/N_h of the pair without its mesh at angular frequencies > 0 [mm/N].

    -w' (K - W^2 M + i W C)^-1 w; with axes that do not move 1/(m_e W^2).
    """
    return _moved(pair, level, omegas)[1]


@dataclass(frozen=True)
class _Balance:
    """The equations of a pair, in two-sided coefficients delta_-H ... delta_H.

    A delta = b + s l: l of the force that is lost where teeth are apart; s = -R_h, and 1/mean k in
    the row of the mean, where N_0 = -F takes the place of R.
    """

    pair: MovingPair
    level: str
    frequency: float
    harmonics: int

    @cached_property
    def order(self) -> NDArray[np.int64]:
        """Numbers of the coefficients."""
        return np.arange(-self.harmonics, self.harmonics + 1)

    @cached_property
    def turning(self) -> Complex:
        """Factor i h W of a rate."""
        return np.asarray(2j * math.pi * self.frequency * self.order)

    @cached_property
    def row(self) -> Complex:
        """The factors s."""
        h = self.harmonics
        omegas = 2.0 * math.pi * self.frequency * np.arange(1, h + 1)
        ahead = receptance(self.pair, self.level, omegas)
        mean = 1.0 / self.pair.wave.mean
        return np.asarray(np.concatenate([-np.conj(ahead[::-1]), [mean], -ahead]), complex)

    @cached_property
    def matrix(self) -> Complex:
        """The matrix A, of N_h = sum over m of k_(h-m) delta_m + i h W c delta_h."""
        pair, h = self.pair, self.harmonics
        half = pair.wave.harmonics(2 * h)
        both = np.concatenate([np.conj(half[:0:-1]), half])
        mesh = both[self.order[:, None] - self.order + 2 * h].astype(complex)
        mesh += np.diag((pair.damping + pair.drag) * self.turning)
        system = np.eye(2 * h + 1) + self.row[:, None] * mesh
        system[h, h] -= 1.0
        return np.asarray(system, complex)

    @cached_property
    def right(self) -> Complex:
        """The right side b: the load, and the transmission error."""
        pair, h = self.pair, self.harmonics
        side = np.zeros(2 * h + 1, complex)
        side[h] = -pair.load / pair.wave.mean
        for n, e in enumerate(pair.error[:h], 1):
            side[h + n], side[h - n] = 0.5 * e, 0.5 * np.conj(e)
        return side

    @cached_property
    def stiffness(self) -> Array:
        """Return the mesh stiffness at equal phases."""
        count = SAMPLES * self.harmonics
        return self.pair.wave.value(np.arange(count) / count)

    def newton(self, delta: Complex) -> Complex:
        """Return the change that Newton's method asks for."""
        pair, k, h = self.pair, self.stiffness, self.harmonics
        count, c = k.size, pair.damping
        assert pair.backlash is not None
        both = _sampled(np.stack([delta[h:], (self.turning * delta)[h:]], axis=1), count)
        apart = (both[:, 0] > 0.0) & (both[:, 0] <= pair.backlash)
        coast = both[:, 0] > pair.backlash
        lost = np.where(apart, k * both[:, 0] + c * both[:, 1], 0.0)
        lost[coast] = pair.backlash * k[coast]
        of_lost, of_k, of_c = np.fft.fft([lost, k * apart, c * apart]) / count
        shift = self.order[:, None] - self.order
        slope = self.matrix - self.row[:, None] * (of_k[shift] + of_c[shift] * self.turning)
        wrong = self.matrix @ delta - self.right - self.row * of_lost[self.order]
        return np.asarray(-np.linalg.solve(slope, wrong))


def linear_orbit(pair: MovingPair, level: str, frequency: float, harmonics: int) -> Orbit:
    """Return the motion of a pair whose teeth never part: one linear system (2 H + 1,).

    It holds the exact harmonics k_l of the wave to l = 2 H; N_0 = -F. frequency of the mesh [Hz].
    """
    system = _Balance(pair, level, frequency, harmonics)
    coefficients = np.linalg.solve(system.matrix, system.right)[harmonics:]
    return Orbit(frequency, np.asarray(coefficients, complex))


def orbit(
    pair: MovingPair, level: str, frequency: float, harmonics: int, guess: Orbit | None = None
) -> Orbit:
    """Return a motion of a pair with backlash at a mesh frequency [Hz], by Newton's method.

    guess: a motion near by; None: that of teeth in contact. Both flanks count as in `MovingPair`,
    with the backlash of the axes at rest. `found` is False where Newton's method does not end.
    """
    system = _Balance(pair, level, frequency, harmonics)
    half = np.zeros(harmonics + 1, complex)
    if guess is None:
        half = linear_orbit(pair, level, frequency, harmonics).harmonics
    else:
        count = min(harmonics + 1, len(guess.harmonics))
        half[:count] = guess.harmonics[:count]
    delta = np.concatenate([np.conj(half[:0:-1]), half])
    for _ in range(NEWTON):
        change = system.newton(delta)
        delta = delta + change
        if np.max(np.abs(change)) <= NEWTON_TOLERANCE * np.max(np.abs(delta)):
            return Orbit(frequency, delta[harmonics:])
    return Orbit(frequency, delta[harmonics:], found=False)


def states(pair: MovingPair, level: str, made: Orbit, count: int) -> Array:
    """Return coordinates and velocities of a motion at equal phases, (count, 2 n).

    The axes by q_h = -(K - W^2 M + i W C)^-1 w N_h with N_h = (delta_h - e_h)/R_h, about the place
    to which the load moves them on a line of action that does not turn.
    """
    bare, harmonics = _bare(pair, level), len(made.harmonics) - 1
    n = bare.mass.size
    omegas = 2.0 * math.pi * made.frequency * np.arange(1, harmonics + 1)
    moved, ahead = _moved(pair, level, omegas)
    force = made.harmonics[1:].copy()
    shaken = np.array(pair.error[:harmonics], complex)
    force[: shaken.size] -= 0.5 * shaken
    half = np.zeros((harmonics + 1, n), complex)
    half[1:] = -moved * (force / ahead)[:, None]
    axes = np.arange(n) != n // 2
    half[0, axes] = pair.load * (bare.direction / np.maximum(np.diag(bare.stiffness), 1e-300))[axes]
    half[:, n // 2] = made.harmonics
    rates = half * np.append(0.0, 1j * omegas)[:, None]
    return _sampled(np.hstack([half, rates]), count)
