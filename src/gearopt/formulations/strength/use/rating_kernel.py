"""First widths of rows by ISO 6336 and AGMA 2001: the text of `widths` and both standards."""

from typing import Any

import numpy as np

from gearopt.formulations.strength import ALLOWANCE
from gearopt.formulations.strength.use.agma import AgmaRow, agma_border, agma_nominal, agma_use
from gearopt.formulations.strength.use.iso6336 import (
    IsoRow,
    iso_border,
    least_part,
    nominal_part,
    refused,
)
from gearopt.formulations.strength.widths import MAX_STEPS, stepped, tried
from gearopt.optimise.jit_kernel import entry, law, light


@light
def chosen(condition, yes, no):
    """`choosing.choose` of numbers."""
    return yes if condition else no


@light
def is_so(condition):
    """`choosing.some` of a number."""
    return condition


NOT_CARRIED = 1.0 + 1e-6  # part in use that is surely above 1, roundings and close included
INSTEAD = {"choose": chosen, "some": is_so}
least, unrated, iso_end = (law(f, INSTEAD) for f in (least_part, refused, iso_border))
by_agma, agma_end = law(agma_use, INSTEAD), law(agma_border, INSTEAD)
iso_parts, agma_least = law(nominal_part, INSTEAD), law(agma_nominal, INSTEAD)
wider, beyond = law(tried, INSTEAD), law(stepped, INSTEAD)


@light
def by_iso(at, way, low, high, same):
    """Greatest part that is used."""
    if unrated(at, high):
        return np.inf
    a, b, c, d = least(at, way, low, high, same)
    return max(max(a, b), max(c, d))


@light
def iso_least(at, way, low, high):
    """Width times the greatest part that is used by the nominal load."""
    a, b, c, d = iso_parts(at, way, low, high)
    return max(max(a, b), max(c, d))


def _search(use: Any, end: Any, nominal: Any) -> Any:
    """First width of one row, by what is used of it, its borders and nominal stresses."""

    @light
    def first(at, way, alike, low, high, close, steps):
        here, power = low, 1.0
        if not here <= high * (1.0 + ALLOWANCE):
            return np.inf
        if nominal(at, way, low, high) > high * NOT_CARRIED:
            return np.inf
        for _ in range(steps):
            now = use(at, way, here, here, alike)
            if now <= 1.0 + close:
                return here
            if not here < high:
                return np.inf
            if np.isnan(now):
                now = np.inf
            border = end(at, way, here)
            there = wider(here, min(high, border), now, power)
            bound = use(at, way, here, there, False)
            if np.isnan(bound):
                bound = np.inf
            here, power = beyond(here, there, now, bound, border)
        return np.nan if steps == MAX_STEPS else here

    return first


first_by_iso = _search(by_iso, iso_end, iso_least)
first_by_agma = _search(by_agma, agma_end, agma_least)


@entry
def iso_widths(c, way, alike, low, high, close, steps):
    """First widths [mm] of rows by ISO 6336; c (31, n): `IsoRow`, alike: of one torque."""
    widths = np.empty(len(low))
    for i in range(len(low)):
        at = IsoRow(
            c[0, i], c[1, i], c[2, i], c[3, i], c[4, i], c[5, i], c[6, i], c[7, i], c[8, i],
            c[9, i], c[10, i], c[11, i], c[12, i], c[13, i], c[14, i], c[15, i], c[16, i],
            c[17, i], c[18, i], c[19, i], c[20, i], c[21, i], c[22, i], c[23, i], c[24, i],
            c[25, i], c[26, i], c[27, i], c[28, i], c[29, i], c[30, i],
        )  # fmt: skip
        widths[i] = first_by_iso(at, way, alike, low[i], high[i], close, steps)
    return widths


@entry
def agma_widths(c, way, alike, low, high, close, steps):
    """First widths [mm] of rows by AGMA 2001; c (17, n): `AgmaRow`."""
    widths = np.empty(len(low))
    for i in range(len(low)):
        at = AgmaRow(
            (c[0, i], c[1, i], c[2, i]), c[3, i], (c[4, i], c[5, i], c[6, i]), c[7, i], c[8, i],
            c[9, i], c[10, i], c[11, i], c[12, i], c[13, i], c[14, i], c[15, i], c[16, i],
        )  # fmt: skip
        widths[i] = first_by_agma(at, way, alike, low[i], high[i], close, steps)
    return widths
