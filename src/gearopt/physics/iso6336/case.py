"""Data of a rating by ISO 6336, beside pair and operation."""

from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import Gear, GearPair, is_internal
from gearopt.physics.geometry.contact import contact_path
from gearopt.physics.iso6336.accuracy import TOLERANCES, Deviations, deviations
from gearopt.physics.iso6336.bending_factors import THIN_RING
from gearopt.physics.iso6336.contact_factors import PROFILE_MODIFICATIONS
from gearopt.physics.iso6336.curves import LOWEST, Curve, bending_curve, pitting_curve
from gearopt.physics.iso6336.load_factors import (
    ARRANGEMENTS,
    HELIX_MODIFICATIONS,
    Shaft,
    twist_of_meshes,
)
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.tooth_form import SHIFTS, ToothForm, tooth_forms
from gearopt.physics.rating import Operation

EDITIONS = ("2006", "2019")


@dataclass(frozen=True)
class Practice:
    """How the pair is made and rated.

    edition: of EDITIONS; tolerances: of `accuracy.TOLERANCES`; grades: of accuracy by ISO 1328,
    pinion and wheel; shift: of `tooth_form.SHIFTS`, the one that Y_F takes; viscosity nu_40
    [mm2/s]; relief C_a of the tips [mm], or None for what wear gives; helix_modification: of
    `load_factors.HELIX_MODIFICATIONS`; profile_modification: of `contact_factors.
    PROFILE_MODIFICATIONS`, for 2019; shaft: of the pinion, by default midway; webs: (b_s/b,
    s_R/m_n) of gears with webs; bores: inner diameters d_i [mm], of bore or rim; backup: ratios
    s_R/h_t of rims, but of rings, whose rim ends at `Gear.outside`; meshes: in which pinion and
    wheel are at once, of planetary stages (number of planets of sun or ring, 1 of a planet; of
    gears that the casing holds minus that of a sun, 0 of a ring), None: a pair between two shafts;
    limited_pitting: permitted; lowest: Z_NT and Y_NT at 1e10 cycles, 0.85 to 1.
    """

    edition: str = "2006"
    tolerances: str = "1995"
    grades: tuple[float, float] = (6.0, 6.0)
    shift: str = "nominal"
    viscosity: float = 220.0
    relief: float | None = None
    helix_modification: str = "none"
    profile_modification: str = "none"
    shaft: Shaft = Shaft()
    webs: tuple[tuple[float, float] | None, tuple[float, float] | None] = (None, None)
    bores: tuple[float, float] = (0.0, 0.0)
    backup: tuple[float | None, float | None] = (None, None)
    limited_pitting: bool = False
    lowest: float = LOWEST
    meshes: tuple[float, float] | None = None

    def bending(self, diameter: Any) -> Any:
        """Return K of `load_factors.shaft_misalignment`, of a sun with the twist by all meshes."""
        bent = self.shaft.bending(diameter)
        return bent if self.meshes is None else bent + twist_of_meshes(abs(self.meshes[0]))


def of_blanks(practice: Practice, pair: GearPair, blanks: tuple[Blank, Blank]) -> Practice:
    """Return the practice with webs, inner diameters and backup ratios of a pair's blanks."""
    (b1, b2), (g1, g2) = blanks, pair.gears
    return replace(
        practice,
        webs=(b1.web(g1), b2.web(g2)),
        bores=(b1.inner_diameter(g1), b2.inner_diameter(g2)),
        backup=(b1.backup(g1), b2.backup(g2)),
    )


