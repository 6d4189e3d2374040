"""Profile shifts that a centre distance asks for: their sum, and how a rule shares it out.

Arguments are floats or arrays of one shape; the tips of both gears are shortened by k = y - (x1 +
x2), which leaves the clearance of the tools.
"""

from collections.abc import Callable
from dataclasses import field
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import (
    Gear,
    GearPair,
    Rack,
    reference_diameter,
    transverse_pressure_angle,
)
from gearopt.physics.geometry.contact import contact_path, root_sliding
from gearopt.physics.geometry.fillet import NEGLIGIBLE, form_diameter, undercut_depth
from gearopt.physics.geometry.involute import (
    angle_at_distance,
    shift_sum,
    working_pressure_angle,
)
from gearopt.physics.geometry.tooth import tip_thickness

HALVINGS = 52  # of an interval of shifts: to the last digit
SUMS = -1.0, 2.0  # of x1 + x2 that are looked at: 0 to 1 is usual
ROUND = 1e-9  # of sums
PINIONS = -1.5, 1.5  # of x1 by a rule that are looked at: -0.5 to 0.8 is usual
STRIDE = 0.1  # of x1, from equal sliding to where root safeties change sides
ROOT_STEPS, CLOSE = 40, 1e-13  # towards equal root safeties, within this of x1
EQUAL = 1e-9  # of ln(S_F1/S_F2): farther off is a jump, no root


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

    @classmethod
    def of_sum(
        cls,
        module: Any,
        teeth: tuple[Any, Any],
        helix_angle: Any,
        racks: tuple[Rack, Rack],
        total: Any,
    ) -> "Meshing":
        """The meshing of gears whose shifts have a sum x1 + x2, without backlash."""
        unit = cls(module, teeth, helix_angle, racks, np.nan)
        normal, transverse = unit.pressure_angles
        working = working_pressure_angle(total, teeth[0] + teeth[1], normal, transverse)
        shorter = np.cos(transverse) / np.cos(working)
        return cls(module, teeth, helix_angle, racks, sum(unit.reference_radii) * shorter)

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

    @property
    def base_radii(self) -> tuple[Any, Any]:
        """Radii of the base circles [mm]."""
        first, second = (r * np.cos(self.pressure_angles[1]) for r in self.reference_radii)
        return first, second

    def take(self, place: Any) -> "Meshing":
        """Some of many (n,); place: an index of arrays, as numpy takes it."""
        first, second = (z[place] for z in self.teeth)
        module, helix, distance = self.module[place], self.helix_angle[place], self.distance[place]
        return Meshing(module, (first, second), helix, self.racks, distance)

    def clear(self) -> tuple[Any, Any]:
        """Ends of x1 between which no tip reaches the tangent point of its mate's base circle."""
        line = self.distance * np.sin(self.working_angle)
        lift = (self.distance - sum(self.reference_radii)) / self.module
        rows = zip(self.base_radii, self.reference_radii, self.racks, strict=True)
        first, second = (
            (np.hypot(base, line) - r) / self.module - rack.addendum + rack.tip_chamfer - lift
            for base, r, rack in rows
        )
        return -second, first + self.shift_sum


