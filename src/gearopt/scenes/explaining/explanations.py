"""Explanations of all kinds; of one without its own: by solving changed files as it poses them."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from gearopt.errors import SolveError
from gearopt.optimise.clock import Clock, of_others, tell_known
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.explaining.explain import binding
from gearopt.optimise.explaining.explanation import (
    Explanation,
    Influence,
    Remedies,
)
from gearopt.optimise.explaining.handles import Handle, handles
from gearopt.optimise.explaining.repair import CERTAIN, any_resolves, conflict
from gearopt.optimise.explaining.sensitivity import of_fixed, sensitivities
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.solve import run
from gearopt.optimise.terms import Array
from gearopt.scenes.explaining.engine import FeasibilityQuestions, Group, singles, with_least
from gearopt.scenes.explaining.influences import Basis, Solved, influences, stepped
from gearopt.scenes.explaining.moves import DUTY, LIMIT, Move
from gearopt.scenes.explaining.numbers import Number, numbers, one_at
from gearopt.scenes.explaining.possible import Possible, possible_by_solving, without_design
from gearopt.scenes.kind import Kind
from gearopt.scenes.plan import S
from gearopt.scenes.reading.ask import Ask

BASIS = (
    " by Lagrange multipliers, checked by solving again. "
    "The effect of relaxing a limit, or of a step, is that of solving again"
)
BASIS_OF_FIXED_CHOICES = f", with these whole numbers and choices,{BASIS}"
SLOPE_TOLERANCE = 0.02  # between sensitivities by multipliers and by solving again that differ
STEP = 1e-3  # of the change up to which whole numbers and choices stay: the step of a re-solve
UNDECIDED = "where a cell is empty, solving again gave no certain answer"
UNPROVEN = "numbers are not solved again, because the answer is not proven optimal"
LATE = "the time sufficed for no sensitivity, as the answer is solved once more before them"
OTHER = (
    "numbers are not solved again, because method {}, which does that, does not prove this answer"
)


def explanation(kind: Kind[S], scene: S, ask: Ask, result: Result | None = None) -> Explanation:
    """Remedies of an impossible file, with its conflict; else sensitivities to every number.

    result: the answer, where it is known; half of the time is for it otherwise.
    """
    clock = Clock(ask.budget, of_others(ask.watch))
    result = result or kind.solve(scene, ask.half)
    if kind.has_remedies(scene) and without_design(result):
        tell_known(ask.watch, result)
        if (ways := ways_out(kind, scene, clock, result, False)) is not None:
            return _impossible_with(ways, result, clock)
    left = replace(ask, budget=clock.left)
    return (kind.influences or partial(by_solving, kind))(scene, left, result)


def ways_out(kind: Kind[S], scene: S, clock: Clock, result: Result, soon: bool) -> Remedies | None:
    """What to write instead of a file that is impossible; None where the kind cannot say it so.

    soon: beside an answer, where what takes long is left out.
    """
    if kind.remedies is not None:
        return kind.remedies(scene, clock, result, soon)
    problem = kind.posed(scene, "").problem
    if kind.possible is None or isinstance(problem, Conic):
        return None
    return remedies(scene, problem, clock, kind.possible, kind.moves)


def _impossible_with(ways: Remedies, result: Result, clock: Clock) -> Explanation:
    shown = replace(result, report={**result.report, **ways.drawn})
    known = ways.conflict, ways.remedies, (), (), ways.message
    return Explanation(shown, *known, clock.seconds, "", ways.any_resolves, ways.unsure)


def by_solving(kind: Kind[S], scene: S, ask: Ask, result: Result) -> Explanation:
    """Sensitivities to every number of a file, or the numbers that would make it possible."""
    clock = Clock(ask.budget, of_others(ask.watch))

    def answer(other: S) -> Result:
        return kind.solve(other, replace(ask, budget=clock.left, watch=clock.watch))

    def posed(other: S) -> Problem | Conic:
        return kind.posed(other, "").problem

    return explained(scene, result, clock, answer, posed, kind.possible, kind.moves)


def explained(
    scene: Any,
    result: Result,
    clock: Clock,
    answer: Callable[[Any], Result],
    posed: Callable[[Any], Problem | Conic],
    possible: Possible[Any] | None = None,
    moves: Callable[[Any], Iterable[Move]] | None = None,
) -> Explanation:
    """Explanation of a result; answer(scene) solves a file, posed(scene) states it.

    possible: whether a changed file has a design, where a kind knows more than by solving it;
    moves: the numbers that may move, where it knows more than the problem's handles.
    """
    if result.status == "infeasible":
        able = possible or possible_by_solving(answer)
        return _impossible(scene, result, clock, able, posed(scene), moves)
    if result.value is None:
        return Explanation(result, message="no design was found in time", seconds=clock.seconds)

    undecided: list[str] = []

    def solved(other: Any) -> float | None:
        try:
            solution = run(posed(other), None, clock.left, watch=clock.watch)[0]
        except SolveError as reason:  # of a changed file: the answer stands
            undecided.append(str(reason))
            return None
        return solution.value if solution.status in CERTAIN else None

    problem = posed(scene)
    try:
        optimum, outcome = run(problem, None, clock.left, watch=clock.watch)
    except SolveError as reason:  # of texts without derivatives: the answer stands
        why = str(reason) if result.status in CERTAIN else UNPROVEN
        return Explanation(result, (), (), binding(result), (), why, clock.seconds)
    if optimum.value is None or optimum.status not in CERTAIN:
        why = _unsolved(result, optimum)
        return Explanation(result, (), (), binding(result), (), why, clock.seconds)
    basis, held = Basis(optimum.value, solved), False
    if isinstance(problem, Problem) and outcome.x is not None:
        x, held = outcome.x, any(variable.discrete for variable, _ in problem.columns)
        basis = at_point(optimum.value, solved, lambda other: _held(posed(other), x), scene, x)
    of_optimum = of_design(scene, result, clock, basis, solved, "", eases(problem), held)
    if not undecided:
        return of_optimum
    gaps = f"{UNDECIDED}: {undecided[0]}"
    return replace(of_optimum, message="; ".join(filter(None, (of_optimum.message, gaps))))


def _unsolved(result: Result, again: Result) -> str:
    """Reason why the answer, solved again without its method, is no basis for sensitivities."""
    if result.status not in CERTAIN:
        return UNPROVEN
    return LATE if again.status == "limit" else OTHER.format(again.method)


def _impossible(
    scene: Any,
    result: Result,
    clock: Clock,
    possible: Possible[Any],
    problem: Problem | Conic,
    moves: Callable[[Any], Iterable[Move]] | None,
) -> Explanation:
    if isinstance(problem, Conic):
        names = tuple(result.proof.get("conflict", ()))
        return Explanation(result, names, message=result.message, seconds=clock.seconds)
    ways = remedies(scene, problem, clock, possible, moves)
    return _impossible_with(ways, result, clock)


def remedies(
    scene: Any,
    problem: Problem,
    clock: Clock,
    possible: Possible[Any],
    moves: Callable[[Any], Iterable[Move]] | None = None,
) -> Remedies:
    """Return the conflict of an impossible file, and each number that alone makes it possible.

    problem: what is solved for the file; its handles, or those of its `relaxed` form, say by their
    keys which numbers are limits or given, and which way is easier. possible: of a changed file;
    moves: the numbers that may move, by default those of the handles.
    """
    relaxed, problem = problem.relaxed is not None, problem.relaxed or problem
    known = _handles(problem)
    groups = (Group((m,)) for m in (moves(scene) if moves else _moves(scene, known)))
    ways = with_least(singles(FeasibilityQuestions(scene, possible, clock), groups), not clock.over)
    blamed = _conflict(problem, known, clock)
    late = "the budget ended before all remedies were tried" if clock.over else ""
    sure = not relaxed and any_resolves(problem, known, blamed, clock)
    return Remedies(tuple(h.name for h in blamed), ways, late, sure)


def _conflict(problem: Problem, known: Sequence[Handle], clock: Clock) -> tuple[Handle, ...]:
    """Return limits in conflict; with what is given where limits alone are not."""
    if any(variable.discrete for variable, _ in problem.columns):
        return ()
    limits = [h for h in known if not h.given]
    return conflict(problem, limits, clock) or conflict(problem, known, clock)


def _moves(scene: Any, known: Sequence[Handle]) -> Iterator[Move]:
    """Yield the numbers of a file that handles name, once each way."""
    places = {n.key: n for n in numbers(scene, defaults=True)}
    named = {(h.key, h.direction): h for h in known if h.key in places}
    for (key, way), handle in named.items():
        role, path = DUTY if handle.given else LIMIT, places[key].path
        yield Move(path, way, role, key, far_first=False, inherits=one_at)


def eases(problem: Problem | Conic) -> dict[str, int]:
    """Return by the keys of a problem's limits: the direction in which they are easier."""
    return {h.key: h.direction for h in _handles(problem) if h.key and not h.given}


