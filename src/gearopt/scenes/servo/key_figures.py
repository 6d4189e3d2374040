"""The numbers of a servo axis that stand in `report` by fixed names; docs/servo.md lists them."""

from collections.abc import Mapping
from typing import Any

from gearopt.optimise.result import Result
from gearopt.physics.inertia import disc_mass
from gearopt.scenes.servo.gears import Gears, described, given_gears
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.springs import stiffness_of
from gearopt.scenes.servo.tolerance_part import of_given

GOALS = {"inertia": "inertia_kg_m2", "mass": "mass_kg", "error": "error_deg"}
BOX = ("needed_width_mm", "needed_height_mm")


def key_figures(
    scene: Scene, results: tuple[Result, ...], design: Mapping[str, Any], report: Mapping[str, Any]
) -> dict[str, Any]:
    """Counts, the chosen and the given train, least values, room, and the lightest train."""
    found: dict[str, Any] = {}
    for result in results:
        if result.name == "train":
            found |= _counts(result.proof)
        if result.name == "stiff" and result.value is not None:
            found["lightest_mass_kg"] = result.value
            found["lightest_train"] = result.design
    if scene.train is not None and "train" in design:
        found |= _train("chosen", design["train"], design.get("stiffness"))
    if (gears := given_gears(scene)) is not None:
        found |= _given(scene, gears)
    for train in report.get("trains") or ():
        if (goal := train["best_of"]) in GOALS:
            found[f"least_{GOALS[goal]}"] = train[GOALS[goal]]
    return found | {key: design["box"][key] for key in BOX if "box" in design}


def _counts(proof: Mapping[str, Any]) -> dict[str, Any]:
    """Of an enumeration: choices of the right ratio, and how many of them keep all limits."""
    if "feasible_trains" not in proof:
        return {}
    return {
        "combinations": proof["trains_looked_at"],
        "feasible_trains": proof["feasible_trains"],
    }


def _train(
    whose: str, train: Mapping[str, Any], springs: Mapping[str, Any] | None
) -> dict[str, Any]:
    found = {f"{whose}_{k}": train[k] for k in ("ratio", *GOALS.values()) if k in train}
    for key in ("output_Nm_per_rad", "frequency_Hz", "windup_deg"):
        if springs is not None and key in springs:
            found[f"{whose}_{key.replace('output_', 'output_stiffness_')}"] = springs[key]
    return found


def _given(scene: Scene, gears: Gears) -> dict[str, Any]:
    """The given train; its mass with the middle shaft as that of [lightest] is counted."""
    train, springs = described(scene, gears), None
    if scene.stiffness is not None:
        springs = stiffness_of(scene, gears)
    found = _train("given", train, springs)
    if scene.sources:
        found |= of_given(scene, gears)
    found["given_train"] = train
    if springs is not None:
        found["given_stiffness"] = springs
    if scene.lightest is not None:
        assert scene.shaft is not None
        thick, long = scene.shaft.diameter.value, scene.shaft.length.value
        density = scene.servo_train().density
        shaft = 1000.0 * float(disc_mass(density, long, thick))
        found["given_mass_with_shaft_kg"] = train["mass_kg"] + shaft
    return found
