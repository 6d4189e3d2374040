"""Ways out of drives with given teeth, modules and widths, against brute force over the file."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from given_drives import every_train, faults, feasible, given_drive, readable, with_changes

import gearopt
from gearopt import Budget
from gearopt.optimise.clock import Clock
from gearopt.report.explained import remedy_words
from gearopt.scenes import drive
from gearopt.scenes.drive.explain.choices import nearest_ratio
from gearopt.scenes.drive.explain.load_limit_remedies import remedies
from gearopt.scenes.drive.explain.tried import Case
from gearopt.scenes.explaining.explanations import explanation
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.load import read

ELEVATOR = Path(__file__).parents[3] / "problems" / "elevator.toml"


def drive_file(duty, stages, limits, power="1 kW", teeth="[teeth]"):
    """A drive's file with the loads of the elevator drive; stages: a number, or their tables."""
    count = isinstance(stages, int)
    return f"""
gearopt = 1
kind = "drive"
{f"stages = {stages}" if count else ""}
[duty]
power = "{power}"
input_speed = "1450 rpm"
{duty}
{"[gears]" + WIDTH if count else stages}
[limits]
k_factor = "2.07 MPa"
unit_load = "48 MPa"
{limits}
{teeth}
"""


WIDTH = "\nface_width_over_diameter = 0.6\n"
STAGE = f"[[stage]]{WIDTH}pinion_teeth = 20\n"
TWO_GIVEN = drive_file(
    "ratio = 20",
    STAGE + STAGE + "wheel_teeth = 60",
    "pinion_teeth = [20, 40]\nwheel_teeth = [20, 100]",
    "7.5 kW",
)
NEITHER_ALONE = drive_file(
    'ratio = 3.17\nratio_tolerance = "0.05 %"',
    STAGE + "wheel_teeth = 60",
    "pinion_teeth = [20, 40]",
)
SHORT_LIST = drive_file(
    "ratio = 4",
    1,
    'pinion_teeth = [20, 22]\nwheel_diameter = "300 mm"',
    "7.5 kW",
    '[teeth]\nmodules = ["1 mm", "8 mm"]',
)


def explained(text, seconds=100.0):
    return explanation(drive.KIND, read(text.encode())[1], Ask(budget=Budget(seconds=seconds)))


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_module_is_added_to_a_list():
    """Between 1 mm and 8 mm: a module of series I, and both series instead of the list."""
    found = explained(SHORT_LIST)
    ways = [c.write for w in found.remedies if w.what == "modules" for c in w.changes]
    assert len(ways) == 2 and ways[1] == '"ISO 54 I+II"'
    assert ways[0].startswith('["1 mm", ') and ways[0].count("mm") == 3
    assert not faults(SHORT_LIST, found)


def test_nothing_is_claimed_least_where_time_ran_out():
    found = explained(TWO_GIVEN, seconds=0.0)
    words = remedy_words(vars(found))[1] if found.remedies else ""
    assert "Smallest change:" not in words and "none with" not in words


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 4, *range(20, 25)])
def test_ways_out_of_drives_with_given_numbers(seed):
    """Each way out was edited into the file; so was each step less, and each single number."""
    text = given_drive(seed)
    assert readable(text)
    found = explained(text)
    assert feasible(text) == (found.result.value is not None)
    assert not faults(text, found)


GIVEN_PAIR = NEITHER_ALONE.replace("3.17", "3").replace("0.05 %", "0.5 %").replace("= 60", "= 63")
FEW_PINIONS = drive_file('ratio = 5.123\nratio_tolerance = "0.01 %"', 1, "pinion_teeth = [17, 30]")
TWO_OF_TEN = drive_file(
    'output_speed = "1.45 rpm"\nratio_tolerance = "0 %"',
    2,
    "stage_ratio = [1, 10]\npinion_teeth = [17, 40]",
    teeth="",
)


def ratio_chosen(text, found):
    """The way out by another ratio, and the ratio that its edit asks for."""
    (way,) = [w for w in found.remedies if w.what == "ratio"]
    edited = with_changes(text, [(c.key, c.write) for c in way.changes])
    assert feasible(edited) and way.kind == "choice"
    return way, read(edited.encode())[1].duty.total_ratio


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "key", "write"),
    [
        (GIVEN_PAIR, "duty.ratio", "3.15"),
        (FEW_PINIONS, "duty.ratio", "5.125"),
        (TWO_OF_TEN, "duty.output_speed", '"14.5 rpm"'),
    ],
    ids=["given pair", "few pinions", "beyond any tolerance"],
)
def test_the_nearest_ratio_is_told(text, key, write):
    """63/20, 41/8 (of 24 to 123 teeth) and 10 x 10 instead of 1000."""
    found = explained(text)
    way, ratio = ratio_chosen(text, found)
    (change,) = way.changes
    assert (change.key, change.write) == (key, write)
    asked = read(text.encode())[1].duty.total_ratio
    assert way.factor == pytest.approx(float(max(ratio / asked, asked / ratio)))
    words = remedy_words(found.to_dict())
    assert any("choose" in row[0] and key in row[1] for row in words[0])
    assert not words[0][0][0].startswith("or ")  # nothing stands before it
    assert "keeps the duty" in words[1]
    assert "is the nearest feasible one" in words[1]


