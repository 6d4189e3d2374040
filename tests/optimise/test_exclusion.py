"""Limits that exclude each other and the numbers to change, of texts that are not convex."""

import itertools
import random

import numpy as np
import pytest

from gearopt import Param, Problem, Repeat, Terms, Var, explain, solve
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.exclusion import exclusion
from gearopt.optimise.explaining.handles import with_limits_named
from gearopt.optimise.result import Budget

WINDOW = 14  # whole numbers beside its bounds to which a variable goes where these are dropped


def rows_and_box(seed):
    """Rows c.x + q x_i x_j <= b of three whole numbers at most, and their bounds."""
    draw = random.Random(seed)
    n = draw.choice((1, 2, 2, 3))
    lows = [draw.randint(-3, 3) for _ in range(n)]
    box = [(a, a + draw.randint(0, 6)) for a in lows]
    rows = [
        (
            [draw.choice((-2, -1, 0, 1, 2)) for _ in range(n)],
            draw.choice((0, 0, 1)),
            draw.randrange(n),
            draw.randrange(n),
            draw.uniform(-12, 6),
        )
        for _ in range(draw.randint(2, 5))
    ]
    return rows, box


def excess(row, x):
    slopes, square, i, j, most = row
    return sum(a * v for a, v in zip(slopes, x, strict=True)) + square * x[i] * x[j] - most


def there_is(rows, box, free=frozenset()):
    """Whether some point meets the rows, the ends in `free` dropped, by trying all; signs stay."""
    sides = [
        range(
            (min(a, 1) if a > 0 else a - WINDOW) if (k, 0) in free else a,
            b + 1 + WINDOW * ((k, 1) in free),
        )
        for k, (a, b) in enumerate(box)
    ]
    return any(all(excess(r, x) <= 0.0 for r in rows) for x in itertools.product(*sides))


@pytest.mark.parametrize("seed", (3, 4, 5, 8, 10, 15))
def test_a_conflict_is_one_by_trying_all_points_and_every_row_is_needed(seed):
    rows, box = rows_and_box(seed)
    assert not there_is(rows, box)
    names = [f"v{k}" for k in range(len(box))]

    def evaluate(x, p):
        point = [getattr(x, name) for name in names]
        return Terms(
            {"first": point[0]}, {f"r{k}": 1 + excess(r, point) / 10 for k, r in enumerate(rows)}
        )

    box_of = zip(names, box, strict=True)
    variables = tuple(Var(name, "", a, b, a, integer=True) for name, (a, b) in box_of)
    result = solve(Problem("whole", variables, (), evaluate))
    assert result.status == "infeasible" and "unsure" not in result.proof
    conflict = result.proof["conflict"]
    assert result.message.endswith(", ".join(conflict))
    kept = {k: r for k, r in enumerate(rows) if f"r{k}" in conflict}
    ends = {(k, e): f"v{k} {w}" for k in range(len(box)) for e, w in enumerate(("lower", "upper"))}
    free = frozenset(end for end, name in ends.items() if name not in conflict)
    assert not there_is(list(kept.values()), box, free)
    for k in kept:
        assert there_is([r for other, r in kept.items() if other != k], box)


@pytest.mark.slow
def test_numbers_that_limits_are_divided_by_are_what_is_changed():
    """x y <= A, 2/(x^2 + y) <= 1 and |x - y| small: A from 0.2 to 0.62508, as x = y = 1 at least.

    With y = x - d, d^2 = 1/2 and x^2 + y = 2: x = 1.2247 - ..., solved by hand to 5 digits.
    """

    def evaluate(x, p):
        limits = {
            "product": x.x * x.y / p.A,
            "sum": p.r / (x.x**2 + x.y),
            "near": (1 + (x.x - x.y) ** 2) / 1.5,
        }
        return Terms({"sum of both": x.x + x.y}, limits)

    two = (Var("x", "", 0.1, 10.0, 1.0), Var("y", "", 0.1, 10.0, 1.0))
    problem = Problem("two", two, (Param("A", "", 0.2), Param("r", "", 2.0)), evaluate)
    d = np.sqrt(0.5)
    x = (-1 + np.sqrt(9 + 4 * d)) / 2  # x^2 + x - d = 2
    explained = explain(problem)
    assert explained.conflict == ("product", "sum", "near") and explained.any_resolves
    changes = {r.what: r.changes[0] for r in explained.remedies}
    assert changes["product"].key == "A" and changes["sum"].key == "sum"
    assert float(changes["product"].write) == pytest.approx(x * (x - d), rel=1e-4)
    for remedy in explained.remedies:
        assert remedy.verified == {"with": "optimal", "with_less": "infeasible"}


def test_a_number_of_several_limits_or_of_the_objective_is_data_unless_it_divides_alone():
    def evaluate(x, p):
        limits = {"a": x.x / p.both, "b": x.x / p.both, "c": x.x / p.cost, "d": p.up * x.x}
        return Terms({"f": p.cost * x.x}, limits | {"e": x.x / (p.one * p.two)})

    names = "both", "cost", "up", "one", "two"
    numbers = tuple(Param(name, "", 2.0) for name in names)
    problem = with_limits_named(Problem("roles", (Var("x", "", 0.1, 9.0, 1.0),), numbers, evaluate))
    roles = {q.name: q.role for q in problem.parameters}
    assert {name for name, role in roles.items() if role == ("limit",)} == {"both"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "numbers"),
    [
        ("l", ()),
        pytest.param("E", (Param("F", "N", 1.0), Param("E", "J", 400.0)), marks=pytest.mark.slow),
    ],
)
def test_comparisons_are_answered_by_the_number_they_compare_with(key, numbers):
    """a b >= 400 of at most 10 each: 100 instead, of a literal as of a parameter."""
    two = tuple(Var(name, "mm", 1.0, 10.0, 3.0) for name in "ab")

    def evaluate(x, p):
        force, least = (p.F, p.E) if numbers else (1, 400)
        return Terms({"area": x.a * x.b}, {"l": x.a * x.b * force >= least})

    remedies = explain(Problem("box", two, numbers, evaluate)).remedies
    changes = {r.changes[0].key: r.changes[0] for r in remedies}
    assert changes[key].was == "400"
    assert float(changes[key].write) == pytest.approx(100.0, 1e-5)


@pytest.mark.slow
def test_whole_numbers_without_an_exact_method_are_explained():
    """7 z_1 <= z_2 of 10 to 40 teeth: the pinion needs 5 teeth."""

    def evaluate(x, p):
        return Terms({"sum": x.a + x.b}, {"ratio": 7 * x.a / x.b, "rim": x.b / 80})

    teeth = tuple(Var(n, "", 10, 40, 17, integer=True) for n in "ab")
    explained = explain(Problem("teeth", teeth, (), evaluate))
    assert explained.conflict == ("ratio", "a lower", "b upper")
    written = {r.what: r.changes[0].write for r in explained.remedies}
    assert written["a lower"] == "5" and written["b upper"] == "70"
    assert 1.75 <= float(written["ratio"]) < 1.75 * 1.001


def test_rows_of_a_repeat_are_named_as_one_limit():
    repeat = Repeat(
        "load", (), {"t": np.array([1.0, 2.0])}, lambda x, p, row: Terms({}, {"sine": row.t / x.x})
    )
    text = Problem(
        "r", (Var("x", "", 0.1, 9.0, 1.0),), (), lambda x, p: Terms({"f": x.x}, {"low": x.x / 1.5}),
        (repeat,),
    )  # fmt: skip
    assert exclusion(text, Clock(Budget(10.0))).names == ("low", "load.sine")
