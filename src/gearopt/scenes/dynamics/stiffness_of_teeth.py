"""A file of kind pair as the mesh of a moving pair: stiffness and error; both are one pair."""

import math
from collections.abc import Iterator, Sequence
from statistics import mean
from typing import Any, NamedTuple

from gearopt.errors import SceneError
from gearopt.formulations.drive.design import drive_design
from gearopt.formulations.dynamics.design import Columns
from gearopt.formulations.dynamics.orbit.task import MICRO
from gearopt.formulations.dynamics.parts import (
    Contact,
    error_harmonics,
    nearest_load,
    of_contact,
    unloaded_error,
)
from gearopt.formulations.dynamics.standard_factors import Toothing
from gearopt.formulations.pair.design import ContactLoad, PairContact, PairRelief
from gearopt.formulations.pair.flank_design import FlankContact, FlankLoad
from gearopt.optimise.typed import typed
from gearopt.physics.motion.stiffness_wave import Wave, constant
from gearopt.scenes.dynamics.handed_on import rotors_of
from gearopt.scenes.dynamics.scene import Scene, wave_of
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.handed_on import same, text_of
from gearopt.scenes.reading.linked_files import Input

GEOMETRY = (  # that both files have
    *(("mesh", "teeth"), ("mesh", "pressure_angle")),
    *(("pinion", "base_diameter"), ("wheel", "base_diameter")),
)
NEAR = 0.01  # relative, of normal forces that are one
ERROR_HARMONICS = 40  # of a transmission error
Error = tuple[complex, ...]
Load = ContactLoad | FlankLoad
HELICAL = (
    "The gears are helical: the motion is that of their transverse plane. Axial forces and motion, "
    "and tilting, are left out."
)


class OfTeeth(NamedTuple):
    """What a pair's teeth give: stiffness, transmission error, themselves; and what is assumed."""

    wave: Wave
    error: Error
    teeth: Toothing
    assumed: list[str]


def of_teeth(scene: Scene, ask: Ask) -> OfTeeth:
    """Return stiffness, error and teeth of the file of [mesh] pair, with its relief.

    The stiffness is the file's own where its wave is not "pair"; a constant one that the file does
    not give is the mean of that.

    SceneError where that pair has other teeth than the file.
    """
    assert scene.mesh.pair is not None and scene.pinion.torque is not None
    named = scene.mesh.pair.answered(ask)
    design = named.result(ask).design
    if others := list(_others(scene, named, ask)):
        rule = f"has other teeth than this file: {'; '.join(others)}"
        raise SceneError(named.file, "", "", rule, "Write those of the pair's file")
    flanks = _flanks(design)
    contact, unloaded = flanks.contact, (0.0,) * len(flanks.unloaded)
    force = 2.0 * scene.pinion.torque.value / scene.pinion.base_diameter.value
    load = nearest_load([each for each in flanks.loads if each.normal_force_N], force)
    error, said = Error(), list[str]()
    if scene.mesh.transmission_error == "pair":
        unloaded, quasistatic = flanks.unloaded, scene.mesh.wave == "constant"
        curve = load.transmission_error_mm if quasistatic else unloaded
        error = error_harmonics(contact, curve, ERROR_HARMONICS) if max(curve) > 0.0 else error
        said.append(_of_error(str(named), quasistatic, load, max(curve) - min(curve)))
    averaged = scene.mesh.wave == "constant" and scene.mesh.stiffness is None
    if averaged or scene.mesh.wave == "pair":
        wave = of_contact(contact, load, unloaded)
        wave = constant(wave.mean) if averaged else wave
        said += _assumed(str(named), load, force, flanks.modified, averaged, any(unloaded))
        said += _model(str(named), contact)
    else:
        wave = wave_of(scene.mesh)
    gears = drive_design(design).stages[0].pair
    if gears.pinion.helix_angle:
        said.append(HELICAL)
    ratio = contact.contact_ratio + float(gears.overlap_ratio)
    numbers = ratio, float(gears.face_width), scene.mesh.accuracy_grade, flanks.relief
    return OfTeeth(wave, error, Toothing(gears, *numbers), said)