def nearest_by_listing(scene):
    """The total ratios next to the one asked for: of all trains within 45 % of it."""
    asked = scene.duty.total_ratio
    trains = every_train(replace(scene.train(), tolerance=Fraction(45, 100))).teeth
    wheels, pinions = trains[:, :, 1].prod(axis=1), trains[:, :, 0].prod(axis=1)
    known = {Fraction(int(w), int(p)) for w, p in zip(wheels, pinions, strict=True)}
    away = min((abs(r - asked) for r in known), default=None)
    return {r for r in known if abs(r - asked) == away}


@pytest.mark.slow
def test_a_tolerance_of_millionths_is_widened_no_more_than_it_must():
    changes = {"limits.pinion_teeth": [20, 21], "duty.ratio_tolerance": "0.0001 %"}
    scene = gearopt.load(ELEVATOR, changes)
    (way,) = [
        w
        for w in gearopt.explain(ELEVATOR, changes).remedies
        if w.changes[0].key == "duty.ratio_tolerance"
    ]
    asked, nearest = scene.duty.total_ratio, max(nearest_by_listing(scene))
    least = max(nearest / asked, asked / nearest) - 1
    written = Fraction(way.changes[0].write.strip('"').removesuffix(" %")) / 100
    assert way.verified["with_less"] == "infeasible"
    assert least <= written <= least * Fraction(1001, 1000)


def check_nearest(seed):
    """The ratio to choose reaches, within the tolerance, the next of all. False: nothing to see."""
    text = given_drive(seed)
    scene = read(text.encode())[1]
    if scene.teeth is None or len(scene.stage) > 2 or feasible(text):
        return False
    reached = nearest_by_listing(scene)
    case = Case(scene, Clock(Budget(seconds=60.0)))
    way = nearest_ratio(case, None)
    if not reached:  # none so near
        assert way is None or way.factor > 1.4
        return False
    assert way is not None and way.verified == {"with": "feasible", "nearer": "infeasible"}
    (change,) = way.changes
    edited = with_changes(text, [(change.key, change.write)])
    written = read(edited.encode())[1].duty.total_ratio
    assert any(abs(r - written) <= scene.duty.ratio_tolerance * written for r in reached)
    assert any(abs(r - written) <= Fraction(1, 10**5) * r for r in reached)
    return feasible(edited)


@pytest.mark.slow
def test_the_nearest_ratio_is_that_of_listing_all_trains():
    assert all(check_nearest(seed) for seed in (102, 108))


@pytest.mark.slow
@pytest.mark.parametrize("first", range(113, 209, 12))
def test_the_nearest_ratio_of_more_drives_is_that_of_listing_all_trains(first):
    assert any([check_nearest(seed) for seed in range(first, first + 12)])


@pytest.mark.slow
def test_no_ratio_is_told_where_none_is_written_or_time_ran_out():
    """63/22 is no decimal number, so a file without a tolerance cannot ask for it; 63/20 is."""
    near = nearest_ratio(Case(read(GIVEN_PAIR.encode())[1], Clock(Budget(seconds=60.0))), None)
    assert [(change.key, change.write) for change in near.changes] == [("duty.ratio", "3.15")]
    exact = GIVEN_PAIR.replace("0.5 %", "0 %").replace("teeth = 20\n", "teeth = 22\n")
    for text, seconds in ((exact, 60.0), (GIVEN_PAIR, 0.0)):
        scene = read(text.encode())[1]
        assert nearest_ratio(Case(scene, Clock(Budget(seconds=seconds))), None) is None


@pytest.mark.slow
def test_no_number_of_real_valued_sizes_is_tried_once_time_is_over(monkeypatch):
    """Each would take a solution of the continuous problem: some twenty here."""
    scene, asked = gearopt.load("problems/three_stage_small_wheels.toml"), []
    monkeypatch.setattr(f"{remedies.__module__}.is_real", lambda scene, clock: True)
    monkeypatch.setattr(f"{remedies.__module__}.even", lambda *of: asked.append(of))
    known = remedies(scene, Clock(Budget(seconds=0.0)))
    assert not asked and not known.remedies and "time ran out" in known.message
