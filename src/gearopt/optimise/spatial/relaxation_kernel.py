"""Linear rows that hold for all points of a box, and bounds that follow from any duals of them.

Rows (Lemma 76): McCormick's for products and quotients, chords and tangents of convex and concave
functions, with right-hand sides rounded outwards. Every relation has four slots (a sum one), so
that a basis of one box fits every other; a slot without a row is free. Bounds by Lemma 77 (Neumaier
and Shcherbina, Math. Program. 99, 2004).
"""

import math

from gearopt.optimise.jit_kernel import entry, inlined, light
from gearopt.optimise.spatial.interval_kernel import (
    ABS,
    ASIN,
    ATAN,
    COSINE,
    EXP,
    FLOOR,
    LEAST,
    LINEAR,
    LOG,
    MAXIMUM,
    MINIMUM,
    POWER,
    PRODUCT,
    QUOTIENT,
    ROOT,
    SINE,
    TANH,
    UNIT,
    down,
    may_be_infinite,
    narrow,
    times,
    up,
    value,
    wave,
)

SLOTS = 4
SLACK = 16.0 * UNIT  # of the terms of a tangent or chord
NEWTON = 60  # steps, each safe: any slope gives a row that holds
LARGE = 1e20  # an end beyond it makes no row
HUGE = 1e280  # a dual times an entry beyond it, or below its inverse, makes no bound


@inlined
def slope(kind, p, x):
    """Derivative of a function of one column."""
    if kind == POWER or kind == ROOT:
        return p * x ** (p - 1.0)
    if kind == EXP:
        return math.exp(x)
    if kind == LOG:
        return 1.0 / x
    if kind == SINE:
        return math.cos(x)
    if kind == COSINE:
        return -math.sin(x)
    if kind == TANH:
        return 1.0 - math.tanh(x) ** 2
    if kind == ATAN:
        return 1.0 / (1.0 + x * x)
    if kind == ASIN:
        return 1.0 / math.sqrt((1.0 - x) * (1.0 + x))
    return -1.0 if x < 0.0 else 1.0  # ABS


@inlined
def bend(kind, p, low, high):
    """Sort of curvature on [low, high]: 1 convex, -1 concave, 0 both or not defined throughout."""
    if kind == EXP or kind == ABS:
        return 1
    if kind == LOG:
        return -1
    if kind == ROOT:
        return -1 if 0.0 < p < 1.0 else 1
    if kind == SINE or kind == COSINE:
        least, most = wave(kind, low, high)
        return -1 if least >= 0.0 else 1 if most <= 0.0 else 0
    if kind == POWER:
        if p > 0.0 and p % 2.0 == 0.0:
            return 1
        if p > 0.0:
            return 1 if low >= 0.0 else -1 if high <= 0.0 else 0
        if low > 0.0:
            return 1
        return (1 if p % 2.0 == 0.0 else -1) if high < 0.0 else 0
    sign = 1 if kind == ASIN else -1
    return sign if low >= 0.0 else -sign if high <= 0.0 else 0


@light
def put(rows, slot, w, u, factor, low, high):
    """Write the row low <= w - factor u <= high into a slot."""
    start, count, index, entry_of, least, most = rows
    if not (abs(factor) < LARGE and (abs(low) < LARGE or abs(high) < LARGE)):
        return
    k = start[slot]
    index[k], index[k + 1] = w, u
    entry_of[k], entry_of[k + 1] = 1.0, -factor
    count[slot] = 2
    least[slot], most[slot] = low, high


@light
def chord(rows, slot, w, u, low, high, a, b, sign):
    """Chord above a convex function (sign 1) or below a concave one, of values a and b."""
    if not (high > low and abs(a) < LARGE and abs(b) < LARGE):
        return
    s = (b - a) / (high - low)
    one, two = a - s * low, b - s * high
    e = SLACK * (abs(a) + abs(b) + abs(s) * max(abs(low), abs(high))) + LEAST
    if sign > 0:
        put(rows, slot, w, u, s, -math.inf, max(one, two) + e)
    else:
        put(rows, slot, w, u, s, min(one, two) - e, math.inf)


