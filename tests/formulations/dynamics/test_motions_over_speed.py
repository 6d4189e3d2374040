"""Motions followed over speed, against programs of their own: RK4, scipy, closed forms.

Known numbers of sweeps were computed apart from gearopt, by RK4 of 400 to 800 steps in a period of
the mesh without located separations: 300 to 500 periods at each speed, then 40 that are judged.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import few
from moving_pairs import oscillator, paper_pair
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from gearopt.formulations.dynamics.motions_over_speed import (
    followed,
    over_speeds,
    passed,
    ranges,
)
from gearopt.formulations.dynamics.steady_motion import in_contact
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import COMPILING
from gearopt.optimise.result import Budget
from gearopt.physics.motion.moving_pair import damping_of
from gearopt.physics.motion.stiffness_wave import constant, fourier, trapezoid

TURN = 2.0 * math.pi


def swept(pair, level, frequencies, harmonics=20):
    """Motions at frequencies [Hz] that rise, and as they fall again, in the same order."""
    contacts = in_contact(pair, level, np.asarray(frequencies), harmonics, Clock())
    rising = followed(pair, level, contacts, Clock())
    falling = followed(pair, level, contacts[::-1], Clock())[::-1]
    return contacts, rising, falling


def driven_pair(bearing=0.02, mesh=0.03, depth=0.5, error=(), **more):
    """The pair of the file that `gearopt new dynamics` writes, or one like it."""
    wave = trapezoid(2e5, depth, 0.68, 0.1) if depth else constant(2e5)
    given = {"kx": 1e5, "wave": wave, "torques": (2e5, 8e5 / 3.0), "backlash": 0.1, "error": error}
    pair = paper_pair(**(given | more))
    pinion, wheel = (
        replace(r, damping=(damping_of(bearing, 1e5, r.mass),) * 2) for r in pair.rotors
    )
    damping = damping_of(mesh, 2e5, pair.mesh_mass)
    return replace(pair, pinion=pinion, wheel=wheel, damping=damping)


SWEEPS = {  # zeta, F_a, stiffness; peaks (W, RMS), teeth part from ... to, rising and falling;
    # from ... to two motions, at how many of the speeds W = 0.01, 0.02 ... 2.1
    "shaken": (
        (0.05, 0.05, 0.0),
        ((0.83, 0.18940), (0.83, 1.40)),
        ((0.72, 0.23576), (0.71, 1.40)),
        (0.71, 0.82, 12),
    ),
    "touching": ((0.05, 0.01, 0.0), ((1.00, 0.070711), None), ((1.00, 0.070711), None), None),
    "stiffness": (
        (0.05, 0.0, 0.2),
        ((0.91, 0.12247), (0.91, 1.07)),
        ((0.84, 0.14721), (0.84, 1.07)),
        (0.84, 0.90, 7),
    ),
    "light damping": (
        (0.01, 0.0, 0.2),
        ((0.90, 0.13433), (0.50, 2.09)),
        ((0.79, 0.89560), (0.45, 2.09)),  # carried on from 0.80 in steps of 0.001
        (0.45, 1.90, 146),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SWEEPS)
def test_sweeps_of_an_oscillator_with_a_gap(name):
    """x'' + 2 zeta x' + k f(x) = 0.1 + F_a W^2 cos W t, k = 1 or 1 + 0.2 cos W t."""
    (ratio, shake, depth), *ways, two = SWEEPS[name]
    wave = fourier(1.0, (depth,)) if depth else None
    low, high = (0.6, 1.405) if name == "stiffness" else (0.01, 2.105)  # which takes long
    pair, speed = oscillator(ratio, 0.1, shake, wave), np.round(np.arange(low, high, 0.01), 2)
    _, *both = swept(pair, "fixed", speed / TURN)
    rms = [np.array([m.rms for m in motions]) for motions in both]
    for motions, found, ((place, most), parts) in zip(both, rms, ways, strict=True):
        assert speed[found.argmax()] == place and found.max() == pytest.approx(most, rel=3e-5)
        apart = speed[[m.highest > 1e-9 for m in motions]]
        assert (parts is None and not apart.size) or (apart.min(), apart.max()) == parts
    apart = speed[np.abs(rms[0] - rms[1]) > 0.02 * rms[0]]
    assert (two is None and not apart.size) or (apart.min(), apart.max(), apart.size) == two
    if name == "light damping":
        assert rms[1][speed == 0.80] == pytest.approx(0.87245, rel=2e-5)


