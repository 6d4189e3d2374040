"""The total ratio of a servo train: closed form, Ipopt and Clarabel against known numbers."""

import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import few

from gearopt.formulations.servo.ratio import Drive, acceleration, best_ratio, least_move_time, swing
from gearopt.formulations.servo.ratio.acceleration import convex_bound
from gearopt.formulations.servo.split import core, staged
from gearopt.optimise import tape
from gearopt.optimise.solve import solve
from gearopt.physics.servo_drive import load_acceleration, rms_torque

METHODS = ("exact", "ipopt", "gp")
J_L, J_M = 19.8, 8.6e-3  # t mm2: 1.98e-2 and 8.6e-6 kg m2
F_L = 4.3 * 98.0665  # N mm: 4.3 kgf cm
BARE = Drive(J_L, J_M, torque=50.0)
REAL = replace(BARE, load_friction=F_L, motor_friction=3.0)


@pytest.mark.parametrize(
    ("drive", "load_speed", "ratio", "value"),
    [
        (BARE, 0.0, 47.982555, 60.584034),
        (replace(BARE, motor_friction=3.0), 0.0, 47.982555, 56.948992),
        (REAL, 0.0, 57.786211, 47.287374),
        (replace(REAL, efficiency=0.9), 0.0, 61.520067, 44.417347),
        (replace(REAL, no_load_speed=800.0), 5.0, 42.063097, 28.626103),
    ],
)
def test_accelerations_known_independently_by_three_methods(drive, load_speed, ratio, value):
    problem = acceleration(drive, load_speed)
    assert tape.kinds(problem).log_convex
    exact, ipopt, gp = (solve(problem, m) for m in METHODS)
    assert exact.status == ipopt.status == "optimal"
    assert exact.gap < 1e-9 and ipopt.gap < 1e-9
    assert exact.proof["method"] == "closed form" and ipopt.proof["method"] == "dual"
    assert exact.design["ratio"] == pytest.approx(ratio, abs=6e-7)
    assert 1.0 / exact.value == pytest.approx(value, abs=6e-7)
    assert ipopt.value == pytest.approx(exact.value, rel=1e-12)
    assert gp.value == pytest.approx(exact.value, rel=1e-9)
    assert ipopt.design["ratio"] == pytest.approx(ratio, abs=1e-6)


def test_the_root_is_the_maximum_of_a_fine_grid():
    rng = np.random.default_rng(3)
    for _ in range(50):
        numbers = np.exp(rng.uniform(-3.0, 3.0, 6))
        drive = Drive(
            *numbers[:2],
            torque=10.0 * numbers[2],
            load_friction=numbers[3],
            efficiency=float(rng.uniform(0.5, 1.0)),
            no_load_speed=100.0 * numbers[4],
            ratio=(1e-3, math.inf),
        )
        speed = float(numbers[5])
        ratio, value = best_ratio(drive, speed)
        near = ratio * np.exp(np.linspace(-1.0, 1.0, 2001))
        slope = drive.torque * speed / drive.no_load_speed
        law = load_acceleration(
            near,
            drive.load_inertia,
            drive.motor_inertia,
            drive.torque,
            drive.load_friction,
            drive.efficiency,
            slope,
        )
        assert law.max() <= value + 1e-12 * abs(value)


@pytest.mark.parametrize(
    ("turn", "ratio", "seconds"),
    [
        (math.pi / 2, 47.982555, 0.322041),
        (6 * math.pi, 29.9595, 1.196456),
        (60 * math.pi, 13.9060, 5.052376),
    ],
)
def test_moves_known_independently_by_three_methods(turn, ratio, seconds):
    problem = least_move_time(replace(BARE, speed_limit=800.0), turn)
    exact, ipopt, gp = (solve(problem, m) for m in METHODS)
    assert exact.status == ipopt.status == "optimal"
    assert exact.value == pytest.approx(seconds, abs=6e-7)
    assert exact.design["ratio"] == pytest.approx(ratio, abs=6e-5)
    assert ipopt.value == pytest.approx(exact.value, rel=1e-11)
    assert gp.value == pytest.approx(exact.value, rel=1e-9)


