"""A peak torque against static strength by ISO 6336, of given gears and as a limit of sizes."""

import math

import pytest

import gearopt
from gearopt.errors import SceneError

GIVEN = {"K_v": 1.1, "K_Hbeta": 1.25, "K_Fbeta": 1.2, "K_Halpha": 1, "K_Falpha": 1}
GIVEN |= {"Z_H": 2.5, "Z_E": "190 sqrt(MPa)", "Z_eps": 0.9, "Z_beta": 1, "Z_BD": 1}
GIVEN |= {"Y_F": 1.4, "Y_S": 2, "Y_beta": 1, "Y_DT": 1, "sigma_Flim": "430 MPa"}
ENDURANCE = {"Z_NT": 0.85, "Z_L": 0.9, "Z_v": 0.9, "Z_R": 0.9, "Z_W": 1.1}
ENDURANCE |= {"Y_NT": 0.85, "Y_deltarelT": 0.9, "Y_RrelT": 0.9, "Y_X": 0.9}
S_F, S_H = 2150 / 346.5, 2400 / (1068.75 * math.sqrt(1.375))  # by hand, see below


def pair(more=(), of_iso=(), given=(), width="40 mm", **tables):
    """A spur pair of module 4 mm with 20 and 60 teeth of case-hardened steel, 200 N m."""
    stage = {"module": "4 mm", "pinion_teeth": 20, "wheel_teeth": 60, "face_width": width}
    rating = {"standard": "iso6336", "life": "20000 h", "overload_factor": 1.5}
    rating |= {"static_torque_factor": 3} | dict(more)
    rating = {k: v for k, v in rating.items() if v is not None}
    rating["iso6336"] = {"accuracy_grade": 6, "given": GIVEN | dict(given)} | dict(of_iso)
    gears = {"treatment": "carburised", "iso_material": "Eh", "iso_quality": "MQ"}
    duty = {"torque": "200 N m", "input_speed": "1000 rpm"}
    made = {"gearopt": 1, "kind": "drive", "duty": duty, "gears": gears, "stage": [stage]}
    return made | {"rating": rating} | tables


def test_static_safety_factors_are_those_by_hand():
    """S_F and S_H of a peak of 3 times 200 N m; K_A and factors of endurance do not enter.

    F_t = 2 600 N m/80 mm = 15000 N; sigma_F = 15000/(40 4) 1.4 2 1.1 1.2 = 346.5 MPa. Eh, static:
    Y_NT = 2.5, Y_deltarelT = 0.44 Y_S + 0.12 = 1: sigma_FG = 430 2 2.5 = 2150 MPa. sigma_H0 =
    2.5 190 0.9 sqrt(15000 4/(80 40 3)) = 1068.75 MPa, sigma_H = that sqrt(1.1 1.25); Z_NT = 1.6:
    sigma_HG = 1500 1.6 = 2400 MPa.
    """
    for given in ({}, ENDURANCE):
        rating = gearopt.rate(pair(given=given)).design["rating"]
        for row in rating["static"]:
            assert row["torque_Nm"] == pytest.approx(600, rel=1e-12)
            assert row["static_bending_stress_MPa"] == pytest.approx(346.5, rel=1e-12)
            assert row["static_bending_safety"] == pytest.approx(S_F, rel=1e-12)
            assert row["static_contact_limit_MPa"] == pytest.approx(2400, rel=1e-12)
            assert row["static_contact_safety"] == pytest.approx(S_H, rel=1e-12)
    without = gearopt.rate(pair({"static_torque_factor": None}, given=ENDURANCE))
    assert without.design["rating"]["gears"] == rating["gears"]


def test_a_static_safety_factor_that_is_missed_is_told():
    """Utilisations are asked over reached; the load may be as small as the square of that."""
    result = gearopt.rate(pair({"minimum_static_contact_safety": 2.5}))
    assert result.limits["pinion_contact_static[1]"] == pytest.approx(2.5 / S_H, rel=1e-12)
    rating = result.design["rating"]
    assert not rating["safe"] and rating["governs"] == "static contact of the pinion, stage 1"
    power = 0.2 * 1000 * math.pi / 30
    assert rating["power_capacity_kW"] == pytest.approx(power * (S_H / 2.5) ** 2, rel=1e-9)
    assert "static contact of the pinion most: static S_H 1.915, 2.5 required" in repr(result)
    assert "Static strength" in result.to_html()


@pytest.mark.slow
@pytest.mark.parametrize("sizes", [{"teeth": {"modules": ["4 mm"]}}, {}])
def test_sizes_are_limited_by_static_strength(sizes):
    """Stresses fall with the root of b: S_H = 2.1 asks for 40 mm (2.1/1.915)^2 at u = 3.

    Of real-valued sizes the ratio is the least of the tolerance, 2.97; b follows 1 + 1/u.
    """
    u = 3 if sizes else 2.97
    width = 40 * (2.1 / S_H) ** 2 * (1 + 1 / u) / (1 + 1 / 3)
    tables = pair({"minimum_static_contact_safety": 2.1}, **sizes)
    tables["duty"] = tables["duty"] | {"ratio": 3}
    tables["limits"] = {"module": ["4 mm", "4 mm"], "pinion_teeth": [20, 20]}
    tables["stage"] = [{"face_width_over_diameter": [0.3, 1]}]
    result = gearopt.solve(tables)
    assert result.status in ("optimal",) if sizes else ("optimal", "stationary")
    assert result.design["stages"][0]["face_width_mm"] == pytest.approx(width, rel=1e-7)
    assert result.limits["pinion_contact_static[1]"] == pytest.approx(1.0, rel=1e-7)


@pytest.mark.parametrize(
    "more, words",
    [
        ({"standard": "agma", "quality": 8, "iso6336": None}, "rated by ISO 6336 alone"),
        (
            {"static_torque_factor": None, "minimum_static_contact_safety": 2},
            "static_torque_factor: is missing",
        ),
        ({"static_torque_factor": 0.5}, "static_torque_factor"),
    ],
)
def test_a_peak_torque_that_cannot_be_rated_is_refused(more, words):
    tables = pair()
    tables["rating"] = {k: v for k, v in (tables["rating"] | more).items() if v is not None}
    with pytest.raises(SceneError, match=words):
        gearopt.rate(tables)
