"""The best relief by a local method: the sharing's conditions as constraints, solved by Ipopt.

The inner minimum is replaced by its conditions, 0 <= share, 0 <= gap, share * gap <= tau, a
mathematical program with complementarity constraints whose tau falls from solve to solve, each
beginning where the one before ended. What is found is judged by the exact sharing.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from gearopt.formulations.pair.relief.meshing import Mesh, Relief
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.solvers import ipopt
from gearopt.optimise.terms import Array, Param, Repeat, Terms, Var, each

MICRO = 1e3  # um a mm
# of the homotopy: greatest share * gap [um], rounding of a relief's beginning [length]
HOMOTOPY = (
    (1e-1, 1e-3),
    (1e-2, 1e-3),
    (1e-3, 1e-3),
    (1e-5, 1e-4),
)
MAX_ITERATIONS = 300  # iterations of one step
STARTS = 4  # where the budget names no end
CORNER = 1e-6  # of a range: starts keep as far from its ends

RANDOM = True
COUNTS = "Ipopt iteration of any start"
SETTINGS = {"starts": STARTS, "steps": HOMOTOPY, "iterations of a step": MAX_ITERATIONS}


def complementarity(mesh: Mesh, low: Array, high: Array, exponents: tuple[float, float]) -> Problem:
    """Pose the least peak-to-peak [um] with amounts [um], lengths [mm], shares and approaches.

    low, high: amounts 1, 2, lengths 1, 2 [mm]. One repeat for every number of pairs in contact,
    over the positions that have it and all loads; its rows have shares f and the approach delta of
    uncoupled pairs. Parameters tau [um] and smoothing [-].
    """
    first, last = np.array(low, float), np.array(high, float)
    first[:2], last[:2] = MICRO * first[:2], MICRO * last[:2]
    middle, count = 0.5 * (first + last), len(mesh.loads)
    ends = [(tuple(v[:2]), tuple(v[2:])) for v in (first, last, middle)]
    (a0, l0), (a1, l1), (a2, l2) = ends
    columns = [Var("amount", "um", a0, a1, a2, 2), Var("length", "mm", l0, l1, l2, 2)]
    most = (
        MICRO * float(max(mesh.loads) * (mesh.compliances - mesh.coupling).max()) + last[:2].sum()
    )
    columns += [Var("low", "um", 0.0, most, 0.1 * most, count)]
    columns += [Var("peak", "um", 0.0, most, 0.1 * most)]
    pairs = mesh.cycle.present.sum(axis=1)
    repeats = tuple(_repeat(mesh, pairs == n, int(n), most, exponents) for n in np.unique(pairs))
    parameters = Param("tau", "um", HOMOTOPY[0][0]), Param("smoothing", "", HOMOTOPY[0][1])
    return Problem(
        "relief by complementarity",
        tuple(columns),
        parameters,
        lambda x, p: Terms({"peak": x.peak}),
        repeats,
    )


def _repeat(
    mesh: Mesh, rows: Any, pairs: int, most: float, exponents: tuple[float, float]
) -> Repeat:
    """Return the positions with so many pairs, at all loads."""
    there = mesh.cycle.present[rows]
    uncoupled = MICRO * (mesh.compliances - mesh.coupling)[rows][there].reshape(-1, pairs)
    tips = [x[rows][there].reshape(-1, pairs) for x in mesh.from_tips]
    loads, data = mesh.loads, dict[str, Array]()
    for i in range(pairs):
        data[f"own{i}"] = np.concatenate([w * uncoupled[:, i] for w in loads])
        for gear in range(2):
            data[f"tip{gear}{i}"] = np.tile(tips[gear][:, i], len(loads))
    for q in range(len(loads)):
        data[f"at{q}"] = np.repeat(np.arange(len(loads)) == q, len(uncoupled)).astype(float)

    def evaluate(x: Any, p: Any, row: Any) -> Terms:
        shares, delta = each(getattr(x, f"share{pairs}")), getattr(x, f"delta{pairs}")
        apart = [_removed(x, p, row, i, exponents) for i in range(pairs)]
        uncoupled = [getattr(row, f"own{i}") for i in range(pairs)]
        gaps = [k * f + e - delta for k, f, e in zip(uncoupled, shares, apart, strict=True)]
        low = sum(getattr(row, f"at{q}") * v for q, v in enumerate(each(x.low)))
        defines = {
            "open": tuple(1.0 - gap for gap in gaps),
            "either": tuple(1.0 + f * g - p.tau for f, g in zip(shares, gaps, strict=True)),
            "least": 1.0 + low - delta,
            "most": 1.0 + delta - low - x.peak,
        }
        return Terms({}, {}, defines, {"shared": sum(shares)})

    share = Var(f"share{pairs}", "", 0.0, 1.0, 1.0 / pairs, pairs)
    delta = Var(f"delta{pairs}", "um", 0.0, most, 0.3 * most)
    return Repeat(f"pairs{pairs}", (share, delta), data, evaluate)


def _removed(x: Any, p: Any, row: Any, pair: int, exponents: tuple[float, float]) -> Any:
    """Depth that both gears' reliefs remove from a pair [um], its beginning rounded."""
    depth = 0.0
    for gear, power in enumerate(exponents):
        u = 1.0 - getattr(row, f"tip{gear}{pair}") / x.length[gear]
        depth = depth + x.amount[gear] * (0.5 * (u + np.sqrt(u**2 + p.smoothing**2))) ** power
    return depth


