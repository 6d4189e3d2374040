"""Designs of a drive by the design processes that its file asks for, as parts of the answer."""

from dataclasses import replace

from gearopt.errors import SolveError
from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.design import describe
from gearopt.optimise.certificate import reconcile
from gearopt.optimise.certified import run
from gearopt.optimise.clock import in_part
from gearopt.optimise.result import Result
from gearopt.optimise.typed import untyped
from gearopt.scenes.drive.rating.rated import with_rating
from gearopt.scenes.drive.scene import PROCESSES, Scene
from gearopt.scenes.drive.sizing import whole_teeth
from gearopt.scenes.reading.ask import Ask


def by_processes(scene: Scene, ask: Ask, best: Result) -> Result:
    """The exact answer with the designs of the processes as parts, under its bound."""
    asked = [name for name in PROCESSES if getattr(scene, name) is not None]
    if not asked or best.status == "infeasible" or ask.method not in (None, "exact"):
        return best
    train = scene.train()
    problem = whole_teeth(scene, train)
    parts, remarks = [], list(best.report.get("notes", []))
    for name in asked:
        words, method = name.replace("_", " "), name.replace("_", "-")
        try:
            watch = in_part(ask.watch, train.unit, words)
            part, outcome = run(problem, method, ask.budget, ask.seed, watch, ask.gap)
        except SolveError as reason:
            remarks.append(f"There is no design by {words}: {reason}.")
            continue
        design = (
            {} if outcome.x is None else untyped(describe(train, teeth.pairs(train, outcome.x)))
        )
        part = replace(part, objective=part.objective | {"unit": train.unit}, design=design)
        parts.append(with_rating(scene, reconcile(replace(part, name=words), best, ask.gap)))
    return replace(best, parts=(*best.parts, *parts), report=best.report | {"notes": remarks})
