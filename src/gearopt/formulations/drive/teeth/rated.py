"""The choices of a stage whose limits are ratings: tooth pairs, modules, ways of making them.

Rows are (pair, module, option); each needs the first face width that carries. Every module is
tried, as a larger one may be the better one where the load-distribution factor falls.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import field, replace
from functools import cached_property, partial
from itertools import chain
from typing import Any

import numpy as np

from gearopt.formulations.drive.shares import least_share, objective_share
from gearopt.formulations.drive.teeth.columns import Index
from gearopt.formulations.drive.teeth.prepared import Part, Prepared
from gearopt.formulations.drive.teeth.stage import EDGE, Cells, Grid, Table
from gearopt.formulations.drive.train import Train
from gearopt.formulations.strength import ALLOWANCE
from gearopt.formulations.strength.standard import IndexRows, Option, Rows, Standard
from gearopt.formulations.strength.widths import MAX_STEPS, Standing
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair

VIRTUAL_CLOSE = 1e-3  # of what a virtual option uses above 1, which has to be a bound alone
FIRST_STEPS = 4  # steps towards a width, for a first lower bound
BOUNDED_AGAIN = 1.01  # times the least of these: what is bounded again
TOGETHER = 2000  # pairs bounded again at once, at least
ROUGH = 0.01  # of what is used above 1, where a bound is only to compare
AT_ONCE = 32_000  # rows of several modules that are tried at once
BATCH = 20_000  # pairs bounded at once
MAX_KEPT = 20_000_000  # first modules of cells and pairs that are kept, 40 MB
CELL_TOLERANCE = 0.02  # of what is used above 1, for that, over the width of a cell
VIRTUAL = -1  # the option that is best in everything
WHEEL = 9.0  # volume of a wheel over that of its pinion, more or less
FINEST = 0.005  # width of a cell where none is given


def _numbered_rows(rows: Index, first: Index, last: Index, count: int) -> tuple[Index, Index]:
    """Each of some rows with so many numbers from its first one on, at most to its last one."""
    numbers = first[:, None] + np.arange(count)
    there = numbers <= last[:, None]
    return np.broadcast_to(rows[:, None], numbers.shape)[there], numbers[there]


@dataclass(frozen=True)
class Found:
    """The least cost of rows (n,), and of one option the index of the first module that carries."""

    cost: Array
    first: Index


@dataclass(frozen=True)
class RatedTable(Table):
    """Tooth pairs (n,) of a stage with options.

    others: tables that may have these pairs, too. tick: the seconds left, called between options
    and modules, about a hundred times a second; what it raises ends the work.
    """

    others: tuple["RatedTable", ...] = ()
    tick: Callable[[], float] = field(default=lambda: math.inf, compare=False, repr=False)

    def made(self, module: Any, pair: Any) -> GearPair:
        """Return the gear pairs (indices) with modules [mm] of the series, of face width 1 mm.

        Shifts are NaN of modules that are not allowed.
        """
        if self.stage.toothing.shifting is None:
            return super().made(module, pair)
        if not self._by_module:
            first, second, shorter = (s[pair] for s in self._shifts)
            toothing = self.stage.toothing_of(self.toothing[pair])
            return toothing.pair(
                module, self.z1[pair], self.z2[pair], 1.0, (first, second, shorter)
            )
        index = np.searchsorted(self.modules, module)
        allowed = (self.first[pair] <= index) & (index <= self.last[pair])
        place = self._shape(index, pair)
        first, second, shorter = (np.where(allowed, s[place], np.nan) for s in self._shifts)
        z1, z2 = self.z1[pair], self.z2[pair]
        toothing = self.stage.toothing_of(self.toothing[pair])
        return toothing.pair(module, z1, z2, 1.0, (first, second, shorter))

    @cached_property
    def _shifts(self) -> tuple[Any, Any, Any]:
        """Profile shifts and shortening of pairs and modules of `_shapes`, or of pairs alone."""
        if not self._by_module:
            toothing = self.stage.toothing_of(self.toothing)
            return toothing.shifts(np.ones(len(self.z1)), self.z1, self.z2)
        module, pair = self._shapes
        toothing = self.stage.toothing_of(self.toothing[pair])
        return toothing.shifts(self.modules[module], self.z1[pair], self.z2[pair])

    @cached_property
    def _prepared(self) -> list[list[Prepared | Part]]:
        """Data that standards take, by option and standard: of pairs, by module those allowed."""
        prepared: list[list[Prepared | Part]] = []
        known: list[tuple[Standard, Prepared | Part]] = []
        for option in self.stage.options:
            prepared.append([])
            for standard in option.standards:
                others = (p for table in self.others for p in table.known(self, standard))
                before = (p for s, p in known if s.like(standard))
                data = next(chain(before, others), None)
                if data is None:
                    count = len(self._shapes[0]) if self._by_module else len(self.z1)
                    data = Prepared(count, partial(self._made_ready, standard))
                prepared[-1].append(data)
                known.append((standard, data))
        return prepared

    def _made_ready(self, standard: Standard, shapes: Index) -> Any:
        """Data that a standard takes of some shapes: pairs, by module those allowed."""
        module, pair = np.ones(len(shapes)), shapes
        if self._by_module:
            module, pair = self.modules[self._shapes[0][shapes]], self._shapes[1][shapes]
        return standard.prepared(self.made(module, pair))

    def known(self, other: "RatedTable", standard: Standard) -> Iterator[Prepared | Part]:
        """Data that a like standard took of another table's pairs, where this one has them all."""
        place = self._place(other)
        if place is None:
            return
        count = len(self.ratio)
        if self._by_module:
            module, row = other._shapes
            place, count = self._shape(module, place[row]), len(self._shapes[0])
        for option, made in zip(self.stage.options, self._prepared, strict=True):
            for one, own in zip(option.standards, made, strict=True):
                if one.like(standard):
                    yield own if len(place) == count else own.part(place)

    @cached_property
    def _counts(self) -> Index:
        """Number of modules that every pair may have, at least one."""
        return np.asarray(np.maximum(self.last - self.first + 1, 1))

    @cached_property
    def _shapes(self) -> tuple[Index, Index]:
        """Modules (indices) and pairs whose teeth are prepared where each module has its own."""
        pair = np.repeat(np.arange(len(self.z1)), self._counts)
        module = self.first[pair] + np.arange(len(pair)) - self._begins[pair]
        return np.minimum(module, len(self.modules) - 1), pair

    @cached_property
    def _begins(self) -> Index:
        """Places of the first modules of pairs in `_shapes`."""
        return np.asarray(np.cumsum(self._counts) - self._counts)

    def _shape(self, module: Index, pair: Index) -> Index:
        """Return the places of allowed modules of pairs in `_shapes`; of others, any."""
        number = np.clip(module - self.first[pair], 0, self._counts[pair] - 1)
        return np.asarray(self._begins[pair] + number)

    def covers(self, other: Table) -> bool:
        """Return whether this table has all pairs of another one, of the same toothing."""
        return isinstance(other, RatedTable) and self._place(other) is not None

    def _place(self, other: Table) -> Index | None:
        """Return where the pairs of another table are in this one; None where one is not."""
        alike = not self._by_module or np.array_equal(self.modules, other.modules)
        toothings, ways = self.stage.toothings, len(self.stage.toothings)
        if not alike or len(other.ratio) > len(self.ratio):
            return None
        same = np.arange(ways)
        if other.stage.toothings != toothings:
            rows = {toothing: row for row, toothing in enumerate(toothings)}
            if not rows.keys() >= {*other.stage.toothings}:
                return None
            same = np.array([rows[toothing] for toothing in other.stage.toothings])
        own, asked = self.names * ways + self.toothing, other.names * ways + same[other.toothing]
        order = np.argsort(own, kind="stable")
        place: Index = order[np.searchsorted(own, asked, sorter=order) % max(1, len(own))]
        there = np.array_equal(own[place], asked)
        if there and self._by_module:
            low, high = self.first[place] <= other.first, other.last <= self.last[place]
            there = bool(np.all(low & high))
        return place if there else None

    @property
    def _by_module(self) -> bool:
        """Whether teeth of different modules have different shapes."""
        own = self.stage.toothing
        return own.working_distance is not None or any(own.thickness_allowances)

    @property
    def one_module(self) -> bool:
        """Whether the smallest module that carries is the best one: not where ratings limit."""
        return False

    @property
    def monotone(self) -> bool:
        """Whether at one power a stronger torque never takes less."""
        return all(s.monotone for o in self.stage.options for s in o.standards)

    def cost(self, torque: Array, pair: Index, most: Array | float = np.inf) -> Array:
        """Return the minimum share of pairs at torques [N mm]; inf where nothing carries them.

        most: values above which any is as good as inf.
        """
        return self._found((torque, torque), pair, most).cost

    def choose(self, torque: float, pair: int) -> tuple[float, float, int]:
        """Return the module, the face width [mm] and the option behind `cost`."""
        module = np.arange(self.first[pair], self.last[pair] + 1)
        own, at = np.full(len(module), pair), np.full(len(module), torque)
        one = self.made(self.modules[module], own)
        ends, best = self._ends(one, module, own), (math.inf, math.inf, math.inf, 0)
        for option in range(len(self.stage.options)):
            widths = self._narrowest((at, at), own, module, option, ends)
            costs = np.where(np.isfinite(widths), self._worth(one, widths, option), np.inf)
            for k in np.flatnonzero(np.isfinite(costs)):
                if costs[k] < best[0] * (1.0 - ALLOWANCE):
                    best = costs[k].item(), self.modules[module[k]].item(), widths[k].item(), option
        return best[1:]

    def rough_cost(self, torque: Array, pair: Index, most: Array | float = np.inf) -> Array:
        """Return a rough lower bound of `cost`; most: as there."""
        return self._found((torque, torque), pair, most, close=ROUGH, steps=2 * FIRST_STEPS).cost

    def least_cost(
        self,
        torque: tuple[Array, Array],
        pair: Index,
        group: Index,
        delta: float,
        most: Array | float = np.inf,
    ) -> Array:
        """Return lower bounds of `cost` at torques [N mm] between two ends.

        Only the least of every group (n,) of pairs is close, as cells of delta need it. most: costs
        above which any is as good as inf.
        """
        cost = self._found(torque, pair, most, steps=FIRST_STEPS).cost
        return self._closer(torque, pair, group, cost, CELL_TOLERANCE * delta, most)

    def useful_ratio(self, least: float, most: float) -> float:
        """Return the largest ratio whose share of a train is at most so much; at least `least`.

        Any stage carries at least the least torque.
        """
        pair = np.flatnonzero(self.ratio > least)
        ends = np.full((2, len(pair)), np.array(self.train.torques)[:, None])
        cost = self._found((ends[0], ends[1]), pair, most, steps=FIRST_STEPS).cost
        near = np.flatnonzero(cost <= most)
        cost = self._found(
            (ends[0, near], ends[1, near]), pair[near], most, close=CELL_TOLERANCE * FINEST
        ).cost
        return float(self.ratio[pair[near]][cost <= most].max(initial=least))

    def _closer(
        self,
        torque: tuple[Array, Array],
        pair: Index,
        group: Index,
        cost: Array,
        close: float,
        most: Array | float,
    ) -> Array:
        """Raise lower bounds of cost (n,) in place until the least of every group is close.

        torque: both ends [N mm]. group (n,): the group of each pair. most: costs above which any is
        as good as inf.
        """
        rough, most = np.isfinite(cost), np.broadcast_to(most, len(cost))
        while rough.any():
            least = np.full(group.max(initial=-1) + 1, np.inf)
            np.minimum.at(least, group, cost)
            above = np.divide(cost, least[group], np.full_like(cost, np.inf), where=rough)
            if above.min() > BOUNDED_AGAIN:
                break
            few = min(TOGETHER, len(above)) - 1
            near = np.flatnonzero(
                rough & (above <= max(BOUNDED_AGAIN, np.partition(above, few)[few]))
            )
            ends = torque[0][near], torque[1][near]
            cost[near] = np.maximum(
                cost[near], self._found(ends, pair[near], most[near], close=close).cost
            )
            rough[near] = False
            if np.all(np.isinf(most)):  # without a train it counts alone which groups have a pair
                rough &= ~np.isin(group, group[~rough & np.isfinite(cost)])
        return cost

    def grid(self, cells: Cells, tick: Callable[[], float]) -> Grid:
        """Minimum cost (torque cells, ratio cells), and first modules of use (torque cells, pairs).

        A lower bound: the least over the torques of a cell, of its pairs the best.
        """
        found = np.full((cells.torque, cells.ratio), np.inf)
        delta, most = cells.delta, cells.most
        column = (self.log_ratio / delta).astype(np.int64)
        highest = math.log(self.train.highest_ratio)
        keeps = len(self.stage.options) == 1 and cells.torque * len(self.ratio) <= MAX_KEPT
        first = np.zeros((cells.torque if keeps else 1, len(self.ratio)), np.int16)
        if keeps and cells.first is not None:
            first[:] = cells.first[np.arange(cells.torque) // 2]
        for rows in cells.batches(len(self.ratio), BATCH):
            tick()
            inside = self.log_ratio <= highest - rows[:, None] * delta + EDGE
            if cells.useful is not None:
                inside &= cells.useful[rows[:, None], column]
            row, pair = np.nonzero(inside)
            low, kept = rows[row] * delta, (rows[row] * keeps, pair)
            ends = self.train.pinion_torques(low - EDGE, low + delta + EDGE, self.log_ratio[pair])
            place = row * cells.ratio + column[pair]
            begins = first[kept].astype(np.int64)
            rough = self._found(ends, pair, most, begins, steps=FIRST_STEPS)
            if keeps:  # with options one in a larger module may hide another one in this cell
                first[kept] = rough.first
            cost = self._closer(ends, pair, place, rough.cost, CELL_TOLERANCE * delta, most)
            np.minimum.at(found, (rows[row], column[pair]), cost)
        return found, first if keeps else None

    def width(self, torque: Array, pair: Index, module: int) -> Array:
        """Return the minimum face width [mm] of pairs of a module (index) at torques; inf: none."""
        every = np.full(len(pair), module)
        possible = (self.first[pair] <= module) & (module <= self.last[pair])
        found = self.least_width((torque, torque), pair, every, ALLOWANCE)
        return np.where(possible, found, np.inf)

    def least_width(
        self, torque: tuple[Array, Array], pair: Index, module: Index, close: float
    ) -> Array:
        """Return lower bounds of the minimum face widths [mm] at torques between two ends.

        module: indices; close: as of `first_width`, with ALLOWANCE and one torque they are exact.
        """
        ends = self._ends(self.made(self.modules[module], pair), module, pair)
        options = range(len(self.stage.options))
        widths = [self._narrowest(torque, pair, module, o, ends, close) for o in options]
        return np.asarray(np.minimum.reduce(widths))

    def narrowest(self, module: int) -> Array:
        """Return the narrowest face width [mm] (n,) that a module (index) allows; inf: none."""
        every, at = np.arange(len(self.ratio)), np.full(len(self.ratio), module)
        ends = self._ends(self.made(self.modules[module], every), at, every)
        allowed = (self.first <= module) & (module <= self.last) & (ends[0] <= ends[1])
        return np.where(allowed, ends[0], np.inf)

    def of(self, train: Train) -> "RatedTable":
        """Return the table of the same pairs for a drive with another objective."""
        made = super().of(train)
        assert isinstance(made, RatedTable)
        return replace(made, others=(*self.others, self))

    def carrying(self, torque: Array, pair: Index, module: int, option: int) -> Array:
        """Return the minimum face width [mm] of pairs of a module (index) made in one way."""
        at = np.full(len(pair), module)
        ends = self._ends(self.made(self.modules[module], pair), at, pair)
        return self._narrowest((torque, torque), pair, at, option, ends)

    def _found(
        self,
        torque: tuple[Array, Array],
        pair: Index,
        most: Array | float = np.inf,
        first: Index | int = 0,
        close: float = ALLOWANCE,
        steps: int = MAX_STEPS,
    ) -> Found:
        """Return the best choices at torques between two ends.

        most: costs above which none counts; first: index of the module to begin with; close,
        steps: as of `first_width`, for lower bounds.
        """
        best = Found(np.full(len(pair), np.inf), np.full(len(pair), len(self.modules)))
        most = np.broadcast_to(most, len(pair))
        at = np.maximum(self.first[pair], first)
        left = np.arange(len(pair))
        while True:
            self.tick()
            left = left[at[left] <= self.last[pair[left]]]
            if not len(left):
                return best
            several = max(1, AT_ONCE // len(left))
            rows, module = _numbered_rows(left, at[left], self.last[pair[left]], several)
            one = self.made(self.modules[module], pair[rows])
            ends = self._ends(one, module, pair[rows])
            limit = np.minimum(most[rows], best.cost[rows])
            larger = self._floor(one, ends[0]) <= limit
            worth = self._worth(one, ends[0], VIRTUAL)
            some = np.flatnonzero((worth <= limit) & np.isfinite(worth))
            if len(some):
                tried = rows[some], pair[rows[some]], module[some]
                ends = ends[0][some], ends[1][some]
                self._try(best, torque, tried, ends, most, (close, steps))
            goes = np.isinf(best.cost) | (not self.train.any_will_do)
            goes[rows[~larger]] = False
            left = left[goes[left]]
            at[left] += several

    def _try(
        self,
        best: Found,
        torque: tuple[Array, Array],
        tried: tuple[Index, Index, Index],
        ends: tuple[Array, Array],
        most: Array,
        until: tuple[float, int],
    ) -> None:
        """Put the least costs of rows, pairs and modules with every option in the best so far.

        No option has a narrower face than the virtual one.
        """
        rows, pair, module = tried
        one = self.made(self.modules[module], pair)
        narrow = ends[0]
        if self._by_module:  # few modules a pair, so that these are met at many torques
            least = self._nominal(module, pair, ends) * torque[0][rows] * (1.0 - EDGE)
            narrow = np.where(least <= ends[1], np.maximum(narrow, least), np.inf)
        bounded = until[1] == MAX_STEPS and self._virtual_option is not None
        for option in (VIRTUAL, *self._by_price) if bounded else self._by_price:
            self.tick()
            limit = np.minimum(most[rows], best.cost[rows])
            with np.errstate(invalid="ignore"):  # of no width
                worth = self._worth(one, narrow, option)
            some = np.flatnonzero(np.isfinite(narrow) & (worth <= limit) & (worth < np.inf))
            if not len(some):
                continue
            low, high = narrow[some], ends[1][some]
            if self.train.by_width:
                high = np.minimum(high, low * (limit[some] / worth[some]) * (1.0 + EDGE))
            loads = torque[0][rows[some]], torque[1][rows[some]]
            sizes = pair[some], module[some]
            enough = (max(until[0], VIRTUAL_CLOSE), until[1]) if option == VIRTUAL else until
            widths = self._narrowest(loads, *sizes, option, (low, high), *enough)
            if option == VIRTUAL:
                narrow = np.full(len(rows), np.inf)
                narrow[some] = widths
            else:
                self._improve(best, rows[some], *sizes, option, widths)

    def _nominal(self, module: Index, pair: Index, ends: tuple[Array, Array]) -> Array:
        """Least face widths over the torque [mm/(N mm)] of pairs with modules (indices)."""
        shape, known = self._shape(module, pair), self._nominal_widths
        _, new = np.unique(np.where(np.isnan(known[shape]), shape, -1), return_index=True)
        new = new[np.isnan(known[shape[new]])]
        if len(new):
            options = [VIRTUAL] if self._virtual_option else range(len(self.stage.options))
            sizes, widths = (module[new], pair[new]), (ends[0][new], ends[1][new])
            least = [self._nominal_of(option, *sizes, widths) for option in options]
            known[shape[new]] = np.minimum.reduce(least)
        return known[shape]

    @cached_property
    def _nominal_widths(self) -> Array:
        """What `_nominal` has by `_shapes`; NaN: not yet."""
        return np.full(int(self._counts.sum()), np.nan)

    def _nominal_of(
        self, option: int, module: Index, pair: Index, widths: tuple[Array, Array]
    ) -> Array:
        """`_nominal` of one option, for every torque of the train."""
        low, high = np.full((2, len(pair)), np.array(self.train.torques)[:, None])
        ends = low, high
        speed = tuple(self.train.speed_at(end) for end in ends)
        safety = self.train.safety_of(self.stage)
        gears = self.made(self.modules[module], pair)
        least = [
            standard.nominal(
                self._prepared_data(ready, module, pair), gears, ends, speed, safety, widths
            )
            for standard, ready in self._standards(option)
        ]
        return np.asarray(np.maximum.reduce(least))

    def _standards(self, option: int) -> Iterator[tuple[Standard, Any]]:
        """Standards of an option, and what each has prepared of all pairs."""
        chosen = self._virtual_option if option == VIRTUAL else self.stage.options[option]
        assert chosen is not None
        return zip(chosen.standards, self._prepared[max(option, 0)], strict=True)

    def _prepared_data(self, prepared: Any, module: Index, pair: Index) -> Any:
        """What a standard has prepared of pairs with modules (indices)."""
        if self._by_module:
            return prepared.take(self._shape(module, pair), self.tick)
        return prepared.take(pair, self.tick).scaled(self.modules[module])

    @cached_property
    def _virtual_option(self) -> Option | None:
        """A virtual option that uses no more than any option; None: there is none, or no choice."""
        first, *rest = self.stage.options
        return first.strongest_with(rest) if rest else None

    @cached_property
    def _cheapest(self) -> Train:
        """The drive with a virtual option of the stage that costs no more than any."""
        first, *rest = self.stage.options
        cheap = replace(self.stage, options=(first.cheapest_with(rest, self.train.density),))
        before, after = self.train.stages[: self.position], self.train.stages[self.position + 1 :]
        stages = [*before, cheap, *after]
        return replace(self.train, stages=tuple(stages), same_option=False)

    @cached_property
    def _by_price(self) -> list[int]:
        """Options, cheap ones first."""
        rows = [zip(o.densities, o.prices, strict=True) for o in self.stage.options]
        costs = [[(rho or 1.0) * price for rho, price in row] for row in rows]
        return sorted(range(len(costs)), key=lambda k: costs[k][0] + WHEEL * costs[k][1])

    def _worth(self, pair: GearPair, width: Array, option: int) -> Array:
        """Share of pairs of these face widths [mm] in the objective."""
        train, option = (self._cheapest, 0) if option == VIRTUAL else (self.train, option)
        shares = objective_share(train, self.position, pair.of_width(width), option=option)
        return np.asarray(shares)

    def _floor(self, pair: GearPair, width: Array) -> Array:
        """Return a lower bound of `_worth` that larger modules and options do not fall below."""
        shifted = self.stage.toothing.shifting is not None
        shifted = shifted and (self._by_module or self.train.hollow)
        if shifted or (
            self.stage.planetary and not self.stage.one_shape
        ):  # a larger one may be the lighter
            return np.zeros(np.shape(width))
        fewest = pair.pinion_teeth, pair.wheel_teeth
        shares = least_share(self._cheapest, self.position, pair.of_width(width), fewest=fewest)
        return np.asarray(shares)

    def _improve(
        self, best: Found, rows: Index, pair: Index, module: Index, option: int, width: Array
    ) -> None:
        """Put pairs that carry and cost less in the place of the best so far."""
        some = np.isfinite(width)
        rows, pair, module, width = rows[some], pair[some], module[some], width[some]
        np.minimum.at(best.first, rows, module)
        cost = self._worth(self.made(self.modules[module], pair), width, option)
        np.minimum.at(best.cost, rows, cost)

    def _ends(self, one: GearPair, module: Index, pair: Index) -> tuple[Array, Array]:
        """Return the minimum and maximum face width [mm] of pairs with modules (indices)."""
        if self.steps is None:
            return self.width_ends(one)
        low, high = (count[module, pair] * self.step for count in self.steps)
        return low, high

    def _narrowest(
        self,
        torque: tuple[Array, Array],
        pair: Index,
        module: Index,
        option: int,
        ends: tuple[Array, Array],
        close: float = ALLOWANCE,
        steps: int = MAX_STEPS,
    ) -> Array:
        """Return the narrowest face widths [mm] of pairs with modules (indices); inf: none."""
        one = self.made(self.modules[module], pair)
        rows = self._rows(torque, one, pair, module, option)
        low = self.stage.least_width(one, torque[0], ends[0])
        widths = rows.first_width(np.arange(len(pair)), low, ends[1], close, steps)
        if self.steps is None:
            return widths
        return self._stepped(rows, widths, ends[1], close)

    def _rows(
        self,
        torque: tuple[Array, Array],
        one: GearPair,
        pair: Index,
        module: Index,
        option: int,
    ) -> Standing:
        def maker(standard: Standard, prepared: Any) -> Callable[[Index], Rows]:
            def rows(place: Index) -> Rows:
                every = len(place) == len(pair)
                gears = one if every else self.made(self.modules[module[place]], pair[place])
                ends = torque[0][place], torque[1][place]
                speed = self.train.speed_at(ends[0]), self.train.speed_at(ends[1])
                teeth = self._prepared_data(prepared, module[place], pair[place])
                return standard.rows(teeth, gears, ends, speed, self.train.safety_of(self.stage))

            return rows

        makers = [maker(standard, prepared) for standard, prepared in self._standards(option)]
        if self.train.law.limits:
            assert self.load is not None
            needed = self.load[pair] * torque[0] / self.modules[module] ** 2
            makers.append(lambda place: IndexRows(needed[place]))
        return Standing(makers, self.tick)

    def _stepped(self, rows: Standing, width: Array, high: Array, close: float) -> Array:
        """Return the first widths on the step from those on that carry; close: as `first_width`."""
        step, found = self.step, np.full(len(width), np.inf)
        active = np.flatnonzero(np.isfinite(width))
        while len(active):
            on = np.ceil(width[active] / step * (1.0 - ALLOWANCE)) * step
            inside = on <= high[active] * (1.0 + ALLOWANCE)
            active, on = active[inside], on[inside]
            carries = np.isfinite(rows.first_width(active, on, on, close))
            found[active[carries]] = on[carries]
            active, on = active[~carries], on[~carries]
            width[active] = rows.first_width(active, on + step, high[active], close)
            active = active[np.isfinite(width[active])]
        return found
