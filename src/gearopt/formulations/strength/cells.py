"""Cells of designs of a stage, over which ratings are bounded from below."""

from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from gearopt.formulations.drive.toothing import Toothing
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import Gear, GearPair

Law = Callable[[Gear], tuple[Any, Any, Any]]
LOWER, UPPER = 0, 1
NUDGE = 1e-11  # relative
ROUNDER = 2.0  # of a parabola the middle is off the mean by all that it rises above both ends


@dataclass(frozen=True)
class Cells:
    """Cells (n,) of designs, each between two ends; every field but the first is (2, n).

    toothing: of the gears, but for a helix angle between the two of helix [rad], None: its own;
    teeth z1; ratio u; diameter d1 and wheel d2, module m_n, width b [mm];
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
    helix: Array | None = None

    @property
    def helix_bounds(self) -> tuple[Any, Any]:
        """The least and the greatest helix angle [rad], without sign."""
        if self.helix is None:
            return (abs(self.toothing.helix_angle),) * 2
        return self.helix[LOWER], self.helix[UPPER]

    def cut(self, end: int) -> Toothing:
        """The toothing of the least or the greatest helix angle."""
        if self.helix is None:
            return self.toothing
        return replace(self.toothing, helix_angle=self.helix[end])

    @property
    def overlap(self) -> Array:
        """Overlap ratios b sin(beta)/(pi m_n)."""
        per_tooth = np.stack(np.broadcast_arrays(*self.helix_bounds, self.teeth[0])[:2])
        return np.asarray(self.slim * self.teeth * np.tan(per_tooth) / np.pi)

    def corner(self, end: int) -> GearPair:
        """Return pairs of the least or the greatest sizes: modules, teeth, diameters, widths.

        They are one pair of gears only where the cell is a point. Helix angles are those of the
        least or greatest base pitch deviation f_pt cos(alpha_t): the other way round. Lengths are
        by NUDGE within the cell, so that an end at a border of a law counts to the side on which
        the cell lies.
        """
        inside = (1.0 + NUDGE, 1.0 - NUDGE)[end]
        sizes = self.module * inside, self.teeth, self.diameter * inside, self.ratio
        pair = self.cut(1 - end).of_diameter(*(size[end] for size in (*sizes, self.width * inside)))
        wheel = replace(pair.wheel, reference_diameter=self.wheel[end] * inside)
        return replace(pair, wheel=wheel)

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

        Thickness allowances are lengths: of teeth that have some the module counts, too. Between
        two helix angles ranges are widened by what the middle one is off the mean, ROUNDER times.
        """
        thinner = any(self.toothing.thickness_allowances)
        module = self.module if thinner else np.ones_like(self.module)
        helix = np.zeros_like(module) if self.helix is None else self.helix
        rows = np.stack([*self.teeth, *self.ratio, *module, *helix])
        order = np.lexsort(rows)
        fresh = np.append(True, np.any(np.diff(rows[:, order]) != 0.0, axis=0))
        teeth, ratio, module, helix = rows[:, order[fresh]].reshape(4, 2, -1)
        place = np.empty(len(order), int)
        place[order] = np.cumsum(fresh) - 1
        corners = product(teeth, ratio, module if thinner else module[:1])
        angles = (None,) if self.helix is None else (helix[LOWER], helix[UPPER], helix.mean(axis=0))
        cuts = [
            self.toothing if one is None else replace(self.toothing, helix_angle=one)
            for one in angles
        ]
        numbers = [law(cut.pair(m, z, z * u, m)) for z, u, m in corners for cut in cuts]
        found = {}
        for name in numbers[0]:
            values = np.array([np.broadcast_to(row[name], teeth[0].shape) for row in numbers])
            values = values.reshape(-1, len(cuts), len(teeth[0]))
            ends, off = values[:, :2], 0.0
            if len(cuts) > 1:
                off = ROUNDER * np.abs(values[:, 2] - ends.mean(axis=1)).max(axis=0)
            least, most = ends.min(axis=(0, 1)) - off, ends.max(axis=(0, 1)) + off
            found[name] = np.stack([least, most])[:, place]
        return found
