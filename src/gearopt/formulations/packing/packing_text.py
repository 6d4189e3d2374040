"""The problem of a packing, twice: with largest extents for samplers, with epigraphs for gradients.

Both have x, y [mm] of the free cylinders. Pairs of one layer keep 2 - d^2/D^2 <= 1 (d: distance,
D: minimum distance of the axes), so nothing is divided by a distance that may vanish.
"""

import math
from functools import reduce
from itertools import combinations
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations.packing.plan import Places, Plan, row
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Param, Terms, Var, each, namespace

NEVER = -1.0  # needed d^2/D^2 of a pair in different layers


def direct(plan: Plan, **methods: Any) -> Problem:
    """Return the packing for samplers: the objective is that of the smallest container around all.

    Variables: x, y, the layers that are free, and the centre of a circle around fixed cylinders.
    """
    guess = row(plan)
    variables = [*_axes(plan, guess), *_centre(plan, guess)]
    if plan.free_layers:
        start = tuple(float(guess.layer[k]) for k in plan.free_layers)
        layers = Var("layer", "", 1, plan.max_layers, start, len(plan.free_layers), integer=True)
        variables.append(layers)

    def evaluate(x: Any, p: Any) -> Terms:
        axes = axes_of(plan, x)
        layer = layers_of(plan, x)
        area, limits = _container(plan, axes, x)
        defines: dict[str, Any] = {}
        rows = tuple(_close(plan, axes, layer, i, j) for i, j in _near(plan))
        if rows:
            defines["apart"] = rows
        if plan.free_layers and plan.filled > 1:
            held = [sum(np.where(at == k, 1.0, 0.0) for at in layer) for k in _levels(plan.filled)]
            defines["occupied"] = tuple(2.0 - count for count in held)
        return Terms(_objective(plan, area, stack(plan, layer)), limits, defines)

    return Problem("packing", tuple(variables), (), evaluate, methods=methods)


def smooth(plan: Plan, layer: Any = None) -> Problem:
    """Return the packing for gradient methods: container sizes are variables, layers are data.

    layer: that of every cylinder (n,), by default the fixed ones; parameters `needed` (pairs; the
    square of minimum distance over D, or NEVER) and `height` of the stack let other layers be
    solved without tracing again. SolveError where layers are free and not given.
    """
    if layer is None and plan.free_layers:
        raise SolveError(
            "gradient methods need fixed layers: give every [[cylinder]] its layer, or use hop"
        )
    guess = row(plan)
    levels = guess.layer if layer is None else layer
    pairs = tuple(plan.pairs)
    needed, tall = of_layers(plan, levels)
    parameters: tuple[Param, ...] = (Param("height", "mm", tall),)
    if pairs:
        gap = Param("gap", "mm", plan.gap, key="container.gap", role="limit")
        parameters = (*parameters, Param("needed", "", needed, len(pairs)), gap)
    if plan.width is not None:
        parameters = (*parameters, Param("width", "mm", plan.width, key="container.width"))
    variables = (*_axes(plan, guess), *_sides(plan, guess))

    def evaluate(x: Any, p: Any) -> Terms:
        axes = axes_of(plan, x)
        width = getattr(p, "width", None)
        walls = _walls(plan, axes, x, width)
        if pairs:
            squares = [_squared_distance_ratio(plan, axes, i, j, p.gap) for i, j in pairs]
            walls["apart"] = tuple(
                1.0 + (need - there) for need, there in zip(each(p.needed), squares, strict=True)
            )
        return Terms(_objective(plan, _area(plan, x, width), p.height), defines=walls)

    return Problem("packing", variables, parameters, evaluate)


def of_layers(plan: Plan, layer: Any) -> tuple[tuple[float, ...], float]:
    """Return the parameters of `smooth` for layers (n,): needed of every pair, height of all."""
    needed = tuple(1.0 if layer[i] == layer[j] else NEVER for i, j in plan.pairs)
    return needed, float(stack(plan, layer))


def stack(plan: Plan, layer: Any) -> Any:
    """Return the sum of the layers' heights [mm]; a layer is as high as its highest cylinder."""
    height = plan.height
    return sum(
        reduce(
            np.maximum,
            [np.where(at == k, h, 0.0) for at, h in zip(layer, height, strict=True)],
        )
        for k in _levels(plan.max_layers)
    )


def _levels(layers: int) -> range:
    return range(1, layers + 1)


def _ends(plan: Plan) -> tuple[float, float, float, float]:
    """Ends of a search in x and y [mm]: a row of all cylinders beyond the fixed ones."""
    if plan.fixed:
        low, high, near, far = plan.held_box
        return low - plan.reach, high + plan.reach, near - plan.reach, far + plan.reach
    return (-plan.reach, plan.reach, -plan.reach, plan.reach)


