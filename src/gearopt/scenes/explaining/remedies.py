"""Ways out of an impossible drive, as edits of its file that were tried before they are told."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from gearopt.formulations import sizing
from gearopt.formulations.teeth.search import possible
from gearopt.formulations.train import Train
from gearopt.optimise.explaining.explain import TAKEN_BACK, THERE
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.explaining.handles import Handle, handles
from gearopt.optimise.explaining.repair import SAME, Clock, Repair, families, impossible
from gearopt.physics.modules import MODULES
from gearopt.scenes.explaining.cures import FIELDS, Cure, cure, less, tolerance_factor
from gearopt.scenes.explaining.numbers import eased, put, written
from gearopt.scenes.reading.toml import dotted, toml_text
from gearopt.scenes.tables.drive import Scene

WIDEST = (1.02, 1.1, 1.3, 2.0, 4.0)  # extra factors that are tried for whole teeth, in turn
CLOSE = 1.0 + 0.5 * TAKEN_BACK  # ratio of an impossible to a possible factor that ends a search
LEAST = 1.0 + 1e-7  # a search between two factors this close ends in any case
SECONDS = 2.0  # at most, for one question whether whole teeth are possible
TOLERANCES = (Fraction(1, 10**5), Fraction(1, 2))  # tried where the file allows none

Moves = tuple[tuple[Handle, float], ...]


@dataclass(frozen=True)
class Ways:
    """conflict: names of limits that cannot hold together; remedies; message: what is missing."""

    conflict: tuple[str, ...] = ()
    remedies: tuple[Remedy, ...] = ()
    message: str = ""


def remedies(scene: Scene, clock: Clock) -> Ways:
    """The conflict and the ways out of an impossible drive, the least change first.

    Every remedy was tried: a design exists with it.
    """
    base = sizing.problem(scene.train())
    movable = [
        replace(h, reach=reach, whole="teeth" in h.family)
        for h in handles(base)
        if (reach := _reach(scene, h)) > 1.0
    ]
    everything = [h for h in handles(base) if not h.given]
    loads = [h for h in movable if h.family in ("k_factor", "unit_load")]  # a better material
    conflict, repairs = impossible(base, clock, movable, everything, [loads])
    if not repairs and scene.teeth is not None:  # possible but for whole teeth
        repairs = [
            Repair("even", 1.0, None, tuple((h, 1.0) for h in family))
            for family in (*families(movable).values(), loads)
        ]
    wider = [list(conflict), [h for h in movable if not h.given]]
    tried = [_remedy(scene, repair, wider, clock) for repair in repairs]
    found = [remedy for remedy in tried if remedy is not None]
    if scene.duty.ratio_tolerance == 0 and (remedy := _tolerance(scene, clock)) is not None:
        found.append(remedy)
    if scene.teeth is not None:
        found += _choices(scene, clock)
    found = _distinct(found)
    late = "time ran out before all ways out were tried" if clock.over else ""
    return Ways(tuple(_told(h.name) for h in conflict), tuple(found), late)


def _distinct(found: Sequence[Remedy]) -> list[Remedy]:
    """Of remedies that edit the same keys, the one of the smallest factor."""
    best: dict[tuple[str, ...], Remedy] = {}
    for remedy in found:
        keys = tuple(c.key for c in remedy.changes)
        if keys not in best or remedy.factor < best[keys].factor * (1.0 - SAME):
            best[keys] = remedy
    return list(best.values())


def _told(name: str) -> str:
    """A limit by the key of the file: a ratio is given by its tooth numbers."""
    return name.replace("ratio", "wheel_teeth") if name.split("[")[0] == "ratio" else name


def _reach(scene: Scene, handle: Handle) -> float:
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
    scene: Scene, repair: Repair, wider: Sequence[Sequence[Handle]], clock: Clock
) -> Remedy | None:
    """A repair as edits, large enough for whole teeth where the file has them; None if none is.

    wider: limits to move as well where those of a least repair do not suffice for whole teeth.
    """
    moves = repair.moves if scene.teeth is None else _for_teeth(scene, repair, wider, clock)
    cured = None if moves is None else cure(scene, moves)
    if moves is None or cured is None or _status(cured.scene, clock) not in THERE:
        return None
    alone = repair.kind == "least"
    each = range(len(cured.changes)) if alone else (None,)
    words = {_status(less(scene, cured, TAKEN_BACK, k), clock) for k in each}
    return Remedy(
        "less" if all(_is_duty(h) for h, _ in moves) else repair.kind,
        ", ".join(dict.fromkeys(_told(h.family) for h, _ in moves)),
        cured.changes,
        (math.prod if alone else max)(c.factor for c in cured.changes),
        _bound(scene, repair),
        {"with": "feasible", "with_less": words.pop() if len(words) == 1 else "mixed"},
    )


def _bound(scene: Scene, repair: Repair) -> float | None:
    """The proven least factor of a repair, in the number that the file has."""
    handle, now = repair.moves[0][0], scene.duty.ratio_tolerance
    if repair.bound is None or not handle.family.startswith("ratio_") or len(repair.moves) > 1:
        return repair.bound
    return tolerance_factor(now, handle, repair.bound) if now else None


def _is_duty(handle: Handle) -> bool:
    return handle.given and handle.family not in FIELDS


def _status(scene: Scene, clock: Clock) -> str:
    """What a scene's answer would be: a status, or "undecided"."""
    if clock.over:
        return "undecided"
    sized = clock.solve(sizing.problem(scene.train())).status
    if scene.teeth is None or sized == "infeasible":
        return sized
    found = _possible(scene.train(), clock)
    return "undecided" if found is None else ("feasible" if found else "infeasible")


