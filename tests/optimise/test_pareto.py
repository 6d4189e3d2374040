"""Fronts of problems of one's own, against fronts that are known in closed form."""

import math

import cvxpy as cp
import numpy as np
import pytest
from campaigns import few

import gearopt
from gearopt import Budget, Conic, Front, Param, Problem, SolveError, Terms, Var
from gearopt.optimise import polish
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto import enumerated, evolution
from gearopt.optimise.pareto.corners import corners, useful, weighed
from gearopt.optimise.pareto.found import Found, Point
from gearopt.optimise.pareto.measures import (
    hypervolume,
    igd,
    knee,
    neighbours,
    picks,
    reference,
    unbeaten,
)


def discs():
    """Squared distances from (0, 0) and (2, 1): on the front sqrt(a) + sqrt(b) = sqrt(5)."""

    def evaluate(x, p):
        return Terms({"a": x.x**2 + x.y**2, "b": (x.x - 2) ** 2 + (x.y - 1) ** 2})

    return Problem("discs", tuple(Var(n, "", -5.0, 5.0, 1.0) for n in "xy"), (), evaluate)


def cone():
    """Cost 1/t1 + 4/t2 against error t1 + t2: on the front cost = (1 + 2)^2/error."""

    def evaluate(x, p):
        cost = cp.sum(cp.multiply(p.a, cp.inv_pos(x.t)))
        return Terms({"cost": cost, "error": cp.sum(x.t)}, {"room": x.t[0] * p.per.most})

    t = Var("t", "", 1e-3, 10.0, 1.0, 2)
    return Conic(
        "tolerances", (t,), (Param("a", "", (1.0, 4.0), 2), Param("most", "", 8.0)), evaluate
    )


def product():
    """Minimise x and 1/x, x in [1, 4]: a geometric program whose front is a b = 1."""

    def evaluate(x, p):
        return Terms({"a": x.x, "b": 1.0 / x.x})

    return Problem("product", (Var("x", "", 1.0, 4.0, 2.0, log=True),), (), evaluate)


def values(front):
    return np.array([p.values for p in front.points])


def shares(front, exact):
    """Return the share of a front's hypervolume that is found; exact (N, 2): its points."""
    corner = reference(exact)
    return hypervolume(values(front), corner) / hypervolume(exact, corner)


@pytest.mark.slow
def test_epsilon_constraints_reach_the_known_front_of_a_plain_problem():
    """So spread that little hypervolume is missing."""
    front = gearopt.pareto(discs(), points=11)
    assert len(front.points) == 11
    assert np.sqrt(values(front)).sum(axis=1) == pytest.approx(math.sqrt(5.0), abs=1e-5)
    assert values(front)[0] == pytest.approx([0.0, 5.0], abs=1e-5)
    # not a convex form of ours: no tangents, but boxes prove each step
    assert front.status == "proven" and front.error is None and 0.02 < front.epsilon < 0.1
    t = np.linspace(0.0, 1.0, 20_001)
    exact = 5.0 * np.column_stack([t**2, (1.0 - t) ** 2])
    best = []  # of 11 points with even roots of the first, even values, and between
    for power in (1.0, 0.5, 0.75):
        u = np.linspace(0.0, 1.0, 11) ** power
        points = 5.0 * np.column_stack([u**2, (1.0 - u) ** 2])
        best.append(hypervolume(points, reference(exact)))
    assert shares(front, exact) > max(best) / hypervolume(exact, reference(exact)) - 1e-3


def test_a_geometric_program_is_proven_point_by_point_with_the_error_between():
    front = gearopt.pareto(product(), points=9)
    assert front.status == "proven" and all(p.proven for p in front.points)
    assert values(front).prod(axis=1) == pytest.approx(1.0, abs=1e-7)
    # log a + log b = 0 is a straight line: tangents and chords agree
    assert front.error == pytest.approx(0.0, abs=1e-5)
    middle = front.points[4]
    assert middle.slopes[0] == pytest.approx(-middle.values[0] / middle.values[1], rel=1e-5)


