"""Time integration: the kernels are the physics text, orders are slopes, invariants stay."""

import math

import numpy as np
import pytest
from moving_pairs import paper_pair
from scipy import integrate

from gearopt.formulations.dynamics.motion.integrate import (
    MARCH,
    composition,
    deformation,
    march,
    numbers,
)
from gearopt.formulations.dynamics.motion.reference import cvodes, scipy_motion
from gearopt.formulations.dynamics.motion.simulate import exact_motion, piecewise_linear, simulate
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget
from gearopt.physics.motion.accelerations import LEVELS
from gearopt.physics.motion.moving_pair import turns
from gearopt.physics.motion.stiffness_wave import fourier, trapezoid

KINDS = ("exact", "tangent", "paper", "paper_linear")
TIMES = np.linspace(0.0, 0.002, 41)


@pytest.mark.parametrize("level", list(LEVELS))
@pytest.mark.parametrize("kind", KINDS)
def test_the_kernel_computes_what_the_physics_says(level, kind):
    """On all flanks: the contact decides by delta, whatever the coordinates."""
    pair = paper_pair(kind, ky=2e3, bearing=0.01, damping=0.1, drag=0.02, backlash=0.1)
    size, law = LEVELS[level]
    model, kernels = numbers(pair, level), kernel(MARCH)
    rng, flanks = np.random.default_rng(1), set()
    for _ in range(30):
        state = rng.normal(size=2 * size) * np.repeat((0.3, 30.0), size)
        out, flank = np.empty(2 * size), int(kernels.flank_now(model.pair, state))
        kernels.rates(*model, 0.0, 2e5, flank, state, out)
        known = law(pair, 2e5, state[:size], state[size:])
        assert out[:size] == pytest.approx(state[size:])
        assert out[size:] == pytest.approx(np.array(known), rel=1e-9, abs=1e-6)
        flanks.add(flank)
    assert flanks == {0, 1, 2} or level == "angles"


def test_levels_agree_where_they_describe_one_motion():
    """Isotropic bearings from rest: exact = tangent = on the line; angles and way = delta."""
    wave = trapezoid(2e5, 0.5, 0.6, 0.1)
    more = {"wave": wave, "frequency": 1000.0, "damping": 0.2, "bearing": 0.01}
    found = {}
    for kind, level in [("exact", name) for name in LEVELS] + [("tangent", "plane")]:
        pair = paper_pair(kind, **more)
        start = np.zeros(2 * LEVELS[level][0])
        found[kind, level] = march(pair, level, timeline(pair, TIMES), "rk8", 2.5e-6, start).delta
    scale = np.max(np.abs(found["exact", "plane"]))
    for key, delta in found.items():
        if key[1] != "fixed":  # whose axes do not move
            assert np.max(np.abs(delta - found["exact", "plane"])) < 1e-11 * scale, key


@pytest.mark.parametrize(("kind", "drifts"), [("exact", 0.0), ("paper", 2.3333)])
def test_momentum_of_a_free_pair_is_kept_by_the_exact_kinematics_alone(kind, drifts):
    """Without bearings and torques. Momentum relative to the pinion's largest spin; energy too."""
    pair = paper_pair(kind, kx=0.0, torques=(0.0, 0.0))
    start = np.zeros(12)
    start[:6] = 0.0, 0.0, 1e-3, 1.0, 0.5, 0.0
    made = march(pair, "angles", timeline(pair, TIMES), "rk8", 2.5e-6, start)
    x1, y1, _, x2, y2, _, vx1, vy1, w1, vx2, vy2, w2 = made.states.T
    centre = 140.0 / math.cos(math.radians(20.0))
    orbital = 6e-4 * (x1 * vy1 - y1 * vx1) + 9e-4 * ((centre + x2) * vy2 - y2 * vx2)
    momentum = orbital + 2.0 * w1 + 4.0 * w2
    drift = np.max(np.abs(momentum)) / np.max(np.abs(2.0 * w1))
    assert drift == pytest.approx(drifts, rel=1e-2, abs=1e-14)
    kinetic = 6e-4 * (vx1**2 + vy1**2) + 9e-4 * (vx2**2 + vy2**2) + 2.0 * w1**2 + 4.0 * w2**2
    energy = 0.5 * kinetic + 0.5 * 2e5 * made.delta**2
    assert energy == pytest.approx(energy[0], rel=1e-12)


