"""AGMA 2001 for a gradient solver: the exact law of one regime, without branches.

The tool angles of the critical sections and the load-distribution factor are unknowns: tangencies
are equalities, and the larger of two branches of K_m is an epigraph, exact where K_m costs. The
regime "conventional" takes the load sharing of the mean length of contact; "conventional 2 rising"
and "... falling" the exact one for m_F from 2 to 3, where the least length rises or falls less.
"""

from typing import Any

import numpy as np

from gearopt.formulations.strength.standard import Smooth
from gearopt.physics.agma import factors
from gearopt.physics.agma.batch import safeties
from gearopt.physics.agma.bending import critical_theta, loaded_tooth, seen_from_wheel
from gearopt.physics.agma.mesh import mean_load_sharing, mesh_of
from gearopt.physics.agma.rating_factors import Practice, distribution
from gearopt.physics.agma.smooth import smooth_factors
from gearopt.physics.choosing import choose
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import contact_path
from gearopt.physics.geometry.tooth import base_helix_angle

UNKNOWNS = ("pinion_tool_angle", "wheel_tool_angle", "load_distribution")
REGIMES = {False: ("spur",), True: ("conventional", "low")}  # by whether teeth are helical


def smooth(
    standard: Any, pair: GearPair, torque: Any, speed: Any, regime: str, unknown: dict[str, Any]
) -> Smooth:
    """Return the rating of a pair of casadi scalars or floats in a regime.

    regime: of `mesh.REGIMES`, or a branch of the conventional one, as of `branches`.
    """
    regime, *branch = regime.split()
    angles = unknown[UNKNOWNS[0]], unknown[UNKNOWNS[1]]
    spread = unknown[UNKNOWNS[2]]
    case = standard.case(pair, torque, speed, {"K_m": spread})
    smooth_form = smooth_factors(pair, regime, angles, case.practice.load)
    rows = zip(("pinion_tangency", "wheel_tangency"), smooth_form.tangencies, strict=True)
    limits, gain = {}, 1.0
    if regime == "low":
        limits["overlap_ratio_high"] = pair.overlap_ratio
    if regime == "conventional":
        whole = float(branch[0]) if branch else 1.0
        limits["overlap_ratio_low"] = whole / pair.overlap_ratio
    if branch:
        limits["overlap_ratio_high"] = pair.overlap_ratio / (whole + 1.0)
        gain = _sharing_gain(pair, whole, branch[1])
    return Smooth(
        safeties(case, smooth_form.pitting * gain, tuple(j * gain for j in smooth_form.bending)),
        limits,
        _distributions(case.practice, pair, spread),
        {name: 1.0 + slack for name, slack in rows},
    )


def branches(pair: GearPair, regime: str) -> tuple[str, ...]:
    """Return the branches of the conventional regime near a pair of floats."""
    if regime != "conventional":
        return ()
    near = int(pair.overlap_ratio)
    wholes = [k for k in (near - 1, near, near + 1) if k >= 1]
    return tuple(f"conventional {k} {side}" for k in wholes for side in ("falling", "rising"))


def _sharing_gain(pair: GearPair, whole: float, side: str) -> Any:
    """Return the mean load sharing ratio over that of `mesh.load_sharing` in one of its branches.

    Transverse contact ratios from 1 to 2. Of both branches the one with the larger L_min holds.
    """
    path = contact_path(pair)
    ratio, overlap = path.transverse_ratio, pair.overlap_ratio
    n_r, n_a = ratio - 1.0, overlap - whole
    lost = n_a * n_r if side == "falling" else (1.0 - n_a) * (1.0 - n_r)
    exact = overlap * np.cos(base_helix_angle(pair.pinion)) / (ratio * overlap - lost)
    return mean_load_sharing(pair, path) / exact


def _distributions(practice: Practice, pair: GearPair, spread: Any) -> dict[str, Any]:
    """Return the branches of K_m over the unknown one; see `factors.load_distribution_factor`."""
    width, diameter = pair.face_width, pair.working_diameters[0]
    leads, mounted = 0.8 if practice.crowned else 1.0, 0.8 if practice.adjusted else 1.0
    offset = 1.0 if practice.offset < 0.175 else 1.1
    inches = width / factors.INCH
    middle = -0.0375 + 0.0125 * inches
    drawn = np.minimum(inches, factors.WIDEST / factors.INCH)
    wide = -0.1109 + 0.0207 * drawn - 0.000228 * drawn**2
    found = {}
    for i, slender in enumerate((0.05, 0.1 * width / diameter)):
        for j, piece in enumerate((-0.025, choose(inches <= 17.0, middle, wide))):
            aligned = factors.alignment_factor(width, practice.curve) * mounted
            factor = 1.0 + leads * ((slender + piece) * offset + aligned)
            found[f"load_distribution_{i}{j}"] = factor / spread
    return found


def guess(standard: Any, pair: GearPair, regime: str) -> dict[str, float]:
    """Return the unknowns of a pair of floats in a regime."""
    mesh = mesh_of(pair, regime.split()[0])
    teeth = [loaded_tooth(m, standard.practice.load) for m in (mesh, seen_from_wheel(mesh))]
    angles = [float(critical_theta(tooth)) for tooth in teeth]
    spread = float(distribution(standard.practice, pair.face_width, pair.working_diameters[0]))
    values = (*(1.0 if np.isnan(a) else a for a in angles), spread)
    return dict(zip(UNKNOWNS, values, strict=True))
