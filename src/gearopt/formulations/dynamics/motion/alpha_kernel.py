"""Kernel of the generalised-alpha family: Newmark, HHT and its own, with Newton's method.

Unknowns are the accelerations; the row of delta holds those of the axes. Left out of the Jacobian:
what the gradient of g changes by within a step, smaller than the rest by (omega h)^2.
"""

import math

import numpy as np

from gearopt.formulations.dynamics.motion.motion_kernel import (
    contact,
    derivative,
    flank_of,
    grown,
    waves,
)
from gearopt.optimise.jit_kernel import entry, inlined

RESIDUAL_TOLERANCE = 1e-8  # residual of the accelerations before the last correction, relative
MAX_CORRECTIONS = 12  # of its steps: far more than the linear pieces need


@inlined
def eliminate(a, b):
    """Solve a x = b in place by elimination with pivots; x is written to b."""
    n = b.size
    for i in range(n):
        pivot = i
        for r in range(i + 1, n):
            if abs(a[r, i]) > abs(a[pivot, i]):
                pivot = r
        if pivot != i:
            for c in range(n):
                a[i, c], a[pivot, c] = a[pivot, c], a[i, c]
            b[i], b[pivot] = b[pivot], b[i]
        for r in range(i + 1, n):
            f = a[r, i] / a[i, i]
            if f != 0.0:
                for c in range(i, n):
                    a[r, c] -= f * a[i, c]
                b[r] -= f * b[i]
    for i in range(n - 1, -1, -1):
        for c in range(i + 1, n):
            b[i] -= a[i, c] * b[c]
        b[i] /= a[i, i]


@inlined
def jacobian(m, k, flank, y, cq, cv, own, out):
    """Residual by acceleration; cq, cv: position by acceleration, velocity by acceleration."""
    n, axes = m.level, m.level // 2
    gap = cv * m.drag
    if flank != 1:
        gap += cq * k + cv * m.damping
    for i in range(n):
        for j in range(n):
            out[i, j] = 0.0
        out[i, i] = own
    out[axes, axes] += gap / m.mesh_mass
    if n == 3:
        out[0, 0] += (cq * m.kx1 + cv * m.cx1) / m.m1
        out[2, 2] += (cq * m.kx2 + cv * m.cx2) / m.m2
        out[0, 1] -= gap / m.m1
        out[2, 1] += gap / m.m2
        out[1, 0] += own
        out[1, 2] -= own
    elif n == 5:
        of_plane(m, flank, y, cq, cv, own, gap, out)


@inlined
def of_plane(m, flank, y, cq, cv, own, gap, out):
    """Add to a Jacobian what axes that move in the plane bring in; gap: of the mesh force."""
    u, v, wu, wv = y[3] - y[0], y[4] - y[1], y[8] - y[5], y[9] - y[6]
    _, gu, gv, suu, suv, svv = contact(m, u, v)
    turned, tilted = 2.0 * cv * (suu * wu + suv * wv), 2.0 * cv * (suv * wu + svv * wv)
    out[0, 0] += (cq * m.kx1 + cv * m.cx1) / m.m1
    out[1, 1] += (cq * m.ky1 + cv * m.cy1) / m.m1
    out[3, 3] += (cq * m.kx2 + cv * m.cx2) / m.m2
    out[4, 4] += (cq * m.ky2 + cv * m.cy2) / m.m2
    out[2, 0] += own * gu + turned
    out[2, 1] += own * gv + tilted
    out[2, 3] -= own * gu + turned
    out[2, 4] -= own * gv + tilted
    du, dv, ru, rv = gu, gv, 0.0, 0.0
    if flank == 2:
        _, ru, rv = grown(m, u, v)
        du, dv = gu - ru, gv - rv
    for i, d, mass in ((0, du, m.m1), (1, dv, m.m1), (3, -du, m.m2), (4, -dv, m.m2)):
        out[i, 2] -= gap * d / mass
        for j, r in ((0, -ru), (1, -rv), (3, ru), (4, rv)):
            out[i, j] += gap * d * r / mass
    for j, r in ((0, -ru), (1, -rv), (3, ru), (4, rv)):
        out[2, j] -= gap * r / m.mesh_mass


