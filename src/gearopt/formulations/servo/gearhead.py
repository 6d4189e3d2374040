"""A planetary stage that is given as the gearhead of a servo axis, seen at motor and load."""

import math
from typing import Any

from gearopt.formulations.servo.servo_design import KG_M2, GearheadDesign, Spring, StiffnessDesign
from gearopt.physics.planetary.gearhead import (
    Gearset,
    compliances,
    inertias,
    lost_motion,
    planet_play,
)
from gearopt.physics.planetary.willis import ENDS
from gearopt.physics.stiffness import locked_frequency

SPRINGS = ("meshes of sun and planets", "meshes of planets and ring", "pins of the planets")


def lost_motions(
    thick: Gearset, thin: Gearset, outwards: tuple[float, float], position: float, clearance: float
) -> dict[str, float]:
    """Least and largest angle of the output between both flanks, as a design has them.

    With the thickest teeth one planet has the least play, and two pins are off along their circle
    to opposite sides; with the thinnest all planets have the largest. Arguments in mm.
    """
    least = min(float(planet_play(thick, out)) for out in outwards)
    most = max(float(planet_play(thin, out)) for out in outwards)
    apart = 2.0 * position if thick.planets > 1 else 0.0
    ends = lost_motion(thick, least, apart=apart), lost_motion(thin, most, clearance)
    names = "least_lost_motion_deg", "lost_motion_deg"
    return {name: math.degrees(end) for name, end in zip(names, ends, strict=True)}


def stiffness_of(
    gears: Gearset, torque: float | None, pin: float, load_inertia: float
) -> StiffnessDesign:
    """Stiffness at the output, motor locked; torque there [N mm], pin [N/mm], inertia [t mm2]."""
    parts = [float(c) for c in compliances(gears, torque, pin)]
    total, rows = math.fsum(parts), zip(SPRINGS, parts, strict=True)
    return StiffnessDesign(
        output_Nm_per_rad=1e-3 / total,
        springs=tuple(Spring(name, c / total, 1e-3 / c) for name, c in rows if c),
        frequency_Hz=float(locked_frequency(1.0 / total, load_inertia)),
        windup_deg=None if torque is None else math.degrees(torque * total),
    )


def described(
    gears: Gearset, friction: float | None, *bodies: Any, **lost: float
) -> GearheadDesign:
    """The stage as a result has it; bodies: as of `inertias`; lost: of `lost_motions`."""
    mass, parts = inertias(gears, *bodies)
    flow, lossy = gears.flow(friction or 0.0), friction is not None
    return GearheadDesign(
        planets=gears.planets,
        teeth=f"{gears.sun.teeth:.0f}, {gears.planet.teeth:.0f}, {-gears.ring.teeth:.0f}",
        ratio=float(1 / abs(flow.speeds[ENDS[gears.held][1]])),
        centre_distance_mm=float(gears.distance),
        ring_outside_diameter_mm=float(-gears.ring.outside),
        mass_kg=1e3 * float(mass),
        inertia_kg_m2=KG_M2 * float(sum(parts.values())),
        planets_inertia_kg_m2=KG_M2 * float(parts["planets"]),
        efficiency=float(flow.efficiency) if lossy else None,
        rolling_power=max(float(m.rolling) for m in flow.meshes) if lossy else None,
        **lost,
    )
