"""Whether other gears than those sized first can be laid out, and with which switch of the file."""

from collections.abc import Iterator
from dataclasses import replace

from gearopt.errors import SolveError
from gearopt.formulations.drive import together
from gearopt.formulations.drive.layout.faults import of_any_gears
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.result import Event
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.explain.box_moves import switched, switches
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.numbers import allowed

SHARE, SECONDS = 0.5, 30.0  # of the time that is left, and at most, of one search
TOGETHER = Change("layout.together", "false", "true", 1.0)

Tried = tuple[Scene, tuple[Change, ...]]


def other_gears(
    scene: Scene, pairs: tuple[GearPair, ...], known: tuple[Remedy, ...], clock: Clock
) -> tuple[tuple[Remedy, ...], str]:
    """Switches with which other gears fit, each solved, and a sentence on those not known.

    pairs: gears sized first, which do not fit. known: remedies for these, which are not tried.
    """
    remedies, unknown = [], []
    for changed, changes in _candidates(scene, pairs, known):
        words = " and ".join(f"{change.key} = {change.write}" for change in changes)
        fits = _some_gears_fit(changed, clock)
        if fits:
            what = " and ".join(change.key.rsplit(".", 1)[-1] for change in changes)
            remedies.append(Remedy("choice", what, changes, 1.0, None, {"with": "feasible"}))
        elif fits is None:
            unknown.append(f"time ran out before it was known whether other gears fit with {words}")
        else:
            unknown.append(f"no other gears fit with {words}")
    return tuple(remedies), "; ".join(unknown)


def _candidates(
    scene: Scene, pairs: tuple[GearPair, ...], known: tuple[Remedy, ...]
) -> Iterator[Tried]:
    """Yield files whose gears are sized with the box, each with its changes.

    Where no gears fit the file, those without the reason; else the file as it is.
    """
    assert scene.layout is not None
    if scene.given or scene.teeth is None or any(own.epicyclic for own in scene.stage):
        return
    free = scene.model_copy(update={"layout": scene.layout.model_copy(update={"together": True})})
    both = () if scene.layout.together else (TOGETHER,)
    if not of_any_gears(scene.gearbox(pairs)):
        if both:
            yield free, both
        return
    alone = {change.key for remedy in known for change in remedy.changes if not change.write}
    for switch in switches(scene):
        changed = switched(free, switch)
        assert switch.move.switch is not None
        change = Change(*switch.move.switch, 1.0)
        if change.key in alone or not allowed(changed):
            continue
        if not of_any_gears(changed.gearbox(pairs)):
            yield changed, (change, *both)


def _some_gears_fit(scene: Scene, clock: Clock) -> bool | None:
    """Return whether some gears can be laid out; None where that is not known in time."""
    left = clock.left.seconds
    seconds = clock.within(SECONDS if left is None else SHARE * left)

    def first(event: Event) -> bool:
        return clock.tell() and event.best is None  # one layout is enough

    try:
        train = scene.train()
        problem = together.problem(train, scene.gearbox)
        budget = replace(clock.left, seconds=min(seconds, SECONDS))
        result, _ = run(problem, None, budget, watch=first)
    except SolveError:  # too many pairs to examine
        return None
    if result.value is not None:
        return True
    return False if result.status == "infeasible" else None
