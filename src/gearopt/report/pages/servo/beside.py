"""The given train beside the chosen one, and what other numbers of stages would bring."""

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.section import Section, Table
from gearopt.report.servo_beside import (
    BARE,
    COUNTS,
    WHOSE,
    beside_rows,
    count_rows,
    given_teeth,
)


def section(result: Result, measures: Measures) -> Section | None:
    """Chosen, given and real-valued bound side by side; None where no gears are given."""
    rows = beside_rows(result.report, measures)
    if not rows:
        return None
    words = [
        given_teeth(result.report),
        "Real-valued bound: no train is better, even with real-valued teeth and modules.",
    ]
    table = Table("chosen and given", ["", *WHOSE.values()], rows)
    return Section("The given train", words=words, tables=(table,), half=True)


def stage_counts(result: Result, measures: Measures) -> Section | None:
    """Inertia and mass by number of stages; None without a train."""
    rows = count_rows(result.report)
    if not rows:
        return None
    table = Table("stage counts", COUNTS, rows)
    half = bool(beside_rows(result.report))
    return Section("Number of stages", words=[BARE], tables=(table,), half=half)
