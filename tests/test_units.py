"""Units against pint, and what is said about a quantity that cannot be read."""

import math
import re
from decimal import Decimal
from fractions import Fraction

import pint
import pytest

from gearopt.units import RECIPROCALS, SPELLINGS, UNITS, parse, pattern, quotient

PINT = pint.UnitRegistry()
INSIDE = {  # dimension -> what one is inside
    "power": "newton * millimeter / second",
    "speed": "radian / second",
    "length": "millimeter",
    "module": "millimeter",
    "stress": "megapascal",
    "angle": "radian",
    "density": "metric_ton / millimeter**3",
    "inertia": "metric_ton * millimeter**2",
    "torque": "newton * millimeter",
    "frequency": "1 / second",
    "fraction": "dimensionless",
    "time": "second",
    "temperature": "degree_Celsius",
    "viscosity": "millipascal * second",
    "kinematic viscosity": "millimeter**2 / second",
    "hardness": "dimensionless",
    "Vickers hardness": "dimensionless",
    "elastic coefficient": "megapascal**0.5",
    "compliance": "millimeter / newton",
    "stiffness": "newton / millimeter",
    "force": "newton",
    "mass": "metric_ton",
}
NAMES = {  # where pint's name is another; a speed of 1/min or 1/s counts revolutions
    "hp": "horsepower",  # 550 ft lbf/s
    "PS": "metric_horsepower",
    "rpm": "revolution / minute",
    "1/min": "revolution / minute",
    "1/s": "revolution / second",
    "Hz": "revolution / second",
    ("frequency", "Hz"): "1 / second",
    ("frequency", "kHz"): "1000 / second",
    "deg/s": "degree / second",
    "rad/s": "radian / second",
    "in": "inch",
    "1/in": "1 / inch",
    "um": "micrometer",
    "deg": "degree",
    "mrad": "milliradian",
    "arcmin": "arcminute",
    "arcsec": "arcsecond",
    "%": "percent",
    "lb/in^3": "pound / inch**3",
    "ksi": "kilopound_force_per_square_inch",
    "psi": "pound_force_per_square_inch",
    "lb in^2": "pound * inch**2",
    "oz in^2": "ounce * inch**2",
    "lbf in s^2": "pound_force * inch * second**2",
    "ozf in s^2": "ounce_force * inch * second**2",
    "mN m": "millinewton * meter",
    "mNm": "millinewton * meter",
    "Nm": "newton * meter",
    "kgf cm": "kilogram_force * centimeter",
    "gf cm": "0.001 * kilogram_force * centimeter",
    "lbf in": "pound_force * inch",
    "lbf ft": "pound_force * foot",
    "ozf in": "ounce_force * inch",
    "h": "hour",
    "min": "minute",
    "mPa s": "millipascal * second",
    "Pa s": "pascal * second",
    "cP": "centipoise",
    "degC": "degree_Celsius",
    "degF": "degree_Fahrenheit",
    "HB": "dimensionless",
    "HV": "dimensionless",
    "sqrt(MPa)": "megapascal**0.5",
    "sqrt(psi)": "pound_force_per_square_inch**0.5",
    "um/kN": "micrometer / kilonewton",
    "nm/N": "nanometer / newton",
    "um/N": "micrometer / newton",
    "mm/N": "millimeter / newton",
    "N/mm": "newton / millimeter",
    "N/m": "newton / meter",
    "N/um": "newton / micrometer",
    "kN/mm": "kilonewton / millimeter",
    "MN/m": "meganewton / meter",
    "lbf/in": "pound_force / inch",
    "t": "metric_ton",
}
ALL = [(dimension, unit) for dimension, units in UNITS.items() for unit in units]


@pytest.mark.parametrize(("dimension", "unit"), ALL, ids=[f"{d} {u}" for d, u in ALL])
def test_every_unit_agrees_with_pint(dimension, unit):
    name = NAMES.get((dimension, unit), NAMES.get(unit, unit))
    offset = dimension == "temperature"
    theirs = PINT.Quantity(7.25, name) if offset else 7.25 * PINT.parse_expression(name)
    theirs = (1 / theirs if unit in RECIPROCALS else theirs).to(INSIDE[dimension]).magnitude
    assert parse(f"7.25 {unit}", dimension).value == pytest.approx(theirs, rel=1e-12)


@pytest.mark.parametrize("mm", ["20", "38.1", "63", "0.3", "1234.56789", "25.4", "84"])
def test_a_length_converted_to_inches_is_the_one_in_mm(mm):
    """The nearest double, and 28 digits; but not fewer than 15, nor another length."""
    exact, inches = Fraction(mm), float(mm) / 25.4
    texts = f"{inches!r}", str((Decimal(mm) / Decimal("25.4")).normalize())
    for text in texts:
        assert parse(f"{text} in", "length").exact == (exact, 0)
    for text in (f"{inches:.9g}", "0.78740157480315", "0.787401574803171"):
        assert parse(f"{text} in", "length").exact[0] == Fraction(text) * Fraction("25.4")


def test_a_quotient_in_one_unit_is_exact():
    found = quotient(parse("1450 rpm", "speed"), parse("66.5 rpm", "speed"))
    assert found == Fraction(14500, 665)
    assert found == quotient(parse("1450 1/min", "speed"), parse("66.5 rpm", "speed"))
    assert quotient(parse("1 1/s", "speed"), parse("60 rpm", "speed")) == 1
    assert quotient(parse("360 deg/s", "speed"), parse("1 1/s", "speed")) == 1
    assert quotient(parse("1 in", "length"), parse("1 mm", "length")) == Fraction("25.4")


