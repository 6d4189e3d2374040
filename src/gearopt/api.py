"""The way in from Python: `load` a problem file, `solve` a file, a scene or a problem."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Result, Watch
from gearopt.optimise.solve import GAP
from gearopt.optimise.solve import solve as solve_problem
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.load import load as load_file
from gearopt.scenes.reading.load import scene_module


def load(path: str | Path) -> BaseModel:
    """The scene of a problem file; SceneError says where it is wrong and what to write."""
    return load_file(path).scene


def solve(
    what: str | Path | BaseModel | Problem | Conic,
    method: str | None = None,
    *,
    budget: Budget | None = None,
    seed: int = 0,
    watch: Watch | None = None,
    gap: float | None = None,
    top: int = 1,
) -> Result:
    """The certified answer to a problem file, to a loaded scene, or to a problem of your own.

    method: by default the scene's or problem's own. budget: seconds and evaluations. watch(event)
    is told of progress; returning False stops the run. gap: relative gap to our bound that is
    enough, so that a search may end there; None: none is, and 1e-6 is called optimal. top: so many
    next best answers too (scenes with an exact method). SceneError for a wrong file, SolveError
    where the method does not fit, ValueError for gap < 0 or top < 1. Not thread-safe.
    """
    if (gap is not None and gap < 0.0) or top < 1:
        raise ValueError(f"needs gap >= 0 and top >= 1, not gap = {gap}, top = {top}")
    budget = replace(budget or Budget(), gap=gap or 0.0)
    gap = GAP if gap is None else gap
    if isinstance(what, Problem | Conic):
        return solve_problem(what, method, budget, seed, watch, gap)
    ask = Ask(method, budget, seed, watch, gap, top)
    if isinstance(what, BaseModel):
        kind = type(what).__module__.rsplit(".", 1)[-1]
        return _named(scene_module(kind).solve(what, ask), scene=kind)
    loaded = load_file(what)
    result = scene_module(loaded.kind).solve(loaded.scene, ask)
    return _named(result, scene=loaded.kind, file=loaded.file, file_sha256=loaded.sha256)


def _named(result: Result, **names: Any) -> Result:
    return replace(result, **names)
