"""Finished teeth: what grinding leaves of a protuberance, and chamfered tips."""

import math
from functools import cache

import pytest
from rated_files import pair

import gearopt
from gearopt.errors import SceneError

TOOL = {"tool_addendum": 1.4, "tool_tip_radius": 0.3, "tool_protuberance": 0.05}
ISO = {"standard": "iso6336", "quality": None, "iso6336": {"accuracy_grade": 6}}


def ground(allowance, **tables):
    """A pair rated by ISO 6336 whose flanks are ground."""
    made = pair(ISO)
    made["rating"] = {k: v for k, v in made["rating"].items() if v is not None}
    made["gears"] = made["gears"] | TOOL | {"grinding_allowance": allowance} | tables
    return made


@cache
def rated(allowance):
    return gearopt.rate(ground(allowance)).design["rating"]


def by_hand(z, residual, ratio, chamfer=0):
    """Y_F and Y_S of a spur gear by ISO 6336-3, 6.2 and 7, rack 1/1.4/0.3, alpha 20 degrees.

    E = pi/4 - h_fP tan alpha + s_pr/cos alpha - (1 - sin alpha) rho/cos alpha; G = rho - h_fP;
    H = 2/z (pi/2 - E) - pi/3; theta = 2 G/z tan theta - H. s_Fn = z sin(pi/3 - theta) + sqrt(3)
    (G/cos theta - rho); rho_F = rho + 2 G^2/(cos theta (z cos^2 theta - 2 G)).
    """
    a, dedendum, rho = math.radians(20), 1.4, 0.3
    e = math.pi / 4 - dedendum * math.tan(a) + residual / math.cos(a)
    e -= (1 - math.sin(a)) * rho / math.cos(a)
    g, h, theta = rho - dedendum, 2 / z * (math.pi / 2 - e) - math.pi / 3, math.pi / 6
    for _ in range(200):
        theta = 2 * g / z * math.tan(theta) - h
    thick = z * math.sin(math.pi / 3 - theta) + math.sqrt(3) * (g / math.cos(theta) - rho)
    fillet = rho + 2 * g**2 / (math.cos(theta) * (z * math.cos(theta) ** 2 - 2 * g))
    base = z * math.cos(a)
    reach = math.sqrt(((z + 2) / 2 - chamfer) ** 2 - (base / 2) ** 2) - math.pi * math.cos(a) * (
        ratio - 1
    )
    d_en = 2 * math.sqrt(reach**2 + (base / 2) ** 2)
    angle = math.acos(base / d_en)
    gamma = (math.pi / 2) / z + math.tan(a) - a - math.tan(angle) + angle
    load = angle - gamma
    arm = (math.cos(gamma) - math.sin(gamma) * math.tan(load)) * d_en
    arm = 0.5 * (arm - z * math.cos(math.pi / 3 - theta) - (g / math.cos(theta) - rho))
    slim, notch = thick / arm, thick / 2 / fillet
    form = 6 * arm * math.cos(load) / (thick**2 * math.cos(a))
    return form, (1.2 + 0.13 * slim) * notch ** (1 / (1.21 + 2.3 / slim))


@pytest.mark.parametrize("allowance", [0, 0.02, 0.05])
def test_the_rest_of_the_protuberance_enters_the_tooth_form(allowance):
    """s_pr = 0.05 - q in E, by the formulas of ISO 6336-3 in `by_hand`."""
    rating = rated(allowance)
    ratio = rating["meshes"][0]["transverse_contact_ratio"]
    found = {row["symbol"]: row for row in rating["factors"]}
    whole = rated(0)["teeth"]
    for tooth, other in zip(rating["teeth"], whole, strict=True):
        assert tooth["span_mm"] == other["span_mm"]  # flanks are finished
        form, concentration = by_hand(tooth["teeth"], 0.05 - allowance, ratio)
        assert found["Y_F"][tooth["member"]] == pytest.approx(form, rel=1e-9)
        assert found["Y_S"][tooth["member"]] == pytest.approx(concentration, rel=1e-9)


@pytest.mark.slow
def test_a_sized_drive_takes_the_rest_of_the_protuberance():
    """It is the drive of a tool with that protuberance, and none larger is asked for."""
    tables = ground(0.02)
    tables["stage"] = [{"face_width_over_diameter": 0.8}]
    tables["duty"] = tables["duty"] | {"ratio": 3}
    tables |= {"limits": {"pinion_teeth": [20, 24]}, "teeth": {}}
    plain = {**tables, "gears": {**tables["gears"], "tool_protuberance": 0.03}}
    del plain["gears"]["grinding_allowance"]
    found, same = (gearopt.solve(each) for each in (tables, plain))
    assert found.status == same.status == "optimal" and found.value == same.value
    assert found.design["stages"] == same.design["stages"]


