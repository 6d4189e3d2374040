"""The way in from Python: `load` a problem file; `solve` or `compare` a file, scene or problem.

What only some of these need is imported inside them: the command answers sooner.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from gearopt.errors import SolveError
from gearopt.optimise.certified import GAP
from gearopt.optimise.clock import Clock, of_others, tell_known, whole
from gearopt.optimise.comparing.plan import EVALUATIONS, SECONDS, SEEDS, Follow, Model, Plan
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.evaluation import elementwise
from gearopt.optimise.options import check, in_turn, named
from gearopt.optimise.pareto.objectives import Tradeoff, chosen_of, traded
from gearopt.optimise.problem import Problem, one_objective
from gearopt.optimise.result import Budget, Result, Watch, plain
from gearopt.optimise.workers import working
from gearopt.scenes.explaining.possible import without_design
from gearopt.scenes.kind import Kind
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.linked_files import inputs_of, stopped_early
from gearopt.scenes.reading.load import FORMAT, bare, kind_named, kind_of
from gearopt.scenes.reading.load import load as load_file

if TYPE_CHECKING:
    from gearopt.optimise.comparing.comparison import Comparison
    from gearopt.optimise.explaining.explanation import Explanation
    from gearopt.optimise.pareto.front import Front

File = str | Path | Mapping[str, Any] | BaseModel  # its path, its tables, or what `load` returns
Changes = Mapping[str, Any] | None  # {key of a file: value}


@named
def load(what: File, changes: Changes = None) -> BaseModel:
    """Return the scene of a problem file; SceneError says where it is wrong and what to write.

    what: a path, or the tables of a file as `tomllib` gives them. changes: {key: value} of what is
    otherwise than in the file, by the keys that `explain` writes: {"duty.power": "9 kW",
    "stage[2].face_width_over_diameter": 0.7, "limits.pinion_teeth[2]": 60}; counted from 1. A key
    that the file lacks is added, None removes one, and a dict stands for a whole table. Other files
    that it names stand beside the file, or in the working directory for tables; one whose gears it
    takes is solved.
    """
    return _opened(what, changes)[0]


@in_turn
def solve(
    what: File | Problem | Conic,
    changes: Changes = None,
    *,
    method: str | None = None,
    budget: Budget | None = None,
    seed: int = 0,
    watch: Watch | None = None,
    gap: float | None = None,
    top: int = 1,
    prices: bool | float = False,
    start: Mapping[str, Any] | None = None,
    remedies: bool = True,
    workers: int = 1,
) -> Result:
    """Return the certified answer to a problem file, its tables or scene, or a problem of your own.

    changes: of a file, as in `load`; `Result.asked` holds the tables with them, to solve again.
    method: by default the scene's or problem's own. budget: seconds and evaluations. watch(event)
    returns False to stop the run. gap: relative gap to our bound that is enough, so that a search
    may end there; None: none is, and 1e-6 is called optimal. top: so many next best answers too
    (drives with a [teeth] table). prices: report["prices"] holds the sensitivities to every number
    of the file, as `explain` does; a number: in so many times the seconds of the answer, at most,
    and 2 s. start: of a Problem, values by name of the variable from which ipopt, multistart and
    annealing begin instead of the guess. remedies: of an impossible file report["ways_out"] holds
    what to write instead; False: its proof alone. workers: of a Problem whose text is run point by
    point, such as a simulation, processes that annealing and nsga2 share them among. SceneError for
    a wrong file or change, SolveError where the method does not fit, or an option changes nothing,
    ValueError for an option of another sort. Threads take turns, each with its own budget.
    """
    check(method=method, budget=budget, seed=seed, watch=watch, gap=gap, top=top, prices=prices)
    check(start=start, remedies=remedies, workers=workers)
    budget, watch = replace(budget or Budget(), gap=gap or 0.0), whole(watch)
    asked = {"method": method, "seconds": budget.seconds, "evaluations": budget.evaluations}
    asked |= {"gap": gap, "seed": seed, "top": top, "prices": prices}
    gap = GAP if gap is None else gap
    _check_slow(what, workers)
    if isinstance(what, Problem | Conic):
        _unchanged(what, changes)
        _only_of_files(what.name, top, prices)
        from gearopt.optimise.own_problems import solve_own

        with working(workers):
            return solve_own(what, method, budget, seed, watch, gap, start)
    _only_of_problems(start)
    ask = Ask(method, budget, seed, watch, gap, top)
    scene, kind, names, ask = _opened_for(what, changes, ask)
    if why := kind.idle(scene, method).get("top"):
        if top > 1:
            raise SolveError(f"top={top} changes nothing here: {why}; leave it out")
        asked["top"] = None
    begun = time.perf_counter()
    result = kind.solve(scene, ask)
    if prices and result.value is not None and result.status != "evaluated":
        result = _with_prices(result, scene, kind, ask.for_prices(prices, result.seconds))
    if remedies and without_design(result):
        result = _with_remedies(result, what, changes, scene, kind, ask, begun)
    result = _with_inputs(result, scene)
    return _named(result, **names | {"options": asked | names["options"]})


def _with_inputs(result: Result, scene: BaseModel) -> Result:
    """A result with the files it rests on, each with its hash, and what is not final there."""
    if not (inputs := inputs_of(scene)):
        return result
    report = result.report | {"inputs": inputs}
    if notes := stopped_early(scene):
        report["notes"] = [*report.get("notes", []), *notes]
    return replace(result, report=report)


@in_turn
def rate(
    what: "File | Front | Result", changes: Changes = None, *, design: int | None = None
) -> Result:
    """Return the rating of the gears that a problem file gives: the table [rating] says by what.

    changes: of a file, as in `load`. design: the number of a design of a Front, from 1, which is
    rated as gears that are given, by the file of the front; that of a Result is rated likewise. The
    status is `evaluated`;
    `Result.feasible` says whether all safety factors are met, limits holds them as utilisations
    (asked for over there), and design["rating"] stresses, safety factors, lives, factors, forces
    and tooth geometry.
    SceneError for a wrong file or change, SolveError names what cannot be rated.
    """
    from gearopt.optimise.pareto.front import Front

    if isinstance(what, Front):
        return _rate_design(what, changes, design)
    if design is not None:
        raise SolveError(f"design={design} is for a Front, as `pareto` returns it; leave it out")
    if isinstance(what, Result):
        if changes is not None:
            raise SolveError("changes are those of a problem file; a result is rated as it is")
        return _rate_found(what, what.design, {})
    scene, kind, names = _opened(what, changes)
    if kind.rate is None:
        name = names["scene"]
        raise SolveError(f'rate takes kind = "drive", not "{name}"; gearopt solve rates a pair')
    return _named(_with_inputs(kind.rate(scene, Ask()), scene), **names)


def _rate_design(front: "Front", changes: Changes, design: int | None) -> Result:
    """Return the rating of a design of a front, counted from 1."""
    count = len(front.points)
    if changes is not None:
        raise SolveError("changes are those of a problem file; a design of a front is as it is")
    if front.scene is None or kind_named(front.scene).rate_design is None:
        of = "a Problem" if front.scene is None else f'kind = "{front.scene}"'
        raise SolveError(f'designs of fronts are rated of kind = "drive"; this front is of {of}')
    if not count:
        raise SolveError("the front has no design that could be rated")
    if design is None or not 1 <= design <= count:
        wrong = "name a design" if design is None else f"there is no design {design}"
        raise SolveError(f"{wrong} of the front, from 1 to {count}")
    return _rate_found(front, front.points[design - 1].design, {"design": design})


def _rate_found(kept: "Front | Result", design: Mapping[str, Any], options: Any) -> Result:
    """Return the rating of a design that was found, as of gears that are given."""
    scene, kind, names = _opened(kept.asked, None)
    if kind.rate_design is None or not design:
        raise SolveError('of results the gears of kind = "drive" are rated, where there are any')
    result = kind.rate_design(scene, Ask(), design)
    return _named(_with_inputs(result, scene), **names | {"options": options})


@in_turn
def export(what: File | Result, format: str, changes: Changes = None) -> bytes:
    """Return the bytes of a file for other programs: the answer to a problem file, or a Result.

    format: rexs (XML 2.0.0; of a drive), step (drive, pair), dxf (these and strain_wave) or csv
    (all these and dynamics). changes: of a file, as in `load`. Gears that are all given are rated
    first, others found. SceneError for a wrong file, SolveError where the answer has no such file,
    or its kind has no such format.
    """
    from gearopt.report.kinds import pages_of

    if isinstance(what, Result) and changes is not None:
        raise SolveError("changes are those of a problem file; a result is written as it is")
    scene = None if isinstance(what, Result) else load(what, changes)
    name = what.scene if isinstance(what, Result) else kind_of(scene)  # type: ignore[arg-type]
    formats = pages_of(name).exports
    if format not in formats:
        of = f'kind = "{name}"' if name else "a Problem"
        known = f"; it is as {', '.join(formats)}" if formats else ""
        raise SolveError(f"{of} is not exported as {format}{known}")
    given = getattr(scene, "given", False) and not getattr(scene, "to_size", True)
    answer = what if isinstance(what, Result) else (rate if given else solve)(what, changes)
    if not answer.design:
        raise SolveError(f"there is no design to export ({answer.status}: {answer.message})")
    try:
        return formats[format](answer)
    except (ValueError, ImportError) as why:
        raise SolveError(f"{format}: {why}") from None


@in_turn
def explain(
    what: File | Problem | Conic,
    changes: Changes = None,
    *,
    budget: Budget | None = None,
    watch: Watch | None = None,
) -> "Explanation":
    """Explain why the answer to a file, a scene or a problem is what it is.

    changes: of a file, as in `load`. Possible: the limits that bind, and the sensitivity to every
    number of the file (to every parameter, and bound with a key, of a problem). Impossible: the
    limits in conflict, and remedies that were tried: what to write instead. SceneError and
    SolveError as in `solve`.
    """
    from gearopt.optimise.explaining.explain import explain as explain_problem
    from gearopt.optimise.maximised import explained_as_asked
    from gearopt.scenes.explaining.explanations import explanation

    check(budget=budget, watch=watch)
    budget, watch = budget or Budget(), whole(watch)
    if isinstance(what, Conic):
        raise SolveError(
            f"explain takes a Problem; {what.name} is a Conic, whose conflict `solve` names already"
        )
    if isinstance(what, Problem):
        _unchanged(what, changes)
        return explained_as_asked(explain_problem(what, budget, watch))
    scene, kind, names, ask = _opened_for(what, changes, Ask(budget=budget, watch=watch))
    explained = explanation(kind, scene, ask)
    result = _with_inputs(explained.result, scene)
    return replace(explained, result=_named(result, **names), message=_whose(explained, scene))


def _whose(explained: "Explanation", scene: BaseModel) -> str:
    """What an explanation says of a file that takes its gears from others, after its own words."""
    others = ", ".join(inputs_of(scene)) if explained.influences else ""
    said = f"the numbers of {others} are not among these" if others else ""
    return "; ".join(filter(None, (explained.message, said)))


def _with_prices(result: Result, scene: BaseModel, kind: Kind[Any], ask: Ask) -> Result:
    """A result with the sensitivities to every number of the file."""
    from gearopt.scenes.explaining.explanations import explanation

    explained = explanation(kind, scene, ask, result)
    return replace(result, report=result.report | {"prices": explained.prices})


def _with_remedies(
    result: Result,
    what: File,
    changes: Changes,
    scene: BaseModel,
    kind: Kind[Any],
    ask: Ask,
    begun: float,
) -> Result:
    """An impossible result with what to write instead, which the watcher is told of first."""
    if not kind.has_remedies(scene):
        return result
    from gearopt.scenes.explaining.explanations import ways_out

    tell_known(ask.watch, result)
    clock = Clock(ask.budget, of_others(ask.watch), begun)
    ways = ways_out(kind, scene, clock, result, True)
    if ways is None:
        return result
    report = {**result.report, **ways.drawn, "ways_out": ways.told}
    return replace(result, report=report, seconds=clock.seconds)


def idle_options(
    what: File, method: str | None, budget: Budget | None = None, watch: Watch | None = None
) -> dict[str, str]:
    """Return the options of `solve` that change nothing for a file, each with the reason."""
    ask = Ask(budget=budget or Budget(), watch=watch)
    scene, kind, *_ = _opened_for(what, None, ask)
    return kind.idle(scene, method)


def _check_slow(what: Any, workers: int) -> None:
    """Raise SolveError for workers of what is no text that is run point by point."""
    if workers > 1 and not (isinstance(what, Problem) and not elementwise(what, None)):
        raise SolveError(
            f"workers={workers} changes nothing here: it is for a Problem whose text is run point "
            "by point, such as a simulation; leave it out"
        )


def _only_of_problems(start: Mapping[str, Any] | None) -> None:
    """Raise SolveError for options of a problem of one's own that are asked of a file."""
    if start is not None:
        raise SolveError("start changes nothing here: it is for a Problem; leave it out")


