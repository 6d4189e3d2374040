"""The split of a servo train: stage count, whole teeth and relaxation."""

import math
from dataclasses import replace
from fractions import Fraction as F
from functools import cache

import numpy as np
import pytest
from campaigns import few
from servo_trains import PAPER, trains_within
from uncompiled import uncompiled

from gearopt.formulations.servo.servo_design import OBJECTIVES
from gearopt.formulations.servo.split import (
    core,
    feasible,
    first_ratio,
    lightest_stage_ratio,
    problem,
    relaxation,
    stage_counts,
    teeth,
    trains,
)
from gearopt.formulations.servo.split.numbers import numbers
from gearopt.formulations.servo.split.teeth import KERNEL
from gearopt.optimise import tape
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.physics.stiffness import lewis_form_factor

INERTIA = [2305.0, 26.02106, 9.10183, 6.66977, 6.05842, 5.88511]

MASS = [2305.0, 98.0, 42.623, 31.713, 28.522, 27.805]


def with_error(degrees):
    return replace(PAPER, error=math.radians(degrees))


@pytest.mark.parametrize("stages", few(range(1, 7), [1, 3]))
def test_inertia_and_mass_by_number_of_stages(stages):
    for goal, expected, digits in (("inertia", INERTIA, 6e-6), ("mass", MASS, 6e-4)):
        text = core(48.0, stages, goal)
        results = [solve(text, m) for m in (*text.methods, "ipopt")]
        assert tape.kinds(text).log_convex
        for result in results:
            assert result.status == "optimal" and result.gap < 1e-10
            assert result.value == pytest.approx(expected[stages - 1], abs=digits)
            assert result.value == pytest.approx(results[0].value, rel=1e-12)
        assert solve(text, "gp").value == pytest.approx(results[0].value, rel=1e-7)


def test_splits_known_independently():
    two, three = stage_counts(48.0, 3)[1:]
    assert two.design["ratio"] == pytest.approx([4.08175, 11.75966], abs=6e-6)
    assert two.value == pytest.approx(26.0211, abs=6e-5)
    assert three.design["ratio"] == pytest.approx([2.143, 3.169, 7.067], abs=6e-4)
    even = core(48.0, 2).batch(np.array([[6.0, 8.0]])).F[0, 0]
    assert even == pytest.approx(38.80555555555556, rel=1e-15)
    for ratio, n_1, n_2, value in (
        (10.0, 2.43003, 4.11518, 9.94222),
        (1000.0, 11.22474, 89.08894, 189.996),
    ):
        result = solve(core(ratio, 2))
        assert result.design["ratio"] == pytest.approx([n_1, n_2], abs=6e-6)
        assert result.value == pytest.approx(value, abs=6e-4)
    assert first_ratio(1000.0) == pytest.approx((2.0**0.5 * 1000.0) ** (1 / 3), rel=1e-3)
    values = [r.value for r in stage_counts(48.0)]
    assert values == sorted(values, reverse=True)


def test_a_core_is_solved_again_with_another_ratio():
    text = core(48.0, 2).at(total=1000.0)
    for method in ("exact", "ipopt"):
        assert solve(text, method).value == pytest.approx(189.996, abs=6e-4)


def test_stage_ratio_of_least_mass():
    n = lightest_stage_ratio()
    assert n == pytest.approx(1.895025455, abs=6e-10)
    assert math.log(48.0) / math.log(n) == pytest.approx(6.06, abs=5e-3)


@pytest.mark.parametrize("scale", [0.1, 1.0, 7.0])
def test_the_root_of_the_cubic_is_the_least_of_the_two_stage_law(scale):
    x = first_ratio(48.0, scale) ** 2
    law = [1 + t + scale / t + scale * 48.0**2 / t**2 for t in x * np.array([1.0, 0.999, 1.001])]
    assert law[0] < min(law[1:])


