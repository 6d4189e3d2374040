"""Stages with planets and rings in files: sized, rated, refused."""

import math
import tomllib
from pathlib import Path

import pytest
from campaigns import few

import gearopt
from gearopt import Budget
from gearopt.errors import SceneError
from gearopt.report.kinds.drive.rating_words import _in_stages
from gearopt.scenes.drive.notes import assumptions
from gearopt.scenes.drive.planetary import at_once
from gearopt.scenes.drive.tables.drive import StageTable

PROBLEMS = Path(__file__).parents[3] / "problems"
STAGE = PROBLEMS / "planetary_stage.toml"
WIND = PROBLEMS / "wind_planetary_stage.toml"


def factors(rating, mesh):
    """Factors of a mesh (from 1) by symbol: of both gears, or of the mesh."""
    rows = [row for row in rating["factors"] if row["stage"] == mesh]
    return {r["symbol"]: (r["pinion"], r["wheel"]) if r["wheel"] else r["pinion"] for r in rows}


def test_a_published_stage_is_met_factor_by_factor(solved):
    """KISSsoft 03/2017, NREL 5 MW, stage 2: printed to the digits here; C_R 0.862 is the report's.

    Masses are of blanks of (d_a + d_f)/2 with the bores and the outside of the report.
    """
    design = solved("wind_planetary_stage").design
    (stage,), rating = design["stages"], design["rating"]
    masses = [stage[f"{gear}_mass_kg"] for gear in ("pinion", "wheel", "ring")]
    assert masses == pytest.approx([379.7, 880.3, 2712.3], rel=1e-3)
    sun, ring = (factors(rating, mesh) for mesh in (1, 2))
    assert sun["Y_F"] == pytest.approx((1.47, 1.38), abs=6e-3)
    assert sun["Y_S"] == pytest.approx((2.04, 2.18), abs=6e-3)
    assert ring["Y_F"] == pytest.approx((1.01, 1.20), abs=6e-3)
    assert ring["Y_S"] == pytest.approx((2.48, 2.34), abs=6e-3)
    assert 0.862 * sun["c_prime"] == pytest.approx(12240.0, rel=2e-3)
    assert 0.862 * ring["c_prime"] == pytest.approx(14053.0, rel=2e-3)
    assert (sun["Z_H"], ring["Z_H"]) == pytest.approx((2.25, 2.85), abs=6e-3)
    assert (sun["Z_eps"], ring["Z_eps"]) == pytest.approx((0.936, 0.891), abs=6e-4)
    first, second = rating["meshes"]
    assert first["working_pressure_angle_deg"] == pytest.approx(24.169, abs=2e-3)
    assert second["working_pressure_angle_deg"] == pytest.approx(15.63, abs=6e-3)
    ratios = [mesh["transverse_contact_ratio"] for mesh in (first, second)]
    assert ratios == pytest.approx([1.370, 1.618], abs=2e-3)
    assert first["pitch_line_velocity_m_per_s"] == pytest.approx(5.03, abs=5e-3)  # at d_w1


def test_its_stresses_with_the_load_factors_of_the_report():
    given = {"K_v": 1.06, "K_Hbeta": [2.06, 1.15], "K_Fbeta": [1.94, 1.14]}
    changes = {f"stage[1].given_iso6336.{name}": value for name, value in given.items()}
    gears = gearopt.rate(WIND, changes).design["rating"]["gears"]
    contact = [g["contact_stress_MPa"] for g in gears]
    assert contact == pytest.approx([1071.17, 994.13, 404.76, 404.76], rel=4e-3)
    bending = [g["bending_stress_MPa"] for g in gears[:2]]
    assert bending == pytest.approx([209.38, 210.14], rel=6e-3)


