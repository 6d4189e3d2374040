"""A public problem: its text, its box, and the optimum that its source quotes."""

import inspect
from collections.abc import Callable
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var

Ends = tuple[tuple[float, float, bool], ...]


@dataclass(frozen=True)
class Case:
    """A problem to be minimised.

    optimum: as quoted. box: ends of every variable, whether it is whole. text(*x) -> objective and
    limits, which are comparisons. guess: else the middle of the box. note: on the quoted optimum.
    """

    name: str
    optimum: float
    box: Ends
    text: Callable[..., tuple[Any, list[Any]]]
    guess: tuple[float, ...] | None = None
    note: str = ""

    def problem(self) -> Problem:
        """The problem, new at each call, so that nothing is kept from another run."""
        names = tuple(inspect.signature(self.text).parameters)
        if len(names) != len(self.box):  # a text of *x
            names = tuple(f"x{k}" for k in range(1, len(self.box) + 1))
        middle = tuple(
            float((low + high) // 2 if whole else 0.5 * (low + high))
            for low, high, whole in self.box
        )
        variables = tuple(
            Var(name, "", low, high, start, integer=whole)
            for name, (low, high, whole), start in zip(
                names, self.box, self.guess or middle, strict=True
            )
        )

        def evaluate(x: Any, p: Any) -> Terms:
            objective, limits = self.text(*(getattr(x, name) for name in names))
            rows = {f"g{k}": row for k, row in enumerate(limits, 1)}
            return Terms({"f": objective}, rows)

        return Problem(self.name, variables, (), evaluate)


def real(low: float, high: float) -> Ends:
    """The ends of one real variable; times n: of n."""
    return ((float(low), float(high), False),)


def whole(low: float, high: float) -> Ends:
    """The ends of one whole variable; times n: of n."""
    return ((float(low), float(high), True),)
