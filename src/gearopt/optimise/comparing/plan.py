"""Plan of a comparison: problems, the budget of every run, and who follows it."""

from collections.abc import Callable

from gearopt.frozen import dataclass
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Event

EVALUATIONS, SECONDS, SEEDS = 20_000, 2.0, 25


@dataclass(frozen=True)
class Model:
    """A problem with its name for a reader, and the unit of its objective."""

    problem: Problem | Conic
    words: str = ""
    unit: str = ""


@dataclass(frozen=True)
class Plan:
    """The budget of every run, and the number of seeds of random methods."""

    evaluations: int = EVALUATIONS
    seconds: float = SECONDS
    seeds: int = SEEDS


@dataclass(frozen=True)
class Progress:
    """Where a comparison is: runs done and in all, the present one, and the time left [s]."""

    done: int
    total: int
    method: str
    seed: int
    left: float
    event: Event | None = None


Follow = Callable[[Progress], bool]