@pytest.mark.parametrize(
    ("file", "change", "words"),
    [
        (WIND, {"rating.iso6336.given": {"K_v": [1.1, 1.2]}}, r"given\.K_v = .*two meshes"),
        (WIND, {"stage[1].given_iso6336": {"K_gamma": 1.2}}, "Write mesh_load_factor"),
        (WIND, {"stage[1].given_iso6336": {"K_v": [1.1, 1.1, 1]}}, "sun and planet, planet and"),
        (STAGE, {"rating.iso6336.given": {"K_gamma": 1.2}}, r"mesh_load_factor: is missing"),
        (
            PROBLEMS / "iso_tr_6336_30.toml",
            {"stage[1].given_iso6336": {"K_v": [1.1, 1.2]}},
            r"K_v = .*planetary.*Remove it",
        ),
    ],
)
def test_factors_of_two_meshes_are_those_of_a_planetary_stage(file, change, words):
    with pytest.raises(SceneError, match=words):
        gearopt.load(file, change)


def given(stage, asked):
    """The tables of a stage that was found, all given."""
    own = {"type": stage["type"], "module": f"{stage['normal_module_mm']} mm"}
    own |= {"face_width": f"{stage['face_width_mm']!r} mm", "fixed": stage.get("fixed", "ring")}
    own |= {name: stage[name] for name in ("sun_teeth", "planet_teeth", "ring_teeth", "planets")}
    return {k: v for k, v in asked.items() if k not in ("limits", "teeth")} | {"stage": [own]}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("held", "ratio", "turns"),
    [("ring", 5.2, "clockwise"), ("carrier", 4.2, "anticlockwise"), ("sun", 1.3, "clockwise")],
)
def test_what_is_found_is_rated_alike_when_it_is_given(held, ratio, turns):
    asked = tomllib.loads(STAGE.read_text())
    del asked["duty"]["output_speed"], asked["x-expected"]
    asked["duty"]["ratio"] = ratio
    asked["gears"]["face_width_over_diameter"] = [0.1, 0.5]
    asked["stage"] = [{"type": "planetary", "fixed": held, "planets": 3}]
    if held == "sun":
        own = {"sun_teeth": [20, 40], "ring_teeth": [70, 110]}
        asked["stage"][0] |= own | {"face_width_over_diameter": [0.1, 0.5]}
    found = gearopt.solve(asked)
    (stage,), rating = found.design["stages"], found.design["rating"]
    assert found.status == "optimal" and rating["safe"]
    z_s, z_r = stage["sun_teeth"], stage["ring_teeth"]
    ratios = {"ring": 1 + z_r / z_s, "carrier": z_r / z_s, "sun": 1 + z_s / z_r}
    assert found.design["ratio"] == pytest.approx(ratios[held])
    assert (z_s + z_r) % 3 == 0
    shafts = rating["shafts"]
    assert shafts[-1]["rotation"] == turns
    powers = [row["torque_Nm"] * row["speed_rpm"] for row in shafts]
    assert powers == pytest.approx([15000 * 30 / math.pi] * 2)
    alone = gearopt.rate(given(stage, asked)).design["rating"]
    for one, other in zip(rating["gears"], alone["gears"], strict=True):
        for mode in ("bending", "contact"):
            assert one[f"{mode}_safety"] == pytest.approx(other[f"{mode}_safety"], rel=1e-9)
    best = min(g["contact_safety"] / 1.1 for g in rating["gears"])
    assert min(best, *(g["bending_safety"] / 1.4 for g in rating["gears"])) < 1.02


@pytest.mark.slow
def test_kinds_of_stages_stand_in_one_drive():
    asked = tomllib.loads(STAGE.read_text())
    del asked["duty"]["output_speed"], asked["x-expected"]
    asked["duty"]["ratio"] = 40
    asked["stage"] = [{}, {"type": "planetary"}, {"type": "internal"}]
    found = gearopt.solve(asked)
    stages = found.design["stages"]
    assert [s.get("type", "parallel") for s in stages] == ["parallel", "planetary", "internal"]
    u = [s["ratio"] for s in stages]
    assert u[1] == pytest.approx(1 + stages[1]["ring_teeth"] / stages[1]["sun_teeth"])
    assert u[2] == pytest.approx(stages[2]["wheel_teeth"] / stages[2]["pinion_teeth"])
    assert found.design["ratio"] == pytest.approx(math.prod(u))
    assert sum(s["gear_volume_mm3"] for s in stages) == pytest.approx(found.value)
    assert "planet at the ring" in found.to_html()


