"""Files with rims, webs, bores and hubs: what they say, what is refused, what is rated."""

import copy
import math

import pytest
from campaigns import few
from rated_files import pair

import gearopt
from gearopt.errors import SceneError

NAME = "light_wheels"
STEEL = {"treatment": "through-hardened", "hardness": "300 HB"}
RATED = {"life": "20000 h", "quality": 8}
WEBBED = {"rim_over_module": 3, "web_over_face_width": 0.3}
DRIVE = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "7.5 kW", "input_speed": "1450 rpm", "ratio": 4},
    "gears": {"face_width_over_diameter": [0.3, 0.9]},
    "stage": [{}],
    "limits": {"pinion_teeth": [20, 24], "preset": "chong-lee-elevator"},
    "teeth": {},
    "objective": {"minimise": "mass", "density": "7.85 kg/dm^3"},
}


def drive(gears=None, pinion=None, wheel=None, **tables):
    """A small drive with keys of its gears."""
    made = copy.deepcopy(DRIVE) | tables
    made["gears"] |= gears or {}
    made["stage"][0] |= {"pinion": pinion or {}, "wheel": wheel or {}}
    return made


def ring(outer, inner):
    return math.pi / 4.0 * (outer**2 - inner**2)


@pytest.mark.slow
def test_masses_of_a_design_by_its_dimensions(solved):
    """Ring by ring of what the result lists; the pinions have no room for a web."""
    result = solved(NAME)
    for stage in result.design["stages"]:
        d, b = stage["wheel_diameter_mm"], stage["face_width_mm"]
        inside = stage["wheel_root_diameter_mm"] - 2.0 * stage["wheel_rim_thickness_mm"]
        hub, bore = stage["wheel_hub_diameter_mm"], stage["wheel_bore_mm"]
        area = b * (ring(d, inside) + ring(hub, bore))
        area += stage["wheel_web_thickness_mm"] * ring(inside, hub)
        assert stage["wheel_mass_kg"] == pytest.approx(7.85e-6 * area, rel=1e-12)
        assert stage["wheel_rim_thickness_mm"] == pytest.approx(3.0 * stage["normal_module_mm"])
        assert stage["wheel_web_thickness_mm"] == pytest.approx(0.3 * b)
        disc = b * ring(stage["pinion_diameter_mm"], stage["pinion_bore_mm"])
        assert stage["pinion_mass_kg"] == pytest.approx(7.85e-6 * disc, rel=1e-12)
        assert "pinion_rim_thickness_mm" not in stage
    assert result.value == pytest.approx(sum(s["mass_kg"] for s in result.design["stages"]))
    told = [note for note in result.report["notes"] if "no web" in note]
    assert [note[:24] for note in told] == [f"The pinion of stage {k} ha" for k in (1, 2)]
    assert any("rims, webs and hubs" in words for words in result.report["assumptions"])


@pytest.mark.slow
def test_webs_save_more_than_half(solved):
    """The number of the docs: 29.1 kg with solid gears."""
    keys = [f"stage[{k}].{m}.bore" for k in (1, 2) for m in ("pinion", "wheel")]
    changes = {"gears.web_over_face_width": 1} | dict.fromkeys(keys, "0 mm")
    solid = gearopt.solve(f"problems/{NAME}.toml", changes=changes)
    assert solid.value == pytest.approx(29.135, abs=1e-3)
    assert solved(NAME).value < 0.44 * solid.value


THIN = {"rim_over_module": 2, "web_over_face_width": 0.25}


