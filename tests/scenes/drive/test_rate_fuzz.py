"""Random files to be rated: a rating of finite numbers, or a refusal by name."""

import math
import random

import pytest
from rated_files import numbers_of, pair

import gearopt

TREATMENTS = ("through-hardened", "nitrided", "nitralloy", "carburised", "induction, roots")

WEBBED = {"rim_over_module": 2.5, "web_over_face_width": 0.3}
IN_MM = {"rim_thickness": "4 mm", "web_thickness": "9 mm", "bore": "12 mm", "hub_over_bore": 1.4}
BODIES = ({}, {}, {"rim_thickness": "3 mm"}, WEBBED, IN_MM, {"bore": "30 mm"})


def gear(chance):
    made = {"profile_shift": round(chance.uniform(-0.5, 0.8), 3)}
    made["tip_alteration"] = chance.choice([0, -0.2, 0.1])
    made["thickness_allowance"] = f"-{chance.choice([0, 0.01, 0.3])} mm"
    made["tool_addendum"] = chance.choice([1.0, 1.25, 1.4])
    made["tool_tip_radius"] = chance.choice([0, 0.1, 0.25, 0.38])
    made["treatment"] = chance.choice(TREATMENTS)
    made["hardness"], made["grade"] = f"{chance.choice([150, 300, 450])} HB", chance.choice([1, 2])
    made["reversed_load"], made["contacts"] = chance.random() < 0.2, chance.choice([1, 5])
    return made | chance.choice(BODIES)


def file(chance):
    teeth, module = chance.choice([5, 8, 12, 17, 25, 60, 1000]), chance.choice([0.1, 1, 3, 50])
    stage = {
        "module": f"{module} mm",
        "pinion_teeth": teeth,
        "wheel_teeth": round(teeth * chance.choice([1, 1.3, 3, 8])),
        "face_width": f"{chance.choice([1, 20, 300])} mm",
        "helix_angle": f"{chance.choice([0, 0.5, 10, 30, 44])} deg",
        "pressure_angle": f"{chance.choice([14.5, 20, 25])} deg",
    }
    rating = {
        "life": f"{chance.choice([0.001, 2e4, 1e8])} h",
        "quality": chance.choice([5, 6, 8, 11]),
        "edition": chance.choice(["D04", "B88"]),
        "service": chance.choice(["general", "critical"]),
        "bending_load": chance.choice(["tip", "highest single"]),
        "size_factor": chance.choice(["one", "shigley"]),
        "reliability": chance.choice([0.5, 0.95, 0.9999]),
        "oil_viscosity": f"{chance.choice([1, 40, 2000])} mPa s",
    }
    power, speed = chance.choice([1e-6, 1, 1e4]), chance.choice([0.01, 1450, 1e5])
    load = [{"power": f"{power * part} kW", "share": part} for part in (0.25, 0.75)]
    duty = {"power": f"{power} kW", "input_speed": f"{speed} rpm"}
    levels = load if chance.random() < 0.4 else None
    return pair(rating, duty, None, gear(chance), gear(chance), levels, **stage)


def checked(seed):
    """Whether a random file has a rating, whose numbers are finite."""
    try:
        result = gearopt.rate(file(random.Random(seed)))
    except gearopt.SolveError as reason:
        assert str(reason).startswith("stage 1 cannot be rated: ")
        return False
    except gearopt.SceneError as wrong:
        assert wrong.key and wrong.remedy
        return False
    found = numbers_of(result.design) | result.limits
    assert found and all(map(math.isfinite, found.values()))
    assert result.design["rating"]["safe"] == result.feasible
    return True


def test_random_files():
    assert 2 < sum(map(checked, range(10))) < 9


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 1900, 100))
def test_many_random_files(first):
    assert 22 < sum(map(checked, range(first, first + 100))) < 78