@pytest.mark.slow
def test_what_takes_two_periods_is_said():
    """Falling from W = 2.1 at zeta 0.01 and k = 1 + 0.2 cos: unstable from 2.09 to 1.91 in contact.

    Teeth part there, and the motion takes two periods, also where contact is stable again.
    """
    speed = np.round(np.arange(1.5, 2.105, 0.01), 2)
    pair = oscillator(0.01, 0.1, 0.0, fourier(1.0, (0.2,)))
    contacts, rising, falling = swept(pair, "fixed", speed / TURN)
    inside = (speed > 1.905) & (speed < 2.095)
    assert [c.growth > 1.0 for c in contacts] == inside.tolist()
    assert [m.repeats for m in rising] == np.where(inside, 2, 1).tolist()
    assert [m.repeats for m in falling] == [2] * 60 + [1]
    known = {1.5: 0.21785, 1.95: 0.10603, 2.0: 0.096633, 2.05: 0.086807}
    for w, rms in known.items():
        assert falling[np.flatnonzero(speed == w)[0]].rms == pytest.approx(rms, rel=5e-5)


@pytest.mark.slow
def test_falling_speeds_stay_with_separated_teeth_through_motions_that_do_not_repeat():
    """The pair of `gearopt new dynamics`, 10,700 to 6700 rpm; in contact 6 to 12 um."""
    frequencies = np.arange(3350.0, 5351.0, 50.0)
    _, rising, falling = swept(driven_pair(), "line", frequencies)
    up, down = ({f: m for f, m in zip(frequencies, way, strict=True)} for way in (rising, falling))
    for f, rms, repeats, near in (
        (3450.0, 0.070288, 1, 1e-3),
        (3600.0, 0.075403, 1, 1e-3),
        (3750.0, 0.055380, 1, 1e-3),
        (4000.0, 0.046864, 0, 2e-2),
        (4400.0, 0.036519, 0, 2e-2),
        (4800.0, 0.028680, 0, 2e-2),
        (5350.0, 0.020601, 1, 1e-3),
    ):
        assert down[f].rms == pytest.approx(rms, rel=near) and down[f].repeats == repeats
    assert down[3350.0].rms == pytest.approx(0.0068536, rel=1e-4)
    for f, rms in ((3450.0, 0.0063095), (4000.0, 0.0065320), (4750.0, 0.011683)):
        assert up[f].rms == pytest.approx(rms, rel=1e-4) and up[f].highest < 1e-4


@pytest.mark.slow
def test_few_speeds_lead_to_the_motions_of_many():
    """Falling from 11,000 rpm to 7000 in two steps: the same branch as in steps of 100 rpm."""
    found = over_speeds(driven_pair(), "line", 30, (7000.0, 11000.0, 3), 20)
    assert found.falling_rms_mm[0] == pytest.approx(0.071990, rel=1e-3)
    assert found.rms_mm[0] == pytest.approx(0.0061519, rel=1e-4)
    assert found.rms_mm[1] == pytest.approx(0.0090772, rel=1e-4)
    assert found.rms_mm[2] == pytest.approx(0.018844, rel=1e-3)
    assert found.falling_rms_mm[2] == pytest.approx(0.018844, rel=1e-3)


def test_steps_between_speeds_are_small():
    asked = np.array([10.0, 20.0, 20.1, 25.0])
    found = passed(asked)
    assert np.all(np.isin(asked, found)) and np.all(np.diff(found) > 0.0)
    assert np.max(found[1:] / found[:-1]) <= math.exp(0.025) and found.size == 1 + 28 + 1 + 9


