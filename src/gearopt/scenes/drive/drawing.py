"""Data of the drawings of gears: measures with allowances, tolerances, backlash, by [drawing]."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive.design import DriveDesign, drive_design
from gearopt.formulations.drive.drawing_data import DrawingData, GearData, MeshData
from gearopt.formulations.drive.rating import MeshName
from gearopt.optimise.result import Result
from gearopt.optimise.typed import untyped
from gearopt.physics.flank_tolerances import flank_tolerances
from gearopt.physics.gears import MEMBERS, Gear, GearPair, signed
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.physics.geometry.tooth import (
    ball_contact_diameter,
    chord,
    circumferential_backlash,
    normal_backlash,
    normal_thickness,
    over_balls,
    over_pins,
    span,
)
from gearopt.physics.iso6336.accuracy import beyond
from gearopt.physics.shaft_forces import hands
from gearopt.scenes.drive.driving import driven, drivers
from gearopt.scenes.drive.rating import iso_material
from gearopt.scenes.drive.rating.by_mesh import by_mesh, mesh_names
from gearopt.scenes.drive.rating.gears import gear_tables
from gearopt.scenes.drive.rating.geometry import BALL, hand_of, spanned_teeth, touches
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.drawing import DrawingTable
from gearopt.scenes.drive.tables.rating import GearTable
from gearopt.scenes.reading.ask import Ask

USUAL_GRADE, USUAL_EDITION = 6, "1995"  # where neither the table nor a rating says
OF_2013 = "tolerances of ISO 1328-1:2013 (no printed example was met)"
BEYOND = "tolerances of {gear}: its {sizes} is beyond the ranges of ISO 1328-1"
Ends = tuple[Gear, ...]  # of a gear at the upper and at the lower allowance


def with_drawing(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The answer with the data of the drawing of every gear, or why there is none."""
    assert known is not None and scene.drawing is not None
    design = drive_design(known.design)
    try:
        design = replace(design, drawing=drawing_data(scene, design))
        sentence, key = _assumed(scene.drawing), "assumptions"
    except (SolveError, ValueError) as reason:
        sentence, key = f"There is no drawing data: {reason}.", "notes"
    report = known.report | {key: [*known.report.get(key, []), sentence]}
    return replace(known, design=untyped(design), report=report)


def drawing_data(scene: Scene, design: DriveDesign) -> DrawingData:
    """Data of the gears of a design; SolveError or ValueError where a table has none."""
    asked = scene.drawing
    assert asked is not None
    held = driven(scene.held(len(design.stages)), design)
    meshed, pairs, materials = by_mesh(held, design)
    names = mesh_names(meshed) or tuple(
        MeshName(stage=k, title=f"stage {k}") for k in range(1, len(pairs) + 1)
    )
    turned = hands(
        [stage.pinion_hand for stage in meshed.stage] or [None] * len(pairs), drivers(meshed)
    )
    several = len(design.stages) > 1
    gears, meshes, unverified = list[GearData](), list[MeshData](), list[str]()
    mates = dict[str, list[str]]()
    for k, (pair, name) in enumerate(zip(pairs, names, strict=True)):
        if any(not float(gear.teeth).is_integer() for gear in pair.gears):
            raise SolveError(f"the gears of stage {name.stage} have no whole numbers of teeth")
        stage = meshed.stage_tables[k]
        tables = gear_tables(stage, meshed.gears, meshed.material, k, materials[k])
        ends = [
            tuple(replace(gear, thickness_allowance=off) for off in asked.thickness(gear))
            for gear in pair.gears
        ]
        meshes.append(_mesh(pair, name, ends, asked))
        for member, gear in enumerate(pair.gears):
            called = f"{name.gears[member]} {name.stage}" if several else name.gears[member]
            called = f"wheel {name.stage - 1}" if stage.idler and member == 0 else called
            mates.setdefault(called, []).append(f"z {abs(pair.gears[1 - member].teeth):g}")
            if member == 0 and (stage.idler or name.pinion != name.gears[0]):
                continue  # it is the wheel of the mesh before
            grade, edition = _accuracy(scene, tables[member], member)
            words = {
                "stage": name.stage,
                "gear": called,
                "hand": hand_of(gear, member, turned[k]),
                "tolerances": f"ISO 1328-1:{edition}, {grade}",
                "tool": _tool(gear, tables[member]),
                "material": _material(design, k + 1, MEMBERS[member], tables[member]),
            }
            words |= _relief(scene, design, MEMBERS[member])
            amounts = flank_tolerances(gear, grade, edition).items()
            words |= {f"{item}_mm": amount for item, amount in amounts}
            gears.append(_gear(gear, ends[member], asked, words))
            unverified += _unverified(called, pair, member, grade, edition)
    return DrawingData(
        gears=tuple(replace(gear, mate=" and ".join(mates[gear.gear])) for gear in gears),
        meshes=tuple(meshes),
        unverified=tuple(dict.fromkeys(unverified)),
    )