@pytest.mark.parametrize("standard", few(["agma", "iso6336"], 1))
def test_the_rating_of_the_design_has_the_same_rims(standard):
    """A sized design, rated as given gears with its dimensions in mm: factors and safeties."""
    rating = {"life": "20000 h", "standard": standard}
    rating |= {"quality": 8} if standard == "agma" else {"iso6336": {"accuracy_grade": 6}}
    tables = drive(STEEL, {}, THIN | {"bore": "40 mm"}, rating=rating)
    del tables["limits"]["preset"]
    sized = gearopt.solve(tables)
    (stage,) = sized.design["stages"]
    rim, web = stage["wheel_rim_thickness_mm"], stage["wheel_web_thickness_mm"]
    assert rim == pytest.approx(2.0 * stage["normal_module_mm"])
    given = {key: stage[key] for key in ("pinion_teeth", "wheel_teeth")}
    given |= {"module": f"{stage['normal_module_mm']} mm"}
    given |= {"face_width": f"{stage['face_width_mm']!r} mm"}
    body = {"rim_thickness": f"{rim} mm", "web_thickness": f"{web!r} mm", "bore": "40 mm"}
    asked = {"power": "7.5 kW", "input_speed": "1450 rpm"}
    rated = gearopt.rate(
        {"gearopt": 1, "kind": "drive", "duty": asked, "gears": STEEL, "rating": rating}
        | {"stage": [given | {"wheel": body}]}
    )
    first, second = (r.design["rating"]["factors"] for r in (sized, rated))
    for one, other in zip(first, second, strict=True):
        for member in ("pinion", "wheel"):
            assert (one[member] or 0.0) == pytest.approx(other[member] or 0.0, rel=1e-9)
    symbol = "K_B" if standard == "agma" else "Y_B"
    factor = next(f for f in first if f["symbol"] == symbol)
    assert factor["pinion"] == 1.0
    assert factor["wheel"] == pytest.approx(1.6 * math.log(2.242 * 2.25 / 2.0), rel=1e-9)
    assert rated.design["mass_kg"] == pytest.approx(sized.value, rel=1e-9)


def test_without_ratings_masses_count_webs():
    light, solid = gearopt.solve(drive(WEBBED)), gearopt.solve(drive())
    assert light.status == solid.status == "optimal"
    assert light.value < 0.6 * solid.value
    full = {"rim_over_module": 3, "web_over_face_width": 1}
    assert gearopt.solve(drive(full)).value == solid.value
    other = gearopt.solve(drive(WEBBED, objective={"minimise": "gear_volume"}))
    assert other.value == pytest.approx(solid.value / 7.85e-6, rel=1e-12)
    own = gearopt.solve(drive(WEBBED, {"web_over_face_width": 1}))
    assert "pinion_web_thickness_mm" not in own.design["stages"][0]


def test_a_key_of_a_gear_comes_before_that_of_all_in_other_words():
    fixed = drive(WEBBED, {"rim_thickness": "5 mm"}, stage=[{"face_width": "30 mm"}])
    fixed["stage"][0]["wheel"] = {"web_thickness": "6 mm"}
    both = gearopt.load(fixed).train().stages[0].blanks
    assert (both[0].rim_over_module, both[0].rim_thickness) == (None, 5.0)
    assert (both[1].rim_over_module, both[1].web_over_width) == (3.0, 0.2)


WRONG = {  # keys of [gears], of the wheel; where, what is told
    "web without a rim": (
        {"web_over_face_width": 0.3},
        {},
        "gears.rim_over_module: is missing",
    ),
    "web in mm without a rim": ({}, {"web_thickness": "6 mm"}, "wheel.rim_thickness: is missing"),
    "hub without a bore": ({}, {"hub_over_bore": 1.5}, "needs bore"),
    "hub as its bore": ({"bore": "9 mm", "hub_over_bore": 1}, {}, "hardly a wall"),
    "rim twice": (
        {"rim_thickness": "9 mm", "rim_over_module": 3},
        {},
        "conflicts with rim_thickness",
    ),
    "web twice": ({}, {"web_thickness": "9 mm"} | WEBBED, "conflicts with web_thickness"),
    "web in mm of an open width": (
        {"rim_thickness": "9 mm", "web_thickness": "6 mm"},
        {},
        "Write web_over_face_width",
    ),
    "web of nothing": ({"web_over_face_width": 0}, {}, "not greater than 0 and at most 2"),
}


@pytest.mark.parametrize("mistake", WRONG)
def test_what_does_not_belong_together_is_refused(mistake):
    gears, wheel, told = WRONG[mistake]
    with pytest.raises(SceneError) as caught:
        gearopt.load(drive(gears, {}, wheel))
    assert told in str(caught.value)