def _axes(plan: Plan, guess: Places) -> tuple[Var, ...]:
    low, high, near, far = _ends(plan)
    free, r, wall = list(plan.free), plan.radius, plan.wall
    count = len(free)
    if plan.fixed or plan.shape == "circle":
        across, along = ((low,) * count, (high,) * count), ((near,) * count, (far,) * count)
    else:  # the container's corner is the origin
        minimum = tuple(float(v) for v in r[free] + wall)
        maximum = tuple(float(v) for v in plan.reach - r[free] - wall)
        across = along = (minimum, tuple(max(a, b) for a, b in zip(minimum, maximum, strict=True)))
    gx, gy = guess.x[free], guess.y[free]
    if not (plan.fixed or plan.shape == "circle"):
        gx, gy = gx + wall, gy + wall
    return (
        Var("x", "mm", *across, tuple(gx.tolist()), count, search=True),
        Var("y", "mm", *along, tuple(gy.tolist()), count, search=True),
    )


def _centre(plan: Plan, guess: Places) -> tuple[Var, ...]:
    if not has_centre(plan):
        return ()
    low, high, near, far = _ends(plan)
    return (
        Var("centre_x", "mm", low, high, float(guess.centre[0]), search=True),
        Var("centre_y", "mm", near, far, float(guess.centre[1]), search=True),
    )


def _sides(plan: Plan, guess: Places) -> tuple[Var, ...]:
    """Return the container's variables; a corner or centre only where something is fixed."""
    at = point_of_packing(plan, guess)[2 * len(plan.free) :]
    low, high, near, far = _ends(plan)
    maximum = 2.0 * max(high - low, far - near)
    minimum = 2.0 * float(plan.radius.max() + plan.wall)
    names: dict[str, tuple[float, float]] = {}
    if plan.shape == "circle":
        names = {"centre_x": (low, high), "centre_y": (near, far)} if plan.fixed else {}
        names |= {"container_radius": (0.5 * minimum, maximum)}
    else:
        if plan.fixed:
            names = {"left": (low - maximum, high), "front": (near - maximum, far)}
        sides = ("side",) if plan.shape == "square" else ("width", "depth")
        names |= {n: (minimum, maximum) for n in (sides if plan.width is None else ("depth",))}
    return tuple(
        Var(name, "mm", *ends, float(np.clip(v, *ends)), search=True)  # a rounding may be outside
        for (name, ends), v in zip(names.items(), at, strict=True)
    )


def _squared_distance_ratio(
    plan: Plan, axes: list[tuple[Any, Any]], i: int, j: int, gap: Any
) -> Any:
    """d^2/D^2 of a pair."""
    (a, b), (c, d) = axes[i], axes[j]
    apart = plan.cylinders[i].radius + plan.cylinders[j].radius + gap
    return ((a - c) ** 2 + (b - d) ** 2) / apart**2


def _near(plan: Plan) -> list[tuple[int, int]]:
    """Return pairs that may come too close: not both fixed, in layers that may be the same."""
    free_layers, cylinders = set(plan.free_layers), plan.cylinders
    pairs = []
    for i, j in combinations(range(len(cylinders)), 2):
        free = not free_layers.isdisjoint((i, j))
        same = (cylinders[i].layer or 1) == (cylinders[j].layer or 1)
        moved = cylinders[i].at is None or cylinders[j].at is None
        if free or (same and moved):
            pairs.append((i, j))
    return pairs


def _close(plan: Plan, axes: list[tuple[Any, Any]], layer: list[Any], i: int, j: int) -> Any:
    """Return the row of a pair: 2 - d^2/D^2 in one layer, 0 in different ones."""
    row_of = 2.0 - _squared_distance_ratio(plan, axes, i, j, plan.gap)
    return np.where(layer[i] == layer[j], row_of, 0.0) if plan.free_layers else row_of


def _extent(values: list[Any], radius: Array) -> Any:
    high = reduce(np.maximum, [v + r for v, r in zip(values, radius, strict=True)])
    return high - reduce(np.minimum, [v - r for v, r in zip(values, radius, strict=True)])