@pytest.mark.parametrize("kind", ["exact", "paper"])
def test_energy_is_what_torques_stiffness_and_damping_give_and_take(kind):
    """d/dt(T + V) = T_1 theta_1' + k'(t) delta^2/2 - c delta'^2 - c_b sum(x'^2 + y'^2)."""
    pair = paper_pair(kind, wave=fourier(2e5, (5e4,)), frequency=1000.0, damping=0.2, bearing=0.01)
    times = np.linspace(0.0, 0.002, 4001)
    made = march(pair, "angles", timeline(pair, times), "rk8", 1e-6, np.zeros(12))
    x1, y1, _, x2, y2, _, vx1, vy1, w1, vx2, vy2, w2 = made.states.T
    phase = 2.0 * math.pi * 1000.0 * times
    k, grows = 2e5 + 5e4 * np.cos(phase), -5e4 * 2.0 * math.pi * 1000.0 * np.sin(phase)
    gu, gv = pair.contact(x2 - x1, y2 - y1).gradient
    rate = gu * (vx2 - vx1) + gv * (vy2 - vy1) - 60.0 * w1 - 80.0 * w2
    kinetic = 6e-4 * (vx1**2 + vy1**2) + 9e-4 * (vx2**2 + vy2**2) + 2.0 * w1**2 + 4.0 * w2**2
    energy = 0.5 * (kinetic + 1e3 * (x1**2 + y1**2 + x2**2 + y2**2) + k * made.delta**2)
    power = 2e5 * w1 + 0.5 * grows * made.delta**2 - 0.2 * rate**2
    power -= 0.01 * (vx1**2 + vy1**2 + vx2**2 + vy2**2)
    given = integrate.simpson(power, x=times)
    assert energy[-1] - energy[0] == pytest.approx(given, rel=1e-8) and given > 1e4


def test_angles_follow_from_delta_and_a_closed_form():
    pair = paper_pair()
    made = march(pair, "plane", timeline(pair, TIMES), "rk8", 2.5e-6, np.zeros(10)).states
    angles = march(pair, "angles", timeline(pair, TIMES), "rk8", 2.5e-6, np.zeros(12)).states
    u, v = made[:, 3] - made[:, 0], made[:, 4] - made[:, 1]
    way = pair.contact(u, v).approach - made[:, 2]
    rigid = 0.5 * (2e5 / 60.0) * TIMES**2
    found = turns(pair, way, rigid)
    assert found.pinion == pytest.approx(angles[:, 2], rel=1e-9, abs=1e-12)
    assert found.wheel == pytest.approx(angles[:, 5], rel=1e-9, abs=1e-12)


def test_yoshidas_weights_meet_the_conditions_of_order_6():
    """Their sum is 1, and sums of third and fifth powers, nested as he has them, vanish."""
    w = composition()
    assert w == pytest.approx(w[::-1]) and w.sum() == pytest.approx(1.0, abs=1e-14)
    assert np.sum(w**3) == pytest.approx(0.0, abs=1e-12)
    assert np.sum(w**5) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("above", [2e-3, 1e-5])
@pytest.mark.parametrize("start", [0.0, 0.3, 0.7])
def test_no_short_separation_is_stepped_over(above, start):
    """A swing to `above` of the static compression: a flight of 2 sqrt(2 above), far below a look.

    Started after a part of an arc, told at other times: looks lie anywhere around crests.
    """
    pair, size = paper_pair(backlash=1.0), 1.0 + above
    wn, still = math.sqrt(2e5 * 3400.0), pair.load / 2e5
    period = 2.0 * (math.pi - math.acos(1.0 / size)) + 2.0 * math.sqrt(size**2 - 1.0)
    state = still * np.array([-1.0 - size * math.cos(start), wn * size * math.sin(start)])
    asked = np.sort(np.append(np.linspace(0.0, 19.1 * period, 78), 4.5 * period - start))
    where = np.searchsorted(asked, 4.5 * period - start)
    times = timeline(pair, np.append(asked, 20.0 * period - start) / wn)
    made = march(pair, "fixed", times, "rk8", period / wn / 40.0, state)
    assert made.events == 40
    crest = 0.5 * (size**2 - 1.0)
    found = made.delta[[where, -1]] / still
    assert found == pytest.approx([crest, -1.0 - size], abs=1e-10)


def test_both_flanks_and_the_teeth_of_a_free_pair_keep_the_energy():
    """In the plane, with a backlash that grows with the centre distance."""
    pair = paper_pair(torques=(0.0, 0.0), backlash=0.05)
    start = np.zeros(10)
    start[2], start[7] = -0.02, 900.0
    times = np.linspace(0.0, 0.005, 51)
    made = march(pair, "plane", timeline(pair, times), "rk8", 1e-6, start)
    x1, y1, delta, x2, y2, vx1, vy1, rate, vx2, vy2 = made.states.T
    u, v = x2 - x1, y2 - y1
    distance = np.hypot(pair.rest.centre_distance + u, v)
    inv = [math.tan(a) - a for a in np.arccos(140.0 / distance)]
    room = 0.05 + 280.0 * (np.array(inv) - math.tan(math.radians(20)) + math.radians(20))
    pressed = np.minimum(delta, 0.0) ** 2 + np.minimum(room - delta, 0.0) ** 2
    sliding = np.array(pair.contact(u, v).gradient) * np.array([vx2 - vx1, vy2 - vy1])
    spin = pair.mesh_mass * (sliding.sum(axis=0) - rate) ** 2
    kinetic = 6e-4 * (vx1**2 + vy1**2) + 9e-4 * (vx2**2 + vy2**2) + spin
    held = 1e3 * (x1**2 + y1**2 + x2**2 + y2**2)
    energy = 0.5 * (kinetic + held + 2e5 * pressed)
    assert energy == pytest.approx(energy[0], rel=1e-9)
    assert made.events > 8 and delta.max() > room.min()  # on the coast flank too


