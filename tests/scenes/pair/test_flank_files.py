"""Files of helical pairs and tables [flank]: what they give, and what goes with them."""

import copy
import tomllib

import numpy as np
import pytest

import gearopt
from gearopt.errors import SolveError
from gearopt.optimise.result import Budget
from gearopt.scenes.pair import KIND

HELICAL = tomllib.loads(KIND.example.text) | {"gears": {"helix_angle": "15 deg"}}


def solved(**tables):
    return gearopt.solve(copy.deepcopy(HELICAL) | tables)


def flank(**tables):
    return solved(**tables).design["flank"]


def test_helical_gears_are_computed_by_slices():
    result = solved()
    found = result.design["flank"]
    assert result.status == "evaluated" and "contact" not in result.design
    assert len(found["place_mm"]) == found["slices"] == 41
    load = found["loads"][-1]
    assert len(load["line_load_N_per_mm"]) == 41
    assert all(len(row) == len(found["path_mm"]) for row in load["contact_stress_MPa"])
    pinion = 3.0 * 25 / np.cos(np.radians(15.0))
    torque = 20e6 / (955 * 2 * np.pi / 60)
    base = pinion * np.cos(np.arctan(np.tan(np.radians(20.0)) / np.cos(np.radians(15.0))))
    assert load["normal_force_N"] == pytest.approx(2 * torque / base, rel=1e-9)
    assert found["overlap_ratio"] == pytest.approx(30 * np.sin(np.radians(15.0)) / (np.pi * 3.0))


def test_a_table_flank_of_a_spur_pair_gives_the_answers_of_the_plane_models():
    spur = tomllib.loads(KIND.example.text)
    plane = gearopt.solve(spur).design["contact"]["loads"]
    sliced = gearopt.solve(spur | {"flank": {"slices": 7}}).design["flank"]["loads"]
    for one, other in zip(plane, sliced, strict=True):
        for name in ("peak_to_peak_mm", "largest_contact_stress_MPa", "mean_mesh_stiffness_MPa"):
            assert other[name] == pytest.approx(one[name], rel=1e-9)


def test_misalignment_is_made_up_for_by_an_equal_helix_correction():
    plain, tilted = flank(), flank(flank={"misalignment": "12 um"})
    both = flank(flank={"misalignment": "12 um", "helix_correction": "12 um"})
    assert tilted["loads"][1]["face_load_factor"] > 1.2
    assert both["loads"][1]["line_load_N_per_mm"] == plain["loads"][1]["line_load_N_per_mm"]


def test_relief_that_is_given_is_evaluated_and_that_which_is_chosen_is_not_proven():
    given = solved(relief={"amount": "10 um", "length": 0.4})
    load = given.design["flank"]["loads"][1]
    assert given.status == "evaluated"
    assert given.value == pytest.approx(load["peak_to_peak_mm"])
    assert load["plain_peak_to_peak_mm"] == flank()["loads"][1]["peak_to_peak_mm"]
    chosen = gearopt.solve(
        copy.deepcopy(HELICAL) | {"relief": {}, "sharing": {"positions": 12}},
        budget=Budget(evaluations=64),
    )
    assert chosen.status == "feasible" and "not proven" in chosen.message
    assert chosen.value < load["plain_peak_to_peak_mm"]


def test_what_slices_do_not_do_is_refused_by_name():
    relieved = copy.deepcopy(HELICAL) | {"relief": {}}
    with pytest.raises(SolveError, match="spur pairs without a table \\[flank\\]"):
        gearopt.pareto(relieved, objectives=["peak_to_peak", "load_jump"])
    with pytest.raises(SolveError, match="nothing to hold each other by"):
        gearopt.solve(copy.deepcopy(HELICAL) | {"sharing": {"level": "Nakada A"}})
    with pytest.raises(SolveError, match="length goes up to 3"):
        gearopt.solve(copy.deepcopy(HELICAL) | {"relief": {"amount": "9 um", "length": 3}})
