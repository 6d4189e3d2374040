"""Units, converted once at the border: inside everything is mm, N, s, rad, MPa, t.

A factor is exact: a rational number times a power of pi, so that the quotient of two speeds in
rpm is a rational number and a ratio limit can be decided without rounding. Only a length that was
converted to inches, and cut to 15 digits or more, is taken for the one it was. Definitions: inch,
pound, standard gravity, horsepower (550 ft lbf/s) and metric horsepower (75 kgf m/s) as fixed by
international agreement (NIST SP 811, appendix B), an ounce is a pound/16; checked against pint in
the tests.
"""

import math
import re
from dataclasses import replace
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cached_property, lru_cache

from gearopt.frozen import dataclass

_INCH = Fraction("25.4")  # mm
_POUND = Fraction("0.45359237")  # kg
_GRAVITY = Fraction("9.80665")  # m/s2
_POUND_FORCE = _POUND * _GRAVITY  # N


def _table(**units: Fraction | int) -> dict[str, tuple[Fraction, int]]:
    return {name: (Fraction(factor), 0) for name, factor in units.items()}


_LENGTHS = {
    **_table(mm=1, cm=10, m=1000, um=Fraction(1, 1000)),
    **_table(**{"in": _INCH, "ft": 12 * _INCH, "uin": _INCH / 10**6}),
}
SYSTEMS = ("metric", "inch")  # in which answers are shown
RECIPROCALS = ("1/in",)  # units that count how often a length goes into theirs: diametral pitches

# dimension -> unit -> (rational factor, power of pi) to the inside unit
UNITS: dict[str, dict[str, tuple[Fraction, int]]] = {
    "power": {  # N mm/s
        **_table(W=10**3, kW=10**6, MW=10**9),
        **_table(hp=550 * 12 * _INCH * _POUND_FORCE, PS=75 * _GRAVITY * 10**3),
    },
    "speed": {  # rad/s
        "rpm": (Fraction(1, 30), 1),
        "1/min": (Fraction(1, 30), 1),
        "1/s": (Fraction(2), 1),
        "Hz": (Fraction(2), 1),
        "rad/s": (Fraction(1), 0),
        "deg/s": (Fraction(1, 180), 1),
    },
    "length": _LENGTHS,  # mm
    "module": _LENGTHS | {"1/in": (_INCH, 0)},  # mm: m_n = 25.4 mm/P of a diametral pitch P
    "stress": {  # MPa = N/mm2
        **_table(MPa=1, Pa=Fraction(1, 10**6), kPa=Fraction(1, 1000), GPa=1000),
        **_table(bar=Fraction(1, 10), **{"N/mm^2": 1}),
        "psi": (_POUND_FORCE / _INCH**2, 0),
        "ksi": (1000 * _POUND_FORCE / _INCH**2, 0),
    },
    "angle": {
        "deg": (Fraction(1, 180), 1),
        "rad": (Fraction(1), 0),
        "mrad": (Fraction(1, 1000), 0),
        "arcmin": (Fraction(1, 180 * 60), 1),
        "arcsec": (Fraction(1, 180 * 3600), 1),
    },
    "density": {  # t/mm3
        "kg/m^3": (Fraction(1, 10**12), 0),
        "kg/dm^3": (Fraction(1, 10**9), 0),
        "g/cm^3": (Fraction(1, 10**9), 0),
        "t/m^3": (Fraction(1, 10**9), 0),
        "lb/in^3": (_POUND / 1000 / _INCH**3, 0),
    },
    "inertia": {  # t mm2
        **_table(
            **{"kg m^2": Fraction(1000), "kg cm^2": Fraction(1, 10), "kg mm^2": Fraction(1, 1000)}
        ),
        **_table(**{"g cm^2": Fraction(1, 10**4), "g mm^2": Fraction(1, 10**6)}),
        **_table(**{"lb in^2": _POUND / 1000 * _INCH**2, "oz in^2": _POUND / 16000 * _INCH**2}),
        **_table(**{"lbf in s^2": _POUND_FORCE * _INCH, "ozf in s^2": _POUND_FORCE / 16 * _INCH}),
    },
    "torque": {  # N mm
        **_table(**{"N m": 1000, "Nm": 1000, "N mm": 1, "mN m": 1, "mNm": 1, "kN m": 10**6}),
        **_table(**{"kgf cm": 10 * _GRAVITY, "gf cm": _GRAVITY / 100}),
        **_table(**{"lbf in": _POUND_FORCE * _INCH, "lbf ft": 12 * _POUND_FORCE * _INCH}),
        **_table(**{"ozf in": _POUND_FORCE / 16 * _INCH}),
    },
    "force": {  # N
        **_table(N=1, kN=1000, kgf=_GRAVITY),
        "lbf": (_POUND_FORCE, 0),
    },
    "compliance": _table(  # mm/N
        **{"um/kN": Fraction(1, 10**6), "nm/N": Fraction(1, 10**6), "um/N": Fraction(1, 1000)},
        **{"mm/N": 1},
    ),
    "stiffness": {  # N/mm
        **_table(**{"N/mm": 1, "N/um": 1000, "kN/mm": 1000, "MN/m": 1000}),
        **_table(**{"N/m": Fraction(1, 1000)}),
        "lbf/in": (_POUND_FORCE / _INCH, 0),
    },
    "mass": {  # t
        **_table(kg=Fraction(1, 1000), g=Fraction(1, 10**6), t=1),
        "lb": (_POUND / 1000, 0),
    },
    "frequency": _table(Hz=1, kHz=1000),  # 1/s
    "time": _table(s=1, min=60, h=3600, ms=Fraction(1, 1000)),  # s
    "temperature": _table(degC=1, degF=Fraction(5, 9)),  # degrees C, above OFFSETS
    "viscosity": _table(**{"mPa s": 1, "Pa s": 1000, "cP": 1}),  # mPa s, dynamic
    "kinematic viscosity": _table(**{"mm^2/s": 1, "cSt": 1}),  # mm2/s
    "hardness": _table(HB=1),  # Brinell
    "Vickers hardness": _table(HV=1),
    "elastic coefficient": {  # sqrt(MPa)
        "sqrt(MPa)": (Fraction(1), 0),
        "sqrt(psi)": (Fraction(math.sqrt(_POUND_FORCE / _INCH**2)), 0),
    },
    "fraction": {"%": (Fraction(1, 100), 0)},
}

