"""Comparisons on problems with known optima: what is equal, what counts, what is kept."""

import math
import statistics
import sys
import types
from importlib import import_module
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from campaigns import few

import gearopt
from gearopt import Comparison, Problem, SolveError, Terms, Var
from gearopt.errors import CertificateError
from gearopt.optimise.comparing.comparison import excess, quantile
from gearopt.optimise.comparing.runs import KINDS, PATIENCE, WARM
from gearopt.optimise.methods import back_ends
from gearopt.optimise.result import Event, Outcome

PROBLEMS = Path(__file__).parents[2] / "problems"
SMALL = {"evaluations": 2000, "seconds": 0.02}


def box(**methods):
    """The largest box from a surface of 6: a cube, so the least inverse volume is 1."""

    def evaluate(x, p):
        a, b, c = x.side
        return Terms({"inverse": 1.0 / (a * b * c)}, {"surface": (a * b + b * c + c * a) / 3.0})

    side = Var("side", "m", 0.01, 100.0, 2.0, size=3, log=True)
    return Problem("box", (side,), (), evaluate, methods=methods)


def catalogue(**methods):
    """Least d n with d n >= 10, d from a list, n whole: 10."""

    def evaluate(x, p):
        return Terms({"size": x.d * x.n}, {"strength": 10.0 / (x.d * x.n)})

    d = Var("d", "", 1.0, 4.0, 4.0, values=(1.0, 3.0, 4.0))
    return Problem(
        "catalogue", (d, Var("n", "", 1, 20, 10, integer=True)), (), evaluate, methods=methods
    )


@pytest.fixture
def declared(monkeypatch):
    """A method whose module declares what a comparison must know."""

    def made(run, **constants):
        name = f"method_of_a_test_{len(constants)}_{id(run)}"
        module = types.ModuleType(name)
        vars(module).update(constants)
        monkeypatch.setitem(sys.modules, name, module)
        run.__module__ = name
        return run

    return made


def at(*point, claims=()):
    """A method that returns a point after claiming better values on the way."""

    def run(problem, budget, seed, watch):
        for n, best in enumerate(claims, 1):
            if watch is not None and watch(Event(0.0, n, best)) is False:
                return Outcome(None, finished=False)
        return Outcome(np.array(point, float), evaluations=len(claims) + 1)

    return run


def rows(found):
    return {row.method: row for group in found.groups for row in group.rows}


def samples(row):
    return [getattr(row, kind) for kind in KINDS]


def test_gaps_are_to_the_best_bound_we_proved():
    problem = box(coarse=at(0.99, 0.99, 0.99))
    found = gearopt.compare(problem, methods=("annealing", "ipopt", "coarse"), seeds=3, **SMALL)
    (group,) = found.groups
    assert group.proven and group.bound_from in ("annealing", "ipopt")
    assert 1.0 - 1e-8 < group.reference <= 1.0 <= group.best
    for row in group.rows:
        for sample in samples(row):
            some = [run for run in sample.runs if run.objective is not None]
            gaps = sorted(run.gap for run in some)
            above = sorted(run.objective / group.reference - 1.0 for run in some)
            assert gaps == pytest.approx(above, abs=1e-14)
            late = len(sample.runs) - len(some)  # a busy machine may leave a run without a point
            assert late == sample.summary.without
            assert not late or sample is row.equal_time
            if not late:
                assert sample.summary.median_gap == statistics.median(gaps)
                assert sample.summary.worst_gap == gaps[-1]
    assert rows(found)["ipopt"].equal_evaluations.summary.tight == 1.0
    assert rows(found)["coarse"].equal_evaluations.summary.tight == 0.0


@pytest.mark.slow
def test_without_a_bound_gaps_are_to_the_best_known():
    found = gearopt.compare(catalogue(), methods=("annealing", "nsga2"), seeds=2, **SMALL)
    (group,) = found.groups
    assert not group.proven and group.bound_from == "" and group.reference == group.best == 10.0


def test_a_bound_can_be_asked_for():
    problem = box(coarse=at(0.99, 0.99, 0.99))
    found = gearopt.compare(problem, methods=("coarse",), seeds=1, bound_from="ipopt", **SMALL)
    (group,) = found.groups
    assert group.proven and group.bound_from == "ipopt" and group.reference > 1.0 - 1e-8
    assert [row.method for row in group.rows] == ["coarse"]


