"""Two spur pairs on which the models of elastic teeth were measured, and what was measured."""

import numpy as np

from gearopt.physics.gears import GearPair
from gearopt.physics.tooth.elastic import ElasticPair

TORQUES = {"reference": 200e3, "second": 600e3}  # N mm


def elastic(name: str, plane: str = "strain") -> ElasticPair:
    if name == "reference":
        pair = GearPair.of_teeth(3.0, 25, 50, 30.0)
        return ElasticPair(pair, (30.0, 50.0), plane=plane)
    pair = GearPair.of_teeth(4.0, 18, 40, 40.0, profile_shifts=(0.3, -0.1))
    return ElasticPair(pair, (36.0, 80.0), plane=plane)


def force(name: str) -> float:
    return TORQUES[name] / elastic(name).members[0].base_radius


def five_points(pair: ElasticPair):
    """0.05 m inside A, then B, C, D, and 0.05 m inside E."""
    path, inside = pair.path, 0.05 * pair.pair.normal_module
    return np.array(
        [path.start + inside, path.lowest_single, 0.0, path.highest_single, path.end - inside]
    )


def stiffness(compliance, pair: ElasticPair):
    """N/(mm um) of a compliance in mm/N."""
    return 1e-3 / (compliance * pair.pair.face_width)
