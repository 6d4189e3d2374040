"""Ratio and train together for a duty: against enumeration by other code, and known numbers."""

import math
from dataclasses import replace
from fractions import Fraction as F

import numpy as np
import pytest
from campaigns import few
from servo_trains import PAPER, trains_within
from uncompiled import uncompiled

from gearopt.formulations.servo.ratio import Drive, ServoDuty, best_ratio
from gearopt.formulations.servo.split import problem, relaxation
from gearopt.formulations.servo.split.numbers import numbers
from gearopt.formulations.servo.split.teeth import KERNEL
from gearopt.optimise import tape
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve

DRIVE = Drive(19.8, 8.6e-3, 50.0, 421.68595, 3.0)
MOVE = ServoDuty(replace(DRIVE, speed_limit=800.0), "move", angle=6.0 * math.pi)
SWING = ServoDuty(
    replace(DRIVE, torque=0.0, load_friction=100.0),
    "swing",
    amplitude=math.radians(20.0),
    angular_frequency=4.0 * math.pi,
)
FASTEST = ServoDuty(DRIVE, "acceleration")
SMALL = replace(
    PAPER,
    pinion_teeth=(14, 18),
    max_wheel_teeth=44,
    shaft=None,
    lost_motion=None,
    error=math.inf,
    bending=5000.0,
)


def any_duty(rng, ratio):
    """A duty whose best ratio is somewhere about a ratio, with everything that may bind."""
    load = float(10.0 ** rng.uniform(-3.0, 1.0))
    torque, eta = float(rng.uniform(5.0, 60.0)), float(rng.uniform(0.7, 1.0))
    drive = Drive(
        load_inertia=load,
        motor_inertia=load / ratio**2 * float(rng.uniform(0.3, 3.0)),
        torque=torque,
        load_friction=float(rng.uniform(0.0, 0.9)) * torque * ratio,
        motor_friction=float(rng.uniform(0.0, 0.2)) * torque,
        efficiency=eta,
    )
    kind = rng.integers(4)
    if kind == 0:
        return ServoDuty(drive, "acceleration")
    if kind == 1:
        line = replace(drive, no_load_speed=float(rng.uniform(1.5, 6.0)) * ratio)
        return ServoDuty(line, "acceleration", load_speed=1.0)
    if kind == 2:
        limited = replace(drive, speed_limit=float(10.0 ** rng.uniform(0.0, 3.0)))
        return ServoDuty(limited, "move", angle=float(rng.uniform(0.1, 30.0)))
    plain = replace(drive, efficiency=1.0, torque=0.0)
    return ServoDuty(plain, "swing", amplitude=1.0, angular_frequency=float(rng.uniform(1.0, 9.0)))


def worth(duty, n, gears):
    """What the duty makes least, from the balance of torques; inf where the load does not move."""
    own = duty.drive
    rotor = own.motor_inertia + gears
    if duty.motion == "swing":
        w = duty.angular_frequency
        inertia = duty.amplitude * w * w * (own.load_inertia / n + n * rotor)
        return math.sqrt(inertia**2 / 2 + (own.load_friction / n + own.motor_friction) ** 2)
    at_speed = own.torque
    if duty.load_speed and math.isfinite(own.no_load_speed):
        at_speed *= 1 - n * duty.load_speed / own.no_load_speed
    out = own.efficiency * n * (at_speed - own.motor_friction) - own.load_friction
    a = out / (own.load_inertia + own.efficiency * n * n * rotor)
    if a <= 0.0:
        return math.inf
    if duty.motion == "acceleration":
        return 1.0 / a
    held = n * (own.torque + own.motor_friction) + own.load_friction  # which brake
    both = 1.0 / a + (own.load_inertia + n * n * rotor) / held
    v = min(math.sqrt(2.0 * duty.angle / both), own.speed_limit / n)
    return duty.angle / v + 0.5 * v * both


def pinion_torques(train, n1, n2, inertias):
    """Peak torques of both pinions in the motion: the motor's, less what turns before the mesh."""
    duty, own, (j1, middle, j4) = train.duty, train.duty.drive, inertias
    n, gears = n1 * n2, j1 + middle / n1**2 + j4 / (n1 * n2) ** 2
    rotor = own.motor_inertia + gears
    if duty.motion == "swing":
        ramp = duty.amplitude * duty.angular_frequency**2
        ramps = [(ramp * (own.load_inertia / n + n * rotor) + own.load_friction / n, ramp)]
    else:
        net = own.torque - own.motor_friction  # at standstill
        out = own.efficiency * n * net - own.load_friction
        a = max(out, 0.0) / (own.load_inertia + own.efficiency * n * n * rotor)
        ramps = [(net, a)]
    if duty.motion == "move":
        both = own.torque + own.motor_friction
        d = (n * both + own.load_friction) / (own.load_inertia + n * n * rotor)
        ramps.append((both, d))
    first = max(t - (own.motor_inertia + j1) * n * a for t, a in ramps)
    second = max(n1 * (t - (own.motor_inertia + j1) * n * a) - middle * n2 * a for t, a in ramps)
    return first, second


