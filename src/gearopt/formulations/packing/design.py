"""A packing in words: container, layers, cylinders; fields are the keys of a result, with units."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from gearopt.formulations.packing.plan import Places, Plan
from gearopt.frozen import dataclass
from gearopt.optimise.typed import typed


@dataclass(frozen=True, kw_only=True)
class ContainerDesign:
    """A container from its left front corner; a circle has a diameter, the others two sides."""

    shape: str
    diameter_mm: float | None = None
    width_mm: float | None = None
    depth_mm: float | None = None
    area_mm2: float
    left_mm: float
    front_mm: float
    height_mm: float
    volume_mm3: float

    @property
    def sides(self) -> tuple[float, float]:
        """Extents in x and y [mm]."""
        across = self.diameter_mm or 0.0
        return self.width_mm or across, self.depth_mm or across


@dataclass(frozen=True, kw_only=True)
class LayerDesign:
    """A layer, counted from the floor: 1 is the lowest."""

    layer: int
    from_mm: float
    to_mm: float


@dataclass(frozen=True, kw_only=True)
class CylinderDesign:
    """A cylinder: its axis, sizes and layer; fixed: the file gives its place."""

    name: str
    x_mm: float
    y_mm: float
    diameter_mm: float
    height_mm: float
    layer: int
    from_mm: float
    to_mm: float
    fixed: bool


@dataclass(frozen=True, kw_only=True)
class PackingDesign:
    """A packing as a result holds it."""

    container: ContainerDesign
    layers: tuple[LayerDesign, ...]
    cylinders: tuple[CylinderDesign, ...]


def packing_design(data: Mapping[str, Any]) -> PackingDesign:
    """Design that a result of a packing holds; ValueError names the keys that do not belong."""
    design: PackingDesign = typed(PackingDesign, data, "design")
    return design


def places(design: PackingDesign) -> Places:
    """Return where the cylinders of a design are."""
    box, cylinders = design.container, design.cylinders
    width, depth = box.sides
    return Places(
        np.array([c.x_mm for c in cylinders]),
        np.array([c.y_mm for c in cylinders]),
        np.array([c.layer for c in cylinders], dtype=np.int64),
        np.array([box.left_mm + 0.5 * width, box.front_mm + 0.5 * depth]),
    )


def describe(plan: Plan, found: Places) -> PackingDesign:
    """Return container, layers from the floor up, and cylinders in the order of the plan.

    Where no place is fixed, the container's left front corner is the origin. Layers are counted
    without gaps from the floor, which keeps those that have a name: all below them hold a cylinder.
    """
    container, x, y = _container(plan, found)
    levels = sorted(set(found.layer.tolist()))
    names = {k: n for n, k in enumerate(levels, 1)}
    layers, floors, floor = [], {}, 0.0
    for k in levels:
        top = floor + max(
            c.height for c, at in zip(plan.cylinders, found.layer, strict=True) if at == k
        )
        layers.append(LayerDesign(layer=names[k], from_mm=floor, to_mm=top))
        floors[k], floor = floor, top
    cylinders = tuple(
        CylinderDesign(
            name=c.name,
            x_mm=float(x[k]),
            y_mm=float(y[k]),
            diameter_mm=2.0 * c.radius,
            height_mm=c.height,
            layer=names[int(found.layer[k])],
            from_mm=floors[int(found.layer[k])],
            to_mm=floors[int(found.layer[k])] + c.height,
            fixed=c.at is not None,
        )
        for k, c in enumerate(plan.cylinders)
    )
    container_design = ContainerDesign(
        **container, height_mm=floor, volume_mm3=container["area_mm2"] * floor
    )
    return PackingDesign(container=container_design, layers=tuple(layers), cylinders=cylinders)


def _container(plan: Plan, found: Places) -> tuple[dict[str, Any], Any, Any]:
    """Return the container's plan, and the axes in its coordinates."""
    r, x, y = plan.radius, found.x, found.y
    if plan.shape == "circle":
        far = max(
            math.hypot(a, b) + c for a, b, c in zip(*(x, y) - found.centre[:, None], r, strict=True)
        )
        size = 2.0 * (far + plan.wall)
        left, front = (found.centre - 0.5 * size).tolist()
        sizes = {"diameter_mm": size}
        area = 0.25 * math.pi * size**2
    else:
        left, front = float((x - r).min()) - plan.wall, float((y - r).min()) - plan.wall
        width = float((x + r).max()) + plan.wall - left
        depth = float((y + r).max()) + plan.wall - front
        if plan.shape == "square":
            width = depth = max(width, depth)
        if plan.width is not None:
            width = plan.width
        sizes = {"width_mm": width, "depth_mm": depth}
        area = width * depth
    if not plan.fixed:
        x, y, left, front = x - left, y - front, 0.0, 0.0
    head = {"shape": plan.shape, **sizes, "area_mm2": area, "left_mm": left, "front_mm": front}
    return head, x, y
