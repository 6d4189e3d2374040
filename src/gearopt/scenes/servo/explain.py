"""Remedies where no train is possible: the conflict, and the smallest changes that help."""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt import units
from gearopt.errors import SolveError
from gearopt.formulations.servo import impossible, split
from gearopt.formulations.servo.choice import train_problem
from gearopt.formulations.servo.servo_design import GOALS
from gearopt.formulations.servo.split.teeth import NO_TEETH
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedies, Remedy
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve, solve_within
from gearopt.physics.gears import SERIES_I, SERIES_II
from gearopt.scenes.explaining.engine import (
    FeasibilityQuestions,
    Group,
    singles,
    with_least,
    within,
)
from gearopt.scenes.explaining.moves import DUTY, LIMIT, Move
from gearopt.scenes.explaining.numbers import STEP_FROM_ZERO, Path, at, cut, put, times
from gearopt.scenes.reading.toml_writing import dotted, toml_text
from gearopt.scenes.servo.axis_steps import errors, of_point
from gearopt.scenes.servo.backlash import binds
from gearopt.scenes.servo.reach import possible, reached
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.mesh import WORDS
from gearopt.units import Quantity

FARTHEST_FACTOR = 1000.0  # factor up to which a limit is moved
WIDEST_FACTOR = 2.0  # the same of numbers that widen the search
MARGIN = 1.0 + 1e-9  # by which the least error is enlarged, to be feasible in doubles
# mm, as makers list them
SHAFT_DIAMETERS = tuple(Fraction(k, 20) for k in (4, 5, 6, 8, 10, 12, 14, 16, 18))
LIMITS: tuple[tuple[Path, int], ...] = (  # of a file, and the way that is easier
    (("stiffness", "frequency"), -1),
    (("stiffness", "windup"), 1),
    (("stiffness", "mesh_variation"), -1),
    (("stiffness", "load_torque"), -1),
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
ASKED = ("train", "output_torque"), ("stiffness", "load_torque")
ERROR, SHAFT, TOLERANCE = ("accuracy", "error"), ("shaft", "diameter"), ("train", "ratio_tolerance")
SIDES = ("space", "width"), ("space", "height")
DIAMETERS: tuple[Path, ...] = (
    SHAFT,
    ("space", "motor_diameter"),
    ("space", "hub_diameter"),
    ("train", "output_shaft_diameter"),
)
HUB, OUTPUT = DIAMETERS[2:]
LESS_BY = 1e-2  # relative, by which two sides move less than one, to be told
LOOSE = "90 deg"  # an error that no train misses
CAUSE_UNKNOWN = "time ran out before the cause was identified"
PATIENCE = 20.0, 5.0  # seconds, for numbers that help alone; where a duty chooses
NAMED = 3  # sources of error that the message names
ASIDE = "the cause is not the accuracy alone: even without a maximum error"
KEPT = {"stiffness": "the stiffness", "box": "[space]"}
WHOLE = (
    "real-valued teeth and modules would meet all other limits, but no whole teeth with the "
    "modules of the list do"
)
LOADED = (
    "there are trains that meet all other limits, but the torque that the motor puts on their "
    "teeth in [duty] is more than bending_stress allows"
)
MOTOR = (
    "the cause is the duty: there are trains that meet all other limits, but the motor can make "
    "the motion of [duty] with none of them"
)
COVERED = (
    "in all trains that meet all other limits the first wheel covers the output shaft, however "
    "thin that is: allow a larger last wheel, or smaller modules"
)


@dataclass(frozen=True)
class Cause:
    """Why a train is impossible.

    names: of limits in conflict; message: the cause in words. error: the least error of a train
    over the one that is asked for, and a bound of it. bodies: whether they leave no train room.
    """

    names: tuple[str, ...] = ()
    message: str = ""
    error: tuple[float, float] | None = None
    bodies: bool = False


def remedies(scene: Scene, clock: Clock, message: str = NO_TEETH) -> Remedies:
    """Conflict and remedies of a train that is impossible.

    message: of the search. Numbers beside the cause are looked for at most PATIENCE.
    """
    if (bound := binds(scene, clock)) is not None:
        return bound
    cause = cause_of(scene, clock, message)
    if clock.over:
        return Remedies(cause.names, message=cause.message)
    assert scene.train is not None
    asked = FeasibilityQuestions(scene, possible, clock, lower_bounds=not cause.names)
    single = {(move.path, move.way): move for move in moves(scene)}
    sufficient = singles(asked, _errors(scene, cause))
    blamed = [(path, -1) for path in DIAMETERS if cause.bodies and (path, -1) in single]
    sufficient += singles(asked, (Group((single[place],)) for place in blamed))
    left = within(clock, PATIENCE[bool(GOALS[scene.train.goal].motion)])
    asked = replace(asked, clock=left)
    sufficient += singles(
        asked, (Group((m,)) for place, m in single.items() if place not in blamed)
    )
    moved = {change.key for remedy in sufficient for change in remedy.changes}
    thinner = [single[path, -1] for path in DIAMETERS if (path, -1) in single]
    bodies = cause.bodies and not moved & {dotted(move.path) for move in thinner}
    if bodies and len(thinner) > 1:
        sufficient += singles(asked, [Group(tuple(thinner), what="all diameters")])
    sufficient += _both_sides(asked, single, sufficient)
    sufficient += [] if (module := _module(asked)) is None else [module]
    sentences = [cause.message] if cause.message else []
    if bodies and not left.over and not any(r.what == "all diameters" for r in sufficient):
        sentences.append("with smaller bodies, the box, the stiffness or the duty is still not met")
    if cause.names and (kept := [KEPT[name] for name in scene.choice().apart]):
        sentences.append(f"every remedy also keeps {' and '.join(kept)}")
    if left.over and sentences:
        sentences.append("time ran out before all numbers of the file were tried")
    listed = with_least(sufficient, not left.over)
    return Remedies(cause.names, listed, "; ".join(sentences))


def moves(scene: Scene) -> Iterator[Move]:
    """Yield every number of a file that may help, and the way that does."""
    for path, way in (*LIMITS, *RANGES):
        value = _given(scene, path)
        if path == HUB and value is not None and (shaft := _given(scene, OUTPUT)):
            value = None if value.value <= shaft.value else value
        if not getattr(value, "number", value):
            continue
        role = DUTY if path in ASKED else LIMIT
        far = FARTHEST_FACTOR if (path, way) in LIMITS else WIDEST_FACTOR
        yield Move(path, way, role, far=far, inherits=_given)
    if scene.train is not None and scene.train.ratio_tolerance == 0:
        steps = tuple(1.0 + float(wide / STEP_FROM_ZERO) for wide in impossible.WIDER)
        yield Move(TOLERANCE, 1, steps=steps)


def _given(scene: Scene, path: Path) -> Any:
    """Return a number of the file that may move; None where there is none.

    A single ratio has a tolerance, a range of ratios has ends.
    """
    table = getattr(scene, str(path[0]))
    if table is None or (path == TOLERANCE and table.ratio[0] != table.ratio[1]):
        return None
    if path[:2] == ("train", "ratio") and table.ratio[0] == table.ratio[1]:
        return None
    value = at(scene, path)
    return Fraction(1, 100) if path == TOLERANCE and value is None else value


def _errors(scene: Scene, cause: Cause) -> Iterator[Group]:
    """Yield the error that is asked for, and all deviations, to which errors are in proportion."""
    if cause.error is None:
        return
    factor, bound = cause.error
    yield Group((Move(("accuracy", "error"), 1),), factor, bound)
    finer = [
        Move(("mesh", k, name), -1, write=_finer, factor=_finer_by)
        for k, mesh in enumerate(scene.mesh)
        for name in WORDS
        if (was := getattr(mesh, name)) and (isinstance(was, tuple) or was.number > 0)
    ]
    yield Group(tuple(finer), factor, bound, "all deviations")


def _finer(now: Any, factor: float, move: Move) -> Any:
    """Return a deviation, or both of its allowances, divided by a factor, rounded towards zero."""
    if isinstance(now, tuple):
        return tuple(_finer(end, factor, move) for end in now)
    return cut(times(now, 1.0 / factor), 1 if now.number < 0 else -1)


def _finer_by(before: Any, after: Any) -> float:
    """Return the factor by which a deviation, or its larger allowance, became smaller."""
    ends = [
        sorted(map(abs, (float(e.number) for e in v)))
        if isinstance(v, tuple)
        else [float(v.number)]
        for v in (before, after)
    ]
    return ends[0][-1] / ends[1][-1]


def _both_sides(
    asked: FeasibilityQuestions, single: dict[Any, Move], found: list[Remedy]
) -> list[Remedy]:
    """Return both sides of the box larger by one factor, where that is less than of one alone."""
    scene = asked.scene
    if scene.space is None or not scene.space.required:
        return []
    both = tuple(single[side, 1] for side in SIDES)
    alone = [r.factor for r in found if r.what in map(dotted, SIDES)]
    return [
        remedy
        for remedy in singles(asked, [Group(both, what="both sides of the box")])
        if all(remedy.factor * (1.0 + LESS_BY) < factor for factor in alone)
    ]


def _module(asked: FeasibilityQuestions) -> Remedy | None:
    """Return the nearest module that alone, added to the list, makes a train possible.

    None for lists of diametral pitches.
    """
    path: Path = ("train", "modules")
    modules = at(asked.scene, path)
    sizes = [m.exact[0] for m in modules]
    if modules[0].reciprocal:
        return None

    def far(m: Fraction) -> float:
        return min(float(max(m, o) / min(m, o)) for o in sizes)

    series = (*SHAFT_DIAMETERS, *SERIES_I, *SERIES_II)
    others = (m for m in series if m not in sizes and far(m) <= WIDEST_FACTOR)
    for module in sorted(others, key=far):
        more = (*modules, modules[0].of(module))
        if asked.ask(put(asked.scene, path, more), possible).answer:
            was, write = (toml_text([str(m) for m in listed]) for listed in (modules, more))
            change = Change("train.modules", was, write, far(module))
            return Remedy(
                "choice", "train.modules", (change,), far(module), None, {"with": "feasible"}
            )
    return None


def cause_of(scene: Scene, clock: Clock, message: str) -> Cause:
    """Conflict of an impossible train, and its cause; message: of the search."""
    asked = scene.accuracy.error
    assert scene.train is not None
    if GOALS[scene.train.goal].motion:
        still = solve_within(clock, train_problem(_aiming(scene, "inertia").choice()))
        if still.status == "optimal":
            return _of_duty(scene, clock)
        if still.status != "infeasible":
            return Cause(message=CAUSE_UNKNOWN)
        message = still.message
    rooms = blocked(scene, clock)
    if asked is None:
        return rooms or _other(scene, message, clock)
    free = with_error(scene, units.parse(LOOSE, "angle"))
    least = solve_within(clock, train_problem(_aiming(free, "error").choice()))
    if least.status == "infeasible":
        if rooms is not None:
            return rooms
        other = _other(free, least.message, clock)
        return replace(other, message=f"{ASIDE}, {other.message}")
    if least.status != "optimal" or least.value is None:
        return Cause(message="time ran out before the minimum possible error was proven")
    factor = units.parse(f"{least.value!r} deg", "angle").value / asked.value
    if rooms is not None:
        return replace(rooms, error=(factor * MARGIN, factor))
    names = impossible.in_conflict(scene.servo_train(), clock)
    real = impossible.minimum_error(scene.servo_train(), clock) if names else None
    bound = factor if real is None else real / asked.value
    return Cause(names, _message(free, least), (factor * MARGIN, bound))


def blocked(scene: Scene, clock: Clock) -> Cause | None:
    """Cause of the conflict; None where a train is impossible without it too."""
    blamed = impossible.in_the_way(scene.servo_train(), clock)
    if blamed is None:
        return None
    names = tuple(name for name, diameter in vars(blamed).items() if diameter > 0)
    if not names:
        return Cause(("output_shaft",), COVERED)
    what = " and ".join(name.replace("_", " ") for name in names)
    return Cause(
        names, f"no train that meets all other limits leaves room for the {what}", bodies=True
    )


def _aiming(scene: Scene, aim: str) -> Scene:
    """Return the scene with another objective; those of the train alone leave the duty aside."""
    assert scene.train is not None
    train = scene.train.model_copy(update={"minimise": aim, "maximise": None})
    return scene.model_copy(update={"train": train})


def _other(scene: Scene, message: str, clock: Clock) -> Cause:
    """Return why a train is impossible whatever its error: limits in conflict, and a sentence.

    message: of the search.
    """
    train = scene.servo_train()
    if names := impossible.in_conflict(train, clock):
        why = "real-valued teeth and modules do not meet all other limits either"
        return Cause(names, message=why)
    if impossible.by_motion(train, clock):
        return Cause(message=LOADED)
    if message != NO_TEETH:  # it names the box, or the stiffness
        return Cause(message=_reached(scene, clock) or message)
    if (other := impossible.with_wider_ratio(train, clock)) is not None:
        ratio, ends = (_span(scene, one) for one in (train, other))
        return Cause(message=f"no whole teeth make the ratio {ratio}; {ends} some do")
    return Cause(message=CAUSE_UNKNOWN if clock.over else WHOLE)


def _reached(scene: Scene, clock: Clock) -> str:
    """Return how stiff a train can be and how small its box, as far as time allows."""
    try:
        return "; ".join(reached(scene, clock))
    except (TimeoutError, SolveError):
        return ""


def _span(scene: Scene, train: split.ServoTrain) -> str:
    """Return the ratios of a train as its file gives them: about a number, or a range."""
    assert scene.train is not None
    if scene.train.ratio[0] == scene.train.ratio[1]:
        return f"within {100.0 * float(train.tolerance):g} %"
    low, high = (f"{float(end):.6g}" for end in train.ratios)
    return f"between {low} and {high}"


def _of_duty(scene: Scene, clock: Clock) -> Cause:
    """Part of the duty that no train keeps, where some keep all else: limits, a sentence."""
    train = scene.servo_train()
    duty = train.duty
    assert duty is not None
    names = impossible.in_conflict(train, clock, duty.goal)
    if duty.max_ratio is not None and duty.max_ratio < train.ratios[0]:
        why = f"the motor's speed limit allows a total ratio of at most {float(duty.max_ratio):.6g}"
        return Cause(names, message=f"the cause is the duty: {why}")
    alone = solve(duty.problem())
    if alone.status == "infeasible":
        return Cause(names, message=f"the cause is the duty, whatever the train: {alone.message}")
    return Cause(names, message=MOTOR)


def with_error(scene: Scene, error: Quantity) -> Scene:
    """Return the scene with another maximum error."""
    accuracy = scene.accuracy.model_copy(update={"error": error})
    return scene.model_copy(update={"accuracy": accuracy})


def _message(scene: Scene, least: Result) -> str:
    """Return the least error of a train, and its largest parts."""
    import numpy as np

    point = np.array(
        [
            *least.design["pinion_teeth"],
            *least.design["wheel_teeth"],
            *least.design["module_mm"],
        ],
        float,
    )
    rows = sorted(errors(scene, of_point(scene, point)), key=lambda row: -row.error_deg)
    largest = ", ".join(f"{row.source} {row.error_deg:.4f} deg" for row in rows[:NAMED])
    return (
        f"with the deviations of the file the most accurate train has an error of "
        f"{least.value:.5f} deg; its largest parts are {largest}"
    )
