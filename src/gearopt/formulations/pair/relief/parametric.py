"""The best amounts and lengths of relief of both gears, for several loads at once.

The text is exact: at each amount and length the load is shared in closed form. It has kinks where
contact is lost, so no derivative is asked of it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from gearopt.formulations.pair.relief.meshing import Criteria, Mesh, Relief
from gearopt.formulations.pair.relief.relief_mpec import local
from gearopt.formulations.pair.relief.relief_search import MICRO, Goal, search
from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Terms, Var

PROVEN = "peak_to_peak", "harmonics"  # objectives, at single loads too, that a search proves
LARGEST_AMOUNT = 30e-3  # mm: amount beyond which no relief of such gears goes


@dataclass(frozen=True)
class Ranges:
    """Ranges of a relief: amounts [mm] and lengths [mm] of both gears from least to most.

    exponents of pinion and wheel, at least 1, which are given.
    """

    amounts: tuple[float, float]
    lengths: tuple[float, float]
    exponents: tuple[float, float] = (1.0, 1.0)

    @classmethod
    def of(cls, mesh: Mesh, exponent: float = 1.0, most: float = LARGEST_AMOUNT) -> "Ranges":
        """Return amounts up to `most` and lengths from 0.1 p_b to the middle of the path."""
        path = mesh.cycle.path
        lengths = 0.1 * float(path.base_pitch), 0.5 * float(path.length)
        return cls((0.0, most), lengths, (exponent, exponent))


def _worst(values: Any) -> Any:
    return np.asarray(values).max(axis=-1)


OBJECTIVES: dict[str, tuple[str, Callable[[Criteria], Any]]] = {  # name -> unit, value (...)
    "peak_to_peak": ("mm", lambda c: _worst(c.peak_to_peak)),
    "harmonics": ("mm", lambda c: _worst(np.sqrt((c.harmonics() ** 2).sum(axis=-1)))),
    "load_jump": ("", lambda c: _worst(c.load_jump)),
    "peak_load": ("", lambda c: _worst(c.peak_load)),
}


def objective(criteria: Criteria, name: str) -> Any:
    """Return an objective (...): the worst over all loads, or of load k, from 1, for "name_at_k".

    peak_to_peak: of the transmission error [mm]; harmonics: root of the sum of squares of its first
    three amplitudes [mm]; load_jump, peak_load: of one pair, over the load.
    """
    head, _, number = name.partition("_at_")
    return OBJECTIVES[head][1](criteria.of_load(int(number)) if number else criteria)


def problem(
    mesh: Mesh,
    ranges: Ranges,
    objectives: tuple[str, ...] = ("peak_to_peak",),
    limits: dict[str, float] | None = None,
) -> Problem:
    """Pose the best relief: variables amount [mm] and length [mm], each of pinion and wheel.

    objectives: names that `objective` takes. limits: greatest values of some of them.
    """
    most = limits or {}

    def evaluate(x: Any, p: Any) -> Terms:
        measures = mesh.criteria(mesh.separations(*reliefs(x.amount, x.length, ranges)))
        return Terms(
            {name: objective(measures, name) for name in objectives},
            {name: objective(measures, name) / bound for name, bound in most.items()},
        )

    powers, methods = ranges.exponents, dict[str, Callable[..., Any]]()
    if len(objectives) == 1 and all(n.startswith(PROVEN) for n in (*objectives, *most)):
        methods = {"exact": search(mesh, powers, _objective_and_limits(mesh, objectives[0], most))}
        if objectives == PROVEN[:1] and not most:
            methods["mpec"] = local(mesh, powers)
    return Problem("relief", variables(ranges), (), evaluate, methods=methods, vectorised=True)


def _objective_and_limits(mesh: Mesh, name: str, limits: dict[str, float]) -> Goal:
    """Objective of the search, and the limits [mm] that it keeps to."""
    loads = np.arange(1, len(mesh.loads) + 1)

    def which(of: str) -> Any:
        head, _, number = of.partition("_at_")
        counted = loads == int(number) if number else loads > 0
        return np.array([counted & (head == sort) for sort in PROVEN])

    ends = [np.where(which(of), MICRO * most, np.inf) for of, most in limits.items()]
    return Goal(which(name), np.min([np.full((2, len(loads)), np.inf), *ends], axis=0))


def reliefs(amounts: Any, lengths: Any, ranges: Ranges) -> tuple[Relief, Relief]:
    """Return the reliefs of pinion and wheel from amounts and lengths [mm] of both."""
    pinion, wheel = (Relief(*row) for row in zip(amounts, lengths, ranges.exponents, strict=True))
    return pinion, wheel


def variables(ranges: Ranges) -> tuple[Var, ...]:
    """Return amount and length, of pinion and wheel, guessed in the middle of their ranges."""
    rows = {"amount": ranges.amounts, "length": ranges.lengths}
    return tuple(
        Var(name, "mm", low, high, 0.5 * (low + high), 2) for name, (low, high) in rows.items()
    )


def at_point(x: Array, ranges: Ranges) -> tuple[Relief, Relief]:
    """Return the reliefs of a point (amount 1, amount 2, length 1, length 2)."""
    a1, a2, l1, l2 = (float(v) for v in x)
    return reliefs((a1, a2), (l1, l2), ranges)