def test_the_front_of_a_conic_problem_is_proven_and_its_error_holds():
    front = gearopt.pareto(cone(), points=7, most={"error": 12.0, "cost": 9.0})
    found = values(front)
    inside = found[:, 1] < 12.0 - 1e-6
    assert front.status == "proven"
    assert found[inside].prod(axis=1) == pytest.approx(9.0, rel=1e-6)
    # the true front lies within the stated error of the line through the points
    widths = np.ptp(found, axis=0)
    worst = 0.0
    for (a0, b0), (a1, b1) in zip(found, found[1:], strict=False):
        for b in np.linspace(b0, b1, 20):
            chord = a0 + (a1 - a0) * (b - b0) / (b1 - b0)
            gap = (chord - 9.0 / b) / widths[0]
            slope = (a1 - a0) / (b1 - b0) * widths[1] / widths[0]
            worst = max(worst, gap / math.hypot(1.0, slope))
    assert 0.2 * front.error < worst <= front.error * (1 + 1e-6) + 1e-7


@pytest.mark.parametrize("method", few(["nsga2", "annealing", "hybrid"], 2))
def test_samplers_come_near_the_known_front(method):
    points, most = (8, 1500) if method == "hybrid" else (None, 2000)
    budget = Budget(evaluations=most)
    front = gearopt.pareto(discs(), method=method, points=points, budget=budget, seed=1)
    excess = np.sqrt(values(front)).sum(axis=1) - math.sqrt(5.0)
    assert front.status == "not proven" and len(front.points) >= 5
    if method == "nsga2":
        assert all(step.evaluations % 100 == 0 for step in front.growth)  # of its population
    assert -1e-6 <= excess.min() and np.median(excess) < 0.02
    assert front.evaluations <= most + 100 and front.growth[-1].hypervolume == pytest.approx(
        front.hypervolume
    )


def test_evolution_ends_with_its_watcher():
    front = gearopt.pareto(discs(), method="nsga2", points=8, watch=lambda event: False)
    assert front.status == "limit" and front.evaluations == 8


def test_points_of_evolution_are_improved_at_their_other_objectives(monkeypatch):
    x = np.array([1.5, 0.2])
    first = Point(x, discs().batch(x[None]).F[0])
    monkeypatch.setattr(evolution, "front", lambda *_: Found((first,), evaluations=90))
    (best,) = gearopt.pareto(discs(), method="hybrid", points=4).points
    assert best.values[1] == pytest.approx(first.values[1], rel=1e-6)
    assert best.values[0] == pytest.approx((math.sqrt(5.0) - first.values[1] ** 0.5) ** 2, rel=1e-6)


def test_a_limit_on_an_objective_cuts_the_front_and_an_impossible_one_is_proven():
    front = gearopt.pareto(product(), points=5, most={"a": 2.0})
    assert values(front)[:, 0].max() == pytest.approx(2.0, rel=1e-6)
    nothing = gearopt.pareto(product(), points=5, most={"a": 2.0, "b": 0.4})
    assert nothing.status == "infeasible" and not nothing.points
    assert nothing.message == "no design meets these together: most_b, most_a"
    assert nothing.impossible[0].proven and nothing.hypervolume is None and nothing.corner == ()


@pytest.mark.slow
def test_three_objectives_by_a_grid_lie_on_the_known_surface():
    """Slices of it spend few points twice."""

    def evaluate(x, p):
        return Terms({"a": 1.0 / (x.x * x.y), "b": x.x, "c": x.y})

    grid = tuple(Var(n, "", 0.5, 2.0, 1.0, log=True) for n in "xy")
    front = gearopt.pareto(Problem("three", grid, (), evaluate), points=20)
    assert values(front).prod(axis=1) == pytest.approx(1.0, abs=1e-6)
    assert np.unique(values(front)[:, 2].round(5)) == pytest.approx([0.5, 1.0, 1.5, 2.0], abs=1e-4)
    assert front.status == "proven" and len(front.points) >= 17 and not front.impossible
    assert all(p.slopes is None or len(p.slopes) == 2 for p in front.points)


