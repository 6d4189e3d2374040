"""Kernels of explicit steps: Runge-Kutta of any tableau, with separation located, and symplectic.

A motion is marched over intervals in which the stiffness is a straight line (and a Fourier sum):
starts, lengths [s], k0, k1 [N/mm] at both ends, and how many steps each takes.
"""

import math

import numpy as np

from gearopt.formulations.dynamics.motion.motion_kernel import derivative, flank_of, opening, waves
from gearopt.optimise.jit_kernel import entry, inlined

NARROW = 1e-13  # share of a step to which an event is located: rounding of a double
HALVES = 12  # of a step, until a short separation is ahead of it or begins in it
PIECES = 64  # parts that a step is cut into where teeth part and meet, at most


@inlined
def step(m, w, table, weights, nodes, place, line, flank, h, y, new, slopes, inside):
    """One step of size h from time line[0] + place; k = line[1] + line[2] (time - line[0])."""
    size, stages = y.size, weights.size
    for s in range(stages):
        for i in range(size):
            inside[i] = y[i]
        for j in range(s):  # by rows, which the compiler makes vectors of
            share = h * table[s, j]
            if share != 0.0:
                for i in range(size):
                    inside[i] += share * slopes[j, i]
        within = place + nodes[s] * h
        k, shake = waves(m, w, line[0] + within)
        derivative(m, line[1] + line[2] * within + k, shake, flank, inside, slopes[s])
    for i in range(size):
        new[i] = y[i]
    for j in range(stages):
        share = h * weights[j]
        if share != 0.0:
            for i in range(size):
                new[i] += share * slopes[j, i]


@inlined
def beyond(m, flank, y):
    """How far a state is past the end of its flank: positive where it must change."""
    delta, _, room, _ = opening(m, y)
    if flank == 0:
        return delta
    if flank == 2:
        return room - delta
    return max(-delta, delta - room)


@inlined
def crests(h, a, b, p, q):
    """Whether the cubic with values a, b and rates p, q at the ends of h is positive inside."""
    if not p > 0.0 > q:
        return False
    share = p / (p - q)  # where the rate, as a straight line, is zero
    rest = 1.0 - share
    top = (1.0 + 2.0 * share) * rest * rest * a + share * rest * rest * h * p
    top += share * share * (3.0 - 2.0 * share) * b - share * share * rest * h * q
    return top > 0.0


@inlined
def swings(m, flank, h, y, new):
    """Whether a step leaves its flank and comes back, by a cubic through both ends."""
    d0, r0, room, w0 = opening(m, y)
    d1, r1, other, w1 = opening(m, new)
    if flank == 0:
        return crests(h, d0, d1, r0, r1)
    if flank == 2:
        return crests(h, room - d0, other - d1, w0 - r0, w1 - r1)
    if crests(h, -d0, -d1, -r0, -r1):
        return True
    return crests(h, d0 - room, d1 - other, r0 - w0, r1 - w1)


@inlined
def located(m, w, table, weights, nodes, place, line, flank, left, above, y, new, slopes, inside):
    """Size of the step that ends a hair past the end of its flank; `above`: how far `left` is past.

    A step may begin where it came onto its flank, also a zero of what is looked for: not that one.
    """
    low, high, below = 0.0, 1.0, min(beyond(m, flank, y), 0.0)
    share, span, near = 1.0, above - below, False
    begun = below < -NARROW * span
    for turn in range(90):
        share = low + (high - low) * below / (below - above)
        if high - low <= NARROW:
            share = high
        elif near:
            share = min(low + 4.0 * NARROW, high)
        elif turn % 3 == 2 or not low < share < high or not begun:
            share = 0.5 * (low + high)
        step(m, w, table, weights, nodes, place, line, flank, share * left, y, new, slopes, inside)
        past = beyond(m, flank, new)
        if past > 0.0:
            if share == high or past <= NARROW * span:
                break
            high, above, near = share, past, False
        else:
            low, below = share, past
            begun = begun or past < -NARROW * span
            near = begun and past >= -NARROW * span
    return share * left


