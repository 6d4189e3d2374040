"""Hard cases of the servo train, each with its right answer."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from servo_trains import PAPER, STIFF

from gearopt.formulations.servo import servo_box
from gearopt.formulations.servo.ratio import Drive, acceleration, best_ratio, least_move_time, swing
from gearopt.formulations.servo.servo_box import ServoBox, first_that_fits
from gearopt.formulations.servo.split import problem, relaxation, stiff
from gearopt.optimise.certificate import certify
from gearopt.optimise.result import Budget, Outcome
from gearopt.optimise.solve import solve
from gearopt.physics.servo_drive import load_acceleration
from gearopt.physics.stiffness import (
    output_compliance,
    shaft_compliance,
    stiffness_of_frequency,
)

J_L, J_M = 19.8, 8.6e-3  # t mm2
F_L = 4.3 * 98.0665  # N mm
BARE = Drive(J_L, J_M, torque=50.0)


def test_without_friction_the_best_ratio_is_exact_and_its_acceleration_flat():
    ratio, value = best_ratio(BARE)
    assert ratio == pytest.approx(math.sqrt(J_L / J_M), rel=2e-16)
    assert load_acceleration(58.65, J_L, J_M, 50.0) / value == pytest.approx(0.98, abs=5e-4)
    assert load_acceleration(ratio * (1.0 + 1e-8), J_L, J_M, 50.0) == pytest.approx(
        value, rel=1e-15
    )


def test_no_motor_inertia_is_unbounded_and_said_so():
    massless = replace(BARE, motor_inertia=0.0)
    exact = solve(acceleration(massless))
    assert exact.status == "failed" and exact.value is None and exact.bound is None
    assert exact.message.startswith("unbounded")
    assert solve(least_move_time(massless, 1.0)).message.startswith("unbounded")
    assert solve(swing(massless, 1.0, 1.0)).message.startswith("unbounded")


@pytest.mark.slow
def test_ipopt_runs_away_without_motor_inertia_and_is_not_believed():
    """At 50 evaluations the ratio is 9e307; it would go on for 3000."""
    massless = acceleration(replace(BARE, motor_inertia=0.0))
    ipopt = solve(massless, "ipopt", Budget(evaluations=200))
    assert ipopt.status == "failed" and ipopt.bound is None
    assert "is unbounded" in ipopt.message


def test_no_motor_inertia_with_a_speed_limit_is_best_at_the_limit():
    massless = replace(BARE, motor_inertia=0.0, speed_limit=800.0)
    for method in ("exact", "ipopt"):
        result = solve(acceleration(massless, 10.0), method)
        assert result.status == "optimal"
        assert result.design["ratio"] == pytest.approx(80.0, rel=1e-12)
    limited = solve(least_move_time(massless, 6.0 * math.pi), "exact")
    assert limited.status == "optimal"
    assert limited.value == pytest.approx(
        solve(least_move_time(massless, 6.0 * math.pi), "ipopt").value
    )


@pytest.mark.parametrize("inertia", [0.0, 1e-17, 1e-30])
def test_cancellation_of_the_root_at_a_vanishing_motor_inertia(inertia):
    """T/(2b) = 75.2; the naive root c + sqrt(c^2 + q) gives 76 at 1e-20 kg m2."""
    drive = Drive(J_L, inertia, 50.0, F_L, 3.0, no_load_speed=800.0)
    assert best_ratio(drive, 5.0)[0] == pytest.approx(75.2, rel=1e-12)
    for method in ("exact", "ipopt"):
        result = solve(acceleration(drive, 5.0), method)
        assert result.status == "optimal"
        assert result.design["ratio"] == pytest.approx(75.2, rel=1e-6)


def test_no_load_inertia():
    """2 F_L/T with load friction, else the lower bound."""
    drive = Drive(0.0, J_M, 50.0, F_L, 3.0)
    assert best_ratio(drive)[0] == pytest.approx(17.9441, abs=6e-5)
    assert solve(acceleration(drive), "ipopt").design["ratio"] == pytest.approx(17.9441, abs=6e-5)
    free = solve(acceleration(Drive(0.0, J_M, 50.0, ratio=(1.5, 9.0))))
    assert free.status == "optimal" and free.design["ratio"] == 1.5


def test_torque_below_friction_is_infeasible_with_its_reason():
    """Eta T^2 < 4 b F_L: the formula's acceleration is -47.2 rad/s2."""
    drive = Drive(J_L, J_M, 50.0, 1000.0, no_load_speed=5.0)  # b = 10 N mm at 1 rad/s
    assert best_ratio(drive, 1.0)[1] == pytest.approx(-47.2, abs=0.05)
    exact, ipopt = (solve(acceleration(drive, 1.0), m) for m in ("exact", "ipopt"))
    assert exact.status == ipopt.status == "infeasible"
    assert "never exceeds the load's friction" in exact.message
    assert ipopt.proof["conflict"] == ["motor_torque"]


