"""Kernel of the search for the best relief: bounds of boxes of amounts and lengths, either way.

The least peak-to-peak, or the least amplitude of harmonics, of all approaches between their planes
(`relief_planes_kernel`) is a convex problem in v = (a1, b1, a2, b2), solved by cutting planes. The
bound is computed from the multipliers of the cuts, whatever they are.
"""

import math

import numpy as np

from gearopt.formulations.pair.relief.relief_planes_kernel import (
    above,
    at,
    below,
    corners,
    depth,
    power,
    raised,
    ranges,
    under,
)
from gearopt.optimise.jit_kernel import entry, inner

CUTS = 24  # planes of a box at most
PIVOTS = 80
CORNERS = 16  # of the product of two trapeziums
CUT_TOLERANCE = 1e-3  # of the value: cutting planes end where they are as near to the relaxation


@inner
def peaks(stiffness, tips, exponents, loads, v, found, delta, apart, acts):
    """Set the peak-to-peak (q,) and the approaches (q, p) of every load at v, exactly."""
    positions, pairs = stiffness.shape
    for q in range(loads.size):
        least, most = math.inf, -math.inf
        for k in range(positions):
            for i in range(pairs):
                apart[i] = power(v[0] - v[1] * tips[0, k, i], exponents[0])
                apart[i] += power(v[2] - v[3] * tips[1, k, i], exponents[1])
            delta[q, k] = depth(stiffness[k], apart, loads[q], acts)
            least, most = min(least, delta[q, k]), max(most, delta[q, k])
        found[q] = most - least


@inner
def amplitude(waves, delta, direction):
    """Length of waves (h, p) times approaches (p,); its direction (h,)."""
    total = 0.0
    for h in range(direction.size):
        direction[h] = 0.0
        for k in range(delta.size):
            direction[h] += waves[h, k] * delta[k]
        total += direction[h] ** 2
    total = math.sqrt(total)
    for h in range(direction.size):
        direction[h] = direction[h] / total if total > 0.0 else 0.0
    return total


@inner
def extremes(stiffness, tips, exponents, load, v, secants, offsets, slopes, room):
    """Positions at v of the largest lower and of the least upper approach."""
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
    return top, bottom


@inner
def peak_cut(stiffness, tips, exponents, load, v, secants, offsets, slopes, room, lower, cut):
    """Set the cut at v of the peak-to-peak: a plane below one approach less one above another."""
    given = stiffness, tips, exponents, load, v, secants, offsets, slopes, room
    top, bottom = extremes(*given)
    under(tips, exponents, v, top, offsets[top], slopes[top], lower)
    above(stiffness[bottom], tips, load, v, bottom, secants, room, cut)
    for j in range(5):
        cut[j] = lower[j] - cut[j]
    return at(cut, v)