class _Flanks(NamedTuple):
    """Contact of a pair, its loads, unloaded errors and mean tip relief [mm]; if it is modified."""

    contact: Contact
    loads: Sequence[Any]
    unloaded: Columns
    relief: float
    modified: bool


def _flanks(design: dict[str, Any]) -> _Flanks:
    """The flanks of a pair as they are, with their relief; by slices of the face or without."""
    if "flank" in design:
        flank: FlankContact = typed(FlankContact, design["flank"], "flank")
        modified = max(flank.unloaded_error_mm) > 0.0 or any(flank.relief_mm)
        return _Flanks(flank, flank.loads, flank.unloaded_error_mm, mean(flank.relief_mm), modified)
    contact: PairContact = typed(PairContact, design["contact"], "contact")
    held = design.get("relief")
    if held is None:
        return _Flanks(contact, contact.loads, unloaded_error(contact, None), 0.0, False)
    relief: PairRelief = typed(PairRelief, held, "relief")
    tips = mean((relief.pinion.amount_mm, relief.wheel.amount_mm))
    return _Flanks(contact, relief.at, unloaded_error(contact, relief), tips, True)


def _of_error(name: str, quasistatic: bool, load: Load, height: float) -> str:
    """Say which transmission error of a file excites the mesh."""
    if not height:
        return (
            f"The unloaded teeth of {name} have no transmission error: nothing is off their flanks."
        )
    most = f"{MICRO * height:.3g} µm peak to peak, its first {ERROR_HARMONICS} harmonics"
    if quasistatic:
        return (
            f"The transmission error is that of {name} at {100.0 * load.load:.4g} % of that file's "
            f"torque, {most}: as the mesh stiffness is constant, it stands for its variation, too."
        )
    return (
        f"The transmission error is that of the unloaded teeth of {name}, {most}: the least relief "
        "of the pairs in contact. The deformation under load is not in it, but in the stiffness."
    )


def _others(scene: Scene, named: Input, ask: Ask) -> Iterator[str]:
    """Yield in words where the pair of another file is not that of the file."""
    follows = rotors_of(named, None, ask).follows
    for table, name in GEOMETRY:
        given, its = getattr(getattr(scene, table), name), follows[table, name]
        if not same(given, its):
            is_its = f"{text_of(given, given)}, of the pair's file {text_of(its, given)}"
            yield f"[{table}] {name} is {is_its}"


def _model(name: str, contact: Contact) -> Iterator[str]:
    """Yield the model of the teeth, and how far its stiffness was off where it was measured."""
    low, high = contact.error_percent
    yield (
        f'The teeth of {name} are by level "{contact.level}" and coupling "{contact.coupling}". '
        f"For 34 spur pairs of steel a pair of teeth was {low:+.3g} to {high:+.3g} % off in "
        "stiffness, against finite elements; its page tells the error of the transmission error."
    )


def _assumed(
    name: str, load: Load, force: float, relieved: bool, averaged: bool, less: bool
) -> Iterator[str]:
    """Yield at which load the stiffness, or its mean, is taken."""
    flanks = "with its relief" if relieved else "whose flanks have no relief"
    of = "the mean over a base pitch of " * averaged
    rest = ", less the gaps of the unloaded teeth," * less
    yield (
        f"The mesh stiffness is {of}the normal force over the transmission error{rest} of {name}, "
        f"{flanks}, "
        f"at {100.0 * load.load:.4g} % of that file's torque, and the same at any force."
    )
    if isinstance(load, ContactLoad) and not relieved and not averaged:
        yield (
            "It changes in steps, as teeth without relief are taken to meet at SAP; deflected ones "
            "meet before it, and gradually: the dynamic factor may lie well above theirs and K_v."
        )
    if not math.isclose(load.normal_force_N, force, rel_tol=NEAR):
        wanted = load.load * force / load.normal_force_N
        yield (
            f"That load has a normal force of {load.normal_force_N:,.5g} N, the torque of this "
            f"file {force:,.5g} N: add {wanted:.3g} to [sharing] loads of {name}."
        )
