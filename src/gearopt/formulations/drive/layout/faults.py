"""Whether a gearbox can be laid out at all: checks of the data in numbers, then a search."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from gearopt.formulations.drive.gearbox import ANYWHERE, Gearbox, KeepOut, Place
from gearopt.formulations.drive.layout.annealing import anneal
from gearopt.formulations.drive.layout.chain import chain, turns
from gearopt.formulations.drive.layout.exact import NODES, first_cell
from gearopt.formulations.drive.layout.slabs import (
    Arrangement,
    Clash,
    arrange,
    arrangements,
    clashes,
    largest_beside,
    orders,
)
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget, Watch

TOUCH = 1e-6  # mm; by which a place may be out of reach
INPUT = Place(0, (0.0, 0.0), (0.0, 0.0))  # the origin
# short runs of annealing: most layouts that exist are found by these
ANNEALING_STEPS, STARTS = 5_000, 4


def faults(box: Gearbox) -> list[str]:
    """Return a sentence for each clash, excess length or unreachable place; none without one."""
    return [
        *_slab_order_faults(box),
        *_keep_out_faults(box),
        *_reach(box),
        *of_any_gears(box),
        *_sides(box),
    ]


def of_any_gears(box: Gearbox) -> list[str]:
    """Return those of the faults that other gears have too."""
    return [*_motor(box), *_place_faults(box), *_level(box), *_through(box)]


def _slab_order_faults(box: Gearbox) -> Iterator[str]:
    """Faults of every order of slabs: those of the order with the smallest clash."""
    least_clash = arrangements(box)[0]
    longest = box.largest[2] * (1.0 + 1e-9)
    if not clashes(box, least_clash) and least_clash.length <= longest:
        return
    every = _every(box)
    clear = [one for one in every if not clashes(box, one)]
    if not clear:
        worst = min(every, key=lambda one: clashes(box, one)[0].short)
        yield from map(_sentence, clashes(box, worst))
    shortest = min(one.length for one in clear or every)
    if shortest > longest:
        yield (
            f"The box is at least {shortest:.2f} mm long, and may be {box.largest[2]:.7g} mm "
            "at most."
        )


def _every(box: Gearbox) -> list[Arrangement]:
    """Return all orders of slabs, whatever they lack."""
    return [arrange(box, s) for s in ([box.slabs] if box.slabs is not None else orders(box))]


def _keep_out_faults(box: Gearbox) -> Iterator[str]:
    """Yield the bodies too close to keep-outs, on the input shaft or a shaft at a given place."""
    tried = arrangements(box)
    if clashes(box, tried[0]):  # it stands for all orders
        tried = tuple(_every(box)) if box.keep_outs else tried
    for k, keep in enumerate(box.keep_outs):
        for given in (INPUT, *box.places):
            there = max(_distance(keep, y, z) for y in given.y for z in given.z)
            least = min(tried, key=lambda one: float(one.keep_apart[k, given.shaft]))
            need = float(least.keep_apart[k, given.shaft])
            if need - there > TOUCH:
                hedge = "" if given is INPUT else "at most "
                who = "the input shaft" if given is INPUT else f"shaft {given.shaft + 1}"
                largest = largest_beside(least.bodies[given.shaft], keep.x).name
                yield (
                    f"{largest[0].upper()}{largest[1:]} violates the clearance to {keep.name} by "
                    f"{need - there:.2f} mm: the axis of {who} is {hedge}{there:.2f} mm from it "
                    f"and needs {need:.2f} mm."
                )


def _motor(box: Gearbox) -> Iterator[str]:
    """Yield the keep-outs that the motor reaches into."""
    for keep in box.keep_outs:
        there = _distance(keep, 0.0, 0.0)
        if keep.x == ANYWHERE and box.motor - there > TOUCH:
            yield f"The motor reaches {box.motor - there:.2f} mm into {keep.name}."


def _sides(box: Gearbox) -> Iterator[str]:
    """Yield where the largest body with its wall clearances exceeds the width or height."""
    bodies = [body for own in arrangements(box)[0].bodies for body in own]
    largest = max(bodies, key=lambda body: body.radius)
    need = 2.0 * (largest.radius + box.clearances.wall)
    wide = min(box.largest[0], math.inf if box.width is None else box.width)
    for side, maximum in (("wide", wide), ("high", box.largest[1])):
        if need > maximum + TOUCH:
            yield (
                f"The box is at least {need:.2f} mm {side} ({2.0 * largest.radius:.2f} mm for "
                f"{largest.name}, twice {box.clearances.wall:g} mm to the walls), and may be "
                f"{maximum:.7g} mm."
            )


def _distance(keep: KeepOut, y: float, z: float) -> float:
    """Return the distance of a point from a keep-out."""
    return math.hypot(
        max(keep.y[0] - y, y - keep.y[1], 0.0),
        max(keep.z[0] - z, z - keep.z[1], 0.0),
    )


def _reach(box: Gearbox) -> Iterator[str]:
    """Yield places that the links between two shafts cannot span."""
    given = [INPUT, *box.places]
    for n, b in enumerate(given):
        for a in given[:n]:
            first, last = sorted((a.shaft, b.shaft))
            links = [p.centre_distance for p in box.pairs[first:last]]
            near, far = _between(a, b)
            reach = sum(links)
            minimum = max(0.0, 2.0 * max(links, default=0.0) - reach)
            who = f"The places of shafts {a.shaft + 1} and {b.shaft + 1}"
            if near > reach + TOUCH and links:
                yield (
                    f"{who} are at least {near:.2f} mm apart; the centre distances between them "
                    f"reach {reach:.2f} mm."
                )
            elif far < minimum - TOUCH:
                yield (
                    f"{who} are at most {far:.2f} mm apart; the centre distances between them "
                    f"keep them {minimum:.2f} mm apart."
                )


def _place_faults(box: Gearbox) -> Iterator[str]:
    """Yield two places of one shaft that exclude each other."""
    given = [INPUT, *box.places]
    for n, b in enumerate(given):
        for a in given[:n]:
            near, _ = _between(a, b)
            if a.shaft == b.shaft and near > TOUCH:
                yield f"Shaft {a.shaft + 1} has two places, {near:.2f} mm apart."


def _through(box: Gearbox) -> Iterator[str]:
    """Yield places so close that two shafts through the whole box overlap, whatever their gears.

    The input shaft has the same torque with any gears; of others the radius counts as none.
    """
    given = [] if box.partial else [INPUT, *box.places]
    for n, b in enumerate(given):
        for a in given[:n]:
            first, last = sorted((a.shaft, b.shaft))
            radii = [box.shafts[k].radius for k in (first, last)]
            least = box.clearances.shafts + (radii[0] if first == 0 else 0.0)
            _, far = _between(a, b)
            if box.axes[first] != box.axes[last] and far < least - TOUCH:
                yield (
                    f"Shafts {first + 1} and {last + 1} pass through the whole box (span = "
                    f'"full"), and their places are at most {far:.2f} mm apart: with their radii '
                    f"and clearance they need {sum(radii) + box.clearances.shafts:.2f} mm."
                )


def _level(box: Gearbox) -> Iterator[str]:
    """Yield places of shafts on the split line that cannot be of one height."""
    given = [p for p in (INPUT, *box.places) if p.shaft in box.level]
    above = max(given, key=lambda p: p.z[0], default=INPUT)
    below = min(given, key=lambda p: p.z[1], default=INPUT)
    if above.z[0] - below.z[1] > TOUCH and above.shaft != below.shaft:
        first, last = sorted((above.shaft + 1, below.shaft + 1))
        yield (
            f"Shafts {first} and {last} are on the split line, but shaft "
            f"{above.shaft + 1} is at a height z of at least {above.z[0]:.2f} mm and shaft "
            f"{below.shaft + 1} of at most {below.z[1]:.2f} mm."
        )


def _between(a: Place, b: Place) -> tuple[float, float]:
    """Return the minimum and maximum distance of two places."""
    near, far = [], []
    for p, q in ((a.y, b.y), (a.z, b.z)):
        near.append(max(p[0] - q[1], q[0] - p[1], 0.0))
        far.append(max(p[1] - q[0], q[1] - p[0]))
    return math.hypot(*near), math.hypot(*far)


def _sentence(clash: Clash) -> str:
    """Missing distance of two axes, in numbers: `Wheel 1 and shaft 3 ...`."""
    first, last = clash.need.between
    a, b = (k + 1 for k in clash.shafts)
    between = f"stage {a}" if b == a + 1 else f"stages {a} to {b - 1} in one line"
    radii = clash.need.distance - clash.need.clearance
    return (
        f"{first[0].upper()}{first[1:]} and {last} are {clash.short:.2f} mm too close: the axes of "
        f"shafts {a} and {b} are at most {clash.there:.2f} mm apart (centre distance of {between}) "
        f"and need {clash.need.distance:.2f} mm ({radii:.2f} mm for both radii, "
        f"{clash.need.clearance:g} mm clearance)."
    )


def possible(box: Gearbox, seconds: float, watch: Watch | None = None) -> bool | None:
    """Return whether there is a layout; None where that is not known in time.

    True with a layout in hand, False because distances clash or every cell of angles is excluded.
    """
    orders, clock = arrangements(box), Clock(Budget(seconds), watch)
    if faults(box):
        return False
    shape = chain(box, orders)

    def goes(steps: int, best: float) -> bool:
        return math.isinf(best)

    if any(np.isfinite(anneal(shape, k, ANNEALING_STEPS, goes)[0][0]) for k in range(STARTS)):
        return True
    kernels: Any = kernel("gearopt.formulations.drive.layout.branch_kernel")
    theta = np.zeros(shape.link.size)
    for m in range(len(orders)):
        (cells, bounds), count, floor = first_cell(theta.size, turns(box)), 1, math.inf
        while count:
            state = (count, math.inf, 0.0, floor)
            count, best, _, floor, fresh = kernels.branch(
                shape, m, cells, bounds, *state, 0.5, NODES, theta
            )
            clock.evaluations += fresh
            if math.isfinite(best):
                return True
            if not clock.tell():
                return None
        if math.isfinite(floor):  # a cell was left undecided
            return None
    return False
