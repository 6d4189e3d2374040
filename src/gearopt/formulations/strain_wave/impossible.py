"""The conflict of an impossible request: limits that no gearing in the ranges meets."""

from collections.abc import Callable, Mapping
from typing import Any

from gearopt.formulations.strain_wave.demand import FREE, LAND, TIP_GAP, Demand
from gearopt.formulations.strain_wave.sizing import problem, tip_leaves
from gearopt.frozen import dataclass
from gearopt.optimise.certified import limits, run
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE
from gearopt.optimise.terms import Array, Terms, Var

GUARDS = ("curvature", "cusp")  # keep the flank regular: there is no gearing without them
STRENGTH = ("pairs", "rim_fatigue", "ratcheting")  # a size may fall short of them
EXCESSES = (-0.99, 1e6)  # of utilisations over 1: ends of the search


@dataclass(frozen=True)
class Nearest:
    """The design whose largest excess over all limits is smallest, found locally.

    excess: of the utilisations over 1, negative where all limits are met with room. numbers (6,) of
    FREE; used: utilisations by limit, the largest of several points.
    """

    excess: float
    numbers: Array
    used: Mapping[str, float]


def nearest(demand: Demand, start: Any, clock: Clock) -> Nearest | None:
    """Return the design of the smallest largest excess of limits on strength, the others met.

    Of all limits where these others cannot be met. None where no gearing has a flank, or in time.
    """
    for eased in (STRENGTH, None):
        posed = _eased(problem(demand, start, tip_leaves(demand, start)), eased)
        result, outcome = run(posed, "ipopt", clock.left, watch=clock.inner(values=False))
        if result.value is not None and outcome.x is not None:
            break
    else:
        return None
    used: dict[str, float] = {}
    for name, value in limits(posed, outcome.x).items():
        stem = name.split("[")[0]
        over = value + (result.value if eased is None or stem in eased else 0.0)
        if stem not in GUARDS:
            used[stem] = max(over, used.get(stem, over))
    return Nearest(result.value, outcome.x[: len(FREE)], used)


def _eased(posed: Problem, eased: tuple[str, ...] | None) -> Problem:
    """Return the problem of the smallest excess of limits; None: of all but GUARDS."""

    def evaluate(x: Any, p: Any) -> Terms:
        terms = posed.evaluate(x, p)
        rows: dict[str, Any] = {}
        for name, value in terms.limits.items():
            moves = name not in GUARDS if eased is None else name in eased
            each = value if isinstance(value, tuple) else (value,)
            rows[name] = tuple(v - x.excess for v in each) if moves else value
        return Terms({"excess": x.excess}, rows, terms.defines, terms.equal)

    excess = Var("excess", "", *EXCESSES, 1.0, search=True)
    return Problem(f"{posed.name}, eased", (*posed.variables, excess), (), evaluate)


def told(demand: Demand, found: Nearest) -> list[str]:
    """Limit and value of everything that is exceeded, with units."""
    gearing = demand.gearing(dict(zip(FREE, map(float, found.numbers), strict=True)))
    module, torque = float(gearing.module), 1e-3 * demand.ratchet_factor * demand.duty.torque

    def short(used: float, least: float, unit: str) -> str:
        return f"{least + (1.0 - used) * module:.3g} {unit} of {least:.3g} {unit}"

    words: dict[str, Callable[[float], str]] = {
        "pairs": lambda u: f"{demand.pairs / u:.3g} conjugate pairs of {demand.pairs:g}",
        "rim_fatigue": lambda u: f"a safety of {demand.safety / u:.3g} of {demand.safety:g}",
        "ratcheting": lambda u: f"at {torque / u:.4g} N m of {torque:.4g} N m",
        "outer_radius": lambda u: (
            f"{u * demand.outer_radius:.4g} mm, {demand.outer_radius:.4g} mm at most"
        ),
        "minor_axis": lambda u: (
            f"{(TIP_GAP + 2.0 * gearing.addendum) / u - 2.0 * gearing.addendum:.3g} modules "
            f"between tips of {TIP_GAP:g}"
        ),
        "base_circle": lambda u: f"{100.0 * (u - 1.0):.3g} % too small a tip circle",
        "interference": lambda u: f"teeth cut by {100.0 * (u - 1.0):.3g} µm",
    }
    lands = ("flexspline_land", "flexspline_space", "spline_land")
    words |= {name: lambda u: short(u, LAND * module, "mm") for name in lands}
    over = {n: u for n, u in found.used.items() if u > 1.0 + FEASIBLE}
    order = sorted(over, key=lambda n: -over[n])
    return [f"{n.replace('_', ' ')}: {words[n](over[n])}" for n in order]
