"""Profile shifts, helix and tools of stages and gears in the file of a drive."""

import math

import pytest
from scipy.optimize import brentq

import gearopt
from gearopt import SceneError

FILE = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "7.5 kW", "input_speed": "1450 rpm", "ratio": 4},
    "gears": {"helix_angle": "12 deg"},
    "stage": [
        {
            "module": "2 mm",
            "pinion_teeth": 21,
            "wheel_teeth": 84,
            "face_width": "40 mm",
            "pinion": {"profile_shift": 0.4},
            "wheel": {"profile_shift": 0.1},
        }
    ],
    "limits": {"k_factor": "4 MPa", "unit_load": "90 MPa", "pinion_teeth": [14, 40]},
    "teeth": {},
}


def involute(angle):
    return math.tan(angle) - angle


def test_a_shifted_pair_has_the_centre_distance_of_iso_21771():
    """inv(alpha_wt) = inv(alpha_t) + 2 (x1 + x2) tan(alpha_n)/(z1 + z2), solved by bisection."""
    stage = gearopt.solve(FILE).design["stages"][0]
    beta, alpha = math.radians(12.0), math.radians(20.0)
    transverse = math.atan(math.tan(alpha) / math.cos(beta))
    value = involute(transverse) + 2.0 * 0.5 * math.tan(alpha) / 105
    working = brentq(lambda a: involute(a) - value, 0.1, 0.9, xtol=1e-15)
    distance = 105 / math.cos(beta) * math.cos(transverse) / math.cos(working)
    assert stage["centre_distance_mm"] == pytest.approx(distance, rel=1e-12)
    assert stage["working_pressure_angle_deg"] == pytest.approx(math.degrees(working), rel=1e-12)
    tips = 42 / math.cos(beta) + 2.8 * 2.0, 168 / math.cos(beta) + 2.2 * 2.0
    assert stage["pinion_tip_diameter_mm"] == pytest.approx(tips[0], rel=1e-14)
    assert stage["wheel_tip_diameter_mm"] == pytest.approx(tips[1], rel=1e-14)


def test_shifts_change_neither_volume_nor_the_limits_of_a_drive():
    bare = {"stage[1].pinion": None, "stage[1].wheel": None}
    shifted, plain = gearopt.solve(FILE), gearopt.solve(FILE, bare)
    assert shifted.value == plain.value and shifted.limits == plain.limits
    assert any("with the profile shifts" in text for text in shifted.report["assumptions"])
    assert any("without profile shift" in text for text in plain.report["assumptions"])


def test_a_given_centre_distance_is_the_working_one():
    stage = gearopt.solve(FILE, {"stage[1].centre_distance": "109 mm"}).design["stages"][0]
    assert stage["centre_distance_mm"] == 109.0
    beta = math.radians(12.0)
    transverse = math.atan(math.tan(math.radians(20.0)) / math.cos(beta))
    working = math.acos(105 / math.cos(beta) * math.cos(transverse) / 109.0)
    assert stage["working_pressure_angle_deg"] == pytest.approx(math.degrees(working), rel=1e-12)


def test_every_stage_has_its_own_helix_and_every_gear_its_own_tool():
    first = FILE["stage"][0] | {"helix_angle": "20 deg", "pressure_angle": "25 deg"}
    second = {"module": "3 mm", "pinion_teeth": 22, "wheel_teeth": 66, "face_width": "60 mm"}
    second |= {"pinion": {"tool_addendum": 1.4, "addendum": 1.1}}
    what = FILE | {"stage": [first, second], "duty": FILE["duty"] | {"ratio": 12}}
    one, two = gearopt.solve(what).design["stages"]
    assert one["helix_angle_deg"] == 20.0 and one["pressure_angle_deg"] == 25.0
    assert one["pinion_diameter_mm"] == pytest.approx(42 / math.cos(math.radians(20.0)), rel=1e-14)
    assert two["helix_angle_deg"] == 12.0 and "pressure_angle_deg" not in two
    d = 66 / math.cos(math.radians(12.0))
    assert two["pinion_root_diameter_mm"] == pytest.approx(d - 2.8 * 3.0, rel=1e-14)
    assert two["pinion_tip_diameter_mm"] == pytest.approx(d + 2.2 * 3.0, rel=1e-14)


@pytest.mark.parametrize(
    ("changes", "key", "said"),
    [
        (
            {"objective.minimise": "total_length"},
            "stage[1].pinion.profile_shift",
            "minimise = total_length takes from the reference circles",
        ),
        (
            {"layout": {"shaft_stress": "40 MPa", "together": True}},
            "stage[1].pinion.profile_shift",
            "together takes from the reference circles",
        ),
        (
            {"stage[1].pinion_teeth": None, "stage[1].centre_distance": "110 mm"},
            "stage[1].centre_distance",
            "needs gears that are all given",
        ),
        ({"stage[1].pinion.profile_shift": 5}, "stage[1].pinion.profile_shift", "between -3 and 3"),
        (
            {"stage[1].pinion.thickness_allowance": "0.05 mm"},
            "stage[1].pinion.thickness_allowance",
            "teeth are thinned",
        ),
        (
            {"gears.addendum": 1.3},
            "gears.addendum",
            "tips of the pinion reach 0.05 m_n into the roots of its mate, whatever the teeth",
        ),
        ({"stage[1].wheel.tool_addendum": 0.9}, "stage[1].wheel.tool_addendum", "reach 0.1 m_n"),
        ({"stage[1].diametral_pitch": 12}, "stage[1].diametral_pitch", "conflicts with module"),
    ],
)
def test_what_does_not_fit_is_named(changes, key, said):
    with pytest.raises(SceneError) as wrong:
        gearopt.solve(FILE, changes)
    assert wrong.value.key == key and said in str(wrong.value)


def test_shifts_that_cancel_fit_every_objective():
    changes = {"stage[1].wheel.profile_shift": -0.4, "objective.minimise": "total_length"}
    plain = {"stage[1].pinion": None, "stage[1].wheel": None, "objective.minimise": "total_length"}
    assert gearopt.solve(FILE, changes).value == gearopt.solve(FILE, plain).value


def test_a_diametral_pitch_is_a_module():
    changes = {"stage[1].module": None, "stage[1].diametral_pitch": 12}
    module = gearopt.solve(FILE, changes).design["stages"][0]["normal_module_mm"]
    assert module == pytest.approx(25.4 / 12, rel=1e-15)


def test_an_optimum_whose_tips_cut_into_fillets_is_not_called_proven_optimal_alone():
    """With tips of 1.2 modules on pinions of 12 to 14 teeth they do; as rated gears they say so."""
    long = {"addendum": 1.2, "tool_addendum": 1.2, "face_width_over_diameter": 1}
    few = {"k_factor": "1.5 MPa", "unit_load": "20 MPa", "pinion_teeth": [12, 14]}
    result = gearopt.solve(FILE | {"stages": 1, "stage": [], "gears": long, "limits": few})
    cut, page = result.report["misfits"], result.to_html()
    assert result.status == "optimal" and "into the fillets of the pinion" in cut[0]
    assert "teeth interfere; proven optimal" in repr(result)
    assert set(cut).isdisjoint(result.report["notes"])
    assert all(sentence.partition("'")[2] in page for sentence in cut)