def test_a_chamfer_that_leaves_no_involute_is_refused():
    """d_Na = m (18 + 2 (0.4 - 1)) = 16.8 m, d_b = 18 m cos(20 degrees) = 16.91 m."""
    tables = pair()
    tables["gears"] = tables["gears"] | {"tip_chamfer": 1, "addendum": 0.4}
    tables["stage"] = [{"face_width_over_diameter": 0.8}]
    tables["duty"] = tables["duty"] | {"ratio": 3}
    tables |= {"limits": {"pinion_teeth": [18, 20]}, "teeth": {}}
    with pytest.raises(SceneError, match="tip_chamfer.*leaves 18 teeth no involute"):
        gearopt.solve(tables)


@pytest.mark.parametrize("tables", [{}, {"tool_protuberance": None}])
def test_grinding_below_the_protuberance_is_refused(tables):
    made = ground(0.06, **tables)
    made["gears"] = {k: v for k, v in made["gears"].items() if v is not None}
    with pytest.raises(SceneError, match="grinding_allowance.*is above tool_protuberance"):
        gearopt.rate(made)


CHAMFERED = {"tip_chamfer": 0.1, "tool_protuberance": 0}


def test_a_chamfer_shortens_the_path_of_contact():
    """Of spur gears of 20 degrees: d_Na = m (z + 2 - 0.2), d_b = m z cos(20 degrees), a = m (z1 +
    z2)/2; eps_alpha = (sqrt(d_Na1^2 - d_b1^2) + sqrt(d_Na2^2 - d_b2^2) - 2 a sin(20 degrees))/(2
    pi m cos(20 degrees)); Z_eps = sqrt((4 - eps_alpha)/3); Y_F as `by_hand`.
    """
    rating = gearopt.rate(ground(0, **CHAMFERED)).design["rating"]
    z, angle = [tooth["teeth"] for tooth in rating["teeth"]], math.radians(20)
    reach = sum(math.sqrt((n + 1.8) ** 2 - (n * math.cos(angle)) ** 2) for n in z)
    ratio = (reach - sum(z) * math.sin(angle)) / (2 * math.pi * math.cos(angle))
    assert rating["meshes"][0]["transverse_contact_ratio"] == pytest.approx(ratio, rel=1e-12)
    found = {row["symbol"]: row for row in rating["factors"]}
    assert found["Z_eps"]["pinion"] == pytest.approx(math.sqrt((4 - ratio) / 3), rel=1e-12)
    for tooth in rating["teeth"]:
        form, _ = by_hand(tooth["teeth"], 0, ratio, 0.1)
        assert found["Y_F"][tooth["member"]] == pytest.approx(form, rel=1e-9)
        module = tooth["reference_diameter_mm"] / tooth["teeth"]
        for name, height in (("tip_diameter_mm", 2), ("tip_form_diameter_mm", 1.8)):
            assert tooth[name] == pytest.approx(module * (tooth["teeth"] + height), rel=1e-12)


@pytest.mark.parametrize("helix", [{}, {"helix_angle": "15 deg"}])
def test_chamfered_teeth_carry_as_shorter_ones_by_agma(helix):
    """I, J, sliding and losses are those of teeth that end at d_Na; d_a is not."""
    chamfered, shorter = pair(**helix), pair(**helix)
    chamfered["gears"] = chamfered["gears"] | {"tip_chamfer": 0.08}
    shorter["gears"] = shorter["gears"] | {"addendum": 0.92}
    one, other = (gearopt.rate(t).design["rating"] for t in (chamfered, shorter))
    assert one["factors"] == other["factors"] and one["gears"] == other["gears"]
    assert one["meshes"] == other["meshes"]
    for tooth, short in zip(one["teeth"], other["teeth"], strict=True):
        assert tooth["tip_diameter_mm"] > short["tip_diameter_mm"]
        for name in ("active_root_diameter_mm", "largest_specific_sliding"):
            assert tooth[name] == pytest.approx(short[name], rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [{"teeth": {}}, {}])
def test_a_sized_drive_of_chamfered_teeth_is_that_of_shorter_ones(teeth):
    values = []
    for key, value in (("tip_chamfer", 0.08), ("addendum", 0.92)):
        tables = pair()
        tables["gears"] = tables["gears"] | {key: value}
        tables["stage"] = [{"face_width_over_diameter": 0.8}]
        tables["duty"] = tables["duty"] | {"ratio": 3}
        tables |= {"limits": {"pinion_teeth": [20, 24]}} | teeth
        result = gearopt.solve(tables)
        assert result.feasible and result.design["rating"]["safe"]
        values.append(result.value)
    assert values[0] == pytest.approx(values[1], rel=1e-9)
