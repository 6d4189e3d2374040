"""kind = "strain_wave": a strain wave gearing (harmonic drive), given or chosen."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.strain_wave import sampled
from gearopt.formulations.strain_wave.demand import FREE, PRESSURE, VOLUME
from gearopt.formulations.strain_wave.design import (
    RoundRow,
    WaveDesign,
    described,
    sketched,
    used,
)
from gearopt.formulations.strain_wave.exchange import (
    CUTTING,
    Exchanged,
    design_of,
    ends_of,
    exchange,
    slopes_of,
)
from gearopt.formulations.strain_wave.impossible import told
from gearopt.formulations.strain_wave.sampled import SHARE
from gearopt.formulations.strain_wave.swept_report import (
    described_by_law,
    swept_gearing,
    used_by_law,
)
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.comparing.runs import Model
from gearopt.optimise.explaining.explain import binding
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.pareto.epsilon import Limiting
from gearopt.optimise.pareto.front import Objective
from gearopt.optimise.pareto.tradeoff import Tradeoff
from gearopt.optimise.result import FEASIBLE, Budget, Result, versions
from gearopt.optimise.terms import Array
from gearopt.optimise.typed import untyped
from gearopt.physics.strain_wave.conjugate import Flank
from gearopt.scenes.kind import Kind, Trades, examples_in
from gearopt.scenes.plan import one_step
from gearopt.scenes.reading.ask import Ask, unseeded, without_method
from gearopt.scenes.strain_wave.explain import MOVES, of_pressure, possible, remedies
from gearopt.scenes.strain_wave.notes import assumptions, notes, range_notes
from gearopt.scenes.strain_wave.scene import Scene

METHODS = ("exchange",)  # its own
SAMPLERS = ("annealing", "nsga2")
NOTHING = "the gearing is given, so that nothing is chosen"
UNPROVEN = "sensitivities need a design that is certified as locally optimal, and this one is not"
NEAREST = "The nearest design of this size that was found reaches: {}."
TELLING_SECONDS = 0.5  # that a description may take beyond a budget that is spent
NO_FLANK = (
    "No gearing was found whose flanks are conjugate from root to tip. "
    "Increase the deflection or the pressure angle."
)
NO_SLOPES: Mapping[str, float] = MappingProxyType({})
HIDDEN = (
    "Interference: the teeth of the best design found overlap by {:.3g} µm, between the positions "
    "that this method checks. --method exchange checks all positions."
)


def gearing(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Choose what the file leaves open, without interference; describe the gearing."""
    if not scene.has_free_sizes:
        return _evaluated(scene, ask)
    if ask.method in SAMPLERS:
        return _sampled(scene, ask)
    if ask.method not in (None, *METHODS):
        names = ", ".join((*METHODS, *SAMPLERS))
        raise SolveError(f"no method {ask.method!r} for a strain wave gearing: {names}")
    clock = Clock(ask.budget, ask.watch)
    found = exchange(scene.demand(), scene.start(), clock, ask.gap)
    result = replace(found.result, seconds=clock.seconds, evaluations=clock.evaluations)
    result = replace(result, method="exchange", seed=ask.seed)
    numbers = found.outcome.x
    if found.design is None or numbers is None:
        return _without_design(scene, found, result, clock)
    if result.status == "stationary":  # what Ipopt says of itself is certified
        result = replace(result, message="")
    slopes = slopes_of(found.problem, numbers) if result.status == "stationary" else {}
    shown = _with(scene, result, found.design, numbers, clock, slopes, _rounds(found))
    if found.clear:
        return shown
    message = f"Stopped before the interference was removed. {shown.message}".strip()
    excess = max(shown.limits.values()) - 1.0
    certificate = {**shown.certificate, "feasibility": excess}
    return replace(shown, status="limit", certificate=certificate, message=message)


