"""Kernel of the monodromy matrix of a pair under a mesh stiffness of any shape."""

import math

import numpy as np

from gearopt.optimise.jit_kernel import entry, inlined


@inlined
def state_derivative(inverse, held, damped, direction, k, y, out):
    """Write the time derivative of states y (2 n, columns), displacements over velocities, to out.

    inverse (n,): 1/masses; held, damped (n, n): stiffness and damping of the supports; k: mesh
    stiffness along direction (n,).
    """
    n, columns = direction.size, y.shape[1]
    for c in range(columns):
        delta = 0.0
        for i in range(n):
            delta += direction[i] * y[i, c]
        for i in range(n):
            out[i, c] = y[n + i, c]
            force = k * direction[i] * delta
            for j in range(n):
                force += held[i, j] * y[j, c] + damped[i, j] * y[n + j, c]
            out[n + i, c] = -force * inverse[i]


@inlined
def stiffness(k0, k1, within, phase, cosines, sines):
    """Stiffness at a share of a straight piece and a phase of the period."""
    k = k0 + (k1 - k0) * within
    for m in range(cosines.size):
        angle = 2.0 * math.pi * (m + 1) * phase
        k += cosines[m] * math.cos(angle) + sines[m] * math.sin(angle)
    return k


@inlined
def summed(y, h, shares, slopes, count, out):
    """Write y and h times the sum of shares of the first slopes to out."""
    size = y.shape[0]
    for a in range(size):
        for b in range(size):
            out[a, b] = y[a, b]
    for j in range(count):
        share = h * shares[j]
        if share != 0.0:
            for a in range(size):
                for b in range(size):
                    out[a, b] += share * slopes[j, a, b]


@entry
def monodromy(tableau, system, wave, period, longest, begin, found):
    """Carry the unit matrix over pieces of a period by Runge-Kutta steps of at most `longest` [s].

    tableau: table, weights, nodes. system: 1/masses, stiffness, damping, direction. wave: lengths
    of the pieces, stiffness at both ends, cosines, sines. begin: the phase of the first. found
    (2 n, 2 n) is written to.
    """
    table, weights, nodes = tableau
    inverse, held, damped, direction = system
    lengths, k0, k1, cosines, sines = wave
    size, stages = found.shape[0], weights.size
    for a in range(size):
        for b in range(size):
            found[a, b] = 1.0 if a == b else 0.0
    slopes, inside = np.empty((stages, size, size)), np.empty((size, size))
    start = begin
    for piece in range(lengths.size):
        long = lengths[piece] * period
        count = max(1, int(math.ceil(long / longest)))
        h = long / count
        for step in range(count):
            for s in range(stages):
                summed(found, h, table[s], slopes, s, inside)
                within = (step + nodes[s]) / count
                phase = start + lengths[piece] * within
                k = stiffness(k0[piece], k1[piece], within, phase, cosines, sines)
                state_derivative(inverse, held, damped, direction, k, inside, slopes[s])
            summed(found, h, weights, slopes, stages, found)
        start += lengths[piece]
    return 0
