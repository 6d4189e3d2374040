"""The gears of a stage of a design with their teeth: a pair, or sun, planet and ring."""

import math
from dataclasses import replace

from gearopt.formulations.drive.design import StageDesign
from gearopt.physics.gears import Gear, GearPair

SAME = 1e-9  # relative; a diameter so near to the design's is that one


def meshes(stage: StageDesign) -> list[tuple[GearPair, tuple[str, str]]]:
    """Pairs in mesh and what their gears are called; none of a ring of unknown teeth."""
    if stage.type == "parallel":
        return [(stage.pair, ("pinion", "wheel"))]
    if stage.type == "internal":
        pair = stage.pair
        diameters = stage.wheel_tip_diameter_mm, stage.wheel_root_diameter_mm
        return [(pair, ("pinion", "ring"))] if _is(pair.wheel, *diameters) else []
    rows = [(stage.pair, ("sun", "planet"))]
    if (ring := _ring(stage)) is not None:
        inner = GearPair(stage.pair.wheel, ring, -stage.centre_distance_mm)
        rows.append((inner, ("planet", "ring")))
    return rows


def sun_planet_ring(stage: StageDesign) -> tuple[Gear, Gear, Gear] | None:
    """Gears of whole teeth of a planetary stage; None of others, or of a ring of unknown teeth."""
    if stage.type != "planetary" or (ring := _ring(stage)) is None:
        return None
    gears = *stage.pair.gears, ring
    return gears if all(float(gear.teeth).is_integer() for gear in gears) else None


def _ring(stage: StageDesign) -> Gear | None:
    """The ring as the tool of the planets cuts it; None where the design's is another."""
    assert stage.ring_teeth and stage.ring_diameter_mm
    ring = replace(
        stage.pair.wheel,
        teeth=-stage.ring_teeth,
        reference_diameter=-stage.ring_diameter_mm,
        profile_shift=stage.ring_profile_shift or 0.0,
        tip_alteration=stage.ring_tip_alteration or 0.0,
        thickness_allowance=0.0,
    )
    return ring if _is(ring, stage.ring_tip_diameter_mm, stage.ring_root_diameter_mm) else None


def _is(ring: Gear, tip: float | None, root: float | None) -> bool:
    """Whether a ring has these diameters [mm], above 0: a design does not hold its tool."""
    pairs = (ring.tip_diameter, tip), (ring.root_diameter, root)
    return all(math.isclose(-own, other or 0.0, rel_tol=SAME) for own, other in pairs)
