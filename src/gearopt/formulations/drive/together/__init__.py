"""Sizes and layout at once: teeth, modules, face widths and link angles of the smallest gearbox.

The same limits as `teeth` and `layout` together, and a proven bound: no train, in no layout, has a
box that is smaller than the answer by more than its gap.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.gearbox import Gearbox, Shaft
from gearopt.formulations.drive.layout.annealing import ANNEAL
from gearopt.formulations.drive.layout.chain import chain
from gearopt.formulations.drive.layout.layout_text import (
    given_places,
    largest,
    positions,
    sides,
    value,
)
from gearopt.formulations.drive.layout.slabs import Arrangement, Slabs, arrange, orders
from gearopt.formulations.drive.teeth.choices import best_choices
from gearopt.formulations.drive.teeth.search import search as sizing
from gearopt.formulations.drive.teeth.stage import Table
from gearopt.formulations.drive.together.search import (
    MARGINS,
    Made,
    Search,
    keep,
    lay,
    prepare,
    prove,
)
from gearopt.formulations.drive.together.tables import KERNELS, Make, frame, numbers
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.best_first import ending
from gearopt.optimise.clock import Clock
from gearopt.optimise.kernels import UNREADY, compiled, kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array, Terms, Var, each
from gearopt.physics.gears import GearPair

Start = tuple[Made, Arrangement, Array]
GAP = 1e-3  # proven where the budget requests none
FIRST_SIZINGS = 40  # best sizings that are laid out before the search
ANY = 1.0  # gap of a first sizing of ratings, whose list takes long: to the bound 0
SLACK = 1e-6  # relative: margins are this much below the requested gap, for rounding

RANDOM = False
COUNTS = "tooth pair or range of link angles bounded"
SETTINGS = {"margins": MARGINS, "sizings laid out first": FIRST_SIZINGS}


def problem(
    train: Train, make: Make, start: Start | None = None, tables: Sequence[Table] = ()
) -> Problem:
    """Return the problem of a drive and its gearbox; `exact` finds the smallest box with its bound.

    make(pairs) -> Gearbox of these gear pairs; shaft k may grow with the torque T1 u_1 ... u_k that
    it carries, and nothing else depends on the pairs. The objective is the
    gearbox's. Variables are those of `text`. start: a layout known before, which is kept
    unless a better one is found: gear pairs and options, arrangement and link angles. tables: of
    the stages, where they are known; a search makes them otherwise.
    """
    box = frame(train, make)

    def exact(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Depth-first passes with narrowing margins; the seed is that of first layouts."""
        if not ready(watch):
            return Outcome(None, False, message=UNREADY)
        search = Search(train, make, Clock(budget, watch), seed, tables=tables)
        return _searched(search, start)

    return text(train, make, box, {"exact": exact})


def ready(watch: Watch | None = None) -> bool:
    """Have every kernel compiled before a clock runs; False if the watcher ended that."""
    law = kernel(KERNELS)
    return compiled(
        _tiny,
        (law.useful, law.shorten, law.fill, law.expand, law.sift, kernel(ANNEAL).anneal),
        watch,
    )


@cache
def _tiny() -> None:
    """Search a tiny drive, which calls every kernel."""
    unit = FaceWidth(Fraction(1), Fraction(1))
    stage = Stage((2.0, 48.0), unit, (Fraction(2), Fraction(3)), (20, 22))
    train = Train(3e4, Fraction(9), Fraction(1, 50), (stage, stage), law=K_FACTOR)

    def make(pairs: tuple[GearPair, ...]) -> Gearbox:
        return Gearbox(pairs, (Shaft(5.0), Shaft(8.0), Shaft(12.0)))

    _searched(Search(train, make, Clock(Budget(gap=0.01)), 0), None)


def _searched(search: Search, start: Start | None) -> Outcome:
    if start is not None:
        keep(search, *start)
    possible = _first(search)
    if possible and search.clock.tell():
        possible = _proven(search)
    return _outcome(search, slabs_of(frame(search.train, search.make)), possible)


def _proven(search: Search) -> bool:
    """Search with narrower and narrower margins; False if there is no train at all."""
    drive, box = numbers(search.train, search.make, search.tables)
    clock = search.clock
    wanted = (clock.budget.gap or GAP) * (1.0 - SLACK)
    margins = [m for m in MARGINS if m > 1.1 * wanted] + [wanted]
    while margins and not clock.stopped:
        work = prepare(search, drive, box, wanted)
        if work is not None and search.train.rated:
            drive = work.drive  # whose widths took long
        while work is not None and margins and prove(search, work, margins[0]):
            clock.bound = max(clock.bound, search.value * (1.0 - margins.pop(0)))
            if search.best is None:
                return False
    return True


def _first(search: Search) -> bool:
    """Lay out the best sizings, or a first one of ratings; False if there is no train at all."""
    rated = search.train.rated
    if rated and search.best is not None:
        return True
    count, enough = (1, Budget(gap=ANY)) if rated else (FIRST_SIZINGS, Budget())
    progress = sizing(search.train, count, enough, search.clock.inner(values=False), floor=0.0)
    for _, node in progress.found[:count]:
        if search.clock.stopped:
            break
        lay(search, best_choices(search.train, node), MARGINS[3])
    return bool(progress.found) or progress.clock.stopped


