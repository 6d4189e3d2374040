"""The relief of a spur pair for its report: both flanks, what it does at every load, and rules."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.formulations.pair_contact import Columns, ContactLoad, PairMesh, at_loads, column
from gearopt.formulations.relief.meshing import NO_RELIEF, Relief
from gearopt.formulations.relief.parametric import objective
from gearopt.formulations.relief.rules import short_relief, tip_amounts
from gearopt.physics.geometry.contact import diameters_at


@dataclass(frozen=True, kw_only=True)
class FlankRelief:
    """What is removed from the flanks of one gear: a (1 - x/l)^p at x from the tip.

    amount a: normal to the flank, at the tip; length l: on the line of action; diameter and roll
    angle where it starts, which a grinder needs.
    """

    amount_mm: float
    length_mm: float
    exponent: float
    start_diameter_mm: float
    start_roll_angle_deg: float
    tip_diameter_mm: float
    tip_roll_angle_deg: float


@dataclass(frozen=True, kw_only=True)
class ReliefRow:
    """A relief by rule, or none, beside the one that is designed.

    peak_to_peak_mm, load_jump: at every load the relief is made for. value: of what is minimised.
    """

    name: str
    pinion_amount_mm: float
    wheel_amount_mm: float
    length_mm: float
    exponent: float
    value: float
    peak_to_peak_mm: Columns
    load_jump: Columns


@dataclass(frozen=True, kw_only=True)
class PairRelief:
    """The relief of a spur pair.

    minimise: of the worst of all loads, relative to the torque of the duty. pinion_removed_mm,
    wheel_removed_mm: columns beside those of the path of contact. at: what happens at every load of
    the contact with it. rows: rules beside it, and no relief.
    """

    minimise: str
    loads: Columns
    pinion: FlankRelief
    wheel: FlankRelief
    pinion_removed_mm: Columns
    wheel_removed_mm: Columns
    at: tuple[ContactLoad, ...]
    rows: tuple[ReliefRow, ...]


def described(
    made: PairMesh,
    reliefs: tuple[Relief, Relief],
    minimise: str,
    loads: Sequence[float],
) -> PairRelief:
    """Return the relief of a pair, of floats, and rules beside it; loads: it was made for."""
    mesh = made.mesh
    removed = [
        mesh.cycle.along(relief.removed(x))
        for relief, x in zip(reliefs, mesh.from_tips, strict=True)
    ]
    pinion, wheel = reliefs
    return PairRelief(
        minimise=minimise,
        loads=tuple(loads),
        pinion=_flank(made, 0, pinion),
        wheel=_flank(made, 1, wheel),
        pinion_removed_mm=column(removed[0]),
        wheel_removed_mm=column(removed[1]),
        at=at_loads(made, mesh.separations(pinion, wheel)),
        rows=tuple(
            _row(made, name, both, minimise, loads) for name, both in beside(made, reliefs).items()
        ),
    )


def beside(made: PairMesh, reliefs: tuple[Relief, Relief]) -> dict[str, tuple[Relief, Relief]]:
    """Return reliefs by name: none, those of the paper's rule and of the corrected one, the best.

    The rules are made for the load of the duty.
    """
    path, coupling = made.mesh.cycle.path, made.mesh.coupling
    printed = tip_amounts(path, made.compliance, 0.0, made.force)
    right = tip_amounts(path, made.compliance, coupling, made.force)
    return {
        "none": (NO_RELIEF, NO_RELIEF),
        "paper's rule": short_relief(path, printed),
        "corrected": short_relief(path, right),
        "corrected, linear": short_relief(path, right, 1.0),
        "this": reliefs,
    }


def _flank(made: PairMesh, k: int, relief: Relief) -> FlankRelief:
    """Return the relief of the pinion (k = 0) or the wheel in the words of a drawing."""
    path, member = made.mesh.cycle.path, made.elastic.members[k]
    length = float(relief.length)
    start = path.end - length if k == 0 else path.start + length
    tip = path.end if k == 0 else path.start

    def place(s: Any) -> tuple[float, float]:
        rolled = path.radii_of_curvature(s)[k] / member.base_radius
        return float(diameters_at(made.elastic.pair, path, s)[k]), float(np.degrees(rolled))

    (begin, roll), (end, tip_roll) = place(start), place(tip)
    return FlankRelief(
        amount_mm=float(relief.amount),
        length_mm=length,
        exponent=float(relief.exponent),
        start_diameter_mm=begin,
        start_roll_angle_deg=roll,
        tip_diameter_mm=end,
        tip_roll_angle_deg=tip_roll,
    )


def _row(
    made: PairMesh,
    name: str,
    reliefs: tuple[Relief, Relief],
    minimise: str,
    loads: Sequence[float],
) -> ReliefRow:
    mesh = made.of_loads(loads)
    found = mesh.criteria(mesh.separations(*reliefs))
    pinion, wheel = reliefs
    return ReliefRow(
        name=name,
        pinion_amount_mm=float(pinion.amount),
        wheel_amount_mm=float(wheel.amount),
        length_mm=float(pinion.length) if pinion is not NO_RELIEF else 0.0,
        exponent=float(pinion.exponent),
        value=float(objective(found, minimise)),
        peak_to_peak_mm=column(found.peak_to_peak),
        load_jump=column(found.load_jump),
    )
