"""Load sharing and the geometry factor for pitting, I, by AGMA 908-B89.

Arguments are pairs of floats, arrays of one shape or casadi scalars. A mesh belongs to a regime:
"spur"; "low" for helical gears of an overlap ratio m_F of at most 1 (low axial contact ratio,
LACR), which 908 treats like spur gears with a correction; "conventional" above. I is continuous
from one to the next, J jumps at m_F = 1: there the load moves from the highest point of single
tooth contact to the tip.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.choosing import choose
from gearopt.physics.gears import Gear, GearPair
from gearopt.physics.geometry.contact import ContactPath, contact_path
from gearopt.physics.geometry.tooth import base_helix_angle
from gearopt.physics.iso6336.tooth_form import virtual_rack

REGIMES = ("spur", "low", "conventional")


@dataclass(frozen=True)
class Mesh:
    """A pair as 908 takes it: its path of contact, overlap and load sharing.

    overlap m_F; sharing: load sharing ratio m_N; overlap_factor: helical overlap factor C_psi,
    squared; conventional: whether m_F > 1, or None where the regime is given by name.
    """

    pair: GearPair
    path: ContactPath
    overlap: Any
    sharing: Any
    overlap_factor: Any
    regime: str | None

    def chosen(self, conventional: Any, low: Any, spur: Any = None) -> Any:
        """Return the value of the pair's regime; spur: where it is not that of low overlap."""
        if self.regime is not None:
            values = (low if spur is None else spur, low, conventional)
            return dict(zip(REGIMES, values, strict=True))[self.regime]
        return choose(self.overlap > 1.0, conventional, low)


@np.errstate(invalid="ignore", divide="ignore")
def mesh_of(pair: GearPair, regime: str | None = None, smooth: bool = False) -> Mesh:
    """Return the mesh of a pair; regime: one of REGIMES, if it is known, so that nothing branches.

    smooth: with `mean_load_sharing`, whose derivative is continuous, for `load_sharing`.

    m_N = 1 for spur gears and for m_F <= 1, else F/L_min (`shortest_lines`). C_psi^2 = 1 - m_F
    (1 - rho_m1 rho_m2 Z/(rho_1 rho_2 p_N)) for m_F <= 1, else 1; rho_m at the mean of the working
    flank, rho at the lowest point of single tooth contact (`curvatures`).
    Source: AGMA 908-B89, clause 4 [unverified], as a public program of AGMA 2101-D04 has it.
    """
    if regime not in (None, *REGIMES):
        raise ValueError(f"no regime {regime!r}; known: {', '.join(REGIMES)}")
    path, overlap = contact_path(pair), pair.overlap_ratio
    bare = Mesh(pair, path, overlap, 1.0, 1.0, regime)
    if regime == "spur":
        return bare
    (low1, low2), (mean1, mean2) = lowest_curvatures(path), mean_curvatures(pair, path)
    ratio = mean1 * mean2 * path.length / (low1 * low2 * normal_base_pitch(pair))
    factor = bare.chosen(1.0, 1.0 - overlap * (1.0 - ratio))
    law = mean_load_sharing if smooth else load_sharing
    sharing = 1.0 if regime == "low" else bare.chosen(law(pair, path), 1.0)
    return Mesh(pair, path, overlap, sharing, factor, regime)


def normal_base_pitch(pair: GearPair) -> Any:
    """Return the normal base pitch p_N = pi m_n cos(alpha_n) [mm]."""
    return np.pi * pair.normal_module * np.cos(pair.pinion.rack.pressure_angle)


def lowest_curvatures(path: ContactPath) -> tuple[Any, Any]:
    """Return the radii of curvature [mm] at the pinion's lowest point of single tooth contact."""
    return path.radii_of_curvature(path.lowest_single)


def mean_curvatures(pair: GearPair, path: ContactPath) -> tuple[Any, Any]:
    """Return the radii of curvature [mm] at the mean radius of the pinion's working flank.

    R_m1 = (R_o1 + a - R_o2)/2. Source: AGMA 908-B89, clause 4.
    """
    pinion, wheel = (0.5 * gear.active_tip_diameter for gear in pair.gears)
    mean = 0.5 * (pinion + pair.centre_distance - wheel)
    first = np.sqrt(mean**2 - (0.5 * pair.pinion.base_diameter) ** 2)
    return first, sum(path.curvatures) - first


