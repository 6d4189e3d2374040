"""A layout as a problem: link angles are the variables, so every mesh is exact.

`direct` takes width and height as they are, for samplers and for the exact search; `smooth` holds
them by the four sides of the box, for gradients.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from gearopt.formulations.drive.gearbox import Gearbox
from gearopt.formulations.drive.layout.chain import Chain, chain
from gearopt.formulations.drive.layout.slabs import Arrangement
from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Terms, Var, each

Point = tuple[list[Any], list[Any]]  # y and z of every shaft


def direct(
    box: Gearbox,
    orders: tuple[Arrangement, ...],
    methods: Mapping[str, Callable[..., Any]],
    goals: tuple[str, ...] = (),
) -> Problem:
    """Return the problem in angles [rad] of the links and, if several, the arrangement of slabs.

    goals: objectives and sides that are minimised instead of the objective of the box.
    """
    shape = chain(box, orders)
    links = shape.link.size
    variables = [Var("angle", "rad", -math.pi, math.pi, 0.1, links)]
    if len(orders) > 1:
        variables.append(Var("arrangement", "", 0, len(orders) - 1, 0, integer=True))

    def evaluate(x: Any, p: Any) -> Terms:
        m = np.rint(x.arrangement).astype(int) if len(orders) > 1 else 0
        y, z = positions(shape, each(x.angle))
        width, height = _side(shape, y), _side(shape, z)
        objective = {box.objective: value(shape, m, width, height)}
        if goals:
            wide = width if box.width is None else box.width + 0.0 * width
            sizes = wide, height, _of(shape.length, m) + 0.0 * width
            objective = {name: measured(name, *sizes) for name in goals}
        limits, equal = _rows(shape, m, (y, z))
        return Terms(
            objective, limits | largest(shape, width, height, _of(shape.length, m)), equal=equal
        )

    return Problem("layout", tuple(variables), (), evaluate, methods=methods, vectorised=True)


def smooth(box: Gearbox, order: Arrangement) -> Problem:
    """Return the problem in link angles [rad] and left, bottom, width, height of the box [mm]."""
    shape = chain(box, (order,))
    links, span = shape.link.size, 2.0 * float(shape.link.sum() + shape.reach.max())
    minimum = 2.0 * float(shape.reach.max())
    variables = (
        Var("angle", "rad", -2.0 * math.pi, 2.0 * math.pi, 0.1, links, search=True),
        Var("left", "mm", -span, 0.0, -0.5 * span, search=True),
        Var("bottom", "mm", -span, 0.0, -0.5 * span, search=True),
        Var("width", "mm", 0.5 * minimum, 2.0 * span, span, search=True),
        Var("height", "mm", 0.5 * minimum, 2.0 * span, span, search=True),
        Var("longest", "mm", 0.5 * minimum, 4.0 * span + shape.factor[0], span, search=True),
    )[: 6 if shape.longest else 5]

    def evaluate(x: Any, p: Any) -> Terms:
        y, z = positions(shape, each(x.angle))
        rows: dict[str, Any] = {}
        for k, r in enumerate(shape.reach):
            rows[f"left[{k + 1}]"] = 1.0 + (x.left - (y[k] - r)) / span
            rows[f"right[{k + 1}]"] = 1.0 + (y[k] + r - x.left - x.width) / span
            rows[f"bottom[{k + 1}]"] = 1.0 + (x.bottom - (z[k] - r)) / span
            rows[f"top[{k + 1}]"] = 1.0 + (z[k] + r - x.bottom - x.height) / span
        if shape.longest:
            sides = {"width": x.width, "height": x.height, "third": shape.factor[0]}
            rows |= {f"{n}_below": 1.0 + (v - x.longest) / span for n, v in sides.items()}
            objective = x.longest
        else:
            objective = value(shape, 0, x.width, x.height)
        limits, equal = _rows(shape, 0, (y, z))
        limits |= largest(shape, x.width, x.height, float(shape.length[0]))
        return Terms({box.objective: objective}, limits, rows, equal)

    return Problem("layout", variables, (), evaluate)


def positions(shape: Chain, angle: tuple[Any, ...]) -> Point:
    """Return y and z of every shaft [mm] for link angles [rad]."""
    return placed_by([float(a) for a in shape.link], angle)


def placed_by(links: list[Any], angle: tuple[Any, ...]) -> Point:
    """Return y and z of every shaft for lengths and angles of the links between them."""
    y, z = [0.0 * angle[0]], [0.0 * angle[0]]
    for a, t in zip(links, angle, strict=True):
        y.append(y[-1] + a * np.cos(t))
        z.append(z[-1] + a * np.sin(t))
    return y, z


def sides(shape: Chain, y: list[Any], z: list[Any]) -> dict[str, float]:
    """Left, bottom, width and height of the box around shafts at y, z [mm]."""
    left, bottom = (min(v - r for v, r in zip(c, shape.reach, strict=True)) for c in (y, z))
    box = {"left": left, "bottom": bottom, "width": _side(shape, y), "height": _side(shape, z)}
    return {name: float(side) for name, side in box.items()}


def _side(shape: Chain, c: list[Any]) -> Any:
    low, high = c[0] - shape.reach[0], c[0] + shape.reach[0]
    for v, r in zip(c[1:], shape.reach[1:], strict=True):
        low, high = np.minimum(low, v - r), np.maximum(high, v + r)
    return high - low


def value(shape: Chain, m: Any, width: Any, height: Any) -> Any:
    """Return the objective of boxes of these sides [mm] around arrangement m."""
    factor = _of(shape.factor, m)
    if shape.longest:
        return np.maximum(np.maximum(width, height), factor)
    return factor * width ** float(shape.power[0]) * height ** float(shape.power[1])


def measured(name: str, width: Any, height: Any, length: Any) -> Any:
    """Return an objective or a side of a box of these sides [mm]."""
    if name == "longest_side":
        return np.maximum(np.maximum(width, height), length)
    sides = {"width": width, "height": height, "length": length}
    factors = {
        "box_volume": ("width", "height", "length"),
        "plan_area": ("width", "length"),
        "face_area": ("width", "height"),
    }
    return math.prod(sides[side] for side in factors.get(name, (name,)))


def _of(values: Array, m: Any) -> Any:
    """Return the value of an arrangement: one, or one for each point of a population."""
    return float(values[m]) if isinstance(m, int) else values[m]


def largest(shape: Chain, width: Any, height: Any, length: Any) -> dict[str, Any]:
    """Return the sides [mm] of a box over their limits, where there are any."""
    by_name = dict(zip(("width", "height", "length"), (width, height, length), strict=True))
    return {
        f"largest_{name}": side / float(maximum)
        for (name, side), maximum in zip(by_name.items(), shape.most, strict=True)
        if math.isfinite(maximum)
    }


def _rows(shape: Chain, m: Any, point: Point) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return limits and equalities of distances (squared), keep-outs, places and split line."""
    y, z = point
    limits: dict[str, Any] = {}
    for i in range(len(y)):
        for j in range(i + 1, len(y)):
            if (need := shape.apart[:, i, j]).any():
                there = (y[i] - y[j]) ** 2 + (z[i] - z[j]) ** 2
                name = f"shafts_apart[{i + 1},{j + 1}]"
                limits[name] = 1.0 + (_of(need, m) ** 2 - there) / float(need.max()) ** 2
        for k, (left, right, bottom, top) in enumerate(shape.keep):
            if (need := shape.keep_apart[:, k, i]).any():
                dy, dz = outside(y[i], left, right), outside(z[i], bottom, top)
                name = f"clear_of_keep_out[{k + 1},{i + 1}]"
                limits[name] = 1.0 + (_of(need, m) ** 2 - dy**2 - dz**2) / float(need.max()) ** 2
    there, same = given_places(shape, y, z)
    return limits | there, same


