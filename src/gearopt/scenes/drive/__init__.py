"""kind = "drive": a multi-stage drive of cylindrical gears of minimum volume, mass or length.

With a [teeth] table the answer has whole teeth and standard modules and is proven by exhaustion;
without one, or by the method ipopt, sizes are continuous and proven by a dual bound. What few files
need (layout, rating, remedies) is imported where it is asked for: the command answers sooner.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gearopt.errors import SolveError
from gearopt.formulations.drive.continuous_sizing import problem as real_valued
from gearopt.formulations.drive.train import EXTREMES
from gearopt.optimise.clock import Clock
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.result import Result
from gearopt.scenes.drive import processes, sizing
from gearopt.scenes.drive.counts import best_count
from gearopt.scenes.drive.driving import may_drive
from gearopt.scenes.drive.notes import assumptions, of_objectives
from gearopt.scenes.drive.scene import PROCESSES, Scene
from gearopt.scenes.drive.sizing import (
    SMOOTH,
    drive_of,
    ideal_of_count,
    takes_real_values,
    whole_teeth,
)
from gearopt.scenes.drive.stage_types import by_type, held_as, open_types, words
from gearopt.scenes.drive.trades import advice, objectives, to_choose, traded
from gearopt.scenes.drive.without import without
from gearopt.scenes.explaining.possible import Verdict
from gearopt.scenes.kind import Kind, Trades, examples_in
from gearopt.scenes.plan import Step, carried_out
from gearopt.scenes.reading.ask import Ask, unseeded

if TYPE_CHECKING:
    from gearopt.optimise.explaining.explanation import Explanation, Remedies

METHODS = ("exact", "process-one", "process-two", "sa", "sa-polish", "sa-paper", "smooth")


def steps(scene: Scene, ask: Ask) -> tuple[Step[Scene], ...]:
    """Gears, designs by the processes, their layout; then assumptions and the rating."""
    to_choose(scene)
    if open_types(scene):
        return (Step(of_best_types),)
    last: tuple[Step[Scene], ...] = (Step(with_assumptions, always=True), Step(rated, always=True))
    last += (Step(drawn),) if scene.drawing is not None else ()
    if scene.layout is None:
        return *sizing.steps(scene, ask), *processes.steps(scene, ask), *last
    from gearopt.scenes.drive import layout

    if scene.layout.together and scene.several:
        return Step(layout.of_best_count), *last
    if layout.box_first(scene):
        return *layout.steps(scene), *last
    gears = *sizing.steps(scene, ask, False), *processes.steps(scene, ask, False)
    return *gears, *layout.steps(scene), *last


def of_best_types(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The drive with the best types of its stages, each choice answered as a file of its own."""
    return best_count(
        scene,
        ask,
        ideal_of_count,
        lambda each, asked, _: carried_out(steps(each, asked), each, asked),
    )


