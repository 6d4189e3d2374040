"""The input of a packing and places in it: cylinders, container, layers as plain numbers."""

from collections.abc import Iterator
from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array

SHAPES = ("rectangle", "square", "circle")
OBJECTIVES = {"volume": "mm3", "area": "mm2"}
TOUCHING = 1e-9  # mm; overlaps below it are rounding of the places written in a file


@dataclass(frozen=True)
class Cylinder:
    """A cylinder with an upright axis: radius and height [mm].

    at: the place of its axis [mm], layer: its layer, each None where free. Layers are counted from
    the floor: 1 is the lowest, and every layer below another holds a cylinder.
    """

    name: str
    radius: float
    height: float
    at: tuple[float, float] | None = None
    layer: int | None = None


@dataclass(frozen=True)
class Plan:
    """Cylinders to be packed, and the container.

    shape: of the container's plan, one of SHAPES. width: of a rectangle [mm], None where free. gap:
    between cylinders, wall: to the container, both sideways [mm]. min_layers, max_layers: least and
    largest number of layers; each of the lowest min_layers holds a cylinder. objective: "volume"
    [mm3], or "area" [mm2] of the plan. ValueError where every cylinder is fixed, or where fewer
    cylinders are left than layers that each must hold one.
    """

    cylinders: tuple[Cylinder, ...]
    shape: str = "rectangle"
    width: float | None = None
    gap: float = 0.0
    wall: float = 0.0
    min_layers: int = 1
    max_layers: int = 1
    objective: str = "volume"

    def __post_init__(self) -> None:
        if not self.free:
            raise ValueError("every cylinder is fixed: nothing is left to place")
        if self.filled > min(self.max_layers, len(self.named) + len(self.free_layers)):
            raise ValueError(f"{self.filled} layers cannot each hold a cylinder")

    @cached_property
    def radius(self) -> Array:
        """Radii [mm], (n,)."""
        return np.array([c.radius for c in self.cylinders], dtype=float)

    @cached_property
    def height(self) -> Array:
        """Heights [mm], (n,)."""
        return np.array([c.height for c in self.cylinders], dtype=float)

    @cached_property
    def free(self) -> tuple[int, ...]:
        """The cylinders whose place is free."""
        return tuple(k for k, c in enumerate(self.cylinders) if c.at is None)

    @cached_property
    def fixed(self) -> tuple[int, ...]:
        """The cylinders whose place is fixed."""
        return tuple(k for k, c in enumerate(self.cylinders) if c.at is not None)

    @cached_property
    def free_layers(self) -> tuple[int, ...]:
        """The cylinders whose layer is to be chosen."""
        single = self.max_layers == 1
        return tuple(k for k, c in enumerate(self.cylinders) if c.layer is None and not single)

    @cached_property
    def named(self) -> frozenset[int]:
        """Layers that hold a cylinder whatever is chosen."""
        free_layers = set(self.free_layers)
        return frozenset(c.layer or 1 for k, c in enumerate(self.cylinders) if k not in free_layers)

    @cached_property
    def filled(self) -> int:
        """Layers from the floor that each hold one: those requested, all up to a named one."""
        return max(self.min_layers, *self.named, 1)

    @cached_property
    def fewest(self) -> int:
        """Layers without which fixed places and layers cannot be kept."""
        return max(self.filled, minimum_layers(self))

    @property
    def pairs(self) -> Iterator[tuple[int, int]]:
        """Pairs of cylinders that a search can move apart."""
        held = set(self.fixed)
        return (p for p in combinations(range(len(self.cylinders)), 2) if not held.issuperset(p))

    def apart(self, i: int, j: int) -> float:
        """Return the minimum distance of two axes in one layer [mm]."""
        return self.cylinders[i].radius + self.cylinders[j].radius + self.gap

    @cached_property
    def reach(self) -> float:
        """A little over the length of a row of all cylinders [mm]; no container need be longer."""
        n = len(self.cylinders)
        row = float(2.0 * self.radius.sum() + (n - 1) * self.gap + 2.0 * self.wall)
        return 1.001 * row

    @cached_property
    def held_box(self) -> tuple[float, float, float, float]:
        """Ends in x and y of the fixed cylinders [mm]; zeros where none is fixed."""
        if not self.fixed:
            return 0.0, 0.0, 0.0, 0.0
        at = [(*(c.at or ()), c.radius) for c in self.cylinders if c.at is not None]
        return (
            min(x - r for x, _, r in at),
            max(x + r for x, _, r in at),
            min(y - r for _, y, r in at),
            max(y + r for _, y, r in at),
        )

    def unit(self) -> str:
        """Return the unit of the objective."""
        return OBJECTIVES[self.objective]


