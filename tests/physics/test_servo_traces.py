"""Every law of the servo train: traced = batch, derivatives = central differences."""

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics import (
    backlash,
    gears,
    servo_drive,
    stiffness,
    tolerances,
)

LAWS = [
    lambda a, b, c, d: gears.disc_mass(a, b, c),
    lambda a, b, c, d: gears.disc_inertia(a, b, c),
    lambda a, b, c, d: servo_drive.load_acceleration(d, a, b, 10.0 * c, 3.0, 0.9, 0.1 * c),
    lambda a, b, c, d: servo_drive.torque_slope(a, b, c),
    lambda a, b, c, d: servo_drive.shortest_move_time(a, b, c),
    lambda a, b, c, d: servo_drive.shortest_move_time(c, 10.0 * b, a),
    lambda a, b, c, d: servo_drive.rms_torque(a, b, c, d, 3.0, 0.2),
    lambda a, b, c, d: stiffness.shaft_compliance(a, b, c),
    lambda a, b, c, d: stiffness.tooth_factor(0.1 * a),
    lambda a, b, c, d: stiffness.lewis_form_factor(20.0 * a),
    lambda a, b, c, d: stiffness.specific_pair_stiffness(a, b, c, d),
    lambda a, b, c, d: stiffness.mesh_compliance(a, b, c),
    lambda a, b, c, d: stiffness.output_compliance((a, b), (c, d)),
    lambda a, b, c, d: stiffness.locked_frequency(a, b),
    lambda a, b, c, d: stiffness.stiffness_of_frequency(a, b),
    lambda a, b, c, d: backlash.radial_backlash(a, 0.2 * b, 0.3 * c),
    lambda a, b, c, d: backlash.thickness_backlash(-a, -b, -0.1 * c, 0.35, 0.2 * d),
    lambda a, b, c, d: backlash.normal_backlash(a, 0.2 * b, 0.3 * c),
    lambda a, b, c, d: backlash.output_error(
        (backlash.backlash_angle(a, b), backlash.pitch_error_angle(b, c)), (d, 1.0)
    ),
    lambda a, b, c, d: tolerances.single_pitch_tolerance(a, b, c),
    lambda a, b, c, d: tolerances.total_pitch_tolerance(a, b, c),
    lambda a, b, c, d: tolerances.total_profile_tolerance(a, b, c),
    lambda a, b, c, d: tolerances.total_helix_tolerance(a, b, c),
    lambda a, b, c, d: tolerances.runout_tolerance(a, b, c),
]


@pytest.mark.parametrize("law", LAWS)
def test_traced_equals_batch_and_derivatives_central_differences(law):
    point = np.array([1.7, 1.3, 2.1, 1.9])
    x = ca.SX.sym("x", 4)
    with legacy_numpy():
        value = law(*ca.vertsplit(x))
    function = ca.Function("law", [x], [value, ca.gradient(value, x)])
    traced, gradient = (np.array(v).ravel() for v in function(point))
    assert np.allclose(law(*np.tile(point, (3, 1)).T), traced, rtol=4e-15, atol=0)
    for k in range(4):
        step = 1e-5 * point[k]
        ends = [law(*(point + s * step * np.eye(4)[k])) for s in (1, -1)]
        size = abs(float(traced[0])) + 1e-300
        assert gradient[k] == pytest.approx(
            (ends[0] - ends[1]) / (2 * step), rel=1e-7, abs=1e-8 * size
        )
