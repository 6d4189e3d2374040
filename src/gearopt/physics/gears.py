"""Cylindrical gears and gear pairs (ISO 21771 terms), in mm and t.

Every quantity is a float, an array (all of one shape) or a casadi scalar; numbers of teeth may be
real. An inertia is in t mm^2 (1 kg m^2 = 1e3 t mm^2). An internal gear (ring) has negative teeth
and negative diameters, and a pair with it a negative u and a, as in ISO 21771: all formulas then
hold for both. Only floats and arrays may be negative; symbols are external gears.
"""

import math
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.geometry.involute import angle_at_distance, working_pressure_angle


def _series(text: str) -> tuple[Fraction, ...]:
    return tuple(Fraction(number) for number in text.split())


# ISO 54:1996, table 1 (GB/T 1357-2008 lists the same); 6.5 is one the standard asks to avoid.
# Checked against three independent public listings.
SERIES_I = _series("1 1.25 1.5 2 2.5 3 4 5 6 8 10 12 16 20 25 32 40 50")
SERIES_II = _series("1.125 1.375 1.75 2.25 2.75 3.5 4.5 5.5 6.5 7 9 11 14 18 22 28 36 45")

MODULES = {"ISO 54 I": SERIES_I, "ISO 54 I+II": tuple(sorted(SERIES_I + SERIES_II))}

# Diametral pitches [1/in] that American textbooks list as in general use (Shigley and others);
# unverified: no second listing of the whole series was found, and standards list others, too.
COARSE_PITCHES = _series("2 2.25 2.5 3 4 6 8 10 12 16")
FINE_PITCHES = _series("20 24 32 40 48 64 80 96 120 150 200")
DIAMETRAL_PITCHES = {
    "DP coarse": COARSE_PITCHES,
    "DP fine": FINE_PITCHES,
    "DP coarse+fine": COARSE_PITCHES + FINE_PITCHES,
}


MEMBERS = ("pinion", "wheel")  # of a pair, in this order


@dataclass(frozen=True)
class Rack:
    """Basic rack: normal pressure angle alpha_P [rad]; all else in normal modules.

    addendum h_aP; dedendum h_fP, which the tool's addendum h_a0 cuts; tip_radius rho_fP of the
    tool's tip, the root radius of the rack; protuberance pr: how far the tool's tip juts out of its
    flank, normal to it, beyond what finishing takes away. tip_chamfer: radial height of a chamfer
    or round of the gear's tips, which takes no part in contact.
    Source: ISO 53:1998, profile A; the same in Rack.m of github.com/gfsReboucas/Drivetrain, and
    what the diameters of its KISSsoft report (NREL 5 MW gearbox, stage 3) follow.
    """

    pressure_angle: Any = math.radians(20.0)
    addendum: Any = 1.0
    dedendum: Any = 1.25
    tip_radius: Any = 0.38
    protuberance: Any = 0.0
    tip_chamfer: Any = 0.0


ISO_53_A = Rack()
RIM = 3.5  # modules of a ring below its roots, from which on Y_B = 1: ISO 6336-3 [unverified]


@dataclass(frozen=True)
class Cutter:
    """Pinion-type cutter, which shapes a gear: number of teeth z_0, the rest in normal modules.

    profile_shift x_0; addendum h_a0: d_a0 = m_n z_0/cos(beta) + 2 m_n (h_a0 + x_0); tip_radius
    rho_a0 of the round at the corners of its tips. Source: ISO 21771:2007 and ISO 6336-3:2006.
    """

    teeth: Any
    profile_shift: Any = 0.0
    addendum: Any = 1.25
    tip_radius: Any = 0.0


def is_internal(teeth: Any) -> bool:
    """Whether a number of teeth, or any of an array, is that of a ring: negative."""
    if isinstance(teeth, int | float | np.number):
        return bool(teeth < 0)
    return isinstance(teeth, np.ndarray) and teeth.dtype.kind != "O" and bool((teeth < 0).any())