def bang_bang(drive, angle, n):
    """The time of a move at a ratio: torque, no torque at the speed limit, torque reversed.

    Newton's laws of rotor and load, with the torque at the train's output between them, give both
    ramps; the time is the least over the speed that is reached.
    """
    ramps = []
    for sign, eta in ((1.0, drive.efficiency), (-1.0, 1.0)):
        rotor = [n * drive.inertia, 1.0 / (eta * n)]  # of the load's acceleration and that torque
        forces = sign * drive.torque - drive.motor_friction, -drive.load_friction
        alone = np.linalg.solve([rotor, [drive.load_inertia, -1.0]], forces)
        ramps.append(sign * alone[0])
    a, d = ramps
    if not a > 0.0:
        return math.inf
    most = min(math.sqrt(2.0 * angle / (1.0 / a + 1.0 / d)), drive.speed_limit / n)
    v = most * np.linspace(0.01, 1.0, 200)
    return float(np.min(v / a + v / d + (angle - 0.5 * v**2 * (1.0 / a + 1.0 / d)) / v))


def test_a_move_brakes_with_friction_too():
    """0.1 N m at 6000 rpm at most, 2 N m of friction: ramps that are alike would take 0.37147 s."""
    axis = Drive(50.0, 5.5e-3, torque=100.0, load_friction=2000.0, speed_limit=200.0 * math.pi)
    turn = math.radians(120.0)
    result = solve(least_move_time(axis, turn))
    assert result.status == "optimal" and result.gap < 1e-9
    assert result.value == pytest.approx(0.33643, abs=6e-6)
    assert result.design["ratio"] == pytest.approx(62.51, abs=6e-3)
    assert result.value == pytest.approx(bang_bang(axis, turn, result.design["ratio"]), rel=1e-13)


@pytest.mark.parametrize("turn", [0.5, 500.0])
@pytest.mark.parametrize("friction", [0.0, F_L])
def test_a_move_is_the_best_of_all_bang_bang_motions(turn, friction):
    from scipy.optimize import minimize_scalar

    drive = replace(REAL, load_friction=friction, efficiency=0.85, speed_limit=800.0)
    least = math.log(1.01 * friction / (0.85 * 47.0)) if friction else 0.0
    found = minimize_scalar(
        lambda log_ratio: bang_bang(drive, turn, math.exp(log_ratio)),
        bounds=(least, 6.0),
        method="bounded",
        options={"xatol": 1e-10},
    )
    problem = least_move_time(drive, turn)
    assert tape.kinds(problem).log_convex
    exact, ipopt, gp = (solve(problem, m) for m in METHODS)
    assert exact.status == ipopt.status == "optimal"
    assert exact.value == pytest.approx(found.fun, rel=1e-12)
    assert ipopt.value == pytest.approx(exact.value, rel=1e-11)
    assert gp.value == pytest.approx(exact.value, rel=1e-9)


def test_swinging_duty_known_independently():
    drive = Drive(J_L, J_M, load_friction=100.0, motor_friction=3.0)
    problem = swing(drive, math.radians(20.0), 4.0 * math.pi)
    exact, ipopt, gp = (solve(problem, m) for m in METHODS)
    assert exact.status == ipopt.status == "optimal"
    assert exact.design["ratio"] == pytest.approx(48.469, abs=6e-4)
    assert exact.value == pytest.approx(32.5656, abs=6e-5)
    assert ipopt.value == pytest.approx(exact.value, rel=1e-12)
    assert gp.value == pytest.approx(exact.value, rel=1e-9)
    free = solve(swing(replace(drive, motor_friction=0.0), math.radians(20.0), 4.0 * math.pi))
    peak = math.radians(20.0) * (4.0 * math.pi) ** 2
    closed = ((J_L / J_M) ** 2 + 2.0 * (100.0 / (J_M * peak)) ** 2) ** 0.25
    assert free.design["ratio"] == pytest.approx(closed, rel=1e-14)
    grid = rms_torque(np.geomspace(10.0, 200.0, 4001), J_L, J_M, peak, 100.0, 3.0)
    assert exact.value <= grid.min() and exact.value == pytest.approx(grid.min(), rel=1e-6)