def _without_design(scene: Scene, found: Exchanged, result: Result, clock: Clock) -> Result:
    """Why nothing was found: what is asked, and how near the nearest design comes to it."""
    if found.nearest is None:
        flankless = result.status == "failed" and not clock.over
        return replace(result, message=NO_FLANK) if flankless else result
    reached = NEAREST.format("; ".join(told(scene.demand(), found.nearest)))
    if result.status != "infeasible":  # else the message is the proof
        result = replace(result, message=reached)
    report = {"nearest": dict(found.nearest.used), "reached": reached}
    return replace(result, report=report, seconds=clock.seconds)


def _rounds(found: Exchanged) -> list[RoundRow]:
    return [
        RoundRow(
            cuts=r.cuts,
            pressure_MPa=r.pressure,
            least_clearance_mm=r.gap,
            iterations=r.iterations,
        )
        for r in found.rounds
    ]


def _sampled(scene: Scene, ask: Ask) -> Result:
    """Choose by annealing or NSGA-II, which look at some poses; the answer is judged at all."""
    clock = Clock(ask.budget, ask.watch)
    problem = sampled.problem(scene.demand(), scene.start())
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, ask.watch, ask.gap)
    if outcome.x is None:
        return result
    least = sampled.least_clearance(scene.demand(), outcome.x[: len(FREE)])
    if result.value is None:
        return replace(result, message=HIDDEN.format(-1e3 * least)) if least < CUTTING else result
    made = design_of(scene.demand(), outcome.x[: len(FREE)])
    return _with(scene, replace(result, message=""), made, outcome.x, clock)


def _evaluated(scene: Scene, ask: Ask) -> Result:
    """Return what is to be known of a gearing that is given."""
    without_method(ask, NOTHING)
    clock = Clock(ask.budget, ask.watch)
    design, limits = _given(scene, clock)
    excess = max(0.0, max(limits.values()) - 1.0)
    over = [name for name, value in limits.items() if value > 1.0 + FEASIBLE]
    found = Result(
        name="strain wave gearing",
        status="evaluated",
        method="closed form",
        objective={},
        certificate={"feasibility": excess},
        message=f"{', '.join(over)}: limits are exceeded" if over else "",
        evaluations=1,
        seed=ask.seed,
        versions=versions("numpy"),
    )
    return replace(_shown(scene, found, design, limits), seconds=clock.seconds)


def _given(scene: Scene, clock: Clock) -> tuple[WaveDesign, dict[str, float]]:
    """Return the design of a gearing that is given, and what it uses of every limit."""
    demand = scene.demand()
    if not scene.involute:
        swept = swept_gearing(scene.gearing(), scene.law())
        design = described_by_law(demand, swept, scene.law(), scene.tool(), _spare(clock))
        return design, used_by_law(demand, swept)
    made = design_of(demand, scene.start())
    return described(demand, made, scene.tool(), _spare(clock)), used(demand, made)


def _spare(clock: Clock) -> Clock:
    """Return the time for what a description may do without."""
    left = clock.left.seconds
    return Clock(Budget(None if left is None else max(left, TELLING_SECONDS)))


def _with(
    scene: Scene,
    result: Result,
    made: Flank,
    numbers: Array,
    clock: Clock,
    slopes: Mapping[str, float] = NO_SLOPES,
    rounds: Sequence[RoundRow] = (),
) -> Result:
    """Return a result with the design that was chosen and what it uses of every limit."""
    demand = scene.demand()
    ends = ends_of(demand.ranges, numbers[: len(FREE)], slopes)
    design = described(demand, made, scene.tool(), _spare(clock), rounds)
    design = replace(design, range_ends=ends)
    return _shown(scene, result, design, _interference_used(result) | used(demand, made))


