"""The smallest box around a two-stage servo train whose last wheel is a sector that swings.

Seen along the shafts: the output shaft carries a sector that sweeps an angle about its mesh line,
all else on the three shafts is discs, and both links have given lengths. So a layout is two angles.
The box stands along the axes; its sides shrink together, by a scale. The exact search halves
intervals of the output link's angle; for each the motor link's angle is decided on its arcs, with
the extents of the interval at their least.
"""

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations.servo.servo_design import BoxDesign
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.frozen import dataclass
from gearopt.optimise.best_first import ending
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Result, Watch
from gearopt.optimise.terms import Array, Terms, Var

RANDOM = False
COUNTS = "interval of angles judged"
TIE = 1e-9  # of the box's sides: layouts that meet it exactly are many, and fit
GAP = 1e-6  # where the budget asks for none
NODES = 20_000  # of a slice
DEEP = 4_000  # open intervals; each halving leaves one
KERNEL = "gearopt.formulations.servo.servo_box_kernel"


@dataclass(frozen=True)
class ServoBox:
    """Discs, links and a box; lengths in mm, angles in rad.

    radii: of what is largest on each shaft, over tips: motor or gear 1, gear 2 or 3, last wheel.
    links: centre distances of stage 1 and 2. hub: radius about the output shaft that the motor
    keeps out of. half_sweep: of the sector to either side of its mesh line, travel included; pi for
    a full wheel. box: width and height.
    """

    radii: tuple[float, float, float]
    links: tuple[float, float]
    hub: float
    half_sweep: float
    box: tuple[float, float]

    def __post_init__(self) -> None:
        if not min(*self.radii, *self.links, *self.box) > 0.0 or not self.hub >= 0.0:
            raise ValueError("radii, links and box are positive lengths")
        if not 0.0 < self.half_sweep <= math.pi:
            raise ValueError("half_sweep is an angle above 0, at most pi (a full wheel)")


class Numbers(NamedTuple):
    """A `ServoBox` as the kernel reads it.

    link: centre distance of stage 1, and the ends of that of stage 2, here the same.
    """

    radius: Array
    link: Array
    hub: float
    half_sweep: float
    box: Array


def numbers(box: ServoBox) -> Numbers:
    """Return the numbers of the kernel."""
    links = (*box.links, box.links[1])
    radius, link, sides = (np.array(v, float) for v in (box.radii, links, box.box))
    return Numbers(radius, link, float(box.hub), float(box.half_sweep), sides)


@dataclass(frozen=True)
class Room:
    """Given numbers of a `ServoBox` without its train; motor_radius: of the motor's body [mm]."""

    motor_radius: float
    hub: float
    half_sweep: float
    box: tuple[float, float]


def tied(box: Any) -> Array:
    """Return the sides of a box with the tie, so that a layout that meets it exactly fits."""
    return (1.0 + TIE) * np.array(box, float)


def of_train(pairs: Pairs, room: Room) -> ServoBox:
    """Return the box of a train."""
    tips = [float(0.5 * gear.tip_diameter) for pair in pairs for gear in pair.gears]
    radii = max(room.motor_radius, tips[0]), max(tips[1], tips[2]), tips[3]
    first, second = (float(pair.centre_distance) for pair in pairs)
    return ServoBox(radii, (first, second), room.hub, room.half_sweep, room.box)


def extents(box: ServoBox, motor: Any, output: Any) -> tuple[Any, Any]:
    """Return width and height [mm] of a layout.

    motor: angle of the link from gear 2 to the motor, output: from the output shaft to gear 2
    [rad]. A sector of half angle g reaches R where its mesh line is at most g off a direction, else
    R cos(off - g), at least its hub.
    """
    r1, r2, r4 = box.radii
    a, b = box.links
    sides = []
    for axis in range(4):
        turn = 0.5 * math.pi * axis
        along, across = np.cos(output - turn), np.abs(np.sin(output - turn))
        corner = along * math.cos(box.half_sweep) + across * math.sin(box.half_sweep)
        swept = r4 * np.where(along >= math.cos(box.half_sweep), 1.0, corner)
        second = b * along
        most = np.maximum(np.maximum(swept, box.hub), second + r2)
        sides.append(np.maximum(most, second + a * np.cos(motor - turn) + r1))
    return sides[0] + sides[2], sides[1] + sides[3]