WRONG = {
    "pinion_teeth": ({"pinion_teeth": 20}, "stage[1].pinion_teeth", "Write sun_teeth"),
    "no planets": ({"planets": 0}, "stage[1].planets", "Write planets = 3"),
    "small ring": (
        {"sun_teeth": 60, "ring_teeth": 40},
        "stage[1].ring_teeth",
        "is below sun_teeth, whose gear runs within the ring. Exchange stage[1].ring_teeth and "
        "stage[1].sun_teeth",
    ),
    "no type": ({"type": "parallel"}, "stage[1].planets", 'type = "planetary"'),
    "nine planets": (
        {"planets": 9},
        "stage[1].planets = 9",
        "about 4 do by",
    ),  # 180/asin(3.25/5.25)
    "up to eight": ({"planets": [3, 8]}, "stage[1].planets = [3, 8]", "Write planets = [3, 4]"),
    "reduction": ({"planet_teeth_reduction": [0.3]}, "stage[1].planet_teeth_reduction", "0.5"),
    "idler": ({"centre_distance": "80 mm"}, "stage[1].centre_distance", "follows from"),
    "ring": ({"ring": {"profile_shift": 0.1}}, "stage[1].ring.profile_shift", "follows from"),
    "cutter": ({"ring": {"cutter_addendum": 1.2}}, "stage[1].ring.cutter_addendum", "cutter_teeth"),
    "sun held": ({"fixed": "sun"}, "stage[1].ring_teeth", "is missing"),
    "shaft": ({"axial_force": "2 kN"}, "stage[1].axial_force", "planetary"),
    "material": ({"ring": {"hardness": "300 HB", "iso_material": "V"}}, "stage[1].ring", "V alloy"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_means_nothing_there_is_refused_by_its_key(name):
    own, place, words = WRONG[name]
    asked = tomllib.loads(STAGE.read_text())
    asked["stage"][0] |= own
    with pytest.raises(SceneError) as refused:
        gearopt.solve(asked)
    assert place in str(refused.value) and words in str(refused.value)


def test_materials_of_a_ring_are_asked_for_by_its_name():
    asked = tomllib.loads(STAGE.read_text())
    steel = {"treatment": asked["gears"].pop("treatment")}
    asked["stage"][0] |= {"sun": steel, "planet": steel, "ring": {"elastic_modulus": "206 GPa"}}
    with pytest.raises(SceneError, match=r"stage\[1\]\.ring\.iso_material"):
        gearopt.solve(asked)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"rating": None}, r'rating: is missing: .*\[rating\] with standard = "iso6336"'),
        (
            {"objective.minimise": "total_length"},
            r"objective\.minimise = .*gear_volume, mass and mesh_loss\. Write",
        ),
        ({"teeth.coprime": True}, r"teeth\.coprime = true: .*mesh_order.*Remove it"),
        ({"teeth": None}, r"teeth: is missing: .*whole teeth are chosen\. Write a table \[teeth\]"),
        ({"layout": {"shaft_stress": "40 MPa"}}, r"layout = .*another stage.*Remove it"),
        ({"process_one": {"stage_ratios": [5.25]}}, r"process_one = .*Remove it"),
        ({"stage[1].helix_angle": ["8 deg", "9 deg"]}, r'\.helix_angle = .*Write.*"8 deg"'),
        ({"gears.helix_angle": ["8 deg", "9 deg"]}, r'gears\.helix_angle = .*Write.*"8 deg"'),
        ({"limits.axial_force": "2 kN"}, r'limits\.axial_force = "2 kN": .*Remove it'),
        ({"limits.preset": "chong-lee-elevator"}, r"limits\.preset = .*Remove it"),
        ({"stage[1].centre_distance": "90 mm"}, r"of gears that are all given"),
        ({"limits": None}, r"limits: is missing .*sun_teeth.*pinion_teeth = \[12, 40\]"),
        ({"stage[1].type": "Planetenstufe"}, 'Write type = "planetary"'),
        (
            {"stage[1].type": None},
            r'planets = .*: needs type = "planetary"\. Write type = "planetary",',
        ),
        (
            {"limits.ring_teeth": [60, 90]},
            r"Write ring_teeth, in a \[\[stage\]\], or wheel_teeth in",
        ),
        ({"rating.standard": ["agma", "iso6336"]}, r'standard = "both"$'),
        ({"stage[1].annulus_teeth": 80}, r"annulus_teeth = 80: .*Write ring_teeth"),
        (
            {"stage[1].planet": [3, 5], "stage[1].planets": None},
            r"planet = \[3, 5\]: \[\[stage\]\] has no key planet.* Write planets = \[3, 5\]$",
        ),
        ({"stage[1].sun": 21}, r"Write a table \[stage\.sun\] with bore = \"40 mm\"$"),
        ({"stage[1].planet_teeth_reduction": 0.3}, r"= 0\.3: .*no multiple of 0\.5"),
    ],
)
def test_what_cannot_be_done_beside_planets_is_said_of_its_own_key(change, words):
    with pytest.raises(SceneError, match=words):
        gearopt.solve(STAGE, change)


