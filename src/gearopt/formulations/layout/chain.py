"""Shafts as a chain of links in the plane across them: what kernels and texts of a layout share."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearopt.formulations.layout.gearbox import ANYWHERE, Gearbox, Range
from gearopt.formulations.layout.slabs import Arrangement
from gearopt.optimise.terms import Array


class Chain(NamedTuple):
    """A layout in numbers, for M arrangements of the slabs; lengths in mm, N links, K keep-outs.

    link (N,): centre distances. reach (N+1,): from each axis to the box. apart (M, N+1, N+1): least
    distances of axes that do not mesh, 0 where there is none. keep (K, 4): left, right, bottom, top
    of keep-outs; keep_apart (M, K, N+1): least distance of each axis from them. place (N+1, 4):
    range of y, then of z, of each axis. level: shafts of equal z (empty: none). close (N,): 0 for a
    free link, 1 for one that ends at a given height, 2 and 3 for two that end at a given place;
    goal (N, 3): shaft that a height is measured from, y, z. most (2,): largest width and height.
    power (2,): exponents of width and height in the objective, factor (M,) times it (its lengths
    and constants). longest: the objective is the longest side instead, and factor the third side.
    The first axis is the origin.
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


NARROW = 0.1  # of a link: a range of places smaller than this is met by closing the chain


def chain(box: Gearbox, orders: tuple[Arrangement, ...]) -> Chain:
    """The numbers of a gearbox with some arrangements of its slabs."""
    count = len(box.shafts)
    link = np.array([p.centre_distance for p in box.pairs])
    reach = [max(body.radius for body in own) for own in orders[0].bodies]
    apart = np.stack([a.apart for a in orders])
    for i in range(count - 1):  # fixed by the centre distances
        apart[:, i, i + 1] = apart[:, i + 1, i] = 0.0
    place = np.tile([-math.inf, math.inf], (count, 2))
    for p in box.places:
        place[p.shaft] = (*p.y, *p.z)
    close, goal = _closings(box, link)
    powers, factor = _objective(box, np.array([a.length for a in orders]))
    width = math.inf if box.width is None else box.width
    return Chain(
        link,
        np.array(reach) + box.clearances.wall,
        apart,
        np.array([(*k.y, *k.z) for k in box.keep_outs]).reshape(-1, 4),
        np.stack([a.keep_apart for a in orders]),
        place,
        np.array(sorted(box.level), np.int64),
        close,
        goal,
        np.array([min(width, box.largest[0]), box.largest[1]]),
        np.array(powers),
        factor,
        box.objective == "longest_side",
    )


def _objective(box: Gearbox, length: Array) -> tuple[tuple[float, float], Array]:
    """Exponents of width and height, and the factor of each arrangement."""
    if box.objective == "longest_side":
        return (1.0, 1.0), np.maximum(length, box.width or 0.0)
    wide = 1.0 if box.objective in ("box_volume", "plan_area", "face_area") else 0.0
    high = 1.0 if box.objective in ("box_volume", "face_area", "height") else 0.0
    factor = length if box.objective in ("box_volume", "plan_area") else np.ones_like(length)
    if box.width is not None and wide:
        return (0.0, high), factor * box.width
    return (wide, high), factor


def _closings(box: Gearbox, link: Array) -> tuple[NDArray[np.int64], Array]:
    """Which links follow from given places, so that a search need not find them."""
    close, goal = np.zeros(len(link), np.int64), np.zeros((len(link), 3))

    def narrow(ends: Range, k: int) -> bool:
        return ends != ANYWHERE and ends[1] - ends[0] < NARROW * link[k]

    for p in box.places:
        k, centre = p.shaft - 1, (0.5 * sum(p.y), 0.5 * sum(p.z))
        if k >= 1 and narrow(p.y, k) and narrow(p.z, k) and not close[k - 1 : k + 1].any():
            close[k - 1 : k + 1], goal[k - 1 : k + 1] = (2, 3), (0.0, *centre)
        elif narrow(p.z, k) and not close[k]:
            close[k], goal[k] = 1, (0.0, 0.0, centre[1])
    for before, after in zip(sorted(box.level), sorted(box.level)[1:], strict=False):
        if not close[after - 1]:
            close[after - 1], goal[after - 1] = 1, (before, 0.0, 0.0)
    return close, goal


def turns(box: Gearbox) -> tuple[float, float]:
    """Range of the first link's angle that holds, by reflection, a copy of every layout [rad]."""
    if box.keep_outs or any(p.y != ANYWHERE for p in box.places):
        return -math.pi, math.pi
    if box.places:  # heights only: left and right are the same
        return -0.5 * math.pi, 0.5 * math.pi
    powers, _ = _objective(box, np.ones(1))
    alike = powers[0] == powers[1] and box.width is None and not box.level
    if alike and box.largest[0] == box.largest[1]:
        return 0.0, 0.25 * math.pi
    return 0.0, 0.5 * math.pi
