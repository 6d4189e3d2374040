"""`explain`: what would make a problem possible, or what its answer owes to each input."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

import numpy as np

from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.explaining.elastic import elastic
from gearopt.optimise.explaining.explanation import Change, Explanation, Influence, Remedy
from gearopt.optimise.explaining.handles import PARAM, Handle, each_word, effective, handles
from gearopt.optimise.explaining.repair import Repair, impossible, value_within
from gearopt.optimise.explaining.sensitivity import BINDS, sensitivities
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Result, Watch
from gearopt.optimise.solve import run, solve_within
from gearopt.optimise.terms import Array, spread

THERE = ("optimal", "stationary", "feasible")  # a design exists
STEP = 1e-3  # relative, of the re-solves that check a sensitivity
ZERO = 1e-9  # of the objective at the guess
EASE = 0.01  # relative, of the step whose price is told
TAKEN_BACK = 1e-3  # a remedy this much smaller must be impossible
DIGITS = 6  # of a number that is proposed; rounded to the easy side
ROOM = 2e-7  # a proposal asks for this much more than the least factor, to be feasible in doubles


def explain(
    problem: Problem, budget: Budget | None = None, watch: Watch | None = None
) -> Explanation:
    """Explain the answer to a continuous problem.

    Impossible: the conflict and its remedies. Possible: the limits that bind, and for every
    parameter its sensitivity, checked by re-solving, and the price of easing it by 1 % if it is a
    limit. SolveError for discrete variables.
    """
    clock = Clock(budget or Budget(), of_others(watch))
    result, outcome = run(problem, "ipopt", clock.left, watch=watch)
    if result.status in ("infeasible", "failed"):
        found_ = handles(problem)
        limits = [h for h in found_ if not h.given]
        conflict, repairs = impossible(problem, clock, found_, limits)
        ways = [_remedy(problem, r, clock) for r in repairs]
        found = Explanation(
            result,
            tuple(h.name for h in conflict),
            tuple(way for way in ways if way.verified["with"] in THERE),
            message="time ran out before all ways out were tried" if clock.over else "",
        )
    elif result.value is None or outcome.x is None:
        found = Explanation(result, message="no design was found in time")
    else:
        influences = tuple(_influences(problem, result, outcome, clock))
        late = "stopped before all numbers were looked at" if clock.over else ""
        found = Explanation(result, (), (), binding(result), influences, late)
    return replace(found, seconds=clock.seconds)


def binding(result: Result) -> tuple[str, ...]:
    """Names of the limits that are used to the full."""
    return tuple(name for name, used in result.limits.items() if used >= 1.0 - BINDS)


def slope(value: float, solve_at: Callable[[float], float | None], factor: float) -> float | None:
    """D ln objective / d ln input by re-solving with the input times a factor near 1."""
    other = solve_at(factor)
    if other is None or value == 0.0:
        return None
    if min(other, value) > 0.0:
        return math.log(other / value) / math.log(factor)
    return (other - value) / (abs(value) * math.log(factor))


def _influences(
    problem: Problem, result: Result, outcome: Outcome, clock: Clock
) -> Iterator[Influence]:
    assert outcome.x is not None and result.value is not None
    value = _nonzero(problem, result.value)
    known = sensitivities(problem, outcome.x).parameters
    limits = {h.place: h for h in handles(problem) if h.kind == PARAM and not h.given}
    used = effective(problem)
    for place, (name, key, number) in enumerate(_inputs(problem)):
        if clock.over:
            return
        if not (used[place] and math.isfinite(number)) or number == 0.0:
            continue

        def solved(factor: float, place: int = place) -> float | None:
            return value_within(clock, _scaled(problem, place, factor))

        step, price = "", None
        if place in limits:
            direction = limits[place].direction
            eased = solved(1.0 + direction * EASE)
            step = f"{direction * EASE:+.0%}"
            price = None if eased is None or value == 0.0 else (eased - value) / abs(value)
        sides = slope(value, solved, 1.0 - STEP), slope(value, solved, 1.0 + STEP)
        if clock.over:  # the row may be half done
            return
        yield Influence(
            key or name,
            f"{number:.10g}",
            float(known[place]) if value and math.isfinite(known[place]) else None,
            sides,
            step,
            price,
        )


def _nonzero(problem: Problem, value: float) -> float:
    """An objective, or 0 where it is rounding beside that of the guess."""
    there = float(problem.batch(problem.bounds()[2][None]).F[0, 0])
    return 0.0 if math.isfinite(there) and abs(value) <= ZERO * abs(there) else value


def _inputs(problem: Problem) -> list[tuple[str, str, float]]:
    """Name, key and value of every parameter component."""
    return [
        (q.name if q.size == 1 else f"{q.name}[{k + 1}]", key, float(v))
        for q in problem.parameters
        for k, (key, v) in enumerate(
            zip(each_word(q.key, q.size), spread(q.value, q.size), strict=True)
        )
    ]


def _scaled(problem: Problem, place: int, factor: float) -> Problem:
    """The problem with one parameter component times a factor."""
    values = problem.parameter_values()
    values[place] *= factor
    return _with(problem, values)


def _with(problem: Problem, values: Array) -> Problem:
    found, start = {}, 0
    for q in problem.parameters:
        part = values[start : start + q.size]
        found[q.name] = float(part[0]) if q.size == 1 else tuple(map(float, part))
        start += q.size
    return problem.at(**found)


def _remedy(problem: Problem, repair: Repair, clock: Clock) -> Remedy:
    """A repair as edits of parameters and bounds, verified by solving with them and with less."""
    handles_, factors = zip(*repair.moves, strict=True)
    asked = np.array([_asked(h, f) for h, f in repair.moves])
    form = elastic(problem, [[h] for h in handles_])

    def status(now: Array) -> str:
        return solve_within(
            clock, form.within("relaxation", tuple(now), tuple(now)), "ipopt"
        ).status

    back = np.eye(len(asked)) if repair.kind == "least" else np.ones((1, len(asked)))
    words = {status(np.maximum(asked * (1.0 - TAKEN_BACK * row), 1.0)) for row in back}
    return Remedy(
        repair.kind,
        ", ".join(dict.fromkeys(h.family for h in handles_)),
        tuple(
            Change(h.key or h.name, f"{h.value:.10g}", f"{h.relaxed(a):.{DIGITS + 2}g}", float(a))
            for h, a in zip(handles_, asked, strict=True)
        ),
        float(asked.prod() if repair.kind == "least" else asked.max()),
        repair.bound,
        {"with": status(asked), "with_less": words.pop() if len(words) == 1 else "mixed"},
    )


def _asked(handle: Handle, factor: float) -> float:
    """The factor that leads to a number of DIGITS digits, on the easy side of what is needed."""
    needed = handle.relaxed(factor * (1.0 + ROOM))
    rounding = ROUND_CEILING if handle.direction > 0 else ROUND_FLOOR
    number = float(Context(prec=DIGITS, rounding=rounding).plus(Decimal(needed)))
    if handle.value <= 0:
        return factor * (1.0 + ROOM)
    return float((number / handle.value) ** handle.direction)