@light
def tangent(rows, slot, kind, p, w, u, x, low, high, sign):
    """Tangent at x below a convex function (sign 1) or above a concave one."""
    f, s = value(kind, p, x), slope(kind, p, x)
    if not (abs(f) < LARGE and abs(s) < LARGE):
        return
    reach = abs(x) + (high - low)
    e = SLACK * (abs(f) + abs(s) * reach) + LEAST * (1.0 + reach)  # of a slope that underflows
    if sign > 0:
        put(rows, slot, w, u, s, f - s * x - e, math.inf)
    else:
        put(rows, slot, w, u, s, -math.inf, f - s * x + e)


@inlined
def touching(kind, p, low, high, x):
    """Points of three tangents: near both ends, and x kept between them."""
    first, last = low, high
    if kind == ROOT and low <= 0.0 and p < 1.0 or kind == LOG and low <= 0.0:
        first = low + 0.02 * (high - low)
    if kind == ASIN:
        first, last = max(low, -1.0 + 1e-6), min(high, 1.0 - 1e-6)
    width = last - first
    middle = x
    if not (first + 0.05 * width < x < last - 0.05 * width):
        positive = first > 0.0 and (kind == ROOT or kind == LOG or kind == POWER)
        middle = math.sqrt(first * last) if positive else 0.5 * (first + last)
    return first, middle, last


@light
def bent_rows(rows, slot, kind, p, w, u, low, high, x, sign):
    """Chord and three tangents of a function of one curvature."""
    first, middle, last = touching(kind, p, low, high, x)
    chord(rows, slot, w, u, low, high, value(kind, p, low), value(kind, p, high), sign)
    if high < math.inf and low > -math.inf:
        tangent(rows, slot + 1, kind, p, w, u, first, low, high, sign)
        tangent(rows, slot + 2, kind, p, w, u, last, low, high, sign)
        if high > low:
            tangent(rows, slot + 3, kind, p, w, u, middle, low, high, sign)


@light
def wavy_rows(rows, slot, kind, p, w, u, low, high):
    """Chord and tangent, moved by M width^2/8, of a function of curvature at most M in size."""
    most = 1.0 if kind == SINE or kind == COSINE else 0.77 if kind == TANH else 0.65
    width, middle = high - low, 0.5 * (low + high)
    if not (0.0 < width < 20.0 and max(abs(low), abs(high)) < 1e6):
        return
    a, b = value(kind, p, low), value(kind, p, high)
    s = (b - a) / width
    shift = most * width * width / 8.0 + SLACK * (2.0 + abs(s) * max(abs(low), abs(high)))
    one, two = a - s * low, b - s * high
    put(rows, slot, w, u, s, min(one, two) - shift, max(one, two) + shift)
    f, s = value(kind, p, middle), slope(kind, p, middle)
    shift = most * width * width / 8.0 + SLACK * (2.0 + abs(s) * (abs(middle) + width))
    put(rows, slot + 1, w, u, s, f - s * middle - shift, f - s * middle + shift)


@light
def odd_rows(rows, slot, n, w, u, low, high):
    """Rows of an odd power across 0: two slopes below, two above (as -(-u)^n)."""
    if not (abs(low**n) < LARGE and abs(high**n) < LARGE):
        return
    for side in range(2):
        far, near = (low, high) if side == 0 else (-high, -low)
        t = near
        for _ in range(
            NEWTON
        ):  # the tangent through the far end: n t^(n-1) (t - far) = t^n - far^n
            gap = (n - 1.0) * t**n - n * far * t ** (n - 1.0) + far**n
            t -= gap / (n * (n - 1.0) * t ** (n - 2.0) * (t - far))
        for k in range(2):
            s = n * near ** (n - 1.0)
            if k == 0:
                s = n * t ** (n - 1.0) if t < near else (near**n - far**n) / (near - far)
            x = min(near, (s / n) ** (1.0 / (n - 1.0)))
            e = SLACK * n * (abs(far**n) + near**n + s * max(-far, near)) + LEAST
            r = min(min(far**n - s * far, near**n - s * near), x**n - s * x) - e
            if side == 0:
                put(rows, slot + k, w, u, s, r, math.inf)
            else:
                put(rows, slot + 2 + k, w, u, s, -math.inf, -r)


