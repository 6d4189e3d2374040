"""How two flanks flatten at their contact."""

from typing import Any

import numpy as np

from gearopt.physics.tooth.elastic import ElasticPair, LoadLine


def half_width(elastic: ElasticPair, positions: Any, force: Any) -> Any:
    """Return half the width b_H [mm] of the contact, b_H^2 = 4 F rho/(pi b) (f_1/E_1 + f_2/E_2).

    positions s [mm]; force F [N] > 0 on the pair of teeth, ValueError for others: towards none the
    compliance of the contact grows without bound. rho = rho_1 rho_2/(rho_1 + rho_2), f:
    `ElasticGear.plane_factor`. Source: Hertz, parallel cylinders.
    """
    if not np.all(np.asarray(force) > 0.0):
        raise ValueError("the compliance of a contact is that under a force above 0 N")
    first, second = elastic.path.radii_of_curvature(np.asarray(positions, float))
    soft = sum(each.plane_factor / each.rigidity for each in elastic.members)
    return np.sqrt(4.0 * force * soft / np.pi * first * second / (first + second))


def contact_compliance(
    elastic: ElasticPair, positions: Any, lines: tuple[LoadLine, LoadLine], force: Any
) -> Any:
    """Return the compliance of the contact to the centre lines of both teeth, approach over F.

    sum_i f_i/(pi E_i b) {2 ln(2 h_i/b_H) - nu'_i} [mm/N], h_i: depth of the load line, nu'_i:
    `ElasticGear.lateral`. force F [N] > 0, at which the secant is taken: it falls with the
    logarithm of the load. Source: Weber and Banaschek (1953); Johnson, Contact Mechanics, 5.6.
    """
    wide = half_width(elastic, positions, force)
    parts = [
        m.plane_factor / (np.pi * m.rigidity) * (2.0 * np.log(2.0 * line.depth / wide) - m.lateral)
        for m, line in zip(elastic.members, lines, strict=True)
    ]
    return parts[0] + parts[1]


def linear_contact_compliance(elastic: ElasticPair, printed: bool = False) -> float:
    """Return sum_i 2 (1 - nu_i^2)/(pi E_i b) [mm/N], of any load and place.

    printed: with the paper's 1 + nu_i^2, which is 1.2 times as soft and no elastic constant. 3 to
    4 times too stiff: the logarithm of `contact_compliance` is missing. Source: Yang and Sun, J.
    Mech. Trans. Autom. Des. 107 (1985); the paper's eq. (12), corrected.
    """
    sign = 1.0 if printed else -1.0
    rows = ((1.0 + sign * m.poisson**2) / m.rigidity for m in elastic.members)
    return 2.0 / np.pi * sum(rows)
