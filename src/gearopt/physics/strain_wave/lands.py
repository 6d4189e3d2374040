"""Widths of lands and spaces of a gearing: teeth that are too thin cannot be made."""

from typing import Any

import numpy as np

from gearopt.physics.strain_wave.conjugate import tangents
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.vectors import Vector


def spline_land(gearing: StrainWave) -> Any:
    """Return the tip land of the circular spline's teeth [mm], an arc of its tip circle.

    r_a (2 pi/z_c - 2 (eta - inv(alpha_a))).
    """
    tangent, _ = tangents(gearing)
    space = gearing.half_angle - tangent + np.arctan(tangent)
    return 2.0 * gearing.tip_radius * (np.pi / gearing.circular_teeth - space)


def flexspline_widths(gearing: StrainWave, root: Vector, tip: Vector) -> tuple[Any, Any]:
    """Return tip land and space at the root [mm] of the undeformed flexspline.

    root, tip: the ends of the conjugate flank, in the tooth's frame.
    """
    pitch = 2.0 * np.pi * (gearing.neutral_radius + root.x) / gearing.teeth
    return 2.0 * tip.y, pitch - 2.0 * root.y