def test_torque_equal_to_friction_only_holds_the_load():
    drive = Drive(J_L, J_M, 50.0, 62.5, no_load_speed=5.0)
    assert best_ratio(drive, 1.0) == pytest.approx((2.5, 0.0), abs=1e-15)
    result = solve(acceleration(drive, 1.0))
    assert result.status == "infeasible" and "2.5, the acceleration is 0" in result.message


def test_inertias_that_differ_by_1e18():
    drive = Drive(1e3, 1e-15, 1e3)  # 1 kg m2, 1e-18 kg m2, 1 N m
    assert best_ratio(drive) == pytest.approx((1e9, 5e8), rel=1e-15)
    for method in ("exact", "ipopt"):
        result = solve(acceleration(drive), method)
        assert result.status == "optimal" and 1.0 / result.value == pytest.approx(5e8, rel=1e-10)


@pytest.mark.parametrize("beside", [1.0 - 1e-9, 1.0, 1.0 + 1e-9])
def test_a_speed_limit_at_the_change_of_regime(beside):
    """The peak speed of the best ratio is just admissible: both regimes meet there."""
    ratio, value = best_ratio(BARE)
    turn = beside * (800.0 / ratio) ** 2 / value
    exact, ipopt = (
        solve(least_move_time(replace(BARE, speed_limit=800.0), turn), m)
        for m in ("exact", "ipopt")
    )
    assert exact.status == ipopt.status == "optimal"
    assert exact.value == pytest.approx(2.0 * math.sqrt(turn / value), rel=1e-12)
    assert ipopt.value == pytest.approx(exact.value, rel=1e-11)


def test_rigid_parts_drop_out_and_a_thin_shaft_is_all():
    assert shaft_compliance(8e4, 10.0, 0.0) == 0.0
    assert shaft_compliance(8e4, math.inf, 50.0) == 0.0
    soft = 1e-6
    assert output_compliance((0.0, soft, 0.0), (1.0, 6.0, 48.0)) == soft / 36.0
    spread = output_compliance((1e-18, 1e-6, 1e-18), (1.0, 1.0, 8.0))
    assert spread == pytest.approx(1e-6, rel=1.1e-12)


def test_the_direction_of_referral_is_the_square_of_the_ratio_squared():
    right, wrong = (output_compliance((1.0,), (n,)) for n in (6.0, 1.0 / 6.0))
    assert wrong / right == pytest.approx(1296.0, rel=1e-14)
    assert np.isfinite(output_compliance((0.0, 0.0), (1.0, 8.0)))


LOOSE = replace(  # nothing but the ratio binds
    PAPER,
    modules=(Fraction(1),),
    pinion_teeth=(16, 40),
    max_wheel_teeth=208,
    bore=Fraction(1),
    wheel_tips=(Fraction(1000), Fraction(1000)),
    error=1.0,
    bending=1e9,
    tolerance=Fraction(0),
)


