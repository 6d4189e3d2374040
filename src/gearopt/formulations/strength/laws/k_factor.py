"""K-factor and unit load: indices of contact stress and of tooth-root stress (Chong and Lee)."""

from gearopt.formulations.strength import Law, LimitedIndex
from gearopt.physics.loads import k_factor, unit_load

K_FACTOR = Law(
    "K-factor and unit load",
    (
        LimitedIndex(
            "k_factor",
            words="K-factor",
            meaning="Largest K-factor W_t/(d1 b) (u + 1)/u, the index of contact stress",
            example="2.07 MPa",
        ),
        LimitedIndex(
            "unit_load",
            meaning="Largest unit load W_t/(b m_n), the index of tooth-root stress",
            example="48 MPa",
        ),
    ),
    lambda pair, torque, speed: (
        k_factor(torque, pair.pinion.reference_diameter, pair.face_width, pair.ratio),
        unit_load(torque, pair.pinion.reference_diameter, pair.face_width, pair.normal_module),
    ),
    proportional=True,
    kind="index values, not a rating by ISO 6336 or AGMA 2101. Application, dynamic and load "
    "distribution factors are not in them",
)
