"""docs/multi_stage.md against gearopt: every row, every erratum, every number in its sentences."""

import itertools
import math
import re
from importlib import import_module
from pathlib import Path

import chong_lee as paper
import chong_lee_rated as rated
import chong_lee_sized as by_rating
import chong_lee_words as words
import numpy as np
import pytest
from chong_lee import DESIGNS, K, recomputed, sixth, train

import gearopt
from gearopt.formulations.drive import processes as process
from gearopt.physics.loads import k_factor

PAGE = (Path(__file__).parents[2] / "docs" / "multi_stage.md").read_text(encoding="utf-8")
PLAIN = " ".join(PAGE.split())
TOTALS = (1450 / 66.5, 110.0)


def row_of(number):
    text = words.errata_rows()[number]
    assert f"| {number} | {text} |\n" in PAGE
    return text


def one(number):
    return recomputed("Table 2, process one")["stages"][number]


ROWS = (
    paper.table_rows,
    paper.total_rows,
    paper.split_rows,
    paper.optimum_rows,
    rated.rated_rows,
    words.rule_rows,
    words.errata_lines,
)


SLOW = [pytest.mark.slow]


@pytest.mark.parametrize(
    "rows", [pytest.param(r, marks=SLOW * (r is rated.rated_rows)) for r in ROWS]
)
def test_every_row_of_every_table_is_recomputed(rows):
    """All rows of a table stand in the page, together, and no other row is among them."""
    assert "|---|\n" + "\n".join(rows()) + "\n\n" in PAGE


def test_every_drive_sized_by_its_rating_has_its_row():
    begun = "[^\n]*\n".join(re.escape(by_rating.first_cells(*case)) for case in by_rating.CASES)
    assert re.search(rf"\|---\|\n{begun}[^\n]*\n\n", PAGE)


@pytest.mark.slow
@pytest.mark.parametrize(("count", "standard", "widths"), by_rating.CASES)
def test_every_row_of_drives_sized_by_their_rating_is_recomputed(count, standard, widths):
    assert f"\n{by_rating.sized_row(count, standard, widths)}\n" in PAGE


@pytest.mark.slow
def test_every_row_of_widened_designs_is_recomputed():
    assert "|---|\n" + "\n".join(by_rating.widened_rows()) + "\n" in PAGE


@pytest.mark.slow
def test_why_iso_takes_more_is_recomputed():
    assert by_rating.why_iso_is_larger() in PLAIN


@pytest.mark.parametrize(
    "sentences", [words.sentences, pytest.param(rated.rated_sentences, marks=SLOW)]
)
def test_every_sentence_with_numbers_is_recomputed(sentences):
    assert not [sentence for sentence in sentences() if sentence not in PLAIN]


def test_the_totals_are_those_of_an_independent_computation():
    """Volumes, ratio errors, K and U as computed apart from gearopt, from the printed tables."""
    known = {
        "elevator": (9781145, 21.7222, -0.377, (0.677, 1.525), (14.92, 28.76)),
        "Table 2, process one": (8708993, 21.6256, -0.821, (1.178, 1.416), (27.05, 31.78)),
        "Table 2, process two": (8261041, 21.6104, -0.890, (1.511, 1.415), (31.91, 31.76)),
        "Table 4, process one": (
            19977138,
            110.3680,
            0.335,
            (0.907, 1.297, 1.440),
            (24.16, 29.83, 32.73),
        ),
        "Table 4, process two": (
            17868914,
            109.0345,
            -0.878,
            (1.561, 1.235, 1.579),
            (41.74, 28.60, 35.16),
        ),
    }
    for name, (volume, ratio, error, contact, root) in known.items():
        made = recomputed(name)
        assert made["gear_volume_mm3"] == pytest.approx(volume, abs=0.5)
        assert made["ratio"] == pytest.approx(ratio, abs=5e-5)
        assert made["ratio_error_percent"] == pytest.approx(error, abs=5.1e-4)
        stages = made["stages"]
        assert [s["k_factor_MPa"] for s in stages] == pytest.approx(contact, abs=5.1e-4)
        assert [s["unit_load_MPa"] for s in stages] == pytest.approx(root, abs=5.1e-3)


def test_what_is_not_marked_in_the_tables_agrees():
    marked = [row for row in paper.table_rows() if "**" in row]
    cells = re.findall(r"([\d.]+) / \*\*([\d.]+)\*\*", "\n".join(marked))
    assert [(a, float(b)) for a, b in cells] == [
        ("198", 197.2),
        ("355.23", 355.288),
        ("219", 218.2),
        ("384.97", 383.976),
    ]


