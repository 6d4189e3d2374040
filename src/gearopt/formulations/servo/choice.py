"""The whole teeth and modules of a servo train: the formulation, held to stiffness and box too.

Stiffness is that of meshes and shaft in series at the output, motor locked.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearopt.formulations.servo import servo_box, split
from gearopt.formulations.servo.servo_design import GOALS, Spring, StiffnessDesign
from gearopt.formulations.servo.split import teeth
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.formulations.servo.split.servo_train import pairs
from gearopt.optimise.clock import Clock, in_part, of_others
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms
from gearopt.physics.gears import GearPair
from gearopt.physics.stiffness import (
    lewis_form_factor,
    line_stiffness,
    locked_frequency,
    mesh_compliance,
    output_compliance,
    shaft_compliance,
    tooth_factor,
)

RANDOM, COUNTS = teeth.RANDOM, teeth.COUNTS  # of the methods that are passed on here
ROUNDING = 1e-12  # of an objective
WANTED = {"stiffness": "is stiff enough", "box": "fits the box"}
LISTED = 1_000_000  # trains that a Pareto front is taken from, at most
SPRINGS = ("mesh of stage 2", "shaft between the stages", "mesh of stage 1")
PART = 50_000  # trains that are evaluated between two checks of the clock


@dataclass(frozen=True)
class Springs:
    """What is given of meshes and shaft between the stages; lengths in mm, moduli in MPa.

    shaft: diameter and length. line_stiffness: of a mesh; None where it follows from the gears'
    youngs_modulus and teeth. load_inertia [t mm2] and load_torque [N mm]: None for none. minimum:
    stiffness of the output [N mm/rad], None where none is required.
    """

    shear_modulus: float
    shaft: tuple[float, float]
    line_stiffness: float | None = None
    youngs_modulus: float = math.nan
    load_inertia: float | None = None
    load_torque: float | None = None
    minimum: float | None = None

    def compliances(self, pairs: Pairs) -> tuple[Any, Any, Any]:
        """Return compliances [rad/(N mm)] at the output, in the order of SPRINGS."""
        first, second = pairs
        twist = shaft_compliance(self.shear_modulus, *self.shaft)
        return (
            self._mesh(second),
            twist / second.ratio**2,
            self._mesh(first) / second.ratio**2,
        )

    def _mesh(self, pair: GearPair) -> Any:
        """Return the compliance [rad/(N mm)] of a mesh, its line stiffness given or by Lewis."""
        stiffness: Any = self.line_stiffness
        if self.line_stiffness is None:
            one, two = (tooth_factor(lewis_form_factor(g.teeth) / math.pi) for g in pair.gears)
            stiffness = line_stiffness(self.youngs_modulus, one, self.youngs_modulus, two)
        return mesh_compliance(stiffness, pair.face_width, pair.wheel.reference_diameter)

    def output_stiffness(self, pairs: Pairs) -> Any:
        """Return the stiffness at the output [N mm/rad]."""
        return 1.0 / output_compliance(self.compliances(pairs), (1.0, 1.0, 1.0))

    def design(self, pairs: Pairs) -> StiffnessDesign:
        """Return stiffness, frequency and wind-up of a train, with the share of every spring."""
        parts = [float(c) for c in self.compliances(pairs)]
        total = math.fsum(parts)
        inertia, torque = self.load_inertia, self.load_torque
        return StiffnessDesign(
            output_Nm_per_rad=1e-3 / total,
            springs=tuple(
                Spring(name, part / total, 1e-3 / part)
                for name, part in zip(SPRINGS, parts, strict=True)
            ),
            frequency_Hz=None if inertia is None else float(locked_frequency(1.0 / total, inertia)),
            windup_deg=None if torque is None else math.degrees(torque * total),
        )


@dataclass(frozen=True)
class Choice:
    """A train to be chosen, what for, and what it must keep beside the limits of `split.problem`.

    springs: with the stiffness that is asked for; None for none. room: the box of a train, which it
    must fit; None for none.
    """

    train: split.ServoTrain
    goal: str = "inertia"
    springs: Springs | None = None
    room: Callable[[Pairs], servo_box.ServoBox] | None = None

    @property
    def minimum_stiffness(self) -> float | None:
        """Return the minimum stiffness of the output [N mm/rad]; None where none is asked for."""
        return None if self.springs is None else self.springs.minimum

    @property
    def apart(self) -> tuple[str, ...]:
        """Return the limits that an enumeration leaves aside."""
        return ("stiffness",) * (self.minimum_stiffness is not None) + ("box",) * (
            self.room is not None
        )

    @property
    def weighed(self) -> tuple[str, ...]:
        """Return the objectives of the Pareto front: inertia, or the goal of the duty, first."""
        first = self.goal if GOALS[self.goal].motion else "inertia"
        return (first, "mass", *(("error",) if self.train.lost_motion is not None else ()))

    def stiff(self, points: Array) -> Array:
        """Return those of some points (N, 6) that are stiff enough."""
        if self.springs is None or self.springs.minimum is None:
            return points
        made = pairs(points.T, self.train.face_width)
        found: Array = points[self.springs.output_stiffness(made) >= self.springs.minimum]
        return found

    def keeps(self, point: Array) -> bool:
        """Return whether a train is stiff enough and fits."""
        if not len(self.stiff(point[None])):
            return False
        return self.room is None or servo_box.first_that_fits([self.room(pairs(point))]) is not None


def train_problem(choice: Choice) -> Problem:
    """Return the problem of a train in the unit that is shown; a box is kept by its own methods.

    Variables as in `split.problem`.
    """
    base, factor = split.problem(choice.train, choice.goal), GOALS[choice.goal].factor

    def evaluate(x: Any, p: Any) -> Terms:
        found = base.evaluate(x, p)
        limits = dict(found.limits)
        if choice.springs is not None and choice.springs.minimum is not None:
            made = pairs((*x.pinion_teeth, *x.wheel_teeth, *x.module), choice.train.face_width)
            limits["stiffness"] = choice.springs.minimum / choice.springs.output_stiffness(made)
        goal = {choice.goal: factor * found.minimise[choice.goal]}
        return replace(found, minimise=goal, limits=limits)

    def method(name: str) -> Callable[..., Outcome]:
        def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
            """Return the best train, or of all in order the first that keeps the limits apart."""
            clock = Clock(budget, watch)
            # a train may be better than the answer where limits are checked apart
            shown = of_others(watch, "") if choice.apart else in_part(watch, factor=factor)
            found: Outcome = base.methods[name](base, budget, seed, shown)
            found = _counted(found, found.proof, choice.apart)
            if choice.apart and found.x is not None and not choice.keeps(found.x):
                clock.evaluations = found.evaluations
                try:
                    best = float(base.batch(found.x[None]).F[0, 0])
                    counts, found = found.proof, _in_order(choice, base, best, clock)
                    found = _counted(found, counts, choice.apart)
                except TimeoutError as early:
                    found = Outcome(None, finished=False, message=str(early))
            return found if found.bound is None else replace(found, bound=factor * found.bound)

        return run

    methods = {name: method(name) for name in ("exact", "enumeration")}
    return Problem("train", base.variables, (), evaluate, methods=methods)


def _counted(found: Outcome, proof: Mapping[str, Any] | None, apart: tuple[str, ...]) -> Outcome:
    """Return an outcome with the counts of an enumeration; apart: limits they leave aside."""
    if proof is None or "feasible_trains" not in proof:
        return found
    counts = {k: proof[k] for k in ("trains_looked_at", "feasible_trains")}
    made = {**(found.proof or {}), **counts, "not_counted": list(apart)}
    if "sentence" in made:
        made["sentence"] = teeth.sentence(made, found.infeasible)
    return replace(found, proof=made)


def _in_order(choice: Choice, base: Problem, best: float, clock: Clock) -> Outcome:
    """Examine all feasible trains, the best first, until one is stiff and fits.

    best: the objective of the best train, whether it is stiff and fits or not.
    """
    looked, stiff, counted = 0, 0, choice.minimum_stiffness is not None
    asked = [WANTED[name] for name in choice.apart]

    def check(tried: int = 0) -> None:
        count = looked + tried
        if not clock.tell(count):
            none = f"none of which {' and '.join(asked)}"
            raise TimeoutError(f"stopped after {count:,} trains, {none}")

    def boxes(points: Array, room: Callable[[Pairs], Any]) -> Iterator[servo_box.ServoBox]:
        for tried, point in enumerate(points):
            check(tried)
            yield room(pairs(point))

    for lot in split.in_order(choice.train, choice.goal, best, check):
        points, room = choice.stiff(lot), choice.room
        found = (0, None) if room is None else servo_box.first_that_fits(boxes(points, room))
        if found is not None and len(points):
            point = points[found[0]]
            bound = float(base.batch(point[None]).F[0, 0]) * (1.0 - ROUNDING)
            count = looked + len(lot)
            proof = _looked(count, stiff + len(points) if counted else None, False)
            return Outcome(point, bound=bound, proof=proof, evaluations=count)
        looked, stiff = looked + len(lot), stiff + len(points)
    what = "fits the box" if stiff else "has the stiffness that is required"
    text = f"none of the {looked:,} trains that meet all other limits {what}"
    proof = _looked(looked, stiff if counted else None, True)
    return Outcome(None, infeasible=True, proof=proof, evaluations=looked, message=text)


def _looked(count: int, stiff: int | None, infeasible: bool) -> dict[str, Any]:
    """Return how an order of trains is proven; stiff: how many of them are, where asked for."""
    proof = teeth.exhaustion(count, None, True)
    proof["sentence"] = teeth.sentence(proof, infeasible)
    return proof if stiff is None else proof | {"trains_stiff_enough": stiff}


def front(choice: Choice, clock: Clock) -> tuple[Array, Array] | None:
    """Return points and objectives (`weighed`) of the Pareto front of trains.

    Stiffness is kept, a box left aside; None where the feasible trains are too many, or time is
    up.
    """

    def check() -> None:
        if not clock.tell():
            raise TimeoutError

    goals = choice.weighed
    posed = split.problem(choice.train, *goals)
    try:
        points = split.feasible(choice.train, goals[0], LISTED, check)
        if points is None:
            return None
        best, worth = points[:0], np.empty((0, len(goals)))
        for start in range(0, len(points), PART):
            check()
            part = choice.stiff(points[start : start + PART])
            if len(part):
                best, worth = np.vstack([best, part]), np.vstack([worth, posed.batch(part).F])
                kept = split.pareto_front(worth)
                best, worth = best[kept], worth[kept]
    except TimeoutError:
        return None
    return (best, worth) if len(best) else None
