"""The best design beside those that the design processes make by rules."""

from gearopt.optimise.result import Result
from gearopt.report.pages.section import Section, Table
from gearopt.report.side_by_side_words import side_by_side


def section(result: Result) -> Section | None:
    """Designs as columns; None where the file asks for no process."""
    heads, rows, missing = side_by_side(result)
    if not rows:
        return None
    words = "The processes choose by rules, without a search; limits and bound are those of all."
    return Section("Processes and optimum", (words, *missing), tables=(Table(heads, rows),))
