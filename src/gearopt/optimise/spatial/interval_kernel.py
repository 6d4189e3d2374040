"""Intervals of the columns of a text, rounded outwards, and their propagation (Lemmas 74 and 75).

A relation is `kind, w, u, v` with an exponent p: w = op(u, v), or a sum of columns that is a
constant. p of a quotient and v of a power say what their values are at 0 (`opens`). Sums, products
and quotients go outwards by more than one unit in the last place, library functions, taken as right
to two, by four or more. Propagation (Messine, RAIRO 38, 2004) narrows w by u and v in the order of
the text, and u and v by w in reverse order.
"""

import math

import numpy as np

from gearopt.optimise.jit_kernel import entry, inlined, light

LINEAR, PRODUCT, QUOTIENT, POWER, ROOT, EXP, LOG, SINE, COSINE, TANH, ATAN, ASIN = range(12)
ABS, MAXIMUM, MINIMUM, FLOOR = range(12, 16)
CONTINUOUS, WHOLE, LISTED = 0, 1, 2
CLOSED, OPEN, UNSIGNED = 0, 1, 2
UNIT = 2.3e-16  # more than the spacing of doubles, relative
LIBRARY = 4.0  # such units for a function of the C library
LEAST = 1e-320  # added to what is not 0, as small numbers have a spacing of their own
BIGGEST = 1.7e308
WHOLE_SLACK = 1e-9  # by which an end of a whole number is rounded outwards before inwards
TURNS = 1e7  # angles beyond it have no range but [-1, 1]
PERIOD = 2.0 * math.pi
ANGLE_SLACK = 1e-8  # by which an extremum of a sine may lie outside and still counts


@inlined
def down(x, units):
    """A double below x by so many units; 0 is exact."""
    if x == math.inf:
        return BIGGEST
    return x if x == 0.0 else x - (abs(x) * (units * UNIT) + LEAST)


@inlined
def up(x, units):
    """A double above x by so many units; 0 is exact."""
    if x == -math.inf:
        return -BIGGEST
    return x if x == 0.0 else x + (abs(x) * (units * UNIT) + LEAST)


@inlined
def lifted(y, x):
    """A value that underflowed to 0 at x, which is not 0, off it: 0 is exact, this is not."""
    return y if y != 0.0 or x == 0.0 else math.copysign(LEAST, y)


@inlined
def times(a, b):
    """Product of two ends, 0 times infinity being 0."""
    return 0.0 if a == 0.0 or b == 0.0 else lifted(a * b, a)


@inlined
def product(a, b, c, d):
    """Interval [a, b] times [c, d]."""
    p, q, r, s = times(a, c), times(a, d), times(b, c), times(b, d)
    return down(min(min(p, q), min(r, s)), 1.0), up(max(max(p, q), max(r, s)), 1.0)


@inlined
def quotient(a, b, c, d):
    """Interval [a, b] through [c, d], one-sided where 0 is an end of that."""
    if c > 0.0 or d < 0.0:
        return product(a, b, down(1.0 / d, 1.0), up(1.0 / c, 1.0))
    low, high = -math.inf, math.inf
    if c == 0.0 and d > 0.0:
        if a >= 0.0:
            low = down(a / d, 1.0)
        elif b <= 0.0:
            high = up(b / d, 1.0)
    elif d == 0.0 and c < 0.0:
        if a >= 0.0:
            high = up(a / c, 1.0)
        elif b <= 0.0:
            low = down(b / c, 1.0)
    return low, high


@inlined
def value(kind, p, x):
    """Function of one column at x, as the library gives it."""
    y = x
    if kind == POWER:
        y = x**p
    elif kind == ROOT:
        y = x**p if x > 0.0 else (0.0 if p > 0.0 else math.inf)
    elif kind == EXP:
        y = math.exp(x)
    elif kind == LOG:
        y = math.log(x) if x > 0.0 else -math.inf
    elif kind == SINE:
        y = math.sin(x)
    elif kind == COSINE:
        y = math.cos(x)
    elif kind == TANH:
        y = math.tanh(x)
    elif kind == ATAN:
        y = math.atan(x)
    elif kind == ASIN:
        y = math.asin(min(1.0, max(-1.0, x)))
    elif kind == ABS:
        y = abs(x)
    elif kind == FLOOR:
        y = np.floor(x)  # a double: numba's math.floor is a 64 bit integer
    return y


