"""The transmission error in motion against the oscillator of one mass in closed form.

m x'' + c (x - e)' + k (x - e) = F with e = E cos W t: X/E = (k + i c W)/(k - m W^2 + i c W).
"""

import math

import numpy as np
import pytest
from test_kahraman_singh import HALF, LOAD, MASS, RATE, STIFFNESS, file, rpm

import gearopt
from gearopt.physics.motion.moving_pair import MovingPair, Rotor
from gearopt.physics.motion.stiffness_wave import constant

RATIO, SHAKE = 0.05, 0.01  # of critical damping; amplitude of e over half the backlash


def amplitude(w, ratio=RATIO):
    """|X|/E at W = w omega_n."""
    c = 2.0 * ratio * MASS * RATE
    turn = w * RATE
    held = STIFFNESS + 1j * c * turn
    return abs(held / (held - MASS * turn**2))


def solved_file(**tables):
    content = file(RATIO, ([SHAKE], []), "in_contact", **tables)
    del content["mesh"]["backlash"], content["mesh"]["damping_acts"]
    return gearopt.solve(content).design


def test_over_speed_it_is_the_transmissibility_of_one_mass():
    """At W = sqrt(2) omega_n, too, where without damping it is the error itself."""
    speeds = solved_file(speeds={"range": [f"{rpm(w)!r} rpm" for w in (0.2, 2.0)], "points": 19})
    speeds = speeds["speeds"]
    for k, speed in enumerate(speeds["speed_rpm"]):
        size = HALF * SHAKE * amplitude(speed / rpm(1.0))
        told = speeds["transmission_error"]
        assert told["rms_mm"][k] == pytest.approx(size / math.sqrt(2.0), rel=1e-6)
        assert told["peak_to_peak_mm"][k] == pytest.approx(2.0 * size, rel=1e-4)
        rest = LOAD * HALF  # F/k
        assert told["highest_mm"][k] == pytest.approx(rest + size, rel=1e-5)  # of 1024 samples
    assert amplitude(math.sqrt(2.0), 0.0) == pytest.approx(1.0)


def test_in_time_it_comes_to_the_same():
    asked = {"duration": "20 ms", "outputs": 4001, "error": 1e-5, "start": "equilibrium"}
    moved = solved_file(simulate=asked, mesh={"speed": f"{rpm(0.7)!r} rpm"})["response"]
    told, size = moved["transmission_error"], HALF * SHAKE * amplitude(0.7)
    assert told["rms_mm"] == pytest.approx(size / math.sqrt(2.0), rel=2e-3)
    assert told["peak_to_peak_mm"] == pytest.approx(2.0 * size, rel=2e-3)
    apart = np.array(told["values_mm"]) + np.array(moved["deformation_mm"])
    w = 0.7 * RATE * 1e-3 * np.array(moved["time_ms"])
    assert apart == pytest.approx(HALF * SHAKE * np.cos(w), abs=1e-8)


def test_teeth_without_an_error_are_told_by_their_deformation():
    content = file(RATIO, ([0.0], []), "in_contact", simulate={"duration": "1 ms"})
    content["mesh"].pop("error_cosines")
    response = gearopt.solve(content).design["response"]
    assert response.get("transmission_error") is None


def test_harmonics_of_the_error_are_cosines_and_sines():
    gear = Rotor(60.0, 1e-3, 2.0, (1e3, 1e3))
    pair = MovingPair(gear, gear, 0.35, constant(2e5), error=(3e-3 - 1e-3j, 0.5e-3j))
    turn = 2.0 * math.pi * 0.17
    known = 3e-3 * math.cos(turn) + 1e-3 * math.sin(turn) - 0.5e-3 * math.sin(2.0 * turn)
    assert pair.error_at(0.17) == pytest.approx(known, rel=1e-12)