def _only_of_files(name: str, top: int, prices: bool | float) -> None:
    """Raise SolveError for options of problem files that are asked of a problem of one's own."""
    if top > 1:
        raise SolveError(f"top={top} changes nothing here: {name} has no next best answers")
    if prices:
        raise SolveError(f"prices=True is for files: explain({name}) has its sensitivities")


DEFAULT = ("ipopt", "annealing", "nsga2")  # compared beside exact algorithms where none are named


@in_turn
def compare(
    what: File | Problem | Conic,
    changes: Changes = None,
    *,
    objectives: Sequence[str] | str | None = None,
    most: Mapping[str, float] | None = None,
    methods: Sequence[str] | str | None = None,
    seeds: int = SEEDS,
    evaluations: int = EVALUATIONS,
    seconds: float = SECONDS,
    bound_from: str | None = None,
    watch: Follow | None = None,
) -> "Comparison":
    """Compare methods on a problem file, its tables or scene, or a problem of your own.

    changes: of a file, as in `load`.
    objectives: two or three names, of which whole fronts are compared, up to the values in `most`;
    without them the one objective of the file. methods: by default those of the file's kind; of a
    problem its own exact ones, ipopt, annealing and nsga2 (of a Conic: conic); of fronts the one
    that proves most, nsga2, annealing and hybrid (of a Conic: epsilon).
    Every method is run by evaluations and by seconds, random ones once for each of the seeds 0, 1,
    ... bound_from: a method run once to prove a bound. watch(progress) ends the comparison by
    returning False, and what is finished is reported. SceneError for a wrong file, SolveError where
    a method is unknown or none takes the problem, ValueError for a budget or number of seeds below
    1.
    """
    from gearopt.optimise.comparing.compare import compare as compare_methods

    check(seeds=seeds, evaluations=evaluations, seconds=seconds, bound_from=bound_from, watch=watch)
    check(most=most)
    plan = Plan(evaluations, seconds, seeds)
    methods = methods.split(",") if isinstance(methods, str) else methods
    if objectives is not None:
        asking = Ask(budget=Budget(seconds))
        pose, names, about = _traded(what, changes, objectives, asking)
        comparison = _fronts(pose, names, most, methods, plan, watch, bound_from)
        return replace(comparison, **_of_comparison(about))
    if most is not None:
        raise SolveError("most changes nothing here: it is for objectives of fronts; leave it out")
    if isinstance(what, Problem | Conic):
        _unchanged(what, changes)
        usual = ("conic",) if isinstance(what, Conic) else (*what.methods, *DEFAULT)
        chosen = usual if methods is None else methods
        one_objective(what.name, what.rows.objectives)
        model = Model(what)
        comparison = compare_methods(chosen, lambda method: model, plan, watch, bound_from)
        return replace(comparison, title=what.name)
    asking = Ask(budget=Budget(seconds))
    scene, kind, about = _opened(what, changes, asking)
    chosen = kind.methods_to_compare(scene) if methods is None else methods
    comparison = compare_methods(chosen, lambda m: kind.posed(scene, m), plan, watch, bound_from)
    title = getattr(scene, "title", "") or about["scene"]
    return replace(comparison, title=title, **_of_comparison(about))


