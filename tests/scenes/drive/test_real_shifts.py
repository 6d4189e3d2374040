"""Real-valued sizes that choose their profile shifts: against given ones, and refusals."""

import pytest
from test_several_helix_angles import PAIR

import gearopt
from gearopt.errors import SceneError
from gearopt.scenes.reading.load import load

RANGES = "[shift]\npinion_shift = { from = 0, to = 0.6 }\nsum = { from = 0, to = 1 }\n"
REAL = PAIR.replace("HELIX", '"15 deg"').replace("[teeth]\n", "").replace("[20, 21]", "[17, 60]")


def written(tmp_path, shift=RANGES, old="", new=""):
    path = tmp_path / "pair.toml"
    path.write_text(REAL.replace(old, new) + shift)
    return path


@pytest.mark.slow
def test_real_valued_sizes_choose_from_all_shifts_of_ranges(tmp_path):
    """None with given shifts is below the bound, nor better by more than 0.2 %."""
    result = gearopt.solve(written(tmp_path), gap=0.03, budget=gearopt.Budget(60.0))
    bound = result.bound
    assert result.status == "feasible" and result.proof["checked"]
    assert result.design["rating"]["safe"]
    assert 0.9 * result.value < bound <= result.value
    notes = str(result.report["notes"])
    assert (
        "The profile shift of the pinion of stage 1 was chosen from all values from 0 to" in notes
    )
    assert "Within ranges of profile shifts the bound interpolates" in notes
    for x1, total in ((0, 0), (0.3, 0.3), (0.6, 0.6), (0.3, 0.8)):
        given = f"[shift]\npinion_shift = {x1}\nsum = {total}\n"
        alone = gearopt.solve(written(tmp_path, given), remedies=False)
        own = alone.design["stages"][0]
        assert own.get("pinion_profile_shift", 0.0) == pytest.approx(x1, abs=1e-12)
        assert bound <= alone.value and result.value <= 1.002 * alone.value


@pytest.mark.parametrize(
    ("shift", "old", "new", "told"),
    [
        (RANGES, "[limits]\n", "[teeth]\n[limits]\n", "without a table [teeth] (or give a step)"),
        (RANGES.replace("sum", "#"), "", "", "nor by a sum of profile shifts"),
        (
            RANGES.replace("pinion_shift", "#"),
            "",
            "",
            "needs pinion_shift as a number or such a range",
        ),
        (RANGES.replace("0.6 }", "0.6, step = 0.2 }"), "", "", "needs pinion_shift as a number"),
        (RANGES.replace("0, to = 1 ", "1, to = 0 "), "", "", "ends in the wrong order"),
        (RANGES, "[[stage]]\n", "[[stage]]\nwheel.tool_tip_radius = 0.05\n", "tip radius of 0.1"),
        (RANGES, "[[stage]]\n", "[[stage]]\nwheel.bore = '20 mm'\n", "solid gears"),
        (RANGES, "[[stage]]\n", "[[load]]\nshare='1'\npower='1 kW'\n[[stage]]\n", "one load and"),
        (RANGES + "[objective]\nminimise = 'total_length'\n", "", "", "moves the centre distance"),
        (RANGES, "[[stage]]\n", "[[stage]]\npinion.profile_shift = 0.1\n", "follows from [shift]"),
    ],
)
def test_where_real_valued_shifts_are_refused(tmp_path, shift, old, new, told):
    with pytest.raises(SceneError) as refusal:
        load(written(tmp_path, shift, old, new))
    assert told in str(refusal.value)


def test_given_shifts_of_real_valued_sizes_are_ranges_of_one_value(tmp_path):
    scene = load(written(tmp_path, "[shift]\npinion_shift = 0.3\nsum = 0.5\n")).scene
    (stage,) = scene.train().stages
    assert stage.shifts == ((0.3, 0.3), (0.5, 0.5)) and scene.rated_real


def test_a_design_that_was_stopped_at_once_keeps_its_shifts(tmp_path):
    """Its gears, drawn and rated, are those of the search."""
    path = written(tmp_path)
    result = gearopt.solve(path, budget=gearopt.Budget(0.0), remedies=False)
    stage = result.design["stages"][0]
    x1, x2 = (stage.get(f"{gear}_profile_shift", 0.0) for gear in ("pinion", "wheel"))
    assert 0.0 <= x1 <= 0.6 and 0.0 <= x1 + x2 <= 1.0
    from gearopt.formulations.drive.design import drive_design

    (pair,) = load(path).scene.pairs(drive_design(result.design))
    assert (pair.pinion.profile_shift, pair.wheel.profile_shift) == pytest.approx((x1, x2))
    assert pair.volume == pytest.approx(result.value, rel=1e-9)
