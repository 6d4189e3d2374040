"""The gear pairs of a sized train, as a layout sees them."""

from gearopt.formulations.layout.gearbox import Pair
from gearopt.formulations.train import Sizes, Train
from gearopt.physics.geometry import centre_distance, reference_diameter


def pairs(train: Train, sizes: Sizes) -> tuple[Pair, ...]:
    """The gear pairs of a train: centre distance, tip radii d/2 + m_n, face width [mm].

    sizes: floats, or casadi scalars. Addendum 1 m_n, no profile shift (ISO 21771).
    """
    found = []
    for m, z, u, b in zip(*sizes, strict=True):
        d = reference_diameter(m, z, train.helix_angle)
        found.append(Pair(centre_distance(d, u), 0.5 * d + m, 0.5 * d * u + m, b))
    return tuple(found)
