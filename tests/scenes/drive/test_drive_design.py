"""The numbers of a drive that a drawing needs, and what they take for granted."""

import math
from pathlib import Path

import pytest

import gearopt
from gearopt.formulations.servo.servo_design import ServoDesign, ServoReport, Stage, TrainDesign
from gearopt.physics.gears import GearPair, Rack
from gearopt.report.design_tables import PAGE_ONLY, STAGE_ROWS
from gearopt.scenes.drive.tables.drive import ORIGINS, PRESETS
from gearopt.scenes.parts import tooth_warnings
from gearopt.scenes.servo.notes import notes as servo_notes

PROBLEMS = Path(__file__).parents[3] / "problems"
FILE = """
gearopt = 1
kind = "drive"
[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
ratio = 21.8
[gears]
helix_angle = "25 deg"
[[stage]]
module = "2 mm"
pinion_teeth = 21
wheel_teeth = 115
face_width = "28 mm"
[[stage]]
module = "3 mm"
pinion_teeth = 23
wheel_teeth = 91
face_width = "58 mm"
[limits]
preset = "chong-lee-elevator"
pinion_teeth = [20, 40]
[teeth]
"""


def solved(tmp_path, text):
    path = tmp_path / "drive.toml"
    path.write_text(text)
    return gearopt.solve(path)


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return solved(tmp_path_factory.mktemp("drive"), FILE)


def test_numbers_of_a_drawing(result):
    """Teeth and widths are given, so every number has a closed form."""
    cosine, tangent = math.cos(math.radians(25)), math.tan(math.radians(20))
    alpha = math.atan(tangent / cosine)
    speed = 1450 * math.pi / 30
    for stage, (m, z1, z2, b) in zip(
        result.design["stages"], ((2, 21, 115, 28), (3, 23, 91, 58)), strict=True
    ):
        assert stage["pinion_tip_diameter_mm"] == pytest.approx(m * (z1 / cosine + 2))
        assert stage["wheel_tip_diameter_mm"] == pytest.approx(m * (z2 / cosine + 2))
        assert stage["pinion_root_diameter_mm"] == pytest.approx(m * (z1 / cosine - 2.5))
        assert stage["wheel_root_diameter_mm"] == pytest.approx(m * (z2 / cosine - 2.5))
        turns = [math.acos(z * math.cos(alpha) / (z + 2 * cosine)) for z in (z1, z2)]
        contact = sum(
            z * (math.tan(t) - math.tan(alpha)) for z, t in zip((z1, z2), turns, strict=True)
        ) / (2 * math.pi)  # the same path by pressure angles at the tips
        assert stage["transverse_contact_ratio"] == pytest.approx(contact, rel=1e-12)
        sine = math.sin(math.radians(25))
        assert stage["overlap_ratio"] == pytest.approx(b * sine / (math.pi * m))
        velocity = stage["pitch_line_velocity_m_per_s"]
        assert velocity == pytest.approx(speed * m * z1 / cosine / 2000)
        tangential = 2e3 * stage["pinion_torque_Nm"] / stage["pinion_diameter_mm"]
        assert tangential * velocity == pytest.approx(7500, rel=1e-12)  # the power, in W
        volumes = [math.pi / 4 * b * (m * z / cosine) ** 2 for z in (z1, z2)]
        assert stage["pinion_mass_kg"] == pytest.approx(7.85e-6 * volumes[0])
        assert stage["wheel_mass_kg"] == pytest.approx(7.85e-6 * volumes[1])
        assert stage["mass_kg"] == pytest.approx(7.85e-6 * sum(volumes))
        speed *= z1 / z2
    assert result.design["mass_kg"] == pytest.approx(7.85e-6 * result.design["gear_volume_mm3"])


def test_a_density_of_the_file_counts(tmp_path, result):
    text = FILE + '[objective]\ndensity = "7.2 kg/dm^3"\n'
    found = solved(tmp_path, text)
    assert found.design["mass_kg"] == pytest.approx(result.design["mass_kg"] * 7.2 / 7.85)
    assert any("density of the file, 7.2 kg/dm^3" in s for s in found.report["assumptions"])
    assert any("steel, 7.85 kg/dm³" in s for s in result.report["notes"])


def test_the_pressure_angle_changes_the_contact_ratio_alone(tmp_path, result):
    text = FILE.replace('"25 deg"', '"25 deg"\npressure_angle = "25 deg"')
    found, angle = solved(tmp_path, text), ("transverse_contact_ratio", "pressure_angle_deg")
    one, other = (
        {k: v for k, v in r.design["stages"][0].items() if k not in angle} for r in (result, found)
    )
    assert one == other and result.limits == found.limits
    was, now = (r.design["stages"][0]["transverse_contact_ratio"] for r in (result, found))
    assert now < 0.9 * was
    assert any("pressure angle of 25 deg" in s for s in found.report["assumptions"])


def test_assumptions_name_preset_rating_and_rack(result):
    words = " ".join(result.report["assumptions"])
    for word in ("ISO 53 profile A", "ISO 6336", "AGMA 2101", "profile shift", "Chong and Lee"):
        assert word in words
    assert "learances" not in words and set(ORIGINS) == set(PRESETS)


