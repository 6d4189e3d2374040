"""Flaws of the teeth of a pair by name: fatal ones, misfits, and those that a designer may accept.

Fatal ones stop a rating; gears with a misfit cannot be assembled or cannot run, whatever their
strength. Of one pair of floats. `agma.refusals` has the fatal ones of external pairs for arrays, as
codes; `internal.margins` those of internal pairs.
"""

import math

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import MEMBERS, Gear, GearPair, is_internal, signed
from gearopt.physics.geometry.contact import active_root_diameters, contact_path, usable_path
from gearopt.physics.geometry.cutter import cutter_tip
from gearopt.physics.geometry.fillet import (
    NEGLIGIBLE,
    form_diameter,
    half_angle,
    has_tip,
    largest_tip_radius,
    profile,
    teeth_without_undercut,
    tool_tip,
    undercut_depth,
)
from gearopt.physics.geometry.internal import margins
from gearopt.physics.geometry.involute import shift_sum
from gearopt.physics.geometry.tooth import (
    circumferential_backlash,
    normal_backlash,
    tip_clearances,
    tip_thickness,
)

THIN_TIP = 0.2  # normal modules of tip thickness; 0.3 to 0.4 if case hardened (recommendation)
LEAST_RATIO = 1.2  # transverse contact ratio below which ISO 6336-1 has no stiffness
PRINTED = 0.5e-3  # mm, half a unit of the last digit of a centre distance as drawings have it
PRINTED_SHIFT = 0.5e-4  # half a unit of the fourth digit of profile shifts, as reports have them
LOOSE = 4.0  # times the recommended least backlash, from which on it is told (a rule of ours)
ROUNDING = 1e-8  # of the module, as limits of a result are held (`FEASIBLE`)
INTRUSION = 1e-3  # normal modules by which tips may touch fillets, less than edges are rounded by
POINTS = 201  # of a fillet, and of the path of a tip


@dataclass(frozen=True)
class Flaw:
    """A flaw by its name, said in a sentence; fatal: no geometry factor means anything then.

    misfit: how far gears that cannot be assembled or cannot run are from fitting, in normal
    modules; 0 of what a designer may accept.
    """

    name: str
    sentence: str
    fatal: bool = False
    misfit: float = 0.0


def flaws(pair: GearPair, of: str = "", named: tuple[str, str] | None = None) -> tuple[Flaw, ...]:
    """Return the flaws of a pair, fatal ones first, then misfits; none of a good pair.

    of: what sentences add to what they are about, such as " of stage 1". named: what both gears
    are called, where there are more than two, as sun and planet.
    """
    called = named or members(pair)
    rows = zip(called, pair.gears, strict=True)
    every = [flaw for member, gear in rows for flaw in _of_gear(member + of, gear)]
    if not any(flaw.fatal for flaw in every):
        every += _of_pair(pair, of, called, f" of {' and '.join(called)}{of}" if named else of)
    return tuple(sorted(every, key=lambda flaw: (not flaw.fatal, not flaw.misfit)))


def members(pair: GearPair) -> tuple[str, str]:
    """Names of both gears: pinion and wheel, or ring."""
    return (MEMBERS[0], "ring") if is_internal(pair.wheel_teeth) else MEMBERS


def _of_cutter(member: str, gear: Gear) -> list[Flaw]:
    """Flaws of a pinion-type cutter, without which a gear has no fillet."""
    tip = cutter_tip(gear)
    if not math.isfinite(tip.distance):
        text = f"The cutter has no centre distance with the {member}: the shifts are too large."
        return [Flaw("no cut", text, True)]
    text = f"The tips of the cutter of the {member} have no room for their rounds."
    return [] if tip.angle >= 0.0 else [Flaw("pointed tool", text, True)]


