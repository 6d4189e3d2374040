"""Flaws of the teeth of a pair by name: what stops a rating, and what a designer may accept.

Of one pair of floats. `agma.refusals` has the fatal ones for arrays, as codes.
"""

import math
from dataclasses import dataclass

import numpy as np

from gearopt.physics.gears import MEMBERS, Gear, GearPair
from gearopt.physics.geometry.contact import active_root_diameters, contact_path, usable_path
from gearopt.physics.geometry.fillet import (
    NEGLIGIBLE,
    form_diameter,
    has_tip,
    largest_tip_radius,
    teeth_without_undercut,
    tool_tip,
    undercut_depth,
)
from gearopt.physics.geometry.tooth import circumferential_backlash, tip_clearances, tip_thickness

THIN_TIP = 0.2  # normal modules of tip thickness; 0.3 to 0.4 if case hardened (recommendation)


@dataclass(frozen=True)
class Flaw:
    """A flaw by its name, said in a sentence; fatal: no geometry factor means anything then."""

    name: str
    sentence: str
    fatal: bool


def flaws(pair: GearPair, of: str = "") -> tuple[Flaw, ...]:
    """Return the flaws of a pair, fatal ones first; none of a good pair.

    of: what sentences add to what they are about, such as " of stage 1".
    """
    found = [flaw for k, gear in enumerate(pair.gears) for flaw in _of_gear(MEMBERS[k] + of, gear)]
    if not any(flaw.fatal for flaw in found):
        found += _of_pair(pair, of)
    return tuple(sorted(found, key=lambda flaw: not flaw.fatal))


def _of_gear(member: str, gear: Gear) -> list[Flaw]:
    """Return what is wrong with one gear, whatever its mate."""
    found = []
    if tool_tip(gear).half_width < 0.0:
        most = float(largest_tip_radius(gear.rack.pressure_angle, gear.rack.dedendum))
        found.append(
            Flaw(
                "pointed tool",
                f"The tool of the {member} has no room for a tip radius of "
                f"{gear.rack.tip_radius:.4g} m_n: at most {most:.4g} make one full round."
                if most > 0.0
                else f"The flanks of the tool of the {member} meet before its addendum of "
                f"{gear.rack.dedendum:.4g} m_n.",
                not has_tip(gear),
            )
        )
    if gear.root_diameter <= 0.0:
        found.append(Flaw("no root", f"The root circle of the {member} has no diameter.", True))
        return found
    thin = float(tip_thickness(gear)) / gear.normal_module
    if gear.tip_diameter <= gear.base_diameter:
        text = f"The tip circle of the {member} lies inside its base circle: it has no involute."
        found.append(Flaw("no involute", text, True))
    elif thin <= 0.0:
        text = f"The teeth of the {member} are pointed: their flanks meet below the tip circle."
        found.append(Flaw("pointed tooth", text, True))
    elif thin < THIN_TIP:
        text = f"The tips of the {member} are {thin:.2f} m_n thick, below {THIN_TIP:g} m_n."
        found.append(Flaw("thin tip", text, False))
    depth = float(undercut_depth(gear)) / gear.normal_module
    if depth > NEGLIGIBLE:
        found.append(Flaw("undercut", _undercut(member, gear, depth), False))
    return found


def _undercut(member: str, gear: Gear, depth: float) -> str:
    """Say that a gear is undercut by a depth in modules, and what avoids it."""
    limit = float(teeth_without_undercut(gear.rack, gear.helix_angle))
    least = 2.0 * NEGLIGIBLE * np.cos(gear.helix_angle)
    least = math.ceil(limit - least / np.sin(gear.transverse_pressure_angle) ** 2)
    shift = f" and profile shift {gear.profile_shift:.4g}" if gear.profile_shift else ""
    needed = math.ceil(100.0 * (gear.profile_shift + depth)) / 100.0
    return (
        f"The {member} is undercut, with {gear.teeth:.4g} teeth{shift}: without profile shift a "
        f"rack cuts {least} teeth and more cleanly (in theory {limit:.1f}), these with a profile "
        f"shift of {needed:.2f}."
    )


def _of_pair(pair: GearPair, of: str) -> list[Flaw]:
    """Return what is wrong with the mesh of two gears that have teeth."""
    if not math.isfinite(float(pair.working_angle)):
        text = (
            f"No centre distance{of} goes with its profile shifts: their sum is too small."
            if pair.working_distance is None
            else f"At the centre distance{of} the base circles overlap."
        )
        return [Flaw("no centre distance", text, True)]
    nominal, usable = contact_path(pair), usable_path(pair)
    ratio = float(usable.transverse_ratio)
    found = []
    bare = float(nominal.transverse_ratio)
    if bare <= 0.0 or bare < 1.0 and bare + pair.overlap_ratio < 1.0:
        text = f"The transverse contact ratio{of} is {bare:.3f}: contact breaks off."
        found.append(Flaw("contact ratio below 1", text, True))
    elif not ratio >= 1.0:
        text = f"Form circles leave a transverse contact ratio{of} of {ratio:.3f}, below 1."
        fatal = not ratio + pair.overlap_ratio >= 1.0
        found.append(Flaw("usable contact ratio below 1", text, fatal))
    found += _interference(pair, of)
    for member, clearance in zip(MEMBERS, tip_clearances(pair), strict=True):
        if clearance < 0.0:
            text = f"The tips of the {member}{of} reach {-clearance:.3f} mm into the mate's root."
            found.append(Flaw("no tip clearance", text, False))
    backlash = float(circumferential_backlash(pair))
    if backlash < -1e-3 * pair.normal_module:
        text = f"The teeth{of} do not fit in: the backlash is {backlash:.3f} mm."
        found.append(Flaw("no backlash", text, False))
    return found


def _interference(pair: GearPair, of: str) -> list[Flaw]:
    """Return the members whose fillet the mate's tip reaches."""
    found = []
    rows = zip(MEMBERS, pair.gears, active_root_diameters(pair), strict=True)
    for member, gear, active in rows:
        form = float(form_diameter(gear))
        if not active >= form * (1.0 - 1e-9):
            text = (
                f"The mate's tip reaches below the form circle of the {member}{of}, "
                f"{form:.3f} mm: relieve or shorten the tips."
            )
            found.append(Flaw("interference", text, False))
    return found
