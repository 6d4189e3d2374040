"""Pareto fronts of drives: hypervolume beside time of epsilon steps, exact search and NSGA-II.

Shares are those of the hypervolume of the reference front: 600 points of epsilon constraints (400
of three objectives), or all designs of an exact search; measured from ideal + 1.05 (nadir - ideal).
"""

import math
import statistics
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from gearopt.bench.drive import CASES, train_of
from gearopt.formulations.drive import teeth
from gearopt.optimise.clock import Clock
from gearopt.optimise.comparing.fronts import REFERENCE_POINTS
from gearopt.optimise.pareto.found import Found
from gearopt.optimise.pareto.judged import status
from gearopt.optimise.pareto.measures import hypervolume, reference
from gearopt.optimise.pareto.tradeoff import found
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget
from gearopt.optimise.terms import Array, Terms, Var

VOLUME, LENGTH, LOSS = "gear_volume", "sum_of_centre_distances", "mesh_loss"
LEAST_VOLUME = 5_687_087.85  # mm3, minimum gear volume of the elevator at its exact ratio
MOST = {VOLUME: 1.5 * LEAST_VOLUME}
FRONTS: tuple[tuple[tuple[str, ...], dict[str, float]], ...] = (
    ((VOLUME, LENGTH), {}),
    ((VOLUME, LOSS), MOST),
    ((VOLUME, LENGTH, LOSS), MOST),
)
EVALUATIONS = 6_000, 20_000
WHOLE = (  # case, objectives, largest gear volume [mm3]
    ("elevator", (VOLUME, LENGTH), None),
    ("elevator", (VOLUME, LOSS), 1.5 * 5_782_370.7),
    ("three_stage", (VOLUME, LENGTH), None),
    ("three_stage", (VOLUME, LOSS), 1.5 * 12_677_057.9),
)
SHARE = 0.99  # of its own last hypervolume


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, method, points, shares of the hypervolume (median, worst), ms.

    NSGA-II is run for `repeat` seeds; ms_to_99_percent: until it has SHARE of what it ends with.
    """
    rows: list[dict[str, Any]] = []
    for names, most in FRONTS:
        rows += _real(names, most, repeat)
    for case, names, largest in WHOLE:
        rows += _whole(case, names, largest, repeat)
    return rows


def elevator() -> Problem:
    """Return the elevator drive in real-valued sizes at its exact ratio, which is eliminated.

    Per stage reference diameter d [mm], width b/d from 0.3 on and number of teeth z >= 20; first
    ratio u. Gears by the limits of K-factor 2.07 MPa and unit load 48 MPa, helix angle 25 degrees.
    """
    ratio, torque = 1450.0 / 66.5, 30e6 * 7.5 / (math.pi * 1450.0)
    cosine = math.cos(math.radians(25.0))

    def evaluate(x: Any, p: Any) -> Terms:
        volume, length, loss, contact, bending = 0.0, 0.0, 0.0, [], []
        for k, (u, t) in enumerate(((x.u, torque), (ratio / x.u, torque * x.u))):
            d, b, z = x.d[k], x.w[k] * x.d[k], x.z[k]
            volume = volume + math.pi / 4.0 * d**2 * b * (1.0 + u**2)
            length = length + d * (1.0 + u) / 2.0
            loss = loss + 6.0 * math.pi * (1.0 + 1.0 / u) / z
            contact.append(2.0 * t * (1.0 + 1.0 / u) / (d**2 * b) / 2.07)
            bending.append(2.0 * t * z / (d**2 * b * cosine) / 48.0)
        limits = {"k_factor": tuple(contact), "unit_load": tuple(bending)}
        width = {"width": (x.w[0] / 0.6, x.w[1] / 0.75)}
        return Terms({VOLUME: volume, LENGTH: length, LOSS: loss}, limits | width)

    variables = (
        Var("u", "", 2.0, 10.0, 5.0, log=True),
        Var("d", "mm", 20.0, 200.0, 80.0, 2, log=True),
        Var("w", "", 0.3, 0.75, 0.5, 2, log=True),
        Var("z", "", 20.0, 100.0, 25.0, 2, log=True),
    )
    return Problem("elevator", variables, (), evaluate)


def _real(names: tuple[str, ...], most: dict[str, float], seeds: int) -> Iterator[dict[str, Any]]:
    problem, case = elevator(), "elevator, real-valued: " + ", ".join(names)
    fine = found(problem, names, most, "epsilon", REFERENCE_POINTS[len(names)]).values
    front, ms = _timed(lambda: found(elevator(), names, most, "epsilon"))
    yield _row(case, "epsilon", [front], [ms], fine)
    for count in EVALUATIONS:
        yield _sampled(case, problem, names, most, count, seeds, fine)


def _whole(
    case: str, names: tuple[str, ...], largest: float | None, seeds: int
) -> Iterator[dict[str, Any]]:
    train = replace(train_of(*CASES[case][:2]), objective=names[0], others=names[1:])
    most = {} if largest is None else {VOLUME: largest}
    words = f"{case}, whole teeth: " + ", ".join(names)
    front, ms = _timed(lambda: found(teeth.problem(train), names, most, "exact"))
    yield _row(words, "exact", [front], [ms], front.values)
    yield _sampled(words, teeth.problem(train), names, most, EVALUATIONS[-1], seeds, front.values)


def _sampled(
    case: str,
    problem: Problem,
    names: tuple[str, ...],
    most: dict[str, float],
    count: int,
    seeds: int,
    exact: Array,
) -> dict[str, Any]:
    """Return the row of NSGA-II (NSGA-III of three objectives) after so many evaluations."""
    budget = Budget(evaluations=count)
    runs = []
    for seed in range(max(1, seeds)):
        call = partial(found, problem, names, most, "nsga2", None, budget, seed)
        runs.append(_timed(call))
    method = f"{'nsga2' if len(names) == 2 else 'nsga3'}, {count:,} evaluations"
    return _row(case, method, [made for made, _ in runs], [ms for _, ms in runs], exact)


def _timed(call: Callable[[], Found]) -> tuple[Found, float]:
    clock = Clock()
    return call(), 1000.0 * clock.seconds


def _row(
    case: str, method: str, runs: list[Found], times: list[float], exact: Array
) -> dict[str, Any]:
    corner = reference(exact)
    whole = hypervolume(exact, corner)
    shares = [hypervolume(made.values, corner) / whole for made in runs]
    grown = [ms for made in runs if (ms := _grown(made, corner)) is not None]
    return {
        "case": case,
        "method": method,
        "points": round(statistics.median(len(made.points) for made in runs)),
        "share_percent": round(100.0 * statistics.median(shares), 3),
        "worst_percent": round(100.0 * min(shares), 3),
        "median_ms": round(statistics.median(times), 1),
        "ms_to_99_percent": round(statistics.median(grown), 1) if grown else None,
        "status": status(runs[0]),
    }


def _grown(made: Found, corner: Array) -> float | None:
    """Return the time [ms] until SHARE of its last hypervolume; None where it has none."""
    volumes = [hypervolume(step.values, corner) for step in made.steps]
    if not volumes or not volumes[-1]:
        return None
    reached = zip(made.steps, volumes, strict=True)
    return next(1000.0 * step.seconds for step, v in reached if v >= SHARE * volumes[-1])