def with_assumptions(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The answer with the assumptions of its design."""
    assert known is not None
    return replace(known, report=known.report | {"assumptions": assumptions(scene)})


def every_assumption(scene: Scene) -> list[str]:
    """The assumptions of all choices of types of the stages."""
    return [*dict.fromkeys(text for each in by_type(scene) for text in assumptions(each))]


def rated(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Rating of the gears; CertificateError where it was to limit them and finds them unsafe."""
    assert known is not None
    if known.value is None:
        return known
    from gearopt.scenes.drive.rating.rated import check_safe, rated_afterwards, with_rating

    result = with_rating(scene, known)
    check_safe(scene, result)
    return rated_afterwards(scene, result)


def drawn(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The answer with the data of its gears' drawings: `drawing.with_drawing`."""
    from gearopt.scenes.drive.drawing import with_drawing

    return with_drawing(scene, ask, known)


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    reasons, boxed = {}, scene.layout is not None
    if scene.teeth is None:
        reasons["top"] = (
            "next best answers are listed of whole teeth, which a table [teeth] asks for"
        )
    elif scene.objective.extreme:
        reasons["top"] = (
            f"one design of the least {scene.objective.extreme} is found, of the least volume"
        )
    elif not boxed and method not in (None, "exact"):
        reasons["top"] = f"{method} finds one answer; exact lists the next best ones"
    return reasons if boxed else reasons | unseeded(method)


def methods_to_compare(scene: Scene) -> tuple[str, ...]:
    """Return the methods of a comparison that names none."""
    if scene.layout is None:
        asked = (name.replace("_", "-") for name in PROCESSES if getattr(scene, name) is not None)
        real = ("ipopt",) if not scene.by_ratings else (SMOOTH,) * scene.rated_real
        return ("exact", *asked, *real, "annealing", "nsga2")
    if scene.layout.together:
        return ("exact",) if scene.by_ratings else ("exact", "ipopt")
    return ("exact", "sa", "sa-polish", "multistart", "nsga2")


def posed(scene: Scene, method: str) -> Model:
    """Return the problem that a method solves for this drive; SolveError where it has none.

    With a [layout] that is the layout of the gears that are best without it; with a range of
    numbers of stages the best number.
    """
    to_choose(scene)
    if len(scene.each) > 1:
        best = carried_out(steps(scene, Ask()), scene, Ask())
        if best.value is None:
            raise SolveError("there is no drive to compare: gearopt explain shows why")
        held, count = held_as(scene, best.design), len(best.design["stages"])
        chosen = f"{count} stages" if scene.several else words(held)
        model = posed(held, method)
        return replace(model, words=f"{model.words}, {chosen} (the best)")
    if scene.layout is not None:
        from gearopt.scenes.drive import layout

        bare = without(scene, "layout")
        return layout.posed(scene, method, carried_out(steps(bare, Ask()), bare, Ask()))
    drive = drive_of(scene)
    if takes_real_values(scene, method):
        train = drive.train
        return Model(real_valued(train), "Real-valued teeth and modules", train.unit)
    unit = EXTREMES.get(scene.objective.extreme, drive.train.unit)
    side = f", {drive.train.driver}s drive" * (len(may_drive(scene)) > 1)
    return Model(whole_teeth(drive), f"Whole teeth and standard modules{side}", unit)


def rate(scene: Scene, ask: Ask) -> Result:
    """Rating of gears that are all given: `rated.rate`."""
    if open_types(scene):
        raise SolveError("a rating is of one type for each [[stage]]: write it, and all its gears")
    from gearopt.scenes.drive.rating.rated import rate as rate_given

    return rate_given(scene, ask)


def rate_design(scene: Scene, ask: Ask, design: Mapping[str, Any]) -> Result:
    """Rating of a design that was found: `rated.rate_design`."""
    from gearopt.scenes.drive.rating.rated import rate_design as rate_found

    return rate_found(held_as(scene, design) if open_types(scene) else scene, ask, design)


def possible(scene: Scene, clock: Clock) -> Verdict:
    """Whether a changed drive has a design: `answers.possible`."""
    from gearopt.scenes.drive.explain import answers

    return answers.possible(scene, clock)


def remedies(scene: Scene, clock: Clock, result: Result, soon: bool) -> "Remedies | None":
    """Remedies of an impossible drive (`answers.remedies`).

    soon: of one that ratings limit, its conflict at most; None where that is not known soon.
    """
    from gearopt.scenes.drive.explain import answers

    return answers.remedies(scene, clock, result, soon)


def influences(scene: Scene, ask: Ask, result: Result) -> "Explanation":
    """Sensitivities of a possible drive: `answers.influences`."""
    from gearopt.scenes.drive.explain import answers

    return answers.influences(scene, ask, result)


ABOUT = {  # files in examples, that of the kind first
    "drive": "a multi-stage drive of cylindrical gears of minimum volume, mass or length",
    "rating": "gears that are given, rated by AGMA or ISO 6336",
    "sizing": "a drive of least volume that is safe by its rating",
    "planetary": "a planetary stage of least volume that is safe by ISO 6336",
}
KIND = Kind(
    scene=Scene,
    examples=examples_in(__file__, ABOUT),
    steps=steps,
    posed=posed,
    methods_to_compare=methods_to_compare,
    methods=METHODS,
    possible=possible,
    remedies=remedies,
    influences=influences,
    assumptions=every_assumption,
    trades=Trades(objectives, traded, advice, of_objectives),
    rate=rate,
    rate_design=rate_design,
    idle=idle,
)
