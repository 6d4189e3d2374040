"""Kernel of the sharp bound of a cell: a linear program chooses weights, intervals judge them.

Sides of the box, places and levels are sums over links of one sinusoid each, and so is, to second
order in the size of the cell, a distance that must be kept. Any weights >= 0 of such rows give a
valid bound: the least value of one sinusoid a link. The best weights are, to second order, those of
the linear program of the cell's middle, so that the bound converges with the square of its size.
"""

import math

import numpy as np

from gearopt.formulations.drive.layout.chain_kernel import MARGIN, NONE, ZERO, cosines, lowest
from gearopt.optimise.jit_kernel import inner

PIVOTS = 40  # of a linear program of some ten columns; more would be a cycle
PIVOT_TOLERANCE = 1e-12  # of a pivot, where the columns are of the order of the sides


@inner
def span(chain, low, high, i, j, p, q):
    """Least and largest p y + q z over a cell, y, z from shaft i to j; p, q a unit vector."""
    turn = math.atan2(q, p)
    least = most = 0.0
    for k in range(i, j):
        a, b = cosines(low[k] - turn, high[k] - turn)
        least += chain.link[k] * a
        most += chain.link[k] * b
    return least, most


@inner
def cut(chain, need, low, high, i, j, y, z):
    """A line u that axes i and j, `need` apart, keep apart along: u, and how far; 0 for none.

    |v| >= need, v = (y, z) from i to j, has u v >= sqrt(need^2 - s^2) wherever u v > 0 and v is at
    most s beside u.
    """
    size = math.sqrt(y * y + z * z)
    if size <= 0.0:
        return 0.0, 0.0, 0.0
    p, q = y / size, z / size
    ahead, _ = span(chain, low, high, i, j, p, q)
    right, left = span(chain, low, high, i, j, -q, p)
    s = max(-right, left) * (1.0 + MARGIN)
    if ahead <= 0.0 or ahead >= need or s >= need:
        return 0.0, 0.0, 0.0
    return p, q, math.sqrt(need * need - s * s) * (1.0 - MARGIN)


@inner
def put(row, ends, n, p, q, b, i, j, side):
    """Write row n; the number of rows then."""
    row[n, 0], row[n, 1], row[n, 2] = p, q, b
    ends[n, 0], ends[n, 1], ends[n, 2] = i, j, side
    return n + 1


@inner
def gather(chain, m, low, high, spans, edge, row, ends):
    """The rows of a cell: p y + q z from shaft i to j is at most b, or b more than a side.

    edge (2, 2): least and largest of the two sides (of one, where the longest counts). row (n, 3):
    p, q, b. ends (n, 3): i, j, the side it is below (-1: none). Returns their number.
    """
    ly, hy, lz, hz = spans
    count, n = chain.reach.size, ZERO
    for i in range(count):
        for j in range(i + 1, count):
            r = chain.reach[i] + chain.reach[j]
            for axis in range(2):
                least, most = (ly[i, j], hy[i, j]) if axis == 0 else (lz[i, j], hz[i, j])
                which = 0 if chain.longest else axis
                counts = chain.longest or chain.power[axis] > 0.0
                for sign in (1.0, -1.0):
                    far = r + (most if sign > 0.0 else -least)
                    p, q = (sign, 0.0) if axis == 0 else (0.0, sign)
                    if counts and far > edge[which, 0]:
                        n = put(row, ends, n, p, q, -r, i, j, which)
                    if far > chain.most[axis]:
                        n = put(row, ends, n, p, q, chain.most[axis] - r, i, j, NONE)
            need = chain.apart[m, i, j]
            y = max(ly[i, j], -hy[i, j], 0.0)
            z = max(lz[i, j], -hz[i, j], 0.0)
            if j > i + 1 and y * y + z * z < need * need:
                y, z = 0.5 * (ly[i, j] + hy[i, j]), 0.5 * (lz[i, j] + hz[i, j])
                p, q, b = cut(chain, need, low, high, i, j, y, z)
                if b > 0.0:
                    n = put(row, ends, n, -p, -q, -b, i, j, NONE)
    for i in range(1, count):
        for c in range(4):
            end = chain.place[i, c]
            least, most = (ly[0, i], hy[0, i]) if c < 2 else (lz[0, i], hz[0, i])
            if (c % 2 == 0 and least < end) or (c % 2 == 1 and most > end):
                sign = -1.0 if c % 2 == 0 else 1.0
                p, q = (sign, 0.0) if c < 2 else (0.0, sign)
                n = put(row, ends, n, p, q, sign * end, ZERO, i, NONE)
    for k in range(1, chain.level.size):
        i, j = chain.level[k - 1], chain.level[k]
        n = put(row, ends, n, 0.0, 1.0, 0.0, i, j, NONE)
        n = put(row, ends, n, 0.0, -1.0, 0.0, i, j, NONE)
    return n


