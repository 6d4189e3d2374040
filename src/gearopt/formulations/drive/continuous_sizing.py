"""Continuous sizing of a drive; of a rated one a smooth form, its bound, and the exact rating.

Where ratings limit the stages, Ipopt minimises the ratings' smooth form in every combination of
what it needs fixed beforehand (regimes of AGMA 908, ranges of K_v of ISO 6336), from the optimum of
a geometric program whose limits are below the true ones (AGMA), or from what a search finds (ISO
6336 without steps in its tolerances). That search bounds the drive from below, in real-valued and
in whole teeth, and looks for designs of its own (`rated_continuous.cells`). What is returned was
rated by the exact form; a design that it does not accept is made as much larger as it takes
(`repaired`).
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations.drive import sizing_text, teeth
from gearopt.formulations.drive.rated_continuous.bounding_program import (
    Choice,
    bounding,
    solved,
    stage_box,
)
from gearopt.formulations.drive.rated_continuous.cells import Searched, search
from gearopt.formulations.drive.rated_continuous.designs import polished
from gearopt.formulations.drive.rated_continuous.quick_bound import quick_bound
from gearopt.formulations.drive.train import Stage, Train
from gearopt.formulations.strength.standard import MODES, Standard
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Event, Outcome, Result, Watch
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Array, Param, Terms, Var, each, namespace
from gearopt.physics.gears import SERIES_I, GearPair
from gearopt.physics.loads import torque_ratios

ROUNDS = 4  # of correcting the smooth form by the exact one
MOST_STANDARDS = 3  # of a stage: AGMA, ISO 6336 and its static strength
EQUAL = 1e-7  # relative; of safety factors that are those of the exact rating
CORRECTION_TOLERANCE = 1e-9  # of corrections that no longer change
GAP_TOLERANCE = 5e-7  # relative gap that ends the search
GAP_SHARE = 0.999  # of a gap that is asked for: roundings included
SEARCH = 5.0  # seconds of the search for a bound where no gap is asked for; 3-fold from 3 stages
POLISHING = 0.2  # of these seconds, at most, for the best design before it
REFINED = 4  # best designs whose choices are refined


def problem(train: Train) -> Problem:
    """Continuous problem of a drive (`exact_text`).

    A rating has branches, and with webs the objective is no posynomial: the method `smooth` finds
    designs of such drives.
    """
    text = sizing_text.exact_text(train)
    special = train.rated or train.hollow
    return replace(text, methods={"smooth": smooth(train)}) if special else text


def smooth(train: Train) -> Callable[..., Outcome]:
    """Return the method of `problem` for a rated drive.

    It returns the best design that the exact rating accepts, with a bound.
    """

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Ipopt on the smooth form from the bounding program; the seed changes nothing."""
        return _outcome(train, problem, Clock(budget, watch))

    return run


def choices(train: Train) -> Iterator[Choice]:
    """Every combination of the regimes that the smooth form needs fixed beforehand."""
    stages = [
        product(*(s.choices(bool(stage.toothing.helix_angle)) for s in _standards(stage)))
        for stage in train.stages
    ]
    return product(*stages)


def _standards(stage: Stage) -> tuple[Standard, ...]:
    """Return the standards that rate a stage."""
    return stage.options[0].standards if stage.options else ()


