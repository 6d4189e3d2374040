"""The table of a stage, of the kind that its limits ask for."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

from gearopt.formulations.gear_train import Train
from gearopt.formulations.teeth.rated import RatedTable
from gearopt.formulations.teeth.stage import Table, columns


def table(
    train: Train,
    position: int,
    cut: Fraction,
    tick: Callable[[], None] = lambda: None,
    others: Sequence[Table] = (),
) -> Table:
    """Return the table of a stage (counted from 0) for ratios up to `cut`.

    tick: called several times a second; what it raises ends the work. others: tables of other
    stages, whose tooth pairs may be the same.
    """
    made = columns(train, position, cut, tick)
    if not train.stages[position].options:
        return Table(*made)
    rated = tuple(t for t in others if isinstance(t, RatedTable))
    return replace(RatedTable(*made), others=rated)


def stage_tables(
    train: Train,
    cut: Fraction,
    tick: Callable[[], None] = lambda: None,
    others: Sequence[Table] = (),
) -> list[Table]:
    """Return the tables of all stages; equal inner stages share one. others: as of `table`."""
    tables: list[Table] = []
    for k in range(len(train.stages)):
        inner = 1 < k < len(train.stages) - 1
        same = inner and train.stages[k] == train.stages[k - 1]
        tables.append(tables[-1] if same else table(train, k, cut, tick, (*others, *tables)))
    return tables
