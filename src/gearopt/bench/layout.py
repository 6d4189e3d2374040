"""Layouts of published trains: time to a proven box beside its error, and annealing beside both.

Known boxes: those of the trains of Chong and Lee, found before by a grid, SLSQP and
another branch and bound; face widths to 0.001 mm, shafts and clearances as assumed there.
"""

import math
import statistics
from typing import Any

from gearopt.formulations.drive import layout
from gearopt.formulations.drive.gearbox import Clearances, Gearbox, Shaft
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run as solved
from gearopt.physics.gears import GearPair

HELIX = math.radians(25.0)
SEEDS = 25
THREE, TWO = (8.0, 15.0, 22.5, 35.0), (10.0, 17.5, 30.0)  # radii of the shafts [mm]
PAPER = ((1.5, 27, 229, 26.8), (3.0, 26, 105, 47.8), (4.0, 27, 87, 95.3))
OTHER = ((1.25, 27, 237, 22.34), (3.0, 26, 109, 51.6), (4.0, 27, 80, 95.3))
BEST = ((1.5, 21, 162, 20.854), (3.0, 21, 89, 41.708), (4.0, 24, 80, 79.443))
CASES: dict[str, tuple[Any, tuple[float, ...], bool, float, float]] = {
    # name: (module, teeth, face width of each stage), shafts, partial, clearances?, box mm3
    "process one": (PAPER, THREE, False, 1.0, 75_516_512.0),
    "process one, no clearances": (PAPER, THREE, False, 0.0, 56_826_192.0),
    "process one, partial span": (PAPER, THREE, True, 1.0, 55_654_946.0),
    "process two": (OTHER, THREE, False, 1.0, 66_689_036.0),
    "process two, partial span": (OTHER, THREE, True, 1.0, 50_183_602.0),
    "least gear volume": (BEST, THREE, False, 1.0, 47_483_118.0),
    "least gear volume, partial span": (BEST, THREE, True, 1.0, 40_113_089.0),
    "elevator, process one": (
        ((2.0, 25, 124, 33.1), (3.0, 25, 109, 62.1)),
        TWO,
        False,
        1.0,
        27_094_106.0,
    ),
    "elevator, least gear volume": (
        ((2.0, 21, 115, 27.805), (3.0, 23, 91, 57.1)),
        TWO,
        False,
        1.0,
        18_406_834.0,
    ),
}


def gearbox(name: str) -> Gearbox:
    """Return the gearbox of a case."""
    train, shafts, partial, room, _ = CASES[name]
    pairs = tuple(GearPair.of_teeth(m, z1, z2, b, HELIX) for m, z1, z2, b in train)
    clearances = Clearances(5.0 * room, 2.0 * room, 10.0 * room, 10.0 * room)
    return Gearbox(pairs, tuple(Shaft(r) for r in shafts), clearances, partial)


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, method, evaluations, ms (median), objective, gap to our bound, error."""
    rows = []
    layout.ready()
    for name in CASES:
        box, known = gearbox(name), CASES[name][-1]
        exact, took = _timed(box, "exact", [0] * (repeat + 1), Budget(seconds=60.0))
        bound = exact[0].bound or 0.0
        rows.append(_row(name, "exact", exact, took, bound, known))
        for steps in (5_000, 20_000, 128_701):
            results, took = _timed(box, "sa", list(range(SEEDS)), Budget(evaluations=steps))
            rows.append(_row(name, f"sa, median of {SEEDS}", results, took, bound, known))
    return rows


def _timed(box: Gearbox, method: str, seeds: list[int], budget: Budget) -> tuple[list[Any], float]:
    """Return results of some seeds and the median time [ms], without the first run."""
    problem, results, times = layout.problem(box, method), [], []
    solved(problem, method, budget, seeds[0])
    for seed in seeds:
        clock = Clock()
        results.append(solved(problem, method, budget, seed)[0])
        times.append(1000.0 * clock.seconds)
    return results, statistics.median(times)


def _row(
    name: str, method: str, results: list[Any], took: float, bound: float, known: float
) -> dict[str, Any]:
    values = [math.inf if r.value is None else r.value for r in results]
    value = statistics.median(values)
    return {
        "case": name,
        "method": method,
        "evaluations": results[0].evaluations,
        "median_ms": round(took, 2),
        "objective": value,
        "gap": 1.0 - bound / value,
        "worst_gap": 1.0 - bound / max(values),
        "error": value / known - 1.0,
    }
