"""Where the gears of a design stand in space, their teeth in mesh, with shafts and bearings.

x runs along the shafts [mm]. In a layout all stand in their places; in a train without one as its
drawing has them, all shafts in one plane and the planets about their sun.
"""

import math
from collections.abc import Iterator
from dataclasses import fields, replace

from gearopt.formulations.drive.design import StageDesign, drive_design
from gearopt.formulations.drive.layout.layout_design import GearDesign
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.physics.blanks import Body
from gearopt.physics.planetary import assembly
from gearopt.report.drawing.bodies import Turning
from gearopt.report.drawing.gear_sections import outside
from gearopt.report.drawing.sheet import Point
from gearopt.report.drawing.solid import Toothed, rings_of, twist
from gearopt.report.drawing.stage_gears import meshes
from gearopt.report.drawing.train_views import bodies

MEMBER = {"sun": "pinion", "planet": "wheel"}  # as which they stand in a stage
SET = "pinion", "wheel", "ring"  # in the order of their colours
LEAST_WALL = 0.02  # of the root diameter: less is left by no bore, the shaft being of one piece


@dataclass(frozen=True)
class Part:
    """A body of revolution about an axis along x, with teeth or without.

    centre: (y, z) of the axis. contour: points (x, radius) [mm], closed but for the axis and the
    teeth. colour: of drawings, by its number in a series; 0 of shafts and bearings.
    """

    name: str
    colour: int
    centre: Point
    contour: tuple[Point, ...]
    toothed: Toothed | None = None


def parts(result: Result) -> list[Part]:
    """Every gear of whole teeth; of a layout shafts and bearings too."""
    design = drive_design(result.design)
    train = design.layout or bodies(result.design.get("stages", ()))
    if train is None:
        return []
    rows: list[Part] = []
    wheel: Toothed | None = None
    for k, stage in enumerate(design.stages, 1):
        for gear, placed in [*_in_mesh(stage, k, train, wheel)]:
            wheel = placed if gear.member == "wheel" else wheel
            contour = _inside(stage, gear, placed, train)
            colour = 1 + SET.index(gear.member) if stage.type == "planetary" else k
            rows.append(Part(gear.name, colour, placed.centre, contour, placed))
    if rows and design.layout:
        rows += _round(design.layout)
    return rows


def _in_mesh(
    stage: StageDesign, k: int, train: Turning, wheel: Toothed | None
) -> Iterator[tuple[GearDesign, Toothed]]:
    """Yield the gears of a stage, turned so that teeth meet spaces; an idler is not met again.

    Hands of a pair are opposite; those of the two gears on a shaft are equal, so that their axial
    forces are opposite, unless they are given. wheel: of the stage before.
    """
    known: dict[str, Toothed] = {}
    for pair, names in meshes(stage):
        if not all(float(gear.teeth).is_integer() for gear in pair.gears):
            continue
        for name, gear in zip(names, pair.gears, strict=True):
            if not known and stage.idler and wheel is not None:
                known[name] = wheel
            if name in known:
                continue
            for drawn, centre in _spots(stage, name, k, train):
                right = drawn.hand == "right" if drawn.hand else k % 2 == 1
                turned = replace(gear, helix_angle=(1.0 if right else -1.0) * gear.helix_angle)
                middle = 0.5 * (drawn.from_mm + drawn.to_mm)
                placed = Toothed(turned, drawn.from_mm, drawn.to_mm, centre, middle=middle)
                placed = mated(known[names[0]], placed) if known else placed
                known.setdefault(name, placed)
                yield drawn, placed


def _spots(
    stage: StageDesign, name: str, k: int, train: Turning
) -> Iterator[tuple[GearDesign, Point]]:
    """Yield where gears of a name stand in a stage: of a set about the axis of its ring."""
    here = [gear for gear in train.gears if gear.stage == k]
    places = {s.shaft: (s.y_mm, s.z_mm) for s in train.shafts}
    if stage.type != "planetary":
        yield from ((gear, places[gear.shaft]) for gear in here if gear.member == name)
        return
    ring = next(gear for gear in here if gear.member == "ring")
    drawn = replace(ring, name=f"{name} {k}", member=MEMBER.get(name, name))
    (y, z), a = places[ring.shaft], stage.centre_distance_mm if name == "planet" else 0.0
    whole = round((stage.sun_teeth or 0.0) + (stage.ring_teeth or 0.0))
    for turn in assembly.turns(whole, stage.planets or 1) if a else (0.0,):
        angle = 2.0 * math.pi * float(turn)
        yield drawn, (y + a * math.cos(angle), z + a * math.sin(angle))


def mated(first: Toothed, second: Toothed) -> Toothed:
    """A gear, or a ring around the first, with a space where the first has a tooth."""
    (y1, z1), (y2, z2) = first.centre, second.centre
    away, z = math.atan2(z2 - z1, y2 - y1), second.gear.teeth
    at = away if z > 0 else away + math.pi  # where they touch, from the first
    phase = first.phase + twist(first.gear) * (second.middle - first.middle)
    ahead = first.gear.teeth * (at - phase) / (2.0 * math.pi)  # of a tooth, in pitches
    hand = math.copysign(1.0, -z) * first.gear.helix_angle
    return replace(
        second,
        gear=replace(second.gear, helix_angle=hand),
        phase=away + math.pi + 2.0 * math.pi * (ahead + 0.5) / z,
    )


def _inside(
    stage: StageDesign, drawn: GearDesign, it: Toothed, train: Turning
) -> tuple[Point, ...]:
    """The contour of a gear away from its teeth: outside of a ring, else rim, web, hub and bore."""
    if it.gear.teeth < 0:
        return tuple((x, 0.5 * outside(it.gear, stage)) for x in (it.end, it.start))
    sizes = (getattr(stage, f"{drawn.member}_{f.name}_mm", None) for f in fields(Body))
    body = Body(*sizes)
    if body.bore is None:
        shaft = next(s.diameter_mm for s in train.shafts if s.shaft == drawn.shaft)
        fits = shaft < (1.0 - LEAST_WALL) * float(it.gear.root_diameter)
        body = replace(body, bore=shaft if fits and stage.type != "planetary" else None)
    return tuple(rings_of(body, it.gear, it.start, it.end))


def _round(layout: Turning) -> Iterator[Part]:
    """Yield shafts and bearings."""
    for shaft in layout.shafts:
        r, a, b = 0.5 * shaft.diameter_mm, shaft.from_mm, shaft.to_mm
        centre = shaft.y_mm, shaft.z_mm
        yield Part(f"shaft {shaft.shaft}", 0, centre, ((a, 0.0), (a, r), (b, r), (b, 0.0)))
        for it in (it for it in layout.bearings if it.shaft == shaft.shaft):
            big, a, b = 0.5 * it.diameter_mm, it.from_mm, it.to_mm
            tube = ((a, r), (a, big), (b, big), (b, r), (a, r))
            yield Part(f"bearing of shaft {shaft.shaft}", 0, centre, tube)
