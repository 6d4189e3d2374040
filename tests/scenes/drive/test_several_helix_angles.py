"""Stages that choose their helix angle from several: against each alone, and refusals."""

import math

import pytest

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.scenes.reading.load import load

PAIR = """
gearopt = 1
kind = "drive"
[duty]
power = "15 kW"
input_speed = "1480 rpm"
ratio = 3
ratio_tolerance = "3 %"
[gears]
helix_angle = HELIX
treatment = "carburised"
grade = 2
face_width_over_diameter = [0.3, 1.0]
[[stage]]
[limits]
pinion_teeth = [20, 21]
[teeth]
[rating]
standard = "agma"
life = "20000 h"
quality = 10
overload_factor = 1.25
mounting = "precision"
minimum_bending_safety = 1.4
minimum_contact_safety = 1.1
oil_viscosity = "40 mPa s"
"""
LIST = '["0 deg", "8 deg", "20 deg"]'
RANGE = '{ from = "0 deg", to = "20 deg", step = "10 deg" }'


def written(tmp_path, helix, old="", new=""):
    path = tmp_path / "pair.toml"
    path.write_text(PAIR.replace("HELIX", helix).replace(old, new))
    return path


@pytest.mark.parametrize(("several", "angles"), [(LIST, (0, 8, 20)), (RANGE, (0, 10, 20))])
def test_the_best_helix_angle_is_that_of_each_alone(tmp_path, several, angles):
    result = gearopt.solve(written(tmp_path, several))
    alone = [gearopt.solve(written(tmp_path, f'"{angle} deg"')).value for angle in angles]
    stage = result.design["stages"][0]
    assert result.status == "optimal"
    assert result.value == pytest.approx(min(alone), rel=1e-12)
    assert stage.get("helix_angle_deg", 0.0) == angles[alone.index(min(alone))]
    assert f"of stage 1 was chosen from 3 values, 0 deg to {angles[-1]} deg." in str(
        result.report["notes"]
    )
    size = f'module = "{stage["normal_module_mm"]} mm"\npinion_teeth = {stage["pinion_teeth"]}\n'
    size += f'wheel_teeth = {stage["wheel_teeth"]}\nface_width = "{stage["face_width_mm"]!r} mm"\n'
    angle = f'"{stage["helix_angle_deg"]} deg"'
    given = gearopt.rate(written(tmp_path, angle, "[[stage]]\n", f"[[stage]]\n{size}"))
    assert given.limits["pinion_bending[1]"] == pytest.approx(1.0, abs=1e-9)
    assert given.design["rating"] == result.design["rating"]


@pytest.mark.parametrize(
    ("helix", "old", "new", "told"),
    [
        (LIST, "[teeth]\n", "", "several values to choose from, which need a table [teeth]"),
        (LIST, "[limits]", '[limits]\npreset = "chong-lee-elevator"', "by [rating] alone"),
        ('{ from = "8 deg" }', "", "", "is not a range with from, to and step"),
        (RANGE.replace("10 deg", "0 deg"), "", "", "has no step above zero"),
        (RANGE.replace("0 deg", "30 deg", 1), "", "", "ends in the wrong order"),
        (RANGE.replace("10 deg", "0.01 deg"), "", "", "has 2,001 values, above 200"),
        ('["0 deg", 8]', "", "", 'Write helix_angle = ["0 deg", "8 deg"]'),
    ],
)
def test_where_no_helix_angle_is_chosen_a_list_is_refused(tmp_path, helix, old, new, told):
    with pytest.raises(SceneError) as refusal:
        load(written(tmp_path, helix, old, new))
    assert told in str(refusal.value)


ALL = '{ from = "8 deg", to = "30 deg" }'


