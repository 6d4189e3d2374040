"""The whole teeth and modules of a servo train: the formulation, held to stiffness and box too."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from gearopt.formulations.servo import servo_box, split
from gearopt.formulations.servo.ratio.duty import UNITS
from gearopt.optimise.clock import Clock, in_part, of_others
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome, Watch
from gearopt.optimise.terms import Array, Terms
from gearopt.scenes.servo.gears import KG_M2
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.springs import output_stiffness
from gearopt.scenes.servo.tables.bodies import half_sweep

RANDOM, COUNTS = split.exact.RANDOM, split.exact.COUNTS  # of the methods that are passed on here
ROUNDING = 1e-12  # of an objective
SHOWN = {  # objective: factor to the unit that is shown, the unit
    "inertia": (KG_M2, "kg_m2"),
    "mass": (1.0, "kg"),
    "error": (180.0 / math.pi, "deg"),
    "inverse_acceleration": (1.0, "s2/rad"),
    "move_time": (1.0, "s"),
    "rms_torque": (1e-3, "Nm"),
}
FRONT = 400  # trains that are shown
LISTED = 1_000_000  # trains that these are chosen from, at the most
PART = 50_000  # trains that are weighed between two looks at the clock


def posed(scene: Scene, boxed: bool = True) -> Problem:
    """The problem of a file's train in the units of `SHOWN`.

    boxed: its own methods keep to a required box too, which is no row of the problem.
    """
    assert scene.train is not None
    goal = scene.train.goal
    base, factor = split.problem(scene.servo_train(), goal), SHOWN[goal][0]
    boxed = boxed and scene.space is not None and scene.space.required
    least = scene.least_stiffness
    apart = ("stiffness",) * (least is not None) + ("box",) * boxed

    def evaluate(x: Any, p: Any) -> Terms:
        found = base.evaluate(x, p)
        limits = dict(found.limits)
        if least is not None:
            (z1, z3), (z2, z4), (m1, m2) = x.pinion_teeth, x.wheel_teeth, x.module
            limits["stiffness"] = least / output_stiffness(scene, (z1, z3, z2, z4, m1, m2))
        return replace(found, minimise={goal: factor * found.minimise[goal]}, limits=limits)

    def method(name: str) -> Callable[..., Outcome]:
        def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
            """The best train; where it breaks a limit, all trains in order until one keeps it."""
            # a train may be better than the answer where limits are looked at apart
            shown = of_others(watch, "") if apart else in_part(watch, factor=factor)
            found: Outcome = base.methods[name](base, budget, seed, shown)
            found = _counted(found, found.proof, apart)
            if apart and found.x is not None and not _keeps(scene, found.x, boxed):
                clock = Clock(budget)
                try:
                    best = float(base.batch(found.x[None]).F[0, 0])
                    counts, found = found.proof, _in_order(scene, base, boxed, best, clock, watch)
                    found = _counted(found, counts, apart)
                except TimeoutError as early:
                    found = Outcome(None, finished=False, message=str(early))
            return found if found.bound is None else replace(found, bound=factor * found.bound)

        return run

    methods = {name: method(name) for name in ("exact", "enumeration")}
    return Problem("train", base.variables, (), evaluate, methods=methods)


def box_of(scene: Scene, point: Array) -> servo_box.ServoBox:
    """The box of a train, as its layout sees it."""
    space, train = scene.space, scene.train
    assert space is not None and train is not None
    return servo_box.of_train(
        point,
        0.5 * space.motor_diameter.value,
        0.5 * space.hub_diameter.value,
        half_sweep(train, space),
        (space.width.value, space.height.value),
    )


def _keeps(scene: Scene, point: Array, boxed: bool) -> bool:
    least = scene.least_stiffness
    if least is not None and least > output_stiffness(scene, point):
        return False
    return not boxed or servo_box.first_that_fits([box_of(scene, point)]) is not None


def _counted(found: Outcome, proof: Mapping[str, Any] | None, apart: tuple[str, ...]) -> Outcome:
    """An outcome with the counts of an enumeration; apart: limits that these do not look at."""
    if proof is None or "feasible_trains" not in proof:
        return found
    counts = {k: proof[k] for k in ("trains_looked_at", "feasible_trains")}
    return replace(found, proof={**(found.proof or {}), **counts, "not_counted": list(apart)})


def _in_order(
    scene: Scene, base: Problem, boxed: bool, best: float, clock: Clock, watch: Watch | None
) -> Outcome:
    """All feasible trains, the best first, until one is stiff and fits; TimeoutError if late.

    best: the objective of the best train, whether it is stiff and fits or not.
    """
    assert scene.train is not None
    least, looked, stiff = scene.least_stiffness, 0, 0
    asked = ("is stiff enough",) * (least is not None) + ("fits the box",) * boxed

    def check(tried: int = 0) -> None:
        count = looked + tried
        event = Event(clock.seconds, count)
        if clock.over or (watch is not None and watch(event) is False):
            none = f"none of which {' and '.join(asked)}"
            raise TimeoutError(f"stopped after {count:,} trains, {none}")

    def boxes(points: Array) -> Iterator[servo_box.ServoBox]:
        for tried, point in enumerate(points):
            check(tried)
            yield box_of(scene, point)

    for lot in split.in_order(scene.servo_train(), scene.train.goal, best, check):
        points = lot if least is None else lot[output_stiffness(scene, lot.T) >= least]
        found = servo_box.first_that_fits(boxes(points)) if boxed else (0, None)
        if found is not None and len(points):
            point = points[found[0]]
            bound = float(base.batch(point[None]).F[0, 0]) * (1.0 - ROUNDING)
            count = looked + len(lot)
            proof = _looked(count, None if least is None else stiff + len(points))
            return Outcome(point, bound=bound, proof=proof, evaluations=count)
        looked, stiff = looked + len(lot), stiff + len(points)
    what = "the box" if stiff else "the stiffness that is asked for"
    text = f"none of the {looked:,} trains that keep all other limits keeps {what}"
    proof = _looked(looked, None if least is None else stiff)
    return Outcome(None, infeasible=True, proof=proof, evaluations=looked, message=text)


def _looked(count: int, stiff: int | None) -> dict[str, Any]:
    """How an order of trains is proven; stiff: how many of them are, where that is asked for."""
    found: dict[str, Any] = {
        "method": "exhausted",
        "arithmetic": "ratios and diameters in whole numbers; the rest in double",
        "trains_looked_at": count,
    }
    return found if stiff is None else found | {"trains_stiff_enough": stiff}


def weighed(scene: Scene) -> tuple[str, ...]:
    """What trains are held against each other by: inertia, or what the duty makes least, first."""
    assert scene.train is not None
    first = scene.train.goal if scene.train.goal in UNITS else "inertia"
    return (first, "mass", *(("error",) if scene.sources else ()))


def front(scene: Scene, clock: Clock) -> tuple[Array, Array] | None:
    """Points and worth (by `weighed`) of all trains that no other is better than in all of it.

    Stiffness is kept, a box not looked at; None where the feasible trains are too many, or time is
    up.
    """
    import numpy as np

    def check() -> None:
        if not clock.tell():
            raise TimeoutError

    train, goals = scene.servo_train(), weighed(scene)
    posed, least = split.problem(train, *goals), scene.least_stiffness
    try:
        points = split.feasible(train, goals[0], LISTED, check)
        if points is None:
            return None
        best, worth = points[:0], np.empty((0, len(goals)))
        for start in range(0, len(points), PART):
            check()
            part = points[start : start + PART]
            if least is not None:
                part = part[output_stiffness(scene, part.T) >= least]
            if len(part):
                best, worth = np.vstack([best, part]), np.vstack([worth, posed.batch(part).F])
                kept = split.unbeaten(worth)
                best, worth = best[kept], worth[kept]
    except TimeoutError:
        return None
    return (best, worth) if len(best) else None