@np.errstate(invalid="ignore", divide="ignore")
def equal_sliding(meshing: Meshing) -> Any:
    """Return x1 of equal specific sliding at the root ends of both flanks; NaN where there is none.

    The tip radius of the wheel, r_2 + (h_aP + y - x1) m_n, falls and that of the pinion rises with
    x1: zeta_1A rises, zeta_2E falls, from minus infinity where the wheel's tip reaches the tangent
    point of the pinion's base circle to minus infinity of the other. So there is one root between.
    Source: ISO 21771:2007, specific sliding; the rule is met by four published stages
    (tests/physics/geometry).
    """
    line = meshing.distance * np.sin(meshing.working_angle)
    radii, bases = meshing.reference_radii, meshing.base_radii
    lift = (meshing.distance - sum(radii)) / meshing.module
    total, ratio = meshing.shift_sum, meshing.ratio
    low, high = meshing.clear()
    good = low < high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        shifts = middle, total - middle
        tips = [
            r + (rack.addendum - rack.tip_chamfer + lift - other) * meshing.module
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


Balance = Callable[[Meshing, Any], Any]


@np.errstate(invalid="ignore", divide="ignore")
def equal_root_safety(meshing: Meshing, balance: Balance) -> Any:
    """Return x1 of equal safety of both roots, of many pairs (n,); NaN where there is none.

    balance(meshing, x1): S_F1/S_F2. It rises with x1 but of a few pairs, of which it turns near an
    end: the root nearest to equal sliding is taken, by strides from there, within the shifts of
    gears that are not undercut and do not interfere.
    """
    low, high = _usable(meshing)
    middle = np.clip(equal_sliding(meshing), low, high)
    start = np.log(balance(meshing, middle))
    inner, outer = np.full_like(middle, np.nan), np.full_like(middle, np.nan)
    known = {1.0: [middle.copy(), start.copy()], -1.0: [middle.copy(), start.copy()]}
    left = np.isfinite(start) & (low <= high)
    while left.any():
        place = np.flatnonzero(left)
        some, nearest = meshing.take(place), np.full(len(place), np.inf)
        for sign, (last, value) in known.items():
            x = np.clip(last[place] + sign * STRIDE, low[place], high[place])
            new = np.log(balance(some, x))
            share = value[place] / (value[place] - new)
            far = np.abs(last[place] + share * (x - last[place]) - middle[place])
            crossed = (value[place] * new <= 0.0) & (far < nearest)
            inner[place[crossed]], outer[place[crossed]] = last[place][crossed], x[crossed]
            nearest = np.where(crossed, far, nearest)
            last[place], value[place] = x, new
        ended = (known[1.0][0] >= high) & (known[-1.0][0] <= low)
        left &= np.isnan(outer) & ~ended
    return _between(meshing, balance, inner, outer)


def _usable(meshing: Meshing) -> tuple[Any, Any]:
    """Ends of x1 of gears that are not undercut, and whose tips do not interfere."""
    rows = zip(meshing.teeth, meshing.reference_radii, meshing.racks, strict=True)
    first, second = (
        undercut_depth(Gear(meshing.module, z, 2.0 * r, 1.0, meshing.helix_angle, rack))
        / meshing.module
        - NEGLIGIBLE
        for z, r, rack in rows
    )
    low, high = meshing.clear()
    return np.maximum(low, first), np.minimum(high, meshing.shift_sum - second)


def _between(meshing: Meshing, balance: Balance, low: Any, high: Any) -> Any:
    """Return x1 of S_F1 = S_F2 between two of opposite sides; NaN: there are none, or it jumps.

    By chords, halving the value of an end that stays (Illinois).
    """
    root = np.full_like(low, np.nan)
    place = np.flatnonzero(np.isfinite(high))
    some, a, b = meshing.take(place), low[place], high[place]
    fa, fb = np.log(balance(some, a)), np.log(balance(some, b))
    for _ in range(ROOT_STEPS):
        x = np.where(fa == fb, b, b - fb * (b - a) / (fb - fa))
        f = np.log(balance(some, x))
        other = f * fb < 0.0
        a, fa = np.where(other, b, a), np.where(other, fb, 0.5 * fa)
        shorter = np.abs(x - b)
        b, fb = x, f
        done = (f == 0.0) | (np.minimum(shorter, np.abs(b - a)) <= CLOSE)
        root[place[done]] = np.where(np.abs(f) <= EQUAL, x, np.nan)[done]
        place, some = place[~done], some.take(~done)
        a, b, fa, fb = (v[~done] for v in (a, b, fa, fb))
        if not len(place):
            break
    return root


ROOT_SAFETY = "equal root safety"  # which takes the strength of the roots, beside the teeth
RULES: dict[str, Callable[[Meshing], Any]] = {
    "equal sliding": equal_sliding,
    "after Roloff": after_roloff,
    "after Henriot": after_henriot,
}


@dataclass(frozen=True)
class Shifting:
    """How shifts follow from a centre distance, and what the teeth may become by them.

    rule: a key of RULES, or ROOT_SAFETY, which needs a balance, S_F1/S_F2 of a meshing and x1;
    tip_thickness: least s_an of either gear, in normal modules; contact_ratio: least eps_alpha;
    sliding: largest specific sliding of either root, without sign.
    """

    rule: str = "equal sliding"
    tip_thickness: float = 0.2
    contact_ratio: float = 1.1
    sliding: float = 3.0
    balance: Balance | None = field(default=None, hash=False)

    @np.errstate(invalid="ignore")
    def shifts(self, meshing: Meshing, given: Any = None) -> tuple[Any, Any, Any]:
        """Return x1, x2 and the shortening k of both tips; NaN outside SUMS, and without a root.

        given: x1, instead of that of the rule, which is NaN outside PINIONS.
        """
        numbers = meshing.module, *meshing.teeth, meshing.helix_angle, meshing.distance
        columns = np.broadcast_arrays(*(np.asarray(v, float) for v in numbers))
        total = np.broadcast_to(meshing.shift_sum, columns[0].shape)
        near = (total >= SUMS[0] - ROUND) & (total <= SUMS[1] + ROUND)
        module, first, second, helix, distance = (column[near] for column in columns)
        inside = Meshing(module, (first, second), helix, meshing.racks, distance)
        pinion = np.full(total.shape, np.nan)
        if given is not None:
            pinion[near] = np.broadcast_to(given, total.shape)[near]
        elif self.rule == ROOT_SAFETY:
            assert self.balance is not None
            pinion[near] = equal_root_safety(inside, self.balance)
        else:
            pinion[near] = RULES[self.rule](inside)
        if given is None:
            pinion[(pinion < PINIONS[0]) | (pinion > PINIONS[1])] = np.nan
        return pinion[()], (total - pinion)[()], (meshing.tip_alteration + 0.0 * pinion)[()]

    @np.errstate(invalid="ignore", divide="ignore")
    def used(self, pair: GearPair) -> dict[str, Any]:
        """Shares of the limits that a pair uses, by name; NaN or infinite: it has no such teeth."""
        return self.used_by_gears(pair) | self.used_in_mesh(pair)

    @np.errstate(invalid="ignore", divide="ignore")
    def left(self, pair: GearPair) -> dict[str, Any]:
        """What a pair leaves of the limits but interference, of each gear; negative: exceeded.

        Smooth in all sizes, in modules: of specific sliding, 1 - rho_2/(u rho_1) >= -s at the root
        of the pinion, as rho_1 + rho_2 is the line of action's a sin(alpha_wt).
        """
        module, path, u = pair.normal_module, contact_path(pair), pair.ratio
        line = sum(path.curvatures)
        lowest = path.root_curvatures
        roots = (
            lowest[0] * (1.0 + u * (1.0 + self.sliding)) - line,
            lowest[1] * (u + 1.0 + self.sliding) - u * line,
        )
        left = {"contact_ratio": path.transverse_ratio - self.contact_ratio}
        for k, (gear, root) in enumerate(zip(pair.gears, roots, strict=True)):
            left |= {
                f"tip_thickness{k}": tip_thickness(gear) / module - self.tip_thickness,
                f"undercut{k}": NEGLIGIBLE - undercut_depth(gear) / module,
                f"specific_sliding{k}": root / module,
            }
        return left

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
        formed = [0.5 * np.sqrt(form_diameter(g) ** 2 - g.base_diameter**2) for g in pair.gears]
        rows = zip(formed, path.root_curvatures, strict=True)
        deep = np.maximum(*(form - low for form, low in rows))
        return {
            "contact_ratio": self.contact_ratio / path.transverse_ratio,
            "specific_sliding": -np.minimum(*root_sliding(path, pair)) / self.sliding,
            "interference": 1.0 + deep / module,
        }
