"""The two-stage servo drive of Youn: tolerances of its Tables 2 and 3 on the wheels of Table 4."""

import math

import numpy as np

from gearopt.formulations.servo.tolerance.stack import (
    RUN_OUT,
    UNIFORM,
    Component,
    ErrorBudget,
    Stack,
)

TERMS = {  # baseline tolerances [um], stages 12 and 34; the zero ones are left out
    "pinion reading": (18.0, 20.0),
    "wheel reading": (24.0, 27.0),
    "centre distance": (4.2, 5.4),
    "pinion bearing clearance": (0.0, 2.5),
    "wheel bearing clearance": (2.5, 3.0),
    "pinion bearing run-out": (0.0, 3.0),
    "wheel bearing run-out": (2.5, 4.0),
    "pitch": (29.0, 33.0),
}
WHEELS = ((48.0, 8.0), (104.0, 1.0))  # diameter [mm], ratio downstream
PRESSURE_ANGLE = math.radians(20.0)
E_WC, E_RSS = 0.10819163246984825, 0.04703039201954477  # deg, of the baseline tolerances


def components(k=1.0, least=0.0, most=math.inf):
    """Each baseline tolerance costs 1; k: an exponent, or one a component, taken in turn."""
    exponents = np.atleast_1d(np.asarray(k, float))
    found = []
    for stage, (diameter, ratio) in enumerate(WHEELS):
        for name, widths in TERMS.items():
            t = widths[stage] * 1e-3
            if t == 0.0:
                continue
            per_mm = 2.0 if name == "pitch" else 4.0 * math.tan(PRESSURE_ANGLE)
            s = math.degrees(per_mm / (diameter * ratio))
            own = float(exponents[len(found) % len(exponents)])
            law = RUN_OUT if "run-out" in name else UNIFORM
            label = f"{('12', '34')[stage]} {name}"
            found.append(Component(label, s, t**own, own, least * t, most * t, law))
    return tuple(found)


BASE = np.array([c.cost for c in components()])  # mm
S = np.array([c.sensitivity for c in components()])  # deg/mm


def stack(*budgets, **given):
    """The drive under budgets (rule, error) with `components(**given)`."""
    return Stack(components(**given), tuple(ErrorBudget(*budget) for budget in budgets))
