"""Kernels on the chain of shafts: what a point measures, and what no point of a cell is below.

A chain is the NamedTuple of arrays of `chain.Chain`; theta (N,) are the link angles. Lengths in mm,
angles in rad. Of `math` they call what Python and machine code round alike (so not `hypot`):
uncompiled they give the same numbers.
"""

import math

import numpy as np

from gearopt.optimise.jit_kernel import inner

FULL = 2.0 * math.pi
MARGIN = 1e-12  # relative; far above the rounding of some ten sums and products of doubles
ROUNDING = 1e-9  # mm; what exact positions may seem to lack
# Integers for arguments: for a literal numba compiles a function once more, and all it calls.
NONE, ZERO, ONE = np.int64(-1), np.int64(0), np.int64(1)


@inner
def measured_at_angles(chain, m, theta, y, z):
    """Width, height, and violation [mm] (the sum of what is missing); y, z are filled in."""
    y[0] = z[0] = 0.0
    for i in range(theta.size):
        y[i + 1] = y[i] + chain.link[i] * math.cos(theta[i])
        z[i + 1] = z[i] + chain.link[i] * math.sin(theta[i])
    return measured_at_positions(chain, m, y, z)


@inner
def measured_at_positions(chain, m, y, z):
    """Width, height and violation of shafts at y, z."""
    count = y.size
    left = bottom = math.inf
    right = top = -math.inf
    short = 0.0
    for i in range(count):
        r = chain.reach[i]
        left, right = min(left, y[i] - r), max(right, y[i] + r)
        bottom, top = min(bottom, z[i] - r), max(top, z[i] + r)
        for j in range(i + 1, count):
            need = chain.apart[m, i, j]
            dy, dz = y[i] - y[j], z[i] - z[j]
            there = dy * dy + dz * dz
            if there < need * need:
                short += need - math.sqrt(there)
        short += max(0.0, chain.place[i, 0] - y[i]) + max(0.0, y[i] - chain.place[i, 1])
        short += max(0.0, chain.place[i, 2] - z[i]) + max(0.0, z[i] - chain.place[i, 3])
        for k in range(chain.keep.shape[0]):
            dy = max(chain.keep[k, 0] - y[i], y[i] - chain.keep[k, 1], 0.0)
            dz = max(chain.keep[k, 2] - z[i], z[i] - chain.keep[k, 3], 0.0)
            need = chain.keep_apart[m, k, i]
            there = dy * dy + dz * dz
            if there < need * need:
                short += need - math.sqrt(there)
    for k in range(1, chain.level.size):
        short += abs(z[chain.level[k]] - z[chain.level[0]])
    width, height = right - left, top - bottom
    short += max(0.0, width - chain.most[0]) + max(0.0, height - chain.most[1])
    short += max(0.0, chain.length[m] - chain.most[2])
    return width, height, short


@inner
def value(chain, m, width, height):
    """The objective: factor W^p H^q, or the longest side."""
    if chain.longest:
        return max(width, height, chain.factor[m])
    found = chain.factor[m]
    if chain.power[0] > 0.0:
        found *= width
    if chain.power[1] > 0.0:
        found *= height
    return found


@inner
def cosines(low, high):
    """Least and largest cosine on an interval, widened by MARGIN."""
    if high - low >= FULL:
        return -1.0, 1.0
    a, b = math.cos(low), math.cos(high)
    least, most = min(a, b) - MARGIN, max(a, b) + MARGIN
    if math.floor(high / FULL) != math.floor(low / FULL):
        most = 1.0
    if math.floor((high - math.pi) / FULL) != math.floor((low - math.pi) / FULL):
        least = -1.0
    return max(least, -1.0), min(most, 1.0)


@inner
def lowest(a, b, low, high):
    """Where a cos(t) + b sin(t) is least on an interval, and its value there."""
    t = math.atan2(b, a) + math.pi  # a minimum; bring it to the first one not below `low`
    t += FULL * math.ceil((low - t) / FULL)
    if t <= high:
        return t, -math.sqrt(a * a + b * b)
    first = a * math.cos(low) + b * math.sin(low)
    last = a * math.cos(high) + b * math.sin(high)
    return (low, first) if first < last else (high, last)


