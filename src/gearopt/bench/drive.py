"""Sizing of drives: time to a proven answer, and its error against known optima.

Known: the two drives of Chong and Lee, solved by SCIP and by brute force in the tests; four
and more stages have no published optimum, so their error is the proven gap.
"""

from typing import Any

from gearopt.bench import timed
from gearopt.formulations.drive import continuous_sizing, teeth
from gearopt.formulations.drive.train import Train
from gearopt.optimise.solve import solve
from gearopt.scenes.reading.load import read

HEAD = """
gearopt = 1
kind = "drive"
[gears]
helix_angle = "25 deg"
[limits]
k_factor = "2.07 MPa"
unit_load = "48 MPa"
pinion_teeth = [20, 40]
[teeth]
modules = "ISO 54 I"
"""
CASES: dict[str, tuple[str, list[float], float | None]] = {
    # name: (power and speeds, b/d1 of every stage, known optimum mm3)
    "elevator": ('"7.5 kW", "1450 rpm", "66.5 rpm"', [0.6, 0.75], 5_782_370.7),
    "three_stage": ('"8 kW", "3520 rpm", "32 rpm"', [0.6, 0.6, 0.75], 12_677_057.9),
    "four stages, 300:1": ("300", [0.6] * 3 + [0.75], None),
    "five stages, 1000:1": ("1000", [0.6] * 4 + [0.75], None),
    "six stages, 3000:1": ("3000", [0.6] * 5 + [0.75], None),
}


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, method, ms (median, minimum, maximum), objective, error, gap."""
    rows = []
    for name, (duty, widths, known) in CASES.items():
        train = train_of(duty, widths)
        rows.append(_row(name, "exact", lambda t=train: solve(teeth.problem(t)), known, repeat))
        # The continuous form has another optimum; its error is the certified gap alone.
        rows.append(
            _row(name, "ipopt", lambda t=train: solve(continuous_sizing.problem(t)), None, repeat)
        )
        built = continuous_sizing.problem(train)
        solve(built)
        rows.append(_row(name, "ipopt, again", lambda b=built: solve(b), None, repeat))
    return rows


def train_of(duty: str, widths: list[float]) -> Train:
    """Return the drive of a case."""
    stages = "".join(f"[[stage]]\nface_width_over_diameter = {w}\n" for w in widths)
    if duty[0] == '"':
        power, first, last = duty.split(", ")
        text = f"[duty]\npower = {power}\ninput_speed = {first}\noutput_speed = {last}\n"
    else:
        text = f'[duty]\npower = "8 kW"\ninput_speed = "3520 rpm"\nratio = {duty}\n'
    _, scene = read((HEAD + text + stages).encode())
    train: Train = scene.train()  # type: ignore[attr-defined]
    return train


def _row(name: str, method: str, call: Any, known: float | None, repeat: int) -> dict[str, Any]:
    result, times = timed(call, repeat)
    return {
        "case": name,
        "method": method,
        **times,
        "objective": result.value,
        "status": result.status,
        "gap": result.gap,
        "error": None if known is None or result.value is None else result.value / known - 1.0,
    }
