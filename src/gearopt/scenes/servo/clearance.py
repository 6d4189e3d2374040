"""What to write instead where no train keeps clear of shafts, hub and motor."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Any

from gearopt.formulations.servo import split
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.solve import solve_within
from gearopt.scenes.servo.scene import Scene
from gearopt.units import Quantity

DIGITS = 5  # of a diameter that is proposed, rounded down
CLOSE = 1e-7  # relative: between the largest diameter that leaves a train, and the least that none
THIN = 1e-6  # part of a diameter below which it is no way out
BACK = 1e-3  # a remedy that much smaller must be impossible
COVERED = (
    "in all trains that keep all other limits the first wheel covers the output shaft, however "
    "thin that is: allow a larger last wheel, or smaller modules"
)


@dataclass(frozen=True)
class Blocked:
    """Bodies that leave no train room, the diameters that would, and a message."""

    conflict: tuple[str, ...]
    remedies: tuple[Remedy, ...]
    message: str


def blocked(scene: Scene, clock: Clock, status: Callable[[Scene], str]) -> Blocked | None:
    """What stands in the way; None where a train is impossible without it too.

    status: of the train of a scene, with its stiffness and its box.
    """
    train = scene.servo_train()
    if train.bodies is None or _status(train, clock) != "infeasible":
        return None
    if _status(replace(train, bodies=None), clock) != "optimal":
        return None
    blamed = train.bodies
    for name in ("shaft", "motor", "output_shaft"):
        none: dict[str, Any] = {name: Fraction(0)}
        thinner = replace(blamed, **none)
        if _status(replace(train, bodies=thinner), clock) == "infeasible":
            blamed = thinner
    names = tuple(name for name, diameter in vars(blamed).items() if diameter > 0)
    if not names:
        return Blocked(("output_shaft",), (), COVERED)
    what = " and ".join(name.replace("_", " ") for name in names)
    message = f"no train that keeps all other limits leaves room for the {what}"
    ways = _ways(scene, clock, status)
    proven = tuple(way for way in ways if way.verified["with"] == "optimal")
    if clock.over:
        message += "; time ran out before all ways out were tried"
    elif ways and not proven:
        message += "; with less in the way, box, stiffness or duty stay out of reach"
    return Blocked(names, proven, message)


def _status(train: split.ServoTrain, clock: Clock) -> str:
    """Status of a train in any box, whatever its duty; a run that the user stops ends the rest."""
    if clock.over:
        return "limit"
    return solve_within(clock, split.problem(train)).status


Place = tuple[str, str]  # table and key
PLACES: tuple[Place, ...] = (
    ("shaft", "diameter"),
    ("space", "motor_diameter"),
    ("space", "hub_diameter"),
    ("train", "output_shaft_diameter"),
)


def _diameters(scene: Scene) -> dict[Place, Quantity]:
    """The diameters that a file gives, above zero."""
    given = {p: getattr(getattr(scene, p[0]), p[1], None) for p in PLACES}
    return {p: q for p, q in given.items() if q is not None and q.number > 0}


def _ways(scene: Scene, clock: Clock, status: Callable[[Scene], str]) -> tuple[Remedy, ...]:
    """Each diameter alone, the least change first; all of them alike where none alone helps."""
    given = [p for p in _diameters(scene) if p != PLACES[3] or scene.space is None]
    found = [_smaller(scene, (place,), clock, status) for place in given]
    alone = sorted((way for way in found if way is not None), key=lambda way: way.factor)
    if alone or len(given) < 2:
        return tuple(alone)
    alike = _smaller(scene, tuple(given), clock, status)
    return () if alike is None else (alike,)


def _smaller(
    scene: Scene, places: tuple[Place, ...], clock: Clock, status: Callable[[Scene], str]
) -> Remedy | None:
    """The largest part of some diameters that leaves a train, by halving; None where none does."""

    def leaves(part: float) -> bool:
        return _status(_scaled(scene, places, part).servo_train(), clock) == "optimal"

    low, high = THIN, 1.0
    if not leaves(low):
        return None
    while high - low > CLOSE * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if leaves(middle) else (low, middle)
    if clock.over:
        return None
    new = _scaled(scene, places, low)
    changes = _changes(scene, new)
    verified = {
        "with": status(new),
        "with_less": status(_scaled(scene, places, min(low * (1.0 + BACK), 1.0))),
    }
    kind = "least" if len(places) == 1 else "even"
    what = ".".join(places[0]) if len(places) == 1 else "all diameters"
    factor = max(change.factor for change in changes)
    return Remedy(kind, what, changes, factor, None, verified)  # a bound is of real-valued teeth


def _scaled(scene: Scene, places: tuple[Place, ...], part: float) -> Scene:
    """The scene with a part of some diameters, rounded down; a hub stays around its shaft."""
    context = Context(prec=DIGITS, rounding=ROUND_FLOOR)
    for place in places:
        was = _diameters(scene)[place]
        number = Fraction(context.create_decimal(Decimal(float(was.number) * part)))
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
