"""REXS files read: every version and container gives the same drive; what has no place is said."""

import tomllib
from decimal import Decimal

import pytest
from rexs_files import as_json, planetary, unit, xml, zipped

import gearopt
from gearopt import units


@pytest.fixture
def read(tmp_path):
    """read(model): the tables of the problem file, and its comments."""

    def call(model):
        data = xml(model) if isinstance(model, dict) else model
        path = tmp_path / "unit.rexs"
        path.write_bytes(data if isinstance(data, bytes) else data.encode())
        text = gearopt.read_rexs(path)
        comments = " ".join(line for line in text.splitlines() if line.startswith("#"))
        return tomllib.loads(text, parse_float=Decimal), " ".join(comments.replace("#", "").split())

    return call


def number(text):
    """The number of a quantity."""
    return float(text.split()[0])


def test_a_unit_is_read(read):
    """By hand: A_sn = A_W/cos 20, sigma_Flim = sigma_FE/2, x = -0.3 mm/3 mm, P = T n."""
    tables, comments = read(unit())
    first, second = tables["stage"]
    assert (first["module"], first["pinion_teeth"], first["wheel_teeth"]) == ("3 mm", 19, 62)
    assert (first["helix_angle"], first["pinion_hand"]) == ("15 deg", "right")
    assert (first["centre_distance"], second["centre_distance"]) == ("127.5 mm", "183 mm")
    assert (first["face_width"], first["pinion"]["face_width"]) == ("40 mm", "45 mm")
    assert (second["pinion_hand"], second["overload_factor"]) == ("left", Decimal("1.25"))
    pinion, wheel = first["pinion"], first["wheel"]
    assert (pinion["profile_shift"], wheel["profile_shift"]) == (Decimal("0.3"), Decimal("-0.1"))
    assert pinion["tip_alteration"] == Decimal("-0.1")
    assert number(wheel["thickness_allowance"]) == pytest.approx(-0.08 / 0.9396926207859084)
    assert (pinion["tool_addendum"], pinion["tool_tip_radius"]) == (Decimal("1.4"), Decimal("0.25"))
    assert (pinion["sigma_Hlim"], pinion["sigma_Flim"]) == ("1500 MPa", "461 MPa")
    assert (pinion["iso_material"], pinion["elastic_modulus"]) == ("Eh", "210000 MPa")
    assert second["pinion"]["roughness"] == "0.6 um" and "tip_alteration" not in second["wheel"]
    assert tables["rating"]["iso6336"]["oil_grade"] == "320 mm^2/s"
    assert tables["objective"]["density"] == "7.83 kg/dm^3"
    assert tables["duty"] == {"torque": "200 N m", "input_speed": "900 rpm"}
    loads = [(number(r["power"]), r["input_speed"], r["share"]) for r in tables["load"]]
    for (power, *_), (torque, speed) in zip(loads, ((120, 1500), (200, 900)), strict=True):
        assert power == pytest.approx(torque * speed * 2 * 3.141592653589793 / 60e3, rel=1e-14)
    assert [row[1:] for row in loads] == [("1500 rpm", "25 %"), ("900 rpm", "75 %")]
    assert "component 24 (cylindrical_gear): tip_diameter 1 mm is no tip circle" in comments
    assert 'shaft = 2, y = "-90 mm", z = "90 mm"' in comments
    assert "shaft_section 81: length, outer_diameter_begin" in comments
    assert 'life = "20000 h" needed' in comments and "surface_hardness_brinell" in comments


def test_every_container_says_the_same(read):
    wanted = read(unit())
    for other in (as_json(unit()), zipped(xml(unit())), zipped(as_json(unit()), "a.rexsj")):
        assert read(other) == wanted
    spaced = xml(unit()).replace("<model ", '<model xmlns="http://rexs.info" ', 1)
    assert read(spaced) == wanted and read(b"\xef\xbb\xbf" + spaced.encode()) == wanted


RENAMED = {  # of versions before 2.0: name now, by the changelogs of REXS
    "load_duration_fraction": "operating_time_fraction",
    "tip_radius_factor": "tip_corner_radius_factor_reference_profile",
    "endurance_limit_flank": "allowable_stress_number_contact_iso_6336_2003",
    "basic_strength_root": "allowable_stress_number_tooth_root_iso_6336_2003",
    "arithmetic_average_roughness_flank": "arithmetic_mean_roughness_flank_iso_4287_1997",
    "N / mm^2": "MPa",
    "\u00b0": "deg",
}


