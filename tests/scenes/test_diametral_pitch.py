"""Diametral pitches in problem files: m_n = 25.4 mm/P, exactly, and in the file's own words."""

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from edits import edited, scene_of

import gearopt
from gearopt import SceneError
from gearopt.formulations.drive.teeth.search import possible
from gearopt.scenes.explaining.numbers import content, numbers
from gearopt.scenes.reading.load import read
from gearopt.scenes.reading.module_series import SERIES, series_of, unverified

PROBLEMS = Path(__file__).parents[2] / "problems"
FILE = """
gearopt = 1
kind = "drive"
[duty]
power = "10 hp"
input_speed = "1750 rpm"
ratio = 5
ratio_tolerance = "1 %"
[[stage]]
{stage}
face_width_over_diameter = 0.7
[limits]
k_factor = "300 psi"
unit_load = "7000 psi"
pinion_teeth = [18, 40]
{limits}
[teeth]
modules = {modules}
"""


def text_of(modules='"DP coarse"', limits="", stage=""):
    return FILE.format(modules=modules, limits=limits, stage=stage)


def scene(*words, **changes):
    return scene_of(text_of(*words, **changes))[0]


@pytest.mark.parametrize(("pitch", "size"), [("10", "2.54"), ("16", "1.5875"), ("8", "3.175")])
def test_a_pitch_is_a_module(pitch, size):
    found = gearopt.solve(scene(f'["{pitch} 1/in"]'))
    alike = gearopt.solve(scene(f'["{size} mm"]'))
    assert found.status == "optimal" and found.value == alike.value
    assert scene(f'["{pitch} DP"]').train().stages[0].modules == (Fraction(size),)


def test_pitches_are_exact_and_ranges_rise_as_they_are_written():
    third = scene('["12 1/in", "3 1/in"]', 'module = ["3 1/in", "12 1/in"]').train()
    assert third.stages[0].modules == (Fraction(254, 120), Fraction(254, 30))
    coarse = scene(limits='module = ["4 1/in", "10 1/in"]').train().stages[0].modules
    assert coarse == tuple(Fraction("25.4") / p for p in (10, 8, 6, 4))
    same = scene('["4 mm"]', 'module = ["4 mm", "0.4 cm"]').train().stages[0].modules
    assert same == (Fraction(4),)


def test_named_series_are_those_of_their_numbers():
    both = scene('"DP coarse+fine"').train().stages[0].modules
    assert len(both) == 21 and both[0] == Fraction("25.4") / 200 and both[-1] == Fraction("12.7")
    parts = [scene(f'"DP {name}"').train().stages[0].modules for name in ("fine", "coarse")]
    assert both == parts[0] + parts[1]


REFUSED = {
    'module = ["12 1/in", "4 1/in"]': '["4 1/in", "12 1/in"]',
    'module = ["2 mm", "4 1/in"]': "a module and a diametral pitch",
    'module = ["7 1/in", "7.5 1/in"]': '["6 1/in", "8 1/in"]',
    'module = ["0 1/in", "4 1/in"]': "not greater than zero",
    'wheel_diameter = "10 1/in"': "unit 1/in of module",
}


@pytest.mark.parametrize("limits", REFUSED)
def test_wrong_pitches_say_what_to_write(limits):
    with pytest.raises(SceneError) as wrong:
        read(text_of(limits=limits).encode())
    assert REFUSED[limits] in str(wrong.value)


def test_a_wheel_that_is_as_large_as_allowed_is_allowed():
    """120 teeth of 12 to the inch are 10 inches, which no double of 25.4/12 times 120 needs be."""
    stage = "pinion_teeth = 24\nwheel_teeth = 120"
    limits = 'wheel_diameter = "10 in"\n'
    exact = scene('["12 1/in"]', limits=limits, stage=stage).train()
    less = scene('["12 1/in"]', limits='wheel_diameter = "9.999999999 in"', stage=stage).train()
    free = {"allowable": (1e9, 1e9)}

    def met(train):
        return possible(replace(train, stages=(replace(train.stages[0], **free),)), 2.0, None)

    assert met(exact) and not met(less)


@pytest.mark.parametrize(
    ("modules", "limits", "stage"),
    [
        ('"DP fine"', 'module = ["20 1/in", "64 1/in"]', ""),
        ('["10 1/in", "12 1/in"]', "", 'module = "12 1/in"'),
        ('["4 mm", "10 1/in"]', "", 'module = ["10 1/in", "12 1/in"]'),
    ],
)
def test_what_is_read_is_written_again(modules, limits, stage):
    one = scene(modules, limits=limits, stage=stage)
    again = type(one).model_validate(content(one))
    assert again == one


