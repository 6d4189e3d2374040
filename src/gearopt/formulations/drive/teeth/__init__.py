"""Exact sizing: whole tooth numbers and standard modules, by branch and bound.

The same objective and limits as `continuous_sizing`, with z1, z2 whole, modules from a series and
face widths tied, free or on a step. `exact` proves its answer by exhausting all other trains.
"""

import math
from collections.abc import Iterable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations.drive import sizing_text
from gearopt.formulations.drive.planetary import Planets, no_room, no_teeth
from gearopt.formulations.drive.teeth.choices import best_choices
from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.front import fronts
from gearopt.formulations.drive.teeth.progress import MARGIN, TIE, Progress, Teeth
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.reach import largest_ratio, narrowed, trimmed
from gearopt.formulations.drive.teeth.search import BEAM, search
from gearopt.formulations.drive.teeth.stage import Table
from gearopt.formulations.drive.teeth.tables import table
from gearopt.formulations.drive.train import Stage, Train
from gearopt.optimise.clock import Clock
from gearopt.optimise.pareto.posed import caps
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import INTERRUPTED, Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms, Var, each, namespace
from gearopt.physics.gears import GearPair, reference_diameter

VARIABLES = {
    "module": "mm",
    "pinion_teeth": "",
    "wheel_teeth": "",
    "face_width": "mm",
    "width_steps": "",
    "option": "",
    "toothing": "",
}
NO_TRAIN = (
    "Proof: every choice of teeth and modules was compared or excluded; none meets all limits."
)
RATED = (
    "whole teeth that ratings limit are for exact, annealing and nsga2 only: a rating finds roots "
    "by iteration and has ranges, and is not a posynomial"
)
UNLIMITED = 1e18  # teeth, steps or mm: no limit

RANDOM = False
COUNTS = "tooth pair sized, to the end of a partial design"
SETTINGS = {"partial designs extended at once": BEAM, "relative margin of exclusion": MARGIN}


