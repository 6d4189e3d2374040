"""Geometry factors of many pairs whose face widths are still to be found.

For searches over numbers of teeth, modules and face widths: I and J depend on the pair and, for
helical gears, on the overlap ratio by closed forms, which a table holds.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.agma.mesh import mesh_of
from gearopt.physics.agma.refusals import geometry_factors
from gearopt.physics.choosing import choose
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.tooth import base_helix_angle

LOW_OVERLAP, HIGH_OVERLAP = 0.5, 2.0  # of the widths at which the two regimes are tabulated

Three = tuple[Any, Any, Any]


@dataclass(frozen=True)
class FactorTable:
    """Quantities of pairs that give I and J at any face width, arrays of one shape.

    low: I/C_psi^2, J_1/C_psi, J_2/C_psi of spur gears and m_F <= 1; slope: (1 - C_psi^2)/m_F; high:
    I m_N, J_1 m_N, J_2 m_N of m_F > 1; contact: transverse contact ratio; axial: axial pitch p_x
    [mm], infinite of spur gears; cosine: of the base helix angle, one for all or of each; refusal:
    indices of `refusals.REFUSALS` for m_F <= 1 and above, where the factors are NaN.
    """

    low: Three
    slope: Any
    high: Three
    contact: Any
    axial: Any
    cosine: Any
    refusal: tuple[Any, Any]

    def take(self, place: Any) -> "FactorTable":
        """Table of some pairs; place: an index of arrays, as numpy takes it."""

        def of(three: Three) -> Three:
            return three[0][place], three[1][place], three[2][place]

        codes = self.refusal[0][place], self.refusal[1][place]
        axial, contact = self.axial[place], self.contact[place]
        cosine = self.cosine[place] if np.ndim(self.cosine) else self.cosine
        return FactorTable(
            of(self.low), self.slope[place], of(self.high), contact, axial, cosine, codes
        )

    @property
    def spur(self) -> bool:
        """Whether all pairs are spur gears, by one helix angle."""
        return np.ndim(self.cosine) == 0 and bool(self.cosine == 1.0)

    def scaled(self, factor: Any) -> "FactorTable":
        """Return the table of pairs whose lengths are all greater by a factor."""
        return replace(self, axial=self.axial * factor)

    def factors(self, width: Any) -> Three:
        """Return I, J_1, J_2 at face widths [mm] of the table's shape.

        Equal to `refusals.geometry_factors` to rounding; NaN where the table has a refusal.
        """
        if self.spur:
            return self.low
        with np.errstate(invalid="ignore"):  # of spur gears among others, of no overlap
            kind = self.contact, self.axial, self.cosine
            return factors_at(self.low, self.slope, self.high, kind, width)


def factors_at(low: Three, slope: Any, high: Three, kind: Three, width: Any) -> Three:
    """I, J_1, J_2 at face widths [mm]; kind: contact, axial and cosine of `FactorTable`."""
    overlap = width / kind[1]
    above, sharing = overlap > 1.0, lines(kind[0], overlap, kind[2])
    factor = np.maximum(0.0, 1.0 - np.minimum(overlap, 1.0) * slope)
    root = np.sqrt(factor)
    return (
        choose(above, high[0] * sharing, low[0] * factor),
        choose(above, high[1] * sharing, low[1] * root),
        choose(above, high[2] * sharing, low[2] * root),
    )


def lines(contact: Any, overlap: Any, cosine: Any) -> Any:
    """Return 1/m_N = L_min/b at overlap ratios; cosine: of the base helix angle."""
    n_r, n_a = contact - np.floor(contact), overlap - np.floor(overlap)
    lost = choose(n_a <= 1.0 - n_r, n_a * n_r, (1.0 - n_a) * (1.0 - n_r))
    return (contact - lost / overlap) / cosine


def factor_table(pair: GearPair, load: str = "highest single") -> FactorTable:
    """Return the table of pairs of arrays of one shape, of any face width.

    load: where it acts on spur teeth, as of `bending.loaded_tooth`. One helix angle for all, or an
    array.
    """
    sine = np.abs(np.sin(pair.pinion.helix_angle))
    helical = bool(np.any(sine))
    shape = np.shape(pair.pinion.teeth * pair.normal_module)
    with np.errstate(divide="ignore"):
        axial = np.broadcast_to(np.pi * pair.normal_module / sine, shape)
    unit = np.where(np.isfinite(axial), axial, pair.normal_module)
    narrow = pair.of_width(LOW_OVERLAP * unit)
    low = _bare(narrow, load)
    high = _bare(pair.of_width(HIGH_OVERLAP * unit), load) if helical else low
    mesh = mesh_of(narrow)
    return FactorTable(
        low[0],
        (1.0 - mesh.overlap_factor) / LOW_OVERLAP if helical else np.zeros(shape),
        high[0],
        np.broadcast_to(mesh.path.transverse_ratio, shape),
        axial,
        np.cos(base_helix_angle(pair.pinion)),
        (low[1], high[1]),
    )


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def _bare(pair: GearPair, load: str) -> tuple[Three, Any]:
    """Return I m_N/C_psi^2 and J m_N/C_psi, NaN where refused, and the codes of refusal."""
    mesh, made = mesh_of(pair), geometry_factors(pair, load)
    root = mesh.sharing / mesh.overlap_factor**0.5
    pitting = made.pitting * (mesh.sharing / mesh.overlap_factor)
    return (pitting, made.bending[0] * root, made.bending[1] * root), np.asarray(made.refusal)
