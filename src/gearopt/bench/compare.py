"""Methods on drives and the Golinski reducer: gap to a proven bound, at equal effort.

The random drives are those of `random_drive(0)` ... `random_drive(4)`; each of their numbers is
drawn from a range that gear catalogues span.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.bench.drive import CASES, train_of
from gearopt.formulations.drive import continuous_sizing, teeth
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.comparing.compare import compare
from gearopt.optimise.comparing.comparison import Comparison
from gearopt.optimise.comparing.plan import Model, Plan
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Param, Terms, Var
from gearopt.physics.gears import SERIES_I

METHODS = ("exact", "scip", "annealing", "nsga2", "ipopt", "gp", "multistart")
CONTINUOUS = METHODS[5:]
SECONDS = 1.0
RANDOM_DRIVES = 5


def run(repeat: int) -> list[dict[str, Any]]:
    """Rows: case, method, the equal budget; medians over `repeat` seeds, worst gap."""
    return [row for name, found in comparisons(repeat) for row in _rows(name, found)]


def comparisons(seeds: int) -> Iterator[tuple[str, Comparison]]:
    """Yield name and comparison of every case."""
    plan = Plan(seconds=SECONDS, seeds=seeds)
    drives = {name: train_of(*CASES[name][:2]) for name in ("elevator", "three_stage")}
    drives |= {f"random drive {k}": random_drive(k) for k in range(RANDOM_DRIVES)}
    for name, train in drives.items():
        yield name, compare(METHODS, _posed(train), plan)
    methods = ("ipopt", "multistart", "annealing", "nsga2", "gp", "scip")
    golinski = Model(reducer(), "Golinski reducer", "cm3")
    yield "Golinski", compare(methods, lambda method: golinski, plan)


def _posed(train: Train) -> Callable[[str], Model]:
    models = {
        True: Model(continuous_sizing.problem(train), "Real-valued teeth", train.unit),
        False: Model(teeth.problem(train), "Whole teeth", train.unit),
    }
    return lambda method: models[method in CONTINUOUS]


def random_drive(number: int) -> Train:
    """Return A drive of two or three stages; `number` is the seed."""
    import numpy as np

    rng = np.random.default_rng([2026, number])
    count = int(rng.integers(2, 4))
    even = rng.uniform(3.0, 5.5)  # ratio of each stage
    stages = []
    for _ in range(count):
        width = Fraction(int(rng.integers(40, 111)), 100)
        stages.append(
            Stage(
                allowable=(float(rng.uniform(1.0, 4.0)), float(rng.uniform(25, 80))),
                face_width=FaceWidth(width, width),
                modules=SERIES_I,
                pinion_teeth=(int(rng.integers(17, 22)), 40),
            )
        )
    torque = float(np.exp(rng.uniform(np.log(5e3), np.log(5e5))))
    ratio = Fraction(round(100 * even**count), 100)
    helix = float(np.radians(rng.uniform(0.0, 25.0)))
    helical = tuple(replace(stage, toothings=(Toothing(helix),)) for stage in stages)
    return Train(torque, ratio, Fraction(1, 100), helical, law=K_FACTOR)


def reducer() -> Problem:
    """Return the Golinski reducer, A = 7.477, B = 16.9e6, x5 >= 7.3: optimum 2994.341315684."""

    def evaluate(x: Any, p: Any) -> Terms:
        b, m, z, l1, l2, d1, d2 = x.b, x.m, x.z, x.l1, x.l2, x.d1, x.d2
        volume = (
            0.7854 * b * m**2 * (3.3333 * z**2 + 14.9334 * z - 43.0934)
            - 1.508 * b * (d1**2 + d2**2)
            + p.A * (d1**3 + d2**3)
            + 0.7854 * (l1 * d1**2 + l2 * d2**2)
        )
        limits = {
            "bending": 27 / (b * m**2 * z),
            "contact": 397.5 / (b * m**2 * z**2),
            "deflection": (1.93 * l1**3 / (m * z * d1**4), 1.93 * l2**3 / (m * z * d2**4)),
            "stress_1": (p.B + (745 * l1 / (m * z)) ** 2) ** 0.5 / (110 * d1**3),
            "stress_2": (157.5e6 + (745 * l2 / (m * z)) ** 2) ** 0.5 / (85 * d2**3),
            "pinion_diameter": m * z / 40,
            "slenderness": (5 * m / b, b / (12 * m)),
            "shaft_length": ((1.5 * d1 + 1.9) / l1, (1.1 * d2 + 1.9) / l2),
        }
        return Terms({"volume": volume}, limits)

    ends = {"b": (2.6, 3.6), "m": (0.7, 0.8), "z": (17, 28), "l1": (7.3, 8.3), "l2": (7.3, 8.3)}
    ends |= {"d1": (2.9, 3.9), "d2": (5.0, 5.5)}
    variables = tuple(
        Var(name, "" if name == "z" else "cm", low, high, (low + high) / 2)
        for name, (low, high) in ends.items()
    )
    return Problem(
        "speed_reducer", variables, (Param("A", "", 7.477), Param("B", "", 16.9e6)), evaluate
    )


def _rows(name: str, found: Comparison) -> Iterator[dict[str, Any]]:
    for group in found.groups:
        for row in group.rows:
            samples = {"evaluations": row.equal_evaluations, "time": row.equal_time}
            for equal, sample in samples.items():
                s = None if sample is None else sample.summary
                yield {
                    "case": name,
                    "method": row.method,
                    "equal": "refused" if row.refused else equal,
                    "objective": s and s.objective,
                    "gap_percent": s and _percent(s.median_gap),
                    "worst_gap_percent": s and _percent(s.worst_gap),
                    "violation": s and s.violation,
                    "evaluations": s and s.evaluations,
                    "ms": s and round(1000.0 * s.seconds, 1),
                }
                if row.refused:
                    break


def _percent(gap: float | None) -> float | None:
    return None if gap is None else float(f"{100.0 * gap:.3g}")
