"""How a file is answered: steps in order, each of which adds to what is known, on one clock.

No step asks why: remedies and sensitivities begin with an answer, and ask for changed files.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Generic, TypeVar

from pydantic import BaseModel

from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Result
from gearopt.scenes.reading.ask import Ask

S = TypeVar("S", bound=BaseModel)  # the scene of a kind
Run = Callable[[Any, Ask, Result | None], Result]


def _file(scene: BaseModel) -> BaseModel:
    """The file as it is read."""
    return scene


@dataclass(frozen=True)
class Step(Generic[S]):
    """A step of the answer to a file.

    run: what is posed, what is asked in the time that is left, and what is known so far (None at
    first) to what is known with this step. posed: what the file states, in plain numbers; by
    default the file itself. own: it takes the method that is asked for and lists next best
    answers; the others have methods of their own. always: it also follows a step without a design.
    """

    run: Run
    posed: Callable[[S], Any] = _file
    own: bool = True
    always: bool = False


def one_step(run: Run) -> Callable[[S, Ask], Sequence[Step[S]]]:
    """Steps of a kind that answers in one."""
    return lambda scene, ask: (Step(run),)


def carried_out(
    steps: Sequence[Step[S]], scene: S, ask: Ask, known: Result | None = None
) -> Result:
    """Result of steps in order, of which one without a design ends those that need one.

    known: what is known before the first of them.
    """
    clock = Clock(ask.budget, ask.watch)
    for step in steps:
        if known is None or known.design or step.always:
            asked = ask if step.own else replace(ask, method=None, top=1)
            posed = step.posed(scene)
            known = step.run(posed, replace(asked, budget=clock.left), known)
    assert known is not None
    return replace(known, seconds=clock.seconds)
