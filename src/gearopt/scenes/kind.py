"""A kind of problem file: its tables, its examples, and how it is solved and explained.

The package of a kind ends with `KIND = Kind(...)`; all that kinds share asks it by these names. A
field that is missing or misspelt fails when the kind is imported.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic

from pydantic import BaseModel

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.pareto.objectives import Tradeoff
from gearopt.optimise.result import Result
from gearopt.scenes.explaining.possible import Possible
from gearopt.scenes.plan import S, Step, carried_out
from gearopt.scenes.reading.ask import Ask

if TYPE_CHECKING:
    from gearopt.optimise.explaining.explanation import Explanation, Remedies
    from gearopt.scenes.explaining.moves import Move


@dataclass(frozen=True)
class Example:
    """A problem file to start from. about: a few words for lists of examples; text: TOML."""

    about: str
    text: str


def examples_in(package: str, about: Mapping[str, str]) -> dict[str, Example]:
    """Return the files of the folder `examples` beside a module, by name without their ending."""
    folder = Path(package).parent / "examples"
    return {
        name: Example(words, (folder / f"{name}.toml").read_text(encoding="utf-8"))
        for name, words in about.items()
    }


def _nothing_posed(scene: BaseModel, method: str) -> Model:
    raise SolveError("this kind of file poses no problem that methods could be compared on")


def _no_methods_to_compare(scene: BaseModel) -> tuple[str, ...]:
    return ()


def _no_next_best(scene: BaseModel, method: str | None) -> dict[str, str]:
    return {"top": "no next best answers are listed"}


def _no_assumptions(scene: BaseModel) -> list[str]:
    return []


def _no_objectives(scene: BaseModel) -> dict[str, str]:
    return {}


def _no_front(scene: BaseModel, names: Sequence[str], ask: Ask) -> Tradeoff:
    raise SolveError("this kind of file has no objectives to weigh against each other")


def _no_notes(scene: BaseModel, names: Sequence[str]) -> list[str]:
    return []


def _no_advice(scene: BaseModel, unknown: Sequence[str]) -> str:
    return ""


@dataclass(frozen=True)
class Trades(Generic[S]):
    """The fronts of a kind.

    objectives: name and unit of all that a front of a file may minimise. traded: the problem of
    these objectives for the method asked, None for the one that proves most; what must be solved
    before, within the budget asked. advice: what to write for
    names that are no objectives of this file; "" where nothing would make them so. notes: sentences
    on how the objectives named are computed.
    """

    objectives: Callable[[S], Mapping[str, str]] = _no_objectives
    traded: Callable[[S, Sequence[str], Ask], Tradeoff] = _no_front
    advice: Callable[[S, Sequence[str]], str] = _no_advice
    notes: Callable[[S, Sequence[str]], list[str]] = _no_notes


NO_TRADES: Trades[Any] = Trades()


@dataclass(frozen=True, kw_only=True)
class Kind(Generic[S]):
    """A kind of problem file.

    scene: the tables of a file. examples: by name, the first that of the kind itself. steps: how a
    file is answered. posed: the problem that a method solves, for comparisons.
    methods_to_compare: those of a comparison that names none. methods: those that the kind has
    beside the back ends.
    possible: whether a changed file has a design, for remedies; None: by solving it. moves: the
    numbers that a remedy may move; None: those of its relaxed form.
    remedies: what to write instead of an impossible file, from its result, which says why; soon:
    beside an answer, where what takes long is left out; None: none are known soon; by default by
    `possible` and `moves`. remedied: whether a file has them; others, and those of a kind without:
    by solving changed files.
    influences: what every number does to an answer, in what time is left; None: by solving changed
    files. assumptions: sentences on what every answer to the file takes for granted. trades: its
    fronts. rate: the rating of given gears; rate_design: of a design that
    was found. idle: the options of `solve` that change nothing, each
    with the reason.
    """

    scene: type[S]
    examples: Mapping[str, Example]
    steps: Callable[[S, Ask], Sequence[Step[S]]]
    posed: Callable[[S, str], Model] = _nothing_posed
    methods_to_compare: Callable[[S], tuple[str, ...]] = _no_methods_to_compare
    methods: tuple[str, ...] = ()
    possible: Possible[S] | None = None
    moves: "Callable[[S], Iterable[Move]] | None" = None
    remedies: "Callable[[S, Clock, Result, bool], Remedies | None] | None" = None
    remedied: Callable[[S], bool] = lambda scene: True
    influences: "Callable[[S, Ask, Result], Explanation] | None" = None
    assumptions: Callable[[S], list[str]] = _no_assumptions
    trades: Trades[S] = NO_TRADES
    rate: Callable[[S, Ask], Result] | None = None
    rate_design: Callable[[S, Ask, Mapping[str, Any]], Result] | None = None
    idle: Callable[[S, str | None], dict[str, str]] = _no_next_best

    def solve(self, scene: S, ask: Ask) -> Result:
        """Answer to a file, without remedies where it is impossible."""
        return carried_out(self.steps(scene, ask), scene, ask)

    def has_remedies(self, scene: S) -> bool:
        """Whether the kind knows what to write instead of a file that is impossible."""
        known = self.remedies is not None or None not in (self.possible, self.moves)
        return known and self.remedied(scene)

    @property
    def example(self) -> Example:
        """The example of the kind itself."""
        return next(iter(self.examples.values()))
