"""The compliance of a pair of teeth by models of one signature, from simple to exact."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.geometry.fillet import profile
from gearopt.physics.iso6336.stiffness import single_stiffness
from gearopt.physics.tooth import finite_elements
from gearopt.physics.tooth.elastic import ElasticGear, ElasticPair, LoadLine
from gearopt.physics.tooth.foundation import (
    cornell_compliance,
    ring_torsion,
    sainsot_compliance,
    torsion_compliance,
)
from gearopt.physics.tooth.hertz import contact_compliance, linear_contact_compliance
from gearopt.physics.tooth.trapezoid import nakada_compliance, trapezoid_compliance

SHEAR = 1.2  # kappa of a rectangular section: the shear strain energy of its parabola of stresses
POINTS = 400  # of fillet and of flank each; the integrals are then good to 1e-5


@dataclass(frozen=True)
class Profile:
    """Integrals over a tooth's centre line from the root circle to heights y [mm]; w: its width.

    bending: of 1/w^3, y/w^3, y^2/w^3 (3, N); slender: of 1/w (N,).
    """

    heights: Any
    bending: Any
    slender: Any


@lru_cache(maxsize=64)
def tabulated(member: ElasticGear) -> Profile:
    """Return the integrals of one gear, by the trapezoidal rule; w need not fall outwards."""
    x, y = profile(member.gear, POINTS, POINTS)
    width = 2.0 * x
    rows = np.stack([np.ones_like(y), y, y * y])
    return Profile(y, _cumulative(rows / width**3, y), _cumulative(1.0 / width, y))


def _cumulative(rows: Any, y: Any) -> Any:
    """Return integrals over y from its first value, along the last axis."""
    steps = 0.5 * (rows[..., 1:] + rows[..., :-1]) * np.diff(y)
    return np.concatenate((np.zeros((*rows.shape[:-1], 1)), np.cumsum(steps, axis=-1)), axis=-1)


def profile_compliance(member: ElasticGear, line: LoadLine) -> Any:
    """Return bending, shear and compression of a tooth of its exact width w(y) [mm/N].

    cos^2(aL)/(E b) {12 f int (y_F - y)^2/w^3 dy + 2 kappa (1 + nu) int dy/w} + f sin^2(aL)/(E b)
    int dy/w, from the root circle to the contact; f: `ElasticGear.plane_factor`, kappa 1.2. As
    (y_F - y)^2 expands, each load takes four table look-ups. Holds for undercut teeth too, whose w
    has a waist. Source: the strain energy of a cantilever (Weber and Banaschek; Cornell).
    """
    table = tabulated(member)
    flat = [np.interp(line.height, table.heights, row) for row in (*table.bending, table.slender)]
    lever, factor = line.crossing, member.plane_factor
    across, along = np.cos(line.angle) ** 2, np.sin(line.angle) ** 2
    bending = 12.0 * factor * (lever**2 * flat[0] - 2.0 * lever * flat[1] + flat[2])
    shear = 2.0 * SHEAR * (1.0 + member.poisson) * flat[3]
    return (across * (bending + shear) + along * factor * flat[3]) / member.rigidity


Compliance = Callable[[ElasticPair, Any, Any], Any]
OfTooth = Callable[[ElasticGear, LoadLine], Any]
OfContact = Callable[[ElasticPair, Any, tuple[LoadLine, LoadLine], Any], Any]


@dataclass(frozen=True)
class Level:
    """A model of the compliance of one pair of teeth.

    compliance(elastic, positions, force): [mm/N] along the line of action, of positions s [mm]
    (0 at the pitch point, positive towards the pinion's tip) and a force F > 0 [N] on this pair of
    teeth, floats or arrays; ValueError for positions outside the path of contact. tooth and body:
    what stands for a tooth and for the ring below it. error: least and largest error of the
    stiffness, relative to finite elements (theirs: to elements of half the size), over five
    positions of two pairs of steel, in plane stress and in plane strain: 25/50 and 18/40 teeth,
    shifts 0 and +0.3/-0.1, bore ratios 1.8 to 2.9. wider: the same over 32 random pairs, 17/17 to
    60/150 teeth, shifts -0.2 to 0.6, bore ratios 1.4 to 5 (of finite elements over 4 of these).
    cost [us]: time a position of a few hundred at once, without set-up. All three by `gearopt bench
    stiffness`.
    """

    compliance: Compliance
    tooth: str
    body: str
    error: tuple[float, float]
    wider: tuple[float, float]
    cost: float

    @property
    def worst(self) -> float:
        """The largest of all errors, in magnitude."""
        return max(map(abs, (*self.error, *self.wider)))


def _iso(elastic: ElasticPair, positions: Any, force: Any) -> Any:
    """Return 1/(c' b): one number, the stiffest of a pair of teeth, wherever it touches."""
    pair = elastic.pair
    elastic.load_lines(positions)
    tangential = force * np.cos(pair.pinion.transverse_pressure_angle)
    single = single_stiffness(pair, tangential / pair.face_width, elastic.moduli)
    return 1.0 / (single * pair.face_width) + np.zeros_like(np.asarray(positions, float))


def _linear(elastic: ElasticPair, positions: Any, lines: Any, force: Any) -> Any:
    return linear_contact_compliance(elastic)


def _printed(elastic: ElasticPair, positions: Any, lines: Any, force: Any) -> Any:
    return linear_contact_compliance(elastic, printed=True)


def _sum(*teeth: OfTooth, contact: OfContact = contact_compliance) -> Compliance:
    """Sum of the compliances of both teeth and of their contact."""

    def compliance(elastic: ElasticPair, positions: Any, force: Any) -> Any:
        lines = elastic.load_lines(positions)
        rows = list(zip(elastic.members, lines, strict=True))
        total = sum(part(member, line) for part in teeth for member, line in rows)
        return total + contact(elastic, positions, lines, force)

    return compliance


def _nakada(convention: str) -> OfTooth:
    return lambda member, line: nakada_compliance(member, line, convention)


def _trapezoid(member: ElasticGear, line: LoadLine) -> Any:
    return trapezoid_compliance(member, line, "B", SHEAR, member.plane_factor)


def _torsion(member: ElasticGear, line: LoadLine) -> Any:
    return torsion_compliance(member)


SAINSOT = profile_compliance, sainsot_compliance
CORNELL = profile_compliance, cornell_compliance
USUAL = "profile + Sainsot"  # for any tooth, undercut or not
RINGED = "profile + Cornell + torsion"  # for any bore, however small
ALONE, RING = ("trapezoid", "half plane"), ("trapezoid", "Sainsot")
LEVELS: Mapping[str, Level] = MappingProxyType(
    {
        USUAL: Level(_sum(*SAINSOT), "profile", "Sainsot", (-0.088, -0.025), (-0.098, 0.008), 0.6),
        "ISO 6336": Level(_iso, "number", "disc", (-0.123, 0.544), (-0.163, 1.280), 0.3),
        "Nakada A as printed": Level(
            _sum(_nakada("A"), contact=_printed), *ALONE, (0.427, 1.897), (0.505, 3.215), 0.9
        ),
        "Nakada A": Level(
            _sum(_nakada("A"), contact=_linear), *ALONE, (0.454, 2.012), (0.531, 3.391), 0.9
        ),
        "Nakada B": Level(
            _sum(_nakada("B"), contact=_linear), *ALONE, (0.303, 1.341), (0.382, 2.995), 0.9
        ),
        "Nakada C": Level(
            _sum(_nakada("C"), contact=_linear), *ALONE, (0.130, 1.056), (0.172, 2.808), 0.9
        ),
        "Nakada C + log Hertz": Level(
            _sum(_nakada("C")), *ALONE, (-0.019, 0.495), (0.030, 1.572), 0.9
        ),
        "trapezoid + Sainsot": Level(
            _sum(_trapezoid, sainsot_compliance), *RING, (-0.015, 0.048), (-0.042, 0.071), 1.0
        ),
        "profile + Sainsot + linear Hertz": Level(
            _sum(*SAINSOT, contact=_linear),
            "profile",
            "Sainsot",
            (0.028, 0.155),
            (0.031, 0.193),
            0.6,
        ),
        "profile + Cornell": Level(
            _sum(*CORNELL), "profile", "half plane", (0.045, 0.233), (0.044, 0.802), 0.6
        ),
        RINGED: Level(
            _sum(*CORNELL, _torsion),
            "profile",
            "half plane and ring",
            (-0.020, 0.055),
            (0.0, 0.106),
            0.6,
        ),
        "finite elements": Level(
            finite_elements.pair_compliance,
            "elements",
            "elements",
            (0.0, 0.001),
            (0.0, 0.001),
            1e4,
        ),
    }
)

# c_12 [mm/N]: how far a pair of teeth gives way under a unit force on the pair next to it
COUPLINGS: Mapping[str, Callable[[ElasticPair], float]] = MappingProxyType(
    {
        "none": lambda elastic: 0.0,
        "ring torsion": ring_torsion,
        "finite elements": finite_elements.coupling,
    }
)