def _accuracy(scene: Scene, table: GearTable, member: int) -> tuple[int, str]:
    """Grade and edition of ISO 1328-1 of a gear."""
    asked, rated = scene.drawing, scene.rating
    assert asked is not None
    iso = rated.iso6336 if rated is not None and rated.by_iso6336 else None
    usual = iso.accuracy_grade[member] if iso and iso.accuracy_grade else USUAL_GRADE
    grades = (asked.accuracy_grade, table.accuracy_grade, usual)
    grade = next(each for each in grades if each is not None)
    return grade, asked.tolerances or (iso.tolerances if iso else USUAL_EDITION)


def _gear(gear: Gear, ends: Ends, asked: DrawingTable, words: dict[str, Any]) -> GearData:
    """The data of a gear; words: names and tolerances by their keys."""
    rack, size = gear.rack, {"form_diameter_mm": form_diameter(ends[0])}
    for name in ("reference_diameter", "base_diameter", "tip_diameter", "root_diameter"):
        size[f"{name}_mm"] = getattr(gear, name)
    for end, at in zip(("upper", "lower"), ends, strict=True):
        cut = replace(at, profile_shift=at.generating_shift, thickness_allowance=0.0)
        size[f"{end}_root_diameter_mm"] = cut.root_diameter
    size = {name: abs(float(value)) for name, value in size.items()}
    bare = replace(gear, thickness_allowance=0.0)
    wide, height = map(float, chord(bare))
    by = "own A_sne, tolerance " * bool(gear.thickness_allowance) + asked.fit
    chamfered = abs(float(gear.active_tip_diameter)) if rack.tip_chamfer else None
    return GearData(
        mate="",
        teeth=abs(round(float(gear.teeth))),
        normal_module_mm=float(gear.normal_module),
        pressure_angle_deg=math.degrees(rack.pressure_angle),
        helix_angle_deg=math.degrees(abs(gear.helix_angle)),
        profile_shift=float(gear.profile_shift),
        upper_generating_shift=float(ends[0].generating_shift),
        lower_generating_shift=float(ends[1].generating_shift),
        face_width_mm=float(gear.width),
        tip_form_diameter_mm=chamfered,
        tooth_thickness_mm=float(normal_thickness(bare, gear.reference_diameter)),
        allowances=by,
        upper_allowance_mm=float(ends[0].thickness_allowance),
        lower_allowance_mm=float(ends[1].thickness_allowance),
        chord_mm=wide,
        chord_height_mm=height,
        **(words | size | _measures(bare, ends, asked)),
    )


def _tool(gear: Gear, table: GearTable) -> str:
    """The tool of a gear: addendum and tip radius, protuberance, teeth of a cutter."""
    if (cutter := gear.cutter) is not None:
        return f"{cutter.addendum:g}/{cutter.tip_radius:g}, cutter z {cutter.teeth:g}"
    pr, q = (float(amount or 0) for amount in (table.tool_protuberance, table.grinding_allowance))
    ends = f", pr {pr:g}" * bool(pr) + f", q {q:g}" * bool(q)
    return f"{gear.rack.dedendum:g}/{gear.rack.tip_radius:g}{ends}"


def _measures(bare: Gear, ends: Ends, asked: DrawingTable) -> dict[str, Any]:
    """Span, balls and pins of a gear, where they touch its flanks."""
    known: dict[str, Any] = {}
    gears = {"": bare, "upper_": ends[0], "lower_": ends[1]}
    if (teeth := spanned_teeth(bare)) is not None:
        known["span_teeth"] = teeth
        known |= {f"{end}span_mm": float(span(gear, teeth)) for end, gear in gears.items()}
    if (ball := _ball(bare, asked)) is None:
        return known
    known["ball_diameter_mm"] = ball
    known |= {f"{end}over_balls_mm": float(over_balls(gear, ball)) for end, gear in gears.items()}
    if bare.helix_angle and bare.teeth % 2:
        known |= {f"{end}over_pins_mm": float(over_pins(gears[end], ball)) for end in [*gears][1:]}
    return known


