"""What a stage with planets or a ring is asked for, and the stage without some of it."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.planetary import LARGE, Planets
from gearopt.formulations.drive.train import Stage

OF_PLANETS = (  # what is asked of the teeth of such a stage, the dearest to drop
    *("sun_teeth_low", "sun_teeth_high", "sun_teeth", "ring_teeth_low", "ring_teeth_high"),
    *("ring_teeth", "planet_teeth_low", "planet_teeth_high", "planet_teeth"),
    *("equally_spaced", "mesh_order", "planet_clearance"),
)
WIDER = 1.25  # by which ranges of teeth are dropped
MEMBERS = ("sun", "planet", "ring")


def of_planets(stage: Stage) -> Iterator[str]:
    """Yield what a stage asks of its teeth; number of planets and reductions are given."""
    way: Planets = stage.options[0].planets
    for member in MEMBERS if way.count else MEMBERS[::2]:
        low, high = getattr(way, member)
        if low == high:
            yield f"{member}_teeth"
        else:
            yield from [f"{member}_teeth_low"] * (low > 1)
            yield from [f"{member}_teeth_high"] * (high < LARGE)
    if way.count:
        yield from ["equally_spaced"] * way.spaced
        yield from ["mesh_order"] * (way.order != "any")
        yield from ["planet_clearance"] * (way.clearance > 0.0)
    yield from ["wheel_diameter"] * math.isfinite(way.widest)


def without_planets(stage: Stage, dropped: set[str]) -> Stage:
    """The stage without what is dropped; ranges of teeth are then wider."""
    first = stage.options[0].planets
    wider = {member: _wider(member, getattr(first, member), dropped) for member in MEMBERS}
    changed: dict[str, Any] = dict(wider)
    changed |= {"spaced": False} if "equally_spaced" in dropped else {}
    changed |= {"order": "any"} if "mesh_order" in dropped else {}
    changed |= {"clearance": 0.0} if "planet_clearance" in dropped else {}
    changed |= {"widest": math.inf} if "wheel_diameter" in dropped else {}
    options = []
    for option in stage.options:
        planets = replace(option.planets, **changed)
        standards: Any = option.standards
        rated = tuple(replace(standard, planets=planets) for standard in standards)
        options.append(replace(option, planets=planets, standards=rated))
    (s_low, s_high), _, (r_low, r_high) = wider.values()
    ends = {"sun": (s_low, s_high), "carrier": (r_low, r_high), "ring": (s_low + r_low, math.inf)}
    z1, z2 = ends["sun"], ends["ring" if first.count and first.held != "carrier" else "carrier"]
    if first.count and first.held == "sun":
        z1 = ends["carrier"]
    most = None if z2[1] >= LARGE else int(z2[1])
    teeth: dict[str, Any] = {"pinion_teeth": (int(z1[0]), int(z1[1]))}
    return replace(stage, options=tuple(options), wheel_teeth=(int(z2[0]), most), **teeth)


def _wider(member: str, span: tuple[float, float], dropped: set[str]) -> tuple[float, float]:
    """A range of teeth without the ends that are dropped."""
    low, high = span
    few, many = ({f"{member}_teeth", f"{member}_teeth_{end}"} & dropped for end in ("low", "high"))
    low = max(1.0, math.floor(low / WIDER)) if few else low
    return low, high if not many or high >= LARGE else float(math.ceil(high * WIDER))
