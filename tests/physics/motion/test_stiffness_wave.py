"""Mesh stiffness over a period: means, limits at steps, harmonics."""

import math

import numpy as np
import pytest

from gearopt.physics.iso6336.stiffness import flexibility, mesh_stiffness
from gearopt.physics.motion.stiffness_wave import (
    constant,
    fourier,
    of_contact_ratio,
    sampled,
    trapezoid,
)

WAVES = {
    "rectangle": trapezoid(2e5, 0.5, 0.68),
    "trapezoid": trapezoid(2e5, 0.5, 0.6, 0.1),
    "to the end": trapezoid(2e5, 0.5, 0.9, 0.1),
    "triangle": trapezoid(2e5, 0.5, 0.5, 0.5),
    "fourier": fourier(2e5, (2e4, 0.0, 3e3), (1e3,)),
    "table": sampled(lambda p: 2e5 + 1e4 * np.cos(2 * math.pi * p), 24),
}


@pytest.mark.parametrize("name", list(WAVES))
def test_mean_and_harmonics_are_integrals(name):
    wave, points = WAVES[name], 2**16
    phase = (np.arange(points) + 0.5) / points
    values = wave.value(phase)
    assert wave.mean == pytest.approx(values.mean(), rel=2e-5)
    assert wave.mean == pytest.approx(2e5, rel=1e-9)
    found = wave.harmonics(7)
    for h in range(8):
        known = np.mean(values * np.exp(-2j * math.pi * h * phase))
        assert abs(found[h] - known) < 3.0  # of 2e5; steps fall between two points


def test_the_trapezoid_is_of_the_depth_and_the_duty_asked():
    wave = WAVES["trapezoid"]
    values = wave.value(np.array([0.3, 0.85, 0.05, 0.65]))
    assert values == pytest.approx([2.4e5, 1.4e5, 1.9e5, 1.9e5], rel=1e-12)  # mean of top, bottom
    # 2/(l pi) sin(l pi duty) sinc(l r) of the height, its centre at phase 0.35
    height, phases = 1e5, np.exp(2j * math.pi * 0.35 * np.arange(5))
    for order in range(1, 5):
        known = height / (order * math.pi) * math.sin(order * math.pi * 0.6)
        known *= math.sin(order * math.pi * 0.1) / (order * math.pi * 0.1)
        assert wave.harmonics(4)[order] * phases[order] == pytest.approx(known, abs=1e-8)


def test_a_step_has_a_limit_on_either_side():
    wave = WAVES["rectangle"]
    left = wave.straight(np.array([0.68, 1.0]), left=True)
    assert left == pytest.approx([2.32e5, 1.32e5])
    assert wave.straight(np.array([0.68, 1.0])) == pytest.approx([1.32e5, 2.32e5])
    assert wave.stepped and not WAVES["trapezoid"].stepped and constant(1e5).stepped


def test_the_wave_of_a_contact_ratio_has_the_mean_of_iso_6336():
    wave = of_contact_ratio(1.3e5, 1.68, 0.1)
    assert wave.mean == pytest.approx(mesh_stiffness(1.3e5, 1.68)[0], rel=1e-12)
    ends = wave.value(np.array([0.3, 0.9]))
    assert ends == pytest.approx([1.75 * 1.3e5, 1.3e5], rel=1e-12)  # two pairs of teeth, and one


def test_what_is_assumed_of_the_mesh_where_the_paper_has_nothing():
    """30 and 40 teeth on 10 mm: c' = 13.591, c_gamma = 20.559 N/(mm um), some 2e5 N/mm."""
    single = 0.8 / float(flexibility((30.0, 40.0), (0.0, 0.0)))  # solid discs
    assert single == pytest.approx(13.591246104904599, rel=1e-12)
    wave = of_contact_ratio(1e4 * single, 1.6835237523353612)
    assert wave.mean == pytest.approx(2.0558700757307914e5, rel=1e-12)
    high, low = wave.value(np.array([0.3, 0.9]))
    assert (high - low) / wave.mean == pytest.approx(0.49582095186900527, rel=1e-12)


@pytest.mark.parametrize(("duty", "ramp"), [(0.05, 0.1), (0.95, 0.1), (0.5, -0.1), (1.2, 0.0)])
def test_ramps_that_overlap_are_refused(duty, ramp):
    with pytest.raises(ValueError, match="does not fit"):
        trapezoid(2e5, 0.5, duty, ramp)
