"""Kernel of load sharing: the closed form of `physics.load_sharing.share`, many rows at a time."""

import math

import numpy as np

from gearopt.optimise.jit_kernel import entry, inner

LANES = 256  # rows at a time: what they need stays in the fastest cache


@entry
def share_rows(compliances, separations, load, coupling, forces, approach):
    """Fill forces (rows, n) [N] and approach (rows,) [mm] of loads (rows,) on n pairs.

    Uncoupled stiffnesses 1/(c - c12); the depth d with sum K max(d - e, 0) = W is approached from
    above by Newton's method, which drops the pairs that it leaves open. Loops over rows have no
    branches, so that they run in vector registers.
    """
    rows, pairs = compliances.shape
    stiffness, lead = np.empty((pairs, LANES)), np.empty((pairs, LANES))
    datum, depth, total, moved = np.empty(LANES), np.empty(LANES), np.empty(LANES), np.empty(LANES)
    for first in range(0, rows, LANES):
        many = min(LANES, rows - first)
        gather(compliances, separations, coupling, first, many, stiffness, lead, datum)
        for r in range(many):
            depth[r] = math.inf
        for _ in range(pairs):
            for r in range(many):
                total[r], moved[r] = 0.0, load[first + r]
            for i in range(pairs):
                for r in range(many):
                    acts = stiffness[i, r] if lead[i, r] <= depth[r] else 0.0
                    total[r] += acts
                    moved[r] += acts * lead[i, r]
            for r in range(many):
                depth[r] = moved[r] / total[r] if total[r] > 0.0 else 0.0
        for r in range(many):
            total[r] = 0.0
        for i in range(pairs):
            for r in range(many):
                lead[i, r] = stiffness[i, r] * max(depth[r] - lead[i, r], 0.0)
                total[r] += lead[i, r]
        for r in range(many):
            w = load[first + r]
            approach[first + r] = depth[r] + datum[r] + coupling * w
            part = w / total[r] if total[r] > 0.0 else 0.0
            for i in range(pairs):
                forces[first + r, i] = lead[i, r] * part


@inner
def gather(compliances, separations, coupling, first, many, stiffness, lead, datum):
    """Set stiffnesses and leads (n, LANES) over the least separation; absent pairs have none."""
    pairs = compliances.shape[1]
    for r in range(many):
        least = math.inf
        for i in range(pairs):
            least = min(least, separations[first + r, i])
        datum[r] = least
        for i in range(pairs):
            there = separations[first + r, i] < math.inf
            stiffness[i, r] = 1.0 / (compliances[first + r, i] - coupling) if there else 0.0
            lead[i, r] = separations[first + r, i] - least if there else 0.0