def test_every_equation_has_its_row_and_every_function_exists():
    rows = re.findall(r"^\| (\(\d+\)(?:, second)?) \|.*\|(.*)\|(.*)\|$", PAGE, re.M)
    assert [name for name, _, _ in rows] == [*(f"({n})" for n in range(1, 15)), "(13), second"]
    for name, where, status in rows:
        assert where.strip() or "not used" in status, name
        for path in re.findall(r"`([\w.]+)`", where):
            module, _, function = path.rpartition(".")
            assert callable(getattr(import_module(f"gearopt.{module}"), function))
    assert sum("corrected" in status for _, _, status in rows) == 6


def test_hertz_stress_of_equation_1():
    angle = math.radians(20.0)
    constant = math.sqrt(0.7 / (2.0 / 206e3 * math.cos(angle) * math.sin(angle)))
    assert f"{constant:.1f} sqrt(K) MPa" in PLAIN
    assert f"2.07 MPa is {constant * math.sqrt(2.07):.0f} MPa" in PLAIN


def test_q_factor_of_equation_9():
    for name, (power, speed) in (("elevator", (7.5, 1450.0)), ("Table 4, process one", (8, 3520))):
        for stage in recomputed(name)["stages"]:
            u, a = stage["ratio"], stage["centre_distance_mm"]
            q = power / speed * (u + 1) ** 3 / u
            made = a**2 * stage["face_width_mm"]
            assert made == pytest.approx(4.775e6 * q / stage["k_factor_MPa"], rel=1e-4)
            speed /= u


def test_volume_does_not_depend_on_what_is_left_free():
    """V = (pi T1/2K)(g(u1) + u1 g(u2) + ...), which the sizing problem finds to be least too."""
    for stages, ratios in itertools.product((2, 3), ((5.0, 4.0, 3.0), (2.0, 6.0, 1.5))):
        u = ratios[:stages]
        closed = math.pi * train(stages).torque / (2 * K) * paper.bracket(u)
        assert paper.volume(stages, u) == pytest.approx(closed, rel=1e-12)
    for stages in (2, 3):
        ratios, value = paper.best_split(stages)
        assert paper.volume(stages, ratios) == pytest.approx(value, rel=1e-7)


def test_best_split_is_stationary():
    (u1, _), _ = paper.best_split(2)
    u = TOTALS[0]
    assert 2 * u1 * (1 + 1 / u) + 2 == pytest.approx((u**2 + 1) / u1**2, rel=1e-3)
    assert paper.best_split(2)[0] == pytest.approx((5.8044, 3.7565), abs=3e-4)
    assert paper.best_split(3)[0] == pytest.approx((7.7936, 4.2475, 3.3229), abs=3e-4)


def test_niemann_is_the_limit_for_large_ratios():
    """Minimising the leading terms gives factors 0.794 and 0.610, 1.104 with eq. (7), (8)."""
    big = 1e12
    two = lambda u1: u1**2 + u1 * (big / u1) ** 2  # noqa: E731
    u1 = 2 ** (-1 / 3) * big ** (2 / 3)
    assert two(u1) < min(two(0.999 * u1), two(1.001 * u1))
    assert process.niemann_ratios(big, (K, K))[0] / u1 == pytest.approx(0.8 / 0.794, abs=1e-3)
    v1, v2 = 2 ** (-5 / 7) * big ** (4 / 7), 2 ** (1 / 7) * big ** (2 / 7)
    three = lambda a, b: a**2 + a * b**2 + big**2 / (a * b)  # noqa: E731
    for a, b in itertools.product((0.999, 1.0, 1.001), repeat=2):
        assert three(v1, v2) <= three(a * v1, b * v2)
    found = process.niemann_ratios(big, (K, K, K))
    assert found[0] / v1 == pytest.approx(0.6 / 0.610, abs=1e-3)
    assert found[1] / v2 == pytest.approx(1.1 / 1.104, abs=1e-3)
    for number in (2 ** (-1 / 3), 2 ** (-5 / 7), 2 ** (1 / 7)):
        assert f"= {number:.3f}" in PLAIN


