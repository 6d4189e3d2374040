"""Motions that are hard: separation, stiff meshes, long runs, resonance, equal frequencies, jumps.

Numbers to compare with: closed forms, and an independent program in SI units.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from moving_pairs import oscillator, paper_pair, steady

from gearopt.formulations.dynamics.motion.balance import linear_orbit
from gearopt.formulations.dynamics.motion.integrate import (
    ALPHA,
    ALPHAS,
    STEPPERS,
    generalised,
    march,
    numbers,
)
from gearopt.formulations.dynamics.motion.simulate import exact_motion
from gearopt.formulations.dynamics.motion.stability import largest
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.optimise.kernels import kernel
from gearopt.physics.motion.accelerations import LEVELS
from gearopt.physics.motion.linear import linear, mesh_shares, modes, static
from gearopt.physics.motion.moving_pair import turns
from gearopt.physics.motion.stiffness_wave import fourier, trapezoid

MODE = math.sqrt(2e5 * 3400.0)  # rad/s of the mesh on fixed axes
TURN = 2.0 * math.pi
TIMES = np.linspace(0.0, 0.002, 41)


def test_teeth_that_part_follow_the_closed_form():
    """Released at three times the static compression: an arc of 4 pi/3, a flight of 2 sqrt(3)."""
    pair = paper_pair(backlash=1.0)
    still = pair.load / 2e5
    period = (4.0 * math.pi / 3.0 + 2.0 * math.sqrt(3.0)) / MODE
    assert period == pytest.approx(2.9347500446e-4, rel=1e-10)
    assert 2.0 * math.pi / MODE == pytest.approx(2.409491574523e-4, rel=1e-12)  # of the linear pair
    times = timeline(pair, np.array([0.0, 0.5, 1.0, 9.5, 10.0]) * period)
    made = march(pair, "fixed", times, "rk8", period / 40.0, np.array([-3.0 * still, 0.0]))
    assert made.delta / still == pytest.approx([-3.0, 1.5, -3.0, 1.5, -3.0], abs=1e-11)
    assert made.events == 20
    assert 1.5 * still == pytest.approx(13.2353e-3, rel=1e-5)


STIFF = {  # k_m/k_b: r_1 after 20 ms by Newmark and by generalised alpha (rho 0.5) [m]; deviation
    # over mean of delta over the last 2.5 ms, of both
    1e3: ((-0.001986651057290289, -0.001986858145161461), (0.29326, 0.079340)),
    1e4: ((-0.001985811047202381, -0.0019858759262272826), (0.29873, 0.077018)),
    1e5: ((-0.0019857282680536574, -0.0019857787218873118), (0.36959, 0.077025)),
    1e6: ((-0.001985717106146659, -0.001985769001620076), (0.29681, 0.077025)),
}


@pytest.mark.parametrize("ratio", list(STIFF))
def test_a_stiff_mesh_moves_the_axes_as_a_rigid_one(ratio):
    """Steps of 6.25 us, far beyond the mesh mode. Newmark's rings; two steps of Newton's suffice.

    Delta falls with the stiffness; what is left of the deviation without ringing is slow motion.
    """
    pair = paper_pair("tangent", k=ratio * 1e3)
    times = timeline(pair, np.linspace(0.0, 0.02, 401))
    given = times.starts, times.lengths, times.k0, times.k1, times.counts(6.25e-6)
    ends, rough = STIFF[ratio]
    rigid = rigid_end(pair)
    assert rigid == pytest.approx(-1.985612905876083, rel=1e-12)
    for alphas, end, deviation in zip(
        (ALPHAS["newmark"], generalised(0.5)), ends, rough, strict=True
    ):
        out = np.empty((400, 6))
        turned = kernel(ALPHA).advance(*numbers(pair, "line"), alphas, *given, np.zeros(6), out)
        assert out[-1, 0] == pytest.approx(1e3 * end, rel=2e-6)
        assert abs(out[-1, 0] - rigid) < 3.5e-4 * 4.11  # [mm] of the largest r_1
        late = out[-50:, 1]
        assert -late.std() / late.mean() == pytest.approx(deviation, rel=2e-2)
        assert -1.36 < late.mean() * ratio * 1e3 / pair.load < -1.30
        assert turned <= 2.05 * 3200


def rigid_end(pair):
    """r_1 [mm] after 20 ms of two axes tied by rigid teeth: delta = 0."""
    me, load = pair.mesh_mass, pair.load
    masses = np.array([[6e-4 + me, -me], [-me, 9e-4 + me]])
    inverse = np.linalg.inv(np.linalg.cholesky(masses))
    square, shapes = np.linalg.eigh(inverse @ (1e3 * np.eye(2)) @ inverse.T)
    shapes, ends = inverse.T @ shapes, np.array([-load, load]) / 1e3
    gone = shapes @ (shapes.T @ masses @ ends * np.cos(np.sqrt(square) * 0.02))
    return ends[0] - gone[0]


@pytest.mark.parametrize("steps", [20, 40, 80])
def test_newmarks_period_is_too_long(steps):
    """By atan: 1e4 periods of 2 pi/n lose 81.05, 20.49 and 5.14 cycles; (omega h)^2/12 of them."""
    lost = {20: 81.05014560, 40: 20.48590869, 80: 5.13566789}[steps]
    first = 1e4 * (2.0 * math.pi / steps) ** 2 / 12.0
    assert first == pytest.approx({20: 82.24670334, 40: 20.56167584, 80: 5.14041896}[steps])
    pair, period = paper_pair(torques=(0.0, 0.0)), 2.0 * math.pi / MODE
    times = timeline(pair, np.linspace(0.0, 500 * period, 501))
    made = march(pair, "fixed", times, "newmark", period / steps, np.array([1.0, 0.0])).states
    phase = np.unwrap(np.angle(made[:, 0] - 1j * made[:, 1] / MODE))
    cycles = -phase[-1] / (2.0 * math.pi) * 20.0  # of 1e4 periods; whole ones are unseen
    assert abs(cycles) == pytest.approx(lost, rel=1e-6)
    energy = made[:, 0] ** 2 + (made[:, 1] / MODE) ** 2
    assert energy == pytest.approx(np.ones(501), rel=1e-9)  # which does not drift


WEAK = {  # zeta, eps: amplitude by an independent program, which reads it off 400 points a period
    (0.05, 1e-3): 0.00999999935,
    (0.01, 1e-3): 0.0499999967,
    (0.002, 1e-3): 0.2499999835,
    (0.05, 1e-2): 0.0999993472,
    (0.01, 1e-2): 0.499997136,
    (0.002, 1e-2): 2.50003775,
}


@pytest.mark.parametrize(("ratio", "depth"), list(WEAK))
def test_weak_modulation_near_resonance(ratio, depth):
    """x'' + 2 zeta x' + (1 + eps cos t) x = 1: amplitude eps/(2 zeta), to second order in eps."""
    pair = replace(oscillator(ratio, 1.0, 0.0, fourier(1.0, (depth,))), backlash=None)
    made = linear_orbit(pair, "fixed", 1.0 / TURN, 12)
    amplitude = np.ptp(made.delta(4000)) / 2.0
    first = depth / (2.0 * ratio)
    assert amplitude == pytest.approx(first, rel=1e-7 if depth < 1e-2 else 3e-5)
    assert amplitude == pytest.approx(WEAK[ratio, depth], rel=1e-5)
    if (ratio, depth) == (0.002, 1e-2):
        pair = replace(pair, mesh_frequency=1.0 / TURN)
        _, least, most, _ = steady(pair, 1500, np.array([-1.0, 0.0]), 4000, 1)
        assert 0.5 * (most - least) == pytest.approx(amplitude, rel=1e-6)