def test_a_quotient_across_pi_is_right_to_rounding():
    found = quotient(parse("1500 rpm", "speed"), parse("20 rad/s", "speed"))
    assert found == pytest.approx(1500 * math.pi / 30 / 20, rel=1e-15)
    back = quotient(parse("20 rad/s", "speed"), parse("1500 rpm", "speed"))
    assert float(found * back) == pytest.approx(1, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "number", "unit"),
    [
        ("7.5 kW", Fraction(15, 2), "kW"),
        ("7.5kW", Fraction(15, 2), "kW"),
        ("  7.5\tkW ", Fraction(15, 2), "kW"),
        ("7.5\u00a0kW", Fraction(15, 2), "kW"),  # no-break space, as word processors write it
        ("+.5e1 kW", Fraction(5), "kW"),
        ("7. kW", Fraction(7), "kW"),
        ("0.1 W", Fraction(1, 10), "W"),  # exact, not the nearest double
        ("-3 W", Fraction(-3), "W"),
    ],
)
def test_numbers_are_read_exactly(text, number, unit):
    found = parse(text, "power")
    assert (found.number, found.unit) == (number, unit)
    assert parse(str(found), "power") == found


@pytest.mark.parametrize("dimension", UNITS)
@pytest.mark.parametrize("text", ["", "kW", "7.5 parsec", "1e99999 mm", "\u0667 mm", "nan"])
def test_errors_name_the_units(dimension, text):
    with pytest.raises(ValueError) as wrong:
        parse(text, dimension)
    assert ", ".join(UNITS[dimension]) in str(wrong.value)


@pytest.mark.parametrize(
    ("text", "theirs", "dimension"),
    [
        ("25 \u00b0", "25 degree", "angle"),
        ("25\u00ba", "25 degree", "angle"),
        ("1450 U/min", "1450 revolution / minute", "speed"),
        ("1450 r/min", "1450 revolution / minute", "speed"),
        ("1450 min^-1", "1450 revolution / minute", "speed"),
        ("1450 min-1", "1450 revolution / minute", "speed"),
        ("1450 min\u207b\u00b9", "1450 revolution / minute", "speed"),
        ("24 s^-1", "24 revolution / second", "speed"),
        ("6 \u00b0/s", "6 degree / second", "speed"),
        ("3 N\u00b7m", "3 newton * meter", "torque"),
        ("3 N*m", "3 newton * meter", "torque"),
        ("3 kNm", "3 kilonewton * meter", "torque"),
        ("3 ft lbf", "3 foot * pound_force", "torque"),
        ("3 lb-in", "3 inch * pound_force", "torque"),
        ("48 N/mm\u00b2", "48 newton / millimeter**2", "stress"),
        ("48 N/mm2", "48 newton / millimeter**2", "stress"),
        ("7850 kg/m\u00b3", "7850 kilogram / meter**3", "density"),
        ("7.85 g/cm3", "7.85 gram / centimeter**3", "density"),
        ("2 kg\u00b7cm\u00b2", "2 kilogram * centimeter**2", "inertia"),
        ("5 \u00b5m", "5 micrometer", "length"),
        ("5 \u03bcm", "5 micrometer", "length"),
        ("5 inches", "5 inch", "length"),
    ],
)
def test_other_spellings_of_a_unit_agree_with_pint(text, theirs, dimension):
    number = PINT.Quantity(theirs).to(INSIDE[dimension]).magnitude
    assert parse(text, dimension).value == pytest.approx(number, rel=1e-12)


def test_no_spelling_is_that_of_two_units():
    for dimension, known in UNITS.items():
        for text in [way for unit in known for way in (unit, *SPELLINGS.get(unit, ()))]:
            others = [u for u in known if u != text and re.fullmatch(pattern(u), text)]
            assert len(others) <= (text not in known) or text in ("Nm", "mNm"), (dimension, text)


@pytest.mark.parametrize("text", ["7,5 kW", "1,450 kW"])
def test_a_comma_is_no_decimal_sign(text):
    with pytest.raises(ValueError, match="has a comma: the decimal sign is a point"):
        parse(text, "power")


def test_a_unit_of_another_dimension_is_called_so():
    with pytest.raises(ValueError, match="has the unit mm of length; units of power: W, kW"):
        parse("7.5 mm", "power")


def test_only_a_fraction_may_be_bare():
    assert (
        parse("0.01", "fraction").exact == parse("1 %", "fraction").exact == (Fraction(1, 100), 0)
    )
    with pytest.raises(ValueError, match="has no unit; units of length: mm, cm"):
        parse("5", "length")


def test_an_error_shows_no_control_characters():
    with pytest.raises(ValueError, match="the unknown unit;") as wrong:
        parse("7 \x1b[31mkW", "power")
    assert str(wrong.value).isprintable()


@pytest.mark.parametrize("text", ["9" * 10**6, "9" * 81 + " mm", "1e9999999 mm", " " * 10**6])
def test_a_long_text_is_refused_at_once(text):
    with pytest.raises(ValueError, match="is not a number with a unit of length"):
        parse(text, "length")