def load_sharing(pair: GearPair, path: ContactPath) -> Any:
    """Return the load sharing ratio m_N = F/L_min of helical gears with m_F > 1.

    With the fractions n_r, n_a of eps_alpha and m_F: L_min = (eps_alpha F - n_a n_r p_x)/cos(psi_b)
    for n_a <= 1 - n_r, else (eps_alpha F - (1 - n_a) (1 - n_r) p_x)/cos(psi_b).
    Source: AGMA 908-B89, clause 4; derived too, as the least total length of the lines of contact.
    """
    ratio, overlap = path.transverse_ratio, pair.overlap_ratio
    n_r, n_a = ratio - np.floor(ratio), overlap - np.floor(overlap)
    lost = choose(n_a <= 1.0 - n_r, n_a * n_r, (1.0 - n_a) * (1.0 - n_r))
    return overlap * np.cos(base_helix_angle(pair.pinion)) / (ratio * overlap - lost)


def mean_load_sharing(pair: GearPair, path: ContactPath) -> Any:
    """Return m_N = p_N/(0.95 Z): smooth, where `load_sharing` has kinks.

    Source: Shigley, eq. (14-21), for helical gears of m_F > 1; L_min = 0.95 of its mean.
    """
    return normal_base_pitch(pair) / (0.95 * path.length)


def pitting_factor(mesh: Mesh) -> Any:
    """Return the geometry factor I = cos(alpha_wt) C_psi^2/((1/rho_1 + 1/rho_2) d_w1 m_N).

    rho at the pinion's lowest point of single tooth contact for spur gears and m_F <= 1, at its
    mean radius above; the pinion is the gear with fewer teeth.
    Zero or negative where that point lies at or below the base circle. 2101 calls it Z_I. The
    radius of a ring is negative, so that its reciprocal is taken off (unverified).
    Source: AGMA 908-B89, clause 4; its table of 15 spur pairs is met to every digit.
    """
    first, second = curvatures(mesh)
    diameter = mesh.pair.working_diameters[0]
    together = first * second / (first + second)
    factor = np.cos(mesh.pair.working_angle) * mesh.overlap_factor
    return factor * together / (diameter * mesh.sharing)


def curvatures(mesh: Mesh) -> tuple[Any, Any]:
    """Return the radii of curvature [mm] of both flanks at which I is taken."""
    low = lowest_curvatures(mesh.path)
    if mesh.regime in ("spur", "low"):
        return low
    mean = mean_curvatures(mesh.pair, mesh.path)
    return mesh.chosen(mean[0], low[0]), mesh.chosen(mean[1], low[1])


def pitch_point_factor(pair: GearPair, sharing: Any = 1.0) -> Any:
    """Return I = cos(alpha_t) sin(alpha_t)/(2 m_N) u/(u + 1), of textbooks; not that of AGMA 908.

    sharing m_N. It takes the curvatures at the pitch point: for 17/52 teeth 23 % above
    `pitting_factor`, and so contact stresses 10 % too low. Source: Shigley, eq. (14-23).
    """
    angle = pair.pinion.transverse_pressure_angle
    share = pair.ratio / (pair.ratio + 1.0)
    return np.cos(angle) * np.sin(angle) / (2.0 * sharing) * share


def virtual_gear(gear: Gear) -> Gear:
    """Return the virtual spur gear in the normal plane: z/cos(beta)^3 teeth, unit module.

    A ring has the rack that leaves its fillet (`virtual_rack`). Source: AGMA 908-B89, clause 5.
    """
    teeth = gear.teeth / np.cos(gear.helix_angle) ** 3
    allowance = gear.thickness_allowance / gear.normal_module
    return Gear(
        1.0,
        teeth,
        teeth,
        1.0,
        0.0,
        virtual_rack(gear),
        gear.profile_shift,
        gear.tip_alteration,
        allowance,
    )
