"""The best relief of a pair's flanks, as its table [relief] asks for it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.pair.contact import PairMesh, column
from gearopt.formulations.pair.design import JudgedRelief, PairRelief
from gearopt.formulations.pair.relief import parametric
from gearopt.formulations.pair.relief.free_form import Profile, Shape, free_problem
from gearopt.formulations.pair.relief.meshing import NO_RELIEF, Mesh, Relief
from gearopt.formulations.pair.relief.parametric import Ranges
from gearopt.formulations.pair.relief.relief_tolerance import Tolerance, robust_problem
from gearopt.formulations.pair.relief_map import Removed, as_made, described
from gearopt.optimise.certified import run
from gearopt.optimise.clock import in_part
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.pareto.objectives import Limiting, Objective, Tradeoff
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.optimise.solve import evaluate
from gearopt.optimise.terms import Array, Terms, Var
from gearopt.optimise.typed import untyped
from gearopt.physics.tooth.ladder import COUPLINGS
from gearopt.physics.tooth.validity import EXACT, errors_in_mesh, installed
from gearopt.scenes.pair.contact import LEAST_SECONDS, coupling_name, models_of
from gearopt.scenes.pair.relief_tables import ReliefTable
from gearopt.scenes.pair.scene import Scene
from gearopt.scenes.reading.ask import Ask

DEFAULT = "annealing"  # of what has no proven search
FREE_SHAPES_BELOW = 2.0  # contact ratio below which free shapes are searched
AT_END = 1e-6  # of a range: a value as near to its end is at it
WORST = 1e-3  # relative gap of a worst case within tolerances
ROBUST = "the worst case is annealed: without tolerance the least value is proven, with it none is"
NUMBERS = ("annealing", "nsga2")  # methods that take no derivatives, which a relief has not
UNBOUND = "without the method exact there is no bound"
UNPROVEN = "only transmission errors have a proven search: of shares of the load there is no bound"
ABSENT = (
    "Finite elements, the finest level, are not installed, so that the relief is not judged by "
    "them: pip install 'gearopt[fem]'."
)
HASTY = "There was no time left to judge the relief by finite elements, the finest level."
JUDGING = 3.0  # s that a search leaves, a quarter of its time at most, for finite elements
KEYS = {"amount": "relief.amount", "length": "relief.length"}  # of variables: their places


def loads_of(scene: Scene) -> tuple[float, ...]:
    """Return the loads that the relief is made for, relative to that of the duty."""
    assert scene.relief
    return tuple(float(load) for load in scene.relief.loads or scene.sharing.loads)


def relieved(scene: Scene, made: PairMesh, ask: Ask) -> tuple[Result, PairRelief | None]:
    """Return the result of the search for the best relief, and the relief that it found."""
    asked, loads = scene.relief, loads_of(scene)
    assert asked
    mesh, search = made.of_loads(loads), _free if asked.free else _parametric
    judging = 0.0 if made.level == EXACT else min(JUDGING, 0.25 * (ask.budget.seconds or 0.0))
    result, removed = search(asked, mesh, replace(ask, budget=ask.budget.less(judging)))
    result = _scoped(result, made)
    if removed is None:
        return result, None
    tolerance = None if asked.tolerance is None else _tolerance(asked, mesh)
    relief = described(made, removed, asked.minimise, loads)
    if tolerance is not None:
        nominal, within = _nominal(relief), replace(ask.budget, gap=WORST)
        watch = in_part(ask.watch, part="worst case within tolerances")
        kept = as_made(mesh, nominal, tolerance, within, ask.seed, watch)
        relief = replace(relief, made=kept)
    left = ask.budget.seconds
    return result, _judged(scene, made, removed, relief, left and left - result.seconds)


def _scoped(result: Result, made: PairMesh) -> Result:
    """Return a result whose proof names the model of the teeth that it holds under."""
    if "scope" not in result.proof:
        return result
    return replace(result, proof=result.proof | {"scope": _under(made, result.proof["scope"])})


def _under(made: PairMesh, scope: str) -> str:
    return f"under {made.level}, {scope}"


def _judged(
    scene: Scene, made: PairMesh, removed: Removed, relief: PairRelief, left: float | None
) -> PairRelief:
    """Return a relief with the models it was chosen under, and what the finest level says of it."""
    elastic, name = made.elastic, coupling_name(models_of(scene, made.elastic)[1])
    known = errors_in_mesh(elastic, made.level, name)
    relief = replace(relief, level=made.level, coupling=name, in_mesh=known)
    if (made.level, name) == (EXACT, EXACT):
        return relief
    if not installed() or (left is not None and left < LEAST_SECONDS):
        return replace(relief, unjudged=HASTY if installed() else ABSENT)
    torque, steps = scene.duty.input_torque, scene.sharing.positions
    fine = PairMesh.of(elastic, EXACT, torque, COUPLINGS[EXACT](elastic), steps, relief.loads).mesh
    there = fine.criteria(removed.on(made.mesh, fine).separations(fine))
    plain = fine.criteria(fine.separations(NO_RELIEF, NO_RELIEF))
    judged = JudgedRelief(
        level=EXACT,
        value=float(parametric.objective(there, relief.minimise)),
        without_relief=float(parametric.objective(plain, relief.minimise)),
        peak_to_peak_mm=column(there.peak_to_peak),
    )
    return replace(relief, judged=judged)


def _nominal(relief: PairRelief) -> tuple[Relief, Relief]:
    """Return a relief by amount, length and exponent as it is drawn."""
    first, second = (
        Relief(flank.amount_mm, flank.length_mm, flank.exponent or 1.0)
        for flank in (relief.pinion, relief.wheel)
    )
    return first, second


def _tolerance(asked: ReliefTable, mesh: Mesh) -> Tolerance:
    """Return the tolerances [mm] of amounts and lengths."""
    assert asked.tolerance
    part = float(asked.length_tolerance or 0)
    return Tolerance(asked.tolerance.value, part * float(mesh.cycle.path.base_pitch))


def _parametric(asked: ReliefTable, mesh: Mesh, ask: Ask) -> tuple[Result, Removed | None]:
    """Result with the best amounts and lengths; where they are given, what these do."""
    ranges = _ranges(asked, mesh)
    problem = _posed(asked, mesh, ranges)
    why = UNBOUND if "exact" in problem.methods else ROBUST if asked.robust else UNPROVEN
    result, reliefs = searched(asked, problem, ranges, ask, why)
    return result, None if reliefs is None else Removed.of(mesh, reliefs)


def searched(
    asked: ReliefTable, problem: Problem, ranges: Ranges, ask: Ask, why: str
) -> tuple[Result, tuple[Relief, Relief] | None]:
    """Result with the best reliefs of pinion and wheel; why: there may be no bound."""
    if asked.given:
        point = problem.bounds()[0]
        result = _united(evaluate(problem, point), asked.minimise)
        return result, parametric.at_point(point, ranges)
    _check_method(problem, ask.method)
    watch = in_part(ask.watch, _unit(asked.minimise))
    method = ask.method or ("exact" if "exact" in problem.methods else DEFAULT)
    result, outcome = run(problem, method, ask.budget, ask.seed, watch, ask.gap)
    result = _united(result, asked.minimise)
    if result.value is None or outcome.x is None:
        return result, None
    if result.bound is None and method != "exact":
        result = replace(result, message=why)
    if notes := _ends(problem, outcome.x):
        result = replace(result, report=result.report | {"notes": notes})
    return result, parametric.at_point(outcome.x, ranges)


def _ends(problem: Problem, point: Array) -> list[str]:
    """Return where an amount or a length ends its range: there a wider one may give less."""
    low, high, _ = problem.bounds()
    near = AT_END * (high - low)
    most, least = (high > low) & (point >= high - near), (high > low) & (point <= low + near)
    said = []
    for k, name in enumerate(("pinion", "wheel")):
        reached = {"deep": most[k], "long": most[k + 2], "short": least[k + 2] & (point[k] > 0.0)}
        words = [f"as {word}" for word, there in reached.items() if there]
        if words:
            rule = "as the range in [relief] allows: a wider one may give less."
            said.append(f"The relief of the {name} is {' and '.join(words)} {rule}")
    return said


def _check_method(problem: Problem, method: str | None) -> None:
    """Refuse a method that does not suit the search for a relief."""
    known = (*problem.methods, *NUMBERS)
    if method is not None and method not in known:
        raise SolveError(f"no method {method!r} for this relief; methods: {', '.join(known)}")


def _free(asked: ReliefTable, mesh: Mesh, ask: Ask) -> tuple[Result, Removed | None]:
    """Return the best relief of any convex shape."""
    problem, watch = _free_problem(asked, mesh), in_part(ask.watch, _unit(asked.minimise))
    _check_method(problem, ask.method)
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = _united(result, asked.minimise)
    if result.value is None or outcome.x is None:
        return result, None
    profile = Profile(mesh, Shape(asked.amount[1].value))
    return result, Removed.of_profile(profile, outcome.x)


def _free_problem(asked: ReliefTable, mesh: Mesh) -> Problem:
    """Return the problem of any convex shape; SolveError where it has none."""
    if float(mesh.cycle.path.transverse_ratio) >= FREE_SHAPES_BELOW:
        raise SolveError(
            'a free shape is searched for contact ratios below 2: write shape = "linear", or '
            "another one, in [relief]"
        )
    problem = free_problem(mesh, Shape(asked.amount[1].value))
    keyed = tuple(replace(v, key=KEYS["amount"]) for v in problem.variables)
    return replace(problem, variables=keyed)


def _united(result: Result, minimise: str) -> Result:
    """Return a result with the unit of its criterion."""
    return replace(result, objective=result.objective | {"unit": _unit(minimise)})


def _ranges(asked: ReliefTable, mesh: Mesh) -> Ranges:
    """Ranges of the relief of a mesh at its loads."""
    low, high = (end.value for end in asked.amount)
    ranges = Ranges.of(mesh, asked.exponent, high)
    if asked.length is not None:
        pitch = float(mesh.cycle.path.base_pitch)
        lengths = float(asked.length[0]) * pitch, float(asked.length[1]) * pitch
        ranges = replace(ranges, lengths=lengths)
    return replace(ranges, amounts=(low, high))


def _posed(asked: ReliefTable, mesh: Mesh, ranges: Ranges) -> Problem:
    """Return the problem of a criterion, or of its worst case within tolerances."""
    if not asked.robust:
        return _problem(asked, mesh, ranges)
    problem = robust_problem(mesh, ranges, _tolerance(asked, mesh))
    return replace(problem, variables=keyed(problem))


def keyed(problem: Problem) -> tuple[Var, ...]:
    """Return the variables of a relief with the places of their ranges in the file."""
    return tuple(replace(v, key=KEYS[v.name]) for v in problem.variables)


def _problem(
    asked: ReliefTable,
    mesh: Mesh,
    ranges: Ranges,
    names: Mapping[str, str] | None = None,
    most: Mapping[str, float] | None = None,
) -> Problem:
    """Return the problem of the relief with the places of its ranges in the file.

    names: of objectives, and of what they are called by its formulation. most: largest values of
    some, by the latter.
    """
    names = names or {asked.minimise: asked.minimise}
    unkeyed = parametric.problem(mesh, ranges, tuple(names.values()), dict(most or {}))

    def evaluate(x: Any, p: Any) -> Terms:
        terms = unkeyed.evaluate(x, p)
        return replace(terms, minimise={n: terms.minimise[own] for n, own in names.items()})

    return replace(unkeyed, variables=keyed(unkeyed), evaluate=evaluate)


def model(scene: Scene, made: PairMesh) -> Model:
    """Return the problem that a method solves."""
    assert scene.relief
    unit = _unit(scene.relief.minimise)
    if scene.relief.free:
        problem = _free_problem(scene.relief, made.of_loads(loads_of(scene)))
        return Model(problem, "Relief of any convex shape, at computed positions", unit)
    mesh = made.of_loads(loads_of(scene))
    problem = _posed(scene.relief, mesh, _ranges(scene.relief, mesh))
    return Model(problem, "Amounts and lengths of relief, at computed positions", unit)


def objectives(scene: Scene) -> dict[str, str]:
    """Objectives of a front of reliefs: the worst of all loads, or at one of them.

    A free shape has no front.
    """
    if scene.relief and scene.relief.free:
        return {}
    return {name: _unit(own.partition("_at_")[0]) for name, own in _named(scene).items()}


def _named(scene: Scene) -> dict[str, str]:
    """Return names of objectives, and what they are called by the formulation.

    At a load of 60 % "peak_to_peak_at_60", of the first load "peak_to_peak_at_1".
    """
    known, loads = list(parametric.OBJECTIVES), loads_of(scene)
    at = [f"{100.0 * load:.4g}".replace(".", "_") for load in loads] if len(loads) > 1 else []
    each = {f"{name}_at_{a}": f"{name}_at_{k}" for name in known for k, a in enumerate(at, 1)}
    return {name: name for name in known} | each


def traded(scene: Scene, made: PairMesh, names: Sequence[str]) -> Tradeoff:
    """Return the problem of a front of reliefs; of transmission errors every point is proven."""
    asked = scene.relief
    assert asked
    mesh = made.of_loads(loads_of(scene))
    ranges = _ranges(asked, mesh)
    units, known = objectives(scene), _named(scene)

    def drawn(x: Array) -> dict[str, Any]:
        removed = Removed.of(mesh, parametric.at_point(x, ranges))
        relief = described(made, removed, asked.minimise, loads_of(scene))
        design: dict[str, Any] = untyped(relief)
        return design

    listed = tuple(Objective(name, units[name]) for name in names)
    chosen = {name: known[name] for name in names}

    def limited(name: str, most: Mapping[str, float]) -> Problem:
        held = {known[other]: value for other, value in most.items()}
        return _problem(asked, mesh, ranges, {name: known[name]}, held)

    proven = tuple(name for name in known if name.startswith(parametric.PROVEN))
    limiting = Limiting(limited, proven) if set(names) <= set(proven) else None
    where = _under(made, mesh.sampled) if limiting else ""
    return Tradeoff(_problem(asked, mesh, ranges, chosen), listed, drawn, limiting, scope=where)


def _unit(name: str) -> str:
    """Return the unit of a criterion."""
    return parametric.OBJECTIVES[name][0]