def test_where_496_comes_from():
    low, high = max(124 / 25, 114 / 23), min(125 / 25, 115 / 23)
    assert f"u1 in {low:.2f} to {high:.2f} if z2 is cut" in PLAIN
    low, high = max(123.5 / 25, 113.5 / 23), min(124.5 / 25, 114.5 / 23)
    assert f"in {low:.3f} to {high:.3f} if it is rounded" in PLAIN
    assert low < 119 / 24 < high and f"119/24 = {119 / 24:.3f}" in PLAIN
    ratio = [(u / 0.8) ** 1.5 / TOTALS[0] for u in (4.96, 5.0)]
    assert "s_12 of {:.3f} to {:.3f}".format(*ratio) in PLAIN
    u1 = process.niemann_ratios(TOTALS[0], (1.0, 2.0))[0]
    assert low < u1 < high and f"u1 = {u1:.3f}" in PLAIN


def test_printed_ratios_of_process_one_cut_give_fewer_teeth():
    rows = DESIGNS["Table 4, process one"]
    assert [math.floor(float(r.u) * r.z1) for r in rows] == [228, 104, 86]
    above = (8.482, 4.039, 3.223)
    assert "8.482, 4.039, 3.223" in PLAIN
    assert [math.floor(u * r.z1) for u, r in zip(above, rows, strict=True)] == [229, 105, 87]


@pytest.mark.parametrize("stages", ["elevator", "three_stage"])
def test_the_problem_files_give_the_printed_gears(stages):
    result = gearopt.solve(paper.PROBLEMS / f"{stages}_processes.toml")
    table = "Table 2" if stages == "elevator" else "Table 4"
    for part in result.parts[1:]:
        name = f"{table}, {part.name}"
        keys = ("normal_module_mm", "pinion_teeth", "wheel_teeth")
        made = [tuple(s[key] for key in keys) for s in part.design["stages"]]
        assert made == words.made_of(name)
        assert part.value == pytest.approx(recomputed(name, "ruled")["gear_volume_mm3"], rel=1e-9)


def test_erratum_01_the_square_of_the_centre_distances():
    """f_12 from eq. (2) of equally loaded stages is s^2 (b2/b1)(a2/a1)^2, not the cube."""
    u1, u2, a1, b1, a2, b2 = 5.2, 3.3, 140.0, 31.0, 233.0, 47.0
    loads = []
    for torque, u, a, b in ((1e5, u1, a1, b1), (1e5 * u1, u2, a2, b2)):
        loads.append(k_factor(torque, 2 * a / (u + 1), b, u))
    f = process.load_share(u1, u2)
    assert f == pytest.approx(loads[1] / loads[0] * b2 / b1 * (a2 / a1) ** 2, rel=1e-12)
    assert words.centres()[1] == pytest.approx(1.0, rel=1e-12)
    assert words.centres(square=False)[1] > 1.3
    row_of(1)


def test_erratum_02_the_square_of_the_stresses():
    """Allowed K1 = 2 K2: the corrected chain uses both alike; s for s^2 makes a2^3 too small."""
    split, widths = words.SPLIT, paper.PROPORTIONS[2]
    a2 = process.next_centre_distance(150.0, split, widths, (2.0, 1.0))
    torque = train(2).torque

    def use(a, torque, u, share, allowed):
        d = process.pinion_diameter(a, u)
        return k_factor(torque, d, share * d, u) / allowed

    first = use(150.0, torque, split[0], widths[0], 2.0)
    assert use(a2, torque * split[0], split[1], widths[1], 1.0) == pytest.approx(first, rel=1e-12)
    printed = a2 / 2 ** (1 / 6)  # (s^2)^(1/3) to s^(1/3) with s^2 = 2
    over = use(printed, torque * split[0], split[1], widths[1], 1.0) / first
    assert f"{over:.3f} times its share" in row_of(2)


def test_erratum_03_the_proportion_is_b_over_d():
    for stage, share in zip((one(0), one(1)), paper.PROPORTIONS[2], strict=True):
        assert stage["face_width_mm"] / stage["pinion_diameter_mm"] == pytest.approx(
            share, rel=1e-3
        )
    row_of(3)


def test_erratum_04_what_equation_6_leaves_out():
    """V = pi b1 a1^2 times (6); (6) is V's bracket times u1/(u1 + 1)^3."""
    rng = np.random.default_rng(0)
    for u in rng.uniform(2, 100, 200):
        u1 = rng.uniform(1, u)
        whole = paper.bracket((u1, u / u1))
        assert sixth(u1, u) == pytest.approx(whole * u1 / (u1 + 1) ** 3, rel=1e-12)
        k, torque, b1 = 2.0, 1e5, 30.0
        a1_squared = torque * (u1 + 1) ** 3 / (2 * u1 * k * b1)
        v = math.pi * torque / (2 * k) * whole
        assert v == pytest.approx(math.pi * b1 * a1_squared * sixth(u1, u), rel=1e-12)
    row_of(4)


