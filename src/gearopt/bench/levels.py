"""Models of teeth in mesh: transmission error and best relief of each beside finite elements.

Random pairs of steel gears, those of the bench `stiffness`, every level with the couplings of
neighbours that go with it. The relief is the best linear one for two loads, by the search of kind
"pair" up to twice the amounts of the paper's rule; what is best by a level is judged by finite
elements, too, whose own best it is held against.
"""

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from gearopt.bench.stiffness import random_pairs
from gearopt.formulations.pair.contact import PairMesh
from gearopt.formulations.pair.relief.meshing import NO_RELIEF, Relief
from gearopt.formulations.pair.relief.parametric import Ranges, at_point, problem
from gearopt.formulations.pair.relief.rules import tip_amounts
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.physics.tooth import finite_elements
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.ladder import COUPLINGS, LEVELS
from gearopt.physics.tooth.validity import EXACT, unsupported

PAIRS, STEPS = 30, 48  # positions over a base pitch
LOADS = (0.6, 1.0)  # the peak to peak without relief is that at the second one
GAP = 0.02  # of the search for a relief
MEASURES = ("peak_to_peak", "amount", "proven", "judged", "penalty")


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: level, coupling, pairs; least, median and largest of every measure.

    peak_to_peak: without relief; amount: the sum at both tips; proven: what the best relief is said
    to leave; all over those by finite elements. judged: what is proven over what finite elements
    say of the same flanks, penalty: what they say over their least. All less 1.
    """
    return ranges([row for k in range(PAIRS) for row in of_pair(k)])


def ranges(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the least, median and largest of every measure by level and coupling."""
    import numpy as np

    together: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for row in rows:
        together.setdefault((row["level"], row["coupling"]), []).append(row)
    return [
        {"level": level, "coupling": coupling, "pairs": len(some)}
        | {
            f"{word}_{name}": round(float(of([row[name] for row in some])), 3)
            for name in MEASURES
            for word, of in (("least", np.min), ("median", np.median), ("largest", np.max))
        }
        for (level, coupling), some in together.items()
    ]


@cache
def _pairs() -> list[tuple[ElasticPair, float]]:
    return random_pairs()[:PAIRS]


def of_pair(number: int) -> Iterator[dict[str, Any]]:
    """Yield a row for every level that supports a pair, with every coupling."""
    elastic, force = _pairs()[number]
    torque = force * elastic.members[0].base_radius
    couplings = {name: model(elastic) for name, model in COUPLINGS.items()}

    def mesh(level: str, coupling: str) -> PairMesh:
        return PairMesh.of(elastic, level, torque, couplings[coupling], STEPS, LOADS)

    finest = mesh(EXACT, EXACT)
    exact, (right, best, least) = finest.mesh, _answers(finest)
    for level in LEVELS:
        for coupling in () if unsupported(elastic, level) else couplings_of(level):
            plain, both, proven = _answers(mesh(level, coupling))
            judged = float(exact.criteria(exact.separations(*both)).peak_to_peak.max())
            ratios = plain / right, _amount(both) / _amount(best), proven / least
            errors = (*ratios, proven / judged, judged / least)
            named = {"pair": number, "level": level, "coupling": coupling}
            yield named | {k: round(v - 1.0, 5) for k, v in zip(MEASURES, errors, strict=True)}
    finite_elements.body.cache_clear()


def couplings_of(level: str) -> tuple[str, ...]:
    """Return the couplings that go with a level: half planes have no ring that turns."""
    if level == EXACT:
        return ("ring torsion",)  # with their own they are what the others are held against
    alone = LEVELS[level].body == "half plane"
    return ("none",) if alone else ("none", "ring torsion", EXACT)


def _answers(made: PairMesh) -> tuple[float, tuple[Relief, Relief], float]:
    """Return the peak to peak [mm] without relief, the best relief, and what it leaves [mm]."""
    import numpy as np

    mesh = made.mesh
    printed = tip_amounts(mesh.cycle.path, made.compliance, 0.0, made.force)
    ranges = Ranges.of(mesh, most=2.0 * max(printed))
    plain = mesh.criteria(mesh.separations(NO_RELIEF, NO_RELIEF)).peak_to_peak[-1]
    result = solve(problem(mesh, ranges), "exact", Budget(gap=GAP))
    assert result.value is not None
    point = np.array([*result.design["amount_mm"], *result.design["length_mm"]])
    return float(plain), at_point(point, ranges), result.value


def _amount(both: tuple[Relief, Relief]) -> float:
    return sum(float(relief.amount) for relief in both)