@pytest.mark.slow
def test_real_valued_sizes_choose_from_all_angles_of_a_range(tmp_path):
    """None of one angle is below the bound; the design is rated as it is when it is given."""
    free = "pinion_teeth = [17, 60]\n"
    path = written(tmp_path, ALL, "pinion_teeth = [20, 21]\n[teeth]\n", free)
    result = gearopt.solve(path, gap=0.01, budget=gearopt.Budget(30.0))
    stage = result.design["stages"][0]
    assert result.status in ("feasible", "optimal") and result.design["rating"]["safe"]
    assert 8.0 < stage["helix_angle_deg"] < 30.0 and result.value == pytest.approx(
        248.8e3, rel=0.01
    )
    assert 0.98 * result.value < result.bound <= result.value
    assert "chosen from all values from 8 deg to 30 deg." in str(result.report["notes"])
    assert any("is not proven" in note for note in result.report["notes"])
    for angle, volume in ((8, 289.1e3), (15, 256.3e3), (22, 250.5e3)):
        alone = written(tmp_path, f'"{angle} deg"', "pinion_teeth = [20, 21]\n[teeth]\n", free)
        value = gearopt.solve(alone, remedies=False).value
        assert value >= result.bound and value == pytest.approx(volume, rel=0.01)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("HELIX", "HELIX", "needs real-valued sizes, without a table [teeth] (or give a step)"),
        ("[teeth]\n", "[[load]]\nshare = '1'\npower = '1 kW'\n", "one load and one material"),
        ("[teeth]\n", "k_factor = '2 MPa'\nunit_load = '9 MPa'\n", "limits by [rating] alone"),
        ("[[stage]]\n", "[[stage]]\nwheel.bore = '20 mm'\n[teeth]\n", "solid gears"),
        ("[teeth]\n", "", 'begins below 1 deg: spur gears.*Write, for example, { from = "1 deg"'),
    ],
)
def test_where_real_valued_helix_angles_are_refused(tmp_path, old, new, told):
    helix = ALL.replace("8", "0") if "spur" in told else ALL
    path = tmp_path / "pair.toml"
    text = PAIR.replace("[teeth]\n", "") if "solid" in told else PAIR
    path.write_text(text.replace(old, new.replace("[teeth]\n", "")).replace("HELIX", helix))
    with pytest.raises(SceneError) as refusal:
        load(path)
    assert all(part in str(refusal.value) for part in told.split(".*"))


def test_real_valued_teeth_have_one_helix_angle(tmp_path):
    with pytest.raises(SolveError, match="several helix angles"):
        gearopt.solve(written(tmp_path, LIST), method="smooth")


MODULES = (1.5, 2.0, 2.5)
SERIES = f"[teeth]\nmodules = {[f'{m} mm' for m in MODULES]}"


def best_of_each_module(tmp_path, limits):
    """The least volume of drives of one module each: limits(module) is what their file has more."""
    results = []
    for module in MODULES:
        text = f'[limits]\nmodule = ["{module} mm", "{module} mm"]'
        path = written(tmp_path, '"15 deg"', "[limits]", text)
        path.write_text(path.read_text().replace(*limits(module)).replace("[teeth]", SERIES))
        results.append(gearopt.solve(path, remedies=False))
    return min(result.value for result in results if result.value)


def limited(tmp_path, limit):
    path = written(tmp_path, '"15 deg"', "[limits]", f"[limits]\n{limit}")
    path.write_text(path.read_text().replace("[teeth]", SERIES))
    return gearopt.solve(path)


def test_an_overlap_ratio_is_a_minimum_face_width_of_every_module(tmp_path):
    result = limited(tmp_path, "overlap_ratio = 1.3")

    def least(module):
        width = 1.3 * math.pi * module / math.sin(math.radians(15))
        return "treatment", f'minimum_face_width = "{width!r} mm"\ntreatment'

    assert result.value == pytest.approx(best_of_each_module(tmp_path, least), rel=1e-9)
    assert result.limits["overlap_ratio[1]"] == pytest.approx(1.0, abs=1e-9)
    assert result.design["stages"][0]["overlap_ratio"] == pytest.approx(1.3, rel=1e-9)


def test_an_axial_force_is_a_minimum_number_of_teeth_of_every_module(tmp_path):
    free = limited(tmp_path, 'axial_force = "9 kN"')
    force = 0.9 * 9000.0 * free.limits["axial_force[1]"]
    result = limited(tmp_path, f'axial_force = "{force!r} N"')
    torque = 15e6 / (1480.0 * math.pi / 30.0)

    def least(module):
        teeth = math.ceil(2.0 * torque * math.sin(math.radians(15)) / (force * module))
        return "[20, 21]", f"[{max(20, teeth)}, 21]" if teeth <= 21 else "[99, 99]"

    assert result.value > free.value
    assert result.value == pytest.approx(best_of_each_module(tmp_path, least), rel=1e-12)


@pytest.mark.parametrize(
    ("helix", "old", "new", "told"),
    [
        ('"0 deg"', "[limits]", "[limits]\noverlap_ratio = 1", "gears.helix_angle"),
        ('"9 deg"', "[teeth]", "", "limits.axial_force"),
    ],
)
def test_limits_of_helical_gears_are_refused_where_nothing_keeps_to_them(
    tmp_path, helix, old, new, told
):
    text = '[limits]\naxial_force = "1 kN"'
    path = written(tmp_path, helix, "[limits]", text)
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(SceneError, match=told):
        load(path)
