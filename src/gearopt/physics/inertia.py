"""Mass and inertia of discs and shafts, and inertia seen through a ratio.

Inside is t mm^2 (1 kg m^2 = 1e3 t mm^2), t and t/mm3. Arguments are floats, arrays of one shape, or
casadi scalars.
"""

import math
from typing import Any


def disc_mass(density: Any, length: Any, diameter: Any) -> Any:
    """Mass (pi/4) rho b d^2 [t] of a solid cylinder.

    density rho [t/mm3]; length b, diameter d [mm] >= 0.
    """
    return math.pi / 4.0 * density * length * diameter**2


def disc_inertia(density: Any, length: Any, diameter: Any) -> Any:
    """Moment of inertia (pi/32) rho b d^4 [t mm2] of a solid cylinder about its axis.

    density rho [t/mm3]; length b, diameter d [mm] >= 0.
    """
    return math.pi / 32.0 * density * length * diameter**4


def reflected_inertia(
    load_inertia: Any, motor_inertia: Any, ratio: Any, efficiency: Any = 1.0
) -> Any:
    """Inertia J_L + eta N^2 J_M [t mm2] that a driving motor's torque accelerates at the load.

    load_inertia J_L, motor_inertia J_M [t mm2] >= 0; ratio N > 0, motor over load speed; efficiency
    0 < eta <= 1 of the train. Source: Youn, eq. (3), with efficiency.
    """
    return load_inertia + efficiency * ratio**2 * motor_inertia
