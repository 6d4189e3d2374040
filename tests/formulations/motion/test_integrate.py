"""Time integration: the kernels are the physics text, orders are slopes, invariants stay."""

import math
from dataclasses import replace

import numpy as np
import pytest
from moving_pairs import paper_pair

from gearopt.formulations.motion.exponential import exact_motion, piecewise_linear
from gearopt.formulations.motion.integrate import (
    ALPHA,
    ALPHAS,
    MARCH,
    STEPPERS,
    composition,
    generalised,
    march,
)
from gearopt.formulations.motion.numbers import deformation, numbers
from gearopt.formulations.motion.reference import cvodes, scipy_motion
from gearopt.formulations.motion.simulate import simulate
from gearopt.formulations.motion.timeline import timeline
from gearopt.optimise.kernels import kernel
from gearopt.physics.motion.accelerations import LEVELS
from gearopt.physics.motion.linear import static
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


@pytest.mark.parametrize(("kx", "known"), [(1e3, 0.0400), (1e4, 0.0151), (1e5, 0.00547)], ids=str)
@pytest.mark.slow
def test_on_anisotropic_bearings_exact_and_tangent_differ(kx, known):
    """By 4, 1.5 and 0.5 % of the RMS over 50 ms for k_y = 3 k_x."""
    wave, times = trapezoid(2e5, 0.5, 0.68, 0.1), np.linspace(0.0, 0.05, 2501)
    made = []
    for kind in ("exact", "tangent"):
        pair = paper_pair(kind, kx=kx, ky=3 * kx, wave=wave, frequency=1000.0)
        pair = replace(pair, damping=2 * 0.03 * math.sqrt(2e5 * pair.mesh_mass))
        made.append(march(pair, "plane", timeline(pair, times), "rk8", 2e-6, np.zeros(10)).delta)
    exact, tangent = made
    rms = np.sqrt(np.mean((exact - tangent) ** 2) / np.mean(tangent**2))
    assert rms == pytest.approx(known, rel=0.02)


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


DIGITS = {
    0.02: (1e-10, 1e-8),
    1.0: (3e-7, 3e-5),
}  # of theta: 8.3e-10 and 3.0e-6, by another program


@pytest.mark.parametrize(
    "end", [0.02, pytest.param(1.0, marks=pytest.mark.slow)], ids=["20 ms", "1 s"]
)
def test_delta_keeps_its_digits_while_the_gears_speed_up(end):
    """From the relative equilibrium, where delta is constant: 449,000 rpm after a second."""
    pair = paper_pair("paper")
    rest, n = static(pair), 21
    x1, y1, x2, y2 = rest.axes
    way = float(pair.contact(*rest.apart).approach) - rest.delta
    times, errors = timeline(pair, np.linspace(0.0, end, n)), []
    for level, third in (("angles", way / 60.0), ("way", way), ("plane", rest.delta)):
        start = np.zeros(2 * LEVELS[level][0])
        start[:5] = x1, y1, third, x2, y2
        made = march(pair, level, times, "rk8", 1e-6 if end > 0.1 else 4e-6, start)
        errors.append(np.max(np.abs(made.delta / rest.delta - 1.0)))
    assert errors[2] < 1e-13 < 1e-12 < errors[1] < 1e-9
    least, most = DIGITS[end]  # of a random walk of roundings: the magnitude alone is repeatable
    assert least < errors[0] < most


@pytest.mark.parametrize("method", list(STEPPERS))
def test_orders_are_slopes(method):
    pair = paper_pair("tangent", kx=1e5, wave=trapezoid(2e5, 0.5, 0.6, 0.1), frequency=1000.0)
    times = timeline(pair, TIMES)
    known = march(pair, "line", times, "rk8", 1e-6, np.zeros(6)).delta
    steps = {"rk8": 25e-6, "rk4": 5e-6, "symplectic": 12.5e-6}.get(method, 1e-6)
    errors = [
        np.max(np.abs(march(pair, "line", times, method, h, np.zeros(6)).delta - known))
        for h in (steps, steps / 2.0)
    ]
    order = math.log2(errors[0] / errors[1])
    assert order == pytest.approx(STEPPERS[method].order, abs=0.25)


def test_a_kink_inside_a_step_costs_the_order():
    """A rectangle with steps that miss its jumps: order 1 to 2, for every method."""
    pair = paper_pair("tangent", kx=1e5, wave=trapezoid(2e5, 0.5, 0.683), frequency=1000.0)
    known = exact_motion(pair, "line", timeline(pair, TIMES), np.zeros(6)).delta

    def error(aligned, h):
        times = timeline(
            pair, np.arange(0.0, 0.002 + 0.5 * h, h) if not aligned else TIMES, aligned
        )
        made = march(pair, "line", times, "rk8", h, np.zeros(6)).delta
        return np.max(np.abs(made[:: 1 if aligned else round(5e-5 / h)] - known))

    missed = [error(False, h) for h in (1.25e-5, 6.25e-6, 3.125e-6)]
    assert 1.0 < missed[0] / missed[2] < 2.0**4.5  # at most order 2
    hit = [error(True, h) for h in (2.5e-5, 1.25e-5)]
    assert math.log2(hit[0] / hit[1]) > 7.0 and hit[1] < 1e-3 * missed[1]


def test_yoshidas_weights_meet_the_conditions_of_order_6():
    """Their sum is 1, and sums of third and fifth powers, nested as he has them, vanish."""
    w = composition()
    assert w == pytest.approx(w[::-1]) and w.sum() == pytest.approx(1.0, abs=1e-14)
    assert np.sum(w**3) == pytest.approx(0.0, abs=1e-12)
    assert np.sum(w**5) == pytest.approx(0.0, abs=1e-12)


