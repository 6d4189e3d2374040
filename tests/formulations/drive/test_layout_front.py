"""Fronts of a box, against its text on a fine grid of all angles."""

from functools import cache

import numpy as np
import pytest
from campaigns import few
from gearboxes import gearbox

from gearopt.errors import SolveError
from gearopt.formulations.drive.gearbox import SIDES, KeepOut
from gearopt.formulations.drive.layout import layout_front
from gearopt.optimise.pareto.measures import unbeaten
from gearopt.optimise.pareto.objectives import Limiting
from gearopt.optimise.pareto.tradeoff import found

FLOOR = KeepOut("floor", (-1e3, 1e3), (-1e3, -140.0))
STEP = 0.015  # rad
BOX = gearbox("elevator", keep_outs=(FLOOR,), motor=130.0)


def front(names, points, most=None, box=BOX):
    limiting = Limiting(lambda name, most: layout_front.limited(box, name, most), tuple(SIDES))
    own = layout_front.problem(box, names)
    return found(own, names, most or {}, None, points, limiting=limiting)


@cache
def six_points(names):
    """Six points of a front, by the names of its objectives."""
    return front(names, 6)


@cache
def grid(names):
    """Values of all layouts on a grid of both angles whose limits are met."""
    problem = layout_front.problem(BOX, names)
    turn = np.arange(-np.pi, np.pi, STEP)
    points = np.stack(np.meshgrid(turn, turn), axis=-1).reshape(-1, 2)
    orders = int(problem.bounds()[1][2]) + 1 if len(problem.columns) > 2 else 1
    values = []
    for m in range(orders):
        rows = np.column_stack([points, np.full(len(points), m)]) if orders > 1 else points
        batch = problem.batch(rows)
        values.append(batch.F[(batch.G <= 1.0).all(axis=1)])
    return np.vstack(values)


FRONTS = few(["width", "plan_area"], 0)


@pytest.mark.parametrize("first", FRONTS)
def test_no_layout_of_a_grid_beats_a_point_and_some_come_near(first):
    names = (first, "height")
    made, values = six_points(names), grid(names)
    assert all(p.proven for p in made.points) and len(made.points) == 6 and made.epsilon < 0.25
    reach = 2.0 * STEP * sum(pair.centre_distance for pair in BOX.pairs) / values.min(axis=0)[1]
    for own in made.values:
        inside = values[:, 1] <= own[1]
        assert values[inside, 0].min() >= own[0] * (1.0 - 1e-6)
        near = values[:, 1] <= own[1] * (1.0 + reach)
        assert values[near, 0].min() <= own[0] * (1.0 + 2.0 * reach)


@pytest.mark.parametrize("first", FRONTS)
def test_between_two_points_the_front_is_within_the_stated_error(first):
    made, values = six_points((first, "height")), grid((first, "height"))
    width = np.ptp(made.values, axis=0)
    worse = ((made.values[:, None] - values[unbeaten(values)][None]) / width).max(axis=2)
    assert worse.min(axis=0).max() <= made.epsilon + 1e-6


@pytest.mark.slow
def test_the_shortest_box_comes_first_where_length_is_an_objective():
    made = front(("length", "height"), 3)
    (point,) = made.points  # one arrangement of two stages
    assert point.proven and point.values[1] == pytest.approx(
        front(("height", "length"), 3).points[0].values[0], rel=1e-6
    )


@pytest.mark.slow
def test_largest_sides_cut_the_front_and_impossible_ones_are_proven():
    made = front(("width", "height"), 3, {"height": 380.0})
    assert made.values[:, 1].max() <= 380.0 * (1 + 1e-7)
    none = front(("width", "height"), 3, {"height": 300.0})
    assert none.infeasible and not none.points and none.message
    with pytest.raises(SolveError, match="box_volume cannot be limited"):
        front(("width", "box_volume"), 3)


@pytest.mark.slow
def test_the_ends_of_three_stages_are_the_published_box():
    """The box of 411.98 x 873.29 mm, found by others as that of least volume, ends the front."""
    made = front(("width", "height"), 3, box=gearbox("table4_p1"))
    assert made.values[0] == pytest.approx([411.98, 873.29], abs=0.01)
    assert made.values[-1] == pytest.approx([873.29, 411.98], abs=0.01)
