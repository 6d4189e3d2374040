"""Simulated annealing (Metropolis) on any problem: many chains side by side, reproducible.

Energy is the logarithm of the objective (or the objective over its scale) plus a penalty that grows
as the temperature falls. Half of the moves change one coordinate, half change all, with steps that
shrink with the temperature; discrete coordinates move by at least one value. The best feasible
point and the last states of the chains are polished (`polish`).
"""

import numpy as np

from gearopt.optimise import polish
from gearopt.optimise.box import Box, box, violation
from gearopt.optimise.clock import Clock
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.optimise.terms import Array

CHAINS = 32
SWEEPS = 4000  # where the budget names no end: 128,000 evaluations in all
HOT, COLD = 0.3, 1e-7  # temperatures, in units of the logarithm of the objective
PENALTY, HARDER = 5.0, 100.0  # energy of a violation of 1 at first, and how often it at last
LONGEST, SHORTEST = 0.3, 1e-6  # steps in a box of width 1
FEASIBLE = 1e-9

FROM_GUESS = True  # it begins at the guess, or where a caller starts it
RANDOM = True
PACED = True  # the cooling is stretched over the evaluations, or else the seconds, it is given
COUNTS = "point evaluated or Ipopt iteration"
SETTINGS = {
    "chains": CHAINS,
    "temperatures": (HOT, COLD),
    "penalty": PENALTY,
    "steps": (LONGEST, SHORTEST),
    **polish.SETTINGS,
}


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Anneal CHAINS chains; the best feasible point ever visited is polished."""
    clock, rng, space = Clock(budget, watch), np.random.default_rng(seed), box(problem)
    last = polish.prepared(problem, clock)
    sampling, most = last.sampling()
    began, end = sampling.seconds, sampling.budget.seconds if most is None else None
    chains = CHAINS if most is None else min(CHAINS, max(1, most))
    sweeps = SWEEPS if most is None else most // chains - 1
    unit = rng.random((chains, len(space.low)))
    unit[0] = space.unit(problem.bounds()[2][None])[0]
    value, excess = violation(problem, space.points(unit))
    scale = max(abs(float(value[0])), 1e-300) if np.isfinite(value[0]) else 1.0
    positive = bool((value[np.isfinite(value)] > 0).all())
    best, sampling.best = _kept(space, unit, value, excess, None, np.inf)
    sampling.evaluations = chains
    sweep = 0
    while sampling.tell() and (end is not None or sweep < sweeps):
        done = (
            sweep / sweeps if end is None else min((sampling.seconds - began) / (end - began), 1.0)
        )
        temperature = HOT * (COLD / HOT) ** done
        moved = _moved(rng, space, unit, LONGEST * (SHORTEST / LONGEST) ** done)
        new_value, new_excess = violation(problem, space.points(moved))
        best, sampling.best = _kept(space, moved, new_value, new_excess, best, sampling.best)
        sampling.evaluations += chains
        weight = PENALTY * HARDER**done
        energy = _energy(value, excess, weight, scale, positive)
        with np.errstate(invalid="ignore", over="ignore"):
            # two points without a value: no rise is known
            rise = _energy(new_value, new_excess, weight, scale, positive) - energy
            chance = np.exp(-np.maximum(np.nan_to_num(rise, nan=np.inf), 0.0) / temperature)
        accept = rng.random(chains) < chance
        unit[accept], value[accept] = moved[accept], new_value[accept]
        excess[accept] = new_excess[accept]
        sweep += 1
    message = "" if best is not None else "no feasible point was visited"
    finished = not sampling.stopped or (end is not None and sweep > 0 and not sampling.refused)
    outcome = Outcome(best, finished, evaluations=sampling.evaluations, message=message)
    energy = _energy(value, excess, PENALTY * HARDER, scale, positive)
    order = np.argsort(np.nan_to_num(energy, nan=np.inf), kind="stable")
    return (
        polish.polished(last, outcome, space.points(unit[order]))
        if not sampling.refused
        else outcome
    )


def _moved(rng: np.random.Generator, space: Box, unit: Array, step: float) -> Array:
    chains, size = unit.shape
    change = step * rng.standard_normal((chains, size))
    single = rng.random(chains) < 0.5
    chosen = rng.integers(0, size, (chains, 1))
    change[single] *= np.arange(size) == chosen[single]
    for k, least in _smallest_steps(space).items():
        short = (change[:, k] != 0) & (np.abs(change[:, k]) < least)
        change[short, k] = np.sign(change[short, k]) * least * rng.integers(0, 2, short.sum())
    moved = unit + change
    return np.abs(np.where(moved > 1.0, 2.0 - moved, moved)).clip(0.0, 1.0)  # reflected


def _smallest_steps(space: Box) -> dict[int, float]:
    """Return the step of discrete coordinates that reaches a neighbour."""
    steps = {k: 1.0 / max(len(v) - 1, 1) for k, v in space.sets.items()}
    for k in np.flatnonzero(space.whole):
        width = space.high[k] - space.low[k]
        gap = np.log1p(1.0 / max(np.exp(space.low[k]), 1.0)) if space.logarithmic[k] else 1.0
        steps[int(k)] = float(gap / width) if width > 0 else 0.0
    return steps


def _energy(value: Array, excess: Array, weight: float, scale: float, positive: bool) -> Array:
    with np.errstate(all="ignore"):
        return (np.log(value) if positive else value / scale) + weight * excess


def _kept(
    space: Box, unit: Array, value: Array, excess: Array, best: Array | None, least: float
) -> tuple[Array | None, float]:
    good = np.where(excess <= FEASIBLE, value, np.inf)
    k = int(good.argmin())
    if good[k] < least:
        return space.points(unit[k : k + 1])[0], float(good[k])
    return best, least
