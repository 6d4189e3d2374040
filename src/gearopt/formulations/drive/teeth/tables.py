"""Pairs of teeth that a stage may have: by load limits (`Table`) or by ratings (`RatedTable`)."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from gearopt.formulations.drive.teeth.columns import columns
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.stage import Table
from gearopt.formulations.drive.train import Train

THINNED = 400  # tooth pairs of a stage, of all ratios, that are left to a hurried search


def table(
    train: Train,
    position: int,
    cut: Fraction,
    tick: Callable[[], float] = lambda: math.inf,
    others: Sequence[RatedTable] = (),
) -> Table:
    """Return the table of a stage (counted from 0) for ratios up to `cut`.

    tick: called several times a second; what it raises ends the work. others: tables that may have
    these tooth pairs, too.
    """
    for known in others:
        if known.train is train and known.position == position and known.cut == cut:
            return known if known.tick == tick else replace(known, others=tuple(others), tick=tick)
    rows = columns(train, position, cut, tick)
    if not train.stages[position].options:
        return Table(*rows)
    return replace(RatedTable(*rows), others=tuple(others), tick=tick)


def stage_tables(
    train: Train,
    cut: Fraction,
    tick: Callable[[], float] = lambda: math.inf,
    shelf: list[RatedTable] | None = None,
) -> list[Table]:
    """Return the tables of all stages; equal inner stages share one.

    tick: as of `table`. shelf: tables of like drives, which spare these work; they are added
    themselves where they hold other pairs.
    """
    tables: list[Table] = []
    shelf = [] if shelf is None else shelf
    for k in range(len(train.stages)):
        inner = 1 < k < len(train.stages) - 1
        same = inner and train.stages[k] == train.stages[k - 1]
        tables.append(tables[-1] if same else table(train, k, cut, tick, shelf))
        made = tables[-1]
        if isinstance(made, RatedTable) and not any(one.covers(made) for one in shelf):
            shelf.append(made)
    return tables


def thinned(tables: list[Table]) -> list[Table]:
    """Return tables with THINNED of their tooth pairs; equal ones stay one."""
    known: dict[int, Table] = {}
    for one in tables:
        if id(one) not in known:
            known[id(one)] = one if len(one.ratio) <= THINNED else _few(one)
    return [known[id(one)] for one in tables]


def _few(one: Table) -> Table:
    """Return a table with THINNED of its tooth pairs, evenly spread in their order."""
    place = np.linspace(0, len(one.ratio) - 1, THINNED).astype(np.int64)
    names = ("z1", "z2", "toothing", "ratio", "log_ratio", "first", "last", "need", "slope")
    columns: dict[str, Any] = {name: getattr(one, name)[place] for name in names}
    if one.steps is not None:
        columns["steps"] = (one.steps[0][:, place], one.steps[1][:, place])
    if one.load is not None:
        columns["load"] = one.load[place]
    return replace(one, **columns)
