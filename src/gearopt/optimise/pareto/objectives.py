"""Several objectives of one problem, as a file or a user poses them.

Kinds of files import it when they are loaded; the methods that find fronts stand in `tradeoff`.
"""

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Outcome
from gearopt.optimise.terms import Array, Terms, Var

EXACT, EPSILON = "exact", "epsilon"  # methods of fronts that kinds of files choose by

Caps = dict[str, float]  # largest values of objectives that the user states


@dataclass(frozen=True)
class Objective:
    """An objective: its name and unit, and the largest value of interest (None: any)."""

    name: str
    unit: str = ""
    most: float | None = None


@dataclass(frozen=True)
class Limiting:
    """How a kind of problem poses one objective under limits on others, for a method of its own.

    problem(name, most): minimise one objective, others at most as large; variables are those of the
    whole problem. names: objectives that may be limited. whole: there are finitely many designs, so
    that steps from one to the next end where there is none.
    """

    problem: Callable[[str, Caps], Problem]
    names: tuple[str, ...]
    whole: bool = False


@dataclass(frozen=True)
class Tradeoff:
    """A problem, its objectives in order, and the design of a point as its file shows it.

    limiting: how it is posed with one objective under limits on others, by a method of its own.
    others: the same with other numbers of stages; the front is of all together. part: which of
    these this is, in words. scope: the designs that it is a front of, where these are not all.
    """

    problem: Problem | Conic
    objectives: tuple[Objective, ...]
    drawn: Callable[[Array], Mapping[str, Any]] | None = None
    limiting: Limiting | None = None
    others: tuple["Tradeoff", ...] = ()
    part: str = ""
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


def traded(problem: Problem | Conic, names: Sequence[str] | None) -> Tradeoff:
    """Return the objectives of a problem of one's own; by default all that it minimises."""
    known = problem.objectives if isinstance(problem, Conic) else problem.rows.objectives
    chosen = chosen_of(names or known, known, problem.name)
    return Tradeoff(problem, tuple(Objective(name) for name in chosen))


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
