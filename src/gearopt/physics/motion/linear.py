"""The pair as a linear system around a state: static states, natural frequencies, modes, tongues.

M q'' + C q' + (K + k w w') q = f with q = (x_1, y_1, s, x_2, y_2), or fewer at lower levels, and
w' q = delta. mm, N, t, s. A periodic stiffness k = mean (1 + sum of a_l cos(2 pi l f t)) makes it
unstable, to first order, in tongues that begin at l f = 2 f_p of a mode p, or at l f = f_p + f_q of
two (combination), and widen with a_l.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearopt.frozen import dataclass
from gearopt.physics.motion.accelerations import stiffness_along
from gearopt.physics.motion.moving_pair import MovingPair
from gearopt.physics.motion.stiffness_wave import Wave

Array = NDArray[np.float64]
# Newton's steps to a static state, and the change that ends them
NEWTON_STEPS, NEWTON_TOLERANCE = 60, 1e-14


@dataclass(frozen=True)
class Linear:
    """Masses (n,), stiffness (n, n) without the mesh, damping (n, n), direction w (n,)."""

    mass: Array
    stiffness: Array
    damping: Array
    direction: Array

    def with_mesh(self, stiffness: float) -> Array:
        """Return K + k w w' (n, n) [N/mm]."""
        return self.stiffness + stiffness * np.outer(self.direction, self.direction)


@dataclass(frozen=True)
class Static:
    """Relative equilibrium: displacements x_1, y_1, x_2, y_2 and delta [mm], normal load [N]."""

    axes: Array
    delta: float
    load: float

    @property
    def apart(self) -> tuple[float, float]:
        """Displacement u, v of axis 2 against axis 1 [mm]."""
        x1, y1, x2, y2 = self.axes
        return float(x2 - x1), float(y2 - y1)


def static(pair: MovingPair) -> Static:
    """Return the state in which delta and the axes rest under the load F, at the mean stiffness.

    N = -F for every kinematics; the gears may speed up meanwhile. Newton from the linear state.
    """
    load = pair.load
    held = np.array([*pair.pinion.stiffness, *pair.wheel.stiffness])
    slope = np.array(pair.contact(0.0, 0.0).gradient)
    axes = np.concatenate([-slope, slope]) * load / held
    for _ in range(NEWTON_STEPS):
        contact = pair.contact(*(axes[2:] - axes[:2]))
        gradient = np.array(contact.gradient)
        rest = held * axes + load * np.concatenate([gradient, -gradient])
        suu, suv, svv = contact.curvature
        block = load * np.array([[suu, suv], [suv, svv]])
        step = np.linalg.solve(np.diag(held) + np.block([[-block, block], [block, -block]]), rest)
        axes = axes - step
        if np.max(np.abs(step)) <= NEWTON_TOLERANCE * np.max(np.abs(axes)):
            break
    return Static(axes, -load / pair.wave.mean, load)


def linear(pair: MovingPair, level: str, state: Static | None = None) -> Linear:
    """Return the linear system of a level, around a static state or the unloaded one.

    Around a state under load the second derivatives of g add the geometric stiffness N S, which
    acts across the line of action. Levels `fixed`, `line`, `plane`.
    """
    p, w = pair.rotors
    c = pair.damping
    if level == "fixed":
        unit = np.ones(1)
        return Linear(
            pair.mesh_mass * unit, np.zeros((1, 1)), (c + pair.drag) * unit[:, None], -unit
        )
    if level == "line":
        held = [stiffness_along(pair, r) for r in pair.rotors]
        mass = np.array([p.mass, pair.mesh_mass, w.mass])
        k, d = (np.diag([held[0][i], 0.0, held[1][i]]) for i in range(2))
        direction = np.array([-1.0, -1.0, 1.0])
    else:
        contact = pair.contact(*(state.apart if state else (0.0, 0.0)))
        gu, gv = contact.gradient
        direction = np.array([-gu, -gv, -1.0, gu, gv])
        mass = np.array([p.mass, p.mass, pair.mesh_mass, w.mass, w.mass])
        k = np.diag([*p.stiffness, 0.0, *w.stiffness])
        d = np.diag([*p.damping, 0.0, *w.damping])
        suu, suv, svv = contact.curvature
        apart = np.array([[-1.0, 0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0, 1.0]])
        load = state.load if state else 0.0
        k = k - load * apart.T @ np.array([[suu, suv], [suv, svv]]) @ apart
    d = d + (c + pair.drag) * np.outer(direction, direction)
    return Linear(mass, k, d, direction)


