"""Whether any train meets all limits: a search that ends with the first one."""

from gearopt.errors import SolveError
from gearopt.formulations.drive.teeth.progress import Teeth
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.search import search
from gearopt.formulations.drive.train import Train
from gearopt.optimise.result import Budget, Event, Watch


def possible(
    train: Train, seconds: float, watch: Watch | None, shelf: list[RatedTable] | None = None
) -> bool | None:
    """Return whether any train meets all limits; None where that is not known in time.

    shelf: as of `search`.
    """
    found = any_train(train, seconds, watch, shelf)
    return found if found is None else bool(found)


def any_train(
    train: Train, seconds: float, watch: Watch | None, shelf: list[RatedTable] | None = None
) -> Teeth | None:
    """Return the teeth of a train that meets all limits, () if there is none; None: not known.

    shelf: as of `search`.
    """

    def first(event: Event) -> bool:
        wanted = watch is None or watch(event) is not False
        return event.best is None and wanted  # one train is enough

    try:
        progress = search(train, 1, Budget(seconds=seconds), first, shelf=shelf)
    except SolveError:  # too many pairs to examine
        return None
    if progress.found:
        return progress.found[0][1]
    return None if progress.clock.stopped else ()
