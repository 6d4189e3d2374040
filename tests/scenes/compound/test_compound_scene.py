"""A compound train's answer: what it achieves is said first, most of all where that is little."""

import re
from fractions import Fraction
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

import gearopt
from gearopt.errors import SceneError
from gearopt.report.pages.result import page
from gearopt.report.terminal import show
from gearopt.scenes.reading.load import read

PROBLEMS = Path(__file__).parents[3] / "problems"


def solved(ratio, teeth=(12, 60), **kind):
    text = f'gearopt = 1\nkind = "compound"\ntitle = "Two pairs"\n[train]\nratio = {ratio}\n'
    return gearopt.solve(read(f"{text}teeth = {list(teeth)}\n".encode())[1], **kind)


def printed(result):
    screen = Console(file=StringIO(), width=110)
    show(result, screen)
    return screen.file.getvalue().split("\n\n")


@pytest.mark.parametrize(
    ("ratio", "teeth", "first", "then"),
    [
        (
            1000,
            (12, 60),
            "ratio 25 instead of 1000 (-97.5 %), out of reach of 12 to 60 teeth; proven nearest",
            "Two pairs of 12 to 60 teeth have ratios from 0.04 to 25. "
            "Write teeth = [12, 380] (up to 1002.78).",
        ),
        (
            0.001,
            (12, 60),
            "ratio 0.04 instead of 0.001 (+3,900 %), out of reach of 12 to 60 teeth; proven "
            "nearest",
            "Two pairs of 12 to 60 teeth have ratios from 0.04 to 25. "
            "Write teeth = [12, 380] (down to 0.00099723).",
        ),
        (
            60,
            (12, 60),
            "ratio 25 instead of 60 (-58.3 %), out of reach of 12 to 60 teeth; proven nearest",
            "Two pairs of 12 to 60 teeth have ratios from 0.04 to 25. "
            "Write teeth = [12, 93] (up to 60.0625) or teeth = [7, 60] (up to 73.4694).",
        ),
        (
            5000,
            (12, 60),
            "ratio 25 instead of 5000 (-99.5 %), out of reach of 12 to 60 teeth; proven nearest",
            "Two pairs of 12 to 60 teeth have ratios from 0.04 to 25. "
            "Write teeth = [5, 354] (up to 5012.64).",
        ),
        (
            10000,
            (12, 60),
            "ratio 25 instead of 10000 (-99.8 %), out of reach of 12 to 60 teeth; proven nearest",
            "Two pairs of 12 to 60 teeth have ratios from 0.04 to 25. No two pairs of 5 to 400 "
            'teeth reach it: kind = "drive" has more stages.',
        ),
        (  # a drive takes ratios from 1
            1e-9,
            (12, 60),
            "ratio 0.04 instead of 1e-09 (+3,999,999,900 %), out of reach of 12 to 60 teeth; "
            "proven nearest",
            "Two pairs of 12 to 60 teeth have ratios from 0.04 to 25. No two pairs of 5 to 400 "
            "teeth reach it.",
        ),
    ],
)
def test_a_ratio_out_of_reach_is_said_first(ratio, teeth, first, then):
    result = solved(ratio, teeth)
    assert result.status == "optimal" and result.message == then
    assert not result.report["reach"]["within"]
    told = printed(result)
    title, decides = told[0].split("\n")
    assert title == f"Two pairs: {first}" and " ".join(told[1].split()) == then
    assert decides == "The allowed numbers of teeth do not reach the ratio."
    html = page(result, "")
    assert html.index(first[1:]) < html.index("driver teeth") and "Remedies" not in html
    said = then.replace('"', "&#34;")
    assert html.count(said) == 1 and html.index(said) < html.index("driver teeth")


@pytest.mark.parametrize(
    ("ratio", "first"),
    [
        (6.931, "ratio 6.930921053 instead of 6.931 (-0.00114 %); proven nearest"),
        (6, "ratio 6 exactly; proven nearest"),
        (
            1 / 3,
            "ratio 0.3333333333 instead of 0.3333333333 (less than 1e-9 % off); proven nearest",
        ),
        (25, "ratio 25 exactly; proven nearest"),
        (25.0000001, "ratio 25 instead of 25.0000001 (-4e-07 %), out of reach"),
    ],
)
def test_what_is_achieved_stands_in_the_title(ratio, first):
    result = solved(ratio)
    assert printed(result)[0].startswith(f"Two pairs: {first}")
    assert result.report["reach"]["within"] == (ratio <= 25)
    assert bool(result.message) == (ratio > 25)


@pytest.mark.slow
def test_the_range_that_is_proposed_is_within_reach():
    for ratio in (26, 60, 399, 1000, 6400):
        for teeth in solved(ratio).report["reach"]["wider_teeth"]:
            assert solved(ratio, tuple(teeth)).report["reach"]["within"]


def test_other_methods_say_the_same_first_and_no_more_than_they_prove():
    result = solved(1000, method="annealing", budget=gearopt.Budget(evaluations=640))
    told = printed(result)[0]
    assert "out of reach of 12 to 60 teeth" in told and "proven nearest" not in told
    teeth = (*result.design["driver_teeth"], *result.design["driven_teeth"])
    assert result.value == float(1 - Fraction(teeth[2] * teeth[3], teeth[0] * teeth[1]) / 1000)


def test_the_value_is_that_of_fractions():
    result = solved("6.931")
    assert result.value == float(1 - Fraction(43 * 49, 16 * 19) / Fraction("6.931"))
    assert result.value == result.bound and result.gap == 0.0


@pytest.mark.slow
def test_a_ratio_may_be_a_fraction_and_is_read_exactly():
    """127/120 is the inch thread of a metric lathe, and no decimal."""
    result = solved('"127/120"', (10, 127))
    assert printed(result)[0].startswith("Two pairs: ratio 1.058333333 exactly; proven nearest")
    assert result.value == 0.0 and result.design["ratio_error_percent"] == 0.0
    off = solved("1.0583333333333333333", (10, 127))  # 20 digits: not the fraction
    assert off.value == pytest.approx(
        float(Fraction(127, 120) * Fraction("1e20") % 1) / 1.0583333e20
    )
    key = gearopt.explain(read(BY_SQUARES.encode())[1]).influences[0]
    assert (key.key, key.value) == ("train.ratio", "127/120")


@pytest.mark.parametrize("name", ["three_stage", "servo_gimbal", "sandgren_train"])
def test_every_kind_reads_a_fraction_where_it_reads_a_ratio(name):
    text = (PROBLEMS / f"{name}.toml").read_text().replace("output_speed =", "ratio =")

    def with_ratio(value):
        return read(re.sub(r"(?m)^ratio = .*", f"ratio = {value}", text).encode())[1]

    table = "duty" if name == "three_stage" else "train"
    for written in ('"1270/120"', '" 127 / 12"'):
        held = getattr(with_ratio(written), table).ratio
        assert held in (Fraction(127, 12), (Fraction(127, 12),) * 2)
    for wrong in ('"127/0"', '"1/0.5"', '"-1/2"', '"127:120"', '"9/00"'):
        with pytest.raises(SceneError, match="ratio"):
            with_ratio(wrong)


BY_SQUARES = """
gearopt = 1
kind = "compound"
[train]
ratio = "127/120"
teeth = [16, 24]
minimise = "squared_error"
"""


def test_the_headline_names_the_error_that_is_least():
    scene = read(BY_SQUARES.encode())[1]
    assert "; proven nearest in 1/ratio" in printed(gearopt.solve(scene))[0]