def _of_comparison(names: dict[str, Any]) -> dict[str, Any]:
    """Return the names of a file as a comparison has them: what is changed, not the tables."""
    kept = {k: v for k, v in names.items() if k not in ("asked", "options", "report")}
    head = (names.get("asked") or {}).get("report") or {}
    return kept | {"changes": names.get("options", {}).get("changes", {}), "head": head}


def _fronts(
    pose: Callable[[Ask], Tradeoff],
    names: Sequence[str],
    most: Mapping[str, float] | None,
    methods: Sequence[str] | None,
    plan: Plan,
    watch: Follow | None,
    bound_from: str | None,
) -> "Comparison":
    """Compare methods of fronts, as `compare` does those of one objective."""
    from gearopt.optimise.comparing.fronts import compare_fronts
    from gearopt.optimise.pareto.tradeoff import compared_methods

    words = f"Front of {', '.join(name.replace('_', ' ') for name in names)}"
    first = pose(Ask())
    if first.others:
        raise SolveError(
            "methods are compared on fronts of one problem: write one number of stages in the file"
        )
    listed = methods or compared_methods(first.problem, first.limiting)

    def model(method: str) -> Model:
        return Model(pose(Ask(method)).problem, words)

    return compare_fronts(listed, model, names, most, plan, watch, bound_from, first.limiting)


