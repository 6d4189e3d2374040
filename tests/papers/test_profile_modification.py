"""docs/profile_modification.md: its tables, and thirteen errata with evidence made another way."""

import math
import re
from importlib import import_module
from pathlib import Path

import hwang
import numpy as np
import pytest
from campaigns import few
from scipy.integrate import quad

from gearopt.physics.agma.stress import bending_stress, contact_stress
from gearopt.physics.tooth.trapezoid import trapezoid

PAGE = (Path(__file__).parents[2] / "docs" / "profile_modification.md").read_text(encoding="utf-8")
MEMBER = hwang.ELASTIC.members[0]
SHAPE = trapezoid(MEMBER, "A")
LOAD = float(MEMBER.load_line(hwang.PATH.curvatures[0]).crossing) - SHAPE.base


@pytest.fixture(scope="module")
def rows():
    return hwang.errata_rows()


def row_of(rows, number):
    assert f"| {number} | {rows[number]} |\n" in PAGE
    return rows[number]


def width(x):
    """Of the cantilever at a height x: a rectangle, then a trapezoid, by two points of a line."""
    slope = (SHAPE.tip_width - SHAPE.root_width) / (SHAPE.height - SHAPE.rectangle)
    return SHAPE.root_width + slope * max(x - SHAPE.rectangle, 0.0)


def test_there_are_thirteen(rows):
    assert list(rows) == list(range(1, 14))


def test_erratum_01_a_length_is_missing(rows):
    """Corrected, a number in any unit, equal to the integral; as printed another one in inches."""
    exact = quad(lambda x: 12.0 * (LOAD - x) ** 2 / width(x) ** 3, 0.0, LOAD, points=(1.0,))[0]
    printed, right, ours, _ = hwang.brackets()
    assert right == pytest.approx(exact, rel=1e-6) and ours == pytest.approx(exact, rel=1e-6)
    other = hwang.brackets(1.0 / 25.4)
    assert other[1] == pytest.approx(right, rel=1e-10) and other[0] > 1.1 * printed
    assert f"{printed:.1f} as printed" in row_of(rows, 1)


def test_erratum_02_nothing_at_the_foot_of_the_trapezoid(rows):
    """Z (4 - Z) - 2 ln Z - 3 and its first two derivatives vanish at Z = 1; as printed it is 3."""

    def bracket(z):
        return z * (4.0 - z) - 2.0 * math.log(z) - 3.0

    h = 1e-4
    assert bracket(1.0) == 0.0 and 1.0 * (4.0 - 1.0) == 3.0
    assert abs(bracket(1.0 + h) - bracket(1.0 - h)) / (2 * h) < 1e-6
    assert abs(bracket(1.0 + h) + bracket(1.0 - h)) / h**2 < 1e-3
    assert "by 3 instead of 0" in row_of(rows, 2)


def test_erratum_03_where_the_flanks_meet(rows):
    """The width is 0 at Q = (h S_F - C S_K)/(S_F - S_K), and Z S_F where the load acts."""
    s_f, s_k, h, c = SHAPE.root_width, SHAPE.tip_width, SHAPE.height, SHAPE.rectangle
    q = (h * s_f - c * s_k) / (s_f - s_k)
    assert width(q) == pytest.approx(0.0, abs=1e-12)
    z = (q - LOAD) / (q - c)
    assert width(LOAD) == pytest.approx(z * s_f, rel=1e-12)
    assert f"here {z:.3f}" in row_of(rows, 3)


def test_erratum_04_a_label_is_out_of_place(rows):
    """As the equations are labelled in print, in their order; (8) stands in a heading."""
    labels = [*range(1, 8), *range(9, 21)]
    assert sorted({*range(1, 21)} - {*labels}) == [8]
    assert "(8) in the heading of section 3-3" in row_of(rows, 4)