def test_a_front_comes_back_from_its_json():
    front = gearopt.pareto(product(), points=2)
    again = Front.from_json(front.to_json())
    assert again.to_json() == front.to_json() and again.points == front.points
    with pytest.raises(ValueError, match="not a Pareto front"):
        Front.from_dict({})


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"objectives": "a,c"}, "no objective 'c'"),
        ({"objectives": ["a"]}, "two or three objectives"),
        ({"method": "nsga"}, "methods: epsilon, nsga2"),
        ({"most": {"c": 1.0}}, "none of the objectives"),
    ],
)
def test_what_does_not_fit_is_said_in_one_sentence(options, words):
    with pytest.raises(SolveError, match=words):
        gearopt.pareto(product(), **options)
    with pytest.raises(ValueError, match="numbers by name"):
        gearopt.pareto(product(), most=[1.0])


def test_unbeaten_points_equal_the_definition_and_ties_come_once():
    rng = np.random.default_rng(3)
    points = rng.integers(1, 9, (300, 3)).astype(float)
    kept = unbeaten(points)
    front = {tuple(points[k]) for k in kept}
    assert len(front) == len(kept)
    for one in points:
        beaten = ((points <= one).all(axis=1) & (points < one).any(axis=1)).any()
        assert (tuple(one) in front) == (not beaten)
    assert len(unbeaten(points, equal=True)) >= len(kept)


@pytest.mark.parametrize("count", [2, 3])
def test_corners_are_what_points_leave_open(count):
    rng = np.random.default_rng(count)
    points = rng.random((40, count))
    found = corners(points, np.ones((1, count)))
    assert (found[:, None] <= found).all(axis=2).sum() == len(found)  # none is below another
    for one in rng.random((500, count)):
        free = not (points <= one).all(axis=1).any()
        assert (one < found).all(axis=1).any() == free
    some = rng.random((200, count))
    weights = np.ones((1, count))
    use = useful(weighed(some, weights), weighed(found, weights))
    below = (some[:, None, :] <= found[None]).all(axis=2).any(axis=1)
    assert (use == below).all()  # exact sums exclude nothing more
    heavy = np.column_stack([some, np.full(len(some), 10.0)])
    assert not useful(heavy, weighed(found, weights)).any()


def test_hypervolume_and_distance_of_a_staircase():
    front = np.array([[0.0, 2.0], [1.0, 1.0], [2.0, 0.0]])
    corner = reference(front)
    assert corner == pytest.approx([2.1, 2.1])
    assert hypervolume(front, corner) == pytest.approx(2.1 * 0.1 + 1.1 * 1.0 + 0.1 * 1.0)
    assert igd(front, front) == 0.0 and igd(front + 0.2, front) == pytest.approx(
        math.hypot(0.1, 0.1)
    )


def test_picks_are_the_knee_the_compromise_and_the_best_of_weights():
    line = np.array([[0.0, 1.0], [0.1, 0.2], [0.5, 0.1], [1.0, 0.0]])
    assert knee(line) == 1 and knee(line[[0, 3]]) is None
    found = picks(line, ["a", "b"], {"a": 0.0, "b": 1.0})
    assert [(p.place, p.rule) for p in found] == [(3, "weights"), (1, "knee"), (1, "compromise")]
    assert neighbours(line, 1) == [0, 2]