def _of_gear(member: str, gear: Gear) -> list[Flaw]:
    """Flaws of one gear with any mate."""
    of_gear = [] if gear.cutter is None else _of_cutter(member, gear)
    if any(flaw.fatal for flaw in of_gear):
        return of_gear
    if gear.cutter is None and tool_tip(gear).half_width < 0.0:
        most = float(largest_tip_radius(gear.rack.pressure_angle, gear.rack.dedendum))
        text = (
            f"The tool of the {member} has no room for a tip radius of "
            f"{gear.rack.tip_radius:.4g} m_n: at most {most:.4g} make one full round."
            if most > 0.0
            else f"The flanks of the tool of the {member} meet before its addendum of "
            f"{gear.rack.dedendum:.4g} m_n."
        )
        of_gear.append(Flaw("pointed tool", text, not has_tip(gear)))
    if signed(gear.root_diameter, gear.teeth) <= 0.0:
        of_gear.append(Flaw("no root", f"The root circle of the {member} has no diameter.", True))
        return of_gear
    thin = float(tip_thickness(gear)) / gear.normal_module
    if signed(gear.active_tip_diameter - gear.base_diameter, gear.teeth) <= 0.0:
        text = f"The tip circle of the {member} lies inside its base circle: it has no involute."
        of_gear.append(Flaw("no involute", text, True))
    elif thin <= 0.0:
        text = f"The teeth of the {member} are pointed: their flanks meet below the tip circle."
        of_gear.append(Flaw("pointed tooth", text, True))
    elif thin < THIN_TIP:
        text = f"The tips of the {member} are {thin:.2f} m_n thick, below {THIN_TIP:g} m_n."
        of_gear.append(Flaw("thin tip", text))
    depth = float(undercut_depth(gear)) / gear.normal_module
    if depth > NEGLIGIBLE:
        of_gear.append(Flaw("undercut", _undercut(member, gear, depth)))
    return of_gear


def _undercut(member: str, gear: Gear, depth: float) -> str:
    """Sentence on a gear that is undercut by a depth in modules, with its remedies."""
    limit = float(teeth_without_undercut(gear.rack, gear.helix_angle))
    least = 2.0 * NEGLIGIBLE * np.cos(gear.helix_angle)
    least = math.ceil(limit - least / np.sin(gear.transverse_pressure_angle) ** 2)
    shift = f", x = {gear.profile_shift:.4g}" if gear.profile_shift else ""
    needed = math.ceil(100.0 * (gear.profile_shift + depth)) / 100.0
    return (
        f"The {member} is undercut (z = {gear.teeth:.4g}{shift}). A rack cuts {least} teeth or "
        f"more without undercut at x = 0 (strictly {limit:.1f}); {gear.teeth:.4g} teeth need "
        f"x = {needed:.2f}."
    )


def _of_pair(pair: GearPair, of: str, called: tuple[str, str], of_both: str) -> list[Flaw]:
    """Flaws of the mesh of two gears that have teeth; of_both: as `of`, but of the mesh."""
    if not math.isfinite(float(pair.working_angle)):
        text = (
            f"No centre distance{of_both} goes with its profile shifts: their sum is too "
            f"{'large' if is_internal(pair.wheel_teeth) else 'small'}."
            if pair.working_distance is None
            else f"At the centre distance{of_both} the base circles have no common tangent."
            if is_internal(pair.wheel_teeth)
            else f"At the centre distance{of_both} the base circles overlap."
        )
        return [Flaw("no centre distance", text, True)]
    nominal, usable = contact_path(pair), usable_path(pair)
    ratio = float(usable.transverse_ratio)
    of_mesh = []
    bare = float(nominal.transverse_ratio)
    if bare <= 0.0 or bare < 1.0 and bare + pair.overlap_ratio < 1.0:
        text = f"The transverse contact ratio{of_both} is {bare:.3f}: contact breaks off."
        of_mesh.append(Flaw("contact ratio below 1", text, True))
    elif not ratio >= 1.0:
        text = f"Form circles leave a transverse contact ratio{of_both} of {ratio:.3f}, below 1."
        fatal = not ratio + pair.overlap_ratio >= 1.0
        of_mesh.append(Flaw("usable contact ratio below 1", text, fatal))
    elif pair.overlap_ratio < 1.0 and ratio < LEAST_RATIO:
        left = " that the form circles leave" if ratio < bare else ""
        text = (
            f"The contact ratio{of_both}{left} is small, {ratio:.3f}: errors of the gears may take "
            f"contact away for a moment; {LEAST_RATIO:g} is a usual minimum."
        )
        of_mesh.append(Flaw("small contact ratio", text))
    if not any(flaw.fatal for flaw in of_mesh):
        of_mesh = _backlash(pair, of_both) + of_mesh
    interference = _internal if is_internal(pair.wheel_teeth) else _interference
    of_mesh += interference(pair, of, called)
    for member, clearance in zip(called, tip_clearances(pair), strict=True):
        depth = -float(clearance) / pair.normal_module
        if depth > ROUNDING:
            text = f"The tips of the {member}{of} reach {-clearance:.3f} mm into the mate's root."
            of_mesh.append(Flaw("no tip clearance", text, misfit=depth))
    return of_mesh


