"""The table of a stage, of the kind that its limits ask for."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

from gearopt.formulations.gear_train import Train
from gearopt.formulations.teeth.columns import columns
from gearopt.formulations.teeth.rated import RatedTable
from gearopt.formulations.teeth.stage import Table


def table(
    train: Train,
    position: int,
    cut: Fraction,
    tick: Callable[[], None] = lambda: None,
    others: Sequence[RatedTable] = (),
) -> Table:
    """Return the table of a stage (counted from 0) for ratios up to `cut`.

    tick: called several times a second; what it raises ends the work. others: tables that may have
    these tooth pairs, too.
    """
    made = columns(train, position, cut, tick)
    if not train.stages[position].options:
        return Table(*made)
    return replace(RatedTable(*made), others=tuple(others), tick=tick)


def stage_tables(
    train: Train,
    cut: Fraction,
    tick: Callable[[], None] = lambda: None,
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