def binh_and_korn():
    """Binh and Korn (1997): minimise 4 x^2 + 4 y^2 and (x - 5)^2 + (y - 5)^2.

    x in [0, 5], y in [0, 3], (x - 5)^2 + y^2 <= 25, (x - 8)^2 + (y + 3)^2 >= 7.7.
    """

    def evaluate(x, p):
        return Terms(
            {"f": 4.0 * x.x**2 + 4.0 * x.y**2, "g": (x.x - 5.0) ** 2 + (x.y - 5.0) ** 2},
            {
                "disc": ((x.x - 5.0) ** 2 + x.y**2) / 25.0,
                "hole": 1.0 + (7.7 - (x.x - 8.0) ** 2 - (x.y + 3.0) ** 2) / 7.7,
            },
        )

    ends = (Var("x", "", 0.0, 5.0, 1.0), Var("y", "", 0.0, 3.0, 1.0))
    return Problem("binh_and_korn", ends, (), evaluate)


def known_front(f):
    """The front of Binh and Korn's problem: x = y up to 3, then y = 3 and x up to 5."""
    x = np.sqrt(f / 8.0)
    bent = np.where(x <= 3.0, x, np.sqrt(np.maximum(f / 4.0 - 9.0, 0.0)))
    return (bent - 5.0) ** 2 + (np.minimum(x, 3.0) - 5.0) ** 2


def test_the_known_front_of_binh_and_korn_is_found():
    front = gearopt.pareto(binh_and_korn(), points=12)
    found = values(front)
    assert len(found) == 12
    assert found[:, 1] == pytest.approx(known_front(found[:, 0]), abs=1e-4)
    assert found[0] == pytest.approx([0.0, 50.0], abs=1e-4)
    # the end is flat: an allowance of 1e-7 in g moves f by 2e-4
    assert found[-1] == pytest.approx([136.0, 4.0], rel=3e-4)
    f = np.linspace(0.0, 136.0, 5001)
    assert shares(front, np.column_stack([f, known_front(f)])) > 0.96


def catalogue(cost, error):
    """One of several designs is to be chosen."""

    def evaluate(x, p):
        goals = {"cost": np.array(cost) @ x.y, "error": np.array(error) @ x.y}
        return Terms(goals, equal={"one": cp.sum(x.y)})

    y = Var("y", "", 0.0, 1.0, 0.0, size=len(cost), integer=True)
    return Conic("catalogue", (y,), (), evaluate)


def test_whole_numbers_of_a_huge_range_are_not_listed():
    n = Var("n", "", 0, 1e20, 1, integer=True)
    problem = Problem("huge", (n,), (), lambda x, p: Terms({"f": x.n, "g": (x.n - 2) ** 2}))
    assert enumerated.front(problem, ("f", "g"), {}, Clock(Budget(seconds=1.0))) is None
    there, beside = np.array([9e14]), [9e14 - 1, 9e14 + 1]
    assert [x[0] for x in polish._beside(problem, there)] == beside  # and at once


def test_a_limit_that_is_infinite_is_not_met():
    n = Var("n", "", -2, 3, 1, integer=True)
    problem = Problem(
        "pole", (n,), (), lambda x, p: Terms({"f": x.n, "g": (x.n - 2) ** 2}, {"a": 1 - 1 / x.n})
    )
    front = gearopt.pareto(problem)
    assert front.status == "complete" and [p.values for p in front.points] == [(1, 1), (2, 0)]
    assert front.proof["method"] == "enumeration" and front.evaluations == 6
    empty = gearopt.pareto(problem, most={"f": 0.5})
    assert empty.status == "infeasible" and empty.message == "no design meets all limits"
    one = Problem("pole", (n,), (), lambda x, p: Terms({"f": x.n}, {"a": 1 - 1 / x.n}))
    assert gearopt.solve(one, method="nsga2", budget=Budget(evaluations=500)).value == 1.0


