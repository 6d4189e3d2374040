"""Simulated annealing of discs in layers: cylinders move one at a time, swap, or change layers.

Energy: ln(objective) + weight * (crowding + excess), where a pair of one layer that is too close
crowds by 1 - d^2/D^2 (D: least distance, d: distance), a given width that is exceeded has its
relative excess, and a layer that must hold something but is empty counts as 1.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gearopt.optimise.jit_kernel import entry, inner

Reals = NDArray[np.float64]
Whole = NDArray[np.int64]

RECTANGLE, SQUARE, CIRCLE, STRIP = 0, 1, 2, 3  # STRIP: a rectangle of given width
LIGHT, HEAVY = (
    1.0,
    20.0,
)  # weight of crowding at first and at last: 1 is overlaps for a good packing
ROUNDING = 1e-12  # of a crowding that is kept by differences


@inner
def crowding(i: int, x: Reals, y: Reals, layer: Whole, radius: Reals, gap: float) -> float:
    """How much cylinder i crowds the others of its layer."""
    total = 0.0
    for j in range(x.size):
        if j != i and layer[j] == layer[i]:
            apart = radius[i] + radius[j] + gap
            square = (x[i] - x[j]) ** 2 + (y[i] - y[j]) ** 2
            if square < apart * apart:
                total += 1.0 - square / (apart * apart)
    return total


@inner
def crowding_of_all(x: Reals, y: Reals, layer: Whole, radius: Reals, gap: float) -> float:
    """The crowding of all pairs."""
    total = 0.0
    for i in range(x.size):
        total += crowding(i, x, y, layer, radius, gap)
    return 0.5 * total


@inner
def stack(layer: Whole, height: Reals, least: int, most: int) -> tuple[float, int]:
    """Sum of the heights of the layers, and the number of layers that lack a cylinder."""
    total, missing = 0.0, 0
    for level in range(1, most + 1):
        tallest = 0.0
        for i in range(layer.size):
            if layer[i] == level and height[i] > tallest:
                tallest = height[i]
        total += tallest
        if tallest == 0.0 and level <= least:
            missing += 1
    return total, missing


@inner
def plan_area(
    x: Reals, y: Reals, centre: Reals, radius: Reals, shape: int, wall: float, width: float
) -> tuple[float, float]:
    """Area of the container, and the relative excess over a given width."""
    if shape == CIRCLE:
        far = 0.0
        for i in range(x.size):
            far = max(far, math.hypot(x[i] - centre[0], y[i] - centre[1]) + radius[i])
        return math.pi * (far + wall) ** 2, 0.0
    low, high, near, far = np.inf, -np.inf, np.inf, -np.inf
    for i in range(x.size):
        low, high = min(low, x[i] - radius[i]), max(high, x[i] + radius[i])
        near, far = min(near, y[i] - radius[i]), max(far, y[i] + radius[i])
    across, along = high - low + 2.0 * wall, far - near + 2.0 * wall
    if shape == SQUARE:
        return max(across, along) ** 2, 0.0
    if shape == STRIP:
        return width * along, max(0.0, across / width - 1.0)
    return across * along, 0.0


@inner
def propose(
    step: float,
    x: Reals,
    y: Reals,
    layer: Whole,
    centre: Reals,
    radius: Reals,
    height: Reals,
    held: Whole,
    gap: float,
    most: int,
    anchored: bool,
) -> int:
    """Change the state by one random move of length `step`.

    Returns the cylinder that moved, -1 where several did, -2 where none could.
    """
    n = x.size
    i, other, kind = np.random.randint(n), np.random.randint(n), np.random.random()
    movable = held[i] & 1 == 0
    if kind < 0.06 and movable:  # swap two unlike ones
        alike = radius[other] == radius[i] and height[other] == height[i]
        if alike or held[other] != held[i]:
            return -2
        x[i], x[other] = x[other], x[i]
        y[i], y[other] = y[other], y[i]
        if held[i] == 0:
            layer[i], layer[other] = layer[other], layer[i]
        return -1
    if kind < 0.10 and most > 1 and held[i] & 2 == 0:  # to another layer, perhaps elsewhere
        layer[i] = np.random.randint(1, most + 1)
        if movable and np.random.random() < 0.7:
            x[i] = x[other] + radius[other] * np.random.normal()
            y[i] = y[other] + radius[other] * np.random.normal()
        return i
    if kind < 0.13 and movable:  # beside another one
        angle, away = 2.0 * math.pi * np.random.random(), radius[i] + radius[other] + gap
        x[i] = x[other] + away * math.cos(angle)
        y[i] = y[other] + away * math.sin(angle)
        return i
    if kind < 0.16:  # all a little, and the centre of a circle
        for j in range(n):
            if held[j] & 1 == 0:
                x[j] += 0.3 * step * np.random.normal()
                y[j] += 0.3 * step * np.random.normal()
        if anchored:
            centre[0] += 0.3 * step * np.random.normal()
            centre[1] += 0.3 * step * np.random.normal()
        return -1
    if not movable:
        return -2
    if np.random.random() < 0.7:
        x[i] += step * np.random.normal()
    if np.random.random() < 0.7:
        y[i] += step * np.random.normal()
    return i


@inner
def copy(
    x: Reals,
    y: Reals,
    layer: Whole,
    centre: Reals,
    to_x: Reals,
    to_y: Reals,
    to_layer: Whole,
    to_centre: Reals,
) -> None:
    """Copy a state, entry by entry: numba compiles that in a tenth of the time of slices."""
    for i in range(x.size):
        to_x[i], to_y[i], to_layer[i] = x[i], y[i], layer[i]
    to_centre[0], to_centre[1] = centre[0], centre[1]


@inner
def mean_diameter(radius: Reals) -> float:
    """Mean diameter of the cylinders."""
    size: float = 0.0
    for k in range(radius.size):
        size += radius[k]
    mean: float = 2.0 * (size / radius.size)
    return mean


@inner
def take(
    i: int,
    x: Reals,
    y: Reals,
    layer: Whole,
    centre: Reals,
    to_x: Reals,
    to_y: Reals,
    to_layer: Whole,
    to_centre: Reals,
) -> None:
    """Copy what a move changed: cylinder i, or all of a state for -1."""
    if i == -1:
        copy(x, y, layer, centre, to_x, to_y, to_layer, to_centre)
    else:
        to_x[i], to_y[i], to_layer[i] = x[i], y[i], layer[i]


@inner
def keep(
    x: Reals,
    y: Reals,
    layer: Whole,
    centre: Reals,
    radius: Reals,
    gap: float,
    value: float,
    best: Reals,
) -> float:
    """Keep a state that crowds nothing as the best one, with its objective; return its crowding."""
    n = x.size
    crowd: float = crowding_of_all(x, y, layer, radius, gap)
    if crowd > 0.0:
        return crowd
    for k in range(n):
        best[k], best[n + k], best[2 * n + k] = x[k], y[k], layer[k]
    best[3 * n], best[3 * n + 1], best[3 * n + 2] = centre[0], centre[1], value
    return crowd


@entry
def anneal(
    seed: int,
    first: int,
    last: int,
    total: int,
    hot: float,
    cold: float,
    x: Reals,
    y: Reals,
    layer: Whole,
    centre: Reals,
    radius: Reals,
    height: Reals,
    held: Whole,
    numbers: Reals,
    best: Reals,
) -> int:
    """Make moves `first` to `last` of an annealing of `total` moves from temperature hot to cold.

    x, y, layer, centre: the state, changed in place. held (n,): 1 the place is fixed, 2 the layer,
    3 both, 0 neither. numbers: gap, wall, width, shape, 1 for volume (0: area), least, most, 1
    where a place is fixed. best (3 n + 3,): the best state that meets all limits (x, y, layer,
    centre) and its objective, changed in place. Returns the number of moves that changed anything.
    """
    np.random.seed(seed)
    gap, wall, width = numbers[0], numbers[1], numbers[2]
    shape, volume = int(numbers[3]), numbers[4] > 0.0
    least, most, anchored = int(numbers[5]), int(numbers[6]), numbers[7] > 0.0
    n, size, accepted = x.size, mean_diameter(radius), 0
    old_x, old_y, old_layer, old_centre = x.copy(), y.copy(), layer.copy(), centre.copy()
    crowd = crowding_of_all(x, y, layer, radius, gap)
    tall, missing = stack(layer, height, least, most)
    area, excess = plan_area(x, y, centre, radius, shape, wall, width)
    value = area * tall if volume else area
    for move in range(first, last):
        temperature = hot * (cold / hot) ** (move / total)
        weight = LIGHT + (HEAVY - LIGHT) * move / total
        step = size * max(1e-4, min(1.0, 2.0 * math.sqrt(temperature)))
        i = propose(step, x, y, layer, centre, radius, height, held, gap, most, anchored)
        if i == -2:
            continue
        new_crowd = crowding_of_all(x, y, layer, radius, gap) if i == -1 else crowd
        if i != -1:
            new_crowd += crowding(i, x, y, layer, radius, gap)
            new_crowd -= crowding(i, old_x, old_y, old_layer, radius, gap)
        new_tall, new_missing = stack(layer, height, least, most) if most > 1 else (tall, missing)
        new_area, new_excess = plan_area(x, y, centre, radius, shape, wall, width)
        new_value = new_area * new_tall if volume else new_area
        change = new_crowd - crowd + new_excess - excess + new_missing - missing
        worse = math.log(new_value / value) + weight * change
        if worse > 0.0 and np.random.random() >= math.exp(-worse / temperature):
            take(i, old_x, old_y, old_layer, old_centre, x, y, layer, centre)
            continue
        accepted += 1
        crowd, excess, tall = max(0.0, new_crowd), new_excess, new_tall
        missing, value = new_missing, new_value
        take(i, x, y, layer, centre, old_x, old_y, old_layer, old_centre)
        if crowd < ROUNDING and excess == 0.0 and missing == 0 and value < best[3 * n + 2]:
            crowd = keep(x, y, layer, centre, radius, gap, value, best)
    return accepted