def signed(value: Any, like: Any) -> Any:
    """A value times the sign of another number, teeth or a diameter; of symbols: +."""
    if not is_internal(like):
        return value
    return np.where(like < 0, -value, value)[()]


def disc_mass(density: Any, length: Any, diameter: Any) -> Any:
    """Mass (pi/4) rho b d^2 [t] of a solid cylinder; rho [t/mm3], b, d [mm]."""
    return math.pi / 4.0 * density * length * diameter**2


def disc_inertia(density: Any, length: Any, diameter: Any) -> Any:
    """Inertia (pi/32) rho b d^4 [t mm2] of a solid cylinder about its axis; as `disc_mass`."""
    return math.pi / 32.0 * density * length * diameter**4


def reference_diameter(module: Any, teeth: Any, helix_angle: Any = 0.0) -> Any:
    """Reference diameter d = m_n z/cos(beta) [mm] (ISO 21771:2007); below 0 of a ring.

    module [mm]: m_n, or the transverse one without a helix angle beta [rad].
    """
    return module * teeth / np.cos(helix_angle)


def transverse_pressure_angle(pressure_angle: Any, helix_angle: Any) -> Any:
    """Transverse pressure angle alpha_t = arctan(tan(alpha_n)/cos(beta)) [rad], ISO 21771:2007."""
    return np.arctan(np.tan(pressure_angle) / np.cos(helix_angle))


def _none(value: Any) -> bool:
    """Whether a shift is the number 0, of which nothing needs to be solved."""
    return isinstance(value, int | float) and value == 0


def _external(teeth: Any) -> None:
    if isinstance(teeth, int | float | np.number) and teeth <= 0:
        raise ValueError(f"{teeth:g} teeth: internal gears are not covered, only external ones")


