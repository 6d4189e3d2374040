"""How the load of a gear pair is shared by the tooth pairs that are in contact.

The forces F [N] along the line of action minimise the complementary energy of the mesh

    1/2 F'CF + e'F    subject to    sum F = W,  F >= 0,

with compliances C [mm/N] and separations e [mm], what lacks to contact of each pair when the
unloaded flanks are without relief and error: the material removed from both flanks, at least 0.
The multiplier of the equilibrium is the approach delta [mm] of the two gears along the line of
action, the loaded transmission error; those of F >= 0 are the gaps that remain [mm].
"""

import itertools
from typing import Any, NamedTuple

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]

CONTACT = 1e-9  # of a reference load: a pair carrying less is not said to be in contact
BLOCK = 8192  # positions computed at once: what they need stays in a processor's cache


class Sharing(NamedTuple):
    """Forces (..., n) [N], approach (...) [mm], gaps (..., n) [mm] of n tooth pairs."""

    forces: Array
    approach: Array
    gaps: Array


def share(compliances: Any, separations: Any, load: Any, coupling: Any = 0.0) -> Sharing:
    """Share a load between n tooth pairs with C = diag(c_i - c12) + c12, in closed form.

    With K_i = 1/(c_i - c12): delta = c12 W + d, sum_i K_i max(d - e_i, 0) = W, F_i = K_i max(d -
    e_i, 0), gap_i = max(e_i - d, 0). d is the least of (W + sum_S K e)/sum_S K over all sets S of
    pairs, so it is concave in e and in W and never falls with either. Found by dropping the pairs
    that it leaves open, at most n - 1 times.

    compliances c_i [mm/N] and separations e_i [mm]: (..., n), separations infinite where a pair is
    not on the path of contact (its compliance does not matter). load W [N]: (...), at least 0.
    coupling c12 [mm/N]: how much the load of one pair moves the others, 0 <= c12 < c_i. The forces
    sum to the load, to rounding; where no pair is on the path the approach is infinite and none
    carries. At W = 0 the approach is the least separation, the kinematic error of the pair.
    ValueError for values outside these ranges.
    """
    shape = np.broadcast_shapes(np.shape(compliances), np.shape(separations), (1,))
    shape = (*np.broadcast_shapes(shape[:-1], np.shape(load), np.shape(coupling)), shape[-1])
    c, e = (np.broadcast_to(a, shape).reshape(-1, shape[-1]) for a in (compliances, separations))
    w, c12 = (np.broadcast_to(a, shape[:-1]).ravel() for a in (load, coupling))
    _check_load(w)
    rows = len(w)
    forces, gaps, approach = (
        np.empty((rows, shape[-1])),
        np.empty((rows, shape[-1])),
        np.empty(rows),
    )
    for start in range(0, rows, BLOCK):
        part = slice(start, start + BLOCK)
        pairs = [np.ascontiguousarray(a[part].T) for a in (c, e)]  # a pair in a row: sums are fast
        found = _shared(pairs[0] - c12[part], pairs[1], w[part])
        forces[part], gaps[part] = found.forces.T, found.gaps.T
        approach[part] = found.approach + c12[part] * w[part]
    return Sharing(forces.reshape(shape), approach.reshape(shape[:-1]), gaps.reshape(shape))


def _check_load(load: Array) -> None:
    if not ((load >= 0.0) & (load < np.inf)).all():
        raise ValueError("a load is finite and at least 0")


def _shared(own: Array, separations: Array, load: Array) -> Sharing:
    """Return the sharing of uncoupled pairs, with rows (n, positions)."""
    absent = ~(separations < np.inf)
    if np.isnan(separations).any() or not ((own > 0.0) & (own < np.inf) | absent).all():
        raise ValueError("a compliance is finite and above the coupling, a separation no NaN")
    datum = separations.min(axis=0)
    none = ~(datum < np.inf)
    with np.errstate(invalid="ignore", divide="ignore"):
        stiffness, lead = 1.0 / own, separations - datum  # exact where it counts
    if absent.any():
        stiffness[absent] = lead[absent] = 0.0
    moments, rest = stiffness * lead, none.astype(float)
    depth = (load + moments.sum(axis=0)) / (rest + stiffness.sum(axis=0))
    for _ in range(len(own) - 1):
        if not (opened := lead > depth).any():
            break
        acting, moved = stiffness.copy(), moments.copy()
        acting[opened] = moved[opened] = 0.0
        depth = (load + moved.sum(axis=0)) / (rest + acting.sum(axis=0))
    forces = stiffness * np.maximum(depth - lead, 0.0)
    carried = forces.sum(axis=0)
    forces *= load / np.where(carried > 0.0, carried, 1.0)
    gaps = np.maximum(lead - depth, 0.0)
    if absent.any():
        gaps[absent] = np.inf
    return Sharing(forces, np.where(none, np.inf, depth + datum), gaps)


def share_dense(compliances: Any, separations: Any, load: Any) -> Sharing:
    """Share a load between a few tooth pairs with any symmetric positive definite C.

    Every set of pairs in contact is tried, 2^n - 1 of them, and the one is taken that meets C F + e
    - delta = gap, F >= 0, gap >= 0 best; the minimum is unique. For compliances of finite elements.
    compliances (..., n, n) [mm/N], separations (..., n) [mm], infinite where a pair is absent, load
    (...) [N], n at most 6. ValueError as `share`, and for more pairs.
    """
    matrix, count = np.asarray(compliances, float), np.shape(compliances)[-1]
    if count > 6:
        raise ValueError("a dense compliance takes at most 6 tooth pairs")
    shape = np.broadcast_shapes(matrix.shape[:-2], np.shape(separations)[:-1], np.shape(load))
    matrix = np.broadcast_to(matrix, (*shape, count, count))
    given = np.broadcast_to(np.asarray(separations, float), (*shape, count))
    w = np.broadcast_to(np.asarray(load, float), shape)
    _check_load(w)
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


def _closed(
    matrix: Array, lead: Array, load: Array, closed: Any, absent: Any
) -> tuple[Array, Sharing]:
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


def slopes(compliances: Any, forces: Any, coupling: Any = 0.0) -> tuple[Array, Array]:
    """Return the derivatives of the approach of `share`, at forces that it found.

    d delta/d e_i = K_i/sum K (..., n), of the pairs that carry, sums to 1; d delta/d W = c12 +
    1/sum K (...) [mm/N], the inverse of the tangent mesh stiffness. Where a pair just touches they
    are those of the side on which it carries nothing. Shapes and units as `share`.
    """
    carries = np.asarray(forces) > 0.0
    own = np.asarray(compliances) - np.asarray(coupling)[..., None]
    stiffness = np.where(carries, 1.0 / np.where(carries, own, 1.0), 0.0)
    total = stiffness.sum(axis=-1)
    return stiffness / total[..., None], np.asarray(coupling) + 1.0 / total


def in_contact(forces: Any, reference: float) -> Any:
    """Return whether pairs carry more than CONTACT of a reference load [N], such as the design's.

    A load of zero has no pair in contact, whatever rounding leaves of it.
    """
    return np.asarray(forces) > CONTACT * reference