@pytest.mark.slow
def test_sweeps_of_a_pair_of_light_damping():
    """0.5 and 1 % damping, depth 0.3: RMS [um] rising and falling, and after how many periods."""
    known = {
        2000.0: (4.0642, 4.0642, 1),
        2250.0: (3.6338, 33.147, 1),
        2500.0: (5.0794, 24.390, 1),
        2750.0: (17.800, 17.800, 1),
        3500.0: (3.5802, 3.5802, 1),
        3750.0: (3.4953, 75.743, 1),
        4250.0: (4.2563, 39.031, 1),
        5000.0: (8.7026, 24.463, 1),
        5250.0: (20.955, 20.955, 1),
        7250.0: (2.7405, 2.7405, 1),
        7500.0: (2.3360, 54.929, 2),
        9000.0: (1.1756, 33.470, 2),
        11500.0: (15.398, 15.398, 2),
        12000.0: (0.5204, 0.5204, 1),
    }
    frequencies = np.arange(2000.0, 12001.0, 250.0)
    _, rising, falling = swept(driven_pair(0.005, 0.01, 0.3), "line", frequencies)
    for f, (up, down, repeats) in known.items():
        at = int(np.flatnonzero(frequencies == f)[0])
        assert 1e3 * rising[at].rms == pytest.approx(up, rel=3e-4)
        assert 1e3 * falling[at].rms == pytest.approx(down, rel=5e-4)
        assert falling[at].repeats == repeats


def law(t, y, f, depth, error):
    """Rates of y = (x_1, delta, x_2, and their rates) of `driven_pair`, by hand; mm, t, s."""
    phase = f * t % 1.0
    high = max(0.0, min(phase / 0.1, 1.0, (0.78 - phase) / 0.1))
    k, force = 2e5 * (1.0 + depth * (high - 0.68)), 0.0
    mass = 1.0 / (60.0**2 / 2.0 + 80.0**2 / 4.0)
    delta, damping = y[1], 0.06 * math.sqrt(2e5 * mass)
    if delta < 0.0:
        force = k * delta + damping * y[4]
    elif delta > 0.1:
        force = k * (delta - 0.1) + damping * y[4]
    one = (force - 1e5 * y[0] - 0.04 * math.sqrt(1e5 * 6e-4) * y[3]) / 6e-4
    two = (-force - 1e5 * y[2] - 0.04 * math.sqrt(1e5 * 9e-4) * y[5]) / 9e-4
    shaken = -error * (TURN * f) ** 2 * math.cos(TURN * f * t)
    return y[3], y[4], y[5], one, two - one - (2e5 / 60.0 + force) / mass + shaken, two


@pytest.mark.parametrize(
    ("depth", "error", "frequencies"),
    few([(0.5, 0.0, (2500.0, 5200.0)), (0.0, 0.004, (5750.0, 5000.0))], 1),
)
def test_a_motion_is_one_by_the_law_written_by_hand(depth, error, frequencies):
    """scipy's DOP853 over a period, from the state told: it comes back, with the RMS told."""
    pair = driven_pair(depth=depth, error=(error,))
    contacts = in_contact(pair, "line", np.array(frequencies), 40, Clock())
    for f, motion in zip(frequencies, followed(pair, "line", contacts, Clock()), strict=True):
        times = np.arange(65) / (64.0 * f)
        given, step = (f, depth, error), times[1] / 4.0
        made = solve_ivp(
            law, times[[0, -1]], motion.state, "DOP853", times, args=given, rtol=1e-8, max_step=step
        )
        assert made.y[:3, -1] == pytest.approx(motion.state[:3], abs=2e-6)
        assert made.y[1, :-1].std() == pytest.approx(motion.rms, rel=1e-3)
        assert made.y[1, :-1].max() == pytest.approx(motion.highest, abs=2e-5)


def test_at_low_speeds_the_motion_is_static():
    """Mesh frequency far below all modes: the RMS and the ends of F/k(t)."""
    pair = driven_pair(wave=fourier(2e5, (4e4, 1e4), (2e4,)))
    found = over_speeds(pair, "line", 30, (9.0, 9.2, 2), 20)
    phase = TURN * np.arange(2048) / 2048
    k = 2e5 + 4e4 * np.cos(phase) + 1e4 * np.cos(2.0 * phase) + 2e4 * np.sin(phase)
    known = 2e5 / 60.0 / k
    assert found.rms_mm == pytest.approx([known.std()] * 2, rel=3e-4)
    assert found.peak_to_peak_mm == pytest.approx([np.ptp(known)] * 2, rel=3e-4)
    assert found.highest_mm == pytest.approx([-known.min()] * 2, rel=3e-4)
    assert found.repeats == (1, 1) and found.falling_rms_mm == found.rms_mm