@inner
def tableau(chain, low, high, edge, slope, row, ends, n, table, names):
    """Write the first tableau of `program`, of the slack basis."""
    links = low.size
    columns, rows = links + slope.size, n + links
    for r in range(rows + 1):
        for c in range(columns + 1):
            table[r, c] = 0.0
    for r in range(n):
        p, q, b = row[r, 0], row[r, 1], row[r, 2]
        i, j, side = ends[r, 0], ends[r, 1], ends[r, 2]
        start = -b
        for k in range(i, j):
            middle = 0.5 * (low[k] + high[k])
            across, up = chain.link[k] * math.cos(middle), chain.link[k] * math.sin(middle)
            tilt = (q * across - p * up) * (high[k] - low[k])
            start += p * across + q * up - 0.5 * tilt
            table[r, k] = -tilt
        if side >= 0:
            start -= edge[side, 0]
            table[r, links + side] = 1.0
        table[r, columns] = -start
    for k in range(links):
        table[n + k, k] = -1.0
        table[n + k, columns] = 1.0
    for c in range(slope.size):
        table[rows, links + c] = slope[c]
    for r in range(rows):
        names[columns + r] = r
    for c in range(columns):
        names[c] = rows + c


@inner
def pivot_exchange(table, rows, columns, out, into):
    """Exchange the basic variable of row `out` for the nonbasic one of column `into`, in place.

    table (rows + 1, columns + 1): each row gives a basic variable, the last the cost, as a linear
    form of the nonbasic ones, its constant last.
    """
    inverse = 1.0 / table[out, into]
    for c in range(columns + 1):
        table[out, c] *= -inverse
    table[out, into] = inverse
    for r in range(rows + 1):
        if r != out:
            factor = table[r, into]
            if factor != 0.0:
                for c in range(columns + 1):
                    if c != into:
                        table[r, c] += factor * table[out, c]
                table[r, into] = factor * inverse


@inner
def leaving(table, rows, columns):
    """Return the row farthest below zero, -1 if none is."""
    out, worst = -1, -1e-9
    for r in range(rows):
        if table[r, columns] < worst:
            out, worst = r, table[r, columns]
    return out


@inner
def entering(table, rows, columns, out):
    """Return the column that keeps all costs above zero in exchange for a row, -1 if none does."""
    into, least = -1, math.inf
    for c in range(columns):
        if table[out, c] > PIVOT_TOLERANCE and table[rows, c] < least * table[out, c]:
            into, least = c, table[rows, c] / table[out, c]
    return into


@inner
def program(chain, low, high, edge, slope, row, ends, n, table, names, weight, theta):
    """Weights of the rows by the dual simplex method on the rows' lines at the cell's middle.

    Columns are angles, from 0 to 1 across the cell, and sides above their least; all costs are >= 0
    so that the slack basis is dual feasible. Returns whether the program is feasible; if not, the
    weights are those of a contradiction.
    """
    links = low.size
    columns, rows = links + slope.size, n + links
    tableau(chain, low, high, edge, slope, row, ends, n, table, names)
    for r in range(n):
        weight[r] = 0.0
    for _ in range(PIVOTS):
        out = leaving(table, rows, columns)
        if out < 0:
            break
        into = entering(table, rows, columns, out)
        if into < 0:
            if names[columns + out] < n:
                weight[names[columns + out]] = 1.0
            for c in range(columns):
                if names[c] < n:
                    weight[names[c]] = max(0.0, -table[out, c])
            return False
        pivot_exchange(table, rows, columns, out, into)
        names[into], names[columns + out] = names[columns + out], names[into]
    for c in range(columns):
        if names[c] < n:
            weight[names[c]] = max(0.0, table[rows, c])
    for k in range(links):
        theta[k] = low[k]
    for r in range(rows):
        k = names[columns + r] - rows
        if 0 <= k < links:
            theta[k] += table[r, columns] * (high[k] - low[k])
    return True


