"""The tolerances of a servo train at minimum cost, and the error that they give in fact."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.servo.choice import TIE, binding
from gearopt.formulations.servo.servo_design import (
    Allocation,
    BudgetUse,
    ServoDesign,
    ServoReport,
    ToleranceRow,
)
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.formulations.servo.tolerance import grades as graded
from gearopt.formulations.servo.tolerance import problem as continuous
from gearopt.formulations.servo.tolerance.sampling import drawn
from gearopt.formulations.servo.tolerance.stack import RUN_OUT, Component, ErrorBudget, Stack
from gearopt.optimise.clock import in_part
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Outcome, Result
from gearopt.optimise.solve import run
from gearopt.optimise.terms import Array, Terms, Var
from gearopt.optimise.typed import untyped
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.servo.axis_steps import added, elastic, gears_of, sensitivity
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.mesh import BudgetTable, Price, Source

RULES: tuple[tuple[str, Any, float], ...] = (  # name, rule and kappa
    ("worst_case", "worst_case", 0.0),
    ("rss", "rss", 0.0),
    ("mean", "mean_plus_sd", 0.0),
    ("mean_plus_3_sd", "mean_plus_sd", 3.0),
)


def stack(scene: Scene, gears: Pairs) -> Stack:
    """Return the deviations of a file as a tolerance stack of given gears; errors in degrees."""
    table = scene.tolerances
    assert table is not None
    low = 0.0 if table.least_factor is None else float(table.least_factor)
    high = math.inf if table.largest_factor is None else float(table.largest_factor)
    parts = tuple(
        Component(
            name=s.name,
            sensitivity=math.degrees(sensitivity(gears, s)),
            cost=price.cost * s.tolerance**price.exponent,
            exponent=price.exponent,
            least=low * s.tolerance,
            most=high * s.tolerance,
            distribution=s.law,
        )
        for s, price in zip(scene.sources, scene.prices, strict=True)
    )
    asked = scene.accuracy.error
    limit = None if asked is None else math.degrees(asked.value)
    tables, lost = enumerate(scene.budget or (BudgetTable(),), 1), start(scene, gears)
    budgets = [_budget(b, parts, old(scene), limit, f"budget[{k}].limit", lost) for k, b in tables]
    return Stack(parts, (*budgets, *_closing(scene, gears)))


def start(scene: Scene, gears: Pairs) -> float:
    """Return the error [deg] that no tolerance changes.

    It is that of two-sided deviations at their lower ends, and of meshes whose stiffness varies.
    """
    lower = sum(s.start * sensitivity(gears, s) for s in scene.sources)
    return math.degrees(lower + sum(elastic(scene, gears)))


def _closing(scene: Scene, gears: Pairs) -> list[ErrorBudget]:
    """Return the budgets of the run-outs, which close a mesh with a minimum backlash."""
    budgets = []
    for k, mesh in enumerate(scene.mesh, 1):
        run_outs = [s for s in scene.sources if s.stage == k and s.law is RUN_OUT]
        if mesh.minimum_backlash is None or not run_outs:
            continue
        left = scene.backlash(k, run_outs=False)[0] - mesh.minimum_backlash.value
        error = math.degrees(2.0 * left * sensitivity(gears, run_outs[0]) / run_outs[0].per_mm)
        names = frozenset(s.name for s in run_outs)
        name, key = f"minimum_backlash[{k}]", f"mesh[{k}].minimum_backlash"
        budgets.append(ErrorBudget("worst_case", error, name=name, key=key, only=names))
    return budgets


def old(scene: Scene) -> Array:
    """Return the tolerances of the file [mm]."""
    import numpy as np

    return np.array([s.tolerance for s in scene.sources])


def _budget(
    table: BudgetTable,
    parts: tuple[Component, ...],
    t: Array,
    limit: float | None,
    key: str,
    lost: float,
) -> ErrorBudget:
    """Return a budget in degrees; its default limit is that of the file, else what t uses.

    lost: the error that is always there, which comes off the limit.
    """
    rule: Any = table.rule
    kappa = float(table.kappa)
    if table.limit is not None:
        limit = math.degrees(table.limit.value)
    elif limit is not None:
        key = "accuracy.error"
    else:
        beside = ErrorBudget("worst_case", 1.0, name="all")  # no part is without influence on it
        limit = lost + float(Stack(parts, (ErrorBudget(rule, 1.0, kappa), beside)).used(t)[0])
    return ErrorBudget(rule, limit - lost, kappa, key=key)


def problem(scene: Scene, gears: Pairs) -> Problem:
    """Return the problem of a file's tolerances: real-valued ones, or grades.

    Of two-sided ones the end that leaves least backlash is held, and the width is sought.
    """
    table = scene.tolerances
    assert table is not None
    if (none := spent(scene, gears)) is not None:
        t = Var("t", "mm", 0.0, 1.0, 0.5, len(scene.sources))
        methods = {"exact": lambda problem, budget, seed, watch: none}
        return Problem("tolerance", (t,), (), lambda x, p: Terms({"cost": x.t[0]}), methods=methods)
    if table.grades is None:
        return continuous(stack(scene, gears))
    return graded.problem(grades(scene, gears))


def grades(scene: Scene, gears: Pairs) -> graded.Choice:
    """Return the grades that a file lets tolerances have."""
    table, errors = scene.tolerances, stack(scene, gears)
    assert table is not None and table.grades is not None
    steps = [2.0 ** (0.5 * j) for j in range(-table.grades, table.grades + 1)]
    parts = tuple(
        graded.Graded(
            c.name,
            c.sensitivity,
            tuple((s.tolerance * f, price.cost * f**-price.exponent) for f in steps),
        )
        for c, s, price in zip(errors.components, scene.sources, scene.prices, strict=True)
    )
    (budget,) = errors.budgets
    rule: Any = budget.rule
    return graded.Choice(parts, budget.error, rule)


def spent(scene: Scene, gears: Pairs) -> Outcome | None:
    """The claim that the numbers held leave nothing to the tolerances; None where some is left."""
    rows = []
    for k, mesh in enumerate(scene.mesh, 1):
        asked, turns = (
            mesh.minimum_backlash,
            any(s.stage == k and s.law is RUN_OUT for s in scene.sources),
        )
        if asked is not None:
            there = scene.backlash(k, run_outs=False)[0]
            rows.append((k, there * (1.0 - TIE) if turns else there, asked.value))
    if (none := binding(tuple(rows))) is not None:
        return none
    lost, asked_error = start(scene, gears), scene.accuracy.error
    limits = [b.limit or asked_error for b in scene.budget or (BudgetTable(),)]
    small = [
        math.degrees(q.value) for q in limits if q is not None and q.value <= math.radians(lost)
    ]
    if not small:
        return None
    varied = " and the varying stiffness of meshes" if scene.elastic is not None else ""
    text = f"the lower allowances{varied} alone give an error of {lost:.5g} degrees, which uses up "
    text += "a budget"
    proof = {"method": "closed form", "sentence": f"Proof: {text}."}
    return Outcome(None, infeasible=True, proof=proof, message=text)


def with_tolerances(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The tolerances of the gears, with their costs and the errors they give."""
    import numpy as np

    gears = gears_of(scene, known)
    if gears is None:
        assert known is not None
        return known
    posed, table = problem(scene, gears), scene.tolerances
    assert table is not None
    watch = in_part(ask.watch, part="tolerances")
    result, outcome = run(posed, ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, name="tolerances", objective=result.objective | {"unit": ""})
    figures: dict[str, Any] = by_every_rule(scene, gears, old(scene), "old")
    if result.value is None or outcome.x is None:
        proof = {k: v for k, v in result.proof.items() if k != "conflict"}
        return added(known, replace(result, proof=proof), report=ServoReport(figures=figures))
    t, errors, lost = np.array(outcome.x, float), stack(scene, gears), start(scene, gears)
    t = widths(scene, t, old(scene))
    allotted = _allocation(errors, t, result, scene, lost)
    draws = drawn(errors, t, lost + errors.budgets[0].error, seed=table.seed, start=lost)
    design = ServoDesign(tolerances=listed(scene, errors)(t), allocation=allotted, drawn=draws)
    figures |= by_every_rule(scene, gears, t, "new")
    figures |= {
        "new_quantile_deg": draws.quantile_deg,
        "new_quantile_low_deg": draws.quantile_low_deg,
        "new_quantile_high_deg": draws.quantile_high_deg,
        "tolerance_cost": allotted.cost,
        "old_tolerance_cost": allotted.old_cost,
    }
    limits = {named(name, errors.components): used for name, used in result.limits.items()}
    result = replace(result, design=untyped(design), limits=limits)
    return added(known, result, design, ServoReport(figures=figures))


