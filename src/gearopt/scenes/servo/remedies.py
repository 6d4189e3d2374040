"""What to write instead where no train is accurate enough: found by solving, and solved again."""

from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Any

from gearopt import units
from gearopt.errors import SolveError
from gearopt.formulations.servo import impossible, split
from gearopt.formulations.servo.choice import train_problem
from gearopt.formulations.servo.servo_design import GOALS
from gearopt.formulations.servo.split.teeth import NO_TEETH
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedies, Remedy
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve, solve_within
from gearopt.scenes.explaining.numbers import times
from gearopt.scenes.servo.alone import alone, reached
from gearopt.scenes.servo.backlash import binds
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.mesh import WORDS, Mesh
from gearopt.scenes.servo.train import errors, of_point
from gearopt.units import Quantity

DIGITS = 5  # of a number that is proposed; rounded to relax the limit
FEASIBILITY_MARGIN = 1e-9  # by which a proposal is easier, to be feasible in doubles
SLACK_TRIED = 1e-3  # a remedy that much smaller must be impossible
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

Place = tuple[str, str]  # table and key
PLACES: tuple[Place, ...] = (
    ("shaft", "diameter"),
    ("space", "motor_diameter"),
    ("space", "hub_diameter"),
    ("train", "output_shaft_diameter"),
)


def remedies(scene: Scene, clock: Clock, message: str = NO_TEETH) -> Remedies:
    """Return the conflict of a train that is impossible, and what to write instead.

    message: of the search. Numbers that help alone are looked for at most PATIENCE.
    """
    if (found := binds(scene, clock)) is not None:
        return found
    found = _cause(scene, clock, message)
    if clock.over:
        return found
    assert scene.train is not None
    patience = PATIENCE[bool(GOALS[scene.train.goal].motion)]
    budget = replace(clock.left, seconds=clock.within(patience))
    within = Clock(budget, clock.watch)
    known = frozenset(change.key for way in found.remedies for change in way.changes)
    more = alone(scene, within, known)
    if found.conflict:  # their bound is of whole teeth
        more = tuple(replace(way, bound=None) for way in more)
    elif found.remedies == () and more and more[0].kind == "alone":
        tried = "not all known" if within.over else "need more"
        least = replace(more[0], kind="least", verified={**more[0].verified, "others": tried})
        more = (least, *more[1:])
    words = found.message
    if found.conflict and (kept := [KEPT[name] for name in scene.choice().apart]):
        words += f"{'; ' if words else ''}every remedy also keeps {' and '.join(kept)}"
    if within.over:
        words += "; time ran out before all numbers of the file were tried" if words else ""
    return replace(found, remedies=(*found.remedies, *more), message=words)


def _cause(scene: Scene, clock: Clock, message: str) -> Remedies:
    """Return the conflict of an impossible train, and what is proposed by its cause."""
    asked = scene.accuracy.error
    assert scene.train is not None
    if GOALS[scene.train.goal].motion:
        still = solve_within(clock, train_problem(_aiming(scene, "inertia").choice()))
        if still.status == "optimal":
            return _of_duty(scene, clock)
        if still.status != "infeasible":
            return Remedies(message=CAUSE_UNKNOWN)
        message = still.message
    rooms = blocked(scene, clock)
    if asked is None and rooms is not None:
        return rooms
    if asked is None:
        return _other(scene, message, clock)
    free = with_error(scene, units.parse(LOOSE, "angle"))
    least = solve_within(clock, train_problem(_aiming(free, "error").choice()))
    if least.status == "infeasible":
        if rooms is not None:
            return rooms
        other = _other(free, least.message, clock)
        return replace(other, message=f"{ASIDE}, {other.message}")
    if least.status != "optimal":
        return Remedies(message="time ran out before the minimum possible error was proven")
    best = units.parse(f"{least.value!r} deg", "angle")
    names = impossible.in_conflict(scene.servo_train(), clock)
    floor = impossible.minimum_error(scene.servo_train(), clock) if names else None
    bound = (floor or best.value) / asked.value
    found = [one(scene, best, bound, clock) for one in (_wider, _finer)]
    proven = tuple(r for r in found if r.verified["with"] == "optimal")
    if rooms is not None:
        return replace(rooms, remedies=(*rooms.remedies, *proven))
    return Remedies(names, proven, _message(free, least))


def _aiming(scene: Scene, aim: str) -> Scene:
    """Return the scene with another objective; those of the train alone leave the duty aside."""
    assert scene.train is not None
    train = scene.train.model_copy(update={"minimise": aim, "maximise": None})
    return scene.model_copy(update={"train": train})


