"""kind = "compound": two gear pairs in series whose ratio comes nearest to a given one."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field

from gearopt.errors import SolveError
from gearopt.formulations import compound
from gearopt.formulations.compound import wider
from gearopt.frozen import dataclass
from gearopt.optimise.certified import run
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.pareto.objectives import EPSILON, Objective, Tradeoff
from gearopt.optimise.result import Result
from gearopt.optimise.terms import Array
from gearopt.optimise.typed import untyped
from gearopt.scenes.kind import Kind, Trades, examples_in
from gearopt.scenes.plan import one_step
from gearopt.scenes.reading.ask import Ask, unseeded
from gearopt.scenes.reading.fields import ProblemFile, Table, choice, speed_ratio, whole
from gearopt.scenes.reading.lists import span

MIN_TEETH, MAX_TEETH = 5, 400  # teeth of a gear that a file may ask for
METHODS = ("exact",)  # its own
ASSUMED = (
    "Numbers of teeth alone are chosen: modules, centre distances and loads are not considered."
)
NEAREST = {  # by objective: how the nearest ratio is said, and what that is
    compound.ERROR: ("nearest", "relative error of the ratio, |achieved/asked - 1|"),
    compound.SQUARED: ("nearest in 1/ratio", "squared error of 1/ratio, (1/asked - 1/achieved)^2"),
}


class Train(Table):
    """The train: two pairs in series, the second driver on the shaft of the first driven gear."""

    ratio: Annotated[Fraction, speed_ratio(6.931, 0)] = Field(
        description="Ratio to come near to, input over output speed; exactly as written, also as a "
        'fraction such as "127/120"'
    )
    teeth: Annotated[tuple[int, int], span(whole(12, MIN_TEETH, MAX_TEETH), [12, 60])] = Field(
        description="Minimum and maximum teeth of any gear"
    )
    minimise: Annotated[str, choice(compound.ERROR, compound.SQUARED)] = Field(
        compound.ERROR,
        description="ratio_error: the relative error of the ratio, |achieved/asked - 1|; "
        "squared_error: (1/asked - 1/achieved)^2, as in Sandgren's problem",
    )


class Scene(ProblemFile):
    """A compound gear train."""

    train: Train


@dataclass(frozen=True, kw_only=True)
class CompoundDesign:
    """A train as a result holds it; fields are its keys, with their units."""

    driver_teeth: tuple[int, int]
    driven_teeth: tuple[int, int]
    ratio: float
    ratio_error_percent: float


def nearest(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Teeth whose ratio is nearest; `report` and message name the ratio achieved."""
    train = _train(scene)
    problem = compound.problem(train)
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, ask.watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": ""})
    if result.value is None or outcome.x is None:
        return result
    teeth = tuple(round(float(z)) for z in outcome.x)
    z1, z2, z3, z4 = teeth
    ratio = Fraction(z3 * z4, z1 * z2)
    value = float(train.ratio_error(1 / ratio))  # rational until here
    lowest, highest = train.reach
    within = lowest <= train.ratio <= highest
    best, measured = NEAREST[train.goal]
    reach = {
        "ratio": float(train.ratio),
        "teeth": list(train.teeth),
        "least_ratio": float(lowest),
        "most_ratio": float(highest),
        "within": within,
        "wider_teeth": [] if within else wider(train, MIN_TEETH, MAX_TEETH),
    }
    return replace(
        result,
        objective=result.objective | {"value": value},
        gap=0.0 if result.bound == value else result.gap,
        design=_design(train, outcome.x),
        message=" ".join(filter(None, (_out_of_reach(train, reach), result.message))),
        report={
            "assumptions": [ASSUMED, f"Nearest is the train of minimum {measured}."],
            "achieved": _achieved(train, ratio),
            "best": best,
            "reach": reach,
        },
    )


def _design(train: compound.Compound, x: Array) -> dict[str, Any]:
    """Return the train of a point, as a result holds it."""
    z1, z2, z3, z4 = (round(float(z)) for z in x)
    ratio = Fraction(z3 * z4, z1 * z2)
    design: dict[str, Any] = untyped(
        CompoundDesign(
            driver_teeth=(z1, z2),
            driven_teeth=(z3, z4),
            ratio=float(ratio),
            ratio_error_percent=100.0 * float(ratio / train.ratio - 1),
        )
    )
    return design


def objectives(scene: Scene) -> dict[str, str]:
    """Return the objectives that a front of the train may have: name and unit."""
    return {scene.train.minimise: "", compound.LARGEST: ""}


def traded(scene: Scene, names: Sequence[str], ask: Ask) -> Tradeoff:
    """Return the problem of a front; SolveError for a method that does not take whole teeth."""
    if ask.method == EPSILON:
        raise SolveError(f"{EPSILON} is for real-valued sizes; teeth are whole: leave it out")
    train = _train(scene)
    listed = tuple(Objective(name) for name in names)
    return Tradeoff(compound.problem(train, names), listed, lambda x: _design(train, x))


def _achieved(train: compound.Compound, ratio: Fraction) -> str:
    """Return the ratio that the best teeth make, beside the one that is asked for."""
    if ratio == train.ratio:
        return f"ratio {float(ratio):.10g} exactly"
    off = 100.0 * float(ratio / train.ratio - 1)
    percent = f"{off:+,.0f} %" if abs(off) >= 100.0 else f"{off:+.3g} %"
    if abs(off) < 1e-9:
        percent = "less than 1e-9 % off"
    text = f"ratio {float(ratio):.10g} instead of {float(train.ratio):.10g} ({percent})"
    lowest, highest = train.reach
    within = lowest <= train.ratio <= highest
    return text if within else "{}, out of reach of {} to {} teeth".format(text, *train.teeth)


def _out_of_reach(train: compound.Compound, reach: dict[str, Any]) -> str:
    """Return the ratios that these teeth reach, and teeth that reach it; "" where they do."""
    if reach["within"]:
        return ""
    reachable = "Two pairs of {} to {} teeth have ratios from {:.6g} to {:.6g}".format(
        *train.teeth, reach["least_ratio"], reach["most_ratio"]
    )
    end, words = (0, "down to") if train.ratio < 1 else (1, "up to")
    ways = [
        f"teeth = {list(teeth)} ({words} {float(replace(train, teeth=teeth).reach[end]):.6g})"
        for teeth in reach["wider_teeth"]
    ]
    if ways:
        return f"{reachable}. Write {' or '.join(ways)}."
    more = ': kind = "drive" has more stages' if train.ratio >= 1 else ""  # a drive slows down
    return f"{reachable}. No two pairs of {MIN_TEETH} to {MAX_TEETH} teeth reach it{more}."


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    unused = {"top": "a compound train has no list of next best answers"}
    return unused | unseeded(method)


def methods_to_compare(scene: Scene) -> tuple[str, ...]:
    """Return the methods of a comparison that names none."""
    return ("exact", "annealing", "nsga2")


def posed(scene: Scene, method: str) -> Model:
    """Return the problem of every method."""
    return Model(compound.problem(_train(scene)), "Four numbers of teeth")


def _train(scene: Scene) -> compound.Compound:
    return compound.Compound(scene.train.ratio, scene.train.teeth, scene.train.minimise)


ABOUT = {  # files in examples, that of the kind first
    "compound": "two gear pairs in series whose ratio comes nearest to a given one",
}
KIND = Kind(
    scene=Scene,
    examples=examples_in(__file__, ABOUT),
    steps=one_step(nearest),
    posed=posed,
    methods_to_compare=methods_to_compare,
    methods=METHODS,
    trades=Trades(objectives, traded),
    idle=idle,
)
