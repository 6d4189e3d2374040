"""Amounts of relief by rule, and every modification without transmission error, in closed form.

Source: Hwang, Hwang, Kim, Cho, A development of tooth profile modification for spur gear, section
3-3; its second rule corrected: the pair that enters or leaves is unloaded by a relief of W (c -
c12) of the pairs that stay, not by their whole deflection W c, as the loaded pairs move it along.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from gearopt.formulations.pair.relief.meshing import Mesh, Relief
from gearopt.optimise.terms import Array
from gearopt.physics.geometry.contact import ContactPath
from gearopt.physics.load_sharing import share

PARABOLIC = 2.0  # the exponent of the paper's curve


def tip_amounts(
    path: ContactPath, compliance: Callable[[Array], Any], coupling: float, load: float
) -> tuple[float, float]:
    """Return the relief [mm] of pinion and wheel tip with which a pair enters and leaves unloaded.

    At the end of the path the pinion's tip, at its start the wheel's: the depth d of the other
    pairs alone, sum K d = W over those a base pitch and more away, K = 1/(c - c12); below a contact
    ratio of 2 W (c - c12) at LPSTC and HPSTC. compliance of positions s [mm], [mm/N]; coupling c12
    = 0 gives the paper's own rule.
    """
    behind = np.arange(1, int(path.transverse_ratio) + 1) * path.base_pitch
    rows = (path.end - behind, path.start + behind)
    rows = tuple(s[(s >= path.start) & (s <= path.end)] for s in rows)
    approaches = [share(compliance(s), np.zeros(len(s)), load, coupling).approach for s in rows]
    pinion, wheel = (float(delta) - coupling * load for delta in approaches)
    return pinion, wheel


def short_relief(
    path: ContactPath, amounts: tuple[float, float], exponent: float = PARABOLIC
) -> tuple[Relief, Relief]:
    """Return reliefs of these amounts [mm] that begin where the last pair begins to share its load.

    Their length is the path of contact beyond a whole number of base pitches, from HPSTC to the
    pinion's tip and from LPSTC to the wheel's below a contact ratio of 2.
    """
    length = _shared_length(path)
    pinion, wheel = (Relief(amount, length, exponent) for amount in amounts)
    return pinion, wheel


def _shared_length(path: ContactPath) -> float:
    ratio = float(path.transverse_ratio)
    return float((ratio - np.floor(ratio)) * path.base_pitch)


def smooth_shares(mesh: Mesh) -> Array:
    """Return shares (p, n) of the load that rise and fall linearly where pairs enter and leave.

    Each pair's weight rises from 0 to 1 over the first part of its path, as long as the path beyond
    a whole number of base pitches, and falls so at the end; shares are weights over their sum.
    """
    length = _shared_length(mesh.cycle.path)
    leaving, entering = (np.minimum(x / length, 1.0) for x in mesh.from_tips)
    weights = np.where(mesh.cycle.present, np.minimum(leaving, entering), 0.0)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def without_error(mesh: Mesh, shares: Array, load: float) -> Array:
    """Return separations (p, n) [mm] with which the transmission error is constant at a load.

    e = delta* - (c - c12) F with the forces F = shares * load that are asked for, delta* = max (c -
    c12) F, so that nothing is added to a flank. All modifications without transmission error at
    this load are of this form. shares (p, n): sum to 1 at each position. At another load W the
    peak-to-peak is |W/load - 1| times that of the gears without relief while every pair stays in
    contact.
    """
    deflections = (mesh.compliances - mesh.coupling) * shares * load
    there = mesh.cycle.present
    return np.where(there, np.where(there, deflections, 0.0).max() - deflections, np.inf)
