"""docs/servo_train.md against gearopt: every row, every sentence, no number unchecked."""

import math
import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import youn
import youn_errata
import youn_optimum as optimum
import youn_optimum_words as beside
import youn_words as words
from servo_tolerances import BASE, TERMS
from servo_trains import LOST, PAPER
from youn import ANGLES, GF_CM, TABLE_4, angles

from gearopt.physics import tolerances

PAGE = (Path(__file__).parents[2] / "docs" / "servo_train.md").read_text(encoding="utf-8")
PLAIN = " ".join(PAGE.split())
ROWS = (
    words.angle_rows,
    words.spring_rows,
    words.mesh_rows,
    words.grade_rows,
    youn_errata.errata_lines,
    optimum.ratio_rows,
    optimum.move_rows,
    optimum.stage_rows,
    optimum.design_rows,
    optimum.box_rows,
    optimum.cost_rows,
    optimum.moved_rows,
    optimum.stiff_rows,
)
SENTENCES = (
    words.given,
    words.repeated,
    words.about_angles,
    words.about_stiffness,
    words.about_section_2,
    words.about_meshes,
    words.about_standards,
    beside.about_statistics,
    beside.about_ratio,
    beside.about_split,
    beside.about_box,
    beside.about_tolerances,
    beside.about_stiff,
    beside.assumptions,
)


@pytest.mark.parametrize("rows", ROWS, ids=lambda rows: rows.__name__)
def test_every_row_of_every_table_is_recomputed(rows):
    """All rows of a table stand in the page, together, and no other row is among them."""
    assert "|---|\n" + "\n".join(rows()) + "\n\n" in PAGE


@pytest.mark.parametrize("made", SENTENCES, ids=lambda made: made.__name__)
def test_every_sentence_with_numbers_is_recomputed(made):
    assert not [sentence for sentence in made() if sentence not in PLAIN]


def test_the_printed_data_are_those_of_the_problems():
    """Tables 2 to 5 here, and as the tests of the formulations have them, are the same."""
    terms = {**youn.RADIAL, "pitch": youn.PITCH}
    assert list(terms) == list(TERMS)
    for name, um in TERMS.items():
        assert [1e3 * t for t in terms[name]] == pytest.approx(list(um), rel=1e-12)
    factor = 4.0 * math.tan(youn.ALPHA)
    lost = [factor * r + 2 * p for r, p in zip(youn.RADIAL_SUMS, youn.PITCH, strict=True)]
    assert lost == pytest.approx(LOST, rel=1e-14)
    assert len(BASE) == 14 and (PAPER.face_width, PAPER.shaft) == (youn.WIDTH, youn.SHAFT)
    assert all(g.diameter == 0.5 * g.teeth for g in youn.GEARS)


def test_the_numbers_are_those_of_an_independent_computation():
    """Angles, springs and windows as computed apart from gearopt, from the printed tables."""
    known = (0.0889769, 0.0520547, 0.0631768, 0.0692324, 0.0363608, 0.0450148, 0.1081916)
    assert list(angles(*TABLE_4).values()) == pytest.approx(known, abs=6e-8)
    known = (0.0854178, 0.0443745, 0.0534764, 0.0664631, 0.0309961, 0.0380782, 0.0915546)
    assert list(angles(*youn.OTHER).values()) == pytest.approx(known, abs=6e-8)
    ends = [(49.37, 49.95), (49.97, 50.74), (121.66, 124.45), (120.05, 123.98)]
    ends += [(9.36, 10.51), (8.86, 10.22)]
    for found, expected in zip(words.windows(), ends, strict=True):
        assert found == pytest.approx(expected, abs=6e-3)
    stiffness, shares, frequency = youn.chain()
    assert stiffness / GF_CM == pytest.approx(3.5345087e8, rel=1e-7)
    assert 1e-3 * stiffness == pytest.approx(34661.69, rel=1e-6)
    assert shares == pytest.approx((0.203, 0.782, 0.015), abs=5e-4)
    assert frequency == pytest.approx(210.6, abs=0.05)


def test_every_angle_lies_in_its_windows():
    """A wheel within its window gives what is printed, one beyond it does not."""
    for name, place, wheel in (
        ("backlash of stage 12", 0, words.windows()[0]),
        ("pitch error of stage 34", 1, words.windows()[3]),
    ):
        inner, outer = (np.array(wheel) * f for f in ((1.0001, 0.9999), (0.9999, 1.0001)))
        for ends, same in ((inner, True), (outer, False)):
            for d in ends:
                made = angles(*((d, 122.0), (50.0, d))[place], youn.OTHER[2])[name]
                assert (f"{made:.3f}" == ANGLES[name]) is same


def test_no_pair_of_gears_gives_the_printed_quotient():
    """Whatever the constant: one gear of each stage, and whichever Lewis factors."""
    printed = [low / high for low, high in ((3.75, 1.85), (3.85, 1.75))]
    for gears in ((0, 2), (0, 3), (1, 2), (1, 3)):
        low, high = words.ratios_of(gears)
        assert high < printed[0] or low > printed[1]
    half, right = youn.rule(0.125, (1, 3))[0], youn.rule(0.25, (1, 3))[0]
    assert round(half / 1e8, 1) == 1.8 and half == pytest.approx(0.5 * right)