@inlined
def residual(m, k, shake, flank, y, given, rate, out):
    """Accelerations less those of the forces; in the row of delta those of the axes are given."""
    n, axes = m.level, m.level // 2
    derivative(m, k, shake, flank, y, rate)
    for i in range(n):
        out[i] = given[i] - rate[n + i]
    if n == 3:
        out[1] += (rate[5] - rate[3]) - (given[2] - given[0])
    elif n == 5:
        _, gu, gv, _, _, _ = contact(m, y[3] - y[0], y[4] - y[1])
        turned = gu * (rate[8] - rate[5]) + gv * (rate[9] - rate[6])
        out[axes] += turned - gu * (given[3] - given[0]) - gv * (given[4] - given[1])


@inlined
def ended(alphas, h, y, old, found, new):
    """Write the state after a step of h from y, with accelerations `old` and `found`, to new."""
    _, _, beta, gamma = alphas
    n = old.size
    for a in range(n):
        new[a] = y[a] + h * y[n + a] + h * h * ((0.5 - beta) * old[a] + beta * found[a])
        new[n + a] = y[n + a] + h * ((1.0 - gamma) * old[a] + gamma * found[a])


@inlined
def corrected(m, alphas, k, shake, h, y, old, found, new, middle, given, wrong, rate, matrix):
    """Correct the accelerations `found` by a step of Newton's; return whether it was the last."""
    am, af, beta, gamma = alphas
    n = m.level
    ended(alphas, h, y, old, found, new)
    for a in range(n):
        given[a] = (1.0 - am) * found[a] + am * old[a]
    for a in range(2 * n):
        middle[a] = (1.0 - af) * new[a] + af * y[a]
    flank = flank_of(m, middle)
    residual(m, k, shake, flank, middle, given, rate, wrong)
    most, size = 0.0, 0.0
    for a in range(n):
        most, size = max(most, abs(wrong[a])), max(size, abs(found[a]))
    cq, cv = (1.0 - af) * beta * h * h, (1.0 - af) * gamma * h
    jacobian(m, k, flank, middle, cq, cv, 1.0 - am, matrix)
    eliminate(matrix, wrong)
    for a in range(n):
        found[a] -= wrong[a]
    return most <= RESIDUAL_TOLERANCE * size or not math.isfinite(most)


@entry
def advance(pair, w, alphas, starts, lengths, k0, k1, counts, y, out):
    """March with alphas (alpha_m, alpha_f, beta, gamma); return Newton's steps."""
    m = pair[0]
    n = m.level
    rate, middle, new = np.empty(2 * n), np.empty(2 * n), np.empty(2 * n)
    old, found, given, wrong = np.zeros(n), np.empty(n), np.empty(n), np.empty(n)
    matrix, turns = np.empty((n, n)), 0
    for i in range(starts.size):
        h = lengths[i] / counts[i]
        if i == 0 or k0[i] != k1[i - 1]:  # the acceleration jumps with the stiffness
            k, shake = waves(m, w, starts[i])
            derivative(m, k0[i] + k, shake, flank_of(m, y), y, rate)
            for a in range(n):
                old[a] = rate[n + a]
        slope = (k1[i] - k0[i]) / lengths[i]
        for j in range(counts[i]):
            within = (j + 1.0 - alphas[1]) * h
            k, shake = waves(m, w, starts[i] + within)
            k += k0[i] + slope * within
            for a in range(n):
                found[a] = old[a]
            for _ in range(MAX_CORRECTIONS):
                turns += 1
                if corrected(
                    m, alphas, k, shake, h, y, old, found, new, middle, given, wrong, rate, matrix
                ):
                    break
            ended(alphas, h, y, old, found, new)
            for a in range(n):
                old[a] = found[a]
            for a in range(2 * n):
                y[a] = new[a]
        for a in range(2 * n):
            out[i, a] = y[a]
    return turns
