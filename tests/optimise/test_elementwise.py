"""Which texts are proven elementwise, and the points that they are tried at."""

import numpy as np
import pytest

from gearopt.errors import SolveError
from gearopt.optimise.evaluation import elementwise, sample
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Param, Repeat, Terms, Var

INF = np.inf


def pair(text):
    both = Var("a", "", 0.5, 4.0, 1.5), Var("b", "", 0.5, 4.0, 2.5)
    return Problem("pair", both, (Param("k", "", 2.0),), text)


ELEMENTS = {
    "two results": lambda a, b: np.modf(a)[0] + np.divmod(a, b)[1],
    "where": lambda a, b: np.where(a > 1.0, a, np.float64(2.0)),
    "select": lambda a, b: np.select([a > 1.0, b > 2.0], [b, 1], a),
    "select, default": lambda a, b: np.select([a > 1.0], [b], default=a),
    "clip": lambda a, b: np.clip(a, 1, b) + np.round(b),
    "like": lambda a, b: a + np.zeros_like(a) + np.ones_like(b) + np.full_like(a, 3.0),
    "no dimension": lambda a, b: a * np.array(3.0) + np.bool_(True) * b,
    "a constant": lambda a, b: 3,
}
OTHERS = {
    "reduce": lambda a, b: np.add.reduce([a, b]),
    "outer": lambda a, b: np.multiply.outer(a, b),
    "an option": lambda a, b: np.add(a, b, where=True),
    "array": lambda a, b: np.sum(np.array([a, b])),
    "times array": lambda a, b: np.sum(a * np.array([1.0, 2.0])),
    "where of arrays": lambda a, b: np.sum(np.where(a > 1.0, np.array([1.0, 2.0]), b)),
    "default of arrays": lambda a, b: np.sum(np.select([a > 1.0], [b], default=np.ones(2))),
    "select of arrays": lambda a, b: np.sum(np.select([a > 1.0], [np.ones(1)], b)),
    "function": lambda a, b: np.ravel(a)[0] + np.sum(b),
    "if": lambda a, b: a if a > 1.0 else b,
    "and": lambda a, b: a * float(bool(a > 1.0 and b > 1.0)),
    "string": lambda a, b: a + len(str(type(a))) * 0.0 + (0.0 if isinstance(a, float) else 1.0),
}


@pytest.mark.parametrize("name", [*ELEMENTS, *OTHERS])
def test_what_is_proven_elementwise(name):
    text = (ELEMENTS | OTHERS)[name]
    problem = pair(lambda x, p: Terms({"f": text(x.a, x.b)}, {"l": x.a / 9.0}))
    assert elementwise(problem, None) is (name in ELEMENTS)
    points = np.random.default_rng(1).uniform(0.5, 4.0, (5, 2))
    alone = [problem.batch(point[None]).F[0, 0] for point in points]
    assert problem.batch(points).F[:, 0] == pytest.approx(alone, rel=1e-14)


@pytest.mark.parametrize(("off", "proven"), [(0.5e-9, True), (2e-9, False)])
@pytest.mark.parametrize("section", ["minimise", "limits", "report"])
def test_a_text_that_tells_floats_from_arrays_betrays_itself(off, proven, section):
    def text(x, p):
        value = x.a + x.b * (1.0 if isinstance(x.a, float) else 1.0 + off * (x.a + x.b) / x.b)
        sections = {"minimise": {"f": x.a}, "limits": {"l": x.b}, "report": {"r": x.a}}
        sections[section] = {"v": value}
        return Terms(**sections)

    assert elementwise(pair(text), None) is proven


def test_rows_of_a_repeat_are_tried_too(caplog):
    """Each text for itself, and told once."""
    for strange in (False, True):

        def own(x, p, row, strange=strange):
            float_only = strange and not isinstance(row.d, float)
            return Terms({"g": x.y * row.d + float_only * x.x})

        y = Var("y", "", 0.0, 9.0, (1.0, 2.0), size=2)
        repeat = Repeat(
            "rows",
            (y,),
            {"d": np.array([1.0, 4.0])},
            lambda x, p, r, o=own: o(type("N", (), {"x": x.x, "y": x.y[0] + x.y[1]}), p, r),
        )
        problem = Problem(
            "two", (Var("x", "", 0.0, 9.0, 3.0),), (), lambda x, p: Terms({}), (repeat,)
        )
        assert elementwise(problem, None)
        assert elementwise(problem, repeat) is not strange


def test_points_to_try_lie_in_the_part_of_the_box_that_matters():
    """The guess first; each between its bounds, of a positive guess within a factor of two."""
    ends = {
        "a": (-INF, INF, 0.0, -0.5, 0.5),
        "b": (-INF, INF, -10.0, -15.0, -5.0),
        "c": (1.0, 1e6, 4.0, 2.0, 8.0),
        "d": (3.0, 5.0, 4.0, 3.0, 5.0),
        "e": (0.0, INF, 4.0, 2.0, 6.0),
        "f": (-INF, 9.0, 4.0, 2.0, 8.0),
        "g": (-9.0, 9.0, -2.0, -9.0, 9.0),
        "h": (-1.0, 1.0, 0.0, -1.0, 1.0),
        "i": (-INF, INF, 0.5, 0.25, 1.0),
    }
    free = tuple(Var(n, "", low, high, guess) for n, (low, high, guess, *_) in ends.items())
    n = Var("n", "", 0.5, 4.5, 2, integer=True)
    s = Var("s", "", 1.0, 8.0, 4.0, values=(8.0, 1.0, 4.0, 5.0))
    problem = Problem("many", (*free, n, s), (), lambda x, p: Terms({"f": x.a}))
    points = sample(problem, 400)
    assert points.shape == (400, 11) and (points == sample(problem, 400)).all()
    assert points[0].tolist() == [v[2] for v in ends.values()] + [2.0, 4.0]
    for column, (*_, low, high) in zip(points.T, ends.values(), strict=False):
        assert low <= column.min() <= low + 0.03 * (high - low)
        assert high - 0.03 * (high - low) <= column.max() <= high
    assert set(points[:, 9]) == {1.0, 2.0, 3.0, 4.0} and set(points[:, 10]) == {1.0, 4.0, 5.0, 8.0}


def test_names_must_be_the_same_at_every_point():
    def text(x, p):
        return Terms({"f": x.a}, {"low": x.b} if float(x.a) < 2.0 else {"high": x.b})

    problem = pair(text)
    with pytest.raises(SolveError, match="text of pair returns other names at other points"):
        problem.batch(np.array([[1.0, 1.0], [3.0, 1.0]]))
    far = pair(lambda x, p: Terms({"f": 1.0 / (float(x.a) - 2.0)}, {"l": x.b}))
    found = far.batch(np.array([[2.0, 1.0], [3.0, 1.0]]))
    assert np.isnan(found.F[0, 0]) and found.F[1, 0] == 1.0
    wrong = pair(lambda x, p: Terms({"f": float(x.a) + (None if x.a > 2.0 else 1.0)}))
    assert np.isnan(wrong.batch(np.array([[1.0, 1.0], [3.0, 1.0]])).F).tolist() == [[False], [True]]
