"""The best drive that increases the speed, or of 1:1, is that of all candidates, each rated."""

import itertools
import math
import random
from fractions import Fraction
from functools import cache

import pytest

import gearopt

MODULES = (2, 2.5, 3)
RATINGS = {
    "agma": {"standard": "agma", "quality": 9},
    "iso6336": {"standard": "iso6336", "iso6336": {"accuracy_grade": 6}},
}
STEP = 4  # mm, of face widths


def tables(speed, rating, stages, **more):
    """A file at 5 kW and an input speed [rpm]."""
    asked = {"life": "10000 h", "minimum_bending_safety": 1.3, "minimum_contact_safety": 1.0}
    made = {"gearopt": 1, "kind": "drive", "rating": asked | RATINGS[rating], "stage": stages}
    duty = {"power": "5 kW", "input_speed": f"{speed!r} rpm"} | more.pop("duty", {})
    return (
        made | {"duty": duty, "gears": {"treatment": "carburised"} | more.pop("gears", {})} | more
    )


@cache
def least(speed, rating, teeth, driver):
    """Least volume of a pair that is safe at the speed of its driver [mm3]; inf: none."""
    (z1, z2), best = teeth, math.inf
    for module in MODULES:
        d1, d2 = module * z1, module * z2
        low, high = math.ceil(0.4 * d1 / STEP), math.floor(0.9 * d1 / STEP)
        for b in range(low * STEP, high * STEP + 1, STEP):
            volume = math.pi / 4 * b * (d1**2 + d2**2)
            if volume < best:
                sizes = {"module": f"{module} mm", "face_width": f"{b} mm", "driver": driver}
                pair = sizes | {"pinion_teeth": z1, "wheel_teeth": z2}
                if gearopt.rate(tables(speed, rating, [pair])).design["rating"]["safe"]:
                    best = volume
                    break
    return best


def candidates(ratio, tolerance, pinions, wheel, stages, coprime):
    """Trains whose stages all reduce the speed or all increase it: the driver, the teeth."""
    every = [(a, b) for a in pinions for b in range(a, wheel + 1)]
    every = [(a, b) for a, b in every if not coprime or math.gcd(a, b) == 1]
    for train in itertools.product(every, repeat=stages):
        u = math.prod(Fraction(b, a) for a, b in train)
        for driver, reached in (("pinion", u), ("wheel", 1 / u)):
            if abs(reached / ratio - 1) <= tolerance:
                yield driver, train


def brute(speed, rating, *which):
    """The least volume of all candidates."""
    best = math.inf
    for driver, train in candidates(*which):
        at, value = speed, 0.0
        for z1, z2 in train:
            value += least(at, rating, (z1, z2), driver)
            at *= z1 / z2 if driver == "pinion" else z2 / z1
            if value >= best:
                break
        best = min(best, value)
    return best


def drawn(seed):
    """A random small drive: its ratio is below 1, or 1 to both sides."""
    draw = random.Random(seed)
    stages = draw.choice([1, 1, 1, 2])
    low = draw.randint(17, 21)
    wheel = low + draw.randint(8, 14) if stages == 1 else low + 5
    even = Fraction(1) if draw.random() < 0.5 else Fraction(low, wheel - draw.randint(1, 4))
    ratio = even if stages == 1 else even * even
    tolerance = Fraction(draw.choice([2, 4, 8] if ratio < 1 else [4, 6, 12]), 100)
    pinions = range(low, low + (5 if stages == 1 else 3))
    case = draw.choice([700, 1450]), draw.choice([*RATINGS]), ratio, tolerance
    return *case, pinions, wheel, stages, draw.random() < 0.5


def assert_best(speed, rating, ratio, tolerance, pinions, wheel, stages, coprime):
    value = brute(speed, rating, ratio, tolerance, pinions, wheel, stages, coprime)
    limits = {"pinion_teeth": [pinions[0], pinions[-1]], "wheel_teeth": [pinions[0], wheel]}
    file = tables(
        speed,
        rating,
        [{}] * stages,
        duty={"ratio": 1 if ratio == 1 else str(ratio), "ratio_tolerance": float(tolerance)},
        gears={"face_width_over_diameter": [0.4, 0.9], "face_width_step": f"{STEP} mm"},
        limits=limits,
        teeth={"modules": [f"{m} mm" for m in MODULES], "coprime": coprime},
    )
    result = gearopt.solve(file)
    assert result.status == ("optimal" if value < math.inf else "infeasible")
    if value < math.inf:
        assert result.value == pytest.approx(value, rel=1e-12)
    return result


QUICK = (21,)
SEEDS = [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in range(24)]


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_the_best_is_that_of_all_candidates(seed):
    assert_best(*drawn(seed))


FORCES = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "6 kW", "input_speed": "900 rpm", "ratio": "4/25", "ratio_tolerance": 0.0},
    "gears": {"treatment": "carburised", "helix_angle": "12 deg"},
    "stage": [{}, {}],
    "limits": {"pinion_teeth": [18, 22], "wheel_teeth": [18, 90]},
    "teeth": {"modules": ["1.5 mm", "2 mm", "2.5 mm", "3 mm", "4 mm"]},
    "rating": {"standard": "iso6336", "life": "10000 h", "iso6336": {"accuracy_grade": 6}},
    "objective": {"minimise": "axial_force"},
}


@pytest.mark.slow
def test_the_least_axial_force_is_that_of_wheels_that_drive():
    """2 T tan(beta)/d with T from the input on, which falls from stage to stage."""
    gears = FORCES["gears"] | {"face_width_over_diameter": [0.3, 1.0]}
    found = gearopt.solve(FORCES | {"gears": gears})
    torque, forces = 6000.0 / (900.0 * math.pi / 30.0), []  # N m
    for stage in found.design["stages"]:
        forces.append(2e3 * torque * math.tan(math.radians(12.0)) / stage["wheel_diameter_mm"])
        torque /= stage["ratio"]
    assert found.status == "optimal" and found.value == pytest.approx(max(forces), rel=1e-9)
    rated = [mesh["axial_force_N"] for mesh in found.design["rating"]["meshes"]]
    assert rated == pytest.approx(forces, rel=1e-9)