def test_of_equal_masses_three_frequencies_are_one():
    """Their shapes are any basis: the space they span is compared."""
    pair = paper_pair(masses=(7.5e-4, 7.5e-4))
    system = linear(pair, "plane")
    found = modes(system, 2e5)
    single = math.sqrt(1e3 / 7.5e-4) / (2 * math.pi)
    assert single == pytest.approx(183.776, abs=5e-4)
    assert found.hertz[1:4] == pytest.approx([single] * 3, rel=1e-9)
    assert found.hertz[[0, 4]] == pytest.approx([137.54631610658546, 5545.173316526311], rel=1e-10)
    sine, cosine = math.sin(pair.pressure_angle), math.cos(pair.pressure_angle)
    known = np.array(
        [[cosine, -sine, 0, 0, 0], [0, 0, 0, cosine, -sine], [sine, cosine, 0, sine, cosine]]
    )
    left = np.linalg.lstsq(found.shapes[:, 1:4], known.T, rcond=None)[0]
    assert found.shapes[:, 1:4] @ left == pytest.approx(known.T, abs=1e-9)
    assert mesh_shares(system, 2e5)[1:4] == pytest.approx([0.0] * 3, abs=1e-12)


def test_line_modes_avoid_each_other():
    """The smallest gap of the upper two, over the bearings: 1907.926 Hz at 1.33352e6 N/mm."""
    found = modes(linear(paper_pair(kx=1.333521432163324e6), "line"), 2e5).hertz
    assert found == pytest.approx([3490.81839378, 6499.90266878, 8407.82884290], rel=1e-9)
    for near in (1.32e6, 1.35e6):
        other = modes(linear(paper_pair(kx=near), "line"), 2e5).hertz
        assert other[2] - other[1] > found[2] - found[1] == pytest.approx(1907.926174, abs=1e-5)


