"""Stiffness of tooth pairs: every model against finite elements, with its time and set-up.

Two pairs of steel gears under plane stress and plane strain, then random pairs, at five positions:
0.05 m_n inside A, at B, C and D, and 0.05 m_n inside E. Nobody has measured the pairs: errors are
counted from finite elements, of the two pairs with their size halved once more.
"""

from dataclasses import replace
from typing import Any

from gearopt.bench import timed
from gearopt.frozen import dataclass
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.flaws import flaws
from gearopt.physics.tooth import finite_elements
from gearopt.physics.tooth.elastic import PLANES, ElasticPair
from gearopt.physics.tooth.ladder import LEVELS, Level, tabulated
from gearopt.physics.tooth.trapezoid import trapezoid
from gearopt.physics.tooth.validity import unsupported, usual_plane

TIMED = 256  # positions of the analytic models, 5 of finite elements
RANDOM, HALVED = 32, 4  # pairs; of these the first ones with elements of half the size, too


@dataclass(frozen=True)
class Sample:
    """A pair, its bores [mm] and the torque of its pinion [N mm]."""

    name: str
    pair: GearPair
    bores: tuple[float, float]
    torque: float


def samples() -> tuple[Sample, ...]:
    """Return the pairs on which the models are measured."""
    first = GearPair.of_teeth(3.0, 25, 50, 30.0)
    second = GearPair.of_teeth(4.0, 18, 40, 40.0, profile_shifts=(0.3, -0.1))
    return (
        Sample("25/50 teeth", first, (30.0, 50.0), 200e3),
        Sample("18/40 teeth, x +0.3/-0.1", second, (36.0, 80.0), 600e3),
    )


def five_points(elastic: ElasticPair) -> tuple[float, ...]:
    """Return positions s [mm]: 0.05 m_n inside A, B, C, D, 0.05 m_n inside E."""
    path, inside = elastic.path, 0.05 * elastic.pair.normal_module
    return path.start + inside, path.lowest_single, 0.0, path.highest_single, path.end - inside


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, method, ms, us a position, ms of set-up, least and largest error.

    errors: of the stiffness, relative; of finite elements what halving them changes. set-up: what
    is kept for further positions, tables and factors. Random pairs are not timed; a level is asked
    for those that it supports (`tooth.validity.unsupported`).
    """
    rows = []
    for sample in samples():
        for plane in PLANES:
            elastic = ElasticPair(sample.pair, sample.bores, plane=plane)
            rows += _levels(sample, elastic, repeat)
    return rows + _random()


def _levels(sample: Sample, elastic: ElasticPair, repeat: int) -> list[dict[str, Any]]:
    """Return the rows of one pair in one plane."""
    force = sample.torque / elastic.members[0].base_radius
    fine = finite_elements.pair_compliance(elastic, five_points(elastic), force, halvings=1)
    finite_elements.body.cache_clear()
    case = f"{sample.name}, plane {elastic.plane}"
    return [
        {"case": case, "method": name} | _row(level, elastic, force, fine, repeat)
        for name, level in LEVELS.items()
    ]


def _row(
    level: Level, elastic: ElasticPair, force: float, fine: Any, repeat: int
) -> dict[str, Any]:
    """Return times and errors of one level; fine: the compliances that it should have."""
    import numpy as np

    points, path = five_points(elastic), elastic.path
    many = points if level.tooth == "elements" else np.linspace(path.start, path.end, TIMED)
    computed, first = timed(lambda: _fresh(level, elastic, points, force), min(repeat, 3))
    _, times = timed(lambda: level.compliance(elastic, many, force), repeat)
    error, each = fine / computed - 1.0, times["median_ms"] / len(many)
    return times | {
        "us_per_position": round(1e3 * each, 3),
        "setup_ms": round(max(first["median_ms"] - each * len(points), 0.0), 2),
        "least_error": round(float(error.min()), 5),
        "largest_error": round(float(error.max()), 5),
    }


def _fresh(level: Level, elastic: ElasticPair, points: Any, force: float) -> Any:
    """Return compliances with nothing kept from before."""
    for table in (tabulated, trapezoid, finite_elements.body):
        table.cache_clear()
    return level.compliance(replace(elastic), points, force)


def random_pairs() -> list[tuple[ElasticPair, float]]:
    """Return `RANDOM` pairs without a flaw, of module 3 mm, with loads [N] of a pair of teeth.

    17 to 60 and 17 to 150 teeth, shifts 0 to 0.6 and -0.2 to 0.4, tip radii of the tool 0.2 to
    0.38 m_n, face widths of 4 to 15 m_n, root over bore 1.4 to 5; the plane that suits the width.
    """
    import numpy as np

    rng = np.random.default_rng(0)
    pairs: list[tuple[ElasticPair, float]] = []
    while len(pairs) < RANDOM:
        rack = Rack(tip_radius=rng.uniform(0.2, 0.38))
        teeth = float(rng.integers(17, 61)), float(rng.integers(17, 151))
        shifts = rng.uniform(0.0, 0.6), rng.uniform(-0.2, 0.4)
        width, load = rng.uniform(12.0, 45.0), rng.uniform(30.0, 180.0)
        ratios = rng.uniform(1.4, 5.0, 2)
        pair = GearPair.of_teeth(3.0, *teeth, width, rack=rack, profile_shifts=shifts)
        if not flaws(pair):
            first, second = (
                float(g.root_diameter / h) for g, h in zip(pair.gears, ratios, strict=True)
            )
            pairs.append(
                (ElasticPair(pair, (first, second), plane=usual_plane(pair)), load * width)
            )
    return pairs


def _random() -> list[dict[str, Any]]:
    """Return the errors of the levels over random pairs, without times."""
    errors: dict[str, list[Any]] = {name: [] for name in LEVELS}
    for k, (elastic, force) in enumerate(random_pairs()):
        points = five_points(elastic)
        fine = finite_elements.pair_compliance(elastic, points, force)
        if k < HALVED:
            halved = finite_elements.pair_compliance(elastic, points, force, halvings=1)
            errors["finite elements"] += list(halved / fine - 1.0)
        finite_elements.body.cache_clear()
        for name, level in LEVELS.items():
            if level.tooth != "elements" and not unsupported(elastic, name):
                errors[name] += list(fine / level.compliance(elastic, points, force) - 1.0)
    untimed = dict.fromkeys(("median_ms", "least_ms", "most_ms", "us_per_position", "setup_ms"))
    return [
        {"case": f"{RANDOM} random pairs", "method": name}
        | untimed
        | {"least_error": round(float(min(found)), 5), "largest_error": round(float(max(found)), 5)}
        for name, found in errors.items()
    ]
