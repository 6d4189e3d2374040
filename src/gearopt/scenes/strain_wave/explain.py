"""Remedies of an impossible file, and the influence of every number of a possible one."""

from collections.abc import Mapping
from dataclasses import replace

from gearopt.formulations.strain_wave.demand import GAP_UNIT
from gearopt.formulations.strain_wave.exchange import exchange
from gearopt.formulations.strain_wave.impossible import nearest
from gearopt.formulations.strain_wave.sizing import problem
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import binding
from gearopt.optimise.explaining.explanation import Explanation, Remedies
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Result
from gearopt.scenes.explaining.engine import FeasibilityQuestions, Group, singles, with_least
from gearopt.scenes.explaining.explanations import at_point, eases, of_design
from gearopt.scenes.explaining.moves import DUTY, Move
from gearopt.scenes.explaining.possible import UNKNOWN, Verdict
from gearopt.scenes.strain_wave.scene import Scene

MOVES = (Move(("duty", "torque"), -1, DUTY), Move(("duty", "outer_diameter"), 1, power=3.0))
EASES = {  # beside ends of ranges: what eases a limit
    "design.pairs": -1,
    "design.safety": -1,
    "design.ratcheting": -1,
    "material.bending_limit": 1,
    "material.shear_limit": 1,
    "duty.outer_diameter": 1,
}
LIMITS = (  # but for those that only keep the flank regular
    *("outer_radius", "interference", "ratcheting", "rim_fatigue", "pairs", "base_circle"),
    *("minor_axis", "flexspline_land", "flexspline_space", "spline_land"),
)
NO_TIME = "no time is left for sensitivities"
NOTHING = 1e-6  # MPa: a multiplier below it is rounding


def possible(scene: Scene, clock: Clock) -> Verdict:
    """Return the excess of the nearest gearing that is found, whose flanks may cut each other."""
    least = nearest(scene.demand(), scene.start(), clock)
    return UNKNOWN if least is None else Verdict(least.excess <= 0.0, least.excess)


def clear(scene: Scene, clock: Clock) -> Verdict:
    """Return whether a gearing without interference is found."""
    return Verdict(exchange(scene.demand(), scene.start(), clock).clear or None)


def remedies(scene: Scene, clock: Clock, result: Result, soon: bool) -> Remedies:
    """Limits in conflict, and torque and outer diameter moved alone until a design exists.

    result: with `nearest`, what the nearest design uses of every limit, and `reached` in words.
    """
    used = result.report.get("nearest", {})
    over = sorted((n for n, u in used.items() if u > 1.0), key=lambda n: -used[n])
    names = tuple(result.proof.get("conflict", over))
    excess = max(used.values()) - 1.0 if used else None
    asked = FeasibilityQuestions(scene, possible, clock, clear, excess=excess)
    known = with_least(singles(asked, (Group((move,)) for move in MOVES)), False)
    late = "the budget ended before all remedies were tried" if clock.over else ""
    reached = result.report.get("reached", "") if result.status == "infeasible" else ""
    return Remedies(names, known, f"{reached} {late}".strip())


def of_pressure(scene: Scene, result: Result, clock: Clock, gap: float) -> Explanation:
    """Return the influence of every number on the pressure, by multipliers and solving again."""
    optimum = exchange(scene.demand(), scene.start(), clock, gap)
    x = optimum.outcome.x
    if x is None or optimum.result.value is None:
        return Explanation(result, (), (), binding(result), (), NO_TIME, clock.seconds)

    def solved(other: Scene) -> float | None:
        again = exchange(other.demand(), other.start(), Clock(clock.left, clock.watch), gap)
        return again.result.value if again.result.status == "stationary" and again.clear else None

    def posed(other: Scene) -> Problem:
        return problem(other.demand(), x[:6], optimum.passages)

    note = costs(optimum.result.multipliers)
    basis = at_point(optimum.result.value, solved, posed, scene, x)
    ways = eases(optimum.problem) | EASES
    return replace(
        of_design(scene, result, clock, basis, solved, note, ways), seconds=clock.seconds
    )


def costs(multipliers: Mapping[str, float]) -> str:
    """Return in words the price [MPa] of each limit that decides, by multipliers.

    1 % of a limit, 1 um of overlap where teeth pass each other.
    """
    total: dict[str, float] = {}
    for name, value in multipliers.items():
        stem = name.split("[")[0]
        total[stem] = total.get(stem, 0.0) - value
    words = []
    for name in (n for n in LIMITS if total.get(n, 0.0) > NOTHING):
        step, part = (1e-3 / GAP_UNIT, "1 µm") if name == "interference" else (0.01, "1 %")
        words.append(f"{name.replace('_', ' ')} {total[name] * step:.3g} MPa for {part}")
    return (
        f"to first order, relaxing a limit lowers the contact pressure: {', '.join(words)}"
        if words
        else ""
    )
