"""Errors of the models of elastic teeth in mesh, measured against finite elements."""

import csv
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from gearopt.frozen import dataclass

FILE = Path(__file__).with_name("in_mesh.csv")  # per cent, by `gearopt bench levels`
PAIRS = 30  # random pairs of steel gears, with bore ratios 1.4 to 5, at 30 to 180 N/mm
Spread = tuple[float, float, float]  # least, median and largest over these pairs


@dataclass(frozen=True)
class Errors:
    """Errors of a level with a coupling, relative to finite elements with theirs, over the pairs.

    peak_to_peak: of the transmission error without relief. Of the best linear relief for 60 and
    100 % of the load: amount, the sum taken off both tips; proven, what the level says that it
    leaves; both over those of the best by finite elements. judged: what the level says over what
    finite elements say of the same flanks, penalty: what these say over their least. All less 1.
    """

    peak_to_peak: Spread
    amount: Spread
    proven: Spread
    judged: Spread
    penalty: Spread


def _read() -> dict[tuple[str, str], Errors]:
    with FILE.open(encoding="utf-8", newline="") as text:
        rows = csv.reader(line for line in text if not line.startswith("level"))
        return {(level, coupling): _errors(values) for level, coupling, *values in rows}


def _errors(values: list[str]) -> Errors:
    """Return errors from per cent: least, median and largest of each in the order of fields."""
    each = [0.01 * float(value) for value in values]
    spreads: list[Spread] = [(each[k], each[k + 1], each[k + 2]) for k in range(0, len(each), 3)]
    return Errors(*spreads)


IN_MESH: Mapping[tuple[str, str], Errors] = MappingProxyType(_read())
