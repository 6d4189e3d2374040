"""External cylindrical gears and gear pairs without profile shift (ISO 21771 terms), in mm and t.

Every quantity is a float, an array (all of one shape) or a casadi scalar; numbers of teeth may be
real.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.physics.geometry import overlap_ratio, transverse_contact_ratio
from gearopt.physics.geometry import transverse_pressure_angle as transverse_angle
from gearopt.physics.inertia import disc_inertia, disc_mass


@dataclass(frozen=True)
class Rack:
    """Basic rack: pressure angle alpha_P [rad], addendum h_aP and dedendum h_fP in normal modules.

    Source: ISO 53:1998, profile A; the same in Rack.m of github.com/gfsReboucas/Drivetrain, and
    what the diameters of its KISSsoft report (NREL 5 MW gearbox, stage 3) follow.
    """

    pressure_angle: float = math.radians(20.0)
    addendum: float = 1.0
    dedendum: float = 1.25


ISO_53_A = Rack()


@dataclass(frozen=True)
class Gear:
    """An external gear: normal module m_n > 0 [mm], number of teeth z > 0, face width b > 0 [mm].

    helix_angle beta [rad], |beta| < pi/2; rack: its basic rack. Diameters are nominal: without
    backlash. Source: ISO 21771:2007.
    """

    normal_module: Any
    teeth: Any
    face_width: Any
    helix_angle: Any = 0.0
    rack: Rack = ISO_53_A

    @property
    def transverse_pressure_angle(self) -> Any:
        """Transverse pressure angle alpha_t = arctan(tan(alpha_n)/cos(beta)) [rad]."""
        return transverse_angle(self.rack.pressure_angle, self.helix_angle)

    @property
    def reference_diameter(self) -> Any:
        """Reference diameter d = m_n z/cos(beta) [mm]."""
        return self.normal_module * self.teeth / np.cos(self.helix_angle)

    @property
    def tip_diameter(self) -> Any:
        """Tip diameter d_a = d + 2 h_aP [mm]."""
        return self.reference_diameter + 2.0 * self.rack.addendum * self.normal_module

    @property
    def root_diameter(self) -> Any:
        """Root diameter d_f = d - 2 h_fP [mm]."""
        return self.reference_diameter - 2.0 * self.rack.dedendum * self.normal_module

    @property
    def base_diameter(self) -> Any:
        """Base diameter d_b = d cos(alpha_t) [mm]."""
        return self.reference_diameter * np.cos(self.transverse_pressure_angle)

    @property
    def tip_pitch(self) -> Any:
        """Pitch pi d_a/z on the tip circle [mm]."""
        return np.pi * self.tip_diameter / self.teeth

    @property
    def volume(self) -> Any:
        """Volume (pi/4) b d^2 [mm3] as a solid reference cylinder."""
        return 0.25 * np.pi * self.face_width * self.reference_diameter**2

    def mass(self, density: Any) -> Any:
        """Return the mass [t] as a solid reference cylinder; density [t/mm3]."""
        return disc_mass(density, self.face_width, self.reference_diameter)

    def inertia(self, density: Any) -> Any:
        """Return the moment of inertia [t mm2] as a solid reference cylinder; density [t/mm3]."""
        return disc_inertia(density, self.face_width, self.reference_diameter)


@dataclass(frozen=True)
class GearPair:
    """Two gears in mesh at their reference centre distance: index 1 the pinion, 2 the wheel.

    normal_module m_n, face_width b [mm], pinion_teeth z1, wheel_teeth z2 > 0; helix_angle beta
    [rad], |beta| < pi/2 (of the pinion; the wheel's has the other hand). Source: ISO 21771:2007.
    """

    normal_module: Any
    pinion_teeth: Any
    wheel_teeth: Any
    face_width: Any
    helix_angle: Any = 0.0
    rack: Rack = ISO_53_A

    def _gear(self, teeth: Any) -> Gear:
        return Gear(self.normal_module, teeth, self.face_width, self.helix_angle, self.rack)

    @property
    def pinion(self) -> Gear:
        """The driving gear of a reduction."""
        return self._gear(self.pinion_teeth)

    @property
    def wheel(self) -> Gear:
        """The driven gear of a reduction."""
        return self._gear(self.wheel_teeth)

    @property
    def gears(self) -> tuple[Gear, Gear]:
        """Pinion and wheel."""
        return self.pinion, self.wheel

    @property
    def ratio(self) -> Any:
        """Gear ratio u = z2/z1."""
        return self.wheel_teeth / self.pinion_teeth

    @property
    def centre_distance(self) -> Any:
        """Reference centre distance a = d1 (1 + u)/2 [mm]."""
        return 0.5 * self.pinion.reference_diameter * (1.0 + self.ratio)

    @property
    def volume(self) -> Any:
        """Volume (pi/4) b d1^2 (1 + u^2) [mm3] of both gears as solid reference cylinders.

        Source: Chong and Lee, eq. (4), correct as printed.
        """
        d = self.pinion.reference_diameter
        return 0.25 * np.pi * self.face_width * d**2 * (1.0 + self.ratio**2)

    def mass(self, density: Any) -> Any:
        """Return the mass [t] of both gears as solid reference cylinders; density [t/mm3]."""
        return density * self.volume

    @property
    def base_pitch(self) -> Any:
        """Transverse base pitch p_bt = pi m_n cos(alpha_t)/cos(beta) [mm]."""
        cosine = np.cos(self.helix_angle)
        angle = self.pinion.transverse_pressure_angle
        return np.pi * self.normal_module / cosine * np.cos(angle)

    @property
    def transverse_contact_ratio(self) -> Any:
        """Transverse contact ratio eps_alpha; validity as the law of this name."""
        pinion, wheel = self.gears
        return transverse_contact_ratio(
            (pinion.tip_diameter, wheel.tip_diameter),
            (pinion.base_diameter, wheel.base_diameter),
            self.centre_distance,
            pinion.transverse_pressure_angle,
            self.base_pitch,
        )

    @property
    def overlap_ratio(self) -> Any:
        """Overlap ratio eps_beta; 0 for spur gears."""
        return overlap_ratio(self.face_width, self.normal_module, self.helix_angle)
