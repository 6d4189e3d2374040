"""How the safeties of both roots compare, by the standard that rates a stage."""

from typing import Any

import numpy as np

from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.strength.standard import Standard
from gearopt.frozen import dataclass
from gearopt.physics.geometry.profile_shift import Meshing


@dataclass(frozen=True)
class RootBalance:
    """S_F1/S_F2 of pairs at a given centre distance, as a function of the pinion's profile shift.

    The wheel has the rest of their sum. standard: that rates them. speed [rad/s] of the pinion, by
    which cycles count; thickness_allowances: A_sn of pinion and wheel [mm].
    """

    standard: Standard
    speed: float
    thickness_allowances: tuple[float, float]

    @np.errstate(invalid="ignore", divide="ignore", over="ignore")
    def __call__(self, meshing: Meshing, shift: Any) -> Any:
        """Return S_F1/S_F2 of pairs (n,) with x1; NaN where the standard has none."""
        shifts = shift, meshing.shift_sum - shift
        shorter = meshing.tip_alteration
        cut = Toothing(
            meshing.helix_angle,
            meshing.racks,
            shifts,
            (shorter, shorter),
            self.thickness_allowances,
            meshing.distance,
        )
        return self.standard.root_balance(cut.pair(meshing.module, *meshing.teeth, 1.0), self.speed)
