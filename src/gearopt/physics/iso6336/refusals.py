"""Pairs of gears for which ISO 6336 has no answer, by name, for one pair or arrays of them."""

from typing import Any

import numpy as np

from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import contact_path, usable_path
from gearopt.physics.geometry.fillet import has_tip
from gearopt.physics.geometry.tooth import tip_thickness
from gearopt.physics.iso6336.case import Practice
from gearopt.physics.iso6336.contact_factors import single_contact_ratios
from gearopt.physics.iso6336.stiffness import theoretical_stiffness
from gearopt.physics.iso6336.tooth_form import ToothForm, tooth_forms

SENTENCES = {
    "internal gear": "a ring is the wheel of a pair and has more teeth than its pinion",
    "no centre distance": "the sum of the profile shifts is too small (with a ring too large) for "
    "any centre distance, or a given one makes the base circles overlap",
    "pointed tool": "the flanks of a tool meet before its tip round begins",
    "no root": "a root circle has no diameter",
    "no involute": "a tip circle lies inside its base circle",
    "pointed tooth": "a tooth is pointed below its tip circle",
    "contact ratio below 1": "the transverse contact ratio is below 1; ISO 6336 has no factors "
    "for it",
    "usable contact ratio below 1": "undercut or interference leaves a transverse contact ratio "
    "below 1, and the overlap does not make up for it",
    "contact ratio of 2.5 or more": "ISO 6336 covers transverse contact ratios below 2.5",
    "contact at the base circle": "an inner point of single tooth contact lies at or below a base "
    "circle",
    "no critical section": "no tangent of 30 degrees touches the root fillet, or the load acts "
    "below it",
    "no stiffness": "the law of c' of ISO 6336-1 has no positive value for these profile shifts",
}
REFUSALS = ("", *SENTENCES)


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def refusal(pair: GearPair, shift: str = "nominal") -> Any:
    """Return an index of REFUSALS for a pair of floats, or arrays of one shape; 0: none.

    shift: as of `tooth_form.tooth_forms`. No exception for any finite numbers.
    """
    if np.ndim(fits := has_teeth(pair)) == 0 and not fits:  # z1 + z2 may be 0
        return 1
    ratio = contact_path(pair).transverse_ratio
    forms = tooth_forms(pair, ratio, shift)
    return refusal_of_teeth(pair, ratio, usable_path(pair).transverse_ratio, forms)


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def refusal_of_teeth(
    pair: GearPair, ratio: Any, usable: Any, forms: tuple[ToothForm, ToothForm]
) -> Any:
    """`refusal` of teeth whose transverse contact ratios and forms are known.

    usable: the contact ratio that undercut leaves.
    """
    ratio, overlap = np.asarray(ratio), pair.overlap_ratio
    first, second = single_contact_ratios(pair, ratio)
    pressed = np.isfinite(first) & np.isfinite(second)
    flags = [
        ~has_teeth(pair),
        ~(np.abs(pair.working_angle - 0.25 * np.pi) < 0.25 * np.pi),
        *_of_gears(pair),
        ~(ratio >= 1.0),
        ~(usable + overlap >= 1.0),
        ~(ratio < 2.5),
        ~pressed & np.less(overlap, 1.0),
        ~_section(forms),
        ~(np.asarray(theoretical_stiffness(pair)) > 0.0),
    ]
    shaped = np.broadcast_arrays(*flags, np.zeros(ratio.shape, bool))[:-1]
    return np.select(shaped, range(1, len(REFUSALS)), 0)[()]


def has_teeth(pair: GearPair) -> Any:
    """Return whether the numbers of teeth are those of external gears, or of pinion and ring."""
    pinion, wheel = np.asarray(pair.pinion_teeth), pair.wheel_teeth
    return (pinion > 0) & (np.greater(wheel, 0) | np.less(wheel, -pinion))


def _section(forms: tuple[ToothForm, ToothForm]) -> Any:
    """Return whether both teeth have a critical section below their load."""
    sound = np.True_
    for form in forms:
        sizes = (form.height, form.thickness, form.fillet_radius, np.cos(form.load_angle))
        for size in sizes:
            sound = sound & (np.asarray(size) > 0.0) & np.isfinite(size)
    return sound


def _of_gears(pair: GearPair) -> list[Any]:
    """Return whether a gear has a pointed tool, no root, no involute, a pointed tooth."""
    gears = pair.gears
    made = []
    for fault in (
        lambda g: ~np.asarray(has_tip(g)),
        lambda g: np.less_equal(g.root_diameter, 0.0) & np.greater(g.teeth, 0.0),
        lambda g: np.less_equal(np.abs(g.active_tip_diameter), np.abs(g.base_diameter)),
        lambda g: ~(np.asarray(tip_thickness(g)) > 0.0),
    ):
        made.append(fault(gears[0]) | fault(gears[1]))
    return made


def refuse(pair: GearPair, practice: Practice) -> None:
    """Raise ValueError with the name of the rule that refuses a pair of floats."""
    if found := int(refusal(pair, practice.shift)):
        name = REFUSALS[found]
        raise ValueError(f"{name}: {SENTENCES[name]}")