def test_the_printed_stiffness_of_the_train():
    """Every shaft that rounds to 0.47e8 makes more than 1.175e6 of a mesh of 4.75e8."""
    for shaft in np.linspace(0.465e8, 0.475e8, 11):
        assert words.printed_total(shaft, 4.75e8) > 1.175e6
        fits = round(words.printed_total(shaft, youn.K_34) / 1e6, 2) == 1.17
        assert fits == (shaft > 0.4714e8)


def test_every_equation_has_its_row_and_every_function_exists():
    rows = re.findall(r"^\| (\(\d+a?\)) \|.*\|(.*)\|(.*)\|$", PAGE, re.M)
    assert [name for name, _, _ in rows] == [*(f"({n})" for n in range(1, 9)), "(8a)"] + [
        f"({n})" for n in range(9, 14)
    ]
    for name, where, status in rows:
        assert "`" in where or "not used" in status, name
    assert sum("corrected (" in status for _, _, status in rows) == 6
    assert sum("not reproducible" in status for _, _, status in rows) == 2
    paths = re.findall(r"`((?:physics|formulations)[\w.]+)`", PAGE)
    for path in paths:
        module, _, function = path.rpartition(".")
        assert hasattr(import_module(f"gearopt.{module}"), function), path
    assert len(set(paths)) > 20


def test_formulas_of_the_standard_are_those_of_the_functions():
    rng = np.random.default_rng(0)
    rows = re.findall(r"^\| [Ff]_\w+, .* \| (.*) \| `physics\.tolerances\.(\w+)` \|$", PAGE, re.M)
    assert len(rows) == 7
    for formula, name in rows:
        text = re.sub(r"([\d)]) (?=[dm(s])", r"\1*", formula)
        assert set(re.findall(r"[a-z]+", text)) <= {"d", "b", "m", "sqrt"}
        law = getattr(tolerances, name)
        for d, b, m in rng.uniform(1.0, 200.0, (20, 3)):
            sizes = {"diameter": d, "face_width": b, "module": m, "grade": 5}
            wanted = law.__code__.co_varnames[: law.__code__.co_argcount]
            found = 1e3 * law(**{key: sizes[key] for key in wanted})
            assert eval(text, {"sqrt": math.sqrt, "d": d, "b": b, "m": m}) == pytest.approx(found)
            sizes["grade"] = 6
            more = 1e3 * law(**{key: sizes[key] for key in wanted})
            assert more == pytest.approx(math.sqrt(2.0) * found)


def test_the_two_stage_examples_share_what_the_page_says_once():
    own, stiff = PAPER, optimum.STIFF
    assert own.sector == stiff.sector == 0.25 and float(own.ratio) == stiff.ratio[0] == 48.0
    assert (own.density, own.bending, own.output_torque) == (
        stiff.density,
        stiff.bending,
        stiff.output_torque,
    )
    assert stiff.ratio[1] == 48.48 and stiff.shear_modulus == pytest.approx(youn.G)


COUNTED = (
    "Of 6,326,052 trains of the right ratio 62,054 meet all limits with 0.1082 degrees and "
    "247,948 with 0.12."
)
FITTING = "has less E than 18/94, 23/210 teeth of 0.3 and 0.5 mm: 0.11707 degrees"


@pytest.mark.slow
def test_all_trains_are_counted():
    (tight, looked), (wide, again) = (beside.counted(error) for error in (0.1082, 0.12))
    assert looked == again
    assert COUNTED == (
        f"Of {looked:,} trains of the right ratio {tight:,} meet all limits with 0.1082 degrees "
        f"and {wide:,} with 0.12."
    )


@pytest.mark.slow
def test_no_train_of_less_error_fits_the_box():
    point = beside.fitting()
    z1, z3, z2, z4, m1, m2 = point
    teeth = f"{z1:g}/{z2:g}, {z3:g}/{z4:g} teeth of {m1:g} and {m2:g} mm"
    assert f"has less E than {teeth}: {optimum.values(point)[2]:.5f} degrees" == FITTING


UNCHECKED = (  # names, units, ordinals, and the formulas that a test of their own reads
    r"\b1e8 gf cm/rad|\b1e-7 kg m²|beside 0\.1 degrees|99\.865 %",
    r"is 0 \||from 0 to t|above 0\b|at grade 5, unrounded,|N_opt = 48 \||\| at 48 \|",
    r"`[^`]*`",
    r"\]\([^)]*\)",
    r"\(\d+a?\)",
    r"[Tt]ables? \d(?:,? (?:to |and )?\d)*",
    r"[Ss]ection \d(?:\.\d)?",
    r"(?:[Gg]ears?|[Ss]tages?|[Ss]haft|[Mm]esh) \d+(?: (?:and|to) \d+)?",
    r"K_s\d+|\b[Dnb][1-4]\b",
    r"ISO(?:/TR)? \d+(?:-\d)?(?::\d{4})?|DIN 3967|AGMA \d{4}",
    r"\| [Ff]_\w+, [^|]* \| [^|]* \|",
)


def test_no_number_is_left_unchecked():
    """What is left of the page without checked rows and sentences has only known digits."""
    lines = [line for rows in ROWS for line in rows()]
    pieces = [s for made in SENTENCES for s in made()] + [COUNTED, FITTING]
    rest = "\n".join(line for line in PAGE.splitlines() if line not in lines)
    rest = " ".join(rest.split())
    for piece in sorted(pieces, key=len, reverse=True):
        assert piece in PLAIN, piece
        rest = rest.replace(piece, " ")
    for pattern in UNCHECKED:
        rest = re.sub(pattern, " ", rest)
    assert not re.findall(r".{0,60}\d.{0,30}", rest)