OFFSETS = {"degF": Fraction(-32)}  # of a unit whose zero is another

# unit -> other ways to write it, read as that unit
SPELLINGS: dict[str, tuple[str, ...]] = {
    "rpm": ("U/min", "r/min", "rev/min", "Upm", "UPM", "upm"),
    "PS": ("cv", "ch"),
    "1/min": ("min^-1", "min-1", "min\u207b\u00b9", "/min"),
    "1/s": ("s^-1", "s-1", "s\u207b\u00b9", "U/s", "r/s", "rev/s"),
    "deg": ("\u00b0", "\u00ba", "degree", "degrees"),  # the raised o is taken for a degree sign
    "deg/s": ("\u00b0/s",),
    "arcmin": ("\u2032",),
    "arcsec": ("\u2033",),
    "um": ("\u00b5m", "\u03bcm"),  # the micro sign, and the Greek letter
    "um/kN": ("\u00b5m/kN", "\u03bcm/kN"),
    "um/N": ("\u00b5m/N", "\u03bcm/N"),
    "in": ("inch", "inches"),
    "1/in": ("/in", "in^-1", "in\u207b\u00b9", "DP", "dp", "1/inch", "/inch"),
    "HB": ("HBW", "HBS", "BHN"),
    "h": ("hours", "hour", "hr", "hrs"),
    "degC": ("\u00b0C", "\u2103", "C"),
    "degF": ("\u00b0F", "\u2109", "F"),
    "lbf in": ("lb in", "in lbf", "in lb"),
    "lbf ft": ("lb ft", "ft lbf", "ft lb"),
}
SIGNS = {  # within any unit: a raised digit, a product with a point or without
    r"\^2": "(\\^2|\u00b2|2)",
    r"\^3": "(\\^3|\u00b3|3)",
    " ": "[ \u00b7\u22c5.*-]?",
}

CUT = 15  # digits from which on a length in inches is taken for a converted one
WHOLE = 12  # digits at most that it had in mm
SLIP = Fraction(1, 10**14)  # relative, by which the digits that were cut change it
_NUMBER = r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?)"
_UNIT = r"((?![eE][+-]?[0-9])[^\s\d.,].*?|1/\S+)?"  # it may hold spaces: N m
_PATTERN = re.compile(rf"{_NUMBER}\s*{_UNIT}")
_LONGEST = 80  # characters of a quantity


