"""Fixed-step methods for the motion of a pair: explicit, symplectic, and Newmark's family.

`numbers` are those of a pair as kernels take them.
"""

import math
from collections.abc import Callable, Mapping
from functools import cache, partial
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.dynamics.motion.timeline import Timeline
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import compiling_aside, kernel
from gearopt.optimise.terms import Array
from gearopt.physics.motion.accelerations import LEVELS, stiffness_along
from gearopt.physics.motion.moving_pair import MovingPair

MARCH = "gearopt.formulations.dynamics.motion.march_kernel"
ALPHA = "gearopt.formulations.dynamics.motion.alpha_kernel"
SLICE = 50_000  # steps between two looks at a clock: some tenth of a second
HHT, RHO = 0.05, 0.9  # numerical damping: alpha of HHT, spectral radius of generalised alpha


@dataclass(frozen=True)
class Marched:
    """States (outputs, 2 n) at the times asked; steps, and how many rates were evaluated.

    Where a clock stopped, at the first of the times alone. events: times that teeth part or meet.
    jammed [s]: when both flanks are first pressed at once, as axes in the plane came together; None
    where they never are, and of methods that locate no separation.
    """

    pair: MovingPair
    level: str
    states: Array
    steps: int
    rates: int
    events: int = 0
    jammed: float | None = None

    @property
    def delta(self) -> Array:
        """Deformation at the outputs [mm]."""
        return deformation(self.pair, self.level, self.states)


@dataclass(frozen=True)
class Stepper:
    """A method of fixed steps: its order, rates a step (Newton's steps count two), and its run.

    entry: module and name of the kernel that runs it.
    undamped: only for pairs without damping, in coordinates whose forces are of positions alone.
    """

    order: int
    rates: int
    run: Callable[[Any, Any, Any, Array, Array, Array], int]
    entry: tuple[str, str]
    undamped: bool = False

    @property
    def kernel(self) -> Any:
        """The kernel that runs it."""
        return getattr(kernel(self.entry[0]), self.entry[1])