def given_places(shape: Chain, y: list[Any], z: list[Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the limits and equalities of given places and of the split line."""
    limits: dict[str, Any] = {}
    equal: dict[str, Any] = {}
    scale = float(shape.link.max())
    for i, ends in enumerate(shape.place):
        for axis, c, (low, high) in (("y", y[i], ends[:2]), ("z", z[i], ends[2:])):
            name = f"place_{axis}[{i + 1}]"
            if low == high:
                equal[name] = 1.0 + (c - low) / scale
                continue
            if math.isfinite(low):
                limits[f"{name}_low"] = 1.0 + (low - c) / scale
            if math.isfinite(high):
                limits[f"{name}_high"] = 1.0 + (c - high) / scale
    for k in range(1, len(shape.level)):
        i, j = shape.level[0], shape.level[k]
        equal[f"split_line[{j + 1}]"] = 1.0 + (z[j] - z[i]) / scale
    return limits, equal


def outside(c: Any, low: float, high: float) -> Any:
    """Return how far a coordinate is outside a range, either end of which may be infinite."""
    far = 0.0 * c
    for past, end in ((low - c, low), (c - high, high)):
        if math.isfinite(end):
            far = np.maximum(far, past)
    return far


@dataclass(frozen=True)
class Placed:
    """A layout: y and z of every axis, and the box around them; the input axis is at 0, 0 [mm]."""

    axes: tuple[tuple[float, float], ...]
    length: float
    left: float
    bottom: float
    width: float
    height: float


def read(orders: tuple[Arrangement, ...], x: Array) -> tuple[tuple[float, ...], Arrangement]:
    """Return the link angles [rad] and the arrangement of slabs of a point of `direct`."""
    links = orders[0].axes[-1]
    m = round(float(x[links])) if len(orders) > 1 else 0
    return tuple(float(t) for t in x[:links]), orders[m]


def placed(box: Gearbox, one: Arrangement, angles: tuple[float, ...]) -> Placed:
    """Return where the shafts are and the box around them [mm], of the given width if any."""
    shape = chain(box, (one,))
    y, z = positions(shape, angles)
    around = sides(shape, y, z)
    if box.width is not None:
        around["left"] -= 0.5 * (box.width - around["width"])
        around["width"] = box.width
    axes = tuple((float(y[k]), float(z[k])) for k in box.axes)
    return Placed(axes, one.length, **around)
