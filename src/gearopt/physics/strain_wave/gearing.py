"""A strain wave gearing: teeth of flexspline and circular spline, rim and wave generator."""

import math
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.geometry.involute import involute

WAVES = ("cosine", "ellipse", "discs")  # shapes that a wave generator gives the flexspline


@dataclass(frozen=True)
class StrainWave:
    """A gearing of two lobes: z_f teeth of the flexspline in z_c = z_f + 2 of an involute spline.

    module m [mm]; teeth z_f; pressure_angle alpha [rad]; profile_shift x and addendum h_a of the
    circular spline, clearance c and deflection w = w_0/m in modules; rim h [mm], the flexspline's
    thickness below its teeth; wave: of WAVES; wrap [rad]: half the angle over which each of two
    discs carries the flexspline. neutral [mm]: the neutral radius R_m where it is given. Else the
    flexspline's root leaves the clearance to the circular spline's tip on the major axis.
    """

    module: Any
    teeth: Any
    pressure_angle: Any = math.radians(20.0)
    profile_shift: Any = 0.0
    addendum: Any = 0.6
    deflection: Any = 1.0
    rim: Any = 0.8
    clearance: Any = 0.25
    wave: str = "cosine"
    wrap: float = math.radians(30.0)
    neutral: Any = None

    @property
    def circular_teeth(self) -> Any:
        """Number of teeth z_c of the circular spline."""
        return self.teeth + 2

    @property
    def ratio(self) -> Any:
        """Reduction z_f/(z_c - z_f) with the circular spline at rest."""
        return 0.5 * self.teeth

    @property
    def teeth_ratio(self) -> Any:
        """Quotient k = z_f/z_c: turn of the space for one of the undeformed flexspline."""
        return self.teeth / self.circular_teeth

    @property
    def radial_deflection(self) -> Any:
        """Largest radial displacement w_0 = w m [mm]."""
        return self.deflection * self.module

    @property
    def pitch_radius(self) -> Any:
        """Reference radius r_p = m z_c/2 of the circular spline [mm]."""
        return 0.5 * self.module * self.circular_teeth

    @property
    def base_radius(self) -> Any:
        """Base radius r_b = r_p cos(alpha) of the circular spline [mm]."""
        return self.pitch_radius * np.cos(self.pressure_angle)

    @property
    def half_angle(self) -> Any:
        """Half the angle eta of a space of the circular spline on its base circle [rad].

        eta = (pi/2 + 2 x tan(alpha))/z_c + inv(alpha).
        """
        angle = self.pressure_angle
        widened = 0.5 * math.pi + 2.0 * self.profile_shift * np.tan(angle)
        return widened / self.circular_teeth + involute(angle)

    @property
    def tip_radius(self) -> Any:
        """Tip radius r_a = r_p + m (x - h_a) of the circular spline [mm]."""
        return self.pitch_radius + self.module * (self.profile_shift - self.addendum)

    @property
    def active_radius(self) -> Any:
        """Largest radius r_w = r_p + m (x + h_a) of the circular spline's flank in use [mm]."""
        return self.pitch_radius + self.module * (self.profile_shift + self.addendum)

    @property
    def root_radius(self) -> Any:
        """Root radius r_w + c m of the circular spline [mm]."""
        return self.active_radius + self.clearance * self.module

    @property
    def neutral_radius(self) -> Any:
        """Neutral radius R_m of the undeformed flexspline [mm]."""
        if self.neutral is not None:
            return self.neutral
        root = self.tip_radius - self.radial_deflection - self.clearance * self.module
        return root - 0.5 * self.rim

    @property
    def blank_radius(self) -> Any:
        """Reference radius m z_f/2 of the undeformed flexspline [mm]."""
        return 0.5 * self.module * self.teeth
