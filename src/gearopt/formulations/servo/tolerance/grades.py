"""One of several grades (tolerance, cost) for every component, at minimum cost within one budget.

    minimise  sum cost_i   subject to   sum s_i t_i <= E   or   (sum (s_i t_i)^2)^(1/2) <= E

Both rules add up weights, s t/E or (s t/E)^2, to 1 at most: the multiple-choice knapsack. `exact`
solves it by dynamic programming, in whole numbers where all that is given are whole numbers and
fractions: after every component, the pairs of sums are kept that no other pair is better than in
both; the minimum weight of the components still to come prunes. `conic.milp` states the same with
one 0-1 variable a grade.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from numbers import Rational
from typing import Any, Literal, get_args

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.dual import ROUNDING
from gearopt.optimise.pareto.posed import caps
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms, Var, each

RANDOM = False
COUNTS = "pair of weight and cost"
TIE = 1e-12  # by which weights in double may exceed the limit; fractions may not at all
FITS = 2**62  # sums of whole numbers below it are of 64 bits, else of Python's own

Rule = Literal["worst_case", "rss"]
Amount = int | float | Fraction


@dataclass(frozen=True)
class Graded:
    """A component: sensitivity s >= 0 and its grades (tolerance t [mm] > 0, cost)."""

    name: str
    sensitivity: Amount
    grades: tuple[tuple[Amount, Amount], ...]


@dataclass(frozen=True)
class Choice:
    """Components to be graded, and the error > 0 that a rule allows them together."""

    components: tuple[Graded, ...]
    error: Amount
    rule: Rule = "worst_case"

    def __post_init__(self) -> None:
        if self.rule not in get_args(Rule) or not self.error > 0 or not self.components:
            raise ValueError("a choice needs components, an error > 0, worst_case or rss")
        for component in self.components:
            if (
                not component.grades
                or component.sensitivity < 0
                or any(t <= 0 for t, _ in component.grades)
            ):
                raise ValueError(f"{component.name}: needs grades t > 0 and a sensitivity >= 0")

    @property
    def rational(self) -> bool:
        """Return whether every number is a whole number or a fraction."""
        numbers = [self.error, *(c.sensitivity for c in self.components)]
        numbers += [v for c in self.components for grade in c.grades for v in grade]
        return all(isinstance(v, Rational) for v in numbers)

    @property
    def weights(self) -> list[list[Any]]:
        """Return the weight of every grade of every component; fractions where all is rational."""
        number: Any = Fraction if self.rational else float
        power = 1 if self.rule == "worst_case" else 2
        return [
            [(number(c.sensitivity) * number(t) / number(self.error)) ** power for t, _ in c.grades]
            for c in self.components
        ]

    @property
    def costs(self) -> list[list[Any]]:
        """Return the cost of every grade of every component; fractions where all is rational."""
        number: Any = Fraction if self.rational else float
        return [[number(cost) for _, cost in c.grades] for c in self.components]


def problem(choice: Choice, names: Sequence[str] = ("cost",), lost: float = 0.0) -> Problem:
    """Pose the choice: variables are grades, counted from 1; `exact` proves the cheapest.

    names: "cost" and "error", both for `exact` to prove the whole front. lost: what is added to the
    error.
    """
    weights, costs = (
        [np.array(row, float) for row in rows] for rows in (choice.weights, choice.costs)
    )
    widths = [np.array([float(t) for t, _ in c.grades]) for c in choice.components]

    def evaluate(x: Any, p: Any) -> Terms:
        at = [_position(grade) for grade in each(x.grade)]
        cost, weight = (
            sum(row[k] for row, k in zip(rows, at, strict=True)) for rows in (costs, weights)
        )
        used = weight if choice.rule == "worst_case" else weight**0.5
        t = tuple(row[k] for row, k in zip(widths, at, strict=True))
        goals = {"cost": cost, "error": lost + float(choice.error) * used}
        kept = {name: goals[name] for name in names}
        return Terms(kept, {choice.rule: used}, report={"tolerance_mm": t})

    most = tuple(float(len(row)) for row in costs)
    grade = Var("grade", "", 1.0, most, 1.0, len(costs), integer=True)
    methods = {"exact": _exact(choice) if len(names) == 1 else _front(choice)}
    return Problem("grades", (grade,), (), evaluate, methods=methods, vectorised=True)


def _position(grade: Any) -> Any:
    if not isinstance(grade, float | np.ndarray | np.generic):
        raise SolveError("grades are looked up in tables: for exact, annealing and nsga2 only")
    return np.rint(grade).astype(int) - 1


def _exact(choice: Choice) -> Any:
    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Run a dynamic program over all picks; the seed changes nothing."""
        clock = Clock(budget, watch)
        picks, none = _picked(choice, clock)
        if none is not None:
            return none
        position = picks.positions(np.array([picks.count - 1]))[0]
        costs = [float(row[k]) for row, k in zip(choice.costs, position, strict=True)]
        rounding = ROUNDING * sum(map(abs, costs))
        return Outcome(
            position + 1.0,
            bound=sum(costs) - (0.0 if choice.rational else rounding),
            proof=_proof(choice, picks, clock),
            evaluations=clock.evaluations,
        )

    return exact


def _front(choice: Choice) -> Any:
    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """All picks that none beats: those that the dynamic program keeps in the end."""
        clock = Clock(budget, watch)
        picks, none = _picked(choice, clock)
        if none is not None:
            return replace(none, x=None)
        points, known = picks.positions(np.arange(picks.count)) + 1.0, caps(problem)
        values, names = problem.batch(points).F, problem.rows.objectives
        limits = np.array([known.get(name, np.inf) for name in names])
        inside = points[(values <= limits * (1.0 + TIE)).all(axis=1)]
        proof, looked = _proof(choice, picks, clock), clock.evaluations
        if len(inside):
            return Outcome(inside[0], others=tuple(inside[1:]), proof=proof, evaluations=looked)
        text = "no grades within the budget keep to the largest values of interest"
        return Outcome(None, infeasible=True, proof=proof, evaluations=looked, message=text)

    return exact


