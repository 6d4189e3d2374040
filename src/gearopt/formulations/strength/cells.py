"""Cells of designs of a stage, over which ratings are bounded from below."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from gearopt.formulations.drive.toothing import Toothing
from gearopt.optimise.terms import Array
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import Gear, GearPair

Law = Callable[[Gear], tuple[Any, Any, Any]]
LOWER, UPPER = 0, 1
NUDGE = 1e-11  # relative


@dataclass(frozen=True)
class Cells:
    """Cells (n,) of designs, each between two ends; every field but the first is (2, n).

    toothing: of the gears; teeth z1; ratio u; diameter d1 and wheel d2, module m_n, width b [mm];
    slim b/d1; torque [N mm] and speed [rad/s] of the pinion.
    """

    toothing: Toothing
    teeth: Array
    ratio: Array
    diameter: Array
    wheel: Array
    module: Array
    width: Array
    slim: Array
    torque: Array
    speed: Array

    @property
    def overlap(self) -> Array:
        """Overlap ratios b sin(beta)/(pi m_n)."""
        per_tooth = abs(np.tan(self.toothing.helix_angle)) / np.pi
        return np.asarray(self.slim * self.teeth * per_tooth)

    def corner(self, end: int) -> GearPair:
        """Return pairs of the least or the greatest sizes: modules, teeth, diameters, widths.

        They are one pair of gears only where the cell is a point. Lengths are by NUDGE within the
        cell, so that an end at a border of a law counts to the side on which the cell lies.
        """
        inside = (1.0 + NUDGE, 1.0 - NUDGE)[end]
        sizes = self.module * inside, self.teeth, self.diameter * inside, self.ratio
        made = self.toothing.of_diameter(*(size[end] for size in (*sizes, self.width * inside)))
        wheel = replace(made.wheel, reference_diameter=self.wheel[end] * inside)
        return replace(made, wheel=wheel)

    def of_bodies(self, blank: Blank, member: int, law: Law) -> tuple[Any, Any]:
        """Least and greatest value (n,) of a law of the blanks of a gear.

        law(gear): of the bodies of `Blank.where`, each monotone in module and diameter, so that its
        ends are at theirs; NaN: none. Bodies that no gear of a cell has are left out. As gears grow
        and modules fall, what fits goes on to fit.
        """
        gears = []
        for module, end in product(self.module, (LOWER, UPPER)):
            d, ratio = self.diameter[end], self.ratio[end]
            pair = self.toothing.of_diameter(module, self.teeth[end], d, ratio, 1.0)
            wheel = replace(pair.wheel, reference_diameter=self.wheel[end])
            gears.append((pair.pinion, wheel)[member])
        rims, bores = (
            np.array([np.broadcast_to(where(g, True, False), self.module[0].shape) for g in gears])
            for where in (blank.where_rim, blank.where_bore)
        )
        others = ~rims.all(axis=0)
        there = rims.any(axis=0), others & bores.any(axis=0), others & ~bores.all(axis=0)
        values = [
            np.where(some, value, np.nan)
            for gear in gears
            for some, value in zip(there, law(gear), strict=True)
        ]
        return np.fmin.reduce(values), np.fmax.reduce(values)

    def teeth_alone(self, law: Callable[[GearPair], dict[str, Any]]) -> dict[str, Array]:
        """Ranges (2, n) by name of quantities that follow from the teeth alone.

        Thickness allowances are lengths: of teeth that have some the module counts, too.
        """
        thinner = any(self.toothing.thickness_allowances)
        module = self.module if thinner else np.ones_like(self.module)
        rows = np.stack([*self.teeth, *self.ratio, *module])
        order = np.lexsort(rows)
        fresh = np.append(True, np.any(np.diff(rows[:, order]) != 0.0, axis=0))
        teeth, ratio, module = rows[:, order[fresh]].reshape(3, 2, -1)
        place = np.empty(len(order), int)
        place[order] = np.cumsum(fresh) - 1
        corners = product(teeth, ratio, module if thinner else module[:1])
        made = [law(self.toothing.pair(m, z, z * u, m)) for z, u, m in corners]
        found = {}
        for name in made[0]:
            values = np.array([np.broadcast_to(one[name], teeth[0].shape) for one in made])
            found[name] = np.stack([values.min(axis=0), values.max(axis=0)])[:, place]
        return found
