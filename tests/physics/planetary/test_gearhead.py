"""A planetary stage between motor and load, against particles, springs in the plane, a print."""

import math

import numpy as np
import pytest
from planar_set import PlanarSet

from gearopt.formulations.drive.planetary import Cutting
from gearopt.physics.geometry.tooth import circumferential_backlash
from gearopt.physics.planetary.gearhead import (
    Gearset,
    compliances,
    inertias,
    lost_motion,
    planet_play,
)
from gearopt.physics.planetary.willis import ENDS

STEEL = 7.85e-9
TEETH = (18, 21, 60)
HELD = ("ring", "carrier", "sun")


def gearset(held="ring", helix=0.0, shifts=(0.3, 0.2, None), allowances=(0.0, 0.0, 0.0)):
    """Three planets of 0.5 mm module, whose two meshes have unequal working angles."""
    cutting = Cutting(helix_angle=helix, shifts=shifts, allowances=allowances)
    gears = cutting.gears(0.5, tuple(map(float, TEETH)), 8.0)
    return Gearset(*gears, 3, held)


def planar(gears):
    """The same set in the plane."""
    angles = [float(pair.working_angle) for pair in gears.pairs()]
    return PlanarSet(TEETH, float(gears.distance), angles, gears.planets)


def particles(inner, outer, width, count=200):
    """Equal masses on circles of a tube of these radii and this width: (mass, radii)."""
    mass = STEEL * width * np.pi * (outer**2 - inner**2)
    rings = (np.arange(count) + 0.5) / count
    radii = np.sqrt(inner**2 + rings * (outer**2 - inner**2))
    return mass / count, radii


@pytest.mark.parametrize("held", HELD)
def test_inertia_is_that_of_particles_that_move(held):
    """Kinetic energy of particles whose paths are differentiated, at a unit speed of the motor."""
    gears, bores, carrier = gearset(held), (3.0, 2.5), 4e-4
    z_s, z_p, z_r = TEETH
    rolls = {  # angles of sun, ring and carrier by that of the motor: no slip at either mesh
        "ring": lambda t: (t, 0.0, t * z_s / (z_s + z_r)),
        "carrier": lambda t: (t, -t * z_s / z_r, 0.0),
        "sun": lambda t: (0.0, t, t * z_r / (z_s + z_r)),
    }[held]
    sun, ring, arm = rolls(1.0)
    spin = arm - z_s / z_p * (sun - arm)
    assert spin == pytest.approx(arm + z_r / z_p * (ring - arm))
    energy, mass = 0.5 * carrier * arm**2, 0.0
    bodies = [(gears.sun, bores[0], sun), (gears.ring, None, ring)]
    for gear, bore, turn in bodies:
        ends = (bore, gear.body) if bore is not None else (-gear.body, -gear.outside)
        each, radii = particles(0.5 * ends[0], 0.5 * ends[1], 8.0)
        energy, mass = energy + 0.5 * each * (radii * turn) @ (radii * turn), mass + 200 * each
    each, radii = particles(0.5 * bores[1], 0.5 * gears.planet.body, 3 * 8.0)
    mass += 200 * each
    step, phases = 1e-6, 2.0 * np.pi * np.arange(8) / 8
    for start in phases:

        def path(t, start=start):
            centre = float(gears.distance) * np.exp(1j * arm * t)
            return centre + radii * np.exp(1j * (start + spin * t))

        velocity = (path(step) - path(-step)) / (2.0 * step)
        energy += 0.5 * each / len(phases) * (abs(velocity) ** 2).sum()
    weight, parts = inertias(gears, STEEL, bores, carrier)
    total = sum(float(part) for part in parts.values())
    assert total == pytest.approx(2.0 * energy, rel=1e-5)
    assert weight == pytest.approx(mass)


def printed(allowances=(0.0, 0.0, 0.0)):
    """The printed stage: 18/36/93 teeth of 21 mm, shifts 0.389, 0.5039 and 0.1171, 584 mm apart."""
    cutting = Cutting(shifts=(0.389, 0.5039, 0.1171), distance=584.0, allowances=allowances)
    return Gearset(*cutting.gears(21.0, (18.0, 36.0, 93.0), 550.0), 3, "ring")


def test_backlash_of_a_printed_stage():
    """Allowances cd25 and js7 of the distance: 0.283 to 0.490 mm, and 0.463 to 0.708 mm."""
    tight, loose = printed((-0.130, -0.175, -0.320)), printed((-0.190, -0.255, -0.450))
    for gears, outwards, both in ((tight, -0.035, (0.283, 0.463)), (loose, 0.035, (0.490, 0.708))):
        outer, inner = gears.pairs(outwards)[0], gears.pairs(-outwards)[1]
        assert circumferential_backlash(outer) == pytest.approx(both[0], abs=1e-3)
        assert circumferential_backlash(inner) == pytest.approx(both[1], abs=1e-3)
    angles = [math.radians(24.169), math.radians(15.629)]
    play = 0.490 * math.cos(angles[0]) + 0.708 * math.cos(angles[1])
    radial = 2.0 * 0.035 * (math.sin(angles[0]) + math.sin(angles[1]))
    assert planet_play(loose) == pytest.approx(play - radial, abs=2e-3)