@pytest.mark.parametrize(
    ("cost", "error", "unbeaten_ones"),
    [
        ((0, 1, 2, 9), (1e4, 3e3, 2.5e3, 0), (0, 1, 2, 3)),
        pytest.param(  # ties and beaten ones
            (2, 0, 1, 1, 3, 2), (1, 4, 3, 4, 1, 3), (1, 2, 0), marks=pytest.mark.slow
        ),
    ],
)
def test_the_front_of_a_catalogue_is_complete(cost, error, unbeaten_ones):
    """Below a tenth of the largest error only (9, 0) is left: the rest of the gap is not empty."""
    front = gearopt.pareto(catalogue(cost, error))
    assert front.status == "complete" and front.error is None and not front.message
    expected = [(cost[k], error[k]) for k in unbeaten_ones]
    assert [p.values for p in front.points] == [
        pytest.approx(v, rel=1e-7, abs=1e-6) for v in expected
    ]
    assert "may be missing" not in repr(front)


@pytest.mark.slow
def test_differences_within_feasibility_are_not_called_complete(monkeypatch):
    """A limit of 1e8 may be exceeded by 1: of costs that near none is proven to be the least."""
    monkeypatch.setattr(enumerated, "MAX_POINTS", 0)
    front = gearopt.pareto(catalogue((1e8, 1e8 + 1, 1e8 + 2, 1e8 + 9), (10, 3, 2.5, 0)))
    assert front.status == "proven" and front.epsilon > 0.1


@pytest.mark.slow
def test_small_differences_of_a_large_objective_lose_no_design(monkeypatch):
    """An excess of 1e-7 of a million is a tenth of all differences: ends are held closer."""
    monkeypatch.setattr(enumerated, "MAX_POINTS", 0)
    cost, error = (1e6, 1e6 + 0.05, 1e6 + 1.0), (10, 1, 0)
    front = gearopt.pareto(catalogue(cost, error))
    assert front.status == "complete"
    assert np.allclose([p.values for p in front.points], list(zip(cost, error, strict=True)))


def zdt3(x, p):
    """Zitzler, Deb and Thiele (2000), problem 3, of 3 variables: a front of five pieces."""
    g = 1.0 + 9.0 * (x.b + x.c) / 2.0
    bent = 1.0 - np.sqrt(x.a / g) - x.a / g * np.sin(10.0 * np.pi * x.a)
    return Terms({"f": x.a, "g": g * bent})


def two_pieces(x, p):
    """The front is a from 0.1 to 0.4 and from 0.6 to 0.9, with b = 0."""
    first = 1.0 + 2.0 * (x.a - 0.1) * (x.a - 0.9) / 0.18
    second = 1.0 - 20.0 * (x.a - 0.4) * (x.a - 0.6) / 4.8
    goals = {"f": 100.0 * (x.a**2 + x.b**2), "g": (x.a - 1.0) ** 2 + x.b**2}
    return Terms(goals, {"first": first, "second": second})


PIECES = {  # text, bounds, guess, pieces of the first objective
    "zdt3": (
        zdt3,
        (0.0, 1.0, 0.5),
        "abc",
        ((0.0, 0.0831), (0.1822, 0.2578), (0.4093, 0.4539), (0.6183, 0.6526), (0.8233, 0.8519)),
    ),
    "two_pieces": (two_pieces, (-2.0, 2.0, 0.0), "ab", ((1.0, 16.0), (36.0, 81.0))),
}


@pytest.mark.parametrize("name", ["two_pieces", pytest.param("zdt3", marks=pytest.mark.slow)])
def test_all_pieces_of_a_front_are_found_whatever_the_guess(name):
    text, ends, variables, pieces = PIECES[name]
    own = Problem(name, tuple(Var(n, "", *ends) for n in variables), (), text)
    front = gearopt.pareto(own, points=20 if name == "zdt3" else 10)
    first = values(front)[:, 0]
    there = [(first >= a - 1e-3) & (first <= b * 1.001 + 1e-3) for a, b in pieces]
    assert np.any(there, axis=0).all() and all(one.sum() >= 2 for one in there)
    assert front.status == "proven" and front.epsilon < 0.1 and not front.message
    assert "one of these is worse by at most" in repr(front)


