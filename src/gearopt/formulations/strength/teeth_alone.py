"""Quantities of ratings that follow from the teeth alone, of any size: laws for cells of teeth."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.physics.agma.bending import (
    bending_factor,
    critical_theta,
    loaded_tooth,
    seen_from_wheel,
)
from gearopt.physics.agma.mesh import (
    lowest_curvatures,
    mean_curvatures,
    mesh_of,
    normal_base_pitch,
    pitting_factor,
)
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import contact_path
from gearopt.physics.iso6336 import contact_factors, stiffness
from gearopt.physics.iso6336.tooth_form import tooth_forms

GEARS = (0, 1)
Law = Callable[[GearPair], dict[str, Any]]


def agma_teeth(load: str, regimes: tuple[str, ...]) -> Law:
    """Law of the quantities that follow from the teeth alone, for `Cells.teeth_alone`.

    By regime I (1 + 1/u), J_1 and J_2 with m_N = C_psi = 1; slope: (1 - C_psi^2)/m_F below m_F = 1.
    """

    def law(pair: GearPair) -> dict[str, Any]:
        grown = 1.0 + 1.0 / pair.ratio
        working = pair.working_diameters[0] / pair.pinion.reference_diameter
        path = contact_path(pair)
        found = {"contact": path.transverse_ratio, "working": working}
        for regime in regimes:
            mesh = replace(mesh_of(pair, regime), sharing=1.0, overlap_factor=1.0)
            found[f"{regime}0"] = pitting_factor(mesh) * grown
            for k, one in enumerate((mesh, seen_from_wheel(mesh)), 1):
                tooth = loaded_tooth(one, load)
                found[f"{regime}{k}"] = bending_factor(tooth, critical_theta(tooth)).value
        if "low" in regimes:
            pairs = lowest_curvatures(path), mean_curvatures(pair, path)
            (low1, low2), (mean1, mean2) = pairs
            grown = mean1 * mean2 * path.length / (low1 * low2 * normal_base_pitch(pair))
            found["slope"] = 1.0 - grown
        return found

    return law


def iso_teeth(shift: str) -> Law:
    """Law of the quantities that follow from the teeth alone, for `Cells.teeth_alone`."""

    def law(pair: GearPair) -> dict[str, Any]:
        path = contact_path(pair)
        ratio = path.transverse_ratio
        forms = tooth_forms(pair, ratio, shift)
        singles = contact_factors.single_contact_ratios(pair, ratio)
        found = {
            "contact": ratio,
            "virtual": forms[0].virtual_ratio,
            "stiffness": stiffness.single_stiffness(pair, np.inf),
            "zone": contact_factors.zone_factor(pair),
            "shorter": pair.pinion.tip_alteration,
        }
        for k in GEARS:
            found |= {
                f"form{k}": forms[k].form,
                f"concentration{k}": forms[k].concentration,
                f"notch{k}": forms[k].notch,
                f"single{k}": np.where(np.isfinite(singles[k]), singles[k], 1.0),
            }
        return found

    return law
