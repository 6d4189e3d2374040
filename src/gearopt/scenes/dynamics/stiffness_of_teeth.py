"""A file of kind pair as the mesh of a moving pair: its stiffness, and that both are one pair."""

import math
from collections.abc import Iterator

from gearopt.errors import SceneError
from gearopt.formulations.dynamics.parts import nearest_load, of_contact
from gearopt.formulations.pair.design import ContactLoad, PairContact, PairRelief
from gearopt.optimise.typed import typed
from gearopt.physics.motion.stiffness_wave import Wave
from gearopt.scenes.dynamics.handed_on import rotors_of
from gearopt.scenes.dynamics.scene import Scene
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.handed_on import same, text_of
from gearopt.scenes.reading.linked_files import Input

GEOMETRY = (  # that both files have
    *(("mesh", "teeth"), ("mesh", "pressure_angle")),
    *(("pinion", "base_diameter"), ("wheel", "base_diameter")),
)
NEAR = 0.01  # relative, of normal forces that are one


def of_teeth(scene: Scene, ask: Ask) -> tuple[Wave, list[str]]:
    """Return the stiffness by the file of [mesh] pair, with its relief; and what is assumed of it.

    SceneError where that pair has other teeth than the file.
    """
    assert scene.mesh.pair is not None and scene.pinion.torque is not None
    named = scene.mesh.pair.answered(ask)
    design = named.result(ask).design
    if "contact" not in design:
        rule = "has its contact by slices of the face: the mesh stiffness is taken from spur pairs"
        tell = "Take the file of a spur pair without a table [flank]"
        raise SceneError(named.file, "", "", rule, tell)
    contact: PairContact = typed(PairContact, design["contact"], "contact")
    if others := list(_others(scene, named, ask)):
        rule = f"has other teeth than this file: {'; '.join(others)}"
        raise SceneError(named.file, "", "", rule, "Write those of the pair's file")
    held = design.get("relief")
    relief: PairRelief | None = typed(PairRelief, held, "relief") if held else None
    force = 2.0 * scene.pinion.torque.value / scene.pinion.base_diameter.value
    loads = contact.loads if relief is None else relief.at
    load = nearest_load([one for one in loads if one.normal_force_N], force)
    return of_contact(contact, load), list(_assumed(str(named), load, force, relief is not None))


def _others(scene: Scene, named: Input, ask: Ask) -> Iterator[str]:
    """Yield in words where the pair of another file is not that of the file."""
    follows = rotors_of(named, None, ask).follows
    for table, name in GEOMETRY:
        given, its = getattr(getattr(scene, table), name), follows[table, name]
        if not same(given, its):
            is_its = f"{text_of(given, given)}, of the pair's file {text_of(its, given)}"
            yield f"[{table}] {name} is {is_its}"


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