def whole_text(seed, count):
    """Two objectives of whole numbers from 0 to 5 with many local minima, and a limit."""
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 3, count))

    def text(x, p):
        v = [getattr(x, f"x{k}") for k in range(count)]
        goals = [
            sum(
                abs(c * (xi - 2.5)) + np.sin(3.0 * d * xi)
                for c, d, xi in zip(a[k], b[k], v, strict=True)
            )
            for k in range(2)
        ]
        return Terms(dict(zip("fg", goals, strict=True)), {"room": 1.0 + sum(b[2] * v) / 5.0})

    return Problem(
        "w", tuple(Var(f"x{k}", "", 0, 5, 0, integer=True) for k in range(count)), (), text
    )


@pytest.mark.parametrize("seed", few(range(24), 4))
def test_fronts_of_whole_numbers_equal_brute_force(seed, monkeypatch):
    """By all points, and by steps, whose bounds hold to 1e-6 of a value, not of the range."""
    problem = whole_text(seed, 1 + seed % 3)
    grid = np.stack(np.meshgrid(*[np.arange(6.0)] * len(problem.columns)), -1)
    batch = problem.batch(grid.reshape(-1, len(problem.columns)))
    every = batch.F[(batch.G <= 1.0).all(axis=1)]
    wanted = every[unbeaten(every)]
    for most in (1e6, 0):
        monkeypatch.setattr(enumerated, "MAX_POINTS", most)
        front = gearopt.pareto(problem)
        assert values(front) == pytest.approx(wanted, abs=1e-9)
        if front.status != "complete":
            small = np.abs(wanted).max(axis=0) / np.ptp(wanted, axis=0)
            assert most == 0 and front.status == "proven" and front.epsilon <= 2e-6 * small.max()


def srn(x, p):
    """Srinivas and Deb (1994): on the front a = -2.5, b from 2.5 to 14.79."""
    goals = {
        "f": 2.0 + (x.a - 2.0) ** 2 + (x.b - 1.0) ** 2,
        "g of b (m)": 9.0 * x.a - (x.b - 1.0) ** 2,
    }
    return Terms(goals, {"disc": (x.a**2 + x.b**2) / 225.0, "line": 2.0 + (x.a - 3.0 * x.b) / 10.0})


def test_no_sampled_design_is_better_than_a_proven_front_says():
    """Nor is any below a proven point. Srinivas and Deb's problem: its guess is no design.

    One of its objectives has a name of several words.
    """
    problem = Problem("srn", tuple(Var(n, "", -20.0, 20.0, 0.0) for n in "ab"), (), srn)
    front = gearopt.pareto(problem, points=9)
    batch = problem.batch(np.random.default_rng(0).uniform(-20.0, 20.0, (100_000, 2)))
    sampled = batch.F[(batch.G <= 1.0).all(axis=1)]
    found = values(front)
    worse = (found[:, None] - sampled[unbeaten(sampled)][None]) / np.ptp(found, axis=0)
    assert front.status == "proven" and worse.max(axis=2).min(axis=0).max() <= front.epsilon < 0.15
    assert found[0, 0] == pytest.approx(10.1, abs=1e-3) and found[-1, 1] < -212.6
    for f, g in found:
        assert not ((sampled[:, 0] < f - 1e-5 * f) & (sampled[:, 1] <= g)).any()


@pytest.mark.slow
@pytest.mark.parametrize("method", ["nsga2", "hybrid"])
def test_samplers_come_near_the_front_of_binh_and_korn(method):
    f = np.linspace(0.0, 136.0, 5001)
    exact = np.column_stack([f, known_front(f)])
    budget, points = Budget(evaluations=6000), 40 if method == "hybrid" else None
    found = gearopt.pareto(binh_and_korn(), method=method, points=points, budget=budget)
    assert (values(found)[:, 1] >= known_front(values(found)[:, 0]) - 1e-4).all()
    assert shares(found, exact) > 0.97 and igd(values(found), exact) < 0.02
