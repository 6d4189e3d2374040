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


def test_remedies_and_sensitivities_are_those_of_the_torque():
    for name in ("elevator_small_wheels", "elevator_by_agma_small_wheels"):
        by_power, by_torque = (
            {c.key: c.write for r in explain(tables).remedies for c in r.changes}
            for tables in both(name)
        )
        assert "duty.power" in by_power
        assert "duty.power" not in by_torque
        power, torque = by_power["duty.power"], by_torque["duty.torque"]
        assert torque.strip('"').endswith(" N m")
        if name == "elevator_by_agma_small_wheels":  # sharp as time allows
            continue
        watts = 1e3 * float(power.strip('"').split()[0])
        newton_metres = float(torque.strip('"').split()[0])
        assert newton_metres * 2.0 * math.pi * 1450.0 / 60.0 == pytest.approx(watts, rel=1e-5)
    slopes = {i.key: i.sensitivity for i in explain(both("elevator")[1]).influences}
    assert slopes["duty.torque"] == pytest.approx(
        1.0, abs=1e-3
    )  # stress law: volume goes as torque


def test_one_of_power_and_torque_is_needed():
    by_power, by_torque = both("elevator")
    duty = {**by_power["duty"], **by_torque["duty"]}
    with pytest.raises(SceneError, match=r"duty\.torque.*conflicts with power"):
        solve({**by_power, "duty": duty})
    del duty["power"], duty["torque"]
    with pytest.raises(SceneError, match=r"duty\.power.*is missing \(or give torque\)"):
        solve({**by_power, "duty": duty})
