"""Continuous sizing of stages that ratings limit: a smooth form, its bound, and the exact rating.

Ipopt minimises the ratings' smooth form in every combination of what it needs fixed beforehand
(regimes of AGMA 908, ranges of K_v of ISO 6336), from the optimum of a geometric program whose
limits are below the true ones. The dual bound of that program is one of the drive, in real-valued
and in whole teeth. What is returned was rated by the exact form.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations import sizing, teeth
from gearopt.formulations.gear_train import Stage, Train, terms
from gearopt.formulations.rated_bound import Choice, bounding, box, lower_bound, solved
from gearopt.formulations.strength.rated import MODES, Standard
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import FEASIBLE, Budget, Outcome, Result, Watch
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Array, Param, Terms, Var, each, namespace
from gearopt.physics.gears import SERIES_I, GearPair

ROUNDS = 4  # of correcting the smooth form by the exact one
SAFE = 1.0 + FEASIBLE  # utilisation up to which the exact rating accepts a design
GROWTH = tuple(10.0 ** (0.5 * k) for k in range(-14, -3))  # of lengths, in a repair
LESS, SMALLEST, HALVINGS = 1e-5, 0.7, 24  # of lengths that an exact rating finds too large
EQUAL = 1e-7  # relative; of safety factors that are those of the exact rating
SAME = 1e-9  # of corrections that no longer change
FINER = (1.0, 1.4, 2.0)  # times the least teeth, of starts without a bounding program
FEW = 20  # teeth above the least of a pinion without a limit, of a search among whole teeth
SECONDS = 5.0  # at most, for that search
REFINED = 4  # best designs whose choices are refined


def smooth(train: Train) -> Callable[..., Outcome]:
    """Return the method of `sizing.problem` for a rated drive.

    It returns the best design that the exact rating accepts, with a bound.
    """

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Ipopt on the smooth form from the bounding program; the seed changes nothing."""
        return _outcome(train, problem, Clock(budget, watch))

    return run


