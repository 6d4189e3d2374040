"""Fronts of the box around gears that are sized first: width against height, and the like."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive import layout
from gearopt.formulations.drive.design import drive_design, gears_first
from gearopt.formulations.drive.gearbox import SIDES
from gearopt.formulations.drive.layout import layout_front
from gearopt.formulations.drive.layout.faults import faults
from gearopt.formulations.drive.layout.layout_text import read
from gearopt.formulations.drive.layout.slabs import arrangements
from gearopt.optimise.pareto.objectives import Limiting, Objective, Tradeoff, impossible
from gearopt.optimise.result import Outcome, Result
from gearopt.optimise.typed import untyped
from gearopt.scenes.drive.described_layout import described, handed
from gearopt.scenes.drive.layout import others_may_fit
from gearopt.scenes.drive.scene import Scene


def objectives(scene: Scene) -> dict[str, str]:
    """Objectives of a front of the box: name and unit; none without [layout]."""
    if scene.layout is None:
        return {}
    given = {"width"} if scene.layout.width is not None else set()
    return {name: unit for name, unit in layout_front.GOALS.items() if name not in given}


def check(scene: Scene) -> None:
    """Raise SolveError where a file asks for gears and box at once."""
    if scene.layout is not None and scene.layout.together:
        raise SolveError(
            "a front of the box is that of gears sized first: write together = false in [layout]"
        )


def traded(scene: Scene, names: Sequence[str], sized: Result) -> Tradeoff:
    """Return the problem of a front of the box around gears that were sized.

    Of three objectives, or two, those behind the first are sides, which epsilon steps limit.
    """
    listed = tuple(Objective(name, objectives(scene)[name]) for name in names)
    if sized.value is None:
        certain, why = sized.status == "infeasible", sized.message or "no gears were found"
        none = Outcome(None, certain, infeasible=certain, proof=dict(sized.proof), message=why)
        return Tradeoff(impossible("layout", names, none), listed)
    gears = drive_design(sized.design)
    box = scene.gearbox(scene.pairs(gears))
    scope = gears_first(sized) if others_may_fit(scene, box) else ""
    if wrong := faults(box):
        proof = {
            "method": "closed form",
            "sentence": "Proof: the sizes of these gears exclude every layout.",
        }
        none = Outcome(None, infeasible=True, proof=proof, message=" ".join(wrong))
        return Tradeoff(impossible("layout", names, none), listed, scope=scope)
    layout.ready()
    orders, given = arrangements(box), [stage.pinion_hand for stage in scene.stage]

    def drawn(x: Any) -> Mapping[str, Any]:
        angles, order = read(orders, x)
        drawing = handed(described(box, order, angles, gears), given)
        design: Mapping[str, Any] = untyped(replace(gears, layout=drawing))
        return design

    limiting = Limiting(lambda name, most: layout_front.limited(box, name, most), tuple(SIDES))
    problem = layout_front.problem(box, tuple(names))
    return Tradeoff(problem, listed, drawn, limiting, scope=scope)