@pytest.mark.parametrize(
    ("ratio", "error"), [(math.sqrt(J_L / J_M), 5.4e-5), (math.exp(4.0), 5.1e-5)]
)
def test_a_ratio_that_no_teeth_give(ratio, error):
    """Exact equality is infeasible; the nearest trains miss by 5.4e-5 and 5.1e-5."""
    asked = replace(LOOSE, ratio=Fraction(round(ratio * 10**8), 10**8))
    assert solve(problem(asked)).status == "infeasible"
    for miss, status in ((error - 1e-6, "infeasible"), (error + 1e-6, "optimal")):
        allowed = replace(asked, tolerance=Fraction(round(miss / ratio * 10**12), 10**12))
        assert solve(problem(allowed)).status == status


@pytest.mark.parametrize("ratio", [47, 48, 53])
def test_a_ratio_that_teeth_give_is_met_exactly(ratio):
    result = solve(problem(replace(LOOSE, ratio=Fraction(ratio))))
    (z1, z3), (z2, z4) = result.design["pinion_teeth"], result.design["wheel_teeth"]
    assert result.status == "optimal" and z2 * z4 == ratio * z1 * z3


def test_a_design_on_its_limit_is_not_lost_to_floats():
    """0.4 (263 + 2) = 106 exactly; in floats 0.4 * 265 may exceed it."""
    result = solve(problem(PAPER))
    assert result.design["wheel_teeth"][1] == 263
    assert Fraction(4, 10) * 265 == PAPER.wheel_tips[1]
    shaved = replace(PAPER, wheel_tips=(PAPER.wheel_tips[0], Fraction(106) - Fraction(1, 10**6)))
    assert solve(problem(shaved)).value > result.value


def test_the_upper_limit_of_the_ratio_is_needed_where_the_objective_rewards_it():
    text = relaxation(PAPER)
    result = solve(text)
    assert math.prod(result.design["ratio"]) == pytest.approx(48.48, rel=1e-9)
    assert solve(text.at(ratio_high=60.0)).value < result.value * (1.0 - 1e-2)


def test_a_bound_relaxed_in_metres_is_refused():
    """Ipopt's default buys 1e-8 m of a least width of 2e-3 m: the mass comes out 5e-6 too good."""
    text = stiff(replace(STIFF, stiffness=stiffness_of_frequency(150.0, J_L)))
    honest = solve(text)
    assert 1e3 * honest.value == pytest.approx(70.596267, abs=6e-7)
    x = np.array([value for block in honest.design.values() for value in np.atleast_1d(block)])
    x[4:6] *= 1.0 - 5e-6
    verdict = certify(text, Outcome(x), 1e-6)
    assert verdict.status == "failed" and verdict.objective is None
    assert "violated" in verdict.message


def test_a_full_last_wheel_is_larger_than_the_box():
    full = ServoBox((4.5, 24.5, 52.5), (28.0, 58.5), 8.0, math.pi, (80.0, 130.0))
    assert first_that_fits([full]) is None
    assert solve(servo_box.problem(full)).bound > 1.3


def test_a_motor_over_the_output_shaft_needs_room_there():
    """Equal links may fold back upon the output shaft; the hub's distance is a limit of its own."""
    folded = ServoBox((12.0, 24.5, 30.0), (40.0, 40.0), 8.0, math.pi, (80.0, 130.0))
    text = servo_box.problem(folded)
    on_top = text.batch(np.array([[math.pi, 0.0]]))
    assert on_top.G[0, 0] > 1.0
    result = solve(text)
    motor, output = result.design["motor_angle_rad"], result.design["output_angle_rad"]
    apart = 2.0 * 40.0 * abs(math.cos(0.5 * (motor - output)))
    assert result.status == "optimal" and apart >= 20.0 - 1e-6
    far = replace(folded, links=(5.0, 6.0))
    stuck = solve(servo_box.problem(far))
    assert stuck.status == "infeasible" and "hub" in stuck.message
