"""A pair on moving axes from the answer of a file of its gears: bodies, mesh, load and speed."""

from dataclasses import replace
from fractions import Fraction
from typing import Any

from pydantic import ValidationError

from gearopt.formulations.drive.design import StageDesign, drive_design
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import MEMBERS
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.fields import refuse
from gearopt.scenes.reading.handed_on import STAGE, HandedOn, takes
from gearopt.scenes.reading.linked_files import Input
from gearopt.scenes.reading.load import kind_named
from gearopt.units import Quantity

BODY = ("rim_thickness", "web_thickness", "hub_diameter", "bore")


def rotors_of(source: Input, number: int | None, ask: Ask) -> HandedOn:
    """The pair on moving axes of a file of kind pair, or of a stage of a drive."""
    of = source.file
    if source.kind == "pair" and number not in (None, 1):
        raise refuse(f"is none of its stages: {of} has stage 1", 1, STAGE)
    if source.kind != "pair":
        source, of = _in_contact(source, number, ask), f"stage {number or 1} of {of}"
    design = drive_design(source.result(ask).design)
    stage, rating = design.stages[0], design.rating
    grades = rating.meshes[0].accuracy_grades if rating else None
    pair, torque = stage.pair, 1e3 * stage.pinion_torque_Nm
    speed = 2e3 * stage.pitch_line_velocity_m_per_s / stage.pinion_diameter_mm
    tables: dict[str, Any] = {
        member: {
            "base_diameter": _of(gear.base_diameter, "mm", "length"),
            "mass": _of(getattr(stage, f"{member}_mass_kg"), "kg", "mass"),
            "inertia": _of(inertia, "kg mm^2", "inertia"),
        }
        for member, gear, inertia in zip(MEMBERS, pair.gears, _inertias(stage), strict=True)
    }
    tables["pinion"]["torque"] = _of(torque, "N mm", "torque")
    tables["mesh"] = {
        "pressure_angle": _of(pair.working_angle, "rad", "angle"),
        "teeth": int(stage.pinion_teeth),
        "speed": _of(speed, "rad/s", "speed"),
        "wave": "pair",
        "pair": source,
        **({"accuracy_grade": max(grades)} if grades else {}),  # the coarser one
    }
    rows = ((table, name, v) for table, values in tables.items() for name, v in values.items())
    follows = {(table, name): value for table, name, value in rows if name != "wave"}
    balance = torque * stage.wheel_teeth / stage.pinion_teeth
    follows["wheel", "torque"] = _of(balance, "N mm", "torque")
    return HandedOn(of, tables, follows, lambda place: True)


def _in_contact(source: Input, number: int | None, ask: Ask) -> Input:
    """The stage of a drive as a pair whose contact is known."""
    gears: dict[str, Any] = {"from": source} | ({"stage": number} if number else {})
    kind = kind_named("pair")
    try:
        scene = kind.scene.model_validate({"gears": gears})
    except ValidationError as wrong:
        error = wrong.errors(include_url=False)[0]
        context = error.get("ctx", {})
        raise refuse(context["rule"], context["write"], STAGE, context["action"]) from None
    result = kind.solve(scene, replace(ask, method=None, top=1))
    return replace(source, kind="pair", what=scene, solved=result)


def _inertias(stage: StageDesign) -> list[float]:
    """Moments of inertia [kg mm2] of pinion and wheel, of the masses that they have."""
    rows = []
    for member, gear, body in zip(MEMBERS, stage.pair.gears, stage.bodies, strict=True):
        gear = replace(gear, body_diameter=body)
        held = {name: getattr(stage, f"{member}_{name}_mm") for name in BODY}
        bore, web = held["bore"] or 0.0, held["web_thickness"]
        blank = Blank(
            rim_thickness=held["rim_thickness"] if web else None,
            web_over_width=web / gear.width if web else 1.0,
            bore=bore,
            hub_over_bore=held["hub_diameter"] / bore if held["hub_diameter"] and bore else 1.0,
        )
        density = getattr(stage, f"{member}_mass_kg") / blank.volume(gear)
        rows.append(float(blank.inertia(gear, density)))
    return rows


def _of(value: Any, unit: str, dimension: str) -> Quantity:
    return Quantity(Fraction(float(value)), unit, dimension)


TAKES_ROTORS = takes(rotors_of)
