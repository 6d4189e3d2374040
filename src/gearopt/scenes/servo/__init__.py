"""kind = "servo": a motor, a two-stage gear train and a load that must be moved and placed.

Tables switch parts on: the best total ratio, the teeth and modules of the train, its stiffness and
box, the tolerances that its accuracy asks for. Each is a certified result; the first that a file
asks for of train, ratio and tolerances is the answer, the others are its parts.
"""

from dataclasses import asdict, dataclass, field, replace
from typing import Any

from gearopt.formulations.servo.ratio.duty import UNITS
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.comparing.trial import Model
from gearopt.optimise.explaining.explain import binding
from gearopt.optimise.explaining.explanation import Change, Explanation, Remedy
from gearopt.optimise.result import Result
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.servo.assumptions import assumptions, notes
from gearopt.scenes.servo.choice import SHOWN, posed
from gearopt.scenes.servo.gears import Gears, described, errors, given_gears
from gearopt.scenes.servo.key_figures import key_figures
from gearopt.scenes.servo.ratio_part import ratio_part
from gearopt.scenes.servo.scene import EXAMPLE, Scene
from gearopt.scenes.servo.springs import stiffness_of
from gearopt.scenes.servo.tolerance_part import problem as tolerance_problem
from gearopt.scenes.servo.tolerance_part import tolerance_part
from gearopt.scenes.servo.train_part import beside, box_part, lightest_part, neighbours, train_part
from gearopt.scenes.servo.ways_out import ways_out

__all__ = ["EXAMPLE", "Scene", "compared", "explain", "model", "solve"]


@dataclass(frozen=True)
class _Found:
    """Some results with their parts of the answer's design and report."""

    results: tuple[Result, ...] = ()
    design: dict[str, Any] = field(default_factory=dict)
    report: dict[str, Any] = field(default_factory=dict)

    def __add__(self, other: "_Found") -> "_Found":
        return _Found(
            self.results + other.results, self.design | other.design, self.report | other.report
        )


def solve(scene: Scene, ask: Ask) -> Result:
    """Every part that the file asks for; the answer is the train, else the ratio, else tolerances.

    A method that is asked for is that of the answer; parts are solved by their own.
    """
    clock = Clock(ask.budget, of_others(ask.watch))
    gears, found = given_gears(scene), _Found()
    if scene.train is not None:
        gears, found = _trained(scene, ask, clock)
    if scene.duty is not None:
        found += _moved(scene, _part(ask, clock, found), found.design.get("train"))
    if gears is not None:
        found += _geared(scene, _part(ask, clock, found), gears)
    if scene.lightest is not None:
        found += _Found((lightest_part(scene, _part(ask, clock, found)),))
    figures = key_figures(scene, found.results, found.design, found.report)
    answer, *parts = found.results
    told: dict[str, Any] = {"assumptions": assumptions(scene)}
    if said := notes(scene, found.design, found.results, found.report):
        told["notes"] = said
    if answer.status == "infeasible" and scene.train is not None:
        conflict, remedies, message = ways_out(scene, clock, answer.message)
        told["ways_out"] = {
            "conflict": list(conflict),
            "remedies": [asdict(r) for r in remedies],
            "message": message,
        }
    return replace(
        answer,
        design=found.design,
        report=found.report | figures | told,
        parts=tuple(parts),
        seconds=clock.seconds,
    )


def _part(ask: Ask, clock: Clock, found: _Found) -> Ask:
    """What is asked of the next part: the method, if nothing was solved yet, and the time left."""
    method = None if found.results else ask.method
    return replace(ask, method=method, budget=clock.left)


def _trained(scene: Scene, ask: Ask, clock: Clock) -> tuple[Gears | None, _Found]:
    """The train, what is known beside it, and its neighbours."""
    result, gears = train_part(scene, ask)
    report = beside(scene, gears)
    if gears is None:
        return None, _Found((result,), report=report)
    report |= {"trains": neighbours(scene, clock)}
    return gears, _Found((result,), result.design, report)


def _moved(scene: Scene, ask: Ask, train: dict[str, Any] | None) -> _Found:
    """The best total ratio, and what the axis achieves with its train."""
    result, design, report = ratio_part(scene, train, ask)
    return _Found((result,), {"ratio": design} if design else {}, report)


def _geared(scene: Scene, ask: Ask, gears: Gears) -> _Found:
    """What follows from the gears, chosen or given: errors, stiffness, box, tolerances."""
    found = _Found((), {"train": described(scene, gears)})
    if rows := errors(scene, gears):
        sums = {
            f"{kind}_deg": sum(row["error_deg"] for row in rows if row["kind"] == kind)
            for kind in ("backlash", "pitch")
        }
        found += _Found((), {"errors": rows}, sums)
    if scene.stiffness is not None:
        found += _Found((), {"stiffness": stiffness_of(scene, gears)})
    if scene.space is not None:
        result, design = box_part(scene, gears, ask)
        found += _Found((result,), {"box": design} if design else {})
    if scene.tolerances is not None:
        result, design, report = tolerance_part(scene, gears, ask)
        found += _Found((result,), design, report)
    return found


def explain(scene: Scene, ask: Ask) -> Explanation:
    """What would make an impossible train possible; of a possible answer the limits that bind."""
    result = solve(scene, ask)
    ways = result.report.get("ways_out")
    if ways is None:
        bind = binding(result) if result.value is not None else ()
        return Explanation(result, (), (), bind, (), result.message, result.seconds)
    found = tuple(
        Remedy(**{**r, "changes": tuple(Change(**c) for c in r["changes"])})
        for r in ways["remedies"]
    )
    told = ways["message"]
    return Explanation(result, tuple(ways["conflict"]), found, message=told, seconds=result.seconds)


def compared(scene: Scene) -> tuple[str, ...]:
    """The methods of a comparison that names none."""
    if scene.train is not None:
        return ("exact", "annealing", "nsga2")
    if scene.duty is None and scene.tolerances is not None and scene.tolerances.grades is not None:
        return ("exact", "annealing", "nsga2")
    return ("exact", "ipopt", "gp")


def model(scene: Scene, method: str) -> Model:
    """The problem of the answer; that of a train without its box, which is no row of it."""
    if scene.train is not None:
        unit = SHOWN[scene.train.goal][1]
        return Model(posed(scene, boxed=False), "Whole teeth and modules, without a box", unit)
    if (duty := scene.servo_duty()) is not None:
        return Model(duty.problem(), "Total ratio", UNITS[duty.goal])
    gears = given_gears(scene)
    assert gears is not None
    return Model(tolerance_problem(scene, gears), "Tolerances of given gears", "")
