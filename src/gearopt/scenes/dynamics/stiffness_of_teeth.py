"""A file of kind pair as the mesh of a moving pair: its stiffness, and that both are one pair."""

import math
from collections.abc import Iterator
from typing import Any

from gearopt.errors import SceneError
from gearopt.formulations.drive.design import DriveDesign, drive_design
from gearopt.formulations.dynamics.parts import nearest_load, of_contact
from gearopt.formulations.pair.design import ContactLoad, PairContact, PairRelief
from gearopt.optimise.typed import typed
from gearopt.physics.gears import GearPair
from gearopt.physics.motion.stiffness_wave import Wave
from gearopt.scenes.dynamics.scene import Scene
from gearopt.scenes.reading.ask import Ask

SAME = 1e-3  # relative, of dimensions that are one: digits of a file
NEAR = 0.01  # relative, of normal forces that are one


def of_teeth(scene: Scene, ask: Ask) -> tuple[Wave, list[str]]:
    """Return the stiffness by the file of [mesh] pair, with its relief; and what is assumed of it.

    SceneError where that pair has other teeth than the file.
    """
    assert scene.mesh.pair is not None and scene.pinion.torque is not None
    named, design = scene.mesh.pair, scene.mesh.pair.result(ask).design
    if "contact" not in design:
        rule = "has its contact by slices of the face: the mesh stiffness is taken from spur pairs"
        tell = "Take the file of a spur pair without a table [flank]"
        raise SceneError(named.file, "", "", rule, tell)
    contact: PairContact = typed(PairContact, design["contact"], "contact")
    if others := list(_others(scene, drive_design(design))):
        rule = f"has other teeth than this file: {'; '.join(others)}"
        raise SceneError(named.file, "", "", rule, "Write those of the pair's file")
    held = design.get("relief")
    relief: PairRelief | None = typed(PairRelief, held, "relief") if held else None
    force = 2.0 * scene.pinion.torque.value / scene.pinion.base_diameter.value
    loads = contact.loads if relief is None else relief.at
    load = nearest_load([one for one in loads if one.normal_force_N], force)
    return of_contact(contact, load), list(_assumed(str(named), load, force, relief is not None))


def _others(scene: Scene, design: DriveDesign) -> Iterator[str]:
    """Yield in words where the pair of a design is not that of the file."""
    pair: GearPair = design.stages[0].pair
    degrees = math.degrees(scene.mesh.pressure_angle.value)
    rows: tuple[tuple[str, float, Any, str], ...] = (
        ("[mesh] teeth", scene.mesh.teeth, pair.pinion.teeth, ""),
        ("[mesh] pressure_angle", degrees, math.degrees(pair.working_angle), " deg"),
        (
            "[pinion] base_diameter",
            scene.pinion.base_diameter.value,
            pair.pinion.base_diameter,
            " mm",
        ),
        ("[wheel] base_diameter", scene.wheel.base_diameter.value, pair.wheel.base_diameter, " mm"),
    )
    for name, given, its, unit in rows:
        if not math.isclose(given, float(its), rel_tol=SAME):
            yield f"{name} is {given:.6g}{unit}, of the pair's file {float(its):.6g}{unit}"


def _assumed(name: str, load: ContactLoad, force: float, relieved: bool) -> Iterator[str]:
    """Yield at which load the stiffness is taken."""
    flanks = "with its relief" if relieved else "whose flanks have no relief"
    yield (
        f"The mesh stiffness is the normal force over the transmission error of {name}, {flanks}, "
        f"at {100.0 * load.load:.4g} % of that file's torque, and the same at any force."
    )
    if not math.isclose(load.normal_force_N, force, rel_tol=NEAR):
        wanted = load.load * force / load.normal_force_N
        yield (
            f"That load has a normal force of {load.normal_force_N:,.5g} N, the torque of this "
            f"file {force:,.5g} N: add {wanted:.3g} to [sharing] loads of {name}."
        )