@dataclass(frozen=True)
class Gear:
    """A gear: normal module m_n [mm], number of teeth z, reference diameter d [mm].

    A ring has z < 0, d < 0: a positive shift then moves its profile towards its centre.

    face_width b [mm] of the mesh; helix_angle beta [rad], |beta| < pi/2; rack: its basic rack.
    profile_shift x and tip_alteration k (negative: shorter teeth) in normal modules;
    thickness_allowance A_sn [mm] of the normal tooth thickness, negative: thinner. d is
    m_n z/cos(beta); `GearPair` sees to that. body_diameter [mm]: of the cylinder that volume, mass
    and inertia count; None: d. width_excess [mm]: by which the gear is wider than the mesh.
    cutter: the pinion-type one that cuts a ring; None: the rack, of a ring its counterpart.
    outside_diameter [mm] < 0 of a ring, whose body is the tube from `body` to there; None: a rim of
    RIM modules. Diameters are nominal: without backlash. Source: ISO 21771:2007.
    """

    normal_module: Any
    teeth: Any
    reference_diameter: Any
    face_width: Any
    helix_angle: Any = 0.0
    rack: Rack = ISO_53_A
    profile_shift: Any = 0.0
    tip_alteration: Any = 0.0
    thickness_allowance: Any = 0.0
    body_diameter: Any = None
    width_excess: Any = 0.0
    cutter: Cutter | None = None
    outside_diameter: Any = None

    @property
    def body(self) -> Any:
        """Diameter [mm] of the cylinder that counts as the gear; of a ring of its hole."""
        return self.reference_diameter if self.body_diameter is None else self.body_diameter

    @property
    def width(self) -> Any:
        """Face width [mm] of the gear itself, b_1 or b_2."""
        return self.face_width + self.width_excess

    @property
    def root_excess(self) -> Any:
        """What of it [mm] bends, a module at each end. Source: ISO 6336-3 [memory: unverified]."""
        excess = self.width_excess
        return excess if _none(excess) else np.minimum(excess, 2.0 * self.normal_module)

    @property
    def generating_shift(self) -> Any:
        """Generating profile shift x_E = x + A_sn/(2 m_n tan(alpha_n)): thinned by a deeper cut."""
        if _none(self.thickness_allowance):
            return self.profile_shift
        thinner = 0.5 * self.thickness_allowance / np.tan(self.rack.pressure_angle)
        return self.profile_shift + thinner / self.normal_module

    @cached_property
    def transverse_pressure_angle(self) -> Any:
        """Transverse pressure angle alpha_t = arctan(tan(alpha_n)/cos(beta)) [rad]."""
        return transverse_pressure_angle(self.rack.pressure_angle, self.helix_angle)

    @property
    def tip_diameter(self) -> Any:
        """Tip diameter d_a = d + 2 (h_aP + x + k) m_n [mm]."""
        height = self.rack.addendum + self.profile_shift + self.tip_alteration
        return self.reference_diameter + 2.0 * height * self.normal_module

    @property
    def active_tip_diameter(self) -> Any:
        """Tip form diameter d_Na [mm], to which flanks touch: below d_a by the chamfer."""
        return self.tip_diameter - 2.0 * self.rack.tip_chamfer * self.normal_module

    @property
    def root_diameter(self) -> Any:
        """Root diameter d_f = d - 2 (h_fP - x) m_n [mm]; by a cutter 2 a_0 - d_a0."""
        if self.cutter is not None:
            return 2.0 * self.cutting(self.profile_shift)[1] - self.cutter_tip_diameter
        depth = self.rack.dedendum - self.profile_shift
        return self.reference_diameter - 2.0 * depth * self.normal_module

    @cached_property
    def base_diameter(self) -> Any:
        """Base diameter d_b = d cos(alpha_t) [mm]."""
        return self.reference_diameter * np.cos(self.transverse_pressure_angle)

    def cutting(self, shift: Any) -> tuple[Any, Any]:
        """Angle alpha_w0 [rad] and a_0 [mm] of gear and cutter at a profile shift x or x_E.

        Their transverse working pressure angle and centre distance, a_0 < 0 of a ring.
        """
        assert self.cutter is not None
        shifts = shift + self.cutter.profile_shift
        teeth, angle = self.teeth + self.cutter.teeth, self.transverse_pressure_angle
        working = working_pressure_angle(shifts, teeth, self.rack.pressure_angle, angle)
        zero = 0.5 * self.reference_diameter * (1.0 + self.cutter.teeth / self.teeth)
        return working, zero * np.cos(angle) / np.cos(working)

    @property
    def cutter_tip_diameter(self) -> Any:
        """Tip diameter d_a0 = d_0 + 2 m_n (h_a0 + x_0) [mm] of the cutter."""
        assert self.cutter is not None
        height = self.cutter.addendum + self.cutter.profile_shift
        reference = self.reference_diameter * self.cutter.teeth / self.teeth
        return reference + 2.0 * height * self.normal_module

    @property
    def outside(self) -> Any:
        """Outside diameter [mm] of a ring, negative."""
        if self.outside_diameter is not None:
            return self.outside_diameter
        return self.root_diameter - 2.0 * RIM * self.normal_module

    @property
    def volume(self) -> Any:
        """Volume (pi/4) b d^2 [mm3] as a solid cylinder, the reference one unless told.

        Of a ring that of the tube between this cylinder and its outside.
        """
        square = self.outside**2 - self.body**2 if is_internal(self.teeth) else self.body**2
        return 0.25 * np.pi * self.width * square

    def mass(self, density: Any) -> Any:
        """Mass [t] as a solid cylinder or tube, see `volume`; density [t/mm3]."""
        if is_internal(self.teeth):
            return density * self.volume
        return disc_mass(density, self.width, self.body)

    def inertia(self, density: Any) -> Any:
        """Moment of inertia [t mm2] as a solid cylinder or tube, see `volume`."""
        inner = disc_inertia(density, self.width, self.body)
        if is_internal(self.teeth):
            return disc_inertia(density, self.width, self.outside) - inner
        return inner


