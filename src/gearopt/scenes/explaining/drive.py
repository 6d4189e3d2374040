"""`explain` for drives: remedies as edits of the file, influences of every number in it."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gearopt.formulations import sizing
from gearopt.formulations.teeth.search import possible
from gearopt.formulations.train import Train
from gearopt.optimise.elastic import Handle, handles
from gearopt.optimise.explain import TAKEN_BACK, slopes
from gearopt.optimise.explanation import Change, Influence, Remedy
from gearopt.optimise.problem import Problem
from gearopt.optimise.repair import Clock, Repair, families, impossible
from gearopt.optimise.result import Result
from gearopt.optimise.sensitivity import sensitivities
from gearopt.optimise.terms import Array
from gearopt.physics.modules import MODULES
from gearopt.scenes.explaining.cures import FIELDS, Cure, cure, less
from gearopt.scenes.explaining.numbers import Number, eased, numbers, put, times

if TYPE_CHECKING:
    from gearopt.scenes.drive import Scene

WIDEST = (1.02, 1.1, 1.3, 2.0, 4.0)  # extra factors that are tried for whole teeth, in turn
CLOSE = 1.0 + 0.5 * TAKEN_BACK  # ratio of an impossible to a possible factor that ends a search
LEAST = 1.0 + 1e-7  # a search between two factors this close ends in any case
SECONDS = 2.0  # at most, for one question whether whole teeth are possible
SMALL = 1e-5  # of ln input: the step for how parameters follow from the numbers of the file
EASE = 0.01  # the step whose price is told; one for teeth


def remedies(scene: "Scene", clock: Clock) -> tuple[tuple[str, ...], tuple[Remedy, ...]]:
    """The conflict and the ways out of an impossible drive, those of smallest change first.

    Empty where time ran out first.
    """
    base = sizing.problem(scene.train())
    movable = [
        replace(h, reach=reach, whole="teeth" in h.family)
        for h in handles(base)
        if (reach := _reach(scene, h)) > 1.0
    ]
    conflict, repairs = impossible(base, clock, movable)
    if not repairs and scene.teeth is not None:  # possible but for whole teeth
        repairs = [
            Repair("even", 1.0, 1.0, tuple((h, 1.0) for h in family))
            for family in families(movable).values()
        ]
    wider = [list(conflict), [h for h in movable if not h.given]]
    tried = [_remedy(scene, repair, wider, clock) for repair in repairs]
    found = [remedy for remedy in tried if remedy is not None]
    if scene.teeth is not None:
        found += _choices(scene, clock)
    return tuple(h.name for h in conflict), tuple(found)


def _reach(scene: "Scene", handle: Handle) -> float:
    """The largest factor by which the file's rules let a limit move; 1 where they do not."""
    if cure(scene, [(handle, handle.reach)]) is not None:
        return handle.reach
    low, high = 1.0, handle.reach
    while high > low * CLOSE:
        middle = math.sqrt(low * high)
        refused = cure(scene, [(handle, middle)]) is None
        low, high = (low, middle) if refused else (middle, high)
    return low


def _remedy(
    scene: "Scene", repair: Repair, wider: Sequence[Sequence[Handle]], clock: Clock
) -> Remedy | None:
    """A repair as edits, large enough for whole teeth where the file has them; None if none is.

    wider: limits to move as well where those of a least repair do not suffice for whole teeth.
    """
    found = _for_teeth(scene, repair, wider, clock)
    if found is None:
        return None
    moves, cured = found
    each = (
        range(len(cured.changes)) if repair.kind == "least" and moves == repair.moves else (None,)
    )
    words = {_status(less(scene, cured, TAKEN_BACK, k), clock) for k in each}
    product = math.prod(f for _, f in moves)
    return Remedy(
        "less" if all(_is_duty(h) for h, _ in moves) else repair.kind,
        ", ".join(dict.fromkeys(h.family for h, _ in moves)),
        cured.changes,
        product if repair.kind == "least" else max(f for _, f in moves),
        repair.bound,
        {
            "with": _status(cured.scene, clock),
            "with_less": words.pop() if len(words) == 1 else "mixed",
        },
    )


def _is_duty(handle: Handle) -> bool:
    return handle.given and handle.family not in FIELDS


def _status(scene: "Scene", clock: Clock) -> str:
    """What a scene's answer would be: a status, or "undecided"."""
    sized = clock.solve(sizing.problem(scene.train())).status
    if scene.teeth is None or sized == "infeasible":
        return sized
    found = _possible(scene.train(), clock)
    return "undecided" if found is None else ("feasible" if found else "infeasible")


def _possible(train: Train, clock: Clock) -> bool | None:
    if clock.over:
        return None
    left = clock.left.seconds
    return possible(train, SECONDS if left is None else min(SECONDS, left), clock.watch)


def _for_teeth(
    scene: "Scene", repair: Repair, wider: Sequence[Sequence[Handle]], clock: Clock
) -> tuple[tuple[tuple[Handle, float], ...], Cure] | None:
    """The moves of a repair, enlarged until whole teeth exist, and the cure they make."""
    known = {h for h, _ in repair.moves}
    also = [()] if repair.kind != "least" else [(), *wider]
    for handles_ in also:
        moves = repair.moves + tuple((h, 1.0) for h in handles_ if h not in known)
        extra = 1.0 if scene.teeth is None else _extra(scene, moves, clock)
        if extra is not None:
            moves = tuple((h, f * extra) for h, f in moves)
            cured = cure(scene, moves)
            return None if cured is None else (moves, cured)
    return None


