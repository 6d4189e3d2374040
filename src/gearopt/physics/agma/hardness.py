"""The hardness ratio factor C_H of the wheel, by AGMA 2001-D04 (2101: Z_W).

It raises the contact strength of a wheel that runs with a harder pinion; of the pinion it is 1.
"""

from typing import Any

import numpy as np

from gearopt.physics.agma.factors import INCH
from gearopt.physics.choosing import choose

WHEELS = (180.0, 400.0)  # HB of wheels against surface hardened pinions
LARGEST_RATIO = 20.0  # where the chart of through-hardened pairs ends
MICROINCH = 1e-6 * INCH  # mm


def hardness_ratio_factor(pinion_hardness: Any, wheel_hardness: Any, ratio: Any) -> Any:
    """Return C_H = 1 + A (u - 1) of through-hardened pinion and wheel.

    A = 8.98e-3 HB_1/HB_2 - 8.29e-3 for HB_1/HB_2 of 1.2 to 1.7, 0 below, 0.00698 above (a jump of
    2.5e-3 at 1.2, of 5e-6 at 1.7). hardness [HB]; ratio u, as of a u of 20 above that.
    Source: AGMA 2001-D04, clause 14, figure; Shigley, eq. (14-36); the limit of 20 is of its chart.
    """
    harder = pinion_hardness / wheel_hardness
    slope = choose(harder < 1.2, 0.0, choose(harder > 1.7, 0.00698, 8.98e-3 * harder - 8.29e-3))
    return 1.0 + slope * (np.minimum(ratio, LARGEST_RATIO) - 1.0)


def surface_hardened_factor(finish: Any, wheel_hardness: Any) -> Any:
    """Return C_H = 1 + B (450 - HB_2), at least 1, of a pinion of 48 HRC or more.

    B = 0.00075 exp(-0.0112 f_P), f_P: its finish R_a in microinches; finish R_a [mm] (the metric
    form of the standard has exp(-0.448 f_P), f_P in um, 1.6 % more of the exponent: the inch form
    is taken). For wheels of 180 to 400 HB. Source: AGMA 2001-D04, clause 14; Shigley, eq. (14-37).
    """
    slope = 0.00075 * np.exp(-0.0112 * finish / MICROINCH)
    return np.maximum(1.0, 1.0 + slope * (450.0 - wheel_hardness))
