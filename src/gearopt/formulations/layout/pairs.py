"""The gear pairs of a sized train, as a layout sees them."""

from gearopt.formulations.layout.gearbox import Pair
from gearopt.formulations.train import Sizes, Train
from gearopt.physics.geometry import centre_distance, reference_diameter, tip_diameter


def pairs(train: Train, sizes: Sizes) -> tuple[Pair, ...]:
    """The gear pairs of a train: centre distance, tip radii, face width [mm].

    sizes: floats, or casadi scalars.
    """
    found = []
    for m, z, u, b in zip(*sizes, strict=True):
        d = reference_diameter(m, z, train.helix_angle)
        tips = (0.5 * tip_diameter(d, m), 0.5 * tip_diameter(d * u, m))
        found.append(Pair(centre_distance(d, u), *tips, b))
    return tuple(found)
