"""The material of a gear by ISO 6336-5, from its table."""

from gearopt.physics.agma.allowables import MODULI
from gearopt.physics.iso6336.materials import SURFACE_HARDENED, Material
from gearopt.scenes.drive.tables.rating import GearTable

OF_TREATMENT = {  # treatment of AGMA: the nearest material of ISO 6336-5
    "through-hardened": "V alloy",
    "carburised": "Eh",
    "induction, roots": "IF",
    "induction, flanks": "IF",
    "nitrided": "NV",
    "nitralloy": "NT",
    "2.5 % chrome": "NT",
    **{iron: "GG" if "A48" in iron else "GGG" for iron in MODULI},
    "ASTM A536 60-40-18": "GGG ferritic",
}
SOFT_ROOTS = "induction, flanks"  # IF of table 1 is hardened at the roots, too (memory)
RZ = 6.0  # R_z over R_a. Source: ISO 6336-2:2006, 12.3.1.3.1: R_a = R_z/6


def steel(table: GearTable) -> Material:
    """Return the material of a gear."""
    usual = Material()
    name = table.iso_material or OF_TREATMENT[table.treatment or "carburised"]
    soft = name not in SURFACE_HARDENED
    hardness = table.flank_hardness or (table.hardness if soft else None)
    return Material(
        name,
        table.iso_quality or usual.quality,
        hardness.value if hardness else 0.0,
        table.iso_core or usual.core,
        yield_strength=table.yield_strength.value if table.yield_strength else 0.0,
        modulus=table.modulus or usual.modulus,
        poisson=usual.poisson if table.poisson_ratio is None else float(table.poisson_ratio),
        flank=_flank(table, usual),
        root=table.root_rz.value if table.root_rz else usual.root,
        reversed_load=bool(table.reversed_load),
        limits=(
            table.sigma_Hlim.value if table.sigma_Hlim else 0.0,
            table.sigma_Flim.value if table.sigma_Flim else 0.0,
        ),
    )


def _flank(table: GearTable, usual: Material) -> float:
    """Return R_z of the flanks [mm]."""
    if table.flank_rz is not None:
        return table.flank_rz.value
    return RZ * table.roughness.value if table.roughness else usual.flank


def finish(table: GearTable) -> float:
    """Return the roughness R_a of the flanks [mm]."""
    return _flank(table, Material()) / RZ


def material(table: GearTable) -> str:
    """Return a gear's material in words."""
    kind = steel(table)
    hardness = table.flank_hardness or (table.hardness if kind.hardness else None)
    words = [kind.name, kind.quality, *([str(hardness)] if hardness else [])]
    words = [table.steel, *words] if table.steel else words
    words += [f"core {table.iso_core}"] if table.iso_core and kind.by_core else []
    words += [f"grade {table.accuracy_grade}"] if table.accuracy_grade is not None else []
    return ", ".join(words)
