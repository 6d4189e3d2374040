"""Where a periodic stiffness makes a pair unstable: first-order formulas against multipliers."""

import math

import numpy as np
import pytest
from moving_pairs import paper_pair

from gearopt.formulations.dynamics.motion.stability import largest
from gearopt.physics.motion.linear import linear, mesh_shares, modes, tongues, with_modal_damping
from gearopt.physics.motion.stiffness_wave import of_contact_ratio, trapezoid

WAVE = trapezoid(2e5, 0.2, 0.68)
CASES = {  # bearings [N/mm], mode (from 1), harmonic: predicted, found half width and damping
    (None, 1, 1): (0.026876, 0.026482, 0.026674),
    (None, 1, 2): (0.014401, 0.015709, 0.015811),
    (1e5, 5, 1): (0.025350, 0.025032, 0.025170),
    (1e6, 1, 1): (0.014231, 0.014850, 0.013606),
}


def system_of(held):
    return linear(paper_pair(), "fixed") if held is None else linear(paper_pair(kx=held), "plane")


@pytest.mark.parametrize("case", list(CASES))
def test_principal_tongues(case):
    """Found: by an independent program, multipliers on a fine grid and bisected damping."""
    held, mode, harmonic = case
    predicted, half, damping = CASES[case]
    system = system_of(held)
    tongue = next(
        t for t in tongues(system, WAVE, 3) if t.modes == (mode, mode) and t.harmonic == harmonic
    )
    assert tongue.half_width == pytest.approx(predicted, rel=1e-4)
    assert tongue.damping == tongue.half_width
    frequencies = tongue.frequency * np.linspace(1 - 0.07, 1 + 0.07, 1401)
    found = frequencies[largest(system, WAVE, frequencies) > 1.0 + 1e-6]
    assert np.ptp(found) / (2.0 * tongue.frequency) == pytest.approx(half, abs=1.5e-4)
    near = tongue.frequency * np.linspace(1 - predicted, 1 + predicted, 21)
    grown = [
        np.max(largest(with_modal_damping(system, 2e5, part * damping), WAVE, near))
        for part in (0.99, 1.01)
    ]
    assert grown[0] > 1.0 > grown[1]


def test_the_third_tongue_is_of_second_order():
    """a_1 and a_2 act together on it: the first-order formula gives a third of its width."""
    tongue = next(t for t in tongues(system_of(None), WAVE, 3) if t.harmonic == 3)
    assert tongue.half_width == pytest.approx(0.00133, rel=1e-2)
    frequencies = tongue.frequency * np.linspace(0.98, 1.02, 2001)
    found = frequencies[largest(system_of(None), WAVE, frequencies) > 1.0 + 1e-6]
    assert np.ptp(found) / (2.0 * tongue.frequency) == pytest.approx(0.0036, rel=0.03)


def test_a_combination_tongue_is_where_and_as_wide_as_said():
    """Of the third and the fifth mode at 1e6 N/mm; with a weaker wave it is of first order."""
    system, wave = system_of(1e6), trapezoid(2e5, 0.02, 0.68)
    sums = [t for t in tongues(system, wave, 1) if t.modes[0] < t.modes[1]]
    tongue = sums[0]
    frequencies = tongue.frequency * (1.0 + tongue.half_width * np.linspace(-4.0, 4.0, 801))
    found = frequencies[largest(system, wave, frequencies) > 1.0 + 1e-7]
    assert np.ptp(found) / (2.0 * tongue.frequency) == pytest.approx(tongue.half_width, rel=0.05)
    assert np.mean(found) == pytest.approx(tongue.frequency, rel=2.0 * tongue.half_width)
    damped = with_modal_damping(system, 2e5, 1.1 * tongue.damping)
    assert np.max(largest(damped, wave, frequencies)) < 1.0


def test_shares_of_the_mesh_add_up():
    """Sum of kappa_p omega_p^2 is k w' M^-1 w, whatever the bearings."""
    pair = paper_pair(kx=1e6)
    system = linear(pair, "plane")
    total = np.sum(mesh_shares(system, 2e5) * modes(system, 2e5).frequencies ** 2)
    assert total == pytest.approx(2e5 * (3400.0 + 1 / 6e-4 + 1 / 9e-4), rel=1e-9)


def test_contact_ratio_decides_the_first_harmonic():
    """a_1 of the assumed wave and the damping a_1/4 that fixed axes need."""
    system = system_of(None)
    for ratio, first, damping in (
        (1.2, 0.244, 0.061),
        (1.4027, 0.350, 0.087),
        (1.5, 0.347, 0.087),
        (1.6835, 0.265, 0.066),
        (1.9, 0.088, 0.022),
    ):
        wave = of_contact_ratio(1.3591e5, ratio)
        found = tongues(system, wave, 1)[0]
        assert 4.0 * found.half_width == pytest.approx(first, abs=5.1e-4)
        assert found.damping == pytest.approx(damping, abs=5.1e-4)
        assert math.isclose(found.frequency, math.sqrt(wave.mean * 3400.0) / math.pi, rel_tol=1e-9)
    almost = tongues(system, of_contact_ratio(1.3591e5, 1.9999), 1)[0]
    assert almost.damping < 5e-5  # at 2 there is no wave
