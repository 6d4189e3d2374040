"""What a strain wave gearing carries, and what it is made of."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.sharing import Loads, Teeth, shared, teeth_turned
from gearopt.physics.strain_wave.conjugate import Flank
from gearopt.physics.strain_wave.rim import Cup
from gearopt.physics.strain_wave.strength import contact_modulus, equal_share, hertz_pressure

SHIFTS = (0.0, 0.25, 0.5, 0.75)  # pitches by which the wave generator is turned: worst of these


@dataclass(frozen=True)
class Duty:
    """Torque T of the output [N mm], face width b [mm], materials of flexspline and spline.

    moduli E [MPa], poissons nu of both. pair_stiffness K [N/mm] of two teeth; cup: that of the
    flexspline; elastic: whether its rim yields to the loads of its teeth. reaction: torque of the
    circular spline over that of the output, 1 + 1/i with it at rest; 1 as the paper has it.
    """

    torque: float
    face_width: float
    moduli: tuple[float, float]
    poissons: tuple[float, float]
    pair_stiffness: float
    cup: Cup
    elastic: bool
    reaction: float = 1.0

    @property
    def contact_modulus(self) -> float:
        """Modulus E* [MPa] of the contact of both materials."""
        return float(contact_modulus(self.moduli, self.poissons))

    @property
    def moment(self) -> float:
        """Moment M [N mm] of the teeth of one lobe: half the torque of the circular spline."""
        return 0.5 * self.reaction * self.torque

    def pressure(self, loads: Any, gap_curvature: Any) -> Any:
        """Return Hertz's pressures p_0 [MPa] of loads [N] at curvatures 1/R [1/mm]."""
        return hertz_pressure(loads / self.face_width, self.contact_modulus, gap_curvature)


def equal_pressure(duty: Duty, flank: Flank, whole: bool = False) -> float:
    """Return the largest pressure [MPa] if the conjugate pairs share the load equally.

    The paper's stress. whole: with the whole number of pairs that always touch, at least 1.
    """
    pairs = float(np.squeeze(flank.pairs_in_contact))
    count = max(1.0, math.floor(pairs)) if whole else pairs
    load = equal_share(2.0 * duty.moment, flank.gearing.base_radius, count)
    return float(duty.pressure(load, flank.contacts.gap_curvature.max()))


def loads_at(duty: Duty, flank: Flank) -> tuple[Teeth, Loads]:
    """Return the teeth that may carry and their loads."""
    return loads_turned(duty, flank, (0.0,))[0]


def loads_turned(duty: Duty, flank: Flank, shifts: Sequence[float]) -> list[tuple[Teeth, Loads]]:
    """Return the same for turns of the wave generator, in pitches from -1/2 to 1/2."""
    rim = (duty.cup, duty.face_width) if duty.elastic else None
    every = teeth_turned(flank, duty.pair_stiffness, rim, shifts)
    arms = [np.full(len(teeth.gaps), teeth.arm) for teeth in every]
    return [
        (teeth, shared(teeth.compliance, teeth.gaps, arm, duty.moment))
        for teeth, arm in zip(every, arms, strict=True)
    ]


def pressures(duty: Duty, flank: Flank, teeth: Teeth, loads: Loads) -> Any:
    """Return the pressure of every tooth [MPa], with 1/R of the nearest conjugate point.

    Teeth outside the arc of contact touch at an end of a flank: contact at an edge is not modelled.
    """
    at = flank.contacts
    return duty.pressure(loads.forces, np.interp(teeth.arcs, at.motion.arc, at.gap_curvature))


def shared_pressure(duty: Duty, flank: Flank) -> float:
    """Return the largest pressure [MPa] of the shared loads over the positions in SHIFTS."""
    return float(max(pressures(duty, flank, *at).max() for at in loads_turned(duty, flank, SHIFTS)))