DESIGNS = [  # error limit deg, goal, z1, z2, z3, z4, modules, J kg m2, mass g, E deg
    (0.1082, "inertia", (19, 101, 29, 263), (0.4, 0.4), 5.142e-7, 167.7, 0.10813),
    (0.1082, "mass", (19, 101, 29, 263), (0.4, 0.4), 5.142e-7, 167.7, 0.10813),
    (0.12, "inertia", (17, 91, 23, 207), (0.3, 0.5), 1.562e-7, 130.8, 0.11975),
    (0.12, "mass", (17, 92, 23, 206), (0.3, 0.5), 1.563e-7, 130.5, 0.11999),
    (0.12, "error", (50, 264, 29, 263), (0.3, 0.4), 6.744e-6, 343.3, 0.09798),
]


def values(train, teeth, modules):
    """Inertia [kg m2], mass [g], error [deg] of a design, and its limits, by the problem's text."""
    text = problem(train, *OBJECTIVES)
    point = np.array([[teeth[0], teeth[2], teeth[1], teeth[3], *modules]], float)
    batch = text.batch(point)
    inertia, mass, error = batch.F[0]
    return 1e-3 * inertia, 1e3 * mass, math.degrees(error), batch.G[0]


@pytest.mark.parametrize(("error", "goal", "teeth", "modules", "J", "mass", "E"), few(DESIGNS, 1))
def test_designs_known_independently(error, goal, teeth, modules, J, mass, E):
    """Of all trains, counted in whole numbers."""
    text = problem(with_error(error), goal)
    for method in ("exact", "enumeration"):
        result = solve(text, method)
        assert result.status == "optimal" and result.gap < 1e-11
        z1, z3 = result.design["pinion_teeth"]
        z2, z4 = result.design["wheel_teeth"]
        assert (z1, z2, z3, z4) == teeth and result.design["module_mm"] == list(modules)
    assert result.proof["method"] == "exhausted"
    assert result.proof["trains_looked_at"] == 6_326_052
    assert result.proof["feasible_trains"] == {0.1082: 62054, 0.12: 247948}[error]
    found = values(with_error(error), teeth, modules)
    assert found[0] == pytest.approx(J, rel=3.3e-4)  # half a unit of the fourth digit
    assert found[1] == pytest.approx(mass, abs=0.06)
    assert found[2] == pytest.approx(E, abs=6e-6)


def test_the_papers_own_design():
    inertia, mass, error, _ = values(PAPER, (16, 96, 26, 208), (0.5, 0.5))
    assert inertia == pytest.approx(7.578e-7, abs=6e-11)
    assert mass == pytest.approx(191.4, abs=0.06)
    assert error == pytest.approx(0.10819, abs=6e-6)


@pytest.mark.parametrize(
    ("error", "wheel", "goal", "bound"),
    few(
        [
            (0.1082, 300, "inertia", 4.884e-4),
            (0.1082, None, "inertia", 4.811e-4),
            (0.12, 300, "inertia", 1.384e-4),
            (0.1082, 300, "mass", 0.16577),
            (0.1082, None, "mass", 0.16538),
            (0.12, 300, "mass", 0.13029),
            (0.12, None, "error", math.radians(0.09768)),
        ],
        [(0.1082, None, "inertia", 4.811e-4), (0.12, 300, "mass", 0.13029)],
    ),
)
def test_bounds_of_the_relaxation(error, wheel, goal, bound):
    train = replace(with_error(error), max_wheel_teeth=wheel)
    text = relaxation(train, goal)
    assert tape.kinds(text).log_convex
    result = solve(text)
    assert result.status == "optimal" and result.gap < 1e-9
    assert result.bound == pytest.approx(bound, rel=1.1e-4)
    assert solve(text, "gp").value == pytest.approx(result.value, rel=1e-7)
    assert result.bound <= solve(problem(with_error(error), goal)).value


