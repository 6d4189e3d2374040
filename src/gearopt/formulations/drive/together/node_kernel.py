"""Kernels on nodes: what the chosen stages and the least of all others make of a gearbox.

A drive is the NamedTuple of arrays `tables.Drive`; a node has chosen a pair and a module for the
stages `first` and after it. Whatever is not chosen yet counts with the least it can be, so every
value here is a lower bound. node (N, 3): centre distance, face width and log ratio of a stage; body
(N+1, 4): radii of wheel, pinion, shaft and bearing on a shaft, 0 if there is none. Lengths in mm,
torques in N mm; p indexes tooth pairs, k modules of a stage, m arrangements of the slabs.
"""

import math

from numba import njit

from gearopt.formulations.drive.layout.chain_kernel import MARGIN
from gearopt.optimise.jit_kernel import inner

ALLOWANCE = 1e-12  # a stress utilisation this little above 1 is rounding, as in sizing
EDGE = 1e-9  # cells and ratio windows overlap by this much in log ratio
SAFE = 1.0 - 1e-11  # a lower bound times this is one in spite of rounding


@njit(cache=True, inline="always")
def module(d, j, p, torque):
    """Least module (index) with which a pair may carry a torque; beyond d.last[p] if none does."""
    k = d.first[p]
    if d.kind[j] < 3:
        needed = d.need[p] * (torque * (1.0 - ALLOWANCE)) ** d.exponent[j]
        while k <= d.last[p] and d.modules[j, k] < needed:
            k += 1
    return k


@njit(cache=True, inline="always")
def width(d, j, p, k, torque):
    """Least face width for a torque, with a module of `module`; inf if none carries it."""
    if d.load.size == 0:
        cell = int(max(math.log(torque / d.torque) - EDGE, 0.0) / d.step) - d.cell[p]
        return d.bisected[min(d.row[p] + max(cell, 0), d.row[p + 1] - 1), k]
    m = d.modules[j, k]
    if d.kind[j] == 2:
        return d.given[j]
    diameter = m * d.z1[p] / d.cosine[j]
    if d.kind[j] == 0:
        return d.high[j] * diameter
    load = d.load[p] * torque / (m * m)
    if d.kind[j] == 1:
        return min(max(d.low[j] * diameter, load), d.high[j] * diameter)
    count = max(math.ceil(load / d.given[j] * (1.0 - ALLOWANCE)), d.least_steps[k, p])
    return count * d.given[j] if count <= d.most_steps[k, p] else math.inf


@inner
def least_area(r0, r1, a):
    """Least W H of a box around two discs whose centres are `a` (or more) apart.

    On 0..45 degrees W H falls until the larger disc no longer fills the height, then grows.
    """
    big = 2.0 * max(r0, r1)
    rise = big - r0 - r1
    if 2.0 * rise * rise >= a * a:
        return big * big
    return big * (r0 + r1 + math.sqrt(a * a - rise * rise))


@inner
def worth(aim, length, area, big):
    """Least objective of boxes of a length, W H >= area and W, H >= big.

    aim (8,): most width, height and length; constant and factor of the length; exponents; 1 for the
    longest side. It is `Drive.aim`: few arguments keep the innermost loop fast. Rounding makes no
    box too large that is just as large as it may be.
    """
    if big * SAFE > min(aim[0], aim[1]) or length * SAFE > aim[2]:
        return math.inf
    if aim[7] > 0.0:
        return max(big, math.sqrt(area), length, aim[3]) * SAFE
    found = (aim[3] + aim[4] * length) * SAFE
    if aim[5] > 0.0 and aim[6] > 0.0:
        return found * area
    return found * big if aim[5] > 0.0 or aim[6] > 0.0 else found


@njit(cache=True, inline="always")
def put(d, j, p, k, node, body):
    """Set a stage of a node: node[j] = centre distance, tip radii, width (unset), log ratio."""
    node[j, 2] = d.log_ratio[p]
    if d.sizes.size > 0:
        node[j, 0], body[j, 1] = d.sizes[p, k, 0], d.sizes[p, k, 1]
        body[j + 1, 0] = d.sizes[p, k, 2]
        return
    half = 0.5 * d.modules[j, k] / d.cosine[j]
    m = d.modules[j, k]
    node[j, 0] = half * (d.z1[p] + d.z2[p])
    body[j, 1] = half * d.z1[p] + m * d.addenda[j, 0]
    body[j + 1, 0] = half * d.z2[p] + m * d.addenda[j, 1]


@inner
def bound_distances(d, j, choice):
    """Number of the given distances of the stages after j of a node, for `Drive.fits`."""
    code = 0
    for i in range(j + 1, choice.shape[0]):
        code += d.stride[i] * d.distance[choice[i, 0]]
    return code


@inner
def place(sorted_values, start, stop, value):
    """First index from start to stop whose value is not below a value; stop if there is none."""
    while start < stop:
        middle = (start + stop) // 2
        if sorted_values[middle] < value:
            start = middle + 1
        else:
            stop = middle
    return start


@inner
def widest(body, x):
    """Radius of the largest body on a shaft."""
    return max(max(body[x, 0], body[x, 1]), max(body[x, 2], body[x, 3]))