@inner
def judged(chain, low, high, edge, slope, log, row, ends, n, weight, pull):
    """The bound that weights of rows give: the least of the weighted sum over cell and sides.

    pull (2, N): weights of cos and sin of each link, filled in.
    """
    links = low.size
    pull[:] = 0.0
    found = size = 0.0
    on = np.zeros(2)
    for r in range(n):
        if weight[r] > 0.0:
            p, q, b = row[r, 0], row[r, 1], row[r, 2]
            i, j, side = ends[r, 0], ends[r, 1], ends[r, 2]
            found -= weight[r] * b
            size += weight[r] * abs(b)
            if side >= 0:
                on[side] += weight[r]
            for k in range(i, j):
                pull[0, k] += weight[r] * p * chain.link[k]
                pull[1, k] += weight[r] * q * chain.link[k]
    for k in range(links):
        if pull[0, k] != 0.0 or pull[1, k] != 0.0:
            _, least = lowest(pull[0, k], pull[1, k], low[k], high[k])
            found += least
            size += abs(pull[0, k]) + abs(pull[1, k])
    for c in range(slope.size):
        a, b = edge[c, 0], edge[c, 1]
        if log and slope[c] == 0.0:
            continue
        if log:
            first, last = math.log(a) - on[c] * a, math.log(b) - on[c] * b
            size += abs(math.log(a)) + abs(math.log(b))
        else:
            first, last = (slope[c] - on[c]) * a, (slope[c] - on[c]) * b
        size += (on[c] + slope[c]) * b
        found += min(first, last)
    return found - MARGIN * size


@inner
def sharp(chain, m, low, high, spans, box, aim, room, pull, theta):
    """A bound of the objective over a cell, no more than `aim`, to which it is sharp.

    spans: the intervals of `excluded`. box: those of `sides`. room: scratch of `scratch`. Filled
    in: pull (2, N), the weights of cos and sin of each link, and theta (N,), where the linear
    program is least; `aim` itself also where nothing in the cell is feasible and below it.
    """
    row, ends, table, names, weight = room
    edge, slope = np.zeros((2, 2)), np.zeros(1 if chain.longest else 2)
    worth = aim / chain.factor[m] * (1.0 + MARGIN)  # longer sides are beyond `aim`
    if chain.longest:
        edge[0, 0] = max(box[0], box[2], chain.factor[m])
        edge[0, 1] = max(min(max(box[1], box[3]), aim * (1.0 + MARGIN)), edge[0, 0])
        slope[0] = 1.0
    else:
        for c in range(2):
            if chain.power[c] > 0.0:
                a = box[2 * c]
                other = box[2 - 2 * c] if chain.power[1 - c] > 0.0 else 1.0
                b = max(a, min(box[2 * c + 1], chain.most[c], worth / other))
                edge[c, 0], edge[c, 1] = a, b
                slope[c] = math.log(b / a) / (b - a) if b - a > 1e-9 * b else 1.0 / b
    n = gather(chain, m, low, high, spans, edge, row, ends)
    there = program(chain, low, high, edge, slope, row, ends, n, table, names, weight, theta)
    log = there and not chain.longest
    if not there:
        slope[:] = 0.0
    found = judged(chain, low, high, edge, slope, log, row, ends, n, weight, pull)
    if not there:
        return aim if found > 0.0 else 0.0
    if log:
        found = chain.factor[m] * math.exp(found) * (1.0 - 4.0 * MARGIN)
    return min(found, aim)


@inner
def scratch(links):
    """Room for the rows of a cell and their linear program."""
    most = 5 * links * (links + 1) + 6 * links
    return (
        np.zeros((most, 3)),
        np.zeros((most, 3), np.int64),
        np.zeros((most + links + 1, links + 3)),
        np.zeros(most + 2 * links + 2, np.int64),
        np.zeros(most),
    )
