"""Metric and inch: what the units of a result are called, and its numbers in either.

A result holds mm, MPa, N m and kg, named in the suffix of every key; nothing is converted before it
is shown. Factors are those of `gearopt.units`, exact by definition of the inch and the pound.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from gearopt.units import UNITS

_INCH = float(UNITS["length"]["in"][0])  # mm
_PSI = float(UNITS["stress"]["psi"][0])  # MPa
_POUND = float(UNITS["density"]["lb/in^3"][0]) * 1000.0 * _INCH**3  # kg
_POUND_FORCE = _PSI * _INCH**2  # N


@dataclass(frozen=True)
class Measures:
    """How quantities are shown: of every suffix the unit's sign and the factor to it.

    digits: how many more decimals a length has than in mm.
    """

    name: str
    units: Mapping[str, tuple[str, float]]
    digits: int = 0

    def unit(self, suffix: str) -> str:
        """Return the sign of a unit, `mm³` for mm3; an unknown suffix as it is."""
        return self.units.get(suffix, (suffix, 1.0))[0]

    @property
    def lengths(self) -> str:
        """Return what a drawing's dimensions are in, as a word."""
        return "inches" if self.unit("mm") == "in" else self.unit("mm")

    def of(self, value: float, suffix: str) -> float:
        """Return a value of the result in the unit that is shown."""
        factor = self.units.get(suffix, ("", 1.0))[1]
        return value if factor == 1.0 else value * factor

    def length(self, value: float, digits: int = 2) -> str:
        """Return a length [mm] with so many decimals, for drawings."""
        return f"{self.of(value, 'mm'):.{digits + self.digits}f}".replace("-0.00", "0.00")


_SAME = {
    **{"percent": ("%", 1.0), "deg": ("°", 1.0), "ms": ("ms", 1.0), "Hz": ("Hz", 1.0)},
    **{"s": ("s", 1.0), "rpm": ("rpm", 1.0), "rad_per_s2": ("rad/s²", 1.0)},
}
METRIC = Measures(
    "metric",
    _SAME
    | {
        "mm": ("mm", 1.0),
        "mm2": ("mm²", 1.0),
        "mm3": ("mm³", 1.0),
        "cm3": ("cm³", 1e-3),  # of mm3
        "MPa": ("MPa", 1.0),
        "Nm": ("N m", 1.0),
        "m_per_s": ("m/s", 1.0),
        "kg": ("kg", 1.0),
        "um": ("µm", 1e3),  # of mm
        "kg_m2": ("g cm²", 1e7),
        "Nm_per_rad": ("N m/rad", 1.0),
        "deg_per_mm": ("°/mm", 1.0),
    },
)
INCH = Measures(
    "inch",
    _SAME
    | {
        "mm": ("in", 1.0 / _INCH),
        "mm2": ("in²", 1.0 / _INCH**2),
        "mm3": ("in³", 1.0 / _INCH**3),
        "cm3": ("in³", 1.0 / _INCH**3),  # of mm3
        "MPa": ("psi", 1.0 / _PSI),
        "m_per_s": ("ft/min", 60_000.0 / (12.0 * _INCH)),
        "Nm": ("lbf in", 1000.0 / (_POUND_FORCE * _INCH)),
        "kg": ("lb", 1.0 / _POUND),
        "um": ("mil", 1000.0 / _INCH),  # of mm
        "kg_m2": ("oz in²", 16e6 / (_POUND * _INCH**2)),
        "Nm_per_rad": ("lbf in/rad", 1000.0 / (_POUND_FORCE * _INCH)),
        "deg_per_mm": ("°/in", _INCH),
    },
    digits=1,
)
SYSTEMS = {m.name: m for m in (METRIC, INCH)}


def diametral_pitch(module: float) -> float:
    """Return the normal diametral pitch [1/in] of a normal module [mm]: 25.4/m_n."""
    return _INCH / module