def test_random_methods_run_for_every_seed_and_deterministic_ones_once():
    found = gearopt.compare(box(), methods=("ipopt", "annealing"), seeds=3, **SMALL)
    for sample in samples(rows(found)["ipopt"]):
        assert [run.seed for run in sample.runs] == [0]
    for sample in samples(rows(found)["annealing"]):
        assert [run.seed for run in sample.runs] == [0, 1, 2]
        assert len({tuple(best for *_, best in run.steps) for run in sample.runs}) == 3
    assert found.seeds == (0, 1, 2)


def test_every_back_end_declares_what_a_comparison_must_know():
    for name in back_ends():
        module = import_module(f"gearopt.optimise.solvers.{name}")
        assert isinstance(module.RANDOM, bool), name
        assert module.COUNTS and module.SETTINGS, name


def test_an_undeclared_method_counts_as_random():
    found = gearopt.compare(box(cube=at(1, 1, 1)), methods=("cube",), seeds=4, **SMALL)
    assert len(rows(found)["cube"].equal_time.runs) == 4


def _told(found):
    """Everything of the runs by evaluations but the times.

    Gaps are left out: runs by time end where they end, and may prove a bound that is 1e-14 better.
    """
    return [
        (row.method, run.seed, run.objective, run.violation, run.evaluations, run.status)
        + tuple((n, best) for _, n, best in run.steps)
        for row in rows(found).values()
        for run in row.equal_evaluations.runs
    ]


@pytest.mark.slow
def test_equal_seeds_give_equal_runs():
    methods = ("ipopt", "multistart", "annealing", "nsga2")
    budget = {"evaluations": 128, "seconds": 0.3}  # ten times as long is enough for 128
    once, again = (gearopt.compare(box(), methods=methods, seeds=2, **budget) for _ in range(2))
    assert _told(once) == _told(again) and len(_told(once)) == 7


def test_methods_that_cannot_take_the_problem_do_not_end_the_comparison():
    found = gearopt.compare(catalogue(), methods=("gp", "ipopt", "annealing"), seeds=1, **SMALL)
    row = rows(found)
    assert "discrete" in row["gp"].refused and "discrete" in row["ipopt"].refused
    assert row["gp"].equal_time is None and row["gp"].start_up_seconds is None
    assert row["annealing"].refused == "" and row["annealing"].equal_time is not None


def test_no_method_at_all_is_an_error():
    with pytest.raises(SolveError, match="discrete"):
        gearopt.compare(catalogue(), methods=("gp",))
    with pytest.raises(SolveError, match="no method 'simplex'"):
        gearopt.compare(box(), methods=("ipopt", "simplex"))


@pytest.mark.parametrize("wrong", [{"seeds": 0}, {"evaluations": 0}, {"seconds": 0.0}])
def test_budgets_below_one_are_refused(wrong):
    (name,) = wrong
    with pytest.raises(ValueError, match=f"^{name}=0.*: {name} is a"):
        gearopt.compare(box(), methods=("ipopt",), **wrong)


COUNTED = ["annealing", "nsga2", "multistart", "ipopt", "gp"]
QUICK = [("annealing", 1234), ("nsga2", 1234), ("ipopt", 7)]


@pytest.mark.parametrize(("method", "most"), few(product(COUNTED, [7, 333, 1234]), QUICK))
def test_no_run_by_evaluations_exceeds_them(method, most):
    """An annealing sweep of all chains is the least it can do: start and one move."""
    found = gearopt.compare(box(), methods=(method,), seeds=1, evaluations=most, seconds=0.02)
    (run,) = rows(found)[method].equal_evaluations.runs
    assert 0 < run.evaluations <= max(most, 64 if method == "annealing" else 1)
    assert all(n <= run.evaluations for _, n, _ in run.steps)


def test_every_method_is_given_the_same_budgets_after_two_warm_ups(declared):
    given = []

    def counting(problem, budget, seed, watch):
        given.append(budget)
        return Outcome(np.ones(3), evaluations=100)

    methods = {"counting": declared(counting, RANDOM=False)}
    gearopt.compare(box(**methods), methods=("counting",), evaluations=500, seconds=0.25)
    assert given[:2] == [WARM, WARM]
    assert [(b.seconds, b.evaluations) for b in given[2:]] == [
        (PATIENCE * 0.25, 500),
        (0.25, None),
    ]


