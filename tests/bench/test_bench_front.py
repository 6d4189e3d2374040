"""The problem of `gearopt bench front`: its front is that of the drive's own formulation."""

from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt.bench.front import LENGTH, LOSS, MOST, VOLUME, _row, elevator
from gearopt.optimise.pareto.found import Found, Point, Step
from gearopt.optimise.pareto.tradeoff import found

FILE = Path(__file__).parents[2] / "problems" / "elevator_free_width.toml"
EXACT = {"duty.ratio_tolerance": "0 %", "limits.pinion_teeth": [20, 1000]}
ENDS = {  # of the digest of Chong and Lee: mm3, and mm or per cent
    LENGTH: ((5.687e6, 338.87), (6.027e6, 331.42)),
    LOSS: ((5.687e6, 1.79), (8.53e6, 1.09)),
}


@pytest.mark.slow
@pytest.mark.parametrize("second", [LENGTH, LOSS])
def test_the_front_is_the_published_one_and_that_of_the_file(second):
    most = MOST if second == LOSS else {}
    made = found(elevator(), (VOLUME, second), most, "epsilon", 4)
    assert made.values[[0, -1]] == pytest.approx(np.array(ENDS[second]), rel=3e-3)
    names = f"{VOLUME},{second}"
    front = gearopt.pareto(FILE, EXACT, objectives=names, most=most, method="epsilon", points=4)
    own = np.array([p.values for p in front.points])
    assert own == pytest.approx(made.values, rel=1e-6) and front.status == "proven"


def test_a_row_has_shares_of_the_hypervolume_and_the_time_to_most_of_it():
    exact = np.array([[0.0, 2.0], [1.0, 1.0], [2.0, 0.0]])  # from (2.1, 2.1): 0.21 + 1.1 + 0.1
    ends = tuple(Point(np.zeros(1), values) for values in exact[[0, 2]])
    whole = 2.1 * 0.1 + 1.1 * 1.0 + 0.1 * 1.0
    steps = Step(0.5, 10, exact[:1]), Step(2.0, 20, exact[[0, 2]])
    row = _row("case", "method", [Found(ends, steps=steps)], [3000.0], exact)
    assert row["share_percent"] == row["worst_percent"]
    assert row["share_percent"] == pytest.approx(100 * (whole - 1.0) / whole, abs=1e-3)
    assert (row["ms_to_99_percent"], row["median_ms"], row["points"]) == (2000.0, 3000.0, 2)
