"""A packing in words: container, layers, cylinders, every length with its unit in the key."""

import math
from typing import Any

from gearopt.formulations.packing.plan import Places, Plan


def describe(plan: Plan, found: Places) -> dict[str, Any]:
    """Container, layers from the floor up, and cylinders in the order of the plan.

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
        layers.append({"layer": names[k], "from_mm": floor, "to_mm": top})
        floors[k], floor = floor, top
    cylinders = [
        {
            "name": c.name,
            "x_mm": float(x[k]),
            "y_mm": float(y[k]),
            "diameter_mm": 2.0 * c.radius,
            "height_mm": c.height,
            "layer": names[int(found.layer[k])],
            "from_mm": floors[int(found.layer[k])],
            "to_mm": floors[int(found.layer[k])] + c.height,
            "fixed": c.at is not None,
        }
        for k, c in enumerate(plan.cylinders)
    ]
    container |= {"height_mm": floor, "volume_mm3": container["area_mm2"] * floor}
    return {"container": container, "layers": layers, "cylinders": cylinders}


def _container(plan: Plan, found: Places) -> tuple[dict[str, Any], Any, Any]:
    """The container's plan, and the axes in its coordinates."""
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
