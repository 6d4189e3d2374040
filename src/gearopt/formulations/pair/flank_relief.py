"""The best tip relief of a pair in slices across its face, by methods that take no derivatives."""

from typing import Any

import numpy as np

from gearopt.formulations.pair.flank import FlankMesh
from gearopt.formulations.pair.relief.meshing import Relief
from gearopt.formulations.pair.relief.parametric import Ranges, reliefs, variables
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Terms
from gearopt.physics.slice_sharing import share_slices


def ranges_of(
    mesh: FlankMesh,
    amounts: tuple[float, float],
    lengths: tuple[float, float] | None,
    exponent: float,
) -> Ranges:
    """Return ranges of amounts [mm] and lengths [base pitches], by default to half the path."""
    path = mesh.sliced.path
    pitch = float(path.base_pitch)
    low, high = lengths or (0.1, 0.5 * float(path.transverse_ratio))
    return Ranges(amounts, (low * pitch, high * pitch), (exponent, exponent))


def peak_to_peak(mesh: FlankMesh, pinion: Relief, wheel: Relief) -> Array:
    """Return the peak-to-peak transmission error (..., l) [mm] at every load.

    reliefs: of numbers, or of arrays (N,) of N designs, which come first.
    """
    apart = mesh.separated((pinion, wheel))[..., None, :, :, :]
    forces = mesh.sliced.force * np.array(mesh.loads)
    shared = share_slices(mesh.springs, apart, forces[:, None])
    return np.asarray(np.ptp(shared.approach, axis=-1))


def problem(mesh: FlankMesh, ranges: Ranges) -> Problem:
    """Pose the least peak-to-peak at the worst load: amount and length [mm] of both gears."""

    def evaluate(x: Any, p: Any) -> Terms:
        errors = peak_to_peak(mesh, *reliefs(x.amount, x.length, ranges))
        return Terms({"peak_to_peak": errors.max(axis=-1)})

    return Problem("relief", variables(ranges), (), evaluate, vectorised=True)
