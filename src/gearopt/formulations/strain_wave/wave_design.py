"""Least contact pressure of a strain wave gearing that interferes nowhere: one smooth program.

Unknown are six numbers of the gearing, the change that keeps the neutral curve's length, the polar
angles of COUNT contacts from root to tip, and the pressure. That no pose of the wave interferes is
one limit for every pose: `exchange` solves with few of them, looks at all poses, and adds those at
which teeth cut each other, until none does.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.demand import (
    FREE,
    PRESSURE,
    VOLUME,
    Demand,
    clear,
    free_variables,
    limits,
    smooth_maximum,
    squares,
)
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var
from gearopt.physics.strain_wave.clearance import corner, involute_gap, thickness_at
from gearopt.physics.strain_wave.conjugate import Contact, angle_at, contact, tangents
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import (
    curve_of,
    neutral_curve,
    perimeter_error,
)
from gearopt.physics.strain_wave.tooth_motion import Motion, motion

NO_LIMITS: Mapping[str, float] = MappingProxyType({})
COUNT = 7  # contacts from root to tip, evenly by the tangent of the pressure angle
CORNER = -1  # of a cut: the circular spline's corner against the flank, instead of a flank point
CHANGE_UNIT = 1e-2  # mm, of the change of the neutral curve
PRESSURES = (1.0, 1e4)  # MPa: ends of the search
REACH = (-0.3, 0.6)  # rad: polar angles at which contacts are looked for


@dataclass(frozen=True, order=True)
class Cut:
    """A pose p [rad] at which a point of the flank, 0 to COUNT - 1, or CORNER must keep clear."""

    angle: float
    point: int


def problem(
    demand: Demand,
    start: Any,
    cuts: Sequence[Cut] = (),
    minimise: str = PRESSURE,
    most: Mapping[str, float] = NO_LIMITS,
) -> Problem:
    """Pose the least pressure [MPa] by equal sharing, from the free numbers `start` (6,).

    minimise: PRESSURE, or VOLUME per torque [mm3/(N m)]; most: largest values of these.
    """

    def evaluate(x: Any, p: Any) -> Terms:
        gearing = demand.gearing({name: getattr(x, name) for name in FREE})
        curve = curve_of(gearing, x.change * CHANGE_UNIT)
        at = [contact(gearing, motion(gearing, curve, angle + 0.0)) for angle in x.contact]
        first, last = tangents(gearing)
        shares = np.linspace(0.0, 1.0, COUNT)
        miss = tuple(
            1.0 + (c.tangent - first - (last - first) * float(share))
            for c, share in zip(at, shares, strict=True)
        )
        found = limits(demand, gearing, curve, at)
        if cuts:
            poses: dict[float, Motion] = {}
            for cut in cuts:
                if cut.angle not in poses:
                    poses[cut.angle] = motion(gearing, curve, cut.angle)
            rooms = [room(gearing, poses[cut.angle], at, cut.point) for cut in cuts]
            found["interference"] = tuple(clear(r) for r in rooms)
        pressure = tuple(s / x.pressure**2 for s in squares(demand, gearing, at))
        goals = {PRESSURE: x.pressure, VOLUME: demand.specific_volume(gearing)}
        found |= {f"most_{name}": goals[name] / value for name, value in most.items()}
        return Terms(
            {minimise: goals[minimise]},
            found,
            {"contact": pressure},
            {"meshing": miss, "length": 1.0 + 100.0 * perimeter_error(curve)},
        )

    return Problem("strain wave gearing", variables(demand, start), (), evaluate)


def room(gearing: StrainWave, at: Motion, contacts: Sequence[Contact], point: int) -> Any:
    """Return the clearance [mm] of a flank point or the corner at a pose, smoothed.

    A point is clear inside the space or before it has passed the tip circle; the corner, of the
    flank or beyond its ends.
    """
    if point != CORNER:
        gap, radius = involute_gap(gearing, at.placed(contacts[point].point))
        return smooth_maximum(gap, gearing.tip_radius - radius)
    nodes = tuple(c.point for c in contacts)
    seen = at.of_tooth(corner(gearing))
    beside = smooth_maximum(nodes[0].x - seen.x, seen.x - nodes[-1].x)
    within = np.minimum(np.maximum(seen.x, nodes[0].x), nodes[-1].x)
    return smooth_maximum(seen.y - thickness_at(nodes, within), beside)


def variables(demand: Demand, start: Any) -> tuple[Var, ...]:
    """Return the variables, with a guess made exactly from the free numbers of `start`."""
    free = free_variables(demand, start)
    gearing = demand.gearing({v.name: v.guess for v in free})
    curve = neutral_curve(gearing)
    change = float(gearing.radial_deflection - curve.second) / CHANGE_UNIT
    if demand.wave == "ellipse":
        change = float(curve.second - curve.radius + gearing.radial_deflection) / CHANGE_UNIT
    first, last = tangents(gearing)
    angles = angle_at(gearing, curve, np.linspace(first, last, COUNT))
    angles = np.where(np.isfinite(angles), angles, 0.03)
    at = [contact(gearing, motion(gearing, curve, p)) for p in angles]
    highest = np.nanmax(squares(demand, gearing, at), initial=1.0) ** 0.5
    return (
        *free,
        Var("change", "0.01 mm", -1e3, 1e3, change, search=True),
        Var("contact", "rad", *REACH, tuple(np.clip(angles, *REACH)), COUNT, search=True),
        Var("pressure", "MPa", *PRESSURES, float(np.clip(highest, *PRESSURES)), search=True),
    )
