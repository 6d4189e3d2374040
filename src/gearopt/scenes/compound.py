"""kind = "compound": two gear pairs in series whose ratio comes nearest to a given one."""

from dataclasses import replace
from fractions import Fraction
from typing import Annotated

from pydantic import Field

from gearopt.errors import SolveError
from gearopt.formulations import compound
from gearopt.optimise.comparing.trial import Model
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.result import Result
from gearopt.optimise.solve import run
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.fields import Table, number, whole, words
from gearopt.scenes.reading.lists import span

__all__ = ["EXAMPLE", "Scene", "compared", "explain", "model", "solve"]
ASSUMED = "Tooth numbers alone: modules, centre distances and loads are not looked at."
EXAMPLE = """\
gearopt = 1
kind = "compound"
title = "A compound train of 6.931 to 1"

[train]
ratio = 6.931                  # input over output speed
teeth = [12, 60]               # of any of the four gears
"""


class Train(Table):
    """The train: two pairs in series, the second driver on the shaft of the first driven gear."""

    ratio: Annotated[Fraction, number(6.931, 0, 10**6)] = Field(
        description="Ratio to come near to, input over output speed"
    )
    teeth: Annotated[tuple[int, int], span(whole(12, 5, 400), [12, 60])] = Field(
        description="Least and most teeth of any gear"
    )


class Scene(Table):
    """A compound gear train."""

    title: Annotated[str, words()] = Field("", description="A line for the report")
    source: Annotated[str, words()] = Field(
        "", description="Where the data and the expected value come from"
    )
    train: Train


def solve(scene: Scene, ask: Ask) -> Result:
    """The teeth whose ratio is nearest."""
    result, outcome = run(
        model(scene, "").problem, ask.method, ask.budget, ask.seed, ask.watch, ask.gap
    )
    result = replace(result, objective=result.objective | {"unit": ""})
    if result.value is None or outcome.x is None:
        return result
    z1, z2, z3, z4 = (round(float(z)) for z in outcome.x)
    ratio = Fraction(z3 * z4, z1 * z2)
    design = {
        "driver_teeth": [z1, z2],
        "driven_teeth": [z3, z4],
        "ratio": float(ratio),
        "ratio_error_percent": 100.0 * float(ratio / scene.train.ratio - 1),
    }
    return replace(result, design=design, report={"assumptions": [ASSUMED]})


def explain(scene: Scene, ask: Ask) -> Explanation:
    """There is nothing to explain: some train is always nearest."""
    raise SolveError("explain is for drives; of a compound train the nearest is always found")


def compared(scene: Scene) -> tuple[str, ...]:
    """The methods of a comparison that names none."""
    return ("exact", "annealing", "nsga2")


def model(scene: Scene, method: str) -> Model:
    """The problem of every method."""
    train = compound.Compound(scene.train.ratio, scene.train.teeth)
    return Model(compound.problem(train), "Four whole tooth numbers")