def test_teeth_that_part_follow_the_closed_form():
    """Released at three times the static compression: an arc of 4 pi/3, a flight of 2 sqrt(3)."""
    pair = paper_pair(backlash=1.0)
    wn, still = math.sqrt(2e5 * 3400.0), pair.load / 2e5
    period = (4.0 * math.pi / 3.0 + 2.0 * math.sqrt(3.0)) / wn
    assert period == pytest.approx(2.9347500446e-4, rel=1e-10)
    times = timeline(pair, np.array([0.0, 0.5, 1.0, 9.5, 10.0]) * period)
    start = np.array([-3.0 * still, 0.0])
    made = march(pair, "fixed", times, "rk8", period / 40.0, start)
    assert made.delta / still == pytest.approx([-3.0, 1.5, -3.0, 1.5, -3.0], abs=1e-11)
    assert made.events == 20
    assert 1.5 * still == pytest.approx(13.2353e-3, rel=1e-5)


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


@pytest.mark.parametrize("steps", [20, 40, 80])
def test_newmarks_period_is_too_long(steps):
    """By atan: 1e4 periods of 2 pi/n lose 81.05, 20.49 and 5.14 cycles."""
    lost = {20: 81.05, 40: 20.49, 80: 5.14}[steps]
    wn = math.sqrt(2e5 * 3400.0)
    period = 2.0 * math.pi / wn
    pair = paper_pair(torques=(0.0, 0.0))
    times = timeline(pair, np.linspace(0.0, 500 * period, 501))
    made = march(pair, "fixed", times, "newmark", period / steps, np.array([1.0, 0.0])).states
    phase = np.unwrap(np.angle(made[:, 0] - 1j * made[:, 1] / wn))
    cycles = -phase[-1] / (2.0 * math.pi) * 20.0  # of 1e4 periods; whole ones are unseen
    assert abs(cycles) == pytest.approx(lost, rel=5e-3)


@pytest.mark.parametrize("ratio", [1e3, 1e5])
def test_a_stiff_mesh_moves_the_axes_as_a_rigid_one(ratio):
    """u_1 after 20 ms against two axes tied by the teeth; delta falls with the stiffness."""
    pair = paper_pair("tangent", k=ratio * 1e3)
    me, load = pair.mesh_mass, pair.load
    masses = np.array([[6e-4 + me, -me], [-me, 9e-4 + me]])
    root = np.linalg.cholesky(masses)
    inverse = np.linalg.inv(root)
    square, shapes = np.linalg.eigh(inverse @ (1e3 * np.eye(2)) @ inverse.T)
    shapes = inverse.T @ shapes
    ends = np.array([-load, load]) / 1e3
    gone = shapes @ (shapes.T @ masses @ ends * np.cos(np.sqrt(square) * 0.02))
    rigid = ends - gone
    times = timeline(pair, np.linspace(0.0, 0.02, 401))
    made = march(pair, "line", times, "newmark", 6.25e-6, np.zeros(6))
    assert made.states[-1, 0] == pytest.approx(rigid[0], abs=4e-4 * np.max(np.abs(ends)) * 2)
    scale = np.mean(made.delta[-50:]) * ratio * 1e3 / load
    assert -1.5 < scale < -1.1  # the static deformation is -1


def test_newmark_rings_where_numerical_damping_does_not():
    """k_m/k_b = 1e4, steps beyond the mesh mode: deviation over mean of delta at the end."""
    pair = paper_pair("tangent", k=1e7)
    times = timeline(pair, np.linspace(0.0, 0.02, 401))
    given = times.starts, times.lengths, times.k0, times.k1, times.counts(6.25e-6)
    rough = {}
    for name, alphas in (("newmark", ALPHAS["newmark"]), ("alpha", generalised(0.5))):
        out = np.empty((400, 6))
        kernel(ALPHA).advance(*numbers(pair, "line"), alphas, *given, np.zeros(6), out)
        rough[name] = abs(out[-50:, 1].std() / out[-50:, 1].mean())
    assert rough["newmark"] == pytest.approx(0.30, abs=0.01)  # 7.079e-8/2.370e-7
    assert rough["alpha"] == pytest.approx(0.077, abs=2e-3)  # the true slow variation


def test_library_methods_agree():
    wave, times = trapezoid(2e5, 0.5, 0.6, 0.1), TIMES[:21]
    pair = paper_pair("paper", wave=wave, frequency=1000.0)
    known = march(pair, "plane", timeline(pair, times), "rk8", 1e-6, np.zeros(10)).delta
    scale = np.max(np.abs(known))
    found = scipy_motion(pair, "plane", times, "DOP853", 1e-11, np.zeros(10)).delta
    assert np.max(np.abs(found - known)) < 1e-7 * scale
    found = cvodes(pair, "plane", times, 1e-10)(np.zeros(10)).delta
    assert np.max(np.abs(found - known)) < 1e-5 * scale
    parted = paper_pair(backlash=1.0)
    start, times = np.array([-0.03, 0.0]), np.linspace(0.0, 6e-4, 7)
    known = march(parted, "fixed", timeline(parted, times), "rk8", 5e-6, start).delta
    found = scipy_motion(parted, "fixed", times, "DOP853", 1e-11, start)
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


def test_symplectic_steps_are_refused_where_forces_depend_on_velocities():
    pair = paper_pair(damping=0.1)
    with pytest.raises(ValueError, match="without damping"):
        march(pair, "line", timeline(pair, TIMES), "symplectic", 1e-5, np.zeros(6))
