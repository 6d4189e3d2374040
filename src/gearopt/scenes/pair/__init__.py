"""kind = "pair": a spur gear pair, sized or given, and how its teeth share the load."""

from collections.abc import Sequence
from dataclasses import replace

from gearopt.errors import SolveError
from gearopt.formulations.design import drive_design
from gearopt.optimise.clock import Clock
from gearopt.optimise.comparing.runs import Model
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.pareto.several import Several
from gearopt.optimise.result import Result, versions
from gearopt.optimise.typed import untyped
from gearopt.scenes import drive
from gearopt.scenes.drive.blank_tables import misfits
from gearopt.scenes.drive.rating import rated
from gearopt.scenes.pair.assumptions import assumptions
from gearopt.scenes.pair.contact_part import contact_of, level_of
from gearopt.scenes.pair.example import EXAMPLE, MORE_EXAMPLES
from gearopt.scenes.pair.scene import Scene
from gearopt.scenes.reading.ask import Ask, unseeded

__all__ = [
    "EXAMPLE",
    "MORE_EXAMPLES",
    "Scene",
    "compared",
    "explain",
    "idle",
    "model",
    "objectives",
    "several",
    "solve",
]
METHODS = ("exact",)  # its own
NOTHING = "the gears are given, so that nothing is chosen"


def solve(scene: Scene, ask: Ask) -> Result:
    """Size the pair where it is not given, by its rating; then compute its contact."""
    if scene.given:
        return _evaluated(scene, ask)
    sized = drive.solve(scene.drive, ask)
    if sized.value is None:
        return sized
    return _with_contact(scene, replace(sized, name="pair"))


def _with_contact(scene: Scene, result: Result) -> Result:
    """Return a result of a drive of one stage with the contact of its pair."""
    design = drive_design(result.design)
    stage = design.stages[0]
    made = contact_of(scene, stage.pair, (stage.pinion_material, stage.wheel_material))
    told = [*result.report.get("assumptions", []), *assumptions(scene, made)]
    return replace(
        result,
        design=untyped(replace(design, contact=made)),
        report=result.report | {"assumptions": told},
    )


def _evaluated(scene: Scene, ask: Ask) -> Result:
    """Return what is to be known of gears that are given, rated where the file asks for it."""
    if ask.method is not None:
        raise SolveError(f"--method {ask.method} changes nothing here: {NOTHING}; leave it out")
    clock = Clock(ask.budget, ask.watch)
    if scene.rating is not None:
        found = rated.rate(scene.drive, ask)
    else:
        design, blanks = rated.given_design(scene.drive, (scene.given_pair,))
        found = Result(
            name="pair",
            status="evaluated",
            method=level_of(scene),
            objective={},
            certificate={"feasibility": 0.0},
            design=untyped(design),
            report={"notes": [*misfits(blanks, (scene.given_pair,))]},
            evaluations=1,
            seed=ask.seed,
            versions=versions("numpy"),
        )
    return replace(_with_contact(scene, found), seconds=clock.seconds)


def explain(scene: Scene, ask: Ask, result: Result | None = None) -> Explanation:
    """Return what every number of the file does to the size of the pair."""
    return drive.explain(_to_size(scene).drive, ask, result)


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    if scene.given:
        return {"top": f"{NOTHING} and nothing next best either", **unseeded(method)}
    return drive.idle(scene.drive, method)


def compared(scene: Scene) -> tuple[str, ...]:
    """Return the methods of a comparison that names none."""
    return drive.compared(_to_size(scene).drive)


def model(scene: Scene, method: str) -> Model:
    """Return the problem that a method solves to size the pair; SolveError of a given one."""
    return drive.model(_to_size(scene).drive, method)


def objectives(scene: Scene) -> dict[str, str]:
    """Return what a front of pairs may minimise: name and unit."""
    return drive.objectives(_to_size(scene).drive)


def several(scene: Scene, names: Sequence[str], method: str | None) -> Several:
    """Return the problem of a front of sizes."""
    return drive.several(_to_size(scene).drive, names, method)


def _to_size(scene: Scene) -> Scene:
    """Return the pair; SolveError for one that is given."""
    if scene.given:
        raise SolveError(f"{NOTHING}: gearopt solve FILE computes their contact")
    return scene