@pytest.mark.parametrize("held", HELD)
@pytest.mark.parametrize("helix", [0.0, 0.35])
@pytest.mark.parametrize("pin", [4e4, math.inf])
def test_springs_in_the_plane(held, helix, pin):
    """Every contact and pin a spring, all members free to move: the same turn of the output."""
    gears = gearset(held, helix)
    whole, springs = 3 * gears.lever**2, compliances(gears, 2e4, pin)
    meshes = [1.0 / (whole * float(c)) for c in springs[:2]]
    turn = planar(gears).compliance(ENDS[held][1], meshes, min(pin, 1e14))
    assert sum(springs) == pytest.approx(turn, rel=1e-6)


def test_light_loads_soften_the_teeth():
    """Below 100 N/mm of F_t/b c' goes by its fourth root; F_t from the torque of the sun."""
    gears = gearset("ring")
    force = 20.0 * gears.sun.face_width  # N, of 20 N/mm
    torque = 3 * force * 0.5 * gears.sun.reference_diameter * (1 + TEETH[2] / TEETH[0])
    soft, stiff = compliances(gears, torque), compliances(gears)
    assert soft[0] == pytest.approx(stiff[0] * 5.0**0.25, rel=1e-9)
    assert compliances(gears, 6.0 * torque)[0] == stiff[0]


@pytest.mark.parametrize("held", HELD)
def test_play_of_planets_that_differ(held):
    """Ends of the output's turn by linear programming: the least of the planets' plays is left."""
    rng = np.random.default_rng(7)
    gears = gearset(held)
    plane = planar(gears)
    for _ in range(2):
        backlashes = rng.uniform(0.01, 0.05, (3, 2))
        play = float(backlashes.sum(axis=1).min())
        turn = plane.play(ENDS[held][1], backlashes, [0.0] * 3)
        assert float(lost_motion(gears, play)) == pytest.approx(turn, rel=1e-9)
        loose = plane.play(ENDS[held][1], np.full((3, 2), 0.02), [0.0] * 3, 0.015)
        assert float(lost_motion(gears, 0.04, 0.015)) == pytest.approx(loose, rel=1e-4)


@pytest.mark.parametrize("held", HELD)
def test_pins_that_are_off_their_places(held):
    """Two pins to opposite sides take their difference; where it is too much, planets bind."""
    gears = gearset(held)
    plane, alike = planar(gears), np.full((3, 2), 0.01)
    turn = plane.play(ENDS[held][1], alike, [0.004, -0.003, 0.001])
    assert float(lost_motion(gears, 0.02, apart=0.007)) == pytest.approx(turn, rel=1e-9)
    assert plane.play(ENDS[held][1], alike, [0.008, -0.008, 0.0]) is None
    assert lost_motion(gears, 0.02, apart=0.016) < 0.0


def test_planets_moved_outwards():
    """Of equal working angles outer and inner backlash change alike, but for second order."""
    thin = (-0.02, -0.02, -0.02)
    unequal, plain = gearset(allowances=thin), gearset(shifts=(0.0, 0.0, 0.0), allowances=thin)
    assert planet_play(plain, 0.01) == pytest.approx(planet_play(plain), abs=1e-4)
    first, second = (math.sin(pair.working_angle) for pair in unequal.pairs())
    change = planet_play(unequal, 1e-4) - planet_play(unequal)
    assert change == pytest.approx(2e-4 * (first - second), rel=1e-2)


@pytest.mark.parametrize("held", HELD)
def test_efficiency_by_rolling_power(held):
    """Textbook formulas (Mueller, Epicyclic Drive Trains) with the loss of both meshes."""
    flow = gearset(held).flow(0.07)
    eta = math.prod(float(power.efficiency) for power in flow.meshes)
    r = TEETH[2] / TEETH[0]
    expected = {
        "ring": (1.0 + r * eta) / (1.0 + r),
        "carrier": eta,
        "sun": (r + eta) / (1.0 + r),
    }[held]
    assert float(flow.efficiency) == pytest.approx(expected, rel=1e-12)
    power = sum(flow.torques[n] * flow.speeds[n] for n in ("sun", "ring", "carrier"))
    assert power == sum(mesh.lost for mesh in flow.meshes)
    assert sum(flow.torques.values()) == 0
    assert ENDS[held][0] in flow.torques