def test_limits_beside_given_gears_at_a_distance_are_named():
    tables = tomllib.loads(WIND.read_text()) | {"limits": {"pinion_teeth": [12, 40]}}
    tables["duty"] |= {"ratio": 6.17}
    with pytest.raises(SceneError, match=r"limits = .*only rated\. Remove it"):
        gearopt.solve(tables)


@pytest.mark.slow
def test_one_reduction_of_planets_is_read_as_a_list_of_it():
    key = "stage[1].planet_teeth_reduction"
    few = {"stage[1].sun_teeth": [30, 34], "stage[1].planets": 3}
    alone, listed = (gearopt.solve(STAGE, few | {key: value}) for value in (1, [1]))
    assert alone.design["stages"] == listed.design["stages"]
    assert "output torque" in str(alone) and "centre distances" not in str(alone)  # of one axis


def test_planets_that_do_not_fit_a_given_stage_are_named():
    rated = gearopt.rate(WIND, {"stage[1].planets": 4, "stage[1].mesh_load_factor": 1.25})
    assert not rated.design["rating"]["safe"]
    assert any("multiple of its 4 planets" in text for text in rated.design["rating"]["misfits"])
    (stage,) = rated.design["stages"]
    masses = [stage[f"{gear}_mass_kg"] for gear in ("pinion", "wheel", "ring")]
    assert masses == pytest.approx([379.7, 880.3, 2712.3], rel=1e-3)  # of the report
    assert "multiple of its 4 planets" in " ".join(str(rated).split())


def test_an_order_of_meshes_that_given_teeth_do_not_keep_is_named():
    order = {"stage[1].mesh_order": "sequential"}  # z_s 18, 3 planets
    misfits = gearopt.rate(WIND, order).design["rating"]["misfits"]
    assert any(
        "mesh_order: it asks for no multiple of 3 planets as z_s" in said for said in misfits
    )


def test_a_search_that_is_interrupted_without_a_design_asks_for_no_more_time():
    stopped = gearopt.solve(STAGE, watch=lambda event: False)
    assert stopped.status == "limit" and stopped.message == "the search was interrupted"
    assert "budget" not in str(stopped) and "more time" not in str(stopped)


def test_sentences_name_the_gears_of_a_set_and_its_stage():
    changes = {"stage[1].face_width": "1100 mm", "stage[1].planet.profile_shift": 0.6}
    rating = gearopt.rate(WIND, changes | {"stage[1].planet.bore": "760 mm"}).design["rating"]
    said = [*rating["misfits"], *rating["flaws"]]
    assert not [text for text in said if "stage 2" in text or "pinion" in text]
    for words in (
        "The teeth of sun and planet of stage 1 do not fit",
        "The face width of sun and planet of stage 1 is 2.91 d1",
        "% of the face width of planet and ring of stage 1",
        "The bore of the planet of stage 1",
    ):
        assert sum(words in text for text in said) == 1, words
    assert len(said) == len(set(said))


