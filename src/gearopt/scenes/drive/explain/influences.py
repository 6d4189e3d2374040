"""A drive that was sized, explained: its binding limits, its sensitivities to every number."""

from collections.abc import Callable
from functools import partial
from typing import Any

from gearopt.formulations.drive import continuous_sizing
from gearopt.formulations.drive.train import MASSES
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import EASE, STEP, binding
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.explaining.repair import CERTAIN, value_within
from gearopt.optimise.explaining.sensitivity import sensitivities
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.scenes.drive.driving import may_drive
from gearopt.scenes.drive.explain.moves import fields, next_module
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.blanks import HUBS, RIM, WEB
from gearopt.scenes.explaining.influences import Basis, influences, per_cent
from gearopt.scenes.explaining.numbers import Number, eased, moved, numbers
from gearopt.scenes.reading.module_series import series_of

BASIS = (
    " with real-valued teeth and modules, by Lagrange multipliers, checked by solving again. "
    "The effect of relaxing a limit is that on the drive itself, solved again"
)
RATED = (  # of drives that ratings limit, or whose gears have webs
    ". The effect of relaxing a limit is that on the drive itself, solved again; numbers that ease "
    "no limit are not listed"
)
OF_RATING = {  # keys of ratings: the direction that eases them
    **dict.fromkeys(("life", "input_revolutions", "overload_factor", "reliability"), -1),
    **dict.fromkeys(("minimum_bending_safety", "minimum_contact_safety", "pinion_offset"), -1),
    **dict.fromkeys((f"minimum_static_{mode}_safety" for mode in ("bending", "contact")), -1),
    "static_torque_factor": -1,
    **dict.fromkeys(("accuracy", "accuracy_grade", "roughness", "flank_rz", "root_rz"), -1),
    **dict.fromkeys(("quality", "hardness", "grade", "flank_hardness"), 1),
    **dict.fromkeys(("tip_thickness", "contact_ratio"), -1),  # of [shift]
    "specific_sliding": 1,
}
GRADES = ("quality", "accuracy")
OF_BLANKS = dict.fromkeys((*RIM, *WEB, HUBS), -1)  # keys of blanks: where gears get lighter
TENTHS = ("life", "input_revolutions", *OF_BLANKS)  # of which a hundredth says little
TENTH = 0.1  # relative
OPTIMALITY_GAP = 1e-6  # gap of an answer that may be compared with another


def explained(
    scene: Scene, result: Result, clock: Clock, answer: Callable[[Scene], Result]
) -> Explanation:
    """Return the result with the influence of every number; answer(scene) solves a changed drive.

    Sensitivities are those of real-valued sizes; steps are solved for the drive as it is.
    """
    whole = result.status in CERTAIN and (result.gap or 0.0) <= OPTIMALITY_GAP

    def solved(other: Scene) -> float | None:
        if not whole:  # a difference to what is not the best means nothing
            return None
        answered = answer(other)
        return answered.value if answered.status in CERTAIN else None

    spelt = _spelt(scene)
    wanted = [
        n for n in numbers(spelt) if not (n.path[:2] == ("teeth", "modules") and _is_series(scene))
    ]
    stepped = scene.by_ratings or scene.train().hollow  # slopes are known of posynomials alone
    if stepped:
        wanted = [n for n in wanted if eases(scene, n)]
    of_numbers = tuple(
        influences(
            spelt,
            None if stepped else _basis(spelt, clock),
            clock,
            wanted,
            lambda number: _easing(spelt, number, result, solved),
            lambda number: _smooth(spelt, number),
        )
    )
    late = f"the time sufficed for {len(of_numbers)} of {len(wanted)} sensitivities"
    late = late if clock.over else ""
    if not whole:
        late = late or "relaxing a limit is not tried, because the answer is not proven optimal"
    return Explanation(
        result,
        binding=tuple(n for n in binding(result) if not n.startswith("common_divisor")),
        influences=of_numbers,
        message=late,
        seconds=clock.seconds,
        basis=RATED if stepped else BASIS,
    )


