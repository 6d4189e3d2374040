"""Several objectives of one problem, as a file or a user poses them, to their front."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Any

from gearopt.errors import SolveError
from gearopt.optimise.clock import Clock, in_part
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.pareto.epsilon import Limiting
from gearopt.optimise.pareto.front import Front, Objective
from gearopt.optimise.pareto.judged import judged, united
from gearopt.optimise.pareto.pareto import EXACT, default, found
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms, Var


@dataclass(frozen=True)
class Several:
    """A problem, its objectives in order, and the design of a point as its file shows it.

    limiting: how it is posed with one objective under limits on others, by a method of its own.
    others: the same with other numbers of stages; the front is of all together. scope: the designs
    that it is a front of, where these are not all.
    """

    problem: Problem | Conic
    objectives: tuple[Objective, ...]
    drawn: Callable[[Array], Mapping[str, Any]] | None = None
    limiting: Limiting | None = None
    others: tuple["Several", ...] = ()
    scope: str = ""


def impossible(of: str, names: Sequence[str], none: Outcome) -> Problem:
    """Problem whose exact method claims a known fact: that there is no design."""
    return Problem(
        of,
        (Var("x", "", 0.0, 1.0, 0.5),),
        (),
        lambda x, p: Terms(dict.fromkeys(names, x.x), {"none": 2.0 + x.x}),
        methods={EXACT: lambda problem, budget, seed, watch: none},
    )


def several(problem: Problem | Conic, names: Sequence[str] | None) -> Several:
    """Return the objectives of a problem of one's own; by default all that it minimises."""
    known = problem.objectives if isinstance(problem, Conic) else problem.rows.objectives
    chosen = chosen_of(names or known, known, problem.name)
    return Several(problem, tuple(Objective(name) for name in chosen))


def chosen_of(names: Sequence[str] | None, known: Sequence[str], of: str) -> tuple[str, ...]:
    """Return names of two or three objectives; SolveError lists those that there are."""
    listed = ", ".join(known)
    if not known:
        raise SolveError(f"{of} has no objectives to weigh against each other: solve it instead")
    if not names:
        raise SolveError(f"name two or three objectives of {of}: {listed}")
    for name in names:
        if name not in known:
            close = get_close_matches(name, known, 1)
            meant = f" (did you mean {close[0]}?)" if close else ""
            raise SolveError(f"{of} has no objective {name!r}{meant}; objectives: {listed}")
    if len(set(names)) != len(names) or not 2 <= len(names) <= 3:
        raise SolveError(
            f"a front has two or three objectives, each once, not {', '.join(names)}; "
            f"objectives of {of}: {listed}"
        )
    return tuple(names)


def solved(
    posed: Several,
    most: Mapping[str, float],
    method: str | None,
    points: int | None,
    weights: Mapping[str, float] | None,
    budget: Budget,
    seed: int,
    watch: Watch | None,
    **names: Any,
) -> Front:
    """Return the front of posed objectives, judged and measured; names: fields of a `Front`."""
    if posed.others:
        given: dict[str, Any] = {
            "most": most,
            "method": method,
            "points": points,
            "weights": weights,
        }
        given |= {"seed": seed, "watch": watch, **names}
        return united(_each(posed, given, Clock(budget)), weights)
    clock, listed = Clock(), [one.name for one in posed.objectives]
    for name in (*most, *(weights or ())):
        if name not in listed:
            raise SolveError(f"{name} is none of the objectives of this front: {', '.join(listed)}")
    chosen = method or default(posed.problem, posed.limiting)
    watch = in_part(watch, posed.objectives[0].unit, "front")
    made = found(posed.problem, listed, most, chosen, points, budget, seed, watch, posed.limiting)
    shown = [replace(one, most=most.get(one.name)) for one in posed.objectives]
    front = judged(posed.problem, made, shown, chosen, clock, weights, posed.drawn, **names)
    proof = {**front.proof, "scope": posed.scope} if posed.scope else front.proof
    return replace(front, seed=seed, proof=proof)


def _each(posed: Several, given: Mapping[str, Any], clock: Clock) -> list[Front]:
    """Front of each of several problems, in equal shares of the time that is left."""
    every, fronts = (replace(posed, others=()), *posed.others), list[Front]()
    for k, one in enumerate(every):
        left = clock.left
        if left.seconds is not None:
            left = replace(left, seconds=left.seconds / (len(every) - k))
        fronts.append(solved(one, budget=left, **given))
        clock.evaluations += fronts[-1].evaluations
    return fronts