@inlined
def wave(kind, low, high):
    """Range of a sine or a cosine."""
    if not high - low < PERIOD or abs(low) > TURNS or abs(high) > TURNS:
        return -1.0, 1.0
    a, b = value(kind, 0.0, low), value(kind, 0.0, high)
    least, most = down(min(a, b), LIBRARY), up(max(a, b), LIBRARY)
    crest = 0.0 if kind == COSINE else 0.5 * math.pi
    if PERIOD * math.ceil((low - crest - ANGLE_SLACK) / PERIOD) + crest <= high + ANGLE_SLACK:
        most = 1.0
    trough = crest + math.pi
    if PERIOD * math.ceil((low - trough - ANGLE_SLACK) / PERIOD) + trough <= high + ANGLE_SLACK:
        least = -1.0
    return max(-1.0, least), min(1.0, most)


@inlined
def power(n, low, high):
    """Range of a whole power n, not 0, of [low, high]."""
    even = n % 2.0 == 0.0
    a, b = lifted(low**n, low), lifted(high**n, high)
    if n > 0.0:
        if not even or low >= 0.0:
            return down(a, LIBRARY), up(b, LIBRARY)
        if high <= 0.0:
            return down(b, LIBRARY), up(a, LIBRARY)
        return 0.0, up(max(a, b), LIBRARY)
    if low > 0.0:
        return down(b, LIBRARY), up(a, LIBRARY)
    if high < 0.0:
        return (down(a, LIBRARY), up(b, LIBRARY)) if even else (down(b, LIBRARY), up(a, LIBRARY))
    if even:
        return down(max(-low, high) ** n, LIBRARY), math.inf
    if low == 0.0:
        return down(b, LIBRARY), math.inf
    return -math.inf, (up(a, LIBRARY) if high == 0.0 else math.inf)


@inlined
def image(kind, p, low, high):
    """Range of a function of one column over [low, high], its domain."""
    if kind == POWER:
        return power(p, low, high)
    if kind == SINE or kind == COSINE:
        return wave(kind, low, high)
    a, b = value(kind, p, low), value(kind, p, high)
    if kind == FLOOR:
        return a, b
    if kind == ABS:
        return (0.0 if low < 0.0 < high else min(a, b)), max(a, b)
    if kind == ROOT or kind == EXP:
        a, b = lifted(a, low), lifted(b, high)
    if kind == ROOT and p < 0.0:
        a, b = b, a
    a, b = down(a, LIBRARY), up(b, LIBRARY)
    if kind == EXP:
        a = max(a, 0.0)
    elif kind == TANH:
        a, b = max(a, -1.0), min(b, 1.0)
    return a, b


@inlined
def root_down(x, p):
    """x**(1/p) from below; the exponent is rounded, too."""
    return down(x ** (1.0 / p), LIBRARY + 1.0 + abs(math.log(x) / p)) if x > 0.0 else 0.0


@inlined
def root_up(x, p):
    """x**(1/p) from above."""
    if x == math.inf:
        return math.inf
    return up(x ** (1.0 / p), LIBRARY + 1.0 + abs(math.log(x) / p)) if x > 0.0 else 0.0


@inlined
def inverse_power(p, low, high, a, b):
    """Interval of u in [low, high] with u**p in [a, b], p whole or u at least 0."""
    even = p % 2.0 == 0.0
    if p < 0.0:  # of 1/w
        if a >= 0.0:
            c = 0.0 if b == math.inf else down(1.0 / b, 1.0)
            a, b = c, (math.inf if a == 0.0 else up(1.0 / a, 1.0))
        elif b <= 0.0:
            c = 0.0 if a == -math.inf else up(1.0 / a, 1.0)
            b, a = c, (-math.inf if b == 0.0 else down(1.0 / b, 1.0))
        else:
            return low, high
        p = -p
    if p % 1.0 != 0.0 or even:
        if b < 0.0:
            return 1.0, 0.0
        most, least = root_up(b, p), root_down(a, p)
        if p % 1.0 != 0.0:
            return least, most
        return (least if low > -least else -most), (-least if high < least else most)
    least = root_down(a, p) if a >= 0.0 else -root_up(-a, p)
    most = root_up(b, p) if b >= 0.0 else -root_down(-b, p)
    return least, most


