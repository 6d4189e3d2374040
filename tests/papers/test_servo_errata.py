"""The errata of docs/servo_train.md, one by one: the number that shows each, made another way."""

import math
import re
from fractions import Fraction as F
from pathlib import Path

import numpy as np
import pytest
import youn
import youn_errata
import youn_words as words
from youn import ANGLES, GF_CM, OTHER, PER_CM2, TABLE_4, angles

from gearopt.physics.servo_drive import load_acceleration
from gearopt.physics.tolerances import total_pitch_tolerance

PAGE = (Path(__file__).parents[2] / "docs" / "servo_train.md").read_text(encoding="utf-8")


def row_of(number):
    text = youn_errata.errata_rows()[number]
    assert f"| {number} | {text} |\n" in PAGE
    return text


def test_there_are_twenty():
    assert list(youn_errata.errata_rows()) == list(range(1, 21))


def test_erratum_01_frictions_not_inertias():
    """Motor: T_M - F_M - T_s = J_M a_M; load: N T_s - F_L = J_L a: solved for both unknowns."""
    n, torque = 48.0, 50.0
    a, shaft = np.linalg.solve([[youn.J_M * n, 1.0], [youn.J_L, -n]], [torque - 3.0, -youn.LOAD])
    made, needed = youn_errata.first()
    assert made == pytest.approx(a, rel=1e-12) and needed == pytest.approx(torque, rel=1e-12)
    assert shaft * n - youn.LOAD == pytest.approx(youn.J_L * a, rel=1e-12)
    assert f"{a:.3f} rad/s²" in row_of(1)


def test_erratum_02_the_slope_has_the_torque():
    """By the quotient rule, in fractions."""
    load, motor, n = F(198, 10), F(86, 10000), 40
    exact = float(50 * (load - n**2 * motor) / (load + n**2 * motor) ** 2)
    assert youn_errata.slope() == pytest.approx(exact, rel=1e-8)
    assert exact == pytest.approx(50.0 * youn_errata.printed_slope(), rel=1e-12)
    root = math.sqrt(youn.J_L / youn.J_M)
    near = load_acceleration(root * np.array([0.999, 1.0, 1.001]), youn.J_L, youn.J_M, 50.0)
    assert near[1] > max(near[0], near[2])
    assert f"{exact:.4f}" in row_of(2)


def test_erratum_03_the_sums_are_lengths():
    tenths = [[round(1e4 * t) for t in row] for row in youn.RADIAL.values()]
    assert [sum(column) for column in zip(*tenths, strict=True)] == [512, 649]
    assert "0.0512, 0.0649 degrees | mm" in row_of(3)


def test_erratum_04_other_wheels():
    """No angle of Table 4 rounds to the printed one; of the other wheels all but two do."""
    mine, other = angles(*TABLE_4), angles(*OTHER)
    assert not [name for name, p in ANGLES.items() if f"{mine[name]:.3f}" == p]
    odd = [name for name, p in ANGLES.items() if f"{other[name]:.3f}" != p]
    assert odd == ["backlash of stage 12", "both at the output"]
    assert float(ANGLES["both at the output"]) / mine["both at the output"] == pytest.approx(
        0.841, abs=5e-4
    )
    row_of(4)


def test_erratum_05_no_wheel_gives_both_angles_of_stage_12():
    for d in np.linspace(45.0, 55.0, 2001):
        made = angles(d, 122.0, OTHER[2])
        names = ("backlash of stage 12", "pitch error of stage 12")
        assert not all(f"{made[name]:.3f}" == ANGLES[name] for name in names)
    assert words.windows()[0][1] < words.windows()[1][0]
    row_of(5)


def test_erratum_06_a_stiffness_at_the_motor():
    """Energy: a twist of shaft 2 by 1 rad turns gear 1 by 6; the same energy, 36 times softer."""
    at_shaft = youn.K_SHAFT * youn.K_34 / (youn.K_SHAFT + youn.K_34)
    assert words.printed_total(youn.K_SHAFT, youn.K_34) == pytest.approx(at_shaft / 6**2)
    assert f"{at_shaft / 36 / 1e6:.3f}e6" in row_of(6)
    assert youn.GEARS[1].teeth / youn.GEARS[0].teeth == 6.0


def test_erratum_07_the_lever_of_a_tangential_spring():
    """Force F on springs E_1 Z_1 b, E_2 Z_2 b in series moves x; torque F r, angle x/r."""
    z = [y / (0.242 + 7.25 * y) for y in (v / math.pi for v in youn.LEWIS)]
    r, force = 52.0, 100.0
    moved = force / (youn.E * z[2] * 6.0) + force / (youn.E * z[3] * 6.0)
    stiffness = force * r / (moved / r)
    assert 1.0 / youn.springs()[0][0] == pytest.approx(stiffness, rel=1e-12)
    assert force / moved / 6.0 == pytest.approx(10.54e3, rel=5e-4)
    text = row_of(7)
    assert f"{4 * force / moved / 6e3:.0f} N/(mm µm)" in text
    assert f"{16 * force / moved / 6e3:.0f}, corrected" in text


def test_erratum_08_the_second_moment_of_a_circle():
    """Pi d^4/32 is the integral of r^2 over the circle; pi d^4/2 holds for the radius."""
    edges = np.linspace(0.0, 4.0, 100_001)
    r = 0.5 * (edges[1:] + edges[:-1])
    polar = np.sum(2.0 * math.pi * r**3 * np.diff(edges))
    stiffness = youn.G * polar / 50.0 / GF_CM
    assert youn.shaft_stiffness() == pytest.approx(stiffness, rel=1e-8)
    literal = math.pi * 8.78e8 * 0.8**4 / (2.0 * 5.0)
    assert youn.shaft_stiffness(literal=True) == pytest.approx(literal, rel=1e-12)
    assert f"{literal / 1e6:.1f}e6 for" in row_of(8) and "16 times" in row_of(8)


