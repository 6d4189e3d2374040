"""A drive that was sized, explained: what binds, and what every number of its file costs."""

from collections.abc import Callable

from gearopt.formulations import sizing
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import binding
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.explaining.repair import CERTAIN
from gearopt.optimise.result import Result
from gearopt.optimise.solve import run
from gearopt.scenes.drive.explaining.influences import influences
from gearopt.scenes.drive.explaining.numbers import numbers
from gearopt.scenes.drive.scene import Scene

SAME = 1e-6  # gap of an answer that may be compared with another


def explained(
    scene: Scene, result: Result, clock: Clock, answer: Callable[[Scene], Result]
) -> Explanation:
    """The result with the influence of every number; answer(scene) solves a changed drive."""
    whole = result.status in CERTAIN and (result.gap or 0.0) <= SAME

    def price(other: Scene) -> float | None:
        if not whole:  # a difference to what is not the best means nothing
            return None
        found = answer(other)
        return found.value if found.status in CERTAIN else None

    ideal = run(sizing.problem(scene.train()), "ipopt", clock.left, watch=clock.watch)
    point = ideal[1].x if ideal[0].status == "optimal" else None
    found = tuple(influences(scene, result, point, clock, price))
    late = f"stopped after {len(found)} of {len(numbers(scene))} numbers" if clock.over else ""
    if not whole:
        late = late or "easing a limit is not priced, because the answer is not proven to the end"
    return Explanation(
        result,
        binding=tuple(n for n in binding(result) if not n.startswith("common_divisor")),
        influences=found,
        message=late,
        seconds=clock.seconds,
    )
