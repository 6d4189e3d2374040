"""Boxes of whole and listed values: halved, narrowed and bounded by intervals, many in one call."""

import numpy as np

from gearopt.optimise.jit_kernel import entry, light
from gearopt.optimise.spatial.interval_kernel import (
    LINEAR,
    LISTED,
    backward,
    forward,
    in_domain,
    narrow,
    narrow_sum,
    propagate,
)


@light
def widest(lo, hi, count):
    """The variable of the largest relative width, -1 where all are fixed."""
    wide, k = 0.0, -1
    for j in range(count):
        if hi[j] > lo[j]:
            part = (hi[j] - lo[j]) / max(abs(lo[j]), abs(hi[j]))
            if part > wide:
                wide, k = part, j
    return k


@light
def halves(sets, j, low, high):
    """The last allowed value of the lower half of [low, high], the first of the upper one."""
    sort, first, last, values = sets
    if sort[j] != LISTED:
        below = np.floor(0.5 * (low + high))
        return below, below + 1.0
    a, b = first[j], last[j] - 1
    while values[a] < low:
        a += 1
    while values[b] > high:
        b -= 1
    middle = (a + b) // 2
    return values[middle], values[middle + 1]


@light
def moves(sums, r, touched):
    """Whether a column of a sum was narrowed."""
    start, index = sums[0], sums[1]
    for k in range(start[r], start[r + 1]):
        if touched[index[k]]:
            return True
    return False


@light
def follow_sum(sums, sets, r, lo, hi, touched):
    """Narrow the columns of a sum, and note which were; False where it cannot be its constant."""
    start, index = sums[0], sums[1]
    before = 0.0
    for k in range(start[r], start[r + 1]):
        before += hi[index[k]] - lo[index[k]]
    if not narrow_sum(sums, sets, r, lo, hi):
        return False
    after = 0.0
    for k in range(start[r], start[r + 1]):
        after += hi[index[k]] - lo[index[k]]
    if after != before:  # also where a width is infinite and the difference no number
        for k in range(start[r], start[r + 1]):
            touched[index[k]] = True
    return True


@light
def follow(relations, exponent, sums, sets, lo, hi, touched):
    """Sweep the relations of columns that were narrowed, both ways; False: it holds no point."""
    count = len(relations)
    for step in range(2 * count):
        r = step if step < count else 2 * count - 1 - step
        kind, w, u, v = relations[r, 0], relations[r, 1], relations[r, 2], relations[r, 3]
        if kind == LINEAR:
            if moves(sums, r, touched) and not follow_sum(sums, sets, r, lo, hi, touched):
                return False
            continue
        if not (touched[w] or touched[u] or v >= 0 and touched[v]):
            continue
        if step < count:
            a, b = lo[w], hi[w]
            if not in_domain(kind, sets, u, lo, hi):
                return False
            low, high = forward(kind, exponent[r], u, v, lo, hi)
            if not narrow(sets, lo, hi, w, low, high):
                return False
            if lo[w] > a or hi[w] < b:
                touched[w] = True
            continue
        a, b = lo[u], hi[u]
        c, d = (lo[v], hi[v]) if v >= 0 else (0.0, 0.0)
        if not backward(kind, exponent[r], w, u, v, sets, lo, hi):
            return False
        if lo[u] > a or hi[u] < b:
            touched[u] = True
        if v >= 0 and (lo[v] > c or hi[v] < d):
            touched[v] = True
    return True


@entry
def halved(relations, exponent, sums, sets, root, aim, cutoff, sweeps, low, high, bound, work, out):
    """Boxes that are left below a cutoff where boxes are halved several times (Lemma 79).

    low, high (N, n): ends of the variables, bound (N,) of the objective; root: ends of all columns
    (C,) of the whole box. work: ends (D+1, C) for D times, variables, sides, ends of the parts
    (D,), narrowed columns (C,). out: low, high (N 2^D, n), bound, written from the start. Returns
    how many boxes are left, and how many there were.
    """
    root_low, root_high = root
    lows, highs, chosen, sides, belows, aboves, touched = work
    out_low, out_high, out_bound = out
    width, depth = low.shape[1], len(chosen)
    count = made = 0
    for i in range(len(low)):
        lo, hi = lows[0], highs[0]
        lo[:] = root_low
        hi[:] = root_high
        for j in range(width):
            lo[j], hi[j] = low[i, j], high[i, j]
        hi[aim] = min(hi[aim], cutoff)
        lo[aim] = max(lo[aim], bound[i])
        if not lo[aim] <= hi[aim]:
            continue
        if not propagate(relations, exponent, sums, sets, lo, hi, sweeps, 0.05):
            continue
        level, arrived = 0, True
        while level >= 0:
            lo, hi = lows[level], highs[level]
            if arrived:
                k = widest(lo, hi, width) if level < depth else -1
                if k < 0:
                    for j in range(width):
                        out_low[count, j], out_high[count, j] = lo[j], hi[j]
                    out_bound[count] = lo[aim]
                    count += 1
                    level, arrived = level - 1, False
                    continue
                chosen[level], sides[level] = k, 0
                belows[level], aboves[level] = halves(sets, k, lo[k], hi[k])
            k, side = chosen[level], sides[level]
            if side == 2:
                level, arrived = level - 1, False
                continue
            sides[level] = side + 1
            made += 1
            next_lo, next_hi = lows[level + 1], highs[level + 1]
            next_lo[:] = lo
            next_hi[:] = hi
            if side == 0:
                next_hi[k] = belows[level]
            else:
                next_lo[k] = aboves[level]
            touched[:] = False
            touched[k] = True
            arrived = True
            for _ in range(sweeps):
                if arrived:
                    arrived = follow(relations, exponent, sums, sets, next_lo, next_hi, touched)
            if arrived and next_lo[aim] < cutoff:
                level += 1
            else:
                arrived = False
    return count, made
