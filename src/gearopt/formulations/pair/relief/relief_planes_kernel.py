"""Planes below and above the approach in a box of reliefs: what its bounds are made of.

A box has a = amount^(1/p) and length l of both gears between ends. What is removed at a distance x
from a tip is the p-th power of u = a - b x where that is positive, with b = a/l: convex in (a, b),
which lie in a trapezium. The approach is concave in what is removed and never falls with it. So it
lies above a plane of v = (a1, b1, a2, b2), by a secant of the concave law and tangents of the
convex power, and below planes, by any set of pairs in contact and secants of the power.
"""

import math

from gearopt.optimise.jit_kernel import inner


@inner
def power(u, exponent):
    """u^p where u is positive, else 0."""
    if u <= 0.0:
        return 0.0
    if exponent == 1.0:
        return u
    return u * u if exponent == 2.0 else u**exponent


@inner
def slope(u, exponent):
    """Derivative of `power`."""
    if u <= 0.0:
        return 0.0
    return 1.0 if exponent == 1.0 else exponent * u ** (exponent - 1.0)


@inner
def depth(stiffness, apart, load, acts):
    """Return the approach d [um] of uncoupled pairs, sum of k_i (d - gap_i)+ = load [N].

    stiffness k_i [N/um], 0 of no pair; apart: gaps [um]. Pairs that open are dropped until none
    does; `acts` becomes k_i of the pairs in contact, 0 of the others.
    """
    pairs, datum = stiffness.size, math.inf
    for i in range(pairs):
        if stiffness[i] > 0.0:
            datum = min(datum, apart[i])
    total, moved = 0.0, load
    for i in range(pairs):
        acts[i] = stiffness[i]
        total += stiffness[i]
        moved += stiffness[i] * (apart[i] - datum)
    found = moved / total
    dropped = True
    while dropped:
        dropped = False
        for i in range(pairs):
            if acts[i] > 0.0 and apart[i] - datum > found:
                dropped = True
                total -= acts[i]
                moved -= acts[i] * (apart[i] - datum)
                acts[i] = 0.0
        if dropped:
            found = max(moved, 0.0) / total
    return datum + found


@inner
def corners(low, high, found):
    """Set the corners (4, 2) of (a, b) of both gears, found (2, 4, 2)."""
    for gear in range(2):
        for j in range(4):
            a = high[2 * gear] if j >= 2 else low[2 * gear]
            length = high[2 * gear + 1] if j % 2 else low[2 * gear + 1]
            found[gear, j, 0], found[gear, j, 1] = a, a / length


@inner
def ranges(tips, exponents, places, secants, ends):
    """Set secants (2, p, n, 2) of the power, offset and factor of u, and ends (2, p, n) of sums."""
    positions, pairs = tips.shape[1], tips.shape[2]
    for k in range(positions):
        for i in range(pairs):
            ends[0, k, i] = ends[1, k, i] = 0.0
            for gear in range(2):
                least, most = math.inf, -math.inf
                for j in range(4):
                    u = places[gear, j, 0] - places[gear, j, 1] * tips[gear, k, i]
                    least, most = min(least, u), max(most, u)
                first = power(least, exponents[gear])
                last = power(most, exponents[gear])
                factor = (last - first) / (most - least) if most > least else 0.0
                secants[gear, k, i, 0] = first - factor * least if factor > 0.0 else last
                secants[gear, k, i, 1] = factor
                ends[0, k, i] += first
                ends[1, k, i] += last


@inner
def below(stiffness, load, ends, slopes, apart, acts):
    """Set slopes (n,) of a plane of separations below the approach; return its offset."""
    one, two, present = -1, -1, 0
    for i in range(stiffness.size):
        slopes[i] = 0.0
        if stiffness[i] > 0.0:
            present += 1
            one, two = (i, two) if one < 0 else (one, i)
    if present == 1:
        slopes[one] = 1.0
        return load / stiffness[one]
    if present > 2:
        return below_many(stiffness, load, ends, slopes, apart, acts)
    first, last = ends[0, one] - ends[1, two], ends[1, one] - ends[0, two]
    at_first = over(stiffness[one], stiffness[two], load, first)
    at_last = over(stiffness[one], stiffness[two], load, last)
    if last > first:  # the secant of the concave law over the difference of separations
        slopes[one] = min(max((at_last - at_first) / (last - first), 0.0), 1.0)
    slopes[two] = 1.0 - slopes[one]
    return min(at_first - slopes[one] * first, at_last - slopes[one] * last)


@inner
def below_many(stiffness, load, ends, slopes, apart, acts):
    """As `below` of more than two pairs: slopes at the middle, offset of the lowest corner."""
    pairs, total, offset = stiffness.size, 0.0, math.inf
    for i in range(pairs):
        apart[i] = 0.5 * (ends[0, i] + ends[1, i])
    depth(stiffness, apart, load, acts)
    for i in range(pairs):
        total += acts[i]
    for i in range(pairs):
        slopes[i] = acts[i] / total
    for corner in range(1 << pairs):
        plane = 0.0
        for i in range(pairs):
            apart[i] = ends[(corner >> i) & 1, i]
            plane += slopes[i] * apart[i]
        offset = min(offset, depth(stiffness, apart, load, acts) - plane)
    return offset


@inner
def over(first, second, load, ahead):
    """Approach less the second separation, of two pairs whose separations differ by `ahead`."""
    both = (load + first * ahead) / (first + second)
    return min(both, min(load / second, load / first + ahead))


@inner
def raised(tips, secants, v, k, apart):
    """Set planes above what is removed from the pairs at position k, at v."""
    for i in range(apart.size):
        apart[i] = 0.0
        for gear in range(2):
            u = v[2 * gear] - v[2 * gear + 1] * tips[gear, k, i]
            apart[i] += secants[gear, k, i, 0] + secants[gear, k, i, 1] * u


@inner
def under(tips, exponents, v, k, offset, slopes, plane):
    """Set the plane below the approach at position k that touches the convex power at v."""
    plane[0] = offset
    for j in range(1, 5):
        plane[j] = 0.0
    for i in range(slopes.size):
        for gear in range(2):
            x = tips[gear, k, i]
            u = v[2 * gear] - v[2 * gear + 1] * x
            rise = slope(u, exponents[gear])
            plane[0] += slopes[i] * (power(u, exponents[gear]) - rise * u)
            plane[1 + 2 * gear] += slopes[i] * rise
            plane[2 + 2 * gear] -= slopes[i] * rise * x


@inner
def above(stiffness, tips, load, v, k, secants, room, plane):
    """Set the plane above the approach at position k of the pairs that act at v."""
    total, moved = 0.0, load
    raised(tips, secants, v, k, room[0])
    depth(stiffness, room[0], load, room[1])
    for i in range(stiffness.size):
        total += room[1, i]
    for j in range(1, 5):
        plane[j] = 0.0
    for i in range(stiffness.size):
        for gear in range(2):
            part = room[1, i] * secants[gear, k, i, 1]
            moved += room[1, i] * secants[gear, k, i, 0]
            plane[1 + 2 * gear] += part / total
            plane[2 + 2 * gear] -= part / total * tips[gear, k, i]
    plane[0] = moved / total


@inner
def at(plane, v):
    """Value of a plane, constant and gradient (5,), at v."""
    return plane[0] + plane[1] * v[0] + plane[2] * v[1] + plane[3] * v[2] + plane[4] * v[3]
