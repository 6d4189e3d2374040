"""What AGMA 2001 uses of a pair between two widths, from below (Lemma 59).

One text for arrays and for numbers, for which `rating_kernel` compiles it.
"""

from typing import Any, NamedTuple

import numpy as np

from gearopt.physics.agma.factors import distributed, size_factor
from gearopt.physics.agma.table import factors_at
from gearopt.physics.choosing import choose

Three = tuple[Any, Any, Any]


class AgmaRow(NamedTuple):
    """A pair, or of arrays many: of `FactorTable`, then of `AgmaRows`."""

    low: Three
    slope: Any
    high: Three
    contact: Any
    axial: Any
    cosine: Any
    bending0: Any
    bending1: Any
    contact0: Any
    contact1: Any
    diameter: Any
    length0: Any
    length1: Any


class AgmaWay(NamedTuple):
    """Numbers of the standard: factors that are not given are NaN.

    sized: K_s is Shigley's; curve, shared: of `distributed`.
    """

    I: float  # noqa: E741
    J: float
    K_m: float
    sized: bool
    curve: Three
    shared: Three


def agma_use(at: AgmaRow, way: AgmaWay, low: Any, high: Any, same: bool) -> Any:
    """Return K_m K_s at the low width over b I and b J at the high one, times what they use.

    K_m and K_s do not fall with the width; b I and b J follow the least length of the lines of
    contact above m_F = 1, which does not fall; below, I and J are largest at one of the ends.
    """
    return part(at, way, low, geometry(at, low, high, same), high)


def agma_nominal(at: AgmaRow, way: AgmaWay, low: Any, high: Any) -> Any:
    """Return a lower bound of the width times what is used at any width between two (Lemma 83).

    Up to m_F = 1 I and J are greatest at an end of the widths; above, L_min/b is at most the
    contact ratio over the cosine of the base helix angle.
    """
    most, above = at.contact / at.cosine, high > at.axial
    rise = np.maximum(1.0, 1.0 - np.minimum(high / at.axial, 1.0) * at.slope)
    root = rise**0.5
    factors = (
        choose(above, np.fmax(at.low[0] * rise, at.high[0] * most), at.low[0] * rise),
        choose(above, np.fmax(at.low[1] * root, at.high[1] * most), at.low[1] * root),
        choose(above, np.fmax(at.low[2] * root, at.high[2] * most), at.low[2] * root),
    )
    return part(at, way, low, factors, 1.0)


def part(at: AgmaRow, way: AgmaWay, low: Any, factors: Three, width: Any) -> Any:
    """Part that is used at a width, with I and J and with K_m and K_s of a width up to it."""
    pitting, first, second = factors
    spread = distributed(low, at.diameter, way.curve, way.shared) if np.isnan(way.K_m) else 1.0
    sizes = (1.0, 1.0)
    if way.sized:
        sizes = size_factor(low, at.length0, 1.0), size_factor(low, at.length1, 1.0)
    pressed = width * (pitting if np.isnan(way.I) else 1.0)
    bent = width * (first if np.isnan(way.J) else 1.0), width * (second if np.isnan(way.J) else 1.0)
    pinion = np.maximum(at.bending0 / bent[0], at.contact0 / pressed) * sizes[0]
    wheel = np.maximum(at.bending1 / bent[1], at.contact1 / pressed) * sizes[1]
    return spread * np.maximum(pinion, wheel)


def geometry(at: AgmaRow, low: Any, high: Any, same: bool) -> Three:
    """Return the largest I, J_1, J_2 of use between two widths."""
    kind = at.contact, at.axial, at.cosine
    wide = factors_at(at.low, at.slope, at.high, kind, high)
    if same:
        return wide
    narrow = factors_at(at.low, at.slope, at.high, kind, low)
    above = high > at.axial
    return (
        choose(above, wide[0], np.maximum(wide[0], narrow[0])),
        choose(above, wide[1], np.maximum(wide[1], narrow[1])),
        choose(above, wide[2], np.maximum(wide[2], narrow[2])),
    )


def agma_border(at: AgmaRow, way: AgmaWay, width: Any) -> Any:
    """Return the width of m_F = 1 for those up to it."""
    return choose(width <= at.axial, at.axial, np.inf)