def _outcome(search: Search, known: tuple[Any, ...], possible: bool) -> Outcome:
    clock, stages = search.clock, len(search.train.stages)
    stopped = clock.stopped
    method = "branch and bound, stopped early" if stopped else "exhausted"
    proof = {
        "method": method,
        "arithmetic": "ratios, teeth and steps rational; boxes double, bounds with an allowance",
        "nodes": {f"{stages - k}": n for k, n in sorted(search.made.items())},
        "nodes_with_a_layout": {f"{stages - k}": n for k, n in sorted(search.left.items())},
        "trains_laid_out": search.trains,
        "sentence": f"Proof: {sum(search.made.values()):,} trains and parts of trains bounded, "
        f"{search.trains:,} laid out in full; {ending(not stopped)}.",
    }
    if search.best is None:
        return Outcome(
            None,
            not stopped,
            infeasible=not stopped and not possible,
            proof=proof,
            evaluations=clock.evaluations,
            message="stopped before a layout was found" if stopped else "",
        )
    best = search.best
    x = point(
        search.train,
        (best.pairs, best.options),
        known.index(best.slabs),
        len(known) > 1,
        best.angles,
    )
    return Outcome(
        x,
        not stopped,
        bound=clock.bound if 0.0 < clock.bound < math.inf else None,
        proof=proof,
        evaluations=clock.evaluations,
    )


def slabs_of(box: Gearbox) -> tuple[Slabs, ...]:
    """Return the orders of slabs that a gearbox leaves open, in the order of `arrangement`."""
    return (box.slabs,) if box.slabs is not None else orders(box)


def text(
    train: Train, make: Make, box: Gearbox, methods: Mapping[str, Callable[..., Any]]
) -> Problem:
    """Pose the smallest box over whole teeth and link angles, for the given methods.

    Variables: those of `teeth`, angle [rad] of each link, arrangement where several are open.
    box: what `make` gives for any sizes.
    """
    sized, known, links = teeth.problem(train), slabs_of(box), len(train.stages)
    placing = [Var("angle", "rad", -math.pi, math.pi, 0.1, links)]
    if len(known) > 1:
        placing.append(Var("arrangement", "", 0, len(known) - 1, 0, integer=True))
    variables = (*sized.variables, *placing)
    count = sum(v.size for v in sized.variables)

    def one(point: Array) -> tuple[dict[str, float], dict[str, float], dict[str, float]]:
        slabs = known[round(point[-1]) if len(known) > 1 else 0]
        there = make(teeth.pairs(train, point[:count]))
        return _terms(there, arrange(there, slabs), point[count : count + links])

    def evaluate(x: Any, p: Any) -> Terms:
        terms = sized.evaluate(x, p)
        columns = [v for var in variables for v in each(getattr(x, var.name))]
        points = np.atleast_2d(np.array(np.broadcast_arrays(*columns), float).T)
        rows = [one(point) for point in points]
        many = np.ndim(columns[0]) > 0

        def block(k: int) -> dict[str, Any]:
            names = rows[0][k]
            return {n: np.array([r[k][n] for r in rows]) if many else names[n] for n in names}

        return Terms(
            block(0),
            {**terms.limits, **block(1)},
            equal={**terms.equal, **block(2)},
            report=dict(terms.minimise),
        )

    return Problem("together", variables, (), evaluate, methods=methods, vectorised=True)


def _terms(
    box: Gearbox, order: Arrangement, angles: Array
) -> tuple[dict[str, float], dict[str, float], dict[str, float]]:
    """Return the objective, limits and equalities of a layout."""
    shape = chain(box, (order,))
    y, z = positions(shape, tuple(float(a) for a in angles))
    side = sides(shape, y, z)
    width, height = side["width"], side["height"]
    limits: dict[str, float] = {}
    for i in range(len(y)):
        for j in range(i + 1, len(y)):
            limits[f"shafts_apart[{i + 1},{j + 1}]"] = _clear(
                order.apart[i, j], y[i] - y[j], z[i] - z[j]
            )
        for k, (left, right, bottom, top) in enumerate(shape.keep):
            dy, dz = max(left - y[i], y[i] - right, 0.0), max(bottom - z[i], z[i] - top, 0.0)
            limits[f"clear_of_keep_out[{k + 1},{i + 1}]"] = _clear(order.keep_apart[k, i], dy, dz)
    limits |= largest(shape, width, height, order.length)
    given, equal = given_places(shape, y, z)
    return {box.objective: value(shape, 0, width, height)}, limits | given, equal


def _clear(need: float, dy: float, dz: float) -> float:
    """Return the utilisation of a minimum distance: at most 1 where it is kept."""
    there = dy**2 + dz**2
    return 1.0 + (need**2 - there) / max(need**2, there, 1.0)


def point(train: Train, made: Made, slabs: int, several: bool, angles: Array) -> Array:
    """Return the point of a train with its layout."""
    order = [float(slabs)] if several else []
    return np.concatenate([teeth.point(train, *made), angles, order])


def pairs(train: Train, x: Array) -> tuple[GearPair, ...]:
    """Return the gear pairs of a point of `text`."""
    count = sum(v.size for v in teeth.problem(train).variables)
    return teeth.pairs(train, x[:count])


def laid_out(train: Train, make: Make, x: Array) -> tuple[Gearbox, tuple[float, ...], Arrangement]:
    """Return the gearbox of a point of `text`, its link angles [rad] and arrangement of slabs."""
    box = make(pairs(train, x))
    known, links = slabs_of(box), len(train.stages)
    start = sum(v.size for v in teeth.problem(train).variables)
    order = arrange(box, known[round(float(x[-1])) if len(known) > 1 else 0])
    return box, tuple(float(t) for t in x[start : start + links]), order
