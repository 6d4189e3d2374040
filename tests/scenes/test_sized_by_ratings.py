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


def test_load_limits_beside_a_rating_limit_alone():
    """The gears are those of the load limits; the rating only tells whether they are safe."""
    loads = {"preset": "chong-lee-elevator"}
    both = gearopt.solve(drive(limits=loads, rating={"minimum_contact_safety": 9}))
    alone = gearopt.solve(drive(limits=loads, rating=None, gears=None))
    assert both.value == alone.value and not both.design["rating"]["safe"]


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
        "ratings limit the gears",
    ),
    "half of the load limits": (
        {"limits": {"k_factor": "2 MPa"}},
        "limits.unit_load",
        "is missing (or give preset)",
    ),
    "box at once": (
        {"layout": {"together": True, "shaft_stress": "40 MPa"}},
        "layout.together",
        "K-factor and unit load",
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
        (
            {"rating": {"standard": "both", "iso6336": {"accuracy_grade": 6}}},
            "cannot be sized by ISO 6336",
        ),
    ],
    ids=["real-valued", "spectrum", "ISO"],
)
def test_what_limits_no_gears_yet_is_named(tables, told):
    with pytest.raises(SolveError, match=told.replace("[", r"\[")):
        gearopt.solve(drive(**tables))


def test_the_file_to_start_from_has_a_safe_answer():
    result = gearopt.solve(tomllib.loads(examples()["sizing"]))
    assert result.status == "optimal" and result.design["rating"]["safe"]