def choices(train: Train) -> Iterator[Choice]:
    """Return every combination of what the smooth form needs fixed beforehand."""
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

    Variables are those of `sizing.problem` and the unknowns of the standards, one component a
    stage. The parameter trim has factors of the smooth safeties, by default 1, by stage, standard
    (two) and mode.
    """
    unknowns, size = _unknowns(train), 8 * len(train.stages)

    def evaluate(x: Any, p: Any) -> Terms:
        extra: dict[str, dict[str, Any]] = {"defines": {}, "equal": {}}

        def rated(k: int, pair: GearPair, torque: Any, speed: Any, safety: Any) -> dict[str, Any]:
            rows: dict[str, Any] = {}
            for j, standard in enumerate(_standards(train.stages[k])):
                suffix = standard.suffix
                own = {n: each(getattr(x, n + suffix))[k] for n in standard.unknowns}
                made = standard.smooth(pair, torque, speed, choice[k][j], own)
                for i, (mode, actual) in enumerate(zip(MODES, made.safeties, strict=True)):
                    rows[mode + suffix] = safety[i // 2] / (actual * p.trim[8 * k + 4 * j + i])
                rows |= {n + suffix: v for n, v in made.limits.items()}
                for part in extra:
                    found = getattr(made, part).items()
                    extra[part] |= {f"{n}{suffix}[{k + 1}]": v for n, v in found}
            return rows

        found = terms(train, p, sizing.text_pairs(train, x, p), rated=rated)
        equal = {**found.equal, **extra["equal"]}
        return Terms(found.minimise, found.limits, extra["defines"], equal)

    columns = (*sizing.variables(train), *unknowns)
    trim = Param("trim", "", (1.0,) * size, size)
    return Problem("sizing", columns, (*sizing.parameters(train), trim), evaluate)


def _unknowns(train: Train) -> tuple[Var, ...]:
    size, found = len(train.stages), {}
    for stage in train.stages:
        for standard in _standards(stage):
            for name, (low, high, log) in standard.unknowns.items():
                at = max(low, 1.0) if log else 0.5 * (low + high)
                own = name + standard.suffix
                lower, upper, guess = ((end,) * size for end in (low, high, at))
                found[own] = Var(own, "", lower, upper, guess, size, log=log, search=True)
    return tuple(found.values())


@dataclass(frozen=True)
class _Design:
    """A design in real-valued teeth that the exact rating accepts.

    x: point of `sizing.problem`; same: whether the smooth form is exact there; status: of Ipopt's
    point, as certified.
    """

    value: float
    x: Array
    choice: Choice
    same: bool
    status: str


def _outcome(train: Train, exact: Problem, clock: Clock) -> Outcome:
    """Return the best design of all combinations with the bound of all."""
    if train.several_options:
        raise SolveError("lists of materials are for whole teeth: give a table [teeth]")
    begun = {choice: _start(train, choice, clock) for choice in choices(train)}
    possible = {choice: start for choice, (start, least) in begun.items() if least < math.inf}
    bound = min(least for _, least in begun.values())
    others: list[Array] = []
    none = any(start is None for start in possible.values())
    if none or train.hollow or not _all_bounded(train):
        others = [*_whole(train, clock), *_starts(exact)]
    designs = [
        _Design(float(exact.batch(x[None]).F[0, 0]), x, choice, False, "feasible")
        for x in others[:1]
        for choice in list(possible)[:1]
        if _safe(exact, x)
    ]
    for choice, start in possible.items():
        made = smooth_problem(train, choice)
        starts = [start] if start is not None else others
        starts = [*starts, *(others if start is not None else [])]
        found = [_design(train, exact, choice, one, clock, made) for one in starts]
        designs += [design for design in found if design is not None]
        if designs:
            clock.best = min(d.value for d in designs)
    designs.sort(key=lambda design: design.value)
    designs += [_refined(train, exact, design, clock) for design in designs[:REFINED]]
    best = min(designs, key=lambda design: design.value, default=None)
    most = math.inf if best is None else best.value
    if not clock.stopped:
        bound = max(bound, lower_bound(train, list(possible), most, clock))
    return _claim(best, bound, clock)


def _refined(train: Train, exact: Problem, best: _Design, clock: Clock) -> _Design:
    """Return the best design in choices that are closer to the exact rating, stage by stage."""
    for k, pair in enumerate(sizing.pairs(train, best.x)):
        for j, standard in enumerate(_standards(train.stages[k])):
            row = best.choice[k]
            for closer in () if clock.stopped else standard.refined(pair, row[j]):
                changed = (*row[:j], closer, *row[j + 1 :])
                own = (*best.choice[:k], changed, *best.choice[k + 1 :])
                made = _design(train, exact, own, best.x, clock)
                if made is not None and made.value < best.value:
                    best = made
    return best


def _claim(best: _Design | None, bound: float, clock: Clock) -> Outcome:
    proof = {
        "method": "dual",
        "arithmetic": "double, with a rounding allowance",
        "sentence": "Proof: a geometric program whose limits and objective are at most those of "
        "the drive; its bound is a dual one, computed from our own derivatives.",
    }
    done = not clock.stopped
    if best is None:
        if bound == math.inf and done:
            return Outcome(None, infeasible=True, proof=proof, evaluations=clock.evaluations)
        words = "no start led to a design that the ratings accept"
        return Outcome(None, done, evaluations=clock.evaluations, message=words)
    known = min(bound, best.value) if bound > -math.inf else None
    words = "" if best.same else "the smooth form of the ratings was corrected by the exact one"
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
    boxes = [(stage, box(train, k, math.inf)) for k, stage in enumerate(train.stages)]
    return all(
        standard.floor(own, standard.choices(bool(stage.toothing.helix_angle))[0]) is not None
        for stage, own in boxes
        for standard in _standards(stage)
    )


def _starts(exact: Problem) -> list[Array]:
    """Return starts of more and more, smaller teeth."""
    lower, upper, guess = exact.bounds()
    names = [v.name for v, _ in exact.columns]
    found = []
    for factor in FINER:
        change = {"module": 1.0 / factor, "pinion_teeth": factor}
        moved = [g * change.get(n, 1.0) for g, n in zip(guess, names, strict=True)]
        found.append(np.clip(moved, lower, upper))
    return found


def _whole(train: Train, clock: Clock) -> list[Array]:
    """Return the best train of whole teeth and standard modules as a point, if one is found."""
    stages = []
    for stage in train.stages:
        least, most = min(stage.modules, default=None), max(stage.modules, default=None)
        if least is None or most is None:
            series = SERIES_I
        else:
            series = tuple(sorted({least, most, *(m for m in SERIES_I if least < m < most)}))
        low, high = stage.pinion_teeth
        stages.append(replace(stage, modules=series, pinion_teeth=(low, high or low + FEW)))
    near = replace(train, stages=tuple(stages))
    found = solve(teeth.problem(near), budget=Budget(clock.within(SECONDS)))
    point = _point(teeth.problem(near), found)
    if point is None:
        return []
    rows = [
        {
            "module": pair.normal_module,
            "pinion_teeth": pair.pinion_teeth,
            "ratio": pair.ratio,
            "face_width": pair.face_width,
        }
        for pair in teeth.pairs(near, point)
    ]
    return [np.array([float(r[v.name]) for v in sizing.variables(train) for r in rows])]


def _start(train: Train, choice: Choice, clock: Clock) -> tuple[Array | None, float]:
    """Return the optimum of the bounding program, or None, and its bound; inf: impossible."""
    made = None if clock.stopped else bounding(train, choice)
    if made is None:
        return None, -math.inf
    found = solved(clock, made)
    if found.status == "infeasible":
        return None, math.inf
    return _point(made, found), -math.inf if found.bound is None else found.bound


def _point(made: Problem, found: Result) -> Array | None:
    if not found.design:
        return None
    values = [np.atleast_1d(v) for v in found.design.values()]
    return np.concatenate(values).astype(float)


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
    trims, size, at = np.ones((len(train.stages), 2, 4)), len(start), start
    best: _Design | None = None
    for _ in range(ROUNDS):
        if clock.stopped:
            break
        made = made.at(trim=tuple(trims.ravel().tolist()))
        found = solved(clock, made.starting(np.concatenate([at, guess(train, at, choice)])))
        point = _point(made, found)
        if point is None:
            break
        at = np.clip(point[:size], *exact.bounds()[:2])
        ratio = _errors(train, at, choice, made, point, trims)
        safe = _repaired(exact, at)
        if safe is not None:
            value = float(exact.batch(safe[None]).F[0, 0])
            same = bool(np.all(np.abs(trims * ratio - 1.0) <= EQUAL)) and np.array_equal(safe, at)
            if best is None or value < best.value:
                best = _Design(value, safe, choice, same, found.status)
        if not np.isfinite(ratio).all() or np.abs(ratio - 1.0).max() <= SAME:
            break
        trims = trims * ratio
    return best


def _safe(exact: Problem, x: Array) -> bool:
    made = exact.batch(x[None])
    return bool(max(made.G.max(initial=0.0), 1.0 + np.abs(made.H - 1.0).max(initial=0.0)) <= SAFE)


def _repaired(exact: Problem, at: Array) -> Array | None:
    """Return a design as it is, or as much larger as the exact rating needs; None: by too much.

    Stages that could be smaller by LESS are made so.
    """
    lengths = np.array([v.unit == "mm" for v, _ in exact.columns])
    stage = [int(n.rsplit("[", 1)[1][:-1]) if v.size > 1 else 1 for v, n in exact.columns]
    lower, upper, _ = exact.bounds()

    def scaled(x: Array, factor: float, chosen: Array) -> Array:
        return np.clip(np.where(chosen, x * factor, x), lower, upper)

    here = next((s for g in (0.0, *GROWTH) if _safe(exact, s := scaled(at, 1 + g, lengths))), None)
    if here is None:
        return None
    for k in range(1, max(stage) + 1):
        own = lengths & (np.array(stage) == k)
        if not _safe(exact, scaled(here, 1.0 - LESS, own)):
            continue
        low, high = SMALLEST, 1.0 - LESS
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            good = _safe(exact, scaled(here, middle, own))
            low, high = (low, middle) if good else (middle, high)
        here = scaled(here, high, own)
    return here


def _loads(train: Train, pairs: tuple[GearPair, ...]) -> Iterator[tuple[GearPair, float, float]]:
    torque = train.torque
    for pair in pairs:
        yield pair, torque, float(train.speed_at(torque))
        torque *= float(pair.ratio)


def guess(train: Train, at: Array, choice: Choice) -> Array:
    """Return the unknowns of the standards at a point, in the order of the variables."""
    columns: dict[str, list[float]] = {v.name: list(each(v.guess)) for v in _unknowns(train)}
    for k, pair in enumerate(sizing.pairs(train, at)):
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
    for k, (pair, torque, speed) in enumerate(_loads(train, sizing.pairs(train, at))):
        for j, standard in enumerate(_standards(train.stages[k])):
            own = {n: each(getattr(x, n + standard.suffix))[k] for n in standard.unknowns}
            smooth = standard.smooth(pair, torque, speed, choice[k][j], own).safeties
            exact = standard.safeties(pair, torque, speed)
            ratio[k, j] = np.array(exact, float) / (np.array(smooth, float) * trims[k, j])
    return ratio