def _backlash(pair: GearPair, of: str) -> list[Flaw]:
    """Return whether the teeth do not fit into their spaces, or are far too loose in them."""
    backlash, given = float(circumferential_backlash(pair)), ""
    if pair.working_distance is not None:
        shifts = sum(gear.profile_shift for gear in pair.gears)
        given = (
            f"; without backlash the centre distance of {abs(pair.centre_distance):.6g} mm asks "
            f"for profile shifts of {shifts_at(pair):.3f} in sum, and the gears have {shifts:.4g}"
        )
    of_distance = 2.0 * math.tan(pair.working_angle) * PRINTED
    normal, module = pair.pinion.rack.pressure_angle, pair.normal_module
    of_shifts = 4.0 * module * math.tan(normal) * PRINTED_SHIFT if given else 0.0
    if backlash < -of_distance - of_shifts:
        text = f"The teeth{of} do not fit in: the backlash is {backlash:.3f} mm{given}."
        return [Flaw("no backlash", text, misfit=-backlash / pair.normal_module)]
    if float(normal_backlash(pair)) > LOOSE * least_backlash(pair):
        text = f"The backlash{of} is {backlash:.3f} mm, more than gears are made with{given}."
        return [Flaw("large backlash", text)]
    return []


def shifts_at(pair: GearPair) -> float:
    """Sum x1 + x2 of nominal teeth that have no backlash at the pair's centre distance."""
    first, teeth = pair.pinion, pair.pinion_teeth + pair.wheel_teeth
    angles = first.rack.pressure_angle, first.transverse_pressure_angle
    return float(shift_sum(pair.working_angle, teeth, *angles))


def least_backlash(pair: GearPair) -> float:
    """Return the recommended least normal backlash (2/3) (0.06 + 0.0005 a + 0.03 m_n) [mm].

    Source: ISO/TR 10064-2:1996, table A.1 (m_n 1.5 to 18 mm, steel in iron housings); AGMA 2002-B88
    has 3/2 of it.
    """
    distance, module = abs(float(pair.centre_distance)), float(pair.normal_module)
    return 2.0 / 3.0 * (0.06 + 5e-4 * distance + 0.03 * module)


def _interference(
    pair: GearPair,
    of: str,
    called: tuple[str, str],
    names: tuple[str, str] = ("interference", "interference"),
) -> list[Flaw]:
    """Return the members into whose fillet the mate's tip cuts, or at least reaches.

    Where an undercut gear has no flank left to be reached, only cutting counts.
    """
    of_tips = []
    for k, (gear, active) in enumerate(zip(pair.gears, active_root_diameters(pair), strict=True)):
        member, form, module = called[k], float(form_diameter(gear)), gear.normal_module
        depth = tip_intrusion(pair, k)
        if depth > INTRUSION * module:
            text = (
                f"The mate's tips cut {depth:.3f} mm into the fillets of the {member}{of}: relieve "
                "or shorten them."
            )
            of_tips.append(Flaw(names[k], text, misfit=depth / module))
        elif not (active >= form * (1.0 - ROUNDING) or undercut_depth(gear) > NEGLIGIBLE * module):
            text = (
                f"The mate's tip reaches below the form circle of the {member}{of}, "
                f"{abs(form):.3f} mm: relieve or shorten the tips."
            )
            of_tips.append(Flaw(names[k], text))
    return of_tips


