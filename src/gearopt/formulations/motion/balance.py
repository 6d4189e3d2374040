"""Periodic motions by harmonic balance: delta as a Fourier series over a period of the mesh.

The axes and the turning are linear and are eliminated: of every harmonic delta_h = R(h W) N_h, with
N the mesh force; 2 H + 1 unknowns are left at every level.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.optimise.terms import Array
from gearopt.physics.motion.linear import linear
from gearopt.physics.motion.moving_pair import MovingPair

Complex = NDArray[np.complex128]
NEWTON, CLOSE = (
    40,
    1e-12,
)  # steps, and the change relative to the largest coefficient that ends them
SAMPLES = 16  # of a period, a harmonic: where the flank changes series converge slowly
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

    def delta(self, phase: Array) -> Array:
        """Return delta at phases of the mesh [mm]."""
        orders = np.arange(1, len(self.harmonics))
        waves = np.exp(2j * math.pi * np.multiply.outer(phase, orders)) @ self.harmonics[1:]
        return np.asarray(self.harmonics[0].real + 2.0 * waves.real)

    @property
    def extremes(self) -> tuple[float, float]:
        """Least and largest delta [mm]."""
        found = self.delta(np.arange(LOOKS) / LOOKS)
        return float(found.min()), float(found.max())


def receptance(pair: MovingPair, level: str, omegas: Any) -> Complex:
    """Return R = delta_h/N_h of the pair without its mesh at angular frequencies > 0 [mm/N].

    -w' (K - W^2 M + i W C)^-1 w; with axes that do not move 1/(m_e W^2).
    """
    bare = linear(replace(pair, damping=0.0, drag=0.0), level)
    w = np.asarray(omegas, float)[:, None, None]
    dynamic = bare.stiffness - w**2 * np.diag(bare.mass) + 1j * w * bare.damping
    moved = np.linalg.solve(dynamic, bare.direction[:, None])
    return np.asarray(-(moved[..., 0] @ bare.direction))


def linear_orbit(pair: MovingPair, level: str, frequency: float, harmonics: int) -> Orbit:
    """Return the motion of a pair whose teeth never part: one linear system (2 H + 1,).

    N_h = sum over m of k_(h-m) delta_m + i h W c delta_h with the exact harmonics k_l of the wave,
    to l = 2 H; N_0 = -F.
    """
    order, wave = np.arange(-harmonics, harmonics + 1), pair.wave
    half = wave.harmonics(2 * harmonics)
    both = np.concatenate([np.conj(half[:0:-1]), half])
    omega = 2.0 * math.pi * frequency
    mesh = both[order[:, None] - order[None, :] + 2 * harmonics].astype(complex)
    mesh += np.diag(1j * order * omega * (pair.damping + pair.drag))
    ahead = receptance(pair, level, omega * np.arange(1, harmonics + 1))
    answer = np.concatenate([np.conj(ahead[::-1]), [0.0], ahead])
    matrix = np.eye(order.size) - answer[:, None] * mesh
    matrix[harmonics] = mesh[harmonics] / wave.mean
    right = np.zeros(order.size, complex)
    right[harmonics] = -pair.load / wave.mean
    for h, a in enumerate(pair.error[:harmonics], 1):
        right[harmonics + h] = right[harmonics - h] = 0.5 * a
    return Orbit(frequency, np.linalg.solve(matrix, right)[harmonics:])


@dataclass(frozen=True)
class _Balance:
    """The equations of a pair with backlash, in real coefficients (mean, cosines, sines)."""

    pair: MovingPair
    level: str
    harmonics: int

    @cached_property
    def phases(self) -> Array:
        """Phases at which the force is sampled."""
        count = SAMPLES * self.harmonics
        return (np.arange(count) + 0.5) / count

    @cached_property
    def stiffness(self) -> Array:
        """Return the mesh stiffness at the phases."""
        return self.pair.wave.value(self.phases)

    @cached_property
    def basis(self) -> Array:
        """Values of 1, cos, sin at the phases, (samples, 2 H + 1)."""
        angle = 2.0 * math.pi * np.outer(self.phases, np.arange(1, self.harmonics + 1))
        return np.hstack([np.ones((len(angle), 1)), np.cos(angle), np.sin(angle)])

    @cached_property
    def turned(self) -> Array:
        """Derivative of the basis by the angle of the mesh."""
        h = self.harmonics
        found = np.hstack(
            [np.zeros((len(self.basis), 1)), -self.basis[:, h + 1 :], self.basis[:, 1 : h + 1]]
        )
        found[:, 1:] *= np.tile(np.arange(1.0, h + 1.0), 2)
        return found

    def equations(self, q: Array, frequency: float) -> tuple[Array, Array, Array]:
        """Return residuals (2 H + 1,), their derivatives by q, and by the frequency [Hz]."""
        step = 1e-6 * frequency
        found, slopes = self.at(q, frequency)
        moved = [self.at(q, frequency + s * step)[0] for s in (1.0, -1.0)]
        return found, slopes, (moved[0] - moved[1]) / (2.0 * step)

    def at(self, q: Array, frequency: float) -> tuple[Array, Array]:
        """Return residuals and their derivatives by q."""
        pair, h, basis = self.pair, self.harmonics, self.basis
        omega = 2.0 * math.pi * frequency
        rates, k = omega * self.turned, self.stiffness
        delta, rate = basis @ q, rates @ q
        room = math.inf if pair.backlash is None else pair.backlash
        pressed = (delta < 0.0) | (delta > room) | (pair.backlash is None)
        base = np.where(delta > room, room if room < math.inf else 0.0, 0.0)
        force = np.where(pressed, k * (delta - base) + pair.damping * rate, 0.0)
        force += pair.drag * rate
        slope = np.where(pressed, k, 0.0)[:, None] * basis
        slope += (np.where(pressed, pair.damping, 0.0) + pair.drag)[:, None] * rates
        back = basis.T * (2.0 / len(basis))
        back[0] *= 0.5
        of_force, by_q = back @ force, back @ slope
        answer = receptance(pair, self.level, omega * np.arange(1, h + 1))
        a, b = answer.real, answer.imag
        residual, jacobian = q.copy(), np.eye(2 * h + 1)
        cosines, sines = slice(1, h + 1), slice(h + 1, 2 * h + 1)
        # delta_h = (cos - i sin)/2: (a + i b)(n_c - i n_s)
        residual[cosines] -= a * of_force[cosines] + b * of_force[sines]
        residual[sines] -= a * of_force[sines] - b * of_force[cosines]
        jacobian[cosines] -= a[:, None] * by_q[cosines] + b[:, None] * by_q[sines]
        jacobian[sines] -= a[:, None] * by_q[sines] - b[:, None] * by_q[cosines]
        for n, e in enumerate(pair.error[:h], 1):
            residual[n] -= e
        residual[0] = (of_force[0] + pair.load) / pair.wave.mean
        jacobian[0] = by_q[0] / pair.wave.mean
        return residual, jacobian


def orbit(
    pair: MovingPair, level: str, frequency: float, harmonics: int, guess: Orbit | None = None
) -> Orbit:
    """Return a motion of a pair with backlash at a mesh frequency [Hz], by Newton's method.

    guess: a motion near by; None: the static state. Both flanks count as in `MovingPair`, with the
    backlash of the axes at rest. `found` is False where Newton's method does not end.
    """
    system, q = _Balance(pair, level, harmonics), _real(guess, pair, harmonics)
    for _ in range(NEWTON):
        residual, slopes = system.at(q, frequency)
        change = np.linalg.solve(slopes, residual)
        q = q - change
        if np.max(np.abs(change)) <= CLOSE * np.max(np.abs(q)):
            return Orbit(frequency, _complex(q))
    return Orbit(frequency, _complex(q), found=False)


def branch(
    pair: MovingPair, level: str, frequencies: tuple[float, float], harmonics: int, step: float
) -> Iterator[Orbit]:
    """Yield the motions along a branch from one mesh frequency to another [Hz], round its folds.

    Pseudo-arclength continuation: frequency and coefficients, each over its scale, are unknowns;
    step: the arc between two motions (frequency over the first one counts 1), halved where Newton's
    method fails, up to 2^-12. At a fold the frequency turns back: there a sweep jumps.
    """
    system, first = _Balance(pair, level, harmonics), frequencies[0]
    sign = math.copysign(1.0, frequencies[1] - first)
    last = orbit(pair, level, first, harmonics)
    size = abs(pair.load) / pair.wave.mean
    point = np.append(_real(last, pair, harmonics) / size, 1.0)
    yield last
    before, arc = np.append(np.zeros(point.size - 1), sign), step
    while True:
        _, slopes, by_f = system.equations(point[:-1] * size, point[-1] * first)
        whole = np.column_stack([slopes * size, by_f * first]) / size
        tangent = np.linalg.solve(np.vstack([whole, before]), np.append(np.zeros(len(whole)), 1.0))
        tangent /= np.linalg.norm(tangent)
        slope = by_f * first / size
        found = _corrected(system, point + arc * tangent, tangent, slope, size, first)
        if found is None:
            arc *= 0.5
            if arc < step / 4096.0:
                return
            continue
        point, before, arc = found, tangent, min(step, 1.5 * arc)
        yield Orbit(float(point[-1] * first), _complex(point[:-1] * size))
        past = sign * (point[-1] * first - frequencies[1]) >= 0.0
        if past or sign * (point[-1] - 1.0) < -1e-9:
            return


def _corrected(
    system: _Balance, guess: Array, tangent: Array, slope: Array, size: float, first: float
) -> Array | None:
    """Return the point of a branch in the plane across its tangent at a guess.

    slope: of the residuals by the frequency where the tangent was taken, which is near enough.
    """
    point = guess.copy()
    for _ in range(16):
        residual, slopes = system.at(point[:-1] * size, point[-1] * first)
        whole = np.vstack([np.column_stack([slopes, slope]), tangent])
        wrong = np.append(residual / size, tangent @ (point - guess))
        change = np.linalg.solve(whole, wrong)
        point = point - change
        if np.max(np.abs(change)) < 1e-10 * np.max(np.abs(point)):
            return point
    return None


def _real(guess: Orbit | None, pair: MovingPair, harmonics: int) -> Array:
    found = np.zeros(2 * harmonics + 1)
    if guess is None:
        found[0] = -pair.load / pair.wave.mean
        return found
    count = min(harmonics, len(guess.harmonics) - 1)
    found[0] = guess.harmonics[0].real
    found[1 : count + 1] = 2.0 * guess.harmonics[1 : count + 1].real
    found[harmonics + 1 : harmonics + count + 1] = -2.0 * guess.harmonics[1 : count + 1].imag
    return found


def _complex(q: Array) -> Complex:
    h = len(q) // 2
    return np.concatenate([[q[0] + 0j], 0.5 * (q[1 : h + 1] - 1j * q[h + 1 :])])
