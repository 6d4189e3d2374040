"""Metric and inch: what the units of a result are called, and its numbers in either.

A result holds mm, MPa, N m and kg, named in the suffix of every key; nothing is converted before it
is shown. Factors are those of `gearopt.units`, exact by definition of the inch and the pound.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import field
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Decimal
from functools import lru_cache
from typing import Any

from gearopt.frozen import dataclass
from gearopt.units import UNITS

_INCH = float(UNITS["length"]["in"][0])  # mm
_PSI = float(UNITS["stress"]["psi"][0])  # MPa
_POUND = float(UNITS["density"]["lb/in^3"][0]) * 1000.0 * _INCH**3  # kg
_POUND_FORCE = _PSI * _INCH**2  # N
_HORSEPOWER = float(UNITS["power"]["hp"][0])  # N mm/s

DIGITS = 5  # significant digits of a number for reading
FEWEST = {"percent": 3, "mm": 3, "um": 4}  # the same of some units; of a length in mm, at least
HUNDREDTHS = 2  # decimals of a length in mm
LENGTH_ROUNDING = 5e-7  # mm; a smaller length is rounding
SMALL, LARGE = 1e-5, 1e15  # numbers below and from there are written with a power of ten
EXACT = 1e-12  # relative; a number so near to a shorter one is that one
IN_MICROMETRES = (
    "peak_to_peak",
    "harmonics",
    "rms",
)  # objectives in mm that are read in micrometres
NO_GAP = 1e-8  # a gap below it is rounding of the bound
_ROUNDING = {-1: ROUND_FLOOR, 0: ROUND_HALF_EVEN, 1: ROUND_CEILING}


@lru_cache(1 << 15)  # designs of a front have most of their numbers in common
def rounded(value: float, digits: int, decimals: int | None = None, way: int = 0) -> str:
    """A number with so many significant digits, integer digits never cut.

    decimals: at least so many of them. Without it a number that has fewer digits, as one of a
    catalogue, is written with these.
    way: -1 rounds down, 1 up, 0 to the nearest.
    """
    if value == 0.0 or not math.isfinite(value):
        return f"{value:.{decimals or 0}f}".replace("-0", "0")
    exponent = math.floor(math.log10(abs(value)))
    places = max(digits - 1 - exponent, decimals or 0)
    if not SMALL <= abs(value) < LARGE:
        step = Decimal(1).scaleb(exponent - digits + 1)
        mantissa = Decimal(value).quantize(step, _ROUNDING[way]).scaleb(-exponent)
        return f"{f'{mantissa:f}'.rstrip('0').rstrip('.')}e{exponent}"
    step = Decimal(1).scaleb(-max(places, 0))
    text = f"{Decimal(value).quantize(step, _ROUNDING[way]):,}"
    exact = math.isclose(float(text.replace(",", "")), value, rel_tol=EXACT)
    short = decimals is None and exact and "." in text
    return text.rstrip("0").rstrip(".") if short else text


def error_of(percent: float) -> str:
    """A relative error; of one as small as rounding, only that it is so small."""
    return f"{percent:+.3g} %" if abs(percent) >= 1e-9 else "below 1e-9 %" if percent else "0 %"


def gap_percent(gap: float) -> str:
    """A gap in per cent, never less than it is."""
    if 0.0 < gap < NO_GAP:
        return f"below {100.0 * NO_GAP:.6f} %"
    text = rounded(100.0 * (1.0 - EXACT) * gap, 2, way=1)  # a shorter number is itself
    return f"{text.rstrip('0').rstrip('.') if '.' in text else text} %"


def read_in(objective: str, unit: str) -> str:
    """The suffix under which an objective is shown: lengths of micrometres as such.

    objective: its name, also of a worst case, or at one load as in "peak_to_peak_at_60".
    """
    small = unit == "mm" and objective.removeprefix("worst_").partition("_at_")[0] in IN_MICROMETRES
    return "um_or_uin" if small else unit


@dataclass(frozen=True, eq=False)  # a system of units is itself alone, and a key of caches
class Measures:
    """How quantities are shown: of every suffix the unit's sign and the factor to it.

    digits: how many more decimals a length has than in mm. scaled: of some suffixes, units
    of sentences and key figures: the end of values it is for, sign and factor.
    """

    name: str
    units: Mapping[str, tuple[str, float]]
    digits: int = 0
    scaled: Mapping[str, tuple[tuple[float, str, float], ...]] = field(default_factory=dict)

    def unit(self, suffix: str) -> str:
        """The sign of a unit, `mm³` for mm3; an unknown suffix as it is."""
        return self.units.get(suffix, (suffix, 1.0))[0]

    @property
    def lengths(self) -> str:
        """Unit of a drawing's dimensions, as a word."""
        return "inches" if self.unit("mm") == "in" else self.unit("mm")

    def of(self, value: float, suffix: str) -> float:
        """A value of the result in the unit that is shown."""
        factor = self.units.get(suffix, ("", 1.0))[1]
        return value if factor == 1.0 else value * factor

    @property
    def module(self) -> tuple[str, str, str]:
        """Name, sign and unit of what stands for a normal module."""
        inch = self.unit("mm") == "in"
        return ("diametral pitch", "P_nd", "1/in") if inch else ("module", "m_n", "mm")

    def of_module(self, module: Any) -> Any:
        """A normal module [mm] as it is shown: itself, or P_nd = 25.4/m_n [1/in].

        A pitch is rounded to 12 digits: 25.4/(25.4/12) is 12.
        """
        if self.module[1] == "m_n" or not isinstance(module, int | float) or not module:
            return module
        return float(f"{_INCH / module:.12g}")

    def words(self, text: str) -> str:
        """A sentence with its metric quantities in these units: "3.2 mm" as "0.126 in"."""
        return text if self.name == "metric" else _METRIC.sub(self._converted, text)

    def _converted(self, match: re.Match[str]) -> str:
        text, unit = match.groups()
        value, shown = float(text.replace(",", "")), "lb/in³"
        if unit in _DENSITIES:
            value *= self.of(1.0, "kg") / self.of(1e6, "mm3")
        else:
            suffix, power = _SUFFIXES[unit]
            value, shown = self.of(value * power, suffix), self.unit(suffix)
        digits = len(re.sub(r"e.*|[^0-9]", "", text).lstrip("0"))
        return f"{rounded(value, max(3, digits))} {shown}"

    def length(self, value: float, digits: int = 2) -> str:
        """A length [mm] with so many decimals, for drawings."""
        return f"{self.of(value, 'mm'):.{digits + self.digits}f}".replace("-0.00", "0.00")

    def short_length(self, value: float, digits: int) -> str:
        """A length [mm] with so many decimals; one that has fewer is written with these."""
        size, places = self.of(value, "mm"), digits + self.digits
        text = f"{size:,.{places}f}"
        exact = math.isclose(float(text.replace(",", "")), size, rel_tol=EXACT)
        return text.rstrip("0").rstrip(".") if exact else text

    def number(self, value: float, suffix: str = "", way: int = 0) -> str:
        """A value of the result in the unit that is shown, for reading.

        Lengths to a hundredth of a millimetre, parts in per cent to three digits, all else to
        five; a number that has fewer is shown exactly. way: as for `rounded`.
        """
        if suffix != "mm":
            return rounded(self.of(value, suffix), FEWEST.get(suffix, DIGITS), way=way)
        size = 0.0 if abs(value) < LENGTH_ROUNDING else self.of(value, suffix)
        return rounded(size, FEWEST["mm"], HUNDREDTHS + self.digits, way)

    def amount(self, value: float, suffix: str, way: int = 0, beside: float | None = None) -> str:
        """A value with its unit for sentences and key figures.

        Volumes and areas have several units there; a length of fewer decimals is shown exactly.
        way: as for `rounded`, for a bound that must stay true. beside: the value whose unit it has,
        where it is read with another, as the end of a range.
        """
        size = abs(value if beside is None else beside)
        for end, sign, factor in self.scaled.get(suffix, ()):
            if size < end:
                return f"{rounded(value * factor, DIGITS, way=way)} {sign}"
        text = self.number(value, suffix, way)
        if "." in text and math.isclose(float(text.replace(",", "")), self.of(value, suffix)):
            text = text.rstrip("0").rstrip(".")
        return f"{text} {self.unit(suffix)}".rstrip()