def test_erratum_05_power_is_proportional():
    for name in DESIGNS:
        power, speed = (7.5, 1450.0) if len(DESIGNS[name]) == 2 else (8.0, 3520.0)
        for s in recomputed(name)["stages"]:
            u, size = s["ratio"], s["face_width_mm"] * s["centre_distance_mm"] ** 2
            share = power / (s["k_factor_MPa"] * u / (u + 1) ** 3 * speed * size)
            assert f"P = {share * 1e7:.3f}e-7 K" in row_of(5)
            speed /= u


def test_erratum_06_niemann_gives_another_split():
    u1 = process.niemann_ratios(TOTALS[0], (K, K))[0]
    assert u1 == pytest.approx(6.2439, abs=5e-5) and f"{u1:.2f}" in row_of(6)
    (stage, _) = DESIGNS["Table 2, process two"]
    assert float(stage.u) == 4.96


def test_erratum_07_two_equations_13():
    """Both have their row; the first gives the widths of the tables."""
    assert len(re.findall(r"^\| \(13\)", PAGE, re.M)) == 2
    width = 0.6 * process.pinion_diameter(one(0)["centre_distance_mm"], one(0)["ratio"])
    assert width == pytest.approx(one(0)["face_width_mm"], rel=1e-3)
    row_of(7)


def test_erratum_08_centres_of_the_elevator():
    stages = recomputed("elevator")["stages"]
    found = [s["centre_distance_mm"] for s in stages] + [stages[1]["wheel_diameter_mm"]]
    assert found == pytest.approx((197.229, 218.193, 355.288), abs=6e-4)
    assert ", ".join(f"{x:.2f}" for x in found[:2]) + f"; {found[2]:.2f}" in row_of(8)


def test_erratum_09_wheel_three_of_process_one():
    stage = recomputed("Table 4, process one")["stages"][2]
    assert stage["wheel_diameter_mm"] == pytest.approx(383.976, abs=6e-4)
    assert f"{2 * 251.57 - 119.16:.2f}" == f"{stage['wheel_diameter_mm']:.2f}" == "383.98"
    row_of(9)


def test_erratum_10_face_widths():
    _, two, three = (s for s in recomputed("Table 4, process one")["stages"])
    assert three["face_width_mm"] / three["pinion_diameter_mm"] == pytest.approx(0.80, abs=5e-4)
    assert two["face_width_mm"] / two["pinion_diameter_mm"] == pytest.approx(0.555, abs=5e-4)
    assert 0.6 * two["pinion_diameter_mm"] == pytest.approx(51.64, abs=5e-3)
    row_of(10)


def test_erratum_11_hardness_of_another_treatment():
    """Even K = 2.07 MPa asks of steel no more than through-hardened steel of 300 HB bears.

    322 HB + 29100 psi: grade 1, through-hardened (Shigley, Mechanical Engineering Design).
    """
    text = row_of(11)
    low, high = map(int, re.search(r"(\d+) to (\d+) HB", text).groups())
    assert low < 300 < 335 < high
    allowed = (322 * 300 + 29100) * 0.00689476
    assert allowed > 681.0 and allowed == pytest.approx(866, abs=1)


def test_erratum_12_a_figure_for_a_ratio_of_2():
    """(6) falls on all of [1, u] whatever the total ratio, so that the curve cannot tell."""
    for total in (2.0, 20.0, TOTALS[0]):
        assert (np.diff(sixth(np.linspace(1.0, total, 2001), total)) < 0).all()
    grid = np.linspace(1.0, 110.0, 219)
    cases = [(a, b, 110 / a / b) for a in grid for b in np.linspace(1, 110 / a, 40)]
    least = min(cases, key=lambda u: paper.bracket(u) * u[0] / (u[0] + 1) ** 3)
    assert least == pytest.approx((110, 1, 1)) and "at (110, 1, 1)" in PLAIN
    row_of(12)


def test_erratum_13_one_material_hides_1_and_2():
    split, widths = words.SPLIT, paper.PROPORTIONS[2]
    a2 = process.next_centre_distance(150.0, split, widths, (K, K))
    u1, u2 = split
    f = u1 * (u2 + 1) ** 3 / (u2 * (u1 + 1) ** 3) * u1
    printed = 150.0 * (f * 1.0 * (u2 + 1) / (u1 + 1) * 0.6 / 0.75) ** (1 / 3)
    assert a2 == pytest.approx(printed, rel=1e-12)
    assert f"a2 = {printed:.2f} mm" in row_of(13)
