"""Problems in the forms of other tools, read back by those tools."""

import casadi as ca
import numpy as np
import pytest

from gearopt import Budget, Param, Problem, Repeat, SolveError, Terms, Var, solve


def text(x, p):
    w = np.array(x.w)
    spread = np.sqrt(1.0 + np.sum(w**2)) + np.log1p(x.n) * p.c
    limits = {
        "far": np.exp(-x.a) + np.hypot(x.a, w[0]) / spread <= 3.0,
        "near": (np.tanh(w[1]) - np.sin(x.a) ** 3, np.arctan2(x.a, 2.0 + w[0] ** 2)),
    }
    cost = spread / x.a + abs(w[1] - x.n) + np.maximum(w[0], np.minimum(w[1], x.a)) + 2.0 / spread
    return Terms({"cost": cost}, limits, equal={"sum": w[0] + w[1] + np.expm1(x.a) == 2.0})


def posed(**changes):
    variables = (
        Var("n", "", 0, 5, 2, integer=True),
        Var("a", "m", 0.5, np.inf, 1.0),
        Var("w", "", (-2.0, -3.0), 3.0, 0.25, size=2),
    )
    load = Repeat(
        "load", (), {"f": np.array([1.0, 2.5])}, lambda x, p, row: Terms({}, {"held": row.f / x.a})
    )
    return Problem("mixed", variables, (Param("c", "", 0.3),), text, (load,), **changes)


def test_an_nl_file_says_the_same_to_another_reader(tmp_path):
    """By casadi's reader, at random points; whole variables stand last."""
    problem = posed()
    problem.to_nl(tmp_path / "mixed.nl")
    names = (tmp_path / "mixed.col").read_text().split()
    assert names == ["a", "w[1]", "w[2]", "n"]
    read = ca.NlpBuilder()
    read.import_nl(str(tmp_path / "mixed.nl"))
    function = ca.Function("f", read.x, [read.f, *read.g]) if isinstance(read.x, list) else None
    function = function or ca.Function("f", [read.x], [read.f, read.g])
    order = [[name for _, name in problem.columns].index(name) for name in names]
    points = np.random.default_rng(3).uniform(0.5, 3.0, (20, 4))
    points[:, 0] = np.rint(points[:, 0])
    batch = problem.batch(points)
    rows = np.hstack([batch.F, batch.G, batch.H])
    for x, row in zip(points, rows, strict=True):
        found = function(*x[order]) if function.n_in() > 1 else function(x[order])
        assert np.allclose(np.concatenate([np.array(v).ravel() for v in found]), row, 1e-13, 1e-13)
    lower, upper, guess = (ends[order] for ends in problem.bounds())
    assert np.allclose(np.ravel(read.x_init), guess)
    assert np.array_equal(np.ravel(read.x_ub), upper) and np.array_equal(np.ravel(read.x_lb), lower)
    assert np.array_equal(np.ravel(read.g_ub), np.ones(rows.shape[1] - 1))
    assert (tmp_path / "mixed.row").read_text().split()[0] == "far"


def test_what_an_nl_file_has_not_is_named(tmp_path):
    listed = Problem("l", (Var("a", "", 1, 2, 1, values=(1.0, 2.0)),), (), lambda x, p: Terms({}))
    with pytest.raises(SolveError, match="list of values, as a has"):
        listed.to_nl(tmp_path / "l.nl")
    kinked = Problem("s", (Var("a", "", 1, 2, 1),), (), lambda x, p: Terms({"f": np.sign(x.a)}))
    with pytest.raises(SolveError, match="no operation op_sign"):
        kinked.to_nl(tmp_path / "s.nl")


def beam(text, unit="mm"):
    sides = tuple(Var(name, unit if name == "h" else "mm", 1.0, 9.0, 4.0) for name in "whl")
    return Problem("beam", sides, (Param("F", "N", 10.0), Param("allowed", "N/mm2", 100.0)), text)


def bent(x, p):
    stress = 6.0 * p.F * x.l / (x.w * x.h**2)
    limits = {"stress": stress <= p.allowed, "slender": x.l / x.h / 20.0}
    return Terms({"volume": x.w * x.h * x.l}, limits, report={"stress": stress})


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        (bent, "cm", r"limits stress mixes units of one dimension: it is 1[\d.]+ with them"),
        (lambda x, p: Terms({"f": x.w + x.h * x.l}), "mm", "in line .*DimensionalityError"),
        (lambda x, p: Terms({"f": x.w}, {"g": x.l <= p.F}), "mm", "limits g compares mm with N"),
        (lambda x, p: Terms({"f": x.w}, {"g": x.w * x.h / x.l}), "mm", "g has the unit mm"),
        (lambda x, p: Terms({"f": np.exp(x.w)}), "mm", "DimensionalityError"),
        (bent, "furlongs per", "h: pint does not know"),
    ],
)
def test_wrong_units_are_told_with_their_line_or_row(text, unit, words):
    with pytest.raises(SolveError, match=words):
        beam(text, unit).check_units()


def test_units_follow_from_those_of_the_variables():
    units = beam(bent).check_units()
    assert units == {"volume": "mm ** 3", "stress": "N / mm ** 2"}
    assert solve(beam(bent)).feasible  # with comparisons, as before


@pytest.mark.slow
def test_problems_go_to_pymoo_and_back():
    from pymoo.problems import get_problem

    theirs = get_problem("bnh")
    problem = Problem.from_pymoo(theirs)
    points = np.random.default_rng(1).uniform(theirs.xl, theirs.xu, (30, 2))
    batch = problem.batch(points)
    F, G = theirs.evaluate(points)
    assert np.allclose(batch.F, F) and np.allclose(batch.G - 1.0, G)
    again = problem.to_pymoo()
    assert np.allclose(again.evaluate(points)[0], F) and (again.xu == theirs.xu).all()
    one = Problem.from_pymoo(get_problem("g6"))
    assert solve(one, method="nsga2", budget=Budget(evaluations=2000)).value < -6000.0
    with pytest.raises(SolveError, match="a has none"):
        posed().to_pymoo()
