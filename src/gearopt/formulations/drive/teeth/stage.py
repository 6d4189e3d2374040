"""The choices of one stage: tooth pairs sorted by ratio, the module and width each one needs.

Ties at whole numbers (ratio and diameter limits, widths on a step) are decided in rational
arithmetic. With a helix angle the diameter contains cos(beta), which for angles in degrees is
irrational except at 0, 60 and 90 (Niven's theorem), so no tie with a rational limit exists there.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.teeth.columns import Index, closed
from gearopt.formulations.drive.train import Stage, Train
from gearopt.formulations.strength import ALLOWANCE, HALVINGS
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

TEETH = 10**8  # more than a wheel has: pairs are told apart by z1 TEETH + z2
EDGE = 1e-9  # cells overlap by this much in log ratio, so that rounding never misses a neighbour


@dataclass(frozen=True)
class Cells:
    """Cells of torque and of ratio, so many of each, all `delta` wide in logarithms.

    useful (torque, ratio): those asked for, None: all; others may count as inf, as may what costs
    more than `most`. first (torque, pairs): of cells of torque twice as wide, the first module
    (index) that may be of use; None: not known.
    """

    torque: int
    ratio: int
    delta: float
    useful: NDArray[np.bool_] | None = None
    most: float = np.inf
    first: NDArray[np.int16] | None = None

    def batches(self, pairs: int, most: int) -> Iterator[NDArray[np.int64]]:
        """Yield cells of torque in order, as many at once as have about so many of the pairs."""
        every, size = np.arange(self.torque), np.full(self.torque, pairs)
        if self.useful is not None:
            size = np.ceil(self.useful[: self.torque].mean(axis=1) * pairs).astype(np.int64)
        every, size = every[size > 0], np.cumsum(size[size > 0])
        yield from np.split(every, np.flatnonzero(np.diff(size // most)) + 1)


Grid = tuple[Array, NDArray[np.int16] | None]


@dataclass(frozen=True)
class Table:
    """Tooth pairs (n,) of one stage with ratios up to `cut`, increasing.

    toothing: which of the stage's toothings cuts them. Pairs that may be cut in several ways are as
    many rows.
    first, last: indices of the modules that diameter and width limits allow. steps: minimum and
    maximum number of width steps, (modules, n), or None. load: of a proportional law the minimum
    width is load T/m^2 [mm]; the minimum module for torque T is need T**exponent; slope: minimum
    objective per torque, from the load limits alone. Of other laws load is None, need and slope are
    0.
    """

    train: Train
    position: int
    z1: Index
    z2: Index
    toothing: Index
    ratio: Array
    log_ratio: Array
    modules: Array
    first: Index
    last: Index
    steps: tuple[Array, Array] | None
    load: Array | None
    need: Array
    exponent: float
    slope: Array
    cut: Fraction

    @property
    def stage(self) -> Stage:
        """The stage's limits."""
        return self.train.stages[self.position]

    @cached_property
    def names(self) -> Index:
        """Number of every row, of rows with the same teeth one: z1 TEETH + z2."""
        return np.asarray(self.z1 * TEETH + self.z2)

    @property
    def step(self) -> float:
        """Step of the face width [mm]; nan where there is none."""
        step = self.stage.face_width.step
        return math.nan if step is None else float(step)

    def made(self, module: Any, pair: Any) -> GearPair:
        """Return the gear pairs (indices) with modules [mm], of face width 1 mm."""
        toothing = self.toothing[pair] if len(self.stage.toothings) > 1 else 0
        return self.train.pair(self.position, module, self.z1[pair], self.z2[pair], 1.0, toothing)

    def cost(self, torque: Array, pair: Index, most: Array | float = np.inf) -> Array:
        """Return the minimum share of pairs at torques [N mm]; inf where nothing carries them.

        most: values above which any is as good as inf.
        """
        return self._best(torque, pair)[0]

    def choose(self, torque: float, pair: int) -> tuple[float, float, int]:
        """Return the module, the face width [mm] and the option behind `cost`."""
        _, module, width = self._best(np.array([torque]), np.array([pair]))
        return module.item(), width.item(), 0

    def rough_cost(self, torque: Array, pair: Index, most: Array | float = np.inf) -> Array:
        """Return a rough lower bound of `cost`; most: as there."""
        return self.cost(torque, pair)

    def least_cost(
        self,
        torque: tuple[Array, Array],
        pair: Index,
        group: Index,
        delta: float,
        most: Array | float = np.inf,
    ) -> Array:
        """Return lower bounds of `cost` at torques [N mm] between two ends.

        The least of every group (n,) of pairs is of use, in cells of delta, up to so much.
        """
        return self.cost(torque[0], pair)

    def useful_ratio(self, least: float, most: float) -> float:
        """Return the largest ratio whose share of a train is at most so much; at least `least`."""
        return float(max(self.ratio.max(initial=0.0), least))

    def grid(self, cells: Cells, tick: Callable[[], float]) -> Grid:
        """Minimum cost (torque cells, ratio cells), and first modules of use where they serve.

        A lower bound: of the torques of a cell the smallest, of its pairs the best.
        """
        column = (self.log_ratio / cells.delta).astype(np.int64)
        found = np.full(cells.torque * cells.ratio, np.inf)
        wheel = self.train.driver == "wheel"  # then torques fall from cell to cell, and by ratios
        for k in range(len(self.modules)):
            tick()
            with np.errstate(divide="ignore"):
                reach = np.log(self.capacity(k) / self.train.torque) + EDGE
            least = np.ceil(-(reach + self.log_ratio) / cells.delta) - 1.0
            carries = least < cells.torque if wheel else reach >= 0.0
            end = (least if wheel else reach / cells.delta)[carries]
            row = np.clip(end, 0, cells.torque - 1).astype(np.int64)
            np.minimum.at(found, row * cells.ratio + column[carries], self.floor(k)[carries])
        on = slice(None, None, 1 if wheel else -1)  # what carries more carries less
        grid = np.minimum.accumulate(found.reshape(cells.torque, cells.ratio)[on], axis=0)[on]
        tick()
        slope = np.full(cells.ratio, np.inf)
        np.minimum.at(slope, column, self.slope / self.ratio if wheel else self.slope)
        low = np.arange(cells.torque) * cells.delta - EDGE
        torque = self.train.pinion_torques(low, low + cells.delta + 2.0 * EDGE, 0.0)[0]
        loaded = np.zeros_like(grid)
        np.multiply(torque[:, None], slope, out=loaded, where=np.isfinite(slope))
        return np.asarray(np.maximum(grid, loaded)), None

    def capacity(self, module: int) -> Array:
        """Return the largest torque [N mm] of each pair with a module (index); 0 where not allowed.

        Where it is bisected, it is inf above the largest torque of the drive.
        """
        allowed = (self.first <= module) & (module <= self.last)
        if self.load is None:
            return np.where(allowed, self._bisected_capacity(module), 0.0)
        with np.errstate(divide="ignore"):
            maximum = (self.modules[module] / self.need) ** (1.0 / self.exponent)
        return np.where(allowed, maximum * (1.0 + 3.0 * ALLOWANCE), 0.0)

    def floor(self, module: int) -> Array:
        """Return the minimum share of each pair with a module (index), whatever the torque."""
        every = np.arange(len(self.ratio))
        one = self.made(self.modules[module], every)
        return self._share(one, self.width_ends(one, module, every)[0])

    def width(self, torque: Array, pair: Index, module: int) -> Array:
        """Return the narrowest face width [mm] of pairs of a module (index); inf: none."""
        return self._width(torque, pair, module, self.made(self.modules[module], pair))

    def of(self, train: Train) -> "Table":
        """Return the table of the same pairs for a drive with another objective."""
        slope = closed(train, self.position, self.z1, self.ratio)[3]
        return replace(self, train=train, slope=slope)

    def carrying(self, torque: Array, pair: Index, module: int, option: int) -> Array:
        """Return the narrowest face width [mm] of pairs of a module (index) made in one way."""
        return self.width(torque, pair, module)

    @property
    def one_module(self) -> bool:
        """Whether the smallest module that carries is the best one, for every objective.

        None falls as it grows, for a tied width, and for a free one once it is at its minimum; but
        the mass of a gear with a web may.
        """
        return self.load is not None and self.steps is None and not self.train.hollow

    def _best(self, torque: Array, pair: Index) -> tuple[Array, Array, Array]:
        return (self.smallest if self.one_module else self._best_of_all)(torque, pair)

    def smallest(self, torque: Array, pair: Index) -> tuple[Array, Array, Array]:
        """Return cost (inf: none carries), module and face width [mm] of the smallest module."""
        assert self.load is not None
        needed = self.need[pair] * (torque * (1.0 - ALLOWANCE)) ** self.exponent
        k = np.maximum(np.searchsorted(self.modules, needed), self.first[pair])
        possible = k <= self.last[pair]
        k = np.minimum(k, len(self.modules) - 1)
        module = self.modules[k]
        one = self.made(module, pair)
        width, maximum = self.width_ends(one)
        if self.stage.face_width.fixed is None:
            width = np.clip(self.load[pair] * torque / module**2, width, maximum)
        value = self._share(one, width)
        return np.where(possible, value, np.inf), module, width

    def _best_of_all(self, torque: Array, pair: Index) -> tuple[Array, Array, Array]:
        """Try every module: by steps of widths, the law or a web a larger one can be better."""
        best, best_module, best_width = (np.full(len(pair), np.inf) for _ in range(3))
        for k, module in enumerate(self.modules):
            one = self.made(module, pair)
            width = self._width(torque, pair, k, one)
            value = np.where(np.isfinite(width), self._share(one, width), np.inf)
            better = value < best * (1.0 - ALLOWANCE)
            best = np.where(better, value, best)
            best_module = np.where(better, module, best_module)
            best_width = np.where(better, width, best_width)
        return best, best_module, best_width

    def _width(self, torque: Array, pair: Index, module: int, one: GearPair) -> Array:
        """Return the narrowest face width [mm] of the pairs `one`: `pair` with a module."""
        ends = self.width_ends(one, module, pair)
        if self.load is not None:
            needed = self.load[pair] * torque / self.modules[module] ** 2
        else:
            law, speed = self.train.law, self.train.speed_at(torque)
            needed = law.minimum_width(one, torque, speed, self.stage.allowable, ends)
        if self.steps is None:
            width, possible = np.clip(needed, *ends), needed <= ends[1] * (1.0 + ALLOWANCE)
        else:
            minimum, maximum = (count[module][pair] for count in self.steps)
            steps = np.maximum(np.ceil(needed / self.step * (1.0 - ALLOWANCE)), minimum)
            width, possible = steps * self.step, steps <= maximum
        possible = possible & (self.first[pair] <= module) & (module <= self.last[pair])
        return np.where(possible, width, np.inf)

    def width_ends(
        self, one: GearPair, module: int = 0, pair: Index | slice = slice(None)
    ) -> tuple[Array, Array]:
        """Return the minimum and maximum face width [mm] of the file; by module where on steps."""
        face, d = self.stage.face_width, one.pinion.reference_diameter
        if self.steps is not None:
            minimum, maximum = (count[module][pair] * self.step for count in self.steps)
            return minimum, maximum
        if face.fixed is not None:
            fixed = np.full_like(d, float(face.fixed))
            return fixed, fixed
        low, high = float(face.low) * d, face.widest * d
        if self.stage.overlap:
            low = np.maximum(low, self.stage.width_of_overlap(one))
        if face.plain:
            return low, high
        ends, m = face.over_module, one.normal_module
        low = np.maximum(low, np.maximum(float(ends[0] or 0) * m, float(face.least)))
        return low, high if ends[1] is None else np.minimum(high, float(ends[1]) * m)

    def _share(self, pair: GearPair, width: Any) -> Array:
        """Share of pairs of these face widths [mm] in the objective."""
        return np.asarray(objective_share(self.train, self.position, pair.of_width(width)))

    def _bisected_capacity(self, module: int) -> Array:
        """Return the largest torque [N mm] of every pair with a module (index), from above."""
        train, every = self.train, np.arange(len(self.ratio))
        one = self.made(self.modules[module], every)
        widest = one.of_width(self.width_ends(one, module, every)[1])

        def carries(torque: Array) -> Any:
            speed = train.speed_at(torque)
            return (
                train.law.largest_utilisation(widest, torque, speed, self.stage.allowable)
                <= 1.0 + ALLOWANCE
            )

        low, high = np.full((2, len(every)), np.array(train.torques)[:, None])
        with np.errstate(all="ignore"):  # of widths of zero, where no step is allowed
            some, all_ = carries(low), carries(high)
            for _ in range(HALVINGS):
                middle = np.sqrt(low * high)
                good = carries(middle)
                low, high = np.where(good, middle, low), np.where(good, high, middle)
        return np.where(some, np.where(all_, np.inf, high), 0.0)