def march(
    pair: MovingPair,
    level: str,
    times: Timeline,
    method: str,
    longest: float,
    state: Array,
    clock: Clock | None = None,
) -> Marched:
    """Return the motion by a method of STEPPERS with steps of at most `longest` [s].

    state (2 n,): coordinates and velocities at the start. clock: asked every SLICE steps; where it
    stops, the motion ends there. It counts rates as evaluations.
    """
    stepper, model = STEPPERS[method], numbers(pair, level)
    if stepper.undamped and not conservative(pair, level):
        raise ValueError(f"{method} is for pairs without damping, not at the level {level!r}")
    counts = times.counts(longest)
    if clock is not None and counts.max() > SLICE:
        times = times.divided(-(-counts // SLICE))
        counts = times.counts(longest)
    out = np.empty((len(counts), 2 * LEVELS[level][0]))
    last, events_of_jam = np.array(state, float), np.array([-1.0, np.inf])
    newton, ends = method in ALPHAS, np.cumsum(counts)
    events = rates = done = 0
    steps, slowed = 0, math.inf if clock is None else SLICE
    clock = clock or Clock()
    while done < len(counts) and (done == 0 or clock.tell()):
        stop = max(done + 1, int(np.searchsorted(ends, steps + slowed, "right")))
        part = slice(done, stop)
        given = model, times.between(done, stop), counts[part], last, out[part], events_of_jam
        advanced = compiling_aside(clock, stepper.kernel, partial(stepper.run, *given))
        if advanced is None:
            break
        spent = 2 * advanced if newton else (int(ends[stop - 1]) - steps) * stepper.rates
        events, rates, done = events + (0 if newton else advanced), rates + spent, stop
        clock.evaluations, steps = clock.evaluations + spent, int(ends[stop - 1])
    whole = np.concatenate([[state], out])[times.asked[times.asked < done] + 1]
    jammed = float(events_of_jam[1]) if np.isfinite(events_of_jam[1]) else None
    return Marched(pair, level, whole, steps, rates, events, jammed)


def conservative(pair: MovingPair, level: str) -> bool:
    """Return whether the forces of a level depend on positions alone."""
    damped = pair.damping or pair.drag or any(c for r in pair.rotors for c in r.damping)
    curved = level == "plane" and pair.kinematics in ("exact", "paper")
    return not damped and not curved


def _explicit(tableau: Callable[[], tuple[Array, Array, Array]]) -> Any:
    def run(model: Any, pieces: Any, counts: Any, state: Array, out: Array, told: Array) -> int:
        law, (table, weights, nodes) = kernel(MARCH).march, tableau()
        return int(law(*model, table, weights, nodes, *pieces, counts, state, out, told))

    return run


def _composed(model: Any, pieces: Any, counts: Any, state: Array, out: Array, told: Array) -> int:
    return int(kernel(MARCH).compose(*model, composition(), *pieces, counts, state, out))


def _implicit(alphas: tuple[float, float, float, float]) -> Any:
    def run(model: Any, pieces: Any, counts: Any, state: Array, out: Array, told: Array) -> int:
        return int(kernel(ALPHA).advance(*model, alphas, *pieces, counts, state, out))

    return run


def generalised(rho: float) -> tuple[float, float, float, float]:
    """Return alpha_m, alpha_f, beta, gamma of generalised alpha with the spectral radius rho.

    Source: Chung and Hulbert, J. Appl. Mech. 60, 1993: alpha_m = (2 rho - 1)/(rho + 1),
    alpha_f = rho/(rho + 1), beta = (1 - alpha_m + alpha_f)^2/4, gamma = 1/2 - alpha_m + alpha_f.
    """
    am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    return am, af, 0.25 * (1.0 - am + af) ** 2, 0.5 - am + af


@cache
def fourth() -> tuple[Array, Array, Array]:
    """Return the classical Runge-Kutta method of order 4: table, weights, nodes."""
    table = np.diag([0.5, 0.5, 1.0], -1)
    return table, np.array([1.0, 2.0, 2.0, 1.0]) / 6.0, np.array([0.0, 0.5, 0.5, 1.0])


@cache
def eighth() -> tuple[Array, Array, Array]:
    """Return the method of order 8 of Dormand and Prince, with 12 stages, as scipy has it."""
    from scipy.integrate import DOP853

    return tuple(np.ascontiguousarray(a, float) for a in (DOP853.A, DOP853.B, DOP853.C))  # type: ignore[return-value]


@cache
def composition() -> Array:
    """Return weights of Yoshida's symmetric composition of order 6 (solution A).

    Source: Yoshida, Phys. Lett. A 150, 1990; a test solves his order conditions to rounding.
    """
    w = [-1.17767998417887, 0.235573213359357, 0.784513610477560]
    return np.array([*w[::-1], 1.0 - 2.0 * sum(w), *w])


ALPHAS: Mapping[str, tuple[float, float, float, float]] = MappingProxyType(
    {
        "newmark": (0.0, 0.0, 0.25, 0.5),
        "hht": (0.0, HHT, 0.25 * (1.0 + HHT) ** 2, 0.5 + HHT),
        "generalised_alpha": generalised(RHO),
    }
)
STEPPERS: Mapping[str, Stepper] = MappingProxyType(
    {name: Stepper(2, 4, _implicit(alphas), (ALPHA, "advance")) for name, alphas in ALPHAS.items()}
    | {
        "rk4": Stepper(4, 4, _explicit(fourth), (MARCH, "march")),
        "rk8": Stepper(8, 12, _explicit(eighth), (MARCH, "march")),
        "symplectic": Stepper(6, 7, _composed, (MARCH, "compose"), undamped=True),
    }
)


KINDS = ("exact", "tangent", "paper", "paper_linear")  # as `motion_kernel.contact` counts them
FORMS = {"way": 1, "angles": 2}  # coordinates of which delta is a difference


WHOLE = ("level", "form", "kinematics")
REAL = (
    *("m1", "m2", "mesh_mass", "load", "kx1", "ky1", "kx2", "ky2", "cx1", "cy1", "cx2", "cy2"),
    *("damping", "drag", "backlash", "sine", "cosine", "radii", "centres", "tangent"),
    *("r1", "r2", "i1", "i2", "torque1", "torque2", "omega"),
)
KIND = np.dtype([(name, np.int64) for name in WHOLE] + [(name, np.float64) for name in REAL])


class Numbers(NamedTuple):
    """A pair at a level, for kernels, with the units of `MovingPair`.

    pair (1,): a record of WHOLE and REAL, `level`: how many coordinates. waves (4, H): cosines and
    sines of the mesh stiffness [N/mm], and of what the error adds to delta'' [mm/s2].
    """

    pair: NDArray[np.void]
    waves: Array


def numbers(pair: MovingPair, level: str) -> Numbers:
    """Return the numbers of a pair at a level of LEVELS."""
    p, w = pair.rotors
    k1, k2, c1, c2 = p.stiffness, w.stiffness, p.damping, w.damping
    if level == "line":
        (a, c), (b, d) = (stiffness_along(pair, r) for r in pair.rotors)
        k1, k2, c1, c2 = (a, a), (b, b), (c, c), (d, d)
    rest, omega = pair.rest, 2.0 * math.pi * pair.mesh_frequency
    backlash = math.inf if pair.backlash is None else pair.backlash
    values = (
        *(LEVELS[level][0], FORMS.get(level, 0), KINDS.index(pair.kinematics)),
        *(p.mass, w.mass, pair.mesh_mass, pair.load, *k1, *k2, *c1, *c2),
        *(pair.damping, pair.drag, backlash),
        *(math.sin(pair.pressure_angle), math.cos(pair.pressure_angle)),
        *(rest.base_radii, rest.centre_distance, rest.tangent_length),
        *(p.base_radius, w.base_radius, p.inertia, w.inertia, p.torque, w.torque, omega),
    )
    cosines, errors = pair.wave.cosines, pair.error
    waves = np.zeros((4, max(len(cosines), len(errors))))
    waves[0, : len(cosines)], waves[1, : len(cosines)] = cosines, pair.wave.sines
    shaken = np.array([-e * (h * omega) ** 2 for h, e in enumerate(errors, 1)], complex)
    waves[2:, : len(errors)] = shaken.real, -shaken.imag
    return Numbers(np.array([values], dtype=KIND), waves)


def deformation(pair: MovingPair, level: str, states: Array) -> Array:
    """Return delta [mm] of states (..., 2 n) of a level."""
    size = LEVELS[level][0]
    if level not in FORMS:
        return np.asarray(states[..., size // 2])
    u, v = states[..., 3] - states[..., 0], states[..., 4] - states[..., 1]
    g = pair.contact(u, v).approach
    if level == "way":
        return np.asarray(g - states[..., 2])
    turned = pair.pinion.base_radius * states[..., 2] + pair.wheel.base_radius * states[..., 5]
    return np.asarray(g - turned)