@pytest.mark.parametrize("version", ("1.0", "1.1", "1.3", "1.5", "1.7", "2.0", "2.0.0"))
def test_every_version_says_the_same(read, version):
    text = xml(unit()).replace('version="1.4"', f'version="{version}"')
    if version > "1.7":
        for before, now in RENAMED.items():
            assert before in text
            text = text.replace(before, now)
    tables, wanted = read(text)[0], read(unit())[0]
    assert tables.pop("source") != wanted.pop("source")
    assert tables == wanted


def test_strengths_of_version_1_0_stand_at_the_gear_and_tools_are_its_references(read):
    model = unit()
    strengths = {"endurance_limit_flank": (1450, "N / mm^2"), "endurance_limit_root": (430, "MPa")}
    model["components"][23][1].update(strengths)
    model["relations"] = [r for r in model["relations"] if 61 not in r[1].values()]
    model["relations"].append(("ordered_reference", {"origin": 23, "referenced": 51}))
    pinion = read(model)[0]["stage"][1]["pinion"]
    assert (pinion["sigma_Hlim"], pinion["sigma_Flim"]) == ("1450 MPa", "430 MPa")
    assert pinion["tool_addendum"] == Decimal("1.4")


def test_a_tooth_thickness_at_the_pitch_diameter_is_not_taken(read):
    """Up to 1.7 it was that at the reference diameter, and is that at the working one now."""
    model, wanted = unit(), read(unit())[0]
    model["components"][21][1]["normal_tooth_thickness_at_pitch_diameter"] = (4.0, "mm")
    tables, comments = read(model)
    assert tables == wanted and "normal_tooth_thickness_at_pitch_diameter" in comments


def test_depths_of_relief_are_in_mm(read):
    model = unit()
    for k, flank in enumerate((41, 42, 43, 44, 45)):
        model["components"][90 + k] = ("tip_relief", {"tip_relief_depth": (0.03, "mm")})
        model["relations"].append(("reference", {"origin": flank, "referenced": 90 + k}))
    relief = read(model)[0]["rating"]["iso6336"]["tip_relief"]
    assert units.parse(relief, "length").value == pytest.approx(30e-3)


@pytest.mark.parametrize(("classes", "of_all"), (((5, 6, 7, 10), 10), ((5, None, 6, 7), None)))
def test_tolerance_classes_are_those_of_2013(read, classes, of_all):
    model = unit()
    for gear, grade in zip((21, 22, 23, 24), classes, strict=True):
        if grade:
            model["components"][gear][1]["tolerance_class_according_to_iso_1328_2013"] = grade
    tables, comments = read(model)
    iso = tables["rating"]["iso6336"]
    assert (iso["tolerances"], iso.get("accuracy_grade")) == ("2013", of_all)
    assert ("accuracy_grade = 6 needed" in comments) is (of_all is None)
    gears = [stage[member] for stage in tables["stage"] for member in ("pinion", "wheel")]
    assert tuple(g.get("accuracy_grade") for g in gears) == classes


def test_times_of_load_cases_are_shares_and_the_life(read):
    model = unit()
    for case, hours in zip(model["cases"], (3000, 9000), strict=True):
        case[1] = {"operating_time": (hours, "h")}
    tables, _ = read(model)
    assert [row["share"] for row in tables["load"]] == ["25 %", "75 %"]
    assert tables["rating"]["life"] == "12000 h"


def test_a_load_case_says_what_changes(read):
    """Torque stays 150 N m where a case speaks of other attributes of the load alone."""
    model = unit()
    model["components"][71][1]["torque_around_u_axis"] = (150, "N m")
    model["components"][11][1]["rotational_speed"] = (1000, "1 / min")
    model["cases"][0][71] = {"force_v_direction": (456, "N")}
    tables, _ = read(model)
    assert tables["duty"] == {"torque": "150 N m", "input_speed": "1000 rpm"}
    power = 150 * 1500 * 2 * 3.141592653589793 / 60e3
    assert number(tables["load"][0]["power"]) == pytest.approx(power, rel=1e-14)


def test_a_speed_of_a_load_case_goes_before_that_of_the_duty(read):
    """The case gives the output shaft's: 90 rpm times 62 61/(19 18)."""
    model = unit()
    model["components"][11][1]["rotational_speed"] = (1000, "1 / min")
    del model["cases"][0][11]
    model["cases"][0][13] = {"rotational_speed": (90, "1 / min")}
    speed = read(model)[0]["load"][0]["input_speed"]
    assert number(speed) == pytest.approx(90 * 62 * 61 / (19 * 18), rel=1e-14)


