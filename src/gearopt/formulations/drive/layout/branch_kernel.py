"""Kernel of the exact search: depth-first branch and bound on cells of link angles."""

import math

import numpy as np

from gearopt.formulations.drive.layout.bound_kernel import scratch, sharp
from gearopt.formulations.drive.layout.chain_kernel import (
    MARGIN,
    ROUNDING,
    excluded,
    measured_at_angles,
    sides,
    value,
    widest,
)
from gearopt.optimise.jit_kernel import entry, inner

ALIKE = 1e-6  # an angle this much narrower than another is not halved again: it is not the cause


@inner
def opened(cells, bounds, count, low, high, k, middle, bound):
    """Add both halves of a cell, cut across angle k, to the open ones; return their count."""
    for half in range(2):
        for i in range(low.size):
            cells[count, 0, i], cells[count, 1, i] = low[i], high[i]
        cells[count, 1 - half, k] = middle
        bounds[count] = bound
        count += 1
    return count


@entry
def branch(chain, m, cells, bounds, count, best, near, floor, rel, limit, theta):
    """Depth-first branch and bound on cells of angles: `limit` nodes, or until `best` improves.

    cells (size, 2, N): low and high of the open cells, of which `count` are in use; bounds (size,):
    theirs. A cell is dropped if nothing in it is feasible or all of it is above best (1 - rel).
    A point of a cell improves `best`, `theta` holds it. floor: least bound of the cells dropped for
    being too good to matter, or because they cannot be halved or there is no room. Where `best` is
    not improved, theta holds the point that lacks least of those that promise to, if that is less
    than `near`, its lack [mm]. Returns count, best, near, floor, nodes.
    """
    links = theta.size
    size = (links + 1, links + 1)
    spans = (np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size))
    room, pull, point = scratch(links), np.zeros((2, links)), np.zeros(links)
    low, high = np.empty(links), np.empty(links)
    y, z = np.zeros(links + 1), np.zeros(links + 1)
    nodes, start = 0, best
    while count > 0 and nodes < limit and best == start:
        count -= 1
        nodes += 1
        aim, bound = best * (1.0 - rel), bounds[count]
        if bound >= aim:
            floor = min(floor, bound)
            continue
        for i in range(links):
            low[i], high[i] = cells[count, 0, i], cells[count, 1, i]
        if excluded(chain, m, low, high, *spans):
            continue
        box = sides(chain, *spans)
        if box[0] > chain.most[0] * (1.0 + MARGIN) or box[2] > chain.most[1] * (1.0 + MARGIN):
            continue
        bound = max(bound, value(chain, m, box[0], box[2]) * (1.0 - 4.0 * MARGIN))
        if bound < aim:
            bound = max(bound, sharp(chain, m, low, high, spans, box, aim, room, pull, point))
        if bound >= aim:
            floor = min(floor, bound)
            continue
        k = halved(chain, m, low, high, box, pull, point, y, z)
        for turn in range(2):
            if turn == 1:
                for i in range(links):
                    point[i] = 0.5 * (low[i] + high[i])
            width, height, short = measured_at_angles(chain, m, point, y, z)
            found = value(chain, m, width, height)
            if short <= ROUNDING and found < best:
                best = found
                for i in range(links):
                    theta[i] = point[i]
            elif best == start and short < near and found < aim:
                near = short
                for i in range(links):
                    theta[i] = point[i]
        middle = point[k]
        if count + 2 > bounds.size or not low[k] < middle < high[k]:
            floor = min(floor, bound)
            continue
        count = opened(cells, bounds, count, low, high, k, middle, bound)
    return count, best, near, floor, nodes


@inner
def halved(chain, m, low, high, box, pull, point, y, z):
    """The angle whose halving promises most: by its weight in the bound, or where that is wrong.

    Where the linear program is least, sides may be longer than it takes them to be, and axes too
    close to each other or not in their place; the links between these count by that error.
    """
    links, scale = low.size, 0.5 * min(box[1], box[3])
    unit = scale if chain.longest else 1.0  # else weights are those of logarithms
    wrong = np.zeros(links)
    width, height, _ = measured_at_angles(chain, m, point, y, z)
    for i in range(links + 1):
        lack = max(chain.place[i, 0] - y[i], y[i] - chain.place[i, 1], 0.0)
        lack = max(lack, chain.place[i, 2] - z[i], z[i] - chain.place[i, 3])
        for k in range(chain.keep.shape[0]):
            past_y = max(chain.keep[k, 0] - y[i], y[i] - chain.keep[k, 1], 0.0)
            past_z = max(chain.keep[k, 2] - z[i], z[i] - chain.keep[k, 3], 0.0)
            lack = max(
                lack, chain.keep_apart[m, k, i] - math.sqrt(past_y * past_y + past_z * past_z)
            )
        for k in range(i):
            wrong[k] = max(wrong[k], lack / scale)
        for j in range(i + 2, links + 1):
            dy, dz = y[i] - y[j], z[i] - z[j]
            lack = chain.apart[m, i, j] - math.sqrt(dy * dy + dz * dz)
            for k in range(i, j):
                wrong[k] = max(wrong[k], lack / scale)
    i, j, _, _ = widest(chain, y)
    for k in range(i, j):
        wrong[k] = max(wrong[k], (width - box[0]) / width)
    i, j, _, _ = widest(chain, z)
    for k in range(i, j):
        wrong[k] = max(wrong[k], (height - box[2]) / height)
    best, most, longest, length = -1, 0.0, 0, 0.0
    for k in range(links):
        size = high[k] - low[k]
        weight = math.sqrt(pull[0, k] * pull[0, k] + pull[1, k] * pull[1, k])
        score = size * (weight / unit + wrong[k] * chain.link[k] / scale)
        if score > most:
            best, most = k, score
        if size * chain.link[k] > length:
            longest, length = k, size * chain.link[k]
    if best < 0 or (high[best] - low[best]) * chain.link[best] < ALIKE * length:
        return longest
    return best
