"""Which of many trains no other is better than in every respect."""

import math
from bisect import bisect_left, bisect_right

import numpy as np

from gearopt.optimise.terms import Array


def unbeaten(worth: Array) -> list[int]:
    """Rows of worth (N, 2 or 3) that no other row is as good as in all columns; less is better.

    In the order of the first column; of equal rows the first one counts.
    """
    if worth.shape[1] == 2:
        worth = np.column_stack([worth, np.zeros(len(worth))])
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
