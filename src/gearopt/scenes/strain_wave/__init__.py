"""kind = "strain_wave": a strain wave gearing (harmonic drive), given or chosen."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.strain_wave import sampled
from gearopt.formulations.strain_wave.cutter_report import CONJUGATE
from gearopt.formulations.strain_wave.demand import FREE, PRESSURE, VOLUME, Demand
from gearopt.formulations.strain_wave.design import (
    Extras,
    RoundRow,
    WaveDesign,
    cutter_design,
    deflections_and_ends,
    loads_and_pressures,
    profile_shifts,
    sizes_and_clearances,
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
from gearopt.formulations.strain_wave.hob_report import hob_design
from gearopt.formulations.strain_wave.impossible import told
from gearopt.formulations.strain_wave.sampled import SHARE
from gearopt.formulations.strain_wave.swept_report import (
    SweptGearing,
    cutter_by_law,
    deflections_by_law,
    loads_by_law,
    sizes_by_law,
    swept_gearing,
    used_by_law,
)
from gearopt.optimise.certified import point_of, run
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.explaining.explain import binding
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.pareto.objectives import Limiting, Objective, Tradeoff
from gearopt.optimise.result import FEASIBLE, Budget, Result, versions
from gearopt.optimise.terms import Array
from gearopt.optimise.typed import untyped
from gearopt.physics.strain_wave.conjugate import Flank
from gearopt.scenes.kind import Kind, Trades, examples_in
from gearopt.scenes.plan import Step
from gearopt.scenes.reading.ask import Ask, unseeded, without_method
from gearopt.scenes.strain_wave.explain import MOVES, of_pressure, possible, remedies
from gearopt.scenes.strain_wave.notes import assumptions, notes, range_notes
from gearopt.scenes.strain_wave.scene import Scene

METHODS = ("exchange",)  # its own
SAMPLERS = ("annealing", "nsga2")
NOTHING = "the gearing is given, so that nothing is chosen"
UNPROVEN = "sensitivities need a local optimum; the first-order conditions of one do not hold here"
NEAREST = "The nearest design of this size that was found reaches: {}."
INTERFERING = "Stopped before the interference was removed."
NUMBERS = "numbers"  # the part of a gearing's numbers, until they are described
TELLING_SECONDS = 0.15  # that each step of a description may take beyond a spent budget
NO_FLANK = (
    "No gearing was found whose flanks are conjugate from root to tip. "
    "Increase the deflection or the pressure angle."
)
HIDDEN = (
    "Interference: the teeth of the best design found overlap by {:.3g} µm, between the positions "
    "that this method checks. --method exchange checks all positions."
)


def steps(scene: Scene, ask: Ask) -> tuple[Step[Scene], ...]:
    """The numbers of a gearing, given or chosen; then its description, part by part.

    Each part adds fields to the design, of which `described` makes the answer's.
    """
    last: list[Step[Scene]] = [Step(described), Step(with_limits)]
    if not scene.involute:
        without_method(ask, NOTHING)
        by_law = given_law, with_law_loads, with_law_sizes, with_law_deflections, with_law_cutter
        return *(Step(step) for step in by_law), last[0], Step(with_law_limits)
    if not scene.has_free_sizes:
        without_method(ask, NOTHING)
        numbers = given
    elif ask.method in SAMPLERS:
        numbers = sampled_numbers
    elif ask.method in (None, *METHODS):
        numbers = exchanged
    else:
        names = ", ".join((*METHODS, *SAMPLERS))
        raise SolveError(f"no method {ask.method!r} for a strain wave gearing: {names}")
    parts = numbers, with_loads, with_sizes, with_deflections, with_shifts, with_cutter
    return *(Step(step) for step in parts), *last


def exchanged(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Numbers of least pressure by equal sharing, without interference at any pose."""
    clock, demand = Clock(ask.budget, ask.watch), scene.demand()
    optimum = exchange(demand, scene.start(), clock, ask.gap)
    result = replace(optimum.result, seconds=clock.seconds, evaluations=clock.evaluations)
    result = replace(result, method="exchange", seed=ask.seed)
    numbers = optimum.outcome.x
    if optimum.design is None or numbers is None:
        return _without_design(scene, optimum, result, clock)
    if result.status == "stationary":  # what Ipopt says of itself is certified
        result = replace(result, message="")
    slopes = slopes_of(optimum.problem, numbers) if result.status == "stationary" else {}
    if not optimum.clear:
        message = f"{INTERFERING} {result.message}".strip()
        result = replace(result, status="limit", message=message)
    return _begun(
        result,
        rounds=_rounds(optimum),
        range_ends=ends_of(demand.ranges, numbers[: len(FREE)], slopes),
    )


