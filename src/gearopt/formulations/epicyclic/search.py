"""Every train of a request, by falling promise: the best of them, and a bound on the way.

The gears that are chosen first make a first part; those that complete it have few degrees of
freedom, since centre distances are equal. Of every first part a bound is computed; parts are
completed in its order, in chunks of bounded size, until no part that is left can hold a better
train. Lemma 89 of docs/proofs.md.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.epicyclic.request import (
    COUPLED,
    ERROR,
    FIRST,
    LOSS,
    RING,
    SIMPLE,
    STEPPED,
    TOLERANCE,
    Request,
)
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.physics.planetary import willis
from gearopt.physics.planetary.assembly import SAME

CHUNK = 20_000  # trains that are looked at together: some 10 MB
DOUBT = 1e-12  # of an error or a loss in doubles, beyond which fractions are not asked
WITHIN = 1e-11  # of a utilisation in doubles
IntArray = np.ndarray[Any, np.dtype[np.int64]]
Key = tuple[Any, int, tuple[int, ...]]


@dataclass(frozen=True)
class Best:
    """The best train: objective, all teeth and teeth, exactly; None: there is none.

    bound: of the objective of all trains; looked: how many were; done: whether none is left.
    """

    key: Key | None
    bound: Any
    looked: int
    done: bool


def best(request: Request, clock: Clock) -> Best:
    """The train of least objective; ties go to the fewest teeth, then to the smallest numbers."""
    firsts, floors, fewest = _firsts(request)
    seconds = _seconds(request)
    size = max(1, CHUNK // max(1, len(seconds)))
    order = np.lexsort((fewest, floors))
    key: Key | None = None
    for start in range(0, len(order), size):
        some = order[start : start + size]
        bound = float(floors[some[0]])
        if key is not None and (bound, int(fewest[some[0]])) > key[:2]:
            return Best(key, key[0], clock.evaluations, True)
        clock.bound = max(clock.bound, bound)
        if not clock.tell():
            return Best(key, bound, clock.evaluations, False)
        trains = _completed(request, firsts[some], seconds)
        clock.evaluations += len(trains)
        for other in _promising(request, trains, key):
            if key is None or other < key:
                key = other
                clock.best = float(key[0])
    return Best(key, math.inf if key is None else key[0], clock.evaluations, True)


def _grid(*ranges: tuple[int, int]) -> IntArray:
    """All combinations of whole numbers in ranges, a row of each."""
    axes = [np.arange(low, high + 1) for low, high in ranges]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(ranges))


def _sets(request: Request, at: int) -> IntArray:
    """Sun, planet and ring of one module whose centre distances are equal, from gear `at` on."""
    sun, planet, (low, high) = request.teeth[at : at + 3]
    two = _grid(sun, planet, (-request.coaxial, request.coaxial))
    two[:, 2] += two[:, 0] + 2 * two[:, 1]
    kept: IntArray = two[(low <= two[:, 2]) & (two[:, 2] <= high)]
    return kept


def _firsts(request: Request) -> tuple[IntArray, Any, Any]:
    """First parts, and of each a bound of the objective and the fewest teeth of a train with it."""
    stepped = request.arrangement == STEPPED
    firsts = _grid(*request.teeth[:2]) if stepped else _sets(request, 0)
    rest = request.teeth[FIRST[request.arrangement] :]
    fewest = firsts.sum(axis=1) + sum(low for low, _ in rest)
    error = np.zeros(len(firsts))
    if request.ratio is not None:
        error = np.maximum(_least_error(request, firsts) - DOUBT, 0.0)
    ring = firsts[:, -1] if firsts.shape[1] == 3 else _base(request, firsts) + rest[0][0]
    floors = {ERROR: error, LOSS: np.zeros(len(firsts)), RING: ring.astype(float)}[request.goal]
    if request.tolerance is not None and TOLERANCE not in request.without:
        kept = error <= float(request.tolerance) + DOUBT
        return firsts[kept], floors[kept], fewest[kept]
    return firsts, floors, fewest


def _base(request: Request, firsts: IntArray) -> IntArray:
    """Least teeth by which the last ring may exceed its planet beside a first part."""
    needed = (firsts[:, 0] + firsts[:, 1]) / float(request.modules)
    base: IntArray = np.ceil(needed - request.coaxial - SAME).astype(np.int64)
    return base


def _least_error(request: Request, firsts: IntArray) -> Any:
    """Bound of |i/u - 1| of all trains with each first part.

    The ratio is linear fractional in r of the last set, of which both ends are known; between them
    it lies between its values there, or has a pole.
    """
    z = [*firsts.T.astype(float)]
    if request.arrangement == SIMPLE:
        return request.error([*firsts.T])
    (p_low, p_high), (r_low, r_high) = request.teeth[-2:]
    if request.arrangement == COUPLED:
        (low, high), known = request.teeth[3], [(z[0], z[2])]
        ends = [(high, r_low), (low, r_high)]
    else:
        ends = [(z[0] * p_high, z[1] * r_low), (z[0] * p_low, z[1] * r_high)]
        known = [] if request.arrangement == STEPPED else [(z[0], z[2])]
    parts = [willis.ratio_parts(request.use, [*known, end]) for end in ends]
    u = float(request.ratio or 1)
    with np.errstate(all="ignore"):
        values = np.sort([above / below / u for above, below in parts], axis=0)
    pole = parts[0][1] * parts[1][1] <= 0
    return np.where(pole, 0.0, np.maximum.reduce([values[0] - 1.0, 1.0 - values[1], 0.0 * z[0]]))


def _seconds(request: Request) -> IntArray:
    """What completes a first part: of two steps the second planet and teeth beyond `_base`.

    Of coupled sets second sets, of each ratio of their teeth the one of fewest: what a train loses
    and its ratio depend on z_r/z_s alone, limits of a set on its own teeth.
    """
    if request.arrangement == SIMPLE:
        return np.zeros((1, 0), np.int64)
    if request.arrangement != COUPLED:
        return _grid(request.teeth[-2], (0, 2 * request.coaxial))
    sets = _sets(request, 3)
    alone = replace(
        request,
        arrangement=SIMPLE,
        teeth=request.teeth[3:],
        planets=request.planets[1:],
        tolerance=None,
        efficiency=None,
    )
    parts = np.array_split(sets, 1 + len(sets) // CHUNK)
    sets = np.concatenate([part[_within(alone, part)] for part in parts])
    divisor = np.gcd(sets[:, 0], sets[:, 2])
    order = np.lexsort((sets[:, 1], sets.sum(axis=1), sets[:, 2]))
    reduced = np.stack((sets[:, 0] // divisor, sets[:, 2] // divisor), axis=1)[order]
    _, kept = np.unique(reduced, axis=0, return_index=True)
    smallest: IntArray = sets[order[kept]]
    return smallest


def _within(request: Request, trains: IntArray) -> Any:
    """Which trains meet all limits, but for DOUBT and WITHIN."""
    met = np.ones(len(trains), bool)
    for name, used in request.used([*trains.T]).items():
        room = WITHIN + (DOUBT / float(request.tolerance or 1) if name == TOLERANCE else 0.0)
        met &= used <= 1.0 + room
    return met


def _completed(request: Request, firsts: IntArray, seconds: IntArray) -> IntArray:
    """All trains with some first parts whose centre distances are equal."""
    if request.arrangement in (SIMPLE, COUPLED):
        first, second = np.indices((len(firsts), len(seconds))).reshape(2, -1)
        return np.column_stack((firsts[first], seconds[second]))
    ring = _base(request, firsts)[:, None] + seconds.sum(axis=1)
    low, high = request.teeth[-1]
    first, second = np.nonzero((low <= ring) & (ring <= high))
    return np.column_stack((firsts[first], seconds[second, 0], ring[first, second]))


def _promising(request: Request, trains: IntArray, key: Key | None) -> Iterator[Key]:
    """Exact keys of the trains that may be better than the best known, the best in doubles first.

    They end where doubles show that no other is better.
    """
    goals = request.goal_of([*trains.T])
    able = np.isfinite(goals) & (goals <= (math.inf if key is None else float(key[0]) + DOUBT))
    trains, goals = trains[able], goals[able]
    met = _within(request, trains)
    trains, goals = trains[met], goals[met]
    totals = trains.sum(axis=1)
    order = np.lexsort((*trains.T[::-1], totals, goals))
    least: float | None = None
    for k in order:
        if least is not None and goals[k] > least + 2 * DOUBT:
            return
        exact = request.key(trains[k].tolist())
        if exact is not None:
            if request.goal == RING:
                yield exact
                return
            least = goals[k] if least is None else least
            yield exact