_SAME = {
    **{"percent": ("%", 1.0), "deg": ("°", 1.0), "ms": ("ms", 1.0), "Hz": ("Hz", 1.0)},
    **{"s": ("s", 1.0), "rpm": ("rpm", 1.0), "rad_per_s2": ("rad/s²", 1.0)},
    **{"h": ("h", 1.0), "cycles": ("cycles", 1.0)},
}
METRIC = Measures(
    "metric",
    _SAME
    | {
        "mm": ("mm", 1.0),
        "mm2": ("cm²", 1e-2),
        "mm3": ("cm³", 1e-3),
        "MPa": ("MPa", 1.0),
        "sqrt_MPa": ("√MPa", 1.0),
        "N": ("N", 1.0),
        "kW": ("kW", 1.0),
        "Nm": ("N m", 1.0),
        "m_per_s": ("m/s", 1.0),
        "kg": ("kg", 1.0),
        "um": ("µm", 1e3),  # of mm
        "um_or_uin": ("µm", 1e3),  # of mm
        "N_per_mm_um": ("N/(mm µm)", 1e-3),  # of MPa
        "N_per_mm": ("N/mm", 1.0),
        "kg_m2": ("g cm²", 1e7),
        "Nm_per_rad": ("N m/rad", 1.0),
        "deg_per_mm": ("°/mm", 1.0),
    },
    scaled={
        "mm2": ((1e2, "mm²", 1.0), (1e6, "cm²", 1e-2), (math.inf, "m²", 1e-6)),
        "mm3": (
            (1e3, "mm³", 1.0),
            (1e7, "cm³", 1e-3),
            (1e10, "dm³", 1e-6),
            (math.inf, "m³", 1e-9),
        ),
    },
)
INCH = Measures(
    "inch",
    _SAME
    | {
        "mm": ("in", 1.0 / _INCH),
        "mm2": ("in²", 1.0 / _INCH**2),
        "mm3": ("in³", 1.0 / _INCH**3),
        "MPa": ("psi", 1.0 / _PSI),
        "sqrt_MPa": ("√psi", 1.0 / math.sqrt(_PSI)),
        "N": ("lbf", 1.0 / _POUND_FORCE),
        "kW": ("hp", 1e6 / _HORSEPOWER),
        "m_per_s": ("ft/min", 60_000.0 / (12.0 * _INCH)),
        "Nm": ("lbf in", 1000.0 / (_POUND_FORCE * _INCH)),
        "kg": ("lb", 1.0 / _POUND),
        "um": ("mil", 1000.0 / _INCH),  # of mm
        "um_or_uin": ("µin", 1e6 / _INCH),  # of mm
        "N_per_mm_um": ("lbf/(in µin)", 1e-6 / _PSI),  # of MPa
        "N_per_mm": ("lbf/in", _INCH / _POUND_FORCE),
        "kg_m2": ("oz in²", 16e6 / (_POUND * _INCH**2)),
        "Nm_per_rad": ("lbf in/rad", 1000.0 / (_POUND_FORCE * _INCH)),
        "deg_per_mm": ("°/in", _INCH),
    },
    digits=1,
)
SYSTEMS = {m.name: m for m in (METRIC, INCH)}
_SUFFIXES = {  # a unit in a sentence: what a key calls it, and how many of that it is
    **{"mm": ("mm", 1.0), "µm": ("um", 1e-3), "m": ("mm", 1e3)},
    **{"mm²": ("mm2", 1.0), "mm^2": ("mm2", 1.0), "cm²": ("mm2", 1e2), "m²": ("mm2", 1e6)},
    **{"mm³": ("mm3", 1.0), "mm^3": ("mm3", 1.0), "cm³": ("mm3", 1e3), "dm³": ("mm3", 1e6)},
    **{"m³": ("mm3", 1e9), "MPa": ("MPa", 1.0), "N m": ("Nm", 1.0), "kg": ("kg", 1.0)},
    **{"kW": ("kW", 1.0), "m/s": ("m_per_s", 1.0)},
}
_DENSITIES = ("kg/dm³", "kg/dm^3", "g/cm³", "g/cm^3")  # kg in 1e6 mm3
_SIGNS = sorted((*_SUFFIXES, *_DENSITIES), key=len, reverse=True)
_METRIC = re.compile(
    r"(?<![\w.])(-?[0-9][0-9,]*(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?)[ \u00a0]"
    rf"({'|'.join(map(re.escape, _SIGNS))})(?![\w/²³^])"
)
