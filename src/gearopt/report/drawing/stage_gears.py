"""The gears of a stage of a design with their teeth: a pair, or sun, planet and ring."""

import math
from dataclasses import replace

from gearopt.formulations.drive.design import TOOL, StageDesign
from gearopt.physics.gears import Cutter, Gear, GearPair, Rack

SAME = 1e-9  # relative; a diameter so near to the design's is that one


def meshes(stage: StageDesign) -> list[tuple[GearPair, tuple[str, str]]]:
    """Pairs in mesh and what their gears are called; none of a ring of unknown teeth."""
    if stage.type == "parallel":
        return [(stage.pair, ("pinion", "wheel"))]
    if stage.type == "internal":
        pair = replace(stage.pair, wheel=replace(stage.pair.wheel, cutter=_cutter(stage)))
        diameters = stage.wheel_tip_diameter_mm, stage.wheel_root_diameter_mm
        return [(pair, ("pinion", "ring"))] if _is(pair.wheel, *diameters) else []
    rows = [(stage.pair, ("sun", "planet"))]
    if (ring := _ring(stage)) is not None:
        inner = GearPair(stage.pair.wheel, ring, -stage.centre_distance_mm)
        rows.append((inner, ("planet", "ring")))
    return rows


def sun_planet_ring(stage: StageDesign) -> tuple[Gear, Gear, Gear] | None:
    """Gears of whole teeth of a planetary stage; None of others, or of a ring unlike its tool."""
    if stage.type != "planetary" or (ring := _ring(stage)) is None:
        return None
    gears = *stage.pair.gears, ring
    return gears if all(float(gear.teeth).is_integer() for gear in gears) else None


def _ring(stage: StageDesign) -> Gear | None:
    """The ring as its tool cuts it; None where that has other diameters."""
    assert stage.ring_teeth and stage.ring_diameter_mm
    planet = stage.pair.wheel
    tool = (getattr(stage, f"ring_{name}") for name in TOOL)
    ring = replace(
        planet,
        rack=Rack(planet.rack.pressure_angle, *tool),
        cutter=_cutter(stage),
        teeth=-stage.ring_teeth,
        reference_diameter=-stage.ring_diameter_mm,
        profile_shift=stage.ring_profile_shift or 0.0,
        tip_alteration=stage.ring_tip_alteration or 0.0,
        thickness_allowance=stage.ring_thickness_allowance_mm,
    )
    return ring if _is(ring, stage.ring_tip_diameter_mm, stage.ring_root_diameter_mm) else None


def _cutter(stage: StageDesign) -> Cutter | None:
    return None if stage.ring_cutter is None else Cutter(*stage.ring_cutter)


def _is(ring: Gear, tip: float | None, root: float | None) -> bool:
    """Whether a ring has these diameters [mm], above 0."""
    pairs = (ring.tip_diameter, tip), (ring.root_diameter, root)
    return all(math.isclose(-own, other or 0.0, rel_tol=SAME) for own, other in pairs)
