"""Designs of a drive by the design processes that its file asks for, as parts of the answer."""

from dataclasses import replace

from gearopt.errors import SolveError
from gearopt.formulations.drive import teeth
from gearopt.optimise.certificate import reconcile
from gearopt.optimise.certified import run
from gearopt.optimise.clock import in_part
from gearopt.optimise.result import Result
from gearopt.optimise.typed import untyped
from gearopt.scenes.drive.scene import PROCESSES, Scene
from gearopt.scenes.drive.sizing import Drive, bare_drive, whole_teeth
from gearopt.scenes.plan import Step
from gearopt.scenes.reading.ask import Ask


def steps(scene: Scene, ask: Ask, own: bool = True) -> tuple[Step[Scene], ...]:
    """Steps to the designs by the processes beside an exact answer; own: as of `Step`."""
    if not _processes_asked(scene) or (own and ask.method not in (None, "exact")):
        return ()
    return Step(by_processes, bare_drive, own, always=True), Step(rated, own=own, always=True)


def _processes_asked(scene: Scene) -> list[str]:
    """Return the names of the processes whose tables a file has."""
    return [name for name in PROCESSES if getattr(scene, name) is not None]


def by_processes(drive: Drive, ask: Ask, best: Result | None) -> Result:
    """The exact answer with the designs of the processes as parts, under its bound."""
    from gearopt.formulations.drive.design import describe

    assert best is not None
    if best.status == "infeasible":
        return best
    train, problem = drive.train, whole_teeth(drive)
    parts, remarks = [], list(best.report.get("notes", []))
    for name in _processes_asked(drive.scene):
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
        parts.append(reconcile(replace(part, name=words), best, ask.gap))
    return replace(best, parts=(*best.parts, *parts), report=best.report | {"notes": remarks})


def rated(scene: Scene, ask: Ask, best: Result | None) -> Result:
    """The answer whose designs by the processes are rated."""
    from gearopt.scenes.drive.rating.rated import with_rating

    assert best is not None
    words = [name.replace("_", " ") for name in PROCESSES]
    parts = [with_rating(scene, part) if part.name in words else part for part in best.parts]
    return replace(best, parts=tuple(parts))
