"""Fronts over numbers of stages: the designs of all counts that none of any count beats."""

from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt import SolveError

FILE = Path(__file__).parents[3] / "problems" / "how_many_stages.toml"
NAMES = "gear_volume,mesh_loss"
FEW = {"limits.pinion_teeth": [17, 19], "duty.ratio": 12, "limits.wheel_teeth": [17, 90]}


def values(front):
    return np.array([point.values for point in front.points])


@pytest.mark.slow
def test_the_front_is_what_is_unbeaten_of_the_fronts_of_every_count():
    whole = gearopt.pareto(FILE, {**FEW, "stages": [1, 3]}, objectives=NAMES)
    each = [gearopt.pareto(FILE, {**FEW, "stages": n}, objectives=NAMES) for n in (1, 2, 3)]
    assert each[0].status == "infeasible" and whole.status == "complete"
    rows = np.vstack([values(front) for front in each if front.points])
    beaten = [((rows <= r).all(axis=1) & (rows < r * (1 - 1e-9)).any(axis=1)).any() for r in rows]
    wanted = rows[~np.array(beaten)]
    assert values(whole) == pytest.approx(wanted[np.argsort(wanted[:, 0])], rel=1e-12)
    assert {len(point.design["stages"]) for point in whole.points} == {2, 3}
    assert whole.picks and whole.hypervolume > 0.0


def test_counts_that_all_are_impossible_have_no_front():
    changes = {**FEW, "stages": [1, 2], "duty.ratio": 200}
    front = gearopt.pareto(FILE, changes, objectives=NAMES)
    assert front.status == "infeasible" and not front.points


def test_what_is_not_complete_is_for_one_number_of_stages():
    changes = {**FEW, "stages": [2, 3]}
    for method in ("epsilon", "nsga2"):
        with pytest.raises(SolveError, match="write stages = 2"):
            gearopt.pareto(FILE, changes, objectives=NAMES, method=method)
    with pytest.raises(SolveError, match="write one number of stages"):
        gearopt.compare(FILE, changes, objectives=NAMES)
