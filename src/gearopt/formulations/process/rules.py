"""The rules by which Chong and Lee size a drive stage by stage: split, teeth, module, centres.

Where the print is wrong the rule here is the corrected one; docs/multi_stage.md shows the evidence.
Lengths in mm, torques in N mm, stresses in MPa; s_ij^2 = K_i/K_j, as sigma_H ~ sqrt(K), eq. (1).
K is the limit of contact stress, U that of tooth-root stress: the two of a proportional law.
"""

import math
from collections.abc import Sequence
from fractions import Fraction

from gearopt.errors import SolveError
from gearopt.formulations.strength import Law
from gearopt.formulations.train import Stage
from gearopt.physics.gears import GearPair

ROUNDING = 1e-12  # relative; a whole number or module missed by so little is met


def niemann_ratios(total: float, contact: Sequence[float]) -> tuple[float, ...]:
    """Ratios of two or three stages after Niemann, as printed.

    Two: u1 = 0.8 (u s_12)^(2/3). Three: u1 = 0.6 u^(4/7) s_12^(2/7) s_13^(4/7),
    u2 = 1.1 u^(2/7) s_21^(4/7) s_23^(2/7). total: u >= 1; contact: K of every stage [MPa].
    These are the leading terms, for u_i >> 1, of the split of least gear volume. SolveError for
    other numbers of stages. Source: Chong and Lee, eqs. (7) and (8).
    """
    k = tuple(contact)
    if len(k) == 2:
        first = 0.8 * (total * (k[0] / k[1]) ** 0.5) ** (2 / 3)
        return first, total / first
    if len(k) == 3:
        first = 0.6 * total ** (4 / 7) * (k[0] / k[1]) ** (1 / 7) * (k[0] / k[2]) ** (2 / 7)
        second = 1.1 * total ** (2 / 7) * (k[1] / k[0]) ** (2 / 7) * (k[1] / k[2]) ** (1 / 7)
        return first, second, total / first / second
    raise SolveError(
        f"process-two has a rule for the ratios of two and three stages, not of {len(k)}: "
        "write stage_ratios in the table [process_two]"
    )


def load_share(ratio: float, following: float) -> float:
    """f_12 = u1 (u2 + 1)^3/(u2 (u1 + 1)^3) n1/n2, which is s_21^2 (b2/b1) (a2/a1)^2.

    ratio u1, following u2 >= 1; n1/n2 = u1. Source: Chong and Lee, eq. (3), corrected: the print
    has (a2/a1)^3, which contradicts eqs. (2) and (6).
    """
    return ratio**2 * (following + 1.0) ** 3 / (following * (ratio + 1.0) ** 3)


def next_centre_distance(
    centre_distance: float,
    ratios: tuple[float, float],
    proportions: tuple[float, float],
    contact: tuple[float, float],
) -> float:
    """a2 = a1 [f_12 s_12^2 (u2 + 1)/(u1 + 1) m_a1/m_a2]^(1/3) [mm]: the next stage's centres.

    centre_distance a1 [mm]; then of both stages: ratios u, proportions m_a = b/d1, limits K [MPa].
    Both stages are then loaded alike. Source: Chong and Lee, eq. (14), corrected: the print has
    s_12, but eq. (3) with b = 2 a m_a/(u + 1), eq. (13), gives its square.
    """
    (u1, u2), (m1, m2), (k1, k2) = ratios, proportions, contact
    cube = load_share(u1, u2) * (k1 / k2) * (u2 + 1.0) / (u1 + 1.0) * m1 / m2
    return centre_distance * math.cbrt(cube)


def pinion_diameter(centre_distance: float, ratio: float) -> float:
    """d1 = 2 a/(u + 1) [mm]. Source: Chong and Lee, eq. (13) with b = m_a d1."""
    return 2.0 * centre_distance / (ratio + 1.0)


def balanced_pinion(law: Law, stage: Stage, ratio: float, helix_angle: float) -> int:
    """Teeth z1 = (U/K) (u + 1)/u cos(beta), cut, with which contact and root limit alike.

    Source: Chong and Lee, eq. (11) over eq. (10). Cut, not rounded: 25.84 is 25 in their Table 2.
    """
    one = GearPair.of_diameter(math.cos(helix_angle), 1.0, 1.0, ratio, 1.0, helix_angle)
    contact, root = law.utilisations(one, 1.0, 0.0, stage.allowable).values()
    balanced = float(contact / root)
    return max(1, math.floor(balanced * (1.0 + ROUNDING)))


def wheel_teeth(pinion_teeth: int, ratio: Fraction | float) -> int:
    """Teeth z2 = u z1, cut.

    Cut, not rounded: process two of Table 4 has 237, 109, 80 where u z1 is 237.70, 109.55, 80.07.
    A fraction is exact; for others ROUNDING decides.
    """
    exact = isinstance(ratio, Fraction)
    return math.floor(ratio * pinion_teeth * (1 if exact else 1.0 + ROUNDING))


def needed_module(
    law: Law, stage: Stage, torque: float, teeth: tuple[int, int], helix_angle: float
) -> float:
    """Minimum normal module [mm] for both load limits with b = m_a d1: the larger of two.

    From U: m^3 = 2 T cos^2(beta)/(m_a z1^2 U). From K: m = d1 cos(beta)/z1 with
    d1^3 = 2 T (u + 1)/(u K m_a). torque [N mm] of the pinion; teeth of pinion and wheel, so that
    the loads hold with those that are made. Source: Chong and Lee, eqs. (10) to (13).
    """
    one = GearPair.of_teeth(1.0, *teeth, 1.0, helix_angle)
    tied = one.of_width(float(stage.face_width.high or 0) * one.pinion.reference_diameter)
    return math.cbrt(law.load(tied, torque, 0.0, stage.allowable))


def next_module(stage: Stage, least: float) -> Fraction | None:
    """The first allowed module not below `least` [mm]; None where there is none."""
    return next((m for m in stage.modules if m >= least * (1.0 - ROUNDING)), None)