def smooth_problem(train: Train, choice: Choice) -> Problem:
    """Return the smooth problem in one combination.

    Variables are those of `problem` and the unknowns of the standards, one component a
    stage. The parameter trim has factors of the smooth safeties, by default 1, by stage, standard
    (MOST_STANDARDS) and mode.
    """
    unknowns, size = _unknowns(train), 4 * MOST_STANDARDS * len(train.stages)

    def evaluate(x: Any, p: Any) -> Terms:
        extra: dict[str, dict[str, Any]] = {"defines": {}, "equal": {}}

        def rated(k: int, pair: GearPair, torque: Any, speed: Any, safety: Any) -> dict[str, Any]:
            rows: dict[str, Any] = {}
            for j, standard in enumerate(_standards(train.stages[k])):
                suffix = standard.suffix
                of_standard = {n: each(getattr(x, n + suffix))[k] for n in standard.unknowns}
                smooth_form = standard.smooth(pair, torque, speed, choice[k][j], of_standard)
                for i, (mode, actual) in enumerate(zip(MODES, smooth_form.safeties, strict=True)):
                    trim = p.trim[4 * (MOST_STANDARDS * k + j) + i]
                    rows[mode + suffix] = safety[i // 2] / (actual * trim)
                rows |= {n + suffix: v for n, v in smooth_form.limits.items()}
                for part in extra:
                    of_part = getattr(smooth_form, part).items()
                    extra[part] |= {f"{n}{suffix}[{k + 1}]": v for n, v in of_part}
            return rows

        pairs = sizing_text.text_pairs(train, x, p)
        terms = sizing_text.terms(train, p, pairs, rated=rated)
        equal = {**terms.equal, **extra["equal"]}
        return Terms(terms.minimise, terms.limits, extra["defines"], equal)

    columns = (*sizing_text.variables(train), *unknowns)
    trim = Param("trim", "", (1.0,) * size, size)
    return Problem("sizing", columns, (*sizing_text.parameters(train), trim), evaluate)


def _unknowns(train: Train) -> tuple[Var, ...]:
    size, by_name = len(train.stages), {}
    for stage in train.stages:
        for standard in _standards(stage):
            for name, (low, high, log) in standard.unknowns.items():
                at = max(low, 1.0) if log else 0.5 * (low + high)
                full_name = name + standard.suffix
                lower, upper, guess = ((end,) * size for end in (low, high, at))
                by_name[full_name] = Var(
                    full_name, "", lower, upper, guess, size, log=log, search=True
                )
    return tuple(by_name.values())


@dataclass(frozen=True)
class _Design:
    """A design in real-valued teeth that the exact rating accepts.

    x: point of `problem`; same: whether the smooth form is exact there; status: of Ipopt's
    point, as certified.
    """

    value: float
    x: Array
    choice: Choice
    same: bool
    status: str


def searched(train: Train) -> Callable[..., Outcome]:
    """Return a method of `problem` for a rated drive: the search for its bound alone."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Branch and bound; the seed changes nothing."""
        clock = Clock(budget, watch)
        searched_cells = _searched(train, None, clock, budget.seconds)
        best = _of_pairs(train, problem, searched_cells)
        return _claim(best, searched_cells.bound, clock)

    return run


def _outcome(train: Train, exact: Problem, clock: Clock) -> Outcome:
    """Return the best design of all combinations with the bound of all."""
    if train.several_options:
        raise SolveError("lists of materials are for whole teeth: give a table [teeth]")
    bounded = _all_bounded(train)
    designs, bound = _by_programs(train, exact, clock) if bounded else ([], -math.inf)
    if not bounded or not designs or train.hollow:
        whole_designs = [
            _Design(_value(exact, x), x, (), False, "feasible") for x in whole(train, clock)
        ]
        designs += [design for design in whole_designs if safe(exact, design.x)]
    best = min(designs, key=lambda design: design.value, default=None)
    long = SEARCH * (3.0 if len(train.stages) > 2 else 1.0)
    seconds = None if clock.budget.gap > 0.0 else clock.within(long)
    if bound < math.inf and not clock.over:
        of_cells = _searched(train, best, clock, seconds)
        of_search = _of_pairs(train, exact, of_cells)
        bound, designs = max(bound, of_cells.bound), [*designs, *([of_search] if of_search else [])]
    more = train.hollow or not bounded and not (designs and _rating_jumps(train))
    more = more and not train.ranging  # there are smooth forms of one toothing alone
    if more and bound < math.inf and clock.tell():
        designs += _by_ipopt(train, exact, [*(d.x for d in designs), *starts(exact)], clock)
    return _claim(min(designs, key=lambda d: d.value, default=None), bound, clock)


def _by_programs(train: Train, exact: Problem, clock: Clock) -> tuple[list[_Design], float]:
    """Return designs from the optima of the bounding programs, and the least of their bounds."""
    begun = {choice: _start(train, choice, clock) for choice in choices(train)}
    designs = []
    for choice, (start, _) in begun.items():
        end = None if start is None else _design(train, exact, choice, start, clock)
        designs += [] if end is None else [end]
        if designs:
            clock.best = min(d.value for d in designs)
    designs.sort(key=lambda design: design.value)
    designs += [_refined_design(train, exact, design, clock) for design in designs[:REFINED]]
    return designs, min(least for _, least in begun.values())


def _by_ipopt(train: Train, exact: Problem, begin: list[Array], clock: Clock) -> list[_Design]:
    """Return designs from given starts."""
    designs = []
    for choice in choices(train):
        smooth_text = smooth_problem(train, choice)
        ended = [_design(train, exact, choice, one, clock, smooth_text) for one in begin]
        designs += [design for design in ended if design is not None]
    designs.sort(key=lambda design: design.value)
    return designs + [_refined_design(train, exact, design, clock) for design in designs[:1]]


def _searched(train: Train, best: _Design | None, clock: Clock, seconds: float | None) -> Searched:
    """Designs and bound that the search over cells adds to the best design so far."""
    known = () if best is None else sizing_text.pairs(train, best.x)
    most = math.inf if best is None else best.value
    close = max(GAP_SHARE * clock.budget.gap, GAP_TOLERANCE)
    inner = Clock(replace(clock.left, seconds=seconds), _with_bound(clock))
    if known and (_rating_jumps(train) or train.ranging):
        spent = None if seconds is None else POLISHING * seconds
        known, most = polished(train, (tuple(known), most), Clock(Budget(spent), clock.inner()))
    result = search(train, known, most, inner, close)
    if result.pairs is None and known and best is not None and most < best.value:
        result = Searched(result.bound, tuple(known), most)
    if result.pairs is not None and result.bound < result.value * (1.0 - close):
        result = Searched(result.bound, *polished(train, (result.pairs, result.value), clock))
    clock.best, clock.bound = min(clock.best, result.value), max(clock.bound, result.bound)
    clock.tell()
    return result


def _with_bound(clock: Clock) -> Watch:
    """Return a watcher of a search within a run, whose bound is one of the run, too."""
    follow = clock.inner()

    def watch(event: Event) -> bool:
        clock.bound = max(clock.bound, -math.inf if event.bound is None else event.bound)
        return follow(event) is not False

    return watch


def _of_pairs(train: Train, exact: Problem, found: Searched) -> _Design | None:
    """Return the design of a search; None where it has none that the exact text accepts."""
    if found.pairs is None:
        return None
    x = point_of_pairs(train, found.pairs)
    x = np.clip(x, *exact.bounds()[:2])
    return _Design(_value(exact, x), x, (), False, "feasible") if safe(exact, x) else None


def _rating_jumps(train: Train) -> bool:
    """Return whether a rating jumps with sizes, which no smooth form follows."""
    return any(one.steps for stage in train.stages for one in _standards(stage))


def _value(exact: Problem, x: Array) -> float:
    return float(exact.batch(x[None]).F[0, 0])


def _refined_design(train: Train, exact: Problem, best: _Design, clock: Clock) -> _Design:
    """Return the best design in choices that are closer to the exact rating, stage by stage."""
    for k, pair in enumerate(sizing_text.pairs(train, best.x)):
        for j, standard in enumerate(_standards(train.stages[k])):
            row = best.choice[k]
            for closer in () if clock.stopped else standard.refined(pair, row[j]):
                changed = (*row[:j], closer, *row[j + 1 :])
                neighbour = (*best.choice[:k], changed, *best.choice[k + 1 :])
                other = _design(train, exact, neighbour, best.x, clock)
                if other is not None and other.value < best.value:
                    best = other
    return best


def _claim(best: _Design | None, bound: float, clock: Clock) -> Outcome:
    proof = {
        "method": "branch and bound",
        "arithmetic": "double, with a rounding allowance",
        "sentence": "Proof: branch and bound over ranges of teeth, ratios and sizes, in each of "
        "which a geometric program with limits and objective at most those of the drive bounds it.",
    }
    done = not clock.stopped
    if best is None:
        if bound == math.inf and done:
            return Outcome(None, infeasible=True, proof=proof, evaluations=clock.evaluations)
        words = "no design that the ratings accept was found"
        words = words if done else "stopped before a design was found"
        return Outcome(None, done, evaluations=clock.evaluations, message=words)
    known = min(bound, best.value) if bound > -math.inf else None
    by_search = not best.choice
    words = "the smooth form of the ratings was corrected by the exact one"
    words = "" if best.same or by_search else words
    return Outcome(
        best.x,
        done,
        bound=known,
        proof=proof if known is not None else None,
        stationary=best.same and best.status in ("optimal", "stationary"),
        evaluations=clock.evaluations,
        message=words,
    )


def _all_bounded(train: Train) -> bool:
    """Return whether every standard has a bounding law, from whose optimum a search may start."""
    if train.ranging:
        return False
    boxes = [(stage, stage_box(train, k, math.inf)) for k, stage in enumerate(train.stages)]
    return all(
        standard.floor(own, standard.choices(bool(stage.toothing.helix_angle))[0]) is not None
        for stage, own in boxes
        for standard in _standards(stage)
    )


def _start(train: Train, choice: Choice, clock: Clock) -> tuple[Array | None, float]:
    """Return the optimum of the bounding program, or None, and its bound; inf: impossible."""
    program = None if clock.stopped else bounding(train, choice)
    if program is None:
        return None, -math.inf
    optimum = solved(clock, program)
    if optimum.status == "infeasible":
        return None, math.inf
    return point_of_result(program, optimum), -math.inf if optimum.bound is None else optimum.bound


def _design(
    train: Train,
    exact: Problem,
    choice: Choice,
    start: Array,
    clock: Clock,
    made: Problem | None = None,
) -> _Design | None:
    """Return the best design in a combination, as the exact rating accepts it.

    made: the smooth problem of the combination, where it is known.
    """
    if clock.stopped:
        return None
    made = made or smooth_problem(train, choice)
    trims, size, at = np.ones((len(train.stages), MOST_STANDARDS, 4)), len(start), start
    best: _Design | None = None
    for _ in range(ROUNDS):
        if clock.stopped:
            break
        made = made.at(trim=tuple(trims.ravel().tolist()))
        optimum = solved(clock, made.starting(np.concatenate([at, guess(train, at, choice)])))
        at_end = point_of_result(made, optimum)
        if at_end is None:
            break
        at = np.clip(at_end[:size], *exact.bounds()[:2])
        ratio = _errors(train, at, choice, made, at_end, trims)
        safe = repaired(exact, at)
        if safe is not None:
            value = float(exact.batch(safe[None]).F[0, 0])
            same = bool(np.all(np.abs(trims * ratio - 1.0) <= EQUAL)) and np.array_equal(safe, at)
            if best is None or value < best.value:
                best = _Design(value, safe, choice, same, optimum.status)
        if not np.isfinite(ratio).all() or np.abs(ratio - 1.0).max() <= CORRECTION_TOLERANCE:
            break
        trims = trims * ratio
    return best


def _loads(train: Train, pairs: tuple[GearPair, ...]) -> Iterator[tuple[GearPair, float, float]]:
    ratios = torque_ratios([float(pair.ratio) for pair in pairs], train.drivers)
    for pair, (at_pinion, _) in zip(pairs, ratios, strict=True):
        yield pair, train.torque * at_pinion, train.speed / at_pinion


def guess(train: Train, at: Array, choice: Choice) -> Array:
    """Return the unknowns of the standards at a point, in the order of the variables."""
    columns: dict[str, list[float]] = {v.name: list(each(v.guess)) for v in _unknowns(train)}
    for k, pair in enumerate(sizing_text.pairs(train, at)):
        for j, standard in enumerate(_standards(train.stages[k])):
            for name, value in standard.guess(pair, choice[k][j]).items():
                columns[name + standard.suffix][k] = value
    return np.array([v for column in columns.values() for v in column])


def _errors(
    train: Train, at: Array, choice: Choice, made: Problem, point: Array, trims: Array
) -> Array:
    """Return the exact safeties over the trimmed smooth ones (stages, standards, 4)."""
    ratio = np.ones_like(trims)
    x = namespace(made.variables, [float(v) for v in point])
    for k, (pair, torque, speed) in enumerate(_loads(train, sizing_text.pairs(train, at))):
        for j, standard in enumerate(_standards(train.stages[k])):
            unknowns = {n: each(getattr(x, n + standard.suffix))[k] for n in standard.unknowns}
            smooth = standard.smooth(pair, torque, speed, choice[k][j], unknowns).safeties
            exact = standard.safeties(pair, torque, speed)
            ratio[k, j] = np.array(exact, float) / (np.array(smooth, float) * trims[k, j])
    return ratio


SAFE = 1.0 + FEASIBLE  # utilisation up to which the exact rating accepts a design
GROWTH = tuple(10.0 ** (0.5 * k) for k in range(-14, -3))  # of lengths, in a repair
LESS, SMALLEST, HALVINGS = 1e-5, 0.7, 24  # of lengths that an exact rating finds too large
FINER = (1.0, 1.4, 2.0)  # times the least teeth, of starts without a bounding program
# teeth above the least of a pinion without a limit, of a search among whole teeth
TEETH_SEARCHED = 20
SECONDS, RANGED_SECONDS = 5.0, 2.5  # at most, for that search; where it has ranges
WAYS = {1: 5, 2: 4, 3: 3}  # values of each of so many ranges, of which that search chooses


def point_of_pairs(train: Train, pairs: tuple[GearPair, ...]) -> Array:
    """Return the values of the variables of `problem` that gear pairs have, stage by stage.

    Module and face width [mm], pinion teeth, ratio, helix angle [rad], shifts: those that are
    variables.
    """
    rows = [
        {
            "module": pair.normal_module,
            "pinion_teeth": pair.pinion_teeth,
            "ratio": pair.ratio,
            "face_width": pair.face_width,
            "helix_angle": pair.pinion.helix_angle,
            "pinion_shift": pair.pinion.profile_shift,
            "shift_sum": pair.pinion.profile_shift + pair.wheel.profile_shift,
        }
        for pair in pairs
    ]
    return np.array([float(r[v.name]) for v in sizing_text.variables(train) for r in rows])


def starts(exact: Problem) -> list[Array]:
    """Return starting points: the guess with FINER times its teeth, of modules so much smaller."""
    lower, upper, guess = exact.bounds()
    names = [v.name for v, _ in exact.columns]
    points = []
    for factor in FINER:
        change = {"module": 1.0 / factor, "pinion_teeth": factor}
        moved = [g * change.get(n, 1.0) for g, n in zip(guess, names, strict=True)]
        points.append(np.clip(moved, lower, upper))
    return points


def whole(train: Train, clock: Clock) -> list[Array]:
    """Return the best train of whole teeth and standard modules as a point, if one is found."""
    stages = []
    for stage in train.stages:
        least, most = min(stage.modules, default=None), max(stage.modules, default=None)
        if least is None or most is None:
            series = SERIES_I
        else:
            series = tuple(sorted({least, most, *(m for m in SERIES_I if least < m < most)}))
        low, high = stage.pinion_teeth
        cuts = stage.toothings
        if stage.ranges:
            ways = [_values(ends, WAYS[len(stage.ranges)]) for ends in stage.ranges.values()]
            rows = (dict(zip(stage.ranges, way, strict=True)) for way in product(*ways))
            cuts = tuple(stage.cut(**row) for row in rows)
        few = replace(stage, modules=series, pinion_teeth=(low, high or low + TEETH_SEARCHED))
        stages.append(replace(few, toothings=cuts, helix=None, shifts=None))
    near = replace(train, stages=tuple(stages))
    allowed = Budget(clock.within(RANGED_SECONDS if train.ranging else SECONDS))
    follow = clock.inner()

    def watch(event: Event) -> bool:  # a first train is found without any seconds
        if event.best is not None and clock.bound == -math.inf:
            clock.bound = quick_bound(train, event.best)
        follow(event)
        return not clock.refused

    answer = solve(teeth.problem(near), budget=allowed, watch=watch)
    point = point_of_result(teeth.problem(near), answer)
    if point is None:
        return []
    return [point_of_pairs(train, teeth.pairs(near, point))]


def _values(ends: tuple[float, float], count: int) -> list[float]:
    """Return so many values from end to end, or the one that there is."""
    return [float(v) for v in np.linspace(*ends, count if ends[0] < ends[1] else 1)]


def point_of_result(made: Problem, found: Result) -> Array | None:
    """Return the point of a result; None where it has none."""
    if not found.design:
        return None
    values = [np.atleast_1d(v) for v in found.design.values()]
    return np.concatenate(values).astype(float)


def safe(exact: Problem, x: Array) -> bool:
    """Return whether the exact text accepts a point."""
    batch = exact.batch(x[None])
    return bool(max(batch.G.max(initial=0.0), 1.0 + np.abs(batch.H - 1.0).max(initial=0.0)) <= SAFE)


def repaired(exact: Problem, at: Array) -> Array | None:
    """Return a design as it is, or as much larger as the exact rating needs; None: by too much.

    Stages that could be smaller by LESS are made so.
    """
    lengths = np.array([v.unit == "mm" for v, _ in exact.columns])
    stage = [int(n.rsplit("[", 1)[1][:-1]) if v.size > 1 else 1 for v, n in exact.columns]
    lower, upper, _ = exact.bounds()

    def scaled(x: Array, factor: float, chosen: Array) -> Array:
        return np.clip(np.where(chosen, x * factor, x), lower, upper)

    here = next((s for g in (0.0, *GROWTH) if safe(exact, s := scaled(at, 1 + g, lengths))), None)
    if here is None:
        return None
    for k in range(1, max(stage) + 1):
        moved = lengths & (np.array(stage) == k)
        if not safe(exact, scaled(here, 1.0 - LESS, moved)):
            continue
        low, high = SMALLEST, 1.0 - LESS
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            good = safe(exact, scaled(here, middle, moved))
            low, high = (low, middle) if good else (middle, high)
        here = scaled(here, high, moved)
    return here
