"""Steps of the layout of a drive: of gears sized first, or gears and box at once."""

import math
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive import continuous_sizing, layout, sizing_text, teeth, together
from gearopt.formulations.drive.design import (
    DriveDesign,
    describe,
    drive_design,
    gears_first,
)
from gearopt.formulations.drive.gearbox import Gearbox
from gearopt.formulations.drive.layout.exact import GAP
from gearopt.formulations.drive.layout.faults import faults, of_any_gears
from gearopt.formulations.drive.layout.layout_text import read
from gearopt.formulations.drive.layout.slabs import Arrangement, Slabs, arrange, arrangements
from gearopt.formulations.drive.together import continuous
from gearopt.formulations.drive.together.tables import frame
from gearopt.formulations.drive.train import Train
from gearopt.optimise.certified import limits, point_of, run
from gearopt.optimise.clock import Clock, following, in_part
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.typed import untyped
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.counts import best_count
from gearopt.scenes.drive.described_layout import (
    described,
    distances_used,
    handed,
    reached,
)
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.sizing import Drive, drive_of, ideal_of_count, noted, of_count
from gearopt.scenes.drive.sizing import sized as sized_gears
from gearopt.scenes.drive.without import without
from gearopt.scenes.plan import Step, carried_out
from gearopt.scenes.reading.ask import Ask

REAL_VALUED = "real-valued"  # the part with real-valued sizes
REAL = ("ipopt", "multistart")  # methods that take real-valued teeth
IN_BOX = "gears in the box"  # the part of the gears of a box that is not drawn yet
APART = "apart"  # the part of gears that are laid out after they are sized
UNFIT = "These gears cannot be arranged with these clearances and positions."

Start = tuple[Slabs, tuple[GearPair, ...], tuple[float, ...]]


def box_first(scene: Scene) -> bool:
    """Whether gears and box are sought at once before the gears are sized: they take less time."""
    asked = scene.layout is not None and scene.layout.together
    return asked and any(map(scene.shifted, scene.stage_tables))


def steps(scene: Scene) -> tuple[Step[Scene], ...]:
    """Steps to the layout of a sized drive; of gears and box at once it is the start.

    Where the box is sought first, from no gears on, they are for comparison.
    """
    if scene.layout is None or not scene.layout.together:
        return (Step(lay_out),)
    if box_first(scene):
        return (
            Step(at_once, drive_to_box),
            Step(with_sized_first, own=False, always=True),
            Step(with_gears, drive_to_box),
            Step(drawn, drive_to_box),
        )
    return (
        Step(lay_out, own=False),
        Step(at_once, drive_to_box, always=True),
        Step(with_gears, drive_to_box),
        Step(with_real_values, drive_to_box),
        Step(drawn, drive_to_box),
    )


def drive_to_box(scene: Scene) -> Drive:
    """The drive whose gears and box are sought at once."""
    return drive_of(without(scene, "processes"))


def lay_out(scene: Scene, ask: Ask, gears: Result | None) -> Result:
    """Layout of a sized drive; the sizing is kept as its part `gears`."""
    assert gears is not None
    return _laid_out(_with_gears(scene, gears), ask, gears)