def problem(train: Train, count: int = 1, floor: float = -math.inf) -> Problem:
    """Return the discrete problem of a drive; `exact` proves its `count` best trains in order.

    floor: a lower bound on the objective known from elsewhere (`continuous_sizing`), with which
    `exact` may stop early where its budget allows a gap.

    Trains are distinct when a tooth number differs; each has its best modules and face widths.
    Variables, one component per stage: module [mm], pinion_teeth, wheel_teeth, and face_width [mm]
    or width_steps where the width is not tied to d1; option, from 1, where a stage has several; one
    for all stages where they take the same; toothing, from 1, where a stage has several.
    Numbers are constants of the text; those with a key in `train.keys` are parameters of the
    relaxed problem. Of a drive with several objectives `exact` proves the whole front (`front`).
    """
    numbers = SimpleNamespace(**train.numbers())

    def evaluate(x: Any, p: Any) -> Terms:
        if train.rated and not _is_plain(each(x.module)[0]):
            raise SolveError(RATED)
        terms = sizing_text.terms(train, numbers, pairs_of(train, x), _options(train, x))
        # A module is one of a set: the ends of the set are no limits of their own here.
        limits = {n: v for n, v in terms.limits.items() if not n.startswith("module_")}
        if not train.coprime:
            return Terms(terms.minimise, limits, equal=terms.equal)
        teeth = zip(each(x.pinion_teeth), each(x.wheel_teeth), strict=True)
        if not _is_plain(each(x.pinion_teeth)[0]):
            raise SolveError("hunting teeth (coprime) are for exact, annealing and nsga2 only")
        divisors = {
            f"common_divisor[{k}]": np.gcd(np.rint(a).astype(int), np.rint(b).astype(int))
            for k, (a, b) in enumerate(teeth, 1)
        }
        return Terms(terms.minimise, {**limits, **divisors}, equal=terms.equal)

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Branch and bound over the teeth; the seed changes nothing."""
        if train.others:
            return _front(train, problem, budget, watch)
        return _outcome(train, count, floor, budget, watch)

    return Problem(
        "teeth",
        _variables(train),
        (),
        evaluate,
        methods={"exact": exact},
        vectorised=True,
        relaxed=None if train.rated or train.others else sizing_text.relaxed(train),
    )


def pairs(train: Train, x: Array) -> tuple[GearPair, ...]:
    """Gear pairs of a point of `problem`."""
    return gears(train, x)[0]


def gears(train: Train, x: Array) -> tuple[tuple[GearPair, ...], tuple[int, ...]]:
    """Gear pairs of a point of `problem`, and the option of every stage, counted from 0."""
    variables = _variables(train)
    named = namespace(variables, [float(v) for v in x])
    options = tuple(round(option) for option in _options(train, named))
    return pairs_of(train, named), options or (0,) * len(train.stages)


def _options(train: Train, x: Any) -> list[Any]:
    if not train.several_options:
        return []
    found = [option - 1.0 for option in each(x.option)]
    return found * len(train.stages) if train.same_option else found


def _is_plain(value: Any) -> bool:
    """Return whether a value is a number or an array, not the scalar of a tracer."""
    return isinstance(value, float | np.ndarray | np.generic)


def pairs_of(train: Train, x: Any) -> tuple[GearPair, ...]:
    """Gear pairs of the variables of `problem` by name."""
    columns = zip(each(x.module), each(x.pinion_teeth), each(x.wheel_teeth), strict=True)
    rows = _toothings(train, x)
    return tuple(
        train.pair(k, m, z1, z2, _width(train, k, x, m, z1, rows[k]), rows[k])
        for k, (m, z1, z2) in enumerate(columns)
    )


def _toothings(train: Train, x: Any) -> list[Any]:
    """Which of its toothings every stage has, from 0."""
    if not train.several_toothings:
        return [0] * len(train.stages)
    return [np.rint(toothing).astype(int) - 1 for toothing in each(x.toothing)]


def _width(train: Train, k: int, x: Any, module: Any, z1: Any, toothing: Any) -> Any:
    stage = train.stages[k]
    face = stage.face_width
    if face.step is not None:
        return each(x.width_steps)[k] * float(face.step)
    if face.tied:
        return float(face.low) * reference_diameter(
            module, z1, stage.toothing_of(toothing).helix_angle
        )
    return each(x.face_width)[k]


def _variables(train: Train) -> tuple[Var, ...]:
    stages = train.stages
    series = tuple(sorted({float(m) for s in stages for m in s.modules}))
    ranges: dict[str, list[tuple[float, float]]] = {name: [] for name in VARIABLES}
    for stage in stages:
        face = stage.face_width
        ranges["module"].append((float(stage.modules[0]), float(stage.modules[-1])))
        ranges["pinion_teeth"].append(_ends(stage.pinion_teeth))
        minimum, maximum = _ends(stage.wheel_teeth)
        reach = math.floor(train.highest_ratio * ranges["pinion_teeth"][-1][1])
        ranges["wheel_teeth"].append((minimum, max(minimum, min(maximum, float(reach)))))
        given = float(face.fixed or 1)
        free = not face.tied and face.step is None and face.fixed is None
        ranges["face_width"].append(_widths(stage) if free else (given, given))
        ranges["width_steps"].append((1.0, UNLIMITED if face.step else 1.0))
        ranges["option"].append((1.0, float(max(1, len(stage.options)))))
        ranges["toothing"].append((1.0, float(len(stage.toothings))))
    if all(s.face_width.tied or s.face_width.step for s in stages):
        del ranges["face_width"]
    if not any(s.face_width.step for s in stages):
        del ranges["width_steps"]
    if not train.several_options:
        del ranges["option"]
    elif train.same_option:
        ranges["option"] = ranges["option"][:1]
    if not train.several_toothings:
        del ranges["toothing"]
    kinds: dict[str, dict[str, Any]] = {"module": {"values": series}, "face_width": {}}
    return tuple(
        Var(
            name,
            VARIABLES[name],
            tuple(low for low, _ in ends),
            tuple(high for _, high in ends),
            tuple(low for low, _ in ends),
            len(ends),
            **kinds.get(name, {"integer": True}),
        )
        for name, ends in ranges.items()
    )


def _widths(stage: Stage) -> tuple[float, float]:
    """Return a range of every free face width [mm], by the diameters of its teeth and modules."""
    ends = zip((stage.modules[0], stage.modules[-1]), _ends(stage.pinion_teeth), strict=True)
    angles = sorted((t.helix_angle for t in stage.toothings), key=abs)
    rows = zip(ends, (angles[0], angles[-1]), strict=True)
    minimum, maximum = (reference_diameter(float(m), z, angle) for (m, z), angle in rows)
    face = stage.face_width
    low = float(face.low) or 1e-6 * face.widest  # thinner than paper
    return 0.999 * low * minimum, 1.001 * max(face.widest * maximum, float(face.least))


def _ends(span: tuple[int, int | None]) -> tuple[float, float]:
    return float(span[0]), UNLIMITED if span[1] is None else float(span[1])


def _outcome(
    train: Train, count: int, floor: float, budget: Budget, watch: Watch | None
) -> Outcome:
    shelf = list[RatedTable]()
    train, progress, missing = _searched(train, count, floor, budget, watch, shelf)
    found = _in_order(progress)
    if count > 1 and found and not (progress.clock.stopped or progress.enough):
        more = search(train, count, progress.clock.left, watch, floor, shelf=shelf)
        found = (found[:1] + [t for t in _in_order(more) if t != found[0]])[:count]
        progress.compared += more.compared
        progress.clock.evaluations += more.clock.evaluations
        progress.nodes += more.nodes
        if more.clock.stopped:
            found = found[:1]
    points = [point(train, *best_choices(train, teeth)) for teeth in found]
    proof = {
        "method": "exhausted",
        "arithmetic": "ratios, teeth, diameters and width steps rational; loads and volumes double",
        "trains_compared": progress.compared,
        "nodes": progress.nodes,
        "pruning_margin": MARGIN,
    }
    compared = f"Proof: {_counted(progress.compared, 'train')} compared,"
    opened = f"(partial designs examined: {progress.nodes:,})."
    if progress.clock.stopped or progress.enough:
        lower = progress.bound if math.isfinite(progress.bound) else None
        words = f"{compared} those not examined are bounded from below {opened}"
        partial = {**proof, "method": "branch and bound, stopped early", "sentence": words}
        if progress.quick > progress.proven:
            partial["checked"] = "in wide cells of sizes, on random designs"
            partial["sentence"] = words.replace("Proof: ", "The bound, checked: ", 1)
        return Outcome(
            points[0] if points else None,
            finished=progress.enough,
            bound=lower,
            proof=partial,
            evaluations=progress.clock.evaluations,
            message=missing or _why(progress, count),
        )
    if not points:
        return Outcome(
            None,
            infeasible=True,
            proof=proof | {"sentence": NO_TRAIN},
            evaluations=progress.clock.evaluations,
            message=_unfit(train),
        )
    return Outcome(
        points[0],
        bound=progress.found[0][0],
        proof=proof | {"sentence": f"{compared} all others excluded by lower bounds {opened}"},
        others=tuple(points[1:]),
        evaluations=progress.clock.evaluations,
    )


def _front(train: Train, problem: Problem, budget: Budget, watch: Watch | None) -> Outcome:
    """Return all trains that none beats in the objectives of a problem, within its limits."""
    names, most = problem.rows.objectives, caps(problem)
    asked = replace(train, objective=names[0], others=names[1:])
    limits = np.array([most.get(name, math.inf) for name in names])
    run = fronts(asked, limits, Clock(budget, watch))
    chosen = run.trains
    opened = f"{_counted(run.compared, 'train')} compared, "
    opened += f"{_counted(run.opened, 'partial design')} examined"
    finished = not run.clock.stopped
    words = (
        f"Proof: these are all Pareto-optimal designs; {opened}, all others excluded by "
        "lower bounds of every objective and of weighted sums."
        if finished
        else f"Stopped before the search was complete{f': {opened}' if run.opened else ''}."
    )
    method = "exhausted" if finished else "branch and bound, stopped early"
    points = [point(train, *made) for made in chosen]
    return Outcome(
        points[0] if points else None,
        finished,
        infeasible=finished and not points,
        proof={"method": method, "sentence": words if points or not finished else NO_TRAIN},
        others=tuple(points[1:]),
        evaluations=run.clock.evaluations,
        message="" if finished else INTERRUPTED if run.clock.refused else "allow more time",
    )


def _counted(count: int, noun: str) -> str:
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def _searched(
    train: Train,
    count: int,
    floor: float,
    budget: Budget,
    watch: Watch | None,
    shelf: list[RatedTable],
) -> tuple[Train, Progress, str]:
    """Search for the best train; return the drive that holds all of use and the search's reach.

    shelf: as of `search`.

    Wide ranges are searched among few pinions first, which leaves out pinions of no use. If there
    still are more pairs than memory takes, the search among few pinions is all there is.
    """
    first, few = Progress(count, Clock(budget, watch), floor), narrowed(train)
    if few == train:
        try:
            return train, search(train, 1, budget, watch, floor, shelf=shelf), ""
        except SolveError as reason:
            first.clock.stopped = True
            return train, first, str(reason)
    try:
        first = search(few, count, budget, watch, floor, whole=False, shelf=shelf)
        if first.clock.stopped or first.enough:
            return train, first, ""
        useful = trimmed(train, first.threshold)
        progress = search(useful, 1, first.clock.left, watch, floor, shelf=shelf)
    except SolveError as reason:
        first.clock.stopped = True
        maximum = max(_ends(s.pinion_teeth)[1] for s in few.stages)
        return train, first, f"{reason}. Only pinions of up to {maximum:.0f} teeth were searched"
    progress.clock.start, progress.clock.budget = first.clock.start, budget
    progress.clock.evaluations += first.clock.evaluations
    progress.nodes += first.nodes
    # What the first search found is a train of the drive as well, where the second one is stopped.
    progress.add(np.array([v for v, _ in first.found]), iter([t for _, t in first.found]))
    return useful, progress, ""


def _unfit(train: Train) -> str:
    """What keeps gears from fitting planets or given distances; nothing where teeth fit."""
    cut = largest_ratio(train)
    stages = [k for k, stage in enumerate(train.stages) if stage.toothing.shifting is not None]
    bare = [k for k in stages if not len(table(train, k, cut).ratio)]
    planetary = [k for k, stage in enumerate(train.stages) if stage.planetary]
    ways = [(k, train.stages[k].options, table(train, k, cut)) for k in planetary]
    reasons = [
        f"{why} (stage {k + 1})."
        for k, options, known in ways
        if (why := _no_stage(train, k, [o.planets for o in options], known))
    ]
    return " ".join(reasons) or " ".join(
        f"No teeth fit {_distances(train.stages[k])} of stage {k + 1}, with the modules, "
        "numbers of teeth, ratios and profile shifts allowed."
        for k in bare
    )


def _no_stage(train: Train, k: int, ways: list[Planets], known: Table) -> str:
    """What keeps planets or a ring from a stage (from 0) of a table; nothing where some fit."""
    if len(known.ratio):
        return no_room(ways, _smallest(known))
    stage, why = train.stages[k], ""
    for wheels in (stage.wheel_teeth, (1, None)):  # limits of rings are asked of ways as well
        free = replace(stage, wheel_teeth=wheels, options=())
        stages = (*train.stages[:k], free, *train.stages[k + 1 :])
        ranges = spans(replace(train, stages=stages), k, train.highest_ratio)
        z1 = np.repeat([z for z, *_ in ranges], [stop - start + 1 for _, start, stop in ranges])
        rows = [np.arange(start, stop + 1) for _, start, stop in ranges]
        why = no_teeth(ways, z1, np.concatenate(rows))
        if len(z1):
            break
    return why


def _smallest(known: Table) -> GearPair:
    """All pairs of a table with the smallest module."""
    every = np.arange(len(known.ratio))
    return known.made(np.full(len(every), known.modules[0]), every)


def _distances(stage: Stage) -> str:
    """The given centre distances of a stage in words, or its sums of profile shifts."""
    if stage.toothing.working_distance is None:
        return "the sums of profile shifts"
    given = sorted({float(toothing.working_distance) for toothing in stage.toothings})
    if len(given) == 1:
        return f"the centre distance of {given[0]:.6g} mm"
    return f"any of the {len(given)} centre distances from {given[0]:.6g} to {given[-1]:.6g} mm"


def _why(progress: Progress, count: int) -> str:
    """Reason why a search ended before it was complete, and its consequence for the list."""
    if not progress.found:
        why = "stopped before a train was found: allow more time"
        return f"the search {INTERRUPTED if progress.clock.refused else why}"
    unknown = "" if math.isfinite(progress.bound) else "; no lower bound is known yet"
    why = f"the search stopped before it was complete{unknown}"
    why = "the requested gap is reached" if progress.enough else why
    return why if count == 1 else f"{why}, so only the best train so far is listed, not {count}"


def _in_order(progress: Progress) -> list[Teeth]:
    """Return trains by objective; ties by fewest teeth, then by the teeth themselves."""
    groups: list[tuple[float, list[Teeth]]] = []
    for value, teeth in progress.found:
        if groups and value <= groups[-1][0] * (1.0 + TIE):
            groups[-1][1].append(teeth)
        else:
            groups.append((value, [teeth]))
    return [t for _, ties in groups for t in sorted(ties, key=lambda t: (sum(map(sum, t)), t))]


def point(train: Train, pairs: Iterable[GearPair], options: Iterable[int] | None = None) -> Array:
    """Point of `problem` of gear pairs; rules that tie their face widths are ignored.

    options: of every stage, from 0; by default the first ones.
    """
    columns: dict[str, list[float]] = {name: [] for name in VARIABLES}
    chosen = (0,) * len(train.stages) if options is None else options
    for pair, stage, option in zip(pairs, train.stages, chosen, strict=True):
        face = stage.face_width
        given = face.tied or face.step is not None  # by d1 or as width_steps
        columns["module"].append(pair.normal_module)
        columns["pinion_teeth"].append(pair.pinion_teeth)
        columns["wheel_teeth"].append(pair.wheel_teeth)
        columns["face_width"].append(1.0 if given else pair.face_width)
        steps = round(pair.face_width / float(face.step)) if face.step else 1
        columns["width_steps"].append(steps)
        columns["option"].append(option + 1)
        columns["toothing"].append(stage.toothing_row(pair) + 1)
    made = [(columns[v.name], v.size) for v in _variables(train)]
    return np.array([float(value) for values, size in made for value in values[:size]])
