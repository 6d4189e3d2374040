"""Sums of profile shifts to choose from without a given distance: against all pairs, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from test_given_distance import PAIR, narrowest, possible, written

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations.drive.teeth.tables import stage_tables
from gearopt.physics.geometry.involute import involute
from gearopt.scenes.reading.load import load

FREE = PAIR.replace('centre_distance = "125 mm"\n', "").replace("[14, 40]", "[17, 18]")
FEW = FREE.replace("[teeth]", '[teeth]\nmodules = ["2 mm", "2.5 mm", "3 mm"]')
SUMS = "[shift]\nsum = [0, 0.4, 0.9]\n"


def distance(module, teeth, cut, total):
    """Centre distance [mm] at which the shifts of two gears have a sum, without backlash."""
    transverse = np.arctan(np.tan(cut.racks[0].pressure_angle) / np.cos(cut.helix_angle))
    known = involute(transverse) + 2.0 * total / teeth * np.tan(cut.racks[0].pressure_angle)
    working = brentq(lambda angle: involute(angle) - known, 0.1, 1.0, xtol=1e-14)
    length = 0.5 * module * teeth / np.cos(cut.helix_angle)
    return length * np.cos(transverse) / np.cos(working)


def shares(train, totals, helices, shift=None):
    """Volume, module, teeth, sum and angle of every pair of a stage that carries."""
    (stage,) = train.stages
    low, high = float(train.lowest_ratio), float(train.highest_ratio)
    for module in map(float, stage.modules):
        for z1 in range(stage.pinion_teeth[0], stage.pinion_teeth[1] + 1):
            for z2 in range(int(np.ceil(low * z1)), int(np.floor(high * z1)) + 1):
                for total in totals:
                    for helix in helices:
                        cut = replace(stage.toothings[0], helix_angle=helix, shift_sum=None)
                        at = replace(cut, working_distance=distance(module, z1 + z2, cut, total))
                        one = replace(train, stages=(replace(stage, toothings=(at,)),))
                        pair = possible(one, 0, module, z1, z2, (0.2, 1.1, 3.0), shift)
                        if pair is not None:
                            width = narrowest(one, 0, pair, train.torque)
                            yield float(pair.of_width(width).volume), module, z1, z2, total, helix


TINY = FEW.replace("[17, 18]", "[17, 17]").replace('"2 mm", "2.5 mm", "3 mm"', '"2.5 mm"')
WHOLE = FEW.replace('"12 deg"', '["9 deg", "15 deg"]')
SHIFTED = SUMS + "pinion_shift = 0.3"


def test_teeth_of_a_sum_are_those_of_their_distance(tmp_path):
    """And a stage has every pair, with every sum, that the limits of [shift] allow."""
    train = load(written(tmp_path, TINY + SUMS)).scene.train()
    (own,) = stage_tables(train, train.highest_ratio)
    (stage,) = train.stages
    rows = set()
    for z2 in range(66, 71):
        for cut in stage.toothings:
            length = distance(2.5, 17 + z2, cut, cut.shift_sum)
            pair, given = cut.pair(2.5, 17, z2, 20.0), replace(cut, shift_sum=None)
            same = replace(given, working_distance=length).pair(2.5, 17, z2, 20.0)
            assert pair.centre_distance == pytest.approx(length, rel=1e-13) and cut.made(pair)
            for gear, other in zip(pair.gears, same.gears, strict=True):
                assert gear.profile_shift == pytest.approx(other.profile_shift, abs=1e-10)
                assert gear.tip_diameter == pytest.approx(other.tip_diameter, rel=1e-12)
                assert gear.body == pytest.approx(other.body, rel=1e-12)
            at = replace(stage, toothings=(replace(given, working_distance=length),))
            one = replace(train, stages=(at,))
            if possible(one, 0, 2.5, 17, z2, (0.2, 1.1, 3.0)) is not None:
                rows.add((z2, cut.shift_sum))
    sums = [stage.toothings[k].shift_sum for k in own.toothing]
    assert rows == {*zip(own.z2.tolist(), sums, strict=True)} and len(rows) == len(own.z2)
    made = own.made(np.full(len(own.z2), 2.5), np.arange(len(own.z2)))
    total = made.pinion.profile_shift + made.wheel.profile_shift
    assert total == pytest.approx(sums, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "shift"),
    [
        (TINY + SUMS, None),
        (WHOLE + SUMS, None),
        (WHOLE + SHIFTED, 0.3),
    ],
)
def test_the_best_sum_is_that_of_all_pairs(tmp_path, text, shift):
    """With every helix angle, too; the distance follows, and both tips are shortened."""
    path = written(tmp_path, text)
    train = load(path).scene.train()
    helices = sorted({cut.helix_angle for cut in train.stages[0].toothings})
    best = min(shares(train, (0.0, 0.4, 0.9), helices, shift))
    result = gearopt.solve(path)
    stage = result.design["stages"][0]
    assert result.status == "optimal" and result.value == pytest.approx(best[0], rel=1e-8)
    assert (stage["normal_module_mm"], stage["pinion_teeth"], stage["wheel_teeth"]) == best[1:4]
    total = stage.get("pinion_profile_shift", 0.0) + stage.get("wheel_profile_shift", 0.0)
    assert total == pytest.approx(best[4], abs=1e-12)
    assert np.radians(stage["helix_angle_deg"]) == pytest.approx(best[5])
    assert result.design["rating"]["safe"]
    note = "The sum of profile shifts of stage 1 was chosen from 3 values, 0 to 0.9."
    assert note in result.report["notes"]


@pytest.mark.slow
def test_a_list_of_sums_is_the_best_of_each_alone(tmp_path):
    def solved(sums):
        return gearopt.solve(
            written(tmp_path, f"{TINY}[shift]\nsum = {sums}\n"), remedies=False
        ).value

    assert solved([0, 0.5]) == pytest.approx(min(solved(0), solved(0.5)), rel=1e-12)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (PAIR + SUMS, "shift.sum.*follows from the centre distance of stage 1"),
        (FREE.replace("[teeth]\n", "") + SUMS, "shift.sum.*a table [teeth]"),
        (FREE + SUMS + "[objective]\nminimise = 'total_length'\n", "shift.sum.*moves the centre"),
        (FREE + "[shift]\nsum = 2\n", "shift.sum.*between -0.5 and 1.5"),
        (
            FREE.replace("[[stage]]\n", "[[stage]]\npinion.profile_shift = 0.2\n") + SUMS,
            "pinion.profile_shift.*follows from [shift]",
        ),
        (
            FREE.replace("[[stage]]\n", '[[stage]]\nwheel.thickness_allowance = "-50 um"\n') + SUMS,
            "shift.sum.*gears without thickness_allowance",
        ),
    ],
)
def test_what_does_not_go_with_a_sum_of_shifts_is_refused(tmp_path, text, told):
    with pytest.raises(SceneError) as refusal:
        load(written(tmp_path, text))
    assert all(part in str(refusal.value) for part in told.split(".*"))


STEPS = "[shift]\nsum = { from = 0, to = 1, step = 0.2 }\n"
WORTH = {  # cm3, as the page of drives has them
    "": 647.3,
    "[shift]\nsum = 0\n": 633.7,
    STEPS: 631.9,
    STEPS + "pinion_shift = { from = 0, to = 0.8, step = 0.1 }\n": 601.6,
}


@pytest.mark.slow
@pytest.mark.parametrize(("table", "volume"), WORTH.items())
def test_what_sums_of_shifts_are_worth(tmp_path, table, volume):
    text = FREE.replace("[17, 18]", "[14, 40]") + table
    result = gearopt.solve(written(tmp_path, text), remedies=False)
    assert result.status == "optimal" and result.value == pytest.approx(1e3 * volume, abs=60.0)


@pytest.mark.parametrize(
    ("old", "place", "meant"),
    [
        ("sum = [0, 0.4, 0.9]", "shift.summ", "sum"),
        ('helix_angle = "12 deg"', "gears.helix_angel", "helix_angle"),
    ],
)
def test_a_misspelt_key_of_a_range_is_no_table(old, place, meant, tmp_path):
    line = f"{place.split('.')[1]} = {{ from = 0, to = 1, step = 1 }}"
    path = written(tmp_path, (FREE + SUMS).replace(old, line, 1))
    with pytest.raises(SceneError, match=f"{place}: unknown key. Did you mean {meant}"):
        load(path)
