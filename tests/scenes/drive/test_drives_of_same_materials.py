"""`same_materials = true`: one material for all pinions of a drive and one for all wheels."""

import copy
import itertools

import pytest

import gearopt
from gearopt.errors import SceneError

HARD = {"name": "hard", "treatment": "carburised", "grade": 2, "price": 9}
TOUGH = {"name": "tough", "treatment": "through-hardened", "hardness": "300 HB", "price": 4}
DRIVE = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "7.5 kW", "input_speed": "1450 rpm", "ratio": 12},
    "gears": {"face_width_over_diameter": 0.6, "materials": ["hard", "tough"]},
    "stage": [{}, {}],
    "limits": {"pinion_teeth": [20, 21]},
    "teeth": {"modules": ["1.25 mm", "2 mm", "2.5 mm"]},
    "rating": {"life": "20000 h", "quality": 8, "minimum_bending_safety": 1.3},
    "objective": {"minimise": "cost", "density": "7.85 kg/dm^3"},
    "material": [HARD, TOUGH],
}


def drive(*stages, **gears):
    """The tables of a drive with keys of its stages and of all gears."""
    made = copy.deepcopy(DRIVE)
    made["gears"] |= {"same_materials": True} | gears
    made["stage"] = [dict(stage) for stage in stages] or made["stage"]
    return made


def chosen(result):
    """The materials of pinion and wheel, of every stage."""
    return [(s["pinion_material"], s["wheel_material"]) for s in result.design["stages"]]


@pytest.mark.slow
def test_the_best_is_that_of_every_pair_of_materials():
    names = ["hard", "tough"]
    pairs = {
        (a, b): [{"pinion": {"materials": [a]}, "wheel": {"materials": [b]}}] * 2
        for a, b in itertools.product(names, names)
    }
    alone = {
        pair: gearopt.solve(drive(*stages, same_materials=False)).value
        for pair, stages in pairs.items()
    }
    best = min((p for p in alone if alone[p] is not None), key=alone.get)
    found = gearopt.solve(drive())
    assert found.status == "optimal"
    assert found.value == pytest.approx(alone[best], rel=1e-12)
    assert chosen(found) == [best, best]


@pytest.mark.slow
def test_it_costs_more_than_a_choice_of_every_stage():
    free, found = (gearopt.solve(drive(same_materials=same)) for same in (False, True))
    assert free.value < found.value
    assert (len(set(chosen(free))), len(set(chosen(found)))) == (2, 1)
    assert "All pinions have one material, and all wheels have one." in found.report["notes"]


def test_materials_that_one_stage_cannot_have_are_left_out():
    """Names count, not the order of a list; a stage may have an accuracy of its own."""
    stages = [{"pinion": {"materials": ["tough", "hard"]}}, {"wheel": {"materials": ["hard"]}}]
    found = gearopt.solve(drive(*stages))
    assert [wheel for _, wheel in chosen(found)] == ["hard", "hard"]
    assert len(set(chosen(found))) == 1


def refused(tables):
    with pytest.raises(SceneError) as error:
        gearopt.load(tables)
    return error.value


def test_no_material_in_common_is_one_message():
    stages = [{"wheel": {"materials": ["tough"]}}, {"wheel": {"materials": ["hard"]}}]
    error = refused(drive(*stages))
    assert error.key == "gears.same_materials"
    assert "no material that the wheels of all stages may have" in str(error)
    assert "stage 1: tough; stage 2: hard" in str(error)


@pytest.mark.parametrize(
    "change, key, told",
    [
        ({"stage": [{}]}, "gears.same_materials", "there is one stage"),
        ({"gears": {"materials": ["hard"]}}, "gears.same_materials", "no gear has a choice"),
        ({"rating": None, "material": None}, "gears.same_materials", "needs a table [rating]"),
        ({"gears": {"materials": None, "treatment": "carburised"}}, "materials", "is missing"),
    ],
)
def test_what_it_changes_nothing_of_is_refused(change, key, told):
    tables = drive()
    for name, more in change.items():
        if more is None:
            del tables[name]
        elif isinstance(more, dict):
            tables[name] = {k: v for k, v in (tables[name] | more).items() if v is not None}
        else:
            tables[name] = more
    if "rating" not in tables:
        tables["gears"].pop("materials")
        tables["limits"] |= {"k_factor": "2 MPa", "unit_load": "48 MPa"}
        tables["objective"] = {}
    error = refused(tables)
    assert error.key.endswith(key) and told in str(error)


@pytest.mark.slow
def test_next_best_trains_have_the_same_materials():
    found = gearopt.solve(drive(), top=4)
    trains = found.report["trains"]
    assert len(trains) == 4
    assert [t["objective"] for t in trains] == sorted(t["objective"] for t in trains)
    for one in trains:
        assert len({(s["pinion_material"], s["wheel_material"]) for s in one["stages"]}) == 1


@pytest.mark.slow
def test_materials_of_its_own_for_every_stage_are_a_remedy():
    """What all stages may have is too soft for the first one, whose module is small."""
    soft = TOUGH | {"name": "soft", "hardness": "180 HB"}
    stages = [
        {"module": "2 mm", "wheel": {"materials": ["hard", "soft"]}},
        {"wheel": {"materials": ["soft"]}},
    ]
    tables = drive(*stages) | {"material": [HARD, TOUGH, soft]}
    tables["teeth"] = {"modules": ["2 mm", "4 mm", "5 mm"]}
    found = gearopt.explain(tables)
    assert found.result.status == "infeasible"
    changes = {change.key: change.write for r in found.remedies for change in r.changes}
    assert changes["gears.same_materials"] == "false"
    tables["gears"]["same_materials"] = False
    assert gearopt.solve(tables).status == "optimal"
