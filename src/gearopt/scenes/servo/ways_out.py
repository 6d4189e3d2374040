"""What to write instead where no train is accurate enough: found by solving, and solved again."""

import math
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction

from gearopt import units
from gearopt.formulations.servo import split
from gearopt.formulations.servo.choice import train_problem
from gearopt.formulations.servo.ratio.duty import UNITS
from gearopt.formulations.servo.split.exact import NO_TEETH
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.explaining.handles import handles
from gearopt.optimise.explaining.repair import conflict
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve, solve_within
from gearopt.scenes.servo.clearance import blocked
from gearopt.scenes.servo.gears import errors, of_point
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.mesh import WORDS, Mesh
from gearopt.units import Quantity

DIGITS = 5  # of a number that is proposed; rounded to the easy side
ROOM = 1e-9  # by which a proposal is easier, to be feasible in doubles
BACK = 1e-3  # a remedy that much smaller must be impossible
LOOSE = "90 deg"  # an error that no train misses
WIDER = tuple(Fraction(1, 10**k) for k in range(6, 0, -1))  # ratio tolerances that are tried
LATE = "time ran out before it was known why"
NAMED = 3  # sources of error that the message names


def ways_out(
    scene: Scene, clock: Clock, told: str = NO_TEETH
) -> tuple[tuple[str, ...], tuple[Remedy, ...], str]:
    """Limits in conflict, remedies and a message for a train that is impossible.

    told: what the search said of it.
    """
    asked = scene.accuracy.error
    assert scene.train is not None
    if scene.train.goal in UNITS:
        still = solve_within(clock, train_problem(_aiming(scene, "inertia").choice()))
        if still.status == "optimal":
            names, message = _of_duty(scene, clock)
            return names, (), message
        if still.status != "infeasible":
            return (), (), LATE
        told = still.message
    rooms = blocked(scene, clock, lambda other: _status(other, clock))
    if asked is None and rooms is not None:
        return rooms.conflict, rooms.remedies, rooms.message
    if asked is None:
        names, message = _other(scene, told, clock)
        return names, (), message
    free = with_error(scene, units.parse(LOOSE, "angle"))
    least = solve_within(clock, train_problem(_aiming(free, "error").choice()))
    if least.status == "infeasible":
        if rooms is not None:
            return rooms.conflict, rooms.remedies, rooms.message
        names, message = _other(free, least.message, clock)
        return names, (), f"it is not for the accuracy: {message}"
    if least.status != "optimal":
        return (), (), "time ran out before the least possible error was proven"
    best = units.parse(f"{least.value!r} deg", "angle")
    names, floor = _conflict(scene, clock)
    bound = (floor or best.value) / asked.value
    found = [ways(scene, best, bound, clock) for ways in (_wider, _finer)]
    proven = tuple(r for r in found if r.verified["with"] == "optimal")
    if rooms is not None:
        return rooms.conflict, (*rooms.remedies, *proven), rooms.message
    return names, proven, _message(free, least)


def _aiming(scene: Scene, aim: str) -> Scene:
    """The scene with another objective; those of the train alone leave the duty aside."""
    assert scene.train is not None
    train = scene.train.model_copy(update={"minimise": aim, "maximise": None})
    return scene.model_copy(update={"train": train})


def _conflict(scene: Scene, clock: Clock) -> tuple[tuple[str, ...], float | None]:
    """Limits that real-valued teeth and modules do not keep either, and their least error [rad].

    Nothing where they keep all of them.
    """
    train = scene.servo_train()
    names = _blamed(train, clock)
    if not names:
        return (), None
    relaxed = split.relaxation(replace(train, error=math.pi), "error")
    return names, solve_within(clock, relaxed).bound


def _blamed(train: split.ServoTrain, clock: Clock, goal: str = "") -> tuple[str, ...]:
    """Limits that no real-valued teeth and modules keep together, none of them to spare."""
    known = "error" if train.lost_motion is not None else "inertia"
    relaxed = split.relaxation(train, goal or known)
    if solve_within(clock, relaxed).status != "infeasible":
        return ()
    return tuple(handle.name for handle in conflict(relaxed, handles(relaxed), clock))


