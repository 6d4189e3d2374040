"""Intervals, rows and bounds of random boxes, held against the true graph in 40 digits."""

import mpmath as mp
import numpy as np
import pytest
from graph import OPERATIONS, boxes, graph

from gearopt.errors import SolveError
from gearopt.optimise.problem import Problem
from gearopt.optimise.spatial.columns import Affine, Builder, divided, powered
from gearopt.optimise.spatial.columns_of_text import columns
from gearopt.optimise.spatial.step import Stepper
from gearopt.optimise.terms import Param, Repeat, Terms, Var

POINTS = 6  # of a box that are held against it


def text(name, ends=((-30.0, 30.0), (-30.0, 30.0))):
    """Problem of one operation of two variables."""
    (a, b), (c, d) = ends
    x, y = Var("x", "", a, b, 0.5 * (a + b)), Var("y", "", c, d, 0.5 * (c + d))
    operation = OPERATIONS[name]
    return Problem("text", (x, y), (), lambda x, p: Terms({"f": operation(x.x, x.y)}))


def start(form, box):
    """Ends of all columns where the variables lie in a box (2, 2)."""
    lower, upper = form.lower.copy(), form.upper.copy()
    lower[:2], upper[:2] = box[:, 0], box[:, 1]
    return lower, upper


def points(form, box, rng):
    """Points of a box with the values of all columns: corners and inner ones."""
    shares = np.vstack([[[0.0, 0.0], [1.0, 1.0]], rng.random((POINTS - 2, 2))])
    for x in box[:, 0] + shares * (box[:, 1] - box[:, 0]):
        x = np.clip(x, box[:, 0], box[:, 1])
        if (value := graph(form, x)) is not None:
            yield value


def inside(value, lower, upper):
    """Columns whose value lies outside their ends."""
    return [j for j, v in enumerate(value) if v is not None and not lower[j] <= v <= upper[j]]


def rows_broken(stepper, value):
    """Rows that a point of the graph violates."""
    first, count, index, factor, least, most = stepper.rows
    broken = []
    for i in range(len(count)):
        terms = range(first[i], first[i] + count[i])
        total = sum((mp.mpf(factor[k]) * value[index[k]] for k in terms), mp.mpf(0))
        over = total - max(min(total, most[i]), least[i])
        if count[i] and abs(over) > 1e-30 * (1 + abs(total)):  # what 40 digits are off by
            broken.append((i, float(over)))
    return broken


def held(name, seed, count):
    """Hold random boxes of an operation against points of the graph; how many points there were."""
    rng = np.random.default_rng(seed)
    form = columns(text(name))
    stepper, seen = Stepper(form), 0
    for box in boxes(name, rng, count):
        lower, upper = start(form, box)
        alive = form.propagated(lower, upper, 5)
        truth = list(points(form, box, rng))
        seen += len(truth)
        assert alive or not truth
        if not alive:
            continue
        stepper.fill(lower, upper, rng.uniform(box[0, 0], box[0, 1], len(lower)))
        y = rng.normal(size=stepper.count) * (rng.random(stepper.count) < 0.3)
        bound = stepper.safe(y, form.objective, 1.0, lower, upper)
        empty = stepper.safe(y, -1, 0.0, lower, upper)
        for value in truth:
            assert inside(value, lower, upper) == []
            assert rows_broken(stepper, value) == []
            assert bound <= value[form.objective] and empty <= 0.0
    return seen


@pytest.mark.parametrize("name", OPERATIONS)
def test_intervals_rows_and_bounds_hold_on_random_boxes(name):
    assert held(name, 0, 3) > 3


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 4))
@pytest.mark.parametrize("name", OPERATIONS)
def test_intervals_rows_and_bounds_hold_on_many_boxes(name, seed):
    assert held(name, seed, 120) > 150


def test_a_cutoff_takes_only_points_above_it():
    rng = np.random.default_rng(3)
    for name in ("powers", "waves", "kinks", "exp"):
        form = columns(text(name))
        stepper = Stepper(form)
        for box in boxes(name, rng, 10):
            lower, upper = start(form, box)
            if not form.propagated(lower, upper, 5):
                continue
            cutoff = float(rng.normal())
            y = rng.normal(size=stepper.count) * (rng.random(stepper.count) < 0.3)
            stepper.fill(lower, upper, lower)
            after = stepper.closed(lower, upper, cutoff, y, False)
            for value in points(form, box, rng):
                if value[form.objective] < min(cutoff, after.bound):
                    assert not after.empty and inside(value, lower, upper) == []


@pytest.mark.parametrize("x", [0.1, 1.0 / 3.0, -7.3])
def test_folded_factors_enclose_the_text(x):
    """0.1 (0.3 x) - 0.7 x/3 + ...: factors that are multiplied here are off by a rounding."""

    def evaluate(v, p):
        a = 0.1 * (0.3 * v.x) - 0.7 * v.x / 3.0 + 1e-3 * (v.x + 1e3) / 7.0
        return Terms({"f": a * (0.1 * v.x) ** 3})

    form = columns(Problem("folds", (Var("x", "", x, x, x),), (), evaluate))
    lower, upper = form.lower.copy(), form.upper.copy()
    assert form.propagated(lower, upper, 2)
    x, d = mp.mpf(x), mp.mpf
    a = d(0.1) * (d(0.3) * x) - d(0.7) * x / 3 + d(1e-3) * (x + 1000) / 7
    truth = a * (d(0.1) * x) ** 3
    assert lower[form.objective] <= truth <= upper[form.objective]
    assert upper[form.objective] - lower[form.objective] < 1e-11 * max(1.0, abs(truth))