def problem(box: ServoBox) -> Problem:
    """Minimise the scale of the box, max(width/W, height/H), with the motor clear of the hub.

    Variables: motor_angle, output_angle [rad]. A scale up to 1 fits.
    """

    def evaluate(x: Any, p: Any) -> Terms:
        width, height = extents(box, x.motor_angle, x.output_angle)
        a, b = box.links
        squared = a * a + b * b + 2.0 * a * b * np.cos(x.motor_angle - x.output_angle)
        clear = 1.0 + ((box.radii[0] + box.hub) ** 2 - squared) / (a + b) ** 2
        scale = np.maximum(width / box.box[0], height / box.box[1])
        report = {"width": width, "height": height}
        return Terms({"scale": scale}, {"motor_clear_of_hub": clear}, report=report)

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Search intervals of the output link; the seed changes nothing."""
        return _searched(box, budget, watch)

    angles = tuple(Var(f"{n}_angle", "rad", -math.pi, math.pi, 0.0) for n in ("motor", "output"))
    return Problem("servo box", angles, (), evaluate, methods={"exact": exact})


def _searched(box: ServoBox, budget: Budget, watch: Watch | None) -> Outcome:
    given, search = numbers(box), kernel(KERNEL).search
    cells, angles = np.zeros((DEEP, 2)), np.zeros(2)
    most = 4.0 * (sum(box.radii) + sum(box.links)) / min(box.box)  # any layout is smaller
    search(given, cells, 0, math.inf, angles, GAP, most, 1)  # compiled before the clock starts
    cells[0] = -math.pi, math.pi
    clock, count, best, stuck = Clock(budget, watch), 1, math.inf, False
    rel = 0.9 * (budget.gap or GAP)
    while count and not clock.stopped:
        left = clock.left.evaluations
        step = NODES if left is None else max(1, min(NODES, left))
        count, best, more, bad = search(given, cells, count, best, angles, rel, most, step)
        stuck, clock.best = stuck or bad, best
        clock.evaluations += more
        clock.tell()
    fits, looked = math.isfinite(best), clock.evaluations
    done = count == 0 and not stuck
    x = np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi if fits else None
    method = "exhausted" if done else "branch and bound, stopped early"
    proof = {
        "method": method,
        "arithmetic": "intervals in double, widened by 1e-12",
        "nodes": looked,
        "pruning_margin": rel,
        "sentence": f"Proof: {looked:,} ranges of link angles, each bounded by interval "
        f"arithmetic; {ending(done)}.",
    }
    if done and not fits:
        text = "in no layout does the motor clear the hub of the output shaft"
        return Outcome(None, infeasible=True, proof=proof, evaluations=looked, message=text)
    bound = best * (1.0 - rel) if done else None
    return Outcome(x, finished=done, bound=bound, proof=proof, evaluations=looked)


def first_that_fits(boxes: Iterable[ServoBox], limit: int = 10_000) -> tuple[int, Array] | None:
    """Return the place of the first box of scale 1 with a layout, and its angles; None for none.

    A layout that meets the box exactly fits: the box is TIE larger than it is. Every box before the
    found one is proven to have none. SolveError where `limit` intervals do not decide.
    """
    code, cells, angles = kernel(KERNEL), np.zeros((DEEP, 2)), np.zeros(2)
    for k, box in enumerate(boxes):
        given = numbers(box)
        answer = code.fits(given._replace(box=tied(given.box)), cells, angles, limit)
        if answer < 0:
            raise SolveError(
                f"whether train {k + 1} fits could not be decided in {limit:,} intervals"
            )
        if answer:
            return k, angles.copy()
    return None


def box_design(
    box: ServoBox, result: Result, x: Array, motor_mm: float, shaft_mm: float
) -> BoxDesign:
    """Return the layout x of a certified result; where the gap leaves it open, decide if it fits.

    motor_mm, shaft_mm: radii of the motor and of the shaft between the stages.
    """
    assert result.value is not None
    fits, most = result.value <= 1.0 + TIE, 1.0 + TIE
    if not fits and result.bound is not None and result.bound <= most:
        fitting = first_that_fits([box])
        fits, x = fitting is not None, x if fitting is None else fitting[1]
    motor, output = float(x[0]), float(x[1])
    width, height = (float(side) for side in extents(box, motor, output))
    return BoxDesign(
        inner_width_mm=box.box[0],
        inner_height_mm=box.box[1],
        needed_width_mm=width,
        needed_height_mm=height,
        fits=fits,
        motor_angle_deg=math.degrees(motor),
        output_angle_deg=math.degrees(output),
        radii_mm=box.radii,
        motor_mm=motor_mm,
        shaft_mm=shaft_mm,
        links_mm=box.links,
        hub_mm=box.hub,
        half_sweep_deg=math.degrees(box.half_sweep),
    )


__all__ = ["ServoBox", "box_design", "extents", "first_that_fits", "of_train", "problem"]
