"""Preferred numbers of ISO 3 against the exact terms of their series."""

from fractions import Fraction

import pytest

from gearopt.physics.preferred_numbers import PREFERRED, preferred_numbers


def test_the_series_are_as_far_off_as_the_standard_says():
    """ISO 3: preferred numbers differ from the terms by +1.26 to -1.01 %."""
    for name, values in PREFERRED.items():
        assert len(values) == int(name[1:])
    off = [float(value) / 10.0 ** (k / 40) - 1.0 for k, value in enumerate(PREFERRED["R40"])]
    assert max(off) == pytest.approx(0.0126, abs=5e-5) and min(off) == pytest.approx(
        -0.0101, abs=5e-5
    )
    assert PREFERRED["R10"] == PREFERRED["R20"][::2] and PREFERRED["R20"] == PREFERRED["R40"][::2]


def test_values_between_two_ends_are_those_of_all_decades():
    found = preferred_numbers("R10", Fraction(1, 2), Fraction(125))
    assert found[0] == Fraction(1, 2) and found[-1] == 125
    assert len(found) == 25 and list(found) == sorted(found)
    assert preferred_numbers("R20", Fraction(101), Fraction(111)) == ()
