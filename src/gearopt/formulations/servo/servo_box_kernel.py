"""Kernels of the servo box: which angles of the links leave room, by intervals of the first one."""

import math

import numpy as np

from gearopt.optimise.jit_kernel import entry, inner

SLACK = 1e-12  # of lengths over the box, and of angles: many times their rounding
MEETS = 1.0 + 10.0 * SLACK  # scale of a box that one layout is judged in: a tie is decided
# Integers for arguments: for a literal numba compiles a function once more, and all it calls.
ZERO, ONE = np.int64(0), np.int64(1)


@inner
def farthest(low, high):
    """Largest distance from 0, at most pi, of angles in an interval."""
    turn = math.floor((low - math.pi) / (2.0 * math.pi)) + 1.0
    if math.pi + 2.0 * math.pi * turn <= high:
        return math.pi
    first = abs((low + math.pi) % (2.0 * math.pi) - math.pi)
    return max(first, abs((high + math.pi) % (2.0 * math.pi) - math.pi))


@inner
def reach(s, low, high, axis):
    """Least extents from the output shaft in one of 4 directions, over angles of the output link.

    Of swept wheel and hub, and of gear 2's axis; axis: 0 right, 1 up, 2 left, 3 down.
    """
    turn = axis * 0.5 * math.pi
    off = farthest(low - turn, high - turn)
    swept = max(s.radius[2] * math.cos(max(off - s.half_sweep, 0.0)), s.hub)
    along = math.cos(off)
    return swept, (s.link[1] if along >= 0.0 else s.link[2]) * along


@inner
def least_bend(keep, a, near, far):
    """Least cosine of the links' angle at which the motor clears the hub, over near <= b <= far.

    In b it falls, or first rises and then falls: an end is least.
    """
    first = (keep * keep - a * a - near * near) / (2.0 * a * near)
    return min(first, (keep * keep - a * a - far * far) / (2.0 * a * far))


@inner
def room(s, scale, low, high, slack):
    """An angle of the motor link that fits a box of this scale, or nan where there is none.

    Over an interval of angles of the output link, and of its lengths link[1] to link[2], the needs
    are relaxed, so that nan proves that no angle in it fits; for one angle (low = high), one length
    and slack 0 an angle found does fit.
    """
    width, height = scale * s.box[0], scale * s.box[1]
    right, x_right = reach(s, low, high, 0.0)
    up, y_up = reach(s, low, high, 1.0)
    left, x_left = reach(s, low, high, 2.0)
    down, y_down = reach(s, low, high, 3.0)
    tight = slack * max(width, height)
    r, r2, a = s.radius[0], s.radius[1], s.link[0]
    if max(right, x_right + r2) + max(left, x_left + r2) > width + tight:
        return math.nan
    if max(up, y_up + r2) + max(down, y_down + r2) > height + tight:
        return math.nan
    if 2.0 * max(r, r2) > min(width, height) + tight:
        return math.nan
    # gear 2 is between x_right and -x_left; from it to the motor only the motor link counts
    x_low = (max(right + x_left, r2) + r - width - tight) / a
    x_high = (width - r - max(left + x_right, r2) + tight) / a
    y_low = (max(up + y_down, r2) + r - height - tight) / a
    y_high = (height - r - max(down + y_up, r2) + tight) / a
    if max(x_low, y_low) > 1.0 or min(x_high, y_high) < -1.0 or x_low > x_high or y_low > y_high:
        return math.nan
    bend = least_bend(r + s.hub, a, s.link[1], s.link[2])
    if bend > 1.0 + slack:
        return math.nan
    middle = 0.5 * (low + high)
    wide = math.acos(max(-1.0, min(1.0, bend - slack))) + 0.5 * (high - low) + slack
    angles = np.empty(11)
    angles[0], angles[1], angles[2] = middle, middle - wide, middle + wide
    for k in range(2):
        c = math.acos(max(-1.0, min(1.0, x_high if k else x_low)))
        y = math.asin(max(-1.0, min(1.0, y_high if k else y_low)))
        angles[3 + 4 * k], angles[4 + 4 * k] = c, -c
        angles[5 + 4 * k], angles[6 + 4 * k] = y, math.pi - y
    edge = 1e-14 + slack  # a boundary point meets its own limit but for rounding
    for k in range(11):
        x, y = math.cos(angles[k]), math.sin(angles[k])
        off = abs((angles[k] - middle + math.pi) % (2.0 * math.pi) - math.pi)
        if x < x_low - edge or x > x_high + edge or y < y_low - edge or y > y_high + edge:
            continue
        if off <= wide + edge or wide >= math.pi:
            return angles[k]
    return math.nan


@inner
def smallest(s, angle, best):
    """Least scale at one angle of the output link, by halving from `best`, and the motor link."""
    found = room(s, best, angle, angle, 0.0)
    if math.isnan(found):
        return math.inf, found
    low, high = 0.0, best
    while high - low > 1e-15 * high:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        there = room(s, middle, angle, angle, 0.0)
        if math.isnan(there):
            low = middle
        else:
            high, found = middle, there
    return high, found


@entry
def search(s, cells, count, best, angles, rel, aim, limit):
    """Depth-first halving of intervals of the output link's angle, for one slice of cells.

    cells (size, 2): the open intervals, `count` in use. best: least scale so far, with its angles
    (2,). A cell is dropped when nothing in it is below best (1 - rel), or, while nothing is found,
    not above `aim`. Returns count, best, cells looked at, and whether one was too narrow to halve.
    """
    looked, stuck = 0, False
    while count > 0 and looked < limit:
        count -= 1
        looked += 1
        low, high = cells[count, 0], cells[count, 1]
        wanted = min(best * (1.0 - rel), aim)
        if math.isnan(room(s, wanted, low, high, SLACK)):
            continue
        middle = 0.5 * (low + high)
        value, motor = smallest(s, middle, wanted)
        if value < best:
            best, angles[0], angles[1] = value, motor, middle
        if count + 2 > cells.shape[0] or not low < middle < high:
            stuck = True
            continue
        cells[count, 0], cells[count, 1] = low, middle
        cells[count + 1, 0], cells[count + 1, 1] = middle, high
        count += 2
    return count, best, looked, stuck


@inner
def decided(s, cells, count, angles, limit):
    """Whether a train fits with the output link in the open cells; see `fits`.

    cells (size, 2): `count` in use. Also returns how many were judged. A layout that meets the box
    but for rounding fits: layouts are judged in one MEETS times as large.
    """
    looked = 0
    while count > 0:
        count -= 1
        looked += 1
        low, high = cells[count, 0], cells[count, 1]
        if math.isnan(room(s, 1.0, low, high, SLACK)):
            continue
        middle = 0.5 * (low + high)
        motor = room(s, MEETS, middle, middle, 0.0)
        if not math.isnan(motor):
            angles[0], angles[1] = motor, middle
            return 1, looked
        if looked >= limit or count + 2 > cells.shape[0] or not low < middle < high:
            return -1, looked
        cells[count, 0], cells[count, 1] = low, middle
        cells[count + 1, 0], cells[count + 1, 1] = middle, high
        count += 2
    return 0, looked


@entry
def fits(s, cells, angles, limit):
    """Whether a train fits its box of scale 1: 1 yes (angles), 0 proven no, -1 undecided."""
    cells[0, 0], cells[0, 1] = -math.pi, math.pi
    return decided(s, cells, ONE, angles, limit)[0]
