"""Quantities of the teeth alone that ratings by ISO 6336 take, of any face width and load.

For searches over numbers of teeth, modules and face widths: tooth forms, contact ratios and
stiffness depend on the pair but for its size, and change with it as lengths do.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import contact_path, usable_path
from gearopt.physics.iso6336 import contact_factors as contact
from gearopt.physics.iso6336.refusals import refusal_of_teeth
from gearopt.physics.iso6336.stiffness import single_stiffness
from gearopt.physics.iso6336.tooth_form import tooth_forms

WIDEST_OVERLAP = 2.0  # overlap ratio of the widths at which pairs are looked at

Two = tuple[Any, Any]


@dataclass(frozen=True)
class ToothTable:
    """Teeth of pairs (n,); of two values the pinion's is first.

    contact: eps_alpha, NaN where ISO 6336 refuses the pair; virtual: eps_alphan; forms Y_F without
    f_eps; concentrations Y_S; notches q_s; stiffness c' of solid steel discs from 100 N/mm on
    [MPa]; zone Z_H; singles: Z_B and Z_D of spur gears, 1 where there are none; overlap: the least
    eps_beta for which ISO 6336 does not refuse the pair; axial: axial pitch [mm], infinite of spur
    gears.
    """

    contact: Any
    virtual: Any
    forms: Two
    concentrations: Two
    notches: Two
    stiffness: Any
    zone: Any
    singles: Two
    overlap: Any
    axial: Any

    def take(self, place: Any) -> "ToothTable":
        """Table of some pairs; place: an index of arrays, as numpy takes it."""

        def of(value: Any) -> Any:
            return tuple(v[place] for v in value) if isinstance(value, tuple) else value[place]

        return ToothTable(**{name: of(value) for name, value in vars(self).items()})

    def scaled(self, factor: Any) -> "ToothTable":
        """Return the table of pairs whose lengths are all greater by a factor."""
        return replace(self, axial=self.axial * factor)


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def tooth_table(pair: GearPair, shift: str = "nominal") -> ToothTable:
    """Return the table of pairs of arrays of one shape, of any face width.

    shift: of `tooth_form.SHIFTS`. One helix angle for all, or an array.
    """
    shape = np.shape(pair.pinion.teeth * pair.normal_module)
    sine = np.abs(np.sin(pair.pinion.helix_angle))
    axial = np.pi * pair.normal_module / sine
    wide = pair.of_width(np.where(np.isfinite(axial), WIDEST_OVERLAP * axial, pair.normal_module))
    ratio, usable = contact_path(wide).transverse_ratio, usable_path(wide).transverse_ratio
    forms = tooth_forms(wide, ratio, shift)
    rated = np.asarray(refusal_of_teeth(wide, ratio, usable, forms)) == 0

    def known(value: Any) -> Any:
        return np.where(rated, value, np.nan)

    ratio = known(ratio)
    made = contact.single_contact_ratios(wide, ratio)
    inside = np.isfinite(made[0]) & np.isfinite(made[1])
    least = np.maximum(1.0 - usable, np.where(inside, 0.0, 1.0))

    def of(value: Any) -> Any:
        return np.broadcast_to(np.asarray(value, float), shape)

    def both(first: Any, second: Any) -> Two:
        return of(first), of(second)

    return ToothTable(
        of(ratio),
        of(known(forms[0].virtual_ratio)),
        both(*(known(form.form) for form in forms)),
        both(*(known(form.concentration) for form in forms)),
        both(*(form.notch for form in forms)),
        of(single_stiffness(wide, np.inf)),
        of(contact.zone_factor(wide)),
        both(*(np.where(inside, np.maximum(m, 1.0), 1.0) for m in made)),
        of(np.where(least > 0.0, least, 0.0)),
        of(axial),
    )
