"""The whole teeth and modules of a servo train: the formulation, held to stiffness and box too.

Stiffness is that of meshes and shaft in series at the output, motor locked. The best train that is
stiff enough and fits its box is searched in rounds, without a list of trains: a round looks at
trains of an objective between two values, and so keeps boxes of poor ones from being judged.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations.servo import servo_box, split
from gearopt.formulations.servo.servo_box import DEEP
from gearopt.formulations.servo.servo_design import GOALS
from gearopt.formulations.servo.split import teeth
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.formulations.servo.split.numbers import posed
from gearopt.formulations.servo.split.servo_train import ServoTrain, pairs
from gearopt.formulations.servo.split.springs import Springs
from gearopt.formulations.servo.split.teeth import point
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock, in_part, of_others
from gearopt.optimise.kernels import kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms

KERNEL = "gearopt.formulations.servo.choice_kernel"
TEETH = "gearopt.formulations.servo.split.teeth_kernel"
FIRST_MARGIN = 1e-3  # by which the trains of the first round are worse than the best one, at most
WIDER = 8.0  # from one round to the next
LAST_ROUND = 10.0  # times the best one: the last round has no end
KERNEL_STEPS = 2_000, 2_000_000  # of the kernel between two checks of the clock: at first, maximum


class Kept(NamedTuple):
    """Stiffness and box that a train keeps beside the limits of `split.problem`, for the kernel.

    spring (5,): line stiffness of a mesh (0: by Lewis) and Young's modulus [MPa], face width [mm],
    compliance of the shaft [rad/(N mm)], minimum stiffness of the output [N mm/rad] (0: none). box:
    numbers of a `ServoBox` whose radii and links the kernel writes, its sides with the tie; boxed:
    whether there is one; motor: its radius [mm].
    """

    spring: Array
    box: Any
    boxed: bool
    motor: float


class Work(NamedTuple):
    """Where a search is.

    known, parts (first stages,): promises, nan where not computed, and the open parts of the
    quarter as bits, -1 where not known. at (4,): first stage, module and pinion teeth of the second
    one to go on from (-1: not entered), parts open to that module. cells, angles: of one box. found
    (6,): z1, z2, z3, z4 and module indices of the best train; ends (3,): objectives above the
    first, up to the second, and the least one found.
    """

    known: Array
    parts: Any
    at: Any
    cells: Array
    angles: Array
    found: Any
    ends: Array


def best_kept(
    train: ServoTrain, goal: str, kept: Kept, best: float, clock: Clock, some: bool = False
) -> Array | None:
    """Return the best train that keeps all, as a point of `split.problem`; None where none does.

    best: the minimum objective of all trains, > 0, about which the rounds of a box begin; inf: one
    round. some: any train that keeps all will do. TimeoutError, with a train as argument if one is
    known, when the clock stops it; SolveError where a box is not decided.
    """
    (given, aim), look = posed(train, goal), kernel(KERNEL).best_kept
    stages = kernel(TEETH).first_stages(given)[0]
    work = Work(
        known=np.full(stages, math.nan),
        parts=np.full(stages, -1),
        at=np.array([stages, -1, -1, 0]),
        cells=np.zeros((DEEP, 2)),
        angles=np.zeros(2),
        found=np.zeros(6, np.int64),
        ends=np.array([-math.inf, math.inf, math.inf]),
    )
    look(given, aim, kept, work, 0)  # compiled before the clock starts
    above, step = -math.inf, FIRST_MARGIN
    while True:
        most = best * (1.0 + step) if kept.boxed and step < LAST_ROUND else math.inf
        work.at[:], work.ends[:] = (0, -1, -1, 0), (above, most, math.inf)
        steps = KERNEL_STEPS[0]
        while work.at[0] < stages:
            looked, undecided = look(given, aim, kept, work, steps)
            if undecided:
                raise SolveError("whether a train fits its box is not decided by intervals")
            if some and math.isfinite(work.ends[2]):
                break
            clock.evaluations, steps = clock.evaluations + looked, min(2 * steps, KERNEL_STEPS[1])
            if not clock.tell() and work.at[0] < stages:
                there = math.isfinite(work.ends[2])
                raise TimeoutError(point(given, work.found) if there else None)
        if math.isfinite(work.ends[2]):
            return point(given, work.found)
        if math.isinf(most):
            return None
        above, step = most, WIDER * step


RANDOM, COUNTS = teeth.RANDOM, teeth.COUNTS  # of the methods that are passed on here
SLACK = teeth.ROUNDING, teeth.FLAT  # of an objective, and of that of a duty
WANTED = {"stiffness": "has the stiffness that is required", "box": "fits the box"}
TIE = 1e-9  # relative: a minimum backlash that is met exactly


@dataclass(frozen=True)
class Choice:
    """A train to be chosen, its goal, and the limits that it keeps beside those of `split.problem`.

    springs: with the stiffness that is asked for; None for none. room: the box of a train, which it
    must fit; None for none. backlash: stages with a minimum backlash, what it is with all
    deviations at their worst, and what is asked for [mm]; no teeth or module change it.
    """

    train: split.ServoTrain
    goal: str = "inertia"
    springs: Springs | None = None
    room: servo_box.Room | None = None
    backlash: tuple[tuple[int, float, float], ...] = ()

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

    def stiff(self, pairs: Pairs) -> bool:
        """Return whether a train is stiff enough."""
        least = self.minimum_stiffness
        if self.springs is None or least is None:
            return True
        return bool(self.springs.output_stiffness(pairs) >= least * (1.0 - teeth.ROUNDING))

    def keeps(self, point: Array) -> bool:
        """Return whether a train is stiff enough and fits."""
        gears = pairs(point, self.train.face_width)
        if self.room is None or not self.stiff(gears):
            return self.stiff(gears)
        return servo_box.first_that_fits([servo_box.of_train(gears, self.room)]) is not None

    @property
    def kept(self) -> Kept:
        """Return stiffness and box as the kernel reads them."""
        room, springs = self.room or servo_box.Room(0.0, 0.0, math.pi, (1.0, 1.0)), self.springs
        box = servo_box.Numbers(
            np.zeros(3), np.zeros(3), room.hub, room.half_sweep, servo_box.tied(room.box)
        )
        spring = np.zeros(5) if springs is None else springs.numbers(self.train.face_width)
        return Kept(spring, box, self.room is not None, room.motor_radius)


def train_problem(choice: Choice) -> Problem:
    """Return the problem of a train in the unit that is shown; a box is kept by its own methods.

    Variables as in `split.problem`.
    """
    base, factor = split.problem(choice.train, choice.goal), GOALS[choice.goal].factor

    def method(name: str) -> Callable[..., Outcome]:
        def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
            """Return the best train; where it breaks the limits apart, the best that keeps them."""
            if (bound := binding(choice.backlash)) is not None:
                return bound
            clock = Clock(budget, watch)
            # a train may be better than the answer where limits are checked apart
            shown = of_others(watch, "") if choice.apart else in_part(watch, factor=factor)
            outcome: Outcome = base.methods[name](base, budget, seed, shown)
            outcome = _with_counts(outcome, outcome.proof, choice.apart)
            if choice.apart and outcome.x is not None and not choice.keeps(outcome.x):
                clock.evaluations = outcome.evaluations
                best = float(base.batch(outcome.x[None]).F[0, 0])
                counts, outcome = outcome.proof, _best_stiff_train(choice, base, best, clock)
                outcome = _with_counts(outcome, counts, choice.apart)
            return (
                outcome if outcome.bound is None else replace(outcome, bound=factor * outcome.bound)
            )

        return run

    methods = {name: method(name) for name in ("exact", "enumeration")}
    return Problem("train", base.variables, (), text(choice, base), methods=methods)


def text(choice: Choice, base: Problem) -> Callable[[Any, Any], Terms]:
    """Return the text of a train's problem: that of `split.problem` in the units that are shown.

    With the limits on stiffness and backlash.
    """

    def evaluate(x: Any, p: Any) -> Terms:
        terms = base.evaluate(x, p)
        limits = dict(terms.limits)
        if choice.springs is not None and choice.springs.minimum is not None:
            gears = pairs((*x.pinion_teeth, *x.wheel_teeth, *x.module), choice.train.face_width)
            limits["stiffness"] = choice.springs.minimum / choice.springs.output_stiffness(gears)
        for stage, there, asked in choice.backlash:
            none = 0.0 * x.module[0]  # of the shape of a population
            scale = there if there > 0.0 else asked  # required over actual, where gears have any
            limits[f"minimum_backlash[{stage}]"] = 1.0 + (asked - there) / scale + none
        goals = {name: GOALS[name].factor * value for name, value in terms.minimise.items()}
        return replace(terms, minimise=goals, limits=limits)

    return evaluate


def binding(backlash: tuple[tuple[int, float, float], ...]) -> Outcome | None:
    """Return the claim that a minimum backlash is not kept; None where all are.

    backlash: as a `Choice` has it. The sum of the deviations is the proof.
    """
    short = [(k, there, asked) for k, there, asked in backlash if there < asked * (1.0 - TIE)]
    if not short:
        return None
    text = " and ".join(
        f"the backlash of stage {k} goes down to {1e3 * there:.4g} µm, below the minimum of "
        f"{1e3 * asked:.4g} µm"
        for k, there, asked in short
    )
    conflict = [f"minimum_backlash[{k}]" for k, _, _ in short]
    words = "Proof: the sum of the deviations, each at the end of its range that closes the mesh."
    proof = {"method": "closed form", "conflict": conflict, "each_alone": True, "sentence": words}
    return Outcome(None, infeasible=True, proof=proof, message=text)


def _with_counts(
    found: Outcome, proof: Mapping[str, Any] | None, apart: tuple[str, ...]
) -> Outcome:
    """Return an outcome with the counts of an enumeration; apart: limits they leave aside."""
    if proof is None or "feasible_trains" not in proof:
        return found
    counts = {k: proof[k] for k in ("trains_looked_at", "feasible_trains")}
    with_counts = {**(found.proof or {}), **counts, "not_counted": list(apart)}
    if "sentence" in with_counts:
        with_counts["sentence"] = teeth.sentence(with_counts, found.infeasible)
    return replace(found, proof=with_counts)


def _best_stiff_train(choice: Choice, base: Problem, best: float, clock: Clock) -> Outcome:
    """Return the best train that is stiff and fits, proven.

    best: the objective of the best train, whether it is stiff and fits or not.
    """
    before = clock.evaluations
    asked = " and ".join(WANTED[name] for name in choice.apart)
    try:
        x = best_kept(choice.train, choice.goal, choice.kept, best, clock)
    except TimeoutError as early:
        (x,) = early.args
        text = "stopped by the budget" if x is not None else f"stopped before a train that {asked}"
        return Outcome(x, finished=False, message=text, evaluations=clock.evaluations)
    looked = clock.evaluations - before
    proof = teeth.exhaustion(looked, None, True)
    proof["sentence"] = teeth.sentence(proof, x is None)
    if x is None:
        text = f"no train that meets all other limits {asked}"
        return Outcome(None, infeasible=True, proof=proof, evaluations=looked, message=text)
    bound = float(base.batch(x[None]).F[0, 0]) * (1.0 - SLACK[bool(GOALS[choice.goal].motion)])
    return Outcome(x, bound=bound, proof=proof, evaluations=looked)