LIMITS = {  # of internal pairs: the flaw, and what happens by so many mm
    "trochoidal_interference": (
        "trochoidal interference",
        "The tips of the {pinion}{of} foul those of the ring by {depth:.3f} mm as they leave mesh: "
        "shorten the tips, or take more teeth of the ring.",
    ),
    "radial_assembly": (
        "axial assembly",
        "The {pinion}{of} does not fit into the ring radially in every position: tips overlap by "
        "{depth:.3f} mm. It is put in along the axis.",
    ),
    "cutter_involute": (
        "overcut",
        "The involute of the cutter{of} ends {depth:.3f} mm before the tips of the ring: they are "
        "no involute. Shorten them, or take a cutter of more teeth.",
    ),
    "cutter_overcut": (
        "overcut",
        "The cutter{of} takes {depth:.3f} mm off the tips of the ring as it leaves the cut: take a "
        "cutter of fewer teeth.",
    ),
    "cutter_infeed": (
        "radial infeed",
        "A cutter{of} that is fed in radially trims the tips of the ring by {depth:.3f} mm: take "
        "one of fewer teeth, or feed it in along the axis.",
    ),
}


def _internal(pair: GearPair, of: str, called: tuple[str, str]) -> list[Flaw]:
    """Flaws of an internal pair and its cutter, by the limits that they break."""
    left, of_pair, module = margins(pair), [], pair.normal_module
    for key, (name, text) in LIMITS.items():
        margin = float(left.get(key, 0.0))
        if margin < -ROUNDING:
            misfit = -margin if key == "trochoidal_interference" else 0.0
            text = text.format(pinion=called[0], of=of, depth=-margin * module)
            of_pair.append(Flaw(name, text, misfit=misfit))
    if of_pair and of_pair[0].misfit:  # tips that foul each other: no path to fillets is left
        return of_pair
    ended = left["involute_interference"] < 0.0
    first = "involute interference" if ended else "fillet interference"
    return of_pair + _interference(pair, of, called, (first, "fillet interference"))


def tip_intrusion(pair: GearPair, member: int) -> float:
    """Return how deep the corners of the mate's tips come into the teeth of a gear [mm].

    Of a pair of floats that touch on one flank, in the transverse plane: the path of the corner in
    the gear's frame against `fillet.profile`, at POINTS places. 0 of gears that run freely.
    """
    gear, mate = pair.gears[member], pair.gears[1 - member]
    distance, top = float(pair.centre_distance), 0.5 * float(mate.tip_diameter)
    tip = 0.5 * float(gear.tip_diameter)
    reach = (distance**2 + top**2 - tip**2) / (2.0 * distance * top)
    corner = np.linspace(-1.0, 1.0, POINTS) * math.acos(min(1.0, max(-1.0, reach)))
    across, along = top * np.sin(corner), distance - top * np.cos(corner)
    radius, turned = np.hypot(across, along), corner - float(half_angle(mate, top))
    if gear.teeth < 0:
        radius, across, along = -radius, -across, -along
    play = max(0.0, float(circumferential_backlash(pair)))  # teeth that do not fit stay centred
    free = play / float(pair.working_diameters[member])
    angle = np.arctan2(across, along) - turned * float(mate.teeth / gear.teeth) + free
    x, y = profile(gear, POINTS, 2)
    fillet = signed(np.hypot(x, y)[:-1], gear.teeth)
    half = np.interp(radius, fillet, np.arctan(x / y)[:-1])
    flank = radius > fillet[-1]
    half[flank] = half_angle(gear, radius[flank])
    depth = np.where(radius > fillet[0], (angle + half - math.pi / gear.teeth) * radius, 0.0)
    return max(0.0, float(np.max(depth)))
