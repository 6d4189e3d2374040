"""A text means what it gives on floats; populations, tapes and certificates must agree with it."""

import logging
import math
import subprocess
import sys
import time
from threading import Thread

import numpy as np
import pytest
from campaigns import few

import gearopt
from gearopt.errors import SolveError
from gearopt.optimise import deadline
from gearopt.optimise.evaluation import elementwise
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Param, Repeat, Terms, Var

WEIGHTS = np.array([1.0, 2.0, 3.0])


def problem(text, size=3, parameters=(), **kind):
    return Problem("own", (Var("w", "", 0.5, 4.0, 1.5, size=size, **kind),), parameters, text)


REDUCTIONS = {
    "sum": lambda w: np.sum(w),
    "prod": lambda w: np.prod(w),
    "max": lambda w: np.max(w),
    "min": lambda w: np.amin(w),
    "norm": lambda w: np.linalg.norm(w),
    "norm 1": lambda w: np.linalg.norm(w, 1),
    "mean": lambda w: np.mean(w),
    "std": lambda w: np.std(w),
    "median": lambda w: np.median(w),
    "dot": lambda w: np.dot(WEIGHTS, w),
    "matmul": lambda w: np.array(w) @ WEIGHTS,
    "times array": lambda w: (WEIGHTS * np.array(w))[1],
    "sort": lambda w: np.sort(w)[0] - np.sort(w)[2],
    "diff": lambda w: np.sum(np.diff(w) ** 2),
    "argmax": lambda w: w[np.argmax(w)],
    "hidden": lambda w: np.maximum(9.0, np.sum(w)),  # equal unless the sum is large
    "of one": lambda w: np.sum(w[0]),
    "if": lambda w: w[0] if w[0] > 1.0 else w[1],
    "python max": lambda w: max(w),
    "math": lambda w: math.sqrt(w[0]) + math.hypot(w[1], w[2]),
    "int": lambda w: WEIGHTS[int(w[0]) % 3] * w[1],
    "undefined": lambda w: math.log(w[0] - 1.0),  # NaN below 1
}


@pytest.mark.parametrize("name", REDUCTIONS)
def test_a_population_gives_what_its_points_give(name):
    value = REDUCTIONS[name]
    points = np.random.default_rng(1).uniform(0.5, 4.0, (7, 3))  # row 3 repeats row 0
    points[3] = points[0]
    found = problem(
        lambda x, p: Terms(
            {"f": value(x.w)}, {"l": (value(x.w) / 9.0, x.w[0] / 4.0)}, report={"r": value(x.w)}
        )
    ).batch(points)

    def on_floats(point):
        try:
            return float(value(tuple(map(float, point))))
        except ValueError:
            return math.nan

    expected = [on_floats(point) for point in points]
    assert found.F[:, 0] == pytest.approx(expected, rel=1e-14, nan_ok=True)
    assert found.G[:, 0] == pytest.approx(np.array(expected) / 9.0, rel=1e-14, nan_ok=True)
    assert found.report["r"] == pytest.approx(expected, rel=1e-14, nan_ok=True)
    assert found.G.shape == (7, 2)


def test_texts_of_elements_run_whole_populations_at_once():
    calls = []

    def text(x, p):
        calls.append(1)
        total = sum(p.k * v**2 + np.sqrt(v) / 2 for v in x.w)
        return Terms(
            {"f": np.where(x.w[0] > 1.0, total, abs(-total))}, {"l": np.clip(x.w[1], 1, 2)}
        )

    whole = problem(text, parameters=(Param("k", "", 2.0),))
    whole.batch(np.full((50, 3), 1.5))
    assert elementwise(whole, None)
    before = len(calls)
    whole.batch(np.full((50, 3), 1.5))
    assert len(calls) == before + 1


def test_a_block_may_hold_what_where_and_select_return():
    def text(x, p):
        high = tuple(np.where(v > 1.0, v, 1.0) / 4.0 for v in x.w)
        return Terms({"f": np.select([x.w[0] > 1.0], [x.w[1]], x.w[2])}, {"high": high})

    points = np.random.default_rng(4).uniform(0.5, 4.0, (6, 3))
    found = problem(text).batch(points)
    assert found.G == pytest.approx(np.maximum(points, 1.0) / 4.0)
    assert found.F[:, 0] == pytest.approx(np.where(points[:, 0] > 1.0, points[:, 1], points[:, 2]))
    assert solve(problem(text), "ipopt").value is not None


