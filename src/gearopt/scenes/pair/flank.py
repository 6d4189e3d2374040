"""Contact over the flank of a pair of a file: helical gears, or a table [flank]."""

import math
from dataclasses import replace

from gearopt.errors import SolveError
from gearopt.formulations.pair.contact import column, compliance_of, teeth_columns
from gearopt.formulations.pair.flank import FlankMesh, Modifications, flank_loads
from gearopt.formulations.pair.flank_design import FlankContact
from gearopt.formulations.pair.flank_relief import problem, ranges_of
from gearopt.formulations.pair.relief.meshing import Relief
from gearopt.formulations.pair.relief.parametric import Ranges
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.physics.contact_lines import length_range, mean_length
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import diameters_at, usable_path
from gearopt.physics.geometry.tooth import base_helix_angle
from gearopt.physics.mesh_cycle import NARROW
from gearopt.physics.tooth.ladder import USUAL
from gearopt.physics.tooth.slices import Sliced
from gearopt.scenes.pair.contact import (
    Materials,
    check_length,
    coupling_name,
    doubts_of,
    models_of,
    stiffnesses_by_iso,
    teeth_of,
    yielding,
)
from gearopt.scenes.pair.flank_tables import ALONG, FlankTable
from gearopt.scenes.pair.relief import keyed, loads_of, searched
from gearopt.scenes.pair.scene import Scene
from gearopt.scenes.reading.ask import Ask
from gearopt.units import Quantity

IN_SLICES = (
    "not proven: of the transmission error of contact by slices across the face there is no bound"
)


def in_slices(scene: Scene, pair: GearPair) -> bool:
    """Return whether the contact of a pair of a file is computed by slices across the face."""
    return scene.flank is not None or float(pair.pinion.helix_angle) != 0.0


def flank_mesh_of(
    scene: Scene, pair: GearPair, materials: Materials = ("", ""), seconds: float | None = None
) -> tuple[FlankMesh, str]:
    """Return a pair of a file in slices without relief, and the level of its teeth.

    Errors as of `teeth_of`.
    """
    table = scene.flank or FlankTable()
    path = usable_path(pair)
    check_length(scene, float(path.transverse_ratio))
    torque = scene.duty.input_torque
    force = float(torque / (0.5 * pair.pinion.base_diameter))
    try:
        teeth = teeth_of(scene, pair, materials, seconds)
        compliance = compliance_of(teeth.elastic, teeth.level, force)
        given = isinstance(scene.sharing.coupling, Quantity)
        inclined = 1.0 if given else math.cos(base_helix_angle(pair.pinion))
        coupling = teeth.coupling / inclined
        sliced = Sliced(pair, path, teeth.elastic, compliance, force, coupling)
        modifications = Modifications(*(table.millimetres(name) for name in ALONG))
        mesh = FlankMesh.of(
            sliced,
            table.slices,
            scene.sharing.positions,
            teeth.loads,
            modifications,
        )
        least = float(mesh.compliances.structure.min())
    except ImportError as reason:  # of finite elements, an extra
        raise SolveError(str(reason)) from None
    if least <= 0.0:
        other = "" if teeth.level == USUAL else f'level = "{USUAL}", or '
        raise SolveError(
            f'[sharing] level = "{teeth.level}" makes teeth stiffer than their contact and '
            "coupling alone, so that slices have nothing to hold each other by: write "
            f'{other}coupling = "none"'
        )
    return mesh, teeth.level


def flank_contact_of(
    scene: Scene, mesh: FlankMesh, level: str, materials: Materials
) -> FlankContact:
    """Return the contact over the flank of a pair of a file, with the reliefs of its mesh."""
    sliced, face = mesh.sliced, mesh.face
    pair, path, elastic = sliced.pair, sliced.path, sliced.normal
    coupling = coupling_name(models_of(scene, elastic)[1])
    iso = stiffnesses_by_iso(scene, pair, elastic, materials)
    loads = flank_loads(mesh)
    beyond = doubts_of(scene, pair, elastic, level, materials)
    most = max(load.largest_contact_stress_MPa for load in loads)
    held = [float(relief.amount) for relief in mesh.reliefs]
    long = [float(relief.length) if relief.amount else 0.0 for relief in mesh.reliefs]
    first, second = (
        float(bore * gear.root_diameter / virtual.root_diameter)
        for bore, virtual, gear in zip(elastic.bores, elastic.pair.gears, pair.gears, strict=True)
    )
    teeth = teeth_columns(level, elastic, path, (coupling, sliced.coupling), iso)
    return FlankContact(
        **(teeth | {"pinion_bore_mm": first, "wheel_bore_mm": second}),
        slices=face.count,
        crowning_mm=mesh.modifications.crowning,
        helix_correction_mm=mesh.modifications.helix_correction,
        misalignment_mm=mesh.modifications.misalignment,
        relief_mm=(held[0], held[1]),
        relief_length_mm=(long[0], long[1]),
        relief_diameters_mm=(
            float(diameters_at(pair, path, path.end - long[0])[0]),
            float(diameters_at(pair, path, path.start + long[1])[1]),
        ),
        base_helix_angle_deg=math.degrees(math.atan(face.slope)),
        face_width_mm=face.width,
        overlap_ratio=float(pair.overlap_ratio),
        contact_lines_mm=_lengths(pair, float(path.transverse_ratio), mean_length(pair, path)),
        path_mm=column(mesh.path_columns),
        place_mm=column(face.places),
        travel_mm=column(mesh.cycle.travels * path.base_pitch),
        unloaded_error_mm=column(mesh.separated(mesh.reliefs).min(axis=(-2, -1))),
        loads=loads,
        validity=(*beyond, *yielding(most)),
    )


def _lengths(pair: GearPair, ratio: float, mean: float) -> tuple[float, float, float]:
    """Return least, mean and largest length [mm] of the contact lines, by closed form."""
    overlap = float(pair.overlap_ratio)
    if overlap == 0.0:
        whole = int(ratio + NARROW)
        most = whole if ratio - whole < NARROW else whole + 1
        return whole * float(pair.face_width), mean, most * float(pair.face_width)
    low, high = length_range(ratio, overlap)
    return low * mean, mean, high * mean


def relieved_flank(
    scene: Scene, mesh: FlankMesh, ask: Ask
) -> tuple[Result, tuple[Relief, Relief] | None]:
    """Return the result of the search for the tip relief of a pair in slices, and the reliefs."""
    posed, ranges = flank_problem(scene, mesh)
    assert scene.relief
    return searched(scene.relief, posed, ranges, ask, IN_SLICES)


def flank_problem(scene: Scene, mesh: FlankMesh) -> tuple[Problem, Ranges]:
    """Return the problem of the relief of a pair in slices, and its ranges."""
    asked = scene.relief
    assert asked
    low, high = (end.value for end in asked.amount)
    lengths = None if asked.length is None else (float(asked.length[0]), float(asked.length[1]))
    ranges = ranges_of(mesh, (low, high), lengths, asked.exponent)
    unkeyed = problem(replace(mesh, loads=loads_of(scene)), ranges)
    return replace(unkeyed, variables=keyed(unkeyed)), ranges