def of_best_count(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Smallest box over gears and places, with the best number of stages."""
    return best_count(scene, ask, ideal_of_count, at_once_of_count)


def at_once_of_count(scene: Scene, ask: Ask, ideal: Result | None = None) -> Result:
    """Gears and box at once of a drive with one number of stages; ideal: in real-valued sizes."""
    gears = of_count(without(scene, "layout"), replace(ask, method=None), ideal)
    gears = noted(scene, replace(ask, method=None), gears)
    if gears.value is None:  # a bound of the gears is none of the box
        return replace(gears, bound=None)
    left = replace(ask, budget=ask.budget.less(gears.seconds))
    return carried_out(steps(scene), scene, left, gears)


def _with_gears(scene: Scene, gears: Result) -> Scene:
    """The drive that is laid out: with the number of stages of its gears."""
    return without(scene.held(len(gears.design["stages"])), "processes")


def gears_of(result: Result) -> Result | None:
    """Gears of an impossible layout; None where it has none, or their layout is possible."""
    for part in result.parts:
        if part.name == "gears" and part.design:
            return part
        if part.name == APART and part.status == "infeasible":
            return gears_of(part)
    return None


def _laid_out(scene: Scene, ask: Ask, sized: Result) -> Result:
    box = scene.gearbox(scene.pairs(drive_design(sized.design)))
    orders = arrangements(box)
    parts = (replace(sized, name="gears"),)
    if wrong := faults(box):
        proof = {"method": "closed form", "conflict": []}
        objective = {"name": str(scene.layout and scene.layout.minimise), "value": None}
        result = replace(sized, method="data check", objective=objective, bound=None, gap=None)
        result = replace(result, status="infeasible", proof=proof, certificate={}, limits={})
        return _impossible(scene, box, sized, replace(result, parts=parts), wrong)
    problem = layout.problem(box, ask.method)
    watch, events = following(in_part(ask.watch, box.unit))
    gap = ask.gap if ask.budget.gap else GAP
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, watch, gap)
    result = replace(result, objective=result.objective | {"unit": box.unit}, parts=parts)
    if result.status == "infeasible":
        return _impossible(scene, box, sized, result, [UNFIT])
    if result.value is None or outcome.x is None:
        return replace(result, name="drive")
    return _with_layout(scene, result, events, sized, box, *read(orders, outcome.x))


def _impossible(
    scene: Scene, box: Gearbox, sized: Result, result: Result, notes: list[str]
) -> Result:
    """Proof that sized gears cannot be laid out, in words."""
    message = " ".join(notes)
    if others_may_fit(scene, box):
        result = replace(result, proof=result.proof | _scope(sized))
        assert scene.layout is not None
        if not scene.layout.together:
            least = str(sized.objective["name"]).replace("_", " ")
            message = f"These gears, sized first for least {least}, do not fit. {message}"
    return replace(result, design={}, message=message, report={"notes": notes})


def _with_layout(
    scene: Scene,
    result: Result,
    events: list[dict[str, Any]],
    sized: Result,
    box: Gearbox,
    angles: tuple[float, ...],
    order: Arrangement,
) -> Result:
    """A result with its gears and layout in the words of a drawing."""
    gears = drive_design(sized.design)
    hands = [stage.pinion_hand for stage in scene.stage]
    drawing = handed(described(box, order, angles, gears), hands)
    if any(part.name == "gears" for part in result.parts) and not scene.given:
        result = _of_gears_first(scene, result, sized)
    parts = () if box_first(scene) else result.parts
    before = sum(p.seconds for p in parts), sum(p.evaluations for p in parts)
    seconds, spent = before[0] + result.seconds, before[1] + result.evaluations
    last = {"seconds": seconds, "evaluations": spent, "best": result.value, "bound": result.bound}
    steps = [
        e | {"seconds": before[0] + e["seconds"], "evaluations": before[1] + e["evaluations"]}
        for e in events
    ]
    return replace(
        result,
        name="drive",
        design=untyped(replace(gears, layout=drawing)),
        limits=sized.limits | distances_used(drawing) | _sides_used(result),
        report={
            "progress": [*steps, last],
            "notes": [*sized.report.get("notes", []), *reached(box, drawing)],
        },
        evaluations=spent,
        seconds=seconds,
    )


def _scope(sized: Result) -> dict[str, str]:
    """Scope of whatever is proven of a layout of gears that were sized before it."""
    return {"scope": gears_first(sized)}


def _of_gears_first(scene: Scene, result: Result, sized: Result) -> Result:
    """Layout whose message says that it is one of gears that were sized before it."""
    words = f"the box is that of {_scope(sized)['scope']}"
    if scene.teeth is not None and not any(own.epicyclic for own in scene.stage):
        words += ": with together = true in [layout] gears and box are optimised together"
    message = "; ".join(filter(None, (result.message, words)))
    return replace(result, proof=result.proof | _scope(sized), message=message)


def _sides_used(result: Result) -> dict[str, float]:
    return {n: v for n, v in result.limits.items() if n.startswith("largest_")}


def others_may_fit(scene: Scene, box: Gearbox) -> bool:
    """Whether a fault of the gears in a box says nothing of others: they were sized first."""
    return not scene.given and not of_any_gears(box)


def at_once(drive: Drive, ask: Ask, known: Result | None) -> Result:
    """Smallest box over gears and places, as values of its variables.

    known: the layout of gears sized first, which is a part of the result; None: they are not.
    """
    if known is None:
        return _at_once(drive, ask, None)
    sized = _sized_first(known)
    if sized is None:  # no gears to lay out
        return known
    scene, apart = drive.scene, replace(known, name=APART)
    box = scene.gearbox(scene.pairs(drive_design(sized.design)))
    if apart.status == "infeasible" and not others_may_fit(scene, box):
        return replace(apart, name="drive")
    return _with_apart_as_part(_at_once(drive, ask, apart), apart)


def _at_once(drive: Drive, ask: Ask, apart: Result | None) -> Result:
    """Smallest box, without parts; apart: the layout of gears sized first, a start."""
    clock, unit = Clock(ask.budget), frame(drive.train, drive.scene.gearbox).unit
    together.ready(ask.watch)
    problem = _problem_at_once(drive.scene, drive.train, ask.method or "exact", apart)
    watch, events = following(in_part(ask.watch, unit))
    gap = ask.gap if ask.budget.gap or ask.method in REAL else together.GAP
    result, _ = run(problem, ask.method, clock.left, ask.seed, watch, gap)
    objective = result.objective | {"unit": unit}
    report = {"progress": events} if result.value is not None else {}
    return replace(result, name="drive", objective=objective, report=report)


def _with_apart_as_part(box: Result, apart: Result) -> Result:
    """The smallest box with the layout of gears sized first as a part."""
    box = replace(box, parts=(replace(apart, report={}),))
    if box.value is not None:
        return box
    return replace(box, seconds=box.seconds + apart.seconds, **_why(box, apart))


def with_sized_first(scene: Scene, ask: Ask, box: Result | None) -> Result:
    """The smallest box, or that there is none, beside the layout of gears sized first.

    Those are the start where no box is known yet.
    """
    assert box is not None
    clock = Clock(ask.budget)
    gears = sized_gears(without(scene, "layout"), ask)
    if not gears.design:
        impossible = gears.status == "infeasible"
        return gears if impossible else _with_apart_as_part(box, replace(gears, name=APART))
    known = lay_out(scene, replace(ask, budget=clock.left), gears)
    late = clock.over and known.value is None  # then there is no time, and nothing to begin with
    if box.value is None and box.status != "infeasible" and not late:
        return at_once(drive_to_box(scene), replace(ask, budget=clock.left), known)
    return _with_apart_as_part(box, replace(known, name=APART))


def _sized_first(result: Result) -> Result | None:
    """Gears sized first, of their layout; None where there was nothing to lay out."""
    return next((part for part in result.parts if part.name == "gears"), None)


def with_gears(drive: Drive, ask: Ask, box: Result | None) -> Result:
    """The smallest box, whose gears are a part until it is drawn."""
    assert box is not None
    train = drive.train
    whole = ask.method not in REAL
    problem = teeth.problem(train) if whole else continuous_sizing.problem(train)
    point = point_of(box.design)[: sum(v.size for v in problem.variables)]
    pairs, options = teeth.gears(train, point) if whole else (sizing_text.pairs(train, point), ())
    design = describe(train, pairs, options)
    values = {"design": untyped(design), "limits": limits(problem, point)}
    gears = replace(box, name=IN_BOX, parts=(), report={}, **values)
    return replace(box, parts=(*box.parts, gears))


def with_real_values(drive: Drive, ask: Ask, box: Result | None) -> Result:
    """The smallest box of whole teeth with one of real-valued teeth, which begins at it, as a part.

    There is none unless Ipopt improves the box.
    """
    assert box is not None
    scene = drive.scene
    train = drive.train
    if ask.method in REAL or scene.by_ratings:
        return box
    whole, angles, order = together.laid_out(train, scene.gearbox, point_of(box.design))
    problem = continuous.problem(train, scene.gearbox, order.slabs, (whole.pairs, angles))
    watch = in_part(ask.watch, whole.unit, REAL_VALUED)
    result, _ = run(problem, "ipopt", ask.budget, watch=watch)
    if result.value is None or result.status == "limit":  # a start is no answer
        return box
    objective = result.objective | {"unit": whole.unit}
    return replace(box, parts=(*box.parts, replace(result, name=REAL_VALUED, objective=objective)))


def drawn(drive: Drive, ask: Ask, box: Result | None) -> Result:
    """The smallest box in the words of a drawing."""
    assert box is not None
    scene = drive.scene
    apart, gears, *others = box.parts
    train = drive.train
    x = point_of(box.design)
    if ask.method in REAL:
        slabs = _start(scene, apart)[0]
        placed = continuous.laid_out(train, scene.gearbox, slabs, x)
    else:
        placed = together.laid_out(train, scene.gearbox, x)
    events, first = box.report["progress"], replace(box, parts=(apart,))
    whole = _with_layout(scene, first, events, gears, *placed)
    return replace(whole, parts=(*whole.parts, *others))


def _why(result: Result, apart: Result) -> dict[str, Any]:
    """Message where there is no design: that of the gears sized first."""
    if result.status != "infeasible":
        return {}
    message = apart.message or "none was found for these in time"
    words = f"No gears within the limits can be arranged. Those sized first do not fit. {message}"
    return {"message": words, "report": {"notes": [words]}}


def posed(scene: Scene, method: str, sized: Result) -> Model:
    """Problem of a method for a layout; SolveError where the gears cannot be laid out."""
    assert scene.layout is not None
    if sized.value is None:
        raise SolveError("there are no gears to lay out: gearopt explain shows why")
    box = scene.gearbox(scene.pairs(drive_design(sized.design)))
    if scene.layout.together:
        apart = _laid_out(scene, Ask(), sized)
        problem = _problem_at_once(scene, scene.train(), method, apart)
        words = "Gears and box at once" + (", real-valued teeth" if method in REAL else "")
        return Model(problem, words, box.unit)
    if wrong := faults(box):
        raise SolveError(" ".join(wrong))
    layout.ready()  # what is compared is machine code
    words = "Layout by four sides" if method in layout.GRADIENT else "Layout by link angles"
    return Model(layout.problem(box, method), f"{words}, of gears that were chosen first", box.unit)


def _problem_at_once(scene: Scene, train: Train, method: str, apart: Result | None) -> Problem:
    """Problem that a method gets; apart: the layout of gears sized first, a start."""
    make = scene.gearbox
    if method == "exact":
        import numpy as np

        known = None
        if apart is not None and apart.value is not None:
            slabs, pairs, angles = _start(scene, apart)
            gears = pairs, _options(train, drive_design(apart.design))
            known = (gears, arrange(make(pairs), slabs), np.array(angles))
        return together.problem(train, make, known)
    if method not in REAL:
        raise SolveError(f"together = true is for exact and {' and '.join(REAL)}, not for {method}")
    if scene.by_ratings:
        raise SolveError(f"{method} takes no gears and box at once that ratings limit; exact does")
    assert apart is not None
    if apart.value is None:
        raise SolveError(f"{method} needs a start: {apart.message}")
    slabs, pairs, angles = _start(scene, apart)
    return continuous.problem(train, make, slabs, (pairs, angles))


def _start(scene: Scene, apart: Result) -> Start:
    """Slabs, gear pairs and angles of a layout."""
    design = drive_design(apart.design)
    assert design.layout is not None
    slabs = tuple(tuple(s - 1 for s in slab) for slab in design.layout.slabs)
    angles = tuple(math.radians(t) for t in design.layout.link_angles_deg)
    return slabs, scene.pairs(design), angles


def _options(train: Train, design: DriveDesign) -> tuple[int, ...]:
    """Option of every stage of a design, from 0, by its materials."""
    names = [(stage.pinion_material, stage.wheel_material) for stage in design.stages]
    known = [
        [option.materials for option in stage.options] or [n]
        for stage, n in zip(train.stages, names, strict=True)
    ]
    return tuple(own.index(n) for own, n in zip(known, names, strict=True))
