"""The best number of stages of a range: every count is solved, and their bounds are put together.

A drive may have any of these numbers of stages, so that its designs are those of all counts, and
the least of their bounds is one of it. Counts that real-valued sizes promise most of come first.
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
from gearopt.scenes.reading.ask import Ask

BESIDE = 2.0  # s, at most, for a count that is known not to be the best
WHOLE = "exhausted"  # the proof of a search to the end
Real = Callable[[Scene, Ask], Result]  # the drive with real-valued sizes
Answer = Callable[[Scene, Ask, Result], Result]  # the drive, where those are known


@dataclass(frozen=True)
class Count:
    """A number of stages: its drive, that with real-valued sizes, and its answer so far."""

    scene: Scene
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
    counts = [_unsolved_count(scene.held(n), ask, clock, real) for n in scene.counts]
    counts.sort(key=lambda c: (c.floor == math.inf, c.real.value or 0.0))
    for k, count in enumerate(counts):
        beside = count.floor > _least_value(counts)
        share = BESIDE if beside else _share(clock, len(counts) - k)
        counts[k] = _solved_count(count, ask, clock, answer, share)
    for k, count in enumerate(counts):
        left = clock.left.seconds
        may_be_better = count.found.status == "limit" and count.bound < _least_value(counts)
        if may_be_better and not clock.over and left is not None and left > count.seconds:
            counts[k] = _solved_count(count, ask, clock, answer)
    return _best(sorted(counts, key=lambda c: c.number), ask, clock)


def _unsolved_count(scene: Scene, ask: Ask, clock: Clock, real: Real) -> Count:
    """Return a count with its real-valued sizes, and their bound of what is not solved yet."""
    before = clock.seconds
    ideal = real(scene, _ask_of_count(ask, clock, scene.counts[0]))
    bound = None if scene.layout is not None else ideal.bound
    missing = {**ideal.objective, "value": None}
    unsolved = replace(ideal, status="limit", objective=missing, bound=bound, gap=None)
    unsolved = replace(unsolved, design={}, limits={}, certificate={}, message="not begun in time")
    result = ideal if ideal.status == "infeasible" else unsolved
    return Count(scene, ideal, replace(result, name="drive"), clock.seconds - before)


def _solved_count(
    count: Count, ask: Ask, clock: Clock, answer: Answer, seconds: float | None = None
) -> Count:
    """Return a count as it is solved in at most so many seconds, unless it was better before."""
    if clock.over or count.found.status == "infeasible":
        return count
    before = clock.seconds
    result = answer(count.scene, _ask_of_count(ask, clock, count.number, seconds), count.real)
    clock.evaluations += result.evaluations
    spent = count.seconds + clock.seconds - before
    better = _value(result) > _value(count.found) and result.status == "limit"
    return replace(count, found=count.found if better else result, seconds=spent)


def _share(clock: Clock, counts: int) -> float | None:
    left = clock.left.seconds
    return None if left is None else left / counts


def _ask_of_count(ask: Ask, clock: Clock, count: int, seconds: float | None = None) -> Ask:
    """Return the request for one number of stages: at most so many seconds of what is left."""
    budget = clock.left
    if seconds is not None:
        budget = replace(budget, seconds=clock.within(seconds))
    return replace(ask, budget=budget, watch=_watch_of_count(ask.watch, clock, count))


def _watch_of_count(watch: Watch | None, clock: Clock, count: int) -> Watch | None:
    """Return a watcher whose events name the number of stages; refused once, all end."""
    if watch is None:
        return None

    def follow(event: Event) -> bool:
        part = f"{_stages(count)}, {event.part}".removesuffix(", ")
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
        "status": result.status,
        "objective": result.value,
        "bound": result.bound,
        "gap": result.gap,
        "ratios": [s["ratio"] for s in stages],
        "modules_mm": [s["normal_module_mm"] for s in stages],
        "teeth": [[s["pinion_teeth"], s["wheel_teeth"]] for s in stages],
        "conflict": result.proof.get("conflict", []) if result.status == "infeasible" else [],
        "seconds": count.seconds,
    }


def _trains(counts: Sequence[Count], top: int) -> list[Any]:
    """Return the best trains of all counts, up to the first that an open search may be below."""

    def objective(train: Mapping[str, Any]) -> float:
        return float(train["objective"])

    trains = sorted((t for c in counts for t in c.found.report.get("trains", ())), key=objective)
    unsure = [c.bound for c in counts if c.found.proof.get("method") != WHOLE]
    sure = min(unsure, default=math.inf)
    return [t for k, t in enumerate(trains[:top]) if k == 0 or objective(t) <= sure]


def _stages(count: int) -> str:
    return f"{count} stage{'s' * (count > 1)}"


def _message(found: Result, counts: Sequence[Count]) -> str:
    """Say which counts may be better than what was found, or that none is possible."""
    if found.status == "infeasible":
        span = f"from {counts[0].number} to {counts[-1].number}"
        return f"with every number of stages {span} no design meets all limits"
    best = found.value or math.inf
    unsure = [str(c.number) for c in counts if c.bound < best and c.found.status == "limit"]
    if found.status == "optimal" or not unsure:
        return found.message
    words = f"a better design may exist with {', '.join(unsure)} stages"
    return f"{words}: not searched to the end"


def _proof(found: Result, counts: Sequence[Count]) -> dict[str, Any]:
    """Return the proof of the count that is bounded lowest, in words of all of them."""
    span = f"Proof: every number of stages from {counts[0].number} to {counts[-1].number} was"
    if found.status == "infeasible":
        return {"method": "every number of stages", "sentence": f"{span} excluded."}
    lowest = min(counts, key=lambda c: c.bound)
    sentence = str(lowest.found.proof.get("sentence", "")).removeprefix("Proof: ")
    sentence = f" With {_stages(lowest.number)}: {sentence}" if sentence else ""
    return {**lowest.found.proof, "sentence": f"{span} bounded; the least bound counts.{sentence}"}