def check(practice: Practice) -> None:
    """Refuse words that are not known and numbers that mean nothing, by ValueError."""
    words = (
        ("edition", practice.edition, EDITIONS),
        ("tolerances", practice.tolerances, TOLERANCES),
        ("shift", practice.shift, SHIFTS),
        ("helix modification", practice.helix_modification, tuple(HELIX_MODIFICATIONS)),
        ("arrangement", practice.shaft.arrangement, tuple(ARRANGEMENTS)),
        ("profile modification", practice.profile_modification, tuple(PROFILE_MODIFICATIONS)),
    )
    for what, word, known in words:
        if word not in known:
            raise ValueError(f"no {what} {word!r}; known: {', '.join(known)}")
    if min(practice.grades) < 0.0 or max(practice.grades) > 12.0:
        raise ValueError(f"no accuracy grade {practice.grades}: 0 to 12")
    if not practice.viscosity > 0.0:
        raise ValueError(f"the viscosity is {practice.viscosity:g}, and has to be above 0")
    if any(np.any(np.less_equal(r, 0.5)) for r in practice.backup if r is not None):
        raise ValueError("no Y_B of a backup ratio of 0.5 and less: rate the rim by other means")
    if not 0.5 <= practice.lowest <= 1.0:
        raise ValueError(f"the life factor at 1e10 cycles is {practice.lowest:g}: 0.5 to 1")
    if practice.meshes is not None and not max(practice.meshes) > 0.0:
        raise ValueError(f"meshes {practice.meshes}: above 0 of one gear at least")


@dataclass(frozen=True)
class Case:
    """A pair to be rated; pair and operation of floats or of arrays of one shape.

    within: of `load_factors.RANGES`, for the smooth form, whose deviations have no steps; else "".
    """

    pair: GearPair
    operation: Operation
    materials: tuple[Material, Material]
    practice: Practice
    given: Mapping[str, Any] = field(default_factory=dict)
    within: str = ""

    @property
    def load(self) -> Any:
        """F_t [N] at the reference diameter."""
        torque = self.operation.power / self.operation.pinion_speed
        return 2.0 * torque / self.pair.pinion.reference_diameter

    @property
    def speed(self) -> Any:
        """Pitch line velocity v [mm/s] at the reference diameter."""
        return 0.5 * self.operation.pinion_speed * self.pair.pinion.reference_diameter

    @cached_property
    def transverse_ratio(self) -> Any:
        """eps_alpha of nominal tip circles."""
        return contact_path(self.pair).transverse_ratio

    @property
    def total_ratio(self) -> Any:
        """eps_gamma."""
        return self.transverse_ratio + self.pair.overlap_ratio

    @cached_property
    def forms(self) -> tuple[ToothForm, ToothForm]:
        """Critical sections of pinion and wheel."""
        return tooth_forms(self.pair, self.transverse_ratio, self.practice.shift)

    @cached_property
    def deviations(self) -> Deviations:
        """Deviations of both gears."""
        practice = self.practice
        return deviations(self.pair, practice.grades, practice.tolerances, bool(self.within))

    @property
    def cycles(self) -> tuple[Any, Any]:
        """Load cycles N_L of pinion and wheel."""
        turns = self.operation.pinion_speed * self.operation.hours * 3600.0 / (2.0 * np.pi)
        first, second = self.operation.contacts
        return turns * first, turns / abs(self.pair.ratio) * second

    def curve(self, member: int, contact: bool) -> Curve:
        """Return the curve of Z_NT or Y_NT of a gear."""
        return life_curve(self.materials[member], self.practice, contact)


def ring_rim(gear: Gear) -> Any:
    """Return s_R/m_n of a ring, from its root circle to its outside."""
    return 0.5 * (gear.root_diameter - gear.outside) / gear.normal_module


def check_rim(pair: GearPair) -> None:
    """Refuse a ring of floats whose rim is too thin for Y_B, by ValueError."""
    if not is_internal(pair.wheel_teeth):
        return
    if not (rim := ring_rim(pair.wheel)) > THIN_RING:
        what = f"no Y_B of a ring of s_R/m_n = {rim:.3g}, {THIN_RING:g} or less"
        raise ValueError(f"{what}: make its outside diameter larger, or give Y_B")


def life_curve(material: Material, practice: Practice, contact: bool) -> Curve:
    """Return the curve of Z_NT or Y_NT of a gear."""
    if contact:
        return pitting_curve(material.family, practice.limited_pitting, practice.lowest)
    return bending_curve(material.family, practice.lowest)