@light
def put_product(rows, slot, w, u, v, fu, fv, low, high):
    """Write the row low <= w - fu u - fv v <= high into a slot."""
    start, count, index, entry_of, least, most = rows
    if not (abs(fu) < LARGE and abs(fv) < LARGE and (abs(low) < LARGE or abs(high) < LARGE)):
        return
    k = start[slot]
    index[k], index[k + 1], index[k + 2] = w, u, v
    entry_of[k], entry_of[k + 1], entry_of[k + 2] = 1.0, -fu, -fv
    count[slot] = 3
    least[slot], most[slot] = low, high


@light
def product_rows(rows, slot, w, u, v, lo, hi):
    """Rows of w = u v (McCormick, Math. Program. 10, 1976)."""
    a, b, c, d = lo[u], hi[u], lo[v], hi[v]
    put_product(rows, slot, w, u, v, c, a, down(-times(a, c), 1.0), math.inf)
    put_product(rows, slot + 1, w, u, v, d, b, down(-times(b, d), 1.0), math.inf)
    put_product(rows, slot + 2, w, u, v, c, b, -math.inf, up(-times(b, c), 1.0))
    put_product(rows, slot + 3, w, u, v, d, a, -math.inf, up(-times(a, d), 1.0))


@light
def extreme_rows(rows, slot, kind, w, u, v, lo, hi):
    """Rows of a maximum or a minimum, by t = u - v in [d, e]."""
    d, e = lo[u] - hi[v], hi[u] - lo[v]
    top = kind == MAXIMUM
    put(rows, slot, w, u, 1.0, 0.0 if top else -math.inf, math.inf if top else 0.0)
    put(rows, slot + 1, w, v, 1.0, 0.0 if top else -math.inf, math.inf if top else 0.0)
    if not (abs(d) < LARGE and abs(e) < LARGE):
        return
    steep = 1.0 if d >= 0.0 else 0.0 if e <= 0.0 else e / (e - d)
    s = math.floor(steep * 1048576.0) / 1048576.0  # so that 1 - s is exact
    if not top:
        s = 1.0 - s
    r = max(max(d, 0.0) - s * d, max(e, 0.0) - s * e)
    if not top:
        r = max(s * d - min(d, 0.0), s * e - min(e, 0.0))
    r += SLACK * (abs(d) + abs(e) + abs(lo[u]) + abs(hi[u]) + abs(lo[v]) + abs(hi[v]))
    low, high = (-math.inf, r) if top else (-r, math.inf)
    put_product(rows, slot + 2, w, u, v, s, 1.0 - s, low, high)


@light
def sum_row(rows, slot, sums, r, lo, hi):
    """Row of a sum; what its factors may be off by is charged over the box."""
    start, count, index, entry_of, least, most = rows
    first, column, factor, error, constant, doubt = sums
    k, e = start[slot], doubt[r]
    for i in range(first[r], first[r + 1]):
        j = column[i]
        index[k], entry_of[k] = j, factor[i]
        if error[i] > 0.0:
            e += 1.01 * error[i] * max(abs(lo[j]), abs(hi[j]))
        k += 1
    count[slot] = k - start[slot] if e < LARGE else 0
    least[slot], most[slot] = (
        (constant[r], constant[r])
        if e == 0.0
        else (
            down(constant[r] - e, 2.0),
            up(constant[r] + e, 2.0),
        )
    )


