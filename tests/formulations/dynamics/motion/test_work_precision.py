"""Errors of methods at fixed steps, as an independent program has them, and their orders."""

import math
from functools import cache

import numpy as np
import pytest
from campaigns import few

from gearopt.bench.integrators import OUTPUTS, TIME, pair
from gearopt.formulations.dynamics.motion.integrate import STEPPERS, march
from gearopt.formulations.dynamics.motion.reference import scipy_motion
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.physics.motion.stiffness_wave import constant, trapezoid

SCENES = {
    "A": pair("paper", constant(2e5)),
    "B": pair("paper", trapezoid(2e5, 0.5, 0.6, 0.1), 1000.0),
    "C": pair("exact", constant(2e5)),
}
STEPS = {"rk4": (16, 64), "rk8": (2, 4), "symplectic": (8, 16)}  # in 50 us; of others 64 and 256
ERRORS = {  # largest |delta - reference| over the largest |delta|, of both steps; from rest, 20 ms
    ("A", "newmark"): (1.1938e-2, 7.4667e-4),
    ("A", "hht"): (1.3570e-2, 8.5002e-4),
    ("A", "generalised_alpha"): (1.2089e-2, 7.5562e-4),
    ("A", "rk4"): (7.5316e-4, 2.9575e-6),
    ("A", "rk8"): (1.9898e-4, 7.2630e-7),
    ("A", "symplectic"): (9.2118e-4, 1.4344e-5),
    ("B", "newmark"): (4.0469e-2, 2.4992e-3),
    ("B", "hht"): (4.6135e-2, 2.8468e-3),
    ("B", "generalised_alpha"): (4.0961e-2, 2.5294e-3),
    ("B", "rk4"): (2.8687e-3, 1.1082e-5),
    ("B", "rk8"): (1.0080e-3, 3.5678e-6),
    ("B", "symplectic"): (3.9014e-3, 6.0877e-5),
    ("C", "newmark"): (1.1955e-2, 7.4866e-4),
    ("C", "hht"): (1.3606e-2, 8.5250e-4),
    ("C", "generalised_alpha"): (1.2104e-2, 7.5799e-4),
    ("C", "rk4"): (2.2880e-4, 9.0213e-7),
    ("C", "rk8"): (4.5467e-6, 1.7112e-8),
    ("C", "symplectic"): (8.0929e-5, 1.2635e-6),
}


@cache
def motion(scene, method, steps):
    """Return delta (401,) with so many steps of a method between two outputs."""
    level = "way" if method == "symplectic" else "plane"
    times = timeline(SCENES[scene], np.linspace(0.0, TIME, OUTPUTS))
    longest = TIME / (OUTPUTS - 1) / steps
    return march(SCENES[scene], level, times, method, longest, np.zeros(10)).delta


QUICK = [k for k in ERRORS if "rk" in k[1] or k in list(ERRORS)[::4]]


@pytest.mark.parametrize(("scene", "method"), few(ERRORS, QUICK))
def test_errors_and_orders(scene, method):
    """The independent program treats a rising stiffness otherwise in HHT: to half a percent."""
    known = motion(scene, "rk8", 64)
    scale, steps = np.max(np.abs(known)), STEPS.get(method, (64, 256))
    found = [np.max(np.abs(motion(scene, method, n) - known)) / scale for n in steps]
    assert found == pytest.approx(ERRORS[scene, method], rel=6e-3)
    order = math.log(found[0] / found[1]) / math.log(steps[1] / steps[0])
    assert order == pytest.approx(STEPPERS[method].order, abs=0.15)


def test_steps_short_enough_meet_an_error_of_1e_9():
    """RK8 with 16 steps in 50 us: 2.7e-11, 5.3e-11 and 3.8e-12 of that program."""
    for scene, known in (("A", 2.7e-11), ("B", 5.3e-11), ("C", 3.8e-12)):
        fine = motion(scene, "rk8", 64)
        off = np.max(np.abs(motion(scene, "rk8", 16) - fine)) / np.max(np.abs(fine))
        assert off < 2.0 * known, scene


@pytest.mark.parametrize("scene", few("CA", 1))
def test_a_tolerance_is_not_the_error(scene):
    """DOP853 at 1e-7 leaves a hundred times as much: 6e-6 to 1.1e-5."""
    known, times = motion(scene, "rk8", 64), np.linspace(0.0, TIME, OUTPUTS)
    found = scipy_motion(SCENES[scene], "plane", times, "DOP853", 1e-7, np.zeros(10)).delta
    error = np.max(np.abs(found - known)) / np.max(np.abs(known))
    assert 3e-6 < error < 2e-5
