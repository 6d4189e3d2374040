"""Factors of AGMA 2001-D04 against worked examples, their charts and their own joints."""

import math

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.agma.allowables import PSI
from gearopt.physics.agma.factors import (
    ALIGNMENT,
    FEET_PER_MINUTE,
    INCH,
    RELIABILITY,
    alignment_factor,
    dynamic_factor,
    elastic_coefficient,
    hardness_ratio_factor,
    highest_speed,
    lewis_form,
    load_distribution_factor,
    proportion_factor,
    quality_of_accuracy,
    reliability_factor,
    rim_factor,
    rim_factor_b88,
    size_factor,
    surface_hardened_factor,
    temperature_factor,
)
from gearopt.physics.agma.life import bending_curve, pitting_curve
from gearopt.physics.agma.stress import (
    bending_safety,
    bending_stress,
    contact_safety,
    contact_stress,
    tangential_load,
)

MICROMETRE = 1e-3


def test_dynamic_factors_of_examples():
    """Shigley 14-4: Q_v 6, 801.1 ft/min: 1.377; 14-5: 925 ft/min: 1.404. B88: the reciprocal."""
    assert dynamic_factor(801.1 * FEET_PER_MINUTE, 6) == pytest.approx(1.377, abs=6e-4)
    assert dynamic_factor(925.0 * FEET_PER_MINUTE, 6) == pytest.approx(1.404, abs=6e-4)
    assert dynamic_factor(100.0 * FEET_PER_MINUTE, 5) == pytest.approx(1.2)  # (50 + 10)/50
    assert dynamic_factor(0.0, 9) == 1.0


def test_the_metric_form_of_the_dynamic_factor_is_nearly_the_same():
    """2101 has sqrt(200 v), v in m/s, for sqrt(196.85 v): K_v differs by less than 0.5 %."""
    for quality in range(6, 12):
        b = 0.25 * (12 - quality) ** (2 / 3)
        a = 50 + 56 * (1 - b)
        for v in (1.0, 10.0, 30.0):
            metric = ((a + math.sqrt(200 * v)) / a) ** b
            assert dynamic_factor(1e3 * v, quality) == pytest.approx(metric, rel=5e-3)


def test_speeds_at_which_the_curves_end():
    """2500 ft/min for Q_v 5; (A + Q_v - 3)^2: 59.77 and 3 for Q_v 6."""
    assert highest_speed(5) == pytest.approx(2500 * FEET_PER_MINUTE)
    assert highest_speed(6) / FEET_PER_MINUTE == pytest.approx((59.773 + 3) ** 2, rel=1e-4)
    assert 1e-3 * highest_speed(11) == pytest.approx(50.0, rel=0.03)  # about 10,000 ft/min


@pytest.mark.parametrize("quality", [4, 12, 4.9])
def test_qualities_without_a_curve_are_refused(quality):
    with pytest.raises(ValueError, match="Q_v"):
        dynamic_factor(1e3, quality)


def test_accuracies_of_the_later_edition_are_the_qualities_of_the_earlier():
    """D04: B = (A_v - 5)^(2/3)/4, C = 50 + 56 (1 - B), K_v = (C/(C + sqrt(196.85 v)))^-B, v in m/s.

    Another program: A_v 11, 10 m/s: 1.582 (exponent 0.667). AGMA: the curves of C95, renamed.
    """
    assert dynamic_factor(1e4, quality_of_accuracy(11)) == pytest.approx(1.582, abs=1e-3)
    for accuracy in range(6, 12):
        b = 0.25 * (accuracy - 5.0) ** (2 / 3)
        c = 50.0 + 56.0 * (1.0 - b)
        for v in (1.0, 10.0, 30.0):
            later = (c / (c + math.sqrt(196.85 * v))) ** -b
            found = dynamic_factor(1e3 * v, quality_of_accuracy(accuracy))
            assert found == pytest.approx(later, rel=1e-5)
    assert quality_of_accuracy(12) == 5.0
    for accuracy in (5, 13):
        with pytest.raises(ValueError, match="A_v"):
            quality_of_accuracy(accuracy)


# Shigley, table 14-2, in public transcriptions: teeth, Y
LEWIS_TABLE = (
    "12 .245 13 .261 14 .277 15 .290 16 .296 17 .303 18 .309 19 .314 20 .322 21 .328 22 .331 24 "
    ".337 26 .346 28 .353 30 .359 34 .371 38 .384 43 .397 50 .409 60 .422 75 .435 100 .447 150 "
    ".460 300 .472 400 .480"
)