@entry
def fill(relations, exponent, sums, lo, hi, at, rows):
    """Write the rows of a box (C,) into their slots; at (C,): where the third tangents touch.

    rows: start (m+1,), count (m,), index, entry (E,), least, most (m,).
    """
    start, count, index, entry_of, least, most = rows
    for i in range(len(count)):
        count[i] = 0
        least[i], most[i] = -math.inf, math.inf
    slot = 0
    for r in range(len(relations)):
        kind, w, u, v = relations[r, 0], relations[r, 1], relations[r, 2], relations[r, 3]
        if kind == LINEAR:
            sum_row(rows, slot, sums, r, lo, hi)
            slot += 1
            continue
        if kind == PRODUCT:
            product_rows(rows, slot, w, u, v, lo, hi)
        elif kind == QUOTIENT:
            if not may_be_infinite(kind, exponent[r], u, v, lo, hi):
                product_rows(rows, slot, u, w, v, lo, hi)
        elif kind == MAXIMUM or kind == MINIMUM:
            extreme_rows(rows, slot, kind, w, u, v, lo, hi)
        elif kind == FLOOR:
            put(rows, slot, w, u, 1.0, -1.0, 0.0)
        else:
            p, low, high = exponent[r], lo[u], hi[u]
            sign = bend(kind, p, low, high)
            if sign != 0:
                bent_rows(rows, slot, kind, p, w, u, low, high, at[u], sign)
            elif kind == POWER and p > 0.0:
                odd_rows(rows, slot, p, w, u, low, high)
            elif kind == SINE or kind == COSINE or kind == TANH or kind == ATAN:
                wavy_rows(rows, slot, kind, p, w, u, low, high)
        slot += SLOTS


@light
def moderate(rows, i, y):
    """Whether a row's dual times its entries neither underflows nor overflows."""
    start, count, index, entry_of, least, most = rows
    for k in range(start[i], start[i] + count[i]):
        if entry_of[k] != 0.0 and not 1.0 / HUGE < abs(y * entry_of[k]) < HUGE:
            return False
    return True


@entry
def safe_bound(rows, y, aim, sign, lo, hi, slopes, doubts):
    """Bound from below of sign times column aim (0 where aim < 0) over the rows and the box.

    y (m,): any duals. slopes, doubts (C,): reduced costs and by how much they may be off.
    """
    start, count, index, entry_of, least, most = rows
    slopes[:] = 0.0
    doubts[:] = 0.0
    if aim >= 0:
        slopes[aim], doubts[aim] = sign, abs(sign)
    total = size = 0.0
    for i in range(len(count)):
        if count[i] == 0 or not abs(y[i]) < LARGE:
            continue
        end = least[i] if y[i] > 0.0 else most[i]
        if y[i] == 0.0 or abs(end) == math.inf or not moderate(rows, i, y[i]):
            continue
        total += y[i] * end
        size += abs(y[i] * end)
        for k in range(start[i], start[i] + count[i]):
            move = y[i] * entry_of[k]
            slopes[index[k]] -= move
            doubts[index[k]] += abs(move)
    spacing = (len(count) + 4.0) * UNIT
    for j in range(len(lo)):
        if doubts[j] == 0.0:
            continue
        doubts[j] *= spacing
        part = math.inf
        for s in (slopes[j] - doubts[j], slopes[j] + doubts[j]):
            part = min(part, min(times(s, lo[j]), times(s, hi[j])))
        if part == -math.inf:
            return -math.inf
        total += part
        size += abs(part)
    total -= (len(count) + len(lo) + 4.0) * (UNIT * size + LEAST)
    return total if total == total else -math.inf


