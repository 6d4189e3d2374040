"""The conclusions of Yoon, Kim and Chung, tested: true of their kinematics, and of involutes?

50 ms from rest, T_2 = 0, as an independent program has it: peak to peak of delta over the second
half, RMS over all. P: the paper's kinematics; PL: the same to first order; E: exact; T: tangent.
"""

import math
from functools import cache

import numpy as np
import pytest
from moving_pairs import paper_pair

from gearopt.formulations.dynamics.motion.integrate import march
from gearopt.formulations.dynamics.motion.stability import bands, largest
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.physics.motion.linear import linear, static
from gearopt.physics.motion.moving_pair import damping_of
from gearopt.physics.motion.stiffness_wave import trapezoid

KINDS = {"P": "paper", "L": "paper_linear", "E": "exact", "T": "tangent"}
CASES = {  # bearings [N/mm], zeta of the mesh, mesh frequency [Hz]: peak to peak [um] of P, PL, E;
    # RMS of P less PL over that of PL; in which kinematics teeth part (delta > 0)
    (1e3, 0.00, 0): (18.5147, 17.4505, 17.4587, 0.7596, "P"),
    (1e3, 0.03, 0): (15.5494, 14.5809, 6.18581, 0.7316, ""),
    (1e3, 0.00, 1000): (37.1036, 27.8117, 29.8681, 0.8012, "PLET"),
    (1e3, 0.03, 1000): (27.8122, 25.0942, 17.9743, 0.7345, ""),
    (1e3, 0.00, 4000): (211.493, 62.8040, 31.1145, 2.4840, "PLET"),
    (1e3, 0.03, 4000): (59.7402, 30.3841, 16.6484, 1.0098, "P"),
    (1e4, 0.00, 0): (18.0425, 17.6113, 17.5828, 0.8304, ""),
    (1e4, 0.03, 0): (13.8849, 13.6684, 4.53679, 0.7366, ""),
    (1e4, 0.00, 1000): (209.125, 30.6006, 145.711, 3.1887, "PLET"),
    (1e4, 0.03, 1000): (24.0419, 23.3812, 16.6110, 0.7368, ""),
    (1e4, 0.00, 4000): (37.5164, 92.1785, 30.3693, 0.9192, "PLET"),
    (1e4, 0.03, 4000): (27.4174, 29.5720, 15.0910, 0.7411, ""),
    (1e5, 0.00, 0): (17.6647, 17.6254, 17.5302, 0.4226, ""),
    (1e5, 0.03, 0): (11.0225, 11.0011, 2.04308, 0.2734, ""),
    (1e5, 0.00, 1000): (30.7927, 28.9716, 31.1523, 0.4362, "PLET"),
    (1e5, 0.03, 1000): (18.5637, 19.6723, 14.5819, 0.2719, ""),
    (1e5, 0.00, 4000): (107.649, 142.438, 29.7684, 0.8582, "PLET"),
    (1e5, 0.03, 4000): (26.0396, 27.2247, 12.0358, 0.2730, ""),
}
TIMES = np.linspace(0.0, 0.05, 5001)


@cache
def motions(case):
    """Return delta [um] of all kinematics, (5001,) each."""
    held, ratio, frequency = case
    wave = trapezoid(2e5, 0.5, 0.68, 0.1) if frequency else None
    found = {}
    for name, kind in KINDS.items():
        damping = damping_of(ratio, 2e5, 1.0 / 3400.0)
        bearing = damping_of(ratio / 3.0, held, 6e-4)
        pair = paper_pair(
            kind, kx=held, wave=wave, frequency=frequency, damping=damping, bearing=bearing
        )
        made = march(pair, "plane", timeline(pair, TIMES), "rk8", 1e-5, np.zeros(10))
        found[name] = 1e3 * made.delta
    return found


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def swing(delta):
    return float(np.ptp(delta[2500:]))


def apart(made):
    return rms(made["P"] - made["L"]) / rms(made["L"])


@pytest.mark.parametrize("case", list(CASES), ids=str)
def test_motions_of_all_kinematics(case):
    """Exact and tangent agree to 1e-11 in every case; the paper and its linear form do not."""
    made, (paper, first, exact, unlike, parts) = motions(case), CASES[case]
    found = [swing(made[name]) for name in "PLET"]
    assert found == pytest.approx([paper, first, exact, exact], rel=2e-5)
    assert apart(made) == pytest.approx(unlike, abs=1e-4)
    assert rms(made["E"] - made["T"]) < 1e-11 * rms(made["T"])
    assert "".join(name for name, delta in made.items() if delta[2500:].max() > 0.0) == parts


def test_with_constant_stiffness_the_effect_is_small_in_amplitude_alone():
    constant = [motions(case) for case in CASES if not case[2]]
    ratios = [swing(made["P"]) / swing(made["L"]) for made in constant]
    assert (min(ratios), max(ratios)) == pytest.approx((1.00, 1.07), abs=5e-3)
    waves = [apart(made) for made in constant]
    assert (min(waves), max(waves)) == pytest.approx((0.27, 0.83), abs=5e-3)  # of the waveform