def test_lewis_form_factors_of_the_table():
    numbers = np.array(LEWIS_TABLE.split(), float)
    assert np.array_equal(lewis_form(numbers[::2]), numbers[1::2])
    assert lewis_form(11) == 0.245 and lewis_form(401) == 0.485
    assert lewis_form(72) == pytest.approx(0.4324, rel=1e-12)  # Shigley 14-8


def test_size_factors_of_an_example():
    """Shigley 14-4: F 1.5 in, P 10, 17 and 52 teeth: Y 0.303, 0.412; K_s 1.043, 1.052."""
    assert lewis_form(np.array([17, 52, 1000])) == pytest.approx([0.303, 0.412, 0.485], abs=5e-4)
    found = size_factor(1.5 * INCH, INCH / 10, lewis_form(np.array([17, 52])))
    assert found == pytest.approx([1.043, 1.052], abs=6e-4)
    assert size_factor(5.0, 1.0, 0.3) == 1.0
    # Shigley's metric form: 0.8433 (b m sqrt(Y))^0.0535
    assert size_factor(100.0, 8.0, 0.3) == pytest.approx(0.8433 * (800 * 0.3**0.5) ** 0.0535, 1e-4)


def test_load_distribution_of_examples():
    """Shigley 14-4: F 1.5, d 1.7: 1.22; 14-5: d 1.963: 1.208; commercial enclosed."""
    assert load_distribution_factor(1.5 * INCH, 1.7 * INCH) == pytest.approx(1.22, abs=6e-3)
    assert load_distribution_factor(1.5 * INCH, 1.963 * INCH) == pytest.approx(1.208, abs=6e-4)


def test_parts_of_the_load_distribution():
    """K_m = 1 + C_mc (C_pf C_pm + C_ma C_e), by hand for F = 2, d = 4 inches, open gearing."""
    proportion, alignment = 0.05 - 0.0375 + 0.025, 0.247 + 0.0334 - 4 * 0.765e-4
    found = load_distribution_factor(2 * INCH, 4 * INCH, "open", True, 0.2, True)
    assert found == pytest.approx(1 + 0.8 * (1.1 * proportion + 0.8 * alignment), rel=1e-12)
    assert proportion_factor(2 * INCH, 40 * INCH) == pytest.approx(proportion)  # at least 0.05
    wide = 20 / 300 - 0.1109 + 0.0207 * 20 - 0.000228 * 400
    assert proportion_factor(20 * INCH, 30 * INCH) == pytest.approx(wide, rel=1e-12)


# Metric constants of 2101-D04, per mm, in a public program: A, B, C of every curve
METRIC = {
    "open": (0.247, 0.657e-3, -1.186e-7),
    "commercial": (0.127, 0.622e-3, -1.69e-7),
    "precision": (0.0675, 0.504e-3, -1.44e-7),
    "extra precision": (0.0380, 0.402e-3, -1.27e-7),
}


@pytest.mark.parametrize("curve", ALIGNMENT)
def test_alignment_is_that_of_the_metric_standard(curve):
    """To the digits of its constants, which give less than the inches have."""
    a, b, c = METRIC[curve]
    for width in (25.4, 100.0, 500.0):
        metric = a + b * width + c * width**2
        assert alignment_factor(width, curve) == pytest.approx(metric, abs=1.2e-3)
        assert alignment_factor(width, curve) == pytest.approx(metric, rel=4e-3)


def test_a_load_distribution_of_another_program():
    """b 80, d 160 mm, commercial: 1.2275; of slender pinions F/(10 d) is at least 0.05."""
    assert load_distribution_factor(80.0, 160.0) == pytest.approx(1.2275, abs=6e-5)
    assert proportion_factor(10.0, 60.0) == pytest.approx(0.025, rel=1e-12)
    assert proportion_factor(10.0, 10.0) == pytest.approx(0.1 - 0.025, rel=1e-12)
    assert load_distribution_factor(80.0, 160.0, offset=0.174) == load_distribution_factor(80, 160)
    offset = load_distribution_factor(80.0, 160.0, offset=0.175) - load_distribution_factor(80, 160)
    assert offset == pytest.approx(0.1 * proportion_factor(80.0, 160.0), rel=1e-12)
    wide = 40 * INCH  # 0.0675 + 0.512 - 0.14816; 0.0380 + 0.408 - 0.13152
    assert alignment_factor(wide, "precision") == pytest.approx(0.43134, rel=1e-12)
    assert alignment_factor(wide, "extra precision") == pytest.approx(0.31448, rel=1e-12)


