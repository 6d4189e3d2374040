"""kind = "checked": whether a compound train of another file misses a ratio by little enough."""

from dataclasses import replace
from typing import Annotated

from pydantic import Field

from gearopt.optimise.problem import Problem
from gearopt.optimise.solve import evaluate
from gearopt.optimise.terms import Terms, Var
from gearopt.scenes.kind import Example, Kind
from gearopt.scenes.plan import one_step
from gearopt.scenes.reading.fields import Table, number, words
from gearopt.scenes.reading.linked_files import Input, result_of

TEXT = """\
gearopt = 1
kind = "checked"

[check]
train = "compound.json"
ratio = 6.931
most_error = 0.01
"""


class Check(Table):
    """What is checked."""

    train: Annotated[Input, result_of("compound")] = Field(description="The train")
    ratio: Annotated[float, number(6.931, 0, 10**6)] = Field(description="The ratio it should have")
    most_error: Annotated[float, number(0.01, 0, 1)] = Field(description="What it may miss it by")


class Scene(Table):
    """A check."""

    title: Annotated[str, words()] = Field("", description="A line for the report")
    check: Check


def solve(scene, ask, known):
    """Nothing is minimised: the utilisation of one limit."""
    asked = scene.check
    train = asked.train.result(ask)

    def text(x, p):
        error = abs(x.ratio / float(asked.ratio) - 1.0)
        return Terms({"error": error}, {"error": error / float(asked.most_error)})

    problem = Problem("check", (Var("ratio", "", 0.0, 1e6, 1.0),), (), text)
    result = evaluate(problem, {"ratio": train.design["ratio"]})
    return replace(result, objective=result.objective | {"unit": ""})


KIND = Kind(scene=Scene, examples={"checked": Example("a check", TEXT)}, steps=one_step(solve))
