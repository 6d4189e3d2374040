"""Idlers: gears in two meshes, rated in both, counted once."""

import math
import re

import pytest
from rated_files import pair

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.report.drawing.train_views import views
from gearopt.report.measures import METRIC

IDLER = {"idler": True, "wheel_teeth": 60}


def train(stage=None, second=None, **more):
    """The tables of a pinion of 20 teeth, an idler of 31 and a wheel of 60."""
    made = pair(**({"wheel_teeth": 31, "face_width": "40 mm"} | (stage or {})), **more)
    made["stage"].append(IDLER | (second or {}))
    return made


def rows(tables):
    """The rating of every gear by its stage and member."""
    gears = gearopt.rate(tables).design["rating"]["gears"]
    return {(gear["stage"], gear["member"]): gear for gear in gears}


def test_an_idler_by_hand():
    """AGMA 2001 with factors that are given, so that stresses are a line each.

    T1 = 7500 W/(1450 pi/30 1/s) = 49.393 N m and W_t = 2 T1/60 mm = 1646.4 N in both meshes.
    s_t = W_t K_o K_v K_m/(b m J) with b 40 mm, m 3 mm: of the idler in the first mesh (J 0.4)
    1646.4 1.25 1.2 1.3/(120 0.4) = 66.886 MPa, and S_F = 0.7 s_at Y_N/s_t with s_at 380 MPa, Y_N
    0.9: 3.5792. In the second mesh its J is 0.35: 76.441 MPa, 3.1318. The wheel, J 0.4, is not
    bent both ways: S_F = 380 0.9/66.886 = 5.1131. s_c = C_p sqrt(W_t K_o K_v K_m/(d_w1 b I)) with
    d_w1 = 60 mm and 93 mm, I 0.1, C_p 190: 190 sqrt(3210.5/240) = 694.92 MPa, 558.17 MPa.
    """
    factors = {"K_v": 1.2, "K_m": 1.3, "J": [0.35, 0.4], "Y_N": 0.9, "I": 0.1}
    given = {"given": factors | {"C_p": "190 sqrt(MPa)"}}
    found = rows(train(rating=given, gears={"s_at": "380 MPa"}))
    assert found[1, "wheel"]["bending_stress_MPa"] == pytest.approx(66.886, rel=1e-4)
    assert found[1, "wheel"]["bending_safety"] == pytest.approx(3.5792, rel=1e-4)
    assert found[2, "pinion"]["bending_stress_MPa"] == pytest.approx(76.441, rel=1e-4)
    assert found[2, "pinion"]["bending_safety"] == pytest.approx(3.1318, rel=1e-4)
    assert found[2, "wheel"]["bending_safety"] == pytest.approx(5.1131, rel=1e-4)
    assert found[1, "wheel"]["contact_stress_MPa"] == pytest.approx(694.92, rel=1e-4)
    assert found[2, "pinion"]["contact_stress_MPa"] == pytest.approx(558.17, rel=1e-4)


def test_an_idler_is_counted_once():
    """Three cylinders; cycles of one flank a revolution; Y_M 0.7 of ISO 6336-5 in both meshes."""
    both = {"standard": "both", "iso6336": {"accuracy_grade": 6}}
    design = gearopt.rate(train(rating=both)).design
    volume = 0.25 * math.pi * 40.0 * (60.0**2 + 93.0**2 + 180.0**2)
    assert design["gear_volume_mm3"] == pytest.approx(volume, rel=1e-12)
    assert design["mass_kg"] == pytest.approx(7.85e-6 * volume, rel=1e-12)
    masses = [s["pinion_mass_kg"] + s["wheel_mass_kg"] for s in design["stages"]]
    assert sum(masses) == pytest.approx(design["mass_kg"], rel=1e-12)
    assert design["ratio"] == pytest.approx(3.0, rel=1e-12)
    assert design["sum_of_centre_distances_mm"] == pytest.approx(213.0, rel=1e-12)
    rating = design["rating"]
    revolutions = 20000.0 * 60.0 * 1450.0 * 20.0 / 31.0
    idler = [
        g for g in rating["gears"] if (g["stage"], g["member"]) in ((1, "wheel"), (2, "pinion"))
    ]
    assert [g["cycles"] for g in idler] == pytest.approx([revolutions] * 2, rel=1e-12)
    (first, second) = (f for f in rating["beside"]["factors"] if f["symbol"] == "Y_M")
    assert (first["pinion"], first["wheel"]) == (1.0, 0.7)
    assert (second["pinion"], second["wheel"]) == (0.7, 1.0)
    assert [s["torque_Nm"] for s in rating["shafts"]] == pytest.approx([49.393, 0.0, 148.179], 1e-5)


