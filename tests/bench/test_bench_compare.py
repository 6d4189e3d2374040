"""The problems of `gearopt bench compare`: repeatable, possible, with known optima."""

import pytest

import gearopt
from gearopt.bench.compare import RANDOM_DRIVES, _rows, random_drive, reducer
from gearopt.formulations.drive import teeth
from gearopt.optimise.solve import solve


@pytest.mark.parametrize("number", range(RANDOM_DRIVES))
def test_random_drives_are_repeatable_and_possible(number):
    train = random_drive(number)
    assert train == random_drive(number) != random_drive(number + 1)
    assert solve(teeth.problem(train)).status == "optimal"


def test_the_reducer_is_golinskis():
    assert solve(reducer()).value == pytest.approx(2994.341315684, abs=1e-8)


def test_rows_have_the_same_columns_also_where_a_method_is_refused():
    found = gearopt.compare(reducer(), methods=("gp", "ipopt"))
    gp, by_count, by_time = _rows("Golinski", found)
    assert list(gp) == list(by_count) == list(by_time)
    assert gp["equal"] == "refused" and gp["objective"] is None
    assert (by_count["equal"], by_time["equal"]) == ("evaluations", "time")
    assert by_time["gap_percent"] == by_time["worst_gap_percent"] == 0.0
