"""Relief of a spur pair: proven search, annealing, local method and any shape, value beside bound.

The pair of a published study, z 25/50, m = 3 mm, 200 Nm, on its grid of 48 positions, uncoupled and
with a compliance c12 between neighbours, at one to three loads. Published: the best of simulated
annealing and of a local method, of linear and of parabolic relief; of any shape the best of some
symmetric patterns of contact. Seeds spend what the published runs did: 2500 evaluations, or two or
three starts of the local method.
"""

import statistics
from functools import partial
from typing import Any

from gearopt.bench import timed
from gearopt.formulations.pair.relief.free_form import free_problem
from gearopt.formulations.pair.relief.meshing import Mesh
from gearopt.formulations.pair.relief.parametric import Ranges, problem
from gearopt.optimise.result import Budget, Result
from gearopt.optimise.solve import solve
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.mesh_cycle import cycle
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.ladder import LEVELS

PATH_STEPS = 48
BORES = (30.0, 50.0)  # mm
TORQUE = 200e3  # N mm, on the pinion
COUPLING = 4.4491e-3 / 5675.6148  # mm/N, of plane finite elements
LOADS = ((1.0,), (0.6, 1.0), (0.5, 1.0, 1.25))
PUBLISHED: dict[tuple[str, int], tuple[float, float, float | None]] = {
    # model, number of loads: um of linear, of parabolic relief, of any shape
    ("uncoupled", 1): (0.4753, 1.4943, None),
    ("uncoupled", 2): (1.6796, 2.1011, 1.5064),
    ("uncoupled", 3): (2.9010, 3.0319, 2.7564),
    ("c12", 1): (0.4564, 1.0059, None),
    ("c12", 2): (1.2373, 1.3494, 1.0615),
    ("c12", 3): (2.0326, 2.0677, 1.9223),
}
SHAPES = {"linear": 1.0, "parabolic": 2.0}
SAMPLED = {"annealing": Budget(evaluations=2500), "mpec": Budget(evaluations=1000)}


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, method, runs, ms, um (median and worst of all seeds), bound, published."""
    rows = []
    for (model, count), known in PUBLISHED.items():
        meshed = mesh(LOADS[count - 1], model, exact=False)
        for (shape, exponent), published in zip(SHAPES.items(), known[:2], strict=True):
            case = model, count, shape
            posed = problem(meshed, Ranges.of(meshed, exponent))
            exact, times = timed(partial(solve, posed, "exact"), 1)
            rows.append(_row(case, "exact", [exact], times["median_ms"], exact.bound, published))
            for method, budget in SAMPLED.items():
                results = [solve(posed, method, budget, seed) for seed in range(repeat)]
                spent = statistics.median(1e3 * r.seconds for r in results)
                rows.append(_row(case, method, results, spent, exact.bound, published))
            both = mesh(LOADS[count - 1], model, exact=True)
            ends = solve(problem(both, Ranges.of(both, exponent)), "exact")
            word = "exact, break points"
            rows.append(_row(case, word, [ends], 1e3 * ends.seconds, ends.bound, None))
        free = solve(free_problem(meshed), "exact")
        case = model, count, "any shape"
        rows.append(_row(case, "exact", [free], 1e3 * free.seconds, free.bound, known[2]))
    return rows


def mesh(parts: tuple[float, ...], model: str, exact: bool) -> Mesh:
    """Return the published pair in mesh at parts of its load."""
    pair = GearPair.of_teeth(3.0, 25, 50, 30.0, 0.0, Rack(tip_radius=0.38))
    load = TORQUE / (0.5 * float(pair.pinion.base_diameter))
    elastic = ElasticPair(pair, BORES)
    level = LEVELS["profile + Sainsot"]
    return Mesh.of(
        cycle(elastic.path, PATH_STEPS, exact),
        lambda s: level.compliance(elastic, s, load),
        COUPLING if model == "c12" else 0.0,
        tuple(part * load for part in parts),
    )


def _row(
    case: tuple[str, int, str],
    method: str,
    found: list[Result],
    spent: float,
    bound: float | None,
    published: float | None,
) -> dict[str, Any]:
    values = [1e3 * r.value for r in found if r.value is not None]
    middle = statistics.median(values)
    return {
        "case": case[0],
        "loads": case[1],
        "relief": case[2],
        "method": method,
        "runs": len(found),
        "median_ms": round(spent, 1),
        "um": round(middle, 5),
        "worst_um": round(max(values), 5),
        "bound_um": None if bound is None else round(1e3 * bound, 5),
        "published_um": published,
    }
