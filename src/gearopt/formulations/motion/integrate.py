"""Fixed-step methods for the motion of a pair: explicit, symplectic, and Newmark's family."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from gearopt.formulations.motion.numbers import deformation, numbers
from gearopt.formulations.motion.timeline import Timeline
from gearopt.optimise.kernels import kernel
from gearopt.optimise.terms import Array
from gearopt.physics.motion.accelerations import LEVELS
from gearopt.physics.motion.moving_pair import MovingPair

MARCH = "gearopt.formulations.motion.march_kernel"
ALPHA = "gearopt.formulations.motion.alpha_kernel"
HHT, RHO = 0.05, 0.9  # numerical damping: alpha of HHT, spectral radius of generalised alpha


@dataclass(frozen=True)
class Marched:
    """States (outputs, 2 n) at the times asked; steps, and what they cost: rates evaluated."""

    pair: MovingPair
    level: str
    states: Array
    steps: int
    rates: int
    events: int = 0

    @property
    def delta(self) -> Array:
        """Deformation at the outputs [mm]."""
        return deformation(self.pair, self.level, self.states)


@dataclass(frozen=True)
class Stepper:
    """A method of fixed steps: its order, rates a step (Newton's steps count two), and its run.

    undamped: only for pairs without damping, in coordinates whose forces are of positions alone.
    """

    order: int
    rates: int
    run: Callable[[Any, Timeline, Any, Array, Array], int]
    undamped: bool = False


def march(
    pair: MovingPair, level: str, times: Timeline, method: str, longest: float, state: Array
) -> Marched:
    """Return the motion by a method of STEPPERS with steps of at most `longest` [s].

    state (2 n,): coordinates and velocities at the start.
    """
    stepper, model = STEPPERS[method], numbers(pair, level)
    if stepper.undamped and not conservative(pair, level):
        raise ValueError(f"{method} is for pairs without damping, not at the level {level!r}")
    counts = times.counts(longest)
    out = np.empty((len(times.starts), 2 * LEVELS[level][0]))
    last = np.array(state, float)
    found = stepper.run(model, times, counts, last, out)
    steps = int(counts.sum())
    whole = np.concatenate([[state], out])[times.asked + 1]
    newton = method in ALPHAS
    rates = 2 * found if newton else steps * stepper.rates
    return Marched(pair, level, whole, steps, rates, 0 if newton else found)


def conservative(pair: MovingPair, level: str) -> bool:
    """Return whether the forces of a level depend on positions alone."""
    damped = pair.damping or pair.drag or any(c for r in pair.rotors for c in r.damping)
    curved = level == "plane" and pair.kinematics in ("exact", "paper")
    return not damped and not curved


def _explicit(tableau: Callable[[], tuple[Array, Array, Array]]) -> Any:
    def run(model: Any, times: Timeline, counts: Any, state: Array, out: Array) -> int:
        law, (table, weights, nodes) = kernel(MARCH).march, tableau()
        given = times.starts, times.lengths, times.k0, times.k1
        return int(law(*model, table, weights, nodes, *given, counts, state, out))

    return run


def _composed(model: Any, times: Timeline, counts: Any, state: Array, out: Array) -> int:
    given = times.starts, times.lengths, times.k0, times.k1
    return int(kernel(MARCH).compose(*model, composition(), *given, counts, state, out))


def _implicit(alphas: tuple[float, float, float, float]) -> Any:
    def run(model: Any, times: Timeline, counts: Any, state: Array, out: Array) -> int:
        given = times.starts, times.lengths, times.k0, times.k1
        return int(kernel(ALPHA).advance(*model, alphas, *given, counts, state, out))

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
    {name: Stepper(2, 4, _implicit(alphas)) for name, alphas in ALPHAS.items()}
    | {
        "rk4": Stepper(4, 4, _explicit(fourth)),
        "rk8": Stepper(8, 12, _explicit(eighth)),
        "symplectic": Stepper(6, 7, _composed, undamped=True),
    }
)