def test_erratum_05_shear_and_compression(rows):
    """6/5: the energy of a parabola of shear stress over that of its mean; compression apart."""
    energy = quad(lambda t: (1.5 * (1.0 - 4.0 * t**2)) ** 2, -0.5, 0.5)[0]
    assert energy == pytest.approx(1.2, rel=1e-12)
    pressed, slender = hwang.axial()
    line = MEMBER.load_line(hwang.PATH.radii_of_curvature(hwang.PATH.end)[0])
    assert math.degrees(line.angle) == pytest.approx(28.004, abs=1e-3)  # as computed elsewhere
    plain = hwang.FORCE * math.sin(math.radians(28.004)) ** 2 * slender * 0.91 / (206e3 * 30.0)
    assert pressed == pytest.approx(1e3 * plain, rel=1e-4) and 0.25 < pressed < 0.33
    assert f"{pressed:.2f} µm" in row_of(rows, 5)


def test_erratum_06_a_sign_and_a_logarithm(rows):
    """Two steel cylinders, plane strain: Johnson's approach of two points at given depths."""
    assert 1.09 / 0.91 == pytest.approx(1.198, abs=5e-4)
    low, high, linear = hwang.hertz()
    assert linear == pytest.approx(1e3 * 4.0 * hwang.FORCE * 0.91 / (math.pi * 206e3 * 30.0))
    rho = 1.0 / sum(1.0 / r for r in hwang.PATH.curvatures)
    wide = math.sqrt(8.0 * hwang.FORCE * 0.91 * rho / (math.pi * 206e3 * 30.0))
    lines = hwang.ELASTIC.load_lines(0.0)
    parts = [2.0 * math.log(2.0 * float(line.depth) / wide) - 0.3 / 0.7 for line in lines]
    at_pitch = 1e3 * hwang.FORCE * 0.91 / (math.pi * 206e3 * 30.0) * sum(parts)
    assert low <= at_pitch / linear <= high
    assert f"{low:.1f} to {high:.1f} times" in row_of(rows, 6)


def test_erratum_07_the_middle_is_not_the_mean(rows):
    """Slopes of a half plane under 12 M x/S^3 on -S/2 to S/2, with E = M = S = 1.

    u'(x) = 2/pi int p(t)/(t - x) dt, its principal value; the mean is weighed by the pressure.
    """
    middle = 2.0 * quad(lambda t: 2.0 / math.pi * 12.0 * t / t, 1e-12, 0.5)[0]
    assert middle == pytest.approx(24.0 / math.pi, rel=1e-9)

    def sunk(x):
        whole = quad(lambda t: 12.0 * t * math.log(abs(t - x)), -0.5, 0.5, points=(x,))[0]
        return -2.0 / math.pi * whole

    mean = quad(lambda x: 12.0 * x * sunk(x), -0.5, 0.5, epsabs=1e-7)[0]
    assert mean == pytest.approx(18.0 / math.pi, rel=1e-5)
    assert "43 to 322 % too stiff as printed" in row_of(rows, 7)


def test_erratum_08_a_sign(rows):
    """Both unknowns from F_1 + F_2 = F and F_1/K_1 + e_1 = F_2/K_2 + e_2."""
    (k1, k2), (e1, e2), load = hwang.EXAMPLE
    exact = np.linalg.solve([[1.0, 1.0], [1.0 / k1, -1.0 / k2]], [load, e2 - e1])
    first, printed, right = hwang.share_of(*hwang.EXAMPLE)
    assert [first, right] == pytest.approx(exact, rel=1e-12) and first + printed < 0.81 * load
    assert "433.33 N corrected" in row_of(rows, 8)


def test_erratum_09_neighbours_and_tension(rows):
    """The amount that unloads a pair, by letting a dense 2 x 2 compliance carry nothing there."""
    own, corrected = hwang.amounts(0.0), hwang.amounts(hwang.COUPLING)
    alone = hwang.compliance(hwang.PATH.lowest_single)
    outer = hwang.compliance(hwang.PATH.end)
    c12 = hwang.COUPLING
    matrix = np.array([[alone, c12], [c12, outer]])
    forces = np.array([hwang.FORCE, 0.0])
    needed = matrix @ forces  # the gears approach by the first; the other pair must lack the rest
    assert 1e3 * (needed[0] - needed[1]) == pytest.approx(corrected[0], rel=1e-9)
    assert 1e3 * needed[0] == pytest.approx(own[0], rel=1e-9)
    assert own[0] / corrected[0] == pytest.approx(1.39, abs=5e-3)
    assert hwang.share_of((4e5, 4e5), (0.03, 0.0), hwang.FORCE)[0] < 0.0
    row_of(rows, 9)


