"""The box of a drive whose gears are sized: data checks, the layout by any method, its words."""

import math
from dataclasses import asdict, replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive import layout
from gearopt.formulations.drive.design import DriveDesign, drive_design, gears_first
from gearopt.formulations.drive.layout.exact import GAP
from gearopt.formulations.drive.layout.faults import faults, of_any_gears
from gearopt.formulations.drive.layout.gearbox import Gearbox, KeepOut
from gearopt.formulations.drive.layout.layout_design import (
    BearingDesign,
    BoxDesign,
    ClearanceDesign,
    GapDesign,
    GearDesign,
    KeepOutDesign,
    LayoutDesign,
    MotorDesign,
    ShaftDesign,
    gear_sizes,
)
from gearopt.formulations.drive.layout.layout_text import Placed, placed, read
from gearopt.formulations.drive.layout.slabs import Arrangement, arrangements
from gearopt.optimise.clock import Clock, following, in_part, of_others, tell_known
from gearopt.optimise.comparing.runs import Model
from gearopt.optimise.result import Result
from gearopt.optimise.solve import run
from gearopt.optimise.typed import untyped
from gearopt.physics.gears import GearPair
from gearopt.physics.shaft_forces import OTHER, hands
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.reading.ask import Ask

SECONDS = 2.0  # at most, for the layout that is drawn beside an impossible one


def pairs_of(scene: Scene, sized: Result) -> tuple[GearPair, ...]:
    """Return the gear pairs of a sized drive."""
    train = scene.train()
    return tuple(
        train.pair(k, s.normal_module_mm, s.pinion_teeth, s.wheel_teeth, s.face_width_mm)
        for k, s in enumerate(drive_design(sized.design).stages)
    )


def lay_out(scene: Scene, ask: Ask, sized: Result) -> Result:
    """Return the layout of a sized drive; the sizing is kept as its part `gears`."""
    box = scene.gearbox(pairs_of(scene, sized))
    orders = arrangements(box)
    wrong = faults(box)
    parts = (replace(sized, name="gears"),)
    if wrong:
        return _impossible(scene, sized, ask, parts, wrong)
    problem = layout.problem(box, ask.method)
    watch, events = following(in_part(ask.watch, box.unit))
    asked = ask.budget.less(sized.seconds)
    gap = ask.gap if ask.budget.gap else GAP
    result, outcome = run(problem, ask.method, asked, ask.seed, watch, gap)
    result = replace(result, objective=result.objective | {"unit": box.unit}, parts=parts)
    if result.status == "infeasible":
        notes = ["These gears cannot be arranged with these clearances and positions."]
        return _impossible(scene, sized, ask, parts, notes, result)
    if result.value is None or outcome.x is None:
        return replace(result, name="drive")
    return with_layout(scene, result, events, sized, box, *read(orders, outcome.x))


def with_layout(
    scene: Scene,
    result: Result,
    events: list[dict[str, Any]],
    sized: Result,
    box: Gearbox,
    angles: tuple[float, ...],
    order: Arrangement,
) -> Result:
    """Return a result with its gears and layout in the words of a drawing."""
    gears = drive_design(sized.design)
    found = handed(described(box, order, angles, gears), scene)
    if any(part.name == "gears" for part in result.parts) and not scene.given:
        result = _of_gears_first(scene, result, sized)
    before = sum(p.seconds for p in result.parts), sum(p.evaluations for p in result.parts)
    seconds, spent = before[0] + result.seconds, before[1] + result.evaluations
    last = {"seconds": seconds, "evaluations": spent, "best": result.value, "bound": result.bound}
    steps = [
        e | {"seconds": before[0] + e["seconds"], "evaluations": before[1] + e["evaluations"]}
        for e in events
    ]
    return replace(
        result,
        name="drive",
        design=untyped(replace(gears, layout=found)),
        limits=sized.limits | used(found) | _sides_used(result),
        report={
            "progress": [*steps, last],
            "notes": [*sized.report.get("notes", []), *_reached(box, found)],
        },
        evaluations=spent,
        seconds=seconds,
    )


def _scope(sized: Result) -> dict[str, str]:
    """Return the scope of whatever is proven of a layout of gears that were sized before it."""
    return {"scope": gears_first(str(sized.objective["name"]))}


def _of_gears_first(scene: Scene, result: Result, sized: Result) -> Result:
    """Return a layout whose message says that it is one of gears that were sized before it."""
    words = f"the box is that of {_scope(sized)['scope']}"
    if scene.teeth is not None:
        words += ": with together = true in [layout] gears and box are optimised together"
    message = "; ".join(filter(None, (result.message, words)))
    return replace(result, proof=result.proof | _scope(sized), message=message)


