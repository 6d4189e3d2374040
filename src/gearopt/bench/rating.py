"""Ratings by AGMA: a pair at a time against rows with tabulated geometry factors, beside the error.

Published: I and J of AGMA 908-B89 at 20 degrees, spur, load at the highest point of single tooth
contact, as in Norton, Machine Design, table 12-9, which the method itself has to meet.
"""

import math
from typing import Any

from gearopt.bench import timed
from gearopt.physics.agma.bending import thinned
from gearopt.physics.agma.life import bending_curve, pitting_curve
from gearopt.physics.agma.rating import Rating, rate
from gearopt.physics.agma.rating_factors import Operation, Practice, Steel
from gearopt.physics.agma.refusals import geometry_factors
from gearopt.physics.agma.table import Duty, FactorTable, factor_table, rate_rows
from gearopt.physics.gears import GearPair, Rack

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
    relative, the largest of all safety factors of 30 pairs.
    """
    rows = _published(repeat)
    for case, helix in HELIX.items():
        rows += _speeds(case, helix, repeat)
    return rows


def _published(repeat: int) -> list[dict[str, Any]]:
    """Return the largest errors of I and of J against the published tables."""
    import numpy as np

    z1, z2, *values = np.array(PUBLISHED).T
    pair = thinned(GearPair.of_teeth(1.0, z1, z2, 1.0, rack=TOOL), THINNING)
    found, times = timed(lambda: geometry_factors(pair), repeat)
    made = found.pitting, *found.bending
    errors = [float(np.abs(a - b).max()) for a, b in zip(made, values, strict=True)]
    count = len(PUBLISHED)
    return [
        _row("I of AGMA 908", "arrays", times, count, errors[0]),
        _row("J of AGMA 908", "arrays", times, count, max(errors[1:])),
    ]


def _speeds(case: str, helix: float, repeat: int) -> list[dict[str, Any]]:
    """Return the table, a million rows of it, and pairs one at a time."""
    import numpy as np

    table, making = timed(lambda: factor_table(*TEETH, helix), repeat)
    rng = np.random.default_rng(0)
    row, column = (rng.integers(0, len(z), ROWS) for z in (table.pinions, table.wheels))
    module = rng.uniform(1.0, 6.0, ROWS)
    width = module * rng.uniform(6.0, 20.0, ROWS)
    places = row, column, module, width
    pairs = [_pair(table, helix, [float(v[k]) for v in places]) for k in range(CHECKED)]
    single, slow = timed(
        lambda: [rate(p, OPERATION, (STEEL,) * 2, PRACTICE) for p in pairs], repeat
    )
    duty = duty_of(single[0])
    found, fast = timed(lambda: rate_rows(table, duty, *places), repeat)
    error = max(
        abs(float(ours[k]) / theirs - 1.0)
        for k, one in enumerate(single)
        for ours, theirs in zip(
            (*found.bending, *found.contact),
            (*one.bending_safety, *one.contact_safety),
            strict=True,
        )
    )
    return [
        _row(case, "one at a time", slow, CHECKED, 0.0),
        _row(case, "table of pairs", making, table.contact.size, None),
        _row(case, "rows of the table", fast, ROWS, error),
    ]


def _pair(table: FactorTable, helix: float, place: list[float]) -> GearPair:
    row, column, module, width = place
    teeth = float(table.pinions[int(row)]), float(table.wheels[int(column)])
    return GearPair.of_teeth(module, *teeth, width, helix)


def duty_of(rating: Rating) -> Duty:
    """Return the duty of rows whose factors are those of a rating."""
    value: dict[str, Any] = {symbol: factor.value for symbol, factor in rating.factors.items()}
    return Duty(
        OPERATION.power,
        OPERATION.pinion_speed,
        OPERATION.overload,
        PRACTICE.quality,
        PRACTICE.curve,
        value["C_p"],
        value["s_at"],
        value["s_ac"],
        rating.cycles[0],
        (bending_curve("carburised"),) * 2,
        (pitting_curve("carburised"),) * 2,
        value["K_R"],
    )


def _row(
    case: str, method: str, times: dict[str, float], ratings: int, error: float | None
) -> dict[str, Any]:
    rate_ = 1e3 * ratings / max(times["median_ms"], 1e-3)
    found = {"case": case, "method": method, **times, "ratings": ratings}
    return found | {"ratings_per_second": round(rate_), "error": error}
