"""Direct collocation of a periodic motion: the equations that hold in every element of a period.

A period is cut into elements that end at the corners of the stiffness. Variables are displacements
and velocities where an element starts, and accelerations at its S Gauss points, which give the
motion within it: the Runge-Kutta method of Gauss, of order 2 S where the motion is smooth (Hairer,
Norsett and Wanner, Solving Ordinary Differential Equations I, II.7).
"""

from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from gearopt.formulations.dynamics.orbit.task import MICRO
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array


class Gauss(NamedTuple):
    """Points c (S,) of [0, 1], weights b (S,), and weights a (S, S) of integrals to each point."""

    points: Array
    weights: Array
    inner: Array


@cache
def gauss(count: int) -> Gauss:
    """Return the Runge-Kutta method of Gauss with a number of points."""
    points = 0.5 * (np.polynomial.legendre.leggauss(count)[0] + 1.0)
    powers = np.arange(count)
    inverse = np.linalg.inv(points[:, None] ** powers)  # coefficients of Lagrange's polynomials
    inner = (points[:, None] ** (powers + 1) / (powers + 1)) @ inverse
    return Gauss(points, (1.0 / (powers + 1)) @ inverse, inner)


class Piece(NamedTuple):
    """A part of the period: its share of it, and k [N/mm] at a share of the part.

    ends: shares of the part, from 0 to 1, between which its elements lie.
    """

    length: Any
    ends: Sequence[Any]
    stiffness: Callable[[Any], Any]


@dataclass(frozen=True)
class Moving:
    """A pair on fixed axes or on the line of action, of floats or casadi scalars. N, t, s, um.

    axes: of pinion and wheel mass [t], stiffness [N/mm] and damping [N s/mm] along the line of
    action; none: they do not move. mesh_mass [t]; load F [N]; damping of teeth in contact and drag
    [N s/mm]; backlash [um]. width [um]: over which contact begins; 0: at once. shaken: of a
    transmission error its second derivative by time [um/s2] at a share of the period.
    """

    mesh_mass: Any
    load: Any
    damping: Any
    backlash: float
    width: Any
    axes: Sequence[tuple[Any, Any, Any]] = ()
    drag: Any = 0.0
    shaken: Callable[[Any], Any] | None = None

    @property
    def size(self) -> int:
        """How many coordinates: delta alone, or r_1, delta, r_2."""
        return 1 + len(self.axes)


def mesh_force(moving: Moving, k: Any, delta: Any, rate: Any) -> Any:
    """Return the force N [N um/mm] of both flanks at delta [um] and its rate [um/s].

    k p(delta) + c p'(delta) delta' of the drive flank, with p(x) = (x - (x^2 + w^2)^(1/2))/2 for
    the least of x and 0; the same of the coast flank at backlash - delta. The error of p is w/2 at
    0, and w^2/(4 |x|) far from it.
    """
    force = moving.drag * rate
    for sign, gap in ((1.0, delta), (-1.0, moving.backlash - delta)):
        root = np.sqrt(gap**2 + moving.width**2)
        share = 0.5 * (1.0 - gap / root)
        force = force + sign * k * 0.5 * (gap - root) + share * moving.damping * rate
    return force


class Timing(NamedTuple):
    """The period counted in units of 1/rate, rate [rad/s]."""

    period: Any
    rate: float


class Collocated(NamedTuple):
    """Rows that are 0, and delta [um] at all Gauss points with their weights in a mean."""

    rows: dict[str, tuple[Any, ...]]
    delta: list[Any]
    weights: list[Any]


def collocated(
    moving: Moving, pieces: Sequence[Piece], points: int, x: Any, timing: Timing
) -> Collocated:
    """Return the equations of a motion that repeats after its pieces, E elements in all.

    Of n coordinates x.places and x.speeds (E n,) hold where elements start, x.bends (E S n,)
    accelerations at the Gauss points: in um, of time in units of 1/rate. Rows: motion, over the
    load, and ends, in tens of um: an element ends where the next starts.
    """
    method, n, size = gauss(points), moving.size, points * moving.size
    motion: list[Any] = []
    ends: list[Any] = []
    delta: list[Any] = []
    weights: list[Any] = []
    count, e, begun = sum(len(p.ends) - 1 for p in pieces), 0, 0.0
    for piece in pieces:
        for low, high in pairwise(piece.ends):
            share = piece.length * (high - low)
            q, v = ([block[e * n + i] for i in range(n)] for block in (x.places, x.speeds))
            bends = [x.bends[e * size + i] for i in range(size)]
            element = _motion_in_element(method, share * timing.period, q, v, bends)
            for j, c in enumerate(method.points):
                at = low + float(c) * (high - low)
                k, phase = piece.stiffness(at), begun + piece.length * at
                motion += _motion(moving, k, element.stages[j], timing.rate, phase)
                delta.append(element.stages[j][0][n // 2])
                weights.append(share * float(method.weights[j]))
            e += 1
            for i in range(n):
                ends.append((element.place[i] - x.places[e % count * n + i]) / TENS)
                ends.append((element.speed[i] - x.speeds[e % count * n + i]) / TENS)
        begun = begun + piece.length
    return Collocated({"motion": tuple(motion), "ends": tuple(ends)}, delta, weights)


TENS = 10.0  # um, the unit of rows of lengths


class _Element(NamedTuple):
    """Displacements, velocities, accelerations at its points; the first two at its end."""

    stages: list[tuple[list[Any], list[Any], list[Any]]]
    place: list[Any]
    speed: list[Any]


def _motion_in_element(
    method: Gauss, h: Any, q: list[Any], v: list[Any], bends: list[Any]
) -> _Element:
    n = len(q)

    def moved(weights: Array) -> tuple[list[Any], list[Any]]:
        twice, reach = weights @ method.inner, float(weights.sum())
        places = [q[i] + h * (reach * v[i] + h * _sum(twice, bends, n, i)) for i in range(n)]
        return places, [v[i] + h * _sum(weights, bends, n, i) for i in range(n)]

    stages = [(*moved(row), bends[j * n : (j + 1) * n]) for j, row in enumerate(method.inner)]
    return _Element(stages, *moved(method.weights))


def _sum(weights: Array, bends: list[Any], n: int, i: int) -> Any:
    return sum(float(w) * bends[j * n + i] for j, w in enumerate(weights))


def _motion(
    moving: Moving, k: Any, stage: tuple[list[Any], list[Any], list[Any]], rate: float, phase: Any
) -> list[Any]:
    """Return the equations of motion at a point, forces over the load."""
    (q, v, a), n = stage, moving.size
    force = mesh_force(moving, k, q[n // 2], rate * v[n // 2])
    equations, apart = [], 0.0
    for i, sign, (mass, held, damped) in zip((0, 2), (1.0, -1.0), moving.axes, strict=False):
        pulled = held * q[i] + damped * rate * v[i]
        equations.append((rate**2 * mass * a[i] + pulled - sign * force) / MICRO / moving.load)
        apart = apart - sign * rate**2 * a[i]
    shaken = moving.shaken(phase) if moving.shaken is not None else 0.0
    turned = rate**2 * a[n // 2] - apart - shaken
    equations.append((moving.mesh_mass * turned + force) / MICRO / moving.load + 1.0)
    return equations