def named(limit: str, parts: Sequence[Component | Source]) -> str:
    """Return `least[3]` as "least of centre distance of stage 1"."""
    if limit.startswith("minimum_backlash"):
        return limit
    stem, _, index = limit.rstrip("]").partition("[")
    return f"{stem} of {parts[int(index) - 1].name}" if index else limit


def widths(scene: Scene, x: Array, before: Array) -> Array:
    """Tolerances [mm] of a point of `problem`: those it holds, or those of its grades.

    before: the tolerances of the file (`old`) [mm].
    """
    table = scene.tolerances
    assert table is not None
    return x if table.grades is None else before * 2.0 ** (0.5 * (x - 1.0 - table.grades))


def listed(scene: Scene, own: Stack) -> Callable[[Array], tuple[ToleranceRow, ...]]:
    """Rows of any tolerances t [mm] beside the old ones, with their ends and costs."""
    table, sources, prices = scene.tolerances, scene.sources, scene.prices
    assert table is not None
    ends = 2.0 ** (0.5 * table.grades) if table.grades is not None else None

    def row(source: Source, price: Price, part: Component, new: float) -> ToleranceRow:
        before = source.tolerance
        low, high = (part.least, part.most) if ends is None else (before / ends, before * ends)
        return ToleranceRow(
            name=source.name,
            stage=source.stage,
            kind=source.kind,
            old_mm=before,
            new_mm=new,
            lower_mm=low,
            upper_mm=high if math.isfinite(high) else None,
            sensitivity_deg_per_mm=part.sensitivity,
            old_cost=price.cost,
            new_cost=price.cost * (before / new) ** price.exponent,
        )

    return lambda t: tuple(map(row, sources, prices, own.components, t.tolist()))


