"""The two spur pairs on which models of elastic teeth are measured, and what to read off them."""

import numpy as np

from gearopt.bench.stiffness import five_points, samples
from gearopt.physics.tooth.elastic import ElasticPair

SAMPLES = dict(zip(("reference", "second"), samples(), strict=True))


def elastic(name: str, plane: str = "strain") -> ElasticPair:
    return ElasticPair(SAMPLES[name].pair, SAMPLES[name].bores, plane=plane)


def force(name: str) -> float:
    return SAMPLES[name].torque / elastic(name).members[0].base_radius


def five(pair: ElasticPair):
    """0.05 m inside A, then B, C, D, and 0.05 m inside E."""
    return np.array(five_points(pair))


def stiffness(compliance, pair: ElasticPair):
    """N/(mm um) of a compliance in mm/N."""
    return 1e-3 / (compliance * pair.pair.face_width)