@inlined
def inverse_wave(kind, low, high, a, b):
    """Interval of u in [low, high] with sine or cosine in [a, b], inside one monotone piece."""
    if not (abs(low) < TURNS and abs(high) < TURNS):
        return low, high
    shift = 0.5 * math.pi if kind == COSINE else 0.0  # cos u = sin(u + shift)
    k = math.floor((0.5 * (low + high) + shift) / math.pi + 0.5)
    centre = k * math.pi - shift
    if centre - low > 0.5 * math.pi or high - centre > 0.5 * math.pi:
        return low, high
    if k % 2.0 != 0.0:
        a, b = -b, -a
    e = 1e-14 * (1.0 + abs(centre))
    least = low if a <= -1.0 else centre + math.asin(min(1.0, a)) - e
    most = high if b >= 1.0 else centre + math.asin(max(-1.0, b)) + e
    return least, most


@inlined
def inverse(kind, p, low, high, a, b):
    """Interval of u in [low, high] whose function lies in [a, b]."""
    if kind == POWER or kind == ROOT:
        return inverse_power(p, low, high, a, b)
    if kind == SINE or kind == COSINE:
        return inverse_wave(kind, low, high, a, b)
    if kind == EXP:
        least = down(math.log(a), LIBRARY) if a > 0.0 else -math.inf
        return least, (up(math.log(b), LIBRARY) if b > 0.0 else -math.inf)
    if kind == LOG:
        return max(0.0, down(math.exp(a), LIBRARY)), up(math.exp(b), LIBRARY)
    if kind == TANH:
        least = down(math.atanh(a), LIBRARY) if a > -1.0 else -math.inf
        most = up(math.atanh(b), LIBRARY) if b < 1.0 else math.inf
        return (least if a < 1.0 else low), (most if b > -1.0 else high)
    if kind == ATAN:
        quarter = 0.5 * math.pi - 1e-15
        least = down(math.tan(a), LIBRARY + 1.0) if a > -quarter else -math.inf
        most = up(math.tan(b), LIBRARY + 1.0) if b < quarter else math.inf
        return (least if a < quarter else low), (most if b > -quarter else high)
    if kind == ASIN:
        quarter = 0.5 * math.pi
        least = down(math.sin(a), LIBRARY) if a > -quarter else -1.0
        return least, (up(math.sin(b), LIBRARY) if b < quarter else 1.0)
    if kind == ABS:
        return (a if low > -a else -b), (-a if high < a else b)
    return a, b + 1.0  # floor


@inlined
def narrow(sets, lo, hi, j, low, high):
    """Cut column j to [low, high], inwards to its allowed values; False where nothing is left."""
    sort, first, last, values = sets
    if low > lo[j]:
        if sort[j] == WHOLE:
            low = np.ceil(low - WHOLE_SLACK)
        elif sort[j] == LISTED:
            k = first[j]
            while k < last[j] and values[k] < low - WHOLE_SLACK * abs(low):
                k += 1
            low = values[k] if k < last[j] else math.inf
        lo[j] = max(lo[j], low)
    if high < hi[j]:
        if sort[j] == WHOLE:
            high = np.floor(high + WHOLE_SLACK)
        elif sort[j] == LISTED:
            k = last[j] - 1
            while k >= first[j] and values[k] > high + WHOLE_SLACK * abs(high):
                k -= 1
            high = values[k] if k >= first[j] else -math.inf
        hi[j] = min(hi[j], high)
    return lo[j] <= hi[j]


