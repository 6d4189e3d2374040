"""Sizes of external cylindrical gears without profile shift (ISO 21771 terms), in mm.

Arguments are floats, arrays of one shape, or casadi scalars.
"""

from typing import Any

import numpy as np


def reference_diameter(module: Any, teeth: Any, helix_angle: float = 0.0) -> Any:
    """Reference (pitch) diameter d = m_n z / cos(beta) [mm].

    module [mm] > 0, the normal one, or the transverse one m_n/cos(beta) without a helix angle;
    teeth > 0; helix_angle [rad], |beta| < pi/2.
    Source: ISO 21771:2007, reference diameter.
    """
    return module * teeth / np.cos(helix_angle)


def centre_distance(pinion_diameter: Any, ratio: Any) -> Any:
    """Reference centre distance a = d1 (1 + u)/2 [mm].

    pinion_diameter d1 [mm] > 0; ratio u = z2/z1 >= 1.
    Source: Chong and Lee, symbols of section 1 (a = (d1 + d2)/2).
    """
    return 0.5 * pinion_diameter * (1.0 + ratio)


def gear_volume(pinion_diameter: Any, face_width: Any, ratio: Any) -> Any:
    """Volume of pinion and wheel as solid reference cylinders V = (pi/4) b d1^2 (1 + u^2) [mm^3].

    pinion_diameter d1, face_width b [mm] > 0; ratio u >= 1.
    Source: Chong and Lee, eq. (4), correct as printed.
    """
    return 0.25 * np.pi * face_width * pinion_diameter**2 * (1.0 + ratio**2)
