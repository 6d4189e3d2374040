"""Kernel of the monodromy matrix of a pair under a mesh stiffness of any shape."""

import math

import numpy as np

from gearopt.optimise.jit_kernel import entry, inner


@inner
def turned(inverse, held, damped, direction, k, y, out):
    """Derivative of displacements and velocities (2 n, columns); inverse: of the masses."""
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


@entry
def monodromy(tableau, system, wave, period, longest, found):
    """Carry the unit matrix over a period by Runge-Kutta steps of at most `longest` [s].

    tableau: table, weights, nodes. system: 1/masses, stiffness, damping, direction. wave: lengths
    of its pieces, stiffness at both ends, cosines, sines. found (2 n, 2 n) is written to.
    """
    table, weights, nodes = tableau
    inverse, held, damped, direction = system
    lengths, k0, k1, cosines, sines = wave
    size, stages = found.shape[0], weights.size
    found[:, :] = 0.0
    for i in range(size):
        found[i, i] = 1.0
    slopes, inside = np.empty((stages, size, size)), np.empty((size, size))
    start = 0.0
    for piece in range(lengths.size):
        long = lengths[piece] * period
        count = max(1, int(math.ceil(long / longest)))
        h = long / count
        for step in range(count):
            for s in range(stages):
                inside[:, :] = found
                for j in range(s):
                    share = h * table[s, j]
                    if share != 0.0:
                        for a in range(size):
                            for b in range(size):
                                inside[a, b] += share * slopes[j, a, b]
                within = (step + nodes[s]) / count
                k = k0[piece] + (k1[piece] - k0[piece]) * within
                phase = start + lengths[piece] * within
                for m in range(cosines.size):
                    angle = 2.0 * math.pi * (m + 1) * phase
                    k += cosines[m] * math.cos(angle) + sines[m] * math.sin(angle)
                turned(inverse, held, damped, direction, k, inside, slopes[s])
            for j in range(stages):
                share = h * weights[j]
                if share != 0.0:
                    for a in range(size):
                        for b in range(size):
                            found[a, b] += share * slopes[j, a, b]
        start += lengths[piece]
    return 0