@inner
def excluded(chain, m, low, high, ly, hy, lz, hz):
    """Whether no point of a cell keeps the distances and places; fills in the intervals.

    ly[i, j] to hy[i, j] holds y_j - y_i of the whole cell, lz, hz the same of z; j > i.
    """
    links = low.size
    if chain.length[m] > chain.most[2] + ROUNDING:
        return True
    for i in range(links):
        if chain.apart[m, i, i + 1] > chain.link[i]:
            return True
        c0, c1 = cosines(low[i], high[i])
        s0, s1 = cosines(low[i] - 0.5 * math.pi, high[i] - 0.5 * math.pi)
        ly[i, i + 1], hy[i, i + 1] = chain.link[i] * c0, chain.link[i] * c1
        lz[i, i + 1], hz[i, i + 1] = chain.link[i] * s0, chain.link[i] * s1
    for span in range(2, links + 1):
        for i in range(links - span + 1):
            j = i + span
            ly[i, j], hy[i, j] = ly[i, j - 1] + ly[j - 1, j], hy[i, j - 1] + hy[j - 1, j]
            lz[i, j], hz[i, j] = lz[i, j - 1] + lz[j - 1, j], hz[i, j - 1] + hz[j - 1, j]
            need = chain.apart[m, i, j] * (1.0 - MARGIN)
            if need <= 0.0:
                continue
            y, z = max(-ly[i, j], hy[i, j]), max(-lz[i, j], hz[i, j])
            if y * y + z * z < need * need:
                return True
            if span == 2:  # exactly, by the angle between the two links
                a, b = chain.link[i], chain.link[i + 1]
                most = cosines(low[i + 1] - high[i], high[i + 1] - low[i])[1]
                if a * a + b * b + 2.0 * a * b * most < need * need:
                    return True
    return misplaced(chain, m, ly, hy, lz, hz)


@inner
def misplaced(chain, m, ly, hy, lz, hz):
    """Whether every point of a cell misses a given place, level, keep-out or largest side."""
    count = chain.reach.size
    slack = MARGIN * (1.0 + hy[0, count - 1] - ly[0, count - 1] + chain.reach[0])
    for i in range(count):
        if ly[0, i] > chain.place[i, 1] + slack or hy[0, i] < chain.place[i, 0] - slack:
            return True
        if lz[0, i] > chain.place[i, 3] + slack or hz[0, i] < chain.place[i, 2] - slack:
            return True
        for k in range(chain.keep.shape[0]):
            need = chain.keep_apart[m, k, i] - slack
            if need <= 0.0:
                continue
            y = max(chain.keep[k, 0] - ly[0, i], hy[0, i] - chain.keep[k, 1], 0.0)
            z = max(chain.keep[k, 2] - lz[0, i], hz[0, i] - chain.keep[k, 3], 0.0)
            if y * y + z * z < need * need:
                return True
    for k in range(1, chain.level.size):
        i, j = chain.level[k - 1], chain.level[k]
        if lz[i, j] > slack or hz[i, j] < -slack:
            return True
    return False


@inner
def sides(chain, ly, hy, lz, hz):
    """Bounds of width and height of every point of a cell: W low, W high, H low, H high."""
    w0 = w1 = h0 = h1 = 0.0
    count = chain.reach.size
    for i in range(count):
        r = 2.0 * chain.reach[i]
        w0, w1, h0, h1 = max(w0, r), max(w1, r), max(h0, r), max(h1, r)
        for j in range(i + 1, count):
            r = chain.reach[i] + chain.reach[j]
            w0 = max(w0, r + max(ly[i, j], -hy[i, j]))
            w1 = max(w1, r + max(hy[i, j], -ly[i, j]))
            h0 = max(h0, r + max(lz[i, j], -hz[i, j]))
            h1 = max(h1, r + max(hz[i, j], -lz[i, j]))
    return w0, w1, h0, h1


@inner
def widest(chain, y):
    """The pair of shafts (i <= j) that makes a side at y, the sign of y_j - y_i, and the side."""
    first = last = 0
    for i in range(1, y.size):
        if y[i] - chain.reach[i] < y[first] - chain.reach[first]:
            first = i
        if y[i] + chain.reach[i] > y[last] + chain.reach[last]:
            last = i
    side = y[last] + chain.reach[last] - y[first] + chain.reach[first]
    return min(first, last), max(first, last), 1.0 if last >= first else -1.0, side