@dataclass(frozen=True)
class Quantity:
    """A number with a unit, as the user wrote it.

    number: the number, exactly; unit: a name of `UNITS[dimension]`, or "" for a bare fraction.
    """

    number: Fraction
    unit: str
    dimension: str

    @cached_property
    def exact(self) -> tuple[Fraction, int]:
        """Return the value in the inside unit as (rational number, power of pi)."""
        factor, power = UNITS[self.dimension][self.unit] if self.unit else (Fraction(1), 0)
        number = self.number + OFFSETS.get(self.unit, 0)
        value = factor / number if self.reciprocal else number * factor
        return (_before_conversion(value, self.number) if self.unit == "in" else value), power

    @property
    def reciprocal(self) -> bool:
        """Return whether a larger number is a smaller quantity, as with a diametral pitch."""
        return self.unit in RECIPROCALS

    def of(self, value: Fraction) -> "Quantity":
        """Return a value in the inside unit in the unit of this quantity, which has no pi."""
        factor, _ = UNITS[self.dimension][self.unit]
        number = factor / value if self.reciprocal else value / factor
        return replace(self, number=number - OFFSETS.get(self.unit, 0))

    @cached_property
    def value(self) -> float:
        """Return the value in the inside unit."""
        rational, power = self.exact
        return float(rational) * math.pi**power

    def __str__(self) -> str:
        return f"{float(self.number):.12g} {self.unit}".rstrip()


def _before_conversion(value: Fraction, number: Fraction) -> Fraction:
    """Return the length [mm] that a number of CUT digits or more in inches was converted from.

    It has WHOLE digits at most; `value` where there is none within SLIP.
    0.7874015748031497 in is 20 mm, though it is above it by 1e-16 of it.
    """
    with localcontext(prec=40):
        written = Decimal(number.numerator) / number.denominator
        if len(written.normalize().as_tuple().digits) < CUT:
            return value
        near = Fraction(f"{Decimal(value.numerator) / value.denominator:.{WHOLE - 1}e}")
    return near if abs(near - value) <= SLIP * abs(value) else value


def quotient(above: Quantity, below: Quantity) -> Fraction:
    """Return above/below of one dimension; exact unless only one unit contains pi."""
    (a, power_a), (b, power_b) = above.exact, below.exact
    if power_a == power_b:
        return a / b
    return Fraction(above.value / below.value)


def pattern(unit: str) -> str:
    """Return the regular expression of all ways to write a unit."""
    ways = [re.escape(way).replace("\\ ", " ") for way in (unit, *SPELLINGS.get(unit, ()))]
    for sign, others in SIGNS.items():
        ways = [way.replace(sign, others) for way in ways]
    return "|".join(way.replace("\\/", "/").replace("\\-", "-") for way in ways)


def named(text: str, dimension: str, flags: int = 0) -> str | None:
    """Return the unit of a dimension that a text spells; None where there is none.

    flags: of the module `re`, such as re.IGNORECASE.
    """
    known = UNITS[dimension]
    return (
        text
        if text in known
        else next((unit for unit in known if re.fullmatch(pattern(unit), text, flags)), None)
    )


@lru_cache(4096)
def parse(text: str, dimension: str) -> Quantity:
    """Read "7.5 kW"; ValueError with a sentence naming the rule where it cannot be read."""
    known = ", ".join(UNITS[dimension])
    match = _PATTERN.fullmatch(text.strip()) if len(text) <= _LONGEST else None
    if match is None and re.search("[0-9],[0-9]", text[:_LONGEST]):
        raise ValueError("has a comma: the decimal sign is a point")
    if match is None:
        raise ValueError(f"is not a number with a unit of {dimension} ({known})")
    number, unit = match.groups()
    if unit is None and dimension != "fraction":
        raise ValueError(f"has no unit; units of {dimension}: {known}")
    recognised = unit and named(unit, dimension)
    if unit is not None and recognised is None:
        other = next((f" of {d}" for d in UNITS if named(unit, d)), "")
        shown = f"{'' if other else 'unknown '}unit {unit if unit.isprintable() else ''}".rstrip()
        raise ValueError(f"has the {shown}{other}; units of {dimension}: {known}")
    return Quantity(Fraction(number), recognised or "", dimension)
