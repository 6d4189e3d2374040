"""Requests that nothing meets: bounds over the ranges, the least excess, what must change."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearopt.bench.wave_design import DEMAND, STARTS
from gearopt.formulations.strain_wave import sampled
from gearopt.formulations.strain_wave.demand import FREE
from gearopt.formulations.strain_wave.exchange import RISE, least_used, proof
from gearopt.formulations.strain_wave.impossible import nearest, told
from gearopt.optimise.clock import Clock
from gearopt.physics.strain_wave.gearing import WAVES, StrainWave
from gearopt.physics.strain_wave.neutral_curve import neutral_curve, radii


def carrying(torque_Nm):
    return replace(DEMAND, duty=replace(DEMAND.duty, torque=1e3 * torque_Nm))


def test_bounds_of_random_boxes():
    """No gearing in a box uses a limit less than the bound; of one design it is its value."""
    draw = np.random.default_rng(22)
    for _ in range(6):
        ranges = {}
        for name, (low, high) in DEMAND.ranges.items():
            ends = np.sort(draw.uniform(low, high, 2))
            ranges[name] = (float(ends[0]), float(ends[1]))
        own = replace(DEMAND, ranges=ranges, outer_radius=draw.uniform(30.0, 50.0))
        low, high = np.array([ranges[name] for name in FREE]).T
        points = low + (high - low) * draw.random((8, len(FREE)))
        posed = sampled.problem(own, points[0], look=sampled.Look(30.0, 85.0, 3, 0.0))
        used = dict(
            zip([r.name for r in posed.rows.inequalities], posed.batch(points).G.T, strict=True)
        )
        within = used["outer_radius"] <= 1.0
        for (name, *kept), bound in least_used(own).items():
            assert (used[name][within | (not kept)] >= bound - 1e-12).all(), name
        assert least_used(own)[("ratcheting",)] > 0.3 * used["ratcheting"].min()
    one = dict(zip(FREE, STARTS[0], strict=True))
    shifted = {n: (v, v) for n, v in one.items()} | {"profile_shift": (-2.0, -2.0)}
    fixed, wide = (
        replace(DEMAND, ranges={**shifted, "module": ends}) for ends in ((0.5, 0.5), (0.4, 0.5))
    )  # outside the largest root lies the largest base circle of negative shifts
    assert least_used(wide)[("ratcheting",)] <= least_used(fixed)[("ratcheting",)]
    of_one = least_used(replace(DEMAND, ranges={n: (v, v) for n, v in one.items()}))
    assert of_one[("outer_radius",)] == pytest.approx((40.5 + 0.5 * 1.75 + 3.0) / 45.0, rel=1e-12)
    assert of_one[("minor_axis",)] == pytest.approx(1.3 / 2.0, rel=1e-12)
    shear = 1.6 * 1e5 / (2.0 * math.pi * 39.625**2 * 0.6 * 0.8)  # 33.8 MPa, R_m as in the paper
    assert of_one[("rim_fatigue",)] == pytest.approx(1.5 * shear / 230.0, rel=1e-12)


@pytest.mark.slow
def test_neutral_curves_rise_no_faster_than_the_lemma_says():
    """Within 0.3 rad of the major axis, at the fewest teeth and the largest deflection of files."""
    angles, steepest = np.linspace(-0.3, 0.0, 61), 0.0
    for wave in WAVES:
        for wrap in np.radians((1.0, 5.0, 30.0, 80.0) if wave == "discs" else (30.0,)):
            own = StrainWave(1.0, 60, addendum=0.9, deflection=2.0, wave=wave, wrap=float(wrap))
            curve = neutral_curve(own)
            rho, slope, _, _ = radii(curve, angles)
            assert (rho >= curve.radius).all()
            steepest = max(steepest, float(np.abs(slope).max() / 2.0))
    assert 1.3 < steepest < RISE


def test_what_no_corner_of_the_ranges_reaches_is_proven():
    assert proof(DEMAND) is None
    found = proof(carrying(1000.0))
    assert found["conflict"] == ["ratcheting"]
    used = least_used(carrying(1000.0))
    assert used[("rim_fatigue", "outer_radius")] == pytest.approx(1.182, abs=1e-3)
    assert 1.0 < used[("ratcheting", "outer_radius")] < 3000.0 / 742.6  # N m, what is found at best
    assert proof(carrying(742.6 / 3.0)) is None
    assert proof(replace(DEMAND, outer_radius=30.0))["conflict"][0] == "outer_radius"
    never = replace(DEMAND, ranges={**DEMAND.ranges, "addendum": (1.3, 1.4)})
    assert proof(never)["conflict"] == ["minor_axis"]


@pytest.mark.slow
def test_the_least_excess_balances_what_cannot_be_met():
    """At 300 N m ratcheting and fatigue fall short alike; what is told is in units."""
    own = carrying(300.0)
    found = nearest(own, np.array(STARTS[0]), Clock())
    assert found.used["ratcheting"] == pytest.approx(found.used["rim_fatigue"], rel=1e-6)
    assert found.excess == pytest.approx(found.used["ratcheting"] - 1.0, abs=1e-6)
    words = "; ".join(told(own, found))
    torque, safety = 900.0 / (1.0 + found.excess), 1.5 / (1.0 + found.excess)
    assert f"ratcheting: at {torque:.4g} N m of 900 N m" in words
    assert f"rim fatigue: a safety of {safety:.3g} of 1.5" in words