LOADS = {  # kinematics, torque [N mm], balanced: k_perp [N/mm], the lowest frequency [Hz]
    ("exact", 2e5): (442.15222587802506, 135.73408477134345),
    ("exact", 1e6): (302.26798494076283, 135.73408477134888),
    ("exact", 5e6): (117.07390762165393, 88.3966265034238),
    ("exact", 5e7): (14.83324560931488, 31.63424904523355),
    ("paper", 2e5): (459.2931717660205, 101.03304959754574),
    ("paper", 1e6): (379.1145209803894, 126.64465642860841),
    ("paper", 5e6): (223.89689235367958, 121.13139456666248),
    ("paper", 5e7): (40.91639780968957, 52.478740341066135),
}


@pytest.mark.parametrize(("kind", "torque"), list(LOADS))
def test_load_softens_the_axes_across_the_line_of_action_and_never_buckles_them(kind, torque):
    """k_perp = k_b/2 - F/(Z_0 + 2 F/k_b), in the paper's form (k_b/2) C_0/C; both are above 0."""
    pair, load = paper_pair(kind, torques=(torque, torque * 8 / 6)), torque / 60.0
    state = static(pair)
    if kind == "exact":
        across = 500.0 - load / (140.0 * math.tan(math.radians(20.0)) + 2 * load / 1e3)
    else:
        centre = 140.0 / math.cos(math.radians(20.0))
        across = 500.0 * centre / math.hypot(centre + state.apart[0], state.apart[1])
    known, lowest = LOADS[kind, torque]
    assert across == pytest.approx(known, rel=1e-12) and across > 0.0
    g = 500.0 - across  # F/Z, the tangent grown by the load
    masses = np.diag([6e-4, 9e-4])
    squares = np.linalg.eigvals(np.linalg.solve(masses, [[1e3 - g, g], [g, 1e3 - g]])).real
    found = modes(linear(pair, "plane", state), 2e5)
    for square in squares:
        assert np.min(np.abs(found.frequencies**2 / square - 1.0)) < 1e-9
    assert found.hertz[0] == pytest.approx(lowest, rel=1e-9)


DIGITS = {0.02: (1e-10, 1e-8), 0.1: (6e-10, 6e-8), 1.0: (3e-7, 3e-5)}
# of theta: 8.3e-10, 6.2e-9 and 3.0e-6 by another program


@pytest.mark.parametrize("end", list(DIGITS))
def test_delta_keeps_its_digits_while_the_gears_speed_up(end):
    """From the relative equilibrium, where delta is constant: 449,000 rpm after a second."""
    pair = paper_pair("paper")
    rest = static(pair)
    x1, y1, x2, y2 = rest.axes
    way = float(pair.contact(*rest.apart).approach) - rest.delta
    times, errors = timeline(pair, np.linspace(0.0, end, 21)), []
    for level, third in (("angles", way / 60.0), ("way", way), ("plane", rest.delta)):
        start = np.zeros(2 * LEVELS[level][0])
        start[:5] = x1, y1, third, x2, y2
        made = march(pair, level, times, "rk8", 8e-6, start)
        errors.append(np.max(np.abs(made.delta / rest.delta - 1.0)))
    assert errors[2] < 1e-13 < 1e-12 < errors[1] < 1e-9
    least, most = DIGITS[end]  # of a random walk of roundings: the magnitude alone is repeatable
    assert least < errors[0] < most


