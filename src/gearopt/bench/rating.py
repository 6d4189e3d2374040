"""Ratings by AGMA and by ISO 6336: a pair at a time against rows of them, beside the error.

Published: I and J of AGMA 908-B89 at 20 degrees, spur, load at the highest point of single tooth
contact, as in Norton, Machine Design, table 12-9, which the method itself has to meet.
"""

import math
from dataclasses import replace
from typing import Any

from gearopt.bench import timed
from gearopt.physics.agma.batch import safeties
from gearopt.physics.agma.bending import thinned
from gearopt.physics.agma.rating import rate
from gearopt.physics.agma.rating_factors import Case, Practice, Steel
from gearopt.physics.agma.refusals import geometry_factors
from gearopt.physics.agma.table import factor_table
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.iso6336 import batch as iso_batch
from gearopt.physics.iso6336 import case as iso
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.rating import rate as iso_rate
from gearopt.physics.rating import Operation

TOOL, THINNING = Rack(tip_radius=0.25), 0.024  # behind the tables
# z1, z2, I, J1, J2
PUBLISHED = (
    (21, 21, 0.078, 0.33, 0.33),
    (21, 26, 0.084, 0.33, 0.35),
    (26, 26, 0.079, 0.35, 0.35),
    (21, 35, 0.091, 0.34, 0.37),
    (26, 35, 0.088, 0.36, 0.38),
    (35, 35, 0.080, 0.39, 0.39),
    (21, 55, 0.102, 0.34, 0.40),
    (26, 55, 0.101, 0.37, 0.41),
    (35, 55, 0.095, 0.40, 0.42),
    (55, 55, 0.080, 0.43, 0.43),
    (21, 135, 0.118, 0.35, 0.43),
    (26, 135, 0.121, 0.38, 0.44),
    (35, 135, 0.120, 0.41, 0.45),
    (55, 135, 0.112, 0.45, 0.47),
    (135, 135, 0.080, 0.49, 0.49),
)
OPERATION = Operation(1.5e7, 150.0, 5000.0, overload=1.25)  # 15 kW
STEEL, PRACTICE = Steel("carburised", 1), Practice(quality=8)
HELIX = {"spur": 0.0, "helical, 17 deg": math.radians(17.0)}
TEETH = range(17, 61), range(61, 201)
ROWS, CHECKED = 1_000_000, 30


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, method, ms, ratings, ratings a second, largest error.

    error: of I and J against the published tables, absolute; of rows against pairs one at a time,
    relative, the largest of all safety factors of 30 pairs. ISO 6336: one at a time, of sigma_H and
    S_H against ISO/TR 6336-30, example 1; of rows against pairs one at a time; of the smooth form
    against rows with the steps of ISO 1328-1:1995, the median.
    """
    rows = _published(repeat)
    for case, helix in HELIX.items():
        rows += _speeds(case, helix, repeat)
    return rows + _iso(repeat)


def _published(repeat: int) -> list[dict[str, Any]]:
    """Return the largest errors of I and of J against the published tables."""
    import numpy as np

    z1, z2, *values = np.array(PUBLISHED).T
    pair = thinned(GearPair.of_teeth(1.0, z1, z2, 1.0, rack=TOOL), THINNING)
    factors, times = timed(lambda: geometry_factors(pair), repeat)
    ours = factors.pitting, *factors.bending
    errors = [float(np.abs(a - b).max()) for a, b in zip(ours, values, strict=True)]
    count = len(PUBLISHED)
    return [
        _row("I of AGMA 908", "arrays", times, count, errors[0]),
        _row("J of AGMA 908", "arrays", times, count, max(errors[1:])),
    ]


def _speeds(case: str, helix: float, repeat: int) -> list[dict[str, Any]]:
    """Return the table, a million rows of it, and pairs one at a time."""
    import numpy as np

    teeth = [z.ravel() for z in np.meshgrid(*TEETH, indexing="ij")]
    table, making = timed(lambda: factor_table(_pairs(helix, teeth[0], teeth[1], 1.0, 1.0)), repeat)
    rng = np.random.default_rng(0)
    place = rng.integers(0, len(teeth[0]), ROWS)
    chosen = _pairs(helix, teeth[0][place], teeth[1][place], 1.0, rng.uniform(6.0, 20.0, ROWS))
    steels = (STEEL,) * 2

    def rows() -> Any:
        factors = table.take(place).factors(chosen.face_width)
        return safeties(Case(chosen, OPERATION, steels, PRACTICE), factors[0], factors[1:])

    separate = [
        _pairs(
            helix,
            float(teeth[0][place[k]]),
            float(teeth[1][place[k]]),
            1.0,
            float(chosen.face_width[k]),
        )
        for k in range(CHECKED)
    ]
    single, slow = timed(lambda: [rate(p, OPERATION, steels, PRACTICE) for p in separate], repeat)
    computed, fast = timed(rows, repeat)
    error = max(
        abs(float(ours[k]) / theirs - 1.0)
        for k, made in enumerate(single)
        for ours, theirs in zip(computed, (*made.bending_safety, *made.contact_safety), strict=True)
    )
    return [
        _row(case, "one at a time", slow, CHECKED, 0.0),
        _row(case, "table of pairs", making, len(teeth[0]), None),
        _row(case, "rows of the table", fast, ROWS, error),
    ]


def _pairs(helix: float, pinion: Any, wheel: Any, module: Any, width: Any) -> GearPair:
    return GearPair.of_teeth(module, pinion, wheel, width, helix)


def iso_example() -> iso.Case:
    """Return ISO/TR 6336-30:2017, example 1: inputs as a public program has them.

    x1 = 0.145, of which c' follows to every printed digit; tips as printed, 159.66 and 872.35.
    Source: gfsReboucas/Drivetrain, MATISO_6336.m; a public test of the edition of 2022.
    """
    rack, helix = Rack(dedendum=1.4, tip_radius=0.39), math.radians(15.8)
    pair = GearPair.of_teeth(8.0, 17, 103, 100.0, helix, rack, (0.145, 0.0), 500.0)
    tips = zip(pair.gears, (159.66, 872.35), strict=True)
    first, second = (replace(g, tip_alteration=(d - g.tip_diameter) / 16.0) for g, d in tips)
    steel = Material("Eh", "MQ", flank=6e-3)
    speed = 360.0 * math.pi / 30.0
    practice = iso.Practice(grades=(5.0, 5.0), viscosity=320.0, relief=70e-3)
    operation = Operation(9e6 * speed, speed, 50000.0)
    return iso.Case(GearPair(first, second, 500.0), operation, (steel, steel), practice)


ISO_PRINTED = {"sigma_H": 1301.35343, "S_H1": 1.02853, "S_H2": 1.08696}
ISO_ROWS, ISO_PRACTICE = 100_000, iso.Practice()


def _iso(repeat: int) -> list[dict[str, Any]]:
    """Return ratings by ISO 6336: the published example, rows, the smooth form."""
    import numpy as np

    case = iso_example()
    inputs = case.pair, case.operation, case.materials, case.practice
    rated, slow = timed(lambda: iso_rate(*inputs), repeat)
    ours = rated.contact_stress[0], *rated.contact_safety
    known = ISO_PRINTED.values()
    error = max(abs(a / b - 1.0) for a, b in zip(ours, known, strict=True))
    rng = np.random.default_rng(0)
    steels = (Material("Eh", "MQ"),) * 2
    numbers = rng.integers(17, 61, ISO_ROWS), rng.integers(61, 201, ISO_ROWS)
    module, helix = rng.uniform(1.0, 6.0, ISO_ROWS), HELIX["helical, 17 deg"]
    pair = GearPair.of_teeth(module, *numbers, 12.0 * module, helix)
    ask = pair, OPERATION, steels, ISO_PRACTICE
    rows, fast = timed(lambda: iso_batch.rate_rows(*ask), repeat)
    smooth, smoothed = timed(lambda: iso_batch.smooth_safeties(*ask, "subcritical"), repeat)
    exact = *rows.bending, *rows.contact
    apart = np.abs(np.array(smooth) / np.array(exact) - 1.0)
    return [
        _row("ISO 6336", "one at a time", slow, 1, error),
        _row("ISO 6336", "rows", fast, ISO_ROWS, _apart(exact, numbers, module, helix, steels)),
        _row("ISO 6336", "smooth form", smoothed, ISO_ROWS, float(np.nanmedian(apart))),
    ]


def _apart(exact: Any, numbers: Any, module: Any, helix: float, steels: Any) -> float:
    """Return the largest relative difference between rows and pairs one at a time."""
    worst = 0.0
    for k in range(CHECKED):
        teeth = float(numbers[0][k]), float(numbers[1][k])
        pair = GearPair.of_teeth(float(module[k]), *teeth, float(12.0 * module[k]), helix)
        separate = iso_rate(pair, OPERATION, steels, ISO_PRACTICE)
        known = *separate.bending_safety, *separate.contact_safety
        worst = max(worst, *(abs(float(a[k]) / b - 1.0) for a, b in zip(exact, known, strict=True)))
    return worst


def _row(
    case: str, method: str, times: dict[str, float], ratings: int, error: float | None
) -> dict[str, Any]:
    rate_ = 1e3 * ratings / max(times["median_ms"], 1e-3)
    row = {"case": case, "method": method, **times, "ratings": ratings}
    return row | {"ratings_per_second": round(rate_), "error": error}
