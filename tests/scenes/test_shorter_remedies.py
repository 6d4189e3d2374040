"""Remedies as one would write them: few digits, easier than what was found, and verified again."""

from decimal import Decimal

import pytest
from bars import Bars

import gearopt
from gearopt.optimise.clock import Clock
from gearopt.scenes.explaining.engine import FeasibilityQuestions, Group, singles
from gearopt.scenes.explaining.moves import Move
from gearopt.scenes.explaining.possible import Verdict

SMALL = "problems/elevator_small_wheels.toml"
BAR = {"pull": "10 N m", "stress": "100 MPa", "safety": Decimal("1.5"), "most": 4}
SCENE = Bars.model_validate({"bar": BAR | {"diameter": "5 mm"}})


def told(key, way, enough):
    """What is written of a number that suffices from one of its own kind on."""

    def possible(own, clock):
        value = getattr(own.bar, key)
        number = float(getattr(value, "number", value))
        return Verdict(number >= enough if way > 0 else number <= enough)

    (remedy,) = singles(
        FeasibilityQuestions(SCENE, possible, Clock()), [Group((Move(("bar", key), way),))]
    )
    return remedy.changes[0]


@pytest.mark.parametrize(
    ("key", "way", "enough", "short"),
    [
        ("stress", 1, 307.3421, '"308 MPa"'),
        ("pull", -1, 5.09872, '"5.09 N m"'),
        ("safety", -1, 1.23456, "1.23"),
        ("most", 1, 37, ""),
    ],
)
def test_numbers_are_rounded_to_the_easy_side_and_whole_ones_stay(key, way, enough, short):
    change = told(key, way, enough)
    assert change.short == short
    assert abs(float(change.write.strip('"').split()[0]) / enough - 1.0) < 6e-4


def test_more_digits_are_tried_where_few_do_not_work():
    """From 307.9 MPa on the file is impossible again."""

    def possible(own, clock):
        return Verdict(307.3421 <= own.bar.stress.number < 307.9)

    move = Move(("bar", "stress"), 1, far=3.075)
    (remedy,) = singles(FeasibilityQuestions(SCENE, possible, Clock()), [Group((move,))])
    assert remedy.changes[0].short in ('"307.4 MPa"', '"307.5 MPa"')


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
