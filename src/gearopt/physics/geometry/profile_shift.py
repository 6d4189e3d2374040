"""Profile shifts that a centre distance asks for: their sum, and how a rule shares it out.

Arguments are floats or arrays of one shape; the tips of both gears are shortened by k = y - (x1 +
x2), which leaves the clearance of the tools.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.physics.gears import GearPair, Rack, reference_diameter, transverse_pressure_angle
from gearopt.physics.geometry.contact import contact_path, specific_sliding
from gearopt.physics.geometry.fillet import NEGLIGIBLE, form_diameter, undercut_depth
from gearopt.physics.geometry.involute import angle_at_distance, shift_sum
from gearopt.physics.geometry.tooth import tip_thickness

HALVINGS = 52  # of an interval of shifts: to the last digit
SUMS = -1.0, 2.0  # of x1 + x2 that are looked at: 0 to 1 is usual


@dataclass(frozen=True)
class Meshing:
    """Two numbers of teeth of a normal module [mm] that mesh without backlash at a distance [mm].

    teeth z1, z2; helix_angle [rad]; racks: of pinion and wheel, of one normal pressure angle;
    distance a [mm].
    """

    module: Any
    teeth: tuple[Any, Any]
    helix_angle: Any
    racks: tuple[Rack, Rack]
    distance: Any

    @property
    def ratio(self) -> Any:
        """Gear ratio u = z2/z1."""
        return self.teeth[1] / self.teeth[0]

    @property
    def pressure_angles(self) -> tuple[Any, Any]:
        """Pressure angles of the racks alpha_n and alpha_t [rad]."""
        normal = self.racks[0].pressure_angle
        return normal, transverse_pressure_angle(normal, self.helix_angle)

    @property
    def reference_radii(self) -> tuple[Any, Any]:
        """Radii of the reference circles [mm]."""
        first, second = (
            0.5 * reference_diameter(self.module, z, self.helix_angle) for z in self.teeth
        )
        return first, second

    @property
    def working_angle(self) -> Any:
        """Transverse working pressure angle alpha_wt [rad]; NaN where base circles overlap."""
        return angle_at_distance(sum(self.reference_radii), self.pressure_angles[1], self.distance)

    @property
    def shift_sum(self) -> Any:
        """Sum x1 + x2 without backlash, in normal modules."""
        return shift_sum(self.working_angle, sum(self.teeth), *self.pressure_angles)

    @property
    def tip_alteration(self) -> Any:
        """Shortening k = (a - a_0)/m_n - (x1 + x2) <= 0 of both gears, in normal modules."""
        return (self.distance - sum(self.reference_radii)) / self.module - self.shift_sum


@np.errstate(invalid="ignore", divide="ignore")
def equal_sliding(meshing: Meshing) -> Any:
    """Return x1 of equal specific sliding at the root ends of both flanks; NaN where there is none.

    The tip radius of the wheel, r_2 + (h_aP + y - x1) m_n, falls and that of the pinion rises with
    x1: zeta_1A rises, zeta_2E falls, from minus infinity where the wheel's tip reaches the tangent
    point of the pinion's base circle to minus infinity of the other. So there is one root between.
    Source: ISO 21771:2007, specific sliding; the rule is met by four published stages
    (tests/physics/geometry).
    """
    normal, transverse = meshing.pressure_angles
    line = meshing.distance * np.sin(meshing.working_angle)
    radii, bases = (
        meshing.reference_radii,
        [r * np.cos(transverse) for r in meshing.reference_radii],
    )
    lift = (meshing.distance - sum(radii)) / meshing.module
    highest = [np.hypot(base, line) for base in bases]  # radii of tips that reach the mate's T
    room = [
        (top - r) / meshing.module - rack.addendum - lift
        for top, r, rack in zip(highest, radii, meshing.racks, strict=True)
    ]
    total, ratio = meshing.shift_sum, meshing.ratio
    low, high = -room[1], room[0] + total
    good = low < high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        shifts = middle, total - middle
        tips = [
            r + (rack.addendum + lift - other) * meshing.module
            for r, rack, other in zip(radii, meshing.racks, shifts[::-1], strict=True)
        ]
        end, start = (
            np.sqrt(np.maximum(tip**2 - base**2, 0.0))
            for tip, base in zip(tips, bases, strict=True)
        )
        pinion, wheel = start / (ratio * (line - start)), ratio * end / (line - end)
        slides = pinion > wheel  # 1 - zeta: the pinion's root slides more
        low, high = np.where(slides, middle, low), np.where(slides, high, middle)
    return np.where(good, 0.5 * (low + high), np.nan)[()]


def after_roloff(meshing: Meshing) -> Any:
    """Return x1 = S/2 + (1/2 - S/2) log(u)/log(z_n1 z_n2/100), z_n = z/cos(beta)^3.

    Source: Roloff/Matek, for DIN 3992 [unverified]: one book, from memory.
    """
    half = 0.5 * meshing.shift_sum
    virtual = meshing.teeth[0] * meshing.teeth[1] / np.cos(meshing.helix_angle) ** 6
    return half + (0.5 - half) * np.log(meshing.ratio) / np.log(virtual / 100.0)


def after_henriot(meshing: Meshing) -> Any:
    """Return x1 = lambda (u - 1)/(u + 1) + S/(u + 1), lambda = 0.7, of reducing pairs.

    Source: Henriot, as ISO/TR 4467 has it [unverified]: lambda is 0.5 to 0.75 in print.
    """
    u = meshing.ratio
    return (0.7 * (u - 1.0) + meshing.shift_sum) / (u + 1.0)


RULES: dict[str, Callable[[Meshing], Any]] = {
    "equal sliding": equal_sliding,
    "after Roloff": after_roloff,
    "after Henriot": after_henriot,
}


@dataclass(frozen=True)
class Shifting:
    """How shifts follow from a centre distance, and what the teeth may become by them.

    rule: a key of RULES. tip_thickness: least s_an of either gear, in normal modules;
    contact_ratio: least eps_alpha; sliding: largest specific sliding of either root, without sign.
    """

    rule: str = "equal sliding"
    tip_thickness: float = 0.2
    contact_ratio: float = 1.1
    sliding: float = 3.0

    @np.errstate(invalid="ignore")
    def shifts(self, meshing: Meshing, given: Any = None) -> tuple[Any, Any, Any]:
        """Return x1, x2 and the shortening k of both tips; NaN outside SUMS, and without a root.

        given: x1, instead of that of the rule.
        """
        numbers = meshing.module, *meshing.teeth, meshing.helix_angle, meshing.distance
        columns = np.broadcast_arrays(*(np.asarray(v, float) for v in numbers))
        total = np.broadcast_to(meshing.shift_sum, columns[0].shape)
        near = (total >= SUMS[0]) & (total <= SUMS[1])
        module, first, second, helix, distance = (column[near] for column in columns)
        inside = Meshing(module, (first, second), helix, meshing.racks, distance)
        pinion = np.full(total.shape, np.nan)
        if given is None:
            pinion[near] = RULES[self.rule](inside)
        else:
            pinion[near] = np.broadcast_to(given, total.shape)[near]
        return pinion[()], (total - pinion)[()], (meshing.tip_alteration + 0.0 * pinion)[()]

    @np.errstate(invalid="ignore", divide="ignore")
    def used(self, pair: GearPair) -> dict[str, Any]:
        """Shares of the limits that a pair uses, by name; NaN or infinite: it has no such teeth."""
        return self.used_by_gears(pair) | self.used_in_mesh(pair)

    @np.errstate(invalid="ignore", divide="ignore")
    def used_by_gears(self, pair: GearPair) -> dict[str, Any]:
        """Shares of the limits that each gear uses alone, in closed form.

        Undercut counts from NEGLIGIBLE modules on; of a tip without thickness the use is infinite.
        """
        module = pair.normal_module
        thin = np.minimum(*(tip_thickness(gear) for gear in pair.gears))
        cut = np.maximum(*(undercut_depth(gear) for gear in pair.gears))
        return {
            "tip_thickness": np.where(thin > 0.0, self.tip_thickness * module / thin, np.inf)[()],
            "undercut": 1.0 - NEGLIGIBLE + cut / module,
        }

    @np.errstate(invalid="ignore", divide="ignore")
    def used_in_mesh(self, pair: GearPair) -> dict[str, Any]:
        """Shares of the limits that gears use together; form circles of undercut ones are sought.

        interference: contact begins above the form circles, d_Nf >= d_Ff (ISO 21771:2007), in radii
        of curvature and modules.
        """
        module, path = pair.normal_module, contact_path(pair)
        first = specific_sliding(path, pair.ratio, path.start)[0]
        second = specific_sliding(path, pair.ratio, path.end)[1]
        lowest = path.radii_of_curvature(path.start)[0], path.radii_of_curvature(path.end)[1]
        formed = [0.5 * np.sqrt(form_diameter(g) ** 2 - g.base_diameter**2) for g in pair.gears]
        deep = np.maximum(*(form - low for form, low in zip(formed, lowest, strict=True)))
        return {
            "contact_ratio": self.contact_ratio / path.transverse_ratio,
            "specific_sliding": -np.minimum(first, second) / self.sliding,
            "interference": 1.0 + deep / module,
        }