def _begun(result: Result, **design: Any) -> Result:
    """A result with fields of its design, whose numbers are a part until they are described."""
    numbers = replace(result, name=NUMBERS)
    return replace(result, parts=(numbers,), design={"left_out": (), **design})


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


def _rounds(found: Exchanged) -> tuple[RoundRow, ...]:
    return tuple(
        RoundRow(
            cuts=r.cuts,
            pressure_MPa=r.pressure,
            least_clearance_mm=r.gap,
            iterations=r.iterations,
        )
        for r in found.rounds
    )


def sampled_numbers(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Numbers by annealing or NSGA-II, which look at some poses; the answer is judged at all."""
    demand = scene.demand()
    problem = sampled.problem(demand, scene.start())
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, ask.watch, ask.gap)
    if outcome.x is None:
        return result
    numbers = outcome.x[: len(FREE)]
    if result.value is None:
        least = sampled.least_clearance(demand, numbers)
        return replace(result, message=HIDDEN.format(-1e3 * least)) if least < CUTTING else result
    return _begun(replace(result, message=""), range_ends=ends_of(demand.ranges, numbers, {}))


def given(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Numbers of a gearing that is given."""
    numbers = dict(zip(FREE, scene.start(), strict=True))
    return _begun(replace(_evaluated(ask), design=numbers))


def given_law(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """A gearing that is given by the law of its teeth."""
    return replace(_evaluated(ask), design={"left_out": ()})


def _evaluated(ask: Ask) -> Result:
    return Result(
        name="strain wave gearing",
        status="evaluated",
        method="closed form",
        objective={},
        certificate={"feasibility": 0.0},
        evaluations=1,
        seed=ask.seed,
        versions=versions("numpy"),
    )


def _flank(demand: Demand, known: Result | None) -> Flank:
    """Gearing and flank of the numbers of a result."""
    assert known is not None
    return design_of(demand, point_of(known.parts[0].design)[: len(FREE)])


def _with(known: Result | None, fields: Mapping[str, Any], left_out: Sequence[str] = ()) -> Result:
    """A result with fields of its design more; left_out: of those that time was short for."""
    assert known is not None
    left = *known.design["left_out"], *left_out
    return replace(known, design={**known.design, **fields, "left_out": left})


def _swept(scene: Scene) -> SweptGearing:
    gearing = scene.gearing()
    return swept_gearing(gearing, scene.law())


def with_loads(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing with the loads of its teeth."""
    demand = scene.demand()
    flank = _flank(demand, known)
    return _with(known, loads_and_pressures(demand, flank))


def with_sizes(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing with its sizes and clearances."""
    demand, extras = scene.demand(), _extras(ask)
    flank = _flank(demand, known)
    return _with(known, sizes_and_clearances(demand, flank, extras), extras.left_out)


def with_deflections(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing with ends of its numbers and other deflections, while there is time."""
    flank, extras = _flank(scene.demand(), known), _extras(ask)
    fields = deflections_and_ends(flank, extras)
    return _with(known, fields, extras.left_out)


def with_shifts(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing with other profile shifts, while there is time."""
    demand, extras = scene.demand(), _extras(ask)
    flank = _flank(demand, known)
    fields = profile_shifts(demand.duty, flank, extras)
    return _with(known, fields, extras.left_out)


def with_cutter(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing with the cutter that the file asks for."""
    tool, extras = scene.tool(), _extras(ask)
    if tool is None:
        return _with(known, {})
    demand = scene.demand()
    flank = _flank(demand, known)
    if tool.generation == CONJUGATE:
        return _with(known, {"cutter": cutter_design(flank, tool, extras)}, extras.left_out)
    return _with(known, {"cutter": hob_design(demand.duty, flank, tool)})


def with_law_loads(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing of a law with the loads of its teeth."""
    swept = _swept(scene)
    return _with(known, loads_by_law(scene.demand(), swept))


def with_law_sizes(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing of a law with its sizes and clearances."""
    swept = _swept(scene)
    return _with(known, sizes_by_law(scene.demand(), swept, scene.law()))


def with_law_deflections(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing of a law with other deflections, while there is time."""
    extras = _extras(ask)
    return _with(known, deflections_by_law(_swept(scene), extras), extras.left_out)


def with_law_cutter(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing of a law with the cutter that the file asks for."""
    tool = scene.tool()
    return _with(known, {} if tool is None else {"cutter": cutter_by_law(_swept(scene), tool)})


def _extras(ask: Ask) -> Extras:
    """Parts that a description may do without, and the time for them."""
    left = ask.budget.seconds
    return Extras(Clock(Budget(None if left is None else max(left, TELLING_SECONDS))))


def described(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing with its whole design, and all that is told of it."""
    assert known is not None
    design = WaveDesign(**known.design)
    report: dict[str, Any] = {
        "assumptions": assumptions(scene),
        "notes": [*notes(design), *range_notes(scene, design.range_ends)],
    }
    drawing = scene.cutter
    if drawing is not None:
        grid = drawing.grid.value if drawing.grid else 0.05
        report["cutter_drawing"] = {
            "scale": None if drawing.scale is None else float(drawing.scale),
            "grid_mm": grid,
        }
    return replace(
        known,
        name="strain wave gearing",
        objective=known.objective | ({"unit": "MPa"} if known.objective else {}),
        design=untyped(design),
        multipliers={k: v for k, v in known.multipliers.items() if "[" not in k},
        report=known.report | report,
    )


def with_limits(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing with what it uses of every limit."""
    assert known is not None
    demand = scene.demand()
    flank = _flank(demand, known)
    limits = _interference_used(known) | used(demand, flank)
    forms = (known.design.get("cutter") or {}).get("forms") or ()
    if forms and forms[-1]["least_clearance_mm"] >= CUTTING:  # the teeth that are cut are judged
        limits = {k: v for k, v in limits.items() if k != "interference" or v <= 1.0}
    return _limited(replace(known, parts=()), limits)


def with_law_limits(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The gearing of a law with what it uses of every limit."""
    assert known is not None
    return _limited(known, used_by_law(scene.demand(), _swept(scene)))


def _limited(known: Result, limits: dict[str, float]) -> Result:
    """A result that is judged by its limits, where it is given or its teeth interfere."""
    excess, certificate, message = max(limits.values()) - 1.0, known.certificate, known.message
    if known.status == "evaluated":
        certificate = {"feasibility": max(0.0, excess)}
        over = [name for name, value in limits.items() if value > 1.0 + FEASIBLE]
        message = f"limits exceeded: {', '.join(over).replace('_', ' ')}" if over else ""
    elif message.startswith(INTERFERING):
        certificate = {**certificate, "feasibility": excess}
    return replace(known, limits=limits, certificate=certificate, message=message)


def _interference_used(result: Result) -> dict[str, float]:
    """Return the largest utilisation of the poses that an optimisation held clear."""
    utilisations = [v for name, v in result.limits.items() if name.startswith("interference")]
    return {"interference": max(utilisations)} if utilisations else {}


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    unused = {"top": "no next best answers are listed"}
    return unused | ({} if method in SAMPLERS else unseeded(method))


def influences(scene: Scene, ask: Ask, result: Result) -> Explanation:
    """Influence of every number on the pressure of a design that was chosen."""
    if scene.has_free_sizes and result.status == "stationary":
        clock = Clock(ask.budget, of_others(ask.watch))
        return of_pressure(scene, result, clock, ask.gap)
    message = UNPROVEN if scene.has_free_sizes else NOTHING
    return Explanation(result, (), (), binding(result), (), message, result.seconds)


def methods_to_compare(scene: Scene) -> tuple[str, ...]:
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
    return Model(
        problem,
        "Without interference, sought over the whole revolution of the wave generator",
        "MPa",
    )


def objectives(scene: Scene) -> dict[str, str]:
    """Return the objectives that a front may have: name and unit."""
    _to_choose(scene)
    return dict(sampled.OBJECTIVES)


def traded(scene: Scene, names: Sequence[str], ask: Ask) -> Tradeoff:
    """Return the problem of a front: the first objective under limits on the other, or sampled.

    The former is clear at all poses. load_share counts teeth, so that it is for the latter.
    """
    demand, start = scene.demand(), scene.start()
    listed = tuple(Objective(name, sampled.OBJECTIVES[name]) for name in names)

    def drawn(x: Array) -> dict[str, Any]:
        return sketched(demand, design_of(demand, x[: len(FREE)]))

    if ask.method in SAMPLERS:
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
    steps=steps,
    posed=posed,
    methods_to_compare=methods_to_compare,
    methods=METHODS,
    possible=possible,
    moves=lambda scene: MOVES,
    remedies=remedies,
    influences=influences,
    assumptions=assumptions,
    trades=Trades(objectives, traded),
    idle=idle,
)
