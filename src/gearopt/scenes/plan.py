"""How a file is answered: steps in order, each of which adds to what is known, on one clock.

No step asks why: remedies and sensitivities begin with an answer, and ask for changed files.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from pydantic import BaseModel

from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Result
from gearopt.scenes.reading.ask import Ask

S = TypeVar("S", bound=BaseModel)  # the scene of a kind
Run = Callable[[S, Ask, Result | None], Result]


@dataclass(frozen=True)
class Step(Generic[S]):
    """A step of the answer to a file.

    run: the file, what is asked in the time that is left, and what is known so far (None at first)
    to what is known with this step. own: it takes the method that is asked for and lists next best
    answers; the others have methods of their own. always: it also follows a step without a design.
    """

    run: Run[S]
    own: bool = True
    always: bool = False


def one_step(run: Run[S]) -> Callable[[S, Ask], Sequence[Step[S]]]:
    """Steps of a kind that answers in one."""
    return lambda scene, ask: (Step(run),)


def carried_out(steps: Sequence[Step[S]], scene: S, ask: Ask) -> Result:
    """Result of steps in order, of which one without a design ends those that need one."""
    clock, known = Clock(ask.budget, ask.watch), None
    for step in steps:
        if known is None or known.design or step.always:
            asked = ask if step.own else replace(ask, method=None, top=1)
            known = step.run(scene, replace(asked, budget=clock.left), known)
    assert known is not None
    return replace(known, seconds=clock.seconds)
