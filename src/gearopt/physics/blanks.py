"""The body of a gear below its teeth: a solid disc, or a rim, a web and a hub around a bore.

A rim or a bore that does not fit a gear is left out: that gear is solid. Every quantity is a float,
an array or a casadi scalar, as in `gears`.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.choosing import choose
from gearopt.physics.gears import Gear, is_internal

HUB = 1.6  # usual diameter of a hub over its bore
HUB_TOLERANCE = 1e-9  # of the diameter: what is this close to the hub counts as touching it
THIN = 0.5  # backup ratio up to which no standard has a rim factor
THICK = 10.0  # backup ratio of a solid gear; from 1.2 on no standard has a rim factor


@dataclass(frozen=True)
class Body:
    """The dimensions [mm] of one gear; None: it has none, as a disc has no web and no hub."""

    rim_thickness: float | None
    web_thickness: float | None
    hub_diameter: float | None
    bore: float | None


@dataclass(frozen=True)
class Blank:
    """How the blanks of gears of any size are made.

    rim_over_module s_R/m_n, or rim_thickness s_R [mm], below the root circle, None: no rim;
    web_over_width b_s/b of the web between rim and hub, from 1 on none; bore d_i [mm], 0: none;
    hub_over_bore h > 1: outer diameter of the hub, which is as wide as the gear, over the bore.

    The rim fits where it leaves a web: d_f - 2 s_R > h d_i. Else the gear is a solid disc, bored
    where the hub is inside its root circle, without a bore, as on a pinion shaft, where it is not.
    kept: the bore is the gear's own and is there whatever the hub, where the wall is not `THIN`.
    """

    rim_over_module: float | None = None
    rim_thickness: float | None = None
    web_over_width: float = 1.0
    bore: float = 0.0
    hub_over_bore: float = HUB
    kept: bool = False

    @property
    def has_rim(self) -> bool:
        """Whether gears have a rim where it fits."""
        return self.rim_over_module is not None or self.rim_thickness is not None

    @property
    def has_web(self) -> bool:
        """Whether gears are lighter below their rims, where these fit."""
        return self.has_rim and self.web_over_width < 1.0

    @property
    def solid(self) -> bool:
        """Whether every gear is a solid disc."""
        return not (self.has_web or self.bore)

    def rim(self, gear: Gear) -> Any:
        """Return the thickness s_R [mm] of the rim."""
        if self.rim_over_module is not None:
            return self.rim_over_module * gear.normal_module
        return self.rim_thickness

    def inside(self, gear: Gear) -> Any:
        """Return the diameter d_f - 2 s_R [mm] inside the rim."""
        return gear.root_diameter - 2.0 * self.rim(gear)

    @property
    def hub(self) -> float:
        """Diameter [mm] of the hub; 0 without a bore: the web reaches the axis."""
        return self.hub_over_bore * self.bore

    def where_rim(self, gear: Gear, yes: Any, no: Any) -> Any:
        """Return one value where the rim fits, which lies inside the reference circle, else one."""
        if not self.has_rim:
            return no
        d, inside = gear.reference_diameter, self.inside(gear)
        return choose(inside > self.hub + HUB_TOLERANCE * d, choose(inside < d, yes, no), no)

    def where_bore(self, gear: Gear, yes: Any, no: Any) -> Any:
        """Return one value where a gear is bored, else another."""
        if not self.bore:
            return no
        d, root = gear.reference_diameter, gear.root_diameter
        hub = (self.bore if self.kept else self.hub) + HUB_TOLERANCE * d
        if self.kept:
            root = root - THIN * (gear.tip_diameter - root)
        return choose(hub < root, choose(hub < d, yes, no), no)

    def where(self, gear: Gear, rim: Any, bored: Any, solid: Any) -> Any:
        """Return the value of the body that a gear has: with a rim, else bored, else solid."""
        return self.where_rim(gear, rim, self.where_bore(gear, bored, solid))

    def volume(self, gear: Gear) -> Any:
        """Return (pi/4) b (d^2 - (1 - b_s/b)((d_f - 2 s_R)^2 - (h d_i)^2) - d_i^2) [mm3].

        What does not fit is not taken off. Teeth count as the ring between root and reference
        circle, as in `Gear.volume`. A ring is a tube, whose rim ends at its outside, of any blank.
        """
        if self.solid or is_internal(gear.teeth):
            return gear.volume
        off: Any = self.where_bore(gear, self.bore**2, 0.0)
        if self.has_web:
            recess = (1.0 - self.web_over_width) * (self.inside(gear) ** 2 - self.hub**2)
            off = off + self.where_rim(gear, recess, 0.0)
        return 0.25 * np.pi * gear.width * (gear.body**2 - off)

    def inertia(self, gear: Gear, density: Any) -> Any:
        """Return the moment of inertia [t mm2] about the axis of what `volume` counts.

        (pi/32) rho b (d^4 - (1 - b_s/b)((d_f - 2 s_R)^4 - (h d_i)^4) - d_i^4): discs taken off.
        """
        if self.solid or is_internal(gear.teeth):
            return gear.inertia(density)
        off: Any = self.where_bore(gear, self.bore**4, 0.0)
        if self.has_web:
            recess = (1.0 - self.web_over_width) * (self.inside(gear) ** 4 - self.hub**4)
            off = off + self.where_rim(gear, recess, 0.0)
        return np.pi / 32.0 * density * gear.width * (gear.body**4 - off)

    @property
    def _hub_part(self) -> float:
        """Part of the area of its hub that a bored gear keeps: 1 - 1/h^2."""
        if self.kept:
            return 0.0
        return 1.0 - self.hub_over_bore**-2 if self.bore else 1.0

    @property
    def least_fraction(self) -> float:
        """Least part of the volume of a disc that any gear keeps: of its web, or of its hub.

        Disjoint rings cover the disc: the rim is whole, of the web b_s/b is left, of the hub
        1 - 1/h^2; and a bored gear holds its hub.
        """
        return min(1.0, self.web_over_width if self.has_web else 1.0, self._hub_part)

    def least_volume(self, gear: Gear, fewest: Any) -> Any:
        """Return a lower bound of the volume that grows with every size, a posynomial.

        fewest: the least number of teeth of the gear. With k = `least_fraction`, c m_n the depth
        from the reference circle to the inside of the rim and y = c cos(beta)/fewest, a gear with a
        web has at least k + (1 - b_s/b) 4 c (1 - y) m_n/d of a disc, which is at most
        k + (1 - b_s/b) 4 y (1 - y); a bored one has at least 1 - 1/h^2.
        """
        depth, least = self._depth(gear), self.least_fraction
        if not self.has_web or depth is None:
            return least * gear.volume
        recess, y = 1.0 - self.web_over_width, depth * np.cos(gear.helix_angle) / fewest
        ring = recess * 4.0 * depth * np.maximum(0.0, 1.0 - y) / gear.reference_diameter
        widest = np.where(y < 0.5, 4.0 * y * (1.0 - y), 1.0)
        kept = np.minimum(1.0, self._hub_part / (least + recess * widest))
        return kept * (least + ring * gear.normal_module) * gear.volume

    def _depth(self, gear: Gear) -> Any:
        """Return how deep the rim reaches below the reference circle, in modules; None: unknown."""
        if self.rim_over_module is None:
            return None
        depth = gear.rack.dedendum - gear.profile_shift + self.rim_over_module
        return depth if depth >= 0.0 else None

    def backup(self, gear: Gear) -> Any:
        """Backup ratio of the rim below the root: m_B = t_R/h_t; None of solid gears."""
        if not (self.has_rim or self.bore):
            return None
        return self.where(gear, *self.backups(gear))

    def backups(self, gear: Gear) -> tuple[Any, Any, Any]:
        """Backup ratios t_R/h_t of the bodies of `where`, whether they fit or not.

        t_R: the rim, or the wall around a bore; h_t: the whole depth of the teeth.
        """
        depth = 0.5 * (gear.tip_diameter - gear.root_diameter)
        wall = 0.5 * (gear.root_diameter - self.bore) / depth
        return self.rim(gear) / depth if self.has_rim else wall, wall, THICK

    def web(self, gear: Gear) -> tuple[Any, Any] | None:
        """Return b_s/b and s_R/m_n, b_s/b being 1 where the rim does not fit; None: no web."""
        if not (self.has_rim and self.web_over_width != 1.0):
            return None
        return self.where_rim(gear, self.web_over_width, 1.0), self.rim(gear) / gear.normal_module

    def inner_diameter(self, gear: Gear) -> Any:
        """Return the diameter [mm] inside which no mass moves with the teeth: of rim, or bore."""
        return self.where(gear, *self.inner_diameters(gear))

    def inner_diameters(self, gear: Gear) -> tuple[Any, Any, Any]:
        """Inner diameters [mm] of the bodies of `where`, whether they fit or not."""
        return self.inside(gear) if self.has_web else self.bore, self.bore, 0.0

    def body(self, gear: Gear) -> Body:
        """Return the dimensions of one gear, of floats."""
        bored = bool(self.where_bore(gear, True, False))
        rim = bool(self.where_rim(gear, True, False))
        web = rim and self.has_web
        return Body(
            float(self.rim(gear)) if rim else None,
            float(self.web_over_width * gear.width) if web else None,
            self.hub if bored and web else None,
            self.bore if bored else None,
        )


SOLID = Blank()