def brute_force(train, goal):
    """Feasible trains and the best of them: whole numbers as fractions, all else plain."""
    best, count = math.inf, 0
    for (z1, z2, z3, z4), (m1, m2) in trains_within(train):
        d1, d2, d3, d4 = (float(m * z) for m, z in ((m1, z1), (m1, z2), (m2, z3), (m2, z4)))
        n2 = z4 / z3
        error = (train.lost_motion[0] / d2) / n2 + train.lost_motion[1] / d4
        y1, y3 = lewis_form_factor(z1), lewis_form_factor(z3)
        width, torque = train.face_width, train.output_torque
        root = (
            2 * torque / d4 / (width * float(m2) * y3),
            2 * torque / n2 / d2 / (width * float(m1) * y1),
        )
        if error > train.error or max(root) > train.bending:
            continue
        count += 1
        area = math.pi / 4 * train.density * width
        discs = [area * d * d for d in (d1, d2, d3, d4)]
        polar = [m * d * d / 8 for m, d in zip(discs, (d1, d2, d3, d4), strict=True)]
        shaft = math.pi / 32 * train.density * train.shaft[1] * train.shaft[0] ** 4
        n = z2 / z1 * n2
        inertia = polar[0] + (polar[1] + polar[2] + shaft) / (z2 / z1) ** 2
        value = {
            "inertia": inertia + train.sector * polar[3] / n**2,
            "mass": 1000 * (sum(discs[:3]) + train.sector * discs[3]),
            "error": error,
        }[goal]
        best = min(best, value)
    return count, best


@pytest.mark.parametrize("seed", few(range(12), 3))
def test_it_is_what_full_enumeration_in_plain_python_finds(seed):
    rng = np.random.default_rng(seed)
    modules = tuple(sorted(F(int(k), 20) for k in rng.choice(np.arange(6, 20), 2, replace=False)))
    train = replace(
        PAPER,
        ratio=F(int(rng.integers(40, 120)), 10),
        tolerance=F(int(rng.integers(0, 40)), 1000),
        modules=modules,
        pinion_teeth=(14, 18),
        max_wheel_teeth=44,
        bore=F(int(rng.integers(16, 36)), 2) * modules[0],
        wheel_tips=(40 * modules[1], F(int(rng.integers(35, 47))) * modules[1]),
        error=math.radians(float(rng.uniform(0.3, 1.2))),
        bending=float(rng.uniform(300.0, 3000.0)),
        sector=float(rng.uniform(0.2, 1.0)),
    )
    goal = list(OBJECTIVES)[seed % 3]
    count, best = brute_force(train, goal)
    whole, quick = (solve(problem(train, goal), m) for m in ("enumeration", "exact"))
    assert whole.proof["feasible_trains"] == count
    if count == 0:
        assert whole.status == quick.status == "infeasible"
    else:
        assert whole.status == quick.status == "optimal"
        assert whole.value == pytest.approx(best, rel=1e-12)
        assert quick.value == pytest.approx(best, rel=1e-12)
        assert solve(relaxation(train, goal)).bound <= best * (1 + 1e-12)


def test_the_kernel_and_the_text_are_one_law():
    rng = np.random.default_rng(5)
    given, code = numbers(PAPER), uncompiled(KERNEL)
    text = problem(PAPER, *OBJECTIVES)
    rows = [row.name for row in text.rows.inequalities]
    judged = [rows.index(n) for n in ("error", "bending_stress[1]", "bending_stress[2]")]
    for _ in range(300):
        z1, z3 = rng.integers(16, 61, 2)
        z2, z4 = rng.integers(60, 301, 2)
        m1, m2 = rng.choice(given.module, 2)
        batch = text.batch(np.array([[z1, z3, z2, z4, m1, m2]], float))
        for goal in range(3):
            value = code.worth(given, goal, m1, z1, z2, m2, z3, z4)
            assert value == pytest.approx(batch.F[0, goal], rel=1e-14)
        keeps = code.sound(given, m1, z1, z2, m2, z3, z4)
        assert keeps == bool((batch.G[0, judged] <= 1.0).all())


@pytest.mark.slow
def test_a_list_of_trains_is_in_order_and_complete():
    train = replace(with_error(0.0985), pinion_teeth=(16, 50))
    found = trains(train, math.radians(0.0985))
    text = problem(train, "error")
    batch = text.batch(np.array(found))
    assert (np.diff(batch.F[:, 0]) >= 0.0).all() and len(found) > 50
    counted = solve(problem(train), "enumeration").proof["feasible_trains"]
    assert len(found) == counted
    assert (batch.G <= 1.0 + 1e-12).all()
    assert batch.F[-1, 0] <= math.radians(0.0985)
    assert batch.F[0, 0] == solve(text).value


