"""Kernels on the pairs of one stage: which are of use, and what the stages before one cost."""

import math

import numpy as np
from numba import njit

from gearopt.formulations.together.node_kernel import (
    ALLOWANCE,
    EDGE,
    grows,
    least_area,
    length,
    module,
    place,
    put,
    width,
    worth,
)


@njit(cache=True)
def useful(d, j, cut, keep):
    """Mark the pairs of a stage that alone stay below `cut`; the least width of those for all."""
    node, body = np.zeros((d.kind.size, 3)), np.zeros((d.kind.size + 1, 4))
    found, wall = math.inf, d.gap[2]
    for i in range(d.kind.size):
        node[i, 1] = d.widths[i]
    for p in range(d.start[j], d.start[j + 1]):
        torque = d.torque
        if j > 0:
            torque *= d.least_before[j]
        if j == d.kind.size - 1:
            torque = max(torque, d.torque * d.low_ratio * (d.z1[p] / d.z2[p]))
        torque *= 1.0 - ALLOWANCE
        keep[p] = False
        for k in range(module(d, j, p, torque), d.last[p] + 1):
            node[j, 1] = width(d, j, p, k, torque)
            if node[j, 1] == math.inf:
                continue
            put(d, j, p, k, node, body)
            least = math.inf
            for m in range(d.slabs.size):
                least = min(least, length(d, m, 0, node))
            r = body[j + 1, 0] + wall
            area = least_area(body[j, 1] + wall, r, node[j, 0])
            if worth(d.aim, least, area, 2.0 * r) < cut:
                keep[p] = True
                found = min(found, node[j, 1])
            elif grows(d, j) and worth(d.aim, least, 4.0 * r * r, 2.0 * r) >= cut:
                break
    return found


@njit(cache=True)
def fill(d, k, start, stop, rest):
    """Tables of stages 0..k-1 with a total ratio of cells start to stop.

    rest.least[k, i, cell]: least width of stage i. rest.front[k, m, cell, bin]: least length that
    the stages add in slabs of their own, for wheels k - 1 of tip radius in a bin.
    """
    j, many, begin = k - 1, d.slabs.size, d.start[k - 1]
    end = d.start[k]
    span = d.log_high - d.log_low + d.delta + 4.0 * EDGE
    widths, more = np.zeros(k), np.zeros(many)
    alone = np.zeros((many, k), np.int64)  # 1 + slab of a stage, 0 where it shares with later ones
    for m in range(many):
        for i in range(k):
            alone[m, i] = 1 + d.slab_of[m, i]
            for o in range(k, d.kind.size):
                if d.slab_of[m, o] == d.slab_of[m, i]:
                    alone[m, i] = 0
    bins = np.zeros((end - begin, d.modules.shape[1]), np.int64)
    for p in range(end - begin):
        for q in range(d.first[begin + p], d.last[begin + p] + 1):
            radius = d.modules[j, q] * (0.5 * d.z2[begin + p] / d.cosine + 1.0)
            above = place(rest.edge[k], 0, rest.edge.shape[1], radius)
            bins[p, q] = max(above - 1, 0)  # not above the radius
    for cell in range(start, stop):
        low = cell * d.delta - EDGE
        through = d.torque * math.exp(low) * (1.0 - ALLOWANCE)
        first = place(d.log_ratio, begin, end, low) if k == 1 else begin
        for p in range(first, place(d.log_ratio, begin, end, low + span)):
            torque, there = d.torque, True
            if k > 1:
                torque = max(torque, through * (d.z1[p] / d.z2[p]))
                left = int(max(cell * d.delta - d.log_ratio[p], 0.0) / d.delta)
                for i in range(j):
                    widths[i] = min(rest.least[j, i, left], rest.least[j, i, left + 1])
                    there = there and widths[i] < math.inf
            for q in range(module(d, j, p, torque), d.last[p] + 1 if there else 0):
                widths[j] = width(d, j, p, q, torque)
                if widths[j] == math.inf:
                    continue
                for i in range(k):
                    rest.least[k, i, cell] = min(rest.least[k, i, cell], widths[i])
                added(d, alone, widths, more)
                for m in range(many):
                    if more[m] < rest.front[k, m, cell, bins[p - begin, q]]:
                        rest.front[k, m, cell, bins[p - begin, q]] = more[m]
                if grows(d, j):
                    break


@njit(cache=True)
def added(d, alone, widths, more):
    """Length that stages add in slabs of their own, in each arrangement: more (M,)."""
    for m in range(more.size):
        more[m] = 0.0
        for i in range(widths.size):
            widest = widths[i]
            for o in range(widths.size):
                if alone[m, o] == alone[m, i] and widths[o] > widths[i]:
                    widest = 0.0  # counts with the wider one
                if alone[m, o] == alone[m, i] and o < i and widths[o] == widths[i]:
                    widest = 0.0
            more[m] += widest if alone[m, i] > 0 else 0.0