@pytest.mark.parametrize(
    ("time", "ratio", "rpm"),
    [
        (0.01, 1.6e4, 4493.787),
        (0.1, 1.6e6, 44937.87),
        (1.0, 1.6e8, 449378.7),
        (10.0, 1.6e10, 4493787),
    ],
)
def test_angles_outgrow_the_deformation_with_the_square_of_time(time, ratio, rpm):
    """r_b1 theta_1 = 1411.76 t^2 m beside 8.8 um: so many times as large."""
    pair = paper_pair()
    push = (2e5 / 60.0) * time  # of q'' = T_1/r_b1; s stays, as F and N cancel
    angle = turns(pair, 0.0, 0.5 * push * time).pinion
    assert 60.0 * angle / (pair.load / 2e5) == pytest.approx(ratio, rel=1e-9)
    assert turns(pair, 0.0, push).pinion * 30.0 / math.pi == pytest.approx(rpm, rel=1e-6)


def test_in_a_tongue_a_linear_motion_grows_and_teeth_that_part_bound_it():
    """Twice the mesh mode, lightly damped: by the multiplier a period; with backlash no longer."""
    wave, frequency = trapezoid(2e5, 0.5, 0.68), 2.0 * MODE / TURN
    given = {"wave": wave, "frequency": frequency, "damping": 0.02 * math.sqrt(2e5 / 3400.0)}
    system = linear(paper_pair(**given), "fixed")
    growth = float(largest(system, wave, np.array([frequency]))[0])
    assert 1.1 < growth < 1.58  # the largest of the map
    start, pair = np.array([-1.01 * paper_pair().load / 2e5, 0.0]), paper_pair(**given)
    times = timeline(pair, np.arange(61) / frequency)
    made = march(pair, "fixed", times, "rk8", 4e-6, start).delta
    steps = np.diff(made[-4:])  # the forced motion falls out; the sign changes every period
    assert steps[1:] / steps[:-1] == pytest.approx([-growth, -growth], rel=1e-6)
    parted = paper_pair(**given, backlash=1.0)
    asked = timeline(parted, np.linspace(0.0, 800.0 / frequency, 8001))
    made = march(parted, "fixed", asked, "rk8", 8e-6, start)
    sizes = [np.ptp(part) for part in np.split(made.delta[4001:], 4)]
    assert sizes == pytest.approx([0.0255] * 4, rel=1e-3) and made.events > 700


def test_at_rest_the_balance_is_static():
    """A mesh frequency that tends to zero: delta = -F/k, of the RMS of F/k."""
    wave = fourier(2e5, (4e4, 1e4), (2e4,))
    pair = paper_pair("tangent", kx=1e5, wave=wave, torques=(2e5, 8e5 / 3.0))
    made = linear_orbit(pair, "line", 0.01, 30)
    phase = np.arange(64) / 64
    assert made.delta(64) == pytest.approx(-pair.load / wave.value(phase), rel=1e-8)
    known = pair.load / wave.value(np.arange(256) / 256)
    assert made.rms == pytest.approx(known.std(), rel=1e-8)


SINGLE = {"rk8": 25e-6, "rk4": 5e-6, "symplectic": 12.5e-6}  # s; of others 1 us


@pytest.mark.parametrize("method", list(STEPPERS))
def test_a_jump_inside_a_step_costs_the_order(method):
    """A rectangle with steps that miss its jumps: order 1 to 2; with steps that end there, all."""
    pair = paper_pair("tangent", kx=1e5, wave=trapezoid(2e5, 0.5, 0.683), frequency=1000.0)
    known = exact_motion(pair, "line", timeline(pair, TIMES), np.zeros(6)).delta
    scale = np.max(np.abs(known))

    def error(aligned, h):
        count = round(5e-5 / h)
        asked = TIMES if aligned else np.linspace(0.0, 0.002, 40 * count + 1)
        made = march(pair, "line", timeline(pair, asked, aligned), method, h, np.zeros(6)).delta
        return np.max(np.abs(made[:: 1 if aligned else count] - known)) / scale

    missed = [error(False, 12.5e-6 / 2**power) for power in range(7)]
    slope = math.log2(missed[0] / missed[-1]) / 6.0
    assert 0.7 < slope < 2.3
    step = SINGLE.get(method, 1e-6)
    hit = [error(True, step), error(True, 0.5 * step)]
    assert math.log2(hit[0] / hit[1]) == pytest.approx(STEPPERS[method].order, abs=0.7)