def _traded(
    what: File | Problem | Conic,
    changes: Changes,
    objectives: Sequence[str] | str | None,
    asking: Ask,
) -> tuple[Callable[[Ask], Tradeoff], tuple[str, ...], dict[str, Any]]:
    """Return how objectives are posed as is asked, their names, and the names of a file."""
    names = objectives.split(",") if isinstance(objectives, str) else objectives
    names = None if names is None else [name.strip() for name in names]
    if isinstance(what, Problem | Conic):
        _unchanged(what, changes)
        tradeoff = traded(what, names)
        return (
            lambda ask: tradeoff,
            tuple(o.name for o in tradeoff.objectives),
            {"title": what.name},
        )
    scene, kind, about = _opened(what, changes, asking)
    known = kind.trades.objectives(scene)
    left = [name for name in names or () if name not in known]
    if left and (why := kind.trades.advice(scene, left)):
        raise SolveError(why)
    chosen = chosen_of(names, list(known), f'this file of kind "{about["scene"]}"')
    texts = {"assumptions": kind.assumptions(scene), "notes": kind.trades.notes(scene, chosen)}
    about |= {
        "title": getattr(scene, "title", ""),
        "report": {key: said for key, said in texts.items() if said},
    }
    return lambda ask: kind.trades.traded(scene, chosen, ask), chosen, about


