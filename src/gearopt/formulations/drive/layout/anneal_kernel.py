"""Kernels of simulated annealing on link angles, and in the paper's way on free positions.

Both keep the best feasible point: link angles, so that every mesh is exact.
"""

import math

import numpy as np

from gearopt.formulations.drive.layout.chain_kernel import (
    ROUNDING,
    ZERO,
    measured_at_positions,
    value,
)
from gearopt.optimise.jit_kernel import entry, inner

HOT, COLD = 0.03, 3e-5  # temperatures, relative to the objective at the start
# steps of an angle [rad], shrinking with the root of the temperature
WIDEST_STEP, NARROWEST_STEP = 1.0, 1e-3
FREE = 8.0  # times as hot where positions are free: meshes must come apart first
PENALTY = 2.0  # energy of a violation as long as the root of the start's face area
MESH = 6.0  # the same, of a centre distance, where positions are free
OTHER = 0.05  # share of moves that try another arrangement of the slabs
TOUCHING, MESHING = 0.05, 0.3  # mm; what the free positions may lack to be worth repairing


@inner
def placed(chain, theta, y, z):
    """Positions of the shafts for search angles: those of closing links only choose a side."""
    y[0] = z[0] = 0.0
    for k in range(theta.size):
        a = chain.link[k]
        side = 1.0 if math.cos(theta[k]) >= 0.0 else -1.0
        if chain.close[k] == 1:
            height = z[int(chain.goal[k, 0])] + chain.goal[k, 2] - z[k]
            sine = min(1.0, max(-1.0, height / a))
            y[k + 1] = y[k] + side * a * math.sqrt(1.0 - sine * sine)
            z[k + 1] = z[k] + a * sine
        elif chain.close[k] == 4:
            cosine = min(1.0, max(-1.0, (chain.goal[k, 1] - y[k]) / a))
            y[k + 1] = y[k] + a * cosine
            z[k + 1] = z[k] + side * a * math.sqrt(1.0 - cosine * cosine)
        elif chain.close[k] == 2:
            b = chain.link[k + 1]
            dy, dz = chain.goal[k, 1] - y[k], chain.goal[k, 2] - z[k]
            d = max(math.sqrt(dy * dy + dz * dz), 1e-9 * a)
            cosine = min(1.0, max(-1.0, (a * a + d * d - b * b) / (2.0 * a * d)))
            turn = math.atan2(dz, dy) + side * math.acos(cosine)
            y[k + 1], z[k + 1] = y[k] + a * math.cos(turn), z[k] + a * math.sin(turn)
        elif chain.close[k] == 3:
            turn = math.atan2(chain.goal[k, 2] - z[k], chain.goal[k, 1] - y[k])
            y[k + 1], z[k + 1] = y[k] + a * math.cos(turn), z[k] + a * math.sin(turn)
        else:
            y[k + 1] = y[k] + a * math.cos(theta[k])
            z[k + 1] = z[k] + a * math.sin(theta[k])


@inner
def directions(y, z, theta):
    """The link angles of positions."""
    for k in range(theta.size):
        theta[k] = math.atan2(z[k + 1] - z[k], y[k + 1] - y[k])


@entry
def anneal(chain, seed, start, stop, total, theta, state, found):
    """Metropolis on link angles, steps `start` to `stop` of `total`.

    theta (N,): search angles, drawn when start is 0. state: arrangement, its energy, scale of
    energy, scale of length. found (N + 2,): best feasible value, its arrangement, its angles.
    """
    np.random.seed(seed)
    links = theta.size
    y, z = np.zeros(links + 1), np.zeros(links + 1)
    many = chain.factor.size
    if start == 0:
        found[0] = math.inf
        for k in range(links):
            theta[k] = np.random.uniform(-math.pi, math.pi)
        state[0] = np.random.randint(many)
        placed(chain, theta, y, z)
        width, height, short = measured_at_positions(chain, int(state[0]), y, z)
        state[2] = value(chain, int(state[0]), width, height)
        state[3] = math.sqrt(width * height)
        state[1] = 1.0 + PENALTY * short / state[3]
    for step in range(start, stop):
        temperature = HOT * (COLD / HOT) ** (step / total)
        size = max(WIDEST_STEP * math.sqrt(temperature / HOT), NARROWEST_STEP)
        k, m = np.random.randint(links), int(state[0])
        old, other = theta[k], m
        if many > 1 and np.random.random() < OTHER:
            other = np.random.randint(many)
        else:
            theta[k] += size * np.random.normal()
        placed(chain, theta, y, z)
        width, height, short = measured_at_positions(chain, other, y, z)
        objective = value(chain, other, width, height)
        energy = objective / state[2] + PENALTY * short / state[3]
        rise = energy - state[1]
        if rise <= 0.0 or np.random.random() < math.exp(-rise / temperature):
            state[0], state[1] = other, energy
            if short <= ROUNDING and objective < found[0]:
                found[0], found[1] = objective, other
                directions(y, z, found[2:])
        else:
            theta[k] = old


@entry
def anneal_positions(chain, seed, start, stop, total, y, z, state, found):
    """The paper's search: free positions, centre distances and overlaps as penalties.

    What it finds within TOUCHING and MESHING is repaired (links of exact length in the same
    directions) and counts if the repaired point is feasible. Arguments as in `anneal`.
    """
    np.random.seed(seed)
    links = chain.link.size
    theta = np.zeros(links)
    yy, zz = np.zeros(links + 1), np.zeros(links + 1)
    if start == 0:
        found[0] = math.inf
        span = 0.5 * chain.link.sum()
        for i in range(1, links + 1):
            y[i], z[i] = span * np.random.random(), span * np.random.random()
        width, height, short = measured_at_positions(chain, ZERO, y, z)
        state[2], state[3] = value(chain, ZERO, width, height), math.sqrt(width * height)
        state[1] = math.inf
    for step in range(start, stop):
        temperature = FREE * HOT * (COLD / HOT) ** (step / total)
        size = max(0.2 * state[3] * math.sqrt(temperature / HOT), 0.01)
        i = np.random.randint(1, links + 1)
        oldy, oldz = y[i], z[i]
        y[i] += size * np.random.normal()
        z[i] += size * np.random.normal()
        width, height, short = measured_at_positions(chain, ZERO, y, z)
        mesh = 0.0
        for k in range(links):
            dy, dz = y[k + 1] - y[k], z[k + 1] - z[k]
            mesh += abs(math.sqrt(dy * dy + dz * dz) - chain.link[k])
        objective = value(chain, ZERO, width, height)
        energy = objective / state[2] + (PENALTY * short + MESH * mesh) / state[3]
        rise = energy - state[1]
        if rise <= 0.0 or np.random.random() < math.exp(-rise / temperature):
            state[1] = energy
            if short <= TOUCHING and mesh <= MESHING and objective < 1.001 * found[0]:
                directions(y, z, theta)
                yy[0] = zz[0] = 0.0
                for k in range(links):
                    yy[k + 1] = yy[k] + chain.link[k] * math.cos(theta[k])
                    zz[k + 1] = zz[k] + chain.link[k] * math.sin(theta[k])
                width, height, short = measured_at_positions(chain, ZERO, yy, zz)
                objective = value(chain, ZERO, width, height)
                if short <= ROUNDING and objective < found[0]:
                    found[0], found[1] = objective, 0.0
                    found[2:] = theta
        else:
            y[i], z[i] = oldy, oldz
