"""Load sharing by any dense compliance, by trying every set of pairs in contact: a second way."""

import itertools

import numpy as np

from gearopt.physics.load_sharing import Sharing


def share_dense(compliances, separations, load):
    """Share a load between a few tooth pairs with any symmetric positive definite C.

    Every set of pairs in contact is tried, 2^n - 1 of them, and the one is taken that meets C F + e
    - delta = gap, F >= 0, gap >= 0 best; the minimum is unique. For compliances of finite elements.
    compliances (..., n, n) [mm/N], separations (..., n) [mm], infinite where a pair is absent, load
    (...) [N], n at most 6. ValueError for more pairs.
    """
    matrix, count = np.asarray(compliances, float), np.shape(compliances)[-1]
    if count > 6:
        raise ValueError("a dense compliance takes at most 6 tooth pairs")
    shape = np.broadcast_shapes(matrix.shape[:-2], np.shape(separations)[:-1], np.shape(load))
    matrix = np.broadcast_to(matrix, (*shape, count, count))
    given = np.broadcast_to(np.asarray(separations, float), (*shape, count))
    w = np.broadcast_to(np.asarray(load, float), shape)
    absent = ~(given < np.inf)
    datum = np.where(absent.all(axis=-1), 0.0, given.min(axis=-1))
    lead = np.where(absent, 0.0, given - datum[..., None])
    best = Sharing(np.zeros_like(lead), np.full(shape, np.inf), np.full(lead.shape, np.inf))
    least = np.full(shape, np.inf)
    for size in range(1, count + 1):
        for closed in itertools.combinations(range(count), size):
            worst, found = _closed(matrix, lead, w, np.array(closed), absent)
            better = worst < least
            least = np.where(better, worst, least)
            best = Sharing(
                *(
                    np.where(better.reshape(better.shape + (1,) * (a.ndim - len(shape))), a, b)
                    for a, b in zip(found, best, strict=True)
                )
            )
    forces, gaps = np.maximum(best.forces, 0.0), np.maximum(best.gaps, 0.0)
    carried = forces.sum(axis=-1)
    forces *= (w / np.where(carried > 0.0, carried, 1.0))[..., None]
    return Sharing(forces, best.approach + datum, np.where(absent, np.inf, gaps))


def _closed(matrix, lead, load, closed, absent):
    """Sharing of pairs that are held closed, and their missing approach [mm]."""
    own = matrix[..., closed[:, None], closed]
    sides = np.stack([np.ones(lead[..., closed].shape), lead[..., closed]], axis=-1)
    solved = np.linalg.solve(own, sides)
    unit, moved = solved[..., 0], solved[..., 1]
    depth = (load + moved.sum(axis=-1)) / unit.sum(axis=-1)
    forces = np.zeros(lead.shape)
    forces[..., closed] = depth[..., None] * unit - moved
    gaps = np.einsum("...ij,...j->...i", matrix, forces) + lead - depth[..., None]
    gaps[..., closed] = 0.0
    pulled = forces * np.diagonal(matrix, axis1=-2, axis2=-1)
    lacks = np.maximum(-pulled, np.where(absent, -np.inf, -gaps)).max(axis=-1)
    lacks = np.where(absent[..., closed].any(axis=-1), np.inf, lacks)
    return lacks, Sharing(forces, depth, gaps)