@in_turn
def pareto(
    what: File | Problem | Conic,
    changes: Changes = None,
    *,
    objectives: Sequence[str] | str | None = None,
    most: Mapping[str, float] | None = None,
    method: str | None = None,
    points: int | None = None,
    weights: Mapping[str, float] | None = None,
    budget: Budget | None = None,
    seed: int = 0,
    watch: Watch | None = None,
    workers: int = 1,
) -> "Front":
    """Return the Pareto front of two or three objectives: the designs that none dominates.

    changes: of a file, as in `load`.
    objectives: names; without them the error lists those of a file, and of a Problem all that it
    minimises are taken.
    most: largest values of interest by name, in the units of the objectives. method: exact (all
    designs of whole teeth, proven), epsilon (real-valued sizes, point by point), nsga2, annealing
    or hybrid; by default the one that proves most. points: sought, where a method has a choice: 60,
    of three objectives 400. weights: by name, of the design to pick. workers: as in `solve`, of
    nsga2 and annealing. SceneError for a wrong file, SolveError where objectives or method
    do not fit.
    """
    from gearopt.optimise.pareto.tradeoff import solved

    check(method=method, budget=budget, seed=seed, watch=watch, points=points, workers=workers)
    check(most=most, weights=weights)
    budget, watch, most = budget or Budget(), whole(watch), dict(most or {})
    clock = Clock(budget)
    asking = Ask(budget=budget, watch=watch).beforehand
    pose, _, about = _traded(what, changes, objectives, asking)
    options: dict[str, Any] = {"method": method, "seconds": budget.seconds, "points": points}
    options |= {"most": most, "weights": weights, "seed": seed}
    about["options"] = options | about.get("options", {})
    _check_slow(what, workers)
    with working(workers):
        trade = pose(Ask(method, budget, seed, watch))
        return solved(trade, most, method, points, weights, clock.left, seed, watch, **about)