def _other(scene: Scene, message: str, clock: Clock) -> Remedies:
    """Return why a train is impossible whatever its error: limits in conflict, and a sentence.

    message: of the search.
    """
    train = scene.servo_train()
    if names := impossible.in_conflict(train, clock):
        why = "real-valued teeth and modules do not meet all other limits either"
        return Remedies(names, message=why)
    if impossible.by_motion(train, clock):
        return Remedies(message=LOADED)
    if message != NO_TEETH:  # it names the box, or the stiffness
        return Remedies(message=_reached(scene, clock) or message)
    if (other := impossible.with_wider_ratio(train, clock)) is not None:
        own, ends = (_span(scene, one) for one in (train, other))
        return Remedies(message=f"no whole teeth make the ratio {own}; {ends} some do")
    return Remedies(message=CAUSE_UNKNOWN if clock.over else WHOLE)


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


def _of_duty(scene: Scene, clock: Clock) -> Remedies:
    """Return what of the duty no train keeps, where some keep all else: limits, a sentence."""
    train = scene.servo_train()
    duty = train.duty
    assert duty is not None
    names = impossible.in_conflict(train, clock, duty.goal)
    if duty.max_ratio is not None and duty.max_ratio < train.ratios[0]:
        why = f"the motor's speed limit allows a total ratio of at most {float(duty.max_ratio):.6g}"
        return Remedies(names, message=f"the cause is the duty: {why}")
    alone = solve(duty.problem())
    if alone.status == "infeasible":
        return Remedies(
            names, message=f"the cause is the duty, whatever the train: {alone.message}"
        )
    return Remedies(names, message=MOTOR)


def with_error(scene: Scene, error: Quantity) -> Scene:
    """Return the scene with another maximum error."""
    accuracy = scene.accuracy.model_copy(update={"error": error})
    return scene.model_copy(update={"accuracy": accuracy})


def _message(scene: Scene, least: Result) -> str:
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
        f"the most accurate train has an error of {least.value:.5f} deg; its largest parts "
        f"are {largest}"
    )


def _rounded(value: float, up: bool) -> str:
    context = Context(prec=DIGITS, rounding=ROUND_CEILING if up else ROUND_FLOOR)
    return f"{context.create_decimal(Decimal(value)).normalize():f}"


def _wider(scene: Scene, best: Quantity, bound: float, clock: Clock) -> Remedy:
    """Return the minimum error that can be asked for."""
    asked = scene.accuracy.error
    assert asked is not None
    scale = asked.value / float(asked.number)
    write = f"{_rounded(best.value / scale * (1.0 + FEASIBILITY_MARGIN), True)} {asked.unit}"
    less = units.parse(f"{best.value / scale * (1.0 - SLACK_TRIED)!r} {asked.unit}", "angle")
    new = units.parse(write, "angle")
    factor = new.value / asked.value
    return Remedy(
        "least",
        "accuracy.error",
        (Change("accuracy.error", f'"{asked}"', f'"{write}"', factor),),
        factor,
        bound,
        {
            "with": _status(with_error(scene, new), clock),
            "with_less": _status(with_error(scene, less), clock),
        },
    )


def _finer(scene: Scene, best: Quantity, bound: float, clock: Clock) -> Remedy:
    """Return all deviations smaller by one factor: every train's error is in proportion to it."""
    asked = scene.accuracy.error
    assert asked is not None
    part = asked.value / best.value * (1.0 - FEASIBILITY_MARGIN)
    changes = [
        Change(f"mesh[{k}].{name}", _text(was), _text(_times(was, part)), 1.0 / part)
        for k, mesh in enumerate(scene.mesh, 1)
        for name in WORDS
        if (was := getattr(mesh, name)) and (isinstance(was, tuple) or was.number > 0)
    ]
    verified = {
        "with": _status(_scaled(scene, part), clock),
        "with_less": _status(_scaled(scene, part * (1.0 + SLACK_TRIED), exact=True), clock),
    }
    return Remedy("even", "all deviations", tuple(changes), 1.0 / part, bound, verified)


def _times(was: Any, part: float) -> Any:
    """Return a deviation, or both of its allowances, times a part, rounded towards zero."""
    if isinstance(was, tuple):
        return tuple(_times(end, part) for end in was)
    size = Fraction(_rounded(abs(float(was.number)) * part, False))
    return replace(was, number=size if was.number > 0 else -size)


