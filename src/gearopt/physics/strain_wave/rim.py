"""The rim as a chain of teeth: how much it lets neighbouring teeth take over a load."""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.gearing import StrainWave


@dataclass(frozen=True)
class Cup:
    """The flexspline's cup: wall t over the rim h, length l [mm] to its bottom.

    modulus E [MPa], poisson nu of its material.
    """

    wall: float = 0.6
    length: float = 30.0
    modulus: float = 206e3
    poisson: float = 0.3


def chain_stiffnesses(gearing: StrainWave, cup: Cup, face_width: Any) -> tuple[Any, Any]:
    """Return k_r, k_s [N/mm]: of the rim between two teeth, and of the wall behind one tooth.

    k_r = E b h/p in tension, k_s = G t p/l in shear, p = 2 pi R_m/z_f. A model that is assumed.
    """
    pitch = 2.0 * np.pi * gearing.neutral_radius / gearing.teeth
    shear = cup.modulus / (2.0 * (1.0 + cup.poisson))
    along = cup.modulus * face_width * gearing.rim / pitch
    return along, shear * cup.wall * gearing.rim * pitch / cup.length


def rim_compliance(gearing: StrainWave, cup: Cup, face_width: Any, teeth: Any) -> Any:
    """Return the compliance (n, n) [mm/N] of the rim under forces on the flanks of teeth.

    cos^2(alpha) (k_r D + k_s I)^-1, D the second difference round the z_f/2 teeth of one lobe;
    both lobes carry alike. teeth (n,): whole numbers along the rim, no two of them equal modulo
    z_f/2. The inverse of a circulant matrix, by its eigenvalues k_s + 2 k_r (1 - cos(4 pi j/z_f)).
    """
    count = round(0.5 * float(gearing.teeth))
    along, behind = chain_stiffnesses(gearing, cup, face_width)
    waves = 2.0 * np.pi * np.arange(count) / count
    first = np.fft.ifft(1.0 / (behind + 2.0 * along * (1.0 - np.cos(waves)))).real
    number = np.asarray(teeth, int)
    apart = (number[:, None] - number[None, :]) % count
    return np.cos(gearing.pressure_angle) ** 2 * first[apart]
