"""Gears and layout of a drive at once: exactly, or with real-valued teeth and modules by Ipopt."""

import math
from dataclasses import replace
from functools import partial
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.drive import sizing, sizing_text, teeth, together
from gearopt.formulations.drive.design import drive_design
from gearopt.formulations.drive.layout.slabs import Slabs, arrange
from gearopt.formulations.drive.together.continuous import angles_of, continuous
from gearopt.formulations.drive.train import Train
from gearopt.optimise.clock import following, in_part
from gearopt.optimise.comparing.runs import Model
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Outcome, Result
from gearopt.optimise.solve import limits, run
from gearopt.optimise.typed import untyped
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.box.lay_out import lay_out, others_may_fit, pairs_of, with_layout
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.reading.ask import Ask

REAL_VALUED = "real-valued"  # the part with real-valued sizes
REAL = ("ipopt", "multistart")  # methods that take real-valued teeth

Start = tuple[Slabs, tuple[GearPair, ...], tuple[float, ...]]


def at_once(scene: Scene, ask: Ask, sized: Result) -> Result:
    """Return the smallest box over gears and places; parts: gears sized first; real-valued."""
    together.ready(ask.watch)
    apart = replace(lay_out(scene, replace(ask, method=None), sized), name="apart")
    if apart.status == "infeasible" and not others_may_fit(scene, pairs_of(scene, sized)):
        return replace(apart, name="drive")
    real = ask.method in REAL
    model = posed(scene, ask.method or "exact", apart)
    watch, events = following(in_part(ask.watch, model.unit))
    asked = ask.budget.less(apart.seconds)
    gap = ask.gap if ask.budget.gap or real else together.GAP
    result, outcome = run(model.problem, ask.method, asked, ask.seed, watch, gap)
    parts = (replace(apart, report={}),)
    result = replace(result, objective=result.objective | {"unit": model.unit}, parts=parts)
    if result.value is None or outcome.x is None:
        spent = sum(p.seconds for p in parts)
        return replace(result, name="drive", seconds=result.seconds + spent, **_why(result, apart))
    if isinstance(model.problem, Problem) and real:
        return _real(scene, result, outcome, sized, model.problem, _start(scene, apart)[0], events)
    train = scene.train()
    make = partial(scene.gearbox, train=train)
    box, angles, order = together.laid_out(train, make, outcome.x)
    own, pairs = teeth.problem(train), together.pairs(train, outcome.x)
    point = outcome.x[: sum(v.size for v in own.variables)]
    chosen = together.options(train, outcome.x)
    gears = replace(sized, design=untyped(scene.design(pairs, chosen)), limits=limits(own, point))
    found = with_layout(scene, result, events, replace(gears, report={}), box, angles, order)
    if scene.by_ratings:
        return found
    left = replace(ask, budget=asked.less(result.seconds))
    smooth = _from(scene, (order.slabs, pairs, angles), left)
    return replace(found, parts=(*found.parts, *smooth))


def _why(result: Result, apart: Result) -> dict[str, Any]:
    """Return the message where there is no design: that of the gears sized first, and remedies."""
    if result.status != "infeasible":
        return {}
    message = apart.message or "none was found for these in time"
    ways = apart.report.get("ways_out") or {"conflict": [], "remedies": [], "message": ""}
    words = f"No gears within the limits can be arranged. Of the gears sized first: {message}"
    beside = {key: apart.report[key] for key in ("nearest_layout",) if key in apart.report}
    return {"message": words, "report": {"notes": [words], "ways_out": ways} | beside}


def posed(scene: Scene, method: str, apart: Result) -> Model:
    """Return the problem that a method gets; apart: the layout of gears sized first, a start."""
    assert scene.layout is not None
    train = scene.train()
    make = partial(scene.gearbox, train=train)
    unit = make(pairs_of(scene, apart.parts[0])).unit
    if method == "exact":
        import numpy as np

        known = None
        if apart.value is not None:
            slabs, pairs, angles = _start(scene, apart)
            made = pairs, _options(train, apart)
            known = (made, arrange(make(pairs), slabs), np.array(angles))
        problem = together.problem(train, make, known)
        return Model(problem, "Gears and box at once", unit)
    if method not in REAL:
        raise SolveError(f"together = true is for exact and {' and '.join(REAL)}, not for {method}")
    if scene.by_ratings:
        raise SolveError(f"{method} takes no gears and box at once that ratings limit; exact does")
    if apart.value is None:
        raise SolveError(f"{method} needs a start: {apart.message}")
    slabs, pairs, angles = _start(scene, apart)
    smooth = continuous(train, make, slabs, (pairs, angles))
    return Model(smooth, "Gears and box at once, real-valued teeth", unit)


def _start(scene: Scene, apart: Result) -> Start:
    """Return slabs, gear pairs and angles of a layout."""
    found = drive_design(apart.design).layout
    assert found is not None
    slabs = tuple(tuple(s - 1 for s in slab) for slab in found.slabs)
    return slabs, pairs_of(scene, apart), tuple(math.radians(t) for t in found.link_angles_deg)


def _options(train: Train, found: Result) -> tuple[int, ...]:
    """Return the option of every stage of a design, from 0, by its materials."""
    stages = drive_design(found.design).stages
    names = [(stage.pinion_material, stage.wheel_material) for stage in stages]
    known = [
        [option.materials for option in stage.options] or [n]
        for stage, n in zip(train.stages, names, strict=True)
    ]
    return tuple(own.index(n) for own, n in zip(known, names, strict=True))


def _from(scene: Scene, start: Start, ask: Ask) -> tuple[Result, ...]:
    """Return the real-valued part, started from an exact answer; none unless Ipopt improves it."""
    slabs, pairs, angles = start
    train = scene.train()
    make = partial(scene.gearbox, train=train)
    problem = continuous(train, make, slabs, (pairs, angles))
    unit = make(pairs).unit
    watch = in_part(ask.watch, unit, REAL_VALUED)
    result, _ = run(problem, "ipopt", ask.budget, watch=watch)
    if result.value is None or result.status == "limit":  # a start is no answer
        return ()
    return (replace(result, name=REAL_VALUED, objective=result.objective | {"unit": unit}),)


def _real(
    scene: Scene,
    result: Result,
    outcome: Outcome,
    sized: Result,
    problem: Problem,
    slabs: Slabs,
    events: list[dict[str, Any]],
) -> Result:
    """Return a result with real-valued teeth in the words of a drawing."""
    assert outcome.x is not None
    train = scene.train()
    own = sizing.problem(train)
    point = outcome.x[: sum(v.size for v in own.variables)]
    pairs = sizing_text.pairs(train, point)
    gears = replace(
        sized, design=untyped(scene.design(pairs)), limits=limits(own, point), report={}
    )
    box = scene.gearbox(pairs)
    angles = angles_of(problem, outcome.x)
    return with_layout(scene, result, events, gears, box, angles, arrange(box, slabs))
