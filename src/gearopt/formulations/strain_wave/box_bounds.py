"""Bounds over the ranges of a design: what proves that no gearing in them meets a limit."""

import math
from collections.abc import Mapping
from typing import Any

from gearopt.formulations.strain_wave.demand import OUTSIDE_BASE, TIP_GAP, Demand
from gearopt.optimise.result import FEASIBLE

RISE = (
    1.4  # of the deflection: slope of the neutral curve within 0.3 rad of the major axis, at most
)
Ends = Mapping[str, float]


def proof(demand: Demand) -> dict[str, Any] | None:
    """Return the proof that no gearing in the ranges meets some limit; None where none is known.

    By lower bounds of utilisations over the whole box: Lemma 72.
    """
    over = {names: used for names, used in least_used(demand).items() if used > 1.0 + FEASIBLE}
    if not over:
        return None
    names = min(over, key=lambda n: (len(n), -over[n]))
    words = f"{names[0].replace('_', ' ')} of at least {100.0 * over[names]:.4g} % of its limit"
    held = f" that keeps the {names[1].replace('_', ' ')}" if len(names) > 1 else ""
    sentence = f"Proof: every gearing in the ranges{held} has a {words}, by bounds over the ranges."
    return {"method": "bounds", "conflict": list(names), "sentence": sentence}


def least_used(demand: Demand) -> dict[tuple[str, ...], float]:
    """Return lower bounds of the utilisation of limits over the ranges, where the others are met.

    By limits in the conflict, the used one first: those that are monotone in every number at their
    best corner; fatigue of the rim and ratcheting with the largest root radius that the ranges, or
    outer radius and ranges, allow.
    """
    low, high = ({n: ends[k] for n, ends in demand.ranges.items()} for k in (0, 1))
    teeth, clear = 0.5 * (demand.teeth + 2.0), demand.clearance
    root = low["module"] * (teeth + low["profile_shift"] + low["addendum"] + clear)
    base = teeth * math.cos(high["pressure_angle"])
    largest = high["module"] * (teeth + high["profile_shift"] + high["addendum"] + clear)
    inside = min(largest, demand.outer_radius - demand.shell)
    return {
        ("outer_radius",): (root + demand.shell) / demand.outer_radius,
        ("minor_axis",): (TIP_GAP + 2.0 * low["addendum"]) / (2.0 * high["deflection"]),
        ("base_circle",): OUTSIDE_BASE * base / (teeth + high["profile_shift"] - low["addendum"]),
        ("rim_fatigue",): _fatigue(demand, low, high, largest),
        ("rim_fatigue", "outer_radius"): _fatigue(demand, low, high, inside),
        ("ratcheting",): _ratcheting(demand, low, high, largest),
        ("ratcheting", "outer_radius"): _ratcheting(demand, low, high, inside),
    }


def _fatigue(demand: Demand, low: Ends, high: Ends, root: float) -> float:
    """Return the least use of the rim's fatigue strength by shear alone, inside a root radius."""
    teeth = 2.0 * low["addendum"] + low["deflection"] + 2.0 * demand.clearance
    radius = root - low["module"] * teeth - 0.5 * low["rim"]
    if radius <= 0.0:
        return math.inf
    wall = demand.duty.cup.wall * high["rim"]
    shear = demand.notch * demand.duty.torque / (2.0 * math.pi * radius**2 * wall)
    return demand.safety * shear / demand.shear_limit


def _ratcheting(demand: Demand, low: Ends, high: Ends, root: float) -> float:
    """Return the least use of the torque at which teeth ratchet, inside a root radius [mm].

    By the least angle between flank and axis of the tooth at its tip. 0 where that is not positive.
    """
    half, clear = 0.5 * (demand.teeth + 2.0), demand.clearance
    above = low["profile_shift"] + low["addendum"]
    least = low["module"] * (half + low["profile_shift"] - high["addendum"] - clear)
    neutral = least - low["module"] * high["deflection"] - 0.5 * high["rim"]
    if neutral <= 0.0:
        return 0.0
    inner = math.cos(low["pressure_angle"]) * half / (half + above)  # r_b/r_w
    pressure = math.acos(min(inner, 1.0))
    lean = RISE * high["deflection"] * low["module"] / neutral
    angle = pressure - math.pi / demand.teeth - lean
    if angle <= 0.0:
        return 0.0
    module = min(high["module"], root / (half + above + clear))
    beyond = min(ends["module"] * (above + clear) for ends in (low, high))
    base = min(high["module"] * half, root - beyond)  # shifts may be negative
    arm = base * math.cos(low["pressure_angle"])
    most = 4.0 * arm * demand.radial_stiffness * high["addendum"] * module / math.tan(angle)
    return demand.ratchet_factor * demand.duty.torque / most