@pytest.mark.slow
def test_explain_says_what_thinner_webs_bring():
    found = gearopt.explain(drive(WEBBED))
    effects = {i.key: i.resolved if hasattr(i, "resolved") else None for i in found.influences}
    assert {"gears.rim_over_module", "gears.web_over_face_width"} <= set(effects)


@pytest.mark.slow
def test_an_impossible_drive_is_so_with_webs():
    """Its remedies are those of solid gears: no limit knows webs."""
    tables = drive(WEBBED)
    tables["limits"] |= {"wheel_diameter": "100 mm"}
    found = gearopt.solve(tables)
    solid = copy.deepcopy(tables)
    solid["gears"] = {"face_width_over_diameter": [0.3, 0.9]}
    other = gearopt.solve(solid)
    assert found.status == other.status == "infeasible"
    ways, others = (r.report["ways_out"] for r in (found, other))
    assert ways["conflict"] == others["conflict"] and ways["remedies"] == others["remedies"]


def test_a_rating_tells_what_does_not_fit():
    """Hubs of 1.6 times 30 mm inside a root circle of 55 mm: a bore, but no web; of 40 mm: none."""
    stage = {"module": "3 mm", "pinion_teeth": 20, "wheel_teeth": 80, "face_width": "30 mm"}
    duty = {"power": "2 kW", "input_speed": "1450 rpm"}
    for bore, told in (("30 mm", "has no web"), ("40 mm", "is solid, without its bore")):
        body = STEEL | WEBBED | {"bore": bore}
        tables = {"gearopt": 1, "kind": "drive", "duty": duty, "gears": body, "rating": RATED}
        found = gearopt.rate(tables | {"stage": [stage]})
        (flaw,) = found.design["rating"]["flaws"]
        assert flaw.startswith(f"The pinion of stage 1 {told}")
        (made,) = found.design["stages"]
        assert made.get("pinion_bore_mm") == (30.0 if bore == "30 mm" else None)
        assert made["wheel_hub_diameter_mm"] == pytest.approx(1.6 * float(bore[:2]))


@pytest.mark.parametrize(("bore", "used"), [(30.0, False), (40.0, True), (45.0, True)])
def test_a_bore_of_a_given_gear_is_rated_though_its_usual_hub_has_no_room(bore, used):
    """Wall (52.5 - bore)/2 below z 20, m 3: Y_B = K_B = 1.6 ln(2.242 h_t/s_R), h_t = 6.75 mm."""
    wall, depth, width = 0.5 * (52.5 - bore), 6.75, 30.0
    asked = {"standard": "both", "iso6336": {"accuracy_grade": 7}}
    found = gearopt.rate(pair(asked, pinion={"bore": f"{bore:g} mm"})).design
    rows = [*found["rating"]["factors"], *found["rating"]["beside"]["factors"]]
    rims = [row["pinion"] for row in rows if row["symbol"] in ("K_B", "Y_B")]
    factor = max(1.0, 1.6 * math.log(2.242 * depth / wall)) if wall < 1.2 * depth else 1.0
    assert rims == pytest.approx([factor] * 2, rel=1e-12) and (factor > 1.0) is used
    said = " ".join(found["rating"]["flaws"])
    assert ("usual hub of the pinion of stage 1" in said) is used
    (stage,) = found["stages"]
    assert stage["pinion_bore_mm"] == bore
    mass = 7.85e-6 * math.pi / 4.0 * width * (60.0**2 - bore**2)
    assert stage["pinion_mass_kg"] == pytest.approx(mass, rel=1e-12)


@pytest.mark.parametrize(("bore", "fits"), [("45.7 mm", True), ("45.8 mm", False)])
def test_a_wall_of_half_the_whole_depth_is_too_thin(bore, fits):
    """52.5 - 6.75 mm = 45.75 mm; a hub that is given says that it is a pinion shaft."""
    found = gearopt.rate(pair(pinion={"bore": bore}))
    rating = found.design["rating"]
    assert found.feasible is fits
    assert ("stay below 45.75 mm" in " ".join(rating.get("misfits", ()))) is not fits
    shaft = gearopt.rate(pair(pinion={"bore": bore, "hub_over_bore": 1.6})).design["rating"]
    assert "solid, without its bore" in " ".join(shaft["flaws"])
