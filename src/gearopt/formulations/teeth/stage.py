"""The choices of one stage: tooth pairs sorted by ratio, the module and width each one needs.

Ties at whole numbers (ratio and diameter limits, widths on a step) are decided in rational
arithmetic. With a helix angle the diameter contains cos(beta), which for angles in degrees is
irrational except at 0, 60 and 90 (Niven's theorem), so no tie with a rational limit exists there.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.errors import SolveError
from gearopt.formulations.train import Stage, Train, share
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair
from gearopt.physics.loads import k_factor, unit_load

Index = NDArray[np.int64]

PAIRS = 3_000_000  # tooth pairs of one stage: about 1 GB of tables
ALLOWANCE = 1e-12  # a stress utilisation this little above 1 is rounding, not a violation


@dataclass(frozen=True)
class Table:
    """Tooth pairs (n,) of one stage with ratios up to a cut, increasing.

    need, exponent: the least module for torque T is need * T**exponent. first, last: indices of
    the modules that diameter and width limits allow. slope: least objective per torque, from the
    load limits alone. steps: least and most number of width steps, (modules, n), or None.
    """

    train: Train
    position: int
    z1: Index
    z2: Index
    ratio: Array
    log_ratio: Array
    modules: Array
    need: Array
    exponent: float
    first: Index
    last: Index
    slope: Array
    steps: tuple[Array, Array] | None

    @property
    def stage(self) -> Stage:
        """The stage's limits."""
        return self.train.stages[self.position]

    @property
    def step(self) -> float:
        """Step of the face width [mm]; nan where there is none."""
        step = self.stage.face_width.step
        return math.nan if step is None else float(step)

    def made(self, module: Any, pair: Any) -> GearPair:
        """Return the gear pairs (indices) with modules [mm], of face width 1 mm."""
        return self.train.pair(module, self.z1[pair], self.z2[pair], 1.0)

    def cost(self, torque: Array, pair: Index) -> Array:
        """Least objective share of pairs at torques [N mm]; inf where nothing carries them."""
        return self._best(torque, pair)[0]

    def choose(self, torque: float, pair: int) -> tuple[float, float]:
        """Module and face width [mm] behind `cost`."""
        _, module, width = self._best(np.array([torque]), np.array([pair]))
        return module.item(), width.item()

    def capacity(self, module: int) -> Array:
        """Largest torque [N mm] each pair carries with a module (index); 0 where not allowed."""
        allowed = (self.first <= module) & (module <= self.last)
        with np.errstate(divide="ignore"):
            most = (self.modules[module] / self.need) ** (1.0 / self.exponent)
        return np.where(allowed, most * (1.0 + 3.0 * ALLOWANCE), 0.0)

    def floor(self, module: int) -> Array:
        """Least objective share of each pair with a module (index), whatever the torque."""
        one = self.made(self.modules[module], np.arange(len(self.ratio)))
        width = self._least_width(one) if self.steps is None else self.steps[0][module] * self.step
        return self._share(one, width)

    def _best(self, torque: Array, pair: Index) -> tuple[Array, Array, Array]:
        if self.steps is not None:
            return self._best_on_steps(*self.steps, torque, pair)
        # The smallest module that carries the torque is the best one: every objective grows
        # with it, for a tied width, and for a free one once the width has its least value.
        needed = self.need[pair] * (torque * (1.0 - ALLOWANCE)) ** self.exponent
        k = np.maximum(np.searchsorted(self.modules, needed), self.first[pair])
        possible = k <= self.last[pair]
        k = np.minimum(k, len(self.modules) - 1)
        module = self.modules[k]
        one = self.made(module, pair)
        width, face = self._least_width(one), self.stage.face_width
        if face.fixed is None:
            widest = face.widest * one.pinion.reference_diameter
            width = np.clip(self._loaded_width(torque, one), width, widest)
        value = self._share(one, width)
        return np.where(possible, value, np.inf), module, width

    def _best_on_steps(
        self, least: Array, most: Array, torque: Array, pair: Index
    ) -> tuple[Array, Array, Array]:
        """Rounding a width up to the step can make a larger module the better one: try all."""
        best, best_module, best_width = (np.full(len(pair), np.inf) for _ in range(3))
        for k, module in enumerate(self.modules):
            one = self.made(module, pair)
            needed = self._loaded_width(torque, one) / self.step
            count = np.maximum(np.ceil(needed * (1.0 - ALLOWANCE)), least[k][pair])
            possible = (self.first[pair] <= k) & (k <= self.last[pair]) & (count <= most[k][pair])
            width = count * self.step
            value = np.where(possible, self._share(one, width), np.inf)
            better = value < best * (1.0 - ALLOWANCE)
            best = np.where(better, value, best)
            best_module = np.where(better, module, best_module)
            best_width = np.where(better, width, best_width)
        return best, best_module, best_width

    def _share(self, pair: GearPair, width: Any) -> Array:
        """Return what pairs of these face widths [mm] add to the objective."""
        return np.asarray(share(self.train, self.position, pair.of_width(width)))

    def _loaded_width(self, torque: Array, pair: GearPair) -> Array:
        """Least face width [mm] for K-factor and unit load."""
        d, m = pair.pinion.reference_diameter, pair.normal_module
        by_contact = k_factor(torque, d, 1.0, pair.ratio) / self.stage.k_factor
        by_bending = unit_load(torque, d, 1.0, m) / self.stage.unit_load
        return np.asarray(np.maximum(by_contact, by_bending))

    def _least_width(self, pair: GearPair) -> Array:
        """Least face width [mm] the file allows for pairs, but for steps."""
        face, d = self.stage.face_width, pair.pinion.reference_diameter
        return float(face.low) * d if face.fixed is None else np.full_like(d, float(face.fixed))