def full_enumeration(train):
    """Feasible trains that move the load, and the best value of all; whole numbers as fractions."""
    best, count = math.inf, 0
    for (z1, z2, z3, z4), (m1, m2) in trains_within(train):
        d1, d2, d3, d4 = (float(m * z) for m, z in ((m1, z1), (m1, z2), (m2, z3), (m2, z4)))
        n1, n2, width = z2 / z1, z4 / z3, train.face_width
        j1, j2, j3, j4 = (math.pi / 32 * train.density * width * d**4 for d in (d1, d2, d3, d4))
        moved = pinion_torques(train, n1, n2, (j1, j2 + j3, train.sector * j4))
        asked = train.output_torque / (n1 * n2), train.output_torque / n2
        loads = (max(asked[0], moved[0]), d1, m1, z1), (max(asked[1], moved[1]), d3, m2, z3)
        root = [2 * t / (d * width * float(m) * math.pi * (0.154 - 0.912 / z))
                for t, d, m, z in loads]  # fmt: skip
        if max(root) > train.bending:
            continue
        gears = j1 + (j2 + j3) / n1**2 + train.sector * j4 / (n1 * n2) ** 2
        value = worth(train.duty, n1 * n2, gears)
        if value < math.inf:
            best, count = min(best, value), count + 1
    return count, best


@pytest.mark.parametrize("seed", few(range(32), 3))
def test_it_is_what_full_enumeration_by_other_code_finds(seed):
    """Every other train has no output_torque: its teeth carry what the motion puts on them."""
    rng = np.random.default_rng(seed)
    modules = tuple(sorted(F(int(k), 20) for k in rng.choice(np.arange(6, 20), 2, replace=False)))
    middle = F(int(rng.integers(25, 70)), 10)
    train = replace(
        SMALL,
        ratio=middle,
        tolerance=F(int(rng.integers(1, 13)), 100),
        modules=modules,
        bore=F(int(rng.integers(16, 36)), 2) * modules[0],
        wheel_tips=(40 * modules[1], F(int(rng.integers(35, 47))) * modules[1]),
        bending=float(rng.uniform(300.0, 3000.0)),
        sector=float(rng.uniform(0.2, 1.0)),
        density=float(10.0 ** rng.uniform(-9.0, -7.0)),
    )
    train = replace(train, duty=any_duty(rng, float(middle)))
    if seed % 2:
        train = replace(train, output_torque=0.0, bending=float(10.0 ** rng.uniform(0.3, 1.6)))
    count, best = full_enumeration(train)
    goal = train.duty.goal
    whole, quick = (solve(problem(train, goal), m) for m in ("enumeration", "exact"))
    assert whole.proof["feasible_trains"] == count
    if count == 0:
        assert whole.status == quick.status == "infeasible"
        return
    assert whole.status == quick.status == "optimal" and quick.gap < 2e-11
    assert whole.value == pytest.approx(best, rel=1e-12)
    assert quick.value == pytest.approx(best, rel=1e-11)
    assert quick.bound <= best and solve(relaxation(train, goal)).bound <= best * (1 + 1e-12)


@pytest.mark.parametrize("seed", few(range(60), 2))
def test_the_trains_that_carry_a_motion_are_an_interval_of_every_row(seed):
    """Gears from light to far heavier than the load; every wheel of a row is looked at."""
    rng, code = np.random.default_rng(seed), uncompiled(KERNEL)
    duty = any_duty(rng, float(10.0 ** rng.uniform(0.3, 2.0)))
    density = float(10.0 ** rng.uniform(-9.0, -5.0))
    given = numbers(replace(SMALL, output_torque=0.0, bending=1.0, density=density, duty=duty))
    for _ in range(4):
        z1, z3 = (int(z) for z in rng.integers(14, 19, 2))
        z2, (m1, m2) = int(rng.integers(z1, 60)), rng.choice([0.3, 0.5, 1.0, 2.0], 2)
        low = int(rng.integers(z3, 80))
        row = range(low, low + int(rng.integers(1, 100)))
        used = [code.used(given, m1, z1, z2, m2, z3, z4) for z4 in row]
        limit = math.exp(rng.uniform(math.log(min(used)) - 0.05, math.log(max(used)) + 0.05))
        scaled = given._replace(tooth=given.tooth / limit)
        least, most = code.carried(scaled, m1, z1, z2, m2, z3, low, row[-1])
        kept = [z4 for z4, u in zip(row, used, strict=True) if u <= limit * (1.0 + 1e-11)]
        assert kept == list(range(least, most + 1))