def test_factors_that_are_hardly_known_stay_in_their_columns():
    x, hardly, one = (
        {j: pair} for j, pair in enumerate([(1.0, 0.0), (2e-18, 3e-18), (1.0, 1e-16)])
    )
    (pair,) = divided(Builder("p", 3, [False] * 3), Affine(x), Affine(hardly)).terms.values()
    assert pair == (1.0, 0.0)
    (pair,) = powered(Builder("p", 3, [False] * 3), Affine(one), 3.0).terms.values()
    assert pair[0] == 1.0 and pair[1] > 3e-16
    constant = Affine({}, 2e-18, 3e-18)
    assert not powered(Builder("p"), constant, -1.0).fixed


def test_numbers_beyond_the_doubles_are_kept_apart_or_refused():
    x = Var("x", "", 1e-200, 1e-150, 1e-170)
    form = columns(Problem("p", (x,), (), lambda x, p: Terms({"f": (1e180 * x.x) ** 2})))
    lower, upper = form.lower.copy(), form.upper.copy()
    assert form.propagated(lower, upper, 2)
    assert 0.99e60 < upper[form.objective] < 1.01e60
    y = Var("y", "", 1.0, 2.0, 1.0)
    product = Problem("p", (x, y), (), lambda x, p: Terms({"f": 1e200 * x.x * (1e200 * x.y)}))
    with pytest.raises(SolveError, match="beyond the numbers"):
        columns(product)


def test_what_underflows_makes_no_row_and_no_bound_false():
    x = Var("x", "", 1e169, 1e171, 1e170)
    inverse = Problem("p", (x,), (), lambda x, p: Terms({"f": 1.0 / x.x}))
    form = columns(inverse, logarithms=False)
    stepper = Stepper(form)
    stepper.fill(form.lower, form.upper, form.lower)  # slopes of -1e-338 and less
    first, count, index, factor, least, most = stepper.rows
    for value in ([mp.mpf(at), 1 / mp.mpf(at)] for at in (1e169, 1e170, 1e171)):
        for i in range(len(count)):
            terms = range(first[i], first[i] + count[i])
            total = sum((mp.mpf(factor[k]) * value[index[k]] for k in terms), mp.mpf(0))
            assert least[i] <= total <= most[i]
    of_line = columns(Problem("p", (x,), (), lambda x, p: Terms({"f": 3.0 * x.x - 1.0})))
    line = Stepper(of_line)
    line.fill(of_line.lower, of_line.upper, of_line.lower)
    low, high = np.array([-1e-99, 0.0]), np.array([-1e-100, 0.0])
    for y in (1e-250, -1e-250):
        line.rows[4][:], line.rows[5][:] = -3e-99, 3e-99  # which the box meets
        assert not line.safe(np.array([y]), -1, 0.0, low, high) > 0.0


def test_equal_operations_are_one_column_and_powers_are_simplified():
    def kinds(evaluate):
        x = tuple(Var(n, "", -1.0, 2.0, 1.0) for n in "xy")
        return [int(r[0]) for r in columns(Problem("p", x, (), evaluate)).relations]

    assert len(kinds(lambda x, p: Terms({"f": x.x * x.y}, {"g": x.y * x.x}))) == 1
    assert kinds(lambda x, p: Terms({"f": np.sqrt(x.x**2)})) == [12]  # |x|
    x = Var("x", "", -1.0, 2.0, 1.0)
    plain = Problem("p", (x,), (), lambda x, p: Terms({"f": abs(x.x) ** 2 / x.x}))
    assert columns(plain).objective == 0  # x itself
    assert kinds(lambda x, p: Terms({"f": x.x * x.x * x.x}))[0] == 3


def test_what_has_no_relaxation_is_named():
    x = Var("x", "", -1.0, 2.0, 1.0)
    problem = Problem("signs", (x,), (), lambda x, p: Terms({"f": np.sign(x.x) * x.x}))
    with pytest.raises(SolveError, match="signs: no relaxation of its text is known: .* sign"):
        columns(problem)


def test_repeats_and_parameters_are_columns_too():
    def row(x, p, data):
        return Terms({"f": (x.own - data.at) ** 2}, {"g": x.own * p.k / data.at})

    problem = Problem(
        "rows",
        (Var("x", "", 0.0, 1.0, 0.5),),
        (Param("k", "", 2.0),),
        lambda x, p: Terms({"f": x.x}),
        (Repeat("row", (Var("own", "", 0.0, 9.0, 1.0),), {"at": (1.0, 2.0, 4.0)}, row),),
    )
    form = columns(problem)
    point = np.array([0.25, 1.0, 2.0, 3.0])
    batch = problem.batch(point[None])
    assert float(graph(form, point)[form.objective]) == pytest.approx(batch.F[0, 0], rel=1e-14)
