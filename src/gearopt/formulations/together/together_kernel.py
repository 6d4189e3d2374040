"""Kernels of the search: choices for one more stage, and a look for a layout of what is chosen."""

import math

import numpy as np
from numba import njit

from gearopt.formulations.layout.branch_kernel import branch
from gearopt.formulations.together.node_kernel import (
    ALLOWANCE,
    EDGE,
    apart,
    bases,
    bound,
    grows,
    least_area,
    loaded,
    module,
    place,
    put,
    widest,
    width,
    worth,
)


@njit(cache=True)
def expand(d, rest, j, parents, start, stop, cut, limit, children, bounds):
    """Children of nodes by a choice for stage j; one slice of about `limit` choices.

    parents (n, N, 2): pair and module of each chosen stage. start (2,): parent and pair to go on
    with, moved on. stop: of the parents. Returns the number of children, and of choices looked at.
    """
    stages, shafts = parents.shape[1], parents.shape[1] + 1
    node, body = np.zeros((stages, 3)), np.zeros((shafts, 4))
    need = np.zeros((shafts, shafts))
    lengths, radius = np.empty(d.slabs.size), np.empty(d.slabs.size)
    choice, kept = np.zeros((stages, 2), np.int64), np.zeros(stages)
    base, shared = np.empty(d.slabs.size), np.empty(d.slabs.size)
    aim, wall, larger = d.aim, d.gap[2], grows(d, j)
    count = looked = 0
    while start[0] < stop and looked < limit and count + d.modules.shape[1] <= bounds.size:
        for i in range(j + 1, stages):
            choice[i, 0], choice[i, 1] = parents[start[0], i, 0], parents[start[0], i, 1]
        left_low, left_high, ratio = d.log_low, d.log_high, 1.0
        for i in range(j + 1, stages):
            put(d, i, choice[i, 0], choice[i, 1], node, body)
            left_low -= node[i, 2]
            left_high -= node[i, 2]
            ratio *= d.z2[choice[i, 0]] / d.z1[choice[i, 0]]
        end = place(d.log_ratio, d.start[j], d.start[j + 1], left_high + EDGE)
        if start[1] < 0:
            start[1] = d.start[j]
            if j == 0:
                start[1] = place(d.log_ratio, d.start[j], end, left_low - EDGE)
        if j < stages - 1:
            loaded(d, j + 1, choice, node)
        bases(d, j, node, base, shared)
        for i in range(stages):
            kept[i] = node[i, 1]
        pinion = body[j + 1, 1] if j + 1 < stages else 0.0
        while start[1] < end and looked < limit and count + d.modules.shape[1] <= bounds.size:
            p = start[1]
            start[1] += 1
            looked += 1
            choice[j, 0] = p
            torque = d.torque
            if j > 0:
                torque *= d.low_ratio / ratio * (d.z1[p] / d.z2[p]) * (1.0 - ALLOWANCE)
            for k in range(module(d, j, p, torque), d.last[p] + 1):
                b = width(d, j, p, k, torque)
                if b == math.inf:
                    continue
                choice[j, 1] = k
                put(d, j, p, k, node, body)
                for i in range(j + 1, stages):
                    node[i, 1] = kept[i]
                node[j, 1] = b
                least = math.inf
                for m in range(base.size):
                    least = min(least, base[m] + max(b - shared[m], 0.0))
                r = max(body[j + 1, 0], pinion) + wall
                area = least_area(body[j, 1] + wall, r, node[j, 0])
                if j + 1 < stages:
                    area = max(area, least_area(r, body[j + 2, 0] + wall, node[j + 1, 0]))
                if worth(aim, least, area, 2.0 * r) >= cut:
                    if larger and worth(aim, least, 4.0 * r * r, 2.0 * r) >= cut:
                        break
                    continue
                if j == 0 and not loaded(d, 0, choice, node):
                    continue
                value = bound(d, rest, j, node, body, need, cut, lengths, radius)
                if value < cut:
                    for i in range(j, stages):
                        children[count, i, 0] = choice[i, 0]
                        children[count, i, 1] = choice[i, 1]
                    bounds[count] = value
                    count += 1
        if start[1] >= end:
            start[0] += 1
            start[1] = -1
    return count, looked


@njit(cache=True)
def sift(d, rest, chain, turns, first, nodes, start, levels, limits, alive, found):
    """Look for a layout below a value of the discs of each node, for one slice.

    levels: what is not below the first is dropped, what is below the second is looked for.
    limits: most cells for an arrangement of a node, and for the slice.
    alive (n,): 0 if there is none, 1 if one was found, 2 if the cells of an arrangement did not
    tell. found (n, 2 + links): its value, arrangement and angles. Returns where it stopped, cells.
    """
    shafts = nodes.shape[1] + 1
    links = shafts - 1 - first
    node, body = np.zeros((shafts - 1, 3)), np.zeros((shafts, 4))
    need = np.zeros((shafts, shafts))
    lengths, radius = np.empty(d.slabs.size), np.empty(d.slabs.size)
    cells, bounds, theta = np.zeros((200 * links, 2, links)), np.zeros(200 * links), np.zeros(links)
    cut, better = levels
    aim = d.aim
    most, limit = limits
    margin = 1.0 - cut / better if better < math.inf else 0.0
    spent = 0
    while start < alive.size and spent < limit:
        for i in range(first, shafts - 1):
            put(d, i, nodes[start, i, 0], nodes[start, i, 1], node, body)
        loaded(d, first, nodes[start], node)
        bound(d, rest, first, node, body, need, cut, lengths, radius)
        alive[start] = 0
        for m in range(d.slabs.size):
            if lengths[m] == math.inf or not apart(d, m, first, node, body, need):
                continue
            for x in range(links + 1):
                chain.reach[x] = widest(body, first + x) + d.gap[2]
                for y in range(links + 1):
                    near = abs(x - y) < 2
                    chain.apart[0, x, y] = 0.0 if near else need[first + x, first + y]
            chain.reach[0] = max(chain.reach[0], radius[m])
            for x in range(links):
                chain.link[x] = node[first + x, 0]
                cells[0, 0, x], cells[0, 1, x] = -math.pi, math.pi
            chain.factor[0] = aim[3] + aim[4] * lengths[m]
            if aim[7] > 0.0:
                chain.factor[0] = max(aim[3], lengths[m])
            cells[0, 0, 0], cells[0, 1, 0] = turns[0], turns[1]
            bounds[0], count, used, least, floor = 0.0, 1, 0, better, math.inf
            while count > 0 and used < most and least == better:
                count, least, floor, looked, _ = branch(
                    chain, 0, cells, bounds, count, least, floor, margin, 64, theta
                )
                used += looked
            spent += used + 1
            if least < better:
                if alive[start] != 1 or least < found[start, 0]:
                    found[start, 0], found[start, 1] = least, m
                    for x in range(links):
                        found[start, 2 + x] = theta[x]
                alive[start] = 1
                if first > 0:
                    break
            elif (count > 0 or floor < cut) and alive[start] == 0:
                alive[start] = 2
        start += 1
    return start, spent
