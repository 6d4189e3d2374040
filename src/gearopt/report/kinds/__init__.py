"""What page and terminal show of each kind of result.

Each module here is a kind, of the name that its scene has, and holds a `Kind` called KIND. Nothing
is registered: a kind without a module, and a problem of a user's own, are shown as `generic` says.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.section import Section, Tile

MakeSection = Callable[[Result, Measures], Section | None]  # None: nothing to show of it


def _nothing(result: Result, measures: Measures) -> Sequence[Any]:
    return ()


def _silent(result: Result) -> str:
    return ""


@dataclass(frozen=True)
class Kind:
    """Sections in the order of the page, and those that the terminal shows in its own order.

    tiles: key figures beside objective and bound. beside: sentences after the proof about what
    else was solved. elsewhere: limits that another table shows, in their own unit. decides:
    what decides a design, "" where its limits say it; figures: what ends that sentence where no
    key figures stand beside. warns: sentences to be read before the numbers. drawn: whether there
    is a drawing of its designs. whole: what a limit of no single stage belongs to, the head of that
    column. given: what is shown of designs that were given, where that is something else.
    """

    sections: tuple[MakeSection, ...]
    terminal: tuple[MakeSection, ...]
    tiles: Callable[[Result, Measures], Sequence[Tile]] = _nothing
    beside: Callable[[Result, Measures], Sequence[str]] = _nothing
    elsewhere: Callable[[Result], Collection[str]] = _silent
    decides: Callable[[Result], str] = _silent
    figures: Callable[[Result], str] = _silent
    warns: Callable[[Result], Sequence[str]] = _silent
    drawn: bool = True
    whole: str = "design"
    given: "Kind | None" = None


def kind_of(result: Result) -> Kind:
    """Return what is shown of a result: what its kind says, else what all kinds have."""
    found = kind_named(result.scene)
    return found.given if found.given and result.given else found


def kind_named(name: str | None) -> Kind:
    """Return what is shown of a kind of this name."""
    known = name in {module.name for module in iter_modules(__path__)}
    found: Kind = import_module(f"{__name__}.{name if known else 'generic'}").KIND
    return found
