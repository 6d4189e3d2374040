"""A drive's design in the words of its drawing: diameters, distances, loads of every stage."""

import math
from typing import Any

from gearopt.formulations.train import Train
from gearopt.physics.gears import GearPair
from gearopt.physics.loads import k_factor, pitch_line_velocity, unit_load

STEEL_DENSITY = 7.85e-9  # t/mm3: EN 1991-1-1 table A.4 (to 78.5 kN/m3), Steel for Life Blue Book


def describe(train: Train, pairs: tuple[GearPair, ...], input_speed: float) -> dict[str, Any]:
    """Return stages and totals; every quantity with its unit in the key.

    input_speed [rad/s]. Masses are those of solid reference cylinders, of steel where the train
    has no density.
    """
    stages: list[dict[str, Any]] = []
    torque, speed = train.torque, input_speed
    density = train.density or STEEL_DENSITY
    for pair in pairs:
        pinion, wheel = pair.gears
        d, b, u = pinion.reference_diameter, pair.face_width, pair.ratio
        masses = [1000.0 * gear.mass(density) for gear in pair.gears]
        stages.append(
            {
                "normal_module_mm": pair.normal_module,
                "pinion_teeth": _whole(pair.pinion_teeth),
                "wheel_teeth": _whole(pair.wheel_teeth),
                "ratio": u,
                "face_width_mm": b,
                "pinion_diameter_mm": d,
                "wheel_diameter_mm": wheel.reference_diameter,
                "pinion_tip_diameter_mm": pinion.tip_diameter,
                "wheel_tip_diameter_mm": wheel.tip_diameter,
                "pinion_root_diameter_mm": pinion.root_diameter,
                "wheel_root_diameter_mm": wheel.root_diameter,
                "centre_distance_mm": pair.centre_distance,
                "transverse_contact_ratio": pair.transverse_contact_ratio,
                "overlap_ratio": pair.overlap_ratio,
                "pinion_torque_Nm": 1e-3 * torque,
                "pitch_line_velocity_m_per_s": 1e-3 * pitch_line_velocity(speed, d),
                "k_factor_MPa": k_factor(torque, d, b, u),
                "unit_load_MPa": unit_load(torque, d, b, pair.normal_module),
                "gear_volume_mm3": pair.volume,
                "pinion_mass_kg": masses[0],
                "wheel_mass_kg": masses[1],
                "mass_kg": sum(masses),
            }
        )
        torque, speed = torque * u, speed / u
    plain: dict[str, Any] = _floats({"stages": stages} | _totals(train, stages, torque, density))
    return plain


def _totals(
    train: Train, stages: list[dict[str, Any]], torque: Any, density: float
) -> dict[str, Any]:
    """Of the whole drive; torque [N mm] is that of its output, density in t/mm3."""
    ratio = math.prod(s["ratio"] for s in stages)
    volume = sum(s["gear_volume_mm3"] for s in stages)
    centres = sum(s["centre_distance_mm"] for s in stages)
    ends = stages[0]["pinion_diameter_mm"] + stages[-1]["wheel_diameter_mm"]
    return {
        "ratio": ratio,
        "ratio_error_percent": round(100.0 * (ratio / float(train.ratio) - 1.0), 9),
        "output_torque_Nm": 1e-3 * torque,
        "gear_volume_mm3": volume,
        "sum_of_centre_distances_mm": centres,
        "total_length_mm": 0.5 * ends + centres,
        "mass_kg": 1000.0 * density * volume,
    }


def _whole(teeth: float) -> float | int:
    """A tooth number as an integer where it is one."""
    return round(teeth) if abs(teeth - round(teeth)) < 1e-9 else float(teeth)


def _floats(found: Any) -> Any:
    """Numpy scalars to plain numbers."""
    if isinstance(found, dict):
        return {k: _floats(v) for k, v in found.items()}
    if isinstance(found, list):
        return [_floats(v) for v in found]
    return found if isinstance(found, int) else float(found)