def handed(found: LayoutDesign, scene: Scene) -> LayoutDesign:
    """Return a layout with the hands of its helices, where the file gives one."""
    given = [stage.pinion_hand for stage in scene.stage]
    if not any(given):
        return found
    of_stage = [{"pinion": hand, "wheel": OTHER[hand]} for hand in hands(given)]
    gears = [replace(gear, hand=of_stage[gear.stage - 1][gear.member]) for gear in found.gears]
    return replace(found, gears=tuple(gears))


def _sides_used(result: Result) -> dict[str, float]:
    return {n: v for n, v in result.limits.items() if n.startswith("largest_")}


def posed(scene: Scene, method: str, sized: Result) -> Model:
    """Return the layout problem of a method; SolveError where the gears cannot be laid out."""
    if sized.value is None:
        raise SolveError("there are no gears to lay out: gearopt explain shows why")
    box = scene.gearbox(pairs_of(scene, sized))
    if wrong := faults(box):
        raise SolveError(" ".join(wrong))
    layout.ready()  # what is compared is machine code
    words = "Layout by four sides" if method in layout.GRADIENT else "Layout by link angles"
    return Model(layout.problem(box, method), f"{words}, of gears that were chosen first", box.unit)


def _impossible(
    scene: Scene,
    sized: Result,
    ask: Ask,
    parts: tuple[Result, ...],
    notes: list[str],
    result: Result | None = None,
) -> Result:
    from gearopt.scenes.drive.explaining.box_remedies import remedies

    layout.ready(ask.watch)
    spent = sized.seconds + (0.0 if result is None else result.seconds)
    left = replace(ask, budget=ask.budget.less(spent))
    if result is None:
        proof = {"method": "closed form", "conflict": []}
        objective = {"name": str(scene.layout and scene.layout.minimise), "value": None}
        result = replace(sized, method="data check", objective=objective, bound=None, gap=None)
        result = replace(result, status="infeasible", proof=proof, certificate={}, limits={})
    if others_may_fit(scene, pairs_of(scene, sized)):
        result = replace(result, proof=result.proof | _scope(sized))
    message = _message(scene, sized, notes)
    result = replace(result, design={}, parts=parts, message=message)
    if scene.layout is not None and not scene.layout.together:
        tell_known(ask.watch, result)
    found, changed = remedies(scene, pairs_of(scene, sized), left)
    report = {"notes": notes, "ways_out": asdict(found)}
    if changed is not None and (drawn := _beside(scene, changed, sized, left)) is not None:
        report["nearest_layout"] = drawn
    return replace(result, report=report)


def others_may_fit(scene: Scene, pairs: tuple[GearPair, ...]) -> bool:
    """Return whether a fault of gears says nothing of others: they were sized first."""
    return not scene.given and not of_any_gears(scene.gearbox(pairs))


def _message(scene: Scene, sized: Result, notes: list[str]) -> str:
    """Return why there is no layout; of gears sized first, that it is these that have none."""
    why = " ".join(notes)
    assert scene.layout is not None
    if scene.layout.together or not others_may_fit(scene, pairs_of(scene, sized)):
        return why
    least = str(sized.objective["name"]).replace("_", " ")
    return f"These gears, sized first for least {least}, do not fit: {why}"


def _beside(scene: Scene, changed: Scene, sized: Result, ask: Ask) -> dict[str, Any] | None:
    """Return a layout of a changed file, and what of the file as it is differs, for a drawing.

    None where none is found in SECONDS.
    """
    pairs = pairs_of(scene, sized)
    asked, box = scene.gearbox(pairs), changed.gearbox(pairs)
    watch = of_others(ask.watch)
    budget = replace(ask.budget, seconds=Clock(ask.budget, watch).within(SECONDS))
    result, outcome = run(layout.problem(box, None), None, budget, watch=watch)
    if result.value is None or outcome.x is None:
        return None
    angles, order = read(arrangements(box), outcome.x)
    found = placed(box, order, angles)
    gone = [_keep_out(k, found) for k in asked.keep_outs if k not in box.keep_outs]
    return {
        "layout": untyped(described(box, order, angles, drive_design(sized.design))),
        "keep_outs": [untyped(k) for k in gone],
        "motor_mm": 2.0 * asked.motor if asked.motor != box.motor else None,
        "largest_mm": [None if math.isinf(v) else v for v in asked.largest],
    }


def _reached(box: Gearbox, found: LayoutDesign) -> list[str]:
    """Return notes on keep-outs that the box itself reaches into."""
    left, bottom = found.box.left_mm, found.box.bottom_mm
    right, top = left + found.box.width_mm, bottom + found.box.height_mm
    deep = {
        k.name: min(right - k.y[0], k.y[1] - left, top - k.z[0], k.z[1] - bottom)
        for k in box.keep_outs
    }
    return [
        f"The box itself reaches {d:.1f} mm into {name}: gears, shafts and bearings are kept out "
        "of it, walls are not (a larger shaft_clearance keeps them out too)."
        for name, d in deep.items()
        if d > 0.05
    ]


