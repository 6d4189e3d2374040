"""The teeth of a stage as they are cut: helix, tools, profile shifts, tips, thickness, distance."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from operator import attrgetter
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import ISO_53_A, Gear, GearPair, Rack, reference_diameter
from gearopt.physics.geometry.profile_shift import Meshing, Shifting

SAME = 1e-9  # of sums of profile shifts


@dataclass(frozen=True)
class Toothing:
    """Properties of the gears of a stage of any size; of two values the pinion's is first.

    helix_angle beta [rad] of both, below 60 degrees; racks: the basic rack of each, of one normal
    pressure angle; profile_shifts x and tip_alterations k in normal modules; thickness_allowances
    A_sn, and width_excesses by which gears are wider than the mesh [mm]; working_distance: a given
    centre distance [mm], None: the one without backlash of nominal teeth. shifting: how profile
    shifts and tip alterations follow from it, None: they are given. shift_sum: a given x1 + x2,
    from which the distance follows in place of a given one.
    pinion_shift: x1 of the sum, None: that of the rule of shifting. Of many pairs (n,) helix angle,
    distance, shift_sum and pinion_shift may be arrays. ValueError for other angles.
    Source: ISO 21771:2007.
    """

    helix_angle: Any = 0.0
    racks: tuple[Rack, Rack] = (ISO_53_A, ISO_53_A)
    profile_shifts: tuple[float, float] = (0.0, 0.0)
    tip_alterations: tuple[float, float] = (0.0, 0.0)
    thickness_allowances: tuple[float, float] = (0.0, 0.0)
    working_distance: Any = None
    shifting: Shifting | None = None
    pinion_shift: Any = None
    shift_sum: Any = None
    width_excesses: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if not np.all(np.abs(self.helix_angle) < math.pi / 3.0):  # whose cosine is rational
            raise ValueError("the helix angle must be below 60 degrees")
        first, second = (rack.pressure_angle for rack in self.racks)
        if first != second:
            raise ValueError("pinion and wheel need one normal pressure angle")

    @property
    def cosine(self) -> float:
        """Cosine of the helix angle."""
        return math.cos(self.helix_angle)

    @property
    def addenda(self) -> tuple[float, float]:
        """Addenda h_aP + x + k of pinion and wheel over the reference circle, in normal modules."""
        rows = zip(self.racks, self.profile_shifts, self.tip_alterations, strict=True)
        first, second = (rack.addendum + x + k for rack, x, k in rows)
        return first, second

    @property
    def on_reference(self) -> bool:
        """Whether the centre distance is that of the reference circles: x1 + x2 = 0, none given."""
        shifted = self.working_distance is not None or self.shift_sum is not None
        return not shifted and sum(self.profile_shifts) == 0

    @property
    def given(self) -> bool:
        """Whether the centre distance is given, and profile shifts follow from it."""
        return self.working_distance is not None and self.shifting is not None

    def at(self, values: Mapping[str, Any]) -> "Toothing":
        """The toothing with other values of COLUMNS."""
        return replace(self, **dict[str, Any](values))

    @property
    def by_reference(self) -> "Toothing":
        """The toothing of gears that count as their reference cylinders: without chosen shifts."""
        return replace(self, shifting=None, pinion_shift=None, shift_sum=None)

    def made(self, pair: GearPair) -> bool:
        """Whether a pair of floats has this helix angle and given distance, x1 + x2 and x1."""
        helix, distance = pair.pinion.helix_angle, pair.working_distance
        if self.shift_sum is not None:
            total = pair.pinion.profile_shift + pair.wheel.profile_shift
            if abs(total - self.shift_sum) > SAME:
                return False
        shifted = self.pinion_shift is None or pair.pinion.profile_shift == self.pinion_shift
        return bool(helix == self.helix_angle and distance == self.working_distance and shifted)

    def pair(
        self,
        module: Any,
        pinion_teeth: Any,
        wheel_teeth: Any,
        face_width: Any,
        shifts: tuple[Any, Any, Any] | None = None,
    ) -> GearPair:
        """Return the gear pair with these numbers; module, face_width [mm].

        shifts: of `shifts`, where they are known. The wheel's reference diameter is u d1, as in
        `of_diameter`: whole teeth and real-valued ones then agree to the last bit.
        """
        d1 = reference_diameter(module, pinion_teeth, self.helix_angle)
        diameters = d1, d1 * (wheel_teeth / pinion_teeth)
        return self._pair(module, (pinion_teeth, wheel_teeth), diameters, face_width, shifts)

    def shifts(self, module: Any, pinion_teeth: Any, wheel_teeth: Any) -> tuple[Any, Any, Any]:
        """Profile shifts x1, x2 and shortening k of tips that follow from the distance or sum."""
        assert self.shifting is not None
        numbers = module, (pinion_teeth, wheel_teeth), self.helix_angle, self.racks
        if self.shift_sum is None:
            return self.shifting.shifts(Meshing(*numbers, self.working_distance), self.pinion_shift)
        meshing = Meshing.of_sum(*numbers, self.shift_sum)
        first, _, shorter = self.shifting.shifts(meshing, self.pinion_shift)
        return first, self.shift_sum - first, shorter

    def of_diameter(
        self, module: Any, pinion_teeth: Any, pinion_diameter: Any, ratio: Any, face_width: Any
    ) -> GearPair:
        """Return the gear pair of a pinion and a ratio; arguments as in `GearPair.of_diameter`."""
        teeth = pinion_teeth, pinion_teeth * ratio
        diameters = pinion_diameter, pinion_diameter * ratio
        return self._pair(module, teeth, diameters, face_width)

    def _pair(
        self,
        module: Any,
        teeth: tuple[Any, Any],
        diameters: tuple[Any, Any],
        face_width: Any,
        known: tuple[Any, Any, Any] | None = None,
    ) -> GearPair:
        """Return the pair of these numbers of teeth and reference diameters [mm].

        Where shifts are chosen a gear counts as a cylinder of d + 2 x m_n, for by reference circles
        shifts would seem to spare more than they do.
        """
        shifts, alterations, bodies = self._shifts_and_diameters(module, teeth, diameters, known)
        first, second = (
            Gear(
                module,
                teeth[i],
                diameters[i],
                face_width,
                self.helix_angle,
                self.racks[i],
                shifts[i],
                alterations[i],
                self.thickness_allowances[i],
                bodies[i],
                self.width_excesses[i],
            )
            for i in range(2)
        )
        return GearPair(first, second, self.working_distance)

    def _shifts_and_diameters(
        self,
        module: Any,
        teeth: tuple[Any, Any],
        diameters: tuple[Any, Any],
        known: tuple[Any, Any, Any] | None,
    ) -> tuple[tuple[Any, Any], tuple[Any, Any], tuple[Any, Any]]:
        """Return profile shifts, tip alterations and diameters of bodies [mm], None: d."""
        if self.shifting is None:
            return self.profile_shifts, self.tip_alterations, (None, None)
        first, second, shorter = self.shifts(module, *teeth) if known is None else known
        bodies = diameters[0] + 2.0 * first * module, diameters[1] + 2.0 * second * module
        return (first, second), (shorter, shorter), bodies

    def alike(self, other: "Toothing") -> bool:
        """Whether another one differs in helix angle, given distance and pinion_shift alone."""
        first, second = _columns_of(self), _columns_of(other)
        return bool(_alike_of(self) == _alike_of(other)) and all(
            (value is None) == (held is None) for value, held in zip(first, second, strict=True)
        )


COLUMNS = ("helix_angle", "working_distance", "pinion_shift", "shift_sum")  # that may differ
ALIKE = ("racks", "profile_shifts", "tip_alterations", "thickness_allowances", "shifting")
_columns_of, _alike_of = attrgetter(*COLUMNS), attrgetter(*ALIKE, "width_excesses")


def in_columns(toothings: Sequence[Toothing]) -> Toothing:
    """Several toothings that are alike as one, whose COLUMNS are arrays where they are given."""
    first = toothings[0]
    names = [name for name in COLUMNS if getattr(first, name) is not None]
    columns: dict[str, Any] = {
        name: np.array([getattr(t, name) for t in toothings]) for name in names
    }
    return replace(first, **columns)


def taken(columns: Toothing, row: Any) -> Toothing:
    """Some of the toothings of `in_columns`, by their places (n,)."""
    held = {name: getattr(columns, name) for name in COLUMNS}
    some: dict[str, Any] = {name: v[row] for name, v in held.items() if v is not None}
    return replace(columns, **some)