@inner
def wave_cut(stiffness, tips, exponents, load, v, secants, offsets, slopes, room, waves, cut):
    """Set the cut at v of the harmonics: of approaches in their direction between the planes.

    An amplitude is at least its part in any direction, a weighted sum of approaches, whose planes
    are those below for positive weights and those above for negative ones.
    """
    positions = stiffness.shape[0]
    lower, upper = np.empty((positions, 5)), np.empty((positions, 5))
    delta, direction = np.empty(positions), np.empty(waves.shape[0])
    for k in range(positions):
        under(tips, exponents, v, k, offsets[k], slopes[k], lower[k])
        above(stiffness[k], tips, load, v, k, secants, room, upper[k])
        delta[k] = 0.5 * (at(lower[k], v) + at(upper[k], v))
    amplitude(waves, delta, direction)
    for j in range(5):
        cut[j] = 0.0
    for k in range(positions):
        weight = 0.0
        for h in range(direction.size):
            weight += direction[h] * waves[h, k]
        for j in range(5):
            cut[j] += weight * (lower[k, j] if weight > 0.0 else upper[k, j])
    return at(cut, v)


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
def bound(stiffness, tips, exponents, loads, waves, weights, low, high, aim, point, found):
    """Bound the largest of weighted measures of all reliefs in a box from below; return it.

    stiffness (p, n) of uncoupled pairs, 0 of absent ones; tips (2, p, n): distances from both tips;
    exponents (2,); loads (q,); waves (h, p): approaches to harmonics; weights (2, q) of
    peak-to-peaks and amplitudes; low, high (4,): a1, l1, a2, l2. A bound that reaches `aim` need
    not be better. point (4,) becomes the v where the relaxation is least, found (2, q) the exact
    measures there.
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
    given = stiffness, tips, exponents, loads, waves, weights
    values, shares, mixture = np.empty((CORNERS, CUTS)), np.empty(CUTS), np.empty(CORNERS)
    table, basis = np.empty((CUTS + 1, CORNERS + CUTS + 1)), np.empty(CUTS, np.int64)
    for r in range(CORNERS):
        mixture[r] = 1.0 / CORNERS
    count, best = 0, 0.0
    while True:
        mixed(places, mixture, point)
        if best >= aim or count + 2 * loads.size > CUTS:
            break
        more, height = cuts_at(
            *given, point, secants, offsets, slopes, room, places, best, values, count
        )
        if height <= best + CUT_TOLERANCE * height:
            break
        count = more
        best = max(best, game(values, count, table, basis, shares, mixture))
    measured(stiffness, tips, exponents, loads, waves, point, found, room)
    return best


@inner
def cuts_at(
    stiffness,
    tips,
    exponents,
    loads,
    waves,
    weights,
    v,
    secants,
    offsets,
    slopes,
    room,
    places,
    best,
    values,
    count,
):
    """Add the cuts at v that are above the bound; return how many there are, and the highest."""
    height, cut, lower = 0.0, np.empty(5), np.empty(5)
    for q in range(loads.size):
        given = stiffness, tips, exponents, loads[q], v, secants, offsets[q], slopes[q], room
        for sort in range(2):
            if weights[sort, q] > 0.0:
                if sort == 0:
                    value = weights[sort, q] * peak_cut(*given, lower, cut)
                else:
                    value = weights[sort, q] * wave_cut(*given, waves, cut)
                height = max(height, value)
                if value > best:
                    at_corners(places, cut, weights[sort, q], values, count)
                    count += 1
    return count, height


@inner
def measured(stiffness, tips, exponents, loads, waves, point, found, room):
    """Set the exact peak-to-peaks and amplitudes (2, q) at a point."""
    delta, direction = np.empty((loads.size, stiffness.shape[0])), np.empty(waves.shape[0])
    peaks(stiffness, tips, exponents, loads, point, found[0], delta, room[0], room[1])
    for q in range(loads.size):
        found[1, q] = amplitude(waves, delta[q], direction)


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
def at_corners(places, cut, weight, values, column):
    """Set the weighted values of a plane at all corners."""
    for r in range(CORNERS):
        values[r, column] = cut[0]
        for j in range(2):
            values[r, column] += cut[1 + j] * places[0, r // 4, j]
            values[r, column] += cut[3 + j] * places[1, r % 4, j]
        values[r, column] *= weight


@entry
def ceiling(stiffness, tips, exponents, loads, low, high, point):
    """Bound the largest peak-to-peak of all reliefs in a box from above; return it and a value.

    Arguments as of `relief_box_kernel.bound`. At every position planes above and below the approach
    are taken, which touch them about the middle of the box; the largest difference of any two is at
    a corner. point (4,) becomes the corner with the largest exact value, which is returned.
    """
    positions, pairs = stiffness.shape
    places, ends = np.empty((2, 4, 2)), np.empty((2, positions, pairs))
    secants, room = np.empty((2, positions, pairs, 2)), np.empty((2, pairs))
    slopes, upper, lower = np.empty(pairs), np.empty((positions, 5)), np.empty((positions, 5))
    mixture, v, found = np.empty(CORNERS), np.empty(4), np.empty(loads.size)
    delta = np.empty((loads.size, positions))
    corners(low, high, places)
    ranges(tips, exponents, places, secants, ends)
    bound, value = 0.0, -math.inf
    for q in range(loads.size):
        for r in range(CORNERS):
            mixture[r] = 1.0 / CORNERS
        mixed(places, mixture, v)
        for k in range(positions):
            offset = below(stiffness[k], loads[q], ends[:, k], slopes, room[0], room[1])
            under(tips, exponents, v, k, offset, slopes, lower[k])
            above(stiffness[k], tips, loads[q], v, k, secants, room, upper[k])
        for r in range(CORNERS):
            for j in range(CORNERS):
                mixture[j] = 1.0 if j == r else 0.0
            mixed(places, mixture, v)
            most, least = -math.inf, math.inf
            for k in range(positions):
                most, least = max(most, at(upper[k], v)), min(least, at(lower[k], v))
            bound = max(bound, most - least)
            if q == 0:
                peaks(stiffness, tips, exponents, loads, v, found, delta, room[0], room[1])
                here = 0.0
                for s in range(loads.size):
                    here = max(here, found[s])
                if here > value:
                    value = here
                    for j in range(4):
                        point[j] = v[j]
    return bound, value
