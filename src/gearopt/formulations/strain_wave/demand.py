"""Limits of a design of a strain wave gearing, as one text for numbers, arrays and symbols."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.sharing import Loads, Teeth, shared, teeth_turned
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Var
from gearopt.physics.strain_wave.conjugate import Contact, Flank
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.lands import flexspline_widths, spline_land
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve, curvature
from gearopt.physics.strain_wave.rim import Cup
from gearopt.physics.strain_wave.strength import (
    contact_modulus,
    equal_share,
    hertz_pressure,
    ratcheting_torque,
    rim_stresses,
    rim_utilisation,
)

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
    """Return teeth and loads as `loads_at`, at turns of the wave generator of -1/2 to 1/2 pitch."""
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


FREE = ("profile_shift", "pressure_angle", "deflection", "addendum", "rim", "module")
UNITS = {"pressure_angle": "rad", "rim": "mm", "module": "mm"}
PRESSURE, VOLUME = "pressure", "volume_per_torque"  # objectives
LAND = 0.25  # modules: least land of tips, least space at roots
LEAST_CURVATURE = 2e-4  # 1/mm: contacts flatter than R = 5 m are not called contacts of a line
OUTSIDE_BASE = 1.002  # tip radius over base radius of the circular spline, at least
TIP_GAP = 0.1  # modules between the tips on the minor axis
CURVATURE_UNIT = 2e-3  # 1/mm, of the limit on curvature
SPEED_UNIT = 10.0  # mm/rad, of the limit on the flank's speed
LEAST_GAP = 1e-5  # mm: 0.01 um, kept where teeth pass each other, so that rounding cuts nothing
GAP_UNIT = 0.1  # mm, of the limit on interference


@dataclass(frozen=True)
class Demand:
    """Teeth z_f, duty, wave generator, limits and the ranges of the six free numbers.

    outer_radius [mm] of all, with `shell` [mm] outside the circular spline's root. Fatigue limits
    [MPa] of rim bending and shear, safety and notch of them; radial_stiffness [N/mm] for ratcheting
    at `ratchet_factor` times the torque; pairs: least conjugate pairs. ranges: of FREE.
    """

    teeth: int
    duty: Duty
    ranges: Mapping[str, tuple[float, float]]
    outer_radius: float
    shell: float = 3.0
    wave: str = "cosine"
    wrap: float = math.radians(30.0)
    clearance: float = 0.25
    bending_limit: float = 400.0
    shear_limit: float = 230.0
    safety: float = 1.5
    notch: float = 1.6
    radial_stiffness: float = 3e3
    ratchet_factor: float = 3.0
    pairs: float = 1.0
    keys: Mapping[str, str] = field(default_factory=dict)

    def gearing(self, numbers: Mapping[str, Any]) -> StrainWave:
        """Return the gearing of the free numbers, floats, arrays or symbols."""
        free = {name: numbers[name] for name in FREE}
        return StrainWave(
            teeth=self.teeth, clearance=self.clearance, wave=self.wave, wrap=self.wrap, **free
        )

    @property
    def unasked(self) -> tuple[str, ...]:
        """Limits that are infinite: nothing is asked."""
        known = {"rim_fatigue": self.bending_limit, "outer_radius": self.outer_radius}
        return tuple(name for name, most in known.items() if math.isinf(most))

    def radius_needed(self, gearing: StrainWave) -> Any:
        """Return the outer radius [mm] that a gearing needs."""
        return gearing.root_radius + self.shell

    def specific_volume(self, gearing: StrainWave) -> Any:
        """Return the volume pi r^2 b/T [mm3/(N m)] of the disc that it takes, by its torque."""
        disc = math.pi * self.radius_needed(gearing) ** 2 * self.duty.face_width
        return disc / (1e-3 * self.duty.torque)


def free_variables(demand: Demand, start: Any) -> tuple[Var, ...]:
    """Return the variables of FREE; start (6,): their guess, moved into the ranges."""
    variables = []
    for name, value in zip(FREE, start, strict=True):
        low, high = demand.ranges[name]
        guess = min(max(float(value), low), high)
        key = demand.keys.get(name, "")
        variables.append(Var(name, UNITS.get(name, ""), low, high, guess, key=key))
    return tuple(variables)


def pairs_of(gearing: StrainWave, contacts: Sequence[Contact]) -> Any:
    """Return the mean conjugate pairs of contacts from root to tip of the flank."""
    arc = contacts[-1].motion.arc - contacts[0].motion.arc
    return arc * gearing.teeth / (2.0 * math.pi)


def squares(demand: Demand, gearing: StrainWave, contacts: Sequence[Contact]) -> list[Any]:
    """Return p_0^2 [MPa^2] at all contacts if the conjugate pairs share the load equally."""
    duty = demand.duty
    load = equal_share(2.0 * duty.moment, gearing.base_radius, pairs_of(gearing, contacts))
    unit = load / duty.face_width * duty.contact_modulus / math.pi
    return [unit * c.gap_curvature for c in contacts]


def limits(
    demand: Demand, gearing: StrainWave, curve: NeutralCurve, contacts: Sequence[Contact]
) -> dict[str, Any]:
    """Return the utilisations of all limits but interference, at most 1 where they are met."""
    root, tip = contacts[0].point, contacts[-1].point
    widths = *flexspline_widths(gearing, root, tip), spline_land(gearing)
    ratchets_at = flank_ratcheting_torque(demand, gearing, contacts[-1])
    return {
        **common_limits(demand, gearing, curve, pairs_of(gearing, contacts), ratchets_at, widths),
        "base_circle": OUTSIDE_BASE * gearing.base_radius / gearing.tip_radius,
        "curvature": tuple(
            1.0 + (LEAST_CURVATURE - c.gap_curvature) / CURVATURE_UNIT for c in contacts
        ),
        "cusp": tuple(1.0 - c.speeds[1] / SPEED_UNIT for c in contacts),
    }


def common_limits(
    demand: Demand,
    gearing: StrainWave,
    curve: NeutralCurve,
    pairs: Any,
    ratchets_at: Any,
    widths: tuple[Any, Any, Any],
) -> dict[str, Any]:
    """Return the utilisations of the limits on teeth of any law.

    pairs: mean conjugate ones; ratchets_at: torque [N mm] at which teeth ratchet; widths [mm] of
    the flexspline's tip land and root space, and of the circular spline's tip land.
    """
    names = ("flexspline_land", "flexspline_space", "spline_land")
    thin = {k: 1.0 + LAND - v / gearing.module for k, v in zip(names, widths, strict=True)}
    utilisations = {
        "pairs": demand.pairs / pairs,
        "rim_fatigue": fatigue(demand, gearing, curve),
        "ratcheting": demand.ratchet_factor * demand.duty.torque / ratchets_at,
        "outer_radius": demand.radius_needed(gearing) / demand.outer_radius,
        **thin,
        "minor_axis": (TIP_GAP + 2.0 * gearing.addendum) / (2.0 * gearing.deflection),
    }
    return {name: used for name, used in utilisations.items() if name not in demand.unasked}


def flank_ratcheting_torque(demand: Demand, gearing: StrainWave, tip: Contact) -> Any:
    """Return the torque [N mm] at which teeth ratchet, by the flank's angle at the tip."""
    slope = -tip.direction.y / tip.direction.x
    return ratcheting_torque(gearing, demand.radial_stiffness, slope)


def fatigue(demand: Demand, gearing: StrainWave, curve: NeutralCurve) -> Any:
    """Return the utilisation of the rim's fatigue strength."""
    strengths = demand.bending_limit, demand.shear_limit
    return rim_utilisation(rim_of(demand, gearing, curve), strengths, demand.safety)


def rim_of(demand: Demand, gearing: StrainWave, curve: NeutralCurve) -> tuple[Any, Any]:
    """Return the alternating bending and the shear stress [MPa] of the rim."""
    duty = demand.duty
    bent = curvature(curve, 0.0)[0], curvature(curve, 0.5 * math.pi)[0]
    return rim_stresses(gearing, bent, duty.torque, duty.moduli[0], demand.notch, duty.cup.wall)