@pytest.mark.parametrize("duty", [FASTEST, MOVE, SWING], ids=lambda d: d.motion)
@pytest.mark.parametrize(
    "ratio",
    [
        pytest.param((F(60), F(2, 3)), id="20-100"),
        pytest.param((F(48), F(1, 100)), id="48", marks=pytest.mark.slow),
    ],
)
def test_real_teeth_are_a_close_bound_of_whole_ones(duty, ratio):
    """The relaxation shares no text with the kernels: its duty is a variable and a limit."""
    train = replace(PAPER, duty=duty, ratio=ratio[0], tolerance=ratio[1])
    text = relaxation(train, duty.goal)
    assert tape.kinds(text).log_convex
    relaxed, result = solve(text), solve(problem(train, duty.goal))
    assert relaxed.status == result.status == "optimal" and relaxed.gap < 1e-9
    assert relaxed.bound <= result.value <= 1.01 * relaxed.bound


def test_gears_move_the_best_ratio_as_known_independently():
    """With 7.578e-7 kg m2 of the paper's gears: N* = 45.999, 4.1 % less acceleration."""
    plain = ServoDuty(replace(DRIVE, load_friction=0.0, motor_friction=0.0), "acceleration")
    ratio, most = best_ratio(plain.with_gears(7.578e-4).drive)
    assert ratio == pytest.approx(45.999, abs=6e-4)
    assert 100.0 * (1.0 - most / best_ratio(plain.drive)[1]) == pytest.approx(4.1, abs=0.06)


@pytest.mark.parametrize("seed", range(6))
def test_the_kernel_and_the_text_are_one_law_of_the_duty(seed):
    rng = np.random.default_rng(100 + seed)
    duty = any_duty(rng, 30.0)
    given, code = numbers(replace(PAPER, duty=duty)), uncompiled(KERNEL)
    for n, gears in zip(rng.uniform(1.0, 100.0, 50), 10.0 ** rng.uniform(-6, 0, 50), strict=True):
        found = code.moved(given.duty, n, gears)
        if math.isinf(found):
            assert duty.acceleration(n, gears) <= 0.0 and duty.value(n, gears) > 1e10
            assert duty.limits(n, 1.0)["friction_torque"] >= 1.0 - 1e-12
        else:
            assert found == pytest.approx(duty.value(n, gears), rel=1e-13)
            assert found == pytest.approx(worth(duty, n, gears), rel=1e-12)


def test_the_speed_limit_of_the_motor_is_kept_exactly():
    """A train of ratio 4 and no other: allowed at just 4, impossible below."""
    train = replace(SMALL, ratio=F(4), tolerance=F(0), modules=(F(1, 2),), bore=F(7))
    drive = replace(DRIVE, speed_limit=4.0, load_friction=0.0)
    at = ServoDuty(drive, "acceleration", load_speed=1.0, max_ratio=F(4))
    below = replace(at, max_ratio=F(4) - F(1, 10**20))
    for method in ("exact", "enumeration"):
        found = solve(problem(replace(train, duty=at), at.goal), method)
        assert found.status == "optimal" and found.limits["motor_speed"] == 1.0
        none = solve(problem(replace(train, duty=below), at.goal), method)
        assert none.status == "infeasible"


def test_a_swing_keeps_to_the_torque_of_the_motor():
    train = replace(PAPER, pinion_teeth=(16, 20), duty=SWING)
    least = solve(problem(train, SWING.goal)).value
    for factor, status in ((1.0 + 1e-6, "optimal"), (1.0 - 1e-6, "infeasible")):
        duty = replace(SWING, drive=replace(SWING.drive, torque=factor * least))
        for method in ("exact", "enumeration"):
            found = solve(problem(replace(train, duty=duty), duty.goal), method)
            assert found.status == status
        assert solve(relaxation(replace(train, duty=duty), duty.goal)).status == "optimal"


def test_where_no_train_moves_the_load_none_is_found():
    stuck = ServoDuty(replace(DRIVE, load_friction=1e5), "acceleration")
    train = replace(PAPER, pinion_teeth=(16, 20), duty=stuck)
    for method in ("exact", "enumeration"):
        assert solve(problem(train, stuck.goal), method).status == "infeasible"


def test_samplers_take_the_same_problem():
    train = replace(PAPER, duty=FASTEST, ratio=F(60), tolerance=F(2, 3), error=math.radians(0.12))
    text = problem(train, FASTEST.goal)
    result, best = solve(text, "annealing", Budget(evaluations=5_000), seed=1), solve(text).value
    assert result.status == "feasible" and best * (1.0 - 1e-11) <= result.value < 1.2 * best


def test_a_run_stops_when_told():
    train = replace(PAPER, duty=FASTEST)
    found = solve(problem(train, FASTEST.goal), watch=lambda event: False)
    assert found.status == "limit" and found.bound is None
