"""Stages with an idler: the search against every pinion, idler, wheel, module and width."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from campaigns import few
from rated_drives import MATERIALS, MODULES, RACK, STEELS, agma, iso, rated_drive

from gearopt.formulations.drive.design import describe
from gearopt.formulations.drive.idler import with_idler
from gearopt.formulations.drive.teeth import gears, problem
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth
from gearopt.formulations.strength.standard import Option
from gearopt.optimise.solve import run
from gearopt.physics.agma.rating import rate as by_agma
from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.rating import rate as by_iso
from gearopt.physics.rating import Operation

HOURS = 20000.0
RATE = {"agma": by_agma, "iso": by_iso}
MADE = {"agma": agma, "iso": iso}


def bent_both_ways(both):
    """Materials of both meshes, of which the idler's is reversed."""
    idler = replace(both[1], reversed_load=True)
    return (both[0], idler), (idler, both[0])


def some_drive(seed, before=0):
    """A small drive whose last stage has an idler; its data for the brute force."""
    rng = np.random.default_rng(seed)
    standards = [("agma",), ("iso",), ("agma", "iso")][seed % 3]
    helix, rpm = float(rng.choice([0.0, 0.2])), float(rng.choice([150.0, 1450.0]))
    shifts = [float(x) for x in rng.choice([-0.1, 0.0, 0.2, 0.3], 3)]
    begin = int(rng.integers(2, 6))
    modules = MODULES[begin : begin + 3]
    low = int(rng.integers(18, 24))
    pinion, idler = (low, low + 2), (low - 1, low + int(rng.integers(4, 9)))
    kind = ["tied", "fixed", "stepped"][int(rng.integers(3))]
    d = float(modules[1]) * low / math.cos(helix)
    face = {
        "tied": FaceWidth(Fraction(3, 5), Fraction(3, 5)),
        "fixed": FaceWidth(Fraction(0), None, fixed=Fraction(round(0.7 * d))),
        "stepped": FaceWidth(Fraction(3, 10), Fraction(1), step=Fraction(4)),
    }[kind]
    materials = {"agma": bent_both_ways(STEELS), "iso": bent_both_ways(MATERIALS)}
    suffix = {"agma": {}, "iso": {"suffix": "_iso"} if len(standards) > 1 else {}}
    halves = []
    for mesh in (0, 1):
        option = Option(tuple(MADE[n](materials[n][mesh], **suffix[n]) for n in standards))
        teeth = (pinion, idler) if mesh == 0 else (idler, (1, None))
        cut = Toothing(helix, (RACK, RACK), profile_shifts=(shifts[mesh], shifts[mesh + 1]))
        halves.append(
            {"options": (option,), "toothings": (cut,)}
            | {"pinion_teeth": teeth[0], "wheel_teeth": teeth[1]}
        )
    torque = d**3 * float(rng.choice([0.1, 0.2, 0.3])) * (0.1 if "iso" in standards else 1.0)
    ratio = Fraction(int(rng.integers(12, 40)), 10)
    drive = rated_drive(ratio, (face,) * 2, torque * rpm * math.pi / 30.0, rpm, modules=modules)
    first, second = (replace(s, **h) for s, h in zip(drive.stages, halves, strict=True))
    aim = {"objective": "mass" if seed % 2 else "gear_volume", "density": 7.85e-9}
    safety = 1.3, 1.05
    train = replace(drive, stages=(with_idler(first, second),), safety=safety, **aim)
    return train, (first, second), materials, standards, shifts


def allowed_widths(face, d1):
    if face.tied:
        return [float(face.low) * d1]
    if face.fixed:
        return [float(face.fixed)]
    counts = range(1, math.floor(float(face.high) * d1 / 4.0) + 1)
    return [4.0 * n for n in counts if 4.0 * n >= float(face.low) * d1]


def safe(train, materials, standards, pairs):
    """Whether both meshes have the safety factors, each rated alone as floats."""
    power, speed = train.torque * train.speed, train.speed
    for mesh, pair in enumerate(pairs):
        operation = Operation(power, speed, HOURS, overload=1.25)
        for name in standards:
            made = MADE[name](materials[name][mesh])
            try:
                rated = RATE[name](pair, operation, materials[name][mesh], made.practice)
            except ValueError:
                return False
            if min(rated.bending_safety) < 1.3 or min(rated.contact_safety) < 1.05:
                return False
        speed /= float(pair.ratio)
    return True