def table(
    train: Train, position: int, cut: Fraction, tick: Callable[[], None] = lambda: None
) -> Table:
    """The table of a stage (counted from 0) for ratios up to `cut`.

    tick: called several times a second; what it raises ends the work.
    """
    tick()
    stage = train.stages[position]
    cosine = math.cos(train.helix_angle)
    z1, z2 = _pairs(train, position, cut)
    tick()
    ratio = z2 / z1
    face, modules = stage.face_width, stage.modules
    widest = face.widest if face.fixed is None else float(face.fixed)
    exponent = 0.5 if face.fixed is not None else 1.0 / 3.0
    # With b = widest (fixed) or widest*d, at unit torque: K-factor and unit load against module.
    contact = k_factor(1.0, 1.0, widest, ratio) / stage.k_factor
    bending = unit_load(1.0, 1.0, widest, 1.0) / stage.unit_load
    power = 1.0 if face.fixed is not None else 2.0
    need = np.maximum(
        contact**exponent * cosine / z1, (bending * (cosine / z1) ** power) ** exponent
    )
    load = np.maximum(
        k_factor(1.0, 1.0, 1.0, ratio) / stage.k_factor,
        unit_load(1.0, 1.0, 1.0, 1.0) / stage.unit_load * z1 / cosine,
    )
    slope = np.zeros_like(ratio)
    if train.objective in ("gear_volume", "mass"):  # no module counts: d1 is 1 mm here
        slope = np.asarray(share(train, position, GearPair.of_teeth(1.0, 1.0, ratio, load)))
    tick()
    first, last = _allowed(stage, z1, z2, cosine)
    return Table(
        train,
        position,
        z1,
        z2,
        ratio,
        np.log(ratio),
        np.array([float(m) for m in modules]),
        need,
        exponent,
        first,
        last,
        slope,
        _steps(stage, z1, cosine),
    )


