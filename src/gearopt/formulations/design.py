"""A drive's design in the words of its drawing: diameters, distances, loads of every stage."""

import math
from typing import Any

from gearopt.formulations.train import Sizes, Train
from gearopt.physics.geometry import centre_distance, gear_volume, reference_diameter
from gearopt.physics.loads import k_factor, unit_load


def describe(train: Train, sizes: Sizes) -> dict[str, Any]:
    """Stages and totals; every quantity with its unit in the key."""
    stages: list[dict[str, Any]] = []
    torque = train.torque
    for m, z, u, b in zip(*sizes, strict=True):
        d = reference_diameter(m, z, train.helix_angle)
        wheel = z * u
        stages.append(
            {
                "normal_module_mm": m,
                "pinion_teeth": _whole(z),
                "wheel_teeth": _whole(wheel),
                "ratio": u,
                "face_width_mm": b,
                "pinion_diameter_mm": d,
                "wheel_diameter_mm": d * u,
                "centre_distance_mm": centre_distance(d, u),
                "pinion_torque_Nm": 1e-3 * torque,
                "k_factor_MPa": k_factor(torque, d, b, u),
                "unit_load_MPa": unit_load(torque, d, b, m),
                "gear_volume_mm3": gear_volume(d, b, u),
            }
        )
        torque *= u
    total = math.prod(sizes[2])
    volume = sum(s["gear_volume_mm3"] for s in stages)
    found = {
        "stages": stages,
        "ratio": total,
        "ratio_error_percent": round(100.0 * (total / float(train.ratio) - 1.0), 9),
        "output_torque_Nm": 1e-3 * torque,
        "gear_volume_mm3": volume,
        "sum_of_centre_distances_mm": sum(s["centre_distance_mm"] for s in stages),
        "total_length_mm": 0.5 * (stages[0]["pinion_diameter_mm"] + stages[-1]["wheel_diameter_mm"])
        + sum(s["centre_distance_mm"] for s in stages),
    }
    if train.density is not None:
        found["mass_kg"] = 1000.0 * train.density * volume
    plain: dict[str, Any] = _floats(found)
    return plain


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
