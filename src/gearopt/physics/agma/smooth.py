"""I and J for a gradient solver: one text without branches, and its error.

The regime is chosen beforehand, the tool angles of the critical sections are variables of the
problem, and the tangency of the parabolas are its equalities: no table and no inner loop. For m_F >
1 the load sharing ratio is that of the mean length of contact, as the least one has kinks.
"""

from typing import Any

from gearopt.frozen import dataclass
from gearopt.physics.agma.bending import (
    bending_factor,
    bending_factors,
    critical_theta,
    loaded_tooth,
    seen_from_wheel,
    tangency,
)
from gearopt.physics.agma.mesh import mesh_of, pitting_factor
from gearopt.physics.gears import GearPair


@dataclass(frozen=True)
class SmoothFactors:
    """I and (J_1, J_2), which hold where both tangencies [normal modules] are 0."""

    pitting: Any
    bending: tuple[Any, Any]
    tangencies: tuple[Any, Any]


def smooth_factors(
    pair: GearPair, regime: str, thetas: tuple[Any, Any], load: str = "highest single"
) -> SmoothFactors:
    """Return I and J of a pair at tool angles theta of pinion and wheel [rad].

    pair: of floats, arrays or casadi scalars; regime: one of `mesh.REGIMES`; thetas between alpha_n
    and pi/2, to be found by a solver, from `critical_theta` or 1. At the tangency both J are at
    their least value over theta but for K_f, whose section is that of the tangency by definition.
    """
    mesh = mesh_of(pair, regime, smooth=True)
    teeth = [loaded_tooth(m, load) for m in (mesh, seen_from_wheel(mesh))]
    first, second = (bending_factor(t, a).value for t, a in zip(teeth, thetas, strict=True))
    slack1, slack2 = (tangency(t, a) for t, a in zip(teeth, thetas, strict=True))
    return SmoothFactors(pitting_factor(mesh), (first, second), (slack1, slack2))


def smooth_error(
    pair: GearPair, regime: str, load: str = "highest single"
) -> tuple[float, float, float]:
    """Return I, J_1 and J_2 of the smooth form less the exact ones, relative to these.

    Of a pair of floats. Rounding alone for spur gears and m_F <= 1; for m_F > 1 the two load
    sharing ratios: -5 to +7 % (positive: the smooth form is optimistic), see tests/physics/agma.
    """
    mesh = mesh_of(pair, regime)
    teeth = [loaded_tooth(m, load) for m in (mesh, seen_from_wheel(mesh))]
    thetas = critical_theta(teeth[0]), critical_theta(teeth[1])
    smooth = smooth_factors(pair, regime, thetas, load)
    exact = [f.value for f in bending_factors(pair, load)]
    pitting = float(smooth.pitting / pitting_factor(mesh_of(pair))) - 1.0
    first, second = (float(a / b) - 1.0 for a, b in zip(smooth.bending, exact, strict=True))
    return pitting, first, second