def test_a_method_that_plans_ahead_is_told_what_its_time_allows(declared):
    given = []

    def planning(problem, budget, seed, watch):
        given.append(budget)
        return Outcome(np.ones(3), evaluations=budget.evaluations)

    methods = {"planning": declared(planning, RANDOM=False, PACED=True)}
    found = gearopt.compare(box(**methods), methods=("planning",), evaluations=500, seconds=0.25)
    (before,) = rows(found)["planning"].equal_evaluations.runs
    speed = before.evaluations / max(before.seconds, 1e-6)
    assert given[3].seconds == 0.25
    assert given[3].evaluations == pytest.approx(0.25 * speed, rel=1e-6, abs=1.0)  # whole


def test_a_comparison_leaves_no_trace_in_the_problem():
    problem = box()
    gearopt.compare(problem, methods=("ipopt", "annealing"), seeds=1, **SMALL)
    assert set(problem.memo) <= {"rows", ("names", None)}


def test_an_infeasible_point_is_never_a_success():
    """A cube of side 1.1 has a better objective, and too much surface."""
    methods = {"wrong": at(1.1, 1.1, 1.1, claims=(0.8,)), "right": at(1, 1, 1)}
    found = gearopt.compare(box(**methods), methods=("wrong", "right", "ipopt"), seeds=3, **SMALL)
    for sample in samples(rows(found)["wrong"]):
        s = sample.summary
        assert (s.close, s.tight, s.without) == (0.0, 0.0, 3)
        assert s.median_gap is s.worst_gap is s.objective is None
        assert s.violation == pytest.approx(0.21)
        assert all(run.gap is None and run.steps == () for run in sample.runs)
        assert set(sample.curve.median) == {None}
    assert rows(found)["right"].equal_time.summary.tight == 1.0
    assert found.groups[0].best == pytest.approx(1.0)


def test_a_seed_without_a_point_is_worse_than_any_other():
    def sometimes(problem, budget, seed, watch):
        return Outcome(None if seed % 3 == 0 else np.full(3, 0.9))

    found = gearopt.compare(
        box(sometimes=sometimes), methods=("sometimes", "ipopt"), seeds=5, **SMALL
    )
    s = rows(found)["sometimes"].equal_time.summary
    assert s.without == 2 and s.worst_gap is None
    assert s.median_gap == pytest.approx(0.9**-3 - 1.0)


def test_a_curve_is_no_better_than_the_checked_point():
    """It claims 0.5, which the point it returns (0.9, objective 1.37) does not have."""
    methods = {"boaster": at(0.9, 0.9, 0.9, claims=(8.0, 0.5)), "modest": at(0.9, 0.9, 0.9)}
    found = gearopt.compare(
        box(**methods), methods=("boaster", "modest", "ipopt"), seeds=1, **SMALL
    )
    (run,) = rows(found)["boaster"].equal_evaluations.runs
    assert run.clipped
    assert [(n, best) for _, n, best in run.steps] == [(1, 8.0), (2, pytest.approx(0.9**-3))]
    (run,) = rows(found)["modest"].equal_evaluations.runs
    assert not run.clipped and [best for _, _, best in run.steps] == [pytest.approx(0.9**-3)]
    curve = rows(found)["boaster"].equal_evaluations.curve
    assert curve.spent == (1.0, 2.0, 3.0)
    assert curve.median == pytest.approx((7.0, 0.9**-3 - 1.0, 0.9**-3 - 1.0))


@pytest.mark.slow
def test_curves_of_samplers_fall_to_the_final_gap():
    found = gearopt.compare(box(), methods=("annealing", "nsga2", "ipopt"), seeds=5, **SMALL)
    for method in ("annealing", "nsga2"):
        for sample in samples(rows(found)[method]):
            curve = sample.curve
            known = [gap for gap in curve.median if gap is not None]
            assert known == sorted(known, reverse=True)
            assert len(set(known)) > (3 if sample is samples(rows(found)[method])[0] else 0)
            assert known[-1] == sample.summary.median_gap
            triples = zip(curve.low, curve.median, curve.high, strict=True)
            for low, median, high in triples:
                assert median is None or (low <= median and (high is None or median <= high))


def test_stopping_keeps_the_runs_that_are_finished():
    def until(progress):
        return not (progress.done == 5 and progress.event is not None)

    methods = {"first": at(1, 1, 1, claims=(2.0,)), "second": at(0.9, 0.9, 0.9, claims=(2.0,))}
    problem = box(**methods)
    found = gearopt.compare(problem, methods=tuple(methods), seeds=25, watch=until, **SMALL)
    assert not found.complete and "5 of 100 runs" in found.message
    row = rows(found)
    assert [len(s.runs) for s in samples(row["first"])] == [2, 1]
    assert [len(s.runs) for s in samples(row["second"])] == [1, 1]