def test_low_speeds_have_harmonics_enough_for_the_fastest_mode():
    """Fixed axes, 0.5 % damping, a rectangle at 250 Hz: the mode at 4.15 kHz rings at every jump.

    Exact: y' = A y + b on both pieces, and the state that a period repeats.
    """
    pair = paper_pair(wave=trapezoid(2e5, 0.5, 0.68), torques=(2e5, 8e5 / 3.0))
    mass, load = 1.0 / 3400.0, 2e5 / 60.0
    pair = replace(pair, damping=0.01 * math.sqrt(2e5 * mass), backlash=0.1)
    maps, count = [], 400
    for k in (2e5 * (1.0 + 0.5 * 0.32), 2e5 * (1.0 - 0.5 * 0.68)):
        rates = np.zeros((3, 3))
        rates[0, 1] = 1.0
        rates[1] = np.array([-k, -0.01 * math.sqrt(2e5 * mass), -load]) / mass
        maps.append(expm(rates / (250.0 * count)))
    high, low = (np.linalg.matrix_power(m, n) for m, n in zip(maps, (272, 128), strict=True))
    whole = low @ high
    state = np.append(np.linalg.solve(np.eye(2) - whole[:2, :2], whole[:2, 2]), 1.0)
    delta = []
    for step in range(count):
        delta.append(state[0])
        state = maps[step >= 272] @ state
    (contact,) = in_contact(pair, "fixed", np.array([250.0]), 20, Clock())
    assert contact.series.rms == pytest.approx(np.std(delta), rel=1e-3)
    assert contact.series.extremes == pytest.approx((min(delta), max(delta)), rel=1e-2)
    assert len(contact.series.harmonics) > 50


def test_coincident_frequencies_move_as_the_line_of_action_alone():
    """Equal masses: 183.776 Hz three times, in the plane; on the line it is there once."""
    given = {"kx": 1e3, "masses": (7.5e-4, 7.5e-4), "wave": fourier(2e5, (4e4, 1e4))}
    frequencies = np.array([183.776, 2800.0])
    rms = {}
    for level in ("line", "plane"):
        _, rising, _ = swept(driven_pair(**given), level, frequencies)
        rms[level] = [m.rms for m in rising]
        assert all(math.isfinite(v) for v in rms[level])
    assert rms["plane"] == pytest.approx(rms["line"], rel=1e-9)


def test_without_backlash_an_unstable_motion_has_no_size():
    """Undamped, within the first tongue of fixed axes, 7.8 to 8.8 kHz: it grows without end."""
    pair = paper_pair(wave=trapezoid(2e5, 0.5, 0.68), torques=(2e5, 8e5 / 3.0))
    found = over_speeds(pair, "fixed", 60, (7000.0, 9000.0, 5), 10)
    assert [v is None for v in found.rms_mm] == [False, False, True, True, False]
    assert [g > 1.01 for g in found.growth] == [False, False, True, True, False]
    assert not found.teeth_part and found.falling_rms_mm == ()
    assert [v is None for v in found.harmonics_mm[0]] == [v is None for v in found.rms_mm]


@pytest.mark.slow
def test_a_motion_between_both_flanks_may_grow_without_end():
    """A depth of 1.2 and little backlash: in two tongues an own RK4 program ends at 1e50 mm."""
    pair = driven_pair(0.02, 0.05, wave=trapezoid(2e5, 1.2, 0.6, 0.05), backlash=0.02)
    contacts, rising, _ = swept(pair, "line", [5500.0, 8000.0, 11000.0])
    assert [c.growth > 1.3 for c in contacts] == [m.grows for m in rising] == [True, False, True]


def test_a_clock_that_stops_leaves_the_first_speeds():
    """Asked once a speed in contact, and once a speed that is followed."""
    pair, seen = oscillator(0.05, 0.1, 0.01), []

    def watch(event):
        if not event.part.startswith(COMPILING):
            seen.append(event.evaluations)
        return len(seen) <= 14

    found = over_speeds(pair, "fixed", 60, (0.09, 0.1, 10), 5, Clock(Budget(), watch))
    assert len(found.speed_rpm) == len(found.rms_mm) == len(found.growth) == 4
    assert found.falling_rms_mm == () and seen == sorted(seen) and seen[-1] > 0


def test_ranges_of_speeds_in_words():
    told = ranges((800.0, 900.0, 1000.0, 1200.0), [True, True, False, True])
    assert told == "800 to 900 and 1,200 rpm"
