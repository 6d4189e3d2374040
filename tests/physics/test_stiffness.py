"""The stiffness chain against known numbers and limit cases."""

import math

import numpy as np
import pytest

from gearopt.physics.stiffness import (
    lewis_form_factor,
    locked_frequency,
    mesh_compliance,
    output_compliance,
    shaft_compliance,
    specific_pair_stiffness,
    stiffness_of_frequency,
    tooth_factor,
)

GF_CM = 9.80665e-2  # N mm
E, G = 1.97e9 * 98.0665e-6, 8.78e8 * 98.0665e-6  # MPa, from gf/cm2


def between(z, low, high):
    """Linear in 1/z between two lines of Shigley's table of Lewis factors."""
    (z_low, y_low), (z_high, y_high) = low, high
    return y_high + (1 / z - 1 / z_high) / (1 / z_low - 1 / z_high) * (y_low - y_high)


LEWIS_Y = (  # of 16, 96, 26, 208 teeth: 0.2960, 0.4455, 0.3460, 0.4667
    0.296,
    between(96, (75, 0.435), (100, 0.447)),
    0.346,
    between(208, (150, 0.460), (300, 0.472)),
)


def chain():
    """Mesh 34, shaft 2 and mesh 12, seen at their shafts, and their downstream ratios."""
    z = [tooth_factor(y / math.pi) for y in LEWIS_Y]
    k_12, k_34 = (
        specific_pair_stiffness(E, z[0], E, z[1]),
        specific_pair_stiffness(E, z[2], E, z[3]),
    )
    parts = (
        mesh_compliance(k_34, 6.0, 104.0),
        shaft_compliance(G, 8.0, 50.0),
        mesh_compliance(k_12, 6.0, 48.0),
    )
    return parts, (1.0, 8.0, 8.0), (k_12, k_34)


def test_tooth_factors_and_specific_pair_stiffness():
    z = [tooth_factor(y / math.pi) for y in LEWIS_Y]
    assert z == pytest.approx([0.1018, 0.1117, 0.1059, 0.1126], abs=6e-5)
    _, _, stiffness = chain()
    assert stiffness == pytest.approx([10.29e3, 10.54e3], rel=5e-4)


def test_chain_of_the_paper():
    parts, ratios, _ = chain()
    assert 1.0 / parts[1] / GF_CM == pytest.approx(7.061e6, rel=1e-4)
    total = output_compliance(parts, ratios)
    assert 1.0 / total / GF_CM == pytest.approx(3.535e8, rel=2e-4)
    assert 1.0 / total == pytest.approx(3.466e7, rel=2e-4)  # 3.466e4 N m/rad
    shares = [c / n**2 / total for c, n in zip(parts, ratios, strict=True)]
    assert shares == pytest.approx([0.203, 0.782, 0.015], abs=6e-4)
    assert 421.7 * total == pytest.approx(1.217e-5, rel=5e-4)  # 4.3 kgf cm
    assert locked_frequency(1.0 / total, 19.8) == pytest.approx(210.6, abs=0.05)


def test_a_locked_motor_is_the_limit_of_a_two_inertia_eigenproblem():
    """Free-free: load and heavy motor through a gear of ratio N on one spring, by eigenvalues."""
    k, load, motor, n = 3.4663e7, 19.8, 8.6e9, 48.0
    matrix = np.array([[k / load, -k / (n * load)], [-k / (n * motor), k / (n * n * motor)]])
    omega = math.sqrt(max(np.linalg.eigvals(matrix).real))
    assert locked_frequency(k, load) == pytest.approx(omega / (2 * math.pi), rel=1e-11)
    assert locked_frequency(stiffness_of_frequency(210.6, load), load) == pytest.approx(210.6)


def test_lewis_factor_lies_above_the_table_by_up_to_nine_percent():
    table = {16: 0.296, 20: 0.322, 26: 0.346, 30: 0.359, 43: 0.397, 60: 0.422, 300: 0.472}
    excess = [lewis_form_factor(z) / y - 1.0 for z, y in table.items()]
    assert 0.0 < min(excess) and 0.08 < max(excess) < 0.09