def local(mesh: Mesh, exponents: tuple[float, float]) -> Callable[..., Outcome]:
    """Return the method of `parametric.problem` that follows Ipopt from several starts."""

    def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Solve from a usual relief, then from others by the seed; keep the best."""
        clock, (low, high, _) = Clock(budget, watch), problem.bounds()
        posed, best = complementarity(mesh, low, high, exponents), None
        for k, start in enumerate(_starts(mesh, low, high, seed)):
            if k >= STARTS and budget.seconds is None and budget.evaluations is None:
                break
            x = _followed(posed, _point(mesh, posed, start, exponents), clock)
            local_point = np.clip(np.array([*x[:2] / MICRO, *x[2:4]]), low, high)
            value = float(problem.batch(local_point[None]).F[0, 0])
            if best is None or value < clock.best:
                best, clock.best = local_point, value
            if not clock.tell():
                break
        return Outcome(best, not clock.stopped, evaluations=clock.evaluations)

    return run


def _starts(mesh: Mesh, low: Array, high: Array, seed: int) -> Iterator[Array]:
    """Yield amounts that deform as a pair does alone, of 0.6 p_b; then others, at random."""
    rng, path = np.random.default_rng(seed), mesh.cycle.path
    deep = float(max(mesh.loads) * np.median(mesh.compliances - mesh.coupling))
    short = 0.6 * float(path.base_pitch)
    inside = low + CORNER * (high - low), high - CORNER * (high - low)
    usual = np.array([deep, deep, short, short])
    yield np.clip(usual, *inside)
    while True:
        yield np.clip(usual * rng.uniform(0.5, 1.5, 4), *inside)


def _point(mesh: Mesh, posed: Problem, start: Array, exponents: tuple[float, float]) -> Array:
    """Return the point of the whole problem where the load is shared exactly."""
    reliefs = (Relief(start[k], start[2 + k], exponents[k]) for k in range(2))
    shared = mesh.sharing(mesh.separations(*reliefs))
    loads = np.array(mesh.loads)[:, None]
    delta = MICRO * (shared.approach - mesh.coupling * loads)
    shares = shared.forces / np.maximum(loads, 1e-300)[..., None]
    peak = np.ptp(delta, axis=1).max()
    parts = [start * np.array([MICRO, MICRO, 1.0, 1.0]), delta.min(axis=1), np.array([peak])]
    there = mesh.cycle.present
    for repeat in posed.repeats:
        rows = there.sum(axis=1) == repeat.variables[0].size
        forces = shares[:, rows][:, there[rows]].reshape(len(loads) * int(rows.sum()), -1)
        parts.append(np.hstack([forces, delta[:, rows].reshape(-1, 1)]).ravel())
    return np.concatenate(parts)


def _followed(posed: Problem, x: Array, clock: Clock) -> Array:
    """Return where Ipopt ends as tau and smoothing fall."""
    for tau, smoothing in HOMOTOPY:
        left = clock.left.evaluations
        most = MAX_ITERATIONS if left is None else min(MAX_ITERATIONS, left)
        budget = Budget(clock.left.seconds, most)
        here = posed.at(tau=tau, smoothing=smoothing)
        outcome = ipopt.run(here, budget, 0, clock.inner(values=False), start=x)
        x = x if outcome.x is None else outcome.x
        if clock.over:
            break
    return x