def _ball(gear: Gear, asked: DrawingTable) -> float | None:
    """Diameter [mm] of the ball that measures a gear; None where none touches its flanks.

    Of several the smallest that touches at d + 2 x m_n or nearer the tip: five balls of printed
    reports (z 18, 36, 24, 95 and a ring of 93) are chosen so.
    """
    if asked.balls is None:
        balls = [BALL * float(gear.normal_module)]
    else:
        middle = gear.reference_diameter + 2.0 * gear.profile_shift * gear.normal_module
        each = sorted(ball.value for ball in asked.balls)
        balls = [ball for ball in each if ball_contact_diameter(gear, ball) >= middle]
    return next((ball for ball in balls if touches(gear, ball)), None)


def _mesh(pair: GearPair, name: MeshName, ends: list[Ends], asked: DrawingTable) -> MeshData:
    """Centre distance and backlash of a mesh: of the thickest teeth nearest, the thinnest apart."""
    distance = abs(float(pair.centre_distance))
    low, high = asked.distance(distance)
    ends_of_play = [
        GearPair(ends[0][k], ends[1][k], signed(distance + off, pair.wheel.teeth))
        for k in (0, 1)
        for off in (low, high)
    ]
    backlash, normal = (
        [float(law(each)) for each in ends_of_play]
        for law in (circumferential_backlash, normal_backlash)
    )
    return MeshData(
        mesh=name.title,
        centre_distance_mm=distance,
        distance_allowances=asked.field,
        lower_distance_allowance_mm=low,
        upper_distance_allowance_mm=high,
        least_backlash_mm=min(backlash),
        largest_backlash_mm=max(backlash),
        least_normal_backlash_mm=min(normal),
        largest_normal_backlash_mm=max(normal),
    )


def _material(design: DriveDesign, mesh: int, member: str, table: GearTable) -> str:
    """Material of a gear with its hardness, as a rating names it, else as the file does."""
    rows = design.rating.gears if design.rating else ()
    rated = [row.material for row in rows if (row.stage, row.member) == (mesh, member)]
    usual = iso_material.material(table) if table.steel or table.iso_material else ""
    return next(iter(rated), usual)


def _relief(scene: Scene, design: DriveDesign, member: str) -> dict[str, float]:
    """Tip relief of a gear: of a pair that is designed with it, else that of a rating."""
    if design.relief is not None:
        flank = getattr(design.relief, member)
        start = flank.start_diameter_mm
        return {"tip_relief_mm": flank.amount_mm, "relief_diameter_mm": start}
    if design.flank is not None and any(design.flank.relief_mm):
        k = MEMBERS.index(member)
        where = design.flank.relief_diameters_mm[k]
        return {"tip_relief_mm": design.flank.relief_mm[k], "relief_diameter_mm": where}
    asked = scene.rating.iso6336.tip_relief if scene.rating else None
    return {"tip_relief_mm": asked.value} if asked else {}


def _unverified(
    called: str, pair: GearPair, member: int, grade: int, edition: str
) -> Iterator[str]:
    """Yield what of a gear's data no second source has, or is beyond a standard's ranges."""
    if edition == "2013":
        yield OF_2013
    both = GearPair(pair.gears[member], pair.gears[member], pair.centre_distance)
    if sizes := beyond(both, (grade, grade), edition):
        yield BEYOND.format(gear=called, sizes=" and ".join(sizes))


def _assumed(asked: DrawingTable) -> str:
    """By what the drawings' data are, and what of it the file does not say."""
    grade = f"grade {USUAL_GRADE} unless gear or rating has one"
    words = {
        "allowance": f"tooth thickness by {asked.fit}",
        "centre_distance": f"centre distance {asked.field}",
        "accuracy_grade": grade if asked.accuracy_grade is None else "one grade",
        "balls": f"balls of {BALL:g} m_n" if asked.balls is None else "balls of the file",
    }
    usual = {key: " (default)" * (key not in asked.model_fields_set) for key in words}
    return (
        f"Drawing data: {', '.join(f'{text}{usual[key]}' for key, text in words.items())}; "
        "backlash is that of teeth and centre distance alone, without runout, parallelism, "
        "temperature and bearings."
    )
