"""Kernels of the search.

Which pairs of a stage are of use, what the stages before one cost, choices for one more stage, and
a look for a layout of what is chosen.
"""

import math

import numpy as np

from gearopt.formulations.drive.layout.branch_kernel import branch
from gearopt.formulations.drive.layout.chain_kernel import ONE, ZERO
from gearopt.formulations.drive.together.node_kernel import (
    ALLOWANCE,
    EDGE,
    apart,
    bases,
    bound,
    bound_distances,
    grows,
    least_area,
    length,
    loaded,
    module,
    place,
    put,
    widest,
    width,
    worth,
)
from gearopt.optimise.jit_kernel import entry, inner

NODES = np.int64(64)  # cells of a node's layout between two looks at how many were spent


@entry
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
                least = min(least, length(d, m, ZERO, node))
            r = body[j + 1, 0] + wall
            area = least_area(body[j, 1] + wall, r, node[j, 0])
            if worth(d.aim, least, area, 2.0 * r) < cut:
                keep[p] = True
                found = min(found, node[j, 1])
            elif grows(d, j) and worth(d.aim, least, 4.0 * r * r, 2.0 * r) >= cut:
                break
    return found


@entry
def shorten(d, j, cut):
    """Drop bisected widths of a stage that are not below `cut` by themselves: they become inf."""
    node, body = np.zeros((d.kind.size, 3)), np.zeros((d.kind.size + 1, 4))
    for i in range(d.kind.size):
        node[i, 1] = d.widths[i]
    for p in range(d.start[j], d.start[j + 1]):
        for k in range(d.first[p], d.last[p] + 1):
            put(d, j, p, k, node, body)
            r = body[j + 1, 0] + d.gap[2]
            area = least_area(body[j, 1] + d.gap[2], r, node[j, 0])
            there = True  # widths rise with the cell
            for row in range(d.row[p], d.row[p + 1]):
                if there:
                    node[j, 1] = d.bisected[row, k]
                    least = math.inf
                    for m in range(d.slabs.size):
                        least = min(least, length(d, m, ZERO, node))
                    there = worth(d.aim, least, area, 2.0 * r) < cut
                if not there:
                    d.bisected[row, k] = math.inf


