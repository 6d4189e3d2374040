"""Continuous sizing against closed forms, independent solutions and hard scales."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from campaigns import few

from gearopt.formulations.drive import continuous_sizing, sizing_text
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise import tape
from gearopt.optimise.certificate import certify
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.optimise.solvers import ipopt

F = Fraction
EXACT, ONE_PERCENT = F(0), F(1, 100)

HELICAL = Toothing(math.radians(25.0))


def drive(power_kW, speed_rpm, total, widths, tolerance=EXACT, **stage):
    limits = {"modules": (), "pinion_teeth": (20, 40), "toothings": (HELICAL,)} | stage
    stages = tuple(Stage((2.07, 48.0), FaceWidth(F(str(w)), F(str(w))), **limits) for w in widths)
    torque = 30e6 * power_kW / math.pi / speed_rpm
    return Train(torque, F(total), tolerance, stages, law=K_FACTOR)


def g(u):
    """V = pi T/(2 K) g(u) at the K limit (Chong and Lee, eqs. 2 and 4)."""
    return (u + 1.0) * (u * u + 1.0) / u


def test_single_stage_closed_form():
    train = drive(7.5, 1450, 5, [0.6])
    result = solve(continuous_sizing.problem(train))
    assert result.status == "optimal"
    assert result.value == pytest.approx(math.pi * train.torque / (2 * 2.07) * g(5.0), rel=1e-10)


def test_two_stages_meet_the_stationarity_of_the_split():
    """2 u1 (1 + 1/u) + 2 = (u^2 + 1)/u1^2 (Chong and Lee, eqs. 2 and 4)."""
    total = F("1450") / F("66.5")
    result = solve(continuous_sizing.problem(drive(7.5, 1450, total, [0.6, 0.75])))
    u1, u = result.design["ratio"][0], float(total)
    assert 2 * u1 * (1 + 1 / u) + 2 == pytest.approx((u * u + 1) / u1**2, rel=1e-7)
    assert result.design["ratio"] == pytest.approx([5.8044, 3.7565], abs=6e-5)


@pytest.mark.parametrize("count", [1, 2, 6])
def test_every_count_of_stages_is_proven_convex_and_optimal(count):
    problem = continuous_sizing.problem(drive(8, 3520, 4**count, [0.6] * count, F(1, 100)))
    assert tape.kinds(problem).log_convex
    result = solve(problem)
    assert result.status == "optimal" and result.gap < 1e-9
    volume = [math.pi * problem.parameters[0].value / (2 * 2.07)]
    even = sum(volume[0] * 4.0**k * g(4.0) for k in range(count))
    assert result.value < even


def test_the_optimum_does_not_depend_on_tied_width_or_helix():
    """V at the K limit is independent of m_a, m and beta."""
    train = drive(8, 3520, 110, [0.6, 0.6, 0.75])
    values = [
        solve(continuous_sizing.problem(t)).value
        for t in (
            train,
            drive(8, 3520, 110, [0.9, 0.5, 0.7]),
            drive(8, 3520, 110, [0.6, 0.6, 0.75], toothings=(Toothing(0.1),)),
        )
    ]
    assert values == pytest.approx([12707311.04] * 3, abs=0.006)


def test_free_width_and_a_fixed_stage():
    train = drive(7.5, 1450, 20, [0.6, 0.75], F(1, 100))
    free = FaceWidth(F("0.3"), F("0.6"))
    loose = replace(train, stages=(replace(train.stages[0], face_width=free), train.stages[1]))
    result = solve(continuous_sizing.problem(loose))
    assert result.status == "optimal"
    assert result.value == pytest.approx(solve(continuous_sizing.problem(train)).value, rel=1e-9)
    given = replace(train.stages[0], modules=(F(2),), pinion_teeth=(21, 21), wheel_teeth=(115, 115))
    fixed = replace(train, stages=(given, train.stages[1]))
    result = solve(continuous_sizing.problem(fixed))
    assert result.status == "optimal"
    assert result.design["module_mm"][0] == pytest.approx(2.0, rel=1e-12)
    assert result.design["ratio"][0] == pytest.approx(115 / 21, rel=1e-12)
    wheel = replace(train.stages[0], wheel_teeth=(115, 115))
    result = solve(continuous_sizing.problem(replace(train, stages=(wheel, train.stages[1]))))
    assert result.status == "optimal"
    first = result.design["pinion_teeth"][0] * result.design["ratio"][0]
    assert first == pytest.approx(115, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "sign"),
    [
        ({"allowable": (2.2, 48.0)}, -1),
        ({"allowable": (1.9, 48.0)}, 1),
        ({"wheel_diameter": F(270)}, 1),
    ],
)
def test_the_answer_moves_the_right_way(change, sign):
    train = drive(7.5, 1450, 20, [0.6, 0.75])
    moved = replace(train, stages=tuple(replace(s, **change) for s in train.stages))
    before, after = (solve(continuous_sizing.problem(t)).value for t in (train, moved))
    assert sign * (after - before) > 1e-4 * before


def test_safety_squared_closed_form():
    """Under K limits V is homogeneous: V(S) = S^2 V(1) for K/S^2."""
    problem = continuous_sizing.problem(drive(7.5, 1450, 20, [0.6, 0.75]))
    one = solve(problem).value
    for safety in (1.1, 1.7):
        limits = {"k_factor": (2.07 / safety**2,) * 2, "unit_load": (48.0 / safety**2,) * 2}
        assert solve(problem.at(**limits)).value == pytest.approx(safety**2 * one, rel=1e-9)


@pytest.mark.parametrize("tolerance", [EXACT, ONE_PERCENT])
def test_impossible_requests_are_proven_and_named(tolerance):
    """Conflict sets that an elastic form in another solver gave."""
    ratio = {"ratio" if tolerance == 0 else "ratio_low"}
    thousand = drive(7.5, 1450, 1000, [0.6, 0.75], tolerance, ratio=(F(1), F(10)))
    result = solve(continuous_sizing.problem(thousand))
    assert result.status == "infeasible"
    assert set(result.proof["conflict"]) == ratio | {"stage_ratio_high[1]", "stage_ratio_high[2]"}
    if tolerance == 0:  # t^2 (1 + t) = 10 splits the misfit over two caps and the ratio
        assert result.proof["least_violation"] == pytest.approx(10 ** (1 / 3) - 1, rel=1e-8)
    wheels = drive(7.5, 1450, F(1450) / F("66.5"), [0.6, 0.75], tolerance, wheel_diameter=F(250))
    result = solve(continuous_sizing.problem(wheels))
    assert result.status == "infeasible"
    named = {"k_factor[1]", "k_factor[2]", "wheel_diameter[1]", "wheel_diameter[2]"}
    assert set(result.proof["conflict"]) == ratio | named


@pytest.mark.parametrize(
    ("power_kW", "speed_rpm"),
    few([(1e-3, 3000.0), (8.0, 3520.0), (1e3, 1500.0), (2e4, 600.0)], 1),
)
def test_one_watt_to_20_megawatts_from_10_random_starts(power_kW, speed_rpm):
    """Starts e^N(0, 2) times 1 (not the guess), with module limits and wheels 5 % too large."""
    limits = {"modules": (F("0.05"), F(200)), "pinion_teeth": (20, 60)}
    train = drive(power_kW, speed_rpm, 110, [0.6, 0.6, 0.75], F(1, 100), **limits)
    _, outcome = run(continuous_sizing.problem(train))
    largest = max(p.wheel.reference_diameter for p in sizing_text.pairs(train, outcome.x))
    cap = F(0.95 * largest)
    capped = replace(train, stages=tuple(replace(s, wheel_diameter=cap) for s in train.stages))
    problem = continuous_sizing.problem(capped)
    best = solve(problem)
    assert best.status == "optimal" and best.gap < 1e-9
    assert max(v for n, v in best.limits.items() if "wheel" in n) == pytest.approx(1.0, abs=1e-8)
    rng = np.random.default_rng(20)
    size = len(problem.columns)
    for _ in range(10):
        start = np.exp(rng.normal(0.0, 2.0, size))
        verdict = certify(problem, ipopt.run(problem, Budget(), 0, None, start=start), 1e-9)
        assert verdict.status == "optimal"
        assert verdict.objective == pytest.approx(best.value, rel=1e-9)


@pytest.mark.parametrize("factor", [1e-24, 1e24])
def test_no_scale_is_called_impossible_because_of_the_search_box(factor):
    """V is proportional to torque at the K limit, at any scale."""
    train = drive(7.5, 1450, 20, [0.6, 0.75])
    one = solve(continuous_sizing.problem(train))
    other = solve(continuous_sizing.problem(replace(train, torque=factor * train.torque)))
    assert other.status == "optimal"
    assert other.value == pytest.approx(factor * one.value, rel=1e-9)


def test_fixed_teeth_may_not_speed_up():
    train = drive(7.5, 1450, 20, [0.6, 0.75], ONE_PERCENT)
    up = replace(train.stages[0], pinion_teeth=(40, 40), wheel_teeth=(20, 20))
    result = solve(continuous_sizing.problem(replace(train, stages=(up, train.stages[1]))))
    assert result.status == "infeasible"
    assert "stage_ratio_low[1]" in result.proof["conflict"]