def test_a_swing_is_held_to_the_torque_of_the_motor():
    """The least rms torque of the digest is 32.5656 N mm."""
    drive = Drive(J_L, J_M, load_friction=100.0, motor_friction=3.0)
    for torque, status in ((32.56, "infeasible"), (32.57, "optimal")):
        text = swing(replace(drive, torque=torque), math.radians(20.0), 4.0 * math.pi)
        assert {solve(text, m).status for m in ("exact", "ipopt")} == {status}
    assert solve(text).limits["motor_torque"] == pytest.approx(32.5656 / 32.57, abs=2e-6)


def test_a_given_ratio_is_an_equality():
    given = replace(REAL, ratio=(48.0, 48.0))
    for text in (
        acceleration(given),
        least_move_time(replace(given, speed_limit=800.0), 3.0),
        swing(given, 0.3, 10.0),
        staged(given, 1e-4, 2),
    ):
        result = solve(text, "ipopt")
        assert result.status == "optimal" and result.gap < 1e-10
        if text.methods:
            assert result.value == pytest.approx(solve(text).value, rel=1e-11)
            assert solve(text).status == "optimal"
    assert 1.0 / solve(acceleration(given)).value == pytest.approx(46.304224, abs=6e-7)
    other = solve(acceleration(given).at(ratio=50.0))
    assert other.design["ratio"] == 50.0


def test_gear_inertia_moves_the_optimum():
    drive = replace(BARE, gear_inertia=7.578e-4)  # 7.578e-7 kg m2
    ratio, value = best_ratio(drive)
    assert ratio == pytest.approx(45.999, abs=6e-4)
    assert value / best_ratio(BARE)[1] - 1.0 == pytest.approx(-0.041, abs=6e-4)
    assert solve(acceleration(drive), "ipopt").design["ratio"] == pytest.approx(ratio, rel=1e-10)


def test_limits_of_the_ratio_and_of_the_speed_hold():
    below = solve(acceleration(replace(BARE, ratio=(1.0, 30.0))))
    above = solve(acceleration(replace(BARE, ratio=(60.0, 100.0))))
    assert (below.design["ratio"], above.design["ratio"]) == (30.0, 60.0)
    capped = acceleration(replace(BARE, speed_limit=800.0), 20.0)
    for method in METHODS:
        assert solve(capped, method).design["ratio"] == pytest.approx(40.0, rel=1e-9)
    none = solve(acceleration(replace(BARE, speed_limit=800.0), 801.0))
    assert none.status == "infeasible" and "speed limit" in none.message
    slow = solve(swing(replace(BARE, speed_limit=100.0), math.radians(20.0), 4.0 * math.pi))
    speed = math.radians(20.0) * 4.0 * math.pi
    assert slow.design["ratio"] == pytest.approx(100.0 / speed, rel=1e-14)


@pytest.mark.parametrize(
    ("change", "sign"),
    [
        ({"load_friction": 1.1 * F_L}, 1),
        ({"load_inertia": 1.1 * J_L}, 1),
        ({"motor_inertia": 1.1 * J_M}, -1),
        ({"gear_inertia": 1e-3}, -1),
        ({"efficiency": 0.9}, 1),
        ({"no_load_speed": 700.0}, -1),
    ],
)
def test_the_best_ratio_moves_the_right_way(change, sign):
    before = best_ratio(replace(REAL, no_load_speed=800.0), 1.0)
    after = best_ratio(replace(REAL, **{"no_load_speed": 800.0} | change), 1.0)
    assert sign * (after[0] - before[0]) > 1e-3 * before[0]
    assert after[1] < before[1]


