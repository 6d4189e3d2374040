"""What is told of a pair on moving axes beside its answer: digits, sensitivities, time spent."""

import time
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt.scenes.dynamics import KIND
from gearopt.scenes.dynamics.steps import resolvable

EXAMPLE = KIND.example.text

PROBLEMS = Path(__file__).parents[3] / "problems"
BARE = EXAMPLE[: EXAMPLE.index("[simulate]")]


def test_a_motion_is_told_to_the_digits_that_were_asked(tmp_path):
    path, told = tmp_path / "motion.toml", []
    for error in (1e-10, 1e-12):
        path.write_text(BARE + f'[simulate]\nduration = "2 ms"\noutputs = 101\nerror = {error}\n')
        told.append(np.array(gearopt.solve(path).design["response"]["deformation_mm"]))
    apart = np.max(np.abs(told[1] - told[0]))
    assert 0.0 < apart <= 1.1e-10 * np.max(np.abs(told[1]))


@pytest.mark.slow
def test_a_proof_tells_the_time_that_its_remedies_took(tmp_path, monkeypatch):
    """Else what is left of a budget is spent again, on files that are solved in full."""
    module = import_module("gearopt.scenes.dynamics.steps")
    alone = module.each_alone

    def slow(*given):
        time.sleep(0.3)
        return alone(*given)

    monkeypatch.setattr(module, "each_alone", slow)
    path = tmp_path / "light.toml"
    text = (PROBLEMS / "least_vibration.toml").read_text()
    path.write_text(text.replace('mass = "2 kg"', 'mass = "0.5 kg"'))
    result = gearopt.solve(path, budget=gearopt.Budget(seconds=0.2))
    assert result.status == "infeasible" and result.seconds >= 0.3


@pytest.mark.slow
def test_numbers_are_solved_again_from_the_answer(tmp_path):
    """Deformations of a linear mesh are proportional to the torque."""
    path = tmp_path / "two_speeds.toml"
    text = (PROBLEMS / "least_vibration.toml").read_text()
    text = text.replace("points = 16", "points = 2").replace("harmonics = 10", "harmonics = 2")
    path.write_text(text)
    result = gearopt.solve(path, prices=True)
    assert result.status == "stationary"
    found = {one["key"]: one for one in result.report["prices"]["influences"]}
    torque = found["pinion.torque"]
    assert torque["sensitivity"] == pytest.approx(1.0, abs=1e-4)
    assert torque["resolved"] == pytest.approx([1.0, 1.0], abs=1e-3)
    assert "Sensitivities" in result.to_html() and len(found) > 20


def test_motions_that_are_simulated_are_not_solved_again():
    """Nor is a limit of the multiplier, which is no text of the problem."""
    held = gearopt.load(PROBLEMS / "least_vibration.toml")
    limited = gearopt.load(PROBLEMS / "least_vibration.toml", {"optimise.multiplier": 0.98})
    parting = gearopt.load(PROBLEMS / "least_vibration_parting.toml")
    found = gearopt.Result("dynamics", "stationary", "screened", {})
    assert resolvable(held, found)
    assert not resolvable(limited, found) and not resolvable(parting, found)
