"""The best modules, face widths and options of a drive whose teeth are chosen."""

import math

import numpy as np

from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.teeth.progress import TIE, Teeth
from gearopt.formulations.drive.teeth.stage import Table
from gearopt.formulations.drive.teeth.tables import table
from gearopt.formulations.drive.train import Train
from gearopt.optimise.terms import Array
from gearopt.physics.gears import GearPair
from gearopt.physics.loads import torque_ratios


def best_pairs(train: Train, teeth: Teeth) -> tuple[GearPair, ...]:
    """Return the gear pairs of a train: the best module and face width for its teeth."""
    return best_choices(train, teeth)[0]


def best_choices(train: Train, teeth: Teeth) -> tuple[tuple[GearPair, ...], tuple[int, ...]]:
    """Return gear pairs and options (from 0) of a train: the best ones for its teeth."""
    return valued(train, teeth)[1:]


def valued(train: Train, teeth: Teeth) -> tuple[float, tuple[GearPair, ...], tuple[int, ...]]:
    """Objective of a train with its best pairs and options, and these; inf: none carries."""
    every = train.of_one_option
    best = [(*_choices(part, teeth), number) for number, part in enumerate(every)]
    value, pairs, chosen, number = min(best, key=lambda choice: choice[0])
    return value, pairs, chosen if len(every) == 1 else (number,) * len(teeth)


def _choices(train: Train, teeth: Teeth) -> tuple[float, tuple[GearPair, ...], tuple[int, ...]]:
    """Return the objective of a train with the best pairs and options, and these; inf: none."""
    value, pairs, options = 0.0, [], []
    loaded: list[tuple[Table, float]] = []
    ratios = torque_ratios([z2 / z1 for z1, z2 in teeth], train.drivers)
    for k, (z1, z2) in enumerate(teeth):
        only = table(train.fixed_teeth(k, z1, z2), k, train.highest_ratio, _no_kernels)
        loaded.append((only, train.torque * ratios[k][0]))
    rows = _best_rows(train, loaded)
    if len(rows) < len(teeth):
        return math.inf, (), ()
    for k, ((only, torque), row) in enumerate(zip(loaded, rows, strict=True)):
        module, width, option = only.choose(torque, row)
        pairs.append(train.pair(k, module, *teeth[k], width, only.toothing[row]))
        options.append(option)
        value += (
            float(objective_share(train, k, pairs[-1], option=option))
            if module < math.inf
            else math.inf
        )
    return value, tuple(pairs), tuple(options)


def _no_kernels() -> float:
    """No seconds left to load kernels: the rows of one train are few."""
    return 0.0


def _best_rows(train: Train, loaded: list[tuple[Table, float]]) -> list[int]:
    """Rows of tables of given teeth, at torques, of the least cost together; none: there are none.

    Of equal ones the first. Distances that go together are those of a row of the train's.
    """
    if not train.distances:
        return [_best(_costs(*one)) if len(one[0].ratio) > 1 else 0 for one in loaded]
    by_distance = [_best_by_distance(*one) for one in loaded]
    best: tuple[float, list[int]] = math.inf, []
    for distances in train.distances:
        chosen = [known.get(a) for known, a in zip(by_distance, distances, strict=True)]
        places = [one for one in chosen if one is not None]
        value = sum(cost for cost, _ in places)
        if len(places) == len(loaded) and value < best[0] * (1.0 - TIE):
            best = value, [row for _, row in places]
    return best[1]


def _best_by_distance(teeth: Table, torque: float) -> dict[float, tuple[float, int]]:
    """The least cost of the rows of a table of given teeth at every distance, and its row."""
    given = np.array([t.working_distance for t in teeth.stage.toothings])[teeth.toothing]
    costs, best = _costs(teeth, torque), {}
    for distance in np.unique(given):
        rows = np.flatnonzero(given == distance)
        row = int(rows[_best(costs[rows])])
        best[float(distance)] = float(costs[row]), row
    return best


def _costs(teeth: Table, torque: float) -> Array:
    """The costs of all rows of a table at a torque [N mm]."""
    rows = np.arange(len(teeth.ratio))
    return teeth.cost(np.full(len(rows), torque), rows)


def _best(costs: Array) -> int:
    """The first of the rows of least cost."""
    return int(np.flatnonzero(costs <= costs.min() * (1.0 + TIE))[0])
