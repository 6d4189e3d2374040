"""How the load of a gear pair is shared by the tooth pairs that are in contact.

The forces F [N] along the line of action minimise the complementary energy of the mesh

    1/2 F'CF + e'F    subject to    sum F = W,  F >= 0,

with compliances C [mm/N] and separations e [mm], what lacks to contact of each pair when the
unloaded flanks are without relief and error: the material removed from both flanks, at least 0.
The multiplier of the equilibrium is the approach delta [mm] of the two gears along the line of
action, the loaded transmission error; those of F >= 0 are the gaps that remain [mm].
"""

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
        shared = _shared(pairs[0] - c12[part], pairs[1], w[part])
        forces[part], gaps[part] = shared.forces.T, shared.gaps.T
        approach[part] = shared.approach + c12[part] * w[part]
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


def slopes(compliances: Any, forces: Any, coupling: Any = 0.0) -> tuple[Array, Array]:
    """Return the derivatives of the approach of `share`, at forces that it found.

    d delta/d e_i = K_i/sum K (..., n), of the pairs that carry, sums to 1; d delta/d W = c12 +
    1/sum K (...) [mm/N], the inverse of the tangent mesh stiffness. Where a pair just touches they
    are those of the side on which it carries nothing. Shapes and units as `share`.
    """
    carries = np.asarray(forces) > 0.0
    uncoupled = np.asarray(compliances) - np.asarray(coupling)[..., None]
    stiffness = np.where(carries, 1.0 / np.where(carries, uncoupled, 1.0), 0.0)
    total = stiffness.sum(axis=-1)
    return stiffness / total[..., None], np.asarray(coupling) + 1.0 / total


def in_contact(forces: Any, reference: float) -> Any:
    """Return whether pairs carry more than CONTACT of a reference load [N], such as the design's.

    A load of zero has no pair in contact, whatever rounding leaves of it.
    """
    return np.asarray(forces) > CONTACT * reference
