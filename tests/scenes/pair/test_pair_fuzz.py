"""Random files of spur pairs: a design whose shares add up, or a refusal in one line."""

import random

import numpy as np
import pytest

import gearopt
from gearopt.errors import SceneError, SolveError

LEVELS = ("profile + Sainsot", "trapezoid + Sainsot", "ISO 6336", "Nakada A")
BUDGET = gearopt.Budget(seconds=2.0, evaluations=2000)


def random_file(rng):
    """Of any size, shifts, tools, bores, duty; every fourth asks for a relief."""
    z1, m = rng.randint(5, 60), rng.choice([0.5, 1, 2, 3, 5, 10])
    z2 = rng.randint(z1, 150)
    stage = {"module": f"{m} mm", "pinion_teeth": z1, "wheel_teeth": z2}
    stage["face_width"] = f"{m * rng.uniform(0.5, 20.0):.4g} mm"
    for member, z in (("pinion", z1), ("wheel", z2)):
        stage[member] = {"profile_shift": round(rng.uniform(-0.5, 0.8), 3)}
        if rng.random() < 0.5:
            stage[member]["bore"] = f"{m * z * rng.uniform(0.05, 0.7):.4g} mm"
    found = {
        "gearopt": 1,
        "kind": "pair",
        "duty": {
            "power": f"{10.0 ** rng.uniform(-2, 3):.4g} kW",
            "input_speed": f"{10.0 ** rng.uniform(1, 4):.4g} rpm",
        },
        "stage": [stage],
        "gears": {"pressure_angle": f"{rng.choice([14.5, 20, 25])} deg"},
        "sharing": {
            "positions": rng.choice([12, 24, 96]),
            "coupling": rng.choice(["none", "ring torsion", "0.2 um/kN"]),
            "loads": rng.sample([0, 0.5, 1, 1.5], rng.randint(1, 3)),
            "level": rng.choice(LEVELS),
        },
    }
    if rng.random() < 0.3:
        found["gears"] |= {"addendum": round(rng.uniform(0.6, 1.4), 3), "tool_addendum": 1.4}
    if rng.random() < 0.25:
        shape = rng.choice(["linear", "parabolic", 1.5])
        found["relief"] = {"shape": shape, "amount": rng.choice(["10 um", ["0 um", "30 um"]])}
    return found


@pytest.mark.slow
@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(4))
def test_a_random_pair_is_computed_or_refused_in_a_line(seed):
    rng, computed = random.Random(f"pairs {seed}"), 0
    for _ in range(60):
        try:
            result = gearopt.solve(random_file(rng), budget=BUDGET)
        except SolveError as reason:
            assert "\n" not in str(reason)
            continue
        except SceneError as wrong:
            assert wrong.rule and wrong.remedy
            continue
        computed += 1
        contact = result.design["contact"]
        pitch = contact["base_pitch_mm"]
        s = np.array(contact["position_mm"])
        assert (s[-1] - s[0]) / pitch == pytest.approx(contact["contact_ratio"], rel=1e-9)
        for load in contact["loads"]:
            shares = np.array(load["share"])
            assert (shares >= 0.0).all() and shares.max() <= 1.0 + 1e-12
            mean = np.trapezoid(shares, s) / pitch  # of all pairs, over a base pitch
            assert mean == pytest.approx(1.0 if load["load"] else 0.0, rel=0.05, abs=1e-12)
            assert load["transmission_error_mm"][0] >= 0.0
        assert gearopt.Result.from_json(result.to_json()).design == result.design
        assert result.value is None or result.value >= (result.bound or 0.0) * (1 - 1e-9)
    assert computed > 15
