"""Numbers of a servo file that alone make a train possible, and how stiff or small one can be.

Every change is read by the rules of the file and searched by the kernel of `choice`, which
proves that there is no train or shows one; a number that helps is moved as little as that takes.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.servo.choice import Springs, best_kept, train_problem
from gearopt.formulations.servo.impossible import WIDER
from gearopt.formulations.servo.split.servo_train import pairs
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.solve import solve_within
from gearopt.optimise.terms import Array
from gearopt.physics.gears import SERIES_I, SERIES_II
from gearopt.physics.stiffness import locked_frequency
from gearopt.scenes.explaining.numbers import Path, apart, at, moved, put, times, written
from gearopt.scenes.reading.toml import dotted, toml_text
from gearopt.scenes.servo.scene import Scene
from gearopt.units import Quantity

DIGITS = 6  # of a number that is tried
FARTHEST_FACTOR = 1000.0  # factor up to which a limit is moved
WIDEST_FACTOR = 2.0  # the same of numbers that widen the search
FACTOR_TOLERANCE = 1e-4  # relative: between a factor that will do and one that will not
ROUND = 1e-2  # relative, by which a proposal may be easier than it must, to be short
SLACK_TRIED = 1e-3  # a remedy that much smaller must be impossible
ABOVE = 1e-9  # relative, by which a stiffer train is asked for than the stiffest known
# mm, as makers list them
SHAFT_DIAMETERS = tuple(Fraction(k, 20) for k in (4, 5, 6, 8, 10, 12, 14, 16, 18))
LIMITS: tuple[tuple[Path, int], ...] = (  # of a file, and the way that is easier
    (("stiffness", "frequency"), -1),
    (("stiffness", "windup"), 1),
    (("space", "width"), 1),
    (("space", "height"), 1),
    (("space", "motor_diameter"), -1),
    (("space", "hub_diameter"), -1),
    (("train", "bending_stress"), 1),
    (("train", "output_torque"), -1),
    (("train", "face_width"), 1),
    (("train", "output_shaft_diameter"), -1),
    (("train", "second_pinion_diameter"), -1),
    (("shaft", "diameter"), 1),
    (("shaft", "diameter"), -1),
    (("shaft", "length"), -1),
)
RANGES: tuple[tuple[Path, int], ...] = (
    (("motor", "torque"), -1),  # loads the teeth less, and may move the load no more
    (("train", "wheel_tip_diameters", 0), 1),
    (("train", "wheel_tip_diameters", 1), 1),
    (("train", "ratio_tolerance"), 1),
    (("train", "ratio", 0), -1),
    (("train", "ratio", 1), 1),
    (("train", "pinion_teeth", 0), -1),
    (("train", "pinion_teeth", 1), 1),
    (("train", "wheel_teeth"), 1),
)
ASKED = (("train", "output_torque"),)  # the duty: to ask for less


def some_train(scene: Scene, clock: Clock) -> Array | None:
    """Return any train that meets all limits, box and stiffness included; None: proven, none does.

    TimeoutError when the clock stops it.
    """
    if clock.over:
        raise TimeoutError(None)
    choice = scene.choice()
    return best_kept(choice.train, choice.goal, choice.kept, math.inf, clock, some=True)


def alone(scene: Scene, clock: Clock, known: frozenset[str]) -> tuple[Remedy, ...]:
    """Return each number that alone makes a train possible, the smallest change first.

    known: keys that are proposed already. What is found when the clock stops, or a box is not
    decided, is kept.
    """
    found: list[Remedy] = []
    try:
        for path, way in (*LIMITS, *RANGES):
            value = _given(scene, path)
            if value is None or dotted(path) in known:
                continue
            far = FARTHEST_FACTOR if (path, way) in LIMITS else WIDEST_FACTOR
            try:
                one = _moved_alone(scene, path, value, way, far, clock)
            except SolveError:  # a box that is not decided: this number is not proposed
                continue
            found += [] if one is None else [one]
        if (tolerance := _tolerance(scene, clock)) is not None:
            found.append(tolerance)
        sides = [one.factor for one in found if one.what in ("space.width", "space.height")]
        box, module = _box(scene, clock), _module(scene, clock)
        if box is not None and all(box.factor * (1.0 + ROUND) < side for side in sides):
            found.append(box)
        found += [] if module is None else [module]
    except (TimeoutError, SolveError):
        pass
    return tuple(sorted(found, key=lambda one: (one.kind != "alone", one.factor)))


def _given(scene: Scene, path: Path) -> Any:
    """Return a number of the file that may move; None where there is none.

    A single ratio has a tolerance, a range of ratios has ends.
    """
    table = getattr(scene, str(path[0]))
    if table is None or (path == ("train", "ratio_tolerance") and table.ratio[0] != table.ratio[1]):
        return None
    if path[:2] == ("train", "ratio") and table.ratio[0] == table.ratio[1]:
        return None
    value = at(scene, path)
    if path == ("train", "ratio_tolerance") and value is None:
        return Fraction(1, 100)
    return value if getattr(value, "number", value) else None


def _moved_alone(
    scene: Scene, path: Path, value: Any, way: int, far: float, clock: Clock
) -> Remedy | None:
    """Return a number moved alone as little as a train takes; None where it does not help."""
    whole = isinstance(value, int)

    def other(factor: float) -> Scene | None:
        new = times(value, factor**way)
        new = _whole(new, way) if whole else cut(new, way)
        found: Scene | None = moved(scene, path, new)
        return found

    def works(factor: float) -> bool:
        changed = other(factor)
        return changed is not None and some_train(changed, clock) is not None

    while far > 1.1 and other(far) is None:
        far = math.sqrt(far)
    if not works(far):
        return None
    low, high = 1.0, far
    while high > low * (1.0 + FACTOR_TOLERANCE):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if works(middle) else (middle, high)
    least = times(value, high**way)
    new = _whole(least, way) if whole else short(least, way)
    less = new - way if whole else cut(times(least, (1.0 - SLACK_TRIED) ** way), way)
    kind = "less" if path in ASKED else "alone"
    return _verified(scene, path, (value, new, less), (kind, low), clock)


def _whole(value: Fraction, way: int) -> int:
    return math.floor(value) if way < 0 else math.ceil(value)


def _verified(
    scene: Scene,
    path: Path,
    values: tuple[Any, Any, Any],
    kind: tuple[str, float | None],
    clock: Clock,
) -> Remedy | None:
    """Return the remedy of a number, solved again with it; None where that is no answer.

    values: as it is, as proposed, a little less. kind: with a factor proven too small.
    """
    value, new, less = values
    if (changed := moved(scene, path, new)) is None:
        return None
    status = solve_within(clock, train_problem(changed.choice())).status
    back = moved(scene, path, less)
    verified = {"with": status, "rounded": f"by up to {100 * ROUND:g} %"}
    if back is not None:
        verified["with_less"] = "infeasible" if some_train(back, clock) is None else "feasible"
    was, write = (toml_text(written(v, path)) for v in (value, new))
    change = Change(dotted(path), was, write, apart(value, new))
    if status != "optimal":
        return None
    return Remedy(kind[0], change.key, (change,), change.factor, kind[1], verified)


def short(value: Any, way: int) -> Any:
    """Return a number with as few digits as it may have, rounded to relax the limit."""
    for digits in range(1, DIGITS):
        found = cut(value, way, digits)
        if apart(value, found) <= 1.0 + ROUND:
            return found
    return cut(value, way)


def cut(value: Any, way: int, digits: int = DIGITS) -> Any:
    """Return a quantity or fraction of so many digits, rounded up (+1) or down (-1)."""
    number = value.number if isinstance(value, Quantity) else value
    context = Context(prec=digits, rounding=ROUND_CEILING if way > 0 else ROUND_FLOOR)
    found = Fraction(context.divide(Decimal(number.numerator), Decimal(number.denominator)))
    return replace(value, number=found) if isinstance(value, Quantity) else found


def _box(scene: Scene, clock: Clock) -> Remedy | None:
    """Return both sides of the box larger by one factor."""
    if scene.space is None or not scene.space.required:
        return None
    paths: tuple[Path, ...] = (("space", "width"), ("space", "height"))
    least = smallest_scale(scene, clock)
    if least is None:
        return None
    changes, larger = [], scene
    for path in paths:
        was = at(scene, path)
        new = short(times(was, least[1]), 1)
        larger = put(larger, path, new)
        factor = float(new.value / was.value)
        changes.append(Change(dotted(path), f'"{was}"', f'"{new}"', factor))
    status = solve_within(clock, train_problem(larger.choice())).status
    if status != "optimal":
        return None
    less = some_train(_scaled(scene, least[1] * (1.0 - SLACK_TRIED)), clock)
    verified = {"with": status, "rounded": f"by up to {100 * ROUND:g} %"}
    verified["with_less"] = "infeasible" if less is None else "feasible"
    factor = max(change.factor for change in changes)
    return Remedy("alone", "both sides of the box", tuple(changes), factor, least[0], verified)


def _scaled(scene: Scene, factor: float) -> Scene:
    for path in (("space", "width"), ("space", "height")):
        scene = put(scene, path, cut(times(at(scene, path), factor), 1))
    return scene


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


def _tolerance(scene: Scene, clock: Clock) -> Remedy | None:
    """Return the smallest tolerance of `WIDER` that whole teeth meet, of a ratio without any."""
    path: Path = ("train", "ratio_tolerance")
    if scene.train is None or scene.train.ratio_tolerance != 0:
        return None
    for k, wide in enumerate(WIDER):
        if some_train(put(scene, path, wide), clock) is not None:
            less = WIDER[k - 1] if k else wide / 10
            return _verified(scene, path, (Fraction(0), wide, less), ("alone", None), clock)
    return None


def _module(scene: Scene, clock: Clock) -> Remedy | None:
    """Return the nearest module that alone, added to the list, makes a train possible.

    None for lists of diametral pitches.
    """
    assert scene.train is not None
    own = scene.train.modules
    sizes = [m.exact[0] for m in own]
    if own[0].reciprocal:
        return None

    def far(m: Fraction) -> float:
        return min(float(max(m, o) / min(m, o)) for o in sizes)

    others = [
        m
        for m in (*SHAFT_DIAMETERS, *SERIES_I, *SERIES_II)
        if m not in sizes and far(m) <= WIDEST_FACTOR
    ]
    for module in sorted(others, key=far):
        larger = put(scene, ("train", "modules"), (*own, own[0].of(module)))
        if some_train(larger, clock) is None:
            continue
        status = solve_within(clock, train_problem(larger.choice())).status
        was, write = (
            "[" + ", ".join(f'"{m}"' for m in series) + "]"
            for series in (own, (*own, own[0].of(module)))
        )
        change = Change("train.modules", was, write, far(module))
        verified = {"with": status}
        found = Remedy("choice", "train.modules", (change,), change.factor, None, verified)
        return found if status == "optimal" else None
    return None


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
        found = smallest_scale(scene, clock)
        if found is not None:
            sides = scene.space.width, scene.space.height
            there, too_small = (
                " x ".join(str(cut(times(side, f), way, 4)) for side in sides)
                for f, way in ((found[1], 1), (found[0], -1))
            )
            yield (
                f"the smallest box of these proportions that holds a train is {there}; it "
                f"is proven that none fits in {too_small}"
            )


def _stiff(springs: Springs, stiffness: float) -> str:
    """Return a stiffness in the words of the limits on it."""
    text = f"{1e-3 * stiffness:.5g} N m/rad at the output"
    if springs.load_inertia is not None:
        text += f", {float(locked_frequency(stiffness, springs.load_inertia)):.5g} Hz"
    if springs.load_torque is not None:
        text += f", a wind-up of {math.degrees(springs.load_torque / stiffness):.4g} deg"
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
