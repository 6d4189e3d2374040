"""Whether a changed file has a design: the question of the search for remedies to a kind."""

from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import THERE, Result

S = TypeVar("S", contravariant=True)
WORDS = {True: "feasible", False: "infeasible", None: "undecided"}


@dataclass(frozen=True)
class Verdict:
    """Whether a file has a design.

    answer: None where that is not known in time. excess: the largest utilisation over 1 of the
    nearest design that is known, at most 0 where it is one; None: only the answer is known.
    """

    answer: bool | None
    excess: float | None = None


UNKNOWN = Verdict(None)


class Possible(Protocol[S]):
    """Answers whether a scene, which the rules of its file take, has a design, within a clock."""

    def __call__(self, scene: S, clock: Clock, /) -> Verdict:
        """Return the verdict."""


def of_status(status: str) -> Verdict:
    """Verdict of the status of a file that was solved."""
    return Verdict(True if status in THERE else (False if status == "infeasible" else None))


def possible_by_solving(answer: Callable[[Any], Result]) -> Possible[Any]:
    """Answers by solving each changed file: answer(scene)."""
    return lambda scene, clock: of_status(answer(scene).status)


def without_design(result: Result) -> bool:
    """Whether no design meets the limits, or none was found and how near one came is told."""
    return result.status == "infeasible" or bool("nearest" in result.report and not result.design)