@light
def narrow_sum(sums, sets, r, lo, hi):
    """Narrow the columns of a sum; False where it cannot be its constant."""
    start, index, factor, error, constant, doubt = sums
    low = high = size_low = size_high = 0.0
    free_low = free_high = 0
    for k in range(start[r], start[r + 1]):
        j = index[k]
        a, b = term(factor[k], error[k], lo[j], hi[j])
        if a == -math.inf:
            free_low += 1
        else:
            low += a
            size_low += abs(a)
        if b == math.inf:
            free_high += 1
        else:
            high += b
            size_high += abs(b)
    spacing = (start[r + 1] - start[r] + 4.0) * UNIT
    kept = constant[r]
    e_low = spacing * (size_low + abs(kept)) + doubt[r]
    e_high = spacing * (size_high + abs(kept)) + doubt[r]
    if free_low == 0 and low - e_low > kept or free_high == 0 and high + e_high < kept:
        return False
    for k in range(start[r], start[r + 1]):
        j = index[k]
        a, b = term(factor[k], error[k], lo[j], hi[j])
        least, most = -math.inf, math.inf
        if free_high == 0:
            least = kept - (high - b) - e_high
        elif free_high == 1 and b == math.inf:
            least = kept - high - e_high
        if free_low == 0:
            most = kept - (low - a) + e_low
        elif free_low == 1 and a == -math.inf:
            most = kept - low + e_low
        if (least > a or most < b) and not narrow(
            sets, lo, hi, j, *unscaled(least, most, factor[k], error[k], lo[j], hi[j])
        ):
            return False
    return True


@inlined
def term(factor, error, low, high):
    """Interval of a factor, known to within an error, times a column."""
    if error == 0.0:
        return product(factor, factor, low, high)
    return product(factor - error, factor + error, low, high)


@inlined
def unscaled(least, most, factor, error, low, high):
    """Interval of a column whose multiple lies between two ends."""
    if factor - error <= 0.0 <= factor + error:
        return low, high
    return quotient(least, most, factor - error, factor + error)


@inlined
def may_be_infinite(kind, p, u, v, lo, hi):
    """Whether a quotient or a negative power may be infinite on the box, as the text computes it.

    p of a quotient, -1 - v of a power: CLOSED, OPEN, or UNSIGNED where its 0 is never -0.
    """
    if kind == QUOTIENT and p > CLOSED:
        return lo[v] <= 0.0 <= hi[v] and not (p == UNSIGNED and lo[v] == 0.0 < hi[v])
    if kind == POWER and v < -1:
        return lo[u] <= 0.0 <= hi[u] and not (v == -1 - UNSIGNED and lo[u] == 0.0 < hi[u])
    return False


@inlined
def forward(kind, p, u, v, lo, hi):
    """Range of an operation on columns u and v."""
    if may_be_infinite(kind, p, u, v, lo, hi):
        return -math.inf, math.inf
    if kind == PRODUCT:
        return product(lo[u], hi[u], lo[v], hi[v])
    if kind == QUOTIENT:
        return quotient(lo[u], hi[u], lo[v], hi[v])
    if kind == MAXIMUM:
        return max(lo[u], lo[v]), max(hi[u], hi[v])
    if kind == MINIMUM:
        return min(lo[u], lo[v]), min(hi[u], hi[v])
    return image(kind, p, lo[u], hi[u])


@inlined
def in_domain(kind, sets, u, lo, hi):
    """Cut an argument to the domain of its function."""
    if kind == LOG or kind == ROOT:
        return narrow(sets, lo, hi, u, 0.0, math.inf)
    if kind == ASIN:
        return narrow(sets, lo, hi, u, -1.0, 1.0)
    return True


@inlined
def solved_factor(a, b, c, d, low, high):
    """Interval of x in [low, high] with x times some of [c, d] in [a, b]."""
    if c < 0.0 < d and (a > 0.0 or b < 0.0):  # two rays: of a/[0, d] and a/[c, 0]
        plus, minus = (a / d, a / c) if a > 0.0 else (b / c, b / d)
        least = down(plus, 1.0) if low > up(minus, 1.0) else low
        most = up(minus, 1.0) if high < down(plus, 1.0) else high
        return least, most
    if a <= 0.0 <= b and c <= 0.0 <= d:
        return low, high
    return quotient(a, b, c, d)