def test_erratum_09_lengths_that_give_the_printed_shaft():
    for length, literal, shown in ((7.512, False, "7.5 mm"), (120.19, True, "120 mm")):
        made = youn.shaft_stiffness(length, literal)
        assert made == pytest.approx(youn.K_SHAFT, rel=1e-4) and shown in row_of(9)
    assert youn.K_SHAFT / youn.shaft_stiffness() == pytest.approx(6.66, abs=5e-3)


def test_erratum_10_rad_called_degrees():
    turn = 4300.0 / 1.17e6
    assert f"{turn:.4f}" == str(youn.ELASTIC)
    assert math.degrees(turn) == pytest.approx(0.2106, abs=5e-5)
    assert "0.000697 degrees" in row_of(10) and f"{youn.ELASTIC_AGAIN} in section 3.2" in row_of(10)


def test_erratum_11_the_potentiometer():
    assert F(8, 1000) * F(90, 20) == F(36, 1000) and F(6, 100) / F(90, 20) == F(1, 75)
    assert youn.measured(youn.MEASURED_V) == pytest.approx(0.036, rel=1e-12)
    assert "| 0.036 |" in row_of(11) and "13.3 mV" in row_of(11)


def test_erratum_12_what_a_reversal_shows():
    lash = angles(*TABLE_4)["backlash at the output"]
    assert 0.036 < float(ANGLES["backlash at the output"]) < youn.MEASURED < lash
    assert f"{lash:.4f} by Table 4" in row_of(12)


def test_erratum_13_both_gears_of_a_mesh():
    once = angles(*TABLE_4)["pitch error at the output"]
    both = math.degrees(2 * 2 * 0.029 / 48 / 8 + 2 * 2 * 0.033 / 104)
    assert both == pytest.approx(2.0 * once, rel=1e-12) and f"{both:.4f} for" in row_of(13)


def test_erratum_14_modulus_and_shear_modulus():
    modulus, shear = (v * PER_CM2 for v in (1.97e9, 8.78e8))
    assert modulus / (2.0 * shear) - 1.0 == pytest.approx(0.122, abs=5e-4)
    softer = modulus / 2.56
    assert softer == pytest.approx(75.47e3, rel=1e-4) and "75.5 GPa" in row_of(14)
    share = youn.chain()[1][1]  # of the shaft: the compliance grows by that part
    drop = 1.0 - 1.0 / (1.0 + share * (shear / softer - 1.0))
    assert f"the output {100 * drop:.0f} % softer" in row_of(14)


def test_erratum_15_weights_and_discs():
    share, discs = youn.weights()
    assert discs == pytest.approx((2.34, 84.1, 6.17, 395.0), rel=2e-3)
    assert share == pytest.approx((6.418, 0.131, 0.243, 0.044), rel=1e-2)
    assert youn.GEARS[0].weight_g > discs[2]  # nor is it gear 3
    row_of(15)


def test_erratum_16_no_way_to_tilt_a_full_gear_4():
    """Along a normal n a disc of diameter d and width w takes d sqrt(1 - n_i^2) + w |n_i|."""
    rng = np.random.default_rng(0)
    n = np.abs(rng.normal(size=(200_000, 3)))
    n = np.vstack([n, [1.0, 1.0, 0.0]])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    with np.errstate(divide="ignore"):
        left = (np.array(youn.BOX) - 105.0 * np.sqrt(1.0 - n**2)) / n
    widest = left.min(axis=1)
    assert widest.max() == pytest.approx(youn_errata.diagonal(), rel=1e-12)
    assert widest.argmax() == len(n) - 1
    assert youn.GEARS[3].diameter + 2 * 0.5 == 105.0 and "8.1 mm" in row_of(16)


def test_erratum_17_the_sum_that_is_never_made():
    assert f"= {0.091 + 0.0004 + 0.0037:.4f} is never" in row_of(17)


def test_erratum_18_titles_of_other_subjects():
    text = row_of(18)
    titles = re.findall(r"no\. (\d) is \*([^*]*)\*", text)
    assert [int(n) for n, _ in titles] == [4, 5, 6, 7]
    assert "W-N Gear" in titles[0][1] and "Circular Arc" in titles[1][1]


def test_erratum_19_gram_force():
    """1 gf/cm2 = 9.80665e-3 N/1e-4 m2 = 98.0665 Pa; steel has about 200 and 80 GPa."""
    moduli = [v * 9.80665e-3 / 1e-4 * 1e-9 for v in (1.97e9, 8.78e8)]
    assert 190.0 < moduli[0] < 210.0 and 75.0 < moduli[1] < 90.0
    assert "E is {:.1f} and G {:.1f} GPa".format(*moduli) in row_of(19)


def test_erratum_20_which_grade_the_pitch_errors_are():
    """Between grades 6 and 7: larger than the one, smaller than the other."""
    for deviation, d in ((0.029, 48.0), (0.033, 104.0)):
        six, seven = (total_pitch_tolerance(d, 0.5, grade) for grade in (6, 7))
        assert six < deviation < seven
    text = row_of(20)
    assert "a guess" in text and "unverified)" in text
    assert abs(17 - 6.72 - 11) < abs(17 - 6.72 - 13) and f"Q {17 - 6.72:.1f}" in text