def test_library_methods_agree():
    wave, times = trapezoid(2e5, 0.5, 0.6, 0.1), np.linspace(0.0, 4e-4, 9)
    pair = paper_pair("paper", wave=wave, frequency=1000.0)
    known = march(pair, "plane", timeline(pair, times), "rk8", 1e-6, np.zeros(10)).delta
    scale = np.max(np.abs(known))
    for method, rtol, off in (
        ("DOP853", 1e-11, 1e-8),
        ("LSODA", 1e-9, 1e-5),
        ("Radau", 1e-6, 1e-3),
    ):
        found = scipy_motion(pair, "plane", times, method, rtol, np.zeros(10)).delta
        assert np.max(np.abs(found - known)) < off * scale
    found = cvodes(pair, "plane", times, 1e-10)(np.zeros(10)).delta
    assert np.max(np.abs(found - known)) < 1e-6 * scale


def test_a_library_method_follows_teeth_that_part():
    pair, start = paper_pair(backlash=1.0), np.array([-0.03, 0.0])
    times = np.linspace(0.0, 6e-4, 7)
    known = march(pair, "fixed", timeline(pair, times), "rk8", 5e-6, start).delta
    found = scipy_motion(pair, "fixed", times, "DOP853", 1e-11, start)
    assert found.delta == pytest.approx(known, abs=1e-9) and found.events == 4


@pytest.mark.parametrize("error", [1e-3, 1e-6, 1e-9])
def test_the_error_asked_is_reached_and_told(error):
    for pair, level in (
        (paper_pair("paper", wave=trapezoid(2e5, 0.5, 0.6, 0.1), frequency=1000.0), "plane"),
        (paper_pair(wave=fourier(2e5, (5e4,)), frequency=4000.0, damping=0.2), "line"),
        (paper_pair(backlash=0.05, wave=fourier(2e5, (9e4,)), frequency=8000.0), "fixed"),
    ):
        made = simulate(pair, level, TIMES, error)
        start = np.zeros(made.motion.states.shape[1])
        fine = march(pair, level, timeline(pair, TIMES), "rk8", 4e-7, start).delta
        off = np.max(np.abs(made.motion.delta - fine)) / np.max(np.abs(fine))
        assert made.met and made.error <= error and off <= max(made.error, 1e-11)
        assert made.method == "rk8" and made.rates >= made.motion.rates


def test_a_piecewise_linear_scene_is_solved_exactly():
    pair = paper_pair("tangent", wave=trapezoid(2e5, 0.5, 0.68), frequency=1000.0, damping=0.2)
    made = simulate(pair, "plane", TIMES, 1e-9)
    fine = march(pair, "plane", timeline(pair, TIMES), "rk8", 1e-6, np.zeros(10)).delta
    assert made.method == "exponential" and made.met
    assert np.max(np.abs(made.motion.delta - fine)) < made.error * np.max(np.abs(fine))
    assert deformation(pair, "plane", made.motion.states)[0] == 0.0
    assert not piecewise_linear(paper_pair(), "plane")
    for other in (paper_pair(), paper_pair("tangent", backlash=1.0)):
        with pytest.raises(ValueError, match="not piecewise linear"):
            exact_motion(other, "plane", timeline(other, TIMES), np.zeros(10))


def test_a_long_motion_begins_with_what_a_short_time_can_reach(monkeypatch):
    pair = paper_pair(wave=trapezoid(2e5, 0.5, 0.68, 0.1), frequency=1000.0, backlash=1.0)
    times = np.linspace(0.0, 100.0, 1_000_001)
    asked = []
    module = "gearopt.formulations.dynamics.motion.simulate.timeline"
    monkeypatch.setattr(module, lambda pair, times: asked.append(times) or timeline(pair, times))
    made = simulate(pair, "fixed", times, 1e-6, clock=Clock(Budget(seconds=0.05)))
    assert len(asked[0]) <= 150_000  # of the million
    assert made is None or (not made.met and made.times[-1] < 100.0)
    assert np.array_equal(asked[0], times[: len(asked[0])])


def test_symplectic_steps_are_refused_where_forces_depend_on_velocities():
    pair = paper_pair(damping=0.1)
    with pytest.raises(ValueError, match="without damping"):
        march(pair, "line", timeline(pair, TIMES), "symplectic", 1e-5, np.zeros(6))
