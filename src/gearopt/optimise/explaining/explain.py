"""`explain`: changes that make a problem possible, or the parts of its inputs in its answer."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from functools import cache

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.explaining.exclusion import (
    VERDICTS,
    Exclusion,
    each_resolves,
    eased,
    exclusion,
    named,
    possible,
)
from gearopt.optimise.explaining.explanation import (
    Change,
    Explanation,
    Influence,
    Remedy,
)
from gearopt.optimise.explaining.halving import Bracket, middles, take
from gearopt.optimise.explaining.handles import (
    LOWER,
    PARAM,
    ROW,
    UPPER,
    Handle,
    each_word,
    effective,
    handles,
    with_limits_named,
)
from gearopt.optimise.explaining.proposed import DIGITS, FEASIBILITY_MARGIN
from gearopt.optimise.explaining.repair import (
    FACTOR_TOLERANCE,
    SLACK_TRIED,
    Repair,
    any_resolves,
    elastic,
    even,
    impossible,
    value_within,
)
from gearopt.optimise.explaining.sensitivity import BINDS, sensitivities
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import THERE, Budget, Outcome, Result, Watch
from gearopt.optimise.solve import BOXES, PROVER, solve_within
from gearopt.optimise.terms import Array, spread

STEP = 1e-3  # relative, of the re-solves that check a sensitivity
ZERO = 1e-9  # of the objective at the guess
EASE = 0.01  # relative, of the step whose effect is reported
FACTORS_IN_TURN = (1.02, 1.1, 1.3, 2.0, 4.0, 16.0, 256.0, 1e6)  # up to the first that suffices


def explain(
    problem: Problem, budget: Budget | None = None, watch: Watch | None = None
) -> Explanation:
    """Explain the answer to a problem.

    Impossible: the conflict and its remedies; of a problem that is not convex in logarithms, or
    discrete, each number that alone suffices. Possible: the limits that bind, and for every
    parameter and every bound with a key its sensitivity (discrete variables held), checked by
    re-solving, and the gain of easing it by 1 % if it is a limit. SolveError where a text without
    an exact method is neither smooth nor has a relaxation.
    """
    clock = Clock(budget or Budget(), of_others(watch))
    problem = with_limits_named(problem)
    method, result, outcome = _answered(problem, clock, watch)
    if result.status in ("infeasible", "failed"):
        explanation = _impossible(problem, method, result, clock)
    elif result.value is None or outcome.x is None:
        explanation = Explanation(result, message="no design was found in time")
    else:
        influences = tuple(_influences(problem, result, outcome.x, method, clock))
        message = "stopped before all numbers were examined" if clock.over else ""
        explanation = Explanation(result, (), (), binding(result), influences, message)
    return replace(explanation, seconds=clock.seconds)


def _answered(problem: Problem, clock: Clock, watch: Watch | None) -> tuple[str, Result, Outcome]:
    """The method that answers a problem, and its answer: of its own, Ipopt, or branch and bound."""
    discrete = any(variable.discrete for variable, _ in problem.columns)
    method = next(iter(problem.methods), PROVER if discrete else "ipopt")
    result, outcome = run(problem, method, _ending(method, clock.left), watch=watch)
    if method == "ipopt" and result.status == "failed" and not clock.over:
        try:
            proven = run(problem, PROVER, _ending(PROVER, clock.left), watch=watch)
        except SolveError:  # no relaxation
            return method, result, outcome
        return PROVER, *proven
    return method, result, outcome


def _ending(method: str, budget: Budget) -> Budget:
    """A budget with an end where the method has none of its own."""
    endless = method == PROVER and budget.seconds is None and budget.evaluations is None
    return replace(budget, evaluations=BOXES) if endless else budget


def _impossible(problem: Problem, method: str, result: Result, clock: Clock) -> Explanation:
    """Conflict and remedies of a problem without a design."""
    known = handles(problem)
    excluding, resolves, remedies = Exclusion(), False, list[Remedy | None]()
    if method == "ipopt":
        blamed, repairs = impossible(problem, clock, known, [h for h in known if not h.given])
        remedies = [_remedy(problem, r, clock) for r in repairs]
        excluding = Exclusion(tuple(h.name for h in blamed))
        resolves = any_resolves(problem, known, blamed, clock)
        if not blamed and _relaxes(problem, clock):  # not convex in logarithms
            method = PROVER
    if method != "ipopt":
        if method == PROVER and result.status == "infeasible":
            excluding = exclusion(problem, clock)
            resolves = each_resolves(problem, excluding, clock)
        remedies = [_alone(problem, h, method, clock) for h in known]
    return Explanation(
        named(result, excluding) if method == PROVER else result,
        excluding.names,
        tuple(r for r in remedies if r is not None and r.verified["with"] in THERE),
        message="the budget ended before all remedies were tried" if clock.over else "",
        any_resolves=resolves,
        unsure=excluding.unsure,
    )


def _relaxes(problem: Problem, clock: Clock) -> bool:
    """Whether branch and bound, too, finds that a problem is impossible."""
    try:
        return not clock.over and possible(problem, clock) is False
    except SolveError:  # no relaxation
        return False


def binding(result: Result) -> tuple[str, ...]:
    """Return names of the limits that are used to the full."""
    return tuple(name for name, used in result.limits.items() if used >= 1.0 - BINDS)


def slope(value: float, solve_at: Callable[[float], float | None], factor: float) -> float | None:
    """Return d ln objective / d ln input by re-solving with the input times a factor near 1."""
    other = solve_at(factor)
    if other is None or value == 0.0:
        return None
    if min(other, value) > 0.0:
        return math.log(other / value) / math.log(factor)
    return (other - value) / (abs(value) * math.log(factor))


def _influences(
    problem: Problem, result: Result, x: Array, method: str, clock: Clock
) -> Iterator[Influence]:
    assert result.value is not None
    value = _nonzero(problem, result.value)
    known = sensitivities(problem.holding(x), x)
    for handle in _inputs(problem):
        if clock.over:
            return

        def solved(factor: float, handle: Handle = handle) -> float | None:
            other = _moved(problem, replace(handle, direction=1), factor)
            return value_within(clock, other, method)

        step, price = "", None
        if handle.direction:
            eased = solved(1.0 + handle.direction * EASE)
            step = f"{handle.direction * EASE:+.0%}"
            price = None if eased is None or value == 0.0 else (eased - value) / abs(value)
        sides = slope(value, solved, 1.0 - STEP), slope(value, solved, 1.0 + STEP)
        if clock.over:  # the row may be half done
            return
        relative = float(
            (known.parameters if handle.kind == PARAM else known.columns)[handle.place]
        )
        if handle.kind != PARAM and abs(x[handle.place] - handle.value) > BINDS * abs(handle.value):
            relative = 0.0  # the bound does not hold the variable
        sure = value != 0.0 and math.isfinite(relative)
        yield Influence(
            handle.label,
            f"{handle.value:.10g}",
            relative if sure else None,
            sides,
            step,
            price,
        )


def _nonzero(problem: Problem, value: float) -> float:
    """Return an objective, or 0 where it is rounding beside that of the guess."""
    there = float(problem.batch(problem.bounds()[2][None]).F[0, 0])
    return 0.0 if math.isfinite(there) and abs(value) <= ZERO * abs(there) else value


def _inputs(problem: Problem) -> Iterator[Handle]:
    """Yield every parameter component that acts, and bound with a key; direction 0: no limit."""
    limits = {(h.kind, h.place): h.direction for h in handles(problem) if not h.given}
    used, place = effective(problem), 0
    for q in problem.parameters:
        keys, values = each_word(q.key, q.size), spread(q.value, q.size)
        for k, (key, value) in enumerate(zip(keys, values, strict=True)):
            name = q.name if q.size == 1 else f"{q.name}[{k + 1}]"
            way = limits.get((PARAM, place), 0)
            if used[place] and math.isfinite(value) and value != 0.0:
                yield Handle(name, PARAM, place, float(value), way, q.unit, key)
            place += 1
    for handle in handles(problem):
        if (
            handle.kind in (LOWER, UPPER)
            and handle.key
            and not handle.given
            and handle.value != 0.0
        ):
            yield handle


def _moved(problem: Problem, handle: Handle, factor: float) -> Problem:
    """Return the problem with the number of a handle relaxed by a factor; below 1 made stricter."""
    if handle.kind == PARAM:
        values = problem.parameter_values()
        values[handle.place] = handle.relaxed(factor)
        return _with(problem, values)
    if handle.kind == ROW:
        return eased(problem, {handle.name: factor})
    bounds = [end.copy() for end in problem.bounds()[:2]]
    bounds[handle.kind == UPPER][handle.place] = handle.relaxed(factor)
    variable, start = problem.columns[handle.place][0], 0
    for other in problem.variables:
        if other.name == variable.name:
            break
        start += other.size
    ends = (tuple(map(float, end[start : start + variable.size])) for end in bounds)
    return problem.within(variable.name, *ends)


def _alone(problem: Problem, handle: Handle, method: str, clock: Clock) -> Remedy | None:
    """Return the smallest change of one number that makes a problem possible; None: none does."""
    bound = handle.kind in (LOWER, UPPER)
    variable = problem.columns[handle.place][0] if bound else None
    whole = variable is not None and variable.integer
    listed = variable is not None and variable.values is not None
    if listed or (handle.value <= 0.0 and (whole or not handle.shift)):
        return None
    handle = replace(handle, whole=whole)

    def asked(factor: float) -> float:
        return handle.eased(_rounded_factor(handle, factor))

    @cache
    def status(factor: float) -> str:
        return solve_within(clock, _moved(problem, handle, factor), method).status

    @cache
    def suffices(factor: float) -> bool | None:
        moved = _moved(problem, handle, asked(factor))
        if method == PROVER:
            return possible(eased(moved, {}, anywhere=True), clock)
        return VERDICTS.get(solve_within(clock, moved, method).status)

    known = Bracket(1.0, 1.0)
    if (
        not any(v.discrete for v, _ in problem.columns)
        and (near := even(problem, [handle], clock)) is not None
    ):
        known = _around(near.factor, suffices)
    if known.high == 1.0:
        down = whole and handle.direction < 0  # to 1 at the most
        factors = [f for f in FACTORS_IN_TURN if not down or f <= handle.value]
        if method == PROVER and factors and suffices(factors[-1]) is False:
            return None  # as far as it may move
        for high in factors:
            if suffices(high):
                known.high = high
                break
            known.low = high
        else:
            return None
    for middle in middles(known, FACTOR_TOLERANCE):
        if clock.over:
            break
        take(known, middle, suffices(middle))
    factor = asked(known.high)
    less = handle.one_back(factor) if whole else factor * (1.0 - SLACK_TRIED)
    number = f"{handle.relaxed(factor):.{DIGITS + 2}g}"
    change = Change(handle.label, f"{handle.value:.10g}", number, factor)
    verified = {"with": status(factor), "with_less": status(less)}
    return Remedy(
        "less" if handle.given else "alone", handle.name, (change,), factor, None, verified
    )


def _around(factor: float, suffices: Callable[[float], bool | None]) -> Bracket:
    """Return a bracket of the least factor of a number that suffices, from a local method's.

    The bracket is [factor/FACTOR_TOLERANCE, factor], or [1, factor/FACTOR_TOLERANCE] where that
    end suffices too; [1, 1] where the factor itself does not.
    """
    if not suffices(factor):
        return Bracket(1.0, 1.0)
    less = max(1.0, factor / FACTOR_TOLERANCE)
    return Bracket(1.0, less) if suffices(less) else Bracket(less, factor)


def _with(problem: Problem, values: Array) -> Problem:
    values_by_name, start = {}, 0
    for q in problem.parameters:
        part = values[start : start + q.size]
        values_by_name[q.name] = float(part[0]) if q.size == 1 else tuple(map(float, part))
        start += q.size
    return problem.at(**values_by_name)


def _remedy(problem: Problem, repair: Repair, clock: Clock) -> Remedy:
    """Return a repair as edits of parameters and bounds, solved with them and with less."""
    handles_, factors = zip(*repair.moves, strict=True)
    asked = np.array([_rounded_factor(h, f) for h, f in repair.moves])
    form = elastic(problem, [[h] for h in handles_])

    def status(now: Array) -> str:
        return solve_within(
            clock, form.within("relaxation", tuple(now), tuple(now)), "ipopt"
        ).status

    back = np.eye(len(asked)) if repair.kind == "least" else np.ones((1, len(asked)))
    words = {status(np.maximum(asked * (1.0 - SLACK_TRIED * row), 1.0)) for row in back}
    return Remedy(
        repair.kind,
        ", ".join(dict.fromkeys(h.family for h in handles_)),
        tuple(
            Change(h.label, f"{h.value:.10g}", f"{h.relaxed(a):.{DIGITS + 2}g}", float(a))
            for h, a in zip(handles_, asked, strict=True)
        ),
        float(asked.prod() if repair.kind == "least" else asked.max()),
        repair.bound,
        {"with": status(asked), "with_less": words.pop() if len(words) == 1 else "mixed"},
    )


def _rounded_factor(handle: Handle, factor: float) -> float:
    """Return the factor of a number of DIGITS digits, rounded to relax the limit."""
    needed = handle.relaxed(factor * (1.0 + FEASIBILITY_MARGIN))
    rounding = ROUND_CEILING if handle.direction > 0 else ROUND_FLOOR
    number = float(Context(prec=DIGITS, rounding=rounding).plus(Decimal(needed)))
    return max(1.0, handle.factor(number))