def _shown(scene: Scene, result: Result, design: WaveDesign, limits: dict[str, float]) -> Result:
    """Return a result with a design and all that is told of it."""
    told: dict[str, Any] = {
        "assumptions": assumptions(scene),
        "notes": [*notes(design), *range_notes(scene, design.range_ends)],
    }
    drawing = scene.cutter
    if drawing is not None:
        grid = drawing.grid.value if drawing.grid else 0.05
        told["cutter_drawing"] = {
            "scale": None if drawing.scale is None else float(drawing.scale),
            "grid_mm": grid,
        }
    return replace(
        result,
        name="strain wave gearing",
        objective=result.objective | ({"unit": "MPa"} if result.objective else {}),
        design=untyped(design),
        limits=limits,
        multipliers={k: v for k, v in result.multipliers.items() if "[" not in k},
        report=result.report | told,
    )


def _interference_used(result: Result) -> dict[str, float]:
    """Return the largest utilisation of the poses that an optimisation held clear."""
    own = [v for name, v in result.limits.items() if name.startswith("interference")]
    return {"interference": max(own)} if own else {}


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    found = {"top": "no next best answers are listed"}
    return found | ({} if method in SAMPLERS else unseeded(method))


def influences(scene: Scene, ask: Ask, result: Result) -> Explanation:
    """What every number does to the pressure of a design that was chosen."""
    if scene.has_free_sizes and result.status == "stationary":
        clock = Clock(ask.budget, of_others(ask.watch))
        return of_pressure(scene, result, clock, ask.gap)
    message = UNPROVEN if scene.has_free_sizes else NOTHING
    return Explanation(result, (), (), binding(result), (), message, result.seconds)


def compared(scene: Scene) -> tuple[str, ...]:
    """Return the methods of a comparison that names none."""
    _to_choose(scene)
    return (*METHODS, *SAMPLERS)


def posed(scene: Scene, method: str) -> Model:
    """Return the problem of a method, whose answers are judged at all poses."""
    _to_choose(scene)
    demand, start = scene.demand(), scene.start()
    problem = sampled.problem(demand, start)
    if method not in SAMPLERS:
        problem = sampled.limited(demand, start, PRESSURE, {})
    return Model(problem, "No interference at any position of the wave", "MPa")


def objectives(scene: Scene) -> dict[str, str]:
    """Return what a front may minimise: name and unit."""
    _to_choose(scene)
    return dict(sampled.OBJECTIVES)


def traded(scene: Scene, names: Sequence[str], method: str | None) -> Tradeoff:
    """Return the problem of a front: the first objective under limits on the other, or sampled.

    The former is clear at all poses. load_share counts teeth, so that it is for the latter.
    """
    demand, start = scene.demand(), scene.start()
    listed = tuple(Objective(name, sampled.OBJECTIVES[name]) for name in names)

    def drawn(x: Array) -> dict[str, Any]:
        return sketched(demand, design_of(demand, x[: len(FREE)]))

    if method in SAMPLERS:
        return Tradeoff(sampled.problem(demand, start, names), listed, drawn)
    if SHARE in names:
        raise SolveError(
            f"{SHARE} counts teeth and has no gradient: add --method {' or '.join(SAMPLERS)}; "
            f"{VOLUME},{PRESSURE} need no such method"
        )
    limiting = Limiting(partial(sampled.limited, demand, start), tuple(names[1:]))
    whole = sampled.problem(demand, start, names, sampled.WHOLE)
    return Tradeoff(whole, listed, drawn, limiting)


def _to_choose(scene: Scene) -> None:
    if not scene.has_free_sizes:
        raise SolveError(f"{NOTHING}: gearopt solve FILE describes it")


ABOUT = {  # files in examples, that of the kind first
    "strain_wave": "a strain wave gearing (harmonic drive), given or chosen",
    "strain-wave-from-duty": "a strain wave gearing from its duty alone",
}
KIND = Kind(
    scene=Scene,
    examples=examples_in(__file__, ABOUT),
    steps=one_step(gearing),
    posed=posed,
    compared=compared,
    methods=METHODS,
    possible=possible,
    moves=lambda scene: MOVES,
    remedies=remedies,
    influences=influences,
    assumptions=assumptions,
    trades=Trades(objectives, traded),
    idle=idle,
)
