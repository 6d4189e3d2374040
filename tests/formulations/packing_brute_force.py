"""Packings looked at without the code under test: what is allowed, and the best of tiny ones."""

import math
from itertools import product

import numpy as np
import pytest

from gearopt.formulations.packing.plan import Cylinder, Plan

SIDES = 4001  # widths of a grid, then of a finer one around the best


def random_plan(rng, most_cylinders=5, fixed=True):
    """Two to five cylinders of few sizes, up to four layers, some with a layer, some with a place.

    None where no packing keeps its words.
    """
    count = int(rng.integers(2, most_cylinders + 1))
    most = int(rng.integers(1, 5))
    radius = rng.choice([2.0, 3.0, 4.5, 5.0], count)
    height = rng.choice([5.0, 10.0, 12.0], count)
    names = [int(rng.integers(1, most + 1)) if rng.random() < 0.4 else None for _ in range(count)]
    places = [
        (float(rng.integers(0, 4)) * 7.0, float(rng.integers(0, 3)) * 7.0)
        if fixed and k and rng.random() < 0.3
        else None
        for k in range(count)
    ]
    shape = str(rng.choice(["rectangle", "square", "circle"]))
    parts = zip(radius, height, places, names, strict=True)
    cylinders = tuple(
        Cylinder(f"c{k}", float(r), float(h), at, layer)
        for k, (r, h, at, layer) in enumerate(parts)
    )
    kind = {
        "shape": shape,
        "gap": float(rng.choice([0.0, 0.0, 1.0])),
        "wall": float(rng.choice([0.0, 0.0, 0.7])),
        "min_layers": most if rng.random() < 0.3 else 1,
        "max_layers": most,
        "objective": str(rng.choice(["volume", "area"])),
    }
    try:
        plan = Plan(cylinders, **kind)
    except ValueError:
        assert not any(True for _ in ways(cylinders, kind["min_layers"], most))
        return None
    return plan if any(True for _ in allowed_ways(plan)) else None


def ways(cylinders, least, most):
    """Layers of all cylinders that keep the named ones and leave none empty from the floor up."""
    choices = [range(1, most + 1) if c.layer is None else (c.layer,) for c in cylinders]
    for layers in product(*choices):
        used = set(layers)
        if used == set(range(1, len(used) + 1)) and least <= len(used):
            yield layers


def allowed_ways(plan):
    """Those of `ways` in which fixed cylinders do not overlap."""
    for layers in ways(plan.cylinders, plan.min_layers, plan.max_layers):
        if not any(
            a.at is not None
            and b.at is not None
            and layers[i] == layers[j]
            and math.dist(a.at, b.at) < a.radius + b.radius + plan.gap - 1e-9
            for i, a in enumerate(plan.cylinders)
            for j, b in enumerate(plan.cylinders[:i])
        ):
            yield layers


def tall(plan, layers):
    """Height of a stack."""
    return sum(
        max(c.height for c, at in zip(plan.cylinders, layers, strict=True) if at == k)
        for k in set(layers)
    )


def least_of_two(plan):
    """The least objective where at most two cylinders, none with a place, share a layer.

    Infinite where no such way is allowed. A value of the formula is a packing, so it is never below
    the best; the grid makes it at most 1e-6 above.
    """
    best = math.inf
    for layers in allowed_ways(plan):
        groups = [
            [c.radius for c, at in zip(plan.cylinders, layers, strict=True) if at == k]
            for k in sorted(set(layers))
        ]
        if max(map(len, groups)) > 2:
            continue
        height = tall(plan, layers) if plan.objective == "volume" else 1.0
        best = min(best, height * _area(plan, groups))
    return best