def test_numbers_are_named_by_their_place_in_the_file():
    found = {n.key: n.text for n in numbers(scene(limits='module = ["4 1/in", "10 1/in"]'))}
    assert found["limits.module[1]"] == "4 1/in" and found["limits.module[2]"] == "10 1/in"
    listed = {n.key: n.text for n in numbers(scene('["12 1/in", "10 1/in"]'))}
    assert listed["teeth.modules[1]"] == "12 1/in"


@pytest.mark.slow
def test_sensitivities_are_those_of_the_number_as_it_is_written():
    """A given module: +1 % of the pitch is -1 % of the module, and of its diameters."""
    stage = 'module = "{}"\npinion_teeth = 20'
    pitch, module = (
        gearopt.explain(scene('["5 1/in"]', stage=stage.format(one)))
        for one in ("5 1/in", "5.08 mm")
    )
    slopes = [
        next(i for i in found.influences if i.key == "stage[1].module") for found in (pitch, module)
    ]
    assert slopes[0].value == "5 1/in"
    resolved = [s.resolved for s in slopes]
    assert resolved[0] == pytest.approx([-v for v in resolved[1]], rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("modules", "limits", "write"),
    [
        ('"DP coarse+fine"', 'module = ["32 1/in", "48 1/in"]', "1/in"),
        ('["32 1/in"]', "stage_ratio = [1, 6]", "1/in"),
    ],
)
def test_remedies_are_in_the_units_of_the_file(modules, limits, write):
    text = text_of(modules, limits)
    one, tables = scene_of(text)
    found = gearopt.explain(one)
    assert found.result.status == "infeasible"
    words = [c.write for r in found.remedies for c in r.changes if "module" in c.key]
    assert words and all(write in w or "DP" in w for w in words)
    assert not any("mm" in c.write for r in found.remedies for c in r.changes)
    for remedy in found.remedies:
        assert gearopt.solve(edited(tables, remedy)).value is not None


@pytest.mark.slow
def test_an_explanation_in_inches_names_no_metric_unit(here):
    """Of a file in inches: value, sentences and table."""
    done = here("explain", PROBLEMS / "inch_drive.toml", "--units", "inch")
    assert done.returncode == 0 and "gear volume 339.67 in³, proven optimal" in done.stdout
    assert re.search(r"limits.module.2. +16 1/in", done.stdout)
    assert not re.search(r"\bmm|MPa|\bkg\b|N m\b", done.stdout)


@pytest.mark.slow
def test_a_file_in_inches_is_answered_in_inches(here, tmp_path):
    """5,566,260.9 mm3 are 339.67 in3; pitches of 16 and 8 to the inch, without a rounding error."""
    done = here("solve", PROBLEMS / "inch_drive.toml", "--units", "inch", "--csv", tmp_path)
    stages = (tmp_path / "stages.csv").read_text(encoding="utf-8-sig")
    assert "diametral pitch P_nd [1/in],16.0,8.0" in stages
    words = re.sub(r"(?m)^Tables: .*", "", done.stdout)
    assert not re.search(r"\bmm|MPa|\bkg\b|N m\b", words), words


@pytest.mark.slow
def test_a_servo_train_of_pitches_is_that_of_its_modules():
    """50.8 and 63.5 to the inch are 0.5 and 0.4 mm; those of a named series are unverified."""
    text = (PROBLEMS / "servo_axis.toml").read_text(encoding="utf-8")
    line = next(row for row in text.splitlines() if row.startswith("modules"))

    def solved(modules):
        one = read(text.replace(line, f"modules = {modules}").encode())[1]
        return gearopt.solve(one)

    module, pitch = solved('["0.5 mm", "0.4 mm"]'), solved('["50.8 1/in", "63.5 1/in"]')
    assert module.status == "optimal" and module.value == pitch.value
    assert "unverified by a standard" in " ".join(solved('"DP fine"').report["assumptions"])


def test_a_standard_series_is_known_by_its_sizes():
    assert [series_of(sizes) for sizes in SERIES.values()] == list(SERIES)
    assert series_of(SERIES["DP fine"][1:]) == "" and unverified(SERIES["ISO 54 I"]) == []
    assert "DP fine" in unverified(SERIES["DP fine"])[0]