def _basis(scene: Scene, clock: Clock) -> Basis | None:
    """Return the optimum of real-valued sizes; None where it is not known.

    Of pinions and wheels that may drive, of those with which it is best.
    """
    best: Basis | None = None
    for driver in may_drive(scene):
        posed = partial(_real_valued, driver=driver)
        base = posed(scene)
        ideal, outcome = run(base, "ipopt", clock.left, watch=clock.watch)
        if ideal.status != "optimal" or ideal.value is None or outcome.x is None:
            return None
        if best is None or ideal.value < best.value:
            known = sensitivities(base, outcome.x)
            solved = partial(_least, clock=clock)
            best = Basis(ideal.value, solved, posed, outcome.x, known, STEP)
    return best


def _real_valued(scene: Scene, driver: str) -> Problem:
    return continuous_sizing.problem(scene.train(driver))


def _least(scene: Scene, clock: Clock) -> float | None:
    """The least objective of a drive of real-valued sizes; None: not known in time."""
    values = [value_within(clock, _real_valued(scene, driver)) for driver in may_drive(scene)]
    return None if None in values else min(value for value in values if value is not None)


def _smooth(scene: Scene, number: Number) -> bool:
    """Return whether a small relative change of a number means anything.

    Zero has none, and of a series the next module counts.
    """
    in_series = scene.teeth is not None and _is_range(number) and "module" in number.path
    return bool(getattr(number.value, "number", number.value)) and not in_series


def _spelt(scene: Scene) -> Scene:
    """Return the scene with the load limits that a preset sets written out."""
    limits = scene.limits
    if limits.preset is None:
        return scene
    loads = {name: limits.load(name) for name in limits.LAW.names}
    return scene.model_copy(update={"limits": limits.model_copy(update={"preset": None, **loads})})


def _is_range(number: Number) -> bool:
    return isinstance(number.path[-1], int)


def _is_series(scene: Scene) -> bool:
    return scene.teeth is not None and bool(series_of(scene.teeth.modules))


def _easing(scene: Scene, number: Number, result: Result, solved: Any) -> tuple[str, float | None]:
    """Return the step that eases a limit of the file, and what it brings; "" for no limit."""
    direction = eases(scene, number)
    if direction == 0 or not result.value:  # nothing is below 0
        return "", None
    value: Any
    if scene.teeth is not None and "module" in number.path:
        value = next_module(scene, number.value, direction)
        step = f"to {value}"
    elif isinstance(number.value, int):
        value, step = number.value + direction, f"{direction:+d}"
    elif number.path[-1] in TENTHS:
        value = eased(number.value, 1.0 + TENTH, direction)
        step = f"{direction * TENTH:+.0%}"
    elif number.path[-1] in GRADES:
        value, step = number.value + direction, f"{direction:+d}"
    else:
        value = eased(number.value, 1.0 + EASE, direction)
        step = per_cent(number.value, direction)
    other = None if value is None else moved(scene, number.path, value)
    if other is None:
        return "", None
    objective = solved(other)
    return step, None if objective is None else (objective - result.value) / abs(result.value)


def eases(scene: Scene, number: Number) -> int:
    """Return +1 or -1: the direction that eases a limit of the file, or makes its gears lighter.

    0 for other numbers.
    """
    path = number.path
    if path == ("duty", "ratio_tolerance"):
        return 1 if number.value else 0
    end = path[-1] if isinstance(path[-1], int) else None
    field = path[-2] if end is not None else path[-1]
    if scene.by_ratings and (way := OF_RATING.get(str(field))):
        return way
    if scene.objective.minimise in MASSES and (way := OF_BLANKS.get(str(field))):
        return way
    ways = dict.fromkeys(
        (*scene.limits.LAW.names, "wheel_diameter", "axial_force"), 1
    )  # no ends of a range
    ways |= {"minimum_face_width": -1, "overlap_ratio": -1}
    for name, place in fields(scene).items():
        if place == (field, end) and path[0] in ("limits", "stage", "gears"):
            return ways.get(name, 0) if end is None else (-1 if end == 0 else 1)
    return 0
