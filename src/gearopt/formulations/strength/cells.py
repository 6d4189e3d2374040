"""Cells of designs of a stage, over which ratings are bounded from below."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from itertools import chain, product
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
MIDDLE = 2  # place of the middle of a range beside LOWER and UPPER


@dataclass(frozen=True)
class Cells:
    """Cells (n,) of designs, each between two ends; every field but the first is (2, n).

    toothing: of the gears, but for its fields that ranges have, each between two ends;
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
    ranges: Mapping[str, Array] = field(default_factory=dict)

    @property
    def helix_bounds(self) -> tuple[Any, Any]:
        """The least and the greatest helix angle [rad], without sign."""
        low, high = self.ranges.get("helix_angle", (abs(self.toothing.helix_angle),) * 2)
        return low, high

    def cut(self, end: int, **ends: int) -> Toothing:
        """The toothing of the least or the greatest helix angle and, unless told, sum of shifts.

        ends: of other fields than the helix angle.
        """
        places = {"helix_angle": end, "pinion_shift": LOWER, "shift_sum": UPPER} | ends
        fields = {name: ends[places[name]] for name, ends in self.ranges.items()}
        return self.toothing.at(fields)

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

        Thickness allowances are lengths: of teeth that have some the module counts, too. Corners
        need not be the extremes along `ranges`, nor along any side where teeth have profile shifts:
        ranges are widened by what the middle is off the mean of the ends there, ROUNDER times.
        """
        toothing = self.toothing
        sides = {"teeth": self.teeth, "ratio": self.ratio}
        if any(toothing.thickness_allowances):
            sides["module"] = self.module
        sides |= self.ranges
        rows = np.stack([*chain(*sides.values())])
        order = np.lexsort(rows)
        fresh = np.append(True, np.any(np.diff(rows[:, order]) != 0.0, axis=0))
        place = np.empty(len(order), int)
        place[order] = np.cumsum(fresh) - 1
        held = rows[:, order[fresh]].reshape(len(sides), 2, -1)
        several = [not np.array_equal(*ends) for ends in held]
        shifted = toothing.shifting is not None or any(toothing.profile_shifts)
        wide = [name for name, many in zip(sides, several, strict=True) if many]
        places, arms = _places([shifted or name in self.ranges for name in wide])
        at_ends, columns = zip(*places, strict=True), {}
        for name, ends, many in zip(sides, held, several, strict=True):
            at = next(at_ends) if many else (LOWER,) * len(places)
            middle = ends.mean(axis=0) if name in self.ranges else 2.0 / (1.0 / ends).sum(axis=0)
            values = np.stack([*ends, middle])
            columns[name] = np.concatenate([values[k] for k in at])
        z, u = columns.pop("teeth"), columns.pop("ratio")
        m = columns.pop("module", np.ones_like(z))
        quantities = law(toothing.at(columns).pair(m, z, z * u, m))
        shape, corners = (len(places), -1), 2 ** sum(several)
        return {
            name: _widened(np.broadcast_to(value, z.shape).reshape(shape), corners, arms)[:, place]
            for name, value in quantities.items()
        }


def _widened(values: Array, corners: int, arms: list[tuple[int, int, int]]) -> Array:
    """Return the range (2, n) of values (places, n), of which the first are at the corners.

    It is widened by what the middles of lines are off the means of their ends, ROUNDER times.
    """
    least, most = values[:corners].min(axis=0), values[:corners].max(axis=0)
    off = np.zeros_like(least)
    for middle, low, high in arms:
        off = off + ROUNDER * np.abs(values[middle] - 0.5 * (values[low] + values[high]))
    least = np.where(least > 0.0, np.maximum(least - off, 0.0), least - off)
    return np.stack([least, most + off])


def _places(lines: Sequence[bool]) -> tuple[list[tuple[int, ...]], list[tuple[int, int, int]]]:
    """Return places on sides, the corners first, and the three of each middle line.

    lines: of which sides there is one, through the middle of the others: its middle, its ends.
    """
    places = list(product((LOWER, UPPER), repeat=len(lines)))
    middle, arms = (MIDDLE,) * len(lines), []
    for k in (k for k, drawn in enumerate(lines) if drawn):
        line = [(*middle[:k], end, *middle[k + 1 :]) for end in (MIDDLE, LOWER, UPPER)]
        places += [at for at in line if at not in places]
        first, second, third = map(places.index, line)
        arms.append((first, second, third))
    return places, arms
