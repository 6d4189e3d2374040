"""The cutter of a strain wave gearing: ways to its edge, and edges that replace it.

An 80:1 gearing of module 0.5 mm, its rack and a pinion-type cutter of 40 teeth. The edge: by the
envelope in closed form, and as the paper draws it, by the blank's flank at many rolls.
"""

import math
from functools import partial
from typing import Any

from gearopt.bench import timed
from gearopt.formulations.strain_wave.cutter_fit import arc_edge, arc_of_cones, straight_edge
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import (
    Profile,
    blank_profile,
    envelope,
    generated,
    superposition,
)
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.vectors import Vector

GEARING = StrainWave(0.5, 160, profile_shift=0.9)
PITCH, CUTTER = 40.0, 10.0  # mm: pitch radii of the blank and of a cutter of 40 teeth
CUTTERS = {"rack": math.inf, "40 teeth": CUTTER}
ROLLS = (-0.18, 0.03)  # rad round the cutter: the blank touches within these
SHORT = (-0.1, 0.03)  # ends too early
PITCHES = (21, 81, 321)
EVERY = 8  # of 401 points, for edges that replace the exact one
LEAST_RADII = {"rack": 500.0, "40 teeth": 3.0}  # mm: radii that a tool may have at least


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: cutter, edge, steps, radius [mm], error [um] against the exact edge, ms.

    steps: rolls, or how often a program was solved. Of the envelope the error is that of the flank
    which it generates again.
    """
    blank = blank_profile(flank(GEARING, 401))
    return [*_exact(blank, repeat), *_rolled(blank, repeat), *_replaced(blank, repeat)]


def _exact(blank: Profile, repeat: int) -> list[dict[str, Any]]:
    rows = []
    for name, radius in CUTTERS.items():
        enveloped, times = timed(partial(envelope, blank, PITCH, radius), repeat)
        back = (generated(enveloped.profile, PITCH, radius) - blank.points).length
        rows.append(_row(name, "envelope", 0, 0.0, float(back.max()), times))
    return rows


def _rolled(blank: Profile, repeat: int) -> list[dict[str, Any]]:
    import numpy as np

    edge = -envelope(blank, PITCH, CUTTER).profile.points[50:350:10]
    rows = []
    cases = [("superposed rolls", ROLLS, steps, False) for steps in PITCHES]
    cases.append(("superposed rolls, ended early", SHORT, PITCHES[-1], False))
    cases.append(("superposed rolls, as printed", ROLLS, PITCHES[-1], True))
    for name, ends, steps, printed in cases:
        rolls = np.linspace(*ends, steps)
        given = blank, (PITCH, CUTTER), rolls, edge.length, printed
        angle, times = timed(partial(superposition, *given), repeat)
        error = float(np.nanmax(np.abs((angle - edge.angle) * edge.length)))
        rows.append(_row("40 teeth", name, steps, 0.0, error, times))
    return rows


def _replaced(blank: Profile, repeat: int) -> list[dict[str, Any]]:
    rows = []
    for name, radius in CUTTERS.items():
        edge: Vector = envelope(blank, PITCH, radius).profile.points[::EVERY]
        line, times = timed(partial(straight_edge, edge), repeat)
        rows.append(_row(name, "straight, linear program", 1, 0.0, line.deviation, times))
        rows.append(_row(name, "straight, least squares", 1, 0.0, line.least_squares, None))
        arc, times = timed(partial(arc_edge, edge), repeat)
        rows.append(
            _row(name, "arc, linear programs", arc.rounds, arc.radius, arc.deviation, times)
        )
        least = LEAST_RADII[name]
        bounded = f"arc, cones, at least {least:g} mm"
        for words, bound in (("arc, cones", 0.0), (bounded, least)):
            cone, times = timed(partial(arc_of_cones, edge, arc, bound), repeat)
            rows.append(_row(name, words, cone.rounds, cone.radius, cone.deviation, times))
    return rows


def _row(
    cutter: str, edge: str, steps: int, radius: float, error: float, times: dict[str, float] | None
) -> dict[str, Any]:
    return {
        "cutter": cutter,
        "edge": edge,
        "steps": steps or "",
        "radius_mm": round(radius, 3) or "",
        "error_um": float(f"{1e3 * error:.3g}"),
        "ms": times["median_ms"] if times else "",
    }
