"""Pages show no number twice but in its table; CSV has one value a cell; rounding."""

import csv
import io
import math
import re
from dataclasses import replace

import layout_cases
import pytest
import servo_cases
from campaigns import few
from read_numbers import figures, repeated

import gearopt
from gearopt.optimise.result import Result
from gearopt.report.answer import opening
from gearopt.report.headline import lead
from gearopt.report.measures import INCH, METRIC, gap_percent, rounded
from gearopt.report.pages.result import page, tables

CASES = (
    *(layout_cases.three_stage, layout_cases.partial_span, layout_cases.elevator),
    *(layout_cases.packing, layout_cases.round_packing, servo_cases.servo, servo_cases.too_wide),
)
SOLVED = (
    *("elevator", "elevator_processes", "elevator_box", "elevator_small_wheels", "six_stages"),
    *("three_stage_together", "five_stages_continuous", "six_cylinders", "sandgren_train"),
    *("servo_gimbal", "servo_gimbal_ratio", "servo_gimbal_impossible", "servo_gimbal_tolerances"),
    "servo_gimbal_stiff",
)
BY_CHANCE = {  # the ratio of 1000 makes 31.831 N m of the motor 31,831 N m
    "five_stages_continuous": {"31831": "in 2 tables"}
}
LAYERS_MEET = {"394": "2 times outside tables"}  # at 10 mm
SEVERAL = re.compile(r"\d[;,] +\d|\d/\d|\d x \d|m_n")  # of values in one cell


def test_the_reader_of_numbers():
    assert list(figures("5,782.4 cm³ and 0.632 %; 12, 1.00, 1e-9, z 21/115")) == [
        *("57824", "632", "115")
    ]
    html = "<p>x 1.234</p><table><tr><td>5.678</td></tr></table><p>1,234 y</p><dl>5.678</dl>"
    assert set(repeated(html)) == {"1234"}
    assert set(repeated(f"{html}<table><tr><td>5.678</td></tr></table>")) == {"1234", "5678"}
    assert "1234" not in repeated(html.replace("<p>1", "<details>1"))


@pytest.mark.parametrize("make", CASES, ids=lambda f: f.__name__)
@pytest.mark.parametrize("measures", few([METRIC, INCH], CASES[::2]), ids=lambda m: m.name)
def test_no_number_stands_twice(make, measures):
    shared = LAYERS_MEET if (make, measures) == (layout_cases.packing, INCH) else {}
    assert repeated(page(make(), "gearopt solve x.toml", measures)) == shared


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLVED)
def test_no_number_stands_twice_on_pages_of_files(solved, name):
    result = solved(name)
    assert repeated(page(result, "gearopt solve x.toml")) == BY_CHANCE.get(name, {})
    assert _of_several(tables(result)) == []


@pytest.mark.parametrize("make", CASES, ids=lambda f: f.__name__)
def test_a_cell_of_csv_holds_one_value(make):
    assert _of_several(tables(make())) == []


def _of_several(texts):
    """Rows with more than one value in a cell, but for tables that are written as the file is."""
    found = []
    for name, text in texts.items():
        head, *rows = csv.reader(io.StringIO(text))
        if not name.startswith("asked") and "write in the file" not in head:
            found += [row for row in rows if any(SEVERAL.search(cell) for cell in row[1:])]
    return found


@pytest.mark.parametrize(
    ("value", "unit", "down", "up"),
    [
        (5782370.733755678, "mm3", "5,782.3 cm³", "5,782.4 cm³"),
        (25455260.4, "mm3", "25.455 dm³", "25.456 dm³"),
        (1.5e9 + 1.0, "mm3", "1,500.0 dm³", "1,500.1 dm³"),
        (2.7008571e-12, "", "2.7008e-12", "2.7009e-12"),
        (16000.0, "mm3", "16 cm³", "16 cm³"),
        (-0.632184, "percent", "-0.633 %", "-0.632 %"),
        (0.00512345, "mm", "0.00512 mm", "0.00513 mm"),
        (0.0, "kg", "0 kg", "0 kg"),
    ],
)
def test_bounds_are_rounded_so_that_they_stay_true(value, unit, down, up):
    assert (METRIC.amount(value, unit, -1), METRIC.amount(value, unit, 1)) == (down, up)


@pytest.mark.parametrize("value", [1e-9, 3.3e-7, 0.0123456, 9.99996, 512.519, 41860.65, 3e12, 1e30])
def test_numbers_keep_five_digits_and_every_integer_digit(value):
    for sign in (1.0, -1.0):
        text = rounded(sign * value, 5).replace(",", "")
        step = min(0.5, 0.5 * 10.0 ** (math.floor(math.log10(value)) - 4)) * (1.0 + 1e-9)
        close = step if value < 1e15 else 1e-4 * value
        assert abs(float(text) - sign * value) <= close


def test_a_gap_is_never_shown_smaller_than_it_is():
    shown = [gap_percent(gap) for gap in (0.0, 1e-14, 9.901e-7, 0.01231, 3.0)]
    assert shown == ["0 %", "below 0.000001 %", "0.0001 %", "1.3 %", "300 %"]


def _of(status, limits, value=1.0, **more):
    aim = {"name": "mass", "unit": "kg", "value": value}
    return Result("own", status, "exact", aim, limits=limits, **more)


@pytest.mark.parametrize(
    ("result", "words"),
    [
        (
            _of("optimal", {"a[1]": 1.0, "a[2]": 1.0, "b": 0.97}),
            "the limits on a[1] and a[2] determine the mass; b is at 97 % of its limit",
        ),
        (_of("optimal", {"a": 1.0}), "the limit on a determines the mass"),
        (
            replace(_of("feasible", {"a[1]": 1.0, "a[2]": 1.0}), scene="drive"),
            "the limits on a of stages 1 and 2 are active",
        ),
        (_of("feasible", {"a": 1.0}), "the limit on a is active"),
        (_of("limit", {"a": 1.0}), "in the best design found the limit on a is active"),
        (
            _of("optimal", {"a": 0.5, "b": 0.9996}),
            "no limit is active; the closest by utilisation is b, at 99.96 %",
        ),
        (
            _of("optimal", {"a": 1.0, "b": 0.9968}),
            "the limit on a determines the mass; b is at 99.7 %",
        ),
        (
            _of("evaluated", {"a": 1.25, "b": 0.9}),
            "the given design exceeds the limit on a by 25 %",
        ),
        (_of("limit", {}, None), "the budget ended: no design was found, which does not prove"),
        (
            _of("limit", {}, None, message="the search was interrupted"),
            "the search was interrupted: no design was found, which does not prove",
        ),
        (_of("failed", {}, None), "the search ended: no design was found"),
        (_of("optimal", {}), "no limit is active at the optimum"),
        (_of("infeasible", {}, None, message="no train fits."), "no train fits"),
    ],
)
def test_the_first_sentence_says_what_decides(result, words):
    assert lead(result).startswith(words)


@pytest.mark.slow
def test_a_ratio_tolerance_is_used_as_far_as_its_error_goes(solved):
    """-0.632 % of 1 % allowed."""
    result = solved("elevator")
    assert "the ratio error is 63 % of its tolerance of 1 %" in lead(result)
    assert isinstance(result, gearopt.Result)


def test_a_ratio_out_of_reach_is_not_blamed_on_whole_numbers(solved):
    result = gearopt.solve("problems/sandgren_train.toml", {"train.ratio": 4000})
    words = opening(result)
    assert words.endswith("the allowed numbers of teeth do not reach the ratio.")
    assert "no train of the allowed" in opening(solved("sandgren_train"))
