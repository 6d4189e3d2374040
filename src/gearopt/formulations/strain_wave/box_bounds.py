"""Bounds over the ranges of a design: what proves that no gearing in them meets a limit."""

import math
from typing import Any

from gearopt.formulations.strain_wave.demand import OUTSIDE_BASE, ROOM, Demand
from gearopt.optimise.result import FEASIBLE


def proof(demand: Demand) -> dict[str, Any] | None:
    """Return the proof that no gearing in the ranges meets some limit; None where none is known.

    By lower bounds of utilisations over the whole box: Lemma 72.
    """
    over = {names: used for names, used in least_used(demand).items() if used > 1.0 + FEASIBLE}
    if not over:
        return None
    names = min(over, key=lambda n: (len(n), -over[n]))
    words = f"{names[0].replace('_', ' ')} is used to {100.0 * over[names]:.4g} % at least"
    held = f", {names[1].replace('_', ' ')} kept" if len(names) > 1 else ""
    sentence = f"Proof: {words} by every gearing in the ranges{held}; at a corner of the ranges."
    return {"method": "bounds", "conflict": list(names), "sentence": sentence}


def least_used(demand: Demand) -> dict[tuple[str, ...], float]:
    """Return lower bounds of the utilisation of limits over the ranges, where the others are met.

    By limits in the conflict, the used one first: those that are monotone in every number at their
    best corner; fatigue of the rim by shear alone, with the largest neutral radius that the
    ranges, or outer radius and ranges, allow.
    """
    low, high = ({n: ends[k] for n, ends in demand.ranges.items()} for k in (0, 1))
    teeth, clear = 0.5 * (demand.teeth + 2.0), demand.clearance
    root = low["module"] * (teeth + low["profile_shift"] + low["addendum"] + clear)
    base = teeth * math.cos(high["pressure_angle"])
    largest = high["module"] * (teeth + high["profile_shift"] + high["addendum"] + clear)
    inside = low["module"] * (2.0 * low["addendum"] + low["deflection"] + 2.0 * clear)

    def fatigue(root: float) -> float:
        radius, wall = root - inside - 0.5 * low["rim"], demand.duty.cup.wall * high["rim"]
        if radius <= 0.0:
            return math.inf
        shear = demand.notch * demand.duty.torque / (2.0 * math.pi * radius**2 * wall)
        return demand.safety * shear / demand.shear_limit

    return {
        ("outer_radius",): (root + demand.shell) / demand.outer_radius,
        ("minor_axis",): (ROOM + 2.0 * low["addendum"]) / (2.0 * high["deflection"]),
        ("base_circle",): OUTSIDE_BASE * base / (teeth + high["profile_shift"] - low["addendum"]),
        ("rim_fatigue",): fatigue(largest),
        ("rim_fatigue", "outer_radius"): fatigue(min(largest, demand.outer_radius - demand.shell)),
    }
