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

EMPTY, POINT, HALVED = -1, 0, 1  # what a box is: without a point, left as it is, or in parts


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


@light
def copy(box, into):
    """Write one box (2, C) over another."""
    for j in range(box.shape[1]):
        into[0, j], into[1, j] = box[0, j], box[1, j]


@light
def share(sets, width, aim, lo, hi, low, high):
    """What a part [low, high] holds of a box [lo, hi]: of its points, and of its objective's width.

    It chooses a variable and proves nothing.
    """
    rest = hi[aim] - lo[aim]
    part = (high[aim] - low[aim]) / rest if 0.0 < rest < np.inf else 1.0
    for j in range(width):
        if hi[j] > lo[j]:
            listed = sets[0][j] == LISTED
            step = (hi[j] - lo[j]) / (sets[2][j] - sets[1][j]) if listed else 1.0
            part *= (high[j] - low[j] + step) / (hi[j] - lo[j] + step)
    return part


@light
def narrowed(form, aim, cutoff, sweeps, lo, hi, touched):
    """Narrow a box of which some columns were, below a cutoff; False: it holds no point."""
    relations, exponent, sums, sets = form
    for _ in range(sweeps):
        if not follow(relations, exponent, sums, sets, lo, hi, touched):
            return False
    return lo[aim] < cutoff


@light
def part(form, aim, cutoff, sweeps, box, j, side, end, into, touched):
    """Narrow the half of a box below (side 0) or above an end of a variable, elsewhere."""
    copy(box, into)
    into[1 - side, j] = end
    touched[:] = False
    touched[j] = True
    return narrowed(form, aim, cutoff, sweeps, into[0], into[1], touched)


@light
def widest(width, lo, hi, done):
    """The variable of the largest relative width that is not done, -1 where none is free."""
    wide, k = 0.0, -1
    for j in range(width):
        if hi[j] > lo[j] and not done[j]:
            part = (hi[j] - lo[j]) / max(abs(lo[j]), abs(hi[j]))
            if part > wide:
                wide, k = part, j
    return k


@light
def split(form, aim, cutoff, sweeps, trials, width, box, parts, touched, tried):
    """Halve a box (2, C) at that variable, of the widest ones, whose halves hold least (Lemma 79).

    trials: how many; a half that holds no point is cut off, in place. Returns EMPTY, POINT or
    HALVED, how many halves there were, and where the two are in parts (4, 2, C).
    """
    sets, lo, hi = form[3], box[0], box[1]
    count, spare, left, least = 0, 0, trials, np.inf
    tried[:] = False
    while True:
        j = widest(width, lo, hi, tried) if left > 0 else -1
        if j < 0 and least < np.inf:
            return HALVED, count, 2 - spare
        if j < 0:  # all are tried, and the last one was cut
            tried[:] = False
            j = widest(width, lo, hi, tried)
            if j < 0:
                return POINT, count, spare
        tried[j] = True
        a, b = parts[spare], parts[spare + 1]
        below, above = halves(sets, j, lo[j], hi[j])
        lower = part(form, aim, cutoff, sweeps, box, j, 0, below, a, touched)
        upper = part(form, aim, cutoff, sweeps, box, j, 1, above, b, touched)
        count, left = count + 2, left - 1
        if not (lower or upper):
            return EMPTY, count, spare
        if not (lower and upper):
            copy(a if lower else b, box)
            tried[j], left, least = False, trials, np.inf
            continue
        held = share(sets, width, aim, lo, hi, a[0], a[1])
        held += share(sets, width, aim, lo, hi, b[0], b[1])
        if held < least - 1e-9:  # equal ones: the widest
            least, spare = held, 2 - spare


@entry
def halved(form, root, aim, cutoff, sweeps, trials, low, high, bound, work, out):
    """Boxes that are left below a cutoff where boxes are halved several times (Lemma 79).

    form: relations, exponents, sums, sets of the columns; root (2, C): ends of the whole box.
    trials: variables that are tried at each. low, high (N, n): ends of the variables, bound (N,) of
    the objective. work: boxes (D+2, 2, C) for D times, how often each was halved (D+2,), parts (4,
    2, C), columns that were narrowed, variables tried (C,). out: low, high (N 2^D, n), bound,
    written from the start. Returns how many boxes are left, and how many halves there were.
    """
    boxes, levels, parts, touched, tried = work
    out_low, out_high, out_bound = out
    width, depth = low.shape[1], len(levels) - 2
    count = made = 0
    for i in range(len(low)):
        copy(root, boxes[0])
        lo, hi = boxes[0, 0], boxes[0, 1]
        lo[:width], hi[:width] = low[i], high[i]
        hi[aim] = min(hi[aim], cutoff)
        lo[aim] = max(lo[aim], bound[i])
        if not lo[aim] <= hi[aim] or not propagate(*form, lo, hi, sweeps, 0.05):
            continue
        levels[0], waiting = 0, 1
        while waiting:
            waiting -= 1
            box, level = boxes[waiting], levels[waiting]
            state = POINT
            if level < depth:
                state, some, k = split(
                    form, aim, cutoff, sweeps, trials, width, box, parts, touched, tried
                )
                made += some
            if state == HALVED:
                for side in range(2):
                    copy(parts[k + 1 - side], boxes[waiting + side])
                    levels[waiting + side] = level + 1
                waiting += 2
            elif state == POINT:
                out_low[count], out_high[count] = box[0, :width], box[1, :width]
                out_bound[count] = box[0, aim]
                count += 1
    return count, made
