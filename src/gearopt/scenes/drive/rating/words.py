"""What factors of a rating are called, their units, and materials in words."""

from gearopt.physics.agma.allowables import CURVES
from gearopt.scenes.drive.rating.tables import GearTable

NAMES = {
    "K_o": "overload",
    "K_v": "dynamic",
    "K_m": "load distribution",
    "K_R": "reliability",
    "K_T": "temperature",
    "C_f": "surface condition",
    "C_p": "elastic coefficient",
    "I": "geometry, pitting",
    "K_B": "rim thickness",
    "K_s": "size",
    "J": "geometry, bending",
    "s_at": "allowable bending stress number",
    "s_ac": "allowable contact stress number",
    "Y_N": "stress cycles, bending",
    "Z_N": "stress cycles, pitting",
    "C_H": "hardness ratio",
}
UNITS = {"s_at": "MPa", "s_ac": "MPa", "C_p": "sqrt_MPa"}  # as suffixes of keys


def material(table: GearTable) -> str:
    """Return a gear's material in words."""
    assert table.treatment
    words = [table.treatment, f"grade {table.grade or 1}"]
    core = " core" if CURVES.get(table.treatment) == "nitrided" else ""
    words += [f"{table.hardness}{core}"] if table.hardness else []
    words += [table.surface_hardness] if table.surface_hardness else []
    return ", ".join(words)
