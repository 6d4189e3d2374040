"""Ways out of drives with given teeth, modules and widths, against brute force over the file."""

import pytest
from given_drives import faults, feasible, given_drive, readable

from gearopt import Budget
from gearopt.report.remedy_words import remedy_words
from gearopt.scenes import drive
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.load import read

TWO_GIVEN = """
gearopt = 1
kind = "drive"
[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
ratio = 20
[[stage]]
face_width_over_diameter = 0.6
pinion_teeth = 20
[[stage]]
face_width_over_diameter = 0.6
pinion_teeth = 20
wheel_teeth = 60
[limits]
k_factor = "2.07 MPa"
unit_load = "48 MPa"
pinion_teeth = [20, 40]
wheel_teeth = [20, 100]
[teeth]
"""
NEITHER_ALONE = """
gearopt = 1
kind = "drive"
[duty]
power = "1 kW"
input_speed = "1450 rpm"
ratio = 3.17
ratio_tolerance = "0.05 %"
[[stage]]
face_width_over_diameter = 0.6
pinion_teeth = 20
wheel_teeth = 60
[limits]
k_factor = "2.07 MPa"
unit_load = "48 MPa"
pinion_teeth = [20, 40]
[teeth]
"""
SHORT_LIST = """
gearopt = 1
kind = "drive"
stages = 1
[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
ratio = 4
[gears]
face_width_over_diameter = 0.6
[limits]
k_factor = "2.07 MPa"
unit_load = "48 MPa"
pinion_teeth = [20, 22]
wheel_diameter = "300 mm"
[teeth]
modules = ["1 mm", "8 mm"]
"""


def explained(text, seconds=100.0):
    return drive.explain(read(text.encode())[1], Ask(budget=Budget(seconds=seconds)))


def test_given_teeth_of_a_stage_move_apart():
    """20/60 in stage 2: 17 pinion teeth in both stages do, so no proof may exclude them."""
    found = explained(TWO_GIVEN)
    moved = TWO_GIVEN.replace("pinion_teeth = 20\n", "pinion_teeth = 17\n")
    assert feasible(moved) and not feasible(TWO_GIVEN)
    pinions = [w for w in found.remedies if all("pinion" in c.key for c in w.changes)]
    assert all(w.bound is None or w.bound <= (20 / 17) ** 2 for w in pinions if len(w.changes) > 1)
    least = found.remedies[0]
    assert (least.kind, least.changes[0].write) == ("least", "[20, 132]")
    assert least.bound == pytest.approx(1.32) and least.bound <= (20 / 17) ** 2
    assert not faults(TWO_GIVEN, found)


def test_teeth_that_do_not_suffice_alone_move_together():
    """Of all pairs z1, z2 with 3.17 within 0.05 %, that of the least product of factors."""
    found = explained(NEITHER_ALONE)
    pairs = [
        (max(a, 20) / min(a, 20) * max(b, 60) / min(b, 60), a, b)
        for a in range(5, 81)
        for b in range(5, 241)
        if abs(b / a / 3.17 - 1) <= 0.0005
    ]
    least, pinion, wheel = min(pairs)
    way = found.remedies[0]
    written = {c.key: int(c.write) for c in way.changes}
    assert written == {"stage[1].pinion_teeth": pinion, "stage[1].wheel_teeth": wheel}
    assert way.kind == "least" and way.factor == pytest.approx(least)
    assert way.verified["with_less"] == "infeasible"


def test_a_module_is_added_to_a_list():
    """Between 1 mm and 8 mm: a module of series I, and both series instead of the list."""
    found = explained(SHORT_LIST)
    ways = [c.write for w in found.remedies if w.kind == "choice" for c in w.changes]
    assert len(ways) == 2 and ways[1] == '"ISO 54 I+II"'
    assert ways[0].startswith('["1 mm", ') and ways[0].count("mm") == 3
    assert not faults(SHORT_LIST, found)


def test_nothing_is_claimed_least_where_time_ran_out():
    found = explained(TWO_GIVEN, seconds=0.0)
    words = " ".join(remedy_words(vars(found))[2]) if found.remedies else ""
    assert "does with less" not in words


@pytest.mark.parametrize("seed", [1, 4])
def test_ways_out_of_drives_with_given_numbers(seed):
    check(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(20, 28)])
def test_ways_out_of_more_drives_with_given_numbers(seed):
    check(seed)


def check(seed):
    """Each way out was edited into the file; so was each step less, and each single number."""
    text = given_drive(seed)
    assert readable(text)
    found = explained(text)
    assert feasible(text) == (found.result.value is not None)
    assert not faults(text, found)
