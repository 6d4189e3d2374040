"""A train and its layout as one problem: the limits of `teeth`, then those of the layout.

The gearbox depends on the gear pairs, so the text builds it for one design at a time; every design
has the same rows, with a need of zero where nothing faces.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from gearopt.formulations import teeth
from gearopt.formulations.gear_train import Train
from gearopt.formulations.layout.chain import chain
from gearopt.formulations.layout.gearbox import Gearbox
from gearopt.formulations.layout.slabs import Arrangement, Slabs, arrange, orders
from gearopt.formulations.layout.text import given_places, positions, sides
from gearopt.formulations.together.tables import Make
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Terms, Var, each
from gearopt.physics.gears import GearPair


def slabs_of(box: Gearbox) -> tuple[Slabs, ...]:
    """The orders of slabs that a gearbox leaves open, as the variable `arrangement` counts them."""
    return (box.slabs,) if box.slabs is not None else orders(box)


def text(
    train: Train, make: Make, box: Gearbox, methods: Mapping[str, Callable[..., Any]]
) -> Problem:
    """Variables: those of `teeth`, angle [rad] of each link, arrangement where several are open.

    box: what `make` gives for any sizes.
    """
    sized, known, links = teeth.problem(train), slabs_of(box), len(train.stages)
    own = [Var("angle", "rad", -math.pi, math.pi, 0.1, links)]
    if len(known) > 1:
        own.append(Var("arrangement", "", 0, len(known) - 1, 0, integer=True))
    variables = (*sized.variables, *own)
    count = sum(v.size for v in sized.variables)

    def one(point: Array) -> tuple[dict[str, float], dict[str, float], dict[str, float]]:
        slabs = known[round(point[-1]) if len(known) > 1 else 0]
        there = make(teeth.pairs(train, point[:count]))
        return _terms(there, arrange(there, slabs), point[count : count + links])

    def evaluate(x: Any, p: Any) -> Terms:
        found = sized.evaluate(x, p)
        columns = [v for var in variables for v in each(getattr(x, var.name))]
        points = np.atleast_2d(np.array(np.broadcast_arrays(*columns), float).T)
        rows = [one(point) for point in points]
        many = np.ndim(columns[0]) > 0

        def block(k: int) -> dict[str, Any]:
            names = rows[0][k]
            return {n: np.array([r[k][n] for r in rows]) if many else names[n] for n in names}

        return Terms(
            block(0),
            {**found.limits, **block(1)},
            equal={**found.equal, **block(2)},
            report=dict(found.minimise),
        )

    return Problem("together", variables, (), evaluate, methods=methods, vectorised=True)


def _terms(
    box: Gearbox, order: Arrangement, angles: Array
) -> tuple[dict[str, float], dict[str, float], dict[str, float]]:
    """Objective, limits and equalities of a layout."""
    shape = chain(box, (order,))
    y, z = positions(shape, tuple(float(a) for a in angles))
    side = sides(shape, y, z)
    width, height = side["width"], side["height"]
    factor = float(shape.factor[0])
    if shape.longest:
        value = max(width, height, factor)
    else:
        value = factor * width ** float(shape.power[0]) * height ** float(shape.power[1])
    limits: dict[str, float] = {}
    for i in range(len(y)):
        for j in range(i + 1, len(y)):
            limits[f"shafts_apart[{i + 1},{j + 1}]"] = _clear(
                order.apart[i, j], y[i] - y[j], z[i] - z[j]
            )
        for k, (left, right, bottom, top) in enumerate(shape.keep):
            dy, dz = max(left - y[i], y[i] - right, 0.0), max(bottom - z[i], z[i] - top, 0.0)
            limits[f"clear_of_keep_out[{k + 1},{i + 1}]"] = _clear(order.keep_apart[k, i], dy, dz)
    for name, there, most in (
        ("width", width, shape.most[0]),
        ("height", height, shape.most[1]),
        ("length", order.length, box.largest[2]),
    ):
        if math.isfinite(most):
            limits[f"largest_{name}"] = there / float(most)
    given, equal = given_places(shape, y, z)
    return {box.objective: value}, limits | given, equal


def _clear(need: float, dy: float, dz: float) -> float:
    """Utilisation of a least distance: at most 1 where it is kept."""
    there = dy**2 + dz**2
    return 1.0 + (need**2 - there) / max(need**2, there, 1.0)


def point(
    train: Train, pairs: tuple[GearPair, ...], slabs: int, several: bool, angles: Array
) -> Array:
    """The point of a train with its layout."""
    order = [float(slabs)] if several else []
    return np.concatenate([teeth.point(train, pairs), angles, order])


def pairs(train: Train, x: Array) -> tuple[GearPair, ...]:
    """Return the gear pairs of a point of `text`."""
    count = sum(v.size for v in teeth.problem(train).variables)
    return teeth.pairs(train, x[:count])


def laid_out(train: Train, make: Make, x: Array) -> tuple[Gearbox, tuple[float, ...], Arrangement]:
    """The gearbox of a point of `text`, its link angles [rad] and its arrangement of slabs."""
    box = make(pairs(train, x))
    known, links = slabs_of(box), len(train.stages)
    start = sum(v.size for v in teeth.problem(train).variables)
    order = arrange(box, known[round(float(x[-1])) if len(known) > 1 else 0])
    return box, tuple(float(t) for t in x[start : start + links]), order