def _text(value: Any) -> str:
    """Return a deviation as a file writes it."""
    ends = value if isinstance(value, tuple) else (value,)
    texts = ", ".join(f'"{end}"' for end in ends)
    return f"[{texts}]" if isinstance(value, tuple) else texts


def _scaled(scene: Scene, part: float, exact: bool = False) -> Scene:
    def scaled(mesh: Mesh) -> Mesh:
        update = {}
        for name in WORDS:
            was = getattr(mesh, name)
            if isinstance(was, tuple):
                update[name] = tuple(times(e, part) for e in was) if exact else _times(was, part)
            elif was is not None and was.number > 0:
                update[name] = times(was, part) if exact else _times(was, part)
        return mesh.model_copy(update=update)

    return scene.model_copy(update={"mesh": tuple(scaled(mesh) for mesh in scene.mesh)})


def _status(scene: Scene, clock: Clock) -> str:
    return "limit" if clock.over else solve_within(clock, train_problem(scene.choice())).status


def blocked(scene: Scene, clock: Clock) -> Remedies | None:
    """Return what stands in the way; None where a train is impossible without it too."""
    blamed = impossible.in_the_way(scene.servo_train(), clock)
    if blamed is None:
        return None
    names = tuple(name for name, diameter in vars(blamed).items() if diameter > 0)
    if not names:
        return Remedies(("output_shaft",), (), COVERED)
    what = " and ".join(name.replace("_", " ") for name in names)
    message = f"no train that meets all other limits leaves room for the {what}"
    ways = _bodies(scene, clock)
    proven = tuple(way for way in ways if way.verified["with"] == "optimal")
    if clock.over:
        message += "; the budget ended before all remedies were tried"
    elif ways and not proven:
        message += "; with smaller bodies, the box, the stiffness or the duty is still not met"
    return Remedies(names, proven, message)


def _diameters(scene: Scene) -> dict[Place, Quantity]:
    """Return the diameters above zero that a file gives."""
    given = {p: getattr(getattr(scene, p[0]), p[1], None) for p in PLACES}
    return {p: q for p, q in given.items() if q is not None and q.number > 0}


def _bodies(scene: Scene, clock: Clock) -> tuple[Remedy, ...]:
    """Return each diameter alone, the smallest change first; all alike where none alone helps."""
    given = [p for p in _diameters(scene) if p != PLACES[3] or scene.space is None]
    found = [_smaller(scene, (place,), clock) for place in given]
    alone = sorted((way for way in found if way is not None), key=lambda way: way.factor)
    if alone or len(given) < 2:
        return tuple(alone)
    alike = _smaller(scene, tuple(given), clock)
    return () if alike is None else (alike,)


def _smaller(scene: Scene, places: tuple[Place, ...], clock: Clock) -> Remedy | None:
    """Return the largest part of some diameters that leaves a train; None where none does."""

    def thinner(part: float) -> Scene:
        return _thinner(scene, places, part)

    part = impossible.largest_part(lambda part: thinner(part).servo_train(), clock)
    if part is None:
        return None
    new = thinner(part)
    changes = _changes(scene, new)
    less = thinner(min(part * (1.0 + SLACK_TRIED), 1.0))
    verified = {"with": _status(new, clock), "with_less": _status(less, clock)}
    kind = "least" if len(places) == 1 else "even"
    what = ".".join(places[0]) if len(places) == 1 else "all diameters"
    factor = max(change.factor for change in changes)
    return Remedy(kind, what, changes, factor, None, verified)  # a bound is of real-valued teeth


def _thinner(scene: Scene, places: tuple[Place, ...], part: float) -> Scene:
    """Return the scene with a part of some diameters, rounded down; a hub surrounds its shaft."""
    for place in places:
        was = _diameters(scene)[place]
        number = Fraction(_rounded(float(was.number) * part, False))
        scene = _with(scene, place, replace(was, number=number))
    given = _diameters(scene)
    hub, shaft = given.get(PLACES[2]), given.get(PLACES[3])
    if hub is not None and shaft is not None and hub.value < shaft.value:
        scene = _with(scene, PLACES[3], hub)
    return scene


def _with(scene: Scene, place: Place, diameter: Quantity) -> Scene:
    table, key = place
    changed = getattr(scene, table).model_copy(update={key: diameter})
    return scene.model_copy(update={table: changed})


def _changes(before: Scene, after: Scene) -> tuple[Change, ...]:
    new = _diameters(after)
    return tuple(
        Change(".".join(p), f'"{was}"', f'"{new[p]}"', was.value / new[p].value)
        for p, was in _diameters(before).items()
        if new[p] != was
    )
