"""Preferred numbers of ISO 3: the rounded values of the series R10, R20 and R40."""

import math
from fractions import Fraction


def _decade(text: str) -> tuple[Fraction, ...]:
    return tuple(Fraction(number) for number in text.split())


# ISO 3:1973, table 1, basic series, from 1 to below 10 (from memory: unverified; R10 and R20 are
# every fourth and every second value of R40, whose largest deviations from 10^(k/40) are +1.26 and
# -1.01 %, as the standard says).
PREFERRED = {
    "R10": _decade("1 1.25 1.6 2 2.5 3.15 4 5 6.3 8"),
    "R20": _decade("1 1.12 1.25 1.4 1.6 1.8 2 2.24 2.5 2.8 3.15 3.55 4 4.5 5 5.6 6.3 7.1 8 9"),
    "R40": _decade(
        "1 1.06 1.12 1.18 1.25 1.32 1.4 1.5 1.6 1.7 1.8 1.9 2 2.12 2.24 2.36 2.5 2.65 2.8 3 3.15 "
        "3.35 3.55 3.75 4 4.25 4.5 4.75 5 5.3 5.6 6 6.3 6.7 7.1 7.5 8 8.5 9 9.5"
    ),
}


def preferred_numbers(series: str, low: Fraction, high: Fraction) -> tuple[Fraction, ...]:
    """Return the preferred numbers of a series from low to high, both included and positive.

    series: a key of PREFERRED. The values of a decade are those of the first times a power of 10.
    """
    first, last = (math.floor(math.log10(float(end))) for end in (low, high))
    decades = (Fraction(10) ** k for k in range(first - 1, last + 2))
    values = (scale * number for scale in decades for number in PREFERRED[series])
    return tuple(value for value in values if low <= value <= high)
