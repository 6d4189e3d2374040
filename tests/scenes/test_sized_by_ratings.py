"""Drives whose limits are the safety factors of their rating."""

import copy
import tomllib
from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.scenes.reading.load import examples

PROBLEMS = Path(__file__).parents[2] / "problems"
NAME = "elevator_by_agma"
DRIVE = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "7.5 kW", "input_speed": "1450 rpm", "ratio": 4},
    "gears": {"treatment": "carburised"},
    "stage": [{"face_width_over_diameter": 0.6}],
    "limits": {"pinion_teeth": [20, 24]},
    "teeth": {},
    "rating": {"life": "20000 h", "quality": 8},
}


def drive(**tables):
    """The tables of a small drive with keys of its tables changed; None takes a table away."""
    made = copy.deepcopy(DRIVE)
    for name, more in tables.items():
        if more is None:
            del made[name]
        elif isinstance(more, dict):
            made[name] = made.get(name, {}) | more
        else:
            made[name] = more
    return made


def safeties(result):
    """The least S_F and S_H of a result that is rated."""
    gears = result.design["rating"]["gears"]
    return min(g["bending_safety"] for g in gears), min(g["contact_safety"] for g in gears)


def test_the_answer_is_rated_by_the_exact_form_as_its_limits_say(solved):
    result = solved(NAME)
    rating = result.design["rating"]
    assert rating["safe"] and result.status == "optimal"
    for gear in rating["gears"]:
        for mode in ("bending", "contact"):
            used = result.limits[f"{gear['member']}_{mode}[{gear['stage']}]"]
            assert used == pytest.approx(1.0 / gear[f"{mode}_safety"], rel=1e-9)


@pytest.mark.parametrize(
    "rating",
    [{"minimum_contact_safety": 1.2}, {"minimum_bending_safety": 3}, {"overload_factor": 1.5}],
    ids=str,
)
def test_more_safety_takes_more_volume(rating):
    small, large = (gearopt.solve(drive(rating=more)) for more in ({}, rating))
    assert large.value > small.value
    asked = rating.get("minimum_bending_safety", 1), rating.get("minimum_contact_safety", 1)
    assert all(s >= a - 1e-8 for s, a in zip(safeties(large), asked, strict=True))


def test_given_gears_that_are_rated_and_sized_are_the_same():
    result = gearopt.solve(drive())
    stage = result.design["stages"][0]
    given = {
        "module": f"{stage['normal_module_mm']} mm",
        "pinion_teeth": stage["pinion_teeth"],
        "wheel_teeth": stage["wheel_teeth"],
        "face_width": f"{stage['face_width_mm']!r} mm",
    }
    rated = gearopt.rate(drive(stage=[given], limits=None))
    assert safeties(rated) == pytest.approx(safeties(result), rel=1e-9)


LOADS = {"preset": "chong-lee-elevator"}


@pytest.mark.parametrize("factor", [1, 2])
def test_load_limits_beside_a_rating_are_limits_too(factor):
    """The least of both is never below the least of either; the one that binds gives it."""
    rating = {"minimum_contact_safety": factor}
    both = gearopt.solve(drive(limits=LOADS, rating=rating))
    loads = gearopt.solve(drive(limits=LOADS, rating=None, gears=None))
    rated = gearopt.solve(drive(rating=rating))
    assert both.value >= max(loads.value, rated.value) * (1.0 - 1e-12)
    binding = loads if factor == 1 else rated
    assert both.value == pytest.approx(binding.value, rel=1e-12)


def test_under_a_spectrum_load_limits_size_alone():
    """The rating then only tells whether the gears are safe."""
    load = [{"power": "7.5 kW", "share": 1}]
    more = {"minimum_contact_safety": 9}
    both = gearopt.solve(drive(limits=LOADS, rating=more, load=load))
    alone = gearopt.solve(drive(limits=LOADS, rating=None, gears=None))
    assert both.value == alone.value and not both.design["rating"]["safe"]


