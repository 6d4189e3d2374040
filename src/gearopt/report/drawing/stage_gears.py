"""The gears of a stage of a design with their teeth: a pair, or sun, planet and ring."""

import math

from gearopt.formulations.drive.design import StageDesign
from gearopt.physics.gears import Gear, GearPair

SAME = 1e-9  # relative; a diameter so near to the design's is that one


def meshes(stage: StageDesign) -> list[tuple[GearPair, tuple[str, str]]]:
    """Pairs in mesh and what their gears are called; none of a ring of unknown teeth."""
    if stage.type != "planetary":
        ring = stage.type == "internal"
        known = not ring or _is_cut(stage, stage.pair.wheel, "wheel")
        return [(stage.pair, ("pinion", "ring" if ring else "wheel"))] if known else []
    rows = [(stage.pair, ("sun", "planet"))]
    if _is_cut(stage, stage.ring, "ring"):
        inner = GearPair(stage.pair.wheel, stage.ring, -stage.centre_distance_mm)
        rows.append((inner, ("planet", "ring")))
    return rows


def sun_planet_ring(stage: StageDesign) -> tuple[Gear, Gear, Gear] | None:
    """Gears of whole teeth of a planetary stage; None of others, or of a ring unlike its tool."""
    if stage.type != "planetary" or not _is_cut(stage, stage.ring, "ring"):
        return None
    gears = *stage.pair.gears, stage.ring
    return gears if all(float(gear.teeth).is_integer() for gear in gears) else None


def _is_cut(stage: StageDesign, ring: Gear, name: str) -> bool:
    """Whether a ring as its tool cuts it has the diameters of the design."""
    pairs = ((f"{name}_tip", ring.tip_diameter), (f"{name}_root", ring.root_diameter))
    return all(
        math.isclose(-d, getattr(stage, f"{key}_diameter_mm") or 0.0, rel_tol=SAME)
        for key, d in pairs
    )