def _extra(scene: "Scene", moves: Sequence[tuple[Handle, float]], clock: Clock) -> float | None:
    """The least common factor beyond a continuous repair with which whole teeth are possible."""

    def works(extra: float, back: float = 0.0) -> bool | None:
        cured = cure(scene, [(h, f * extra) for h, f in moves])
        if cured is None:
            return None
        return _possible((less(scene, cured, back) if back else cured.scene).train(), clock)

    found = works(1.0)
    low, high = 1.0, 1.0
    for high in () if found else WIDEST:
        found = works(high)
        if found is not False:
            break
        low = high
    if not found:
        return None
    while high > low * CLOSE or (high > low * LEAST and works(high, TAKEN_BACK)):
        middle = math.sqrt(low * high)
        found = works(middle)
        if found is None:
            return None
        low, high = (low, middle) if found else (middle, high)
    return high


def _choices(scene: "Scene", clock: Clock) -> Iterator[Remedy]:
    """Switches of [teeth] that suffice alone: hunting teeth off, both series of modules."""
    teeth = scene.teeth
    assert teeth is not None
    both = MODULES["ISO 54 I+II"]
    ways: list[tuple[str, str, str, dict[str, Any]]] = []
    if teeth.coprime:
        ways.append(("coprime", "true", "false", {"coprime": False}))
    if not set(both) <= set(teeth.modules):
        written = next((f'"{n}"' for n, s in MODULES.items() if s == teeth.modules), "a list")
        ways.append(("modules", written, '"ISO 54 I+II"', {"modules": both}))
    for field, was, write, update in ways:
        other = scene.model_copy(update={"teeth": teeth.model_copy(update=update)})
        if _possible(other.train(), clock):
            change = Change(f"teeth.{field}", was, write, 1.0)
            yield Remedy("choice", field, (change,), 1.0, None, {"with": "feasible"})


def influences(
    scene: "Scene", result: Result, ideal: Array | None, clock: Clock, solved: Any
) -> Iterator[Influence]:
    """What every number of the file does to the objective.

    Sensitivities are those of real-valued sizes (at the point `ideal` of their problem; None: none
    known); prices are of the drive as it is: solved(scene) -> objective, or None.
    """
    base = sizing.problem(scene.train())
    slope = None if ideal is None else sensitivities(base, ideal)
    value = None if ideal is None else float(base.batch(ideal[None]).F[0, 0])
    for number in numbers(scene):
        if clock.over:
            return
        if number.path[:2] == ("teeth", "modules") and _is_series(scene):
            continue

        def resolved(factor: float, number: Number = number) -> float | None:
            moved = put(scene, number.path, times(number.value, factor))
            return clock.solve(sizing.problem(moved.train())).value

        step, price = _price(scene, number, result, solved)
        yield Influence(
            number.key,
            number.text,
            None
            if slope is None or not _relative(number)
            else _chained(scene, number, base, slope),
            (None, None) if value is None or not _relative(number) else slopes(value, resolved),
            step,
            price,
        )


def _relative(number: Number) -> bool:
    """Whether a relative change of a number means anything: zero has none."""
    return bool(getattr(number.value, "number", number.value))


def _is_series(scene: "Scene") -> bool:
    return scene.teeth is not None and scene.teeth.modules in MODULES.values()


def _chained(scene: "Scene", number: Number, base: Problem, slope: Any) -> float:
    """D ln objective / d ln number, through the parameters and given sizes that follow from it."""
    import numpy as np

    ends = [
        sizing.problem(put(scene, number.path, times(number.value, math.exp(s))).train())
        for s in (-SMALL, SMALL)
    ]
    lower, upper, _ = base.bounds()
    given = lower == upper
    with np.errstate(invalid="ignore", divide="ignore"):
        below, above = (np.log(e.parameter_values()) for e in ends)
        rates = np.nan_to_num((above - below) / (2 * SMALL))
        sizes = [np.where(given, e.bounds()[0], 1.0) for e in ends]
        moves = np.log(sizes[1] / sizes[0]) / (2 * SMALL)
    return float(slope.parameters @ rates + slope.columns @ moves) + 0.0


def _price(scene: "Scene", number: Number, result: Result, solved: Any) -> tuple[str, float | None]:
    """The step that eases a limit of the file, and what it brings; "" for what is no limit."""
    direction = _eases(number)
    if direction == 0 or result.value is None:
        return "", None
    factor = 1.0 + (EASE if not isinstance(number.value, int) else 0.5 / number.value)
    value = eased(number.value, factor, direction)
    step = f"{direction:+d}" if isinstance(number.value, int) else f"{direction * EASE:+.0%}"
    found = solved(put(scene, number.path, value))
    return step, None if found is None else found / result.value - 1.0


def _eases(number: Number) -> int:
    """+1 or -1: the direction that eases a limit of the file; 0 for what is no limit."""
    path = number.path
    if path == ("duty", "ratio_tolerance"):
        return 1 if number.value else 0
    end = path[-1] if isinstance(path[-1], int) else None
    field = path[-2] if end is not None else path[-1]
    for name, place in FIELDS.items():
        if place == (field, end) and path[0] in ("limits", "stage", "gears"):
            ranged = end is not None or name in ("k_factor", "unit_load", "wheel_diameter")
            return 0 if not ranged else (-1 if end == 0 else 1)
    return 0
