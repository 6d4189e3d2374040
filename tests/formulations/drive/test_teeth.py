"""Exact teeth: statuses, budgets, objectives and what a caller can see (values: test_problems)."""

import math
from dataclasses import replace
from fractions import Fraction
from importlib import import_module

import pytest
from brute_force import some_drive
from campaigns import few

from gearopt.formulations.drive import continuous_sizing, teeth
from gearopt.formulations.drive.teeth.reach import narrowed
from gearopt.formulations.drive.teeth.search import possible
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import OBJECTIVES, FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.physics.gears import SERIES_I

F = Fraction
ELEVATOR, ONE_PERCENT = F("1450") / F("66.5"), F(1, 100)

HELICAL = Toothing(math.radians(25.0))


def drive(total=ELEVATOR, widths=("0.6", "0.75"), tolerance=ONE_PERCENT, **stage):
    limits = {"modules": SERIES_I, "pinion_teeth": (20, 40), "toothings": (HELICAL,)} | stage
    stages = tuple(Stage((2.07, 48.0), FaceWidth(F(w), F(w)), **limits) for w in widths)
    return Train(49392.913, F(total), tolerance, stages, law=K_FACTOR)


def test_table_2_designs_are_beaten_under_their_own_limits():
    """Holding the paper's process-one loads as limits: 8,708,993 -> 8,520,524 mm3."""
    train = drive()
    own = tuple(replace(s, allowable=(1.416, 31.78)) for s in train.stages)
    result = solve(teeth.problem(replace(train, stages=own)))
    assert result.status == "optimal"
    assert result.value == pytest.approx(8520524, abs=1.0)


@pytest.mark.parametrize("objective", [o for o in OBJECTIVES if o != "cost"])
def test_exact_is_never_below_the_continuous_bound(objective):
    train = replace(drive(), objective=objective, density=7.85e-9)
    exact, ideal = solve(teeth.problem(train)), solve(continuous_sizing.problem(train))
    assert exact.status == ideal.status == "optimal"
    assert ideal.bound <= exact.value <= 1.08 * ideal.value


def test_mass_is_density_times_volume():
    volume = solve(teeth.problem(drive()))
    mass = solve(teeth.problem(replace(drive(), objective="mass", density=7.85e-9)))
    assert mass.value == pytest.approx(7.85e-6 * volume.value, rel=1e-12)


@pytest.mark.parametrize(
    "stage",
    [
        {"modules": (F(1),)},
        {"wheel_diameter": F(250)},
        {"ratio": (F(1), F(4))},
        {"wheel_teeth": (1, 60)},
    ],
)
def test_infeasible_is_proven_by_exhaustion(stage):
    result = solve(teeth.problem(drive(**stage)))
    assert result.status == "infeasible" and result.value is None
    assert result.proof["method"] == "exhausted"


def test_possible_answers_yes_no_or_not_in_time():
    assert possible(drive(), 5.0, None) is True
    assert possible(drive(wheel_diameter=F(250)), 5.0, None) is False
    assert possible(drive(wheel_diameter=F(250)), 5.0, lambda event: False) is None


@pytest.mark.slow
def test_a_stopped_search_has_a_bound_and_says_so():
    train = drive(total=F(3000), widths=("0.6",) * 5 + ("0.75",))
    stopped = solve(teeth.problem(train), budget=Budget(evaluations=400_000))
    finished = solve(teeth.problem(train))
    assert finished.status == "optimal"
    assert stopped.status == "limit" and stopped.proof["method"].startswith("branch and bound")
    assert stopped.value >= finished.value
    assert stopped.bound is not None and stopped.bound <= finished.value
    seen = []
    watched = solve(teeth.problem(train), watch=lambda event: seen.append(event) or len(seen) < 5)
    assert watched.status == "limit" and len(seen) == 5


def test_no_budget_at_all_still_answers():
    result = solve(teeth.problem(drive()), budget=Budget(seconds=0.0))
    assert result.status == "limit" and result.value is None


def test_more_pairs_than_memory_takes_are_a_limit_and_say_what_to_narrow():
    one = {"total": F(10**6), "widths": ("0.6",), "pinion_teeth": (5, 1000)}
    found = solve(teeth.problem(drive(**one, tolerance=F(1, 100)), floor=1.0))
    assert found.status == "limit" and found.bound == 1.0 and found.value > 1.0
    assert "narrow its pinion teeth" in found.message and "up to 5 teeth" in found.message
    nothing = solve(teeth.problem(drive(**one, tolerance=F(1, 2)), floor=1.0))
    assert nothing.status == "limit" and nothing.value is None


@pytest.mark.parametrize("number", few(range(20), 2))
def test_wide_ranges_are_searched_like_narrow_ones(number, monkeypatch):
    """Pinions left out for their cost change nothing: of random drives and their ten best."""
    train = some_drive(number, 2)
    expected = [run(teeth.problem(train, n))[1] for n in (1, 10)]
    module = import_module("gearopt.formulations.drive.teeth.reach")
    monkeypatch.setattr(module, "PAIRS_AT_ONCE", 150)
    assert narrowed(train) != train
    for n, whole in zip((1, 10), expected, strict=True):
        found = run(teeth.problem(train, n))[1]
        assert found.infeasible == whole.infeasible and found.bound == whole.bound
        assert (found.x is None) == (whole.x is None)
        points = zip((found.x, *found.others), (whole.x, *whole.others), strict=True)
        assert whole.x is None or all((a == b).all() for a, b in points)


@pytest.mark.slow
def test_five_to_five_hundred_teeth_are_proven():
    """The best of wide ranges is that of 5 to 100 teeth: larger pinions cost more."""
    found = [solve(teeth.problem(drive(pinion_teeth=(5, most)))) for most in (100, 500, 1000)]
    assert {f.status for f in found} == {"optimal"}
    assert len({f.value for f in found}) == 1