@pytest.mark.parametrize(("ratio", "least", "most"), [(0.0, 0.41, 6.8), (0.03, 0.93, 1.97)])
def test_with_a_changing_stiffness_the_papers_form_is_not_its_linear_one(ratio, least, most):
    cases = [case for case in CASES if case[2] and case[1] == ratio]
    found = [swing(motions(case)["P"]) / swing(motions(case)["L"]) for case in cases]
    assert (min(found), max(found)) == pytest.approx((least, most), rel=8e-3)


@pytest.mark.parametrize(
    ("held", "known"), [(1e3, 0.0400193), (1e4, 0.0150974), (1e5, 0.0054681)], ids=str
)
def test_on_anisotropic_bearings_exact_and_tangent_differ(held, known):
    """By 4, 1.5 and 0.5 % of the RMS over 50 ms for k_y = 3 k_x; 1 kHz, 3 % damping."""
    wave, times, made = trapezoid(2e5, 0.5, 0.68, 0.1), np.linspace(0.0, 0.05, 2501), []
    for kind in ("exact", "tangent"):
        damping = damping_of(0.03, 2e5, 1.0 / 3400.0)
        pair = paper_pair(
            kind, kx=held, ky=3.0 * held, wave=wave, frequency=1000.0, damping=damping
        )
        made.append(march(pair, "plane", timeline(pair, times), "rk8", 1e-5, np.zeros(10)).delta)
    exact, tangent = made
    assert rms(exact - tangent) / rms(tangent) == pytest.approx(known, rel=2e-5)


def test_from_rest_the_papers_axes_move_along_the_line_of_centres_alone():
    """y_1 = y_2 = 0 stays so, and a displacement of 1e-6 mm stays as small for 0.2 s."""
    times = np.linspace(0.0, 0.2, 401)
    for kind, along in (("paper", 0), ("exact", 1)):
        pair = paper_pair(kind, wave=trapezoid(2e5, 0.5, 0.68, 0.1), frequency=1000.0)
        made = march(pair, "plane", timeline(pair, times), "rk8", 2e-5, np.zeros(10)).states
        x, y = np.max(np.abs(made[:, [0, 3]])), np.max(np.abs(made[:, [1, 4]]))
        assert (x > 0.1 and y == 0.0) if along == 0 else y > x > 0.1
        if kind == "paper":
            pushed = np.eye(10)[1] * 1e-6
            moved = march(pair, "plane", timeline(pair, times), "rk8", 2e-5, pushed).states
            assert np.max(np.abs(moved - made)[:, :5]) == pytest.approx(1.01e-6, rel=0.02)


def test_axes_that_move_apart_cost_contact_ratio():
    """Full-depth teeth, 30 and 40, on the paper's base circles, at rest and under F = 1764.7 N."""
    module = 120.0 / (30.0 * math.cos(math.radians(20.0)))
    assert module == pytest.approx(4.2567, abs=5e-5)
    known = {"": (148.98489, 1.68352), "exact": (150.22863, 1.40266), "paper": (156.81848, 0.11597)}
    for kind, (distance, ratio) in known.items():
        pair = paper_pair(kind or "exact")
        u, v = static(pair).apart if kind else (0.0, 0.0)
        found = math.hypot(pair.rest.centre_distance + u, v)
        assert found == pytest.approx(distance, abs=6e-6)
        outer = [0.5 * module * z + module for z in (30, 40)]
        path = sum(math.sqrt(a * a - r * r) for a, r in zip(outer, (60.0, 80.0), strict=True))
        path -= math.sqrt(found**2 - 140.0**2)
        pitch = math.pi * module * math.cos(math.radians(20.0))
        assert path / pitch == pytest.approx(ratio, abs=6e-6)


ROWS = {  # the main bands at a depth of 0.5, kHz
    "fixed": ((7.80, 8.80), (3.95, 4.30)),
    "tangent 1e3": ((10.50, 11.90), (5.35, 5.80)),
    "tangent 1e5": ((10.80, 12.20), (5.50, 5.95), (7.00, 7.10)),
    "tangent 1e6": ((10.65, 11.20), (6.40, 6.75), (5.35, 5.55), (7.50, 7.75), (8.90, 9.05)),
    "paper 1e3": ((8.85, 9.65),),
}


@pytest.mark.parametrize("name", list(ROWS))
def test_main_bands_of_instability(name):
    kind, _, held = name.partition(" ")
    pair = paper_pair() if kind == "fixed" else paper_pair(kind, kx=float(held))
    system = linear(pair, "fixed") if kind == "fixed" else linear(pair, "plane", static(pair))
    frequencies = np.linspace(500.0, 14000.0, 271)
    row = largest(system, trapezoid(2e5, 0.5, 0.68), frequencies)
    found = [(a / 1e3, b / 1e3) for a, b in bands(frequencies, row > 1.0 + 1e-6)]
    for band in ROWS[name]:
        assert min(max(abs(a - band[0]), abs(b - band[1])) for a, b in found) < 0.051