def test_words_of_a_drive_of_planets():
    """No larger gear drives where the carrier does; no bores where there are none."""
    words = " ".join(assumptions(gearopt.load(PROBLEMS / "wind_gearbox.toml")))
    assert "driven in stages 1 and 2 by the carrier, in stage 3 by the wheel" in words
    assert "The gears of pairs are external" in words and "Volumes of pairs are" in words
    words = " ".join(assumptions(gearopt.load(STAGE)))
    assert "bores" not in words and "the members named input drive" in words


@pytest.mark.parametrize(
    ("where", "words"),
    [
        (["1, a", "1, b"], "in stage 1 (a; b): "),
        (["1, a", "1, b", "2, a", "2, b", "3"], "in all planetary meshes and stage 3: "),
        (["1, a", "2, a"], "in stage 1 (a) and stage 2 (a): "),
        (["3", "4"], "in stages 3 and 4 "),
        ([], ""),
    ],
)
def test_meshes_of_unverified_factors_are_named_together(where, words):
    assert _in_stages(where, ["1, a", "1, b", "2, a", "2, b"]) == words


def test_printed_digits_of_shifts_fit_a_printed_distance():
    """The report has x_p = 0.5039, of which the fourth digit is rounded, and a = 584 mm."""
    printed = gearopt.rate(WIND, {"stage[1].planet.profile_shift": 0.5039}).design["rating"]
    assert not printed.get("misfits")
    apart = gearopt.rate(WIND, {"stage[1].planet.profile_shift": 0.5045}).design["rating"]
    assert any("do not fit in" in text for text in apart["misfits"])


@pytest.mark.parametrize(
    ("key", "value"),
    [("contact_ratio", 1.75), ("specific_sliding", 0.5), ("rule", "after Henriot")],
)
def test_limits_of_shifts_that_planets_do_not_keep_are_refused(key, value):
    with pytest.raises(SceneError, match=rf"shift\.{key} .* external gears alone"):
        gearopt.solve(STAGE, {"shift.sum": 0.3, f"shift.{key}": value})


def test_a_held_sun_has_no_mass_and_the_twist_of_all_meshes():
    """Minus the number of planets, as of `Practice.meshes`; a held ring has 0."""
    stage = StageTable(type="planetary", fixed="sun")
    assert [at_once(stage, 3, ring) for ring in (False, True)] == [(-3.0, 1.0), (1.0, 3.0)]


def test_a_changed_sun_is_the_one_that_is_rated():
    stage = StageTable(type="planetary").model_copy(update={"sun_teeth": (20, 20)})
    assert stage.pinion_teeth == (20, 20) and "pinion_teeth" not in stage.model_fields_set


def test_a_face_width_over_the_ring_is_not_that_of_all_gears():
    with pytest.raises(SceneError, match=r"stage\[1\]\.face_width_over_diameter.*ring's"):
        gearopt.solve(STAGE, {"stage[1].fixed": "sun", "stage[1].ring_teeth": [70, 110]})


NO_TEETH = [
    ({"duty.ratio": 1.9}, "1 + z_r/z_s and a ring with room for planets"),
    ({"stage[1].ring.cutter_teeth": 400}, "more teeth than its cutter, 400"),
    ({"limits.wheel_teeth": [20, 40]}, "20 to 40 teeth of the ring"),
    ({"stage[1].sun_teeth": 20, "stage[1].mesh_order": "simultaneous"}, "z_s (mesh_order)"),
    ({"stage[1].planets": 6, "stage[1].ring_teeth": [90, 200]}, "neighbouring planets"),
]


