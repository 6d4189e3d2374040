"""The best number of stages of a range, or choice of their types: each is solved, and is bounded.

A drive may have any of these numbers of stages, so that its designs are those of all counts, and
the least of their bounds is one of it. Counts that real-valued sizes promise most of come first.
A choice of types is such a count, too.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.certificate import least
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Event, Result, Watch
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.stage_types import open_types, words
from gearopt.scenes.reading.ask import Ask

BESIDE = 2.0  # s, at most, for a count that is known not to be the best
WHOLE = "exhausted"  # the proof of a search to the end
NONE = Result("drive", "limit", "not begun in time", {})
Real = Callable[[Scene, Ask], Result]  # the drive with real-valued sizes
Answer = Callable[[Scene, Ask, Result], Result]  # the drive, where those are known


@dataclass(frozen=True)
class Count:
    """A number of stages, or their types: its drive, in real-valued sizes, and its answer so far.

    types: words of the types, where they are chosen; else "".
    """

    scene: Scene
    types: str
    real: Result
    found: Result
    seconds: float

    @property
    def floor(self) -> float:
        """Lower bound of all designs by their real-valued sizes; a box has no such bound."""
        if self.real.status == "infeasible":
            return math.inf
        boxed = self.scene.layout is not None
        return -math.inf if self.real.bound is None or boxed else self.real.bound

    @property
    def number(self) -> int:
        """Return the number of stages."""
        return self.scene.counts[0]

    @property
    def words(self) -> str:
        """What is counted: its number of stages, or their types."""
        return self.types or f"{self.number} stage{'s' * (self.number > 1)}"

    @property
    def bound(self) -> float:
        """Lower bound of all designs of this count."""
        if self.found.status == "infeasible":
            return math.inf
        return -math.inf if self.found.bound is None else self.found.bound


def best_count(scene: Scene, ask: Ask, real: Real, answer: Answer) -> Result:
    """Return the best drive over its numbers of stages, with a row for each in report["counts"].

    Each count gets an equal share of the time; what is left goes to those that were not finished
    and may be better.
    """
    clock = Clock(ask.budget)
    named = open_types(scene)
    counts = [_unsolved_count(each, named, ask, clock, real) for each in scene.each]
    order = sorted(
        range(len(counts)),
        key=lambda k: (counts[k].floor == math.inf, counts[k].real.value or 0.0),
    )
    for done, k in enumerate(order):
        beside = counts[k].floor > _least_value(counts)
        share = BESIDE if beside else _share(clock, len(counts) - done)
        counts[k] = _solved_count(counts[k], ask, clock, answer, share)
    for k, count in ((k, counts[k]) for k in order):
        left = clock.left.seconds
        may_be_better = count.found.status == "limit" and count.bound < _least_value(counts)
        if may_be_better and not clock.over and left is not None and left > count.seconds:
            counts[k] = _solved_count(count, ask, clock, answer)
    return _best(counts, ask, clock)


def _unsolved_count(scene: Scene, named: bool, ask: Ask, clock: Clock, real: Real) -> Count:
    """Return a count with its real-valued sizes, and their bound of what is not solved yet."""
    before, types = clock.seconds, words(scene) if named else ""
    count = Count(scene, types, NONE, NONE, 0.0)
    ideal = real(scene, _ask_of_count(ask, clock, count.words))
    bound = None if scene.layout is not None else ideal.bound
    missing = {**ideal.objective, "value": None}
    unsolved = replace(ideal, status="limit", objective=missing, bound=bound, gap=None)
    unsolved = replace(unsolved, design={}, limits={}, certificate={}, message="not begun in time")
    result = ideal if ideal.status == "infeasible" else unsolved
    named_drive = replace(result, name="drive")
    return replace(count, real=ideal, found=named_drive, seconds=clock.seconds - before)


def _solved_count(
    count: Count, ask: Ask, clock: Clock, answer: Answer, seconds: float | None = None
) -> Count:
    """Return a count as it is solved in at most so many seconds, unless it was better before."""
    if clock.over or count.found.status == "infeasible":
        return count
    before = clock.seconds
    result = answer(count.scene, _ask_of_count(ask, clock, count.words, seconds), count.real)
    clock.evaluations += result.evaluations
    spent = count.seconds + clock.seconds - before
    better = _value(result) > _value(count.found) and result.status == "limit"
    return replace(count, found=count.found if better else result, seconds=spent)


def _share(clock: Clock, counts: int) -> float | None:
    left = clock.left.seconds
    return None if left is None else left / counts


def _ask_of_count(ask: Ask, clock: Clock, count: str, seconds: float | None = None) -> Ask:
    """Return the request for one number of stages: at most so many seconds of what is left."""
    budget = clock.left
    if seconds is not None:
        budget = replace(budget, seconds=clock.within(seconds))
    return replace(ask, budget=budget, watch=_watch_of_count(ask.watch, clock, count))


def _watch_of_count(watch: Watch | None, clock: Clock, count: str) -> Watch | None:
    """Return a watcher whose events name the number of stages; refused once, all end."""
    if watch is None:
        return None

    def follow(event: Event) -> bool:
        part = f"{count}, {event.part}".removesuffix(", ")
        clock.stopped = clock.stopped or watch(replace(event, part=part)) is False
        return not clock.stopped

    return follow


def _value(found: Result) -> float:
    return math.inf if found.value is None else found.value


def _least_value(counts: Sequence[Count]) -> float:
    return min(_value(c.found) for c in counts)


def _best(counts: Sequence[Count], ask: Ask, clock: Clock) -> Result:
    """Return the best of all counts, with the bound of all."""
    best = least([c.found for c in counts], ask.gap)
    report = best.report | {"counts": [_row(c) for c in counts]}
    if trains := _trains(counts, ask.top):
        report["trains"] = trains
    return replace(
        best,
        report=report,
        message=_message(best, counts),
        proof=_proof(best, counts),
        seconds=clock.seconds,
        evaluations=sum(c.found.evaluations for c in counts),
    )


def _row(count: Count) -> dict[str, Any]:
    """Return status, objective and bound of one number of stages, as a result holds them."""
    result = count.found
    stages = result.design.get("stages", [])
    return {
        "stages": count.number,
        **({"types": count.types} if count.types else {}),
        "status": result.status,
        "objective": result.value,
        "bound": result.bound,
        "gap": result.gap,
        "ratios": [s["ratio"] for s in stages],
        "modules_mm": [s["normal_module_mm"] for s in stages],
        "teeth": [[s[f"{gear}_teeth"] for gear in _gears(s)] for s in stages],
        "conflict": result.proof.get("conflict", []) if result.status == "infeasible" else [],
        "seconds": count.seconds,
    }


def _gears(stage: Mapping[str, Any]) -> tuple[str, ...]:
    return ("sun", "planet", "ring") if stage.get("sun_teeth") else ("pinion", "wheel")


def _trains(counts: Sequence[Count], top: int) -> list[Any]:
    """Return the best trains of all counts, up to the first that an open search may be below."""

    def objective(train: Mapping[str, Any]) -> float:
        return float(train["objective"])

    trains = sorted((t for c in counts for t in c.found.report.get("trains", ())), key=objective)
    unsure = [c.bound for c in counts if c.found.proof.get("method") != WHOLE]
    sure = min(unsure, default=math.inf)
    return [t for k, t in enumerate(trains[:top]) if k == 0 or objective(t) <= sure]


def _all(counts: Sequence[Count]) -> str:
    if counts[0].types:
        return "every choice of types of the stages"
    return f"every number of stages from {counts[0].number} to {counts[-1].number}"


def _message(found: Result, counts: Sequence[Count]) -> str:
    """Say which counts may be better than what was found, or that none is possible."""
    if found.status == "infeasible":
        return f"with {_all(counts)} no design meets all limits"
    best = found.value or math.inf
    unsure = [c for c in counts if c.bound < best and c.found.status == "limit"]
    if found.status == "optimal" or not unsure:
        return found.message
    which = "; ".join(c.types for c in unsure)
    which = which or f"{', '.join(str(c.number) for c in unsure)} stages"
    return f"a better design may exist with {which}: not searched to the end"


def _proof(found: Result, counts: Sequence[Count]) -> dict[str, Any]:
    """Return the proof of the count that is bounded lowest, in words of all of them."""
    span = f"Proof: {_all(counts)} was"
    if found.status == "infeasible":
        return {"method": "every number of stages", "sentence": f"{span} excluded."}
    lowest = min(counts, key=lambda c: c.bound)
    sentence = str(lowest.found.proof.get("sentence", "")).removeprefix("Proof: ")
    sentence = f" With {lowest.words}: {sentence}" if sentence else ""
    return {**lowest.found.proof, "sentence": f"{span} bounded; the least bound counts.{sentence}"}
