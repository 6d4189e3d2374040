"""Planetary stages of files by AGMA, alone and beside ISO 6336."""

import math
from pathlib import Path

import pytest
from campaigns import few

import gearopt
from gearopt.errors import SceneError

PROBLEMS = Path(__file__).parents[3] / "problems"
WIND, STAGE = PROBLEMS / "wind_planetary_stage.toml", PROBLEMS / "planetary_stage.toml"
BY_AGMA = {
    "rating.standard": "agma",
    "rating.quality": 9,
    "rating.iso6336": None,
    "gears.iso_material": None,
    "gears.treatment": "carburised",
    "gears.grade": 2,
    "stage[1].ring.iso_material": None,
    "stage[1].ring.hardness": None,
}
SIZED = {"rating.standard": "agma", "rating.quality": 10, "rating.iso6336": None}


def external(sun, planet, duty, contacts):
    """Rating of a pair of sun and planet alone, the one with fewer teeth first, by AGMA."""
    turned = sun["teeth"] > planet["teeth"]
    first, second = (planet, sun) if turned else (sun, planet)
    gears = [
        {k: v for k, v in gear.items() if k != "teeth"}
        | ({"reversed_load": True} if gear is planet else {"contacts": contacts})
        for gear in (first, second)
    ]
    torque, speed = duty
    u = second["teeth"] / first["teeth"]
    torque, speed = (torque / u, speed * u) if turned else (torque, speed)
    return gearopt.rate(
        {
            "gearopt": 1,
            "kind": "drive",
            "duty": {"torque": f"{torque!r} N m", "input_speed": f"{speed!r} rpm"},
            "gears": {"treatment": "carburised", "grade": 2},
            "stage": [
                {
                    "module": "21 mm",
                    "pinion_teeth": first["teeth"],
                    "wheel_teeth": second["teeth"],
                    "face_width": "550 mm",
                    "centre_distance": "584 mm",
                    "pinion": gears[0],
                    "wheel": gears[1],
                }
            ],
            "rating": {
                "standard": "agma",
                "quality": 9,
                "life": "175000 h",
                "overload_factor": 1.25 * 1.1,
                "minimum_bending_safety": 1.56,
                "minimum_contact_safety": 1.25,
            },
        }
    ).design["rating"]["gears"]


@pytest.mark.parametrize(("z_s", "z_p"), [(18, 36), (36, 18)])
def test_sun_and_planet_are_an_external_pair_with_a_third_of_the_load(z_s, z_p):
    """T/3, K_o K_gamma, the speed against the carrier, three contacts of the sun, 0.7 s_at."""
    z_r, shifts = 93 - 18 * (z_s > z_p), (0.389, 0.5038) if z_s < z_p else (0.5038, 0.389)
    changes = BY_AGMA | {"stage[1].sun_teeth": z_s, "stage[1].planet_teeth": z_p}
    changes |= {"stage[1].ring_teeth": z_r, "stage[1].equally_spaced": False}
    changes |= {
        f"stage[1].{g}.profile_shift": x for g, x in zip(("sun", "planet"), shifts, strict=True)
    }
    changes |= {"stage[1].sun.bore": None, "stage[1].planet.bore": None}
    changes |= {"stage[1].planet.hub_over_bore": None}
    rating = gearopt.rate(WIND, changes).design["rating"]
    relative = 294.5 * z_r / (z_s + z_r)
    members = [
        {"teeth": z, "profile_shift": x, "tip_alteration": -0.0835}
        for z, x in zip((z_s, z_p), shifts, strict=True)
    ]
    alone = external(*members, (162105.5 / 3.0, relative), 3)
    alone = alone[::-1] if z_s > z_p else alone
    for own, other in zip(rating["gears"][:2], alone, strict=True):
        for name in ("bending_stress_MPa", "contact_stress_MPa", "bending_safety", "cycles"):
            assert own[name] == pytest.approx(other[name], rel=1e-9)
        assert own["contact_safety"] == pytest.approx(other["contact_safety"], rel=1e-9)
    assert rating["named"][0]["pinion"] == "sun"
    sharing = [row for row in rating["factors"] if row["symbol"] == "K_gamma"]
    assert [row["pinion"] for row in sharing] == [1.1, 1.1]


def test_the_ring_is_marked_and_bends_by_the_formula():
    """sigma_F = W_t K_o K_gamma K_v K_m/(b m_t J) of the printed row; I, J and K_B are marked."""
    rating = gearopt.rate(WIND, BY_AGMA).design["rating"]
    rows = {row["symbol"]: row for row in rating["factors"] if row["stage"] == 2}
    assert {s for s, row in rows.items() if not row["verified"]} == {"I", "J", "K_B"}
    product = math.prod(rows[s]["pinion"] for s in ("K_o", "K_gamma", "K_v", "K_m"))
    ring = next(g for g in rating["gears"] if g["stage"] == 2 and g["member"] == "wheel")
    force = rating["meshes"][1]["tangential_force_N"]
    stress = force * product * rows["K_B"]["wheel"] / (550.0 * 21.0 * rows["J"]["wheel"])
    assert ring["bending_stress_MPa"] == pytest.approx(stress, rel=1e-9)


@pytest.mark.parametrize("both", few([False, True], 0))
def test_sized_stages_are_safe_by_what_they_were_sized_by(both):
    changes = SIZED if not both else {"rating.standard": "both", "rating.quality": 10}
    found = gearopt.solve(STAGE, changes)
    assert found.status == "optimal"
    rating = found.design["rating"]
    assert rating["safe"] and "AGMA" in rating["standard"]
    assert bool(rating.get("beside")) == both
    reached = {name: used for name, used in found.limits.items() if "_of_ring" in name}
    assert max(reached.values()) <= 1.0 + 1e-9


@pytest.mark.parametrize("symbol", ["I", "J"])
@pytest.mark.parametrize("place", ["rating.given", "stage[1].given"])
def test_factors_of_one_mesh_are_not_given_to_two(symbol, place):
    with pytest.raises(SceneError, match=f"given.{symbol}.*is of one mesh"):
        gearopt.rate(WIND, BY_AGMA | {f"{place}.{symbol}": 0.2})


@pytest.mark.slow
def test_limits_of_a_larger_sun_are_those_of_its_rating():
    """18 teeth of the planet, 40 of the sun: used is what S_F and S_H say, gear by gear."""
    changes = SIZED | {"stage[1].sun_teeth": 40, "duty.output_speed": None, "duty.ratio": 3.0}
    changes |= {"stage[1].ring_teeth": [74, 86], "stage[1].planets": 3, "duty.ratio_tolerance": 0.1}
    changes |= {"rating.standard": "both", "rating.iso6336": {"accuracy_grade": 6}}
    found = gearopt.solve(STAGE, changes)
    rating = found.design["rating"]
    assert rating["named"] == rating["beside"]["named"]
    for gear, member in zip(rating["gears"][:2], ("pinion", "wheel"), strict=True):
        asked = rating["minimum_bending_safety"] / gear["bending_safety"]
        assert gear["member"] == member
        assert found.limits[f"{member}_bending_of_sun[1]"] == pytest.approx(asked, rel=1e-9)