def brute_force(train, halves, materials, standards, shifts):
    """Least volume [mm3] of three gears, and the gears; every choice is tried, none left out."""
    first, best = halves[0], (math.inf, None)
    helix = first.toothing.helix_angle
    for z1 in range(first.pinion_teeth[0], first.pinion_teeth[1] + 1):
        for z2 in range(first.wheel_teeth[0], first.wheel_teeth[1] + 1):
            wheels = range(
                math.ceil(train.lowest_ratio * z1), math.floor(train.highest_ratio * z1) + 1
            )
            for z3 in (z for z in wheels if z1 <= z2 <= z):
                for module in map(float, first.modules):
                    d = [module * z / math.cos(helix) for z in (z1, z2, z3)]
                    for b in allowed_widths(first.face_width, d[0]):
                        volume = 0.25 * math.pi * b * sum(x * x for x in d)
                        if volume >= best[0]:
                            break
                        pairs = [
                            GearPair.of_teeth(
                                module, float(a), float(c), b, helix, RACK, tuple(shifts[k : k + 2])
                            )
                            for k, (a, c) in enumerate(((z1, z2), (z2, z3)))
                        ]
                        if safe(train, materials, standards, pairs):
                            best = volume, ((z1, z2), (z2, z3), module, b)
                            break
    return best


def agrees(seed):
    """Assert that the search finds what the brute force does; its status."""
    train, *data = some_drive(seed)
    least, teeth = brute_force(train, *data)
    result, outcome = run(problem(train))
    if teeth is None:
        assert result.status == "infeasible"
        return result.status
    assert result.status == "optimal"
    scale = 7.85e-6 if train.objective == "mass" else 1.0
    assert result.value == pytest.approx(scale * least, rel=1e-9)
    assert result.bound == pytest.approx(scale * least, rel=1e-9)
    design = describe(train, *gears(train, outcome.x))
    assert [(s.pinion_teeth, s.wheel_teeth) for s in design.stages] == [*teeth[:2]]
    assert [s.normal_module_mm for s in design.stages] == [teeth[2]] * 2
    assert [s.face_width_mm for s in design.stages] == pytest.approx([teeth[3]] * 2, rel=1e-9)
    assert [s.idler for s in design.stages] == [False, True]
    assert design.gear_volume_mm3 == pytest.approx(least, rel=1e-9)
    assert design.mass_kg == pytest.approx(7.85e-6 * least, rel=1e-9)
    return result.status


@pytest.mark.parametrize("seed", few((0, 11), 1))
def test_a_small_drive_with_an_idler_against_brute_force(seed):
    assert agrees(seed) == "optimal"


@pytest.mark.slow
def test_small_drives_with_idlers_against_brute_force():
    found = [agrees(seed) for seed in range(30)]
    assert found.count("optimal") >= 20
    assert found.count("infeasible") >= 1


def least_pair(train, stage, materials, standards, teeth):
    """Least volume [mm3] of a stage without idler."""
    best = math.inf
    for module in map(float, stage.modules):
        for b in allowed_widths(stage.face_width, module * teeth[0] / stage.toothing.cosine):
            pair = stage.toothing.pair(module, float(teeth[0]), float(teeth[1]), b)
            if float(pair.volume) < best and safe(train, materials, standards, [pair]):
                best = float(pair.volume)
    return best


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 6, 11, 25])
def test_a_stage_before_that_with_the_idler(seed):
    """Its ratio sets torque and speed of both meshes after it."""
    train, halves, materials, standards, shifts = some_drive(seed)
    both = {name: (made[0][0], made[0][0]) for name, made in materials.items()}
    suffix = {"suffix": "_iso"} if len(standards) > 1 else {}
    made = (MADE[n](both[n], **(suffix if n == "iso" else {})) for n in standards)
    z = halves[0].pinion_teeth[0]
    plain = replace(
        halves[0],
        options=(Option(tuple(made)),),
        pinion_teeth=(z, z + 1),
        wheel_teeth=(1, None),
        ratio=(Fraction(8, 5), Fraction(9, 5)),
    )
    asked = {"ratio": train.ratio * Fraction(17, 10), "torque": train.torque / 1.7}
    two = replace(train, stages=(plain, *train.stages), speed=train.speed * 1.7, **asked)
    result, _ = run(problem(two))
    least = math.inf
    for z1 in (z, z + 1):
        for z2 in range(math.ceil(z1 * plain.ratio[0]), math.floor(z1 * plain.ratio[1]) + 1):
            u = Fraction(z2, z1)
            alone = {name: (pair,) for name, pair in both.items()}
            volume = least_pair(two, plain, alone, standards, (z1, z2))
            load = {"torque": two.torque * float(u), "speed": two.speed / float(u)}
            rest = replace(train, ratio=two.ratio / u, **load)
            least = min(least, volume + brute_force(rest, halves, materials, standards, shifts)[0])
    assert result.status == "optimal"
    scale = 7.85e-6 if train.objective == "mass" else 1.0
    assert result.value == pytest.approx(scale * least, rel=1e-9)
