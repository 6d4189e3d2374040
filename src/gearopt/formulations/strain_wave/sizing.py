"""Least contact pressure of a strain wave gearing that interferes nowhere: one smooth program.

Unknown are six numbers of the gearing, the change that keeps the neutral curve's length, the polar
angles of COUNT contacts from root to tip, and the pressure. Teeth cut each other where a point of
the flank passes the tip circle of the circular spline on the wrong side of its corner. The pose of
such a passage is one more unknown, held by an equation, so that the limit follows it as the design
changes; `exchange` adds the passages that matter.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import field
from types import MappingProxyType
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.demand import (
    FREE,
    GAP_UNIT,
    LEAST_GAP,
    PRESSURE,
    VOLUME,
    Demand,
    free_variables,
    limits,
    squares,
)
from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var
from gearopt.physics.strain_wave.clearance import corner, least_gaps
from gearopt.physics.strain_wave.conjugate import Contact, angle_at, contact, flank, tangents
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import (
    curve_of,
    neutral_curve,
    perimeter_error,
)
from gearopt.physics.strain_wave.tooth_motion import motion
from gearopt.physics.strain_wave.vectors import Vector

NO_LIMITS: Mapping[str, float] = MappingProxyType({})
COUNT = 7  # contacts from root to tip, evenly by the tangent of the pressure angle
CHANGE_UNIT = 1e-2  # mm, of the change of the neutral curve
PRESSURES = (1.0, 1e4)  # MPa: ends of the search
FIRST_DEG = 1.0  # of the wave, at which the first design's passage is looked for
REACH = (-0.3, 0.6)  # rad: polar angles at which contacts are looked for
PASSING = (1e-3, 0.5 * math.pi)  # rad: polar angles of passages, on the side that teeth leave


@dataclass(frozen=True, order=True)
class Passage:
    """A point of the flank, 0 to COUNT - 1, passes the tip circle as its tooth leaves, or enters.

    leaves: at positive polar angles. angle [rad]: about where, the guess.
    """

    point: int
    leaves: bool
    angle: float = field(compare=False)


def problem(
    demand: Demand,
    start: Any,
    passages: Sequence[Passage] = (),
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
        rows = limits(demand, gearing, curve, at)
        passing = [
            motion(gearing, curve, getattr(x, name) + 0.0).placed(at[passage.point].point)
            for name, passage in zip(_names(passages), passages, strict=True)
        ]
        if passages:
            rows["interference"] = tuple(_cut(gearing, place) for place in passing)
        pressure = tuple(s / x.pressure**2 for s in squares(demand, gearing, at))
        goals = {PRESSURE: x.pressure, VOLUME: demand.specific_volume(gearing)}
        rows |= {f"most_{name}": goals[name] / value for name, value in most.items()}
        return Terms(
            {minimise: goals[minimise]},
            rows,
            {"contact": pressure},
            {
                "meshing": _missed(gearing, at),
                "length": 1.0 + 100.0 * perimeter_error(curve),
                "passing": tuple(1.0 + (z.length - gearing.tip_radius) / GAP_UNIT for z in passing),
            },
        )

    unknown = (*variables(demand, start), *_angles(passages))
    return Problem("strain wave gearing", unknown, (), evaluate)


def _missed(gearing: StrainWave, contacts: Sequence[Contact]) -> tuple[Any, ...]:
    """Return 1 for contacts that lie evenly by t between the flank's ends."""
    first, last = tangents(gearing)
    wanted = (first + (last - first) * float(s) for s in np.linspace(0.0, 1.0, len(contacts)))
    return tuple(1.0 + (c.tangent - t) for c, t in zip(contacts, wanted, strict=True))


def _cut(gearing: StrainWave, place: Vector) -> Any:
    """Return the limit on a point that passes the tip circle at a place, beside the corner [mm]."""
    room = gearing.base_radius * (corner(gearing).angle - place.angle)
    return 1.0 + (LEAST_GAP - room) / GAP_UNIT


@np.errstate(all="ignore")  # of a start without a flank
def tip_leaves(demand: Demand, start: Any) -> tuple[Passage, ...]:
    """Return where the flank's tip passes the tip circle as its tooth leaves, in the first design.

    There teeth come nearest but for their contact; of a start without a flank it is a guess.
    """
    meshing = flank(demand.gearing(dict(zip(FREE, map(float, start), strict=True))))
    known = least_gaps(meshing, FIRST_DEG, 2) if meshing.complete.all() else []
    angles = [one.angle for one in known if one.passing and one.point == 1.0 and one.angle > 0.0]
    return (Passage(COUNT - 1, True, angles[0] if angles else 1.0),)


def _names(passages: Sequence[Passage]) -> list[str]:
    return [f"passage_{k}" for k, _ in enumerate(passages, 1)]


def _angles(passages: Sequence[Passage]) -> list[Var]:
    """Return the polar angles of the passages."""
    angles = []
    for name, passage in zip(_names(passages), passages, strict=True):
        low, high = PASSING if passage.leaves else (-PASSING[1], -PASSING[0])
        guess = min(max(passage.angle, low), high)
        angles.append(Var(name, "rad", low, high, guess, search=True))
    return angles


@np.errstate(all="ignore")  # of a start without a flank
def variables(demand: Demand, start: Any) -> tuple[Var, ...]:
    """Return the variables, with a guess made exactly from the free numbers of `start`."""
    free = free_variables(demand, start)
    gearing = demand.gearing({v.name: v.guess for v in free})
    curve = neutral_curve(gearing)
    change = float(gearing.radial_deflection - curve.second) / CHANGE_UNIT
    if demand.wave == "ellipse":
        change = float(curve.second - curve.radius + gearing.radial_deflection) / CHANGE_UNIT
    reach = max(1e3, 2.0 * abs(change))
    first, last = tangents(gearing)
    angles = angle_at(gearing, curve, np.linspace(first, last, COUNT))
    angles = np.where(np.isfinite(angles), angles, 0.03)
    at = [contact(gearing, motion(gearing, curve, p)) for p in angles]
    highest = np.nan_to_num(squares(demand, gearing, at)).max() ** 0.5
    return (
        *free,
        Var("change", "0.01 mm", -reach, reach, change, search=True),
        Var("contact", "rad", *REACH, tuple(np.clip(angles, *REACH)), COUNT, search=True),
        Var("pressure", "MPa", *PRESSURES, float(np.clip(highest, *PRESSURES)), search=True),
    )
