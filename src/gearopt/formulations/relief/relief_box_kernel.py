"""Kernel of the search for the best relief: bounds of boxes of amounts and lengths.

A box has a = amount^(1/p) and length l of both gears between ends. What is removed at a distance x
from a tip is the p-th power of u = a - b x where that is positive, with b = a/l: convex in (a, b),
which lie in a trapezium. The approach is concave in what is removed and never falls with it. So in
a box every approach lies above a plane (below it: secants of the concave law, tangents of the
convex power) and below planes (a set of pairs in contact, secants of the power), and the least
peak-to-peak between them is a linear program in (a1, b1, a2, b2), solved by cutting planes. The
bound is computed from its multipliers, whatever they are.
"""

import math

import numpy as np

from gearopt.optimise.jit_kernel import entry, inner

CUTS = 24  # planes of a box at most
PIVOTS = 80
CORNERS = 16  # of the product of two trapeziums
NEAR = 1e-3  # of the value: cutting planes end where they are as near to the relaxation


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
    """Approach of uncoupled pairs by dropping those that open; `acts` becomes the ones that do."""
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
def peaks(stiffness, tips, exponents, loads, v, found, apart, acts):
    """Set the peak-to-peak of every load at v = (a1, b1, a2, b2), exactly."""
    positions, pairs = stiffness.shape
    for q in range(loads.size):
        least, most = math.inf, -math.inf
        for k in range(positions):
            for i in range(pairs):
                apart[i] = power(v[0] - v[1] * tips[0, k, i], exponents[0])
                apart[i] += power(v[2] - v[3] * tips[1, k, i], exponents[1])
            delta = depth(stiffness[k], apart, loads[q], acts)
            least, most = min(least, delta), max(most, delta)
        found[q] = most - least


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
    """Set slopes (n,) of a plane of separations below the approach; return its offset.

    Of two pairs the secant of the concave law over the difference of their separations; of more,
    the slopes at the middle, and the offset of the corner where the plane is least below.
    """
    pairs, present = stiffness.size, 0
    for i in range(pairs):
        slopes[i] = 0.0
        present += stiffness[i] > 0.0
    if present == 1:
        for i in range(pairs):
            if stiffness[i] > 0.0:
                slopes[i] = 1.0
                return load / stiffness[i]
    if present == 2:
        one, two = -1, -1
        for i in range(pairs):
            if stiffness[i] > 0.0:
                if one < 0:
                    one = i
                else:
                    two = i
        first = ends[0, one] - ends[1, two]
        last = ends[1, one] - ends[0, two]
        at_first = over(stiffness[one], stiffness[two], load, first)
        at_last = over(stiffness[one], stiffness[two], load, last)
        if last > first:
            slopes[one] = min(max((at_last - at_first) / (last - first), 0.0), 1.0)
        slopes[two] = 1.0 - slopes[one]
        return min(at_first - slopes[one] * first, at_last - slopes[one] * last)
    total = 0.0
    for i in range(pairs):
        apart[i] = 0.5 * (ends[0, i] + ends[1, i])
    depth(stiffness, apart, load, acts)
    for i in range(pairs):
        total += acts[i]
    for i in range(pairs):
        slopes[i] = acts[i] / total
    offset = math.inf
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
def extremes(stiffness, tips, exponents, load, v, secants, offsets, slopes, room):
    """Positions at v of the largest lower and of the least upper approach, and their difference."""
    positions, pairs = stiffness.shape
    top, most, bottom, least = 0, -math.inf, 0, math.inf
    for k in range(positions):
        lower = offsets[k]
        for i in range(pairs):
            for gear in range(2):
                u = v[2 * gear] - v[2 * gear + 1] * tips[gear, k, i]
                lower += slopes[k, i] * power(u, exponents[gear])
        if lower > most:
            top, most = k, lower
        raised(tips, secants, v, k, room[0])
        upper = depth(stiffness[k], room[0], load, room[1])
        if upper < least:
            bottom, least = k, upper
    return top, bottom, most - least


@inner
def plane(stiffness, tips, exponents, load, v, secants, slopes, top, bottom, value, room, cut):
    """Set constant and gradient (5,) of the plane through the value at v of two positions."""
    pairs, total = stiffness.shape[1], 0.0
    raised(tips, secants, v, bottom, room[0])
    depth(stiffness[bottom], room[0], load, room[1])
    for i in range(pairs):
        total += room[1, i]
    for j in range(5):
        cut[j] = 0.0
    for i in range(pairs):
        for gear in range(2):
            x = tips[gear, top, i]
            u = v[2 * gear] - v[2 * gear + 1] * x
            rise = slopes[top, i] * slope(u, exponents[gear])
            cut[1 + 2 * gear] += rise
            cut[2 + 2 * gear] -= rise * x
            rise = room[1, i] / total * secants[gear, bottom, i, 1]
            cut[1 + 2 * gear] -= rise
            cut[2 + 2 * gear] += rise * tips[gear, bottom, i]
    cut[0] = value
    for j in range(4):
        cut[0] -= cut[1 + j] * v[j]


