"""Floquet multipliers against closed forms, and the shares of published maps."""

import math

import numpy as np
import pytest
from moving_pairs import paper_pair
from scipy import special

from gearopt.formulations.dynamics.motion import stability
from gearopt.formulations.dynamics.motion.stability import (
    largest,
    monodromy,
    multipliers,
    stability_map,
)
from gearopt.optimise.clock import Clock
from gearopt.physics.motion.linear import Linear, linear, static, with_modal_damping
from gearopt.physics.motion.stiffness_wave import fourier, sampled, trapezoid

UNIT = Linear(np.ones(1), np.zeros((1, 1)), np.zeros((1, 1)), -np.ones(1))
FREQUENCIES, DEPTHS = np.linspace(500.0, 14000.0, 271), np.linspace(0.05, 0.75, 15)
MAPS = {  # model: unstable share of the map [%] without damping, with 1 and 5 %; largest multiplier
    "fixed": ((9.99, 9.05, 4.16), 1.582),
    "tangent 1e3": ((14.15, 12.25, 5.68), 1.584),
    "exact 1e3": ((14.15, 12.25, 5.68), 1.584),
    "tangent 1e5": ((16.33, 12.47, 4.94), 1.544),
    "tangent 1e6": ((17.54, 10.58, 0.00), 1.358),
    "paper 1e3": ((9.20, 6.54, 1.43), 1.584),
}


def test_meissner():
    """Trace and determinant of random rectangles."""
    rng = np.random.default_rng(1)
    for _ in range(15):
        k1, k2, duty = rng.uniform(0.2, 3.0), rng.uniform(0.2, 3.0), rng.uniform(0.1, 0.9)
        period = rng.uniform(0.5, 20.0)
        mean = duty * k1 + (1.0 - duty) * k2
        wave = trapezoid(mean, (k1 - k2) / mean, duty)
        found = monodromy(UNIT, wave, 1.0 / period)
        w1, w2 = math.sqrt(k1), math.sqrt(k2)
        a, b = w1 * duty * period, w2 * (1.0 - duty) * period
        known = 2 * math.cos(a) * math.cos(b) - (w1 / w2 + w2 / w1) * math.sin(a) * math.sin(b)
        assert np.trace(found) == pytest.approx(known, rel=1e-9, abs=1e-9)
        assert np.linalg.det(found) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("q", [0.1, 0.5, 1.0])
def test_mathieu(q):
    """x'' + (a - 2 q cos 2t) x = 0: on the edges of the tongues the trace is 2 or -2."""
    edges = {
        0.1: (0.8987655570, 1.0987343130, 3.9991667028, 4.0041611598),
        0.5: (0.4706543549, 1.4667668425, 3.9791892158, 4.1009005956),
        1.0: (-0.1102488170, 1.8591080725, 3.9170247730, 4.3713009827),
    }[q]
    exact = [f(n, q) for f, n in ((special.mathieu_b, 1), (special.mathieu_a, 1))]
    exact += [f(n, q) for f, n in ((special.mathieu_b, 2), (special.mathieu_a, 2))]
    assert exact == pytest.approx(edges, abs=1e-10)
    for a, trace in zip(exact, (-2.0, -2.0, 2.0, 2.0), strict=True):
        found = monodromy(UNIT, fourier(a, (-2.0 * q,)), 1.0 / math.pi)
        assert np.trace(found) == pytest.approx(trace, abs=1e-9)


@pytest.mark.parametrize(
    "name",
    [n if n == "fixed" else pytest.param(n, marks=pytest.mark.slow) for n in MAPS],
)
def test_shares_of_the_map(name):
    """271 mesh frequencies of 500 to 14,000 Hz, 15 depths of 0.05 to 0.75, rectangles of 0.68."""
    kind, _, held = name.partition(" ")
    shares, most = MAPS[name]
    if kind == "fixed":
        base = linear(paper_pair(), "fixed")
    else:
        pair = paper_pair(kind, kx=float(held))
        base = linear(pair, "plane", static(pair))
    waves = [trapezoid(2e5, depth, 0.68) for depth in DEPTHS]
    for ratio, share in zip((0.0, 0.01, 0.05), shares, strict=True):
        found = stability_map(with_modal_damping(base, 2e5, ratio), waves, FREQUENCIES).growth
        assert 100.0 * np.mean(found > 1.0 + 1e-6) == pytest.approx(share, abs=5.1e-3)
        if ratio == 0.0:
            assert found.max() == pytest.approx(most, abs=6e-4)


def test_exact_and_tangent_kinematics_have_the_same_multipliers():
    """Under load too: the axes across the line of action are softer, and take no part."""
    wave, frequencies = trapezoid(2e5, 0.5, 0.68), np.linspace(500.0, 14000.0, 28)
    found = []
    for kind in ("exact", "tangent"):
        pair = paper_pair(kind)
        system = with_modal_damping(linear(pair, "plane", static(pair)), 2e5, 0.01)
        found.append(np.maximum(largest(system, wave, frequencies), 1.0))
    assert found[0] == pytest.approx(found[1], abs=1e-10) and found[0].max() > 1.1


def test_any_wave_is_carried_to_the_digits_of_a_rectangle():
    """A narrow trapezoid tends to the rectangle, and straight pieces without slope are it."""
    system = with_modal_damping(linear(paper_pair(kx=1e5), "plane"), 2e5, 0.01)
    stepped = trapezoid(2e5, 0.5, 0.68)
    exact = multipliers(system, stepped, 3000.0)
    by_steps = multipliers(system, fourier(2e5, (0.0,)), 3000.0)
    constant = multipliers(system, trapezoid(2e5, 1e-30, 0.5), 3000.0)
    assert np.sort(np.abs(by_steps)) == pytest.approx(np.sort(np.abs(constant)), abs=1e-10)
    off = [
        abs(abs(multipliers(system, trapezoid(2e5, 0.5, 0.68, ramp), 3000.0)[0]) - abs(exact[0]))
        for ramp in (0.02, 0.01)
    ]
    assert off[1] < 0.3 * off[0] < 1e-3
    dense = sampled(trapezoid(2e5, 0.5, 0.6, 0.1).value, 200)
    ramped = trapezoid(2e5, 0.5, 0.6, 0.1)
    one, other = (abs(multipliers(system, w, 3000.0)[0]) for w in (dense, ramped))
    assert one == pytest.approx(other, abs=1e-10)


def test_slow_meshes_and_stiff_bearings_stop_within_a_period():
    """A period in parts is the same map; a watcher that says no ends it at the next part."""
    system = linear(paper_pair(kx=2e6), "line")
    ramped, looks = trapezoid(2e5, 0.5, 0.68, 0.1), [0]
    whole = monodromy(system, ramped, 200.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stability, "SLICE", 100)
        assert monodromy(system, ramped, 200.0) == pytest.approx(whole, rel=1e-9, abs=1e-12)

    def watch(event):
        looks[0] += 1
        return looks[0] < 4

    assert len(largest(system, ramped, np.array([3e3, 2e3, 1e-9, 5e3]), Clock(watch=watch))) == 2
    assert looks[0] == 4