@pytest.mark.parametrize(("changes", "words"), few(NO_TEETH, 2))
def test_why_no_teeth_fit_is_said(changes, words):
    asked = tomllib.loads(STAGE.read_text())
    del asked["duty"]["output_speed"], asked["x-expected"]
    asked["duty"]["ratio"] = 5.25
    asked["stage"][0]["planets"] = 3
    result = gearopt.solve(asked, changes, remedies=False)
    assert result.status == "infeasible" and words in result.message


@pytest.mark.slow
def test_a_thin_ring_is_left_out_of_a_search_within_a_given_outside():
    """180 mm leave the lightest rings no rim of 1.75 m_n; the answer keeps it."""
    asked = tomllib.loads(STAGE.read_text())
    asked["stage"][0] |= {"planets": 3, "ring": {"outside_diameter": "180 mm"}}
    result = gearopt.solve(asked)
    (stage,) = result.design["stages"]
    root = stage["ring_root_diameter_mm"]
    assert 180.0 - root > 2 * 1.75 * stage["normal_module_mm"]


WAYS_OUT = {
    "cutter": ({"ring": {"cutter_teeth": 400}}, {"cutter_teeth"}),
    "assembly": ({"sun_teeth": 20, "ring_teeth": 84}, {"planets", "ring_teeth", "equally_spaced"}),
    "order": ({"sun_teeth": 20, "mesh_order": "simultaneous"}, {"mesh_order", "sun_teeth"}),
    "reduction": ({"planet_teeth_reduction": [9]}, {"planet_teeth_reduction"}),
    "outside": ({"ring": {"outside_diameter": "120 mm"}}, {"outside_diameter"}),
}


@pytest.mark.parametrize("name", few(list(WAYS_OUT), 0))
def test_what_stages_with_a_ring_may_have_instead_is_found_and_true(name):
    own, keys = WAYS_OUT[name]
    asked = tomllib.loads(STAGE.read_text())
    del asked["duty"]["output_speed"], asked["x-expected"]
    asked["duty"]["ratio"] = 5.25 if name != "assembly" else 5.2
    asked["stage"] = [{"type": "planetary", "planets": 3} | own]
    ways = gearopt.explain(asked).remedies
    assert keys <= {change.key.split(".")[-1] for way in ways for change in way.changes}
    for way in ways:
        assert gearopt.solve(asked, way.edits).value is not None


INNER = {"type": "internal", "ring_teeth": [20, 60]}
FIVE = {"type": "planetary", "planets": 5}


@pytest.mark.parametrize(
    ("ratio", "stages", "key"),
    few([(1.1, [INNER], "duty.ratio"), (40, [FIVE, FIVE], "stage[1].planets")], 0),
)
def test_a_ring_too_close_to_its_pinion_or_planets_too_many_have_a_way_out(ratio, stages, key):
    """z_r = 1.1 z of 60 teeth at most interfere; five planets have no room at a ratio above 6."""
    asked = tomllib.loads(STAGE.read_text())
    asked["duty"] = {"power": "15 kW", "input_speed": "1480 rpm", "ratio": ratio}
    del asked["x-expected"]
    asked["stage"] = stages
    explained = gearopt.explain(asked)
    (way,) = (w for w in explained.remedies if [c.key for c in w.changes] == [key])
    assert gearopt.solve(asked, way.edits, budget=Budget(seconds=60)).value is not None
    assert not any("sun" in name for name in explained.conflict) or len(stages) == 2


@pytest.mark.slow
def test_a_limit_on_the_ring_is_in_the_conflict_that_it_makes():
    """12 teeth of the sun and a ratio of 5.25 ask for 51 of the ring, 40 are allowed."""
    asked = tomllib.loads(STAGE.read_text())
    del asked["duty"]["output_speed"], asked["x-expected"]
    asked["duty"]["ratio"] = 5.25
    explained = gearopt.explain(asked, {"limits.wheel_teeth": [20, 40]})
    assert "ring_teeth_high[1]" in explained.conflict
    assert any("51" in change.write for way in explained.remedies for change in way.changes)
