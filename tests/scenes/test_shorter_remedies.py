"""Remedies as one would write them: few digits, easier than what was found, and verified again."""

from decimal import Decimal

import pytest

import gearopt
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.result import Budget
from gearopt.scenes.explaining.shorter import shorter

SMALL = "problems/elevator_small_wheels.toml"


def remedy(was, write, kind="alone"):
    return Remedy(kind, "x", (Change("x", was, write, 1.1),), 1.1, None)


def shorts(was, write, works=lambda edits, seconds: True, kind="alone"):
    (found,) = shorter([remedy(was, write, kind)], Clock(Budget()), works)
    assert found.changes[0].write == write and found.factor == 1.1
    return found.changes[0].short


@pytest.mark.parametrize(
    ("was", "write", "short"),
    [
        ('"300 mm"', '"307.3421 mm"', '"308 mm"'),
        ('"7.5 kW"', '"5.09872 kW"', '"5.09 kW"'),
        ("[1, 10]", "[1, 31.4643]", "[1, 31.5]"),
        ('["-40 mm", "92.5 mm"]', '["-40.1234 mm", "92.5 mm"]', '["-40.2 mm", "92.5 mm"]'),
        ('"0.018 mm"', '"0.016534 mm"', '"0.0165 mm"'),
        ('"1 kg/dm^3"', '"1.23456 kg/dm^3"', '"1.24 kg/dm^3"'),
        ("21", "1234", ""),
        ('"250 mm"', '"283 mm"', ""),
        ("true", "false", ""),
        ('"ISO 54 I"', '["1 mm", "1.25 mm"]', ""),
    ],
)
def test_numbers_are_rounded_to_the_easy_side(was, write, short):
    assert shorts(was, write) == short


def test_more_digits_are_tried_where_few_do_not_work():
    tight = '"307.3421 mm"'
    assert shorts('"300 mm"', tight, lambda e, s: e["x"] != "308 mm") == '"307.4 mm"'
    assert shorts('"300 mm"', tight, lambda e, s: False) == ""


def test_the_nearest_ratio_is_not_rounded():
    assert shorts("1000", "99.9876", kind="choice") == ""


@pytest.mark.slow
def test_a_file_with_what_one_would_write_has_a_design():
    found = gearopt.explain(SMALL)
    (first, *_) = found.remedies
    (change,) = first.changes
    assert (change.write, change.short, change.value) == ('"282.492 mm"', '"283 mm"', "283 mm")
    assert gearopt.solve(SMALL, first.edits).feasible
    for one in found.remedies:
        for c in one.changes:
            digits = Decimal((c.short or "1").strip('"').split()[0].strip("[,")).as_tuple().digits
            assert len(digits) <= 4
    ways = gearopt.solve(SMALL).report["ways_out"]["remedies"]
    assert [r["changes"][0]["short"] for r in ways] == [r.changes[0].short for r in found.remedies]
