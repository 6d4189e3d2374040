"""The best design beside those that the design processes make by rules."""

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.section import Section
from gearopt.report.pages.table import Table
from gearopt.report.side_by_side_words import side_by_side


def section(result: Result, measures: Measures) -> Section | None:
    """Designs as columns; None where the file asks for no process."""
    heads, rows, missing = side_by_side(result, measures)
    if not rows:
        return None
    words = "The processes choose by rules, without a search; limits and bound are those of all."
    table = Table("processes and optimum", heads, rows)
    return Section("Processes and optimum", words=(words, *missing), tables=(table,))