def test_top_is_in_order_distinct_and_starts_with_the_best():
    result, outcome = run(teeth.problem(drive(), 20))
    problem = teeth.problem(drive(), 20)
    points = [outcome.x, *outcome.others]
    values = [float(problem.batch(x[None]).F[0, 0]) for x in points]
    assert len(points) == 20
    assert values == sorted(values) and values[0] == pytest.approx(result.value, rel=1e-12)
    assert len({tuple(x[2:6]) for x in points}) == 20
    assert all((problem.batch(x[None]).G <= 1 + 1e-12).all() for x in points)


def test_coprime_teeth_have_no_common_divisor():
    result, _ = run(teeth.problem(replace(drive(), coprime=True)))
    pairs = zip(result.design["pinion_teeth"], result.design["wheel_teeth"], strict=True)
    assert all(math.gcd(a, b) == 1 for a, b in pairs)
    assert result.limits["common_divisor[1]"] == 1.0


def test_fixed_things_stay_fixed():
    train = drive()
    first = replace(
        train.stages[0],
        modules=(F(5, 2),),
        pinion_teeth=(24, 24),
        wheel_teeth=(119, 119),
        face_width=FaceWidth(F(0), None, fixed=F(40)),
    )
    result, outcome = run(teeth.problem(replace(train, stages=(first, train.stages[1]))))
    assert result.status == "optimal"
    pair, _ = teeth.pairs(replace(train, stages=(first, train.stages[1])), outcome.x)
    assert pair == train.pair(0, 2.5, 24, 119, 40.0)


def test_finer_series_and_wider_tolerance_never_hurt():
    base = solve(teeth.problem(drive())).value
    finer = tuple(sorted({*SERIES_I, F("1.75"), F("2.75")}))
    assert solve(teeth.problem(drive(modules=finer))).value <= base
    assert solve(teeth.problem(drive(tolerance=F(2, 100)))).value <= base
    assert solve(teeth.problem(drive(tolerance=F(1, 1000)))).value >= base


def test_a_gap_that_is_enough_ends_the_search():
    """Free widths in six stages take minutes to exhaust; 0.1 % of the continuous bound does not."""
    free = FaceWidth(F("0.3"), F("0.6"))
    train = drive(total=F(3000), widths=("0.6",) * 6)
    train = replace(train, stages=tuple(replace(s, face_width=free) for s in train.stages))
    bound = solve(continuous_sizing.problem(train)).bound
    budget = Budget(evaluations=3_000_000, gap=1e-3)
    result = solve(teeth.problem(train, floor=bound), budget=budget, gap=1e-3)
    assert result.status == "optimal" and result.gap <= 1e-3
    assert result.bound >= bound and result.evaluations < 2_000_000
    assert result.message == "the requested gap is reached"


@pytest.mark.parametrize(
    ("total", "widths", "gap"),
    few(
        [
            (F(110), ("0.6", "0.6", "0.75"), 5e-3),
            (F(300), ("0.6",) * 3 + ("0.75",), 1e-3),
            (F(1000), ("0.6",) * 4 + ("0.75",), 1e-2),
        ],
        1,
    ),
)
def test_a_requested_gap_is_reached_or_the_search_goes_on(total, widths, gap):
    """The bound of the first look holds for smaller ratios only and must not count."""
    train = replace(drive(total, widths), torque=21702.9)
    exact = solve(teeth.problem(train))
    events = []
    result = solve(teeth.problem(train), budget=Budget(gap=gap), gap=gap, watch=events.append)
    assert result.status == "optimal" and result.gap <= gap
    assert result.bound <= exact.value * (1 + 1e-12)
    assert all(e.bound is None or e.bound <= exact.value * (1 + 1e-12) for e in events)


def test_a_drive_of_nonsense_numbers_is_refused():
    with pytest.raises(ValueError, match="positive numbers"):
        replace(drive(), torque=math.nan)
    with pytest.raises(ValueError, match="positive numbers"):
        replace(drive(), torque=-1e5)
    with pytest.raises(ValueError, match="ratio >= 1"):
        replace(drive(), ratio=F(1, 2))
    with pytest.raises(ValueError, match="needs a density"):
        replace(drive(), objective="mass")


def test_a_tolerance_that_leaves_too_many_pairs_is_told_before_memory_is_spent(monkeypatch):
    monkeypatch.setattr("gearopt.formulations.drive.teeth.later_stages.ENTRIES", 100_000)
    loose = drive(total=F(100), widths=("0.6",) * 3, tolerance=F(1, 2))
    found = solve(teeth.problem(loose))
    assert found.status == "limit" and "narrow it, or limit wheel teeth" in found.message


@pytest.mark.slow
def test_a_question_that_asks_too_much_is_undecided_not_an_error():
    """Pinions of 12 to 4000 teeth, any wheel: more pairs than are listed."""
    train = drive(total=F(600), widths=("0.6",) * 3, pinion_teeth=(12, 4000))
    assert possible(train, 5.0, None) is None


def test_a_list_of_the_best_shares_the_budget_of_the_best():
    """The second search, for the list, gets what the first one left."""
    alone = solve(teeth.problem(drive()))
    budget = Budget(evaluations=alone.evaluations + 5000)
    listed, outcome = run(teeth.problem(drive(), 1000), budget=budget)
    assert listed.value == alone.value
    assert listed.evaluations < alone.evaluations + 5000 + 20_000  # a slice more, not a search
    assert len(outcome.others) == 0
    assert Budget(3.0, 10, 0.1).less(5.0, 4) == Budget(0.0, 6, 0.1)
