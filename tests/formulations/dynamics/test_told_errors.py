"""Errors told of maps of stability and of motions over speed, against finer runs of 20 pairs."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from campaigns import few
from moving_pairs import paper_pair

from gearopt.formulations.dynamics import steady_motion
from gearopt.formulations.dynamics.motion import stability
from gearopt.formulations.dynamics.motion.balance import linear_orbit
from gearopt.formulations.dynamics.motion.stability import stability_map
from gearopt.formulations.dynamics.motions_over_speed import followed
from gearopt.formulations.dynamics.parts import scaled
from gearopt.formulations.dynamics.steady_motion import in_contact
from gearopt.optimise.clock import Clock
from gearopt.physics.motion.linear import linear
from gearopt.physics.motion.moving_pair import damping_of
from gearopt.physics.motion.stiffness_wave import fourier, trapezoid

SEEDS = range(20)


def drawn(seed):
    """A pair of random bearings, damping, wave, backlash and error, and the level of its axes."""
    draw = np.random.default_rng(seed)
    depth, duty = draw.uniform(0.1, 0.7), draw.uniform(0.3, 0.8)
    waves = (
        trapezoid(2e5, depth, duty),
        trapezoid(2e5, depth, duty, draw.uniform(0.02, 0.15)),
        fourier(2e5, 6e4 * draw.uniform(-1.0, 1.0, 3), 3e4 * draw.uniform(-1.0, 1.0, 2)),
    )
    kx, mesh, bearing = (
        10.0 ** draw.uniform(4.0, 5.5),
        draw.uniform(0.0, 0.06),
        draw.uniform(0.0, 0.03),
    )
    error = tuple(draw.uniform(0.0, 2e-3, 2)) if seed % 2 else ()
    pair = paper_pair(
        kx=kx, wave=waves[seed % 3], torques=(2e5, 8e5 / 3.0), kinematics="tangent", error=error
    )
    pinion, wheel = (
        replace(r, damping=(damping_of(bearing, kx, r.mass),) * 2) for r in pair.rotors
    )
    damping = damping_of(mesh, 2e5, pair.mesh_mass)
    return replace(pair, pinion=pinion, wheel=wheel, damping=damping), ("fixed", "line")[
        seed // 3 % 2
    ]


def exact(system, wave, frequency):
    """Largest multiplier of a stepped stiffness, by exponentials of 40 digits."""
    n, over = system.mass.size, mp.eye(2 * system.mass.size)
    for length, k in zip(wave.lengths, wave.after, strict=True):
        rates = np.zeros((2 * n, 2 * n))
        rates[:n, n:] = np.eye(n)
        rates[n:, :n] = -system.with_mesh(float(k)) / system.mass[:, None]
        rates[n:, n:] = -system.damping / system.mass[:, None]
        whole = mp.matrix(rates.tolist()) * (mp.mpf(float(length)) / mp.mpf(float(frequency)))
        over = mp.expm(whole) * over
    return max(abs(v) for v in mp.eig(over, left=False, right=False))


@pytest.mark.parametrize("seed", few(SEEDS, 3))
def test_the_error_of_a_map_is_below_what_is_told(seed):
    """Exponentials of 40 digits of a stepped stiffness; else steps a quarter as long."""
    pair, level = drawn(seed)
    if seed % 5 == 0:  # multipliers meet on the unit circle
        bare = [replace(r, damping=(0.0, 0.0)) for r in pair.rotors]
        pair = replace(pair, damping=0.0, pinion=bare[0], wheel=bare[1])
    system, frequencies = linear(pair, level), np.linspace(1000.0, 12000.0, 40)
    waves = [scaled(pair.wave, d) for d in (0.2, 0.6)]
    made = stability_map(system, waves, frequencies)
    off = 0.0
    some = range(0, 40, 8) if pair.wave.stepped and level == "line" else range(40)
    for wave, row in zip(waves, made.growth, strict=True):
        top = stability._top(system, wave)
        for k in some:
            if wave.stepped:
                with mp.workdps(40):
                    off = max(off, abs(float(exact(system, wave, frequencies[k]) - row[k])))
                continue
            over = stability._over_period(system, wave, frequencies[k], top, None, 4.0)
            off = max(off, abs(np.max(np.abs(np.linalg.eigvals(over))) - row[k]))
    assert off <= made.error < 1e-5


@pytest.mark.parametrize("seed", few(SEEDS, 1))
@pytest.mark.parametrize("parting", [False, True])
def test_the_error_of_motions_over_speed_is_below_what_is_told(seed, parting, monkeypatch):
    """Of four times as many harmonics where teeth stay in contact; else of steps a quarter long."""
    pair, level = drawn(seed)
    pair = replace(pair, backlash=0.1 if parting else None, drag=0.02 if parting else 0.0)
    frequencies = np.random.default_rng(seed).uniform(1500.0, 9000.0, 3)
    told = in_contact(pair, level, frequencies, 20, Clock())
    for contact, f in zip(told, frequencies, strict=True):
        at = replace(pair, mesh_frequency=f)
        (motion,) = followed(at, level, [contact], Clock())
        count = 4 * (len(contact.series.harmonics) - 1)
        finer = linear_orbit(at, level, f, count).delta(4096)
        off = np.abs(finer - contact.series.delta(4096)).max() / np.abs(finer).max()
        assert off <= contact.error < 5e-3
        if motion.grows or not motion.repeats or motion.highest < 0.0 or not parting:
            continue
        with monkeypatch.context() as patched:
            patched.setattr(steady_motion, "STEPS_PER_PERIOD", 48.0)
            state = steady_motion._repeating(at, level, motion.state, motion.repeats, Clock())
            finer = steady_motion._periodic_response(at, level, state, motion.repeats, Clock())
        off = np.abs(finer.delta - motion.delta).max() / np.abs(finer.delta).max()
        assert off <= motion.error < 1e-5
        assert finer.load == pytest.approx(motion.load, rel=1e-3, abs=1.0)
