"""A point of the layout problem as places: the axes, and the box around them."""

from dataclasses import dataclass

from gearopt.formulations.layout.chain import chain
from gearopt.formulations.layout.gearbox import Gearbox
from gearopt.formulations.layout.slabs import Arrangement
from gearopt.formulations.layout.text import positions, sides
from gearopt.optimise.terms import Array


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
    """Link angles [rad] and the arrangement of slabs that a point of `problem` stands for."""
    links = len(orders[0].bodies) - 1
    m = round(float(x[links])) if len(orders) > 1 else 0
    return tuple(float(t) for t in x[:links]), orders[m]


def placed(box: Gearbox, one: Arrangement, angles: tuple[float, ...]) -> Placed:
    """Where the shafts are, and the box around them [mm]; as wide as asked, where that is given."""
    shape = chain(box, (one,))
    y, z = positions(shape, angles)
    found = sides(shape, y, z)
    if box.width is not None:
        found["left"] -= 0.5 * (box.width - found["width"])
        found["width"] = box.width
    axes = tuple((float(a), float(b)) for a, b in zip(y, z, strict=True))
    return Placed(axes, one.length, **found)
