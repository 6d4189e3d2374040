"""Points of a packing's texts: which number is which place, and back."""

from typing import Any

import numpy as np

from gearopt.formulations.packing.plan import Places, Plan
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, namespace


def places(plan: Plan, problem: Problem, at: Array, layer: Any = None) -> Places:
    """Where all cylinders are at a point of either text; layer: those given to `smooth`."""
    x = namespace(problem.variables, [float(v) for v in at])
    both = axes(plan, x)
    centre = np.array([getattr(x, "centre_x", 0.0), getattr(x, "centre_y", 0.0)], float)
    layer = [round(float(k)) for k in layers(plan, x)] if layer is None else layer
    return Places(
        np.array([a for a, _ in both], float),
        np.array([b for _, b in both], float),
        np.array(layer, dtype=np.int64),
        centre,
    )


def point(plan: Plan, found: Places) -> Array:
    """The point of `direct` of a packing; where nothing is fixed, its corner is the origin."""
    free, x, y = list(plan.free), found.x, found.y
    if not plan.fixed and plan.shape != "circle":
        x, y = (v - float((v - plan.radius).min()) + plan.wall for v in (x, y))
    parts = [x[free], y[free]]
    if has_centre(plan):
        parts.append(found.centre)
    parts.append(found.layer[list(plan.lifted)].astype(float))
    return np.concatenate(parts)


def start(plan: Plan, found: Places) -> Array:
    """The point of `smooth` of a packing, whose container just holds it."""
    r, wall, free = plan.radius, plan.wall, list(plan.free)
    x, y = found.x, found.y
    if plan.shape == "circle":
        far = float(np.max(np.hypot(x - found.centre[0], y - found.centre[1]) + r)) + wall
        centre = found.centre if plan.fixed else np.empty(0)
        return np.concatenate([x[free], y[free], centre, [far]])
    left, front = float((x - r).min()) - wall, float((y - r).min()) - wall
    across, along = float((x + r).max()) + wall - left, float((y + r).max()) + wall - front
    if not plan.fixed:
        x, y, left, front = x - left, y - front, 0.0, 0.0
    corner = [left, front] if plan.fixed else []
    sides = [max(across, along)] if plan.shape == "square" else [across, along]
    if plan.width is not None:
        sides = [along]
    return np.concatenate([x[free], y[free], corner, sides])


def each(value: Any) -> tuple[Any, ...]:
    """A block as a tuple, also of one."""
    return value if isinstance(value, tuple) else (value,)


def axes(plan: Plan, x: Any) -> list[tuple[Any, Any]]:
    """Axes of all cylinders: those of the free ones are variables."""
    free = iter(zip(each(x.x), each(x.y), strict=True))
    return [c.at if c.at is not None else next(free) for c in plan.cylinders]


def layers(plan: Plan, x: Any) -> list[Any]:
    """Layers of all cylinders: those that are free are variables."""
    lifted = dict(zip(plan.lifted, each(x.layer), strict=True)) if plan.lifted else {}
    return [lifted.get(k, c.layer or 1) for k, c in enumerate(plan.cylinders)]


def has_centre(plan: Plan) -> bool:
    """Whether the centre of the container is a variable: of a circle around fixed cylinders."""
    return plan.shape == "circle" and bool(plan.fixed)
