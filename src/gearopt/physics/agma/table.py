"""Many ratings at once: geometry factors tabulated by tooth pair, all else numpy on rows.

For searches over numbers of teeth, modules and face widths with one tool, helix angle and shifts: I
and J then depend on the tooth pair and, for helical gears, on the overlap ratio by closed forms.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearopt.physics.agma.bending import (
    bending_factor,
    critical_theta,
    loaded_tooth,
    seen_from_wheel,
)
from gearopt.physics.agma.factors import dynamic_factor, load_distribution_factor
from gearopt.physics.agma.life import Curve
from gearopt.physics.agma.mesh import mesh_of, pitting_factor
from gearopt.physics.agma.refusals import geometry_factors
from gearopt.physics.agma.stress import (
    bending_safety,
    bending_stress,
    contact_safety,
    contact_stress,
    tangential_load,
)
from gearopt.physics.choosing import choose
from gearopt.physics.gears import ISO_53_A, GearPair, Rack
from gearopt.physics.geometry.tooth import base_helix_angle

LOW_OVERLAP, HIGH_OVERLAP = 0.5, 2.0  # of the widths at which the two regimes are tabulated
BLOCK = 8192  # rows that stay in a processor's cache


@dataclass(frozen=True)
class FactorTable:
    """Geometry factors by tooth pair, arrays of shape (pinions, wheels); rows of numbers of teeth.

    pinions, wheels: numbers of teeth, ascending. low: I/C_psi^2, J_1/C_psi, J_2/C_psi of spur gears
    and m_F <= 1; slope: (1 - C_psi^2)/m_F; high: I m_N, J_1 m_N, J_2 m_N of m_F > 1; contact:
    transverse contact ratio; working: d_w1/m_n; cosine: of the base helix angle; refusal: indices
    of `refusals.REFUSALS` for m_F <= 1 and above, where the factors are NaN.
    """

    pinions: Any
    wheels: Any
    helix_angle: float
    low: tuple[Any, Any, Any]
    slope: Any
    high: tuple[Any, Any, Any]
    contact: Any
    working: Any
    cosine: float
    refusal: tuple[Any, Any]


def factor_table(
    pinions: Iterable[float],
    wheels: Iterable[float],
    helix_angle: float = 0.0,
    rack: Rack = ISO_53_A,
    profile_shifts: tuple[float, float] = (0.0, 0.0),
    thickness_allowance: float = 0.0,
) -> FactorTable:
    """Return the table of all pairs of numbers of teeth; thickness_allowance in normal modules."""
    z1, z2 = (np.unique(np.asarray(list(z), float)) for z in (pinions, wheels))
    first, second = np.meshgrid(z1, z2, indexing="ij")
    axial = np.pi / np.sin(abs(helix_angle)) if helix_angle else 1.0  # pitch over m_n
    made = []
    for overlap in (LOW_OVERLAP, HIGH_OVERLAP):
        pair = GearPair.of_teeth(
            1.0, first, second, overlap * axial, helix_angle, rack, profile_shifts
        )
        gears = (replace(g, thickness_allowance=thickness_allowance) for g in pair.gears)
        made.append(GearPair(*gears))
    low, high = (_bare(pair) for pair in made)
    mesh = mesh_of(made[0])
    slope = (1.0 - mesh.overlap_factor) / LOW_OVERLAP if helix_angle else 0.0 * first
    codes = [np.asarray(geometry_factors(pair).refusal) for pair in made]
    return FactorTable(
        z1,
        z2,
        helix_angle,
        _masked(low, codes[0]),
        slope,
        _masked(high, codes[1]),
        mesh.path.transverse_ratio,
        made[0].working_diameters[0],
        float(np.cos(base_helix_angle(made[0].pinion))),
        (codes[0], codes[1]),
    )


def _masked(values: tuple[Any, Any, Any], codes: Any) -> tuple[Any, Any, Any]:
    first, second, third = (np.where(codes == 0, v, np.nan) for v in values)
    return first, second, third


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def _bare(pair: GearPair) -> tuple[Any, Any, Any]:
    """Return I m_N/C_psi^2 and J m_N/C_psi."""
    mesh = mesh_of(pair)
    teeth = [loaded_tooth(mesh), loaded_tooth(seen_from_wheel(mesh))]
    bare = mesh.sharing / mesh.overlap_factor
    first, second = (bending_factor(tooth, critical_theta(tooth)).value for tooth in teeth)
    root = mesh.sharing / mesh.overlap_factor**0.5
    return pitting_factor(mesh) * bare, first * root, second * root


def tabled_factors(table: FactorTable, row: Any, column: Any, width: Any) -> tuple[Any, Any, Any]:
    """Return I, J_1, J_2 of pairs table.pinions[row], table.wheels[column].

    row, column: integer arrays of one shape; width: face width over normal module. Equal to
    `refusals.geometry_factors` to rounding. NaN where the table has a refusal.
    """
    if not table.helix_angle:
        return table.low[0][row, column], table.low[1][row, column], table.low[2][row, column]
    overlap = width * (np.sin(abs(table.helix_angle)) / np.pi)
    ratio = table.contact[row, column]
    factor = np.maximum(0.0, 1.0 - np.minimum(overlap, 1.0) * table.slope[row, column])
    n_r, n_a = ratio - np.floor(ratio), overlap - np.floor(overlap)
    lost = choose(n_a <= 1.0 - n_r, n_a * n_r, (1.0 - n_a) * (1.0 - n_r))
    sharing = (ratio - lost / overlap) / table.cosine  # 1/m_N
    above = overlap > 1.0
    powers = (factor, np.sqrt(factor), np.sqrt(factor))
    low, high = table.low, table.high
    found = [
        np.where(above, h[row, column] * sharing, one[row, column] * power)
        for one, h, power in zip(low, high, powers, strict=True)
    ]
    return found[0], found[1], found[2]


@dataclass(frozen=True)
class Duty:
    """What all rows of a batch share.

    power [N mm/s] and pinion_speed [rad/s]; overload K_o; quality Q_v; curve of K_m; elastic C_p
    [sqrt(MPa)]; bending (s_at, s_at) and contact (s_ac, s_ac C_H) [MPa] of pinion and wheel; cycles
    of the pinion; bending_curves, contact_curves; reliability K_R.
    """

    power: float
    pinion_speed: float
    overload: float
    quality: float
    curve: str
    elastic: float
    bending: tuple[float, float]
    contact: tuple[float, float]
    cycles: float
    bending_curves: tuple[Curve, Curve]
    contact_curves: tuple[Curve, Curve]
    reliability: float = 1.0


@dataclass(frozen=True)
class Ratings:
    """Safety factors of rows: S_F of pinion and wheel, S_H of pinion and wheel (of stress)."""

    bending: tuple[Any, Any]
    contact: tuple[Any, Any]


def rate_rows(
    table: FactorTable, duty: Duty, row: Any, column: Any, module: Any, width: Any
) -> Ratings:
    """Return the safety factors of many gear pairs under one duty; K_s = K_B = K_T = C_f = 1.

    row, column: integer arrays into the table; module m_n, face width b [mm]: arrays of their
    shape, one-dimensional. Row by row the same as the laws of `stress` with `geometry_factors`.
    """
    found = np.empty((4, len(row)))
    for start in range(0, len(row), BLOCK):
        part = slice(start, start + BLOCK)
        found[:, part] = _block(table, duty, row[part], column[part], module[part], width[part])
    return Ratings((found[0], found[1]), (found[2], found[3]))


def _block(table: FactorTable, duty: Duty, row: Any, column: Any, module: Any, width: Any) -> Any:
    """Return S_F1, S_F2, S_H1, S_H2 of some rows."""
    factors = tabled_factors(table, row, column, width / module)
    diameter = table.working[row, column] * module
    load = tangential_load(duty.power, duty.pinion_speed, diameter)
    speed = 0.5 * duty.pinion_speed * diameter
    shared = duty.overload * dynamic_factor(speed, duty.quality)
    shared = shared * load_distribution_factor(width, diameter, duty.curve)
    transverse = module / np.cos(table.helix_angle)
    pressed = contact_stress(duty.elastic, load, width, diameter, factors[0], shared)
    ratio = table.wheels[column] / table.pinions[row]
    cycles = duty.cycles, duty.cycles / ratio
    found = []
    for k in (0, 1):
        stress = bending_stress(load, width, transverse, factors[k + 1], shared)
        life = duty.bending_curves[k].factor(cycles[k])
        found.append(bending_safety(duty.bending[k], life, 1.0, duty.reliability, stress))
    for k in (0, 1):
        life = duty.contact_curves[k].factor(cycles[k])
        found.append(contact_safety(duty.contact[k], life, 1.0, 1.0, duty.reliability, pressed))
    return found