def test_a_text_that_branches_on_a_parameter_is_proven_for_each_value():
    def text(x, p):
        return Terms({"f": np.sum(x.w) if p.mode > 0 else x.w[0] + x.w[1] + x.w[2]})

    points = np.random.default_rng(2).uniform(0.5, 4.0, (5, 3))
    for mode in (-1.0, 1.0, -1.0):
        found = problem(text, parameters=(Param("mode", "", -1.0),)).at(mode=mode)
        assert found.batch(points).F[:, 0] == pytest.approx(points.sum(axis=1), rel=1e-14)


def test_the_slower_way_is_told_once(caplog):
    one = problem(lambda x, p: Terms({"f": np.linalg.norm(x.w)}))
    with caplog.at_level(logging.INFO, "gearopt"):
        for _ in range(3):
            one.batch(np.full((4, 3), 2.0))
    assert [r.getMessage().split(",")[0] for r in caplog.records] == [
        "the text of own is run point by point"
    ]


@pytest.mark.parametrize("reduction", ["sum", "norm", "element"])
def test_repeats_give_what_their_rows_give(reduction):
    data = np.array([1.0, 4.0, 9.0])

    def row_text(x, p, row):
        value = {
            "sum": lambda: np.sum(x.own) + np.sum(x.shared) * np.sum(row.d),
            "norm": lambda: np.linalg.norm([*x.own, row.d]),
            "element": lambda: x.own[0] * row.d + x.own[1] * x.shared[1],
        }[reduction]()
        return Terms({"f": value}, {"l": value / 9.0}, report={"r": value})

    whole = Problem(
        "rows",
        (Var("shared", "", 0.0, 4.0, 1.0, size=2),),
        (),
        lambda x, p: Terms({"f": x.shared[0]}),
        (Repeat("row", (Var("own", "", 0.0, 4.0, 1.0, size=2),), {"d": data}, row_text),),
    )
    points = np.random.default_rng(3).uniform(0.0, 4.0, (6, 8))
    found = whole.batch(points)
    for k, point in enumerate(points):
        shared, own = point[:2], point[2:].reshape(3, 2)
        values = [
            {
                "sum": o.sum() + shared.sum() * d,
                "norm": math.sqrt(o[0] ** 2 + o[1] ** 2 + d**2),
                "element": o[0] * d + o[1] * shared[1],
            }[reduction]
            for o, d in zip(own, data, strict=True)
        ]
        assert found.F[k, 0] == pytest.approx(shared[0] + sum(values), rel=1e-14)
        assert found.G[k] == pytest.approx(np.array(values) / 9.0, rel=1e-14)
        assert found.report["row.r"][k] == pytest.approx(values, rel=1e-14)


@pytest.mark.parametrize(
    ("method", "points"), few([("annealing", 2000), ("ipopt", 50), ("nsga2", 1500)], 2)
)
def test_methods_agree_on_a_sum_of_numpy(method, points):
    """min sum (w - (1, 2, 3))^2 with sum w <= 4.5: each w is 0.5 below, 0.75 in all."""

    def text(x, p):
        away = np.array(x.w) - WEIGHTS
        return Terms({"f": np.sum(away**2)}, {"total": np.sum(x.w) / 4.5})

    result = solve(problem(text), method, Budget(evaluations=points))
    assert 0.75 - 1e-6 <= result.value < 0.95 and result.limits["total"] <= 1.0 + 1e-8


@pytest.mark.parametrize("seed", few(range(3), 1))
def test_samplers_on_whole_numbers_find_what_enumeration_finds(seed):
    rng = np.random.default_rng(seed)
    target, weight, most = rng.uniform(0.0, 5.0, 3), rng.uniform(0.5, 2.0, 3), rng.uniform(6, 12)

    def values(w):
        w = np.array(w)
        return np.linalg.norm(weight * (w - target)) + 1.0, np.max(w) * np.sum(w) / most / 2.0

    def text(x, p):
        f, g = values(x.w)
        return Terms({"f": f}, {"g": g})

    every = [np.array([a, b, c], float) for a in range(6) for b in range(6) for c in range(6)]
    best = min(f for f, g in map(values, every) if g <= 1.0 + 1e-9)
    n = Var("w", "", 0, 5, 1, size=3, integer=True)
    result = solve(Problem("whole", (n,), (), text), "annealing", Budget(evaluations=2000))
    assert result.value == pytest.approx(best, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (lambda x, p: Terms({"f": np.max(x.w)}), r"np.max\(x.w\).*further variable t"),
        (lambda x, p: Terms({"f": x.w[0] if x.w[0] > 1 else 1.0}), "further variable t"),
        (lambda x, p: Terms({"f": np.std(x.w)}), "in line .*np.std.*functions of scalars"),
        (lambda x, p: Terms({"f": x.w[0]}, {"l": math.sqrt(x.w[0])}), r"l is .* nan on symbols"),
        (lambda x, p: Terms({"f": math.hypot(*x.w[:2])}), "f is .* nan on symbols.*not math.sqrt"),
        (lambda x, p: Terms({"f": int(x.w[0]) + x.w[1]}), "cannot be traced in line"),
    ],
)
def test_what_has_no_derivatives_is_named_with_what_to_write(text, words):
    with pytest.raises(SolveError, match=words):
        solve(problem(text), "ipopt")