def _gear(module: Any, width: Any, helix_angle: Any, teeth: Any, rack: Rack, shift: Any) -> Gear:
    diameter = reference_diameter(module, teeth, helix_angle)
    return Gear(module, teeth, diameter, width, helix_angle, rack, shift)


@dataclass(frozen=True)
class GearPair:
    """Two gears in mesh: index 1 the pinion, 2 the wheel, which may be a ring (`internal`).

    Normal module, face width, helix angle and pressure angle are those of both. working_distance:
    a centre distance [mm] that is given; else it is the one without backlash of nominal teeth.
    Source: ISO 21771:2007.
    """

    pinion: Gear
    wheel: Gear
    working_distance: Any = None

    @classmethod
    def of_teeth(
        cls,
        normal_module: Any,
        pinion_teeth: Any,
        wheel_teeth: Any,
        face_width: Any,
        helix_angle: Any = 0.0,
        rack: Rack = ISO_53_A,
        profile_shifts: tuple[Any, Any] = (0.0, 0.0),
        working_distance: Any = None,
    ) -> "GearPair":
        """The pair of a normal module, numbers of teeth above 0 and a face width; lengths in mm."""
        _external(pinion_teeth)
        _external(wheel_teeth)
        shared = normal_module, face_width, helix_angle
        pinion = _gear(*shared, pinion_teeth, rack, profile_shifts[0])
        wheel = _gear(*shared, wheel_teeth, rack, profile_shifts[1])
        return cls(pinion, wheel, working_distance)

    @classmethod
    def internal(
        cls,
        normal_module: Any,
        pinion_teeth: Any,
        ring_teeth: Any,
        face_width: Any,
        helix_angle: Any = 0.0,
        racks: tuple[Rack, Rack] = (ISO_53_A, ISO_53_A),
        profile_shifts: tuple[Any, Any] = (0.0, 0.0),
        working_distance: Any = None,
        cutter: Cutter | None = None,
    ) -> "GearPair":
        """The pair of an external pinion and a ring of z2 < -z1 teeth; working_distance < 0."""
        if not np.all(np.less(ring_teeth, 0)):
            raise ValueError(f"{ring_teeth} teeth of a ring: write a negative number")
        _external(pinion_teeth)
        shared = normal_module, face_width, helix_angle
        pinion = _gear(*shared, pinion_teeth, racks[0], profile_shifts[0])
        ring = _gear(*shared, ring_teeth, racks[1], profile_shifts[1])
        return cls(pinion, replace(ring, cutter=cutter), working_distance)

    @classmethod
    def of_diameter(
        cls,
        normal_module: Any,
        pinion_teeth: Any,
        pinion_diameter: Any,
        ratio: Any,
        face_width: Any,
        helix_angle: Any = 0.0,
        rack: Rack = ISO_53_A,
    ) -> "GearPair":
        """The pair of a pinion of d1 = m_n z1/cos(beta) and a ratio, for symbolic problems."""
        shared = face_width, helix_angle, rack
        return cls(
            Gear(normal_module, pinion_teeth, pinion_diameter, *shared),
            Gear(normal_module, pinion_teeth * ratio, pinion_diameter * ratio, *shared),
        )

    def of_width(self, face_width: Any) -> "GearPair":
        """The pair with another face width [mm]."""
        pinion, wheel = (replace(gear, face_width=face_width) for gear in self.gears)
        return GearPair(pinion, wheel, self.working_distance)

    @property
    def normal_module(self) -> Any:
        """Normal module m_n [mm]."""
        return self.pinion.normal_module

    @property
    def pinion_teeth(self) -> Any:
        """Number of teeth z1."""
        return self.pinion.teeth

    @property
    def wheel_teeth(self) -> Any:
        """Number of teeth z2."""
        return self.wheel.teeth

    @property
    def face_width(self) -> Any:
        """Face width b [mm] of the mesh: of the narrower gear."""
        return self.pinion.face_width

    @property
    def gears(self) -> tuple[Gear, Gear]:
        """Pinion and wheel."""
        return self.pinion, self.wheel

    @property
    def ratio(self) -> Any:
        """Gear ratio u = z2/z1."""
        return self.wheel.teeth / self.pinion.teeth

    @property
    def reference_distance(self) -> Any:
        """Reference centre distance a_0 = d1 (1 + u)/2 [mm]."""
        return 0.5 * self.pinion.reference_diameter * (1.0 + self.ratio)

    @cached_property
    def working_angle(self) -> Any:
        """Transverse working pressure angle alpha_wt [rad]; NaN where there is none."""
        angle = self.pinion.transverse_pressure_angle
        if self.working_distance is not None:
            return angle_at_distance(self.reference_distance, angle, self.working_distance)
        shifts = self.pinion.profile_shift + self.wheel.profile_shift
        if _none(shifts):
            return angle
        teeth = self.pinion.teeth + self.wheel.teeth
        return working_pressure_angle(shifts, teeth, self.pinion.rack.pressure_angle, angle)

    @cached_property
    def centre_distance(self) -> Any:
        """Centre distance a = a_0 cos(alpha_t)/cos(alpha_wt) [mm], or the one that is given."""
        if self.working_distance is not None:
            return self.working_distance
        if _none(self.pinion.profile_shift + self.wheel.profile_shift):
            return self.reference_distance
        cosine = np.cos(self.pinion.transverse_pressure_angle)
        return self.reference_distance * cosine / np.cos(self.working_angle)

    @property
    def working_diameters(self) -> tuple[Any, Any]:
        """Working pitch diameters d_w1 = 2 a/(1 + u), d_w2 = u d_w1 [mm]."""
        pinion = 2.0 * self.centre_distance / (1.0 + self.ratio)
        return pinion, self.ratio * pinion

    @property
    def volume(self) -> Any:
        """Volume (pi/4) b d1^2 (1 + u^2) [mm3] of both gears as solid reference cylinders.

        Of rings and other bodies the sum of their volumes. Source: Chong and Lee, eq. (4),
        correct as printed.
        """
        wider = self.pinion.width_excess or self.wheel.width_excess
        if is_internal(self.wheel.teeth) or wider or self.pinion.body_diameter is not None:
            return self.pinion.volume + self.wheel.volume
        d = self.pinion.reference_diameter
        return 0.25 * np.pi * self.face_width * d**2 * (1.0 + self.ratio**2)

    @property
    def base_pitch(self) -> Any:
        """Transverse base pitch p_bt = pi m_n cos(alpha_t)/cos(beta) [mm]."""
        cosine = np.cos(self.pinion.helix_angle)
        angle = self.pinion.transverse_pressure_angle
        return np.pi * self.normal_module / cosine * np.cos(angle)

    @property
    def transverse_contact_ratio(self) -> Any:
        """Transverse contact ratio eps_alpha = g_alpha/p_bt: mean tooth pairs in contact.

        g_alpha = (sqrt(d_a1^2 - d_b1^2) + z2/|z2| sqrt(d_a2^2 - d_b2^2))/2 - a sin(alpha_wt). Too
        large with undercut (`geometry.fillet.is_undercut`). Source: ISO 6336-1, ISO 21771:2007.
        """
        first, second = (
            np.sqrt(gear.active_tip_diameter**2 - gear.base_diameter**2) for gear in self.gears
        )
        reach = 0.5 * (first + signed(second, self.wheel.base_diameter))
        return (reach - self.centre_distance * np.sin(self.working_angle)) / self.base_pitch

    @property
    def overlap_ratio(self) -> Any:
        """Overlap ratio eps_beta = b sin(|beta|)/(pi m_n); 0 for spur gears."""
        sine = np.abs(np.sin(self.pinion.helix_angle))
        return self.face_width * sine / (np.pi * self.normal_module)