@pytest.mark.parametrize("curve", ALIGNMENT)
def test_load_distribution_never_falls_with_the_face_width(curve):
    """Beyond the curves' end at 40 inches their polynomials would, below 1 and below 0."""
    widths = np.linspace(5.0, 6000.0, 600)
    found = load_distribution_factor(widths, 500.0, curve)
    assert (np.diff(found) > -4e-3).all() and found.min() > 1.0  # the standard's gap at 17 inches
    end = load_distribution_factor(40 * INCH, 500.0, curve)
    beyond = load_distribution_factor(80 * INCH, 500.0, curve)
    assert beyond - end == pytest.approx(40 * INCH / 5000.0, rel=1e-9)


def test_the_curves_join():
    for width, gap in ((1.0, 1e-12), (17.0, 4e-3)):  # the standard's own gap at 17 inches
        below, above = (proportion_factor(width * INCH * s, 20 * INCH) for s in (1, 1 + 1e-12))
        assert above == pytest.approx(below, abs=gap)
    values = [alignment_factor(3 * INCH, curve) for curve in ALIGNMENT]
    assert values == sorted(values, reverse=True)
    with pytest.raises(ValueError, match="commercial"):
        alignment_factor(10.0, "excellent")


def test_rims():
    assert rim_factor(1.2) == pytest.approx(1.0001, abs=1e-4)
    assert rim_factor(0.5) == pytest.approx(2.4, abs=2e-3)  # the chart's end
    assert rim_factor_b88(0.5) == pytest.approx(2.4) and rim_factor_b88(1.3) == 1.0


def test_reliability_and_its_fit():
    for reliability, value in RELIABILITY.items():
        assert reliability_factor(reliability) == pytest.approx(value, abs=0.02)
    assert reliability_factor(0.90) == pytest.approx(0.8328, abs=5e-5)
    assert reliability_factor(0.95) == pytest.approx(0.885, abs=5e-4)  # Shigley 14-8
    assert reliability_factor(0.995) == pytest.approx(0.50 + 0.109 * math.log(200), rel=1e-12)
    assert RELIABILITY == {0.5: 0.70, 0.9: 0.85, 0.99: 1.0, 0.999: 1.25, 0.9999: 1.50}


def test_temperature():
    assert temperature_factor(np.array([20.0, 120.0])) == pytest.approx([1.0, 1.0])
    assert temperature_factor(160.0) == pytest.approx((460 + 320) / 620)
    assert temperature_factor(121.0) == pytest.approx((460 + 249.8) / 620)


def test_elastic_coefficients():
    """189.81 of E 206000, nu 0.3 (ISO/TR 6336-30: Z_E 189.8117); 2285 sqrt(psi) of 30e6 psi."""
    assert elastic_coefficient(206e3, 0.3, 206e3, 0.3) == pytest.approx(189.8117, abs=5e-5)
    american = elastic_coefficient(30e6 * PSI, 0.3, 30e6 * PSI, 0.3) / PSI**0.5
    assert american == pytest.approx(2290.6, abs=0.1)
    cast = elastic_coefficient(206e3, 0.3, 173e3, 0.3)
    assert 170 < cast < 189  # steel on nodular iron: 2160 sqrt(psi) = 179 in the standard's table