def test_stopping_at_once_reports_nothing_and_loses_nothing():
    found = gearopt.compare(box(), methods=("ipopt",), watch=lambda progress: False, **SMALL)
    assert not found.complete and samples(rows(found)["ipopt"]) == [None, None]
    assert Comparison.from_json(found.to_json()).to_dict() == found.to_dict()


def test_progress_counts_the_runs_and_the_time_left():
    seen = []
    methods = {"cube": at(1, 1, 1, claims=(2.0,))}
    watch = lambda p: seen.append(p) is None  # noqa: E731
    gearopt.compare(box(**methods), methods=("cube",), seeds=3, watch=watch, **SMALL)
    starts = [p for p in seen if p.event is None]
    assert [(p.done, p.total, p.seed) for p in starts] == [(0, 0, 0)] + [  # the start-up
        (k, 6, seed) for k, seed in enumerate((0, 0, 1, 1, 2, 2))
    ]
    assert all(p.left >= 0.0 for p in seen) and len(seen) == 13
    events = [p.event for p in seen if p.event is not None]
    assert {(e.part, e.objective, e.unit) for e in events} == {("box", "inverse", "")}


def test_events_of_a_file_name_its_unit():
    seen = []
    gearopt.compare(
        PROBLEMS / "elevator.toml",
        methods=("ipopt",),
        seeds=1,
        bound_from="ipopt",
        watch=lambda p: seen.append(p.event) is None,
        **SMALL,
    )
    told = {(e.part, e.objective, e.unit) for e in seen if e is not None}
    assert told == {("sizing", "gear_volume", "mm3")}


def test_a_run_that_breaks_is_a_run_without_a_point():
    def breaks(problem, budget, seed, watch):
        if seed:
            raise SolveError("it broke")
        return Outcome(np.ones(3))

    found = gearopt.compare(box(breaks=breaks), methods=("breaks",), seeds=2, **SMALL)
    first, second = rows(found)["breaks"].equal_time.runs
    assert (first.status, second.status, second.message) == ("optimal", "failed", "it broke")


def test_models_stand_apart():
    """A drive with [teeth]: whole teeth and real-valued ones have a bound each."""
    scene = gearopt.load(PROBLEMS / "elevator.toml")
    found = gearopt.compare(scene, methods=("exact", "ipopt"))  # both end by themselves
    whole, real = found.groups
    assert [row.method for row in whole.rows] == ["exact"]
    assert [row.method for row in real.rows] == ["ipopt"]
    assert whole.reference == pytest.approx(5_782_370.7, rel=1e-8)
    assert real.reference == pytest.approx(5_618_183.5, rel=1e-8)
    assert whole.unit == real.unit == "mm3" and whole.words != real.words


def test_a_file_without_teeth_says_why_exact_has_no_row_of_numbers():
    found = gearopt.compare(PROBLEMS / "elevator_exact_ratio.toml", methods=("exact", "ipopt"))
    (group,) = found.groups
    assert "[teeth]" in rows(found)["exact"].refused and group.proven
    assert found.file_sha256 and found.scene == "drive" and found.title


def test_json_round_trip_and_format():
    methods = {"wrong": at(1.1, 1.1, 1.1)}
    found = gearopt.compare(
        box(**methods), methods=("ipopt", "annealing", "wrong"), seeds=2, **SMALL
    )
    again = Comparison.from_json(found.to_json())
    assert again.to_dict() == found.to_dict() and again.groups == found.groups
    assert found.settings["annealing"]["chains"] == 32 and found.machine["cpus"] >= 1
    with pytest.raises(ValueError, match="format 99"):
        Comparison.from_dict({**found.to_dict(), "comparison": 99})


def test_quantiles_between_two_values_are_their_mean():
    assert [quantile([3.0, 1.0, 2.0], q) for q in (0.0, 0.25, 0.5, 0.75, 1.0)] == [1, 1, 2, 3, 3]
    assert quantile([1.0, 2.0], 0.5) == 1.5 == quantile([3.0, 1.0, 0.0, 2.0], 0.5)
    assert quantile([1.0, math.inf], 0.5) is None
    assert quantile([1.0, math.inf, math.inf], 0.5) is None


def test_a_value_below_a_bound_is_a_contradiction():
    assert excess(1.0 - 1e-9, 1.0) == 0.0
    assert excess(-1.0, -2.0) == 0.5
    assert excess(0.5, 0.0) == 0.5
    with pytest.raises(CertificateError):
        excess(0.9, 1.0)
