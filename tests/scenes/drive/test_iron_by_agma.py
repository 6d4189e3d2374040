"""Grey and ductile iron by ASTM, rated by AGMA with the lower values of its tables."""

import math

import pytest
from rated_files import pair

import gearopt
from gearopt.errors import SceneError

PSI = 0.45359237 * 9.80665 / 25.4**2 * 1e3  # MPa of 1000 psi
IRONS = [  # s_ac, s_at [ksi], E [10^6 psi]: the lower values as Shigley, ch. 14, prints them
    ("ASTM A48 class 20", 50, 5, 22),
    ("ASTM A48 class 30", 65, 8.5, 22),
    ("ASTM A48 class 40", 75, 13, 22),
    ("ASTM A536 60-40-18", 77, 22, 24),
    ("ASTM A536 80-55-06", 77, 22, 24),
    ("ASTM A536 100-70-03", 92, 27, 24),
    ("ASTM A536 120-90-02", 103, 31, 24),
]


@pytest.mark.parametrize(("iron", "contact", "bending", "modulus"), IRONS)
def test_strength_and_elastic_coefficient_of_iron(iron, contact, bending, modulus):
    """s_ac and s_at in psi; C_p = (pi (1 - 0.09) (1/E_1 + 1/E_2))^(-1/2), E_1 = 206 GPa."""
    tables = pair()
    tables["stage"][0]["wheel"] = {"treatment": iron}
    result = gearopt.rate(tables)
    found = {row["symbol"]: row for row in result.design["rating"]["factors"]}
    assert found["s_ac"]["wheel"] == pytest.approx(contact * PSI, rel=1e-12)
    assert found["s_at"]["wheel"] == pytest.approx(bending * PSI, rel=1e-12)
    both = math.pi * 0.91 * (1 / 206000 + 1 / (modulus * 1000 * PSI))
    assert found["C_p"]["pinion"] == pytest.approx(both**-0.5, rel=1e-12)
    assert found["C_H"]["wheel"] == 1
    for symbol in ("s_ac", "s_at", "Y_N", "Z_N"):
        assert not found[symbol]["verified"]
    assert any("stress cycle factors of steel" in line for line in result.report["assumptions"])


def test_short_lives_follow_the_lowest_curve_of_steel():
    """Y_N = 2.3194 N^-0.0538 of 160 HB, Z_N = 1.249 N^-0.0138 of nitrided steel."""
    tables = pair({"life": "1 h"})
    tables["gears"] = {"treatment": "ASTM A536 80-55-06", "hardness": "200 HB"}
    rating = gearopt.rate(tables).design["rating"]
    found = {row["symbol"]: row for row in rating["factors"]}
    for gear in rating["gears"]:
        cycles = gear["cycles"]
        assert 1e4 < cycles < 1e6
        assert found["Y_N"][gear["member"]] == pytest.approx(2.3194 * cycles**-0.0538, rel=1e-12)
        assert found["Z_N"][gear["member"]] == pytest.approx(1.249 * cycles**-0.0138, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [{"teeth": {}}, {}])
def test_a_sized_drive_of_iron_is_that_of_gears_of_its_strength(teeth):
    """Beyond 1e7 cycles all curves are one, so that steel of these numbers sizes alike."""
    values = []
    own = {"s_ac": "77 ksi", "s_at": "22 ksi", "elastic_modulus": f"{24000 * PSI!r} MPa"}
    for steel in ({"treatment": "ASTM A536 80-55-06"}, {"treatment": "carburised"} | own):
        tables = pair()
        tables["gears"] = steel
        tables["stage"] = [{"face_width_over_diameter": 0.8}]
        tables["duty"] = tables["duty"] | {"ratio": 3}
        tables |= {"limits": {"pinion_teeth": [20, 24]}} | teeth
        result = gearopt.solve(tables)
        assert result.design["rating"]["safe"]
        values.append(result.value)
    assert values[0] == pytest.approx(values[1], rel=1e-9)


def test_iron_is_rated_by_both_standards():
    tables = pair({"standard": "both", "iso6336": {"accuracy_grade": 8}})
    tables["gears"] = {"treatment": "ASTM A48 class 30", "hardness": "180 HB"}
    rating = gearopt.rate(tables).design["rating"]
    assert "GG" in rating["beside"]["gears"][0]["material"]
    assert "grade" not in rating["gears"][0]["material"]
    moduli = [
        {r["symbol"]: r["pinion"] for r in of["factors"]} for of in (rating, rating["beside"])
    ]
    assert moduli[0]["C_p"] == pytest.approx(moduli[1]["Z_E"], rel=1e-12)


def test_an_iron_by_name_is_told_its_class():
    tables = pair()
    tables["gears"] = {"steel": "GGG-50"}
    with pytest.raises(SceneError, match='Write treatment = "ASTM A536 80-55-06"'):
        gearopt.rate(tables)
