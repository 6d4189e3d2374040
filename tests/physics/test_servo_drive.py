"""Servo drive laws against known numbers, the time domain, and the laws' own limits."""

import math

import numpy as np
import pytest

from gearopt.physics.gears import disc_inertia, disc_mass
from gearopt.physics.servo_drive import (
    best_acceleration,
    load_acceleration,
    move_time,
    reflected_inertia,
    rms_torque,
    shortest_move_time,
    torque_slope,
)

J_L, J_M = 19.8, 8.6e-3  # t mm2: 1.98e-2 and 8.6e-6 kg m2
FRICTION = 4.3 * 98.0665  # N mm: 4.3 kgf cm


@pytest.mark.parametrize(
    ("case", "accelerations"),
    [
        ({"torque": 50.0}, (60.584034, 60.584030)),
        ({"torque": 47.0}, (56.948992, 56.948988)),
        ({"torque": 47.0, "load_friction": FRICTION}, (47.287374, 46.304224)),
        ({"torque": 47.0, "load_friction": FRICTION, "efficiency": 0.9}, (44.417347, 42.747476)),
        (
            {
                "torque": 47.0,
                "load_friction": FRICTION,
                "torque_slope": torque_slope(50.0, 5.0, 800.0),
            },
            (28.626103, 28.129015),
        ),
    ],
)
def test_accelerations_known_independently(case, accelerations):
    """At the printed best ratio, and at 48."""
    best = {
        (False, False): 47.982555,
        (True, False): 57.786211,
        (True, True): 61.520067,
    }
    ratio = best["load_friction" in case, "efficiency" in case]
    ratio = 42.063097 if "torque_slope" in case else ratio
    for n, a in zip((ratio, 48.0), accelerations, strict=True):
        assert load_acceleration(n, J_L, J_M, **case) == pytest.approx(a, abs=6e-7)


def test_power_balance_of_motor_and_load():
    """Motor: T - T_s = J_M N a; load: eta N T_s - F_L = J_L a, T_s the torque at the train."""
    n, torque, friction, eta, b = 31.0, 47.0, 250.0, 0.85, 0.2
    a = load_acceleration(n, J_L, J_M, torque, friction, eta, b)
    shaft = torque - b * n - J_M * n * a
    assert eta * n * shaft - friction == pytest.approx(J_L * a, rel=1e-12)
    assert reflected_inertia(J_L, J_M, n, eta) == pytest.approx(
        (eta * n * (torque - b * n) - friction) / a, rel=1e-12
    )


def test_best_acceleration_is_that_of_the_inertia_match():
    best = math.sqrt(J_L / J_M)
    assert best == pytest.approx(47.98255, abs=6e-6)
    peak = best_acceleration(J_L, J_M, 50.0)
    assert load_acceleration(best, J_L, J_M, 50.0) == pytest.approx(peak, rel=1e-14)
    assert 1.0 - load_acceleration(48.0, J_L, J_M, 50.0) / peak == pytest.approx(6.6e-8, abs=6e-10)
    loss = 1.0 - load_acceleration(50 / 8 * 122 / 13, J_L, J_M, 50.0) / peak
    assert loss == pytest.approx(0.020, abs=5e-4)


def test_friction_of_the_motor_only_scales():
    ratios = np.linspace(5.0, 200.0, 50)
    with_friction = load_acceleration(ratios, J_L, J_M, 47.0)
    assert np.allclose(with_friction / load_acceleration(ratios, J_L, J_M, 50.0), 0.94, rtol=1e-14)


def test_move_times_known_independently():
    for angle, ratio, seconds in (
        (math.pi / 2, 47.982555, 0.322041),
        (6 * math.pi, 29.959500, 1.196456),
        (60 * math.pi, 13.906000, 5.052376),
    ):
        a = load_acceleration(ratio, J_L, J_M, 50.0)
        assert shortest_move_time(angle, 800.0 / ratio, a) == pytest.approx(seconds, abs=6e-7)
    best = math.sqrt(J_L / J_M)
    a = load_acceleration(best, J_L, J_M, 50.0)
    assert shortest_move_time(6 * math.pi, 800 / best, a) == pytest.approx(1.405762, abs=6e-7)
    assert shortest_move_time(60 * math.pi, 800 / best, a) == pytest.approx(11.5808, abs=6e-5)


def test_the_time_of_a_move_is_the_integral_of_its_speed():
    angle, peak, a = 6.0, 2.0, 5.0
    t = np.linspace(0.0, move_time(angle, peak, a), 200_001)
    speed = np.minimum(np.minimum(a * t, a * (t[-1] - t)), peak)
    assert np.trapezoid(speed, t) == pytest.approx(angle, rel=1e-9)
    assert shortest_move_time(angle, math.inf, a) == pytest.approx(2 * math.sqrt(angle / a))


def test_rms_torque_is_the_time_domain_mean():
    n, amplitude, omega = 48.469, math.radians(20.0), 4.0 * math.pi
    peak = amplitude * omega**2
    t = np.linspace(0.0, 2.0 * math.pi / omega, 200_001)[:-1]
    torque = -(J_L / n + n * J_M) * peak * np.sin(omega * t)
    torque += (100.0 / n + 3.0) * np.sign(np.cos(omega * t))
    law = rms_torque(n, J_L, J_M, peak, 100.0, 3.0)
    assert law == pytest.approx(math.sqrt(np.mean(torque**2)), rel=1e-5)
    assert law == pytest.approx(32.5656, abs=6e-5)


def test_discs_of_the_paper():
    """Solid discs of Table 1's gears: 2.34, 84.1, 6.17, 395 g at 7.75 g/cm3."""
    for d, grams in ((8, 2.34), (48, 84.1), (13, 6.17), (104, 395.0)):
        assert disc_mass(7.75e-9, 6.0, d) == pytest.approx(grams * 1e-6, rel=3e-3)
        assert disc_inertia(7.75e-9, 6.0, d) == pytest.approx(
            disc_mass(7.75e-9, 6.0, d) * d * d / 8.0, rel=1e-14
        )