@pytest.mark.slow
def test_all_feasible_trains_keep_all_limits():
    points = feasible(PAPER)
    assert points.shape == (62054, 6)  # as counted independently
    batch = problem(PAPER).batch(points)
    assert (batch.G <= 1.0 + 1e-12).all()
    assert batch.F.min() == solve(problem(PAPER)).value
    assert feasible(PAPER, maximum=62053) is None


def test_a_run_stops_when_told():
    seen = []

    def watch(event):
        seen.append(event)
        return False

    result = solve(problem(PAPER), "enumeration", watch=watch)
    assert result.status == "limit" and len(seen) == 1
    assert solve(problem(PAPER), "enumeration", Budget(evaluations=1000)).status == "limit"


@pytest.mark.parametrize("goal", ["inertia", "error"])
@pytest.mark.parametrize("method", ["exact", "enumeration"])
def test_looks_at_the_clock_change_nothing(goal, method, monkeypatch):
    """A search that pauses after every first stage finds, counts and lists the same."""
    train = replace(PAPER, pinion_teeth=(16, 22), modules=PAPER.modules[2:4])
    whole, listed = solve(problem(train, goal), method), feasible(train, goal)
    monkeypatch.setattr(teeth, "KERNEL_STEPS", (1, 1))
    monkeypatch.setattr(teeth, "LISTING_STEPS", 1)
    monkeypatch.setattr(teeth, "FIRST_NOTES", 1)
    seen, checks = [], []
    parts = solve(problem(train, goal), method, watch=lambda event: seen.append(event) or True)
    assert parts.to_dict() | {"seconds": 0} == whole.to_dict() | {"seconds": 0}
    assert max(np.diff([0, *(e.evaluations for e in seen)])) < 0.1 * whole.evaluations
    again = feasible(train, goal, check=lambda: checks.append(0))
    assert np.array_equal(again, listed) and len(checks) > 100


def test_a_list_of_all_trains_stops_when_told():
    def check():
        raise TimeoutError

    with pytest.raises(TimeoutError):
        feasible(PAPER, check=check)
    assert feasible(PAPER, maximum=10) is None


def test_annealing_takes_the_same_problem():
    text = problem(with_error(0.12), "inertia")
    result, best = solve(text, "annealing", Budget(evaluations=10_000), seed=1), solve(text).value
    assert result.status == "feasible" and best * (1.0 - 1e-12) <= result.value < 2.0 * best


@pytest.mark.slow
def test_nsga2_takes_one_goal_or_several():
    text = problem(with_error(0.12), "inertia")
    result = solve(text, "nsga2", Budget(evaluations=10_000), seed=1)
    assert result.status == "feasible"
    assert solve(text).value * (1.0 - 1e-12) <= result.value < 2.0 * solve(text).value
    _, outcome = run(problem(with_error(0.12), "inertia", "error"), "nsga2", seed=1)
    assert len(outcome.others) > 10


@pytest.mark.parametrize(
    ("change", "sign"),
    [
        ({"error": math.radians(0.11)}, -1),
        ({"bore": F(13)}, 1),
        ({"shaft": (9.0, 50.0)}, 1),
        ({"sector": 0.5}, 1),
    ],
)
def test_the_best_inertia_moves_the_right_way(change, sign):
    (before, whole), (after, changed) = least(PAPER), least(replace(PAPER, **change))
    assert sign * (after - before) > 1e-6 * before
    assert sign * (changed - whole) >= 0.0


@cache
def least(train):
    """Least inertia with real-valued teeth, and with whole ones."""
    return solve(relaxation(train)).value, solve(problem(train)).value


def test_impossible_errors_are_proven_and_named():
    tight = with_error(0.09)
    assert solve(problem(tight)).status == "infeasible"
    named = solve(relaxation(tight))
    assert named.status == "infeasible"
    assert {"error", "wheel_tip_diameter[2]"} <= set(named.proof["conflict"])


@pytest.mark.parametrize(
    "wrong",
    [
        {"pinion_teeth": (8, 20)},
        {"modules": ()},
        {"ratio": F(0)},
        {"sector": 1.5},
        {"error": 0.0},
    ],
)
def test_what_is_no_train_is_refused(wrong):
    with pytest.raises(ValueError):
        replace(PAPER, **wrong)
