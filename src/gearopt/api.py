"""The way in from Python: `load` a problem file; `solve` or `compare` a file, scene or problem.

All that `import gearopt` offers is to be found here, imported or defined.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from gearopt.errors import CertificateError, GearoptError, SceneError, SolveError  # noqa: F401
from gearopt.optimise.clock import whole
from gearopt.optimise.comparing.compare import EVALUATIONS, SECONDS, SEEDS, Follow, Model, Plan
from gearopt.optimise.comparing.compare import compare as compare_methods
from gearopt.optimise.comparing.comparison import Comparison
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.result import Budget, Event, Result, Watch, plain  # noqa: F401
from gearopt.optimise.solve import GAP, evaluate  # noqa: F401
from gearopt.optimise.solve import solve as solve_problem
from gearopt.optimise.terms import Param, Repeat, Terms, Var  # noqa: F401
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.inputs import inputs_of
from gearopt.scenes.reading.load import kind_of, scene_module
from gearopt.scenes.reading.load import load as load_file


def load(path: str | Path) -> BaseModel:
    """Return the scene of a problem file; SceneError says where it is wrong and what to write."""
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
    prices: bool = False,
) -> Result:
    """Return the certified answer to a problem file, a loaded scene, or a problem of your own.

    method: by default the scene's or problem's own. budget: seconds and evaluations. watch(event)
    returns False to stop the run. gap: relative gap to our bound that is enough, so that a search
    may end there; None: none is, and 1e-6 is called optimal. top: so many next best answers too
    (scenes with an exact method). prices: report["prices"] holds the sensitivities to every number
    of the file, as `explain` does. SceneError for a wrong file, SolveError where the method does
    not fit, ValueError for gap < 0 or top < 1. Not thread-safe.
    """
    if (gap is not None and gap < 0.0) or top < 1:
        raise ValueError(f"needs gap >= 0 and top >= 1, not gap = {gap}, top = {top}")
    budget, watch = replace(budget or Budget(), gap=gap or 0.0), whole(watch)
    asked = {"method": method, "seconds": budget.seconds, "evaluations": budget.evaluations}
    asked |= {"gap": gap, "seed": seed, "top": top, "prices": prices}
    gap = GAP if gap is None else gap
    if isinstance(what, Problem | Conic):
        return solve_problem(what, method, budget, seed, watch, gap)
    ask = Ask(method, budget, seed, watch, gap, top)
    scene, module, names = _opened(what)
    result: Result = module.solve(scene, ask)
    if prices and result.value is not None and result.status != "evaluated":
        left = replace(ask, budget=budget.less(result.seconds))
        found = _explained(module, scene, left, result)
        result = replace(result, report=result.report | {"prices": found.prices})
    if inputs := inputs_of(scene):
        result = replace(result, report=result.report | {"inputs": inputs})
    return _named(result, options=asked, **names)


def explain(
    what: str | Path | BaseModel | Problem | Conic,
    *,
    budget: Budget | None = None,
    watch: Watch | None = None,
) -> Explanation:
    """Explain why the answer to a file, a scene or a problem is what it is.

    Possible: the limits that bind, and the sensitivity to every number of the file (to every
    parameter, and bound with a key, of a problem). Impossible: the limits in conflict, and
    remedies that were tried: what to write instead. SceneError and SolveError as in
    `solve`; a problem with discrete variables needs an exact method of its own.
    """
    from gearopt.optimise.explaining.explain import explain as explain_problem

    budget, watch = budget or Budget(), whole(watch)
    if isinstance(what, Conic):
        raise SolveError(
            f"explain takes a Problem; {what.name} is a Conic, whose conflict `solve` names already"
        )
    if isinstance(what, Problem):
        return explain_problem(what, budget, watch)
    ask = Ask(budget=budget, watch=watch)
    scene, module, names = _opened(what)
    found = _explained(module, scene, ask)
    return replace(found, result=_named(found.result, **names))


def _explained(module: Any, scene: Any, ask: Ask, result: Result | None = None) -> Explanation:
    """Return the explanation by the kind itself, or by its `solve` and `model`."""
    if hasattr(module, "explain"):
        found: Explanation = module.explain(scene, ask, result)
        return found
    from gearopt.scenes.explaining.default import explain as explain_scene

    return explain_scene(module, scene, ask, result)


DEFAULT = ("ipopt", "annealing", "nsga2")  # compared beside exact algorithms where none are named


def compare(
    what: str | Path | BaseModel | Problem | Conic,
    methods: Sequence[str] | str | None = None,
    *,
    seeds: int = SEEDS,
    evaluations: int = EVALUATIONS,
    seconds: float = SECONDS,
    bound_from: str | None = None,
    watch: Follow | None = None,
) -> Comparison:
    """Compare methods on a problem file, a loaded scene, or a problem of your own.

    methods: by default those of the file's kind; of a problem its own exact ones, ipopt, annealing
    and nsga2 (of a Conic: conic).
    Every method is run by evaluations and by seconds, random ones once for each of the seeds 0, 1,
    ... bound_from: a method run once to prove a bound. watch(progress) ends the comparison by
    returning False, and what is finished is reported. SceneError for a wrong file, SolveError where
    a method is unknown or none takes the problem, ValueError for a budget or number of seeds below
    1.
    """
    plan = Plan(evaluations, seconds, seeds)
    methods = methods.split(",") if isinstance(methods, str) else methods
    if isinstance(what, Problem | Conic):
        usual = ("conic",) if isinstance(what, Conic) else (*what.methods, *DEFAULT)
        named = usual if methods is None else methods
        one_objective(what.name, what.rows.objectives)
        own = Model(what)
        found = compare_methods(named, lambda method: own, plan, watch, bound_from)
        return replace(found, title=what.name)
    scene, module, names = _opened(what)
    named = module.compared(scene) if methods is None else methods
    found = compare_methods(named, lambda m: module.model(scene, m), plan, watch, bound_from)
    del names["asked"]
    return replace(found, title=getattr(scene, "title", "") or names["scene"], **names)


def _opened(what: str | Path | BaseModel) -> tuple[BaseModel, Any, dict[str, Any]]:
    """Return the scene of a file (or the scene itself), the module of its kind, and its names."""
    if isinstance(what, BaseModel):
        kind = kind_of(what)
        title = {"title": getattr(what, "title", "")}
        return what, scene_module(kind), {"scene": kind, "asked": title}
    loaded = load_file(what)
    names: dict[str, Any] = {
        "scene": loaded.kind,
        "file": loaded.file,
        "file_sha256": loaded.sha256,
        "asked": loaded.asked,
    }
    return loaded.scene, scene_module(loaded.kind), names


def _named(result: Result, **names: Any) -> Result:
    return replace(result, design=plain(result.design), report=plain(result.report), **names)
