"""The spur pair whose relief is published: z 25/50, m 3 mm, b 30 mm, bores 30/50 mm, 200 Nm."""

import functools

from gearopt.formulations.pair.relief.meshing import Mesh
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.mesh_cycle import cycle
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.ladder import LEVELS

LOAD = 5675.614786538198  # N, on the line of action
COUPLING = 4.4491e-3 / 5675.6148  # mm/N, of plane finite elements
PAIR = GearPair.of_teeth(3.0, 25, 50, 30.0, 0.0, Rack(tip_radius=0.38))
ELASTIC = ElasticPair(PAIR, (30.0, 50.0))
PATH = ELASTIC.path


def compliance(positions):
    """Compliance [mm/N] of one pair at positions [mm]: profile, Sainsot's body, Hertz at LOAD."""
    return LEVELS["profile + Sainsot"].compliance(ELASTIC, positions, LOAD)


@functools.cache
def mesh(loads=(1.0,), coupling=COUPLING, steps=48, exact=False):
    """The pair in mesh at multiples of LOAD; by default on the published grid of 48 positions."""
    given = tuple(f * LOAD for f in loads)
    return Mesh.of(cycle(PATH, steps, exact), compliance, coupling, given)
