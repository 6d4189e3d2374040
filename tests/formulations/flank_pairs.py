"""Pairs in slices that tests of contact over the flank share."""

from types import SimpleNamespace

import numpy as np

from gearopt.formulations.pair.contact import compliance_of
from gearopt.formulations.pair.flank import FlankMesh, Modifications
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import usable_path
from gearopt.physics.geometry.tooth import base_helix_angle
from gearopt.physics.tooth.ladder import COUPLINGS, USUAL
from gearopt.physics.tooth.slices import Sliced, normal_section

# module, teeth, face width [mm], helix angle [deg], shifts, bores [mm], torque [N mm]
PAIRS = {
    "12 degrees": (3.0, (25, 50), 24.0, 12.0, (0.0, 0.0), (30.0, 50.0), 200e3),
    "17 degrees": (4.0, (24, 36), 60.0, 17.0, (0.2, 0.1), (40.0, 50.0), 900e3),
    "25 degrees": (3.0, (20, 41), 36.0, 25.0, (0.2, 0.0), (24.0, 44.0), 250e3),
    "spur": (3.0, (25, 50), 30.0, 0.0, (0.0, 0.0), (30.0, 50.0), 200e3),
}


def gears(name, angle=None):
    """The pair of a name, its bores [mm] and transverse normal force [N]; angle [deg]."""
    module, teeth, width, helix, shifts, bores, torque = PAIRS[name]
    helix = np.radians(helix if angle is None else angle)
    pair = GearPair.of_teeth(module, *teeth, width, helix, profile_shifts=shifts)
    return pair, bores, float(torque / (0.5 * pair.pinion.base_diameter))


def flank(name, slices=21, coupling="ring torsion", angle=None, steps=96, loads=(1.0,), **gaps):
    """A pair in slices; gaps: of `Modifications`."""
    pair, bores, force = gears(name, angle)
    normal = normal_section(pair, bores)
    cosine = float(np.cos(base_helix_angle(pair.pinion)))
    sliced = Sliced(
        pair,
        usable_path(pair),
        normal,
        compliance_of(normal, USUAL, force),
        force,
        COUPLINGS[coupling](normal) / cosine,
    )
    return FlankMesh.of(sliced, slices, steps, loads, Modifications(**gaps))


def solid(name):
    """What `solid_gears.contact_lines` asks of a pair."""
    pair, bores, _ = gears(name)
    steel = {"moduli": (206000.0, 206000.0), "poissons": (0.3, 0.3)}
    return SimpleNamespace(pair=pair, path=usable_path(pair), bores=bores, **steel)
