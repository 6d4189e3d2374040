"""Forces on shafts: statics, a textbook's numbers, and the right-hand rule from the tooth trace."""

import math

import numpy as np
import pytest

from gearopt.physics.gears import GearPair
from gearopt.physics.shaft_forces import (
    OTHER,
    hands,
    mesh_forces,
    rotation,
    rpm,
    train_forces,
)

LBF = 0.45359237 * 9.80665
TORQUE = 50e3
FIRST = GearPair.of_teeth(2.5, 19, 77, 32.0, math.radians(18.0), profile_shifts=(0.2, 0.1))
SECOND = GearPair.of_teeth(4.0, 18, 67, 50.0, math.radians(10.0))
THIRD = GearPair.of_teeth(6.0, 20, 41, 80.0, math.radians(8.0))
TRAIN = (FIRST, SECOND, THIRD)


def test_a_textbook_pair():
    """Solutions of Shigley, problem 13-35: 4/in normal, 18/32, 30 deg, W_t 800: 336, 462, 983."""
    pair = GearPair.of_teeth(25.4 / 4, 18, 32, 50.0, math.radians(30.0))
    found = mesh_forces(pair, 800 * LBF * 0.5 * pair.pinion.reference_diameter)
    parts = [float(f) / LBF for f in (found.tangential, found.radial, found.axial)]
    assert [round(f) for f in parts] == [800, 336, 462]
    assert round(math.hypot(*parts)) == 983


@pytest.mark.parametrize("pair", [SECOND, THIRD, GearPair.of_teeth(3.0, 20, 60, 30.0)])
def test_without_shift_the_force_is_normal_to_the_tooth(pair):
    """|F| = F_t/(cos alpha_n cos beta)."""
    found = mesh_forces(pair, TORQUE)
    gear = pair.pinion
    cosines = math.cos(gear.rack.pressure_angle) * math.cos(gear.helix_angle)
    whole = math.hypot(found.tangential, found.radial, found.axial)
    assert whole == pytest.approx(found.tangential / cosines, rel=1e-12)


def test_with_shift_the_force_lies_on_the_line_of_action():
    """Its moment about the axis is the torque at the base circle: F cos(beta_b) r_b = T."""
    found, gear = mesh_forces(FIRST, TORQUE), FIRST.pinion
    whole = math.hypot(found.tangential, found.radial, found.axial)
    slope = math.asin(math.sin(gear.helix_angle) * math.cos(gear.rack.pressure_angle))
    moment = whole * math.cos(slope) * 0.5 * float(gear.base_diameter)
    assert moment == pytest.approx(TORQUE, rel=1e-12)


def test_every_shaft_is_in_balance():
    """Torque goes in at the input and out at the last shaft; between them nothing is left."""
    found = train_forces(TRAIN, TORQUE, hands([None] * 3))
    ratio = math.prod(float(pair.ratio) for pair in TRAIN)
    outside = {1: TORQUE, 2: 0.0, 3: 0.0, 4: -TORQUE * ratio}
    for shaft, given in outside.items():
        inside = sum(f.tangential * f.radius for f in found if f.shaft == shaft)
        assert inside + given == pytest.approx(0.0, abs=1e-12 * TORQUE * ratio)


def test_action_is_reaction():
    found = train_forces(TRAIN, TORQUE, ["right", "left", "left"])
    for stage in (1, 2, 3):
        pinion, wheel = (f for f in found if f.stage == stage)
        assert pinion.axial == -wheel.axial and pinion.radial == wheel.radial
        assert pinion.tangential == -wheel.tangential and wheel.hand == OTHER[pinion.hand]


@pytest.mark.parametrize("hand", ["right", "left"])
@pytest.mark.parametrize("stage", [0, 1, 2])
def test_the_right_hand_rule_follows_from_the_trace_of_a_tooth(hand, stage):
    """The trace climbs along the axis as it turns; the flank pushes square to it, along the turn.

    A right-hand thread moves away from the eye, +z, as it winds clockwise, +phi.
    """
    helix = TRAIN[stage].pinion.helix_angle * (1.0 if hand == "right" else -1.0)
    turn = 1.0 if stage % 2 == 0 else -1.0  # along +phi on shafts 1 and 3, along -phi on shaft 2
    trace = np.array([math.sin(helix), math.cos(helix)])  # phi, z
    push = np.array([trace[1], -trace[0]]) * turn  # on the wheel: square to the trace, along turn
    assert push @ trace == pytest.approx(0.0, abs=1e-15) and push[0] * turn > 0.0
    chosen = [hand if k == stage else "right" for k in range(3)]
    found = train_forces(TRAIN, TORQUE, chosen)
    pinion = next(f for f in found if f.stage == stage + 1 and f.member == "pinion")
    assert math.copysign(1.0, pinion.axial) == math.copysign(1.0, -push[1])


def test_by_default_the_thrusts_of_an_intermediate_shaft_oppose():
    assert hands([None, None, None]) == ["right", "left", "right"]
    assert hands(["left", None, "right"]) == ["left", "right", "right"]
    by_default = train_forces(TRAIN, TORQUE, hands([None] * 3))
    turned = train_forces(TRAIN, TORQUE, ["right"] * 3)
    for shaft in (2, 3):
        first, second = (f.axial for f in by_default if f.shaft == shaft)
        assert first * second < 0.0
        less, more = (
            abs(sum(f.axial for f in found if f.shaft == shaft)) for found in (by_default, turned)
        )
        assert less < more


def test_shafts_turn_in_turn():
    assert [rotation(k) for k in (1, 2, 3)] == ["clockwise", "anticlockwise", "clockwise"]
    assert rpm(2.0 * math.pi) == pytest.approx(60.0, rel=1e-15)
