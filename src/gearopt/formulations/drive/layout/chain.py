"""Shafts as a chain of links in the plane across them, as its kernels and problems share it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.drive.gearbox import Gearbox, Range
from gearopt.formulations.drive.layout.slabs import TOUCH, Arrangement
from gearopt.optimise.terms import Array


class Chain(NamedTuple):
    """A layout in numbers, for M arrangements of the slabs; lengths in mm, N links, K keep-outs.

    Shafts of one line are one axis here. link (N,): centre distances. reach (N+1,): from each axis
    to the box. apart (M, N+1, N+1): minimum distances of axes, 0 where there is none or, of
    neighbours, the centre distance is enough. keep (K, 4): left, right, bottom, top of keep-outs;
    keep_apart (M, K, N+1): minimum distance of each axis from them. place (N+1, 4): range of y,
    then of z, of each axis. level: axes of equal z (empty: none). close (N,): 0 for a free link, 1
    for one that ends at a given height, 2 and 3 for two that end at a given place, 4 for one that
    ends at a given y; goal (N, 3): axis that a height is measured from, y, z. most (3,): largest
    width, height, length. power (2,): exponents of width and height in the objective, factor (M,)
    times it (its lengths and constants). longest: the objective is the longest side instead, and
    factor the third side. length (M,): of the box. The first axis is the origin.
    """

    link: Array
    reach: Array
    apart: Array
    keep: Array
    keep_apart: Array
    place: Array
    level: NDArray[np.int64]
    close: NDArray[np.int64]
    goal: Array
    most: Array
    power: Array
    factor: Array
    longest: bool
    length: Array


NARROW = 0.1  # of a link: a range of places smaller than this is met by closing the chain


def chain(box: Gearbox, orders: tuple[Arrangement, ...]) -> Chain:
    """Return the numbers of a gearbox with some arrangements of its slabs."""
    axes = np.array(box.axes)
    first = np.flatnonzero(np.diff(axes, prepend=-1))  # shaft of every axis
    link = np.array([pair.centre_distance for pair in box.pairs])[first[1:] - 1]
    shafts = np.array([max(body.radius for body in own) for own in orders[0].bodies])
    reach = np.maximum.reduceat(shafts, first)
    apart = np.stack([a.apart for a in orders])
    apart = np.maximum.reduceat(np.maximum.reduceat(apart, first, 1), first, 2)
    for i, there in enumerate(link):
        need = apart[:, i, i + 1]
        apart[:, i, i + 1] = apart[:, i + 1, i] = np.where(need > there + TOUCH, need, 0.0)
    place = np.tile([-math.inf, math.inf], (len(first), 2))
    for p in box.places:
        on = axes[p.shaft]
        place[on, ::2] = np.maximum(place[on, ::2], (p.y[0], p.z[0]))
        place[on, 1::2] = np.minimum(place[on, 1::2], (p.y[1], p.z[1]))
    close, goal = _closings(box, link, place)
    length = np.array([a.length for a in orders])
    powers, factor = _objective(box, length)
    width = math.inf if box.width is None else box.width
    return Chain(
        link,
        reach + box.clearances.wall,
        apart,
        np.array([(*k.y, *k.z) for k in box.keep_outs]).reshape(-1, 4),
        np.maximum.reduceat(np.stack([a.keep_apart for a in orders]), first, 2),
        place,
        np.array(levels(box), np.int64),
        close,
        goal,
        np.array([min(width, box.largest[0]), *box.largest[1:]]),
        np.array(powers),
        factor,
        box.objective == "longest_side",
        length,
    )


def levels(box: Gearbox) -> list[int]:
    """Axes on the split line, in order."""
    return sorted({box.axes[shaft] for shaft in box.level})


def _objective(box: Gearbox, length: Array) -> tuple[tuple[float, float], Array]:
    """Return the exponents of width and height, and the factor of each arrangement."""
    if box.objective == "longest_side":
        return (1.0, 1.0), np.maximum(length, box.width or 0.0)
    wide = 1.0 if box.objective in ("box_volume", "plan_area", "face_area", "width") else 0.0
    high = 1.0 if box.objective in ("box_volume", "face_area", "height") else 0.0
    factor = length if box.objective in ("box_volume", "plan_area") else np.ones_like(length)
    if box.width is not None and wide:
        return (0.0, high), factor * box.width
    return (wide, high), factor


def _closings(box: Gearbox, link: Array, place: Array) -> tuple[NDArray[np.int64], Array]:
    """Return which links follow from given places, so that a search need not find them."""
    close, goal = np.zeros(len(link), np.int64), np.zeros((len(link), 3))

    for k, (left, right, bottom, top) in enumerate(place[1:]):
        at_y, at_z = right - left < NARROW * link[k], top - bottom < NARROW * link[k]
        if k >= 1 and at_y and at_z and not close[k - 1 : k + 1].any():
            centre = 0.5 * (left + right), 0.5 * (bottom + top)
            close[k - 1 : k + 1], goal[k - 1 : k + 1] = (2, 3), (0.0, *centre)
        elif at_z and not close[k]:
            close[k], goal[k] = 1, (0.0, 0.0, 0.5 * (bottom + top))
        elif at_y and not close[k]:
            close[k], goal[k] = 4, (0.0, 0.5 * (left + right), 0.0)
    level = levels(box)
    for before, after in zip(level, level[1:], strict=False):
        if not close[after - 1]:
            close[after - 1], goal[after - 1] = 1, (before, 0.0, 0.0)
    return close, goal


def turns(box: Gearbox) -> tuple[float, float]:
    """Range of the first link's angle that holds, by reflection, a copy of every layout [rad].

    Left and right, or top and bottom, may be changed where all places and keep-outs are symmetric;
    width and height where they are alike.
    """
    given = [(p.y, p.z) for p in box.places] + [(k.y, k.z) for k in box.keep_outs]
    left_right = all(_symmetric(y) for y, _ in given)
    top_bottom = all(_symmetric(z) for _, z in given)
    powers, _ = _objective(box, np.ones(1))
    alike = powers[0] == powers[1] and box.width is None and not box.level
    alike = alike and box.largest[0] == box.largest[1] and all(y == z for y, z in given)
    if left_right and top_bottom:
        return 0.0, 0.25 * math.pi if alike else 0.5 * math.pi
    if left_right:
        return -0.5 * math.pi, 0.5 * math.pi
    return (0.0, math.pi) if top_bottom else (-math.pi, math.pi)


def _symmetric(ends: Range) -> bool:
    return ends[0] == -ends[1]