def described(
    box: Gearbox, one: Arrangement, angles: tuple[float, ...], sized: DriveDesign
) -> LayoutDesign:
    """Describe the layout of a sized drive as a result holds it."""
    found = placed(box, one, angles)
    shafts = [body for own in one.bodies for body in own if body.name.startswith("shaft")]
    return LayoutDesign(
        box=_box(found),
        shafts=tuple(
            ShaftDesign(
                shaft=k,
                y_mm=y,
                z_mm=z,
                diameter_mm=2 * body.radius,
                from_mm=body.x[0],
                to_mm=body.x[1],
            )
            for k, ((y, z), body) in enumerate(zip(found.axes, shafts, strict=True), 1)
        ),
        gears=_gears(box, one, sized),
        bearings=tuple(
            BearingDesign(shaft=k, diameter_mm=2 * body.radius, from_mm=body.x[0], to_mm=body.x[1])
            for k, own in enumerate(one.bodies, 1)
            for body in own
            if body.name.startswith("bearing")
        ),
        link_angles_deg=tuple(math.degrees(t) for t in angles),
        slabs=tuple(tuple(s + 1 for s in slab) for slab in one.slabs),
        gaps=_gaps(box, one, found),
        clearances=_clearances(box),
        obstacles=tuple(_keep_out(k, found) for k in box.keep_outs),
        motor=MotorDesign(diameter_mm=2 * box.motor) if box.motor else None,
        split=tuple(k + 1 for k in box.level),
    )


def used(found: LayoutDesign) -> dict[str, float]:
    """Return, of every two axes that must keep apart, the part of their distance that is needed."""
    return {
        " to ".join(gap.between).replace(" ", "_"): 1.0 - (gap.gap_mm - gap.needed_mm) / gap.axes_mm
        for gap in found.gaps
    }


def _box(found: Placed) -> BoxDesign:
    width, height, length = found.width, found.height, found.length
    return BoxDesign(
        width_mm=width,
        height_mm=height,
        length_mm=length,
        left_mm=found.left,
        bottom_mm=found.bottom,
        volume_mm3=width * height * length,
        plan_area_mm2=width * length,
        face_area_mm2=width * height,
    )


def _gears(box: Gearbox, one: Arrangement, sized: DriveDesign) -> tuple[GearDesign, ...]:
    gears = []
    for k, own in enumerate(one.bodies, 1):
        for body in (b for b in own if b.gear):
            member, stage = body.name.split()[0], sized.stages[body.stage]
            wheel, pair = member == "wheel", box.pairs[body.stage]
            gear = pair.wheel if wheel else pair.pinion
            gears.append(
                GearDesign(
                    name=body.name,
                    stage=body.stage + 1,
                    member=member,
                    shaft=k,
                    teeth=stage.wheel_teeth if wheel else stage.pinion_teeth,
                    from_mm=body.x[0],
                    to_mm=body.x[1],
                    **gear_sizes(gear),
                )
            )
    return tuple(gears)


def _gaps(box: Gearbox, one: Arrangement, found: Placed) -> tuple[GapDesign, ...]:
    """Return clear distances of bodies that must keep apart, the tightest first."""
    gaps = []
    for (i, j), need in one.needs.items():
        (ya, za), (yb, zb) = found.axes[i], found.axes[j]
        there = math.hypot(yb - ya, zb - za)
        gap = there - (need.distance - need.clearance)
        gaps.append(
            GapDesign(between=need.between, gap_mm=gap, needed_mm=need.clearance, axes_mm=there)
        )
    for k, keep in enumerate(box.keep_outs):
        for i, (y, z) in enumerate(found.axes):
            if (needed := float(one.keep_apart[k, i])) > 0.0:
                dy = max(keep.y[0] - y, y - keep.y[1], 0.0)
                dz = max(keep.z[0] - z, z - keep.z[1], 0.0)
                gaps.append(
                    GapDesign(
                        between=(f"shaft {i + 1} with its gears", keep.name),
                        gap_mm=math.hypot(dy, dz) - needed + box.clearances.shafts,
                        needed_mm=box.clearances.shafts,
                        axes_mm=math.hypot(dy, dz),
                    )
                )
    return tuple(sorted(gaps, key=lambda g: float(g.gap_mm) - float(g.needed_mm)))


def _clearances(box: Gearbox) -> ClearanceDesign:
    found = box.clearances
    return ClearanceDesign(
        gear_to_gear_mm=found.gears,
        gear_to_shaft_mm=found.shafts,
        wall_mm=found.wall,
        axial_mm=found.axial,
    )


def _keep_out(keep: KeepOut, found: Placed) -> KeepOutDesign:
    return KeepOutDesign(
        name=keep.name,
        left_mm=keep.y[0],
        right_mm=keep.y[1],
        bottom_mm=keep.z[0],
        top_mm=keep.z[1],
        from_mm=max(keep.x[0], -0.1 * found.length),
        to_mm=min(keep.x[1], 1.1 * found.length),
    )
