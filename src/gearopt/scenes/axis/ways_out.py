"""What to write instead where no train is accurate enough: found by solving, and solved again."""

import math
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction

from gearopt import units
from gearopt.formulations import split
from gearopt.formulations.split.exact import NO_TEETH
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.explaining.handles import handles
from gearopt.optimise.explaining.repair import Clock, conflict
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve
from gearopt.scenes.axis.choice import posed
from gearopt.scenes.axis.gears import errors, of_point
from gearopt.scenes.tables.servo import Scene
from gearopt.scenes.tables.servo_mesh import WORDS, Mesh
from gearopt.units import Quantity

DIGITS = 5  # of a number that is proposed; rounded to the easy side
ROOM = 1e-9  # by which a proposal is easier, to be feasible in doubles
BACK = 1e-3  # a remedy that much smaller must be impossible
LOOSE = "90 deg"  # an error that no train misses
WIDER = tuple(Fraction(1, 10**k) for k in range(6, 0, -1))  # ratio tolerances that are tried
NAMED = 3  # sources of error that the message names


def ways_out(scene: Scene, clock: Clock) -> tuple[tuple[str, ...], tuple[Remedy, ...], str]:
    """Limits in conflict, remedies and a message for a train that is impossible."""
    asked = scene.accuracy.error
    assert asked is not None and scene.train is not None
    free = with_error(scene, units.parse(LOOSE, "angle"))
    assert free.train is not None
    aim = free.train.model_copy(update={"minimise": "error"})
    least = _solved(free.model_copy(update={"train": aim}), clock)
    if least.status == "infeasible":
        names, message = _other(free, least, clock)
        return names, (), f"it is not for the accuracy: {message}"
    if least.status != "optimal":
        return (), (), "time ran out before the least possible error was proven"
    best = units.parse(f"{least.value!r} deg", "angle")
    names, floor = _conflict(scene, clock)
    bound = (floor or best.value) / asked.value
    found = [ways(scene, best, bound, clock) for ways in (_wider, _finer)]
    proven = tuple(r for r in found if r.verified["with"] == "optimal")
    return names, proven, _message(free, least)


def _solved(scene: Scene, clock: Clock) -> Result:
    """The train of a scene within what is left; a run that the user stops ends the rest too."""
    result = solve(posed(scene), budget=clock.left, watch=clock.watch)
    clock.stopped = clock.stopped or result.status == "limit"
    return result


def _conflict(scene: Scene, clock: Clock) -> tuple[tuple[str, ...], float | None]:
    """Limits that real-valued teeth and modules do not keep either, and their least error [rad].

    Nothing where they keep all of them.
    """
    train = scene.servo_train()
    names = _blamed(train, clock)
    if not names:
        return (), None
    return names, clock.solve(split.relaxation(replace(train, error=math.pi), "error")).bound


def _blamed(train: split.ServoTrain, clock: Clock) -> tuple[str, ...]:
    """Limits that no real-valued teeth and modules keep together, none of them to spare."""
    relaxed = split.relaxation(train, "error")
    if clock.solve(relaxed).status != "infeasible":
        return ()
    return tuple(handle.name for handle in conflict(relaxed, handles(relaxed), clock))


def _other(scene: Scene, least: Result, clock: Clock) -> tuple[tuple[str, ...], str]:
    """What makes a train impossible whatever its error: limits in conflict, and a sentence."""
    train = scene.servo_train()
    if names := _blamed(train, clock):
        return names, "real-valued teeth and modules do not keep all other limits either"
    if least.message != NO_TEETH:  # it names the box, or the stiffness
        return (), least.message
    own = train.tolerance
    for wider in WIDER:
        if wider <= own:
            continue
        problem = split.problem(replace(train, tolerance=wider), "error")
        if clock.over or solve(problem, budget=clock.left, watch=clock.watch).status != "optimal":
            continue
        ends = [f"{100.0 * float(part):g} %" for part in (own, wider)]
        return (), f"no whole teeth make the ratio within {ends[0]}; within {ends[1]} some do"
    return (), (
        "real-valued teeth and modules keep all other limits, whole teeth and the modules of the "
        "list do not"
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
    rows = sorted(errors(scene, of_point(point)), key=lambda row: -row["error_deg"])
    largest = ", ".join(f"{row['source']} {row['error_deg']:.4f} deg" for row in rows[:NAMED])
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
    return "limit" if clock.over else _solved(scene, clock).status
