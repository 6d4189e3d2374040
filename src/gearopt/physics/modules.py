"""Standard normal modules [mm]."""

from fractions import Fraction


def _series(text: str) -> tuple[Fraction, ...]:
    return tuple(Fraction(number) for number in text.split())


# ISO 54:1996, table 1 (GB/T 1357-2008 lists the same); 6.5 is one the standard asks to avoid.
# Checked against three independent public listings.
SERIES_I = _series("1 1.25 1.5 2 2.5 3 4 5 6 8 10 12 16 20 25 32 40 50")
SERIES_II = _series("1.125 1.375 1.75 2.25 2.75 3.5 4.5 5.5 6.5 7 9 11 14 18 22 28 36 45")

MODULES = {"ISO 54 I": SERIES_I, "ISO 54 I+II": tuple(sorted(SERIES_I + SERIES_II))}