def test_helical_idlers_bear_no_axial_force():
    """Both meshes push it, one each way; the second pinion has the hand of the first wheel."""
    helical = gearopt.rate(train({"helix_angle": "15 deg", "pinion_hand": "left"})).design["rating"]
    input_, idler, output = (s["axial_force_N"] for s in helical["shafts"])
    assert idler == pytest.approx(0.0, abs=1e-9) and input_ == pytest.approx(-output, rel=1e-12)
    assert [t["hand"] for t in helical["teeth"]] == ["left", "right", "right", "left"]


def test_three_gears_are_drawn_on_three_shafts():
    front, side = views(gearopt.rate(train()).design["stages"], METRIC)
    assert front.svg.count('class="tip') == 3 == side.svg.count('class="tip')
    assert [side.svg.count(f">b{k} ") for k in (1, 2)] == [1, 0]


def test_widths_in_diameters_are_those_of_the_first_pinion():
    made = train({"face_width_over_diameter": 0.7})
    del made["stage"][0]["face_width"]
    assert [s["face_width_mm"] for s in gearopt.rate(made).design["stages"]] == [42.0, 42.0]


@pytest.mark.parametrize(
    ("stage", "second", "place", "rule"),
    [
        ({"idler": True}, {}, "stage[1].idler", "is of the first stage"),
        ({}, {"module": "4 mm"}, "stage[2].module", "follows from the wheel of stage 1"),
        ({}, {"pinion_teeth": 30}, "stage[2].pinion_teeth", "follows"),
        ({}, {"face_width": "41 mm"}, "stage[2].face_width", "follows"),
        ({}, {"helix_angle": "5 deg"}, "stage[2].helix_angle", "follows"),
        ({}, {"pinion_hand": "left"}, "stage[2].pinion_hand", "follows"),
        ({}, {"pinion": {"profile_shift": 0.1}}, "stage[2].pinion.profile_shift", "follows"),
        ({}, {"pinion": {"contacts": 2}}, "stage[2].pinion.contacts", "follows"),
        ({"wheel": {"reversed_load": False}}, {}, "stage[1].wheel.reversed_load", "bent both ways"),
        ({"wheel_teeth": [25, 31]}, {}, "stage[2].idler", "needs a table .teeth."),
        ({}, {"wheel_teeth": 30}, "stage[2].wheel_teeth", "is below pinion_teeth.*as a pair"),
        ({"wheel_teeth": 19}, {}, "stage[1].wheel_teeth", "is below pinion_teeth.*as a pair"),
    ],
)
def test_what_does_not_fit_an_idler_is_refused_by_name(stage, second, place, rule):
    with pytest.raises(SceneError, match=f"{re.escape(place)} = .*{rule}"):
        gearopt.rate(train(stage, second))


def test_what_is_said_twice_and_the_same_is_taken():
    again = {"module": "3 mm", "pinion_teeth": 31, "pinion": {"profile_shift": 0.2}}
    once = train({"wheel": {"profile_shift": 0.2}})
    twice = train({"wheel": {"profile_shift": 0.2}}, again)
    assert gearopt.rate(once).design == gearopt.rate(twice).design


