"""What a stage with planets or a ring is asked for, and the stage without some of it."""

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.drive.planetary import LARGE, Planets
from gearopt.formulations.drive.train import Stage
from gearopt.optimise.explaining.explanation import Change
from gearopt.physics.planetary.loads import MESH_LOAD_FACTORS
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.drive.tables.planetary import PLANETARY, Teeth
from gearopt.scenes.explaining.moves import with_each
from gearopt.scenes.explaining.numbers import SHORT, cut, times

OF_PLANETS = (  # what is asked of the teeth of such a stage, the dearest to drop
    *("sun_teeth_low", "sun_teeth_high", "sun_teeth", "ring_teeth_low", "ring_teeth_high"),
    *("ring_teeth", "planet_teeth_low", "planet_teeth_high", "planet_teeth"),
    *("equally_spaced", "mesh_order", "planet_clearance"),
)
WIDER = 1.25  # by which ranges of teeth are dropped
MEMBERS = ("sun", "planet", "ring")
FREE: dict[str, tuple[str, Any]] = {  # what is asked beside teeth: a field of `Planets`, without it
    "equally_spaced": ("spaced", False),
    "mesh_order": ("order", "any"),
    "planet_clearance": ("clearance", 0.0),
    "wheel_diameter": ("widest", math.inf),
}
RATIOS = "1.02", "1.05", "1.1", "1.15", "1.2", "1.3", "1.5", "2"  # by which ratios are tried
STEPS, TIMES = 12, (1.1, 1.25, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)  # teeth and diameters that are tried


def ends_of(name: str, low: Any, high: Any, least: int = 0) -> list[str]:
    """Names of what a range asks: one number, or its ends."""
    if low == high:
        return [name]
    return [f"{name}_low"] * (low > least) + [f"{name}_high"] * (high is not None)


def of_planets(stage: Stage) -> Iterator[str]:
    """Yield what a stage asks of its teeth; number of planets and reductions are given."""
    way: Planets = stage.options[0].planets
    for member in MEMBERS if way.count else MEMBERS[::2]:
        low, high = getattr(way, member)
        yield from ends_of(f"{member}_teeth", low, high if high < LARGE else None, least=1)
    for name, (key, free) in FREE.items():
        if (way.count or name == "wheel_diameter") and getattr(way, key) != free:
            yield name


def without_planets(stage: Stage, dropped: set[str]) -> Stage:
    """The stage without what is dropped; ranges of teeth are then wider."""
    first = stage.options[0].planets
    wider = {m: _wider(m, getattr(first, m), dropped, first.held == "sun") for m in MEMBERS}
    changed: dict[str, Any] = wider | dict(FREE[name] for name in FREE.keys() & dropped)
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


def _wider(
    member: str, span: tuple[float, float], dropped: set[str], drives: bool
) -> tuple[float, float]:
    """A range of teeth without the ends that are dropped."""
    low, high = span
    few, many = ({f"{member}_teeth", f"{member}_teeth_{end}"} & dropped for end in ("low", "high"))
    if member == "ring" and not drives:  # the ratio limits it
        return 1.0 if few else low, LARGE if many else high
    low = max(1.0, math.floor(low / WIDER)) if few else low
    return low, high if not many or high >= LARGE else float(math.ceil(high * WIDER))


def ways_of_planets(scene: Scene) -> Iterator[Iterator[tuple[tuple[Change, ...], Scene]]]:
    """Yield of every key of stages with a ring the next values, near ones first, and drives."""
    for k, stage in enumerate(scene.stage):
        for path, values in _next_values(stage) if stage.epicyclic else ():
            yield with_each(scene, ("stage", k, *path), values)
    if scene.duty.asks_ratio and any(stage.epicyclic for stage in scene.stage):
        key = "ratio" if scene.duty.output_speed is None else "output_speed"
        each = [Fraction(f) ** way for f in RATIOS for way in (1, -1)]
        now = getattr(scene.duty, key)
        yield with_each(scene, ("duty", key), [cut(times(now, f), 1, SHORT) for f in each])


def _next_values(stage: StageTable) -> Iterator[tuple[tuple[str, ...], list[Any]]]:
    """Yield the keys that a stage may write otherwise, and values, near ones first."""
    if stage.type == PLANETARY:
        known = MESH_LOAD_FACTORS if stage.mesh_load_factor is None else range(2, 8)
        low, high = stage.counts[0], stage.counts[-1]
        counts = [n for n in known if not low <= n <= high]
        counts.sort(key=lambda n: (n > high, min(abs(n - low), abs(n - high))))  # fewer have room
        yield ("planets",), [(n, n) for n in counts]
        yield ("mesh_order",), [None] * (stage.mesh_order is not None)
        yield ("planet_teeth_reduction",), [None] * (stage.planet_teeth_reduction is not None)
    for name in ("sun_teeth", "planet_teeth", "ring_teeth"):
        yield (name,), _near(getattr(stage, name))
    if stage.type == PLANETARY:
        gap = stage.planet_clearance
        yield ("planet_clearance",), [gap * Fraction(n, 4) for n in (3, 2, 1, 0)] if gap else []
        yield ("equally_spaced",), [False] * (stage.equally_spaced is not False)
        yield ("fixed",), [held for held in ("ring", "carrier") if held != stage.held]
    if stage.ring.cutter_teeth is not None:
        fewer = [stage.ring.cutter_teeth // n for n in (2, 3, 4, 6, 8, 12, 16)]
        yield ("ring", "cutter_teeth"), [z for z in fewer if z >= 5]
    if stage.ring.outside_diameter is not None:
        wide = [times(stage.ring.outside_diameter, factor) for factor in TIMES]
        yield ("ring", "outside_diameter"), wide


def _near(teeth: Teeth) -> list[Teeth]:
    """Fixed numbers of teeth up and down from one, near ones first; none of a range."""
    if teeth is None or teeth[0] != teeth[1]:
        return []
    steps = [way * n for n in range(1, STEPS + 1) for way in (1, -1)]
    return [(teeth[0] + n, teeth[0] + n) for n in steps]