@dataclass(frozen=True)
class Modes:
    """Angular frequencies (n,) [rad/s], rising, and shapes (n, n), columns of unit modal mass."""

    frequencies: Array
    shapes: Array

    @property
    def hertz(self) -> Array:
        """Return natural frequencies [Hz]."""
        return self.frequencies / (2.0 * math.pi)


def modes(system: Linear, stiffness: float) -> Modes:
    """Return the undamped modes at a mesh stiffness k [N/mm]; an unstable one counts negative."""
    root = 1.0 / np.sqrt(system.mass)
    square, shapes = np.linalg.eigh(system.with_mesh(stiffness) * np.outer(root, root))
    return Modes(np.sign(square) * np.sqrt(np.abs(square)), root[:, None] * shapes)


def mesh_shares(system: Linear, stiffness: float) -> Array:
    """Return kappa = k (w' phi)^2/omega^2 of each mode, (n,): its strain energy in the mesh."""
    natural = modes(system, stiffness)
    along = system.direction @ natural.shapes
    return np.asarray(stiffness * along**2 / natural.frequencies**2)


def with_modal_damping(system: Linear, stiffness: float, ratio: float) -> Linear:
    """Return the system with every mode at a mesh stiffness damped by a ratio zeta more."""
    natural = modes(system, stiffness)
    inverse = system.mass[:, None] * natural.shapes  # M Phi, as Phi' M Phi = 1
    more = inverse @ np.diag(2.0 * ratio * natural.frequencies) @ inverse.T
    return replace(system, damping=system.damping + more)


@dataclass(frozen=True)
class Tongue:
    """A tongue: modes p <= q (from 1), harmonic l, mesh frequency f [Hz] at its tip.

    half_width: of f, relative, without damping; damping: the modal damping ratio above which there
    is none (of p = q; for a combination that of both modes).
    """

    modes: tuple[int, int]
    harmonic: int
    frequency: float
    half_width: float
    damping: float


def tongues(system: Linear, wave: Wave, harmonics: int) -> list[Tongue]:
    """Return the tongues of all modes and sums of two modes, the widest first.

    p = q: half width and critical damping are kappa_p a_l/4, kappa_p the strain energy share of the
    mesh. p < q: half width in 2 pi l f is mean a_l |w'phi_p w'phi_q|/(2 sqrt(omega_p omega_q)).
    Amplitudes a_l = 2 |c_l|/mean of the wave. To first order in a_l: where harmonics of a wave act
    together (a_1 with a_2 on l = 3), or tongues overlap, they may be wider. Differences of two
    frequencies are stable, as the coupling is symmetric.
    """
    mean, shapes = wave.mean, modes(system, wave.mean)
    along, omega = system.direction @ shapes.shapes, shapes.frequencies
    kappa, every = mesh_shares(system, mean), []
    for order, c in enumerate(wave.harmonics(harmonics)[1:], 1):
        a = 2.0 * abs(c) / mean
        for p in range(omega.size):
            for q in range(p, omega.size):
                total = omega[p] + omega[q]
                if p == q:
                    width = damping = kappa[p] * a / 4.0
                else:
                    root = math.sqrt(omega[p] * omega[q])
                    width = mean * a * abs(along[p] * along[q]) / (2.0 * root) / total
                    damping = width * total / (2.0 * root)
                every.append(
                    Tongue((p + 1, q + 1), order, total / (2.0 * math.pi * order), width, damping)
                )
    return sorted(every, key=lambda t: -t.half_width)
