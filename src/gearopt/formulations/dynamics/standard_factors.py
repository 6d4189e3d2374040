"""K_v of the standards beside the dynamic factors of a pair's motions."""

import math
from typing import Any

import numpy as np

from gearopt.formulations.dynamics.design import StandardFactors
from gearopt.formulations.dynamics.parts import gaps
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.agma import factors as agma
from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336 import load_factors as iso
from gearopt.physics.iso6336.accuracy import beyond, deviations
from gearopt.physics.motion.moving_pair import MovingPair


@dataclass(frozen=True)
class Toothing:
    """The teeth of a moving pair, as far as they are known.

    face_width [mm] and grade of ISO 1328-1, None where not given; contact_ratio at rest, the total
    one; relief C_a [mm]: mean of the tips of both gears.
    """

    gears: GearPair
    contact_ratio: float
    face_width: float | None = None
    grade: int | None = None
    relief: float = 0.0

    def apart(self, distance: float, growth: float) -> float:
        """Return the contact ratio where axes `distance` apart at rest are further apart [mm].

        eps - (Z - Z_0)/p_b: the path of contact loses what the line of action between the base
        circles gains, Z = (C^2 - R^2)^(1/2), whatever the tips are.
        """
        pinion, wheel = self.gears.gears
        radii = 0.5 * (pinion.base_diameter + wheel.base_diameter)
        now, before = (math.sqrt(max(0.0, c**2 - radii**2)) for c in (distance + growth, distance))
        pitch = math.pi * pinion.base_diameter / pinion.teeth
        return float(self.contact_ratio - (now - before) / pitch)


def standard_factors(
    teeth: Toothing, pair: MovingPair, own_rpm: float, speeds_rpm: Any
) -> StandardFactors:
    """Return K_v at the pair's own speed (0: it has none) and at others, or why there is none."""
    missing = [
        f"[mesh] {name}"
        for name, value in (("face_width", teeth.face_width), ("accuracy_grade", teeth.grade))
        if value is None
    ]
    if missing:
        why = f"{' and '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing"
        return StandardFactors(missing=f"K_v of ISO 6336 and AGMA is not told: {why}.")
    speeds = np.append(np.asarray(speeds_rpm, float), [own_rpm] if own_rpm > 0.0 else [])
    both, reasons = [], list[str]()
    for law in (_of_iso, _of_agma):
        values = law(teeth, pair, math.pi / 30.0 * speeds)
        reasons += [values] if isinstance(values, str) else []
        both.append(() if isinstance(values, str) else gaps(values, 6))
    count = len(speeds_rpm)
    (own_iso, iso_at), (own_agma, agma_at) = (
        (next(iter(values[count:]), None), values[:count]) for values in both
    )
    return StandardFactors(
        own_iso=own_iso, own_agma=own_agma, iso=iso_at, agma=agma_at, missing=" ".join(reasons)
    )


def _of_iso(teeth: Toothing, pair: MovingPair, speeds: Array) -> Array | str:
    """Return K_v of ISO 6336-1, method B, at speeds of the pinion [rad/s], with K_A = 1.

    The resonance ratio by the mean stiffness and the mesh mass of the moving pair, c' by
    c_gamma = c' (0.75 eps_alpha + 0.25); of helical gears by the total contact ratio. Deviations
    are not run in.
    """
    width, grade, gears = teeth.face_width, teeth.grade, teeth.gears
    assert width is not None and grade is not None
    if outside := beyond(gears, (grade, grade)):
        return f"K_v of ISO 6336 is not told: {', '.join(outside)} beyond ISO 1328-1."
    line = pair.pinion.torque / (0.5 * gears.pinion.reference_diameter) / width
    stiffness, mass = pair.wave.mean / width, pair.mesh_mass / width
    single = stiffness / (0.75 * (teeth.contact_ratio - float(gears.overlap_ratio)) + 0.25)
    off = deviations(gears, (grade, grade))
    relative = iso.Dynamics(
        single * off.base_pitch / line,
        single * off.profile_form / line,
        abs(1.0 - single * teeth.relief / line),
        teeth.contact_ratio,
    )
    resonance = iso.resonance_speed(gears.pinion_teeth, stiffness, mass)
    return np.asarray(iso.dynamic_factor(relative, speeds / resonance, line))


def _of_agma(teeth: Toothing, pair: MovingPair, speeds: Array) -> Array | str:
    """Return K_v of AGMA 2001-D04 at speeds of the pinion [rad/s]; NaN beyond its curve."""
    try:
        quality = agma.quality_of_accuracy(float(teeth.grade or 0))
    except ValueError as wrong:
        return f"K_v of AGMA is not told: {wrong}."
    pace = speeds * 0.5 * teeth.gears.pinion.reference_diameter
    most = float(agma.highest_speed(quality))
    if np.all(pace > most):
        return f"K_v of AGMA is not told: its curve ends at {1e-3 * most:.3g} m/s."
    return np.where(pace <= most, agma.dynamic_factor(pace, quality), math.nan)