def _allocation(own: Stack, t: Array, result: Result, scene: Scene, lost: float) -> Allocation:
    assert result.value is not None
    budgets = tuple(
        BudgetUse(
            rule=budget.rule,
            limit_deg=lost + budget.error,
            used_deg=lost + float(used) * budget.error,
            kappa=budget.kappa if budget.rule == "mean_plus_sd" else None,
        )
        for budget, used in zip(own.budgets, own.used(t), strict=True)
        if budget.only is None
    )
    before = sum(price.cost for price in scene.prices)
    method = str(result.proof.get("method", result.method))
    return Allocation(budgets, result.value, before, method)


def by_every_rule(scene: Scene, gears: Pairs, t: Array, whose: str) -> dict[str, float]:
    """Return the error of tolerances t by every rule [deg], named after whose they are."""
    parts = tuple(
        Component(s.name, math.degrees(sensitivity(gears, s)), 1.0, distribution=s.law)
        for s in scene.sources
    )
    budgets = tuple(ErrorBudget(rule, 1.0, kappa, name) for name, rule, kappa in RULES)
    used = (start(scene, gears) + Stack(parts, budgets).used(t)).tolist()
    errors = {f"{whose}_{name}_deg": v for (name, _, _), v in zip(RULES, used, strict=True)}
    mean, three = (errors[f"{whose}_{name}_deg"] for name in ("mean", "mean_plus_3_sd"))
    return errors | {f"{whose}_sd_deg": (three - mean) / 3.0}
