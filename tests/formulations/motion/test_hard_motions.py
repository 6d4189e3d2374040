"""Motions that are hard for a method: separation, stiff meshes, long runs, digits, kinks.

Numbers to compare with: closed forms, and an independent program in SI units.
"""

import math

import numpy as np
import pytest
from moving_pairs import paper_pair

from gearopt.formulations.motion.exponential import exact_motion
from gearopt.formulations.motion.integrate import ALPHA, ALPHAS, STEPPERS, generalised, march
from gearopt.formulations.motion.numbers import numbers
from gearopt.formulations.motion.timeline import timeline
from gearopt.optimise.kernels import kernel
from gearopt.physics.motion.accelerations import LEVELS
from gearopt.physics.motion.linear import static
from gearopt.physics.motion.moving_pair import turns
from gearopt.physics.motion.stiffness_wave import trapezoid

MODE = math.sqrt(2e5 * 3400.0)  # rad/s of the mesh on fixed axes
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