@pytest.mark.parametrize("standard", ["iso6336", "both"])
def test_every_standard_asked_for_is_met(standard):
    tables = drive(rating={"standard": standard, "iso6336": {"accuracy_grade": 6}})
    if standard == "iso6336":
        del tables["rating"]["quality"]
    result = gearopt.solve(tables)
    rating = result.design["rating"]
    assert result.status == "optimal" and rating["safe"]
    assert standard == "iso6336" or rating["beside"]["safe"]


def test_widths_keep_to_their_limits():
    ends = {"face_width_over_diameter": [0.2, 1], "face_width_over_module": [9, 14]}
    free, held, least = (
        gearopt.solve(drive(stage=[{"face_width_over_diameter": [0.2, 1]} | more]))
        for more in ({}, ends, {"minimum_face_width": "60 mm"})
    )
    stage = held.design["stages"][0]
    assert 9 <= stage["face_width_mm"] / stage["normal_module_mm"] <= 14 + 1e-9
    assert least.design["stages"][0]["face_width_mm"] >= 60 - 1e-9
    assert free.value <= min(held.value, least.value)


def test_explain_says_what_steel_and_life_bring():
    found = gearopt.explain(drive())
    brings = {one.key: one.price for one in found.influences}
    assert brings["rating.life"] <= 0.0 and brings["rating.quality"] <= 0.0
    assert "limits.pinion_teeth[2]" in brings


def test_an_impossible_drive_is_proven_so_and_every_remedy_works():
    tables = drive(limits={"wheel_diameter": "100 mm", "pinion_teeth": [20, 22]})
    found = gearopt.explain(tables)
    assert found.result.status == "infeasible"
    remedies = {r.what: r for r in found.remedies}
    assert "limits.wheel_diameter" in remedies and "duty.power" in remedies
    for remedy in remedies.values():
        assert gearopt.solve(tables, remedy.edits).value is not None


REFUSED = {  # the mistake: tables, key, what is said
    "no limits at all": ({"rating": None, "gears": None}, "limits.preset", "a table [rating]"),
    "a load limit of a stage alone": (
        {"stage": [{"face_width_over_diameter": 0.6, "k_factor": "2 MPa"}]},
        "stage[1].k_factor",
        "ratings alone limit the gears",
    ),
    "half of the load limits": (
        {"limits": {"k_factor": "2 MPa"}},
        "limits.unit_load",
        "is missing (or give preset)",
    ),
    "box at once": (
        {"layout": {"together": True, "shaft_stress": "40 MPa"}},
        "layout.together",
        "load limits alone",
    ),
    "process": ({"process_one": {"stage_ratios": [4]}}, "process_one", "is a process by"),
    "no steel": ({"gears": None}, "gears.treatment", "needs the steel"),
    "misspelt safety": (
        {"rating": {"minimum_bending_safty": 2}},
        "rating.minimum_bending_safty",
        "Did you mean minimum_bending_safety",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_mistakes_are_one_message(name):
    tables, key, told = REFUSED[name]
    made = drive(**tables)
    with pytest.raises(SceneError) as refused:
        gearopt.load(made)
    assert refused.value.key == key and told in str(refused.value)
    assert len(refused.value.errors) == 1


@pytest.mark.parametrize(
    ("tables", "told"),
    [
        ({"teeth": None}, "a table [teeth]"),
        ({"load": [{"power": "5 kW", "share": 1}]}, "load spectrum"),
    ],
    ids=["real-valued", "spectrum"],
)
def test_what_limits_no_gears_yet_is_named(tables, told):
    with pytest.raises(SolveError, match=told.replace("[", r"\[")):
        gearopt.solve(drive(**tables))


def test_the_file_to_start_from_has_a_safe_answer():
    result = gearopt.solve(tomllib.loads(examples()["sizing"]))
    assert result.status == "optimal" and result.design["rating"]["safe"]