def sized(more=None, stage=None, second=None, limits=None, gears=None):
    """The tables of a drive whose pinion, idler and wheel are chosen."""
    return {
        "gearopt": 1,
        "kind": "drive",
        "duty": {
            "power": "7.5 kW",
            "input_speed": "1450 rpm",
            "ratio": 3,
            "ratio_tolerance": "1 %",
        },
        "gears": {"treatment": "carburised", "face_width_over_diameter": [0.3, 1]} | (gears or {}),
        "stage": [{"wheel_teeth": [20, 25]} | (stage or {}), {"idler": True} | (second or {})],
        "limits": {"pinion_teeth": [19, 20]} | (limits or {}),
        "teeth": {"modules": ["2.5 mm", "3 mm"]},
        "rating": {"life": "20000 h", "quality": 8, "minimum_bending_safety": 1.4},
    } | (more or {})


def test_gears_with_an_idler_are_sized_and_rated():
    """The rating of the three gears given, as a file of their own, has the safety factors asked."""
    result = gearopt.solve(sized())
    assert result.status == "optimal"
    first, second = result.design["stages"]
    assert second["idler"] and second["pinion_teeth"] == first["wheel_teeth"]
    b, d = first["face_width_mm"], (*_diameters(first), second["wheel_diameter_mm"])
    assert result.value == pytest.approx(0.25 * math.pi * b * sum(x**2 for x in d), rel=1e-9)
    given = {"module": f"{first['normal_module_mm']} mm", "face_width": f"{b!r} mm"}
    given |= {"pinion_teeth": first["pinion_teeth"], "wheel_teeth": first["wheel_teeth"]}
    tables = sized(stage=given, second={"wheel_teeth": second["wheel_teeth"]})
    for name in ("limits", "teeth"):
        del tables[name]
    used = gearopt.rate(tables).limits
    assert max(used.values()) == pytest.approx(1.0, rel=1e-7)
    assert max(result.limits.values()) == pytest.approx(max(used.values()), rel=1e-7)


def _diameters(stage):
    return stage["pinion_diameter_mm"], stage["wheel_diameter_mm"]


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        (sized({"objective": {"minimise": "mesh_loss"}}), "needs minimise"),
        (sized({"teeth": {"coprime": True}}), "without coprime"),
        (sized({"stage": [{}, {"idler": True}]}), "needs its teeth: wheel_teeth of stage 1"),
        (sized({"stage": [{"wheel_teeth": 20}, {"idler": True}, {}]}), "in the last stage alone"),
        (sized(second={"centre_distance": "90 mm"}), "together with centre_distance"),
        (sized(second={"minimum_contact_safety": 2}), "together with minimum_contact_safety"),
        (sized(gears={"helix_angle": ["0 deg", "10 deg"]}), "one material, helix angle"),
        (sized(stage={"wheel": {"bore": "20 mm"}}), "solid gears"),
        (sized(stage={"wheel_diameter": "60 mm"}), "together with wheel_diameter of stage 1"),
        (sized(gears={"pinion_face_width_excess": "5 mm"}), "with pinion_face_width_excess"),
        (sized({"shift": {"sum": 0.3}}), "helix angle and shift"),
        (sized(limits={"preset": "chong-lee-elevator"}), "limits by .rating. alone"),
        (sized({"layout": {"shaft_diameters": ["20 mm"] * 3}}), "together with a .layout."),
    ],
)
def test_what_no_search_knows_beside_an_idler_is_refused(tables, words):
    with pytest.raises(SceneError, match=rf"stage\[\d\].idler = true: .*{words}.*gearopt rate"):
        gearopt.solve(tables)


def test_extremes_are_no_objective_of_a_front_beside_an_idler():
    """They would be those of pinion and wheel, which are not in mesh."""
    with pytest.raises(SolveError, match="no idler"):
        gearopt.pareto(sized(), objectives=["gear_volume", "inverse_contact_ratio"])


def test_lengths_are_no_objective_of_a_front_beside_an_idler():
    with pytest.raises(SolveError, match="sum_of_centre_distances is not for stages with an idler"):
        gearopt.pareto(sized(), objectives=["gear_volume", "sum_of_centre_distances"])