def _picked(choice: Choice, clock: Clock) -> tuple["Picked", Outcome | None]:
    """Grades that the program keeps; and the outcome where there are none, or it was stopped."""
    rows, limit, _ = _numbers(choice)
    picks = picked(*rows, limit, clock)
    if not picks.finished:
        finest = np.array([min(range(len(w)), key=w.__getitem__) for w in choice.weights])
        words = "stopped by the budget: the finest grades"
        return picks, Outcome(finest + 1.0, False, evaluations=clock.evaluations, message=words)
    if not picks.count:
        return picks, _impossible(choice, _proof(choice, picks, clock), limit)
    return picks, None


def _proof(choice: Choice, found: "Picked", clock: Clock) -> dict[str, Any]:
    return {
        "method": "exhausted",
        "arithmetic": _numbers(choice)[2],
        "pairs": clock.evaluations,
        "pairs_kept": found.largest,
        "sentence": f"Proof: dynamic programming over all choices, {clock.evaluations:,} pairs of "
        "error and cost examined.",
    }


def _numbers(choice: Choice) -> tuple[tuple[list[Any], list[Any]], Any, str]:
    """Return weights and costs to be added up, the limit of the weights, and the arithmetic."""
    if choice.rational:
        weights, limit = whole(choice.weights)
        return (weights, whole(choice.costs)[0]), limit, "rational"
    rows = [[np.array(row) for row in part] for part in (choice.weights, choice.costs)]
    return (rows[0], rows[1]), 1.0 + TIE, f"double, weights to {TIE:g}"


def _impossible(choice: Choice, proof: dict[str, Any], limit: Any) -> Outcome:
    """Return the claim that the finest grades break the budget, with the fewest that do."""
    finest = [min(row) for row in choice.weights]  # the minimum weight
    allowed = 1 if choice.rational else limit
    order = sorted(range(len(finest)), key=lambda k: -finest[k])
    sums = [sum(finest[k] for k in order[:count]) for count in range(len(order))]
    count = next((count for count, used in enumerate(sums) if used > allowed), len(order))
    names = [choice.components[k].name for k in order[:count]]
    message = f"the finest grades of {', '.join(names)} alone exceed the budget {choice.rule}"
    proof |= {"conflict": [choice.rule], "components": names, "sentence": f"Proof: {message}."}
    return Outcome(None, infeasible=True, proof=proof, message=message)


@dataclass(frozen=True)
class Picked:
    """The pairs of weight and cost that no other is better than in both, by rising weight.

    count: how many; none where nothing is within the weight, or it was stopped. trail: of every
    component the pair before it, and the position picked, of each pair kept. finished: all was
    examined. largest: number of pairs kept at once.
    """

    count: int
    finished: bool
    largest: int
    trail: Sequence[tuple[Any, Any]] = ()

    def positions(self, places: Any) -> Any:
        """Return the positions picked, from 0, (places, components), of some of the pairs."""
        chosen = []
        for before, position in reversed(self.trail):
            chosen.append(position[places])
            places = before[places]
        return np.column_stack(chosen[::-1])


def picked(
    weights: Sequence[Array],
    costs: Sequence[Array],
    limit: Any,
    clock: Clock,
) -> Picked:
    """Return the sums of costs and weights <= limit that no other beats; the last is the cheapest.

    weights, costs: one array per component, of doubles or whole numbers; the clock counts pairs and
    is asked before each component.
    """
    lightest = [w.min() for w in weights]
    later = [sum(lightest[k + 1 :]) for k in range(len(weights))]
    weight, cost = 0 * weights[0][:1], 0 * costs[0][:1]
    trail, largest = [], 1
    for own_weight, own_cost, rest in zip(weights, costs, later, strict=True):
        if not clock.tell():
            return Picked(0, False, largest)
        weight = np.add.outer(weight, own_weight).ravel()
        cost = np.add.outer(cost, own_cost).ravel()
        clock.evaluations += len(weight)
        order = _best(weight, cost, np.flatnonzero(weight + rest <= limit))
        if not len(order):
            return Picked(0, True, largest)
        trail.append(np.divmod(order, len(own_weight)))
        weight, cost = weight[order], cost[order]
        largest = max(largest, len(order))
    return Picked(len(cost), True, largest, trail)


def _best(weight: Array, cost: Array, inside: Any) -> Any:
    """Return the places, by rising weight, of the pairs that are cheaper than every lighter one."""
    order = inside[np.argsort(cost[inside], kind="stable")]
    order = order[np.argsort(weight[order], kind="stable")]
    lowest = np.minimum.accumulate(cost[order])
    cheaper = np.ones(len(order), bool)
    cheaper[1:] = cost[order][1:] < lowest[:-1]
    return order[cheaper]


def whole(rows: Sequence[Sequence[Fraction]]) -> tuple[list[Any], int]:
    """Return rows of fractions as whole numbers of their common denominator, and that."""
    unit = math.lcm(*(v.denominator for row in rows for v in row))
    numbers = [[int(v * unit) for v in row] for row in rows]
    most = unit + sum(max(map(abs, row)) for row in numbers)
    kind: Any = np.int64 if most < FITS else object
    return [np.array(row, dtype=kind) for row in numbers], unit
