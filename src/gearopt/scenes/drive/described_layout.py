"""The layout of a drive in the words of a drawing: box, shafts, gears, gaps, keep-outs."""

import math
from collections.abc import Sequence
from dataclasses import replace

from gearopt.formulations.drive.design import DriveDesign, StageDesign
from gearopt.formulations.drive.gearbox import Gearbox, KeepOut, Planetary
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
from gearopt.formulations.drive.layout.layout_text import Placed, placed
from gearopt.formulations.drive.layout.slabs import Arrangement, Body
from gearopt.physics.shaft_forces import OTHER, hands


def described(
    box: Gearbox, arrangement: Arrangement, angles: tuple[float, ...], sized: DriveDesign
) -> LayoutDesign:
    """Describe the layout of a sized drive as a result holds it."""
    layout = placed(box, arrangement, angles)
    shafts = [
        body
        for on_shaft in arrangement.bodies
        for body in on_shaft
        if body.name.startswith("shaft")
    ]
    return LayoutDesign(
        box=_box(layout),
        shafts=tuple(
            ShaftDesign(
                shaft=k,
                y_mm=y,
                z_mm=z,
                diameter_mm=2 * body.radius,
                from_mm=body.x[0],
                to_mm=body.x[1],
            )
            for k, ((y, z), body) in enumerate(zip(layout.axes, shafts, strict=True), 1)
        ),
        gears=_gears(box, arrangement, sized),
        bearings=tuple(
            BearingDesign(shaft=k, diameter_mm=2 * body.radius, from_mm=body.x[0], to_mm=body.x[1])
            for k, on_shaft in enumerate(arrangement.bodies, 1)
            for body in on_shaft
            if body.name.startswith("bearing")
        ),
        link_angles_deg=tuple(math.degrees(t) for t in angles),
        slabs=tuple(tuple(s + 1 for s in slab) for slab in arrangement.slabs),
        gaps=_gaps(box, arrangement, layout),
        clearances=_clearances(box),
        obstacles=tuple(keep_out_design(k, layout) for k in box.keep_outs),
        motor=MotorDesign(diameter_mm=2 * box.motor) if box.motor else None,
        split=tuple(k + 1 for k in box.level),
    )


def handed(layout: LayoutDesign, given: Sequence[str | None]) -> LayoutDesign:
    """Layout with the hands of its helices; given: those of the pinions in the file, if any."""
    if not any(given):
        return layout
    of_stage = [{"pinion": hand, "wheel": OTHER[hand]} for hand in hands(given)]
    gears = [
        replace(gear, hand=of_stage[gear.stage - 1].get(gear.member, "")) for gear in layout.gears
    ]
    return replace(layout, gears=tuple(gears))


def distances_used(layout: LayoutDesign) -> dict[str, float]:
    """Return, of every two axes that must keep apart, the part of their distance that is needed."""
    return {
        " to ".join(gap.between).replace(" ", "_"): 1.0 - (gap.gap_mm - gap.needed_mm) / gap.axes_mm
        for gap in layout.gaps
    }


def reached(box: Gearbox, layout: LayoutDesign) -> list[str]:
    """Return notes on keep-outs that the box itself reaches into."""
    left, bottom = layout.box.left_mm, layout.box.bottom_mm
    right, top = left + layout.box.width_mm, bottom + layout.box.height_mm
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


def _box(layout: Placed) -> BoxDesign:
    width, height, length = layout.width, layout.height, layout.length
    return BoxDesign(
        width_mm=width,
        height_mm=height,
        length_mm=length,
        left_mm=layout.left,
        bottom_mm=layout.bottom,
        volume_mm3=width * height * length,
        plan_area_mm2=width * length,
        face_area_mm2=width * height,
    )


def _gears(box: Gearbox, arrangement: Arrangement, sized: DriveDesign) -> tuple[GearDesign, ...]:
    gears = []
    for k, on_shaft in enumerate(arrangement.bodies, 1):
        for body in (b for b in on_shaft if b.gear):
            member, stage = body.name.split()[0], sized.stages[body.stage]
            if isinstance(box.pairs[body.stage], Planetary):
                gears += [_disc(body, stage, k)] if body.stage == k - 1 else []
                continue
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


def disc(stage: StageDesign) -> Planetary | None:
    """A planetary stage as a layout sees it; None of other stages."""
    if stage.type != "planetary" or stage.ring_outside_diameter_mm is None:
        return None
    wide = stage.face_width_mm + (stage.carrier_width_mm or 0.0)
    return Planetary(stage.ring_outside_diameter_mm, wide, stage.ratio)


def _disc(body: Body, stage: StageDesign, shaft: int) -> GearDesign:
    """The ring of a planetary stage as a gear on its input shaft, of its outside diameter.

    A cheek of its carrier, where it counts, is beside it on both sides.
    """
    cheek = 0.5 * (stage.carrier_width_mm or 0.0)
    return GearDesign(
        name=body.name,
        stage=shaft,
        member="ring",
        shaft=shaft,
        teeth=stage.ring_teeth or 0,
        normal_module_mm=stage.normal_module_mm,
        reference_diameter_mm=stage.ring_diameter_mm or 0.0,
        tip_diameter_mm=2.0 * body.radius,
        root_diameter_mm=stage.ring_root_diameter_mm or 0.0,
        helix_angle_deg=stage.helix_angle_deg,
        from_mm=body.x[0] + cheek,
        to_mm=body.x[1] - cheek,
    )


def _gaps(box: Gearbox, arrangement: Arrangement, layout: Placed) -> tuple[GapDesign, ...]:
    """Return clear distances of bodies that must keep apart, the tightest first."""
    gaps = []
    for (i, j), need in arrangement.needs.items():
        (ya, za), (yb, zb) = layout.axes[i], layout.axes[j]
        there = math.hypot(yb - ya, zb - za)
        gap = there - (need.distance - need.clearance)
        gaps.append(
            GapDesign(between=need.between, gap_mm=gap, needed_mm=need.clearance, axes_mm=there)
        )
    for k, keep in enumerate(box.keep_outs):
        for i, (y, z) in enumerate(layout.axes):
            if (needed := float(arrangement.keep_apart[k, i])) > 0.0:
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
    clearances = box.clearances
    return ClearanceDesign(
        gear_to_gear_mm=clearances.gears,
        gear_to_shaft_mm=clearances.shafts,
        wall_mm=clearances.wall,
        axial_mm=clearances.axial,
    )


def keep_out_design(keep: KeepOut, layout: Placed) -> KeepOutDesign:
    """A keep-out, cut off a little beyond the box."""
    return KeepOutDesign(
        name=keep.name,
        left_mm=keep.y[0],
        right_mm=keep.y[1],
        bottom_mm=keep.z[0],
        top_mm=keep.z[1],
        from_mm=max(keep.x[0], -0.1 * layout.length),
        to_mm=min(keep.x[1], 1.1 * layout.length),
    )
