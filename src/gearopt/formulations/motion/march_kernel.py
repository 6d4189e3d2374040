"""Kernels of explicit steps: Runge-Kutta of any tableau, with separation located, and symplectic.

A motion is marched over intervals in which the stiffness is a straight line (and a Fourier sum):
starts, lengths [s], k0, k1 [N/mm] at both ends, and how many steps each takes.
"""

import math

import numpy as np

from gearopt.formulations.motion.motion_kernel import derivative, flank_of, opening, waves
from gearopt.optimise.jit_kernel import entry, inner

NARROW = 1e-13  # share of a step to which an event is located: rounding of a double
HALVES = 12  # of a step, until a short separation is ahead of it or begins in it
PIECES = 64  # parts that a step is cut into where teeth part and meet, at most


@inner
def step(m, table, weights, nodes, place, line, flank, h, y, new, slopes, inside):
    """One step of size h from time line[0] + place; k = line[1] + line[2] (time - line[0])."""
    size, stages = y.size, weights.size
    for s in range(stages):
        inside[:] = y
        for j in range(s):  # by rows, which the compiler makes vectors of
            share = h * table[s, j]
            if share != 0.0:
                for i in range(size):
                    inside[i] += share * slopes[j, i]
        within = place + nodes[s] * h
        k = line[1] + line[2] * within + waves(m, line[0] + within)
        derivative(m, line[0] + within, k, flank, inside, slopes[s])
    new[:] = y
    for j in range(stages):
        share = h * weights[j]
        if share != 0.0:
            for i in range(size):
                new[i] += share * slopes[j, i]


@inner
def beyond(m, flank, y):
    """How far a state is past the end of its flank: positive where it must change."""
    delta, _, room, _ = opening(m, y)
    if flank == 0:
        return delta
    if flank == 2:
        return room - delta
    return max(-delta, delta - room)


@inner
def crests(h, a, b, p, q, margin):
    """Whether the cubic with values a, b and rates p, q at the ends of h is positive inside.

    margin: share of h (p - q), which is 8 times the height of the crest, that may be missing.
    """
    if not p > 0.0 > q:
        return False
    share = p / (p - q)  # where the rate, as a straight line, is zero
    rest = 1.0 - share
    top = (1.0 + 2.0 * share) * rest * rest * a + share * rest * rest * h * p
    top += share * share * (3.0 - 2.0 * share) * b - share * share * rest * h * q
    return top > margin * h * (q - p)


@inner
def swings(m, flank, h, y, new, margin):
    """Whether a step leaves its flank and comes back, by a cubic through both ends."""
    d0, r0, room, w0 = opening(m, y)
    d1, r1, other, w1 = opening(m, new)
    if flank == 0:
        return crests(h, d0, d1, r0, r1, margin)
    if flank == 2:
        return crests(h, room - d0, other - d1, w0 - r0, w1 - r1, margin)
    if crests(h, -d0, -d1, -r0, -r1, margin):
        return True
    return crests(h, d0 - room, d1 - other, r0 - w0, r1 - w1, margin)


@inner
def located(m, table, weights, nodes, place, line, flank, left, above, y, new, slopes, inside):
    """Size of the step at whose end the flank changes; `above`: how far one of `left` is past.

    A step may begin where it came onto its flank, also a zero of what is looked for: not that one.
    """
    low, high, below = 0.0, 1.0, min(beyond(m, flank, y), 0.0)
    share, span = 1.0, above - below
    begun = below < -NARROW * span
    for turn in range(90):
        share = low + (high - low) * below / (below - above)
        if turn % 3 == 2 or not low < share < high or not begun:
            share = 0.5 * (low + high)
        step(m, table, weights, nodes, place, line, flank, share * left, y, new, slopes, inside)
        past = beyond(m, flank, new)
        if past > 0.0:
            high, above = share, past
        else:
            low, below = share, past
            begun = begun or past < -NARROW * span
        if high - low <= NARROW or (begun and abs(past) <= NARROW * span):
            break
    return share * left


@inner
def carried(m, table, weights, nodes, place, line, flank, h, y, new, slopes, inside):
    """One step of h in which teeth may part and meet; the flank at its end, and events counted."""
    left, events = h, 0
    for _ in range(PIECES):
        step(m, table, weights, nodes, place, line, flank, left, y, new, slopes, inside)
        past = beyond(m, flank, new)
        for _ in range(HALVES):
            if past > 0.0 or not swings(m, flank, left, y, new, 0.0):
                break
            left *= 0.5
            step(m, table, weights, nodes, place, line, flank, left, y, new, slopes, inside)
            past = beyond(m, flank, new)
        if past > 0.0:
            left = located(
                m, table, weights, nodes, place, line, flank, left, past, y, new, slopes, inside
            )
            delta, _, room, _ = opening(m, new)
            flank = (0 if delta <= 0.5 * room else 2) if flank == 1 else 1
            events += 1
        y[:] = new
        place += left
        h -= left
        left = h
        if h <= 0.0:
            return flank, events
    step(m, table, weights, nodes, place, line, flank, left, y, new, slopes, inside)
    y[:] = new
    return flank_of(m, y), events


@entry
def march(m, table, weights, nodes, starts, lengths, k0, k1, counts, y, out):
    """Runge-Kutta steps; out[i] is the state at the end of interval i. Return events located."""
    size = y.size
    slopes, inside = np.empty((weights.size, size)), np.empty(size)
    new, line = np.empty(size), np.empty(3)
    flank, events = flank_of(m, y), 0
    for i in range(starts.size):
        h = lengths[i] / counts[i]
        line[0], line[1], line[2] = starts[i], k0[i], (k1[i] - k0[i]) / lengths[i]
        for j in range(counts[i]):
            if m.backlash < math.inf:
                flank, more = carried(
                    m, table, weights, nodes, j * h, line, flank, h, y, new, slopes, inside
                )
                events += more
            else:
                step(m, table, weights, nodes, j * h, line, flank, h, y, new, slopes, inside)
                y[:] = new
        out[i] = y
    return events


@entry
def compose(m, weights, starts, lengths, k0, k1, counts, y, out):
    """Compositions of the Stoermer-Verlet step (half a drift, a kick, half a drift)."""
    n = m.level
    rate = np.empty(2 * n)
    for i in range(starts.size):
        h = lengths[i] / counts[i]
        slope = (k1[i] - k0[i]) / lengths[i]
        for j in range(counts[i]):
            within = j * h
            for w in weights:
                part = w * h
                for a in range(n):
                    y[a] += 0.5 * part * y[n + a]
                at = within + 0.5 * part
                k = k0[i] + slope * at + waves(m, starts[i] + at)
                derivative(m, starts[i] + at, k, flank_of(m, y), y, rate)
                for a in range(n):
                    y[n + a] += part * rate[n + a]
                    y[a] += 0.5 * part * y[n + a]
                within += part
        out[i] = y
    return 0


@entry
def rates(m, t, k, flank, y, out):
    """`motion_kernel.derivative`, with the Fourier part of the stiffness added to k."""
    derivative(m, t, k + waves(m, t), flank, y, out)


@entry
def flank_now(m, y):
    """`motion_kernel.flank_of`."""
    return flank_of(m, y)


@entry
def past(m, flank, y):
    """How far a state is past the end of its flank [mm]."""
    return beyond(m, flank, y)


@entry
def swung(m, flank, h, y, new, margin):
    """Whether a motion of h [s] from y to new may have left its flank and come back."""
    return swings(m, flank, h, y, new, margin)
