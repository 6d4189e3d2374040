"""Page and terminal of each kind of result.

Each module here is a kind, of the name that its scene has, and holds `Pages` called PAGES. Nothing
is registered: a kind without a module, and a problem of a user's own, have those of `generic`.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import field
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.section import Section, Tile

MakeSection = Callable[[Result, Measures], Section | None]  # None: nothing to show of it

Export = Callable[[Result], bytes]  # ValueError, ImportError: why there is none


def _nothing(result: Result, measures: Measures) -> Sequence[Any]:
    return ()


def _no_words(result: Result, measures: Measures) -> str:
    return ""


def _silent(result: Result) -> str:
    return ""


@dataclass(frozen=True)
class Pages:
    """Sections in the order of the page, and those that the terminal shows in its own order.

    tiles: key figures beside objective and bound. sentences_on_parts: after the proof, about the
    other problems that were solved. elsewhere: limits that another table shows, in their own unit.
    binding_limit: in words what decides a design, "" where its limits say it; figures: the end of
    that sentence where no key figures stand beside. warns: sentences to be read before the numbers.
    drawn: whether there is a drawing of its designs. whole: what a limit of no single stage
    belongs to, the head of that column. exports: files for other programs, by their format.
    pages_of_given: those of designs that were given, where they are others.
    """

    sections: tuple[MakeSection, ...]
    terminal: tuple[MakeSection, ...]
    tiles: Callable[[Result, Measures], Sequence[Tile]] = _nothing
    sentences_on_parts: Callable[[Result, Measures], Sequence[str]] = _nothing
    elsewhere: Callable[[Result], Collection[str]] = _silent
    binding_limit: Callable[[Result, Measures], str] = _no_words
    figures: Callable[[Result], str] = _silent
    warns: Callable[[Result, Measures], Sequence[str]] = _nothing
    drawn: bool = True
    whole: str = "design"
    exports: Mapping[str, Export] = field(default_factory=dict)
    pages_of_given: "Pages | None" = None


def pages_of_result(result: Result) -> Pages:
    """Pages of a result: those of its kind, else those that all kinds have."""
    pages = pages_of(result.scene)
    return pages.pages_of_given if pages.pages_of_given and result.given else pages


def pages_of(name: str | None) -> Pages:
    """Sections, key figures and warnings of a kind."""
    known = name in {module.name for module in iter_modules(__path__)}
    pages: Pages = import_module(f"{__name__}.{name if known else 'generic'}").PAGES
    return pages