@inner
def game(values, count, table, basis, weights, mixture):
    """Solve max over weights of the least row of values (16, count) times weights, by the simplex.

    Sets weights (count,) and the mixture (16,) of corners at which the cuts meet; returns the least
    row, which is a bound whatever the weights are.
    """
    shift, width = math.inf, CORNERS + count + 1
    for r in range(CORNERS):
        for c in range(count):
            shift = min(shift, values[r, c])
    for c in range(count):  # maximise sum y: values' y <= 1, from the slacks
        for r in range(CORNERS):
            table[c, r] = values[r, c] - shift + 1.0
        for j in range(count):
            table[c, CORNERS + j] = 1.0 if j == c else 0.0
        table[c, width - 1] = 1.0
        basis[c] = CORNERS + c
    for j in range(width):
        table[count, j] = -1.0 if j < CORNERS else 0.0
    for _ in range(PIVOTS):
        if not pivoted(table, basis, count, width):
            break
    return read(values, count, table, basis, weights, mixture)


@inner
def pivoted(table, basis, count, width):
    """Whether there was a step of the simplex method, which was made."""
    enters, price = -1, -1e-12
    for j in range(width - 1):
        if table[count, j] < price:
            enters, price = j, table[count, j]
    if enters < 0:
        return False
    leaves, ratio = -1, math.inf
    for c in range(count):
        if table[c, enters] > 1e-12 and table[c, width - 1] / table[c, enters] < ratio:
            leaves, ratio = c, table[c, width - 1] / table[c, enters]
    if leaves < 0:
        return False
    pivot = table[leaves, enters]
    for j in range(width):
        table[leaves, j] /= pivot
    for c in range(count + 1):
        factor = table[c, enters]
        if c != leaves and factor != 0.0:
            for j in range(width):
                table[c, j] -= factor * table[leaves, j]
    basis[leaves] = enters
    return True


@inner
def read(values, count, table, basis, weights, mixture):
    """Set weights and mixture from a final table, made to be shares; return the least row."""
    total, mixed, width = 0.0, 0.0, CORNERS + count + 1
    for c in range(count):
        weights[c] = max(table[count, CORNERS + c], 0.0)
        total += weights[c]
    for r in range(CORNERS):
        mixture[r] = 0.0
    for c in range(count):
        if basis[c] < CORNERS:
            mixture[basis[c]] = max(table[c, width - 1], 0.0)
            mixed += mixture[basis[c]]
    for c in range(count):
        weights[c] = weights[c] / total if total > 0.0 else 1.0 / count
    for r in range(CORNERS):
        mixture[r] = mixture[r] / mixed if mixed > 0.0 else 1.0 / CORNERS
    least = math.inf
    for r in range(CORNERS):
        row = 0.0
        for c in range(count):
            row += weights[c] * values[r, c]
        least = min(least, row)
    return least


@entry
def bound(stiffness, tips, exponents, loads, weights, low, high, aim, point, found):
    """Bound the largest of weighted peak-to-peaks of all reliefs in a box from below; return it.

    stiffness (p, n) of uncoupled pairs, 0 of absent ones; tips (2, p, n): distances from both tips;
    exponents (2,); loads, weights (q,); low, high (4,): a1, l1, a2, l2. A bound that reaches `aim`
    need not be better. point (4,) becomes the (a1, b1, a2, b2) where the relaxation is least, found
    (q,) the exact peak-to-peaks there.
    """
    positions, pairs = stiffness.shape
    places, ends = np.empty((2, 4, 2)), np.empty((2, positions, pairs))
    secants, room = np.empty((2, positions, pairs, 2)), np.empty((2, pairs))
    offsets, slopes = np.empty((loads.size, positions)), np.empty((loads.size, positions, pairs))
    corners(low, high, places)
    ranges(tips, exponents, places, secants, ends)
    for q in range(loads.size):
        for k in range(positions):
            offsets[q, k] = below(
                stiffness[k], loads[q], ends[:, k], slopes[q, k], room[0], room[1]
            )
    values, shares, mixture = np.empty((CORNERS, CUTS)), np.empty(CUTS), np.empty(CORNERS)
    table, basis = np.empty((CUTS + 1, CORNERS + CUTS + 1)), np.empty(CUTS, np.int64)
    for r in range(CORNERS):
        mixture[r] = 1.0 / CORNERS
    count, best, cut = 0, 0.0, np.empty(5)
    while True:
        mixed(places, mixture, point)
        if best >= aim or count + loads.size > CUTS:
            break
        height = 0.0
        for q in range(loads.size):
            given = stiffness, tips, exponents, loads[q], point, secants
            top, bottom, value = extremes(*given, offsets[q], slopes[q], room)
            height = max(height, weights[q] * value)
            if weights[q] * value > best:
                plane(*given, slopes[q], top, bottom, value, room, cut)
                for j in range(5):
                    cut[j] *= weights[q]
                at_corners(places, cut, values, count)
                count += 1
        if height <= best + NEAR * height:
            break
        best = max(best, game(values, count, table, basis, shares, mixture))
    peaks(stiffness, tips, exponents, loads, point, found, room[0], room[1])
    return best


@inner
def mixed(places, mixture, point):
    """Set the point (4,) that a mixture of corners (16,) is."""
    for j in range(4):
        point[j] = 0.0
    for r in range(CORNERS):
        for j in range(2):
            point[j] += mixture[r] * places[0, r // 4, j]
            point[2 + j] += mixture[r] * places[1, r % 4, j]


@inner
def at_corners(places, cut, values, column):
    """Set the values of a plane at all corners."""
    for r in range(CORNERS):
        values[r, column] = cut[0]
        for j in range(2):
            values[r, column] += cut[1 + j] * places[0, r // 4, j]
            values[r, column] += cut[3 + j] * places[1, r % 4, j]
