"""Loads of planetary stages against a printed report; rules of K_gamma.

KISSsoft 03/2017, NREL 5 MW gearbox, stage_02.rtf of gfsReboucas/Drivetrain: 18/36/93 teeth, three
planets, 162105.5 N m on the sun at 294.5 1/min, carrier at 47.8 1/min, 175200 h.
"""

import pytest

from gearopt.formulations.drive.planetary import Cutting, Planets
from gearopt.physics.planetary.loads import mesh_load_factor


def test_forces_and_speeds_are_printed():
    """F_t 285900.438 N at both meshes; n 246.7 1/min of the sun, 123.4 of a planet."""
    planets = Planets(Cutting(), 3, fewer=3)
    pair = planets.pair(21.0, 18.0, 93.0, 550.0)
    for with_ring, radius, speed in ((False, 0.5 * 18 * 21.0, 246.7), (True, 0.5 * 36 * 21, 123.4)):
        torque, relative = planets.slower(pair, with_ring)
        assert 162105.5e3 * torque / radius == pytest.approx(285900.438, rel=2e-6)
        assert 294.5 * relative == pytest.approx(speed, abs=0.06)


@pytest.mark.parametrize(
    ("rule", "values"),
    [
        ("wind", {3: 1.10, 4: 1.25, 5: 1.35, 6: 1.44, 7: 1.47}),
        ("class society", {3: 1.0, 4: 1.2, 5: 1.3, 6: 1.4, 9: 1.4}),
        ("square root", {1: 1.0, 3: 1.0, 4: 1.25, 7: 1.5, 12: 1.75}),
    ],
)
def test_mesh_load_factors_are_those_of_the_tables(rule, values):
    for planets, value in values.items():
        assert mesh_load_factor(planets, rule) == pytest.approx(value, rel=1e-12)


def test_what_a_rule_has_not_is_refused():
    with pytest.raises(ValueError, match="no K_gamma of 2 planets by 'wind': 3 to 7; give K_gamma"):
        mesh_load_factor(2, "wind")
    with pytest.raises(ValueError, match="no K_gamma of 8 planets"):
        mesh_load_factor(8, "wind")
    with pytest.raises(ValueError, match="no rule 'AGMA' of K_gamma; known: wind, class society"):
        mesh_load_factor(3, "AGMA")