def _unchanged(problem: Problem | Conic, changes: Changes) -> None:
    """Raise ValueError for changes of what is no file."""
    if isinstance(changes, list | tuple | str):
        raise ValueError(
            f"{changes!r}: options have names, as in method='ipopt', or "
            "methods=['ipopt', 'annealing'] of compare"
        )
    if changes is not None:
        raise ValueError(
            "changes are those of a problem file; write problem.at(name=value) for a parameter of "
            f"{problem.name}"
        )


def _opened_for(
    what: File, changes: Changes, ask: Ask
) -> tuple[BaseModel, Kind[Any], dict[str, Any], Ask]:
    """As `_opened`, and what is left to ask once its gears are known."""
    begun = time.perf_counter()
    scene, kind, names = _opened(what, changes, ask.beforehand)
    spent = time.perf_counter() - begun if inputs_of(scene) else 0.0
    return scene, kind, names, replace(ask, budget=ask.budget.less(spent))


def _opened(
    what: File, changes: Changes, asking: Ask | None = None
) -> tuple[BaseModel, Kind[Any], dict[str, Any]]:
    """Return the scene of what was given, its kind, and its names for a result.

    asking: by which a file is solved whose gears it takes.
    """
    if not isinstance(changes, Mapping | NoneType):
        raise ValueError(
            f"{changes!r} is not a dict of changes, such as {{'duty.power': '9 kW'}}; options have "
            "names, as in method='exact', or methods=['ipopt', 'annealing'] of compare"
        )
    if not isinstance(what, str | Path | Mapping | BaseModel):
        raise ValueError(
            f"{type(what).__name__}: write the path of a problem file, its tables, what `load` "
            "returns, or a Problem"
        )
    if isinstance(what, str) and "\n" in what:
        raise ValueError("that is the text of a file: write its path, or tomllib.loads(text)")
    if isinstance(what, BaseModel):
        from gearopt.scenes.explaining.numbers import content

        scene, kind = what, kind_of(what)
        what = {"gearopt": FORMAT, "kind": kind, **content(scene)}
        if not changes:
            return scene, kind_named(kind), {"scene": kind, "asked": bare(what), "options": {}}
    loaded = load_file(what, changes, asking)
    names: dict[str, Any] = {
        "scene": loaded.kind,
        "file": loaded.file,
        "file_sha256": loaded.sha256,
        "asked": loaded.asked,
        "options": {"changes": loaded.changes} if loaded.changes else {},
    }
    return loaded.scene, kind_named(loaded.kind), names


def _named(result: Result, **names: Any) -> Result:
    return replace(result, design=plain(result.design), report=plain(result.report), **names)