@light
def backward(kind, p, w, u, v, sets, lo, hi):
    """Narrow the arguments of an operation by its value; False where nothing is left."""
    if (kind == QUOTIENT and p > CLOSED or kind == POWER and v < -1) and (
        lo[w] <= 0.0 <= hi[w] or may_be_infinite(kind, p, u, v, lo, hi)
    ):
        return True  # a value of 0 may be that of either infinity
    if kind == PRODUCT:
        low, high = solved_factor(lo[w], hi[w], lo[v], hi[v], lo[u], hi[u])
        if not narrow(sets, lo, hi, u, low, high):
            return False
        low, high = solved_factor(lo[w], hi[w], lo[u], hi[u], lo[v], hi[v])
        return narrow(sets, lo, hi, v, low, high)
    if kind == QUOTIENT:
        low, high = product(lo[w], hi[w], lo[v], hi[v])
        infinite = p > CLOSED and lo[v] <= 0.0 <= hi[v]  # then u is any, not 0 times infinity
        if not infinite and not narrow(sets, lo, hi, u, low, high):
            return False
        low, high = solved_factor(lo[u], hi[u], lo[w], hi[w], lo[v], hi[v])
        return narrow(sets, lo, hi, v, low, high)
    if kind == MAXIMUM:
        low_u = lo[w] if hi[v] < lo[w] else -math.inf
        low_v = lo[w] if hi[u] < lo[w] else -math.inf
        if not narrow(sets, lo, hi, u, low_u, hi[w]):
            return False
        return narrow(sets, lo, hi, v, low_v, hi[w])
    if kind == MINIMUM:
        high_u = hi[w] if lo[v] > hi[w] else math.inf
        high_v = hi[w] if lo[u] > hi[w] else math.inf
        if not narrow(sets, lo, hi, u, lo[w], high_u):
            return False
        return narrow(sets, lo, hi, v, lo[w], high_v)
    low, high = inverse(kind, p, lo[u], hi[u], lo[w], hi[w])
    return narrow(sets, lo, hi, u, low, high)


@light
def sweep(relations, exponent, sums, sets, lo, hi):
    """One pass forwards and one backwards; False where the box holds no point."""
    count = len(relations)
    for r in range(count):
        kind, w, u, v = relations[r, 0], relations[r, 1], relations[r, 2], relations[r, 3]
        if kind == LINEAR:
            if not narrow_sum(sums, sets, r, lo, hi):
                return False
        elif not in_domain(kind, sets, u, lo, hi):
            return False
        else:
            low, high = forward(kind, exponent[r], u, v, lo, hi)
            if not narrow(sets, lo, hi, w, low, high):
                return False
    for r in range(count - 1, -1, -1):
        kind, w, u, v = relations[r, 0], relations[r, 1], relations[r, 2], relations[r, 3]
        if kind == LINEAR:
            if not narrow_sum(sums, sets, r, lo, hi):
                return False
        elif not backward(kind, exponent[r], w, u, v, sets, lo, hi):
            return False
    return True


@entry
def propagate(relations, exponent, sums, sets, lo, hi, sweeps, share):
    """Narrow a box in place, until no width falls by more than a share of it; False: it is empty.

    relations (R, 4) kind, w, u, v; exponent (R,); sums: start (R+1,), index, factor, error (E,),
    constant, doubt (R,); sets: sort, first, last of the columns, and their listed values; lo, hi
    (C,).
    """
    before = hi - lo
    for _ in range(sweeps):
        if not sweep(relations, exponent, sums, sets, lo, hi):
            return False
        moved = False
        for j in range(len(lo)):
            width = hi[j] - lo[j]
            if width < before[j] and not width >= (1.0 - share) * before[j]:
                moved = True
            before[j] = width
        if not moved:
            break
    return True