def test_hardness_ratios():
    """Shigley 14-4: HB 240/200, u 52/17: 1.005; limits of the chart at 1.2 and 1.7."""
    assert hardness_ratio_factor(240, 200, 52 / 17) == pytest.approx(1.005, abs=2e-4)
    assert hardness_ratio_factor(230, 200, 5.0) == 1.0
    assert hardness_ratio_factor(400, 200, 5.0) == pytest.approx(1 + 4 * 0.00698)
    edge = [hardness_ratio_factor(1.7 * 200 + s, 200, 5.0) for s in (-1e-6, 1e-6)]
    assert edge[0] == pytest.approx(edge[1], abs=3e-5)
    assert hardness_ratio_factor(342, 200, 5.0) == pytest.approx(1 + 4 * 0.00698, rel=1e-12)
    assert hardness_ratio_factor(400, 200, 30.0) == pytest.approx(1 + 19 * 0.00698, rel=1e-12)
    assert hardness_ratio_factor(250, 200, 3.0) == pytest.approx(1 + 2 * (8.98 * 1.25 - 8.29) / 1e3)
    inches = surface_hardened_factor(16 * 25.4e-6, 200.0)  # 16 microinches
    assert inches == pytest.approx(1 + 0.00075 * math.exp(-0.0112 * 16) * 250)
    assert surface_hardened_factor(1 * MICROMETRE, 450.0) == 1.0


def test_stresses_scale_with_load_and_their_safety():
    """By hand: W_t 1000 N, b 10, m 2, J 0.4: 125 MPa; C_p 190, d 40, I 0.1: 950 MPa."""
    assert tangential_load(2e7, 100.0, 40.0) == pytest.approx(1e4)
    assert bending_stress(1000.0, 10.0, 2.0, 0.4) == pytest.approx(125.0)
    pressed = contact_stress(190.0, 1000.0, 10.0, 40.0, 0.1)
    assert pressed == pytest.approx(190.0 * 25.0**0.5)
    assert bending_safety(250.0, 0.9, 1.0, 1.0, 125.0) == pytest.approx(1.8)
    safety = contact_safety(1000.0, 0.95, 1.0, 1.0, 1.0, pressed)
    power = safety**2  # by which the load may grow
    assert contact_stress(190.0, 1000.0 * power, 10.0, 40.0, 0.1) == pytest.approx(950.0)


LAWS = [
    lambda a, b: dynamic_factor(1e4 * a, 7.0 + b),
    lambda a, b: highest_speed(7.0 + b),
    lambda a, b: size_factor(100.0 * a, 5.0 * b, 0.3),
    lambda a, b: load_distribution_factor(100.0 * a, 60.0 * b),
    lambda a, b: load_distribution_factor(500.0 * a, 600.0 * b, "open", True, 0.3, True),
    lambda a, b: rim_factor(0.5 * a),
    lambda a, b: reliability_factor(0.6 * a),
    lambda a, b: temperature_factor(100.0 * a),
    lambda a, b: elastic_coefficient(2e5 * a, 0.3, 2e5 * b, 0.25),
    lambda a, b: hardness_ratio_factor(300.0 * a, 250.0 * b, 3.0),
    lambda a, b: surface_hardened_factor(1e-3 * a, 200.0 * b),
    lambda a, b: bending_stress(1e3 * a, 20.0, 3.0, 0.4 * b),
    lambda a, b: contact_stress(190.0, 1e3 * a, 20.0, 50.0 * b, 0.1),
    lambda a, b: rim_factor_b88(0.8 * a + 0.1 * b),
    lambda a, b: bending_safety(250.0 * a, 0.9, 1.0, 1.0, 125.0 * b),
    lambda a, b: contact_safety(1000.0 * a, 0.95, 1.0, 1.0, 1.0, 900.0 * b),
    lambda a, b: bending_curve("through-hardened", 250.0).factor(1e5 * a * b),
    lambda a, b: bending_curve("carburised").factor(1e8 * a * b),
    lambda a, b: pitting_curve("through-hardened").factor(1e6 * a * b),
    lambda a, b: pitting_curve("nitrided", "critical").factor(1e8 * a * b),
]


@pytest.mark.parametrize("law", LAWS)
def test_traced_equals_batch_and_derivatives_central_differences(law):
    point = np.array([1.31, 1.27])
    x = ca.SX.sym("x", 2)
    with legacy_numpy():
        value = law(*ca.vertsplit(x))
    function = ca.Function("law", [x], [value, ca.gradient(value, x)])
    traced, gradient = (np.array(v).ravel() for v in function(point))
    assert np.allclose(law(*np.tile(point, (3, 1)).T), traced, rtol=1e-14, atol=0)
    for k in range(2):
        ends = [law(*(point + s * 1e-5 * np.eye(2)[k])) for s in (1, -1)]
        assert gradient[k] == pytest.approx((ends[0] - ends[1]) / 2e-5, rel=1e-7, abs=1e-9)