def test_a_problem_is_solved_again_with_other_numbers():
    """The closed form reads the problem's present numbers, as the text does."""
    drive = replace(REAL, no_load_speed=800.0, speed_limit=500.0)
    changed = {"torque": 60.0, "load_friction": 300.0, "no_load_speed": 600.0}
    expected = best_ratio(replace(drive, **changed), 4.0)[1]
    text = acceleration(drive, 5.0).at(**changed, load_speed=4.0)
    for method in ("exact", "ipopt"):
        assert 1.0 / solve(text, method).value == pytest.approx(expected, rel=1e-10)
    turn = least_move_time(replace(REAL, speed_limit=800.0), 20.0).at(angle=30.0, speed_limit=600.0)
    sine = swing(BARE, 0.3, 10.0).at(amplitude=0.4, load_inertia=30.0, ratio_low=2.0)
    for other in (turn, sine):
        exact, ipopt = (solve(other, m) for m in ("exact", "ipopt"))
        assert exact.status == ipopt.status == "optimal"
        assert exact.value == pytest.approx(ipopt.value, rel=1e-11)


def test_no_parameter_is_without_effect():
    """Each number of a text changes its objective or a limit."""
    drive = replace(REAL, gear_inertia=1e-3, no_load_speed=800.0, speed_limit=700.0)
    drive = replace(drive, ratio=(2.0, 90.0))
    still = replace(drive, no_load_speed=math.inf)
    for text in (
        acceleration(drive, 5.0),
        acceleration(drive),
        least_move_time(still, 9.0),
        swing(drive, 1, 2),
    ):
        x = text.bounds()[2][None]
        before = text.batch(x)
        for q in text.parameters:
            after = text.at(**{q.name: 1.01 * q.value}).batch(x)
            assert not np.array_equal(
                np.r_[before.F[0], before.G[0]], np.r_[after.F[0], after.G[0]]
            )


def test_impossible_drives_are_proven_and_named():
    weak = acceleration(replace(REAL, ratio=(1.0, 8.0)))
    exact, ipopt = (solve(weak, m) for m in ("exact", "ipopt"))
    assert exact.status == ipopt.status == "infeasible"
    assert "-2.24" in exact.message
    assert ipopt.proof["conflict"] == ["motor_torque", "ratio_high"]
    stuck = acceleration(replace(BARE, motor_friction=60.0))
    assert [solve(stuck, m).status for m in ("exact", "ipopt")] == ["infeasible"] * 2
    assert "own friction" in solve(stuck).message


@pytest.mark.parametrize("stages", few([1, 3, 2], 2))
def test_ratio_and_split_at_once_are_the_best_of_all_ratios(stages):
    """Nested: the least gear inertia by `core` for every total ratio, the best ratio by Brent."""
    from scipy.optimize import minimize_scalar

    pinion = 2e-4
    text = staged(REAL, pinion, stages)
    assert tape.kinds(text).log_convex
    result = solve(text)
    assert result.status == "optimal" and result.gap < 1e-9
    assert solve(text, "gp").value == pytest.approx(result.value, rel=1e-7)

    def inverse(log_ratio):
        n = math.exp(log_ratio)
        least = core(n, stages)
        gears = pinion * solve(least, None if least.methods else "ipopt").value
        return 1.0 / load_acceleration(n, J_L, J_M + gears, 47.0, F_L)

    found = minimize_scalar(inverse, bounds=(2.5, 5.0), method="bounded", options={"xatol": 1e-7})
    assert result.value == pytest.approx(found.fun, rel=1e-11)
    ratios = np.atleast_1d(result.design["stage_ratio"])
    assert math.prod(ratios) == pytest.approx(math.exp(found.x), rel=1e-5)
    light = solve(staged(REAL, 1e-12, stages))
    assert 1.0 / light.value == pytest.approx(best_ratio(REAL)[1], rel=1e-6)


