"""How the load of a gear pair is shared by slices of its teeth that hold each other.

Forces F [N] on slices minimise the complementary energy 1/2 F'CF + e'F under sum F = W, F >= 0, as
of `load_sharing`, with C = diag(c) + K^-1 + c12: c of the contacts, K the springs of each pair of
teeth, a bed and links of neighbours (a Stieltjes matrix of three diagonals), c12 of all. C is the
inverse of an M-matrix, so that slices which pull leave for good (docs/proofs.md, lemma 91). Each
round solves (K + diag(1/c)) u = (delta - e)/c, linear in delta, by three diagonals.
"""

from typing import Any, NamedTuple

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]


class SliceSharing(NamedTuple):
    """Forces (..., n, m) [N] of m slices of n pairs, approach (...) and gaps (..., n, m) [mm]."""

    forces: Array
    approach: Array
    gaps: Array


class Springs(NamedTuple):
    """Compliances c (..., n, m) [mm/N] of contacts; bed (..., n, m) and links (..., n, m - 1).

    bed and links [N/mm]; coupling c12 [mm/N].
    """

    contacts: Array
    bed: Array
    links: Array
    coupling: float


def share_slices(springs: Springs, separations: Any, load: Any) -> SliceSharing:
    """Share loads W (...) [N] between slices with separations e (..., n, m) [mm].

    Infinite separations: no contact there. The forces sum to the load, to rounding. ValueError for
    a load below 0, and where a load meets no slice at all.
    """
    e = np.asarray(separations, float)
    shape = np.broadcast_shapes(e.shape, springs.contacts.shape, (*np.shape(load), 1, 1))
    e, contacts, bed = (np.broadcast_to(a, shape) for a in (e, springs.contacts, springs.bed))
    links = np.broadcast_to(springs.links, (*shape[:-1], shape[-1] - 1))
    w = np.broadcast_to(np.asarray(load, float), shape[:-2])
    if not ((w >= 0.0) & (w < np.inf)).all():
        raise ValueError("a load is finite and at least 0")
    datum = e.min(axis=(-2, -1))
    if not (datum < np.inf).all():
        raise ValueError("no slice is in contact")
    present = e < np.inf
    lead = np.where(present, e - datum[..., None, None], 0.0)
    acts = present.copy()
    stiff = np.where(present, 1.0 / np.where(present, contacts, 1.0), 0.0)
    whole = bed + _around(links)
    while True:
        active = np.where(acts, stiff, 0.0)
        a, b = _solved(whole + active, links, active, active * lead)
        rise, held = active * (1.0 - a), active * (lead - b)
        depth = (w + held.sum(axis=(-2, -1))) / rise.sum(axis=(-2, -1))
        forces = depth[..., None, None] * rise - held
        pulls = acts & (forces < 0.0)
        if not pulls.any():
            break
        acts &= ~pulls
    total = forces.sum(axis=(-2, -1))
    forces = forces * (w / np.where(total > 0.0, total, 1.0))[..., None, None]
    moved = depth[..., None, None] * a - b
    gaps = np.where(acts, 0.0, np.maximum(lead + moved - depth[..., None, None], 0.0))
    gaps = np.where(present, gaps, np.inf)
    return SliceSharing(forces, depth + datum + springs.coupling * w, gaps)


def _around(links: Any) -> Any:
    """Return the sum of the links (..., m - 1) at either side of each slice (..., m)."""
    around = np.zeros((*links.shape[:-1], links.shape[-1] + 1))
    around[..., :-1] += links
    around[..., 1:] += links
    return around


def _solved(diagonal: Any, links: Any, first: Any, second: Any) -> tuple[Any, Any]:
    """Return the solutions (..., m) of two right sides; off the diagonal stand minus the links."""
    pivots, held, a, b = (np.moveaxis(x, -1, 0).copy() for x in (diagonal, links, first, second))
    for k in range(1, len(pivots)):
        factor = held[k - 1] / pivots[k - 1]
        pivots[k] -= factor * held[k - 1]
        a[k] += factor * a[k - 1]
        b[k] += factor * b[k - 1]
    a[-1] /= pivots[-1]
    b[-1] /= pivots[-1]
    for k in range(len(pivots) - 2, -1, -1):
        a[k] = (a[k] + held[k] * a[k + 1]) / pivots[k]
        b[k] = (b[k] + held[k] * b[k + 1]) / pivots[k]
    return np.moveaxis(a, 0, -1), np.moveaxis(b, 0, -1)
