"""Loads of planetary stages against a printed report.

KISSsoft 03/2017, NREL 5 MW gearbox, stage_02.rtf of gfsReboucas/Drivetrain: 18/36/93 teeth, three
planets, 162105.5 N m on the sun at 294.5 1/min, carrier at 47.8 1/min, 175200 h.
"""

import pytest

from gearopt.formulations.drive.planetary import Cutting, Planets


def test_forces_and_speeds_are_printed():
    """F_t 285900.438 N at both meshes; n 246.7 1/min of the sun, 123.4 of a planet."""
    planets = Planets(Cutting(), 3, fewer=3)
    pair = planets.pair(21.0, 18.0, 93.0, 550.0)
    for with_ring, radius, speed in ((False, 0.5 * 18 * 21.0, 246.7), (True, 0.5 * 36 * 21, 123.4)):
        torque, relative = planets.slower(pair, with_ring)
        assert 162105.5e3 * torque / radius == pytest.approx(285900.438, rel=2e-6)
        assert 294.5 * relative == pytest.approx(speed, abs=0.06)
