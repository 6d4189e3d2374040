"""Names and numbers, as every report writes them."""

import math
from collections.abc import Mapping
from typing import Any

from gearopt.report.measures import METRIC, Measures

REACHED = 1e-6  # below a limit by less than that, it is used to the full
MODULE = "normal_module_mm"
VERDICTS = {
    "optimal": ("proven optimal", "green"),
    "stationary": ("locally optimal (no bound)", "yellow"),
    "feasible": ("feasible, not proven optimal", "yellow"),
    "evaluated": ("evaluated, all limits met", "green"),
    "infeasible": ("impossible, proven", "red"),
    "limit": ("stopped early", "yellow"),
    "failed": ("failed", "red"),
}


def limit_words(name: str) -> str:
    """`k_factor[2]` as "K-factor of stage 2"."""
    stem, _, index = name.rstrip("]").partition("[")
    words = stem.replace("_", " ").replace("k factor", "K-factor")
    return f"{words} of stage {index}" if index else words


def edit(change: Mapping[str, Any]) -> str:
    """A change of a file as one would write it."""
    key, write = change["key"], change["write"]
    return f"{key} = {write}" if write else f"remove {key}"


def heading(key: str, measures: Measures = METRIC) -> str:
    """`face_width_mm` as "face width [mm]"."""
    stem, suffix = parted(key, measures)
    words = stem.replace("_", " ")
    return f"{words} [{measures.unit(suffix)}]" if suffix else words


def parted(key: str, measures: Measures = METRIC) -> tuple[str, str]:
    """Name and unit of a key: `face_width_mm` is ("face_width", "mm")."""
    if key == MODULE:  # of a metric series, in any system
        return "normal_module [mm]", ""
    units = [unit for unit in measures.units if key.endswith(f"_{unit}")]
    unit = max(units, key=len, default="")
    return (key.removesuffix(f"_{unit}"), unit) if unit else (key, "")


def amount(value: Any, unit: str, measures: Measures = METRIC) -> str:
    """A number of a result with its unit, for reading."""
    return f"{number(measures.of(value, unit))} {measures.unit(unit)}".rstrip()


def share(used: float) -> str:
    """A part of a whole in per cent; 100.0 only where it is reached."""
    text = f"{100.0 * used:.1f}"
    below = text == "100.0" and used < 1.0 - REACHED
    return f"{math.floor(1e4 * used) / 100.0:.2f}" if below else text


def number(value: Any) -> str:
    """A number for reading: thousands apart, six significant digits, tenths of large ones."""
    if isinstance(value, list):
        return "  ".join(number(v) for v in value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    if isinstance(value, int):
        return f"{value:,}"
    if abs(value) >= 1e5:
        return f"{value:,.0f}" if abs(value) >= 1e8 else f"{value:,.1f}"
    if abs(value) >= 100:
        return f"{value:,.2f}"
    return f"{value:.5g}" if abs(value) >= 1e-6 or value == 0.0 else f"{value:.8g}"