@inner
def onto(d, first, node, body):
    """Shafts and bearings of a node by the least torque they carry."""
    log_ratio = d.log_low
    for x in range(node.shape[0], first - 1, -1):
        cell = min(max(int((log_ratio - EDGE) / d.delta), 0), d.shaft.shape[1] - 1)
        body[x, 2], body[x, 3] = d.shaft[x, cell], d.bearing[x, cell]
        if x > first:
            log_ratio -= node[x - 1, 2]
    body[first, 0] = 0.0
    return log_ratio


@inner
def loaded(d, first, choice, node):
    """Set the face widths of a node; False if a stage cannot carry its least torque.

    With all stages chosen the torques are exact, otherwise those of the least total ratio.
    """
    stages = node.shape[0]
    torque = d.torque
    if first > 0:
        torque *= d.low_ratio
        for j in range(first, stages):
            torque /= d.z2[choice[j, 0]] / d.z1[choice[j, 0]]
        torque *= 1.0 - ALLOWANCE
    for j in range(first, stages):
        node[j, 1] = math.inf
        if choice[j, 1] >= module(d, j, choice[j, 0], torque):
            node[j, 1] = width(d, j, choice[j, 0], choice[j, 1], torque)
        if node[j, 1] == math.inf:
            return False
        torque *= d.z2[choice[j, 0]] / d.z1[choice[j, 0]]
    return True


@inner
def apart(d, m, first, node, body, found):
    """Least distances of the axes of a node; False if its links cannot hold them apart."""
    shafts = body.shape[0]
    for x in range(first, shafts):
        there = 0.0
        for y in range(x + 1, shafts):
            there += node[y - 1, 0]
            need = 0.0
            for s in range(4):
                if body[x, s] <= 0.0:
                    continue
                for t in range(4):
                    if d.faces[m, x, s, y, t] > 0 and body[y, t] > 0.0:
                        gap = d.gap[0] if s < 2 and t < 2 else d.gap[1]
                        need = max(need, body[x, s] + body[y, t] + gap)
            if x == 0 and y == shafts - 1 and d.motor > 0.0:
                need = max(need, d.motor + body[y, 2] + d.gap[1])
            found[x, y] = found[y, x] = need
            if there < need * (1.0 - MARGIN):
                return False
    return True


@inner
def length(d, m, first, node):
    """Length of the box with the stages of a node; others add nothing but their slabs' gaps."""
    found = d.ends + d.gap[3] * (d.slabs[m] - 1)
    for s in range(d.slabs[m]):
        own = 0.0
        for j in range(first, node.shape[0]):
            if d.slab_of[m, j] == s:
                own = max(own, node[j, 1])
        found += own
    return found


@inner
def bound(d, rest, first, node, body, need, cut, lengths, radius):
    """Lower bound of all that a node leads to, as far as it is below `cut`.

    lengths (M,), radius (M,): least length and least radius on shaft `first` that are left in each
    arrangement; the length is inf where none is.
    """
    shafts = body.shape[0]
    low = onto(d, first, node, body)
    cell = int(max(low - EDGE, 0.0) / d.delta)
    best = math.inf
    for m in range(d.slabs.size):
        lengths[m], radius[m] = math.inf, 0.0
        if not apart(d, m, first, node, body, need):
            continue
        area = big = 0.0
        for x in range(first + 1, shafts):
            r = widest(body, x) + d.gap[2]
            big = max(big, 2.0 * r)
            for y in range(x + 1, shafts):
                a = node[x, 0] if y == x + 1 else need[x, y]
                area = max(area, least_area(r, widest(body, y) + d.gap[2], a))
        own = widest(body, first)
        base = length(d, m, first, node)
        bins = 1 if first == 0 else rest.edge.shape[1]
        for i in range(bins):
            wheel = 0.0 if first == 0 else rest.edge[first, i]
            more = 0.0 if first == 0 else rest.front[first, m, cell, i]
            if more == math.inf:
                continue
            r = max(own, wheel) + d.gap[2]
            wide = area
            for y in range(first + 1, shafts):
                a = node[first, 0] if y == first + 1 else need[first, y]
                wide = max(wide, least_area(r, widest(body, y) + d.gap[2], a))
            value = worth(d.aim, base + more, wide, max(big, 2.0 * r))
            best = min(best, value)
            if value < cut:
                if lengths[m] == math.inf:
                    radius[m] = r
                lengths[m] = min(lengths[m], base + more)
                radius[m] = min(radius[m], r)
    return best


@njit(cache=True, inline="always")
def grows(d, j):
    """Whether a larger module only makes the wheel and the width larger."""
    return d.sizes.size == 0 and (d.kind[j] == 0 or d.kind[j] == 2)


@inner
def bases(d, j, node, base, shared):
    """Least length without stage j, and what its slab is wide anyhow, in each arrangement (M,)."""
    for m in range(base.size):
        node[j, 1] = 0.0
        base[m] = length(d, m, j, node) + d.others[m, j]
        shared[m] = 0.0
        for i in range(j + 1, node.shape[0]):
            if d.slab_of[m, i] == d.slab_of[m, j]:
                shared[m] = max(shared[m], node[i, 1])
