"""The best modules, face widths and options of a drive whose teeth are chosen."""

import math

import numpy as np

from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.teeth.progress import TIE, Teeth
from gearopt.formulations.drive.teeth.stage import Table
from gearopt.formulations.drive.teeth.tables import table
from gearopt.formulations.drive.train import Train
from gearopt.physics.gears import GearPair


def best_pairs(train: Train, teeth: Teeth) -> tuple[GearPair, ...]:
    """Return the gear pairs of a train: the best module and face width for its teeth."""
    return best_choices(train, teeth)[0]


def best_choices(train: Train, teeth: Teeth) -> tuple[tuple[GearPair, ...], tuple[int, ...]]:
    """Return gear pairs and options (from 0) of a train: the best ones for its teeth."""
    return valued(train, teeth)[1:]


def valued(train: Train, teeth: Teeth) -> tuple[float, tuple[GearPair, ...], tuple[int, ...]]:
    """Objective of a train with its best pairs and options, and these; inf: none carries."""
    every = train.of_one_option
    made = [_choices(one, teeth) for one in every]
    least = min(range(len(every)), key=lambda k: made[k][0])
    value, pairs, chosen = made[least]
    return value, pairs, chosen if len(every) == 1 else (least,) * len(teeth)


def _choices(train: Train, teeth: Teeth) -> tuple[float, tuple[GearPair, ...], tuple[int, ...]]:
    """Return the objective of a train with the best pairs and options, and these; inf: none."""
    torque, value, found, chosen = train.torque, 0.0, [], []
    for k, (z1, z2) in enumerate(teeth):
        only = table(train.fixed_teeth(k, z1, z2), k, train.highest_ratio)
        row = _best_row(only, torque)
        module, width, option = only.choose(torque, row)
        found.append(train.pair(k, module, z1, z2, width, only.toothing[row]))
        chosen.append(option)
        value += (
            float(objective_share(train, k, found[-1], option=option))
            if module < math.inf
            else math.inf
        )
        torque *= z2 / z1
    return value, tuple(found), tuple(chosen)


def _best_row(teeth: Table, torque: float) -> int:
    """Return the row of a table of given teeth of the least cost: the first of equal ones."""
    rows = np.arange(len(teeth.ratio))
    if len(rows) == 1:
        return 0
    costs = teeth.cost(np.full(len(rows), torque), rows)
    return int(np.flatnonzero(costs <= costs.min() * (1.0 + TIE))[0])