def test_torque_that_changes_its_sign_is_told(read):
    model = unit()
    model["cases"][1][71] = {"torque_around_u_axis": (-200, "N m")}
    tables, comments = read(model)
    assert tables["load"] == read(unit())[0]["load"]
    assert "write reversed_load = true at gears whose teeth are bent both ways" in comments


def test_power_below_zero_leaves(read):
    model = unit()
    model["cases"] = []
    model["components"][13][1]["rotational_speed"] = (90, "1 / min")
    model["components"][72][1]["power"] = (-3, "kW")
    stages = read(model)[0]["stage"]
    assert [s.get("driver") for s in stages] == [None, None] and stages[0]["pinion_teeth"] == 19


def test_torque_that_leaves_is_that_of_the_output(read):
    """T = -200 N m at 90 rpm of the slow shaft: i = 62 61/(19 18), and the fast shaft drives."""
    model = unit()
    model["cases"] = []
    model["components"][13][1]["rotational_speed"] = (90, "1 / min")
    model["components"][72][1]["torque_around_u_axis"] = (-200, "N m")
    duty = read(model)[0]["duty"]
    ratio = 62 * 61 / (19 * 18)
    assert number(duty["torque"]) == pytest.approx(200 / ratio, rel=1e-14)
    assert number(duty["input_speed"]) == pytest.approx(90 * ratio, rel=1e-14)


def test_power_that_enters_at_the_slow_shaft_is_driven_by_wheels(read):
    model = unit()
    model["cases"] = []
    model["components"][13][1]["rotational_speed"] = (90, "1 / min")
    model["components"][72][1]["power"] = (3, "kW")
    tables, _ = read(model)
    assert [s["driver"] for s in tables["stage"]] == ["wheel", "wheel"]
    assert tables["stage"][0]["pinion_teeth"] == 18
    assert number(tables["duty"]["torque"]) == pytest.approx(
        3000 / (90 * 2 * 3.14159265358979 / 60)
    )


def test_an_idler_is_one_gear_in_two_meshes(read):
    model = unit()
    model["components"][23][1].update(number_of_teeth=40, helix_angle_reference_diameter=0)
    model["components"][24][1].update(helix_angle_reference_diameter=0)
    for gear in (21, 22):
        model["components"][gear][1].update(
            normal_module=(4.5, "mm"), helix_angle_reference_diameter=0, face_width=(65, "mm")
        )
    del model["components"][21][1]["tip_diameter"]
    model["components"][31][1].pop("center_distance")
    model["components"][32][1].clear()
    relations = [r for r in model["relations"] if r[0] != "stage" and 22 not in r[1].values()]
    relations += [("stage", {"stage": 31, "gear_1": 21, "gear_2": 23})]
    model["relations"] = [*relations, ("stage", {"stage": 32, "gear_1": 23, "gear_2": 24})]
    first, second = read(model)[0]["stage"]
    assert (first["wheel_teeth"], second["idler"], second["wheel_teeth"]) == (40, True, 61)
    assert "pinion_teeth" not in second and "module" not in second


def test_planets_are_grouped(read):
    tables, _ = read(planetary())
    stage = tables["stage"][0]
    teeth = [stage[f"{name}_teeth"] for name in ("sun", "planet", "ring")]
    assert (stage["type"], stage["planets"], teeth) == ("planetary", 3, [17, 22, 61])
    assert stage["centre_distance"] == "78 mm" and "fixed" not in stage


@pytest.mark.parametrize(
    ("held", "fixed", "ratio"), ((8, "carrier", 61 / 17), (6, "sun", 1 + 17 / 61))
)
def test_the_member_at_the_casing_is_fixed(read, held, fixed, ratio):
    model = planetary()
    model["relations"][5][1]["inner_part"] = held
    free = 7
    model["relations"][3] = ("assembly", {"assembly": free, "part": 9})
    del model["components"][6][1]["rotational_speed"]
    model["components"][free][1]["rotational_speed"] = (100, "1 / min")
    tables, comments = read(model)
    assert tables["stage"][0]["fixed"] == fixed
    turned = fixed == "carrier"  # the ring drives the sun, which is described from the sun
    speed = 100 * ratio if turned else 100
    assert number(tables["duty"]["input_speed"]) == pytest.approx(speed)
    assert ("increases the speed" in comments) is turned


def test_the_command_prints_a_file_and_refuses_in_one_line(here, tmp_path):
    path = tmp_path / "unit.rexs"
    path.write_text(xml(unit()), encoding="utf-8")
    done = here("import", path)
    assert done.returncode == 0 and done.stdout == gearopt.read_rexs(path) and not done.stderr
    path.write_text("<model", encoding="utf-8")
    done = here("import", path)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and not done.stdout
