"""Checks of given gears: an involute, room for their bores, steady contact."""

from typing import Any

from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.geometry.flaws import flaws
from gearopt.physics.tooth.ladder import LEVELS, USUAL
from gearopt.physics.tooth.trapezoid import is_waisted
from gearopt.scenes.drive.tables.blanks import blank
from gearopt.scenes.drive.tables.drive import Gears, StageTable
from gearopt.scenes.drive.tables.rating import with_shared
from gearopt.scenes.drive.toothings import ROOT, TIP, cause
from gearopt.scenes.reading.fields import refuse

Place = tuple[Any, ...]


def check_pair(pair: GearPair, own: StageTable, gears: Gears) -> None:
    """Refuse gears without contact that goes on, and bores without room; own, gears: tables."""
    _check_flaws(pair, own, gears)
    for member, gear in zip(MEMBERS, pair.gears, strict=True):
        body = blank(with_shared(getattr(own, member), gears), None)
        root = float(gear.root_diameter)
        if body.bore and body.hub >= root:
            place: Place = ("stage", 0, member, "bore")
            place = place if getattr(own, member).bore is not None else ("gears", "bore")
            rule = (
                f"leaves its hub, {body.hub:.4g} mm, no room inside the root circle of the "
                f"{member}, {root:.4g} mm"
            )
            raise refuse(rule, f"{0.5 * root / body.hub_over_bore:.2g} mm", place, "sample")


def check_level(pair: GearPair, level: str | None) -> None:
    """Refuse a model of teeth as trapezoids, if that is asked for, of teeth that are undercut."""
    if level is None or LEVELS[level].tooth != "trapezoid":
        return
    for member, gear in zip(MEMBERS, pair.gears, strict=True):
        if is_waisted(gear):
            rule = f"takes teeth as trapezoids, and those of the {member} are undercut"
            raise refuse(rule, USUAL, ("sharing", "level"))


def _check_flaws(pair: GearPair, own: StageTable, gears: Gears) -> None:
    """Refuse fatal flaws of the teeth, and misfits, each at the key that makes it.

    Interference alone is left: contact is computed where there are flanks.
    """
    every = flaws(pair)
    wrong = [f for f in every if f.fatal or f.misfit and f.name != "interference"]
    if not wrong:
        return
    flaw = wrong[0]
    said = f"makes gears that cannot run: {flaw.sentence[0].lower()}{flaw.sentence[1:].rstrip('.')}"
    if flaw.name in ("no root", "no involute", "pointed tooth"):
        member = next(m for m in MEMBERS if m in flaw.sentence)
        place, write = cause(0, member, own, gears, ROOT if flaw.name == "no root" else TIP)
        raise refuse(said, write, place, "sample")
    if flaw.name == "pointed tool":
        raise refuse(said, 0.38, _tool(flaw.sentence, own), "sample")
    if own.centre_distance is not None and flaw.name != "usable contact ratio below 1":
        raise refuse(said, f"{pair.reference_distance:.4g} mm", ("stage", 0, "centre_distance"))
    for weak in every:  # an undercut gear: the sentence has the shift that it needs
        if weak.name == "undercut":
            member = next(m for m in MEMBERS if m in weak.sentence)
            rule = f"{said}. {weak.sentence.rstrip('.')}"
            tell = f"Write [stage.{member}] profile_shift, or more {member}_teeth"
            raise refuse(rule, tell, ("stage", 0, f"{member}_teeth"), "tell")
    member = min(MEMBERS, key=lambda m: float(getattr(own, m).profile_shift or 0))
    place, write = cause(0, member, own, gears, TIP)
    raise refuse(said, write, place, "sample")


def _tool(sentence: str, own: StageTable) -> Place:
    member = next(m for m in MEMBERS if m in sentence)
    alone = getattr(own, member).tool_tip_radius is not None
    return ("stage", 0, member, "tool_tip_radius") if alone else ("gears", "tool_tip_radius")
