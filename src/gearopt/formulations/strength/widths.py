"""The narrowest face width that carries, proven: no width below it does.

What of the load capacity is used may rise with the width, and jump. It is followed from the
narrowest width on: as long as the lower bound of a step is above 1, no width in it carries.
"""

from collections.abc import Sequence

import numpy as np

from gearopt.formulations.strength import ALLOWANCE
from gearopt.formulations.strength.rated import REFUSED, Rows
from gearopt.optimise.terms import Array

PAST_BORDER = 1.0 + 1e-12  # a border is passed by this factor
ROUNDING = 1e-13  # of a bound
MAX_STEPS = 2000  # of a row; a bound of 1 is reached in some tens
ROUGH = 1e-4  # of what is used above 1 where a lower bound on the width is close enough
SHY = 0.97  # of a step that would lead to a bound of 1
LARGEST_POWER = 4.0  # power of what is used, of a step
SHORT = 1e-14  # relative length of a step that ends a row


def used(rows: Sequence[Rows], low: Array, high: Array) -> Array:
    """Return the lower bound of rows by several standards."""
    found = rows[0].used(low, high)
    for one in rows[1:]:
        found = np.maximum(found, one.used(low, high))
    return np.asarray(np.where(np.isnan(found), np.inf, found))


def first_width(
    rows: Sequence[Rows], low: Array, high: Array, close: float = ALLOWANCE, steps: int = MAX_STEPS
) -> Array:
    """Return the first face width [mm] (n,) from low to high that carries; inf: none.

    A lower bound of it where close, what may be used above 1, is more than rounding, or after so
    many steps.
    """
    found, here, top = np.full(len(low), np.inf), np.array(low, float), np.asarray(high, float)
    active = np.flatnonzero(here <= top * (1.0 + ALLOWANCE))
    rows = [one.take(active) for one in rows]
    here, top, power = here[active], top[active], np.ones(len(active))
    for _ in range(steps):
        if not len(active):
            break
        now = used(rows, here, here)
        carries = now <= 1.0 + close
        found[active[carries]] = here[carries]
        goes = ~carries & (here < top)
        if not goes.all():
            active, rows = active[goes], [one.take(goes) for one in rows]
            here, top, power, now = here[goes], top[goes], power[goes], now[goes]
        here, power = _on(rows, here, top, now, power)
    if len(active) and steps == MAX_STEPS:
        raise ArithmeticError(f"no narrowest face width was found in {MAX_STEPS} steps")
    found[active] = here  # what is left is bounded from below
    return found


def _on(
    rows: Sequence[Rows], here: Array, top: Array, now: Array, power: Array
) -> tuple[Array, Array]:
    """Return the widths after one step, and the powers of `now` that the next one tries.

    A power is that at which the bound, falling as it did in this step, would be near 1.
    """
    border = np.min([one.border(here) for one in rows], axis=0)
    end = np.minimum(top, border)
    now = np.clip(now, PAST_BORDER, REFUSED)
    there = np.minimum(here * now**power, end)
    bound = used(rows, here, there)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        falls = np.log(now / np.minimum(bound, REFUSED)) / np.log(there / here)
    at_border = here >= border
    goes = (bound >= 1.0 - ROUNDING) | at_border | (there <= here * (1.0 + SHORT))
    falls = np.where(~goes & (now == REFUSED), 2.0 * falls, falls)  # where a refusal ends
    here = np.where(goes, np.where(at_border, border * PAST_BORDER, there), here)
    return here, np.where(np.isfinite(falls), SHY / np.maximum(falls, SHY / LARGEST_POWER), 1.0)
