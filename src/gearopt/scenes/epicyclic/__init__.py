"""kind = "epicyclic": numbers of teeth of planetary trains, what they do, and whether they fit."""

from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.epicyclic import problem
from gearopt.formulations.epicyclic.design import EpicyclicDesign, describe
from gearopt.formulations.epicyclic.request import ERROR
from gearopt.optimise.certified import run
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.result import Result
from gearopt.optimise.typed import untyped
from gearopt.scenes.epicyclic.explain import remedies
from gearopt.scenes.epicyclic.tables import Scene
from gearopt.scenes.kind import Kind, examples_in
from gearopt.scenes.plan import one_step
from gearopt.scenes.reading.ask import Ask, unseeded

UNRATED = 'Nothing is rated, no module and no face width chosen: kind = "drive" has strength.'
ASSUMED = "Efficiencies of meshes are assumed (unverified): {}."
LOSSES = (
    "Losses are those of the meshes alone, an efficiency of each in the frame of its carrier, "
    "whichever gear drives; bearings, seals and oil are left out. Loads of planets are equal."
)
GEOMETRY = (
    "Teeth have an addendum of one module; interference of internal gears is not computed: the "
    "least difference of teeth of a ring and its planets stands for it, a rule of thumb."
)
LOCKED = "The train locks itself: with these losses no torque at the input turns the output."
SHIFTED = "Centre distances are made equal by profile shifts, which are not computed here."


def solved(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The best train of a file, described."""
    request = scene.request()
    result, outcome = run(problem(request), ask.method, ask.budget, ask.seed, ask.watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": ""})
    if result.value is None or outcome.x is None:
        return result
    teeth = [round(float(z)) for z in outcome.x]
    design = describe(request, teeth)
    eta = scene.efficiency
    assumed = [
        f"{float(getattr(eta, name)):g} at {name}s"
        for name in type(eta).model_fields
        if name not in eta.model_fields_set
    ]
    spoken = {
        LOCKED: design.efficiency == 0.0,
        SHIFTED: request.apart(teeth) > 1e-9,
        ASSUMED.format(", ".join(assumed)): bool(assumed),
        UNRATED: True,
    }
    notes = [words for words, holds in spoken.items() if holds]
    report: dict[str, Any] = {"assumptions": [LOSSES, GEOMETRY], "notes": notes}
    if request.goal == ERROR:
        report["achieved"] = _achieved(design, request.ratio or Fraction(1))
    return replace(result, design=untyped(design), report=report)


def _achieved(design: EpicyclicDesign, asked: Fraction) -> str:
    """The ratio that the best teeth make, beside the one that is asked for."""
    if not (off := design.ratio_error_percent):
        return f"ratio {design.ratio:.10g} exactly"
    return f"ratio {design.ratio:.10g} instead of {float(asked):.10g} ({off:+.3g} %)"


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Options of `solve` that change nothing, each with the reason."""
    return {"top": "a planetary train has no list of next best answers"} | unseeded(method)


def methods_to_compare(scene: Scene) -> tuple[str, ...]:
    """Methods of a comparison that names none."""
    return ("exact", "annealing", "nsga2")


def posed(scene: Scene, method: str) -> Model:
    """The problem of every method."""
    return Model(problem(scene.request()), "Numbers of teeth")


ABOUT = {  # files in examples, that of the kind first
    "epicyclic": "a planetary train: teeth nearest to a ratio, speeds, torques, efficiency",
}
KIND = Kind(
    scene=Scene,
    examples=examples_in(__file__, ABOUT),
    steps=one_step(solved),
    posed=posed,
    methods_to_compare=methods_to_compare,
    methods=("exact",),
    remedies=remedies,
    idle=idle,
)