def test_erratum_10_symbols(rows):
    """1/(pi 2 (1 - 0.09)/206000 MPa) has the unit MPa, and C_p is its square root."""
    modulus = 206000.0 / (2.0 * math.pi * 0.91)
    assert f"{math.sqrt(modulus):.2f} for steel" in row_of(rows, 10)


def test_erratum_11_a_year(rows):
    assert 1900 + int(re.search(r"2001-B(\d\d)", row_of(rows, 11))[1]) == 1988


def test_erratum_12_only_the_sum_counts(rows):
    first, second = hwang.PATH.radii_of_curvature(np.linspace(-7.0, 7.0, 9))
    assert first / (first + second) + second / (first + second) == pytest.approx(np.ones(9))
    row_of(rows, 12)


def test_erratum_13_smooth_load_is_no_even_motion(rows):
    """Between coupled pairs of equal compliance both shapes give one ramp, by (19) with e."""
    x = np.linspace(0.0, 1.0, 11)
    straight, curved = ((1.0 - x) ** p - x**p for p in (1.0, 2.0))
    assert straight == pytest.approx(curved, abs=1e-12)  # e_1 - e_2 of equal amounts
    line, curve = hwang.short(hwang.COUPLING, 1.0), hwang.short(hwang.COUPLING, 2.0)
    assert line == pytest.approx(0.888, abs=2e-3) and curve == pytest.approx(2.168, abs=0.02)
    assert hwang.ramp(2.0) < 0.02 < 0.4 < curve / hwang.peak_to_peak(hwang.mesh())
    row_of(rows, 13)


def test_tables_of_the_page():
    """Finite elements of other meshes [N/(mm um)] beside our models; rules at the torque."""
    for row in (*hwang.levels(), *hwang.rules()):
        assert f"{row}\n" in PAGE
    assert "| finite elements, by others | 9.30 | 12.49 | 12.68 | 12.62 | 9.58 |" in PAGE
    published = {"independent": 7.205, "coupled": 4.981}  # um, on 48 positions
    found = hwang.peak_to_peak(hwang.mesh(0.0)), hwang.peak_to_peak(hwang.mesh())
    assert found == pytest.approx(tuple(published.values()), abs=0.02)
    for value in found:
        assert f"{value:.2f}" in PAGE


@pytest.mark.parametrize("model, loads, straight, curved", few(hwang.BEST, 1))
def test_best_relief_of_the_published_cases(model, loads, straight, curved):
    """Proven values below both published ones, and larger as positions are added."""
    row = hwang.best_row(model, loads, straight, curved)
    assert f"{row}\n" in PAGE
    for cell, published in zip(row[2:-2].split(" | ")[2:], (straight, curved), strict=True):
        known, even, ends, finer = map(float, cell.split(" / "))
        assert even < known == published and even <= ends <= finer < 1.3 * even


def test_every_function_of_the_table_of_equations_is_there():
    named = re.findall(r"`((?:physics|formulations|scenes)\.[\w.]+)`", PAGE)
    assert len(named) > 14
    for name in named:
        module, _, attribute = name.rpartition(".")
        assert hasattr(import_module(f"gearopt.{module}"), attribute), name


def test_equations_1_and_3_have_their_quotients():
    """In the edition of 1988 the dynamic factor divides: K_v = 0.8 there is 1.25 in our own."""
    bending = 1000.0 * 1.25 / 0.8 / (30.0 * 3.0) * 1.1 * 1.2 / 0.4
    factors = 1.25 * (1.0 / 0.8) * 1.1 * 1.2
    assert bending_stress(1000.0, 30.0, 3.0, 0.4, factors) == pytest.approx(bending, rel=1e-12)
    contact = 190.0 * math.sqrt(1000.0 * 1.25 / 0.8 * 1.1 / (75.0 * 30.0) * 1.2 / 0.1)
    assert contact_stress(190.0, 1000.0, 30.0, 75.0, 0.1, factors) == pytest.approx(contact)