def _container(plan: Plan, axes: list[tuple[Any, Any]], x: Any) -> tuple[Any, dict[str, Any]]:
    """Return the area of the smallest container [mm2], and the limit of a given width."""
    if plan.shape == "circle":
        a, b = getattr(x, "centre_x", 0.0), getattr(x, "centre_y", 0.0)
        far = reduce(
            np.maximum,
            [
                np.sqrt((u - a) ** 2 + (v - b) ** 2) + r
                for (u, v), r in zip(axes, plan.radius, strict=True)
            ],
        )
        return math.pi * (far + plan.wall) ** 2, {}
    across = _extent([a for a, _ in axes], plan.radius) + 2.0 * plan.wall
    along = _extent([b for _, b in axes], plan.radius) + 2.0 * plan.wall
    if plan.shape == "square":
        return np.maximum(across, along) ** 2, {}
    if plan.width is not None:
        return plan.width * along, {"width": across / plan.width}
    return across * along, {}


def _area(plan: Plan, x: Any, width: Any) -> Any:
    if plan.shape == "circle":
        return math.pi * x.container_radius**2
    if plan.shape == "square":
        return x.side**2
    return x.depth * (x.width if width is None else width)


def _walls(plan: Plan, axes: list[tuple[Any, Any]], x: Any, width: Any) -> dict[str, Any]:
    """Return the rows, by wall, that keep cylinders inside the container, where no bound does.

    width: of a container that has no variable for it.
    """
    scale = 2.0 * float(plan.radius.mean())
    if plan.shape == "circle":
        a, b = getattr(x, "centre_x", 0.0), getattr(x, "centre_y", 0.0)
        rows = [
            1.0
            + ((u - a) ** 2 + (v - b) ** 2 - (x.container_radius - plan.wall - r) ** 2) / scale**2
            for (u, v), r in zip(axes, plan.radius, strict=True)
        ]
        return {"inside": tuple(rows)}
    left, front = getattr(x, "left", 0.0), getattr(x, "front", 0.0)
    width = getattr(x, "side", getattr(x, "width", width))
    depth = getattr(x, "side", getattr(x, "depth", None))
    need = plan.radius + plan.wall
    sides: dict[str, Any] = {}
    if plan.fixed:
        sides["left_side"] = tuple(
            1.0 + (left + n - u) / scale for (u, _), n in zip(axes, need, strict=True)
        )
        sides["front_side"] = tuple(
            1.0 + (front + n - v) / scale for (_, v), n in zip(axes, need, strict=True)
        )
    sides["right_side"] = tuple(
        1.0 + (u + n - left - width) / scale for (u, _), n in zip(axes, need, strict=True)
    )
    sides["back_side"] = tuple(
        1.0 + (v + n - front - depth) / scale for (_, v), n in zip(axes, need, strict=True)
    )
    return sides


def _objective(plan: Plan, area: Any, height: Any) -> dict[str, Any]:
    return {"volume": area * height} if plan.objective == "volume" else {"area": area}


def places(plan: Plan, problem: Problem, at: Array, layer: Any = None) -> Places:
    """Return where all cylinders are at a point of either text; layer: those given to `smooth`."""
    x = namespace(problem.variables, [float(v) for v in at])
    both = axes_of(plan, x)
    centre = np.array([getattr(x, "centre_x", 0.0), getattr(x, "centre_y", 0.0)], float)
    layer = [round(float(k)) for k in layers_of(plan, x)] if layer is None else layer
    return Places(
        np.array([a for a, _ in both], float),
        np.array([b for _, b in both], float),
        np.array(layer, dtype=np.int64),
        centre,
    )


def point(plan: Plan, found: Places) -> Array:
    """Return the point of `direct` of a packing; if nothing is fixed, its corner is the origin."""
    free, x, y = list(plan.free), found.x, found.y
    if not plan.fixed and plan.shape != "circle":
        x, y = (v - float((v - plan.radius).min()) + plan.wall for v in (x, y))
    parts = [x[free], y[free]]
    if has_centre(plan):
        parts.append(found.centre)
    parts.append(found.layer[list(plan.free_layers)].astype(float))
    return np.concatenate(parts)


def point_of_packing(plan: Plan, found: Places) -> Array:
    """Return the variables of `smooth` for a packing, with the smallest container around it."""
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


def axes_of(plan: Plan, x: Any) -> list[tuple[Any, Any]]:
    """Return the axes of all cylinders: those of the free ones are variables."""
    free = iter(zip(each(x.x), each(x.y), strict=True))
    return [c.at if c.at is not None else next(free) for c in plan.cylinders]


def layers_of(plan: Plan, x: Any) -> list[Any]:
    """Return the layers of all cylinders: those that are free are variables."""
    free_layers = (
        dict(zip(plan.free_layers, each(x.layer), strict=True)) if plan.free_layers else {}
    )
    return [free_layers.get(k, c.layer or 1) for k, c in enumerate(plan.cylinders)]


def has_centre(plan: Plan) -> bool:
    """Return whether the centre is a variable: that of a circle around fixed cylinders."""
    return plan.shape == "circle" and bool(plan.fixed)
