"""Motions followed over speed, against simulations carried on from speed to speed."""

from dataclasses import replace

import numpy as np
import pytest
from moving_pairs import paper_pair

from gearopt.formulations.dynamics.dynamics_parts import followed, resting
from gearopt.formulations.motion.integrate import march
from gearopt.formulations.motion.timeline import timeline
from gearopt.optimise.clock import Clock
from gearopt.physics.motion.moving_pair import damping_of
from gearopt.physics.motion.stiffness_wave import trapezoid


@pytest.mark.slow
def test_a_falling_speed_stays_on_the_branch_of_separated_teeth():
    """From 10,300 to 9500 rpm of 30 teeth; there the motion in contact has 11.7 um."""
    pair = paper_pair(
        kx=1e5, wave=trapezoid(2e5, 0.5, 0.68, 0.1), torques=(2e5, 8e5 / 3.0), backlash=0.1
    )
    pinion, wheel = (replace(r, damping=(damping_of(0.02, 1e5, r.mass),) * 2) for r in pair.rotors)
    mesh = damping_of(0.03, 2e5, pair.mesh_mass)
    pair = replace(pair, pinion=pinion, wheel=wheel, damping=mesh)
    frequencies, state, known = (
        np.array([5150.0, 4950.0, 4850.0, 4750.0]),
        resting(pair, "line"),
        [],
    )
    for frequency in frequencies:
        moved = replace(pair, mesh_frequency=float(frequency))
        times = np.arange(200 * 32 + 1) / (32 * frequency)
        made = march(moved, "line", timeline(moved, times), "rk8", 1.5e-5, state)
        state = made.states[-1]
        known.append(made.delta[-40 * 32 :].std())
    assert known == pytest.approx([0.02316, 0.02603, 0.02772, 0.02953], rel=1e-2)
    found = [one.rms for one in followed(pair, "line", frequencies, 20, Clock())]
    assert found == pytest.approx(known, rel=1.5e-2)