def _possible(train: Train, clock: Clock) -> bool | None:
    """Whether whole teeth are possible; None where that is not known in time."""
    if clock.over:
        return None
    left = clock.left.seconds
    return possible(train, SECONDS if left is None else min(SECONDS, left), clock.watch)


def _for_teeth(
    scene: Scene, repair: Repair, wider: Sequence[Sequence[Handle]], clock: Clock
) -> Moves | None:
    """The moves of a repair, enlarged until whole teeth exist."""
    known = {h for h, _ in repair.moves}
    also: list[Sequence[Handle]] = [()] if repair.kind != "least" else [(), *wider]
    for more in also:
        moves = repair.moves + tuple((h, 1.0) for h in more if h not in known)
        extra = _extra(scene, moves, clock)
        if extra is not None:
            larger = tuple((h, f * extra) for h, f in moves)
            return larger if repair.kind != "least" else _trimmed(scene, larger, clock)
    return None


def _works(scene: Scene, moves: Moves, clock: Clock, back: float = 0.0) -> bool | None:
    """Whether whole teeth exist with moves (less a part `back` of each); None: not known."""
    cured = cure(scene, moves)
    if cured is None:
        return None
    return _possible((less(scene, cured, back) if back else cured.scene).train(), clock)


def _extra(scene: Scene, moves: Moves, clock: Clock) -> float | None:
    """The least common factor beyond a continuous repair with which whole teeth are possible."""

    def works(extra: float, back: float = 0.0) -> bool | None:
        return _works(scene, tuple((h, f * extra) for h, f in moves), clock, back)

    found = works(1.0)
    low, high = 1.0, 1.0
    for high in () if found else WIDEST:
        found = works(high)
        if found is not False:
            break
        low = high
    return _between(low, high, works) if found else None


def _between(low: float, high: float, works: Any) -> float | None:
    """The least factor between an impossible and a possible one; None where time ran out.

    works(factor, back): whether a factor will do, also with its edits taken back by a part.
    """
    while high > low * CLOSE or (high > low * LEAST and works(high, TAKEN_BACK)):
        middle = math.sqrt(low * high)
        found = works(middle)
        if found is None:
            return None
        low, high = (low, middle) if found else (middle, high)
    return high


def _trimmed(scene: Scene, moves: Moves, clock: Clock) -> Moves | None:
    """Moves of which each is needed, and as small as the others allow; None where time ran out."""
    kept = moves
    for handle, factor in reversed(moves):
        others = tuple(m for m in kept if m[0] is not handle)
        if others and _works(scene, others, clock):
            kept = others
            continue
        least = _between(1.0, factor, _alone(scene, others, handle, clock))
        if least is None:
            return None
        kept = tuple((h, least if h is handle else f) for h, f in kept)
    return kept


def _alone(scene: Scene, others: Moves, handle: Handle, clock: Clock) -> Any:
    """Whether a factor of one move will do beside the others: works(factor, back)."""

    def works(factor: float, back: float = 0.0) -> bool | None:
        moves = (*others, (handle, factor))
        cured = cure(scene, moves)
        if cured is None or not back:
            return _works(scene, moves, clock)
        one = less(scene, cured, back, _change(scene, cured, handle))
        return _possible(one.train(), clock)

    return works


def _change(scene: Scene, cured: Cure, handle: Handle) -> int | None:
    """Which change of a cure comes from a handle."""
    own = cure(scene, [(handle, handle.reach)])
    paths = () if own is None else own.paths
    return next((k for k, path in enumerate(cured.paths) if path in paths), None)


def _tolerance(scene: Scene, clock: Clock) -> Remedy | None:
    """The least ratio tolerance with which a drive of none is possible."""
    path = ("duty", "ratio_tolerance")

    def works(tolerance: float, back: float = 0.0) -> bool | None:
        other = put(scene, path, Fraction(tolerance * (1.0 - back)))
        word = _status(other, clock)
        return None if word in ("undecided", "limit", "failed") else word in THERE

    low, high = (float(t) for t in TOLERANCES)
    least = low if works(low) else (_between(low, high, works) if works(high) else None)
    if least is None:
        return None
    value = eased(Fraction(least), 1.0, 1)
    texts = [toml_text(written(v, path)) for v in (Fraction(0), value)]
    change = Change(dotted(path), texts[0], texts[1], math.inf)
    words = ["feasible" if works(float(value), b) else "infeasible" for b in (0.0, TAKEN_BACK)]
    if words[0] == "infeasible":
        return None
    verified = {"with": words[0], "with_less": words[1]}
    return Remedy("less", path[-1], (change,), change.factor, None, verified)


def _choices(scene: Scene, clock: Clock) -> Iterator[Remedy]:
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