def some_drive(rng):
    """A drive with numbers over seven decades, some of them 0 or infinite."""

    def some(share, spread):
        return 0.0 if rng.random() < share else float(np.exp(rng.uniform(-spread, spread)))

    return Drive(
        some(0.1, 8.0),
        some(0.1, 8.0) or 1e-3,
        float(np.exp(rng.uniform(-5.0, 8.0))),
        some(0.3, 8.0),
        some(0.5, 4.0),
        some(0.6, 8.0),
        float(rng.uniform(0.3, 1.0)),
        some(0.5, 8.0) or math.inf,
        some(0.4, 8.0) or math.inf,
        (float(np.exp(rng.uniform(-2.0, 2.0))), 200.0 * some(0.5, 3.0) or math.inf),
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_closed_form_and_ipopt_agree_on_any_drive(seed):
    rng, seen = np.random.default_rng(seed), set()
    for _ in range(15):
        drive = some_drive(rng)
        turn, speed = np.exp(rng.uniform(-3.0, 5.0, 2))
        for text in (
            acceleration(drive, speed),
            least_move_time(replace(drive, no_load_speed=math.inf), turn),
            swing(replace(drive, efficiency=1.0), turn, speed),
        ):
            exact, ipopt = (solve(text, m) for m in ("exact", "ipopt"))
            assert exact.status == ipopt.status
            seen.add(exact.status)
            if exact.value is not None:
                assert exact.value == pytest.approx(ipopt.value, rel=1e-9)
    assert seen == {"optimal", "infeasible"}


@pytest.mark.parametrize(
    "wrong",
    [
        {"efficiency": 0.0},
        {"efficiency": 1.01},
        {"torque": -1.0},
        {"load_inertia": math.nan},
        {"load_inertia": 0.0, "motor_inertia": 0.0},
        {"ratio": (5.0, 2.0)},
        {"ratio": (0.0, 2.0)},
    ],
)
def test_what_is_no_drive_is_refused(wrong):
    with pytest.raises(ValueError):
        replace(BARE, **wrong)


def test_what_is_no_duty_is_refused():
    for wrong in (
        lambda: acceleration(replace(BARE, torque=0.0)),
        lambda: acceleration(BARE, -2.0),
        lambda: least_move_time(BARE, 0.0),
        lambda: swing(BARE, 1.0, math.inf),
    ):
        with pytest.raises(ValueError, match="positive"):
            wrong()


def test_duties_that_the_laws_do_not_cover_are_refused():
    with pytest.raises(ValueError, match="no_load_speed"):
        least_move_time(replace(BARE, no_load_speed=800.0), 1.0)
    with pytest.raises(ValueError, match="losses"):
        swing(replace(BARE, efficiency=0.9), 1.0, 1.0)


def test_the_bound_is_below_the_law_and_refuses_what_is_no_minimum():
    def law(n):
        return n + 100.0 / n

    bound = convex_bound(law, 10.0, 1.0, 1e6)
    assert 20.0 * (1.0 - 1e-9) < bound < 20.0
    assert convex_bound(law, 10.1, 1.0, 1e6) is None
    assert convex_bound(law, 9.9, 1.0, 1e6) is None
    edge = convex_bound(law, 12.0, 12.0, 1e6)
    assert law(12.0) * (1.0 - 1e-9) < edge < law(12.0)
    assert convex_bound(law, 12.0, 1.0, 12.0) is None
    for power, low, high in ((-1.0, 1.0, 1.0 + 5e-6), (1.0, 1.0 - 5e-6, 1.0)):
        beside = convex_bound(lambda n, power=power: n**power, 1.0, low, high)
        assert 1.0 - 2e-5 < beside < min(low**power, high**power)  # the least is within one step
    assert convex_bound(lambda n: 1.0 / n, 2.0, 1.0, 100.0, room=1e-12) is None  # no step at all
