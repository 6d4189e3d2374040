"""Stages whose type is chosen, against a file for every choice of types."""

import tomllib
from itertools import product
from pathlib import Path

import pytest

import gearopt
from gearopt import Budget, SceneError

FILE = Path(__file__).parents[3] / "problems" / "planetary_or_parallel.toml"
KEYS = {"planetary": ("planets",), "parallel": ("wheel_teeth",), "internal": ("ring_teeth",)}
OWN = {"planets": 3, "wheel_teeth": [20, 480], "ring_teeth": [60, 160]}


def asked(*types, ratio=5.2, pinion_teeth=(24, 32), modules=("2 mm", "3 mm")):
    """A drive of stages of these types, with the keys of each that it may have."""
    drive = tomllib.loads(FILE.read_text())
    del drive["x-expected"], drive["duty"]["output_speed"]
    drive["duty"]["ratio"] = ratio
    drive["limits"]["pinion_teeth"] = list(pinion_teeth)
    drive["teeth"] = {"modules": list(modules)}
    drive["stage"] = []
    for kinds in types:
        each = [kinds] if isinstance(kinds, str) else kinds
        names = [name for kind in each for name in KEYS[kind]]
        drive["stage"].append({"type": kinds} | {name: OWN[name] for name in names})
    return drive


def held_to_files(types, **drive):
    """The best over choices of types, held to files with one choice each."""
    found = gearopt.solve(asked(*types, **drive), top=3)
    each = [[kinds] if isinstance(kinds, str) else kinds for kinds in types]
    alone = {row: gearopt.solve(asked(*row, **drive), top=3) for row in product(*each)}
    known = [r for r in alone.values() if r.value is not None]
    best = min(known, key=lambda r: r.value)
    assert found.status == "optimal" and found.value == best.value
    assert found.bound == min(r.bound for r in known)
    assert found.design == best.design and found.limits == best.limits
    assert [row["types"] for row in found.report["counts"]] == [", ".join(row) for row in alone]
    for row, own in zip(found.report["counts"], alone.values(), strict=True):
        assert (row["status"], row["objective"]) == (own.status, own.value)
    every = sorted(t["objective"] for r in known for t in r.report["trains"])
    assert [t["objective"] for t in found.report["trains"]] == every[:3]
    return found


@pytest.mark.slow
def test_the_best_type_is_that_of_separate_files():
    found = held_to_files([["planetary", "parallel"]], pinion_teeth=[32, 32], modules=["2 mm"])
    assert found.design["stages"][0]["type"] == "planetary"
    page = found.to_html()
    assert "Types of the stages" in page and "every choice of types" in page


@pytest.mark.slow
@pytest.mark.parametrize("minimise", ["gear_volume", "mesh_loss"])
def test_types_of_two_stages_are_chosen(minimise):
    types = [["parallel", "planetary"], ["internal", "parallel"]]
    found = held_to_files(types, ratio=12)
    assert len(found.report["counts"]) == 4


@pytest.mark.slow
def test_an_impossible_choice_is_no_error():
    """At 15:1 three planets, seven times the sun, overlap: 8 sin 60 degrees is below 7."""
    found = held_to_files([["planetary", "parallel"]], ratio=15)
    status = [row["status"] for row in found.report["counts"]]
    assert status == ["infeasible", "optimal"]


def test_without_time_nothing_is_proven():
    found = gearopt.solve(asked(["planetary", "parallel"]), budget=Budget(1e-9))
    assert (found.status, found.value, found.bound) == ("limit", None, None)


@pytest.mark.slow
def test_a_front_holds_the_best_of_all_types():
    """Designs of separate fronts that none of them dominates."""
    names = ("gear_volume", "mesh_loss")
    kinds = ["planetary", "parallel"]
    fronts = [gearopt.pareto(asked(t), objectives=names) for t in (kinds, *kinds)]
    both, *alone = [[tuple(p.values) for p in f.points] for f in fronts]
    every = {v for values in alone for v in values}
    best = {v for v in every if not any(w != v and w[0] <= v[0] and w[1] <= v[1] for w in every)}
    assert len(best) > 3 and set(both) == best


@pytest.mark.slow
def test_explain_holds_the_types_that_were_found():
    found = gearopt.explain(asked(["planetary", "parallel"]))
    assert "the types of the stages are held: planetary" in found.message
    assert any(one.key == "rating.life" for one in found.influences)


WRONG = {
    "unknown": ({"type": ["planetary", "paralel"]}, '["planetary", "parallel"]'),
    "empty": ({"type": []}, "is empty"),
    "of neither": ({"type": ["planetary", "internal"]}, 'is not of "planetary" or "internal"'),
    "of another": ({"type": ["parallel", "internal"]}, 'needs type = "planetary"'),
    "given": ({"limits": None}, "of gears that are to be sized"),
    "layout": ({"layout": {"shaft_stress": "40 MPa"}}, "a [layout] takes one"),
    "no teeth": ({"teeth": None}, "whole teeth are chosen"),
}


@pytest.mark.parametrize("name", WRONG)
def test_types_that_cannot_be_chosen_are_refused(name):
    changes, words = WRONG[name]
    drive = asked(["planetary", "parallel"])
    for key, value in changes.items():
        if key == "type":
            drive["stage"][0][key] = value
        elif value is None:
            del drive[key]
        else:
            drive[key] = value
    with pytest.raises(SceneError) as wrong:
        gearopt.solve(drive)
    assert words in str(wrong.value)


def test_one_type_in_a_list_is_that_type():
    drive = asked(["parallel"])
    found = gearopt.solve(drive)
    assert "counts" not in found.report and found.design["stages"][0]["wheel_teeth"] > 17


def test_more_choices_than_are_compared_are_refused():
    drive = asked(*[["planetary", "parallel"]] * 6, ratio=900)
    with pytest.raises(SceneError, match="leaves 64 choices of types, and 32 at most"):
        gearopt.solve(drive)
