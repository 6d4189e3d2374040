"""Which of many trains no other is better than in every respect."""

import math
from bisect import bisect_left, bisect_right
from typing import Any

import numpy as np

from gearopt.optimise.terms import Array

FEW = 60  # rows that are tried against all others
MANY = 2000  # rows from which on that is quicker than one by one
SLOW, IDLE = 0.005, 5  # part of the rows that must go at a time, or in so many more attempts


def unbeaten(worth: Array) -> list[int]:
    """Rows of worth (N, 2 or 3) that no other row is as good as in all columns; less is better.

    In the order of the first column; of equal rows the first one counts.
    """
    if worth.shape[1] == 2:
        worth = np.column_stack([worth, np.zeros(len(worth))])
    rows = _rest(worth)
    return [int(rows[k]) for k in _one_by_one(worth[rows])]


def _rest(worth: Array) -> Any:
    """Rows that are left once those that a few good ones beat are dropped, all at once."""
    low, rows, idle = worth.min(0), np.arange(len(worth)), 0
    columns = np.ascontiguousarray(worth.T)
    width = np.maximum(worth.max(0) - low, np.finfo(float).tiny)
    for direction in np.random.default_rng(0).dirichlet([0.5, 0.5, 0.5], FEW) / width:
        a, b, c = columns
        best = (direction @ columns).argmin()
        x, y, z = columns[:, best]
        kept = (a < x) | (b < y) | (c < z) | ((a == x) & (b == y) & (c == z))
        dropped = len(rows) - int(kept.sum())
        if dropped:
            rows, columns = rows[kept], np.ascontiguousarray(columns[:, kept])
        idle = idle + 1 if dropped < SLOW * len(rows) else 0
        if idle > IDLE or len(rows) < MANY:
            break
    return rows


def _one_by_one(worth: Array) -> list[int]:
    """The rows themselves: in the order of the first column, each against a stair of the rest."""
    kept: list[int] = []
    stairs: list[tuple[float, float]] = []  # of columns 2 and 3: one rising, the other falling
    for k in np.lexsort(worth.T[::-1]):
        step = (float(worth[k, 1]), float(worth[k, 2]))
        at = bisect_right(stairs, (step[0], math.inf))
        if at and stairs[at - 1][1] <= step[1]:
            continue
        kept.append(int(k))
        at = bisect_left(stairs, step)
        while at < len(stairs) and stairs[at][1] >= step[1]:
            del stairs[at]
        stairs.insert(at, step)
    return kept
