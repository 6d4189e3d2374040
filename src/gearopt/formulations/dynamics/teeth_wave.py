"""The mesh stiffness of a pair's own teeth, from its contact."""

from collections.abc import Sequence

import numpy as np

from gearopt.formulations.pair.contact import ContactLoad, PairContact
from gearopt.physics.motion.stiffness_wave import Wave


def nearest_load(loads: Sequence[ContactLoad], force: float) -> ContactLoad:
    """Return the load whose normal force is nearest to one [N]."""
    return min(loads, key=lambda one: abs(one.normal_force_N - force))


def of_contact(contact: PairContact, load: ContactLoad) -> Wave:
    """Return normal force over transmission error of a pair's own teeth at one of its loads.

    With this stiffness the normal force deforms the mesh by the transmission error, relief and all.
    Both sides of the points where pairs come and go are a step of the wave. load: of the contact,
    or of its relief.
    """
    phase = np.array(contact.travel_mm) / contact.base_pitch_mm
    stiffness = load.normal_force_N / np.array(load.transmission_error_mm)
    inside = (phase > 1e-12) & (phase < 1.0 - 1e-12)
    edges = np.unique(phase[inside])
    left = np.array([stiffness[phase == e][0] for e in edges])
    right = np.array([stiffness[phase == e][-1] for e in edges])
    return Wave(
        np.concatenate([[0.0], edges]),
        np.concatenate([[stiffness[-1]], left]),
        np.concatenate([[stiffness[0]], right]),
    )