def _handles(problem: Problem | Conic) -> tuple[Handle, ...]:
    """Return the handles of a problem; none where its text cannot be traced."""
    try:
        return () if isinstance(problem, Conic) else handles(problem.relaxed or problem)
    except SolveError:
        return ()


def of_design(
    scene: Any,
    result: Result,
    clock: Clock,
    basis: Basis,
    solved: Solved,
    note: str,
    directions: dict[str, int],
    held: bool = False,
) -> Explanation:
    """Return the explanation of a design: solved(scene), the objective with changed whole numbers.

    directions: that ease a limit, by key; held: the basis holds whole numbers and choices.
    """
    value, ranges = basis.value, list[str]()
    wanted = [n for n in numbers(scene) if n.path[1:2] != ("modules",)]  # what is offered

    def near(number: Number) -> tuple[float, float]:
        down, up = basis.kept(scene, number) if held else (basis.step, basis.step)
        if held and clock.over:  # what was not solved in time counts as the same design
            return 0.0, 0.0
        if min(down, up) < basis.step:
            now = float(getattr(number.value, "number", number.value))
            low, high = now * (1.0 - down), now * (1.0 + up)
            unit = getattr(number.value, "unit", "")
            ranges.append(f"{number.key} from {low:.10g} to {high:.10g} {unit}".rstrip())
            small = STEP * min((c for c in (down, up) if c > 0.0), default=0.0)
            return small * (down > 0.0), small * (up > 0.0)
        return down, up

    def easing(number: Number) -> tuple[str, float | None]:
        way = directions.get(number.key, 0)
        return stepped(scene, number, way, value, basis.solved, solved)

    of_numbers = tuple(map(_sure, influences(scene, basis, clock, wanted, easing, near=near)))
    late = f"the time sufficed for {len(of_numbers)} of {len(wanted)} sensitivities"
    late = late if clock.over else note
    if ranges:
        late = "; ".join(filter(None, (late, f"the same design is best with {', '.join(ranges)}")))
    words = BASIS_OF_FIXED_CHOICES if held else f",{BASIS}"
    return Explanation(result, (), (), binding(result), of_numbers, late, clock.seconds, words)


def _sure(found: Influence) -> Influence:
    """Return without a sensitivity by multipliers that is neither side's: it is not unique."""
    sides = [s for s in found.resolved if s is not None]
    slope = found.sensitivity
    if (
        slope is None
        or not sides
        or any(abs(slope - s) <= SLOPE_TOLERANCE * max(1.0, abs(s)) for s in sides)
    ):
        return found
    return replace(found, sensitivity=None)


def _held(problem: Problem | Conic, x: Array) -> Problem:
    assert isinstance(problem, Problem)
    return problem.holding(x)


def at_point(
    value: float, solved: Solved, posed: Callable[[Any], Problem], scene: Any, x: Array
) -> Basis:
    """Return the basis of a point x of posed(scene); without multipliers where x has none."""
    held = posed(scene)
    lower, upper, _ = held.bounds()
    if (lower == upper).all():
        return Basis(value, solved, posed, x, of_fixed(held))
    try:
        known = sensitivities(held, x)
    except SolveError:  # the text cannot be traced, or has no derivatives
        return Basis(value, solved)
    return (
        Basis(value, solved, posed, x, known) if known.stationary(held, x) else Basis(value, solved)
    )