def _other(scene: Scene, told: str, clock: Clock) -> tuple[tuple[str, ...], str]:
    """What makes a train impossible whatever its error: limits in conflict, and a sentence.

    told: what the search said.
    """
    train = scene.servo_train()
    if names := _blamed(train, clock):
        return names, "real-valued teeth and modules do not keep all other limits either"
    if told != NO_TEETH:  # it names the box, or the stiffness
        return (), told
    for wider in WIDER:
        if wider <= train.tolerance:
            continue
        other = replace(train, tolerance=wider)
        problem = split.problem(other, "inertia")
        if clock.over or solve_within(clock, problem).status != "optimal":
            continue
        own, ends = (_span(scene, one) for one in (train, other))
        return (), f"no whole teeth make the ratio {own}; {ends} some do"
    if clock.over:
        return (), LATE
    return (), (
        "real-valued teeth and modules keep all other limits, whole teeth and the modules of the "
        "list do not"
    )


def _span(scene: Scene, train: split.ServoTrain) -> str:
    """The ratios of a train as its file gives them: about a number, or from one to another."""
    assert scene.train is not None
    if scene.train.ratio[0] == scene.train.ratio[1]:
        return f"within {100.0 * float(train.tolerance):g} %"
    low, high = (f"{float(end):.6g}" for end in train.ratios)
    return f"between {low} and {high}"


def _of_duty(scene: Scene, clock: Clock) -> tuple[tuple[str, ...], str]:
    """What of the duty no train keeps, where some keep all else: limits, and a sentence."""
    train = scene.servo_train()
    duty = train.duty
    assert duty is not None
    names = _blamed(train, clock, duty.goal)
    if duty.most_ratio is not None and duty.most_ratio < train.ratios[0]:
        why = f"the motor's speed limit allows a total ratio of {float(duty.most_ratio):.6g}"
        return names, f"it is for the duty: {why} at the most"
    alone = solve(duty.problem())
    if alone.status == "infeasible":
        return names, f"it is for the duty, whatever the train: {alone.message}"
    return names, (
        "it is for the duty: trains keep all other limits, but the motor does not do what [duty] "
        "asks with any of them"
    )


def with_error(scene: Scene, error: Quantity) -> Scene:
    """The scene with another largest error."""
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
        f"the most accurate train has an error of {least.value:.5f} deg; of it the largest parts "
        f"are {largest}"
    )


def _rounded(value: float, up: bool) -> str:
    context = Context(prec=DIGITS, rounding=ROUND_CEILING if up else ROUND_FLOOR)
    return f"{context.create_decimal(Decimal(value)).normalize():f}"


def _wider(scene: Scene, best: Quantity, bound: float, clock: Clock) -> Remedy:
    """The least error that can be asked for."""
    asked = scene.accuracy.error
    assert asked is not None
    scale = asked.value / float(asked.number)
    write = f"{_rounded(best.value / scale * (1.0 + ROOM), True)} {asked.unit}"
    less = units.parse(f"{best.value / scale * (1.0 - BACK)!r} {asked.unit}", "angle")
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
    """All deviations smaller by one factor: the error of every train is in proportion to them."""
    asked = scene.accuracy.error
    assert asked is not None
    part = asked.value / best.value * (1.0 - ROOM)
    changes = [
        Change(f"mesh[{k}].{name}", f'"{was}"', f'"{_times(was, part)}"', 1.0 / part)
        for k, mesh in enumerate(scene.mesh, 1)
        for name in WORDS
        if (was := getattr(mesh, name)) is not None and was.number > 0
    ]
    verified = {
        "with": _status(_scaled(scene, part), clock),
        "with_less": _status(_scaled(scene, part * (1.0 + BACK), exact=True), clock),
    }
    return Remedy("even", "all deviations", tuple(changes), 1.0 / part, bound, verified)


def _times(was: Quantity, part: float) -> str:
    return f"{_rounded(float(was.number) * part, False)} {was.unit}"


def _scaled(scene: Scene, part: float, exact: bool = False) -> Scene:
    def scaled(mesh: Mesh) -> Mesh:
        update = {}
        for name in WORDS:
            was = getattr(mesh, name)
            if was is not None and was.number > 0:
                text = f"{float(was.number) * part!r} {was.unit}" if exact else _times(was, part)
                update[name] = units.parse(text, "length")
        return mesh.model_copy(update=update)

    return scene.model_copy(update={"mesh": tuple(scaled(mesh) for mesh in scene.mesh)})


def _status(scene: Scene, clock: Clock) -> str:
    return "limit" if clock.over else solve_within(clock, train_problem(scene.choice())).status