def _pairs(train: Train, position: int, cut: Fraction) -> tuple[Index, Index]:
    """All (z1, z2) of a stage with ratios up to cut, by ratio, then by teeth.

    SolveError where they are more than memory is worth.
    """
    ranges = spans(train, position, cut)
    count = sum(stop - start + 1 for _, start, stop in ranges)
    if count > PAIRS:
        raise SolveError(
            f"a stage has {count:,} tooth pairs to choose from: narrow its pinion teeth, or limit "
            "its wheel teeth or ratio (limits.pinion_teeth, limits.wheel_teeth, limits.stage_ratio)"
        )
    wheels = [np.arange(start, stop + 1, dtype=np.int64) for _, start, stop in ranges]
    z1 = np.repeat([z for z, _, _ in ranges], [len(w) for w in wheels]).astype(np.int64)
    z2 = np.concatenate(wheels)
    if train.coprime:
        keep = np.gcd(z1, z2) == 1
        z1, z2 = z1[keep], z2[keep]
    order = np.argsort(z2 / z1, kind="stable")
    return z1[order], z2[order]


def spans(train: Train, position: int, cut: Fraction) -> list[tuple[int, int, int]]:
    """Of every pinion z1 of a stage its least and most wheel teeth for ratios up to cut.

    The most is one below the least where there are none.
    """
    stage = train.stages[position]
    low = max(stage.ratio[0], train.lowest_ratio) if len(train.stages) == 1 else stage.ratio[0]
    high = cut if stage.ratio[1] is None else min(cut, stage.ratio[1])
    most_wheel = stage.wheel_teeth[1]
    least_z1, most_z1 = stage.pinion_teeth
    assert most_z1 is not None
    found = []
    for z in range(least_z1, most_z1 + 1):
        start = max(stage.wheel_teeth[0], math.ceil(low * z))
        stop = math.floor(high * z)
        stop = stop if most_wheel is None else min(stop, most_wheel)
        found.append((z, start, max(stop, start - 1)))
    return found


def _allowed(stage: Stage, z1: Index, z2: Index, cosine: float) -> tuple[Index, Index]:
    """First and last module index that wheel diameter and fixed-width proportions allow."""
    first = np.zeros(len(z1), dtype=np.int64)
    last = np.full(len(z1), len(stage.modules) - 1, dtype=np.int64)
    exact_cosine = Fraction(cosine)

    def most_teeth(length: Fraction) -> Index:
        """Most teeth of a wheel of that diameter, for every module (decreasing)."""
        return np.array([math.floor(length * exact_cosine / m) for m in stage.modules])

    if stage.wheel_diameter is not None:
        most = most_teeth(stage.wheel_diameter)
        last = np.minimum(last, (most[:, None] >= z2).sum(axis=0) - 1)
    face = stage.face_width
    if face.fixed is not None and face.low > 0:
        last = np.minimum(last, (most_teeth(face.fixed / face.low)[:, None] >= z1).sum(axis=0) - 1)
    if face.fixed is not None and face.high is not None:
        length = face.fixed / face.high
        least = np.array([math.ceil(length * exact_cosine / m) for m in stage.modules])
        first = (least[:, None] > z1).sum(axis=0)
    return first, last


def _steps(stage: Stage, z1: Index, cosine: float) -> tuple[Array, Array] | None:
    """Least and most number of width steps for every module and pair."""
    face = stage.face_width
    if face.step is None:
        return None
    assert face.high is not None
    exact_cosine = Fraction(cosine)
    teeth = np.unique(z1)
    place = np.searchsorted(teeth, z1)
    least = np.empty((len(stage.modules), len(teeth)))
    most = np.empty_like(least)
    for k, module in enumerate(stage.modules):
        for i, z in enumerate(teeth):
            diameter = module * int(z) / exact_cosine
            least[k, i] = max(1, math.ceil(face.low * diameter / face.step))
            most[k, i] = math.floor(face.high * diameter / face.step)
    return least[:, place], most[:, place]