@pytest.mark.slow
def test_assumptions_of_a_layout_tell_defaults_from_what_the_file_gives(tmp_path):
    table = '[layout]\nshaft_stress = "40 MPa"\nwall_clearance = "8 mm"\n'
    found = solved(tmp_path, FILE + table)
    words = " ".join(found.report["assumptions"])
    assert "to the walls across the shafts 8 mm," in words
    assert "between gears that do not mesh 5 mm (default)" in words
    assert "torsion alone at 40 MPa" in words and "no bearings" in words
    gears = {g["name"]: g for g in found.design["layout"]["gears"]}
    for k, stage in enumerate(found.design["stages"], 1):
        for member in ("pinion", "wheel"):
            for size in ("tip", "root"):
                told = stage[f"{member}_{size}_diameter_mm"]
                assert gears[f"{member} {k}"][f"{size}_diameter_mm"] == told


@pytest.mark.parametrize("teeth", [15, 16, 17, 18])
def test_an_undercut_pinion_is_named(tmp_path, result, teeth):
    """At 0 degrees 17 teeth are the least (17.1 in theory); at 25 degrees 13 (13.05)."""
    assert not any("undercut" in note for note in result.report["notes"])
    text = FILE.replace('"25 deg"', '"0 deg"').replace("[20, 40]", "[12, 40]")
    text = text.replace("pinion_teeth = 21\nwheel_teeth = 115", f"pinion_teeth = {teeth}\n")
    text = text.replace("wheel_teeth = 91", "").replace(
        'face_width = "28 mm"', 'face_width = "80 mm"'
    )
    text = text.replace('module = "2 mm"', 'module = "4 mm"').replace('"3 mm"', '"5 mm"')
    found = solved(tmp_path, text.replace('"58 mm"', '"120 mm"'))
    assert found.value is not None
    notes = [n for n in found.report["notes"] if "undercut" in n]
    assert len(notes) == (teeth < 17)
    if notes:
        assert "stage 1" in notes[0] and f"(z = {teeth})" in notes[0]
        assert "A rack cuts 17 teeth or more without undercut at x = 0 (strictly 17.1)" in notes[0]


@pytest.mark.parametrize(
    ("pressure", "helix", "least"),
    [(20, 0, 17), (14.5, 0, 31), (25, 0, 12), (20, 25, 13), (20, 45, 7)],
)
def test_the_least_teeth_that_are_not_named_are_those_of_tables(pressure, helix, least):
    """Tables have 32 of 14.5 degrees, of racks with a smaller tip radius than ISO 53."""
    angles = math.radians(pressure), math.radians(helix)
    pairs = [
        GearPair.of_teeth(2.0, z, 60, 20.0, angles[1], Rack(angles[0]))
        for z in (least - 1, least, least + 1, least - 2)
    ]
    notes = [n for n in tooth_warnings(pairs, " So.") if "is undercut" in n]
    assert [n[: n.index(" is undercut")] for n in notes] == [
        "The pinion of stage 1",
        "The pinion of stage 4",
    ]
    assert all(f"A rack cuts {least} teeth or more without undercut at x = 0" in n for n in notes)
    assert all(n.endswith(" So.") for n in notes)
    flank = 1.25 - 0.38 * (1.0 - math.sin(angles[0]))  # where that of the rack ends
    transverse = math.atan(math.tan(angles[0]) / math.cos(angles[1]))
    for z, named in ((least - 1, True), (least, False)):  # how far the rack reaches too deep
        deep = flank - 0.5 * z / math.cos(angles[1]) * math.sin(transverse) ** 2
        assert (deep > 0.01) is named


def test_a_servo_train_names_the_same_pinions():
    scene = gearopt.load(PROBLEMS / "servo_gimbal_light.toml")
    stages = tuple(Stage(0.5, z, 100, 100 / z, *[1.0] * 5) for z in (16, 17))
    design = ServoDesign(train=TrainDesign(stages, 37.0))
    said = [n for n in servo_notes(scene, (), design, ServoReport()) if "undercut" in n]
    assert len(said) == 1 and "stage 1 is undercut (z = 16)" in said[0]


def test_a_stop_while_real_valued_sizes_are_sought_is_heard(tmp_path):
    """And their value, which whole teeth never reach, is not told as the best one so far."""
    path, seen = tmp_path / "drive.toml", []
    path.write_text(FILE)
    stopped = gearopt.solve(path, watch=lambda event: bool(seen.append(event)))
    assert stopped.status == "limit" and stopped.value is None
    assert len(seen) == 2 and seen[0].part == "sizing" and seen[1].best is None
    gearopt.solve(path, watch=lambda event: seen.append(event) is None)
    told = [event.best for event in seen if event.part == "teeth" and event.best is not None]
    assert told == sorted(told, reverse=True)


def test_the_table_of_stages_has_a_row_for_every_key(result):
    """And for those of other strength laws."""
    assert PAGE_ONLY < set(result.design["stages"][0]) <= set(STAGE_ROWS)