@entry
def fill(d, k, start, stop, rest):
    """Lower entries of the tables `rest` in place, of stages 0..k-1 in cells start to stop.

    Cells are of their total ratio; the tables hold inf before, and those of k - 1 are complete.
    rest.least[k, i, cell]: least width of stage i [mm]. rest.front[k, m, cell, bin]: least length
    [mm] that the stages add in slabs of their own, for wheels k - 1 of tip radius in a bin.
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
            if d.sizes.size > 0:
                radius = d.sizes[begin + p, q, 2]
            else:
                radius = d.modules[j, q] * (0.5 * d.z2[begin + p] / d.cosine[j] + d.addenda[j, 1])
            above = place(rest.edge[k], ZERO, rest.edge.shape[1], radius)
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


@inner
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


@inner
def taken(d, j, parent, choice, node, body):
    """Put the stages after j of a node; return the log ratios left to the others, their ratio."""
    left_low, left_high, ratio = d.log_low, d.log_high, 1.0
    for i in range(j + 1, choice.shape[0]):
        choice[i, 0], choice[i, 1] = parent[i, 0], parent[i, 1]
        put(d, i, choice[i, 0], choice[i, 1], node, body)
        left_low -= node[i, 2]
        left_high -= node[i, 2]
        ratio *= d.z2[choice[i, 0]] / d.z1[choice[i, 0]]
    return left_low, left_high, ratio


@inner
def weakest(d, j, p, ratio):
    """Least torque on stage j with pair p, before stages of this ratio."""
    torque = d.torque
    if j > 0:
        torque *= d.low_ratio / ratio * (d.z1[p] / d.z2[p]) * (1.0 - ALLOWANCE)
    return torque


@inner
def ground(j, stages, r, wall, node, body):
    """Least area around the gears of stage j, and of the next one."""
    area = least_area(body[j, 1] + wall, r, node[j, 0])
    if j + 1 < stages:
        area = max(area, least_area(r, body[j + 2, 0] + wall, node[j + 1, 0]))
    return area


@inner
def shortest(base, shared, b):
    """Least length of all orders of slabs with one more face width b."""
    least = math.inf
    for m in range(base.size):
        least = min(least, base[m] + max(b - shared[m], 0.0))
    return least


@inner
def record(child, choice, j):
    """Write the choices of stage j and those after it."""
    for i in range(j, choice.shape[0]):
        child[i, 0], child[i, 1] = choice[i, 0], choice[i, 1]


@entry
def expand(d, rest, j, parents, start, stop, cut, limit, children, bounds):
    """Children of nodes by a choice for stage j; one slice of about `limit` choices.

    parents (n, N, 2): pair and module of each chosen stage. start (2,): parent and pair to go on
    with (-1: the first that fits), moved on. stop: of the parents. What is worth `cut` is left out.
    children (m, N, 2), bounds (m,): written. Returns the number of both, and of choices looked at.
    """
    stages, shafts = parents.shape[1], parents.shape[1] + 1
    node, body = np.zeros((stages, 3)), np.zeros((shafts, 4))
    need = np.zeros((shafts, shafts))
    lengths, radius = np.empty(d.slabs.size), np.empty(d.slabs.size)
    choice, kept = np.zeros((stages, 2), np.int64), np.zeros(stages)
    base, shared = np.empty(d.slabs.size), np.empty(d.slabs.size)
    aim, wall, larger, count, looked = d.aim, d.gap[2], grows(d, j), 0, 0
    while start[0] < stop and looked < limit and count + d.modules.shape[1] <= bounds.size:
        left_low, left_high, ratio = taken(d, j, parents[start[0]], choice, node, body)
        end = place(d.log_ratio, d.start[j], d.start[j + 1], left_high + EDGE)
        if start[1] < 0:
            start[1] = d.start[j] if j else place(d.log_ratio, d.start[j], end, left_low - EDGE)
        if j < stages - 1:
            loaded(d, j + 1, choice, node)
        bases(d, j, node, base, shared)
        for i in range(stages):
            kept[i] = node[i, 1]
        pinion = body[j + 1, 1] if j + 1 < stages else 0.0
        code = bound_distances(d, j, choice)
        while start[1] < end and looked < limit and count + d.modules.shape[1] <= bounds.size:
            p = start[1]
            start[1] += 1
            looked += 1
            if not d.fits[j, code + d.stride[j] * d.distance[p]]:
                continue
            choice[j, 0] = p
            torque = weakest(d, j, p, ratio)
            for k in range(module(d, j, p, torque), d.last[p] + 1):
                b = width(d, j, p, k, torque)
                if b == math.inf:
                    continue
                choice[j, 1] = k
                put(d, j, p, k, node, body)
                for i in range(j + 1, stages):
                    node[i, 1] = kept[i]
                node[j, 1] = b
                least = shortest(base, shared, b)
                r = max(body[j + 1, 0], pinion) + wall
                area = ground(j, stages, r, wall, node, body)
                if worth(aim, least, area, 2.0 * r) >= cut:
                    if larger and worth(aim, least, 4.0 * r * r, 2.0 * r) >= cut:
                        break  # larger modules need more, too
                    continue
                if j == 0 and not loaded(d, ZERO, choice, node):
                    continue
                value = bound(d, rest, j, node, body, need, cut, lengths, radius)
                if value < cut:
                    record(children[count], choice, j)
                    bounds[count] = value
                    count += 1
        if start[1] >= end:
            start[0], start[1] = start[0] + 1, -1
    return count, looked


@entry
def sift(d, rest, chain, turns, first, nodes, start, levels, limits, alive, found):
    """Look for a layout below a value of the discs of each node, for one slice.

    levels = cut, better: what is not below cut is dropped, what is below better is looked for.
    limits = most, limit: cells for an arrangement of a node, and for the slice.
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
            bounds[0], count, used, least, floor = 0.0, ONE, 0, better, math.inf
            while count > 0 and used < most and least == better:
                count, least, _, floor, looked = branch(
                    chain, ZERO, cells, bounds, count, least, 0.0, floor, margin, NODES, theta
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
