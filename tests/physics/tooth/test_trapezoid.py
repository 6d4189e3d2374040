"""The trapezoid of Nakada and Utagawa: its integrals in 60 digits, its three conventions."""

import decimal
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from reference_pairs import elastic

from gearopt.physics.tooth.trapezoid import (
    Trapezoid,
    bending_integral,
    bending_series,
    shear_integral,
    shear_series,
    trapezoid,
)


def exact(eps, power):
    """g (power 3) and l (power 1) in 60 digits."""
    with decimal.localcontext(prec=60):
        e = Decimal(float(eps))
        log = (1 - e).ln()
        return float((-2 * e - e * e - 2 * log) / e**3 if power == 3 else -log / e)


def printed(s_f, s_k, h, c, s_c):
    """S_F^3 times the integral, in the paper's form, which divides by S_F - S_K."""
    with np.errstate(all="ignore"):
        q = np.float64(h * s_f - c * s_k) / np.float64(s_f - s_k)
        z = (q - s_c) / (q - c)
        above = 6 * (q - c) ** 3 * (z * (4 - z) - 2 * np.log(z) - 3)
        return 12 * (s_c * c * (s_c - c) + c**3 / 3) + above


def truth(s_f, s_k, h, c, s_c):
    """The same in 60 digits, of the numbers as they are."""
    with decimal.localcontext(prec=60):
        s_f, s_k, h, c, s_c = map(Decimal, (s_f, s_k, h, c, s_c))
        q = (h * s_f - c * s_k) / (s_f - s_k)
        z = (q - s_c) / (q - c)
        above = 6 * (q - c) ** 3 * (z * (4 - z) - 2 * z.ln() - 3)
        return float(12 * (s_c * c * (s_c - c) + c**3 / 3) + above)


def stable(s_f, s_k, h, c, s_c):
    return float(bending_integral(Trapezoid(0.0, s_f, s_k, h, c), s_c)) * s_f**3


def test_limits_of_the_series():
    assert bending_series(0.0) == 2.0 / 3.0 and shear_series(0.0) == 1.0
    known = [1.91187, 2.73686, 3.71945, 6.44156, 15.42571]
    assert bending_series([0.8, 0.9, 0.95, 0.99, 0.9999]) == pytest.approx(known, abs=5e-6)
    step = 1e-6
    assert (bending_series(step) - bending_series(-step)) / (2 * step) == pytest.approx(0.5)
    assert (shear_series(step) - shear_series(-step)) / (2 * step) == pytest.approx(0.5)


def test_series_to_rounding_from_a_wide_tip_to_a_point():
    eps = np.concatenate((np.linspace(-5.0, -0.151, 40), np.linspace(-0.149, 0.1499, 41)))
    eps = np.concatenate((eps[eps != 0.0], np.linspace(0.15, 0.9999, 60)))
    assert bending_series(eps) == pytest.approx([exact(e, 3) for e in eps], rel=2e-14)
    assert shear_series(eps) == pytest.approx([exact(e, 1) for e in eps], rel=2e-14)


@pytest.mark.parametrize(
    ("ratio", "lost"),
    [
        (0.36, 1e-15),
        (0.9, 1e-12),
        (0.99, 8e-10),
        (0.999, 3e-7),
        (0.9999, 6e-4),
        (1.0 - 1e-6, 0.34),
        (1.0 - 1e-8, 1e9),
    ],
)
def test_the_printed_form_loses_all_digits_near_a_parallel_sided_tooth(ratio, lost):
    shape = 6.0, 6.0 * ratio, 6.3, 1.2, 4.0
    known = truth(*shape)
    assert stable(*shape) == pytest.approx(known, rel=2e-15)
    error = abs(float(printed(*shape)) / known - 1.0)
    assert lost / 10.0 < max(error, 2e-16) < lost * 10.0


def test_a_parallel_sided_tooth_is_exact():
    assert np.isnan(printed(6.0, 6.0, 6.3, 1.2, 4.0))
    s_f, c, s_c = Fraction(6), Fraction(6, 5), Fraction(4)
    known = 12 * s_c**3 / 3 / s_f**3  # 12 int (S_C - x)^2 dx/S_F^3
    shape = Trapezoid(0.0, 6.0, 6.0, 6.3, float(c))
    assert float(bending_integral(shape, 4.0)) == pytest.approx(float(known), rel=2e-15)
    assert float(shear_integral(shape, 4.0)) == pytest.approx(4.0 / 6.0, rel=1e-15)


@pytest.mark.parametrize(("above", "lost"), [(1e-2, 4e-7), (1e-4, 0.36), (1e-6, 6e5)])
def test_a_load_close_above_the_rectangle(above, lost):
    shape = 6.0, 2.16, 6.3, 0.0, above
    known = truth(*shape)
    assert stable(*shape) == pytest.approx(known, rel=1e-15)
    error = abs(float(printed(*shape)) / known - 1.0)
    assert lost / 10.0 < error < lost * 10.0


def test_a_tooth_wider_at_its_tip_against_quadrature():
    s_f, s_k, h, c, s_c = 6.0, 7.2, 6.3, 1.2, 4.0
    x = np.linspace(0.0, s_c, 400_001)
    width = np.where(x < c, s_f, s_f + (s_k - s_f) * (x - c) / (h - c))
    shape = Trapezoid(0.0, s_f, s_k, h, c)
    known = np.trapezoid(12.0 * (s_c - x) ** 2 / width**3, x)
    assert float(bending_integral(shape, s_c)) == pytest.approx(known, rel=1e-9)
    assert float(shear_integral(shape, s_c)) == pytest.approx(np.trapezoid(1.0 / width, x))


@pytest.mark.parametrize(
    ("convention", "known"),
    [  # y0, S_F, S_K, h, C of pinion and wheel, by another program
        (
            "A",
            ([34.2146, 6.0485, 2.1592, 6.2710, 1.1506], [71.7836, 6.5124, 2.3262, 6.2077, 0.6232]),
        ),
        ("B", ([33.75, 6.0485, 2.1592, 6.7356, 1.6152], [71.25, 6.5124, 2.3262, 6.7413, 1.1567])),
        ("C", ([33.75, 5.4736, 2.1592, 6.7356, 1.6152], [71.25, 6.0700, 2.3262, 6.7413, 1.1567])),
    ],
)
def test_three_conventions_of_the_cantilever(convention, known):
    made = [trapezoid(each, convention) for each in elastic("reference").members]
    for shape, numbers in zip(made, known, strict=True):
        found = shape.base, shape.root_width, shape.tip_width, shape.height, shape.rectangle
        assert found == pytest.approx(numbers, abs=6e-5)