@inlined
def carried(m, w, table, weights, nodes, place, line, flank, h, y, new, slopes, inside):
    """One step of h, cut where teeth part and meet; the flank at its end, and events counted."""
    left, events = h, 0
    for piece in range(PIECES):
        past, last = 0.0, m.backlash == math.inf or piece == PIECES - 1
        for halving in range(HALVES + 1):
            if halving > 0:
                left *= 0.5
            step(m, w, table, weights, nodes, place, line, flank, left, y, new, slopes, inside)
            if last:
                break
            past = beyond(m, flank, new)
            if past > 0.0 or not swings(m, flank, left, y, new):
                break
        if past > 0.0:
            left = located(
                m, w, table, weights, nodes, place, line, flank, left, past, y, new, slopes, inside
            )
            delta, _, room, _ = opening(m, new)
            flank = (0 if delta <= 0.5 * room else 2) if flank == 1 else 1
            events += 1
        for i in range(y.size):
            y[i] = new[i]
        place += left
        h -= left
        left = h
        if last or h <= 0.0:
            break
    if last:
        flank = flank_of(m, y)
    return flank, events


@inlined
def jams(m, y):
    """Whether both flanks are pressed at once, as the axes came together."""
    delta, _, room, _ = opening(m, y)
    return room < delta < 0.0


@entry
def march(pair, w, table, weights, nodes, starts, lengths, k0, k1, counts, y, out, told):
    """Runge-Kutta steps; out[i] is the state at the end of interval i. Return events located.

    told: the flank at the start, or -1: that of the state; at the end that there. Then when first
    both flanks were pressed at once, inf: not yet.
    """
    m, size = pair[0], y.size
    slopes, inside = np.empty((weights.size, size)), np.empty(size)
    new, line = np.empty(size), np.empty(3)
    flank, events = int(told[0]), 0
    if flank < 0:
        flank = flank_of(m, y)
    for i in range(starts.size):
        h = lengths[i] / counts[i]
        line[0], line[1], line[2] = starts[i], k0[i], (k1[i] - k0[i]) / lengths[i]
        for j in range(counts[i]):
            flank, more = carried(
                m, w, table, weights, nodes, j * h, line, flank, h, y, new, slopes, inside
            )
            events += more
            if told[1] == math.inf and m.backlash < math.inf and m.level > 4 and jams(m, y):
                told[1] = starts[i] + (j + 1) * h
        for a in range(size):
            out[i, a] = y[a]
    told[0] = flank
    return events


@entry
def compose(pair, w, weights, starts, lengths, k0, k1, counts, y, out):
    """Compositions of the Stoermer-Verlet step (half a drift, a kick, half a drift)."""
    m = pair[0]
    n = m.level
    rate = np.empty(2 * n)
    for i in range(starts.size):
        h = lengths[i] / counts[i]
        slope = (k1[i] - k0[i]) / lengths[i]
        for j in range(counts[i]):
            within = j * h
            for share in weights:
                part = share * h
                for a in range(n):
                    y[a] += 0.5 * part * y[n + a]
                at = within + 0.5 * part
                k, shake = waves(m, w, starts[i] + at)
                derivative(m, k0[i] + slope * at + k, shake, flank_of(m, y), y, rate)
                for a in range(n):
                    y[n + a] += part * rate[n + a]
                    y[a] += 0.5 * part * y[n + a]
                within += part
        for a in range(2 * n):
            out[i, a] = y[a]
    return 0


@entry
def rates(pair, w, t, k, flank, y, out):
    """`motion_kernel.derivative` at a time, with the Fourier part of the stiffness added to k."""
    m = pair[0]
    more, shake = waves(m, w, t)
    derivative(m, k + more, shake, flank, y, out)


@entry
def flank_now(pair, y):
    """`motion_kernel.flank_of`."""
    return flank_of(pair[0], y)


@entry
def past(pair, flank, y):
    """How far a state is past the end of its flank [mm]."""
    return beyond(pair[0], flank, y)