def _area(plan, groups):
    widest = 2.0 * (max(map(max, groups)) + plan.wall)
    pairs = [g for g in groups if len(g) == 2]
    if plan.shape == "circle":
        rows = [2.0 * sum(g) + plan.gap + 2.0 * plan.wall for g in pairs]
        return 0.25 * math.pi * max([widest, *rows]) ** 2

    def depth(w):
        found = np.full(w.shape, widest)
        for a, b in pairs:
            across = np.minimum(np.maximum(w - 2.0 * plan.wall - a - b, 0.0), a + b + plan.gap)
            along = np.sqrt(np.maximum((a + b + plan.gap) ** 2 - across**2, 0.0))
            found = np.maximum(found, along + a + b + 2.0 * plan.wall)
        return found

    low, high = widest, widest + max([2.0 * sum(g) + plan.gap for g in pairs], default=0.0)
    for _ in range(4):
        w = np.linspace(low, high, SIDES)
        values = w * depth(w) if plan.shape == "rectangle" else np.maximum(w, depth(w)) ** 2
        k, step = int(values.argmin()), w[1] - w[0]
        low, high = max(widest, w[k] - 2.0 * step), w[k] + 2.0 * step
    return float(values.min())


def least_at_random(plan, rng, tries=300):
    """The least objective of packings thrown at random; infinite where none was allowed."""
    every, best = list(allowed_ways(plan)), math.inf
    count, size = len(plan.cylinders), 2.0 * plan.radius.sum()
    held = [c.at for c in plan.cylinders]
    near = np.array([p for p in held if p is not None] or [(0.0, 0.0)]).mean(axis=0)
    for _ in range(tries):
        layers = every[int(rng.integers(len(every)))]
        spread = near + size * rng.uniform(0.2, 0.8) * (rng.random((count, 2)) - 0.5)
        at = np.array([spread[k] if p is None else p for k, p in enumerate(held)])
        if fault(plan, at, layers) is None:
            best = min(best, objective(plan, at, layers))
    return best


def drawn_fault(plan, design, value):
    """What is not allowed in a design, or is not as large as it says, or None."""
    box, drawn = design["container"], design["cylinders"]
    at = np.array([(c["x_mm"], c["y_mm"]) for c in drawn])
    layers = tuple(c["layer"] for c in drawn)
    reach = plan.radius + plan.wall - 1e-6
    corner = np.array([box["left_mm"], box["front_mm"]])
    if plan.shape == "circle":
        size = 0.5 * box["diameter_mm"]
        inside = np.hypot(*(at - corner - size).T) + reach <= size
        area = math.pi * size**2
    else:
        sides = np.array([box["width_mm"], box["depth_mm"]])
        inside = (at - reach[:, None] >= corner) & (at + reach[:, None] <= corner + sides)
        area = sides.prod()
    if not inside.all():
        return "outside of the container"
    if value != pytest.approx(area * (tall(plan, layers) if plan.objective == "volume" else 1.0)):
        return f"{value} is not its size"
    return fault(plan, at, layers)


def fault(plan, at, layers):
    """What is not allowed of places and layers, or None."""
    used = set(layers)
    if used != set(range(1, len(used) + 1)) or not plan.min_layers <= len(used) <= plan.max_layers:
        return f"layers {sorted(used)}"
    for i, a in enumerate(plan.cylinders):
        if a.layer is not None and layers[i] != a.layer:
            return f"{a.name} is in layer {layers[i]}"
        if a.at is not None and tuple(at[i]) != a.at:
            return f"{a.name} has moved"
        for j, b in enumerate(plan.cylinders[:i]):
            need = a.radius + b.radius + plan.gap
            if layers[i] == layers[j] and math.dist(at[i], at[j]) < need - 1e-6:
                return f"{a.name} and {b.name} overlap"
    return None


def objective(plan, at, layers):
    """Volume or area of a container around places: the smallest, but for a circle."""
    r = plan.radius[:, None]
    low, high = (at - r).min(axis=0) - plan.wall, (at + r).max(axis=0) + plan.wall
    sides = high - low
    area = sides.prod() if plan.shape == "rectangle" else sides.max() ** 2
    if plan.shape == "circle":
        centre = 0.5 * (low + high)
        area = math.pi * (float((np.hypot(*(at - centre).T) + plan.radius).max()) + plan.wall) ** 2
    return float(area) * (tall(plan, layers) if plan.objective == "volume" else 1.0)
