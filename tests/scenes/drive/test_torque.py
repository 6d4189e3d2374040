"""A drive by the torque at its input is the drive by power: P = T ω."""

import math
import tomllib
from pathlib import Path

import pytest

from gearopt import explain, rate, solve
from gearopt.errors import SceneError

PROBLEMS = Path(__file__).parents[3] / "problems"


def both(name):
    """The tables of a file by power [kW at rpm], and the same by torque."""
    tables = tomllib.loads((PROBLEMS / f"{name}.toml").read_text(encoding="utf-8"))
    power, speed = (float(tables["duty"][key].split()[0]) for key in ("power", "input_speed"))
    duty = {key: value for key, value in tables["duty"].items() if key != "power"}
    torque = 1e3 * power / (2.0 * math.pi * speed / 60.0)
    return tables, {**tables, "duty": {**duty, "torque": f"{torque!r} N m"}}


def numbers(value, place=""):
    """Every float of nested tables with its place."""
    if isinstance(value, dict):
        value = value.items()
    elif isinstance(value, list | tuple):
        value = enumerate(value)
    else:
        return {place: value} if isinstance(value, float) else {}
    return {k: v for key, inner in value for k, v in numbers(inner, f"{place}.{key}").items()}


@pytest.mark.parametrize(
    ("name", "answer"), [("elevator", solve), ("catalogue_pair", rate), ("pair_from_duty", solve)]
)
def test_the_answer_is_the_same(name, answer):
    by_power, by_torque = (answer(tables).to_dict()["design"] for tables in both(name))
    first, second = numbers(by_power), numbers(by_torque)
    assert first
    assert first.keys() == second.keys()
    assert second == pytest.approx(first, rel=1e-12, abs=1e-15)


def duty_remedies(tables, key):
    """What explain writes for a number of the duty of an impossible file."""
    changes = [c for r in explain(tables).remedies for c in r.changes]
    assert {c.key for c in changes if c.key in ("duty.power", "duty.torque")} == {key}
    (value,) = (c.write.strip('"') for c in changes if c.key == key)
    return value


@pytest.mark.slow
def test_the_remedy_by_a_stress_law_is_that_of_the_torque():
    by_power, by_torque = both("elevator_small_wheels")
    power, torque = duty_remedies(by_power, "duty.power"), duty_remedies(by_torque, "duty.torque")
    assert power.endswith(" kW")
    assert torque.endswith(" N m")
    watts = float(torque.split()[0]) * 2.0 * math.pi * 1450.0 / 60.0
    assert watts == pytest.approx(1e3 * float(power.split()[0]), rel=1e-5)


@pytest.mark.slow
def test_the_remedy_by_ratings_is_the_largest_torque_that_is_possible():
    tables = both("elevator_by_agma_small_wheels")[1]
    value = duty_remedies(tables, "duty.torque")
    assert value.endswith(" N m")
    for factor, status in ((1.0, "optimal"), (1.01, "infeasible")):
        duty = {**tables["duty"], "torque": f"{factor * float(value.split()[0])!r} N m"}
        assert solve({**tables, "duty": duty}, remedies=False).status == status


@pytest.mark.slow
def test_the_volume_goes_as_the_torque_by_a_stress_law():
    slopes = {i.key: i.sensitivity for i in explain(both("elevator")[1]).influences}
    assert slopes["duty.torque"] == pytest.approx(1.0, abs=1e-3)


def test_one_of_power_and_torque_is_needed():
    by_power, by_torque = both("elevator")
    duty = {**by_power["duty"], **by_torque["duty"]}
    with pytest.raises(SceneError, match=r"duty\.torque.*conflicts with power"):
        solve({**by_power, "duty": duty})
    del duty["power"], duty["torque"]
    with pytest.raises(SceneError, match=r"duty\.power.*is missing \(or give torque\)"):
        solve({**by_power, "duty": duty})
