"""Whether a file has any train, how stiff a train can be and how small its box."""

import math
from collections.abc import Iterator
from dataclasses import replace

from gearopt.formulations.servo.choice import best_kept
from gearopt.formulations.servo.split.servo_train import pairs
from gearopt.formulations.servo.split.springs import Springs
from gearopt.optimise.clock import Clock
from gearopt.optimise.terms import Array
from gearopt.physics.stiffness import locked_frequency
from gearopt.scenes.explaining.numbers import at, cut, put, times
from gearopt.scenes.explaining.possible import Verdict
from gearopt.scenes.servo.scene import Scene

FARTHEST_FACTOR = 1000.0  # factor up to which a box is enlarged
FACTOR_TOLERANCE = 1e-4  # relative: between a factor that will do and one that will not
ABOVE = 1e-9  # relative, by which a stiffer train is asked for than the stiffest known


def some_train(scene: Scene, clock: Clock) -> Array | None:
    """Return any train that meets all limits, box and stiffness included; None: proven, none does.

    TimeoutError when the clock stops it.
    """
    if clock.over:
        raise TimeoutError(None)
    choice = scene.choice()
    return best_kept(choice.train, choice.goal, choice.kept, math.inf, clock, some=True)


def possible(scene: Scene, clock: Clock) -> Verdict:
    """Return whether some train meets all limits; a search of all of them decides."""
    return Verdict(some_train(scene, clock) is not None)


def reached(scene: Scene, clock: Clock) -> Iterator[str]:
    """Yield how stiff a train can be, and how small its box, all else as the file has it.

    TimeoutError when the clock stops it.
    """
    springs = scene.springs
    if springs is not None and springs.minimum is not None:
        stiffest = _stiffest(scene, clock)
        if stiffest is not None:
            yield f"the stiffest train that meets all other limits has {_stiff(springs, stiffest)}"
    if scene.space is not None and scene.space.required:
        scales = smallest_scale(scene, clock)
        if scales is not None:
            sides = scene.space.width, scene.space.height
            there, too_small = (
                " x ".join(str(cut(times(side, f), way, 4)) for side in sides)
                for f, way in ((scales[1], 1), (scales[0], -1))
            )
            yield (
                f"the smallest box of these proportions that holds a train is {there}; it "
                f"is proven that none fits in {too_small}"
            )


def smallest_scale(scene: Scene, clock: Clock) -> tuple[float, float] | None:
    """Return factors of both sides of the box: one proven too small, one with a train.

    None where no box helps.
    """
    low, high = 1.0, FARTHEST_FACTOR
    if some_train(_scaled(scene, high), clock) is None:
        return None
    while high > low * (1.0 + FACTOR_TOLERANCE):
        middle = math.sqrt(low * high)
        fits = some_train(_scaled(scene, middle), clock) is not None
        low, high = (low, middle) if fits else (middle, high)
    return low, high


def _scaled(scene: Scene, factor: float) -> Scene:
    for path in (("space", "width"), ("space", "height")):
        scene = put(scene, path, cut(times(at(scene, path), factor), 1))
    return scene


def _stiff(springs: Springs, stiffness: float) -> str:
    """Return a stiffness in the words of the limits on it."""
    text = f"{1e-3 * stiffness:.5g} N m/rad at the output"
    if springs.load_inertia is not None:
        text += f", {float(locked_frequency(stiffness, springs.load_inertia)):.5g} Hz"
    if springs.load_torque is not None:
        text += f", a windup of {math.degrees(springs.load_torque / stiffness):.4g} deg"
    return text


def _stiffest(scene: Scene, clock: Clock) -> float | None:
    """Return the maximum stiffness of a train at the output [N mm/rad]; None without any train.

    A stiffer train than the last is asked for until it is proven that there is none.
    """
    choice = scene.choice()
    assert choice.springs is not None and choice.springs.minimum is not None
    best, asked, above = None, 0.0, choice.springs.minimum
    while True:
        kept = replace(choice, springs=replace(choice.springs, minimum=asked or None)).kept
        if clock.over:
            raise TimeoutError(None)
        x = best_kept(choice.train, choice.goal, kept, math.inf, clock, some=True)
        if x is not None:
            best = float(choice.springs.output_stiffness(pairs(x, choice.train.face_width)))
        elif best is None or asked <= best * (1.0 + 2.0 * ABOVE):
            return best
        else:
            above = asked
        middle = math.sqrt(best * above) if best else 0.0
        asked = (
            middle
            if middle > (best or 0.0) * (1.0 + FACTOR_TOLERANCE)
            else (best or 0.0) * (1.0 + ABOVE)
        )