class Places(NamedTuple):
    """Where all cylinders are: axes x, y [mm] and layers from 1, (n,); centre of a circle [mm]."""

    x: Array
    y: Array
    layer: NDArray[np.int64]
    centre: Array

    def copied(self) -> "Places":
        """Return a copy of the places, in arrays of its own."""
        return Places(self.x.copy(), self.y.copy(), self.layer.copy(), self.centre.copy())


def row(plan: Plan) -> Places:
    """Return a packing that meets all limits: the free cylinders in a row behind the fixed ones.

    ValueError where the fixed ones overlap.
    """
    left, _, _, end = plan.held_box
    x, y = np.zeros(len(plan.radius)), np.zeros(len(plan.radius))
    for k, c in enumerate(plan.cylinders):
        if c.at is not None:
            x[k], y[k] = c.at
            continue
        end += plan.gap if end > 0 or plan.fixed else 0.0
        x[k], y[k] = left + c.radius, end + c.radius
        end = y[k] + c.radius
    coloured = colours(plan, plan.max_layers)
    if coloured is None:
        raise ValueError("fixed cylinders overlap in more layers than there are")
    layer = np.array(coloured, dtype=np.int64)
    for level in range(1, plan.filled + 1):
        if not (layer == level).any():
            layer[next(k for k in plan.free_layers if (layer == layer[k]).sum() > 1)] = level
    centre = np.zeros(2)
    if plan.shape == "circle":
        low, high = (x - plan.radius).min(), (x + plan.radius).max()
        near, far = (y - plan.radius).min(), (y + plan.radius).max()
        centre = np.array([0.5 * (low + high), 0.5 * (near + far)])
        if not plan.fixed:
            x, y, centre = x - centre[0], y - centre[1], np.zeros(2)
    return Places(x, y, layer, centre)


def overlap(plan: Plan, i: int, j: int) -> float:
    """Return how much too close two fixed cylinders would be in one layer [mm]; 0 if not."""
    a, b = plan.cylinders[i].at, plan.cylinders[j].at
    assert a is not None and b is not None
    missing = plan.apart(i, j) - float(np.hypot(a[0] - b[0], a[1] - b[1]))
    return missing if missing > TOUCHING else 0.0


def minimum_layers(plan: Plan) -> int:
    """Return the minimum number of layers in which no two fixed cylinders overlap."""
    given = max(c.layer or 1 for c in plan.cylinders)
    return next(k for k in range(given, len(plan.cylinders) + given) if colours(plan, k))


def colours(plan: Plan, layers: int) -> list[int] | None:
    """Return a layer from 1 to `layers` of each cylinder so that no fixed ones overlap, or None."""
    layer_of = [c.layer or 0 for c in plan.cylinders]
    open_ = [k for k in plan.fixed if not layer_of[k]]
    settled = [k for k in plan.fixed if layer_of[k]]

    def fill(rank: int) -> bool:
        if rank == len(open_):
            return True
        k = open_[rank]
        before = settled + open_[:rank]
        for level in range(1, layers + 1):
            if all(layer_of[o] != level or not overlap(plan, k, o) for o in before):
                layer_of[k] = level
                if fill(rank + 1):
                    return True
        layer_of[k] = 0
        return False

    return [level or 1 for level in layer_of] if fill(0) else None