def test_a_sampler_takes_what_has_no_derivatives_and_says_that_nothing_is_proven():
    def text(x, p):
        return Terms({"f": np.max(x.w) + 1.0 / np.min(x.w)})  # least at 1, 1, 1

    result = solve(problem(text), "annealing", Budget(evaluations=500))
    assert result.status == "feasible" and 2.0 <= result.value < 2.01
    assert result.bound is None and "cannot be traced" in result.message


def test_a_text_whose_symbols_mean_something_else_is_refused():
    def text(x, p):
        return Terms({"f": x.w[0] if isinstance(x.w[0], float) else 2.0 * x.w[0]})

    with pytest.raises(SolveError, match="f is 1.5 on numbers, but 3 on symbols"):
        solve(problem(text), "ipopt")


def test_norm_and_sum_are_proven_on_their_tapes():
    """min |w - (1, 2, 3)| with sum w <= 4.5; on the sphere the nearest is 0.5 below in each."""

    def text(x, p):
        return Terms({"f": np.sum((np.array(x.w) - WEIGHTS) ** 2)}, {"total": np.sum(x.w) / 4.5})

    result = gearopt.solve(problem(text))
    assert result.status == "optimal" and result.value == pytest.approx(0.75, rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("method", few([None, "annealing"], 1))
def test_a_simulation_that_waits_for_a_number_is_ended_on_symbols(method, monkeypatch):
    """It steps to t = 1 by a width that is NaN on symbols: no comparison with NaN ends a loop."""
    monkeypatch.setattr(deadline, "SHORTEST", 0.05)

    def simulated(x, p):
        t, y = 0.0, 1.0
        while not t >= 1.0:
            y, t = y - 0.1 * x.w * y, t + 0.1 * math.exp(1e-6 * x.w)
        return Terms({"y": (y - 0.2) ** 2})

    own, began = problem(simulated, size=1), time.perf_counter()
    found = gearopt.solve(own, method=method, budget=Budget(seconds=0.15))
    assert found.value < 0.1 and found.message.count("has not ended") == 1
    with pytest.raises(SolveError, match=r"line \d+ .*has not ended .*annealing and nsga2"):
        gearopt.solve(own, method="ipopt", budget=Budget(seconds=0.1))
    assert time.perf_counter() - began < 20.0  # without an end it goes on for ever


def test_time_that_other_work_takes_is_not_the_text_s():
    with deadline.within(0.02):
        time.sleep(0.04)
    with pytest.raises(TimeoutError, match=r"has not ended after 0.02 s"), deadline.within(0.02):
        for _ in range(100):
            time.sleep(0.01)


def test_tracers_and_profilers_go_on_after_work_that_may_be_ended():
    code = (
        "import sys; from gearopt.optimise.deadline import within\n"
        "with within(9.0): pass\n"
        "sys.setprofile(lambda *seen: None); print(sum([1, 2])); (lambda: None)()"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=30)  # else without end


def test_threads_take_turns():
    inside, most = [], []

    def text(x, p):
        inside.append(1)
        most.append(len(inside))
        time.sleep(1e-3)
        inside.pop()
        return Terms({"f": (x.w - p.c) ** 2})

    own, found = problem(text, 1, (Param("c", "", 1.0),)), {}

    def work(c):
        found[c] = gearopt.solve(own.at(c=c)).design["w"]

    threads = [Thread(target=work, args=(c,)) for c in (1.0, 2.0, 3.0)]
    for step in (Thread.start, Thread.join):
        for thread in threads:
            step(thread)
    assert found == {c: pytest.approx(c) for c in (1.0, 2.0, 3.0)} and max(most) == 1