@entry
def reduce(sets, slopes, doubts, bound, cutoff, lo, hi):
    """Narrow columns by reduced costs (Lemma 77): beyond the new ends the objective is >= cutoff.

    False where nothing is left.
    """
    room = up(cutoff - bound, 2.0)
    if not 0.0 <= room < math.inf:
        return True
    for j in range(len(lo)):
        least, most = slopes[j] - doubts[j], slopes[j] + doubts[j]
        low, high = -math.inf, math.inf
        if least > 0.0 and lo[j] > -math.inf:
            high = up(lo[j] + up(ratio(room, least), 3.0), 2.0)
        elif most < 0.0 and hi[j] < math.inf:
            low = down(hi[j] - up(ratio(room, -most), 3.0), 2.0)
        if not narrow(sets, lo, hi, j, low, high):
            return False
    return True


@inlined
def ratio(a, b):
    """Quotient that may be infinite."""
    return a / b


@entry
def scale(rows, lo, hi, shift, unit, factor, out):
    """Linear program of a box in units of its widths: x = shift + unit x'; rows of largest entry 1.

    factor (m,): of the rows. out: start (m+1,) int32, index int32, entry (E,), least, most (m,),
    lower, upper (C,). Returns the number of entries.
    """
    start, count, index, entry_of, least, most = rows
    first, column, number, below_of, above_of, lower, upper = out
    for j in range(len(lo)):
        low, high = lo[j], hi[j]
        width = high - low
        shift[j] = low if low > -math.inf else high if high < math.inf else 0.0
        size = width if 0.0 < width < math.inf else max(1.0, abs(shift[j]))
        unit[j] = 2.0 ** math.ceil(math.log2(min(max(size, 1e-300), 1e300)))
        lower[j], upper[j] = (low - shift[j]) / unit[j], (high - shift[j]) / unit[j]
    k = 0
    for i in range(len(count)):
        first[i] = k
        move = largest = 0.0
        for e in range(start[i], start[i] + count[i]):
            j = index[e]
            move += entry_of[e] * shift[j]
            largest = max(largest, abs(entry_of[e]) * unit[j])
        factor[i] = 2.0 ** -math.ceil(math.log2(largest)) if 0.0 < largest < math.inf else 1.0
        for e in range(start[i], start[i] + count[i]):
            number[k] = entry_of[e] * unit[index[e]] * factor[i]
            column[k] = index[e]
            if abs(number[k]) > 1e-9:
                k += 1
        below_of[i], above_of[i] = (least[i] - move) * factor[i], (most[i] - move) * factor[i]
    first[len(count)] = k
    return k


@inlined
def misfit(kind, p, w, u, v, x):
    """How far the value of an operation is from its column at a point."""
    if kind == PRODUCT:
        return abs(x[u] * x[v] - x[w])
    if kind == QUOTIENT:
        return abs(x[u] - x[w] * x[v])
    if kind == MAXIMUM:
        return abs(max(x[u], x[v]) - x[w])
    if kind == MINIMUM:
        return abs(min(x[u], x[v]) - x[w])
    return abs(value(kind, p, x[u]) - x[w])


@entry
def scores(relations, exponent, below_of, x, y, lo, hi, root, score):
    """Errors of the relations at x, weighted with their duals y, summed over the variables below.

    below_of (C, n): the variables that a column depends on; root (n,): widths at the root.
    """
    score[:] = 0.0
    slot = 0
    for r in range(len(relations)):
        kind, w, u, v = relations[r, 0], relations[r, 1], relations[r, 2], relations[r, 3]
        if kind == LINEAR:
            slot += 1
            continue
        weight = 1e-12
        for i in range(slot, slot + SLOTS):
            weight = max(weight, abs(y[i]))
        slot += SLOTS
        error = misfit(kind, exponent[r], w, u, v, x)
        if not error < LARGE:
            error = LARGE
        for j in range(len(score)):
            if below_of[w, j] and hi[j] > lo[j]:
                part = (hi[j] - lo[j]) / root[j] if root[j] < math.inf else 1.0
                score[j] += error * weight * part


@entry
def cut(sets, lo, hi, j, low, high):
    """Cut one column to [low, high]; False where nothing is left."""
    return narrow(sets, lo, hi, j, low, high)
